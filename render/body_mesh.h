/* What stays of a body while it moves: its triangles, edges and texture coordinates.
 *
 *     surface of the world --make--> vertices with one uv and one normal each (seams and creases have theirs twice)
 *     faces that are cut --leave_out--> the triangles and edges that are drawn
 *
 * Called by world_frame.c, once for a body, and again where its cuts change. Texture coordinates are the mesh's own; for a grid u = row / (rows - 1),
 * v = column / (columns - 1); else the body's first shape is projected on to the sides of a box.
 * Creases, too, are those of the first shape: the edges of a cube that is not round. */
#ifndef SKEIN_RENDER_BODY_MESH_H
#define SKEIN_RENDER_BODY_MESH_H

#include "skein/skein.h"

typedef struct render_body_mesh {
    size_t vertex_count, triangle_count, edge_count;
    uint32_t *particles; /* of each vertex */
    uint32_t *weld;      /* the first vertex at each vertex's particle that is on the same side of all creases */
    uint32_t *triangles; /* triangle_count x 3, vertices */
    uint32_t *edges;     /* edge_count x 2, particles: of the faces, each once */
    uint32_t *all_triangles, *all_edges; /* of the whole body, cut or not */
    size_t all_edge_count;
    uint32_t *edge_of_side; /* of each corner of a face: the edge to the next one, among all */
    float *uv;              /* vertex_count x 2 */
    double sides[2];        /* metres along u and v from 0 to 1, about */
    bool grid;              /* u goes along the rows */
    uint64_t shape;         /* a hash of all this; never 0 */
} render_body_mesh;

/* Start from {0}. `positions` are those of all particles. A `round` body has no creases. False where there is no memory: what is there is released. */
bool render_body_mesh_make(render_body_mesh *mesh, const skein_surface *surface, const double *positions, bool round);
/* Leaves out the faces for which `cut` holds, and the edges that no other face has; NULL: none. It is whole once made. The
 * surface is the one that it was made from. False where there is no memory: nothing changes. */
bool render_body_mesh_leave_out(render_body_mesh *mesh, const skein_surface *surface, const uint8_t *cut);
void render_body_mesh_release(render_body_mesh *mesh);

#endif
