/* The state: named vectors in slot order, and what the particles were built with.
 *
 * A slot is a place that is good for speed; the user's index is what every file and call uses.
 * slot_of[user] leads from one to the other. Vectors are padded to a multiple of 16 slots; the
 * padding is zero and stays zero. Owned by the world; only the world adds particles. */
#ifndef SK_PARTICLES_PARTICLES_H
#define SK_PARTICLES_PARTICLES_H

#include "plan/row.h"

typedef struct sk_particles {
    size_t count, slot_count; /* slot_count: padded */
    size_t capacity;
    sk_vec4 *vector[SK_VECTOR_COUNT]; /* SK_NONE is unused */
    uint32_t *slot_of;
    sk_vec3 *built;     /* positions as they were built, user's order */
    real *mass;         /* kg, user's order; 0 for one that was built as held */
    bool *held;
} sk_particles;

/* Adds particles at the end. False when there is no memory: the particles are then as they were. */
bool sk_particles_add(sk_particles *particles, sk_allocator *allocator, size_t count, const double *positions,
                      const double *velocities, const double *masses);
/* Takes back all from `count` on: the last ones added. */
void sk_particles_truncate(sk_particles *particles, size_t count);
/* Positions as built, all else zero. */
void sk_particles_reset(sk_particles *particles);
/* Holds a particle, or gives it back its mass. */
void sk_particle_hold(sk_particles *particles, size_t particle, bool held);
void sk_particles_release(sk_particles *particles, sk_allocator *allocator);

#endif
