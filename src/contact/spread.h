/* Panels of a flat sheet that lie spread out: what a search need not look for at all.
 *
 * A sheet that was built flat has a place on a plane for each point, u, and is a map of it: X(u), linear on each triangle, by
 * a gradient J of three rows and two columns. If for some fixed A and all triangles around, w.(A' J)w >= c w.w, then two
 * points whose straight way from one to the other on the plane stays among these triangles are no nearer than
 *
 *     |X(a) - X(b)| >= c / |A| |a - b|,      for (X(a) - X(b)).(A w) = the integral of (J w).(A w) along w = a - b
 *
 * however the sheet turns, swings and stretches there. So a few leaves that lie together are a panel. For those around it, and
 * whether no border of the sheet lies between them, lists are made once; then bounds on J of each panel tell for each
 * substep that nothing of a panel is near anything around it, and boxes that it is not near anything else. Nor may a pair
 * lose its gap in the substep, whose rule looks along one normal: that asks how much J changes in it.
 *
 * Such a panel is out: its features have no boxes, and its vertices no courses. A vertex of those around that is held back
 * brings it in. What is left out are pairs that neither push nor bound would change, so who is out changes no bit. */
#ifndef SK_CONTACT_SPREAD_H
#define SK_CONTACT_SPREAD_H

#include "contact/search/boxes.h"

enum { SK_PANEL_LEAVES = 16, SK_PANEL_LANES = 16, SK_PANEL_AHEAD = 16 };

/* What is known of sixteen panels, a lane each, where they were looked at last: the square of how much J has changed since it was
 * looked at before that, of any triangle; where they are, and were then; and where they are expected, while that is known. */
typedef struct sk_panels {
    _Alignas(64) real change[SK_PANEL_LANES];
    real low[3][SK_PANEL_LANES], high[3][SK_PANEL_LANES], low_before[3][SK_PANEL_LANES], high_before[3][SK_PANEL_LANES];
    sk_tree_block course; /* from some substep on, and SK_PANEL_AHEAD later */
} sk_panels;

/* Panels that have a corner in common, and what is said of these once. */
typedef struct sk_panel_block {
    bool whole;  /* no border of the sheet lies between them */
    real apart;  /* m: what features without a corner in common are apart there, at least, as built; */
    real across; /* and from corner to corner of two such features, at most: in what these are apart */
    real steep;  /* J changes by no more than that times the longest way of a vertex */
    real keeps;  /* c / |A|, where it was looked at last */
    bool spread; /* nothing in it comes near anything else in it */
} sk_panel_block;

/* Lists of numbers, one after the other: those of i from start[i] to start[i + 1]. */
typedef struct sk_lists {
    uint32_t *start, *number;
} sk_lists;

typedef struct sk_spread {
    size_t count; /* of panels: also of what is no sheet, but then none is ever out */
    sk_panels *sixteen;
    real (*least)[16]; /* of panels: the least of J's six numbers, and of these with the other sign; the rest is 0 */
    uint32_t *of_leaf; /* panels of leaves, */
    sk_lists leaves;   /* and leaves of panels */
    size_t block_count;
    sk_panel_block *block;
    sk_lists blocks, beside; /* of panels: in which blocks they are, and who else is in these, they themselves too */
    sk_lists members, around,
        through;         /* of blocks: panels in them, and those through which ways between these may lead; and
                                        * of panels: the blocks whose ways may lead through them */
    uint8_t *out;        /* panels that are; */
    uint8_t *vertex_out; /* vertices that need no course: their panels are, and those beside these; */
    uint8_t *patch_out;  /* and patches all of whose leaves are */
    size_t out_count;
    /* rows of sixteen panels, one panel a lane, a leaf a row: corners (both of the edge that two triangles share, and the third of
     * each), what makes J of their differences, and J as it was last, of both triangles */
    uint32_t *row_start, (*corner)[4][SK_PANEL_LANES];
    real (*inverse)[2][4][SK_PANEL_LANES], (*gradient)[2][6][SK_PANEL_LANES];
    sk_tree tree;       /* of the boxes of panels on their ways; */
    sk_box *box, *wide; /* these, and wider ones; */
    int age;            /* substeps since panels got courses: on these all are apart as they must be, */
    int wait;           /* or until that is tried again */
    bool off_course;    /* somebody is not */
    uint32_t *met;      /* and which of the tree's blocks one may meet */
    uint8_t *was_out;   /* panels that were, when it was last said who is lost; */
    uint8_t *turned;    /* and those that have gone out or come in, which boxes of leaves do not know yet */
    uint8_t *mark;      /* of vertices: for a moment */
    real thickness;     /* that panels were looked at for */
    real holds,
        gone;      /* m: all that are out are while nobody has gone farther since; and how far they have gone at most */
    int rest;      /* frames until others may go out again */
    bool stale;    /* somebody was held back since */
    bool went_out; /* panels have, and pairs of theirs may be kept */
    bool came_in;  /* panels have, and it has not been said yet who is lost */
    bool never;    /* nobody goes out: an implicit solve asks several times what becomes of a substep */
    bool eager;    /* few suffice to be out: tests ask for it */
} sk_spread;

struct sk_touch;

/* Lists the panels of a skin, none of them out. False when there is no memory. */
bool sk_spread_make(struct sk_touch *touch, sk_allocator *allocator);
void sk_spread_release(sk_spread *spread, sk_allocator *allocator);
/* The longest way of all slots from `before` to x. */
real sk_spread_longest_way(const struct sk_touch *touch, const sk_vec4 *x, size_t packed);
/* Whether all that are out stay so, as they do for a while, where vertices have gone so far in a substep. */
static inline bool sk_spread_holds(sk_spread *spread, real way) {
    if (!(spread->gone + way <= spread->holds)) return false;
    spread->gone += way;
    return true;
}
/* Looks at panels where vertices are before a substep (`p`): those that are no longer spread come in; others may go out, if asked
 * for. Vertices that need a course from now on are lost; returns whether there are any. */
bool sk_spread_look(struct sk_touch *touch, bool more);
/* The same of a substep, where vertices go from `p` to `q`, by no more than `way`; nobody goes out. */
bool sk_spread_follow(struct sk_touch *touch, real way);
/* And then, where all were out and some came in: somebody may be held back now, and goes the common way. */
void sk_spread_follow_held(struct sk_touch *touch);
/* A vertex is held back: panels around which all vertices had to go all of their ways come in, as soon as all such vertices
 * have been told; then others are lost, if it returns true. */
void sk_spread_disturb(struct sk_touch *touch, size_t v);
bool sk_spread_come_in(struct sk_touch *touch);
/* All come in; returns whether vertices are lost. */
bool sk_spread_end(struct sk_touch *touch);
/* Whether all is out that there is. */
static inline bool sk_spread_is_all_out(const sk_spread *spread) {
    return spread->count && spread->out_count == spread->count;
}
/* Whether a leaf is out. */
static inline bool sk_spread_has(const sk_spread *spread, size_t leaf) {
    return spread->out_count && spread->out[spread->of_leaf[leaf]];
}

/* Whether a vertex needs no course. */
static inline bool sk_vertex_is_out(const sk_spread *spread, size_t v) {
    return spread->out_count && spread->vertex_out[v];
}

#endif
