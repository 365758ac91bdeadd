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
 * All of it follows from the state before a step and after it, by least and greatest values, which know no order: so it
 * is the same for any threads. What is kept for it, where a body began to be still and since when, is in snapshots. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"
#include "world/world.h"

static const double still_for = 0.5; /* s */

/* ---- bodies ---- */

static sk_body *body_at(const skein_world *world, size_t i) {
    return world->objects.data[i]->category == SKEIN_BODY ? world->objects.data[i]->as.body : NULL;
}

void sk_body_forget_rest(skein_world *world, sk_body *body) {
    sk_release(&world->allocator, body->rest_from);
    body->rest_from = NULL;
    body->still = 0;
    body->asleep = body->roused = false;
}

void sk_world_rouse(skein_world *world) {
    world->roused |= world->particles.asleep_count > 0;
}

void sk_world_rouse_at(skein_world *world, size_t first, size_t count) {
    for (size_t i = 0; i < world->objects.count && world->particles.asleep_count; i++) {
        sk_body *body = body_at(world, i);
        if (body && body->first_particle < first + count && first < body->first_particle + body->particle_count)
            body->roused = true;
    }
}

/* Where nothing may sleep: steps are done elsewhere, or are parts of steps. */
static bool is_sleepless(const skein_world *world) {
    return world->device || world->share;
}

void sk_body_set_asleep(skein_world *world, sk_body *body, bool asleep) {
    sk_particles *all = &world->particles;
    sk_body_forget_rest(world, body);
    body->asleep = asleep;
    world->sleepers_known = false;
    world->crossings_asleep = 0;
    for (size_t i = 0; i < body->particle_count && asleep; i++) {
        sk_vec4 *v = &all->vector[SK_V][all->slot_of[body->first_particle + i]];
        *v = (sk_vec4){0, 0, 0, v->w};
    }
    sk_particles_set_presence(all, body->first_particle, body->particle_count, asleep ? SK_ASLEEP : SK_HERE);
    world->plan_stale = world->slots_stale = true;
}

void sk_world_wake_all(skein_world *world) {
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = body_at(world, i);
        if (body && body->asleep) sk_body_set_asleep(world, body, false);
        if (body) body->roused = false;
    }
    world->roused = false;
}

/* ---- what is known of them in a step ---- */

/* A body that is there, and the box around it. */
typedef struct sleeper {
    sk_body *body;
    const sk_common *common;
    real low[3], high[3];
    bool unmoving;  /* all of it is pinned, and was not led in the last step, nor is in the next */
    bool ready, awake;
    uint32_t index; /* among these, in the order of bodies */
} sleeper;

typedef struct room {
    skein_world *world;
    sleeper *of;
    size_t count;
    uint32_t *island; /* of sleepers, by their index: a union */
    bool *disturbed;  /* of islands, by their root: somebody in it does not sleep */
    real near;        /* m: boxes that are nearer may touch; below 0: none does */
} room;

/* How near bodies have to come to touch: contact's thickness, or a rule's reach. Below 0 where nobody meets anybody. */
static real reach_of_rules(const skein_world *world) {
    double reach = -1;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_FORCE || !object->common.plain.enabled) continue;
        const sk_force *force = object->as.force;
        if (force->type->radius) reach = fmax(reach, force->type->radius(force->params));
        if (force->type->meeting) reach = fmax(reach, 2 * sk_object_number(object, "thickness"));
    }
    for (size_t i = 0; i < world->objects.count && reach >= 0; i++)
        if (body_at(world, i)) reach = fmax(reach, 2 * sk_object_number(world->objects.data[i], "contact.thickness"));
    return (real)reach;
}

/* The box of a body, `ahead` seconds of its ways included; and whether it stands there, pinned. */
static void find_box(const skein_world *world, sleeper *s, real ahead) {
    const sk_particles *all = &world->particles;
    s->unmoving = !s->body->roused;
    for (int k = 0; k < 3; k++) s->low[k] = SK_REAL_MAX, s->high[k] = -SK_REAL_MAX;
    for (size_t i = 0; i < s->body->particle_count; i++) {
        const size_t slot = all->slot_of[s->body->first_particle + i];
        const sk_vec4 x = all->vector[SK_X][slot], v = all->vector[SK_V][slot], old = all->vector[SK_PREVIOUS][slot];
        const real at[3] = {x.x, x.y, x.z}, way[3] = {ahead * v.x, ahead * v.y, ahead * v.z};
        s->unmoving &= !(x.w > 0) && !memcmp(&old, &x, 3 * sizeof(real));
        for (int k = 0; k < 3; k++) {
            s->low[k] = sk_min(s->low[k], sk_min(at[k], at[k] + way[k]));
            s->high[k] = sk_max(s->high[k], sk_max(at[k], at[k] + way[k]));
        }
    }
}

static void release_room(room *r) {
    sk_release(&r->world->allocator, r->of);
    sk_release(&r->world->allocator, r->island);
    sk_release(&r->world->allocator, r->disturbed);
}

/* Joins bodies that a constraint of the program's is on. */
static void join_linked(const room *r) {
    const skein_world *world = r->world;
    for (size_t i = 0; i < world->objects.count; i++) {
        if (world->objects.data[i]->category != SKEIN_CONSTRAINT) continue;
        const sk_batch *batch = world->objects.data[i]->as.batch;
        size_t first = SIZE_MAX;
        for (size_t n = 0; n < r->count; n++) {
            const uint32_t begin = r->of[n].body->first_particle, count = r->of[n].body->particle_count;
            bool is_on = false;
            for (size_t k = 0; k < batch->count * batch->arity && !is_on; k++) is_on = batch->particle[k] - begin < count;
            if (is_on && first < SIZE_MAX) sk_union_join(r->island, (uint32_t)first, (uint32_t)n);
            if (is_on) first = n;
        }
    }
}

static int compare_low(const void *a, const void *b) {
    const sleeper *one = a, *other = b;
    if (one->low[0] != other->low[0]) return one->low[0] < other->low[0] ? -1 : 1;
    return (one->index > other->index) - (one->index < other->index);
}

static bool boxes_meet(const sleeper *a, const sleeper *b, real near) {
    bool meet = true;
    for (int k = 0; k < 3; k++) meet &= a->low[k] - near <= b->high[k] && b->low[k] - near <= a->high[k];
    return meet;
}

/* Joins those whose boxes may touch. What stands pinned joins nobody: two that lie on it do not know of each other. */
static void join_near(const room *r) {
    qsort(r->of, r->count, sizeof *r->of, compare_low);
    for (size_t a = 0; a < r->count && r->near >= 0; a++)
        for (size_t b = a + 1; b < r->count && r->of[b].low[0] - r->near <= r->of[a].high[0]; b++)
            if (!r->of[a].unmoving && !r->of[b].unmoving && boxes_meet(&r->of[a], &r->of[b], r->near))
                sk_union_join(r->island, r->of[a].index, r->of[b].index);
}

/* All bodies that are there. False when there is no memory. */
static bool list_bodies(skein_world *world, double ahead, room *r) {
    *r = (room){.world = world, .near = reach_of_rules(world)};
    r->of = sk_allocate(&world->allocator, (world->objects.count + 1) * sizeof *r->of);
    r->island = sk_allocate(&world->allocator, (world->objects.count + 1) * sizeof *r->island);
    r->disturbed = sk_allocate(&world->allocator, (world->objects.count + 1) * sizeof *r->disturbed);
    if (!r->of || !r->island || !r->disturbed) {
        release_room(r);
        return false;
    }
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = body_at(world, i);
        if (!body || !body->enabled || !body->particle_count) continue;
        sleeper *s = &r->of[r->count];
        *s = (sleeper){.body = body, .common = &world->objects.data[i]->common.plain, .index = (uint32_t)r->count};
        r->island[r->count] = (uint32_t)r->count;
        find_box(world, s, (real)ahead);
        r->count++;
    }
    return true;
}

/* Finds out who may touch whom. */
static void join(const room *r) {
    join_linked(r);
    join_near(r);
}

/* Marks the islands of those who are awake. */
static void mark_disturbed(const room *r) {
    memset(r->disturbed, 0, r->count * sizeof *r->disturbed);
    for (size_t n = 0; n < r->count; n++)
        if (r->of[n].awake) r->disturbed[sk_union_root(r->island, r->of[n].index)] = true;
}

static bool is_disturbed(const room *r, const sleeper *s) {
    return r->disturbed[sk_union_root(r->island, s->index)];
}

/* ---- rules that change ---- */

/* Whether a formula has a name in it. */
static bool has_name(const char *text, const char *name) {
    const size_t length = strlen(name);
    for (bool in_word = false; *text; text++) {
        const bool letter = isalnum((unsigned char)*text) || *text == '_' || *text == '.';
        if (letter && !in_word && !strncmp(text, name, length) && !isalnum((unsigned char)text[length]) && text[length] != '_')
            return true;
        in_word = letter;
    }
    return false;
}

/* Whether a rule made of a text may be another one at another time: one with t in it, or one that cannot be read. */
static bool may_change(const sk_object *object) {
    bool reads = false;
    if (!object->making) return false;
    for (size_t f = 0; f < object->kind->field_count; f++) {
        const skein_field *field = &object->kind->fields[f];
        const char *text = field->type == SKEIN_FIELD_TEXT ? sk_field_load(field, object->params).text : NULL;
        if (!text || !text[0]) continue;
        reads = true;
        if (has_name(text, "t")) return true;
    }
    return !reads;
}

/* Whether a collider is elsewhere, or another, when a step is over. */
static bool moves_on(const sk_object *object, double time, double dt) {
    const sk_collider *collider = object->as.collider;
    const sk_collider_common *common = collider->common;
    const double *v = common->velocity;
    if (!common->enabled) return false;
    if (collider->led || (collider->travel.noted && collider->travel.changed)) return true;
    if (collider->type->changes ? collider->type->changes(collider->params) : collider->type->deforms && may_change(object)) return true;
    return (v[0] != 0 || v[1] != 0 || v[2] != 0 || common->spin != 0) && time + dt > common->start;
}

/* How far apart the particles of a body and a collider are at a pose. */
static double distance_at(const skein_world *world, const sk_collider *collider, const sk_pose *pose, const sleeper *s) {
    const sk_particles *all = &world->particles;
    double least = INFINITY;
    for (size_t first = 0; first < s->body->particle_count; first += SK_LANES) {
        real p[3][SK_LANES] = {{0}};
        sk_sixteen_contacts contacts;
        const size_t left = s->body->particle_count - first, lanes = left < SK_LANES ? left : SK_LANES;
        for (size_t l = 0; l < SK_LANES; l++) { // the first again where there is nobody
            const sk_vec4 x = all->vector[SK_X][all->slot_of[s->body->first_particle + first + (l < lanes ? l : 0)]];
            p[0][l] = x.x, p[1][l] = x.y, p[2][l] = x.z;
        }
        sk_probe_sixteen_of[world->isa](collider, pose, p, &contacts);
        for (size_t l = 0; l < lanes; l++) least = fmin(least, (double)contacts.distance[l]);
    }
    return least;
}

/* The farthest point of a body's box from a pose. */
static double reach_of(const sk_pose *pose, const sleeper *s) {
    const double from[3] = {(double)pose->position.x, (double)pose->position.y, (double)pose->position.z};
    double far = 0;
    for (int k = 0; k < 3; k++) far += pow(fmax(fabs((double)s->low[k] - from[k]), fabs((double)s->high[k] - from[k])), 2);
    return sqrt(far);
}

/* How far a point of the body's box may be led by what a collider does between two poses. */
static double way_between(const sk_pose *a, const sk_pose *b, const sleeper *s) {
    const double way[3] = {(double)(b->position.x - a->position.x), (double)(b->position.y - a->position.y),
                           (double)(b->position.z - a->position.z)};
    double turned = 0;
    for (int i = 0; i < 9; i++) turned += pow((double)b->rotation[i] - (double)a->rotation[i], 2);
    return sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]) + sqrt(turned) * reach_of(a, s);
}

/* Whether it may be all that its box is away from: a formula is no distance. */
static bool is_far(const skein_world *world, const sk_collider *collider, const sk_pose *pose, const sleeper *s, double clear) {
    real middle[3][SK_LANES];
    double half = 0;
    sk_sixteen_contacts contacts;
    for (int k = 0; k < 3; k++) {
        half += pow((double)(s->high[k] - s->low[k]) / 2, 2);
        for (int l = 0; l < SK_LANES; l++) middle[k][l] = (s->low[k] + s->high[k]) / 2;
    }
    if (collider->type->making && !collider->type->surface) return false;
    sk_probe_sixteen_of[world->isa](collider, pose, middle, &contacts);
    return (double)contacts.distance[0] > sqrt(half) + clear;
}

/* What is met on the way from one pose to the other is no farther from one of them than half that way. Where a frame leads a
 * collider in the next step is not known yet: as far as in the last one. */
static bool is_met_by(const skein_world *world, const sk_collider *collider, const sleeper *s, double dt) {
    sk_pose pose[2] = {sk_collider_pose_unled(collider, world->time), sk_collider_pose_at(collider, world->time + dt)};
    if (collider->led) {
        pose[0] = sk_collider_pose_at(collider, world->time), pose[1] = pose[0];
        pose[1].position = sk_add(pose[0].position, sk_scale((real)dt, pose[0].velocity));
    }
    const double turns = collider->led ? dt * (double)sk_length(pose[0].spin) * reach_of(&pose[0], s) : 0;
    const double clear = 2 * collider->common->thickness + way_between(&pose[0], &pose[1], s) + turns;
    for (int i = 0; i < 2; i++)
        if (!is_far(world, collider, &pose[i], s, clear) && !(distance_at(world, collider, &pose[i], s) > clear)) return true;
    return false;
}

/* Whether a collider that moves is near a body in the next step. */
static bool is_met(const skein_world *world, const sleeper *s, double dt) {
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_COLLIDER || !moves_on(object, world->time, dt)) continue;
        const char *on = object->as.collider->common->on;
        if (on[0] && !sk_names_mean(on, s->common->name, s->common->groups)) continue;
        if (is_met_by(world, object->as.collider, s, dt)) return true;
    }
    return false;
}

/* ---- waking ---- */

/* Whose pins are led elsewhere, by the program or by motions, is roused, and its box has the place. */
static bool follow_pins(const room *r, double dt) {
    skein_world *world = r->world;
    const sk_particles *all = &world->particles;
    if (!world->pins.count && !world->motions.count) return true;
    if (!sk_world_lead(world, world->time + dt)) return false;
    sleeper *s = r->of;
    for (size_t i = 0; i < world->led.count; i++) {
        const uint32_t particle = world->led.data[i].particle;
        const sk_vec4 x = all->vector[SK_X][all->slot_of[particle]];
        const double *place = world->led.data[i].place;
        const real to[3] = {(real)place[0], (real)place[1], (real)place[2]};
        if (!sk_particle_counts(all, particle) || !all->pinned[particle] || !memcmp(to, &x, sizeof to)) continue;
        for (size_t n = 0; n < r->count && particle - s->body->first_particle >= s->body->particle_count; n++) s = &r->of[n];
        if (particle - s->body->first_particle >= s->body->particle_count) continue; // of no body
        s->body->roused = true;
        s->unmoving = false;
        for (int k = 0; k < 3; k++) s->low[k] = sk_min(s->low[k], to[k]), s->high[k] = sk_max(s->high[k], to[k]);
    }
    world->led.count = 0;
    return true;
}

/* Those who are to wake, and all that these may touch; a sleeper that is awake wakes who may touch it. */
static void wake_islands(const room *r, double dt) {
    for (size_t n = 0; n < r->count; n++) {
        sleeper *s = &r->of[n];
        sk_body *body = s->body;
        s->awake = body->asleep ? body->roused || r->world->roused || !(s->common->sleep > 0) || is_met(r->world, s, dt) : !s->unmoving;
        body->roused = false;
    }
    mark_disturbed(r);
    for (size_t n = 0; n < r->count; n++)
        if (r->of[n].body->asleep && is_disturbed(r, &r->of[n])) sk_body_set_asleep(r->world, r->of[n].body, false);
}

skein_status sk_world_wake(skein_world *world, double dt, skein_error *error) {
    const double ways = 2; // it may get faster
    room r;
    if (!world->particles.asleep_count) {
        world->roused = false;
        return SKEIN_OK;
    }
    skein_status status = sk_world_touch(world);
    if (status) return status;
    if (is_sleepless(world)) {
        sk_world_wake_all(world);
        return SKEIN_OK;
    }
    if (!list_bodies(world, ways * dt, &r)) return sk_fail_memory(error, "bodies that sleep");
    const bool good = !r.count || follow_pins(&r, dt);
    if (good) {
        join(&r);
        wake_islands(&r, dt);
        world->roused = false;
    }
    release_room(&r);
    return good ? SKEIN_OK : sk_fail_memory(error, "bodies that sleep");
}

/* ---- falling asleep ---- */

/* Whether something moves a body whatever it does itself. */
static bool is_driven(const skein_world *world, const sleeper *s) {
    const sk_body *body = s->body;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category == SKEIN_FORCE && object->common.plain.enabled) {
            const sk_force *force = object->as.force;
            const char *on = object->common.plain.on;
            const bool pushes = force->type->phase == SK_PUSHES || force->type->phase == SK_MEETS;
            const bool steers = !pushes || force->type->radius || sk_force_particle(force) >= 0;
            if ((steers || may_change(object)) && (!on[0] || sk_names_mean(on, s->common->name, s->common->groups))) return true;
        }
        if (object->category == SKEIN_CONSTRAINT && object->common.plain.enabled && may_change(object)) {
            const sk_batch *batch = object->as.batch;
            for (size_t k = 0; k < batch->count * batch->arity; k++)
                if (batch->particle[k] - body->first_particle < body->particle_count) return true;
        }
    }
    return sk_world_carries(world, s->common);
}

/* Counts for how long a body has been still. False when there is no memory. */
static bool watch(skein_world *world, sleeper *s, double dt) {
    const sk_particles *all = &world->particles;
    sk_body *body = s->body;
    const real far = (real)(s->common->sleep * still_for);
    bool still = body->rest_from != NULL;
    s->ready = s->unmoving;
    if (!(s->common->sleep > 0)) {
        sk_body_forget_rest(world, body);
        return true;
    }
    if (!body->rest_from && !(body->rest_from = sk_allocate(&world->allocator, body->particle_count * sizeof *body->rest_from)))
        return false;
    for (size_t i = 0; i < body->particle_count && still; i++) {
        const sk_vec3 off = sk_sub(sk_xyz(all->vector[SK_X][all->slot_of[body->first_particle + i]]), body->rest_from[i]);
        still = sk_dot(off, off) <= far * far;
    }
    body->still = still ? body->still + dt : 0;
    for (size_t i = 0; i < body->particle_count && !still; i++)
        body->rest_from[i] = sk_xyz(all->vector[SK_X][all->slot_of[body->first_particle + i]]);
    s->ready |= body->still > still_for - 1e-9;
    return true;
}

/* Those of whom all that they may touch is ready, too. */
static void let_sleep(const room *r, double dt) {
    skein_world *world = r->world;
    for (size_t n = 0; n < r->count; n++) {
        sleeper *s = &r->of[n];
        if (s->ready && s->common->sleep > 0 && !s->body->asleep) s->ready = !is_driven(world, s) && !is_met(world, s, dt);
        s->awake = !s->body->asleep && !s->ready;
    }
    mark_disturbed(r);
    for (size_t n = 0; n < r->count; n++) {
        const sleeper *s = &r->of[n];
        if (s->ready && s->common->sleep > 0 && !s->body->asleep && !is_disturbed(r, s)) sk_body_set_asleep(world, s->body, true);
    }
}

skein_status sk_world_let_sleep(skein_world *world, double dt, skein_error *error) {
    bool any = false, ready = false, good = true;
    for (size_t i = 0; i < world->objects.count; i++)
        any |= body_at(world, i) && (world->objects.data[i]->common.plain.sleep > 0 || body_at(world, i)->rest_from);
    if (!any || is_sleepless(world)) return SKEIN_OK;
    room r;
    if (!list_bodies(world, 0, &r)) return sk_fail_memory(error, "bodies that sleep");
    for (size_t n = 0; n < r.count && good; n++) {
        if (r.of[n].body->asleep) continue;
        good = watch(world, &r.of[n], dt);
        ready |= r.of[n].ready && r.of[n].common->sleep > 0;
    }
    if (good && ready) {
        join(&r);
        let_sleep(&r, dt);
    }
    release_room(&r);
    return good ? SKEIN_OK : sk_fail_memory(error, "bodies that sleep");
}

bool skein_body_asleep(const skein_world *world, skein_handle handle) {
    const sk_object *object = world ? sk_object_of(world, handle) : NULL;
    return object && object->category == SKEIN_BODY && object->as.body->asleep;
}
