/* The student's loops. Built with -O3 -march=native and the compiler's own habits, as the student would. */
#include "bench/plain.h"

#include <math.h>
#include <stdlib.h>

plain_system *plain_create(size_t particles, size_t springs) {
    plain_system *system = calloc(1, sizeof *system);
    if (!system) return NULL;
    system->particles = calloc(particles, sizeof *system->particles);
    system->springs = calloc(springs, sizeof *system->springs);
    system->particle_count = particles;
    system->spring_count = springs;
    if (system->particles && system->springs) return system;
    plain_destroy(system);
    return NULL;
}

void plain_destroy(plain_system *system) {
    if (!system) return;
    free(system->particles);
    free(system->springs);
    free(system);
}

void plain_project(void *data) {
    plain_system *system = data;
    for (size_t s = 0; s < system->spring_count; s++) {
        const plain_spring *spring = &system->springs[s];
        plain_particle *a = &system->particles[spring->a], *b = &system->particles[spring->b];
        float dx = a->x[0] - b->x[0], dy = a->x[1] - b->x[1], dz = a->x[2] - b->x[2];
        float length = sqrtf(dx * dx + dy * dy + dz * dz);
        float k = (spring->rest - length) / (length * (a->w + b->w + spring->compliance * system->per_step));
        a->x[0] += k * a->w * dx, a->x[1] += k * a->w * dy, a->x[2] += k * a->w * dz;
        b->x[0] -= k * b->w * dx, b->x[1] -= k * b->w * dy, b->x[2] -= k * b->w * dz;
    }
}

void plain_force(void *data) {
    plain_system *system = data;
    for (size_t s = 0; s < system->spring_count; s++) {
        const plain_spring *spring = &system->springs[s];
        plain_particle *a = &system->particles[spring->a], *b = &system->particles[spring->b];
        float dx = a->x[0] - b->x[0], dy = a->x[1] - b->x[1], dz = a->x[2] - b->x[2];
        float length = sqrtf(dx * dx + dy * dy + dz * dz), inverse = 1 / length;
        float rate = ((a->v[0] - b->v[0]) * dx + (a->v[1] - b->v[1]) * dy + (a->v[2] - b->v[2]) * dz) * inverse;
        float pull = (spring->stiffness * (length - spring->rest) + spring->damping * rate) * inverse;
        a->f[0] -= pull * dx, a->f[1] -= pull * dy, a->f[2] -= pull * dz;
        b->f[0] += pull * dx, b->f[1] += pull * dy, b->f[2] += pull * dz;
    }
}
