/* The rules of a flock: each alone by hand, all of them against a loop over all pairs, and what happens at the
 * extremes. Its order parameters are in test_flock_order.c. */
#include "all_methods.h"
#include "helpers.h"

/* What Skein's flocks owe: the formulas, in double, as plainly as they can be written. */
typedef struct zones {
    double separation, alignment, cohesion;
    bool squared;
} zones;

static const zones usual = {45, 20, 35, false}, usual_squared = {45, 20, 35, true};

static vec3 plus(vec3 a, double s, vec3 b) {
    return (vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static vec3 unit(vec3 a) {
    double length = length3(a);
    return length > 0 ? (vec3){a.x / length, a.y / length, a.z / length} : (vec3){0, 0, 0};
}

/* What a neighbour at d, flying with v, adds in units of dt; its weight goes to `sum`. */
static vec3 part_of(const zones *z, vec3 d, vec3 v, double *sum) {
    double r = z->separation + z->alignment + z->cohesion, distance = length3(d);
    if (!(distance > 0) || !(distance < r)) return (vec3){0, 0, 0};
    double relative_distance = distance / r, near = z->separation / r, along = (z->separation + z->alignment) / r;
    if (z->squared) relative_distance *= relative_distance;
    if (relative_distance < near) {
        *sum += near / relative_distance - 1;
        return plus((vec3){0, 0, 0}, -(near / relative_distance - 1), unit(d));
    }
    if (relative_distance < along) {
        double a = (relative_distance - near) / (along - near);
        *sum += 1.5;
        return plus((vec3){0, 0, 0}, 0.5 - cos(a * 2 * PI) * 0.5 + 0.5, unit(v));
    }
    double a = (relative_distance - along) / (1 - along);
    *sum += 0.5;
    return plus((vec3){0, 0, 0}, 0.5 - (cos(a * 2 * PI) * -0.5 + 0.5), unit(d));
}

static const double dt = 1.0 / 64;

static void add_flocking(skein_world *world, const zones *z) {
    OK(world, skein_force_add(world, "flocking",
                              SKEIN_SETTINGS(SKEIN_REAL("separation", z->separation),
                                             SKEIN_REAL("alignment", z->alignment), SKEIN_REAL("cohesion", z->cohesion),
                                             SKEIN_TEXT("measure", z->squared ? "distance^2" : "distance")),
                              NULL));
}

/* ---- Each rule alone ----------------------------------------------------------------------------- */

/* A bird at rest at the origin and one at `distance` along z that flies along x: what the first one gets in dt. */
static vec3 change_of_two(const zones *z, double distance, double flies) {
    skein_world *world = new_world("symplectic_euler", 1);
    add_particle(world, 1, 0, 0, 0);
    add_moving(world, 1, 0, 0, distance, flies, 0, 0);
    add_flocking(world, z);
    steps(world, 1, dt);
    vec3 v = velocity_of(world, 0), x = position_of(world, 0);
    assert_near(x.z, v.z * dt, 1e-9); // x += v dt, with the new v
    assert_near(v.y, 0, 0);
    skein_world_destroy(world);
    return (vec3){v.x / dt, v.y / dt, v.z / dt};
}

static void each_zone_by_hand(void **state) {
    (void)state;
    static const struct {
        double relative_distance, along, towards;
    } cases[] = {{0.225, 0, -1}, {0.1, 0, -3.5},   {0.45, 0.5, 0}, {0.55, 1.5, 0}, {0.5, 1, 0}, {0.65, 0, 0.5},
                 {0.7375, 0, 0}, {0.825, 0, -0.5}, {0.9125, 0, 0}, {1, 0, 0},      {1.2, 0, 0}};
    for (int squared = 0; squared < 2; squared++)
        for (size_t i = 0; i < COUNT(cases); i++) {
            double share = squared ? sqrt(cases[i].relative_distance) : cases[i].relative_distance;
            // squares cannot be right on the edge of a zone
            bool edge =
                squared && (cases[i].along == 0.5 || cases[i].towards == 0.5 || cases[i].relative_distance == 1);
            vec3 c = change_of_two(squared ? &usual_squared : &usual, 100 * share * (edge ? 1.0000002 : 1), 3);
            assert_near(c.x, cases[i].along, 1e-6 + (edge ? 1e-5 : 0));
            assert_near(c.z, cases[i].towards, 1e-6 + (edge ? 1e-5 : 0) + 20 * EPSILON);
        }
}

/* The speed of the neighbour is nothing, its direction all; one at rest has none. */
static void only_the_direction_of_flight_counts(void **state) {
    (void)state;
    assert_near(change_of_two(&usual, 55, 0.001).x, 1.5, 1e-6);
    assert_near(change_of_two(&usual, 55, -4000).x, -1.5, 1e-6);
    assert_near(length3(change_of_two(&usual, 55, 0)), 0, 0);
}

static void attraction_by_hand(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    add_particle(world, 2, 3, 0, 0), add_particle(world, 2, 0, 4, 0), add_particle(world, 2, 1, -2, 2),
        add_particle(world, 1, 1, 1, 1);
    add_particle(world, 0, 5, 5, 5);
    OK(world, skein_force_add(world, "attraction",
                              SKEIN_SETTINGS(SKEIN_REAL("strength", 5), SKEIN_VEC3("centre", 1, 1, 1)), NULL));
    steps(world, 1, dt);
    static const double from[][3] = {{3, 0, 0}, {0, 4, 0}, {1, -2, 2}};
    for (size_t i = 0; i < COUNT(from); i++) {
        vec3 d = unit((vec3){1 - from[i][0], 2.5 * (1 - from[i][1]), 1 - from[i][2]}), v = velocity_of(world, i);
        assert_near(length3(plus(v, -5 * dt, d)) / dt, 0, 1e-6 * 5);
    }
    assert_under(length3(velocity_of(world, 3)), 0); // right there, there is no way
    assert_under(length3(velocity_of(world, 4)), 0); // held
    skein_world_destroy(world);
}

/* The pointer acts at any depth along the line of sight, a particle in a ball round itself. */
static void predator_by_hand(void **state) {
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        skein_world *world = new_world("symplectic_euler", 1);
        double depth = kind ? 0 : 1e4;
        add_particle(world, 1, 50, 0, depth), add_moving(world, 1, 0, -99, -depth, 20, 0, 0),
            add_moving(world, 1, 0, 101, 0, 20, 0, 0);
        add_moving(world, 1, 0, 0, kind ? 0 : 7, 20, 0, 0);
        OK(world, kind ? skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("particle", 3)), NULL)
                       : skein_force_add(world, "predator",
                                         SKEIN_SETTINGS(SKEIN_VEC3("line", 0, 0, -3), SKEIN_VEC3("position", 0, 0, 55)),
                                         NULL));
        OK(world, skein_force_add(world, "speed_limit", NULL, NULL));
        steps(world, 1, dt);
        assert_near(velocity_of(world, 0).x / dt, 75, 1e-6 * 75); // (0.25 - 1) 100, along predator - bird
        vec3 v = velocity_of(world, 1);
        assert_near(v.y / v.x, (1 - 0.99 * 0.99) * -100 * dt / 20, 1e-6);
        assert_near(length3(v), 14, 1e-5);                                // near: 9 + 5
        assert_near(length3(velocity_of(world, 2)), 9, 1e-5);             // not near
        assert_near(length3(velocity_of(world, 3)), kind ? 9 : 14, 1e-5); // itself, or right under the pointer
        skein_world_destroy(world);
    }
}

/* 40 m beside the line, whatever its direction and however far along. */
static void a_line_of_sight_may_lie_askew(void **state) {
    (void)state;
    const vec3 along = {2 / 7.0, 3 / 7.0, 6 / 7.0}, beside = unit((vec3){3, -2, 0});
    skein_world *world = new_world("symplectic_euler", 1);
    for (int i = -1; i <= 1; i++) {
        vec3 at = plus(plus((vec3){5, 6, 7}, 300 * i, along), 40, beside);
        add_particle(world, 1, at.x, at.y, at.z);
    }
    OK(world, skein_force_add(world, "predator",
                              SKEIN_SETTINGS(SKEIN_VEC3("line", 4, 6, 12), SKEIN_VEC3("position", 5, 6, 7)), NULL));
    steps(world, 1, dt);
    for (size_t i = 0; i < 3; i++) // (1 - 0.4^2) 100 m/s2, away
        assert_under(length3(plus(velocity_of(world, i), -84 * dt, beside)), 1e-3 * 84 * dt);
    skein_world_destroy(world);
}

/* What scares so much that the limit would be under 0 stops them; it does not turn them round. */
static void an_alarm_may_lower_the_limit(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    add_moving(world, 1, 1, 0, 0, 0, 5, 0);
    skein_handle hawk;
    OK(world,
       skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("strength", 0), SKEIN_REAL("alarm", -6)), &hawk));
    OK(world, skein_force_add(world, "speed_limit", NULL, NULL));
    steps(world, 1, dt);
    assert_near(velocity_of(world, 0).y, 3, 1e-5); // 9 - 6
    OK(world, skein_set(world, hawk, "alarm", skein_number(-20)));
    steps(world, 1, dt);
    assert_under(length3(velocity_of(world, 0)), 0);
    skein_world_destroy(world);
}

/* The limit is for one step only, and what is slower is left alone. */
/* All flee from where it is when the substep begins, however many there are before and behind it. */
static void a_predator_may_be_one_of_many(void **state) {
    (void)state;
    enum { MANY = 1000, HAWK = 555 };
    static double v[2][3 * MANY];
    for (int w = 0; w < 2; w++) {
        skein_world *world = new_world("symplectic_euler", 1);
        OK(world, skein_body_add(world, "flock", NULL,
                                 SKEIN_SETTINGS(SKEIN_REAL("count", MANY), SKEIN_REAL("speed", 500)), NULL));
        vec3 at = position_of(world, HAWK);
        OK(world, skein_force_add(world, "predator",
                                  w ? SKEIN_SETTINGS(SKEIN_REAL("particle", HAWK))
                                    : SKEIN_SETTINGS(SKEIN_VEC3("position", at.x, at.y, at.z)),
                                  NULL));
        steps(world, 1, dt);
        OK(world, skein_velocities_copy(world, 0, MANY, v[w]));
        skein_world_destroy(world);
    }
    for (int i = 0; i < 3 * MANY; i++) assert_true(v[0][i] == v[1][i]);
}

static void the_limit_is_raised_in_this_step_only(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    add_moving(world, 1, 1, 0, 0, 0, 30, 0), add_moving(world, 1, 0, 0, 500, 3, 4, 0);
    skein_handle hawk;
    OK(world, skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("strength", 0)), &hawk));
    OK(world, skein_force_add(world, "speed_limit", NULL, NULL));
    steps(world, 1, dt);
    assert_near(length3(velocity_of(world, 0)), 14, 1e-5);
    assert_near(length3(velocity_of(world, 1)), 5, 0);
    OK(world, skein_set(world, hawk, "enabled", skein_number(0)));
    steps(world, 1, dt);
    assert_near(length3(velocity_of(world, 0)), 9, 1e-5);
    skein_world_destroy(world);
}

/* ---- Grid against all pairs ----------------------------------------------------------------------- */

static void assert_flock_is_that_of_all_pairs(size_t count, double spread, const zones *z, size_t stride) {
    skein_world *world = new_world("symplectic_euler", 1);
    OK(world, skein_body_add(world, "flock", NULL,
                             SKEIN_SETTINGS(SKEIN_REAL("count", (double)count),
                                            SKEIN_VEC3("spread", spread, spread / 2, spread), SKEIN_REAL("speed", 1e-3)),
                             NULL));
    add_flocking(world, z);
    vec3 *x = calloc(count, sizeof *x), *v = calloc(count, sizeof *v);
    OK(world, skein_positions_copy(world, 0, count, &x[0].x));
    OK(world, skein_velocities_copy(world, 0, count, &v[0].x));
    steps(world, 1, dt);
    double off = 0, all = 0;
    for (size_t i = 0; i < count; i += stride) {
        vec3 ought = {0, 0, 0};
        double weight = 0;
        for (size_t j = 0; j < count; j++) ought = plus(ought, 1, part_of(z, minus(x[j], x[i]), v[j], &weight));
        vec3 is = plus((vec3){0, 0, 0}, 1 / dt, minus(velocity_of(world, i), v[i]));
        double error = length3(minus(is, ought));
        assert_under(error, 1e-5 * (1 + weight));
        off += error * error, all += length3(ought) * length3(ought);
    }
    assert_under(sqrt(off), 1e-5 * sqrt(all));
    free(x), free(v);
    skein_world_destroy(world);
}

static void the_grid_is_all_pairs(void **state) {
    (void)state;
    // about 30 neighbours each, at sizes from 1,024 on
    assert_flock_is_that_of_all_pairs(1024, 660, &usual, 1);
    assert_flock_is_that_of_all_pairs(4096, 1046, &usual_squared, 4);
    assert_flock_is_that_of_all_pairs(16384, 1661, &usual, 32);
    // gathered, so that lists of neighbours are longer than what is kept at once; scattered; all in reach
    assert_flock_is_that_of_all_pairs(3000, 250, &usual, 16);
    assert_flock_is_that_of_all_pairs(1024, 30000, &usual, 1);
    assert_flock_is_that_of_all_pairs(500, 50, &usual_squared, 1);
    // zones that are missing
    assert_flock_is_that_of_all_pairs(1024, 400, &(zones){45, 0, 35, false}, 4);
    assert_flock_is_that_of_all_pairs(1024, 400, &(zones){0, 20, 35, false}, 4);
    assert_flock_is_that_of_all_pairs(1024, 400, &(zones){45, 20, 0, true}, 4);
    assert_flock_is_that_of_all_pairs(1024, 400, &(zones){0, 60, 0, false}, 4);
    assert_flock_is_that_of_all_pairs(1024, 400, &(zones){0, 0, 60, false}, 4);
    assert_flock_is_that_of_all_pairs(1024, 400, &(zones){60, 0, 0, true}, 4);
}

/* ---- Bodies and methods --------------------------------------------------------------------------- */

/* Two flocks in one world: a rule moves the body it names, and looks at the one it minds. */
static void flocks_mind_whom_they_are_told_to(void **state) {
    (void)state;
    static const char *const on[] = {"", "a", "a", "b"}, *const neighbours[] = {"", "", "b", "a"};
    for (size_t c = 0; c < COUNT(on); c++) {
        skein_world *world = new_world("symplectic_euler", 1);
        // a cloth in strips before them, so that slots are not the user's order
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 50), SKEIN_VEC3("position", 1e4, 0, 0)), NULL));
        uint32_t first = (uint32_t)skein_particle_count(world);
        for (int k = 0; k < 2; k++)
            OK(world, skein_body_add(world, "flock", NULL,
                                     SKEIN_SETTINGS(SKEIN_TEXT("name", k ? "b" : "a"), SKEIN_REAL("count", 37),
                                                    SKEIN_REAL("seed", k), SKEIN_REAL("speed", 1e-3),
                                                    SKEIN_VEC3("spread", 150, 150, 150)),
                                     NULL));
        OK(world,
           skein_force_add(world, "flocking",
                           SKEIN_SETTINGS(SKEIN_TEXT("on", on[c]), SKEIN_TEXT("neighbours", neighbours[c])), NULL));
        if (c)
            OK(world, skein_force_add(world, "attraction",
                                      SKEIN_SETTINGS(SKEIN_TEXT("on", on[c]), SKEIN_REAL("strength", 7)), NULL));
        vec3 x[74], v[74];
        OK(world, skein_positions_copy(world, first, 74, &x[0].x));
        OK(world, skein_velocities_copy(world, first, 74, &v[0].x));
        steps(world, 1, dt);
        for (size_t i = 0; i < 74; i++) {
            const char *own = i < 37 ? "a" : "b";
            bool moved = !on[c][0] || !strcmp(on[c], own);
            vec3 ought = {0, 0, 0};
            double weight = 0;
            for (size_t j = 0; j < 74 && moved; j++) {
                const char *whom = neighbours[c][0] ? neighbours[c] : on[c];
                if (whom[0] && strcmp(whom, j < 37 ? "a" : "b")) continue;
                ought = plus(ought, 1, part_of(&usual, minus(x[j], x[i]), v[j], &weight));
            }
            if (moved && c) ought = plus(ought, 7, unit((vec3){-x[i].x, -2.5 * x[i].y, -x[i].z}));
            vec3 is = plus((vec3){0, 0, 0}, 1 / dt, minus(velocity_of(world, first + i), v[i]));
            assert_under(length3(minus(is, ought)), 1e-5 * (7 + weight));
        }
        skein_world_destroy(world);
    }
}

/* Once a substep under every method: with no other force all of them do the same. */
static void every_method_flies_a_flock(void **state) {
    (void)state;
    vec3 first[200];
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 3);
        OK(world, skein_body_add(world, "flock", NULL,
                                 SKEIN_SETTINGS(SKEIN_REAL("count", 200), SKEIN_VEC3("spread", 200, 90, 200)), NULL));
        add_flocking(world, &usual);
        OK(world, skein_force_add(world, "attraction", NULL, NULL));
        OK(world, skein_force_add(world, "predator", NULL, NULL));
        OK(world, skein_force_add(world, "speed_limit", NULL, NULL));
        steps(world, 20, 1.0 / 30);
        vec3 x[200];
        OK(world, skein_positions_copy(world, 0, 200, &x[0].x));
        if (m == 0) memcpy(first, x, sizeof x);
        for (int i = 0; i < 200; i++) {
            assert_under(length3(minus(x[i], first[i])), 2e-2); // a flock is chaotic: roundings grow
            assert_true(length3(velocity_of(world, (size_t)i)) < 14.001);
        }
        skein_world_destroy(world);
    }
}

/* Gravity pulls, and still nobody is faster than the limit: when a method drifts, or at the end of its substep. */
static void the_limit_holds_against_forces(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 2);
        add_moving(world, 1, 0, 0, 0, 1, 0, 0);
        add_gravity(world);
        OK(world, skein_force_add(world, "speed_limit", SKEIN_SETTINGS(SKEIN_REAL("limit", 2)), NULL));
        steps(world, 60, 1.0 / 60);
        assert_near(length3(velocity_of(world, 0)), 2, 1e-3);
        assert_true(position_of(world, 0).y > -2.05 && position_of(world, 0).y < -1.5);
        skein_world_destroy(world);
    }
}

/* ---- Extremes ------------------------------------------------------------------------------------- */

static void assert_all_finite(skein_world *world) {
    skein_statistics s = statistics_of(world);
    assert_int_equal(s.nonfinite, 0);
}

static void extremes_are_safe(void **state) {
    (void)state;
    for (int squared = 0; squared < 2; squared++)
        for (int c = 0; c < 5; c++) {
            skein_world *world = new_world("symplectic_euler", 1);
            static const double spreads[] = {0, 1e-12, 1e-3, 1e6, 1e9};
            OK(world, skein_body_add(world, "flock", NULL,
                                     SKEIN_SETTINGS(SKEIN_REAL("side", 32), SKEIN_REAL("speed", c % 2 ? 5 : 0),
                                                    SKEIN_VEC3("spread", spreads[c], spreads[c], spreads[c])),
                                     NULL));
            assert_int_equal(skein_particle_count(world), 1024);
            add_flocking(world, squared ? &usual_squared : &usual);
            OK(world, skein_force_add(world, "attraction", NULL, NULL));
            OK(world, skein_force_add(world, "predator", NULL, NULL));
            OK(world, skein_force_add(world, "speed_limit", NULL, NULL));
            steps(world, 3, dt);
            assert_all_finite(world);
            for (size_t i = 0; i < 1024; i++) assert_true(length3(velocity_of(world, i)) < 14.001);
            skein_world_destroy(world);
        }
    // no zones: no neighbours, and the birds fly on
    skein_world *world = new_world("xpbd", 1);
    OK(world, skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 5)), NULL));
    add_flocking(world, &(zones){0, 0, 0, false});
    vec3 v = velocity_of(world, 3);
    steps(world, 3, dt);
    assert_under(length3(minus(velocity_of(world, 3), v)), 0);
    // a negative distance is refused, and says so
    FAILS(world, SKEIN_ERROR_VALUE, "separation",
          skein_force_add(world, "flocking", SKEIN_SETTINGS(SKEIN_REAL("separation", -1)), NULL));
    skein_world_destroy(world);
}

static void faults_are_named(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    OK(world,
       skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_TEXT("name", "gulls"), SKEIN_REAL("count", 9)), NULL));
    skein_handle rule;
    OK(world, skein_force_add(world, "flocking", SKEIN_SETTINGS(SKEIN_TEXT("on", "guls")), &rule));
    FAILS(world, SKEIN_ERROR_NAME, "guls", skein_world_step(world, dt));
    OK(world, skein_set(world, rule, "on", skein_text("gulls")));
    OK(world, skein_set(world, rule, "neighbours", skein_text("hawks")));
    FAILS(world, SKEIN_ERROR_NAME, "hawks", skein_world_step(world, dt));
    OK(world, skein_set(world, rule, "neighbours", skein_text("")));
    OK(world, skein_world_step(world, dt));
    OK(world, skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("particle", 9)), &rule));
    FAILS(world, SKEIN_ERROR_VALUE, "no particle 9", skein_world_step(world, dt));
    OK(world, skein_set(world, rule, "particle", skein_number(8)));
    OK(world, skein_world_step(world, dt));
    skein_mesh mesh = {0};
    FAILS(world, SKEIN_ERROR_VALUE, "mesh", skein_body_add(world, "flock", &mesh, NULL, NULL));
    // a bird that got lost is nobody's neighbour, and harms no one
    OK(world, skein_velocities_set(world, 4, 1, (const double[]){1e15, 0, 0}));
    steps(world, 2, 1e6);
    skein_world_destroy(world);
}

/* ---- The same bits -------------------------------------------------------------------------------- */

static uint64_t hash_of(const char *isa, int threads) {
    setenv("SKEIN_SIMD", isa, 1);
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    unsetenv("SKEIN_SIMD");
    OK(world, skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
    OK(world, skein_body_add(world, "flock", NULL,
                             SKEIN_SETTINGS(SKEIN_REAL("count", 9001), SKEIN_VEC3("spread", 700, 300, 900)), NULL));
    add_flocking(world, &usual);
    OK(world, skein_force_add(world, "attraction", NULL, NULL));
    OK(world, skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_VEC3("line", 1, 2, 3)), NULL));
    OK(world, skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("particle", 4000)), NULL));
    OK(world, skein_force_add(world, "speed_limit", NULL, NULL));
    steps(world, 5, dt);
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

static void the_bits_are_the_same_for_any_width_and_threads(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    static const char *const isas[] = {"sse", "avx2", "avx512"};
    uint64_t one = hash_of("sse", 1);
    for (size_t i = 0; i < COUNT(isas); i++)
        for (int threads = 1; threads <= 3; threads++) assert_true(hash_of(isas[i], threads) == one);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_zone_by_hand),
        cmocka_unit_test(only_the_direction_of_flight_counts),
        cmocka_unit_test(attraction_by_hand),
        cmocka_unit_test(predator_by_hand),
        cmocka_unit_test(a_line_of_sight_may_lie_askew),
        cmocka_unit_test(an_alarm_may_lower_the_limit),
        cmocka_unit_test(a_predator_may_be_one_of_many),
        cmocka_unit_test(the_limit_is_raised_in_this_step_only),
        cmocka_unit_test(the_grid_is_all_pairs),
        cmocka_unit_test(flocks_mind_whom_they_are_told_to),
        cmocka_unit_test(every_method_flies_a_flock),
        cmocka_unit_test(the_limit_holds_against_forces),
        cmocka_unit_test(extremes_are_safe),
        cmocka_unit_test(faults_are_named),
        cmocka_unit_test(the_bits_are_the_same_for_any_width_and_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
