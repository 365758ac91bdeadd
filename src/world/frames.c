/* Motions as moving frames: bodies that live in them, and colliders that go with them.
 *
 * From the start of a step to its end a motion goes by D, a rigid map. Before anything else is done, bodies that live in it
 * are carried along by a share of D, 1 - inertia, or all of it where the step is a jump: positions of free particles and
 * pins alike, and velocities turn. What is left of the way, pins and colliders make substep by substep, as ever, and the
 * body feels it. So with an inertia of 1 nothing is done at all; with 0 a body is where it would be if the motion stood
 * still, taken along; and a jump flings nobody.
 *
 *   a motion's places, now and then --frame_of--> D --share--> what is carried --put_along--> X, V; colliders' ways
 *
 * Several motions of one body act one after the other, as on its pins, each with its own share. All of it follows from the
 * time and the fields: no state is kept from step to step. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "world/record.h"
#include "world/world.h"

/* ---- the frame of a motion ---- */

/* The nearest frame to the places that it leads its particles to. */
static bool fit(const skein_world *world, sk_allocator *allocator, const sk_motion *motion, double since,
                sk_frame *frame) {
    double(*places)[3] = sk_allocate(allocator, (2 * motion->count + 1) * sizeof *places);
    if (!places) return false;
    for (size_t i = 0; i < motion->count; i++) {
        sk_vec3 built = world->particles.built[motion->particle[i]];
        const double from[3] = {(double)built.x, (double)built.y, (double)built.z};
        double *to = places[motion->count + i];
        memcpy(places[i], from, sizeof from);
        memcpy(to, from, sizeof from);
        motion->type->move(motion, i, since, to);
    }
    *frame = motion->count
                 ? sk_frame_fit(motion->count, (const double(*)[3])places, (const double(*)[3])places + motion->count)
                 : SK_NO_FRAME;
    sk_release(allocator, places);
    return true;
}

/* Where a motion puts what was built, at a time. Of one that moves all of space rigidly that is exact. */
static bool frame_of(const skein_world *world, sk_allocator *allocator, const sk_motion *motion, double time,
                     sk_frame *frame) {
    double since = fmax(0, time - motion->common->start);
    if (motion->type->given) return fit(world, allocator, motion, since, frame);
    *frame = SK_NO_FRAME;
    memset(frame->shift, 0, sizeof frame->shift);
    motion->type->move(motion, 0, since, frame->shift);
    for (int c = 0; c < 3; c++) {
        double to[3] = {c == 0, c == 1, c == 2};
        motion->type->move(motion, 0, since, to);
        for (int r = 0; r < 3; r++) frame->turn[3 * r + c] = to[r] - frame->shift[r];
    }
    return sk_is_turn(frame->turn) ? true : fit(world, allocator, motion, since, frame);
}

/* Whether it is more than what leads pins. */
static bool is_frame(const sk_motion *motion) {
    const sk_motion_common *common = motion->common;
    return common->enabled && (common->colliders[0] || common->inertia < 1 || common->jump < SK_UNBOUNDED ||
                               common->jump_turn < 180 || common->jump_times[0]);
}

bool sk_world_carries(const skein_world *world, const sk_common *body) {
    for (size_t i = 0; i < world->motions.count; i++) {
        const sk_motion *motion = world->motions.data[i];
        const bool its = !motion->common->on[0] || sk_names_mean(motion->common->on, body->name, body->groups);
        if (its && (is_frame(motion) || sk_motion_is_leash(motion))) return true;
    }
    return false;
}

static bool any_frame(const skein_world *world) {
    for (size_t i = 0; i < world->motions.count; i++)
        if (is_frame(world->motions.data[i])) return true;
    return false;
}

/* What it is that makes the way: the middle of those that it leads, or its first collider. */
static void find_middle(const skein_world *world, const sk_motion *motion, double middle[3]) {
    memcpy(middle, motion->middle, sizeof motion->middle);
    for (size_t i = 0; i < world->rules.colliders.count && !motion->count; i++) {
        const sk_collider *collider = world->rules.colliders.data[i];
        if (!sk_names_have(motion->common->colliders, sk_word_of(collider->common->name))) continue;
        collider->type->place(collider->params, middle);
        return;
    }
}

static bool is_jump(const skein_world *world, const sk_motion *motion, const sk_leg *leg, const sk_frame *way,
                    double time, double dt) {
    const sk_motion_common *common = motion->common;
    double from[3], to[3], start[3], since = time - common->start;
    if (common->jump_times[0] && sk_motion_jumps(common, since, since + dt)) return true;
    if (common->jump_turn < 180 && sk_frame_angle(way) > common->jump_turn * (3.14159265358979323846 / 180))
        return true;
    if (!(common->jump < SK_UNBOUNDED)) return false;
    find_middle(world, motion, start);
    sk_frame_place(&leg->start, start, from);
    sk_frame_place(way, from, to);
    return hypot(hypot(to[0] - from[0], to[1] - from[1]), to[2] - from[2]) > common->jump;
}

/* Where all motions are now, where they carry what lives in them, and where they will be. */
static skein_status find_legs(skein_world *world, double dt, skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    if (!SK_RESERVE(allocator, &world->legs, world->motions.count)) return sk_fail_memory(error, "frames of motions");
    world->legs.count = world->motions.count;
    for (size_t i = 0; i < world->motions.count; i++) {
        const sk_motion *motion = world->motions.data[i];
        sk_leg *leg = &world->legs.data[i];
        *leg = (sk_leg){.start = SK_NO_FRAME, .carried = SK_NO_FRAME, .end = SK_NO_FRAME};
        if (!motion->common->enabled) continue;
        if (!frame_of(world, allocator, motion, world->time, &leg->start) ||
            !frame_of(world, allocator, motion, world->time + dt, &leg->end))
            return sk_fail_memory(error, "frames of motions");
        sk_frame back = sk_frame_back(&leg->start), way = sk_frame_then(&back, &leg->end);
        leg->jumps = is_jump(world, motion, leg, &way, world->time, dt);
        double share = leg->jumps ? 1 : 1 - motion->common->inertia;
        leg->carries = share > 0;
        sk_frame part = sk_frame_share(&way, share);
        leg->carried = sk_frame_then(&leg->start, &part);
    }
    return SKEIN_OK;
}

/* ---- several motions, one after the other ---- */

typedef struct journey {
    sk_frame now, carried, end; /* carried: from now on */
    bool led, carries, jumps;
} journey;

static void add_leg(journey *all, const sk_leg *leg) {
    all->now = sk_frame_then(&all->now, &leg->start);
    all->carried = sk_frame_then(&all->carried, &leg->carried);
    all->end = sk_frame_then(&all->end, &leg->end);
    all->led = true;
    all->carries |= leg->carries, all->jumps |= leg->jumps;
}

/* What a body (NULL: particles of none) lives in, or a collider goes with. */
static journey journey_of(const skein_world *world, const sk_common *body, const char *collider) {
    journey all = {.now = SK_NO_FRAME, .carried = SK_NO_FRAME, .end = SK_NO_FRAME};
    for (size_t i = 0; i < world->legs.count; i++) {
        const sk_motion_common *common = world->motions.data[i]->common;
        bool its = collider ? sk_names_have(common->colliders, sk_word_of(collider))
                            : !common->on[0] || (body && sk_names_mean(common->on, body->name, body->groups));
        if (common->enabled && its) add_leg(&all, &world->legs.data[i]);
    }
    sk_frame back = sk_frame_back(&all.now);
    all.carried = sk_frame_then(&back, &all.carried);
    return all;
}

/* ---- who is carried ---- */

static void place(const sk_frame *frame, sk_vec4 *x) {
    const double from[3] = {(double)x->x, (double)x->y, (double)x->z};
    double to[3];
    sk_frame_place(frame, from, to);
    *x = (sk_vec4){(real)to[0], (real)to[1], (real)to[2], x->w};
}

/* Puts particles elsewhere; their velocities turn. */
static void put(sk_particles *particles, size_t first, size_t count, const sk_frame *frame, bool previous) {
    const sk_frame turn = {{frame->turn[0], frame->turn[1], frame->turn[2], frame->turn[3], frame->turn[4],
                            frame->turn[5], frame->turn[6], frame->turn[7], frame->turn[8]},
                           {0, 0, 0}};
    for (size_t i = first; i < first + count; i++) {
        if (particles->presence[i] == SK_GONE) continue; // it has no place of its own
        size_t slot = particles->slot_of[i];
        place(frame, &particles->vector[SK_X][slot]);
        place(&turn, &particles->vector[SK_V][slot]);
        if (previous) place(frame, &particles->vector[SK_PREVIOUS][slot]);
    }
}

/* Carries a run of particles, and notes it: what is seen between two steps goes on from where they were. */
static bool put_along(skein_world *world, size_t first, size_t count, const journey *way) {
    if (!way->carries || !count) return true;
    if (!SK_RESERVE(&world->allocator, &world->carried, world->carried.count + 1)) return false;
    put(&world->particles, first, count, &way->carried, false);
    world->carried.data[world->carried.count++] = (sk_carried){first, count, way->carried, way->jumps};
    return true;
}

/* Marks the particles of bodies, or takes the marks off again. */
static void mark_bodies(skein_world *world, uint32_t mark) {
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_BODY) continue;
        const sk_body *body = object->as.body;
        for (size_t p = 0; p < body->particle_count; p++) world->led_at[body->first_particle + p] = mark;
    }
}

/* Particles that are in no body. */
static bool carry_loose(skein_world *world) {
    journey way = journey_of(world, NULL, NULL);
    bool good = true;
    if (!way.carries) return true;
    mark_bodies(world, 0); // where places of pins are listed: nobody's is now
    for (size_t first = 0, end; first < world->particles.count && good; first = end) {
        for (end = first + 1; end < world->particles.count && (world->led_at[end] == 0) == (world->led_at[first] == 0);)
            end++;
        if (world->led_at[first]) good = put_along(world, first, end - first, &way);
    }
    mark_bodies(world, SK_NOBODY);
    return good;
}

static void lead_colliders(skein_world *world) {
    for (size_t i = 0; i < world->rules.colliders.count; i++) {
        sk_collider *collider = world->rules.colliders.data[i];
        journey way = journey_of(world, NULL, collider->common->name);
        if (way.led) sk_collider_lead(collider, world->time, &way.now, &way.carried, &way.end);
    }
}

skein_status sk_world_carry(skein_world *world, double dt, skein_error *error) {
    world->carried.count = 0;
    if (!any_frame(world)) return SKEIN_OK;
    skein_status status = sk_world_touch(world);
    if (!status) status = find_legs(world, dt, error);
    if (status) return status;
    bool good = carry_loose(world);
    for (size_t i = 0; i < world->objects.count && good; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_BODY || !object->as.body->enabled) continue;
        journey way = journey_of(world, &object->common.plain, NULL);
        good = put_along(world, object->as.body->first_particle, object->as.body->particle_count, &way);
    }
    lead_colliders(world);
    return good ? SKEIN_OK : sk_fail_memory(error, "frames of motions");
}

void sk_world_uncarry_previous(skein_world *world) {
    for (size_t i = 0; i < world->carried.count; i++) {
        const sk_carried *run = &world->carried.data[i];
        sk_frame back = sk_frame_back(&run->way);
        for (size_t p = run->first; p < run->first + run->count && !run->jumps; p++)
            if (world->particles.presence[p] != SK_GONE)
                place(&back, &world->particles.vector[SK_PREVIOUS][world->particles.slot_of[p]]);
    }
    world->carried.count = 0;
}

/* ---- before a step is begun ---- */

bool sk_world_look_ahead(skein_world *world, double dt) {
    skein_error ignored;
    return !any_frame(world) || !find_legs(world, dt, &ignored);
}

sk_frame sk_world_frame_ahead(const skein_world *world, const char *collider) {
    journey way = journey_of(world, NULL, collider);
    return way.end;
}

/* ---- colliders between steps ---- */

bool sk_world_place_colliders(skein_world *world) {
    bool any = any_frame(world);
    skein_error ignored;
    if (any && find_legs(world, 0, &ignored)) return false;
    for (size_t i = 0; i < world->rules.colliders.count; i++) {
        sk_collider *collider = world->rules.colliders.data[i];
        journey way = {.led = false};
        if (any) way = journey_of(world, NULL, collider->common->name);
        if (!way.led && !collider->led) continue;
        collider->travel.ever |= way.led && !collider->led;
        collider->led = way.led;
        collider->frame = way.now;
    }
    return true;
}

/* ---- by a program ---- */

skein_status skein_body_teleport(skein_world *world, skein_handle handle, const double turn[9], const double shift[3]) {
    SK_NEED(world, world);
    sk_object *object = sk_object_find(world, handle, SKEIN_BODY);
    skein_error *error = sk_world_error(world);
    if (!object) return SKEIN_ERROR_HANDLE;
    sk_frame frame = SK_NO_FRAME;
    if (turn) memcpy(frame.turn, turn, sizeof frame.turn);
    if (shift) memcpy(frame.shift, shift, sizeof frame.shift);
    for (int k = 0; k < 3; k++)
        if (!(fabs(frame.shift[k]) <= SK_FAR))
            return sk_fail(error, SKEIN_ERROR_VALUE, "shift", "numbers must be finite, under 1e15");
    if (!sk_is_turn(frame.turn))
        return sk_fail(error, SKEIN_ERROR_VALUE, "turn",
                       "expected the three rows of a rotation: of length 1, at right angles");
    skein_status status = sk_world_touch(world);
    if (status) return status;
    const sk_body *body = object->as.body;
    sk_world_rouse_at(world, body->first_particle, body->particle_count);
    put(&world->particles, body->first_particle, body->particle_count, &frame, true);
    sk_record_state(world);
    return SKEIN_OK;
}
