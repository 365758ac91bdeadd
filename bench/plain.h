/* What a good student writes: particles as structs, springs as structs, one after the other, in float. */
#ifndef SKEIN_BENCH_PLAIN_H
#define SKEIN_BENCH_PLAIN_H

#include <stddef.h>

typedef struct plain_particle {
    float x[3], v[3], f[3], w;
} plain_particle;

typedef struct plain_spring {
    int a, b;
    float rest, compliance, stiffness, damping;
} plain_spring;

typedef struct plain_system {
    plain_particle *particles;
    plain_spring *springs;
    size_t particle_count, spring_count;
    float per_step; /* 1/h^2 of a substep */
} plain_system;

plain_system *plain_create(size_t particles, size_t springs);
void plain_destroy(plain_system *system);

/* The timed ones, each once over all springs. `system` is a plain_system. */
void plain_project(void *system); /* XPBD */
void plain_force(void *system);   /* damped spring forces, scattered */

#endif
