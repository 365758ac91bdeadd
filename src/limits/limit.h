/* Tethers, which keep cloth from stretching like rubber (Kim, Chentanez, Mueller 2012).
 *
 * A particle may not be farther from a pinned one, its anchor, than its distance along the cloth, times
 * 1 + bound. One pass at the end of a substep does for a whole sheet what would take thousands of sweeps
 * over springs. Each element moves only its own particle. They are stored by slot, in the order of memory:
 *
 *   block of 16 slots:  lengths to anchor 0 of 16 particles | to anchor 1 | ...     infinite: not tethered
 *
 * Anchors move, and another thread may be writing their blocks, even in another substep. But nothing acts on pinned
 * particles, so the path of an anchor is known when a step begins: start + velocity x time. sk_limit_begin notes these,
 * and the kernel reads nothing else of anchors. */
#ifndef SK_LIMITS_LIMIT_H
#define SK_LIMITS_LIMIT_H

#include "base/fields.h"
#include "particles/particles.h"
#include "plan/op.h"

/* A particle that others are tethered to, as the step began. */
typedef struct sk_anchor {
    sk_vec3 start, velocity;
    real free;     /* its inverse mass: over 0 if it is not pinned any more */
    uint32_t slot; /* (takes the place of a real, or of half of one) */
} sk_anchor;

/* When tethers are applied. A cloth with coarse grids has three sets of them: position methods use the first two,
 * others the last. Where a grid's cells are longer one way, all are applied last, besides the coarsest grid's own. */
typedef enum sk_limit_order {
    SK_LIMIT_LAST,   /* after all that pulls */
    SK_LIMIT_SELDOM, /* the same, but by position methods in every second substep while surfaces may meet, and none do */
    SK_LIMIT_BEFORE_COARSE,  /* on the coarsest grid's particles, before coarse grids carry their movement on */
    SK_LIMIT_AFTER_COARSE,   /* on particles near an anchor, before all that pulls, as seldom */
    SK_LIMIT_WITHOUT_COARSE, /* last, by methods that do not use coarse grids */
} sk_limit_order;

typedef struct sk_limit {
    sk_kernels kernel;
    const char *label;
    const bool *enabled;
    bool asleep; /* all that it is on sleeps */
    bool late;   /* its anchors were pinned once their body was built, and may be others soon (world/tethers.c) */
    const double *bound; /* of the stretch: 0.05 lets it grow by 5 % */
    sk_limit_order order;
    size_t count;
    size_t anchors;     /* of each element */
    bool shared;        /* all elements have the same anchors */
    uint32_t *particle; /* the tethered one, then its anchors: count x (1 + anchors), user's indices */
    real *length;       /* count x anchors: along the cloth at rest, m; infinite where no path leads */
    real *cut_length;   /* the same along what a cut has left; NULL: the cloth is whole, and may have coarse grids */
    /* by slot, from first_slot on (a multiple of 16) */
    size_t first_slot, slot_count;
    real *slot_length; /* slot_count x anchors, in blocks */
    bool *empty;       /* for each block: no particle in it is tethered */
    uint32_t *pin_of; /* places in `pins`: anchors of them where they are shared, else slot_count x anchors, in blocks */
    /* of the present step */
    sk_anchor *pins; /* each anchor once; the first stands for none */
    size_t pin_count;
    double start;        /* the time when it began, s */
    bool moves, lets_go; /* some anchor moves; some anchor is not pinned any more */
} sk_limit;

/* Makes tethers from copies of the arrays, in which no particle is tethered twice. NULL when there is no memory. */
sk_limit *sk_tethers_create(sk_allocator *allocator, size_t count, size_t anchors, const uint32_t *particles,
                            const real *lengths);
void sk_limit_release(sk_limit *limit, sk_allocator *allocator);
/* Updates what is stored by slot to the particles' slots. False when there is no memory. */
bool sk_limit_arrange(sk_limit *limit, sk_allocator *allocator, const sk_particles *particles);
/* Whether it acts. */
static inline bool sk_limit_is_on(const sk_limit *limit) {
    return *limit->enabled && !limit->asleep;
}
/* A step begins at `time`, with these positions and velocities (quads). */
void sk_limit_begin(sk_limit *limit, const sk_vec4 *x, const sk_vec4 *v, double time);

#endif
