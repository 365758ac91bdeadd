/* The state: named vectors in slot order, and what the particles were built with.
 *
 * A slot is a place that is good for speed; the user's index is what every file and call uses, and
 * slot_of[user] leads from one to the other. Strips come first:
 *
 *   slots  | strips of a grid | strips of another | all other particles, by rank | empty |
 *
 * Strips: a grid of rows x columns is cut into sixteen strips of `width` columns, one a lane, so that the
 * particle at (r, c) has slot first + (r width + c mod width) 16 + c / width. A neighbour of a block of
 * sixteen slots is then one block, at a constant distance. Slots without a particle are zero and weigh
 * nothing; the last sixteen are always empty. Owned by the world; only the world adds particles. */
#ifndef SK_PARTICLES_PARTICLES_H
#define SK_PARTICLES_PARTICLES_H

#include "plan/row.h"

typedef struct sk_strips {
    uint32_t first_particle, count; /* some places may stay empty */
    uint32_t rows, columns;
    uint32_t width; /* columns a strip: blocks a row */
    size_t first_slot;
} sk_strips;

typedef struct sk_particles {
    size_t count, capacity;           /* user's particles */
    size_t slot_count, slot_capacity; /* multiples of 16 */
    size_t strip_slots;               /* the first ones, in strips */
    size_t empty_slot;                /* the first of the last sixteen */
    bool arranged;                    /* slots are as the picture shows */
    sk_vec4 *vector[SK_VECTOR_COUNT]; /* slots; SK_NONE is unused, temporaries may be NULL */
    uint32_t *slot_of;
    uint32_t *particle_of; /* slots; SK_NOBODY in empty ones */
    uint32_t *place; /* of particles in strips: row x columns + column in their grid */
    uint32_t *rank;  /* where a particle would like to lie: its own index, unless said otherwise */
    sk_vec3 *built;  /* positions as they were built, user's order */
    real *mass;      /* kg, user's order; 0 for one that was built as held */
    bool *held;
    struct {
        sk_strips *data;
        size_t count, capacity;
    } strips;
} sk_particles;

/* Adds particles at the end. False when there is no memory: the particles are then as they were. */
bool sk_particles_add(sk_particles *particles, sk_allocator *allocator, size_t count, const double *positions,
                      const double *velocities, const double *masses);
/* Says that particles are a grid, at these places of it (NULL: in row order); width and first slot are found here. */
bool sk_particles_add_strips(sk_particles *particles, sk_allocator *allocator, sk_strips strips, const uint32_t *place);
/* Takes back all particles and strips from `count` on: the last ones added, not yet arranged. */
void sk_particles_truncate(sk_particles *particles, size_t count);
/* Gives every particle its slot; the state goes along. False when there is no memory: all as before. */
bool sk_particles_arrange(sk_particles *particles, sk_allocator *allocator);
/* Makes the temporaries that are wanted (bit v: vector v) and lets the others go. False when there is no memory. */
bool sk_particles_want(sk_particles *particles, sk_allocator *allocator, uint32_t wanted);
/* Positions as built, all else zero. */
void sk_particles_reset(sk_particles *particles);
/* Holds a particle, or gives it back its mass. */
void sk_particle_hold(sk_particles *particles, size_t particle, bool held);
void sk_particles_release(sk_particles *particles, sk_allocator *allocator);

#endif
