/* Objects whose formulas have parameters: a kind of their own, in which each parameter is a field like all others; and
 * texts that are compiled, whose errors say where. The kind here is the test's: the library's are in test_fields.c. */
#include <stdio.h>
#include <string.h>

#include "helpers.h"

#include "base/status.h"
#include "formula/formula.h"
#include "world/world.h"

typedef struct pull_params {
    double parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    double gain;
    char *text;
    skein_formula *formula;
} pull_params;

static const skein_field fields[] = {
    SK_TEXT(pull_params, text, "text", "1", "a number"),
    SK_PARAMETERS(pull_params, parameter, "what the text names"),
    SK_REAL(pull_params, gain, "gain", "", 2, 0, 10, "a field behind the parameters"),
};

static skein_status make(void *params, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    pull_params *p = params;
    skein_formula_desc desc = {.result = SKEIN_FORMULA_NUMBER, .particles = 1};
    skein_formula *formula = sk_formula_of_field("text", p->text, desc, kind, allocator, error);
    if (!formula) return error->status;
    const skein_formula *all[] = {formula};
    skein_status status = p->formula ? SKEIN_OK : sk_formula_check_used(kind, all, 1, error);
    if (status) {
        skein_formula_destroy(formula);
        return status;
    }
    skein_formula_destroy(p->formula);
    p->formula = formula;
    return SKEIN_OK;
}

static void unmake(void *params, sk_allocator *allocator) {
    (void)allocator;
    skein_formula_destroy(((pull_params *)params)->formula);
}

static void kernel(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)run, (void)op, (void)begin, (void)end;
}

static const sk_making making = {.make = make, .unmake = unmake};
static const sk_force_type pull = {
    .kind = {"pull", "a force of the test", SKEIN_FORCE, fields, sizeof fields / sizeof *fields, sizeof(pull_params)},
    .domain = SK_OVER_PARTICLES,
    .kernel = {SK_ANY_ISA(kernel)},
    .making = &making,
};

static skein_status add(skein_world *world, const skein_setting *settings, skein_handle *handle) {
    return sk_world_add_force(world, &pull, settings, handle);
}

static void parameters_are_fields(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    skein_handle one, two;
    assert_int_equal(add(world,
                         SKEIN_SETTINGS(SKEIN_TEXT("name", "mine"), SKEIN_TEXT("text", "Radius - speed*t"),
                                        SKEIN_REAL("parameters.Radius", 0.3), SKEIN_REAL("parameters.speed", 7)),
                         &one),
                     SKEIN_OK);
    assert_int_equal(add(world, NULL, &two), SKEIN_OK);
    // each has a kind of its own
    const skein_kind *kind = skein_object_kind(world, one), *other = skein_object_kind(world, two);
    assert_string_equal(kind->name, "pull");
    assert_ptr_not_equal(kind, other);
    assert_int_equal(kind->field_count, 4);
    assert_int_equal(other->field_count, 2);
    assert_string_equal(kind->fields[2].name, "parameters.Radius");
    assert_string_equal(kind->fields[3].name, "parameters.speed");
    // set and read by handle and by path, and where the formula's values are
    skein_value value;
    assert_int_equal(skein_get(world, one, "parameters.speed", &value), SKEIN_OK);
    assert_true(value.number[0] == 7);
    assert_int_equal(skein_set_path(world, "forces.mine.parameters.Radius", skein_number(0.5)), SKEIN_OK);
    assert_int_equal(skein_get_path(world, "forces.0.parameters.Radius", &value), SKEIN_OK);
    assert_true(value.number[0] == 0.5);
    const pull_params *params = world->objects.data[one.index]->params;
    assert_true(params->parameter[0] == 0.5 && params->parameter[1] == 7 && params->gain == 2);
    const char *names[SKEIN_FORMULA_MOST_PARAMETERS + 1];
    assert_int_equal(sk_parameter_names(kind, names), 2);
    assert_string_equal(names[1], "speed");
    assert_null(names[2]);
    // no others
    assert_int_equal(skein_set(world, one, "parameters.Radios", skein_number(1)), SKEIN_ERROR_NAME);
    assert_non_null(strstr(skein_world_error(world)->message, "did you mean 'parameters.Radius'?"));
    assert_int_equal(skein_set(world, two, "parameters.speed", skein_number(1)), SKEIN_ERROR_NAME);
    assert_int_equal(skein_set(world, one, "parameters.speed", skein_number(1e300)), SKEIN_ERROR_VALUE);
    skein_world_destroy(world);
}

/* What a kind says of its parameters as such. */
static void kinds_take_parameters(void **state) {
    (void)state;
    assert_true(sk_takes_parameters(&pull.kind));
    assert_ptr_equal(skein_field_find(&pull.kind, "parameters.any", NULL), &fields[1]);
    assert_null(skein_field_find(&pull.kind, "parameters.", NULL));
    const skein_kind *wind = skein_kind_find(SKEIN_FORCE, "wind", NULL);
    assert_false(sk_takes_parameters(wind));
    assert_null(skein_field_find(wind, "parameters.any", NULL));
}

static void expect_refused(const skein_setting *settings, const char *where, const char *words) {
    skein_world *world = skein_world_create(NULL, NULL);
    assert_int_not_equal(add(world, settings, NULL), SKEIN_OK);
    const skein_error *error = skein_world_error(world);
    if (strcmp(error->where, where) || !strstr(error->message, words))
        fail_msg("'%s: %s', expected '%s: ...%s...'", error->where, error->message, where, words);
    assert_int_equal(skein_object_count(world, SKEIN_FORCE), 0);
    skein_world_destroy(world);
}

static void bad_names_are_refused(void **state) {
    (void)state;
    expect_refused(SKEIN_SETTINGS(SKEIN_REAL("parameters.2x", 1)), "parameters.2x", "'2x' cannot be a parameter's name");
    expect_refused(SKEIN_SETTINGS(SKEIN_REAL("parameters.a.b", 1)), "parameters.a.b", "'a.b' cannot be");
    expect_refused(SKEIN_SETTINGS(SKEIN_REAL("parameters.*", 1)), "parameters.*", "'*' cannot be");
    expect_refused(SKEIN_SETTINGS(SKEIN_REAL("parameters.", 1)), "parameters.", "'' cannot be");
    expect_refused(SKEIN_SETTINGS(SKEIN_REAL("parameters.length", 1)), "parameters.length", "has a meaning");
    expect_refused(SKEIN_SETTINGS(SKEIN_REAL("parameters.p3", 1)), "parameters.p3", "has a meaning");
    expect_refused(SKEIN_SETTINGS(SKEIN_TEXT("text", "R"), SKEIN_REAL("parameters.R", 1), SKEIN_REAL("gain", 1),
                                  SKEIN_REAL("parameters.R", 2)),
                   "parameters.R", "given twice");
    expect_refused(SKEIN_SETTINGS(SKEIN_TEXT("text", "R"), SKEIN_REAL("parameters.R", 1e300)), "parameters.R",
                   "out of range");
    expect_refused(SKEIN_SETTINGS(SKEIN_TEXT("text", "R"), SKEIN_VEC3("parameters.R", 1, 2, 3)), "parameters.R",
                   "expected a number");
    expect_refused(SKEIN_SETTINGS(SKEIN_REAL("parameters.R", 1), SKEIN_REAL("parameter.R", 1)), "parameter.R",
                   "did you mean 'parameters.R'?");
    expect_refused(
        SKEIN_SETTINGS(SKEIN_TEXT("text", "R*0"), SKEIN_REAL("parameters.R", 1), SKEIN_REAL("parameters.S", 1)),
        "parameters.S", "'S' is in no formula of this object");
}

static void at_most_32(void **state) {
    (void)state;
    char name[33][32], text[400] = "0";
    skein_setting settings[35];
    settings[0] = (skein_setting)SKEIN_TEXT("text", text);
    for (int i = 0; i < 33; i++) {
        snprintf(name[i], sizeof name[i], "parameters.a%d", i);
        if (i < 32) snprintf(text + strlen(text), sizeof text - strlen(text), "+a%d", i);
        settings[i + 1] = (skein_setting)SKEIN_REAL(name[i], i);
    }
    settings[34] = (skein_setting){NULL, {0, {0, 0, 0}, NULL}};
    expect_refused(settings, "parameters.a32", "too many parameters: 32 are the most");
    settings[33].name = NULL;
    skein_world *world = skein_world_create(NULL, NULL);
    skein_value value;
    assert_int_equal(add(world, settings, NULL), SKEIN_OK);
    assert_int_equal(skein_get_path(world, "forces.0.parameters.a31", &value), SKEIN_OK);
    assert_true(value.number[0] == 31);
    skein_world_destroy(world);
}

static void bad_texts_are_shown(void **state) {
    (void)state;
    expect_refused(SKEIN_SETTINGS(SKEIN_TEXT("text", "Radius + lenght(p)"), SKEIN_REAL("parameters.Radius", 1)), "text",
                   "column 10: there is no name 'lenght'; did you mean 'length'?\n"
                   "    Radius + lenght(p)\n             ^^^^^^");
    expect_refused(
        SKEIN_SETTINGS(SKEIN_TEXT("text", "let a = 1;\na + Radios"), SKEIN_REAL("parameters.Radius", 1)), "text",
        "line 2, column 5: there is no name 'Radios'; did you mean 'Radius'?\n    a + Radios\n        ^^^^^^");
    expect_refused(SKEIN_SETTINGS(SKEIN_TEXT("text", "p")), "text", "expected a number");
    expect_refused(SKEIN_SETTINGS(SKEIN_TEXT("text", "")), "text", "the formula is empty");
}

/* A living object's text: a good one takes over, a bad one leaves all as it was. */
static void texts_change(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    skein_handle handle;
    skein_value value;
    assert_int_equal(add(world, SKEIN_SETTINGS(SKEIN_TEXT("text", "R*p.x"), SKEIN_REAL("parameters.R", 1)), &handle),
                     SKEIN_OK);
    const pull_params *params = world->objects.data[handle.index]->params;
    const skein_formula *before = params->formula;
    assert_int_equal(skein_set(world, handle, "text", skein_text("R*(p.x")), SKEIN_ERROR_SYNTAX);
    assert_int_equal(skein_set(world, handle, "text", skein_text("Q*p.x")), SKEIN_ERROR_NAME);
    assert_ptr_equal(params->formula, before);
    assert_int_equal(skein_get(world, handle, "text", &value), SKEIN_OK);
    assert_string_equal(value.text, "R*p.x");
    assert_int_equal(skein_set(world, handle, "text", skein_text("R*p.y")), SKEIN_OK);
    assert_string_equal(params->formula->text, "R*p.y");
    // to what it is, and one that needs its parameter no more
    assert_int_equal(skein_get(world, handle, "text", &value), SKEIN_OK);
    assert_int_equal(skein_set(world, handle, "text", value), SKEIN_OK);
    assert_int_equal(skein_set(world, handle, "text", skein_text("p.z")), SKEIN_OK);
    assert_int_equal(skein_set(world, handle, "name", skein_text("it")), SKEIN_OK);
    assert_int_equal(skein_get(world, handle, "name", &value), SKEIN_OK);
    assert_int_equal(skein_set(world, handle, "name", value), SKEIN_OK);
    assert_int_equal(skein_get_path(world, "forces.it.text", &value), SKEIN_OK);
    assert_string_equal(value.text, "p.z");
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parameters_are_fields), cmocka_unit_test(kinds_take_parameters),
        cmocka_unit_test(bad_names_are_refused), cmocka_unit_test(at_most_32),
        cmocka_unit_test(bad_texts_are_shown),   cmocka_unit_test(texts_change),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
