/* What colliders made from a mesh have in common: `mesh`, which asks its triangles, and `field`, which asks distances that were sampled
 * from them. */
#ifndef SK_COLLIDERS_MESH_H
#define SK_COLLIDERS_MESH_H

#include "colliders/collider.h"
#include "colliders/trimesh.h"

/* The parameters of such a collider begin so. */
typedef struct sk_mesh_params {
    double position[3], rotation[3], scale;
    char *mesh;
    sk_trimesh *made;
} sk_mesh_params;

#define SK_MESH_FIELDS(params)                                                                                      \
    SK_TEXT(params, mesh, "mesh", "",                                                                               \
            "file of the mesh, OBJ, OFF, PLY, STL or glTF (in scenes; a program passes the mesh itself)"),          \
        SK_VEC3(params, position, "position", "m", 0, 0, 0, "where the mesh's origin is put, before any motion"),   \
        SK_VEC3(params, rotation, "rotation", "deg", 0, 0, 0, "turned about x, then y, then z, before any motion"), \
        SK_REAL(params, scale, "scale", "", 1, 1e-9, 1e9, "factor on the mesh's coordinates")

/* Members of sk_collider_type that are the same for both (mesh.c). */
void sk_mesh_place(const void *params, double position[3]);
void sk_mesh_turn(const void *params, double rotation[9]);
skein_status sk_mesh_make(void *params, const skein_kind *kind, sk_allocator *allocator, skein_error *error);
void sk_mesh_unmake(void *params, sk_allocator *allocator);
skein_status sk_mesh_take(void *params, const skein_mesh *mesh, sk_allocator *allocator, sk_faults_text *faults,
                          skein_error *error);
sk_trimesh *sk_mesh_surface(const void *params);
double sk_mesh_scale(const void *params);

/* The collider `mesh`, whose probes the field's distances come from. */
extern const sk_collider_type sk_solid_mesh;

#endif
