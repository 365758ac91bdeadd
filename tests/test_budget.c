/* Substeps for a time a frame: the choice by any cost, and that what was chosen is kept and done again. No test asks how
 * long anything takes. */
#include "test_command.h"

#include "io/budget.h"

/* ---- the choice, by costs that are given ---- */

typedef struct machine {
    double least, each, power; /* ms: least + each n^power */
    int asked, most_asked;
} machine;

static double cost(void *user, int substeps) {
    machine *m = user;
    m->asked++;
    if (substeps > m->most_asked) m->most_asked = substeps;
    double n = substeps, sum = m->each;
    for (double k = 0; k < m->power; k++) sum *= n;
    return m->least + sum;
}

static int most_for(const machine *m, double ms, int most) {
    machine copy = *m;
    int n = 1;
    while (n < most && cost(&copy, n + 1) <= ms) n++;
    return n;
}

static void the_most_that_it_pays_for(void **state) {
    (void)state;
    static const machine machines[] = {
        {0.1, 0.05, 1, 0, 0}, {2, 0.3, 1, 0, 0}, {0, 0.01, 2, 0, 0}, {0.5, 1e-4, 1, 0, 0}};
    for (size_t i = 0; i < COUNT(machines); i++) {
        int before = 0;
        for (double ms = 0.01; ms < 1000; ms *= 1.07) {
            machine m = machines[i];
            int n = io_budget_substeps(ms, 500, cost, &m), ought = most_for(&m, ms, 500);
            assert_true(n >= before && n <= 500); // a larger budget never gets fewer
            assert_true(n <= ought && n + n / 16 + 1 >= ought);
            if (n > 1) assert_true(cost(&m, n) <= ms);
            assert_true(m.asked < 30 && m.most_asked <= 2 * ought); // nor is time spent on what is far too much
            before = n;
        }
    }
}

/* ---- in a scene ---- */

#define SCENE "scenes/hanging.json"

static json_t *run(const char *scene, const char *set, const char *more) {
    outcome o = more ? SKEIN("run", scene, "--json", "--no-progress", "--frames", "20", "--set", set, "--set", more)
                     : SKEIN("run", scene, "--json", "--no-progress", "--frames", "20", "--set", set);
    assert_status(o, 0);
    json_t *report = json_loads(o.out, 0, NULL);
    assert_non_null(report);
    assert_true(!strstr(set, "budget_ms") || strstr(o.err, " ms a frame "));
    outcome_free(&o);
    return report;
}

/* What the report has is a scene without a budget, of the substeps that it says; and they give the same hash. */
static void it_is_done_again(void **state) {
    (void)state;
    static const char *const budgets[] = {"method.budget_ms=0.000001", "method.budget_ms=2"};
    for (size_t i = 0; i < COUNT(budgets); i++) {
        json_t *report = run(SCENE, budgets[i], "bodies.0.grid=[9, 9]"), *budget = json_object_get(report, "budget");
        json_t *document = json_object_get(report, "document"), *method = json_object_get(document, "method");
        double chosen = number_of(json_object_get(budget, "chosen"), "substeps");
        assert_null(json_object_get(method, "budget_ms"));
        assert_true(chosen >= 1);
        assert_true(number_of(method, "substeps") == chosen);
        assert_true(number_of(report, "substeps") == 20 * chosen); // the trial left nothing behind
        if (i == 0) assert_true(chosen == 1 && json_is_true(json_object_get(budget, "exceeded")));
        if (chosen > 1) assert_true(number_of(json_object_get(budget, "half"), "max_stretch") > 0);
        char again[600], substeps[64];
        snprintf(again, sizeof again, "%s", in_folder("again.json"));
        assert_int_equal(json_dump_file(document, again, 0), 0);
        snprintf(substeps, sizeof substeps, "method.substeps=%.0f", chosen);
        json_t *same = run(again, "name=again", NULL), *said = run(SCENE, substeps, "bodies.0.grid=[9, 9]");
        assert_string_equal(text_of(same, "state_hash"), text_of(report, "state_hash"));
        assert_string_equal(text_of(said, "state_hash"), text_of(report, "state_hash"));
        assert_null(json_object_get(same, "budget"));
        json_decref(report), json_decref(same), json_decref(said);
    }
}

static void what_is_no_budget_is_refused(void **state) {
    (void)state;
    outcome o = SKEIN("check", SCENE, "--set", "method.budget_ms=-1");
    assert_int_equal(o.status, 2);
    assert_non_null(strstr(o.err, "method.budget_ms: "));
    outcome_free(&o);
    o = SKEIN("check", SCENE, "--set", "method.budget_ms=fast");
    assert_int_equal(o.status, 2);
    assert_non_null(strstr(o.err, "expected a number"));
    outcome_free(&o);
    // another method keeps it
    o = SKEIN("run", SCENE, "--frames", "2", "--no-progress", "--set", "method.budget_ms=0.0001", "--set",
              "method.type=pbd");
    assert_status(o, 0);
    assert_non_null(strstr(o.err, "is less than a frame takes"));
    outcome_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_most_that_it_pays_for),
        cmocka_unit_test_setup_teardown(it_is_done_again, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_is_no_budget_is_refused, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
