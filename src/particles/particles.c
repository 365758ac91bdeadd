#include "particles/particles.h"

#include <string.h>

/* Moves one array into a larger block; the new part is zero. */
static bool grow(sk_allocator *allocator, void **array, size_t old_count, size_t new_count, size_t size) {
    void *grown = sk_allocate(allocator, new_count * size);
    if (!grown) return false;
    if (*array && old_count) memcpy(grown, *array, old_count * size);
    sk_release(allocator, *array);
    *array = grown;
    return true;
}

static bool reserve(sk_particles *particles, sk_allocator *allocator, size_t need) {
    if (need <= particles->capacity) return true;
    size_t room = particles->capacity * 2 > need ? particles->capacity * 2 : need;
    room = (room + 15) / 16 * 16;
    size_t old = particles->capacity;
    // each array grows on its own: if one fails, the others are merely larger than they need be
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++)
        if (!grow(allocator, (void **)&particles->vector[v], old, room, sizeof(sk_vec4))) return false;
    if (!grow(allocator, (void **)&particles->slot_of, old, room, sizeof(uint32_t)) ||
        !grow(allocator, (void **)&particles->built, old, room, sizeof(sk_vec3)) ||
        !grow(allocator, (void **)&particles->mass, old, room, sizeof(real)) ||
        !grow(allocator, (void **)&particles->held, old, room, sizeof(bool)))
        return false;
    particles->capacity = room;
    return true;
}

bool sk_particles_add(sk_particles *particles, sk_allocator *allocator, size_t count, const double *positions,
                      const double *velocities, const double *masses) {
    if (!reserve(particles, allocator, particles->count + count)) return false;
    for (size_t k = 0; k < count; k++) {
        size_t i = particles->count + k;
        const double *p = positions + 3 * k, *v = velocities ? velocities + 3 * k : (const double[3]){0, 0, 0};
        real mass = (real)masses[k];
        particles->slot_of[i] = (uint32_t)i;
        particles->built[i] = sk_v3_of(p);
        particles->mass[i] = mass;
        particles->held[i] = !(mass > 0);
        particles->vector[SK_X][i] = (sk_vec4){(real)p[0], (real)p[1], (real)p[2], mass > 0 ? 1 / mass : 0};
        particles->vector[SK_V][i] = (sk_vec4){(real)v[0], (real)v[1], (real)v[2], mass};
        particles->vector[SK_PREVIOUS][i] = particles->vector[SK_X][i];
    }
    particles->count += count;
    particles->slot_count = (particles->count + 15) / 16 * 16;
    return true;
}

void sk_particles_truncate(sk_particles *particles, size_t count) {
    for (size_t i = count; i < particles->count; i++)
        for (int v = SK_X; v < SK_VECTOR_COUNT; v++) particles->vector[v][particles->slot_of[i]] = (sk_vec4){0, 0, 0, 0};
    particles->count = count;
    particles->slot_count = (count + 15) / 16 * 16;
}

void sk_particles_reset(sk_particles *particles) {
    for (size_t i = 0; i < particles->count; i++) {
        uint32_t s = particles->slot_of[i];
        sk_vec3 p = particles->built[i];
        particles->vector[SK_X][s] = (sk_vec4){p.x, p.y, p.z, particles->vector[SK_X][s].w};
        particles->vector[SK_V][s] = (sk_vec4){0, 0, 0, particles->vector[SK_V][s].w};
        particles->vector[SK_F][s] = (sk_vec4){0, 0, 0, 0};
        particles->vector[SK_PREVIOUS][s] = particles->vector[SK_X][s];
    }
}

void sk_particle_hold(sk_particles *particles, size_t particle, bool held) {
    uint32_t s = particles->slot_of[particle];
    real mass = particles->mass[particle];
    particles->held[particle] = held || !(mass > 0);
    particles->vector[SK_X][s].w = particles->held[particle] ? 0 : 1 / mass;
    if (held) particles->vector[SK_V][s] = (sk_vec4){0, 0, 0, particles->vector[SK_V][s].w};
}

void sk_particles_release(sk_particles *particles, sk_allocator *allocator) {
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++) sk_release(allocator, particles->vector[v]);
    sk_release(allocator, particles->slot_of);
    sk_release(allocator, particles->built);
    sk_release(allocator, particles->mass);
    sk_release(allocator, particles->held);
    memset(particles, 0, sizeof *particles);
}
