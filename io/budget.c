/* Substeps for a time a frame: see budget.h. */
#include "io/budget.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "io/advice.h"

enum { MOST_SUBSTEPS = 1000, MOST_FRAMES = 60, LOOKS = 6 };
static const double most_seconds = 0.5; /* of one trial */

int io_budget_substeps(double ms, int most, double (*cost)(void *user, int substeps), void *user) {
    int good = 1, over = 2;
    if (!(cost(user, 1) <= ms)) return 1;
    while (over <= most && cost(user, over) <= ms) good = over, over *= 2;
    if (over > most) over = most + 1;
    while (over - good > 1 + good / 16) {
        int middle = good + (over - good) / 2;
        if (cost(user, middle) <= ms) good = middle;
        else over = middle;
    }
    return good;
}

typedef struct pilot {
    skein_world *world;
    const void *start;
    size_t size;
    int frames, steps_per_frame;
    double dt;
    bool failed; /* the world could not go on from its start */
} pilot;

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void look(skein_world *world, io_trial *trial) {
    skein_statistics s;
    if (skein_world_statistics(world, &s)) return;
    trial->max_stretch = fmax(trial->max_stretch, s.max_stretch);
    trial->p99_stretch = fmax(trial->p99_stretch, s.p99_stretch);
}

/* From the start with so many substeps. A world that blows up ends its trial, with the frames that it made. */
static io_trial try(pilot *p, int substeps, bool looks) {
    io_trial trial = {.substeps = substeps};
    if (skein_snapshot_read(p->world, p->start, p->size) ||
        skein_set_path(p->world, "method.substeps", skein_number(substeps)))
        p->failed = true;
    int frames = 0;
    double gone = 0;
    while (!p->failed && frames < p->frames && gone < most_seconds) {
        double begun = seconds();
        int s = 0;
        while (s < p->steps_per_frame && !skein_world_step(p->world, p->dt)) s++;
        gone += seconds() - begun;
        frames++;
        if (s < p->steps_per_frame) break;
        if (looks && (frames % (p->frames / LOOKS + 1) == 0 || frames == p->frames)) look(p->world, &trial);
    }
    trial.ms = frames ? 1e3 * gone / frames : 0;
    return trial;
}

static double cost(void *user, int substeps) {
    return try(user, substeps, false).ms;
}

/* What rounding leaves room for, and what the field takes. */
static int most_substeps(skein_world *world, double dt) {
    return (int)fmax(1, fmin(MOST_SUBSTEPS, io_substeps_by_rounding(world, dt)));
}

skein_status io_budget_choose(skein_world *world, const io_scene_settings *settings, io_budget *budget,
                              skein_error *error) {
    double dt;
    int per_frame = io_scene_steps_per_frame(settings, &dt), most = most_substeps(world, dt);
    *budget = (io_budget){.ms = settings->budget_ms,
                          .frames = settings->frames < MOST_FRAMES ? settings->frames : MOST_FRAMES};
    if (budget->frames < 1) budget->frames = 1;
    size_t size = skein_snapshot_size(world);
    void *start = malloc(size + 1);
    if (!start) return io_error_set(error, SKEIN_ERROR_MEMORY, "method.budget_ms", "out of memory");
    skein_status status = skein_snapshot_write(world, start, size, &size);
    pilot p = {world, start, size, budget->frames, per_frame, dt, status != SKEIN_OK};
    if (!p.failed) {
        try(&p, 1, false); // memory and caches are cold
        int chosen = io_budget_substeps(budget->ms, most, cost, &p);
        budget->chosen = try(&p, chosen, true);
        budget->exceeded = chosen == 1 && budget->chosen.ms > budget->ms;
        budget->bounded = chosen + chosen / 16 >= most;
        if (chosen > 1) budget->half = try(&p, chosen / 2, true);
        if (2 * chosen <= most) budget->twice = try(&p, 2 * chosen, true);
        if (skein_snapshot_read(world, start, size) || skein_set_path(world, "method.substeps", skein_number(chosen)))
            p.failed = true;
    }
    if (p.failed) {
        *error = *skein_world_error(world);
        status = error->status;
    }
    free(start);
    return status;
}

static size_t put_trial(const io_trial *trial, const char *before, char *text, size_t size) {
    if (!trial->substeps) return 0;
    int length = snprintf(text, size, "%s%d substep%s, %.3g ms", before, trial->substeps,
                          trial->substeps == 1 ? "" : "s", trial->ms);
    size_t at = length < 0 || (size_t)length >= size ? size - 1 : (size_t)length;
    if (trial->max_stretch > 0)
        length = snprintf(text + at, size - at, ", stretch at most %.3g %% (99 %% of edges under %.3g %%)",
                          100 * trial->max_stretch, 100 * trial->p99_stretch);
    else length = 0;
    return length < 0 || (size_t)length >= size - at ? size - 1 : at + (size_t)length;
}

void io_budget_text(const io_budget *budget, char *text, size_t size) {
    char start[160];
    snprintf(start, sizeof start, "a budget of %.6g ms a frame %s; in the first %d: ", budget->ms,
             budget->exceeded  ? "is less than a frame takes"
             : budget->bounded ? "leaves time, and more substeps would gain nothing"
                               : "buys",
             budget->frames);
    size_t at = put_trial(&budget->chosen, start, text, size);
    at += put_trial(&budget->half, "; half of them: ", text + at, size - at);
    put_trial(&budget->twice, "; twice as many: ", text + at, size - at);
}
