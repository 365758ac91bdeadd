/* What can touch: the triangles of all bodies and the edges that are in none, and bodies that do not meet. */
#ifndef SK_CONTACT_SKIN_H
#define SK_CONTACT_SKIN_H

#include "forces/force.h"
#include "particles/particles.h"

/* Features that lie together, by their first numbers: up to two triangles with an edge in common, or edges of a rope.
 * Each vertex and edge belongs to one leaf alone. */
typedef struct sk_leaf {
    uint32_t first_vertex, first_edge, first_triangle;
    uint8_t vertices, edges, triangles;
} sk_leaf;

/* A particle within a solid: the user's index, and the piece that encloses it. */
typedef struct sk_inner {
    uint32_t particle, piece;
} sk_inner;

/* What can touch, in numbers of its own. */
typedef struct sk_skin {
    size_t vertex_count, edge_count, triangle_count, leaf_count;
    uint32_t *particle; /* of vertices: the user's index */
    uint32_t *piece;    /* of vertices: what hangs together has one number, that of one of them */
    int8_t *closed; /* of pieces: its surface is closed, and its faces look out of it, 1, or into it, -1; or it is open, 0 */
    sk_inner *inner;
    size_t inner_count;
    sk_vec4 *built; /* as they were built */
    uint32_t (*edge)[2], (*triangle)[3];
    sk_leaf *leaf;
    real *thickness, *friction; /* of vertices: those of their body; a thickness of 0: the rule's */
    real thickest;              /* m: of these thicknesses; 0: no body has its own, and both arrays mean nothing */
    bool all_own;               /* and every body has */
    real longest;               /* m: of edges, as they were built */
    real spacing; /* m: what lies between features of one surface that have no corner in common, as they were built */
    uint32_t *leaf_start, *leaf_of; /* those of vertex v: leaf_of[leaf_start[v]] to leaf_of[leaf_start[v + 1]] */
} sk_skin;

/* Bodies of which some pairs do not meet (make/ignored.c). */
typedef struct sk_ignored {
    bool any;
    uint32_t *of_leaf; /* of leaves: a number of their body, and of whoever the text calls the same; 0: of none */
    uint8_t *pair;     /* width x width: whether bodies of these numbers do not meet */
    size_t width;
} sk_ignored;

/* Finds out which pieces are closed, and who is within them; vertex_of: of the user's particles, or UINT32_MAX (make/solids.c). False when there
 * is no memory. */
bool sk_solids_make(sk_skin *skin, sk_allocator *allocator, const sk_particles *particles, const uint32_t *vertex_of,
                    const sk_meeting_parts *parts);
/* Makes the skin of what a rule acts on: triangles, and edges that are in none, by the user's indices. False when there
 * is no memory: the skin is then empty. */
bool sk_skin_make(sk_skin *skin, sk_allocator *allocator, const sk_particles *particles, const sk_only *only,
                  const sk_meeting_parts *parts);
void sk_skin_release(sk_skin *skin, sk_allocator *allocator);

/* Where an edge is looked for in a table with open addressing, whose size is a power of 2; `a` is the lesser end. */
static inline size_t sk_edge_place(uint32_t a, uint32_t b, size_t mask) {
    return ((uint64_t)a * 0x9e3779b97f4a7c15u ^ (uint64_t)b * 0xc2b2ae3d27d4eb4fu) >> 20 & mask;
}

/* ---- make/leaves.c ---- */

/* Finds the triangle with which each of those that are `here` is one leaf, or UINT32_MAX, and the order of all. False when there is
 * no memory. */
bool sk_leaves_deal(uint32_t *partner, uint32_t *order, sk_allocator *allocator, const sk_particles *particles,
                    const sk_meeting_parts *parts, const uint8_t *here);

/* ---- make/ignored.c ---- */

/* Reads the pairs of names, of bodies and of groups, and numbers the leaves of the bodies that have them. False when there is
 * no memory. */
bool sk_ignored_make(sk_ignored *ignored, sk_allocator *allocator, const sk_skin *skin, const char *text,
                     const sk_meeting_parts *parts);
/* Whether a text is pairs of names, with commas between them. */
skein_status sk_ignored_check(const char *text, skein_error *error);
void sk_ignored_release(sk_ignored *ignored, sk_allocator *allocator);
static inline bool sk_is_ignored(const sk_ignored *ignored, uint32_t a, uint32_t b) {
    return ignored->any && ignored->pair[(size_t)ignored->of_leaf[a] * ignored->width + ignored->of_leaf[b]];
}

#endif
