/* Unit vertex normals of polygon meshes.
 *
 * Owns how the faces around a vertex are weighted in its normal. Called for a body's surface, and through
 * skein_mesh_normals() by code that writes or draws meshes. Invariant: the result is finite and of unit length; for a
 * flat mesh in a coordinate plane it is exactly that plane's normal, borders included. */
#ifndef SK_SPACE_NORMALS_H
#define SK_SPACE_NORMALS_H

#include <skein/skein.h>

/* Fills out[vertex_count x 3], for a mesh that has been checked. */
void sk_mesh_normals(const skein_mesh *mesh, skein_normals weighting, double *out);
/* Checks that a caller's mesh has the pointers that its counts require. */
skein_status sk_mesh_check_pointers(const skein_mesh *mesh, skein_error *error);

#endif
