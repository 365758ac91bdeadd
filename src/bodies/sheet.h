/* A sheet: the working mesh of a builder, between the user's mesh and the world.
 *
 *   mesh or grid --> vertices, faces --> transform --> weld --> particles, faces of particles, areas
 *
 * Vertices are the file's; particles are vertices after welding (without it, the same). Owned by the
 * builder for the time of the build. */
#ifndef SK_BODIES_SHEET_H
#define SK_BODIES_SHEET_H

#include "base/memory.h"

typedef struct sk_sheet {
    sk_allocator *allocator;
    size_t vertex_count, face_count, corner_count; /* as they came */
    uint32_t *face_sizes, *face_vertices;
    uint32_t *particle_of_vertex;
    size_t particle_count;
    double (*position)[3]; /* of particles (of vertices until welding) */
    /* Faces of particles: face f has corners[face_start[f] .. face_start[f + 1]); corners that welding
     * made equal are left out, so a face may have fewer than 3. */
    size_t *face_start;
    uint32_t *corners;
    double *face_area;
    double *particle_area; /* each face's area, shared out to its corners */
    uint32_t grid_rows, grid_columns;
    size_t flat_faces; /* faces without an area */
    uint32_t first_flat_face;
} sk_sheet;

/* A copy of a user's mesh; every index and number is checked. */
skein_status sk_sheet_from_mesh(sk_sheet *sheet, sk_allocator *allocator, const skein_mesh *mesh, skein_error *error);
/* A grid of rows x columns vertices, `width` along x and `depth` along z, centred, facing up. */
skein_status sk_sheet_from_grid(sk_sheet *sheet, sk_allocator *allocator, const int32_t grid[2], const double size[2],
                                skein_error *error);
/* Scales, turns (degrees about x, then y, then z) and moves the vertices. */
void sk_sheet_transform(sk_sheet *sheet, double scale, const double degrees[3], const double offset[3]);
/* The same for any points. */
void sk_points_transform(double (*points)[3], size_t count, double scale, const double degrees[3],
                         const double offset[3]);
/* Makes particles: vertices nearer than `distance` (0: none) become one. Then faces and areas. */
skein_status sk_sheet_weld(sk_sheet *sheet, double distance, skein_error *error);
/* Whether all triangles of its faces, cut from their first corners, look the same way, to a thousandth of a radian. After
 * welding. */
bool sk_sheet_is_flat(const sk_sheet *sheet);
void sk_sheet_release(sk_sheet *sheet);

#endif
