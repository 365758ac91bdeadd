/* Sweeps: the order in which a batch's elements are computed. It affects the result; lanes and threads do not change
 * it.
 *
 * Strips. Where particles lie in strips (particles/particles.h), the elements whose particles are at grid places
 * (r + row_step[i], c + column_step[i]) make one sweep: blocks (r + row_step[i], k + column_step[i]) of sixteen slots
 * are combined lane by lane, and no index is read. Over the end of a strip, they are combined with the next strip's
 * first blocks, one lane on (a long step may lead over several strips):
 *
 *       strip 0   strip 1 ...  strip 15         lane l owns columns [l w, (l + 1) w)
 *     . a b . . | a b . . . |  ...              a block is one column of every strip
 *
 * Places without an element have zero stiffness.
 *
 * Groups. All other elements go in groups of sixteen that share no particle, such that elements which share one stay in
 * order: the result is that of the scalar loop, bit for bit. If groups are nearly in the order of their particles'
 * slots, threads can follow each other along them too: a *slab* is a number of blocks of slots (in strips a row), and
 * the groups of slab j touch only slabs j to j + reach. */
#ifndef SK_CONSTRAINTS_SWEEP_H
#define SK_CONSTRAINTS_SWEEP_H

#include "base/wide_types.h"
#include "constraints/constraint.h"

enum {
    SK_BLOCK_GROUPS = 8, /* the most groups that are computed together */
    SK_MOST_RESTS = 4    /* rest values of an element that walks along strips */
};

/* Blocks [first, last) of a strip row: particle i of their elements lies shift[i] strips on. */
typedef struct sk_span {
    size_t first, last;
    int shift[SK_MOST_ARITY];
    bool turned; /* some shift is not 0, so that lanes must be rotated */
} sk_span;

struct sk_sweep {
    const sk_batch *batch;
    bool strips;          /* else groups */
    size_t element_count; /* real ones */
    size_t first_lane;
    /* strips */
    sk_walk walk;
    int32_t row_step[SK_MOST_ARITY], column_step[SK_MOST_ARITY]; /* of each particle from the element's place */
    sk_span span[SK_MOST_ARITY];                                 /* a strip row's */
    size_t span_count;
    size_t together;                                 /* how many sweeps from this one on lie along the same strips */
    real rest[SK_MOST_RESTS], stiffness, compliance; /* what most blocks have in every lane */
    /* groups, in the order of the elements */
    uint32_t *slots; /* of each group 16 first particles, 16 second ones ... */
    size_t group_count;
    uint8_t *ahead;       /* for each group, how many from it on share no particle; NULL if that is not needed */
    uint32_t *slab_start; /* if they walk: the groups of slab j are [slab_start[j], slab_start[j + 1]); else NULL */
    char label[48];       /* the batch's, and the direction */
};

static inline size_t sk_sweep_lane_count(const sk_sweep *sweep) {
    return (sweep->strips ? sweep->walk.rows * sweep->walk.width : sweep->group_count) * SK_LANES;
}
/* Whether halves of it are by rows, so that chains of elements stay whole; else they are by blocks in rows. */
static inline bool sk_sweep_halves_rows(const sk_sweep *sweep) {
    return sweep->walk.reach == 0 && sweep->walk.rows > 1;
}
/* Whether an op that projects a half has a lane, which counts from the sweep's first. */
static inline bool sk_sweep_half_has(const sk_sweep *sweep, sk_half half, size_t lane) {
    if (!sweep->strips || half == SK_WHOLE) return true;
    size_t block = lane / SK_LANES, row = block / sweep->walk.width, column = block % sweep->walk.width;
    return (sk_sweep_halves_rows(sweep) ? row : column) % 2 == (half == SK_ODD_HALF);
}

#endif
