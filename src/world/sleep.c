/* Bodies that fall asleep: what has come to rest is left out of all work until something comes near it or is changed.
 *
 * A body with `sleep` over 0 is still while nobody of it goes farther from where it was than that speed would take it in
 * half a second. Bodies that may touch, for their boxes meet, or that a constraint joins, fall asleep together, once all
 * of them have been still for so long; what is all pinned and does not move is no hindrance. A sleeping body is as one
 * that is disabled (particles/particles.h: it has no slots that an op would meet), but it counts in all that is measured
 * and drawn, and its velocities are 0.
 *
 *   awake --still for half a second, and so is all that it may touch--> asleep
 *   asleep --before a step: it was changed by hand; a rule was; its pins are led elsewhere; a collider that moves comes
 *            near; so does the box of what is awake-->  awake, and so at once is all that it may touch
 *
 * The half second begins anew where that is broken off, for what holds a body up may have gone and it has only begun to fall:
 * where somebody came near or went, where something moves it or a collider moves near it, and where it, or any rule, is changed.
 *
 * All of it follows from the state before a step and after it, by least and greatest values, which know no order: so it
 * is the same for any threads. What is kept for it, where a body began to be still and since when, is in snapshots. */
#include <string.h>

#include "world/sleep.h"

static const double still_for = 0.5; /* s */

/* ---- bodies ---- */

static void forget_places(skein_world *world, sk_body *body) {
    sk_release(&world->allocator, body->rest.from);
    body->rest.from = NULL;
    body->rest.still = 0;
}

void sk_body_forget_rest(skein_world *world, sk_body *body) {
    forget_places(world, body);
    body->rest = (sk_rest){.asleep = false};
    world->sleepers_known = false;
}

void sk_body_set_asleep(skein_world *world, sk_body *body, bool asleep) {
    sk_body_forget_rest(world, body);
    body->rest.asleep = asleep;
    sk_particles_set_presence(&world->particles, body->first_particle, body->particle_count,
                              asleep ? SK_ASLEEP : SK_HERE);
    world->plan_stale = world->slots_stale = true;
}

static void wake(skein_world *world, sk_body *body) {
    if (body->rest.asleep) sk_body_set_asleep(world, body, false);
}

void sk_world_wake_all(skein_world *world) {
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = sk_world_body_at(world, i);
        if (!body) continue;
        wake(world, body);
        sk_body_forget_rest(world, body);
    }
    world->roused = false;
}

void sk_world_rouse(skein_world *world) {
    world->roused = true;
    world->sleepers_known = false;
}

void sk_world_rouse_at(skein_world *world, size_t first, size_t count) {
    size_t of_bodies = 0;
    bool any = false;
    world->sleepers_known = false;
    for (size_t i = 0; i < world->objects.count && !any; i++)
        any = sk_world_body_at(world, i) &&
              (sk_world_body_at(world, i)->rest.asleep || sk_world_body_at(world, i)->rest.from);
    if (!any) return; // nobody sleeps, or is about to
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = sk_world_body_at(world, i);
        if (!body) continue;
        const size_t begin = body->first_particle, end = begin + body->particle_count;
        if (begin >= first + count || first >= end) continue;
        of_bodies += (end < first + count ? end : first + count) - (begin > first ? begin : first);
        if (!body->rest.roused) sk_box_begin(body->rest.low, body->rest.high);
        sk_box_widen(&world->particles, body, 0, body->rest.low, body->rest.high); // whom it leaves is to know
        body->rest.roused = true;
    }
    if (of_bodies < count) sk_world_rouse(world); // some are of no body
}

/* Where nothing may sleep: steps are done elsewhere, or are parts of steps. */
static bool is_sleepless(const skein_world *world) {
    return world->device || world->share;
}

/* ---- waking ---- */

/* Those who are to wake, and all that these may touch; what stands pinned wakes where somebody comes near it. */
static void wake_islands(const sk_neighbours *r, double dt) {
    skein_world *world = r->world;
    for (size_t n = 0; n < r->count; n++) {
        sk_sleeper *s = &r->of[n];
        const bool called = s->body->rest.roused || s->led || s->tied || world->roused || !(s->common->sleep > 0);
        s->awake = s->body->rest.asleep ? called || sk_is_met(world, s, dt) : !s->unmoving || s->tied;
    }
    sk_neighbours_mark(r);
    for (size_t i = 0; i < r->leans.count; i++)
        if (sk_is_disturbed(r, r->by_index[r->leans.data[i].other]))
            wake(world, r->by_index[r->leans.data[i].pinned]->body);
    for (size_t n = 0; n < r->count; n++)
        if (sk_is_disturbed(r, &r->of[n])) wake(world, r->of[n].body);
}

/* What is known of rest begins anew for all that was changed. */
static void forget_what_was_roused(skein_world *world) {
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = sk_world_body_at(world, i);
        if (!body || !(world->roused || body->rest.roused)) continue;
        forget_places(world, body);
        body->rest.roused = false;
    }
    world->roused = false;
}

/* Wakes whom it must, where somebody sleeps; all rules and constraints are as they will be in the step. */
static skein_status wake_some(skein_world *world, double dt, skein_error *error) {
    const double ways = 2; // it may get faster
    sk_neighbours r;
    if (!sk_neighbours_find(world, ways * dt, dt, &r)) return sk_fail_memory(error, "bodies that sleep");
    const bool good = sk_world_look_ahead(world, dt);
    if (good) wake_islands(&r, dt);
    sk_neighbours_release(&r);
    return good ? SKEIN_OK : sk_fail_memory(error, "bodies that sleep");
}

skein_status sk_world_wake(skein_world *world, double dt, skein_error *error) {
    skein_status status = SKEIN_OK;
    if (world->particles.asleep_count && dt > 0) {
        status = sk_world_touch(world);
        if (!status) status = sk_world_arrange(world, error);
        if (!status) status = sk_world_find_pins(world, error);
        if (!status && is_sleepless(world)) sk_world_wake_all(world);
        else if (!status) status = wake_some(world, dt, error);
    }
    if (!status) forget_what_was_roused(world);
    return status;
}

/* ---- falling asleep ---- */

/* Counts for how long a body has been still. False when there is no memory. */
static bool watch(skein_world *world, sk_sleeper *s, double dt) {
    const sk_particles *all = &world->particles;
    sk_body *body = s->body;
    const real far = (real)(s->common->sleep * still_for);
    bool still = body->rest.from != NULL && body->rest.near == s->near;
    s->ready = s->unmoving;
    if (!(s->common->sleep > 0)) {
        forget_places(world, body);
        return true;
    }
    if (!body->rest.from &&
        !(body->rest.from = sk_allocate(&world->allocator, body->particle_count * sizeof *body->rest.from)))
        return false;
    for (size_t i = 0; i < body->particle_count && still; i++) {
        const sk_vec3 off =
            sk_sub(sk_xyz(all->vector[SK_X][all->slot_of[body->first_particle + i]]), body->rest.from[i]);
        still = sk_dot(off, off) <= far * far;
    }
    body->rest.still = still ? body->rest.still + dt : 0;
    body->rest.near = s->near;
    for (size_t i = 0; i < body->particle_count && !still; i++)
        body->rest.from[i] = sk_xyz(all->vector[SK_X][all->slot_of[body->first_particle + i]]);
    s->ready |= body->rest.still > still_for - 1e-9;
    return true;
}

static void fall_asleep(skein_world *world, sk_body *body) {
    sk_body_set_asleep(world, body, true);
    for (size_t i = 0; i < body->particle_count; i++) {
        sk_vec4 *v = &world->particles.vector[SK_V][world->particles.slot_of[body->first_particle + i]];
        *v = (sk_vec4){0, 0, 0, v->w};
    }
}

/* Those of whom all that they may touch is ready, too. */
static void let_sleep(const sk_neighbours *r, double dt) {
    skein_world *world = r->world;
    for (size_t n = 0; n < r->count; n++) {
        sk_sleeper *s = &r->of[n];
        sk_body *body = s->body;
        if (!body->rest.asleep && s->ready && s->common->sleep > 0 &&
            (s->led || sk_is_driven(world, s) || sk_is_met(world, s, dt))) {
            s->ready = false;
            forget_places(world, body); // it may lose its hold when that ends
        }
        s->awake = !body->rest.asleep && (!s->ready || s->led || s->tied);
    }
    sk_neighbours_mark(r);
    for (size_t i = 0; i < r->leans.count; i++)
        if (sk_is_disturbed(r, r->by_index[r->leans.data[i].other]))
            r->by_index[r->leans.data[i].pinned]->ready = false;
    for (size_t n = 0; n < r->count; n++) {
        const sk_sleeper *s = &r->of[n];
        if (s->ready && s->common->sleep > 0 && !s->body->rest.asleep && !sk_is_disturbed(r, s))
            fall_asleep(world, s->body);
    }
}

skein_status sk_world_let_sleep(skein_world *world, double dt, skein_error *error) {
    bool any = false, ready = false, good = true;
    for (size_t i = 0; i < world->objects.count; i++)
        any |= sk_world_body_at(world, i) &&
               (world->objects.data[i]->common.plain.sleep > 0 || sk_world_body_at(world, i)->rest.from);
    if (!any || is_sleepless(world)) return SKEIN_OK;
    sk_neighbours r;
    if (!sk_neighbours_find(world, 0, dt, &r)) return sk_fail_memory(error, "bodies that sleep");
    for (size_t n = 0; n < r.count && good; n++) {
        if (r.of[n].body->rest.asleep) continue;
        good = watch(world, &r.of[n], dt);
        ready |= r.of[n].ready && r.of[n].common->sleep > 0;
    }
    good = good && (!ready || sk_world_look_ahead(world, dt));
    if (good && ready) let_sleep(&r, dt);
    sk_neighbours_release(&r);
    return good ? SKEIN_OK : sk_fail_memory(error, "bodies that sleep");
}

bool skein_body_asleep(const skein_world *world, skein_handle handle) {
    const sk_object *object = world ? sk_object_of(world, handle) : NULL;
    return object && object->category == SKEIN_BODY && object->as.body->rest.asleep;
}
