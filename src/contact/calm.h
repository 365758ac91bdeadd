/* Patches of a surface whose own features keep apart: what a search leaves out.
 *
 * Features of leaves that have a vertex in common are always near each other, so boxes find them in every search, and hardly
 * ever do they touch: that takes a fold as sharp as they are wide. So a few leaves that lie together are a patch, which
 * lists all such pairs once. Their distances are looked at, with the places of the patch's vertices then; they hold while
 * these vertices have not moved more than that allows against each other, which one box around their moves since then
 * tells, but for how it has turned as a whole. A patch of which this is known is calm. What is not calm is searched for as everything else.
 *
 *          +---+---+---+---+
 *          |   |   |   |   |      a patch, its leaves P, and the leaves around them
 *          +---+---+---+---+
 *          |   | P | P |   |
 *          +---+---+---+---+
 *          |   | P | P |   |
 *          +---+---+---+---+
 *          |   |   |   |   |
 *          +---+---+---+---+
 *
 * Pairs that are left out are none that a bound or a push would change, so which patches are calm changes no bit. */
#ifndef SK_CONTACT_CALM_H
#define SK_CONTACT_CALM_H

#include "base/memory.h"
#include "base/wide_types.h"

enum { SK_PATCH_LEAVES = 4, SK_PATCH_LANES = 16 };

/* What is known of a patch. */
typedef struct sk_calm_patch {
    real slack;    /* m: so much may its vertices move against each other; */
    real distance; /* and the least gap of its pairs, less what counts for none, where the moves begin */
    bool calm;
    bool whole;  /* while all its vertices go all of their ways in this substep: not if one is held back */
    bool ceased; /* to be calm: its pairs are to be kept */
} sk_calm_patch;

typedef struct sk_calm {
    size_t patch_count, ceased; /* and how many have ceased to be calm since all were looked at, */
    real room;                  /* which says how much room one needed then, a share of the thickness; */
    int wide_for;               /* for so many such looks it is much */
    sk_calm_patch *patch;
    uint32_t *of_leaf;           /* of leaves: their patch */
    uint32_t *ring_start, *ring; /* of leaves: those that have a vertex in common with it, itself too */
    /* pairs, by patch and sort: blocks of sixteen from start[patch] on, the last one filled up with the first pair again */
    uint32_t *start[2], *corner[2][4];
    uint64_t *key[2]; /* the largest number for what fills a block up */
    real *thickness[2];
    bool known[2]; /* whether thicknesses are */
    /* vertices of sixteen patches, one patch a lane: rows from row_start[sixteen] on, filled up with the first again; the
     * first three tell how it has turned */
    uint32_t *row_start, *row;
    real *from;  /* x, y, z of sixteen lanes for each row: where they were when distances were looked at */
    real *holds; /* of sixteen patches: all that were calm are while `gone` is no more */
    real least;  /* the least of these */
    real gone;   /* m: how much two vertices may have moved against each other, at most, substep after substep */
    uint32_t *of_vertex_start, *of_vertex; /* of vertices: the patches that list it */
    /* by thread: what is found out of the pairs of a patch */
    real *scratch;
    uint8_t *found;
    int threads;
    size_t most; /* pairs of a patch */
    bool never;  /* is any calm: tests ask for it */
} sk_calm;

struct sk_touch;

/* Lists the patches of a skin, none of them calm. False when there is no memory. */
bool sk_calm_make(struct sk_touch *touch, sk_allocator *allocator);
void sk_calm_release(sk_calm *calm, sk_allocator *allocator);
/* Thicknesses of pairs have changed: nobody is calm until it is looked at. */
void sk_calm_forget(struct sk_touch *touch);
/* Looks at patches where vertices are before a substep (`p`). Pairs of those that cease to be calm are kept. Or at all,
 * those that are not calm, too, before all pairs are searched for. False when there is no memory. */
bool sk_calm_look(struct sk_touch *touch, sk_allocator *allocator, bool all);
/* Whether all patches that were calm are so on any shares of this substep's ways, which are no longer than that: then none
 * has to be followed. */
bool sk_calm_holds(struct sk_touch *touch, real way);
/* The same of a substep, where vertices go from `p` to `q`; in a storm no pairs are kept, and all are looked at. */
bool sk_calm_follow(struct sk_touch *touch, sk_allocator *allocator);
/* A vertex is held back: patches that were known to be calm for whole ways alone are not any more. */
bool sk_calm_disturb(struct sk_touch *touch, sk_allocator *allocator, size_t v);

#endif
