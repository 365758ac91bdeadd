/* Triangles that are asked where they are nearest: the surface of colliders made from meshes.
 *
 *     mesh --fans, welding--> triangles --halves by their middles--> a tree of boxes --> nearest point, side, crossing
 *
 * Owns: sk_trimesh, made by trimesh.c; its tree, trimesh_tree.c. Asked by mesh.c and seat.c, many points at a time
 * (trimesh_near.h), and one by one here. Everything is in the mesh's own frame, so that a mesh that moves as a whole
 * stays as it is; one that changes its shape is fitted again (sk_trimesh_move).
 *
 * Which side a point is on: of a mesh that is closed, by the pseudo-normal of what is nearest, a face, an edge or a corner
 * (Baerentzen and Aanaes 2005); of any other by the generalized winding number, far triangles by dipoles (Barill and others
 * 2018). An open sheet (a dish, a ground) has no inside: it is solid from both sides. */
#ifndef SK_COLLIDERS_TRIMESH_H
#define SK_COLLIDERS_TRIMESH_H

#include "base/memory.h"
#include "base/vector.h"

/* Corner a, the sides from it, and what the nearest point asks of them; sixteen numbers. */
typedef struct sk_facet {
    real a[3], ab[3], ac[3];
    real bb, bc, cc;             /* ab.ab, ab.ac, ac.ac */
    real per_bb, per_cc, per_ee; /* one over a side's square, 0 where it has no length */
    real per_area;               /* 1/(bb cc - bc^2); NaN where the triangle has no area: then no point is over it */
} sk_facet;

/* A node's first child is the next one; `first` is the other child, or a leaf's first triangle. */
typedef struct sk_tree_node {
    real low[3], high[3];
    uint32_t first, count; /* triangles of a leaf; 0: none */
} sk_tree_node;

/* The triangles under a node, seen from afar: areas times normals, at their middle, and the square of their extent. */
typedef struct sk_dipole {
    double middle[3], area[3], square;
} sk_dipole;

typedef struct sk_trimesh {
    sk_allocator *allocator;
    double *led; /* where the vertices that were given go next; NULL until it is known */
    bool leads;
    sk_vec3 *from, *to; /* of welded vertices, in a step through which they go; NULL like `led` */
    double start, dt, now;
    double fastest; /* of their speeds in that step, in the mesh's own frame */
    size_t given_count, vertex_count, triangle_count, node_count;
    uint32_t *vertex_of;       /* of each vertex that was given: which it is, welded */
    sk_vec3 *place, *velocity; /* of welded vertices; m, m/s */
    sk_vec3 *made;             /* their places before a program led them anywhere; NULL while none has */
    uint32_t (*corner)[3];     /* in the tree's order */
    uint32_t (*beside)[3]; /* the triangle on the other side of edge k, from corner k on; SK_ALONE: none, or several */
    sk_facet *facet;
    sk_vec3 *normal;        /* of faces, of length 1 or 0 */
    sk_vec3 *vertex_normal; /* weighted by angles */
    sk_tree_node *node;
    sk_dipole *dipole; /* of nodes */
    /* Cells over the box of a closed mesh that keeps its shape: what no triangle comes near is inside or outside as a whole. */
    uint8_t *cell;
    int cells[3];
    real cell_low[3], per_cell[3], cell_span; /* the diagonal of one */
    real slack; /* squared m: rounding may make a triangle nearer by so much than its box */
    bool closed, turned, moves;
    bool sheet;      /* so open that it has no inside */
    double openness; /* the areas of its faces as vectors, summed up, over the sum of its areas; 0 of what is closed */
    size_t open_edges, torn_edges,
        thin; /* edges of one triangle; of more than two, or of two that disagree; faces left out */
} sk_trimesh;

#define SK_ALONE UINT32_MAX

/* Fails with SKEIN_ERROR_MESH, SKEIN_ERROR_LIMIT and SKEIN_ERROR_MEMORY. */
skein_status sk_trimesh_create(const skein_mesh *mesh, sk_allocator *allocator, sk_trimesh **made, skein_error *error);
void sk_trimesh_destroy(sk_trimesh *m); /* NULL is allowed */
/* What is wrong with it, in words: "the mesh x.obj has 12 open edges"; "" where nothing is. `file` may be "". */
void sk_trimesh_faults(const sk_trimesh *m, const char *file, char *text, size_t size);
/* Memory for being led: false when there is none. What is never led needs none. */
bool sk_trimesh_provide(sk_trimesh *m);
/* The surface of what is at rest where `place` says now, which may have been written to. */
void sk_trimesh_settle(sk_trimesh *m);
/* Where the vertices that were given, 3 numbers each, will be in the next step; false when there is no memory. */
bool sk_trimesh_lead(sk_trimesh *m, const double *positions);
/* A step begins: the vertices set out for where they were led to, or stand still. */
void sk_trimesh_begin(sk_trimesh *m, double time, double dt);
/* They are where they were led to, at once, and rest. */
void sk_trimesh_stop(sk_trimesh *m);
/* How far vertices are led by the next step, at most, in its own coordinates. */
double sk_trimesh_way(const sk_trimesh *m);
/* The surface as it is on that way at a time. */
void sk_trimesh_follow(sk_trimesh *m, double time);
/* Where a vertex is between two steps, the first of which ends at `time`: at the end of its way, also where no op has followed it there. */
sk_vec3 sk_trimesh_place(const sk_trimesh *m, size_t vertex, double time);

/* trimesh_tree.c: the tree over `corner`, which it sorts; and its boxes by where the corners are now. */
bool sk_trimesh_plant(sk_trimesh *m);
void sk_trimesh_fit(sk_trimesh *m);
/* How often the surface goes round p: 1 inside. */
double sk_trimesh_winding(const sk_trimesh *m, const double p[3]);

/* trimesh_cells.c: makes the cells of a mesh; false where there is no memory. */
bool sk_trimesh_divide(sk_trimesh *m);
/* Where p is, which is within the mesh's box and has no triangle `within` so far. Undecided: those within a cell's span will say. */
typedef enum sk_trimesh_side { SK_OUTSIDE, SK_INSIDE, SK_UNDECIDED } sk_trimesh_side;
sk_trimesh_side sk_trimesh_side_of(const sk_trimesh *m, const real p[3], real within);

typedef struct sk_trimesh_spot {
    double normal[3], distance; /* unit, out of the solid; negative inside */
    double speed, slide[3];     /* of the surface there: along the normal, and the rest of its velocity */
} sk_trimesh_spot;
/* Of a point whose nearest triangle is known. */
void sk_trimesh_look(const sk_trimesh *m, uint32_t triangle, const real p[3], sk_trimesh_spot *spot);

/* Where the way from a to b first meets a triangle: returns the part of the way, 0 to 1, and the triangle's unit normal on the side of a;
 * 2 where it meets none. */
double sk_trimesh_cross(const sk_trimesh *m, const double a[3], const double b[3], double normal[3]);

#endif
