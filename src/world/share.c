/* Runs that several processes share (skein/share.h): a world that is a part of one, and a world whose steps the program
 * takes. */
#include <string.h>

#include "plan/share_part.h"
#include "world/cut.h"

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

static const sk_object *body_after(const skein_world *world, size_t *at) {
    while (*at < world->objects.count && world->objects.data[*at]->category != SKEIN_BODY) ++*at;
    return *at < world->objects.count ? world->objects.data[(*at)++] : NULL;
}

skein_status skein_world_part_set(skein_world *world, const skein_part *part) {
    SK_NEED(world, world);
    skein_error *error = sk_world_error(world);
    if (part && (!part->number || !part->measure || !part->send || !part->receive))
        return sk_fail(error, SKEIN_ERROR_VALUE, "part", "a part of a run needs number, measure, send and receive");
#ifdef SK_SMALL
    if (part) return sk_fail(error, SKEIN_ERROR_VALUE, "part", "this build has no parts of runs");
#endif
    sk_share *share = part ? sk_share_create(&world->allocator, part) : NULL;
    if (part && !share) return sk_fail_memory(error, "a part of a run");
    sk_share_destroy(world->share, &world->allocator);
    world->share = share;
    sk_world_wake_all(world);
    world->plan_stale = true;
    return SKEIN_OK;
}

skein_status skein_world_part_shadow(skein_world *world, size_t number) {
    static const bool off = false;
    SK_NEED(world, world);
    size_t at = 0;
    const sk_object *object = body_after(world, &at);
    for (size_t i = 0; i < number && object; i++) object = body_after(world, &at);
    if (!object)
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "body", "there is no body %zu in this world", number);
    const sk_body *body = object->as.body;
    for (size_t i = 0; i < body->batch_count; i++) body->batch[i]->enabled = &off;
    for (size_t i = 0; i < world->rules.limits.count; i++)
        if (world->rules.limits.data[i]->enabled == &body->enabled) world->rules.limits.data[i]->enabled = &off;
    world->plan_stale = world->slots_stale = true;
    return SKEIN_OK;
}

/* ---- what can be shared ---- */

/* The bodies of a world, and which of them stay together. */
typedef struct body_list {
    skein_share_body *data;
    size_t count;
} body_list;

static size_t body_with(const body_list *list, size_t particle) {
    for (size_t b = 0; b < list->count; b++)
        if (particle >= list->data[b].first && particle - list->data[b].first < list->data[b].count) return b;
    return list->count;
}

/* Two bodies, and all that either is with, are with the first of them. */
static void join(body_list *list, size_t a, size_t b) {
    if (a == list->count || b == list->count) return;
    size_t one = list->data[a].together, other = list->data[b].together;
    for (size_t i = 0; i < list->count; i++)
        if (list->data[i].together == one || list->data[i].together == other)
            list->data[i].together = one < other ? one : other;
    list->data[a].loose = list->data[b].loose = false;
}

/* Those whose particles are these. A body is joined with itself, too. */
static void join_particles(body_list *list, const uint32_t *particle, size_t count, double work) {
    size_t last = list->count;
    for (size_t i = 0; i < count; i++) {
        if (last < list->count && particle[i] >= list->data[last].first &&
            particle[i] - list->data[last].first < list->data[last].count)
            continue;
        size_t body = body_with(list, particle[i]);
        join(list, last < list->count ? last : body, body);
        last = body;
    }
    if (last < list->count) list->data[last].work += work;
}

/* Bodies whose particles a rule looks at together with others', all of them in [first, end), where none is loose. */
static void join_range(body_list *list, const sk_group *group) {
    size_t last = list->count;
    for (size_t b = 0; b < list->count; b++) {
        if (list->data[b].first < group->first || list->data[b].first >= group->end) continue;
        join(list, last < list->count ? last : b, b);
        last = b;
    }
}

static bool has_loose(const body_list *list, const sk_group *group) {
    for (size_t b = 0; b < list->count; b++)
        if (list->data[b].loose && list->data[b].enabled && list->data[b].first >= group->first &&
            list->data[b].first < group->end)
            return true;
    return false;
}

static bool list_bodies(skein_world *world, body_list *list) {
    size_t at = 0;
    const sk_object *object;
    list->data = sk_allocate(&world->allocator, (world->objects.count + 1) * sizeof *list->data);
    list->count = 0;
    while (list->data && (object = body_after(world, &at)) != NULL) {
        const sk_body *body = object->as.body;
        bool loose = body->particle_count && !body->triangle_count && !body->grid_rows && !body->batch_count &&
                     sk_field_named(object->kind->fields, object->kind->field_count, "count");
        list->data[list->count] = (skein_share_body){
            body->first_particle,        body->particle_count, body->enabled, loose, list->count, false,
            (double)body->particle_count};
        list->count++;
    }
    return list->data != NULL;
}

/* What joins bodies, but for rules that look at neighbours. */
static void join_by_constraints(const skein_world *world, body_list *list) {
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        join_particles(list, batch->particle, batch->count * batch->arity, (double)batch->count);
    }
    for (size_t i = 0; i < world->rules.limits.count; i++) {
        const sk_limit *limit = world->rules.limits.data[i];
        join_particles(list, limit->particle, limit->count * (1 + limit->anchors), (double)limit->count);
    }
}

static const char *op_name(const sk_op *op) {
    // what a solve consists of, and arithmetic that only a solve has, have formulas for labels
    const sk_op_type *type = sk_op_type_of(op);
    if (type->arithmetic || type->leads) return "a method that solves for all particles at once (backward Euler)";
    return op->label ? op->label : type->name;
}

/* Bodies in [first, end) are shown, where none of them is loose: a part where they are not would do without their rule. */
static void show(body_list *list, const sk_group *group) {
    for (size_t b = 0; b < list->count && !has_loose(list, group); b++)
        list->data[b].shown |= list->data[b].first >= group->first && list->data[b].first < group->end;
}

/* Rules that look at neighbours: over loose bodies they do it across parts, else all are in one. */
static void join_by_neighbours(const skein_world *world, body_list *list) {
    for (size_t r = 0; r < world->plan.count; r++) {
        const sk_op *op = &world->plan.data[r];
        if (!sk_op_type_of(op)->walks) continue;
        const sk_group *group = op->group ? op->group : &world->everybody,
                       *seen = op->seen ? op->seen : &world->everybody;
        if (has_loose(list, group) || has_loose(list, seen)) {
            show(list, group);
            show(list, seen);
            const sk_only *only = &((const sk_force *)op->rule)->only;
            for (size_t i = 0; i < only->count; i++)
                show(list, &(sk_group){only->data[i].first, only->data[i].end, 0, 0, 0});
            continue;
        }
        join_range(list, group);
        join_range(list, seen);
        join(list, body_with(list, group->first), body_with(list, seen->first));
    }
}

/* Constraints of the program's own, and tracks, know particles by numbers, which are others where a loose body comes before. */
static bool knows_numbers(const skein_world *world, const body_list *list) {
    size_t first_loose = SIZE_MAX, at = 0;
    for (size_t b = 0; b < list->count; b++)
        if (list->data[b].loose && list->data[b].first < first_loose) first_loose = list->data[b].first;
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        bool own = false;
        const sk_object *object;
        for (at = 0; (object = body_after(world, &at)) != NULL;)
            for (size_t k = 0; k < object->as.body->batch_count; k++) own |= object->as.body->batch[k] == batch;
        for (size_t k = 0; k < batch->count * batch->arity && !own; k++)
            if (batch->particle[k] >= first_loose) return true;
    }
    return false;
}

/* Whether a motion leads the pins of more bodies than one. */
static bool leads_several(const skein_world *world, const sk_motion *motion) {
    size_t cursor = 0;
    const char *on = motion->common->on;
    return !on[0] || (sk_world_next_named(world, on, &cursor) && sk_world_next_named(world, on, &cursor));
}

static bool leads_loose(const skein_world *world, const body_list *list) {
    bool loose = false;
    for (size_t b = 0; b < list->count; b++) loose |= list->data[b].loose;
    for (size_t i = 0; i < world->motions.count; i++) {
        const sk_motion *motion = world->motions.data[i];
        if ((loose && motion->type->given) || (list->count > 1 && leads_several(world, motion))) return true;
        for (size_t k = 0; k < motion->count; k++) {
            size_t b = body_with(list, motion->particle[k]);
            if (b < list->count && list->data[b].loose) return true;
        }
    }
    return world->pins.count != 0;
}

/* What of a world whose plan is up to date cannot be shared, or NULL. */
static const char *what_cannot(skein_world *world, body_list *list) {
    const char *what = NULL;
    if (world->device) return "another device";
    if (sk_world_tears(world)) return "a body that tears";
    if (list->count ? world->particles.count != list->data[list->count - 1].first + list->data[list->count - 1].count
                    : true)
        return "particles of no body";
    join_by_constraints(world, list);
    for (size_t r = 0; r < world->plan.count && !what; r++)
        if (!sk_op_can_be_shared(&world->plan.data[r])) what = op_name(&world->plan.data[r]);
    if (what) return what;
    join_by_neighbours(world, list);
    if (knows_numbers(world, list)) return "constraints of its own on bodies behind a flock: put the flock last";
    if (leads_loose(world, list)) return "particles of a flock that are led, or of more bodies than one";
    return NULL;
}

static skein_status fail_share(const char *what, skein_error *error) {
    if (!what) return SKEIN_OK;
    return sk_fail(
        error, SKEIN_ERROR_VALUE, "share",
        "several processes cannot share a run with %s: it is of flocks, and of bodies that meet nobody but by "
        "rules that look at their neighbours and a flock's, under a method that solves nothing",
        what);
}

skein_status sk_world_check_share(skein_world *world, skein_error *error) {
    body_list list;
    if (!list_bodies(world, &list)) return sk_fail_memory(error, "the bodies of a run");
    skein_status status = fail_share(what_cannot(world, &list), error);
    sk_release(&world->allocator, list.data);
    return status;
}

skein_status skein_world_share_bodies(skein_world *world, double dt, skein_share_body *out, size_t most, size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, count);
    if (most) SK_NEED(world, out);
    body_list list;
    skein_error *error = sk_world_error(world);
    skein_status status = sk_world_compile(world, dt, error);
    *count = 0;
    if (status) return status;
    if (!list_bodies(world, &list)) return sk_fail_memory(error, "the bodies of a run");
    status = fail_share(what_cannot(world, &list), error);
    *count = status ? 0 : list.count;
    for (size_t i = 0; i < *count && i < most; i++) out[i] = list.data[i];
    sk_release(&world->allocator, list.data);
    return status;
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
