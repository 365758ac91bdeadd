/* The plan is what runs: an op taken out of it changes the state, and `explain` prints a line an op. */
#include "helpers.h"
#include "world/world.h"

static const double dt = 1.0 / 90;

/* Something of everything: a soft cloth whose edges, folds and tethers are all strained, loose particles that
 * crowd, bounce and slide, every force and a moving collider. */
static skein_world *busy_world(const char *method) {
    skein_world *world = new_world(method, 3);
    if (!strcmp(method, "xpbd")) OK(world, skein_set_path(world, "method.iterations", skein_number(2)));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "rag"), SKEIN_PAIR("grid", 6, 6),
                                            SKEIN_VEC3("position", 0, 0.6, 0), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("density", 0.5), SKEIN_REAL("stretch.stiffness", 20),
                                            SKEIN_REAL("stretch.damping", 0.05), SKEIN_REAL("shear.stiffness", 10),
                                            SKEIN_REAL("shear.damping", 0.02), SKEIN_TEXT("bend.by", "springs"),
                                            SKEIN_REAL("bend.stiffness", 5), SKEIN_REAL("bend.damping", 0.01),
                                            SKEIN_REAL("stretch.limit", 0.02), SKEIN_REAL("stretch.tether", 0)),
                             NULL));
    uint64_t seed = 11;
    for (int i = 0; i < 20; i++)
        add_moving(world, random_between(&seed, 0.05, 0.2), random_between(&seed, -0.5, 0.5),
                   random_between(&seed, 0.2, 0.5), random_between(&seed, -0.5, 0.5), random_between(&seed, -1, 1),
                   random_between(&seed, -2, 0), random_between(&seed, -1, 1));
    // a triangle of springs: one spring alone would be solved by its first pass, and a second one not matter
    OK(world, skein_constraint_add(world, "distance", (const uint32_t[]){36, 37, 37, 38, 38, 36}, 3,
                                   SKEIN_SETTINGS(SKEIN_REAL("stiffness", 50), SKEIN_REAL("damping", 0.1)), NULL));
    add_gravity(world);
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0.01, 0, 0.02)), NULL));
    OK(world, skein_force_add(world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 1, 0.2, 2)), NULL));
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5)), NULL));
    OK(world, skein_force_add(world, "separation",
                              SKEIN_SETTINGS(SKEIN_REAL("radius", 0.25), SKEIN_REAL("strength", 0.3)), NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_TEXT("name", "ground")), NULL));
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", "ball"), SKEIN_VEC3("centre", 0, 0.1, 0.2),
                                                SKEIN_REAL("radius", 0.3), SKEIN_REAL("restitution", 0.4),
                                                SKEIN_REAL("motion.spin", 3)),
                                 NULL));
    return world;
}

/* Takes an op out; a repeat around it has one less to repeat. */
static void drop_row(sk_plan *plan, size_t dropped) {
    for (size_t r = 0; r < dropped; r++)
        if (plan->data[r].length && r + plan->data[r].length >= dropped) plan->data[r].length--;
    memmove(plan->data + dropped, plan->data + dropped + 1, (plan->count - dropped - 1) * sizeof *plan->data);
    plan->count--;
}

/* The hash after two whole steps and 40 without that op (SIZE_MAX: with all). */
static uint64_t hash_without(const char *method, size_t dropped, size_t *count, char *line, double *blended) {
    skein_world *world = busy_world(method);
    steps(world, 2, dt);
    *count = world->plan.count;
    if (dropped < *count) {
        sk_op_describe(&world->plan.data[dropped], line, 256);
        drop_row(&world->plan, dropped);
    }
    assert_false(world->plan_stale);
    for (int n = 0; n < 40; n++) OK(world, skein_world_step(world, dt));
    if (dropped < *count) assert_int_equal(world->plan.count, *count - 1); // nothing wrote the plan anew
    uint64_t hash = skein_world_hash(world);
    OK(world, skein_positions_blend(world, 0.5, 10, 1, blended));
    skein_world_destroy(world);
    return hash;
}

static void every_row_matters(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        size_t count, unheard;
        char line[256];
        double blended[3], blended_without[3];
        uint64_t whole = hash_without(method_names[m], SIZE_MAX, &count, line, blended);
        assert_int_equal(hash_without(method_names[m], SIZE_MAX, &unheard, line, blended), whole);
        assert_true(count > 20);
        int silent = 0, heard = 0;
        for (size_t r = 0; r < count; r++) {
            bool changed = hash_without(method_names[m], r, &unheard, line, blended_without) != whole;
            // of sweeps over and over the last ones may find nothing any more
            const bool again = strstr(line, "while edges are strained");
            heard += again && changed;
            if (changed || again) continue;
            silent++;
            // two ops that no such motion depends on: the end of what has all but come to rest (test_bits), and the
            // last step's positions, saved for blending between frames
            if (strstr(line, "V, 0 where at most")) continue;
            assert_int_equal(r, 0);
            assert_non_null(strstr(line, "P   = X "));
            assert_memory_not_equal(blended, blended_without, sizeof blended);
        }
        assert_int_equal(silent, 2);
        assert_true(heard > 1);
    }
}

/* ---- explain ------------------------------------------------------------------------------------ */

typedef struct page {
    char lines[128][256];
    size_t count;
} page;

static void write_line(void *user, const char *line) {
    page *p = user;
    assert_true(p->count < COUNT(p->lines) && strlen(line) < sizeof p->lines[0]);
    strcpy(p->lines[p->count++], line);
}

static size_t lines_with(const page *p, const char *part) {
    size_t count = 0;
    for (size_t i = 0; i < p->count; i++) count += strstr(p->lines[i], part) != NULL;
    return count;
}

static void explain_prints_a_line_a_row(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = busy_world(method_names[m]);
        uint64_t before = skein_world_hash(world);
        page p = {.count = 0};
        OK(world, skein_world_explain(world, dt, write_line, &p));
        assert_int_equal(p.count, world->plan.count);
        assert_true(skein_world_hash(world) == before); // looking is not running
        for (size_t i = 0; i < p.count; i++) {
            const sk_op *op = &world->plan.data[i];
            assert_non_null(strstr(p.lines[i], sk_op_type_of(op)->name));
            assert_null(strchr(p.lines[i], '\n'));
            if (op->label && op->kind != SK_OP_REPEAT) assert_non_null(strstr(p.lines[i], op->label));
        }
        // the repeat says how often and how much, and what it repeats is indented
        assert_int_equal(lines_with(&p, "3 times"), 1);
        assert_true(lines_with(&p, "gravity") == 1 && lines_with(&p, "separation") == 1 && lines_with(&p, "limit") >= 1);
        assert_true(lines_with(&p, "ball") == lines_with(&p, "ground") && lines_with(&p, "ball") >= 1);
        assert_int_equal(lines_with(&p, "    "), p.count);
        size_t repeat = 0;
        while (world->plan.data[repeat].kind != SK_OP_REPEAT) repeat++;
        for (size_t i = repeat + 1; i <= repeat + world->plan.data[repeat].length; i++)
            assert_memory_equal(p.lines[i], "    ", 4);

        // ops bear the names that rules have now
        OK(world, skein_set_path(world, "forces.0.name", skein_text("weight")));
        p.count = 0;
        OK(world, skein_world_explain(world, dt, write_line, &p));
        assert_true(lines_with(&p, "gravity") == 0 && lines_with(&p, "weight") == 1);

        // a rule that is switched off has no ops
        OK(world, skein_set_path(world, "colliders.ball.enabled", skein_number(0)));
        OK(world, skein_set_path(world, "forces.0.enabled", skein_number(0)));
        p.count = 0;
        OK(world, skein_world_explain(world, dt, write_line, &p));
        assert_int_equal(lines_with(&p, "ball"), 0);
        assert_int_equal(lines_with(&p, "weight"), 0);
        assert_true(lines_with(&p, "ground") >= 1);

        // without a reader it only makes sure that there is a plan
        OK(world, skein_world_explain(world, dt, NULL, NULL));
        FAILS(world, SKEIN_ERROR_VALUE, "dt", skein_world_explain(world, 0, write_line, &p));
        skein_world_destroy(world);
    }
}

/* Ops that would do nothing are not written: no multipliers without damping and with one pass, no limits that
 * are infinite, no grid where no rule wants neighbours. */
static void needless_rows_are_left_out(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    skein_handle body;
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 3), SKEIN_TEXT("pins", "0"),
                                            SKEIN_REAL("stretch.limit", 0.05), SKEIN_TEXT("bend.by", "springs"),
                                            SKEIN_REAL("bend.stiffness", 20)),
                             &body));
    page p = {.count = 0};
    OK(world, skein_world_explain(world, dt, write_line, &p));
    assert_true(lines_with(&p, "multiplier") == 0 && lines_with(&p, "grid") == 0 && lines_with(&p, "V0") == 0);
    assert_true(lines_with(&p, "project") >= 3 && lines_with(&p, "limit") >= 2);
    OK(world, skein_set(world, body, "bend.damping", skein_number(0.1)));
    OK(world, skein_set(world, body, "stretch.limit", skein_number(INFINITY)));
    p.count = 0;
    OK(world, skein_world_explain(world, dt, write_line, &p));
    assert_true(lines_with(&p, "multiplier") >= 1 && lines_with(&p, "limit") == 1 && lines_with(&p, "strain") == 0);
    OK(world, skein_set(world, body, "stretch.tether", skein_number(INFINITY)));
    p.count = 0;
    OK(world, skein_world_explain(world, dt, write_line, &p));
    assert_int_equal(lines_with(&p, "limit"), 0);
    OK(world, skein_set_path(world, "method.iterations", skein_number(3)));
    p.count = 0;
    OK(world, skein_world_explain(world, dt, write_line, &p));
    assert_true(lines_with(&p, "multiplier") >= 3 && lines_with(&p, "project") == 3 * lines_with(&p, "multiplier"));
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_row_matters),
        cmocka_unit_test(explain_prints_a_line_a_row),
        cmocka_unit_test(needless_rows_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
