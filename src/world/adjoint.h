/* The adjoint of a plan: its ops in reverse. Of each vector there is an *adjoint*, the derivative of the measure by it;
 * an op that read vectors and wrote one hands that one's adjoint on to them. Called by gradient.c.
 *
 * Vectors lie as they do while the plan runs, strips in packed blocks; the w of adjoints are 0, always, so that sums go over all
 * numbers alike. */
#ifndef SK_WORLD_ADJOINT_H
#define SK_WORLD_ADJOINT_H

#include "world/world.h"

/* What a field changes: a batch's stiffness and damping, and a force, each by one of the field. */
typedef struct sk_effect {
    double *stiffness, *damping; /* of each batch */
    sk_uniform_force *force;     /* of each force */
    bool on_forces;              /* on any */
} sk_effect;

/* X and V, where forces were looked at. */
typedef struct sk_taped {
    real *x, *v;
} sk_taped;

typedef struct sk_adjoint {
    skein_world *world;
    size_t reals;   /* of a vector: 4 a slot, spare ones too */
    size_t packed;  /* slots in packed blocks while the plan runs */
    double span;    /* m, how far positions are moved to either side to see how a force changes */
    real *of[SK_VECTOR_COUNT];
    real *inverse_mass, *mass; /* of each number; 0 beside x, y and z, and for particles that are pinned or none */
    real *moved, *still, *force[2], *plain[5];
    real *side[2]; /* X a little to either side, along the adjoint of F, */
    double step;   /* by so much of that; 0: not made for the present state */
    struct {
        sk_taped *data;
        size_t count, capacity;
    } tape;
    size_t used; /* of the tape */
    sk_uniform_force *forces; /* each of the world's as it is */
    sk_effect *effects;
    size_t effect_count;
    double *by_effect;
} sk_adjoint;

/* Looks whether the plan can be gone through in reverse, and makes what that takes. */
skein_status sk_adjoint_begin(sk_adjoint *a, skein_world *world, skein_error *error);
void sk_adjoint_end(sk_adjoint *a);
/* Runs the plan once, and puts what its forces looked at on the tape, if `tape`. False without memory. */
bool sk_adjoint_run(sk_adjoint *a, double dt, bool tape);
/* Goes through it in reverse, from what the tape had last on: adjoints of X and V after the step become those before
 * it, at the time `start`. Fails where a damped constraint is none that can be followed. */
skein_status sk_adjoint_reverse(sk_adjoint *a, double start, double dt, skein_error *error);
/* How often op r of a plan, or the ops that it repeats, put a state on the tape; 0 for those that are repeated. */
size_t sk_adjoint_looks(const sk_plan *plan, size_t r);
/* Where in a vector's numbers a particle's x is, and how far y and z are from each other. */
size_t sk_adjoint_place(const sk_adjoint *a, size_t particle, size_t *stride);
static inline void sk_effect_release(sk_effect *effect, sk_allocator *allocator) {
    sk_release(allocator, effect->stiffness);
    sk_release(allocator, effect->damping);
    sk_release(allocator, effect->force);
}

#endif
