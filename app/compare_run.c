/* One run of a comparison: loaded, stepped frame by frame, sampled against the reference, and its errors and orders. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/compare.h"
#include "io/own_kinds.h"

/* Beyond these a run counts as blown up even where its numbers are still finite (limits can hold together what no
 * longer has to do with the scene): m; stretch; times the energy that moves about in the reference. */
static const double far_away = 1e6, torn = 10, wild = 10;

enum { MOST_SETS = 256 };

/* The scene under this method and step: the user's changes, then these. */
static int load(const compare_scene *scene, const char *method, double step, app_scene *loaded) {
    const char *sets[MOST_SETS + 5];
    char type[64], length[64], frames[64];
    size_t count = 0;
    for (; scene->sets && scene->sets[count] && count < MOST_SETS; count++) sets[count] = scene->sets[count];
    snprintf(type, sizeof type, "method.type=%s", method);
    snprintf(length, sizeof length, "step=%.17g", step);
    snprintf(frames, sizeof frames, "frames=%d", scene->frames);
    sets[count++] = type;
    sets[count++] = "method.substeps=1";
    sets[count++] = length;
    if (scene->frames) sets[count++] = frames;
    sets[count] = NULL;
    *loaded = (app_scene){.quiet = true};
    return app_load(scene->path, sets, loaded);
}

/* Whether every particle is where one could be, and all have an energy that they could have. */
static bool is_sane(const compare_scene *scene, skein_world *world) {
    skein_view x = skein_position_view(world), v = skein_velocity_view(world);
    double energy = 0;
    for (size_t i = 0; i < x.count; i++) {
        const skein_real *p = x.xyzw + 4 * (size_t)x.slot_of[i], *u = v.xyzw + 4 * (size_t)v.slot_of[i];
        for (int k = 0; k < 3; k++) {
            if (!(fabs((double)p[k]) < far_away)) return false;
            energy += 0.5 * (double)u[3] * (double)u[k] * (double)u[k];
        }
    }
    return !(scene->energy_scale > 0) || energy < wild * scene->energy_scale;
}

/* Root of the mean square distance to the reference at a frame. */
static double error_at(const compare_scene *scene, const skein_world *world, size_t frame) {
    skein_view view = skein_position_view(world);
    if (!scene->reference || frame >= scene->reference_frames || view.count != scene->particles) return NAN;
    const double *ought = scene->reference + 3 * scene->particles * frame;
    double sum = 0;
    for (size_t i = 0; i < view.count; i++)
        for (size_t k = 0; k < 3; k++) {
            double d = (double)view.xyzw[4 * (size_t)view.slot_of[i] + k] - ought[3 * i + k];
            sum += d * d;
        }
    return sqrt(sum / (double)view.count);
}

static bool take_sample(compare_scene *scene, compare_run *run, skein_world *world) {
    skein_statistics s;
    if (skein_world_statistics(world, &s)) return false;
    size_t frame = run->sample_count++;
    run->samples[frame] = (compare_sample){s.time, s.kinetic_energy + s.potential_energy + s.elastic_energy,
                                           s.max_stretch, error_at(scene, world, frame)};
    if (s.nonfinite || s.max_stretch > torn) run->outcome = COMPARE_BLEW_UP;
    if (scene->energy_scale > 0 && s.kinetic_energy + s.elastic_energy > wild * scene->energy_scale)
        run->outcome = COMPARE_BLEW_UP;
    scene->most_moving = fmax(scene->most_moving, s.kinetic_energy + s.elastic_energy);
    return true;
}

/* Steps a frame; false when a call failed. */
static bool step_frame(const compare_scene *scene, compare_run *run, skein_world *world, int steps) {
    for (int i = 0; i < steps && run->outcome == COMPARE_GOOD; i++) {
        double start = app_seconds();
        if (skein_world_step(world, run->step)) return false;
        run->seconds += app_seconds() - start;
        run->steps++;
        if (!is_sane(scene, world)) run->outcome = COMPARE_BLEW_UP;
    }
    return true;
}

/* What the samples say of the whole run. */
static void sum_up(compare_run *run) {
    double square = 0;
    run->stretch = 0;
    for (size_t i = 0; i < run->sample_count; i++) {
        square += run->samples[i].error * run->samples[i].error;
        run->stretch = fmax(run->stretch, run->samples[i].stretch);
    }
    run->error = run->outcome == COMPARE_GOOD ? sqrt(square / (double)run->sample_count) : (double)NAN;
    if (run->sample_count) run->loss = run->samples[0].energy - run->samples[run->sample_count - 1].energy;
}

static bool run_frames(compare_scene *scene, compare_run *run, app_scene *loaded, bool keep) {
    skein_world *world = loaded->world;
    size_t frames = (size_t)loaded->settings.frames + 1;
    int steps = io_scene_steps_per_frame(&loaded->settings, &run->step);
    if (keep) {
        scene->particles = skein_particle_count(world);
        scene->reference = calloc(frames * scene->particles * 3 + 1, sizeof *scene->reference);
        if (!scene->reference) return false;
    }
    run->samples = calloc(frames, sizeof *run->samples);
    if (!run->samples) return false;
    bool good = true;
    for (size_t f = 0; f < frames && good && run->outcome == COMPARE_GOOD; f++) {
        good = (f == 0 || step_frame(scene, run, world, steps)) && take_sample(scene, run, world);
        if (good && keep &&
            !skein_positions_copy(world, 0, scene->particles, scene->reference + 3 * scene->particles * f))
            scene->reference_frames = f + 1;
    }
    if (!good) {
        app_print_error(skein_world_error(world));
        run->outcome = COMPARE_FAILED;
    }
    return true;
}

/* What tells how far rounding alone may take a run from the reference. */
static void note_reference(compare_scene *scene, const compare_run *run) {
    scene->reference_steps = run->steps;
    for (size_t i = 0; scene->reference && i < 3 * scene->particles * scene->reference_frames; i++)
        scene->extent = fmax(scene->extent, fabs(scene->reference[i]));
}

bool compare_run_one(compare_scene *scene, compare_run *run, bool keep) {
    app_scene loaded;
    run->outcome = COMPARE_GOOD;
    if (load(scene, run->method, run->step, &loaded)) {
        run->outcome = COMPARE_REFUSED; // it has been said why
        run->error = NAN;
        return true;
    }
    if (!keep && !scene->quiet) { // notes are the same for each run, but this is about its own step
        loaded.quiet = false;
        app_advise(&loaded);
        loaded.quiet = true;
    }
    bool good = run_frames(scene, run, &loaded, keep);
    if (keep && run->outcome == COMPARE_GOOD) scene->energy_scale = scene->most_moving;
    if (keep) note_reference(scene, run);
    app_unload(&loaded);
    sum_up(run);
    return good;
}

double compare_reference_step(const compare_scene *scene, const char *method, double least) {
    app_scene loaded;
    skein_stability s;
    if (load(scene, method, least, &loaded)) return 0;
    double step = least / 8;
    if (skein_world_stability(loaded.world, &s)) app_print_error(skein_world_error(loaded.world));
    else step = fmin(step, 0.5 * skein_kinds_stable_substep(io_kinds(), method, &s));
    app_unload(&loaded);
    return step;
}

void compare_orders(const compare_scene *scene, compare_run *runs, size_t count) {
    // each step rounds positions by up to half an epsilon, to either side: a random walk
    double epsilon = sizeof(skein_real) == sizeof(double) ? DBL_EPSILON : FLT_EPSILON;
    double rounding = epsilon * scene->extent * sqrt((double)scene->reference_steps);
    for (size_t r = 0; r < count; r++) {
        compare_run *run = &runs[r];
        run->order = NAN;
        if (run->outcome != COMPARE_GOOD) continue;
        for (size_t i = r; i-- > 0;) {
            if (runs[i].outcome != COMPARE_GOOD || strcmp(runs[i].method, run->method) || runs[i].step == run->step)
                continue;
            run->order = log(runs[i].error / run->error) / log(runs[i].step / run->step);
            break;
        }
        run->rounded = isnan(run->order) ? run->error < rounding / 8 : run->order < 0.5 && run->error < rounding;
    }
}
