/* Registered bodies by functions, and the functions that they build with. */
#include <string.h>

#include "outside/outside.h"

struct skein_builder {
    skein_world *world;
    sk_body *body;
    skein_error *error;
    size_t count; /* of particles */
};

skein_status skein_build_fail(skein_builder *builder, const char *field, const char *message) {
    if (!builder) return SKEIN_ERROR_VALUE;
    return sk_fail(builder->error, SKEIN_ERROR_VALUE, field ? field : "", "%s", message ? message : "it failed");
}

skein_status skein_build_particles(skein_builder *builder, size_t count, const double *positions,
                                   const double *velocities, const double *masses) {
    if (!builder) return SKEIN_ERROR_VALUE;
    if (builder->count) return skein_build_fail(builder, "", "a body's particles are built once");
    if (count && (!positions || !masses)) return sk_fail_null(builder->error, positions ? "masses" : "positions");
    sk_body *body = builder->body;
    skein_status status = sk_world_add_particles(builder->world, count, positions, velocities, masses, builder->error);
    if (status) return status;
    body->particle_of_vertex = sk_allocate(&builder->world->allocator, (count + 1) * sizeof *body->particle_of_vertex);
    if (!body->particle_of_vertex) return sk_fail_memory(builder->error, "a body");
    for (size_t i = 0; i < count; i++) body->particle_of_vertex[i] = body->first_particle + (uint32_t)i;
    body->vertex_count = builder->count = count;
    return SKEIN_OK;
}

static skein_status check_numbers(const skein_builder *builder, const uint32_t *numbers, size_t count,
                                  const char *what) {
    for (size_t i = 0; i < count; i++)
        if (numbers[i] >= builder->count)
            return sk_fail(builder->error, SKEIN_ERROR_VALUE, what, "there is no particle %u: the body has %zu",
                           numbers[i], builder->count);
    return SKEIN_OK;
}

static double distance(const skein_builder *builder, const uint32_t pair[2]) {
    const sk_particles *all = &builder->world->particles;
    const sk_vec3 a = all->built[pair[0]], b = all->built[pair[1]];
    return (double)sk_length(sk_sub(a, b));
}

skein_status skein_build_springs(skein_builder *builder, const char *label, size_t count, const uint32_t *pairs,
                                 double stiffness, double damping) {
    if (!builder) return SKEIN_ERROR_VALUE;
    if (!label || (count && !pairs)) return sk_fail_null(builder->error, label ? "pairs" : "label");
    if (builder->body->batch_count == SK_MOST_BODY_BATCHES)
        return sk_fail(builder->error, SKEIN_ERROR_LIMIT, label, "a body has %d sorts of springs at the most",
                       SK_MOST_BODY_BATCHES);
    if (!(stiffness >= 0) || !(damping >= 0))
        return sk_fail(builder->error, SKEIN_ERROR_VALUE, label, "stiffness and damping are 0 or more");
    skein_status status = check_numbers(builder, pairs, 2 * count, label);
    if (status) return status;
    sk_allocator *allocator = &builder->world->allocator;
    uint32_t *particles = sk_allocate(allocator, (2 * count + 1) * sizeof *particles);
    real *rest = sk_allocate(allocator, (count + 1) * sizeof *rest);
    status = particles && rest ? SKEIN_OK : sk_fail_memory(builder->error, label);
    for (size_t i = 0; i < 2 * count && !status; i++) particles[i] = builder->body->first_particle + pairs[i];
    for (size_t i = 0; i < count && !status; i++) rest[i] = (real)distance(builder, particles + 2 * i);
    if (!status)
        status = sk_world_add_body_batch(builder->world, builder->body, &sk_distance, label,
                                         (sk_material){stiffness, damping}, true, count, particles, rest, NULL,
                                         builder->error);
    sk_release(allocator, particles);
    sk_release(allocator, rest);
    return status;
}

skein_status skein_build_triangles(skein_builder *builder, size_t count, const uint32_t *corners) {
    if (!builder) return SKEIN_ERROR_VALUE;
    if (count && !corners) return sk_fail_null(builder->error, "corners");
    sk_body *body = builder->body;
    if (body->face_count) return skein_build_fail(builder, "", "a body's triangles are built once");
    skein_status status = check_numbers(builder, corners, 3 * count, "corners");
    if (status) return status;
    sk_allocator *allocator = &builder->world->allocator;
    uint32_t(*triangles)[3] = sk_allocate(allocator, (count + 1) * sizeof *triangles);
    body->face_sizes = sk_allocate(allocator, (count + 1) * sizeof *body->face_sizes);
    body->face_vertices = sk_allocate(allocator, (3 * count + 1) * sizeof *body->face_vertices);
    status = triangles && body->face_sizes && body->face_vertices ? SKEIN_OK : sk_fail_memory(builder->error, "faces");
    for (size_t i = 0; i < 3 * count && !status; i++) {
        body->face_sizes[i / 3] = 3;
        body->face_vertices[i] = corners[i];
        triangles[i / 3][i % 3] = body->first_particle + corners[i];
    }
    if (!status) {
        body->face_count = count, body->face_vertex_count = 3 * count;
        status = sk_world_add_triangles(builder->world, count, (const uint32_t(*)[3])triangles, builder->error);
    }
    sk_release(allocator, triangles);
    return status;
}

/* ---- the type ---- */

static skein_status build(skein_world *world, sk_body *body, const void *params, const skein_mesh *mesh,
                          skein_error *error) {
    const skein_body_type *given = sk_outside_of(params)->given;
    skein_builder builder = {world, body, error, 0};
    return given->build(&builder, sk_given_params(params), mesh);
}

static bool live(const void *params, const char *field) {
    (void)params, (void)field;
    return false; // every field affects what is built
}

static void change(sk_body *body, const void *params) {
    (void)body, (void)params;
}

void sk_outside_body(sk_outside *outside, const skein_body_type *given) {
    sk_body_type *type = &outside->type.body;
    type->build = build;
    type->live = live;
    type->change = change;
    type->shape = given->shape;
    type->making = &outside->making;
}
