/* Tests of `skein compare`, `skein stability` and the warning of `skein check`: what they say, write and draw. */
#include "test_command.h"

#include <math.h>

/* A sheet that hangs, undamped, with springs that limit the step. */
static const char *sheet_scene(void) {
    char *path = in_folder("sheet.json");
    write_scene(
        path,
        "{ 'frames': 6, 'output': [], 'method': { 'type': 'xpbd', 'substeps': 7, 'iterations': 2 },\n"
        "  'bodies': [ { 'type': 'cloth', 'grid': [6, 6], 'pins': 'top corners',\n"
        "    'stretch': { 'stiffness': 2000, 'tether': 'infinite' }, 'shear': { 'stiffness': 200 }, 'bend': { 'by': 'springs', 'stiffness': 2 } } ],\n"
        "  'forces': [ { 'type': 'gravity' } ] }");
    return path;
}

static size_t lines_of(const char *text) {
    size_t count = 0;
    for (; *text; text++) count += *text == '\n';
    return count;
}

/* The number behind `words` in a line of a table. */
static double number_behind(const char *text, const char *words) {
    const char *at = strstr(text, words);
    if (!at) fail_msg("'%s' is not in '%s'", words, text);
    return strtod(at + strlen(words), NULL);
}

static void runs_are_compared(void **state) {
    (void)state;
    const char *s = sheet_scene();
    outcome o = SKEIN("compare", s, "--methods", "symplectic_euler,rk4,xpbd,backward_euler", "--steps",
                      "0.004,5e-4,2.5e-4", "--frames", "5", "--out", in_folder("out"));
    assert_status(o, 0);
    char *table = read_text(in_folder("out/compare.csv")), *series = read_text(in_folder("out/series.csv"));
    assert_int_equal(strncmp(table, "method,step (s),outcome,steps,error (m),", 40), 0);
    assert_int_equal(lines_of(table), 13);
    // 4 ms is too long for the explicit ones: said with the step, and no error
    assert_contains(o.out, "blew up at step ");
    assert_non_null(strstr(table, "symplectic_euler,0.00333333333,blew up,"));
    assert_non_null(strstr(table, "rk4,0.00333333333,blew up,"));
    assert_non_null(strstr(table, "backward_euler,0.00333333333,good,"));
    // steps are made to fit a frame of 1/60 s: 34 of them, and 67; five frames
    double steps = number_behind(table, "rk4,0.000490196078,good,");
    assert_true(steps == 34 * 5);
    double coarse = number_behind(table, "symplectic_euler,0.000490196078,good,170,"),
           fine = number_behind(table, "symplectic_euler,0.000248756219,good,335,"),
           best = number_behind(table, "rk4,0.000490196078,good,170,");
    assert_true(coarse > 0 && fine > 0 && coarse < 1e-2 && fine < coarse && best < fine);
    // a line a frame and run, the start included; less where it blew up
    assert_true(lines_of(series) >= 1 + 10 * 6 && lines_of(series) <= 1 + 12 * 6);
    free(table);
    free(series);
    assert_true(exists(in_folder("out/compare.gnuplot")));
    if (!strstr(o.err, "gnuplot is missing")) {
        char *picture = read_text(in_folder("out/compare.png"));
        assert_memory_equal(picture, "\x89PNG\r\n\x1a\n", 8);
        free(picture);
        picture = read_text(in_folder("out/compare.svg"));
        assert_non_null(strstr(picture, "<svg"));
        assert_non_null(strstr(picture, "backward_euler"));
        free(picture);
    }
    outcome_free(&o);
}

/* The order that the formulas of docs/methods.md promise, on a soft pendulum; and rounding is called so. */
static void orders_are_found(void **state) {
    (void)state;
    char *path = in_folder("swing.json");
    write_scene(path,
                "{ 'frames': 30, 'output': [], 'method': { 'type': 'rk4' },\n"
                "  'bodies': [ { 'type': 'rope', 'count': 2,\n"
                "    'to': [0.6, 0, 0], 'pins': 'first', 'stretch': { 'stiffness': 8, 'tether': 'infinite' } } ],\n"
                "  'forces': [ { 'type': 'gravity' } ] }");
    outcome o = SKEIN("compare", path, "--methods", "symplectic_euler,midpoint,rk4", "--steps", "0.008,0.004", "--out",
                      in_folder("orders"));
    assert_status(o, 0);
    outcome_free(&o);
    char *table = read_text(in_folder("orders/compare.csv"));
    static const struct {
        const char *method;
        double order;
    } known[] = {{"\nsymplectic_euler,0.00333", 1}, {"\nmidpoint,0.00333", 2}, {"\nrk4,0.00333", 4}};
    for (size_t i = 0; i < COUNT(known) - (sizeof(skein_real) == sizeof(float)); i++) { // rk4 is at float's floor
        const char *row = strstr(table, known[i].method);
        assert_non_null(row);
        const char *last = strchr(row + 1, '\n');
        while (*last != ',') last--;
        assert_float_equal(strtod(last + 1, NULL), known[i].order, 0.25);
    }
    free(table);
    o = SKEIN("compare", path, "--methods", "midpoint,explicit_euler", "--steps", "0.004", "--json", "--quiet");
    assert_status(o, 0);
    assert_true(!strncmp(o.out, "{\n", 2) && !*o.err);
    assert_contains(o.out, "\"reference\": {\n    \"method\": \"rk4\"");
    assert_contains(o.out, "\"method\": \"explicit_euler\"");
    assert_contains(o.out, "\"outcome\": \"good\"");
    assert_contains(o.out, "\"order\": null"); // one step says nothing of it
    outcome_free(&o);
    o = SKEIN("compare", path, "--methods", "midpoint", "--steps", "0.004", "--quiet");
    assert_status(o, 0);
    assert_true(!*o.out && !*o.err);
    outcome_free(&o);
    if (sizeof(skein_real) == sizeof(double)) return;
    o = SKEIN("compare", path, "--methods", "rk4", "--steps", "0.001,0.0005");
    assert_status(o, 0);
    assert_contains(o.out, " rounded ");
    assert_contains(o.out, "a build with -DSKEIN_DOUBLE=ON goes further");
    outcome_free(&o);
}

static void what_cannot_be_compared_is_said(void **state) {
    (void)state;
    const char *s = sheet_scene();
    assert_says(2, "", "skein compare: --methods: there is no method 'rk5'; did you mean 'rk4'?\n", "compare", s,
                "--methods", "rk5");
    assert_says(2, "", "skein compare: --steps: '0': expected seconds, 1e-7 to 10\n", "compare", s, "--steps", "0.1,0");
    assert_says(2, "", "skein compare: --frames 0: expected a whole number, 1 to 100000\n", "compare", s, "--frames",
                "0");
    assert_says(2, "", "skein compare: expected names of methods and steps in seconds, with commas between\n",
                "compare", s, "--methods", ",");
    // what is rigid has an xpbd reference, and the others are refused
    outcome o = SKEIN("compare", s, "--set", "bodies.0.stretch.stiffness=infinite", "--methods", "leapfrog,xpbd",
                      "--steps", "1e-3", "--frames", "2");
    assert_status(o, 0);
    assert_contains(o.err, "leapfrog needs finite stiffness");
    assert_contains(o.out, "refused");
    assert_contains(o.out, "distance to xpbd");
    outcome_free(&o);
}

static void stability_is_foretold(void **state) {
    (void)state;
    const char *s = sheet_scene();
    outcome o = SKEIN("stability", s, "--set", "bodies.0.stretch.damping=0.1");
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    static const char *const words[] = {"stiffest", "most damped", "\nbackward_euler     any", "does not damp swinging",
                                        ": stable."};
    for (size_t i = 0; i < COUNT(words); i++) assert_contains(o.out, words[i]);
    double most = number_behind(o.out, "\nsymplectic_euler ");
    assert_true(most > 0.1 && most < 3);
    outcome_free(&o);

    // undamped, explicit Euler has no step; a scene that asks for more than there is, is warned
    o = SKEIN("stability", s, "--set", "method.type=explicit_euler");
    assert_status(o, 0);
    assert_contains(o.out, "explicit_euler     none");
    assert_contains(o.out, "UNSTABLE");
    outcome_free(&o);
    o = SKEIN("check", s, "--set", "method.type=symplectic_euler");
    assert_status(o, 0);
    assert_contains(o.err, "warning: ");
    assert_contains(o.err, "symplectic_euler is stable with substeps of");
    assert_contains(o.out, "; 1 warning\n");
    double enough = number_behind(o.err, "set method.substeps to ");
    outcome_free(&o);
    char set[64];
    snprintf(set, sizeof set, "method.substeps=%g", enough);
    o = SKEIN("check", s, "--set", "method.type=symplectic_euler", "--set", set);
    assert_contains(o.out, "; 0 warnings\n");
    outcome_free(&o);
    o = SKEIN("check", s, "--set", "method.type=explicit_euler", "--set", "method.substeps=100000");
    assert_contains(o.err, "undamped springs grow under explicit_euler at any step");
    outcome_free(&o);
}

/* Position methods keep what forces do in a substep in the positions, which round it. */
static void substeps_that_rounding_swallows(void **state) {
    (void)state;
    const char *s = sheet_scene();
    bool is_double = sizeof(skein_real) == sizeof(double);
    const char *many = is_double ? "method.substeps=90000" : "method.substeps=300";
    static const char *const methods[] = {"method.type=xpbd", "method.type=pbd", "method.type=backward_euler"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        outcome o = SKEIN("check", s, "--set", methods[m], "--set", many);
        assert_status(o, 0);
        if (m == 2 || is_double) {
            // passes are no conjugate gradients: the scene's 2 are not carried over
            assert_string_equal(
                o.err, m == 2 ? "skein: method.iterations is left out: backward_euler has no such field\n" : "");
            outcome_free(&o);
            continue;
        }
        assert_contains(o.err, "hardly more than positions are rounded to");
        assert_contains(o.out, "; 1 warning\n");
        double most = number_behind(o.err, "set method.substeps to ");
        outcome_free(&o);
        char set[64];
        snprintf(set, sizeof set, "method.substeps=%g", most);
        o = SKEIN("check", s, "--set", methods[m], "--set", set);
        assert_string_equal(o.err, "");
        outcome_free(&o);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(runs_are_compared),
        TEST(orders_are_found),
        TEST(what_cannot_be_compared_is_said),
        TEST(stability_is_foretold),
        TEST(substeps_that_rounding_swallows),
    };
    return cmocka_run_group_tests_name("compare", tests, NULL, NULL);
}
