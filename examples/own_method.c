/* A method of one's own: Heun's, of second order. It is the mean of two slopes, at the start of a substep and where that
 * one leads. It writes rows, and the library runs them: on all threads, with every force, constraint and collider there
 * is. A swinging spring shows its order: half the substep, a quarter of the error. */
#include <math.h>
#include <skein/kinds.h>
#include <stdio.h>

typedef struct heun_params {
    int32_t substeps;
} heun_params;

static const skein_field fields[] = {
    SKEIN_FIELD_OF_INT(heun_params, substeps, "substeps", "", 20, 1, 100000, "equal parts that a step is cut into"),
};

static void write_heun(skein_plan_builder *w, const void *data, double dt) {
    const heun_params *params = data;
    double h = dt / params->substeps;
    size_t repeat = skein_write_repeat(w, (size_t)params->substeps, h);
    skein_write_steering(w);
    skein_write_forces(w);
    // what the first slope leads to, and half of it kept
    skein_write_sum(w, SKEIN_T0, 1, SKEIN_X, h / 2, SKEIN_V);
    skein_write_sum(w, SKEIN_SAVED_V, 1, SKEIN_V, 0, SKEIN_NO_VECTOR);
    skein_write_kick(w, SKEIN_T1, SKEIN_V, h / 2, SKEIN_F);
    skein_write_sum(w, SKEIN_X, 1, SKEIN_X, h, SKEIN_V);
    skein_write_kick(w, SKEIN_V, SKEIN_V, h, SKEIN_F);
    skein_write_stage_time(w, 1);
    // the second slope, from there
    skein_write_forces(w);
    skein_write_sum(w, SKEIN_X, 1, SKEIN_T0, h / 2, SKEIN_V);
    skein_write_kick(w, SKEIN_V, SKEIN_T1, h / 2, SKEIN_F);
    skein_write_bounds(w);
    skein_write_contacts(w);
    skein_write_end(w, repeat);
}

static const skein_method_type heun = {
    .kind = {"heun", "the mean of two slopes: second order", SKEIN_METHOD, fields, 1, sizeof(heun_params)},
    .write = write_heun,
};

const skein_kind *const skein_module_kinds[] = {&heun.kind, NULL};

/* How far from cos(t) a unit mass on a unit spring is after a second. */
static double error_with(const skein_kinds *kinds, int substeps) {
    skein_world_desc desc = skein_default_world_desc();
    desc.kinds = kinds;
    skein_world *world = skein_world_create(&desc, NULL);
    double x[3] = {1, 0, 0};
    bool good = world && !skein_method_set(world, "heun", SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))) &&
                !skein_particles_add(world, 1, x, NULL, (const double[]){1}, NULL) &&
                !skein_force_add(world, "force_field", SKEIN_SETTINGS(SKEIN_TEXT("force", "-p")), NULL) &&
                !skein_world_step(world, 1) && !skein_positions_copy(world, 0, 1, x);
    if (!good) fprintf(stderr, "own_method: %s\n", skein_world_error(world)->message);
    skein_world_destroy(world);
    return good ? fabs(x[0] - cos(1)) : NAN;
}

int main(void) {
    skein_error error = {SKEIN_OK, "", ""};
    skein_kinds *kinds = skein_kinds_create(&error);
    if (!kinds || skein_kind_register(kinds, &heun.kind, &error))
        return fprintf(stderr, "own_method: %s %s\n", error.where, error.message), 1;
    double coarse = error_with(kinds, 10), fine = error_with(kinds, 20);
    printf("10 substeps: off by %.2e m; 20: %.2e m, %.1f times less\n", coarse, fine, coarse / fine);
    skein_kinds_destroy(kinds);
    return coarse / fine > 3.5 && coarse / fine < 4.5 ? 0 : 1;
}
