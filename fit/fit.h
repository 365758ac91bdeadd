/* Fitting: numbers of a scene are varied until its run is like a target, by the gradient of the run (skein/gradient.h) and
 * L-BFGS. A module (io/module.h): the library and the reader of scenes once more, in double precision, which gradients
 * take, and liblbfgs. What passes between it and the command has no number of the library's own type, so that one
 * serves commands of either precision.
 *
 * Called by app/fit.c. */
#ifndef SKEIN_FIT_H
#define SKEIN_FIT_H

#include <skein/skein.h>

/* A field to vary, all of its numbers. A field that cannot be negative, and one whose bounds are positive, is varied in its
 * logarithm. */
typedef struct fit_field {
    const char *path;   /* "bodies.0.stretch.stiffness" */
    double least, most; /* bounds, which are never reached; -INFINITY and INFINITY: none */
} fit_field;

/* One number that was varied. */
typedef struct fit_number {
    size_t field;  /* which, */
    int component; /* and of its numbers which */
    double began, found;
} fit_number;

/* How far it has come. */
typedef struct fit_state {
    int iterations, evaluations; /* evaluations: runs with their gradients */
    bool moved;                  /* an iteration has ended, not just a run */
    double misfit;               /* m, of the best so far: the root of the mean squared distance from the target */
    const fit_number *numbers;   /* found: the best so far */
    size_t count;
} fit_state;

typedef struct fit_request {
    const char *scene; /* JSON; its files have whole paths */
    const char *path;  /* as faults have it */
    double dt;         /* s, of a step */
    /* The target: at some steps, in their order, where some particles are, three numbers each. */
    const uint32_t *particles;
    size_t particle_count;
    const size_t *steps;
    const double *places;
    size_t sample_count;
    const fit_field *fields;
    size_t field_count;
    int most_iterations;
    bool (*go_on)(void *user, const fit_state *state); /* after each run; false ends it with the best so far */
    void *user;
} fit_request;

typedef enum fit_end { FIT_CONVERGED, FIT_ITERATIONS, FIT_STUCK, FIT_STOPPED } fit_end;

typedef struct fit_outcome {
    fit_number *numbers; /* to be released */
    size_t count;
    int iterations, evaluations;
    double began, misfit; /* m, of the first run and of the best */
    fit_end end;
} fit_outcome;

typedef struct fit_content {
    /* False after an error. The outcome has to be released in any case. */
    bool (*run)(const fit_request *request, fit_outcome *outcome, skein_error *error);
    void (*release)(fit_outcome *outcome);
} fit_content;

#endif
