/* Reading and writing the state: views, copies in the user's order, holding particles, surfaces. */
#include <math.h>
#include <string.h>

#include "colliders/trimesh.h"
#include "world/record.h"
#include "world/world.h"

/* ---- where the state stands: in the world's vectors, or on a device ---- */

/* What a device is ahead belongs to the state as much as what stands here: fetching it changes no state, and so a
 * constant world's may be fetched. */
skein_status sk_world_fetch(const skein_world *world) {
    sk_device *device = world->device;
    if (!device || !device->ahead) return SKEIN_OK;
    device->ahead = false;
    return device->read(device, (skein_world *)(uintptr_t)world, world->error);
}

skein_status sk_world_touch(skein_world *world) {
    skein_status status = sk_world_fetch(world);
    if (!status && world->device) world->device->behind = true;
    return status;
}

skein_status sk_world_set_device(skein_world *world, sk_device *device) {
    skein_status status = sk_world_fetch(world);
    if (status) return status;
    if (world->device) world->device->release(world->device, world);
    sk_world_wake_all(world);
    world->device = device;
    world->plan_stale = world->pins_stale = true;
    if (device) device->ahead = false, device->behind = true;
    return SKEIN_OK;
}

void skein_world_wait(const skein_world *world) {
    if (world && world->device) world->device->wait(world->device);
}

/* ---- reading and writing ---- */

size_t skein_particle_count(const skein_world *world) {
    return world ? world->particles.count : 0;
}

static skein_view view_of(const skein_world *world, sk_vector vector) {
    return (skein_view){(const skein_real *)(const void *)world->particles.vector[vector], world->particles.slot_of,
                        world->particles.count};
}

skein_view skein_position_view(const skein_world *world) {
    if (!world) return (skein_view){0};
    sk_world_fetch(world);
    return view_of(world, SK_X);
}

skein_view skein_velocity_view(const skein_world *world) {
    if (!world) return (skein_view){0};
    sk_world_fetch(world);
    return view_of(world, SK_V);
}

skein_status sk_world_check_range(const skein_world *world, size_t first, size_t count) {
    size_t have = world->particles.count;
    if (first <= have && count <= have - first) return SKEIN_OK;
    return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "", "%zu particle%s from %zu on: the world has %zu", count,
                   count == 1 ? "" : "s", first, have);
}

static skein_status copy_out(const skein_world *world, sk_vector vector, size_t first, size_t count, double *out) {
    skein_status status = sk_world_check_range(world, first, count);
    if (!status) status = sk_world_fetch(world);
    if (status) return status;
    for (size_t i = 0; i < count; i++) {
        sk_vec4 p = world->particles.vector[vector][world->particles.slot_of[first + i]];
        out[3 * i] = (double)p.x, out[3 * i + 1] = (double)p.y, out[3 * i + 2] = (double)p.z;
    }
    return SKEIN_OK;
}

skein_status skein_positions_copy(const skein_world *world, size_t first, size_t count, double *out) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, out);
    return copy_out(world, SK_X, first, count, out);
}

skein_status skein_velocities_copy(const skein_world *world, size_t first, size_t count, double *out) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, out);
    return copy_out(world, SK_V, first, count, out);
}

skein_status skein_positions_built(const skein_world *world, size_t first, size_t count, double *out) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, out);
    skein_status status = sk_world_check_range(world, first, count);
    for (size_t i = 0; i < count && !status; i++) {
        const sk_vec3 p = world->particles.built[first + i];
        out[3 * i] = (double)p.x, out[3 * i + 1] = (double)p.y, out[3 * i + 2] = (double)p.z;
    }
    return status;
}

skein_status skein_positions_blend(const skein_world *world, double blend, size_t first, size_t count, double *out) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, out);
    if (!isfinite(blend))
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "blend", "a blend of %g: expected a finite number",
                       blend);
    skein_status status = copy_out(world, SK_X, first, count, out);
    for (size_t i = 0; i < count && !status; i++) {
        sk_vec4 old = world->particles.vector[SK_PREVIOUS][world->particles.slot_of[first + i]];
        const double from[3] = {(double)old.x, (double)old.y, (double)old.z};
        for (int k = 0; k < 3; k++) out[3 * i + (size_t)k] = from[k] + blend * (out[3 * i + (size_t)k] - from[k]);
    }
    return status;
}

/* Whether these are others than there are: what is put where it is, in each frame, wakes nobody. */
static bool changes(const skein_world *world, sk_vector vector, size_t first, size_t count, const double *xyz) {
    bool same = true;
    for (size_t i = 0; i < count && same; i++) {
        const sk_vec4 *p = &world->particles.vector[vector][world->particles.slot_of[first + i]];
        same = (real)xyz[3 * i] == p->x && (real)xyz[3 * i + 1] == p->y && (real)xyz[3 * i + 2] == p->z;
    }
    return !same;
}

static skein_status copy_in(skein_world *world, sk_vector vector, size_t first, size_t count, const double *xyz) {
    skein_status status = sk_world_check_range(world, first, count);
    if (status) return status;
    for (size_t i = 0; i < 3 * count; i++)
        if (!(xyz[i] >= -SK_FAR && xyz[i] <= SK_FAR))
            return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "",
                           "particle %zu: numbers must be finite, under 1e15", first + i / 3);
    status = sk_world_touch(world);
    if (status) return status;
    if (changes(world, vector, first, count, xyz)) sk_world_rouse_at(world, first, count);
    for (size_t i = 0; i < count; i++) {
        sk_vec4 *p = &world->particles.vector[vector][world->particles.slot_of[first + i]];
        if (world->particles.presence[first + i] == SK_GONE) continue; // it has no place of its own
        *p = (sk_vec4){(real)xyz[3 * i], (real)xyz[3 * i + 1], (real)xyz[3 * i + 2], p->w};
    }
    return SKEIN_OK;
}

skein_status skein_positions_set(skein_world *world, size_t first, size_t count, const double *xyz) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, xyz);
    skein_status status = copy_in(world, SK_X, first, count, xyz);
    // a particle that was moved by hand did not travel: there is nothing to blend
    if (!status) status = copy_in(world, SK_PREVIOUS, first, count, xyz);
    if (!status) sk_record_numbers(world, SK_X, first, count, xyz);
    return status;
}

skein_status skein_velocities_set(skein_world *world, size_t first, size_t count, const double *xyz) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, xyz);
    skein_status status = copy_in(world, SK_V, first, count, xyz);
    if (!status) sk_record_numbers(world, SK_V, first, count, xyz);
    return status;
}

skein_status skein_particle_pin(skein_world *world, size_t particle, bool pinned) {
    SK_NEED(world, world);
    skein_status status = sk_world_check_range(world, particle, 1);
    if (!status) status = sk_world_touch(world);
    if (status) return status;
    sk_particle_pin(&world->particles, particle, pinned);
    world->pins_stale = true;
    sk_world_rouse_at(world, particle, 1);
    sk_record_hold(world, particle, pinned);
    return SKEIN_OK;
}

skein_status skein_body_surface(const skein_world *world, skein_handle handle, skein_surface *surface) {
    SK_NEED(world, world);
    SK_NEED(world, surface);
    const sk_object *object = sk_object_find(world, handle, SKEIN_BODY);
    if (!object) return SKEIN_ERROR_HANDLE;
    const sk_body *body = object->as.body;
    *surface =
        (skein_surface){body->first_particle, body->particle_count, body->particle_of_vertex, body->vertex_count,
                        body->face_sizes,     body->face_count,     body->face_vertices,      body->face_vertex_count,
                        body->grid_rows,      body->grid_columns,   body->corner_uv};
    return SKEIN_OK;
}

skein_status skein_body_uv_set(skein_world *world, skein_handle handle, const float *corner_uv, size_t corner_count) {
    SK_NEED(world, world);
    if (corner_count) SK_NEED(world, corner_uv);
    const sk_object *object = sk_object_find(world, handle, SKEIN_BODY);
    skein_error *error = sk_world_error(world);
    if (!object) return SKEIN_ERROR_HANDLE;
    sk_body *body = object->as.body;
    if (corner_count != body->face_vertex_count)
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "texture coordinates for %zu corners: the body's faces have %zu",
                       corner_count, body->face_vertex_count);
    for (size_t i = 0; i < 2 * corner_count; i++)
        if (!(corner_uv[i] >= -(float)SK_FAR && corner_uv[i] <= (float)SK_FAR))
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "corner %zu: texture coordinates must be finite, under 1e15",
                           i / 2);
    float *kept = sk_allocate(&world->allocator, 2 * corner_count * sizeof *kept);
    if (!kept) return sk_fail_memory(error, "texture coordinates");
    memcpy(kept, corner_uv, 2 * corner_count * sizeof *kept);
    sk_release(&world->allocator, body->corner_uv);
    body->corner_uv = kept;
    return SKEIN_OK;
}

skein_status skein_collider_pose(const skein_world *world, skein_handle handle, skein_pose *pose) {
    SK_NEED(world, world);
    SK_NEED(world, pose);
    const sk_object *object = sk_object_find(world, handle, SKEIN_COLLIDER);
    if (!object) return SKEIN_ERROR_HANDLE;
    sk_pose at = sk_collider_pose_at(object->as.collider, world->time);
    const double position[3] = {(double)at.position.x, (double)at.position.y, (double)at.position.z};
    memcpy(pose->position, position, sizeof position);
    for (int i = 0; i < 9; i++) pose->rotation[i] = (double)at.rotation[i];
    return SKEIN_OK;
}

skein_status skein_shape_of(const skein_world *world, skein_handle handle, skein_shape *shape) {
    SK_NEED(world, world);
    SK_NEED(world, shape);
    const sk_object *object = sk_object_of(world, handle);
    if (!object || (object->category != SKEIN_BODY && object->category != SKEIN_COLLIDER))
        return sk_fail_handle(world, handle, "body or collider", "");
    *shape = (skein_shape){.sort = SKEIN_SHAPE_SURFACE};
    if (object->category == SKEIN_BODY) {
        shape->sort = object->body_type->shape;
    } else {
        const sk_collider *collider = object->as.collider;
        if (collider->type->shape) collider->type->shape(collider->params, shape);
    }
    return SKEIN_OK;
}

skein_status skein_collider_vertices_set(skein_world *world, skein_handle handle, const double *positions,
                                         size_t vertex_count) {
    SK_NEED(world, world);
    SK_NEED(world, positions);
    skein_error *error = sk_world_error(world);
    sk_object *object = sk_object_find(world, handle, SKEIN_COLLIDER);
    if (!object) return SKEIN_ERROR_HANDLE;
    const sk_collider *collider = object->as.collider;
    if (!collider->type->surface || !collider->type->begin)
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "a %s has no vertices to be set", object->kind->name);
    sk_trimesh *m = collider->type->surface(collider->params);
    if (vertex_count != m->given_count)
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "%zu places for %zu vertices", vertex_count, m->given_count);
    for (size_t i = 0; i < 3 * vertex_count; i++)
        if (!(fabs(positions[i]) <= 1e12))
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "vertex %zu: coordinates must be finite, under 1e12", i / 3);
    if (!m->led) world->plan_stale = true; // from now on each substep asks where it is
    if (!sk_trimesh_lead(m, positions)) return sk_fail_memory(error, "the vertices");
    sk_record_vertices(world, object, vertex_count, positions);
    return SKEIN_OK;
}

skein_status skein_collider_teleport(skein_world *world, skein_handle handle) {
    SK_NEED(world, world);
    sk_object *object = sk_object_find(world, handle, SKEIN_COLLIDER);
    if (!object) return SKEIN_ERROR_HANDLE;
    sk_collider_stop(object->as.collider);
    sk_world_rouse(world);
    sk_record_teleport(world, object);
    return SKEIN_OK;
}
