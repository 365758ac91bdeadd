/* A flock as a good student writes it: arrays of coordinates in float, loops that the compiler turns into wide ones. */
#ifndef SKEIN_BENCH_PLAIN_FLOCK_H
#define SKEIN_BENCH_PLAIN_FLOCK_H

#include <stdbool.h>
#include <stddef.h>

typedef struct plain_flock {
    size_t count, cells; /* cells: along each axis, each as wide as the reach */
    float separation, alignment, cohesion, dt;
    float low, size;           /* of the cells' cube */
    float *x[3], *v[3], *u[3]; /* positions, velocities, directions; with a grid in the order of cells */
    float *to_x[3], *to_v[3];  /* where a step writes */
    int *start, *cell, *id, *to_id;
} plain_flock;

/* Copies count x 3 positions and velocities. NULL if there is no memory. */
plain_flock *plain_flock_create(size_t count, const double *positions, const double *velocities, double separation,
                                double alignment, double cohesion, double dt);
void plain_flock_destroy(plain_flock *flock);

/* The timed ones: a step of flocking, x += v dt. `flock` is a plain_flock. */
void plain_flock_grid(void *flock);      /* sorted into cells as wide as the reach, three of them a range */
void plain_flock_all_pairs(void *flock); /* everybody looks at everybody */

#endif
