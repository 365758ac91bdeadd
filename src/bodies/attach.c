/* Choosing a body's particles by a text, as its pins are, and finding the triangles of another that they can be tied to. */
#include <skein/attach.h>
#include <string.h>

#include "bodies/body.h"
#include "colliders/seat.h"
#include "colliders/trimesh.h"
#include "world/choose.h"

skein_status skein_body_select(skein_world *world, skein_handle handle, const char *text, uint32_t *out, size_t most,
                               size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, text);
    SK_NEED(world, count);
    if (most) SK_NEED(world, out);
    skein_error *error = sk_world_error(world);
    const sk_object *object = sk_object_find(world, handle, SKEIN_BODY);
    if (!object) return SKEIN_ERROR_HANDLE;
    const sk_body *body = object->as.body;
    bool *chosen = sk_allocate(&world->allocator, (body->particle_count + 1) * sizeof *chosen);
    if (!chosen) return sk_fail_memory(error, "pins");
    memset(chosen, 0, body->particle_count * sizeof *chosen);
    skein_status status = sk_world_choose(world, body, body->first_particle, body->particle_count, text, chosen, error);
    *count = 0;
    for (uint32_t i = 0; i < body->particle_count && !status; i++) {
        if (!chosen[i]) continue;
        if (*count < most) out[*count] = body->first_particle + i;
        ++*count;
    }
    sk_release(&world->allocator, chosen);
    return status;
}

/* ---- the nearest triangles ---- */

/* The surface of a body where it is now, as a mesh; and which particle each of its vertices is. */
static skein_status surface_of(skein_world *world, const sk_body *body, sk_trimesh **made, skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    size_t triangles = 0;
    double *position = sk_allocate(allocator, 3 * body->particle_count * sizeof *position);
    uint32_t *corner = sk_allocate(allocator, 3 * body->triangle_count * sizeof *corner);
    uint32_t *size = sk_allocate(allocator, body->triangle_count * sizeof *size);
    skein_status status = position && corner && size ? SKEIN_OK : sk_fail_memory(error, "the surface");
    if (!status) status = skein_positions_copy(world, body->first_particle, body->particle_count, position);
    for (size_t t = 0; t < body->triangle_count && !status; t++) {
        const uint32_t *of = world->triangles.corner[body->first_triangle + t];
        if (of[0] == of[1] && of[0] == of[2]) continue; // it was cut away
        for (size_t k = 0; k < 3; k++) corner[3 * triangles + k] = of[k] - body->first_particle;
        size[triangles++] = 3;
    }
    const skein_mesh mesh = {position, body->particle_count, size, triangles, corner, 3 * triangles};
    if (!status) status = sk_trimesh_create(&mesh, allocator, made, error);
    sk_release(allocator, position);
    sk_release(allocator, corner);
    sk_release(allocator, size);
    return status;
}

/* Of vertices at one place the first counts. */
static uint32_t particle_of(const sk_trimesh *m, uint32_t vertex) {
    uint32_t v = 0;
    while (m->vertex_of[v] != vertex) v++;
    return v;
}

static skein_status find_triangles(skein_world *world, const uint32_t *particles, size_t count, const sk_body *to,
                                   uint32_t *out, skein_error *error) {
    sk_trimesh *m = NULL;
    skein_status status = surface_of(world, to, &m, error);
    for (size_t i = 0; i < count && !status; i++) {
        double at[3];
        sk_seat seat;
        if ((status = skein_positions_copy(world, particles[i], 1, at))) break;
        sk_trimesh_find_seat(m, at, &seat);
        out[4 * i] = particles[i];
        for (size_t k = 0; k < 3; k++)
            out[4 * i + 1 + k] = to->first_particle + particle_of(m, m->corner[seat.triangle][k]);
    }
    sk_trimesh_destroy(m);
    return status;
}

skein_status skein_attachments_find(skein_world *world, const uint32_t *particles, size_t count, skein_handle to,
                                    uint32_t *out) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, particles);
    if (count) SK_NEED(world, out);
    skein_error *error = sk_world_error(world);
    const sk_object *object = sk_object_find(world, to, SKEIN_BODY);
    if (!object) return SKEIN_ERROR_HANDLE;
    const sk_body *body = object->as.body;
    if (!body->triangle_count)
        return sk_fail(error, SKEIN_ERROR_VALUE, "to", "'%s' has no triangles that a particle could be tied to",
                       body->label);
    for (size_t i = 0; i < count; i++) {
        if (particles[i] >= world->particles.count)
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "there is no particle %u (the world has %zu)", particles[i],
                           world->particles.count);
        if (particles[i] - body->first_particle < body->particle_count)
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "particle %u is one of '%s' itself", particles[i], body->label);
    }
    return find_triangles(world, particles, count, body, out, error);
}
