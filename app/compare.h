/* skein compare: a scene under several methods and steps, measured side by side.
 *
 *   compare.c       the command: arguments, table, CSV
 *   compare_run.c   one run, sampled once a frame, against a reference
 *   compare_plot.c  the plot, by gnuplot */
#ifndef SKEIN_APP_COMPARE_H
#define SKEIN_APP_COMPARE_H

#include "app/command.h"

enum { COMPARE_MOST_RUNS = 64, COMPARE_NAME = 32 };

/* A run's state at a frame. */
typedef struct compare_sample {
    double time, energy, stretch; /* s, J; largest */
    double error;                 /* m, root of the mean square distance to the reference; NaN where there is none */
} compare_sample;

typedef enum compare_outcome { COMPARE_GOOD, COMPARE_BLEW_UP, COMPARE_REFUSED, COMPARE_FAILED } compare_outcome;

typedef struct compare_run {
    char method[COMPARE_NAME];
    double step; /* asked for; then as it fits the frames, s */
    compare_outcome outcome;
    uint64_t steps; /* taken; where it blew up, the step that did */
    double seconds; /* spent stepping */
    double error;   /* m, over all frames; NaN */
    double order;   /* p of error ~ step^p, from the same method's longer step before it; NaN where there is none */
    bool rounded;   /* its error is as small as rounding lets it be: shorter steps do not help */
    double stretch; /* the largest of all frames */
    double loss;    /* of energy, J, from the first to the last frame */
    compare_sample *samples;
    size_t sample_count;
} compare_run;

/* What all runs share. */
typedef struct compare_scene {
    const char *path;
    const char *const *sets; /* the user's */
    int frames;              /* 0: the scene's */
    bool quiet, json;        /* how to say it */
    double *reference;       /* positions at every frame, particles x 3 each; NULL: none yet */
    size_t particles, reference_frames;
    double most_moving;  /* J, kinetic and elastic, the most at any frame so far */
    double energy_scale; /* the same of the reference alone; 0: none yet */
    double extent;       /* m, the largest coordinate of the reference */
    uint64_t reference_steps;
} compare_scene;

/* Runs and fills in what is not asked for. With `keep`, the positions become the scene's reference. False when there
 * is no memory. */
bool compare_run_one(compare_scene *scene, compare_run *run, bool keep);
/* Fills in the orders of all runs, and which of them end in rounding. */
void compare_orders(const compare_scene *scene, compare_run *runs, size_t count);
/* The step of a reference: well under the others, and under what `method` can take. 0 after a printed fault. */
double compare_reference_step(const compare_scene *scene, const char *method, double least);

/* Writes FOLDER/compare.gnuplot and draws compare.png and compare.svg with it. False after a printed fault; where
 * gnuplot is missing, that is only said. */
bool compare_plot(const char *folder, const char *title, const compare_run *runs, size_t count);

static inline double compare_ms_per_step(const compare_run *run) {
    return run->steps ? 1e3 * run->seconds / (double)run->steps : 0;
}
/* Seconds of computing for a second of the scene. */
static inline double compare_cost(const compare_run *run) {
    return run->steps ? run->seconds / ((double)run->steps * run->step) : 0;
}

#endif
