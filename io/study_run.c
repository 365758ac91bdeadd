/* One row of a study: its scene read, built, stepped and measured. What it says depends on the study and the row alone,
 * but for the seconds. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "io/study_inside.h"
#include "io/verdict.h"

/* What is known of a run. */
typedef struct run {
    const io_study *study;
    const char *outcome;
    char said[sizeof(skein_error)]; /* the first words of what is wrong, "" */
    int frames;
    skein_statistics end;
    io_study_note notes[IO_STUDY_MOST_MEASURES];
    uint64_t scene_hash;
    double seconds;
} run;

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- stepping ---- */

static void end_with(run *r, const char *outcome, const skein_error *error) {
    r->outcome = outcome;
    if (error && !r->said[0])
        snprintf(r->said, sizeof r->said, "%s%s%s", error->where, error->where[0] ? ": " : "", error->message);
}

static void hear_fault(void *user, const skein_error *error) {
    end_with(user, "refused", error);
}

static bool step_frame(run *r, skein_world *world, int steps, double dt) {
    bool good = true;
    for (int s = 0; s < steps && good; s++) good = !skein_world_step(world, dt);
    if (!good) end_with(r, "failed", skein_world_error(world));
    r->frames += good;
    return good;
}

/* Statistics as skein run notes them: for the verdict every sixteenth frame will do. */
static bool look(run *r, skein_world *world, io_verdict *verdict, bool first) {
    if (skein_world_statistics(world, &r->end)) {
        end_with(r, "failed", skein_world_error(world));
        return false;
    }
    if (!first) io_verdict_note(verdict, &r->end);
    return true;
}

static void run_frames(run *r, skein_world *world, const io_scene_settings *settings, bool (*go_on)(void *user),
                       void *user) {
    const io_study *study = r->study;
    double dt, growth;
    int steps = io_scene_steps_per_frame(settings, &dt);
    skein_error error;
    if (!look(r, world, NULL, true)) return;
    io_verdict verdict = io_verdict_begin(world, settings->most_stretch, &r->end);
    for (;;) {
        bool last = r->frames == settings->frames, finite = io_is_finite(world);
        if (io_study_measure_now(world, study->wanted, r->notes, study->wanted_count, r->frames, last || !finite,
                                 &error)) {
            end_with(r, "failed", &error);
            return;
        }
        if ((last || !finite || r->frames % 16 == 0) && !look(r, world, &verdict, false)) return;
        if (!finite) {
            snprintf(r->said, sizeof r->said, "blew up in frame %d: %zu of %zu particles are no longer finite",
                     r->frames, r->end.nonfinite, r->end.particles);
            end_with(r, "blew up", NULL);
        }
        if (last || !finite) break;
        if (go_on && !go_on(user)) {
            end_with(r, "stopped", NULL);
            return;
        }
        if (!step_frame(r, world, steps, dt)) return;
    }
    io_ending ending = r->outcome ? IO_ENDED_WELL : io_verdict_end(&verdict, &r->end, &growth);
    if (ending == IO_ENDED_TORN)
        snprintf(r->said, sizeof r->said, "an edge is stretched by %.0f %%", 100 * r->end.max_stretch);
    else if (ending == IO_ENDED_GROWN)
        snprintf(r->said, sizeof r->said, "its energy has grown by %.3g J, and nothing does work on it", growth);
    if (!r->outcome) r->outcome = ending ? "beyond bounds" : "good";
}

/* ---- the result ---- */

static json_t *hash_text(uint64_t hash) {
    return json_sprintf("%016" PRIx64, hash);
}

static json_t *number(double x) {
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *describe(const run *r, size_t row) {
    const io_study *study = r->study;
    bool measured = !strcmp(r->outcome, "good") || !strcmp(r->outcome, "beyond bounds");
    json_t *result = json_object(), *measures = json_array();
    for (size_t m = 0; m < study->wanted_count; m++)
        json_array_append_new(measures,
                              measured ? number(io_study_measured(&study->wanted[m], &r->notes[m])) : json_null());
    const struct {
        const char *name;
        json_t *value;
    } all[] = {
        {"row", json_integer((json_int_t)row)},
        {"outcome", json_string(r->outcome)},
        {"said", json_string(r->said)},
        {"frames", json_integer(r->frames)},
        {"steps", json_integer((json_int_t)r->end.steps)},
        {"time", json_real(r->end.time)},
        {"measures", measures},
        {"state_hash", hash_text(r->end.state_hash)},
        {"scene_hash", hash_text(r->scene_hash)},
        {"skein", json_string(study->built)},
        {"precision", json_string(sizeof(skein_real) == sizeof(double) ? "double" : "float")},
        {"seconds", json_real(r->seconds)},
    };
    bool good = result != NULL;
    for (size_t i = 0; i < COUNT_OF(all); i++) good &= !json_object_set_new(result, all[i].name, all[i].value);
    if (good) return result;
    json_decref(result);
    return NULL;
}

json_t *io_study_crashed(const io_study *study, size_t row, const char *said) {
    run r = {.study = study, .outcome = "crashed"};
    snprintf(r.said, sizeof r.said, "%s", said);
    return describe(&r, row);
}

json_t *io_study_run(const io_study *study, size_t row, int threads, bool (*go_on)(void *user), void *user) {
    double start = seconds_now();
    run *r = calloc(1, sizeof *r);
    char **sets = study_sets(study, row);
    json_t *result = NULL;
    if (r && sets) {
        r->study = study;
        io_faults faults = {hear_fault, r, 0, NULL};
        io_scene *scene = io_scene_read_text(study->scene_text, strlen(study->scene_text), "scene.json",
                                             (const char *const *)sets, study->exporters, &faults);
        skein_world_desc desc = skein_default_world_desc();
        desc.thread_count = threads;
        skein_world *world = scene ? io_scene_build(scene, &desc, &faults) : NULL;
        if (scene) r->scene_hash = io_scene_hash(scene);
        if (world && !faults.count) run_frames(r, world, io_scene_get(scene), go_on, user);
        else if (!r->outcome)
            end_with(r, "refused", &(skein_error){SKEIN_ERROR_MEMORY, "scene.json", "could not be built"});
        skein_world_destroy(world);
        io_scene_free(scene);
        r->seconds = seconds_now() - start;
        result = describe(r, row);
    }
    study_free_sets(sets);
    free(r);
    return result;
}
