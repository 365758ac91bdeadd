/* Geometry on the card: surfaces that move, and the fixed shapes (sphere, box, bowl, disc, square).
 *
 * Called by draw.c. A moving surface's triangles and uv go to the card once; its positions and normals
 * go there every frame into the buffers that stand ready. */
#ifndef SKEIN_RENDER_MESHES_H
#define SKEIN_RENDER_MESHES_H

#include "render/camera.h"
#include "render/frame.h"
#include "skein/skein.h"

/* One surface on the card. Start from {0}. */
typedef struct render_mesh {
    unsigned arrays, positions, normals, uv, values, triangles;
    size_t vertex_count, triangle_count;
    double middle[3], edge; /* of the surface now: its vertices' mean, and the mean length of an edge */
    double spread[3];       /* half the axes of an ellipsoid like it, along x, y and z, metres */
    uint64_t shape;         /* of the surface whose triangles are there */
    float *staged;          /* vertex_count x 3, twice: what goes to the card next */
} render_mesh;

/* Brings a surface to the card: all of it when its shape is new, else only what moved. */
skein_status render_mesh_update(render_mesh *mesh, const render_surface *surface, skein_error *error);
void render_mesh_destroy(render_mesh *mesh);
/* How long an edge of the surface's triangles is in a picture so many pixels high, about. */
double render_mesh_edge_pixels(const render_mesh *mesh, const render_camera *camera, int height);

/* Smooth unit normals of a surface, vertex_count x 3: its triangles' normals, weighted by area, 0 where
 * no triangle of any area meets. Returns the surface's area. */
double render_surface_normals(const render_surface *surface, float *normals);

/* A fixed shape. Indexed by 16 bits; the first attribute is at location 0. */
typedef struct render_shape {
    unsigned arrays, vertices, indices;
    int index_count;
} render_shape;

/* The unit sphere with `rings` from pole to pole; attribute: direction (3 floats). */
skein_status render_shape_sphere(render_shape *shape, int rings, skein_error *error);
/* For render_solid, of fine or coarse triangles; attribute: 4 times the inner box's corner, from -1
 * to 1, plus the direction from there (3 floats). */
skein_status render_shape_solid(render_shape *shape, bool fine, skein_error *error);
/* For render_bowl: the unit sphere up to the rim, seen from outside; attribute: direction (3 floats). */
skein_status render_shape_bowl(render_shape *shape, skein_error *error);
/* The half of a unit sphere around +z, of eight triangles: for many small ones that are turned to the viewer. */
skein_status render_shape_dome(render_shape *shape, skein_error *error);
/* The unit disc (an octagon: its rim is lost in the haze) and the square from -1 to 1; attribute: place (2 floats). */
skein_status render_shape_disc(render_shape *shape, skein_error *error);
skein_status render_shape_square(render_shape *shape, skein_error *error);
void render_shape_destroy(render_shape *shape);

#endif
