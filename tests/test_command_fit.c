/* skein fit: stiffnesses are found again from a point cache that another run left, and what cannot be fitted says so. */
#include "fit.h"

static const char symplectic[] = "'type': 'symplectic_euler', 'substeps': 10";

#ifdef SKEIN_FIT

static void stiffnesses_are_found_again(void **state) {
    (void)state;
    make_target("hang", 7, 40, symplectic);
    json_t *report = fit_from("hang", (const double[]){3, 1 / 3.0, 3}, "40", in_folder("found.json"));
    assert_found(report, 0.01);
    static const char *const keys[] = {"skein",      "commit",  "command_line", "scene",  "method", "precision",
                                       "target",     "samples", "points",       "steps",  "began",  "found",
                                       "iterations", "runs",    "began_misfit", "misfit", "end",    "seconds"};
    for (size_t i = 0; i < COUNT(keys); i++)
        if (!json_object_get(report, keys[i])) fail_msg("the report has no %s", keys[i]);
    assert_int_equal(json_object_size(report), COUNT(keys));
    assert_int_equal(json_integer_value(json_object_get(report, "samples")), 40); // the start is not one
    assert_int_equal(json_integer_value(json_object_get(report, "points")), 49);
    double first = json_number_value(json_object_get(report, "began_misfit")),
           last = json_number_value(json_object_get(report, "misfit"));
    assert_true(last < 1e-3 * first && last > 0);
    assert_string_equal(json_string_value(json_object_get(report, "end")), "converged");
    // the scene that was written has what was found, and moves like the target
    char vary[100];
    double found = json_number_value(json_object_get(json_object_get(report, "found"), fit_paths[0]));
    snprintf(vary, sizeof vary, "%s=50..200", fit_paths[0]);
    outcome o = SKEIN("fit", in_folder("found.json"), "--target", in_folder("hang/sheet.pc2"), "--vary", vary, "--json",
                      "--quiet");
    assert_status(o, 0);
    json_t *again = json_loads(o.out, 0, NULL);
    assert_true(json_number_value(json_object_get(json_object_get(again, "began"), fit_paths[0])) == found);
    assert_true(fabs(json_number_value(json_object_get(again, "began_misfit")) / last - 1) < 1e-3);
    assert_string_equal(o.err, "");
    json_decref(again), json_decref(report);
    outcome_free(&o);
}

/* Under XPBD, through its projections. */
static void stiffnesses_are_found_under_xpbd(void **state) {
    (void)state;
    make_target("firm", 6, 30, "'type': 'xpbd', 'substeps': 10");
    json_t *report = fit_from("firm", (const double[]){3, 1 / 3.0, 3}, "40", in_folder("firm_found.json"));
    assert_found(report, 0.02);
    assert_string_equal(json_string_value(json_object_get(report, "end")), "converged");
    json_decref(report);
}

/* Gravity is no positive number, and has three: found from noughts and a wrong one. And bounds are kept to. */
static void a_force_is_found_within_bounds(void **state) {
    (void)state;
    make_target("force", 5, 12, symplectic);
    outcome o = SKEIN("fit", in_folder("force.json"), "--target", in_folder("force/sheet.pc2"), "--vary",
                      "forces.0.acceleration", "--set", "forces.0.acceleration=1 -5 2", "--json");
    assert_status(o, 0);
    assert_contains(o.err, "iteration 1 of 50 at most");
    json_t *report = json_loads(o.out, 0, NULL),
           *g = json_object_get(json_object_get(report, "found"), "forces.0.acceleration");
    for (size_t k = 0; k < 3; k++)
        assert_true(fabs(json_number_value(json_array_get(g, k)) - (k == 1 ? -9.81 : 0)) < 1e-3);
    json_decref(report);
    outcome_free(&o);
    o = SKEIN("fit", in_folder("force.json"), "--target", in_folder("force/sheet.pc2"), "--vary",
              "forces.1.rate=2.5..8", "--set", "forces.1.rate=6", "--quiet", "--json");
    report = json_loads(o.out, 0, NULL);
    double rate = json_number_value(json_object_get(json_object_get(report, "found"), "forces.1.rate"));
    if (!(rate >= 2.5 && rate < 2.6)) fail_msg("a rate of %g, not the bound nearest to 2", rate);
    json_decref(report);
    outcome_free(&o);
}

static void what_cannot_be_fitted_says_so(void **state) {
    (void)state;
    make_target("small", 4, 3, symplectic);
    make_target("large", 5, 3, symplectic);
    static const struct {
        const char *vary, *set, *words;
    } all[] = {
        {"bodies.0.stretch.stifness", "fps=60", "stifness"},
        {"bodies.0.name", "fps=60", "it is no number that could be varied"},
        {"bodies.0.stretch.stiffness=5..2", "fps=60", "--vary bodies.0.stretch.stiffness: expected a field"},
        {"bodies.0.stretch.stiffness=5", "fps=60", "expected a field"},
        {"bodies.0.stretch.stiffness=1..50", "fps=60",
         "it begins at 100: expected a number between its bounds, 1 and 50"},
        {"forces.1.rate,forces.1.rate", "fps=60", "it is named twice"},
        {"bodies.0.stretch.stiffness", "bodies.0.stretch.tether=1.02", "has no gradient"},
        {"bodies.0.stretch.stiffness", "bodies.0.stretch.stiffness=1e7", "the run blew up"},
        {"bodies.0.density", "fps=60", "density shapes what is already built"},
    };
    for (size_t i = 0; i < COUNT(all); i++) {
        outcome o = SKEIN("fit", in_folder("small.json"), "--target", in_folder("small/sheet.pc2"), "--vary",
                          all[i].vary, "--set", all[i].set, "--no-progress");
        assert_status(o, 2);
        assert_contains(o.err, all[i].words);
        outcome_free(&o);
    }
    const char *const small = in_folder("small.json"), *const cache = in_folder("small/sheet.pc2"),
                      *const rate = "forces.1.rate";
    outcome o = SKEIN("fit", small, "--target", in_folder("large/sheet.pc2"), "--vary", rate);
    assert_status(o, 2);
    assert_contains(o.err, "it has 25 points: expected as many as the body has vertices (16) or particles (16)");
    outcome_free(&o);
    o = SKEIN("fit", small, "--target", in_folder("none.pc2"), "--vary", rate);
    assert_status(o, 2);
    assert_contains(o.err, "none.pc2");
    outcome_free(&o);
    o = SKEIN("fit", small, "--vary", rate);
    assert_status(o, 2);
    assert_contains(o.err, "--target CACHE.pc2");
    outcome_free(&o);
    o = SKEIN("fit", small, "--target", cache);
    assert_status(o, 2);
    assert_contains(o.err, "which fields are to be found?");
    outcome_free(&o);
    o = SKEIN("fit", small, "--target", cache, "--vary", rate, "--body", "cape");
    assert_status(o, 2);
    assert_contains(o.err, "there is no body of the name 'cape'");
    outcome_free(&o);
    o = SKEIN("fit", small, "--target", cache, "--vary", rate, "--iterations", "0");
    assert_status(o, 2);
    assert_contains(o.err, "--iterations 0: expected a whole number");
    outcome_free(&o);
}

#else

static void without_its_module_it_says_what_to_do(void **state) {
    (void)state;
    make_target("small", 4, 3, symplectic);
    outcome o =
        SKEIN("fit", in_folder("small.json"), "--target", in_folder("small/sheet.pc2"), "--vary", "forces.1.rate");
    assert_status(o, 1);
    assert_contains(o.err, "'tools/setup build' installs what it takes (liblbfgs), and 'make' builds it");
    outcome_free(&o);
}

#endif

int main(void) {
    const struct CMUnitTest tests[] = {
#ifdef SKEIN_FIT
        cmocka_unit_test_setup_teardown(stiffnesses_are_found_again, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(stiffnesses_are_found_under_xpbd, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_force_is_found_within_bounds, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_cannot_be_fitted_says_so, make_folder, remove_folder),
#else
        cmocka_unit_test_setup_teardown(without_its_module_it_says_what_to_do, make_folder, remove_folder),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
