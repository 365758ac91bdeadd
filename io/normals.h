/* Unit vertex normals of polygon meshes.
 *
 * Owns: how the faces around a vertex share in its normal. Called by the mesh writers and by whoever
 * draws. Invariant: the result is finite and of unit length; of a flat mesh in a coordinate plane it
 * is exactly that plane's normal, borders included.
 */
#ifndef SKEIN_IO_NORMALS_H
#define SKEIN_IO_NORMALS_H

#include <skein/skein.h>

/* In the order of the exporter's choice "area|uniform|angle". */
typedef enum io_normals {
    IO_NORMALS_AREA,    /* a face counts by its area */
    IO_NORMALS_UNIFORM, /* every face counts the same */
    IO_NORMALS_ANGLE    /* a face counts by its angle at the vertex: the same for any cut into triangles */
} io_normals;

/* Fills out[vertex_count x 3]. A face without area counts nothing; a vertex without a face that
 * counts gets (0, 1, 0). */
void io_normals_compute(const skein_mesh *mesh, io_normals mode, double *out);

#endif
