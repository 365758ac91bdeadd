/* Runs that several processes share (skein/share.h): a world that is a part of one, and a world whose steps the program
 * takes. */
#include <string.h>

#include "plan/share.h"
#include "world/world.h"

static skein_state state_of(skein_world *world) {
    const sk_particles *all = &world->particles;
    return (skein_state){all->count,
                         all->slot_count,
                         all->slot_of,
                         all->particle_of,
                         (skein_real(*)[4])(void *)all->vector[SK_X],
                         (skein_real(*)[4])(void *)all->vector[SK_V]};
}

skein_status skein_world_state(skein_world *world, skein_state *state) {
    SK_NEED(world, world);
    SK_NEED(world, state);
    skein_status status = sk_world_arrange(world, sk_world_error(world));
    if (!status) status = sk_world_touch(world);
    if (!status) *state = state_of(world);
    return status;
}

/* ---- a part ---- */

skein_status skein_world_part_set(skein_world *world, const skein_part *part) {
    SK_NEED(world, world);
    skein_error *error = sk_world_error(world);
    if (part && (!part->number || !part->measure || !part->exchange))
        return sk_fail(error, SKEIN_ERROR_VALUE, "part", "a part of a run needs number, measure and exchange");
    sk_share *share = part ? sk_allocate(&world->allocator, sizeof *share) : NULL;
    if (part && !share) return sk_fail_memory(error, "a part of a run");
    if (share) *share = (sk_share){.given = *part};
    sk_release(&world->allocator, world->share);
    world->share = share;
    world->plan_stale = true;
    return SKEIN_OK;
}

static size_t body_count(const skein_world *world) {
    size_t count = 0;
    for (size_t i = 0; i < world->objects.count; i++) count += world->objects.data[i]->category == SKEIN_BODY;
    return count;
}

skein_status sk_world_check_share(const skein_world *world, skein_error *error) {
    const char *what = world->device                 ? "another device"
                       : body_count(world) != 1      ? "any number of bodies but one"
                       : world->particles.strip_slots || world->triangles.count || world->rules.batches.count
                           ? "a body of more than single particles"
                       : world->motions.count || world->pins.count ? "particles that are led"
                                                                   : NULL;
    for (size_t r = 0; r < world->plan.count && !what; r++) {
        const sk_op *op = &world->plan.data[r];
        if (!sk_op_can_be_shared(op)) what = op->label ? op->label : sk_op_type_of(op)->name;
    }
    if (!what) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, "share",
                   "several processes cannot share a run with %s: it is of one flock, under a method that solves "
                   "nothing and rules that look at no certain particle",
                   what);
}

skein_status skein_world_can_share(skein_world *world, double dt) {
    SK_NEED(world, world);
    skein_error *error = sk_world_error(world);
    skein_status status = sk_world_compile(world, dt, error);
    return status ? status : sk_world_check_share(world, error);
}

/* ---- a world whose steps the program takes ---- */

typedef struct outside_device {
    sk_device base; /* first: the world's pointer is this one's */
    skein_runner runner;
} outside_device;

static skein_status prepare(sk_device *base, skein_world *world, skein_error *error) {
    (void)base, (void)world, (void)error;
    return SKEIN_OK;
}

static skein_status step(sk_device *base, skein_world *world, sk_run *run, skein_error *error) {
    outside_device *device = (outside_device *)(void *)base;
    skein_state state = state_of(world);
    skein_status status =
        device->runner.step(device->runner.user, run->time, world->plan_dt, base->behind ? &state : NULL, error);
    if (status) return status;
    base->behind = false;
    base->ahead = true;
    return SKEIN_OK;
}

static skein_status read_back(sk_device *base, skein_world *world, skein_error *error) {
    outside_device *device = (outside_device *)(void *)base;
    skein_state state = state_of(world);
    return device->runner.read(device->runner.user, &state,
                               (skein_real(*)[4])(void *)world->particles.vector[SK_PREVIOUS], error);
}

static void release(sk_device *base, skein_world *world) {
    outside_device *device = (outside_device *)(void *)base;
    if (device->runner.release) device->runner.release(device->runner.user);
    sk_release(&world->allocator, device);
}

static void wait_for(sk_device *base) {
    (void)base;
}

skein_status skein_world_runner_set(skein_world *world, const skein_runner *runner) {
    SK_NEED(world, world);
    skein_error *error = sk_world_error(world);
    if (!runner) return sk_world_set_device(world, NULL);
    if (!runner->name || !runner->step || !runner->read)
        return sk_fail(error, SKEIN_ERROR_VALUE, "runner", "a runner needs name, step and read");
    outside_device *device = sk_allocate(&world->allocator, sizeof *device);
    if (!device) return sk_fail_memory(error, "a runner");
    *device = (outside_device){{prepare, step, read_back, release, wait_for, false, true, runner->name}, *runner};
    skein_status status = sk_world_set_device(world, &device->base);
    if (status) sk_release(&world->allocator, device);
    return status;
}
