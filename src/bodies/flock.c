/* A flock: loose particles in a box or a ball, each flying its own way. Rules that steer (flocking, attraction,
 * predator, speed_limit) make it one; it brings none of its own, so that several flocks may share them. */
#include <math.h>

#include "base/elementary.h"
#include "base/hash.h"
#include "bodies/body.h"

typedef struct flock_params {
    int32_t count, side, seed;
    double position[3], spread[3], speed, swirl, velocity[3], mass;
} flock_params;

// clang-format off
static const skein_field fields[] = {
    SK_INT(flock_params, count, "count", "", 1024, 1, 100000000, "of particles"),
    SK_INT(flock_params, side, "side", "", 0, 0, 10000, "side x side particles instead of count; 0: count"),
    SK_VEC3(flock_params, position, "position", "m", 0, 0, 0, "the middle"),
    {"spread", SKEIN_FIELD_VEC3, offsetof(flock_params, spread), "m", {20, 20, 20}, 0, 1e9, NULL, NULL,
     "size of the box that they are strewn in, evenly"},
    SK_REAL(flock_params, speed, "speed", "m/s", 5, 0, SK_FAR, "each flies so fast, in a direction of its own"),
    SK_REAL(flock_params, swirl, "swirl", "m/s", 0, -SK_FAR, SK_FAR,
            "and all of them so, about the vertical through the middle"),
    SK_VEC3(flock_params, velocity, "velocity", "m/s", 0, 0, 0, "and all of them so, besides"),
    SK_REAL(flock_params, mass, "mass", "kg", 0.1, 1e-9, 1e9, "of each"),
    SK_INT(flock_params, seed, "seed", "", 1, 0, 2147483647, "another one strews them differently"),
};
// clang-format on

/* Evenly in [0, 1): the k-th number of particle i, the same on every machine. */
static double random_number(const flock_params *params, size_t i, uint64_t k) {
    uint64_t key = sk_hash_mix(((uint64_t)(uint32_t)params->seed << 32 | (uint64_t)i) * 8 + k + 0x9e3779b97f4a7c15u);
    return (double)(key >> 11) / 9007199254740992.0;
}

static void strew(const flock_params *params, size_t i, double position[3], double velocity[3]) {
    for (uint64_t k = 0; k < 3; k++)
        position[k] = params->position[k] + params->spread[k] * (random_number(params, i, k) - 0.5);
    // evenly over the sphere of directions
    double y = 2 * random_number(params, i, 3) - 1, ring = sqrt(1 - y * y), sine, cosine;
    sk_sincos(6.283185307179586 * random_number(params, i, 4), &sine, &cosine);
    double x = position[0] - params->position[0], z = position[2] - params->position[2], out = sqrt(x * x + z * z);
    double swirl = out > 0 ? params->swirl / out : 0;
    velocity[0] = params->velocity[0] + params->speed * ring * cosine + swirl * z;
    velocity[1] = params->velocity[1] + params->speed * y;
    velocity[2] = params->velocity[2] + params->speed * ring * sine - swirl * x;
}

static skein_status build(skein_world *world, sk_body *body, const void *data, const skein_mesh *mesh,
                          skein_error *error) {
    const flock_params *params = data;
    if (mesh) return sk_fail(error, SKEIN_ERROR_VALUE, "mesh", "a flock is made of single particles, not of a mesh");
    size_t count = params->side ? (size_t)params->side * (size_t)params->side : (size_t)params->count;
    sk_allocator *allocator = &world->allocator;
    double *positions = sk_allocate(allocator, count * 3 * sizeof *positions);
    double *velocities = sk_allocate(allocator, count * 3 * sizeof *velocities);
    double *masses = sk_allocate(allocator, count * sizeof *masses);
    body->particle_of_vertex = sk_allocate(allocator, count * sizeof *body->particle_of_vertex);
    skein_status status =
        positions && velocities && masses && body->particle_of_vertex ? SKEIN_OK : sk_fail_memory(error, "a flock");
    for (size_t i = 0; i < count && !status; i++) {
        strew(params, i, positions + 3 * i, velocities + 3 * i);
        masses[i] = params->mass;
        body->particle_of_vertex[i] = body->first_particle + (uint32_t)i;
    }
    if (!status) status = sk_world_add_particles(world, count, positions, velocities, masses, error);
    if (!status) body->vertex_count = count;
    sk_release(allocator, masses);
    sk_release(allocator, velocities);
    sk_release(allocator, positions);
    return status;
}

static bool live(const void *params, const char *field) {
    (void)params, (void)field;
    return false; // all of it shapes what is built
}

static void change(sk_body *body, const void *params) {
    (void)body, (void)params;
}

const sk_body_type sk_flock = {
    .kind = {"flock", "loose particles, each flying its own way, for rules that steer", SKEIN_BODY, fields,
             sizeof fields / sizeof *fields, sizeof(flock_params)},
    .build = build,
    .live = live,
    .change = change,
    .shape = SKEIN_SHAPE_BIRDS,
};
