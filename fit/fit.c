/* The module "fit": see fit.h.
 *
 *   z, a real number for each that is varied  --set_numbers-->  fields  --skein_gradient-->  misfit and its derivatives
 *
 * L-BFGS (liblbfgs: Nocedal's, with a backtracking search for the strong Wolfe conditions) knows no bounds, and no runs that
 * fail: bounds are in how z becomes a number, and a run that fails, or numbers that leap, are infinitely far from the target,
 * so that the search steps back. */
#include "fit/fit.h"

#include <lbfgs.h>
#include <math.h>
#include <skein/gradient.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/module.h"
#include "io/scene.h"

/* Between two tries a number changes at most by so much, in its logarithm, say: by a factor of 20. */
static const double leap = 3;
/* m, from the target: nothing moves so far but what blows up. */
static const double farthest = 1e6;

typedef struct fit {
    const fit_request *request;
    fit_outcome *outcome;
    skein_world *world;
    const char **paths;                     /* of the fields, ended by NULL */
    double *best, *last, *numbers, *slopes; /* of each number: z; and its value and the derivative by it */
    double *scale;                          /* what z is multiplied by; 0: it is the logarithm */
    double mean;                            /* one over how many distances there are */
    double unit;                            /* m^2, the first run's mean: what L-BFGS sees begins at 1 */
    size_t sample;                          /* while a run is measured: samples from here on are done */
    skein_error *error;
    bool stopped, failed, first;
} fit;

/* ---- z and numbers ---- */

/* What z stands for: the number itself or its logarithm, with two bounds as a share of the way from one to the other. */
static double number_at(const fit *f, size_t i, double z) {
    const fit_number *n = &f->outcome->numbers[i];
    const fit_field *field = &f->request->fields[n->field];
    double least = field->least, most = field->most, x = n->began;
    bool log_scale = f->scale[i] == 0;
    if (isfinite(least) && isfinite(most)) {
        double a = log_scale ? log(least) : least, b = log_scale ? log(most) : most, at = log_scale ? log(x) : x;
        double share = 1 / (1 + (b - at) / (at - a) * exp(-4 * z / (b - a) * (log_scale ? 1 : f->scale[i])));
        return log_scale ? exp(a + (b - a) * share) : a + (b - a) * share;
    }
    if (isfinite(least)) return least + (x - least) * exp(z);
    if (isfinite(most)) return most - (most - x) * exp(-z);
    return log_scale ? x * exp(z) : x + f->scale[i] * z;
}

/* How it changes with z: these are smooth, and as exact as a search needs. */
static double slope_at(const fit *f, size_t i, double z) {
    double h = 1e-5;
    return (number_at(f, i, z + h) - number_at(f, i, z - h)) / (2 * h);
}

/* Sets all fields to numbers; false after the error of a field that does not take one. */
static bool set_numbers(fit *f, const double *numbers) {
    skein_value value = {0};
    for (size_t i = 0; i < f->outcome->count; i++) {
        const fit_number *n = &f->outcome->numbers[i];
        const char *path = f->paths[n->field];
        if (!n->component && skein_get_path(f->world, path, &value)) return false;
        value.number[n->component] = numbers[i];
        bool whole = i + 1 == f->outcome->count || !f->outcome->numbers[i + 1].component;
        if (whole && skein_set_path(f->world, path, value)) return false;
    }
    return true;
}

/* ---- the misfit of one run ---- */

static double measure(void *user, const skein_gradient_state *state) {
    fit *f = user;
    const fit_request *r = f->request;
    while (f->sample && r->steps[f->sample - 1] > state->step) f->sample--; // from the last to the first
    if (!f->sample || r->steps[f->sample - 1] != state->step) return 0;
    const double *places = r->places + 3 * r->particle_count * --f->sample;
    double sum = 0;
    for (size_t i = 0; i < 3 * r->particle_count; i++) {
        size_t at = 3 * (size_t)r->particles[i / 3] + i % 3;
        double d = state->positions[at] - places[i];
        sum += f->mean * d * d;
        state->by_positions[at] += 2 * f->mean * d;
    }
    return sum;
}

/* The mean squared distance with these numbers; INFINITY where they cannot be run. */
static double run_with(fit *f, const double *numbers) {
    const fit_request *r = f->request;
    skein_gradient_desc desc = {
        .dt = r->dt, .steps = r->steps[r->sample_count - 1], .measure = measure, .user = f, .fields = f->paths};
    skein_gradient_result result = {.by_field = f->slopes};
    f->sample = r->sample_count;
    f->outcome->evaluations++;
    skein_status status = skein_world_reset(f->world);
    if (!status && set_numbers(f, numbers)) status = skein_gradient(f->world, &desc, &result);
    else if (!status) status = skein_world_error(f->world)->status;
    if (!status && result.value < farthest * farthest) return result.value;
    bool mine = status == SKEIN_ERROR_MEMORY; // and of the first run any fault is
    skein_error blown = {SKEIN_ERROR_VALUE, "", "the run blew up: begin with other numbers, or with more substeps"};
    if (f->first || mine) {
        const skein_error *why = status ? skein_world_error(f->world) : &blown;
        io_error_set(f->error, why->status, r->path, "the run that it begins with has no gradient: %s%s%s", why->where,
                     why->where[0] ? ": " : "", why->message);
        f->failed = true;
    }
    return INFINITY;
}

/* ---- L-BFGS's calls ---- */

static void tell(fit *f, bool moved) {
    fit_outcome *o = f->outcome;
    fit_state state = {o->iterations, o->evaluations, moved, o->misfit, o->numbers, o->count};
    f->stopped |= f->request->go_on && !f->request->go_on(f->request->user, &state);
}

static lbfgsfloatval_t evaluate(void *user, const lbfgsfloatval_t *z, lbfgsfloatval_t *slope, const int count,
                                const lbfgsfloatval_t step) {
    fit *f = user;
    (void)step;
    bool near = true;
    for (int i = 0; i < count; i++) {
        slope[i] = 0;
        near &= fabs(z[i] - f->last[i]) <= leap;
        f->numbers[i] = number_at(f, (size_t)i, z[i]);
    }
    if (f->stopped || f->failed || !near) return INFINITY;
    double mean = run_with(f, f->numbers);
    if (f->first) f->unit = mean > 0 && isfinite(mean) ? mean : 1, f->outcome->began = sqrt(mean);
    if (f->first || mean < f->outcome->misfit * f->outcome->misfit) {
        f->outcome->misfit = sqrt(mean);
        for (int i = 0; i < count; i++) f->outcome->numbers[i].found = f->numbers[i], f->best[i] = z[i];
    }
    f->first = false;
    if (isfinite(mean))
        for (int i = 0; i < count; i++) slope[i] = f->slopes[i] * slope_at(f, (size_t)i, z[i]) / f->unit;
    if (!f->failed) tell(f, false);
    return mean / f->unit;
}

static int went_on(void *user, const lbfgsfloatval_t *z, const lbfgsfloatval_t *slope, const lbfgsfloatval_t value,
                   const lbfgsfloatval_t size, const lbfgsfloatval_t slope_size, const lbfgsfloatval_t step, int count,
                   int iteration, int tries) {
    fit *f = user;
    (void)slope, (void)value, (void)size, (void)slope_size, (void)step, (void)tries;
    f->outcome->iterations = iteration;
    memcpy(f->last, z, (size_t)count * sizeof *z);
    tell(f, true);
    return f->stopped || f->failed;
}

/* ---- a fit ---- */

static void take_fault(void *user, const skein_error *error) {
    skein_error *first = user;
    if (!first->status) *first = *error;
}

static skein_world *build(const fit_request *request, skein_error *error) {
    io_faults faults = {take_fault, error, 0, NULL};
    const skein_kind *const none = NULL; // it writes and shows nothing
    io_scene *scene = io_scene_read_text(request->scene, strlen(request->scene), request->path, NULL, &none, &faults);
    skein_world_desc desc = skein_default_world_desc();
    if (scene) desc.thread_count = io_scene_get(scene)->threads;
    skein_world *world = scene ? io_scene_build(scene, &desc, &faults) : NULL;
    io_scene_free(scene); // what the world takes of it, it has copied
    return world;
}

/* Whether a field cannot be negative: asked by trying. */
static bool is_positive(skein_world *world, const char *path, skein_value value) {
    skein_value other = value;
    for (int k = 0; k < value.count; k++)
        if (!(value.number[k] > 0)) return false;
    other.number[0] = -other.number[0];
    if (skein_set_path(world, path, other)) return true;
    skein_set_path(world, path, value);
    return false;
}

static bool add_field(fit *f, size_t which, skein_error *error) {
    const fit_field *field = &f->request->fields[which];
    skein_value value;
    if (skein_get_path(f->world, field->path, &value)) {
        *error = *skein_world_error(f->world);
        return false;
    }
    if (!value.count)
        return !io_error_set(error, SKEIN_ERROR_VALUE, field->path, "it is no number that could be varied");
    bool positive = is_positive(f->world, field->path, value) || field->least > 0;
    double size = 0;
    for (int k = 0; k < value.count; k++) size = fmax(size, fabs(value.number[k]));
    for (int k = 0; k < value.count; k++) {
        double x = value.number[k];
        if (!isfinite(x))
            return !io_error_set(error, SKEIN_ERROR_VALUE, field->path, "it is infinite: begin with a number");
        if (!(x > field->least && x < field->most))
            return !io_error_set(error, SKEIN_ERROR_VALUE, field->path,
                                 "it begins at %g: expected a number between its bounds, %g and %g", x, field->least,
                                 field->most);
        bool in_logarithm = positive && (!isfinite(field->least) || !isfinite(field->most) || field->least > 0);
        f->scale[f->outcome->count] = in_logarithm ? 0 : size > 0 ? size : 1;
        f->outcome->numbers[f->outcome->count++] = (fit_number){which, k, x, x};
    }
    return true;
}

static bool prepare(fit *f, skein_error *error) {
    const fit_request *r = f->request;
    size_t most = 3 * r->field_count + 1;
    f->paths = calloc(r->field_count + 1, sizeof *f->paths);
    f->outcome->numbers = calloc(most, sizeof *f->outcome->numbers);
    double **const each[] = {&f->best, &f->last, &f->numbers, &f->slopes, &f->scale};
    bool good = f->paths && f->outcome->numbers;
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) good &= (*each[i] = calloc(most, sizeof **each[i])) != NULL;
    if (!good) return !io_error_set(error, SKEIN_ERROR_MEMORY, "", "out of memory");
    f->mean = 1 / ((double)r->sample_count * (double)r->particle_count);
    for (size_t i = 0; i < r->field_count && good; i++) {
        f->paths[i] = r->fields[i].path;
        good = add_field(f, i, error);
    }
    return good;
}

static fit_end end_of(const fit *f, int status) {
    if (f->stopped) return FIT_STOPPED;
    switch (status) {
    case LBFGS_SUCCESS:
    case LBFGS_STOP:
    case LBFGS_ALREADY_MINIMIZED: return FIT_CONVERGED;
    case LBFGSERR_MAXIMUMITERATION: return FIT_ITERATIONS;
    default: return FIT_STUCK; // no step goes down: as near as rounding lets it, or at a kink
    }
}

static bool search(fit *f) {
    lbfgs_parameter_t how;
    lbfgs_parameter_init(&how);
    how.m = 10;
    how.epsilon = 1e-9;
    how.past = 3, how.delta = 1e-3;
    how.max_iterations = f->request->most_iterations;
    how.linesearch = LBFGS_LINESEARCH_BACKTRACKING_STRONG_WOLFE;
    int count = (int)f->outcome->count;
    lbfgsfloatval_t *z = lbfgs_malloc(count), value;
    if (!z) return !io_error_set(f->error, SKEIN_ERROR_MEMORY, "", "out of memory");
    for (int i = 0; i < count; i++) z[i] = 0;
    f->first = true;
    int status = lbfgs(count, z, &value, evaluate, went_on, f, &how);
    f->outcome->end = end_of(f, status);
    lbfgs_free(z);
    if (status == LBFGSERR_OUTOFMEMORY)
        io_error_set(f->error, SKEIN_ERROR_MEMORY, "", "out of memory"), f->failed = true;
    return !f->failed;
}

static bool run(const fit_request *request, fit_outcome *outcome, skein_error *error) {
    *outcome = (fit_outcome){0};
    fit f = {.request = request, .outcome = outcome, .error = error};
    *error = (skein_error){SKEIN_OK, "", ""};
    f.world = build(request, error);
    bool good = f.world && prepare(&f, error) && search(&f);
    skein_world_destroy(f.world);
    double *const each[] = {f.best, f.last, f.numbers, f.slopes, f.scale};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) free(each[i]);
    free(f.paths);
    return good;
}

static void release(fit_outcome *outcome) {
    free(outcome->numbers);
    *outcome = (fit_outcome){0};
}

static const fit_content content = {run, release};
IO_MODULE_OF_EITHER(&content);
