/* Copies of the state into memory of the caller's own layout: positions, velocities, the vertices and normals of a body's surface, those
 * of a collider's triangles. */
#include <math.h>
#include <string.h>

#include "colliders/trimesh.h"
#include "space/normals.h"
#include "world/cut.h"

static size_t number_size(const skein_buffer *to) {
    return to->type == SKEIN_FLOAT32 ? sizeof(float) : sizeof(double);
}

/* Whether the caller's memory can take `count` times three numbers. */
static skein_status check_buffer(const skein_world *world, const skein_buffer *to, size_t count, const char *name) {
    skein_error *error = sk_world_error(world);
    if (to->type != SKEIN_FLOAT32 && to->type != SKEIN_FLOAT64)
        return sk_fail(error, SKEIN_ERROR_VALUE, name, "numbers of type %d: expected SKEIN_FLOAT32 or SKEIN_FLOAT64",
                       (int)to->type);
    if (to->stride && to->stride < 3 * number_size(to))
        return sk_fail(error, SKEIN_ERROR_VALUE, name, "a stride of %zu bytes: expected 0, or %zu or more", to->stride,
                       3 * number_size(to));
    if (count && !to->data) return sk_fail_null(error, name);
    return SKEIN_OK;
}

static void put(const skein_buffer *to, size_t index, double x, double y, double z) {
    size_t stride = to->stride ? to->stride : 3 * number_size(to);
    char *at = (char *)to->data + index * stride;
    if (to->type == SKEIN_FLOAT32) memcpy(at, (const float[]){(float)x, (float)y, (float)z}, 3 * sizeof(float));
    else memcpy(at, (const double[]){x, y, z}, 3 * sizeof(double));
}

static skein_status copy_to(const skein_world *world, sk_vector vector, size_t first, size_t count,
                            const skein_buffer *to) {
    SK_NEED(world, world);
    skein_status status = sk_world_check_range(world, first, count);
    if (!status) status = check_buffer(world, to, count, "to");
    if (!status) status = sk_world_fetch(world);
    for (size_t i = 0; i < count && !status; i++) {
        sk_vec4 p = world->particles.vector[vector][world->particles.slot_of[first + i]];
        put(to, i, (double)p.x, (double)p.y, (double)p.z);
    }
    return status;
}

skein_status skein_positions_copy_to(const skein_world *world, size_t first, size_t count, skein_buffer to) {
    return copy_to(world, SK_X, first, count, &to);
}

skein_status skein_velocities_copy_to(const skein_world *world, size_t first, size_t count, skein_buffer to) {
    return copy_to(world, SK_V, first, count, &to);
}

/* ---- surfaces ---- */

/* What is found for a body's particles, and copied to its vertices: where welding joined vertices they share it. */
typedef struct shape {
    double *xyz, *normal; /* particle_count x 3 */
    uint32_t *corner;     /* face_vertex_count: the surface's corners as particles of the body */
} shape;

/* Where a body's particles are between the last two steps. */
static void find_places(const skein_world *world, const sk_body *body, double blend, double *xyz) {
    for (size_t i = 0; i < body->particle_count; i++) {
        uint32_t slot = world->particles.slot_of[body->first_particle + i];
        sk_vec4 now = world->particles.vector[SK_X][slot], before = world->particles.vector[SK_PREVIOUS][slot];
        const double to[3] = {(double)now.x, (double)now.y, (double)now.z};
        const double from[3] = {(double)before.x, (double)before.y, (double)before.z};
        for (size_t k = 0; k < 3; k++) xyz[3 * i + k] = from[k] + blend * (to[k] - from[k]);
    }
}

static void find_normals(const sk_body *body, const shape *s) {
    for (size_t f = 0, i = 0; f < body->face_count; f++)
        for (size_t first = i; i < first + body->face_sizes[f]; i++) // what is cut has no area
            s->corner[i] =
                body->particle_of_vertex[body->face_vertices[sk_is_cut(body, f) ? first : i]] - body->first_particle;
    const skein_mesh mesh = {s->xyz,    body->particle_count,   body->face_sizes, body->face_count,
                             s->corner, body->face_vertex_count};
    sk_mesh_normals(&mesh, SKEIN_NORMALS_AREA, s->normal);
}

static void put_vertices(const skein_buffer *to, const sk_body *body, const double *of_particles) {
    for (size_t v = 0; v < body->vertex_count && to->data; v++) {
        const double *at = of_particles + 3 * (size_t)(body->particle_of_vertex[v] - body->first_particle);
        put(to, v, at[0], at[1], at[2]);
    }
}

static skein_status copy_vertices(skein_world *world, const sk_body *body, double blend, const skein_buffer *positions,
                                  const skein_buffer *normals) {
    sk_allocator *allocator = &world->allocator;
    shape s = {.xyz = sk_allocate(allocator, 3 * (size_t)body->particle_count * sizeof *s.xyz)};
    bool good = s.xyz != NULL;
    if (good && normals->data) {
        s.normal = sk_allocate(allocator, 3 * (size_t)body->particle_count * sizeof *s.normal);
        s.corner = sk_allocate(allocator, body->face_vertex_count * sizeof *s.corner);
        good = s.normal && s.corner;
    }
    if (good) {
        find_places(world, body, blend, s.xyz);
        put_vertices(positions, body, s.xyz);
        if (normals->data) find_normals(body, &s);
        put_vertices(normals, body, s.normal);
    }
    sk_release(allocator, s.xyz);
    sk_release(allocator, s.normal);
    sk_release(allocator, s.corner);
    return good ? SKEIN_OK : sk_fail_memory(sk_world_error(world), "a surface's vertices");
}

skein_status skein_body_vertices_copy(skein_world *world, skein_handle body, double blend, skein_buffer positions,
                                      skein_buffer normals) {
    SK_NEED(world, world);
    const sk_object *object = sk_object_find(world, body, SKEIN_BODY);
    if (!object) return SKEIN_ERROR_HANDLE;
    if (!isfinite(blend))
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "blend", "a blend of %g: expected a finite number",
                       blend);
    size_t count = object->as.body->vertex_count;
    skein_status status = positions.data ? check_buffer(world, &positions, count, "positions") : SKEIN_OK;
    if (!status && normals.data) status = check_buffer(world, &normals, count, "normals");
    if (!status) status = sk_world_fetch(world);
    return status ? status : copy_vertices(world, object->as.body, blend, &positions, &normals);
}

/* ---- colliders ---- */

/* A field has triangles, too, but contact asks what was sampled of them. */
static const sk_trimesh *triangles_of(const sk_collider *collider) {
    const sk_collider_type *type = collider->type;
    return type->surface && type->cross ? type->surface(collider->params) : NULL;
}

skein_status skein_collider_triangles(const skein_world *world, skein_handle handle, skein_triangles *triangles) {
    SK_NEED(world, world);
    SK_NEED(world, triangles);
    const sk_object *object = sk_object_find(world, handle, SKEIN_COLLIDER);
    if (!object) return SKEIN_ERROR_HANDLE;
    const sk_trimesh *m = triangles_of(object->as.collider);
    *triangles =
        m ? (skein_triangles){m->corner[0], m->triangle_count, m->vertex_count} : (skein_triangles){NULL, 0, 0};
    return SKEIN_OK;
}

skein_status skein_collider_vertices_copy(const skein_world *world, skein_handle handle, skein_buffer positions) {
    SK_NEED(world, world);
    const sk_object *object = sk_object_find(world, handle, SKEIN_COLLIDER);
    if (!object) return SKEIN_ERROR_HANDLE;
    const sk_collider *collider = object->as.collider;
    const sk_trimesh *m = triangles_of(collider);
    if (!m) return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "", "a %s has no triangles", object->kind->name);
    skein_status status = check_buffer(world, &positions, m->vertex_count, "positions");
    const sk_pose pose = sk_collider_pose_at(collider, world->time);
    const real *r = pose.rotation;
    for (size_t v = 0; v < m->vertex_count && !status; v++) {
        const sk_vec3 own =
            sk_scale((real)collider->type->scale(collider->params), sk_trimesh_place(m, v, world->time));
        const sk_vec3 at = sk_add(pose.position, sk_v3(r[0] * own.x + r[1] * own.y + r[2] * own.z,
                                                       r[3] * own.x + r[4] * own.y + r[5] * own.z,
                                                       r[6] * own.x + r[7] * own.y + r[8] * own.z));
        put(&positions, v, (double)at.x, (double)at.y, (double)at.z);
    }
    return status;
}
