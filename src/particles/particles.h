/* The state: named vectors in slot order, and what the particles were built with.
 *
 * A slot is a place that is good for speed; the user's index is what every file and call uses, and
 * slot_of[user] leads from one to the other. Strips come first:
 *
 *   slots  | strips of a grid | strips of another | all other particles, by rank | empty | spare | out of it | zero |
 *
 * Strips: a grid of rows x columns is cut into sixteen strips of `width` columns, one a lane, so that the
 * particle at (r, c) has slot first + (r width + c mod width) 16 + c / width. A neighbour of a block of
 * sixteen slots is then one block, at a constant distance. Slots without a particle are zero and weigh
 * nothing; the sixteen empty ones stay so, and so do the spare ones, where free lanes read and write (constraints/groups.c):
 * each slab has its own, a *slab* being so many blocks, in strips a row. No row over slots comes there, nor to particles
 * that are out of it (their body is disabled), which lie behind; those that are gone (their body was removed) have no slot of their own but one that is zero. To
 * all others it is as if they had never been. Owned by the world; only the world adds particles. */
#ifndef SK_PARTICLES_PARTICLES_H
#define SK_PARTICLES_PARTICLES_H

#include "plan/op.h"

enum {
    SK_SLAB_BLOCKS = 4, /* blocks a slab, where there are no strips */
    SK_SLAB_SPARES = 4  /* spare slots a slab: a cache line of floats */
};

typedef struct sk_strips {
    uint32_t first_particle, count; /* some places may stay empty */
    uint32_t rows, columns;
    uint32_t width; /* columns a strip: blocks a row */
    size_t first_slot;
} sk_strips;

/* Whether a particle takes part. */
typedef enum sk_presence {
    SK_HERE,
    SK_ASIDE, /* it stays as it is until it takes part again */
    SK_GONE   /* its index is free for another body's */
} sk_presence;

typedef struct sk_particles {
    size_t count, capacity;           /* user's particles */
    size_t slot_count, slot_capacity; /* multiples of 16; the slots of those who take part, and the empty ones */
    size_t slot_end;                  /* all slots in use */
    size_t out_count, gone_count;     /* who takes no part (those that are gone, too), and those that are gone */
    size_t strip_slots;               /* the first ones, in strips */
    size_t empty_slot;                /* the first of the sixteen */
    size_t spare_slot;                /* the first one, and */
    size_t spare_slabs;               /* how many slabs have some: those of the strips with most rows, or of all others */
    bool arranged;                    /* slots are as the picture shows */
    sk_vec4 *vector[SK_VECTOR_COUNT]; /* slots; SK_NONE is unused, temporaries may be NULL */
    uint32_t *slot_of;
    uint32_t *particle_of; /* slots; SK_NOBODY in empty ones */
    uint32_t *place; /* of particles in strips: row x columns + column in their grid */
    uint32_t *rank;  /* where a particle would like to lie: its own index, unless said otherwise */
    sk_vec3 *built;  /* positions as they were built, user's order */
    real *mass;      /* kg, user's order; 0 for one that was built as pinned */
    bool *pinned;
    uint8_t *presence; /* an sk_presence */
    struct {
        sk_strips *data;
        size_t count, capacity;
    } strips;
} sk_particles;

/* Adds particles at the end. False when there is no memory: the particles are then as they were. */
bool sk_particles_add(sk_particles *particles, sk_allocator *allocator, size_t count, const double *positions,
                      const double *velocities, const double *masses);
/* How many columns a strip has, where the grid has so many. */
uint32_t sk_strip_width(uint32_t columns);
/* Says that particles are a grid, at these places of it (NULL: in row order); width and first slot are found here. */
bool sk_particles_add_strips(sk_particles *particles, sk_allocator *allocator, sk_strips strips, const uint32_t *place);
/* Takes particles out, or back in; whole bodies only. They are as they were: slots are to be arranged. */
void sk_particles_set_presence(sk_particles *particles, size_t first, size_t count, sk_presence presence);
/* Where `count` particles that are gone, or end with the last one, lie together, before `first`; or `first`. */
size_t sk_particles_find_room(const sk_particles *particles, size_t first, size_t count);
/* Gives the particles from `first` on, the last ones, the indices from `target` on, and takes off what is then beyond. */
void sk_particles_renumber(sk_particles *particles, size_t first, size_t target);
/* The next run of particles that take part: [*first, *end) from *first on; false where there is none. */
bool sk_particles_next_run(const sk_particles *particles, size_t *first, size_t *end);
static inline bool sk_particle_is_here(const sk_particles *particles, size_t particle) {
    return particles->presence[particle] == SK_HERE;
}
/* Takes back all particles and strips from `count` on: the last ones added, not yet arranged. */
void sk_particles_truncate(sk_particles *particles, size_t count);
/* Gives every particle its slot; the state goes along. False when there is no memory: all as before. */
bool sk_particles_arrange(sk_particles *particles, sk_allocator *allocator);
/* Makes the temporaries that are wanted (bit v: vector v) and lets the others go. False when there is no memory. */
bool sk_particles_want(sk_particles *particles, sk_allocator *allocator, uint32_t wanted);
/* Clears what belongs to no particle: forces, which are in the layout of a running plan, and the spare slots that free
 * lanes read and write. What was lost there in a blow-up would come back. */
void sk_particles_forget(sk_particles *particles);
/* Positions as built, all else zero. */
void sk_particles_reset(sk_particles *particles);
/* Holds a particle, or gives it back its mass. */
void sk_particle_pin(sk_particles *particles, size_t particle, bool pinned);
void sk_particles_release(sk_particles *particles, sk_allocator *allocator);

#endif
