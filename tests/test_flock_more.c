/* Beyond the zones of a flock: a field of view, the nearest few, limits on turning and climbing, bounds, obstacles that
 * are looked ahead for, and birds and cloth that mind each other. */
#include "all_methods.h"
#include "helpers.h"

static const double dt = 1.0 / 64;

static vec3 plus(vec3 a, double s, vec3 b) {
    return (vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static vec3 unit(vec3 a) {
    double length = length3(a);
    return length > 0 ? (vec3){a.x / length, a.y / length, a.z / length} : (vec3){0, 0, 0};
}

static double dot(vec3 a, vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static double degrees_between(vec3 a, vec3 b) {
    return acos(fmin(1, fmax(-1, dot(unit(a), unit(b))))) * 180 / PI;
}

static skein_world *flock_of(int count, double spread, double speed) {
    skein_world *world = new_world("symplectic_euler", 1);
    OK(world, skein_body_add(world, "flock", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", count),
                                            SKEIN_VEC3("spread", spread, spread, spread), SKEIN_REAL("speed", speed)),
                             NULL));
    return world;
}

/* ---- Whom a bird minds ---------------------------------------------------------------------------- */

/* Separation alone, so that each neighbour that counts pushes with r/distance - 1. */
static void assert_seen(int count, double spread, double view, int nearest) {
    enum { MOST = 2000 };
    static vec3 x[MOST], v[MOST];
    double reach = 50;
    skein_world *world = flock_of(count, spread, 1e-3);
    OK(world, skein_force_add(world, "flocking",
                              SKEIN_SETTINGS(SKEIN_REAL("separation", reach), SKEIN_REAL("alignment", 0),
                                             SKEIN_REAL("cohesion", 0), SKEIN_REAL("view", view),
                                             SKEIN_REAL("nearest", nearest)),
                              NULL));
    OK(world, skein_positions_copy(world, 0, (size_t)count, &x[0].x));
    OK(world, skein_velocities_copy(world, 0, (size_t)count, &v[0].x));
    steps(world, 1, dt);
    for (int i = 0; i < count; i += count / 100 + 1) {
        double best[65], weight = 0;
        int found = 0;
        for (int pass = 0; pass < 2; pass++) {
            vec3 ought = {0, 0, 0};
            for (int j = 0; j < count; j++) {
                vec3 d = minus(x[j], x[i]);
                double distance = length3(d);
                if (j == i || distance >= reach) continue;
                if (view < 360 && dot(d, unit(v[i])) < cos(view * PI / 360) * distance) continue;
                if (!pass && nearest) { // find out how far the last that counts is
                    int at = found < nearest ? found++ : nearest;
                    for (; at > 0 && best[at - 1] > distance; at--) best[at] = best[at - 1];
                    best[at] = distance;
                }
                if (!pass || (nearest && distance > best[found - 1])) continue;
                ought = plus(ought, -(reach / distance - 1), unit(d));
                weight += reach / distance;
            }
            if (!pass) continue;
            vec3 is = plus((vec3){0, 0, 0}, 1 / dt, minus(velocity_of(world, (size_t)i), v[i]));
            assert_under(length3(minus(is, ought)), 1e-5 * (1 + weight));
        }
    }
    skein_world_destroy(world);
}

static void birds_see_ahead_and_the_nearest(void **state) {
    (void)state;
    static const double views[] = {360, 270, 180, 90};
    for (size_t k = 0; k < COUNT(views); k++) assert_seen(500, 150, views[k], 0);
    assert_seen(500, 150, 360, 7);
    assert_seen(500, 150, 360, 1);
    assert_seen(500, 150, 200, 7);
    assert_seen(20, 90, 360, 64); // more than there are
    // so many in reach that lists are cut again and again
    assert_seen(2000, 70, 360, 7);
    assert_seen(2000, 70, 120, 20);
    assert_seen(2000, 70, 120, 0);
    // of those at the same distance the first few: as many as asked for, not more
    skein_world *ties = new_world("symplectic_euler", 1);
    for (int i = 0; i < 27; i++) add_particle(ties, 1, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    OK(ties, skein_force_add(ties, "flocking",
                             SKEIN_SETTINGS(SKEIN_REAL("separation", 4), SKEIN_REAL("alignment", 0),
                                            SKEIN_REAL("cohesion", 0), SKEIN_REAL("nearest", 5)),
                             NULL));
    steps(ties, 1, dt);
    assert_near(length3(velocity_of(ties, 13)) / dt, 3, 1e-5); // of six round it one is left out, and two pairs cancel
    skein_world_destroy(ties);
    // a bird that stands still sees all round
    skein_world *world = new_world("symplectic_euler", 1);
    add_particle(world, 1, 0, 0, 0), add_moving(world, 1, 3, 0, 0, 1, 0, 0), add_moving(world, 1, 0, 3, 0, 0, 1, 0);
    OK(world, skein_force_add(world, "flocking", SKEIN_SETTINGS(SKEIN_REAL("view", 10)), NULL));
    steps(world, 1, dt);
    assert_true(velocity_of(world, 0).x < -0.01 && velocity_of(world, 0).y < -0.01);
    assert_true(velocity_of(world, 1).y == 0 && velocity_of(world, 2).x == 0); // those fly away from it
    skein_world_destroy(world);
}

/* ---- Weights as formulas -------------------------------------------------------------------------- */

static uint64_t fly(const char *isa, const char *towards, const char *along, vec3 *v, size_t count, double nearest) {
    setenv("SKEIN_SIMD", isa, 1);
    skein_world *world = flock_of((int)count, 220, 1e-3);
    unsetenv("SKEIN_SIMD");
    OK(world,
       skein_force_add(world, "flocking",
                       SKEIN_SETTINGS(SKEIN_TEXT("formula.towards", towards), SKEIN_TEXT("formula.along", along),
                                      SKEIN_REAL("nearest", nearest), SKEIN_REAL("view", nearest > 0 ? 300 : 360)),
                       NULL));
    steps(world, 1, dt);
    OK(world, skein_velocities_copy(world, 0, count, &v[0].x));
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

/* The zones written as formulas give what the zones give; one of the two may be left out. */
static void weights_may_be_formulas(void **state) {
    (void)state;
    enum { COUNT_ = 600 };
    static vec3 plain[COUNT_], is[COUNT_], first[COUNT_], second[COUNT_], start[COUNT_];
    const char *
        towards = "select(relative_distance < 0.45, 1 - 0.45/relative_distance, select(relative_distance < 0.65, 0, "
                  "0.5*cos(2*pi*(relative_distance - 0.65)/0.35)))",
       *along =
           "let a = (relative_distance - 0.45)/0.2; select(relative_distance >= 0.45 && relative_distance < 0.65, 1 - 0.5*cos(2*pi*a), 0)";
    skein_world *world = flock_of(COUNT_, 220, 1e-3);
    OK(world, skein_velocities_copy(world, 0, COUNT_, &start[0].x));
    skein_world_destroy(world);
    for (int nearest = 0; nearest < 20; nearest += 9) {
        fly("sse", "", "", plain, COUNT_, nearest);
        uint64_t hash = fly("sse", towards, along, is, COUNT_, nearest);
        fly("sse", towards, "", first, COUNT_, nearest), fly("sse", "", along, second, COUNT_, nearest);
        for (int i = 0; i < COUNT_; i++) {
            vec3 ought = minus(plain[i], start[i]),
                 both = plus(minus(first[i], start[i]), 1, minus(second[i], start[i]));
            assert_under(length3(minus(minus(is[i], start[i]), ought)) / dt, 2e-4);
            assert_under(length3(minus(both, ought)) / dt, 2e-4);
        }
        assert_true(fly("avx2", towards, along, is, COUNT_, nearest) == hash);
        assert_true(fly("avx512", towards, along, is, COUNT_, nearest) == hash);
    }
    // by hand, with the time; what is not finite counts for nothing
    world = new_world("symplectic_euler", 1);
    add_particle(world, 1, 0, 0, 0), add_moving(world, 1, 0, 50, 0, 0, 0, 3);
    skein_handle rule;
    OK(world, skein_force_add(world, "flocking",
                              SKEIN_SETTINGS(SKEIN_TEXT("formula.towards", "3 - 2*relative_distance"),
                                             SKEIN_TEXT("formula.along", "100*t")),
                              &rule));
    steps(world, 1, 0.01);
    assert_near(velocity_of(world, 0).y, 0.02, 1e-7);
    assert_near(velocity_of(world, 0).z, 0.01, 1e-7); // t is the end of the substep
    OK(world, skein_set(world, rule, "formula.towards", skein_text("exp(1e3*relative_distance)^9")));
    OK(world, skein_set(world, rule, "formula.along", skein_text("")));
    vec3 v = velocity_of(world, 0);
    steps(world, 1, 0.01);
    assert_under(length3(minus(velocity_of(world, 0), v)), 0);
    // faults are told with the field and the place
    static const struct {
        const char *text, *words;
    } faults[] = {{"relative_distance +", "formula.towards"},
                  {"distance*2", "formula.towards"},
                  {"length(p0)", "depends on particles"},
                  {"vec3(1, 2, 3)", "formula.towards"}};
    for (size_t i = 0; i < COUNT(faults); i++) {
        skein_status status = skein_set(world, rule, "formula.towards", skein_text(faults[i].text));
        const skein_error *error = skein_world_error(world);
        assert_true(status && (strstr(error->message, faults[i].words) || strstr(error->where, faults[i].words)));
        steps(world, 1, 0.01); // with what was there before
    }
    OK(world, skein_set(world, rule, "formula.towards", skein_text("1")));
    steps(world, 1, 0.01);
    OK(world, skein_remove(world, rule));
    steps(world, 1, 0.01);
    skein_world_destroy(world);
}

/* ---- Limits --------------------------------------------------------------------------------------- */

static void turning_and_climbing_are_limited(void **state) {
    (void)state;
    skein_world *world = flock_of(300, 60, 5);
    OK(world, skein_force_add(world, "flocking", NULL, NULL)); // wild: all are in each other's first zone
    OK(world, skein_force_add(world, "turn_limit", SKEIN_SETTINGS(SKEIN_REAL("turn", 90)), NULL));
    bool turned = false;
    for (int s = 0; s < 30; s++) {
        vec3 before[300];
        OK(world, skein_velocities_copy(world, 0, 300, &before[0].x));
        steps(world, 1, dt);
        for (size_t i = 0; i < 300; i++) {
            double angle = degrees_between(before[i], velocity_of(world, i));
            assert_true(angle < 90 * dt * 1.01 + 0.1);
            turned |= angle > 90 * dt * 0.95;
        }
    }
    assert_true(turned);
    skein_world_destroy(world);

    // by hand: straight back means to the side first, and what turns less than the limit is left alone
    world = new_world("symplectic_euler", 1);
    add_moving(world, 1, 100, 0, 0, 2, 0, 0), add_moving(world, 1, 0, 0, 100, 2, 0, 0),
        add_moving(world, 1, 0, 100, 0, 0, 2, 0);
    OK(world, skein_force_add(world, "attraction", SKEIN_SETTINGS(SKEIN_REAL("strength", 10 * 64)), NULL));
    OK(world, skein_force_add(world, "turn_limit", SKEIN_SETTINGS(SKEIN_REAL("turn", 30 * 64)), NULL));
    steps(world, 1, dt);
    vec3 v = velocity_of(world, 0), side = velocity_of(world, 1), up = velocity_of(world, 2);
    assert_near(length3(v), 8, 1e-5);
    assert_near(v.x, 8 * cos(PI / 6), 1e-5);
    assert_near(v.y, 0, 1e-6);
    assert_near(side.x, sqrt(104) * cos(PI / 6), 1e-5); // toward -z, 30 degrees of 79
    assert_near(side.z, -sqrt(104) * sin(PI / 6), 1e-5);
    assert_near(up.y, 8 * cos(PI / 6), 1e-5);
    skein_world_destroy(world);

    world = new_world("symplectic_euler", 1);
    add_moving(world, 1, 0, 0, 0, 3, 4, 0), add_moving(world, 1, 9, 0, 0, 0, -5, 0),
        add_moving(world, 1, 0, 9, 0, 4, 1, 3);
    add_moving(world, 1, 0, 0, 9, 0, 3, -4);
    OK(world, skein_force_add(world, "turn_limit", SKEIN_SETTINGS(SKEIN_REAL("climb", 30)), NULL));
    steps(world, 1, dt);
    v = velocity_of(world, 0), side = velocity_of(world, 1), up = velocity_of(world, 2);
    assert_near(v.y, 2.5, 1e-6);
    assert_near(length3(v), 5, 1e-6);
    assert_near(side.y, -2.5, 1e-6);
    assert_near(length3(side), 5, 1e-6);
    assert_under(length3(minus(up, (vec3){4, 1, 3})), 0);
    assert_near(velocity_of(world, 3).y, 2.5, 1e-6);
    assert_near(velocity_of(world, 3).z, -5 * cos(PI / 6), 1e-6);
    skein_world_destroy(world);
}

/* ---- Bounds --------------------------------------------------------------------------------------- */

static void bounds_are_not_left_by_more_than_a_step(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (int kind = 0; kind < 3; kind++) {
            skein_world *world = flock_of(200, 12, 20);
            OK(world, skein_method_set(world, all_methods[m], SKEIN_SETTINGS(SKEIN_REAL("substeps", 2))));
            OK(world, skein_force_add(world, "flocking",
                                      SKEIN_SETTINGS(SKEIN_REAL("separation", 3), SKEIN_REAL("alignment", 2),
                                                     SKEIN_REAL("cohesion", 2)),
                                      NULL));
            OK(world, skein_force_add(world, "speed_limit", SKEIN_SETTINGS(SKEIN_REAL("limit", 20)), NULL));
            OK(world, skein_force_add(world, "bounds",
                                      SKEIN_SETTINGS(SKEIN_TEXT("shape", kind == 1 ? "sphere" : "box"),
                                                     SKEIN_TEXT("edge", kind == 2 ? "periodic" : "wall"),
                                                     SKEIN_VEC3("size", 20, 14, 16), SKEIN_VEC3("centre", 1, 0, 0),
                                                     SKEIN_REAL("radius", 12)),
                                      NULL));
            double step = 20 * dt, out = 0;
            bool wrapped = false;
            vec3 before[200];
            for (int s = 0; s < 100; s++) {
                OK(world, skein_positions_copy(world, 0, 200, &before[0].x));
                steps(world, 1, dt);
                for (size_t i = 0; i < 200; i++) {
                    vec3 x = minus(position_of(world, i), (vec3){1, 0, 0});
                    double beyond =
                        kind == 1 ? length3(x) - 12 : fmax(fmax(fabs(x.x) - 10, fabs(x.y) - 7), fabs(x.z) - 8);
                    out = fmax(out, beyond);
                    wrapped |= length3(minus(position_of(world, i), before[i])) > 10;
                    assert_true(length3(velocity_of(world, i)) < 20.001);
                    // nothing shoots across the picture between two steps
                    double blended[3];
                    OK(world, skein_positions_blend(world, 0, i, 1, blended));
                    assert_true(length3(minus((vec3){blended[0], blended[1], blended[2]}, position_of(world, i))) <
                                1.01 * step);
                }
            }
            assert_true(out < 1.001 * step);
            assert_true(wrapped == (kind == 2));
            skein_world_destroy(world);
        }
    // a mirror
    skein_world *world = new_world("symplectic_euler", 1);
    add_moving(world, 1, 0, 4.999, 0, 2, 3, 4), add_moving(world, 1, 0, 4, 0, 2, 3, 4);
    add_moving(world, 1, 0, 7, 0, 2, -3, 4);
    OK(world,
       skein_force_add(world, "bounds", SKEIN_SETTINGS(SKEIN_TEXT("shape", "sphere"), SKEIN_REAL("radius", 5)), NULL));
    steps(world, 1, 1e-3);
    assert_under(length3(minus(velocity_of(world, 0), (vec3){2, -3, 4})), 1e-2);
    assert_share(length3(velocity_of(world, 0)), sqrt(29), 1e-6);
    assert_under(length3(minus(velocity_of(world, 1), (vec3){2, 3, 4})), 0);
    assert_under(length3(minus(velocity_of(world, 2), (vec3){2, -3, 4})), 0); // outside, and on its way in
    skein_world_destroy(world);
    world = flock_of(3, 1, 1);
    OK(world, skein_force_add(world, "bounds",
                              SKEIN_SETTINGS(SKEIN_TEXT("shape", "sphere"), SKEIN_TEXT("edge", "periodic")), NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "no other side", skein_world_step(world, dt));
    skein_world_destroy(world);
}

/* ---- Obstacles ------------------------------------------------------------------------------------ */

/* Birds fly at a ball, a box and a floor; how often one touches them comes back. */
static size_t touches_of_flight(const char *method, bool looks) {
    skein_world *world = new_world(method, 1);
    for (int i = 0; i < 64; i++) add_moving(world, 1, -20, 0.37 * (i % 8) - 1.3, 0.37 * (i / 8) - 1.3, 8, 0, 0);
    for (int i = 0; i < 16; i++) add_moving(world, 1, 4 * i - 30, 10, 1, 3, -7, 0);
    for (int i = 0; i < 16; i++) add_moving(world, 1, 30, 0.2 * i, 0, -8, 0, 0);
    OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 2), SKEIN_REAL("thickness", 0.2)),
                                 NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -5), SKEIN_REAL("thickness", 0.2)),
                                 NULL));
    OK(world, skein_collider_add(world, "box",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 15, 0, 0), SKEIN_VEC3("size", 2, 6, 6),
                                                SKEIN_REAL("thickness", 0.2)),
                                 NULL));
    if (looks)
        OK(world,
           skein_force_add(world, "lookout", SKEIN_SETTINGS(SKEIN_REAL("ahead", 1), SKEIN_REAL("clearance", 1)), NULL));
    OK(world, skein_force_add(world, "speed_limit", NULL, NULL));
    size_t touches = 0;
    for (int s = 0; s < 5 * 64; s++) {
        steps(world, 1, dt);
        touches += statistics_of(world).contacts;
    }
    skein_world_destroy(world);
    return touches;
}

static void obstacles_are_looked_ahead_for(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        assert_true(touches_of_flight(method_names[m], false) > 50);
        assert_true(touches_of_flight(method_names[m], true) == 0);
    }
}

/* ---- Birds and cloth ------------------------------------------------------------------------------ */

/* A flag hangs in the way of a flock that minds it: no bird comes near; and it feels them go by, if it minds them. */
static void birds_and_cloth_mind_each_other(void **state) {
    (void)state;
    static const char *const methods[] = {"symplectic_euler", "xpbd"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        double nearest[2], moved[2];
        for (int neighbours = 0; neighbours < 2; neighbours++) {
            skein_world *world = new_world(methods[m], 10);
            OK(world, skein_body_add(
                          world, "cloth", NULL,
                          SKEIN_SETTINGS(SKEIN_TEXT("name", "flag"), SKEIN_PAIR("grid", 9, 9), SKEIN_PAIR("size", 4, 4),
                                         SKEIN_VEC3("rotation", 90, 0, 0), SKEIN_TEXT("pins", "top edge"),
                                         SKEIN_REAL("stretch.stiffness", 200), SKEIN_REAL("shear.stiffness", 20),
                                         SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 1)),
                          NULL));
            size_t cloth = skein_particle_count(world);
            OK(world, skein_body_add(world, "flock", NULL,
                                     SKEIN_SETTINGS(SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", 50),
                                                    SKEIN_VEC3("position", 0, 0, 12), SKEIN_VEC3("spread", 4, 4, 4),
                                                    SKEIN_REAL("speed", 0), SKEIN_VEC3("velocity", 0, 0, -6)),
                                     NULL));
            if (neighbours) {
                OK(world, skein_force_add(world, "flocking",
                                          SKEIN_SETTINGS(SKEIN_TEXT("on", "birds"), SKEIN_TEXT("neighbours", "flag"),
                                                         SKEIN_REAL("separation", 2), SKEIN_REAL("alignment", 0),
                                                         SKEIN_REAL("cohesion", 0), SKEIN_REAL("strength", 10)),
                                          NULL));
                OK(world, skein_force_add(world, "flocking",
                                          SKEIN_SETTINGS(SKEIN_TEXT("on", "flag"), SKEIN_TEXT("neighbours", "birds"),
                                                         SKEIN_REAL("separation", 3), SKEIN_REAL("alignment", 0),
                                                         SKEIN_REAL("cohesion", 0), SKEIN_REAL("strength", 0.5)),
                                          NULL));
            }
            OK(world, skein_force_add(world, "speed_limit", SKEIN_SETTINGS(SKEIN_TEXT("on", "birds")), NULL));
            nearest[neighbours] = INFINITY, moved[neighbours] = 0;
            for (int s = 0; s < 240; s++) {
                steps(world, 1, dt);
                for (size_t c = 0; c < cloth; c++) {
                    moved[neighbours] = fmax(moved[neighbours], fabs(position_of(world, c).z));
                    for (size_t b = cloth; b < cloth + 50; b += 7)
                        nearest[neighbours] =
                            fmin(nearest[neighbours], length3(minus(position_of(world, c), position_of(world, b))));
                }
            }
            assert_int_equal(statistics_of(world).nonfinite, 0);
            skein_world_destroy(world);
        }
        assert_true(nearest[0] < 0.3 && nearest[1] > 0.5);
        assert_true(moved[0] < 1e-3 && moved[1] > 0.02);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(birds_see_ahead_and_the_nearest),  cmocka_unit_test(weights_may_be_formulas),
        cmocka_unit_test(turning_and_climbing_are_limited), cmocka_unit_test(bounds_are_not_left_by_more_than_a_step),
        cmocka_unit_test(obstacles_are_looked_ahead_for),   cmocka_unit_test(birds_and_cloth_mind_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
