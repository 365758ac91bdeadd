/* A failed allocation is an ordinary failure: whichever one fails, the call says so, nothing leaks, and the world
 * goes on as if the call had not been made. */
#include "purse.h"

static const double dt = 1.0 / 90;

/* The calls of the scenario, each to be made again after a failure. */
typedef struct scenario {
    skein_world *world;
    skein_handle gravity, ground, surface;
    skein_statistics statistics;
    skein_order order;
    double diagonal[1024];
    int call;
} scenario;

/* A sparse solver that takes a matrix for its diagonal. */
static skein_status analyse(void *user, const skein_sparse_matrix *pattern, skein_error *error) {
    (void)user, (void)error;
    assert_in_range(pattern->size, 1, COUNT(((scenario *)user)->diagonal));
    return SKEIN_OK;
}
static bool factor(void *user, const skein_sparse_matrix *matrix) {
    for (size_t i = 0; i < matrix->size; i++) ((scenario *)user)->diagonal[i] = matrix->value[matrix->start[i]];
    return true;
}
static bool solve(void *user, const double *b, double *x) {
    const scenario *s = user;
    for (size_t i = 0; i < 3 * skein_particle_count(s->world); i++) x[i] = b[i] / s->diagonal[i];
    return true;
}

static const double cube[8][3] = {{2, 1, 0}, {3, 1, 0}, {3, 2, 0}, {2, 2, 0},
                                  {2, 1, 1}, {3, 1, 1}, {3, 2, 1}, {2, 2, 1}};
static const uint32_t cube_sizes[6] = {4, 4, 4, 4, 4, 3};
static const uint32_t cube_corners[23] = {0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 2, 3, 7, 6, 0, 4, 7, 3, 1, 2, 6};

static skein_status make_call(scenario *s) {
    const skein_mesh mesh = {cube[0], 8, cube_sizes, 6, cube_corners, 23};
    switch (s->call) {
    case 0: return skein_method_set(s->world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 5)));
    case 1:
        return skein_body_add(s->world, "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_TEXT("name", "sheet"), SKEIN_PAIR("grid", 6, 5),
                                             SKEIN_VEC3("position", 0, 1, 0),
                                             SKEIN_TEXT("pins", "top corners, 7, box -1 0 -1 -0.45 2 -0.4"),
                                             SKEIN_REAL("stretch.stiffness", 100)),
                              NULL);
    case 2:
        return skein_body_add(s->world, "cloth", &mesh,
                              SKEIN_SETTINGS(SKEIN_REAL("weld", 1e-6), SKEIN_TEXT("pins", "corners"),
                                             SKEIN_REAL("stretch.stiffness", 100)),
                              NULL);
    case 3:
        return skein_body_add(s->world, "lattice", NULL,
                              SKEIN_SETTINGS(SKEIN_VEC3("grid", 3, 3, 2), SKEIN_TEXT("pins", "left face, 17"),
                                             SKEIN_VEC3("position", 4, 2, 0)),
                              NULL);
    case 4:
        return skein_body_add(s->world, "rope", NULL,
                              SKEIN_SETTINGS(SKEIN_REAL("count", 5), SKEIN_VEC3("from", -2, 2, 0),
                                             SKEIN_VEC3("to", -3, 2, 0), SKEIN_REAL("length", 1.5),
                                             SKEIN_TEXT("pins", "first, last"), SKEIN_REAL("stretch.stiffness", 10)),
                              NULL);
    case 5: return skein_force_add(s->world, "gravity", SKEIN_SETTINGS(SKEIN_TEXT("name", "down")), &s->gravity);
    case 6:
        return skein_force_add(s->world, "separation",
                               SKEIN_SETTINGS(SKEIN_REAL("radius", 0.2), SKEIN_REAL("strength", 0.001)), NULL);
    case 7: return skein_force_add(s->world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 1, 0, 1)), NULL);
    case 8:
        return skein_collider_add(s->world, "sphere",
                                  SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.8, 0), SKEIN_REAL("radius", 0.15)), NULL);
    case 9: return skein_collider_add(s->world, "plane", NULL, &s->ground);
    case 10:
        return skein_collider_add(
            s->world, "formula",
            SKEIN_SETTINGS(SKEIN_TEXT("surface", "length(p - vec3(0, h, 0)) - 0.15"), SKEIN_REAL("parameters.h", 0.8)),
            &s->surface);
    case 11:
        return skein_force_add(s->world, "force_field",
                               SKEIN_SETTINGS(SKEIN_TEXT("force", "-k*v"), SKEIN_REAL("parameters.k", 0.1)), NULL);
    case 12: return skein_force_add(s->world, "potential", SKEIN_SETTINGS(SKEIN_TEXT("energy", "sin(p.x - t)")), NULL);
    case 13: return skein_set(s->world, s->surface, "surface", skein_text("length(p - vec3(0, h, 0)) - 0.2"));
    case 14: {
        static const double positions[3 * 90] = {0, 3, 0, 1, 3, 0};
        double masses[90];
        for (int i = 0; i < 90; i++) masses[i] = 0.1;
        return skein_particles_add(s->world, 90, positions, NULL, masses, NULL);
    }
    case 15:
        return skein_constraint_add(s->world, "distance", (const uint32_t[]){0, 20, 3, 31}, 2,
                                    SKEIN_SETTINGS(SKEIN_TEXT("name", "string")), NULL);
    case 16: return skein_set_path(s->world, "colliders.1.name", skein_text("ground"));
    case 17: return skein_world_explain(s->world, dt, NULL, NULL);
    case 18: return skein_world_step(s->world, dt);
    case 19: return skein_world_step(s->world, dt);
    case 20: return skein_world_statistics(s->world, &s->statistics);
    case 21: return skein_method_set(s->world, "xpbd", NULL);
    case 22:
        return skein_set(s->world, s->gravity, "name", skein_text("a name that is long enough for a block of its own"));
    case 23: return skein_world_reset(s->world);
    case 24: return skein_world_step(s->world, dt);
    case 25: return skein_world_step(s->world, dt / 2);
    case 26: {
        skein_pass passes[8];
        size_t count;
        return skein_world_profile(s->world, dt, passes, 8, &count);
    }
    case 27: return skein_world_statistics(s->world, &s->statistics);
    case 28:
        return skein_body_add(s->world, "flock", NULL,
                              SKEIN_SETTINGS(SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", 40)), NULL);
    case 29:
        return skein_force_add(
            s->world, "flocking",
            SKEIN_SETTINGS(SKEIN_TEXT("on", "birds"), SKEIN_TEXT("formula.towards", "1 - relative_distance^2")), NULL);
    case 30: return skein_force_add(s->world, "predator", SKEIN_SETTINGS(SKEIN_TEXT("on", "birds")), NULL);
    case 31: return skein_force_add(s->world, "speed_limit", SKEIN_SETTINGS(SKEIN_TEXT("on", "birds")), NULL);
    case 32:
        return skein_constraint_add(
            s->world, "formula", (const uint32_t[]){0, 20, 3, 31}, 2,
            SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) - k * rest(length(p0 - p1))"),
                           SKEIN_REAL("parameters.k", 1), SKEIN_REAL("stiffness", 10)),
            NULL);
    case 33: return skein_constraint_add(s->world, "energy", (const uint32_t[]){0, 20}, 1, NULL, NULL);
    case 34: return skein_world_step(s->world, dt);
    case 35: return skein_order_measure(s->world, 5, 60, (const double[]){0, 0, 0}, 1, &s->order);
    case 36:
        return skein_sparse_solver_set(s->world, &(skein_sparse_solver){"diagonal", s, analyse, factor, solve, NULL});
    case 37:
        return skein_method_set(s->world, "backward_euler",
                                SKEIN_SETTINGS(SKEIN_TEXT("preconditioner", "cholesky"),
                                               SKEIN_REAL("newton_iterations", 1), SKEIN_REAL("cg_iterations", 3)));
    case 38: return skein_world_step(s->world, dt);
    case 39: return skein_world_statistics(s->world, &s->statistics);
    default: return SKEIN_ERROR_LIMIT;
    }
}
enum { CALLS = 40 };

/* What a failed call must leave as it was. */
typedef struct census {
    size_t particles, objects[SKEIN_CATEGORY_COUNT];
} census;

static census count_all(const skein_world *world) {
    census c = {.particles = skein_particle_count(world)};
    for (skein_category k = SKEIN_BODY; k <= SKEIN_COLLIDER; k++) c.objects[k] = skein_object_count(world, k);
    return c;
}

static void ignore(void *user, skein_log_level level, const char *message) {
    (void)user, (void)level, (void)message;
}

/* Plays the scenario through; true if nothing failed. The hash of its end, if it came so far, is in `hash`. */
static bool play(purse *p, uint64_t *hash) {
    skein_world_desc desc = purse_world(p);
    desc.log = ignore; // so that the faults of meshes are looked for
    bool whole = true;
    skein_error error = {0};
    scenario s = {.world = skein_world_create(&desc, &error)};
    if (!s.world) {
        assert_int_equal(error.status, SKEIN_ERROR_MEMORY);
        assert_true(p->in_use == 0 && p->blocks == 0);
        if (p->forever) return false;
        whole = false;
        s.world = skein_world_create(&desc, &error);
        assert_non_null(s.world);
    }
    bool all_made = true;
    for (s.call = 0; s.call < CALLS; s.call++) {
        census before = count_all(s.world), after;
        skein_status status = make_call(&s);
        if (!status) continue;
        // for want of memory, or, where memory is gone for good, of what an earlier call could not make
        if (all_made || !p->forever) assert_int_equal(status, SKEIN_ERROR_MEMORY);
        assert_int_equal(skein_world_error(s.world)->status, status);
        assert_true(skein_world_error(s.world)->message[0]);
        whole = false;
        after = count_all(s.world);
        assert_memory_equal(&before, &after, sizeof before);
        if (p->forever) all_made = false;
        else OK(s.world, make_call(&s));
    }
    if (all_made) {
        *hash = s.statistics.state_hash;
        assert_true(*hash == skein_world_hash(s.world));
        assert_int_equal(s.statistics.nonfinite, 0);
        assert_int_equal(s.statistics.memory_bytes, p->in_use);
    }
    skein_world_destroy(s.world);
    assert_int_equal(p->blocks, 0);
    assert_int_equal(p->in_use, 0);
    return whole;
}

/* Sanitizers are slow: there every seventh allocation has its turn; else every second. */
enum { STRIDE = SPARING ? 7 : 2 };

/* Each allocation fails once: the call fails, is made again, and the run ends as one in which nothing failed. */
static void one_failure_is_made_good(void **state) {
    (void)state;
    uint64_t whole = 0, hash;
    purse p = {.fail_at = SIZE_MAX};
    assert_true(play(&p, &whole));
    size_t calls = p.calls;
    assert_true(calls > 150);
    bool nothing_failed = false;
    for (size_t n = 0; !nothing_failed; n += STRIDE) {
        p = (purse){.fail_at = n};
        nothing_failed = play(&p, &hash);
        assert_true(hash == whole);
        assert_true(nothing_failed == (n >= calls)); // every one of them is refused once
    }
}

/* Memory ends for good at the n-th allocation: every call from there on may fail, none does harm. */
static void memory_may_end_at_any_point(void **state) {
    (void)state;
    uint64_t hash;
    size_t n = 0;
    for (;; n += STRIDE) {
        purse p = {.fail_at = n, .forever = true};
        if (play(&p, &hash)) break;
    }
    assert_true(n > 150);
}

/* Removing and setting up again does not pile up memory. */
static void a_long_life_does_not_leak(void **state) {
    (void)state;
    purse p = {.fail_at = SIZE_MAX};
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = purse_take, desc.release = purse_give_back, desc.memory_user = &p;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    add_particle(world, 1, 0, 0, 0), add_particle(world, 1, 1, 0, 0);
    OK(world, skein_force_add(world, "separation", NULL, NULL));
    size_t settled = 0;
    for (int n = 0; n < 100; n++) {
        OK(world, skein_method_set(world, method_names[n % 2], SKEIN_SETTINGS(SKEIN_REAL("substeps", 1 + n % 5))));
        steps(world, 1, dt);
        OK(world, skein_world_reset(world));
        if (n == 10) settled = p.in_use;
    }
    assert_int_equal(p.in_use, settled);
    // after the second step nothing is allocated
    size_t calls = p.calls;
    OK(world, skein_method_set(world, "xpbd", NULL));
    steps(world, 2, dt);
    calls = p.calls;
    steps(world, 50, dt);
    assert_int_equal(p.calls, calls);
    skein_world_destroy(world);
    assert_int_equal(p.in_use, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_failure_is_made_good),
        cmocka_unit_test(memory_may_end_at_any_point),
        cmocka_unit_test(a_long_life_does_not_leak),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
