/* Gradients of a run: against closed forms, against differences of whole runs, and that they find what was looked for. */
#include <skein/gradient.h>

#include "helpers.h"

#define NUMBER(name_, value_)       \
    {                               \
        name_, {                    \
            1, {value_, 0, 0}, NULL \
        }                           \
    }
#define VECTOR(name_, x_, y_, z_) \
    {                             \
        name_, {                  \
            3, {x_, y_, z_}, NULL \
        }                         \
    }
#define TEXT(name_, text_)      \
    {                           \
        name_, {                \
            0, {0, 0, 0}, text_ \
        }                       \
    }
#define SETTINGS(...) ((const skein_setting[]){__VA_ARGS__, {NULL, {0, {0, 0, 0}, NULL}}})

/* In single precision there is nothing to be tried but that it says so. */
#define ONLY_IN_DOUBLE() \
    if (sizeof(skein_real) != sizeof(double)) skip()

static uint64_t seed = 21;

static double draw(void) { // of [-1, 1)
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(int64_t)seed * 0x1p-63;
}

/* Before each test, so that its directions do not depend on those before it. */
static int seed_anew(void **state) {
    (void)state;
    seed = 21;
    return 0;
}

/* ---- measures ---- */

/* A sum over states of weights times positions and velocities, and of the squares of distances. */
typedef struct weighing {
    size_t steps;
    const double *weights; /* 3 a particle */
    bool all;
    size_t calls;
} weighing;

static double weigh(void *user, const skein_gradient_state *state) {
    weighing *w = user;
    w->calls++;
    if (!w->all && state->step != w->steps) return 0;
    double sum = 0;
    for (size_t i = 0; i < 3 * state->particle_count; i++) {
        double x = state->positions[i], v = state->velocities[i], a = w->weights[i];
        sum += a * x + 0.5 * x * x + 0.1 * a * v + 0.05 * v * v * v;
        state->by_positions[i] = a + x;
        state->by_velocities[i] = 0.1 * a + 0.15 * v * v;
    }
    return sum;
}

/* ---- one spring, in closed form ---- */

/* A body on a spring from a pin, on a line: x'' = -k/m (x - 1) - c/m x' + g. */
static skein_world *one_spring(const char *method, double k, double c, double g) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = 1;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, method, SETTINGS(NUMBER("substeps", 2))));
    const double places[6] = {0, 0, 0, 1, 0, 0}, masses[2] = {0, 0.5};
    OK(world, skein_particles_add(world, 2, places, NULL, masses, NULL));
    OK(world, skein_constraint_add(world, "distance", (const uint32_t[]){0, 1}, 1,
                                   SETTINGS(NUMBER("stiffness", k), NUMBER("damping", c)), NULL));
    OK(world, skein_force_add(world, "gravity", SETTINGS(VECTOR("acceleration", g, 0, 0)), NULL));
    const double moved[3] = {1.2, 0, 0}, speed[3] = {0.3, 0, 0};
    OK(world, skein_positions_set(world, 1, 1, moved));
    OK(world, skein_velocities_set(world, 1, 1, speed));
    return world;
}

static double last_x(void *user, const skein_gradient_state *state) {
    const size_t *steps = user;
    if (state->step != *steps) return 0;
    state->by_positions[3] = 1;
    return state->positions[3];
}

/* Symplectic Euler on it is a linear map of (x, v), whose derivatives by k, c and g are carried along here. */
static void a_spring_has_the_gradient_of_its_map(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    const double k = 40, c = 0.3, g = -1.5, m = 0.5, dt = 0.02, h = dt / 2;
    size_t steps = 25;
    double x = 1.2, v = 0.3, dx[5] = {1, 0, 0, 0, 0}, dv[5] = {0, 1, 0, 0, 0}; // by x0, v0, k, c, g
    for (size_t i = 0; i < 2 * steps; i++) {
        const double own[5] = {0, 0, -(x - 1) / m, -v / m, 1};
        double a = -k / m * (x - 1) - c / m * v + g;
        for (int q = 0; q < 5; q++) dv[q] += h * (-k / m * dx[q] - c / m * dv[q] + own[q]);
        v += h * a, x += h * v;
        for (int q = 0; q < 5; q++) dx[q] += h * dv[q];
    }
    skein_world *world = one_spring("symplectic_euler", k, c, g);
    uint64_t hash = skein_world_hash(world);
    double by_x[6], by_v[6], by_field[5];
    skein_gradient_desc desc = {.dt = dt,
                                .steps = steps,
                                .measure = last_x,
                                .user = &steps,
                                .fields = (const char *const[]){"constraints.0.stiffness", "constraints.0.damping",
                                                                "forces.0.acceleration", NULL}};
    skein_gradient_result result = {0, by_x, by_v, by_field};
    OK(world, skein_gradient(world, &desc, &result));
    assert_true(fabs(result.value - x) < 1e-12);
    const double got[5] = {by_x[3], by_v[3], by_field[0], by_field[1], by_field[2]};
    for (int q = 0; q < 5; q++)
        if (fabs(got[q] - dx[q]) > 1e-8 * (1e-3 + fabs(dx[q]))) fail_msg("%d: %.12g, not %.12g", q, got[q], dx[q]);
    assert_true(fabs(by_field[3]) < 1e-9 && fabs(by_field[4]) < 1e-9); // it stays on its line
    assert_true(hash == skein_world_hash(world) && skein_world_time(world) == 0);
    skein_world_destroy(world);
}

/* A rope with damping, slack and taut by turns: its map has two branches, and the derivative is that of the one that was taken.
 * Slack it neither pulls nor damps. */
static void a_rope_has_the_gradient_of_the_branch_it_takes(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    const double k = 40, c = 0.3, g = 1.5, m = 0.5, dt = 0.02, h = dt / 2;
    size_t steps = 60, taut = 0;
    double x = 1.2, v = 0.3, dx[5] = {1, 0, 0, 0, 0}, dv[5] = {0, 1, 0, 0, 0}; // by x0, v0, k, c, g
    for (size_t i = 0; i < 2 * steps; i++) {
        bool pulls = x > 1;
        double kk = pulls ? k : 0, cc = pulls ? c : 0;
        const double own[5] = {0, 0, pulls ? -(x - 1) / m : 0, pulls ? -v / m : 0, 1};
        double a = -kk / m * (x - 1) - cc / m * v + g;
        for (int q = 0; q < 5; q++) dv[q] += h * (-kk / m * dx[q] - cc / m * dv[q] + own[q]);
        v += h * a, x += h * v;
        for (int q = 0; q < 5; q++) dx[q] += h * dv[q];
        taut += pulls;
    }
    assert_true(taut > 20 && taut < 2 * steps - 20); // both were taken
    skein_world *world = one_spring("symplectic_euler", k, c, g);
    OK(world, skein_remove(world, skein_object_at(world, SKEIN_CONSTRAINT, 0)));
    OK(world, skein_constraint_add(world, "formula", (const uint32_t[]){0, 1}, 1,
                                   SETTINGS(TEXT("constraint", "1 - length(p0 - p1) >= 0"), NUMBER("stiffness", k),
                                            NUMBER("damping", c)),
                                   NULL));
    double by_x[6], by_v[6], by_field[5];
    skein_gradient_desc desc = {.dt = dt,
                                .steps = steps,
                                .measure = last_x,
                                .user = &steps,
                                .fields = (const char *const[]){"constraints.0.stiffness", "constraints.0.damping",
                                                                "forces.0.acceleration", NULL}};
    skein_gradient_result result = {0, by_x, by_v, by_field};
    OK(world, skein_gradient(world, &desc, &result));
    assert_true(fabs(result.value - x) < 1e-10);
    const double got[5] = {by_x[3], by_v[3], by_field[0], by_field[1], by_field[2]};
    for (int q = 0; q < 5; q++)
        if (fabs(got[q] - dx[q]) > 1e-7 * (1e-3 + fabs(dx[q]))) fail_msg("%d: %.12g, not %.12g", q, got[q], dx[q]);
    skein_world_destroy(world);
}

/* ---- a hanging cloth ---- */

enum { SIDE = 20, FRAMES = 120 };

static const char *const fields[] = {"bodies.0.stretch.stiffness",
                                     "bodies.0.shear.stiffness",
                                     "bodies.0.bend.rigidity",
                                     "forces.0.acceleration",
                                     "forces.1.rate",
                                     "bodies.0.stretch.damping",
                                     NULL};
enum { FIELD_NUMBERS = 8, STEEL = 3 };

/* It swings from its top edge, or its corners: then it folds, and soon no difference of runs is small enough. */
static skein_world *cloth(const char *method, uint32_t side, int substeps, const char *pins, double drag,
                          double damping) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = 1;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    bool solves =
        !strcmp(method, "backward_euler"); // to the last digits, so that differences of runs are what they seem
    OK(world, skein_method_set(world, method,
                               SETTINGS(NUMBER("substeps", substeps),
                                        NUMBER(solves ? "tolerance" : "substeps", solves ? 1e-10 : substeps))));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SETTINGS({"grid", {2, {side, side, 0}, NULL}}, TEXT("pins", pins),
                                      VECTOR("rotation", 60, 0, 0), NUMBER("stretch.tether", (double)INFINITY),
                                      NUMBER("stretch.stiffness", 100), NUMBER("shear.stiffness", 20),
                                      NUMBER("bend.rigidity", 1e-4), NUMBER("stretch.damping", damping)),
                             NULL));
    OK(world, skein_force_add(world, "gravity", SETTINGS(VECTOR("acceleration", 0, -9.81, 0)), NULL));
    OK(world, skein_force_add(world, "drag", SETTINGS(NUMBER("rate", drag)), NULL));
    return world;
}

static double numbers_of(skein_world *world, double *numbers) {
    size_t n = 0;
    for (size_t i = 0; fields[i]; i++) {
        skein_value value;
        OK(world, skein_get_path(world, fields[i], &value));
        for (int k = 0; k < value.count; k++) numbers[n++] = value.number[k];
    }
    assert_int_equal(n, FIELD_NUMBERS);
    return 0;
}

static void set_numbers(skein_world *world, const double *numbers) {
    for (size_t i = 0, n = 0; fields[i]; i++) {
        skein_value value;
        OK(world, skein_get_path(world, fields[i], &value));
        for (int k = 0; k < value.count; k++) value.number[k] = numbers[n++];
        OK(world, skein_set_path(world, fields[i], value));
    }
}

/* The measure by running it, from places and velocities moved along a direction, and fields too. */
static double run_moved(skein_world *world, weighing *w, double dt, const double *x, const double *v, const double *f,
                        const double *dx, const double *dv, const double *df, double e) {
    size_t count = skein_particle_count(world);
    double *at = malloc(12 * count * sizeof *at), *speed = at + 3 * count, *by = speed + 3 * count,
           moved[FIELD_NUMBERS], sum = 0;
    OK(world, skein_world_reset(world));
    for (size_t i = 0; i < 3 * count; i++) at[i] = x[i] + e * dx[i], speed[i] = v[i] + e * dv[i];
    for (int i = 0; i < FIELD_NUMBERS; i++) moved[i] = f[i] + e * df[i];
    set_numbers(world, moved);
    OK(world, skein_positions_set(world, 0, count, at));
    OK(world, skein_velocities_set(world, 0, count, speed));
    for (size_t step = 0; step <= w->steps; step++) {
        if (step) OK(world, skein_world_step(world, dt));
        OK(world, skein_positions_copy(world, 0, count, at));
        OK(world, skein_velocities_copy(world, 0, count, speed));
        skein_gradient_state state = {step, 0, count, at, speed, by, by + 3 * count};
        sum += weigh(w, &state);
    }
    set_numbers(world, f);
    free(at);
    return sum;
}

/* Bends and stretches it a little, so that no multiplier pulls at a fold that is not there. */
static void disturb(skein_world *world, double most) {
    size_t count = skein_particle_count(world);
    double *x = malloc(3 * count * sizeof *x);
    OK(world, skein_positions_copy(world, 0, count, x));
    for (size_t i = 0; i < 3 * count; i++) x[i] += most * draw();
    OK(world, skein_positions_set(world, 0, count, x));
    free(x);
}

/* Random directions through positions, velocities and fields, against central differences of whole runs: the worst error, of twenty as a
 * share of the derivative itself; of a few of at least a hundredth of its terms, for where they cancel, differences say no more. */
static double worst_direction(skein_world *world, size_t steps, double dt, bool all, int directions, size_t most_bytes) {
    size_t count = skein_particle_count(world);
    double *room = malloc(21 * count * sizeof *room), *x = room, *v = x + 3 * count, *by_x = v + 3 * count,
           *by_v = by_x + 3 * count, *dx = by_v + 3 * count, *dv = dx + 3 * count, *weights = dv + 3 * count;
    double f[FIELD_NUMBERS], by_f[FIELD_NUMBERS], df[FIELD_NUMBERS], worst = 0;
    for (size_t i = 0; i < 3 * count; i++) weights[i] = draw();
    weighing w = {steps, weights, all, 0};
    OK(world, skein_positions_copy(world, 0, count, x));
    OK(world, skein_velocities_copy(world, 0, count, v));
    numbers_of(world, f);
    skein_gradient_desc desc = {
        .dt = dt, .steps = steps, .measure = weigh, .user = &w, .fields = fields, .most_bytes = most_bytes};
    skein_gradient_result result = {0, by_x, by_v, by_f};
    OK(world, skein_gradient(world, &desc, &result));
    assert_int_equal(w.calls, steps + 1);
    for (int d = 0; d < directions; d++) {
        double ought = 0, scale = 0, slope[2];
        for (size_t i = 0; i < 3 * count; i++) {
            dx[i] = 0.01 * draw(), dv[i] = 0.1 * draw();
            ought += dx[i] * by_x[i] + dv[i] * by_v[i];
            scale += fabs(dx[i] * by_x[i]) + fabs(dv[i] * by_v[i]);
        }
        for (int i = 0; i < FIELD_NUMBERS; i++) {
            df[i] = (fabs(f[i]) + (i >= 3 && i <= 5)) * draw();
            ought += df[i] * by_f[i];
            scale += fabs(df[i] * by_f[i]);
        }
        for (int k = 0; k < 2; k++) { // two widths, and what they say of none
            double e = 2e-5 / (k + 1);
            slope[k] =
                (run_moved(world, &w, dt, x, v, f, dx, dv, df, e) - run_moved(world, &w, dt, x, v, f, dx, dv, df, -e)) /
                (2 * e);
        }
        double extrapolated = (4 * slope[1] - slope[0]) / 3, least = directions < 20 ? 0.01 * scale : 0,
               error = fabs(extrapolated - ought) / fmax(fabs(ought), least);
        if (getenv("SKEIN_GRADIENT_SAYS"))
            print_message("direction %d: %.12g, by differences %.12g, off by %.2g (terms of %.3g)\n", d, ought,
                          extrapolated, error, scale);
        worst = fmax(worst, error);
    }
    OK(world, skein_world_reset(world));
    free(room);
    return worst;
}

static void a_hanging_cloth_agrees_with_differences(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    for (int all = 0; all < 4; all++) {
        skein_world *world = cloth(all < 2 ? "symplectic_euler" : "xpbd", SPARING ? 8 : SIDE, 10, "top edge", 2, 0);
        double worst = worst_direction(world, SPARING ? 10 : FRAMES, 1 / 60.0, all % 2, all % 2 ? 2 : 20, 0);
        if (!(worst < 1e-6)) fail_msg("off by %g", worst);
        skein_world_destroy(world);
    }
}

/* SKEIN_GRADIENT_WHOLE=1 runs all 120 frames of 20 x 20 with backward Euler in all directions: eight minutes of processor time, nearly all
 * of it for the differences. */
#define WHOLE (getenv("SKEIN_GRADIENT_WHOLE") != NULL)

static void backward_euler_agrees_with_differences(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    for (int all = 0; all < 2; all++) {
        skein_world *world = cloth("backward_euler", WHOLE ? SIDE : 7, 2, "top edge", 2, all ? 0.05 : 0);
        double worst = worst_direction(world, WHOLE ? FRAMES : 15, 1 / 60.0, all, all ? 2 : 20, 0);
        if (!(worst < 1e-6)) fail_msg("off by %g", worst);
        skein_world_destroy(world);
    }
}

/* The measure from a start that is moved along a direction of positions, velocities and numbers of fields. */
static double run_from(skein_world *world, weighing *w, const char *const *paths, const double *x, const double *f,
                       const double *along, double e) {
    size_t count = skein_particle_count(world), fields_from = 6 * count;
    double *at = malloc(12 * count * sizeof *at), sum = 0;
    OK(world, skein_world_reset(world));
    for (size_t i = 0; i < 6 * count; i++) at[i] = x[i] + e * along[i];
    for (size_t i = 0; paths[i]; i++)
        OK(world, skein_set_path(world, paths[i], skein_number(f[i] * (1 + e * along[fields_from + i]))));
    OK(world, skein_positions_set(world, 0, count, at));
    OK(world, skein_velocities_set(world, 0, count, at + 3 * count));
    for (size_t step = 0; step <= w->steps; step++) {
        if (step) OK(world, skein_world_step(world, 0.02));
        OK(world, skein_positions_copy(world, 0, count, at));
        OK(world, skein_velocities_copy(world, 0, count, at + 3 * count));
        skein_gradient_state state = {step, 0, count, at, at + 3 * count, at + 6 * count, at + 9 * count};
        sum += weigh(w, &state);
    }
    for (size_t i = 0; paths[i]; i++) OK(world, skein_set_path(world, paths[i], skein_number(f[i])));
    free(at);
    return sum;
}

/* How far the gradient is from central differences in four directions, at the worst, of the largest. */
static double worst_of_small(skein_world *world, const char *const *paths, size_t steps) {
    enum { MOST = 12, MOST_FIELDS = 4 };
    size_t count = skein_particle_count(world), fields_from = 6 * count, n = 0;
    double x[6 * MOST], by[6 * MOST + MOST_FIELDS], along[6 * MOST + MOST_FIELDS], weights[3 * MOST], f[MOST_FIELDS],
        worst = 0, most = 0;
    assert_true(count <= MOST);
    for (; paths[n]; n++) {
        skein_value value;
        OK(world, skein_get_path(world, paths[n], &value));
        f[n] = value.number[0];
    }
    for (size_t i = 0; i < 3 * count; i++) weights[i] = draw();
    OK(world, skein_positions_copy(world, 0, count, x));
    OK(world, skein_velocities_copy(world, 0, count, x + 3 * count));
    weighing w = {steps, weights, true, 0};
    skein_gradient_desc desc = {.dt = 0.02, .steps = steps, .measure = weigh, .user = &w, .fields = paths};
    skein_gradient_result result = {0, by, by + 3 * count, by + fields_from};
    OK(world, skein_gradient(world, &desc, &result));
    for (int d = 0; d < 4; d++) {
        double ought = 0, slope[2];
        for (size_t i = 0; i < fields_from + n; i++) {
            along[i] = draw();
            ought += along[i] * by[i] * (i < fields_from ? 1 : f[i - fields_from]);
        }
        for (int k = 0; k < 2; k++) {
            double e = 2e-5 / (k + 1);
            slope[k] =
                (run_from(world, &w, paths, x, f, along, e) - run_from(world, &w, paths, x, f, along, -e)) / (2 * e);
        }
        double extrapolated = (4 * slope[1] - slope[0]) / 3;
        worst = fmax(worst, fabs(extrapolated - ought)), most = fmax(most, fabs(ought));
        if (getenv("SKEIN_GRADIENT_SAYS"))
            print_message("direction %d: %.12g, by differences %.12g\n", d, ought, extrapolated);
    }
    return worst / most;
}

/* A few particles, some pinned, with one kind of constraint under XPBD, of which each has an element. */
static void every_kind_agrees_under_projections(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    static const double places[8][3] = {{0, 0, 0},       {1, 0.1, 0},     {0.2, 1, 0.1},   {0.9, 0.8, 0.6},
                                        {0.4, 0.3, 1.1}, {1.3, 0.2, 1.2}, {0.1, 1.2, 0.9}, {1.1, 1.3, 1.4}};
    static const struct {
        const char *kind, *text;
        size_t arity;
        double stiffness, damping, moved;
    } cases[] = {{"distance", NULL, 2, 300, 2, 0.05},
                 {"distance", NULL, 2, (double)INFINITY, 0, 0.05},
                 {"angle", NULL, 3, 20, 0.1, 0.05},
                 {"area", NULL, 3, 200, 1, 0.05},
                 {"dihedral", NULL, 4, 20, 0.1, 0.05},
                 {"dihedral", NULL, 4, 3e4, 20, 1}, // some turn by as much as is done at once
                 {"volume", NULL, 4, 3000, 3, 0.05},
                 {"straight", NULL, 3, 20, 0.1, 0.05},
                 {"isometric", NULL, 4, 20, 0.1, 0.05},
                 {"twist", NULL, 4, 20, 0.1, 0.05},
                 {"attachment", NULL, 4, 200, 1, 0.05},
                 {"formula", "rest(length(p0 - p1)) >= length(p0 - p1)", 2, 300, 0, 0.05},
                 {"formula", "dot(p0 - p1, p2 - p1) - rest(dot(p0 - p1, p2 - p1)) + 0.1 * sin(4 * t)", 3, 100, 0, 0.05}};
    for (size_t c = 0; c < 2 * COUNT(cases); c++) {
        size_t i = c / 2, arity = cases[i].arity;
        skein_world_desc desc = skein_default_world_desc();
        desc.thread_count = 1;
        skein_world *world = skein_world_create(&desc, NULL);
        OK(world, skein_method_set(world, "xpbd", SETTINGS(NUMBER("substeps", 3), NUMBER("iterations", c % 2 ? 3 : 1))));
        double masses[8] = {0, 0.5, 0.4, 0.7, 0.3, 0.6, 0.5, 0.8}, x[24];
        OK(world, skein_particles_add(world, 8, places[0], NULL, masses, NULL));
        uint32_t of[32];
        for (size_t e = 0; e + arity <= 8; e++)
            for (size_t k = 0; k < arity; k++) of[e * arity + k] = (uint32_t)(e + k);
        const skein_setting settings[] = {NUMBER("stiffness", cases[i].stiffness),
                                          NUMBER("damping", c % 2 ? cases[i].damping : 0),
                                          cases[i].text ? (skein_setting)TEXT("constraint", cases[i].text)
                                                        : (skein_setting){NULL, {0, {0, 0, 0}, NULL}},
                                          {NULL, {0, {0, 0, 0}, NULL}}};
        OK(world, skein_constraint_add(world, cases[i].kind, of, 9 - arity, settings, NULL));
        OK(world, skein_force_add(world, "gravity", SETTINGS(VECTOR("acceleration", 1, -5, 2)), NULL));
        OK(world, skein_force_add(world, "drag", SETTINGS(NUMBER("linear", 0.1)), NULL));
        for (int k = 0; k < 24; k++) x[k] = places[0][k] + cases[i].moved * draw();
        OK(world, skein_positions_set(world, 0, 8, x));
        bool rigid = isinf(cases[i].stiffness), damped = c % 2 && cases[i].damping > 0;
        const char *const paths[] = {"forces.1.linear", rigid ? NULL : "constraints.0.stiffness",
                                     damped ? "constraints.0.damping" : NULL, NULL};
        double worst = worst_of_small(world, paths, 12);
        // a loaded attachment is differentiated beside a kink, in narrower steps
        double most = !strcmp(cases[i].kind, "attachment") ? 1e-6 : 1e-7;
        if (!(worst < most))
            fail_msg("%s %s, %s, is off by %g", cases[i].kind, cases[i].text ? cases[i].text : "",
                     c % 2 ? "three passes" : "one", worst);
        skein_world_destroy(world);
    }
}

/* Position methods: XPBD at one pass and at several, where multipliers are kept; with damping; PBD, whose passes share. */
static void projections_agree_with_differences(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    static const struct {
        const char *method;
        int iterations;
        double damping;
    } cases[] = {{"xpbd", 1, 0}, {"xpbd", 1, 0.05}, {"xpbd", 3, 0}, {"xpbd", 3, 0.05}, {"pbd", 1, 0}, {"pbd", 2, 0.05}};
    for (size_t c = 0; c < COUNT(cases); c++) {
        skein_world *world = cloth(cases[c].method, 6, 10, "top edge", 2, cases[c].damping);
        OK(world, skein_set_path(world, "method.iterations", skein_number(cases[c].iterations)));
        disturb(world, 0.01);
        double worst = worst_direction(world, 12, 1 / 60.0, c % 2, 4, c % 2);
        if (!(worst < 1e-6))
            fail_msg("%s, %d passes, damping %g: off by %g", cases[c].method, cases[c].iterations, cases[c].damping,
                     worst);
        skein_world_destroy(world);
    }
}

static void other_methods_and_damping_agree_too(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    static const char *const methods[] = {"symplectic_euler", "explicit_euler", "leapfrog", "midpoint", "rk4"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world = cloth(methods[m], 7, m == 1 ? 100 : 10, "top corners", 0.5, 0.05);
        double worst = worst_direction(world, 12, 1 / 60.0, true, 4, 0);
        if (!(worst < 1e-6)) fail_msg("%s is off by %g", methods[m], worst);
        skein_world_destroy(world);
    }
}

/* A measure of a run that has none, in these words; the world is as it was. */
static void fails(skein_world *world, const char *const *paths, const char *words) {
    double weights[300] = {0};
    weighing w = {2, weights, false, 0};
    skein_gradient_desc desc = {.dt = 0.01, .steps = 2, .measure = weigh, .user = &w, .fields = paths};
    skein_gradient_result result = {0};
    uint64_t hash = skein_world_hash(world);
    assert_true(skein_gradient(world, &desc, &result) != SKEIN_OK);
    const skein_error *error = skein_world_error(world);
    if (!strstr(error->message, words) && !strstr(error->where, words))
        fail_msg("'%s: %s' has no '%s'", error->where, error->message, words);
    assert_true(hash == skein_world_hash(world));
}

/* Pins that a motion leads are where it says, wherever they began, and pull the others along. */
static void a_cloth_is_led(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    static const char *const methods[] = {"symplectic_euler", "backward_euler"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world = cloth(methods[m], 6, m ? 2 : 10, "top corners", 0.5, 0);
        OK(world, skein_motion_add(world, "turn", NULL, SETTINGS(NUMBER("speed", 2)), NULL));
        double worst = worst_direction(world, 9, 1 / 60.0, true, 4, m); // with checkpoints, too
        if (!(worst < 1e-6)) fail_msg("%s is off by %g", methods[m], worst);
        OK(world, skein_set_path(world, "motions.0.inertia", skein_number(0.5)));
        fails(world, NULL, "carries along");
        skein_world_destroy(world);
    }
}

/* Whether all states are kept or most are computed once more: the same numbers. */
static void checkpoints_change_nothing(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    skein_world *world = cloth("symplectic_euler", 6, 8, "top corners", 0.5, 0);
    size_t count = skein_particle_count(world);
    double *by[2], weights[108];
    for (size_t i = 0; i < COUNT(weights); i++) weights[i] = draw();
    for (int k = 0; k < 2; k++) {
        by[k] = calloc(6 * count + FIELD_NUMBERS, sizeof **by);
        weighing w = {23, weights, true, 0};
        skein_gradient_desc desc = {
            .dt = 0.01, .steps = 23, .measure = weigh, .user = &w, .fields = fields, .most_bytes = k};
        skein_gradient_result result = {0, by[k], by[k] + 3 * count, by[k] + 6 * count};
        OK(world, skein_gradient(world, &desc, &result));
    }
    assert_memory_equal(by[0], by[1], (6 * count + FIELD_NUMBERS) * sizeof **by);
    free(by[0]), free(by[1]);
    skein_world_destroy(world);
}

/* ---- finding stiffnesses ---- */

/* Squares of distances to where another cloth was, in every fourth frame. */
typedef struct target {
    const double *places;
    size_t count;
} target;

static double distance(void *user, const skein_gradient_state *state) {
    const target *t = user;
    double sum = 0;
    if (state->step % 4) return 0;
    for (size_t i = 0; i < 3 * t->count; i++) {
        double d = state->positions[i] - t->places[state->step * 3 * t->count + i];
        sum += d * d;
        state->by_positions[i] = 2 * d;
    }
    return sum;
}

static void set_stiffnesses(skein_world *world, const double logs[3]) {
    for (int i = 0; i < 3; i++) OK(world, skein_set_path(world, fields[i], skein_number(exp(logs[i]))));
}

/* The measure and its derivative by the logarithms of the three. */
static double measure_at(skein_world *world, target *t, size_t steps, const double logs[3], double slope[3]) {
    const char *const three[] = {fields[0], fields[1], fields[2], NULL};
    OK(world, skein_world_reset(world));
    set_stiffnesses(world, logs);
    skein_gradient_desc desc = {.dt = 1 / 60.0, .steps = steps, .measure = distance, .user = t, .fields = three};
    skein_gradient_result result = {.by_field = slope};
    OK(world, skein_gradient(world, &desc, &result));
    for (int i = 0; i < 3; i++) slope[i] *= exp(logs[i]);
    return result.value;
}

/* BFGS from three times, and a third of, what they are: within 1 % after 20 iterations. */
static void three_stiffnesses_are_found(void **state) {
    (void)state;
    ONLY_IN_DOUBLE();
    const size_t steps = 40;
    skein_world *world = cloth("symplectic_euler", SPARING ? 5 : 12, 10, "top corners", 0.5, 0);
    size_t count = skein_particle_count(world);
    const double truth[3] = {log(100), log(20), log(1e-4)};
    double *places = malloc((steps + 1) * 3 * count * sizeof *places);
    for (size_t s = 0; s <= steps; s++) {
        if (s) OK(world, skein_world_step(world, 1 / 60.0));
        OK(world, skein_positions_copy(world, 0, count, places + 3 * count * s));
    }
    target t = {places, count};
    double at[3] = {log(100 / 3.0), log(60), log(1e-4 / 3)}, slope[3], inverse[3][3] = {{0}};
    double value = measure_at(world, &t, steps, at, slope);
    for (int i = 0; i < 3; i++)
        inverse[i][i] = 0.3 / sqrt(slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2]);
    int iterations = 0;
    for (; iterations < 20; iterations++) {
        double way[3], next[3], new_slope[3], new_value = 0, part = 1, down = 0;
        for (int i = 0; i < 3; i++) {
            way[i] = 0;
            for (int k = 0; k < 3; k++) way[i] -= inverse[i][k] * slope[k];
            down += way[i] * slope[i];
        }
        for (int tries = 0; tries < 12; tries++, part /= 2) {
            for (int i = 0; i < 3; i++) next[i] = at[i] + part * fmax(-1, fmin(1, way[i]));
            new_value = measure_at(world, &t, steps, next, new_slope);
            if (new_value <= value + 1e-4 * part * down) break;
        }
        double s[3], y[3], sy = 0, hy[3] = {0}, yhy = 0;
        for (int i = 0; i < 3; i++) s[i] = next[i] - at[i], y[i] = new_slope[i] - slope[i], sy += s[i] * y[i];
        double yy = y[0] * y[0] + y[1] * y[1] + y[2] * y[2];
        for (int i = 0; i < 3 && !iterations && sy > 0; i++)
            for (int k = 0; k < 3; k++) inverse[i][k] = i == k ? sy / yy : 0;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) hy[i] += inverse[i][k] * y[k];
        for (int i = 0; i < 3; i++) yhy += y[i] * hy[i];
        for (int i = 0; i < 3 && sy > 0; i++)
            for (int k = 0; k < 3; k++)
                inverse[i][k] += (1 + yhy / sy) * s[i] * s[k] / sy - (hy[i] * s[k] + s[i] * hy[k]) / sy;
        memcpy(at, next, sizeof at), memcpy(slope, new_slope, sizeof slope);
        value = new_value;
        if (getenv("SKEIN_GRADIENT_SAYS"))
            print_message("%2d: %.4g: %.6g %.6g %.6g\n", iterations + 1, value, exp(at[0]), exp(at[1]), exp(at[2]));
        bool found = true;
        for (int i = 0; i < 3; i++) found &= fabs(at[i] - truth[i]) < 0.01;
        if (found) break;
    }
    for (int i = 0; i < 3; i++)
        if (!(fabs(at[i] - truth[i]) < 0.01))
            fail_msg("%s is found as %g, not %g", fields[i], exp(at[i]), exp(truth[i]));
    free(places);
    skein_world_destroy(world);
}

/* ---- what has none ---- */

static void what_has_no_gradient_says_so(void **state) {
    (void)state;
    skein_world *world = cloth("symplectic_euler", 4, 4, "top corners", 0.5, 0);
    if (sizeof(skein_real) != sizeof(double)) {
        fails(world, NULL, "double precision");
        skein_world_destroy(world);
        return;
    }
    fails(world, (const char *const[]){"bodies.0.stretch.stifness", NULL}, "stifness");
    fails(world, (const char *const[]){"bodies.0.bend.stiffness", NULL}, "shapes what is already built");
    fails(world, (const char *const[]){"bodies.0.stretch.limit", NULL}, "infinite");
    fails(world, (const char *const[]){"method.substeps", NULL}, "expected a whole number");
    OK(world, skein_method_set(world, "pbd", SETTINGS(NUMBER("inertia", 0))));
    fails(world, NULL, "has no gradient yet"); // it moves no velocities
    OK(world, skein_method_set(world, "xpbd", NULL));
    OK(world, skein_set_path(world, "bodies.0.stretch.tether", skein_number(1.02)));
    fails(world, NULL, "tether");
    OK(world, skein_set_path(world, "bodies.0.stretch.tether", skein_number((double)INFINITY)));
    OK(world, skein_constraint_add(world, "energy", (const uint32_t[]){10, 0}, 1, NULL, NULL));
    fails(world, NULL, "an energy has no gradient");
    OK(world, skein_remove(world, skein_object_at(world, SKEIN_CONSTRAINT, 0)));
    OK(world, skein_constraint_add(world, "formula", (const uint32_t[]){10, 9}, 1,
                                   SETTINGS(TEXT("constraint", "length(p0 - p1 - rest(p0 - p1))")), NULL));
    fails(world, NULL, "has a kink");
    OK(world, skein_remove(world, skein_object_at(world, SKEIN_CONSTRAINT, 0)));
    OK(world, skein_method_set(world, "symplectic_euler", NULL));
    OK(world, skein_collider_add(world, "plane", NULL, NULL));
    fails(world, NULL, "has no gradient yet");
    skein_world_destroy(world);
}

#define ON_ITS_OWN(test_) cmocka_unit_test_setup(test_, seed_anew)

int main(void) {
    const struct CMUnitTest tests[] = {
        ON_ITS_OWN(a_spring_has_the_gradient_of_its_map),
        ON_ITS_OWN(a_rope_has_the_gradient_of_the_branch_it_takes),
        ON_ITS_OWN(a_hanging_cloth_agrees_with_differences),
        ON_ITS_OWN(backward_euler_agrees_with_differences),
        ON_ITS_OWN(every_kind_agrees_under_projections),
        ON_ITS_OWN(projections_agree_with_differences),
        ON_ITS_OWN(other_methods_and_damping_agree_too),
        ON_ITS_OWN(a_cloth_is_led),
        ON_ITS_OWN(checkpoints_change_nothing),
        ON_ITS_OWN(three_stiffnesses_are_found),
        ON_ITS_OWN(what_has_no_gradient_says_so),
    };
    if (getenv("SKEIN_TEST_ONLY")) cmocka_set_test_filter(getenv("SKEIN_TEST_ONLY"));
    return cmocka_run_group_tests(tests, NULL, NULL);
}
