/* What the lists of panels are made with (spread.c): sheets on their planes, panels of leaves, and blocks of panels. */
#ifndef SK_CONTACT_MAKE_SPREAD_H
#define SK_CONTACT_MAKE_SPREAD_H

#include "contact/touch.h"

/* A place on a sheet's plane, and a rectangle on it. */
typedef struct spot {
    real u, v;
} spot;
typedef struct rectangle {
    spot low, high;
} rectangle;

typedef struct numbers {
    uint32_t *data;
    size_t count, capacity;
} numbers;

/* A panel by where it begins along the first axis. */
typedef struct beginning {
    real low;
    uint32_t panel;
} beginning;

/* Where a rectangle is, among those of a sheet. */
typedef struct bin {
    uint32_t u, v;
} bin;

/* What is needed while panels are made. */
typedef struct making {
    const sk_skin *skin;
    sk_spread *spread;
    sk_allocator *allocator;
    double (*normal)[3]; /* of pieces, by their numbers: their normals, */
    sk_vec4 *along;      /* and a direction on their planes */
    uint8_t *flat;       /* whether they are */
    uint8_t *border;     /* edges that have one triangle */
    spot *spot;          /* of vertices */
    sk_vec4 *centre;     /* of leaves */
    rectangle *of_leaf, *of_panel;
    real *longest;    /* edge of a panel */
    real *steep;      /* 1/m: how much J of its triangles changes with its corners, at most; */
    real *apart;      /* and the least between its features and those beside it */
    bin *bin;         /* of panels: which, on their sheet */
    beginning *order; /* of a piece's panels */
    uint32_t *in_bin; /* and these by their bins */
    numbers beside, members, around, starts[2]; /* of members, and around */
    struct {
        sk_panel_block *data;
        size_t count, capacity;
    } block;
    spot *point, *hull; /* of all members of one */
    size_t point_capacity;
} making;

static inline uint32_t corner_of(const sk_skin *skin, const sk_leaf *leaf) {
    return leaf->triangles ? skin->triangle[leaf->first_triangle][0] : skin->edge[leaf->first_edge][0];
}

static inline sk_vec3 side(const sk_skin *skin, uint32_t a, uint32_t b) {
    return sk_sub(sk_xyz(skin->built[b]), sk_xyz(skin->built[a]));
}

static inline sk_vec3 cross_of(const sk_skin *skin, const uint32_t t[3]) {
    return sk_cross(side(skin, t[0], t[1]), side(skin, t[0], t[2]));
}

static inline int corners_of_leaf(const sk_skin *skin, const sk_leaf *leaf, uint32_t corner[6]) {
    int count = 0;
    for (uint32_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++)
        for (int c = 0; c < 3; c++) corner[count++] = skin->triangle[t][c];
    for (int c = 0; c < 2 && !leaf->triangles; c++) corner[count++] = skin->edge[leaf->first_edge][c];
    return count;
}

/* Corners of a leaf: of the edge that two triangles share, and the third of each; of one triangle this comes twice, and of an
 * edge its first end. */
static inline void corners_in_row(const sk_skin *skin, const sk_leaf *leaf, uint32_t corner[4]) {
    if (!leaf->triangles) {
        const uint32_t *edge = skin->edge[leaf->first_edge];
        corner[0] = edge[0], corner[1] = edge[1], corner[2] = corner[3] = edge[0];
        return;
    }
    const uint32_t *t = skin->triangle[leaf->first_triangle],
                   *s = leaf->triangles > 1 ? skin->triangle[leaf->first_triangle + 1] : t;
    int third = 0;
    uint32_t other = t[0];
    for (int k = 0; k < 3 && s != t; k++) {
        if (t[k] != s[0] && t[k] != s[1] && t[k] != s[2]) third = k;
        if (s[k] != t[0] && s[k] != t[1] && s[k] != t[2]) other = s[k];
    }
    corner[0] = t[(third + 1) % 3], corner[1] = t[(third + 2) % 3], corner[2] = t[third],
    corner[3] = s == t ? t[third] : other;
}

static inline uint32_t piece_of_panel(const making *m, size_t p) {
    const sk_skin *skin = m->skin;
    return skin->piece[corner_of(skin, &skin->leaf[m->spread->leaves.number[m->spread->leaves.start[p]]])];
}

static inline real turn_of(spot a, spot b, spot c) {
    return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

static const rectangle nowhere = {{SK_REAL_MAX, SK_REAL_MAX}, {-SK_REAL_MAX, -SK_REAL_MAX}};

static inline rectangle with_spot(rectangle r, spot s) {
    return (rectangle){{sk_min(r.low.u, s.u), sk_min(r.low.v, s.v)}, {sk_max(r.high.u, s.u), sk_max(r.high.v, s.v)}};
}

static inline rectangle with_rectangle(rectangle r, const rectangle *other) {
    return with_spot(with_spot(r, other->low), other->high);
}

/* ---- sheets.c ---- */

/* Finds the pieces that were built flat, with all triangles on the same side, and where their vertices are on their planes; whether
 * there are any. */
bool sk_sheets_find(making *m);

/* ---- panels.c ---- */

/* Deals leaves to panels, one piece after the other. False when there is no memory. */
bool sk_panels_deal(making *m);
/* Measures them, when they have room. */
void sk_panels_measure(making *m);

/* ---- blocks.c ---- */

/* Lists the blocks of all sheets, and who is beside whom; of others, nobody is. False when there is no memory. */
bool sk_blocks_list(making *m);

#endif
