/* Pins that are led: pinned particles that are somewhere else at the end of a step.
 *
 * Held particles go on with their velocity under every method, and nothing acts on them. So a place for the end of a
 * step is a velocity for its time: all ops see it, and know no pins. Between steps a pin rests, so that positions,
 * velocities and what is held are still all of the state.
 *
 * Motions (world/motions.c) say places by the time; what a program says comes after them and counts.
 *
 *   places wait --set out--> V = (place - X)/dt --the plan--> X --arrive--> X = place, V = 0
 *
 * Of the way that a moving frame makes, pins are carried along with all others first (world/frames.c). */
#include <math.h>
#include <string.h>

#include "world/record.h"
#include "world/world.h"

/* Drops what a later place has overridden, where the list holds more than there are particles. */
static bool shorten(skein_world *world) {
    size_t count = world->particles.count, kept = world->pins.count;
    if (kept <= count) return true;
    bool *seen = sk_allocate(&world->allocator, count * sizeof *seen);
    if (!seen) return false;
    memset(seen, 0, count * sizeof *seen);
    for (size_t i = world->pins.count; i-- > 0;) {
        sk_pin pin = world->pins.data[i];
        if (!seen[pin.particle]) world->pins.data[--kept] = pin;
        seen[pin.particle] = true;
    }
    sk_release(&world->allocator, seen);
    world->pins.count -= kept;
    memmove(world->pins.data, world->pins.data + kept, world->pins.count * sizeof *world->pins.data);
    return true;
}

static skein_status check_pins(skein_world *world, const uint32_t *particles, size_t count, const double *xyz) {
    const sk_particles *all = &world->particles;
    skein_error *error = sk_world_error(world);
    for (size_t i = 0; i < count; i++) {
        size_t particle = particles ? particles[i] : i;
        if (particle >= all->count)
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "there is no particle %zu (the world has %zu)", particle,
                           all->count);
        if (!all->pinned[particle])
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "particle %zu is not pinned: pin it with skein_particle_pin()",
                           particle);
        for (size_t k = 0; k < 3; k++)
            if (!(fabs(xyz[3 * i + k]) <= SK_FAR))
                return sk_fail(error, SKEIN_ERROR_VALUE, "", "particle %zu: numbers must be finite, under 1e15",
                               particle);
    }
    return SKEIN_OK;
}

skein_status skein_pins_move(skein_world *world, const uint32_t *particles, size_t count, const double *xyz) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, xyz);
    skein_status status = check_pins(world, particles, count, xyz);
    if (status) return status;
    if (!shorten(world) || !SK_RESERVE(&world->allocator, &world->pins, world->pins.count + count))
        return sk_fail_memory(sk_world_error(world), "places for pins");
    for (size_t i = 0; i < count; i++)
        world->pins.data[world->pins.count++] =
            (sk_pin){particles ? particles[i] : (uint32_t)i, {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]}};
    sk_record_pins(world, particles, count, xyz);
    return SKEIN_OK;
}

/* The velocity with which a pin is at its place after dt. */
static skein_status set_out(skein_world *world, const sk_pin *pin, double dt, skein_error *error) {
    const sk_particles *all = &world->particles;
    size_t slot = all->slot_of[pin->particle];
    sk_vec4 x = all->vector[SK_X][slot], *v = &all->vector[SK_V][slot];
    double way[3] = {pin->place[0] - (double)x.x, pin->place[1] - (double)x.y, pin->place[2] - (double)x.z};
    for (int k = 0; k < 3; k++)
        if (!(fabs(way[k] / dt) <= SK_FAR))
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "pin %u: %g m in a step of %g s is too fast", pin->particle,
                           way[k], dt);
    *v = (sk_vec4){(real)(way[0] / dt), (real)(way[1] / dt), (real)(way[2] / dt), v->w};
    return SKEIN_OK;
}

/* Whether it is still to be led: it may have been let go since, or its body taken out. */
static bool is_led(const skein_world *world, const sk_pin *pin) {
    return world->particles.pinned[pin->particle] && sk_particle_is_here(&world->particles, pin->particle);
}

skein_status sk_world_set_out(skein_world *world, double dt, skein_error *error) {
    const sk_particles *all = &world->particles;
    skein_status status = sk_world_carry(world, dt, error);
    if (status) return status;
    for (size_t i = 0; i < world->rules.colliders.count; i++) // before pins: some sit on them
        sk_collider_begin(world->rules.colliders.data[i], world->time, dt);
    status = sk_world_set_leashes(world, dt, error);
    if (status) return status;
    if (!sk_world_lead(world, world->time + dt)) return sk_fail_memory(error, "places for pins");
    status = world->led.count ? sk_world_touch(world) : SKEIN_OK;
    for (size_t i = 0; i < world->led.count && !status; i++)
        if (is_led(world, &world->led.data[i])) status = set_out(world, &world->led.data[i], dt, error);
    if (status) {
        sk_world_arrive(world, false);
        world->pins.count = 0;
        return status;
    }
    if (world->device) return SKEIN_OK; // which runs no limits that look at pins
    for (size_t i = 0; i < world->rules.limits.count; i++)
        if (sk_limit_is_on(world->rules.limits.data[i]))
            sk_limit_begin(world->rules.limits.data[i], all->vector[SK_X], all->vector[SK_V], world->time);
    return SKEIN_OK;
}

skein_status sk_world_arrive(skein_world *world, bool done) {
    const sk_particles *all = &world->particles;
    if (done && !world->device) sk_world_uncarry_previous(world);
    if (!world->led.count) return SKEIN_OK;
    skein_status status = sk_world_touch(world);
    for (size_t i = 0; i < world->led.count && !status; i++) {
        const sk_pin *pin = &world->led.data[i];
        if (!is_led(world, pin)) continue;
        sk_vec4 *x = &all->vector[SK_X][all->slot_of[pin->particle]],
                *v = &all->vector[SK_V][all->slot_of[pin->particle]];
        if (done) *x = (sk_vec4){(real)pin->place[0], (real)pin->place[1], (real)pin->place[2], x->w};
        *v = (sk_vec4){0, 0, 0, v->w};
    }
    world->led.count = 0;
    if (done) world->pins.count = 0;
    return status;
}
