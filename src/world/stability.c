/* The largest stable substeps of explicit methods, from the stiffest modes of the world as it lies.
 *
 * Power iteration on M^-1 (a K + b C): K the stiffness of the constraints at the present positions, C their damping
 * and the air's. The mode of the largest frequency limits most methods; where other springs are damped more, so may
 * the most damped one, or one between. A method says what it does to a mode by its amplification matrix. */
#include <math.h>

#include "methods/plan_builder_solve.h"
#include "world/world.h"

enum { MOST_ITERATIONS = 2000, SETTLED_ITERATIONS = 30 };

/* Where power iteration keeps its vectors. */
static const sk_vector mode_at = (sk_vector)SK_DIRECTION, image = (sk_vector)SK_PRODUCT;
static const sk_vector zero = (sk_vector)SK_BLOCK0, resistance = (sk_vector)SK_INERTIA, sums = (sk_vector)SK_SUMS;

typedef struct finder {
    skein_world *world;
    sk_plan_builder builder;
    sk_plan plan;
    sk_run run;
    sk_solve solve;
} finder;

static void run_plan(finder *f) {
    sk_run_ops(&f->run, f->world->tasks, f->plan.data, f->plan.count);
    f->plan.count = 0;
}

/* image = (a K + b C) mode, by the product of conjugate gradients with no mass; returns mode image. */
static double measure(finder *f, double a, double b) {
    sk_write_clear(&f->builder, resistance);
    sk_write_resistance(&f->builder, resistance, b);
    sk_write_sum(&f->builder, image, 1, mode_at, 0, SK_NONE); // with a scale of 0 this is the direction
    sk_write_multiply(&f->builder, a, b);
    run_plan(f);
    return sk_solve_sum(&f->run, 0);
}

/* Any vector will do to begin with, if it has something of every mode. */
static void fill_mode(finder *f) {
    uint64_t seed = 1;
    real *number = (real *)(void *)f->run.vector[mode_at];
    for (size_t i = 0; i < 4 * f->run.slot_count; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        number[i] = (real)((double)(seed >> 11) / 9007199254740992.0 - 0.5);
    }
}

/* Leaves the mode of the largest value of M^-1 (a K + b C), of length 1 in M; false if there is none. */
static bool iterate(finder *f, double a, double b) {
    double value = 0;
    fill_mode(f);
    for (int iteration = 0, settled = 0; iteration < MOST_ITERATIONS && settled < SETTLED_ITERATIONS; iteration++) {
        double now = measure(f, a, b);
        settled = fabs(now - value) <= 1e-4 * now ? settled + 1 : 0;
        value = now;
        sk_write_pass(&f->builder, &sk_solve_norm, sums, image, SK_X, "image w image");
        run_plan(f);
        double square = sk_solve_sum(&f->run, 1);
        if (!(square > 0) || isinf(square)) return false;
        sk_write_kick(&f->builder, mode_at, zero, 1 / sqrt(square), image);
        run_plan(f);
    }
    return true;
}

/* Adds the mode that was found. */
static void add_mode(finder *f, skein_stability *s) {
    double square = measure(f, 1, 0), damping = measure(f, 0, 1);
    double frequency = sqrt(square > 0 ? square : 0);
    s->modes[s->mode_count++] = (skein_mode){frequency, damping / 2};
}

/* Whether forces of the air, and constraints along themselves, take energy. */
static void look_for_damping(const sk_rules *rules, bool *air, bool *along) {
    for (size_t i = 0; i < rules->forces.count; i++)
        *air |= *rules->forces.data[i]->enabled && sk_force_on_velocity(rules->forces.data[i]);
    for (size_t i = 0; i < rules->batches.count; i++)
        *along |= sk_batch_is_on(rules->batches.data[i]) && sk_batch_damping_time(rules->batches.data[i]) > 0;
}

static void find_modes(finder *f, skein_stability *s) {
    bool air = false, along = false;
    look_for_damping(&f->world->rules, &air, &along);
    s->swinging_is_free = along && !air;
    if (iterate(f, 1, 0)) add_mode(f, s);
    if (!air && !along) return;
    if (iterate(f, 0, 1)) add_mode(f, s);
    // h^2 K + 2 h C at most 4 is what limits symplectic Euler: a mode between the two, if there is one
    double h = INFINITY;
    for (size_t i = 0; i < s->mode_count; i++) {
        double w = s->modes[i].frequency, c = s->modes[i].damping_rate;
        h = fmin(h, w > 0 ? 2 * (sqrt(c * c + w * w) - c) / (w * w) : 1 / c);
    }
    if (isfinite(h) && iterate(f, h * h, 2 * h)) add_mode(f, s);
}

skein_status skein_world_stability(skein_world *world, skein_stability *stability) {
    SK_NEED(world, world);
    SK_NEED(world, stability);
    skein_error *error = sk_world_error(world);
    *stability = (skein_stability){.mode_count = 0};
    skein_status status = sk_world_arrange(world, error);
    skein_error ignored; // a name that no body has is a step's to tell
    if (!status) sk_world_find_whom(world, &ignored);
    if (!status) status = sk_world_fetch(world);
    if (status) return status;
    for (size_t i = 0; i < world->rules.batches.count; i++) sk_batch_refresh(world->rules.batches.data[i]);
    uint32_t wanted =
        1u << mode_at | 1u << image | 1u << zero | 1u << resistance | 1u << sums | 1u << SK_FILTER0 | 1u << SK_FILTER1;
    world->plan_stale = true; // its temporaries go
    if (!sk_particles_want(&world->particles, &world->allocator, wanted)) return sk_fail_memory(error, "stability");
    finder f = {.world = world, .run = sk_world_run_context(world)};
    f.run.solve = &f.solve;
    f.builder = (sk_plan_builder){.plan = &f.plan,
                                  .allocator = &world->allocator,
                                  .rules = &world->rules,
                                  .isa = world->isa,
                                  .slot_count = world->particles.slot_count,
                                  .strip_slots = world->particles.strip_slots,
                                  .particle_count = world->particles.count,
                                  .h = 1};
    sk_write_pack(&f.builder); // products go along strips
    if (!f.builder.no_memory) {
        sk_write_pass(&f.builder, &sk_solve_open, (sk_vector)SK_FILTER0, SK_X, (sk_vector)SK_FILTER1, "S");
        run_plan(&f);
        find_modes(&f, stability);
        sk_write_unpack(&f.builder); // there is room for as many ops as packing has
        run_plan(&f);
    }
    sk_release(&world->allocator, f.plan.data);
    sk_release(&world->allocator, f.plan.parts.data);
    return f.builder.no_memory ? sk_fail_memory(error, "stability") : SKEIN_OK;
}

/* ---- what a method makes of a mode ---- */

static double spectral_radius(const double m[4]) {
    double half = (m[0] + m[3]) / 2, determinant = m[0] * m[3] - m[1] * m[2], square = half * half - determinant;
    return square < 0 ? sqrt(determinant) : fabs(half) + sqrt(square);
}

static bool is_stable(const sk_method_type *method, double z, double zeta) {
    double matrix[4];
    method->amplify(z, zeta, matrix);
    return spectral_radius(matrix) <= 1 + 1e-9;
}

/* The largest z = omega h up to which all are stable, of a mode with damping ratio zeta; 0: none. */
static double stable_z(const sk_method_type *method, double zeta) {
    double low = 0.02, high;
    if (zeta > 0) low = fmin(low, fmin(zeta / 2, 0.1 / zeta));
    if (!is_stable(method, low, zeta)) return 0;
    for (high = low; is_stable(method, high, zeta); high *= 1.02)
        if (high > 1e3) return INFINITY;
    low = high / 1.02;
    for (int i = 0; i < 40; i++) {
        double middle = (low + high) / 2;
        *(is_stable(method, middle, zeta) ? &low : &high) = middle;
    }
    return low;
}

double sk_stable_substep(const sk_method_type *method, const skein_stability *stability) {
    double least = INFINITY;
    if (!method->amplify) return least;
    for (size_t i = 0; i < stability->mode_count; i++) {
        double w = stability->modes[i].frequency, c = stability->modes[i].damping_rate;
        // what only damping holds is as a spring far below it
        if (!(w > 1e-3 * c)) w = 1e-3 * c;
        if (w > 0) least = fmin(least, stable_z(method, c / w) / w);
    }
    return least;
}
