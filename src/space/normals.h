/* Unit vertex normals of polygon meshes.
 *
 * Owns: how the faces around a vertex share in its normal. Called for a body's surface, and by whoever writes or draws
 * meshes, through skein_mesh_normals(). Invariant: the result is finite and of unit length; of a flat mesh in a
 * coordinate plane it is exactly that plane's normal, borders included. */
#ifndef SK_SPACE_NORMALS_H
#define SK_SPACE_NORMALS_H

#include <skein/skein.h>

/* Fills out[vertex_count x 3], of a mesh that is known to be good. */
void sk_mesh_normals(const skein_mesh *mesh, skein_normals weighting, double *out);
/* Whether a mesh that a caller gives has the pointers that its counts call for. */
skein_status sk_mesh_check_pointers(const skein_mesh *mesh, skein_error *error);

#endif
