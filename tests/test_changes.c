/* Settings that change between steps: what is brought up to date is what depended on them, and nothing is missed. Each
 * live field of each kind is set in two worlds, in one of which everything is made anew before each step. */
#include "all_methods.h"
#include "helpers.h"
#include "world/world.h"

/* What there is to be changed: a hanging cloth, a lattice and birds over a floor, in the air. */
typedef struct pair {
    skein_world *marked, *anew;
    skein_handle object[2]; /* in each */
} pair;

static void add_everything(skein_world *world) {
    double mass[4] = {0.1, 0.1, 0.1, 0.1}, at[12] = {3, 0, 0, 3.5, 0.1, 0, 3, 0.5, 0.1, 3, 0.1, 0.6};
    OK(world, skein_particles_add(world, 4, at, NULL, mass, NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("stretch.stiffness", 200), SKEIN_REAL("shear.stiffness", 100),
                                            SKEIN_TEXT("name", "cloth")),
                             NULL));
    add_gravity(world);
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -0.6)), NULL));
}

static skein_status add_one(skein_world *world, const skein_kind *kind, skein_handle *handle) {
    static const uint32_t particles[] = {0, 1, 2, 3};
    // the closed surface of the four
    static const uint32_t closed[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    skein_setting soft[] = {SKEIN_REAL("stiffness", 50), {NULL, {0, {0, 0, 0}, NULL}}};
    size_t arity;
    switch (kind->category) {
    case SKEIN_BODY:
        return skein_body_add(world, kind->name, NULL,
                              !strcmp(kind->name, "cloth") ? SKEIN_SETTINGS(SKEIN_PAIR("grid", 4, 4)) : NULL, handle);
    case SKEIN_CONSTRAINT:
        OK(world, skein_constraint_arity(world, kind->name, NULL, &arity));
        if (!strcmp(kind->name, "enclosed_volume") || !strcmp(kind->name, "pressure"))
            return skein_constraint_add(world, kind->name, closed, 4, NULL, handle);
        return skein_constraint_add(world, kind->name, particles, 1,
                                    skein_field_find(kind, "stiffness", NULL) ? soft : NULL, handle);
    case SKEIN_FORCE: return skein_force_add(world, kind->name, NULL, handle);
    default: return skein_collider_add(world, kind->name, NULL, handle);
    }
}

/* Another value that the field may have; false where there is none to be tried. */
static bool another(const skein_field *field, skein_value *value, int turn) {
    double step = turn ? 0.35 : 0.2;
    switch (field->type) {
    case SKEIN_FIELD_BOOL: value->number[0] = value->number[0] == 0; return true;
    case SKEIN_FIELD_INT: value->number[0] = fmin(value->number[0] + 1, field->most); return true;
    case SKEIN_FIELD_CHOICE: value->number[0] = value->number[0] == 0; return true;
    case SKEIN_FIELD_REAL:
    case SKEIN_FIELD_REAL2:
    case SKEIN_FIELD_VEC3:
        for (int k = 0; k < value->count; k++) {
            double x = isinf(value->number[k]) ? 100 : value->number[k];
            value->number[k] = fmax(field->least, fmin(field->most, x * (1 + step) + step * (k + 1) * 0.3));
        }
        return true;
    default: return false;
    }
}

static void make_anew(skein_world *world) {
    world->plan_stale = true;
    for (size_t i = 0; i < world->rules.batches.count; i++) world->rules.batches.data[i]->stale = true;
}

static void step_both(const pair *p, const char *method, const char *kind, const char *field) {
    make_anew(p->anew);
    skein_status a = skein_world_step(p->marked, 0.01), b = skein_world_step(p->anew, 0.01);
    if (a == b && skein_world_hash(p->marked) == skein_world_hash(p->anew)) return;
    fail_msg("%s, %s, %s: what was marked is not what was changed", method, kind, field);
}

/* Sets a field to other values and back, with steps between. How many sets were taken. */
static size_t try_field(const pair *p, const char *method, const skein_kind *kind, const skein_field *field) {
    skein_value value, old;
    size_t taken = 0;
    if (!skein_field_is_live(p->marked, p->object[0], field->name)) return 0;
    OK(p->marked, skein_get(p->marked, p->object[0], field->name, &value));
    old = value;
    for (int turn = 0; turn < 3; turn++) {
        if (turn == 2) value = old;
        else if (!another(field, &value, turn)) return taken;
        skein_status a = skein_set(p->marked, p->object[0], field->name, value),
                     b = skein_set(p->anew, p->object[1], field->name, value);
        assert_int_equal(a, b);
        taken += a == SKEIN_OK;
        step_both(p, method, kind->name, field->name);
    }
    return taken;
}

static size_t try_kind(const char *method, const skein_kind *kind) {
    pair p = {.marked = new_world(method, 2), .anew = new_world(method, 2)};
    skein_world *worlds[] = {p.marked, p.anew};
    size_t taken = 0, common_count;
    for (int w = 0; w < 2; w++) {
        add_everything(worlds[w]);
        if (add_one(worlds[w], kind, &p.object[w])) { // it needs a mesh
            skein_world_destroy(p.marked), skein_world_destroy(p.anew);
            return 0;
        }
    }
    step_both(&p, method, kind->name, "");
    const skein_field *common = skein_common_fields(kind->category, &common_count);
    kind = skein_object_kind(p.marked, p.object[0]);
    for (size_t f = 0; f < kind->field_count; f++) taken += try_field(&p, method, kind, &kind->fields[f]);
    for (size_t f = 0; f < common_count; f++) taken += try_field(&p, method, kind, &common[f]);
    skein_world_destroy(p.marked), skein_world_destroy(p.anew);
    return taken;
}

static void each_field_reaches_what_depends_on_it(void **state) {
    static const skein_category categories[] = {SKEIN_BODY, SKEIN_CONSTRAINT, SKEIN_FORCE, SKEIN_COLLIDER};
    static const char *const methods[] = {"xpbd", "pbd", "leapfrog", "backward_euler"};
    (void)state;
    size_t kinds = 0, taken = 0;
    for (size_t m = 0; m < COUNT(methods); m++)
        for (size_t c = 0; c < COUNT(categories); c++)
            for (size_t k = 0; skein_kind_at(categories[c], k); k++) {
                size_t now = try_kind(methods[m], skein_kind_at(categories[c], k));
                kinds += now > 0, taken += now;
            }
    printf("%zu settings of %zu kinds under %zu methods\n", taken, kinds, COUNT(methods));
    assert_true(kinds > 25 * COUNT(methods) && taken > 300 * COUNT(methods));
}

/* Another step, another method's settings, and a constraint's stiffness in turns. */
static void steps_of_any_length_reach_the_plan(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        pair p = {.marked = new_world(all_methods[m], 2), .anew = new_world(all_methods[m], 2)};
        add_everything(p.marked), add_everything(p.anew);
        for (int i = 0; i < 12; i++) {
            double dt = i % 3 ? 0.004 : 0.005;
            skein_value stiffness = skein_number(i % 4 ? 150 : 200);
            make_anew(p.anew);
            OK(p.marked, skein_set_path(p.marked, "bodies.cloth.shear.stiffness", stiffness));
            OK(p.anew, skein_set_path(p.anew, "bodies.cloth.shear.stiffness", stiffness));
            OK(p.marked, skein_world_step(p.marked, dt));
            OK(p.anew, skein_world_step(p.anew, dt));
            assert_true(skein_world_hash(p.marked) == skein_world_hash(p.anew));
        }
        skein_world_destroy(p.marked), skein_world_destroy(p.anew);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_field_reaches_what_depends_on_it),
        cmocka_unit_test(steps_of_any_length_reach_the_plan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
