/* The state: named vectors in slot order, and what the particles were built with.
 *
 * Every file and call uses the user's index of a particle; its slot, chosen for speed, is its place in the
 * vectors, slot_of[index]. Strips come first:
 *
 *   slots  | strips of a grid | strips of another | all other particles, by rank | empty | spare | out of it | zero |
 *
 * Strips: a grid of rows x columns is cut into sixteen strips of `width` columns, one a lane, so that the
 * particle at (r, c) has slot first + (r width + c mod width) 16 + c / width. A neighbour of a block of
 * sixteen slots is then one block, at a constant distance. Slots without a particle are zero, mass included;
 * that holds for the sixteen empty ones, and for the spare ones, which free lanes read and write
 * (constraints/groups.c). Each *slab*, a number of blocks (in strips a row), has spare slots of its own. Ops
 * over slots reach neither these nor the particles that are out of it (their body is disabled, or asleep), which lie
 * behind. Particles that are gone (their body was removed) share one slot, which is zero. To all others it is
 * as if these had never been. Owned by the world; only the world adds particles. */
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
    SK_ASLEEP, /* it rests, and counts (world/sleep.c): no op meets it until it is woken */
    SK_ASIDE,  /* its state is kept until it takes part again */
    SK_GONE    /* its index is free for another body's */
} sk_presence;

typedef struct sk_particles {
    size_t count, capacity;           /* user's particles */
    size_t slot_count, slot_capacity; /* multiples of 16; the slots of particles that take part, and the empty ones */
    size_t slot_end;                  /* all slots in use */
    size_t out_count, gone_count;     /* particles that take no part (with those that are gone), and that are gone */
    size_t asleep_count;              /* that take no part because they sleep */
    size_t strip_slots;               /* how many of the first slots are in strips */
    size_t empty_slot;                /* the first of the sixteen */
    size_t spare_slot;                /* the first one, and */
    size_t spare_slabs;               /* slabs that have spares: those of the strips with most rows, or of the rest */
    bool arranged;                    /* slots are as the picture shows */
    sk_vec4 *vector[SK_VECTOR_COUNT]; /* slots; SK_NONE is unused, temporaries may be NULL */
    uint32_t *slot_of;
    uint32_t *particle_of; /* slots; SK_NOBODY in empty ones */
    uint32_t *place;       /* of particles in strips: row x columns + column in their grid */
    uint32_t *rank;        /* a particle's place in the order of slots outside of strips; its index by default */
    sk_vec3 *built;        /* positions as they were built, user's order */
    real *mass;            /* kg, user's order; 0 for one that was built as pinned */
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
/* How many columns a strip has in a grid of `columns`. */
uint32_t sk_strip_width(uint32_t columns);
/* Declares that particles form a grid, at these places of it (NULL: in row order); sets the width and first slot. */
bool sk_particles_add_strips(sk_particles *particles, sk_allocator *allocator, sk_strips strips, const uint32_t *place);
/* Takes whole bodies' particles out, or back in, with their state as it was. Slots must then be arranged. */
void sk_particles_set_presence(sk_particles *particles, size_t first, size_t count, sk_presence presence);
/* The first of `count` indices in a row, before `first`, whose particles are gone or beyond the last; else `first`. */
size_t sk_particles_find_room(const sk_particles *particles, size_t first, size_t count);
/* Gives the particles from `first` to the last one the indices from `target` on, and drops those beyond the end. */
void sk_particles_renumber(sk_particles *particles, size_t first, size_t target);
/* Finds the next run [*first, *end) of particles that count, from *first on; false if there is none. */
bool sk_particles_next_run(const sk_particles *particles, size_t *first, size_t *end);
static inline bool sk_particle_is_here(const sk_particles *particles, size_t particle) {
    return particles->presence[particle] == SK_HERE;
}
/* Whether a particle takes part, or would if it did not sleep. */
static inline bool sk_particle_counts(const sk_particles *particles, size_t particle) {
    return particles->presence[particle] <= SK_ASLEEP;
}
/* Removes the particles and strips from `count` on, which were added last and are not arranged yet. */
void sk_particles_truncate(sk_particles *particles, size_t count);
/* Gives every particle its slot, and moves the state there. False when there is no memory: nothing has changed then. */
bool sk_particles_arrange(sk_particles *particles, sk_allocator *allocator);
/* Makes the temporaries in `wanted` (bit v: vector v) and releases the others. False when there is no memory. */
bool sk_particles_want(sk_particles *particles, sk_allocator *allocator, uint32_t wanted);
/* Clears values that belong to no particle: forces, which are in the layout of a running plan, and the spare slots that
 * free lanes read and write. Infinities left there by a blow-up would come back. */
void sk_particles_forget(sk_particles *particles);
/* Sets positions as built, and all else to zero. */
void sk_particles_reset(sk_particles *particles);
/* Pins a particle, or gives it back its mass. */
void sk_particle_pin(sk_particles *particles, size_t particle, bool pinned);
void sk_particles_release(sk_particles *particles, sk_allocator *allocator);

#endif
