/* Surfaces that have gone through each other: at the start, or driven by pins, which nothing holds back.
 *
 * No history tells on which side each of them ought to be, but what they look like now mostly does. Without the edges that go
 * through something a surface falls into parts, of which the smaller ones are on the wrong side: these are led back through
 * the triangles in their way, a little in each substep (after the global intersection analysis of Baraff and others
 * 2003, doi 10.1145/882262.882357). Where an edge has both ends in one part, it is led where the line along which the
 * surfaces meet gets shorter (intersection contour minimisation: Volino and Magnenat-Thalmann 2006, doi
 * 10.1145/1141911.1141982).
 *
 *       part 1  |  part 2  |  part 1             a sheet, seen along another one, which has
 *    -----------+          +-----------          its back above and its face below
 *    ============\\========/============
 *                 `------'
 *
 * Until then contact, which would hold them where they are, is not between an edge and a triangle that go through each
 * other, nor between what is around them where surfaces are so fine that contact of neighbours does the same. Between all
 * others it is, so that what is pressed together does not fall through itself.
 *
 * Of two solids it is known which end of an edge is inside: that behind the triangle, as its faces look.
 *
 * Neighbours hold back who is led alone. So what crossings of two pieces say together leads these as wholes, too: solids out of each
 * other, with all that is in them; of a solid that a sheet cuts in two the solid to one side, and the part of the sheet that is inside
 * to the other; and of two sheets each. Two that cross along a line which divides neither of them go along it, and
 * sheets of which none is pinned go as fast as they move, if that is more: in one heap, nothing would lead out of its folds. Where what the crossings of
 * two solids say adds up to little, they lead to all sides, and contact of all around holds both where they are: then there is none
 * between these two, and they go away from where they cross, or, if all in the group are filled, by the shortest way that one of their faces looks along (way_out.c). Meanwhile they come no nearer (impact.c). Where solids have faces in one plane, the
 * later one is taken to be a little aside (sides.c), or no edge would go through anything.
 *
 * Whoever is known to have come to where it is without going through anything is not looked at. What is done depends on
 * the places before a substep alone: a state that was saved and loaded goes on as it would have. */
#ifndef SK_CONTACT_TANGLE_H
#define SK_CONTACT_TANGLE_H

#include "base/memory.h"
#include "base/vector.h"
#include "plan/op.h"

/* An edge that goes through a triangle: numbers of a skin. */
typedef struct sk_crossing {
    uint32_t edge, triangle;
} sk_crossing;
typedef struct sk_crossing_list {
    sk_crossing *data;
    size_t count, capacity;
} sk_crossing_list;

/* Which crossings have an edge or a triangle with a vertex: bits of their numbers in the list, of which the last six
 * count. (Where there are more than 64, one may be taken for another, and contact between more features is left out.) */
typedef struct sk_crossings_at {
    uint64_t edges, triangles;
} sk_crossings_at;

/* What is led as a whole: a solid, a sheet around where it is gone through, or the part of a sheet that is in a solid. */
typedef struct sk_whole {
    sk_vec3 way;    /* first the sum of what crossings say, then where it is led, m */
    real share;     /* the sum of how much of the way is its own, */
    uint32_t count; /* of so many crossings */
    bool stuck; /* a solid whose crossings lead to all sides: contact with others that go through something leaves it alone */
    uint32_t vertices;   /* of a solid; */
    bool filled;         /* there are particles in it, and so it keeps its shape; */
    sk_vec3 middle;      /* the sum of their places, m, */
    sk_vec3 crossed;     /* and of those where it is gone through; */
    uint32_t by_nothing; /* of crossings: how many there are since it has faces in one plane with another one; */
    real after;          /* of crossings: how many more are with solids that come before it than after it */
    bool pinned;         /* a sheet that is pinned goes around its crossings alone: */
    sk_vec3 low, high;   /* between these, as it was built */
    /* of a group's first piece */
    bool hollow;                /* not all that go through each other in it are filled */
    bool hangs;                 /* a sheet of it is pinned */
    double mass_of_all, motion; /* kg, and twice its kinetic energy, J */
    /* of solids, or of a group's first piece (impact.c) */
    bool held;          /* somebody of it is pinned */
    double momentum[3]; /* kg m/s; of a group: what it has lost */
    double mass;        /* kg; of a group: of who shares that */
    double gained[3];   /* m/s: what all of a solid gain, since it is led out of another one */
} sk_whole;

typedef struct sk_tangle {
    bool any;   /* something is led apart in this substep */
    bool same;  /* all are where the last bound has left them */
    bool clean; /* no edge went through a triangle when the last bound ended */
    bool forced; /* in this substep, what is pinned or had no gap may have gone through something; written by any thread */
    bool torn;     /* something has blown up, and met nobody since the last search for all; the same */
    sk_vec4 *left; /* by slot: where all were when the last bound ended */
    size_t left_count, left_capacity;
    sk_crossing_list crossing;
    /* by vertex */
    sk_crossings_at *of, *fine; /* of all crossings, and of those of features that are fine */
    uint32_t *part, *size;      /* the first vertex of its part, and how many are in the part of a first one */
    sk_vec4 *lead;              /* the sum of where its crossings lead it, m; w: how many do */
    sk_whole *whole;            /* of the pieces of the skin, and behind these of parts */
    uint32_t *group;            /* of pieces: another one of who goes through it, or holds it back (impact.c) */
    uint8_t *marked;            /* it is not where the last bound left it; it is led */
    uint8_t *cut;               /* of edges: they go through something */
} sk_tangle;

struct sk_touch;

/* Room for all that is by vertex or edge; false when there is no memory. */
bool sk_tangle_reserve(struct sk_touch *touch, sk_allocator *allocator);
/* Finds out what is tangled where all are before a substep, unless nothing can be, and where it is led by `step`, m.
 * `known`: all are where the last bound has left them. False when there is no memory. */
bool sk_tangle_look(struct sk_touch *touch, const sk_run *run, const sk_op *op, real step, bool known);
/* Leads vertices by slots apart: x, and `before` with it, if that is what velocities are found from. */
void sk_tangle_lead(const struct sk_touch *touch, sk_vec4 *x, sk_vec4 *before, size_t packed);
/* A bound has ended at places x, by slots: `keeps` if only what is pinned may have gone through something. `last`: of its
 * step. False when there is no memory. */
bool sk_tangle_leave(struct sk_touch *touch, sk_allocator *allocator, const sk_vec4 *x, bool keeps, bool last);
void sk_tangle_release(sk_tangle *tangle, sk_allocator *allocator);

#endif
