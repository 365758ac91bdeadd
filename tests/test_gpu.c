/* The plan on the graphics card: the same worlds stepped on both devices agree, and what cannot run there is named.
 * Runs on whatever OpenGL there is; Mesa's llvmpipe plays a card where there is none. */
#include "gpu/device.h"
#include "helpers.h"

static const double dt = 1.0 / 60;
/* The card computes in float, so a processor that computes in double is farther off it by its own rounding. */
#define FLOAT_OFF (sizeof(skein_real) == sizeof(double) ? 2 : 1)

static const char *const explicit_methods[] = {
    "explicit_euler", "symplectic_euler", "lookahead_euler", "midpoint", "leapfrog", "rk4", "xpbd", "pbd"};

/* The world on a card; skips the test where there is none. */
static void to_card(skein_world *world) {
    if (!skein_world_device_set(world, SKEIN_DEVICE_GPU)) return;
    fprintf(stderr, "skipped: %s\n", skein_world_error(world)->message);
    skein_world_destroy(world);
    skip();
}

/* The farthest that any particle's position or velocity is off, the sizes being about 1. */
static double difference(const skein_world *a, const skein_world *b) {
    size_t count = skein_particle_count(a);
    double *x = calloc(count * 12, sizeof *x), worst = 0;
    OK(a, skein_positions_copy(a, 0, count, x));
    OK(a, skein_velocities_copy(a, 0, count, x + 3 * count));
    OK(b, skein_positions_copy(b, 0, count, x + 6 * count));
    OK(b, skein_velocities_copy(b, 0, count, x + 9 * count));
    for (size_t i = 0; i < 6 * count; i++) {
        double off = fabs(x[i] - x[6 * count + i]);
        if (!(off <= worst)) worst = off;
    }
    free(x);
    return worst;
}

static void scatter(skein_world *world, size_t count, double size, uint64_t seed) {
    double *x = calloc(count * 7, sizeof *x), *v = x + 3 * count, *m = x + 6 * count;
    for (size_t i = 0; i < 3 * count; i++) {
        x[i] = random_between(&seed, -size / 2, size / 2);
        v[i] = random_between(&seed, -1, 1);
    }
    for (size_t i = 0; i < count; i++) m[i] = i % 17 == 5 ? 0 : random_between(&seed, 0.5, 2);
    OK(world, skein_particles_add(world, count, x, v, m, NULL));
    free(x);
}

static skein_world *falling(const char *method, size_t count) {
    skein_world *world = new_world(method, 4);
    add_gravity(world);
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0.5, 0, 1)), NULL));
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("linear", 0.2), SKEIN_REAL("rate", 0.1)), NULL));
    scatter(world, count, 2, 7);
    return world;
}

static void falling_agrees_under_every_method(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(explicit_methods); m++) {
        skein_world *cpu = falling(explicit_methods[m], 300), *gpu = falling(explicit_methods[m], 300);
        to_card(gpu);
        for (int i = 0; i < 10; i++) {
            OK(cpu, skein_world_step(cpu, dt));
            OK(gpu, skein_world_step(gpu, dt));
        }
        double off = difference(cpu, gpu);
        if (off > 1e-4) fprintf(stderr, "%s is off by %g\n", explicit_methods[m], off);
        assert_true(off <= 1e-4);
        skein_world_destroy(cpu);
        skein_world_destroy(gpu);
    }
}

/* Steps both worlds, on either device, and holds them against each other. */
static void assert_agree(skein_world *cpu, skein_world *gpu, int steps, double most, const char *what) {
    to_card(gpu);
    for (int i = 0; i < steps; i++) {
        OK(cpu, skein_world_step(cpu, dt));
        OK(gpu, skein_world_step(gpu, dt));
    }
    double off = difference(cpu, gpu);
    most *= FLOAT_OFF;
    if (!(off <= most)) fprintf(stderr, "%s is off by %g\n", what, off);
    assert_true(off <= most);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* ---- contact ------------------------------------------------------------------------------------ */

static const struct shape {
    const char *kind;
    skein_setting settings[8];
} shapes[] = {
    {"plane", {SKEIN_VEC3("normal", 0.1, 1, 0), SKEIN_REAL("offset", -1), SKEIN_REAL("friction", 0.2)}},
    {"sphere", {SKEIN_REAL("radius", 0.9), SKEIN_REAL("restitution", 0.7), SKEIN_VEC3("motion.velocity", 0.3, 0.1, 0)}},
    {"sphere", {SKEIN_REAL("radius", 0.8), SKEIN_REAL("mass", 5)}},
    {"bowl", {SKEIN_REAL("radius", 1.8), SKEIN_REAL("friction", 0.6)}},
    {"capsule",
     {SKEIN_VEC3("from", -1, 0, 0), SKEIN_VEC3("to", 1, 0.3, 0), SKEIN_REAL("radius", 0.5),
      SKEIN_REAL("motion.spin", 3), SKEIN_VEC3("motion.axis", 1, 1, 0)}},
    {"box",
     {SKEIN_VEC3("size", 1, 1.5, 0.8), SKEIN_VEC3("rotation", 20, 30, 40), SKEIN_REAL("motion.spin", -2),
      SKEIN_REAL("motion.start", 0.02), SKEIN_REAL("restitution", 0.3)}},
};

static skein_world *colliding(const char *method, const struct shape *shape) {
    skein_world *world = new_world(method, 3);
    add_gravity(world);
    OK(world, skein_collider_add(world, shape->kind, shape->settings, NULL));
    scatter(world, 400, 3, 11);
    return world;
}

static void contact_agrees_for_every_shape(void **state) {
    (void)state;
    for (size_t s = 0; s < COUNT(shapes); s++) {
        for (int m = 0; m < 2; m++) {
            skein_world *cpu = colliding(method_names[m], &shapes[s]), *gpu = colliding(method_names[m], &shapes[s]);
            assert_agree(cpu, gpu, 4, 1e-4, shapes[s].kind);
        }
    }
    // and it is there at all: nobody is deep in the ball
    skein_world *world = colliding("xpbd", &shapes[1]);
    to_card(world);
    skein_statistics statistics;
    OK(world, skein_world_statistics(world, &statistics));
    assert_true(statistics.max_penetration > 0.1);
    OK(world, skein_world_step(world, dt));
    OK(world, skein_world_statistics(world, &statistics));
    assert_true(statistics.max_penetration < 1e-3);
    skein_world_destroy(world);
}

/* ---- neighbours --------------------------------------------------------------------------------- */

static skein_world *pushing(const char *method, size_t count, double size, double radius) {
    skein_world *world = new_world(method, 2);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("quadratic", 0.3)), NULL));
    OK(world, skein_force_add(world, "separation",
                              SKEIN_SETTINGS(SKEIN_REAL("radius", radius), SKEIN_REAL("strength", 0.5)), NULL));
    scatter(world, count, size, count);
    return world;
}

/* Few and many, in one cell and far apart; a second rule of another reach. */
static void neighbours_agree(void **state) {
    (void)state;
    static const struct {
        size_t count;
        double size, radius;
    } crowds[] = {{1, 1, 0.2}, {2, 0.1, 0.2}, {40, 0.01, 0.5}, {700, 2, 0.3}, {3000, 4, 0.35}, {500, 1e6, 1e5}};
    for (size_t c = 0; c < COUNT(crowds); c++) {
        skein_world *world[2];
        for (int w = 0; w < 2; w++) {
            world[w] = pushing(c % 2 ? "xpbd" : "leapfrog", crowds[c].count, crowds[c].size, crowds[c].radius);
            OK(world[w], skein_force_add(world[w], "separation",
                                         SKEIN_SETTINGS(SKEIN_REAL("radius", crowds[c].radius / 2)), NULL));
        }
        assert_agree(world[0], world[1], 2, 1e-4 * fmax(1, crowds[c].size / 10), "a crowd");
    }
}

static void particles_that_are_nowhere_harm_nobody(void **state) {
    (void)state;
    skein_world *world = pushing("symplectic_euler", 200, 1, 0.2);
    to_card(world);
    OK(world, skein_velocities_set(world, 3, 1, (const double[]){1e15, 0, 0}));
    OK(world, skein_world_step(world, 1e6)); // drag overflows
    skein_statistics statistics;
    OK(world, skein_world_statistics(world, &statistics));
    assert_true(statistics.nonfinite >= 1);
    OK(world, skein_world_step(world, 1e-3));
    skein_world_destroy(world);
}

static void the_same_bits_come_again(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int w = 0; w < 2; w++) {
        skein_world *world = pushing("xpbd", 2000, 2, 0.3);
        to_card(world);
        for (int i = 0; i < 5; i++) {
            OK(world, skein_world_step(world, dt));
            if (w) skein_world_hash(world); // looking changes nothing
        }
        hash[w] = skein_world_hash(world);
        skein_world_destroy(world);
    }
    assert_true(hash[0] == hash[1]);
}

/* ---- a flock ------------------------------------------------------------------------------------ */

/* About 30 neighbours each, going round; the hawk is seen along z. */
static skein_world *flying(const char *method, size_t count, bool hawk) {
    skein_world *world = new_world(method, 1);
    double side = 2 * cbrt((double)count / 7.2);
    OK(world, skein_body_add(world, "flock", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", (double)count),
                                            SKEIN_VEC3("spread", side, side, side), SKEIN_REAL("swirl", 4)),
                             NULL));
    OK(world, skein_force_add(world, "flocking",
                              SKEIN_SETTINGS(SKEIN_REAL("separation", 0.8), SKEIN_REAL("alignment", 0.6),
                                             SKEIN_REAL("cohesion", 0.6), SKEIN_REAL("view", hawk ? 250 : 360)),
                              NULL));
    OK(world, skein_force_add(world, "attraction", NULL, NULL));
    if (hawk)
        OK(world, skein_force_add(world, "predator",
                                  SKEIN_SETTINGS(SKEIN_REAL("radius", side / 3), SKEIN_VEC3("line", 0, 0, 2)), NULL));
    OK(world, skein_force_add(world, "speed_limit", SKEIN_SETTINGS(SKEIN_REAL("limit", 6)), NULL));
    return world;
}

static void a_flock_agrees_after_a_step(void **state) {
    (void)state;
    static const size_t counts[] = {1, 33, 1024, 4096, 16384};
    for (size_t i = 0; i < COUNT(counts); i++)
        assert_agree(flying("symplectic_euler", counts[i], i % 2), flying("symplectic_euler", counts[i], i % 2), 1,
                     1e-5, "a flock");
    for (size_t m = 0; m < COUNT(explicit_methods); m++)
        assert_agree(flying(explicit_methods[m], 300, true), flying(explicit_methods[m], 300, true), 2, 1e-4,
                     explicit_methods[m]);
}

/* Kept from turning, climbing and leaving, and looking out for what is in the way. */
static skein_world *kept(const char *method, bool ball) {
    skein_world *world = flying(method, 400, true);
    OK(world,
       skein_force_add(world, "turn_limit", SKEIN_SETTINGS(SKEIN_REAL("turn", 60), SKEIN_REAL("climb", 20)), NULL));
    if (ball)
        OK(world, skein_force_add(world, "bounds",
                                  SKEIN_SETTINGS(SKEIN_TEXT("shape", "sphere"), SKEIN_REAL("radius", 3)), NULL));
    else
        OK(world, skein_force_add(world, "bounds",
                                  SKEIN_SETTINGS(SKEIN_VEC3("size", 6, 7, 5), SKEIN_VEC3("centre", 0.5, 0, 0)), NULL));
    OK(world, skein_force_add(world, "lookout", SKEIN_SETTINGS(SKEIN_REAL("ahead", 0.5)), NULL));
    OK(world, skein_collider_add(world, "capsule", SKEIN_SETTINGS(SKEIN_VEC3("motion.velocity", 1, 0, 0)), NULL));
    // (who is stopped by friction has no direction of flight but rounding's, and these rules ask for one)
    OK(world,
       skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -3), SKEIN_REAL("friction", 0)), NULL));
    return world;
}

static void a_flock_that_is_kept_agrees(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(explicit_methods); m++)
        assert_agree(kept(explicit_methods[m], m % 2), kept(explicit_methods[m], m % 2), 2, 1e-4, explicit_methods[m]);
    // the tests above are about something: each rule alone changes where the birds go
    static const char *const rules[] = {"forces.2.enabled", "forces.4.enabled", "forces.5.enabled", "forces.6.enabled"};
    for (size_t r = 0; r < COUNT(rules); r++) {
        skein_world *with = kept("symplectic_euler", false), *without = kept("symplectic_euler", false);
        to_card(with);
        to_card(without);
        OK(without, skein_set_path(without, rules[r], skein_number(0)));
        for (int i = 0; i < 2; i++) {
            OK(with, skein_world_step(with, dt));
            OK(without, skein_world_step(without, dt));
        }
        assert_true(difference(with, without) > 0.01);
        skein_world_destroy(with);
        skein_world_destroy(without);
    }
    skein_world *world = kept("symplectic_euler", false);
    to_card(world);
    OK(world, skein_set_path(world, "forces.5.edge", skein_text("periodic")));
    FAILS(world, SKEIN_ERROR_VALUE, "with periodic edges", skein_world_step(world, dt));
    OK(world, skein_set_path(world, "forces.5.edge", skein_text("wall")));
    OK(world, skein_set_path(world, "forces.2.particle", skein_number(7)));
    FAILS(world, SKEIN_ERROR_VALUE, "predator cannot run", skein_world_step(world, dt));
    OK(world, skein_set_path(world, "forces.2.particle", skein_number(-1)));
    OK(world, skein_set_path(world, "forces.0.nearest", skein_number(7)));
    FAILS(world, SKEIN_ERROR_VALUE, "only the nearest", skein_world_step(world, dt));
    skein_world_destroy(world);
}

static void a_profile_is_one_pass(void **state) {
    (void)state;
    skein_world *world = flying("symplectic_euler", 300, false);
    skein_pass passes[4];
    size_t count;
    to_card(world);
    OK(world, skein_world_profile(world, dt, passes, COUNT(passes), &count));
    assert_int_equal(count, 1);
    assert_true(passes[0].seconds > 0);
    skein_world_destroy(world);
}

/* What neighbours within 2 make of a bird's velocity in a step, looking at all of them (flocking.h). */
static void add_steering(const double *x, const double *v, size_t count, size_t i, double out[3]) {
    for (size_t j = 0; j < count; j++) {
        double d[3], square = 0, speed = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = x[3 * j + (size_t)k] - x[3 * i + (size_t)k];
            square += d[k] * d[k];
            speed += v[3 * j + (size_t)k] * v[3 * j + (size_t)k];
        }
        double distance = sqrt(square), percent = distance / 2;
        if (!(distance > 0) || !(percent < 1)) continue;
        double towards = 0, with = 0;
        if (percent < 0.4) towards = 1 - 0.4 / percent;
        else if (percent < 0.7) with = 1 - 0.5 * cos(2 * PI * (percent - 0.4) / 0.3);
        else towards = 0.5 * cos(2 * PI * (percent - 0.7) / 0.3);
        for (int k = 0; k < 3; k++)
            out[k] += dt * (towards * d[k] / distance + with * v[3 * j + (size_t)k] / sqrt(speed));
    }
}

static void the_cards_grid_is_all_pairs(void **state) {
    (void)state;
    for (size_t count = 1024; count <= 16384; count *= 4) {
        skein_world *world = flying("symplectic_euler", count, false);
        OK(world, skein_set_path(world, "forces.1.enabled", skein_number(0)));
        OK(world, skein_set_path(world, "forces.2.limit", skein_number(1e6)));
        double *before = calloc(9 * count, sizeof *before), *v = before + 3 * count, *after = before + 6 * count;
        OK(world, skein_positions_copy(world, 0, count, before));
        OK(world, skein_velocities_copy(world, 0, count, v));
        to_card(world);
        OK(world, skein_world_step(world, dt));
        OK(world, skein_velocities_copy(world, 0, count, after));
        double moved = 0;
        for (size_t i = 0; i < count; i += count / 256) {
            double ought[3] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
            add_steering(before, v, count, i, ought);
            for (int k = 0; k < 3; k++) {
                assert_near(after[3 * i + (size_t)k], ought[k], 1e-5);
                moved = fmax(moved, fabs(ought[k] - v[3 * i + (size_t)k]));
            }
        }
        assert_true(moved > 0.1);
        free(before);
        skein_world_destroy(world);
    }
}

/* Two flocks: one minds only itself, the other only the first; a hawk frightens one; loose particles are let be. */
static skein_world *two_flocks(const char *method) {
    static const char *const names[] = {"jays", "daws"};
    skein_world *world = new_world(method, 2);
    scatter(world, 50, 3, 9);
    for (int f = 0; f < 2; f++) {
        OK(world, skein_body_add(world, "flock", NULL,
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", names[f]), SKEIN_REAL("count", 400 + 300 * f),
                                                SKEIN_VEC3("spread", 6, 6, 6), SKEIN_REAL("seed", f)),
                                 NULL));
        OK(world, skein_force_add(world, "flocking",
                                  SKEIN_SETTINGS(SKEIN_REAL("separation", 0.5), SKEIN_REAL("alignment", 0.3 + 0.2 * f),
                                                 SKEIN_REAL("cohesion", 0.2), SKEIN_TEXT("on", names[f]),
                                                 SKEIN_TEXT("minds", "jays"), SKEIN_TEXT("measure", "distance^2")),
                                  NULL));
    }
    OK(world,
       skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("radius", 4), SKEIN_TEXT("on", "daws")), NULL));
    OK(world,
       skein_force_add(world, "speed_limit", SKEIN_SETTINGS(SKEIN_REAL("limit", 4), SKEIN_TEXT("on", "jays")), NULL));
    return world;
}

static void flocks_that_mind_each_other_agree(void **state) {
    (void)state;
    for (int m = 0; m < 2; m++)
        assert_agree(two_flocks(method_names[m]), two_flocks(method_names[m]), 2, 1e-4, "one of two flocks");
}

/* After a thousand steps every bird is elsewhere; but the flocks are alike. And 100 bytes a bird are enough. */
static void the_flocks_stay_alike(void **state) {
    (void)state;
    skein_order order[2];
    for (int w = 0; w < 2; w++) {
        skein_world *world = flying("symplectic_euler", 1024, false);
        if (w) to_card(world);
        for (int i = 0; i < 300; i++) OK(world, skein_world_step(world, dt));
        OK(world, skein_order_measure(world, 0, 1024, (const double[3]){0, 0, 0}, 0, &order[w]));
        skein_world_destroy(world);
    }
    assert_share(order[1].polarization, order[0].polarization, 0.05);
    assert_share(order[1].milling, order[0].milling, 0.05);
    assert_share(order[1].radius, order[0].radius, 0.05);
    assert_share(order[1].nearest, order[0].nearest, 0.05);
}

static void four_thousand_birds_fly_a_hundred_steps(void **state) {
    (void)state;
    skein_world *world = flying("symplectic_euler", 100000, true);
    to_card(world);
    OK(world, skein_world_step(world, dt));
    skein_device_info info = skein_world_device(world);
    assert_true((double)info.bytes < 100.0 * 100000);
    assert_int_equal(info.pass_count, 3); // the loop of substeps, the grid, and one shader for all the rest
    skein_world_destroy(world);
    world = flying("symplectic_euler", 4096, true);
    to_card(world);
    for (int i = 0; i < 100; i++) OK(world, skein_world_step(world, dt));
    skein_statistics statistics;
    OK(world, skein_world_statistics(world, &statistics));
    assert_int_equal(statistics.nonfinite, 0);
    skein_world_destroy(world);
}

/* After some steps the state lies in the order of the cells: a step from there is the processor's, bird by bird. */
static void birds_that_were_moved_are_the_same_birds(void **state) {
    (void)state;
    skein_world *cpu = flying("symplectic_euler", 500, true), *gpu = flying("symplectic_euler", 500, true);
    double *now = calloc(6 * 500, sizeof *now);
    to_card(gpu);
    for (int i = 0; i < 4; i++) OK(gpu, skein_world_step(gpu, dt));
    assert_null(skein_world_device(gpu).slot_of);
    assert_true(skein_world_device(gpu).particle_buffer != 0);
    OK(gpu, skein_positions_copy(gpu, 0, 500, now));
    OK(gpu, skein_velocities_copy(gpu, 0, 500, now + 1500));
    OK(cpu, skein_positions_set(cpu, 0, 500, now));
    OK(cpu, skein_velocities_set(cpu, 0, 500, now + 1500));
    OK(cpu, skein_world_step(cpu, dt));
    OK(gpu, skein_world_step(gpu, dt));
    assert_under(difference(cpu, gpu), 1e-5);
    // a rule for some of them only: now slots matter, and are the world's again
    for (int w = 0; w < 2; w++) {
        skein_world *world = w ? gpu : cpu;
        scatter(world, 20, 3, 77);
        OK(world, skein_set_path(world, "forces.0.on", skein_text("birds")));
        OK(world, skein_world_step(world, dt));
    }
    assert_non_null(skein_world_device(gpu).slot_of);
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    free(now);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* ---- memory ------------------------------------------------------------------------------------- */

typedef struct purse {
    size_t calls, fail_at, blocks;
} purse;

static void *take(void *user, size_t size, size_t alignment) {
    purse *p = user;
    if (p->calls++ == p->fail_at) return NULL;
    p->blocks++;
    return aligned_alloc(alignment, size);
}

static void give_back(void *user, void *memory, size_t size) {
    (void)size;
    ((purse *)user)->blocks--;
    free(memory);
}

/* Whichever allocation fails on the way to the card, the call says so, can be made again, and nothing is left. */
static void failed_allocations_are_survived(void **state) {
    (void)state;
    purse p = {0, SIZE_MAX, 0};
    bool failed = true;
    for (size_t n = 0; failed; n++) {
        skein_world_desc desc = skein_default_world_desc();
        desc.allocate = take, desc.release = give_back, desc.memory_user = &p;
        skein_world *world = skein_world_create(&desc, NULL);
        OK(world, skein_force_add(world, "separation", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3)), NULL));
        OK(world, skein_method_set(world, "symplectic_euler", NULL));
        scatter(world, 60, 1, 3);
        OK(world, skein_world_step(world, dt)); // what is not the card's is there already
        p.fail_at = p.calls + n;
        skein_status status = skein_world_device_set(world, SKEIN_DEVICE_GPU);
        if (status == SKEIN_ERROR_MEMORY) status = skein_world_device_set(world, SKEIN_DEVICE_GPU);
        if (status) fprintf(stderr, "skipped: %s\n", skein_world_error(world)->message);
        for (int i = 0; i < 4 && !status; i++) {
            skein_status stepped = skein_world_step(world, dt);
            if (!stepped) continue;
            assert_int_equal(stepped, SKEIN_ERROR_MEMORY);
            OK(world, skein_world_step(world, dt));
        }
        failed = p.calls > p.fail_at && !status;
        p.fail_at = SIZE_MAX;
        skein_statistics statistics;
        OK(world, skein_world_statistics(world, &statistics));
        skein_world_destroy(world);
        assert_int_equal(p.blocks, 0);
        if (status) skip();
        assert_true(n > 5 || failed);
    }
}

/* ---- limits of drivers: a binding smaller than a vector, an axis shorter than the groups -------- */

static void small_bindings_and_short_axes_do(void **state) {
    (void)state;
    skein_world *cpu = colliding("xpbd", &shapes[4]), *gpu = colliding("xpbd", &shapes[4]);
    scatter(cpu, 5000, 3, 3);
    scatter(gpu, 5000, 3, 3);
    to_card(gpu);
    sk_gpu_device *device = (sk_gpu_device *)(void *)gpu->device;
    device->most_bytes = 16 * 1000; // 7 parts of it are 896 slots
    device->most_groups = 3;
    for (int i = 0; i < 3; i++) {
        OK(cpu, skein_world_step(cpu, dt));
        OK(gpu, skein_world_step(gpu, dt));
    }
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    // with neighbours everybody must be in reach
    OK(gpu, skein_force_add(gpu, "separation", NULL, NULL));
    FAILS(gpu, SKEIN_ERROR_LIMIT, "5400 particles", skein_world_step(gpu, dt));
    device->most_bytes = 1 << 20;
    OK(gpu, skein_world_step(gpu, dt));
    OK(cpu, skein_force_add(cpu, "separation", NULL, NULL));
    OK(cpu, skein_world_step(cpu, dt));
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* ---- the state goes to and fro ------------------------------------------------------------------ */

static void change_by_hand(skein_world *world) {
    OK(world, skein_positions_set(world, 4, 1, (const double[]){0.1, 0.2, 0.3}));
    OK(world, skein_velocities_set(world, 5, 2, (const double[]){1, 2, 3, 4, 5, 6}));
    OK(world, skein_particle_hold(world, 6, true));
}

static void changes_by_hand_arrive(void **state) {
    (void)state;
    skein_world *cpu = pushing("xpbd", 100, 1, 0.2), *gpu = pushing("xpbd", 100, 1, 0.2);
    to_card(gpu);
    for (int turn = 0; turn < 6; turn++) {
        skein_world *both[] = {cpu, gpu};
        for (int w = 0; w < 2; w++) {
            if (turn == 1) change_by_hand(both[w]);
            if (turn == 2) scatter(both[w], 30, 1, 5); // others join, and slots change
            if (turn == 3) OK(both[w], skein_set_path(both[w], "forces.1.radius", skein_number(0.4)));
            if (turn == 4) add_gravity(both[w]);
            OK(both[w], skein_world_step(both[w], dt));
        }
        assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
        double blend[2][3];
        for (int w = 0; w < 2; w++) OK(both[w], skein_positions_blend(both[w], 0.5, 7, 1, blend[w]));
        for (int k = 0; k < 3; k++) assert_near(blend[0][k], blend[1][k], 1e-4);
    }
    // back to the processor in the middle of it, and to the card again
    OK(gpu, skein_world_device_set(gpu, SKEIN_DEVICE_CPU));
    assert_int_equal(skein_world_device(gpu).device, SKEIN_DEVICE_CPU);
    OK(cpu, skein_world_step(cpu, dt));
    OK(gpu, skein_world_step(gpu, dt));
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    OK(gpu, skein_world_device_set(gpu, SKEIN_DEVICE_GPU));
    OK(cpu, skein_world_reset(cpu));
    OK(gpu, skein_world_reset(gpu));
    OK(cpu, skein_world_step(cpu, dt));
    OK(gpu, skein_world_step(gpu, dt));
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* The library reads the state only when asked, and asks for no more memory than it needs. */
static void the_card_is_described(void **state) {
    (void)state;
    skein_world *world = falling("symplectic_euler", 1000);
    to_card(world);
    skein_device_info info = skein_world_device(world);
    assert_int_equal(info.device, SKEIN_DEVICE_GPU);
    assert_true(strlen(info.name) > 3 && !info.position_buffer);
    OK(world, skein_world_step(world, dt));
    assert_true(world->device->ahead);
    info = skein_world_device(world);
    assert_true(world->device->ahead && info.position_buffer && info.velocity_buffer);
    assert_int_equal(info.slot_count, world->particles.slot_count);
    // forces never leave the shader, so that X, V and P are all there is; and a substep is one pass
    assert_int_equal(info.bytes, 3 * 16 * info.slot_count);
    assert_int_equal(info.pass_count, 3);
    skein_position_view(world);
    assert_false(world->device->ahead);
    skein_world_destroy(world);
}

/* ---- what cannot run ---------------------------------------------------------------------------- */

static void keep_line(void *user, const char *line) {
    strncat(user, line, 200);
    strcat(user, "\n");
}

static void what_cannot_run_is_named(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 2);
    add_gravity(world);
    OK(world, skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_TEXT("name", "sail"), SKEIN_PAIR("grid", 8, 8)),
                             NULL));
    to_card(world);
    FAILS(world, SKEIN_ERROR_VALUE, "sail: its ", skein_world_step(world, dt));
    FAILS(world, SKEIN_ERROR_VALUE, "--device cpu", skein_world_explain(world, dt, NULL, NULL));
    OK(world, skein_world_device_set(world, SKEIN_DEVICE_CPU));
    OK(world, skein_world_step(world, dt));
    skein_world_destroy(world);

    world = new_world("backward_euler", 1);
    scatter(world, 10, 1, 1);
    to_card(world);
    FAILS(world, SKEIN_ERROR_VALUE, "cannot run on the graphics card", skein_world_step(world, dt));
    skein_world_destroy(world);
}

static void the_plan_has_the_same_rows(void **state) {
    (void)state;
    static char lines[2][8192];
    skein_world *world = pushing("xpbd", 100, 1, 0.2);
    OK(world, skein_collider_add(world, "plane", NULL, NULL));
    lines[0][0] = lines[1][0] = 0;
    OK(world, skein_world_explain(world, dt, keep_line, lines[0]));
    to_card(world);
    OK(world, skein_world_explain(world, dt, keep_line, lines[1]));
    assert_string_equal(lines[0], lines[1]);
    assert_non_null(strstr(lines[1], "neighbour"));
    skein_world_destroy(world);
}

static void without_a_current_context_there_is_no_adopting(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 2);
    FAILS(world, SKEIN_ERROR_VALUE, "", skein_world_device_set(world, SKEIN_DEVICE_CURRENT_GL));
    assert_int_equal(skein_world_device(world).device, SKEIN_DEVICE_CPU);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(falling_agrees_under_every_method),
        cmocka_unit_test(contact_agrees_for_every_shape),
        cmocka_unit_test(neighbours_agree),
        cmocka_unit_test(particles_that_are_nowhere_harm_nobody),
        cmocka_unit_test(the_same_bits_come_again),
        cmocka_unit_test(a_flock_agrees_after_a_step),
        cmocka_unit_test(a_flock_that_is_kept_agrees),
        cmocka_unit_test(a_profile_is_one_pass),
        cmocka_unit_test(the_cards_grid_is_all_pairs),
        cmocka_unit_test(flocks_that_mind_each_other_agree),
        cmocka_unit_test(the_flocks_stay_alike),
        cmocka_unit_test(four_thousand_birds_fly_a_hundred_steps),
        cmocka_unit_test(birds_that_were_moved_are_the_same_birds),
        cmocka_unit_test(failed_allocations_are_survived),
        cmocka_unit_test(small_bindings_and_short_axes_do),
        cmocka_unit_test(changes_by_hand_arrive),
        cmocka_unit_test(the_card_is_described),
        cmocka_unit_test(what_cannot_run_is_named),
        cmocka_unit_test(the_plan_has_the_same_rows),
        cmocka_unit_test(without_a_current_context_there_is_no_adopting),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
