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
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/union_find.h"
#include "colliders/trimesh.h"
#include "world/world.h"

static const double still_for = 0.5; /* s */

/* ---- bodies ---- */

static sk_body *body_at(const skein_world *world, size_t i) {
    return world->objects.data[i]->category == SKEIN_BODY ? world->objects.data[i]->as.body : NULL;
}

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
    sk_particles_set_presence(&world->particles, body->first_particle, body->particle_count, asleep ? SK_ASLEEP : SK_HERE);
    world->plan_stale = world->slots_stale = true;
}

static void wake(skein_world *world, sk_body *body) {
    if (body->rest.asleep) sk_body_set_asleep(world, body, false);
}

void sk_world_wake_all(skein_world *world) {
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = body_at(world, i);
        if (!body) continue;
        wake(world, body);
        sk_body_forget_rest(world, body);
    }
    world->roused = false;
}

/* Widens a box by where particles are, and by where they will be so many seconds ahead. */
static void widen(const sk_particles *all, const sk_body *body, real ahead, real low[3], real high[3]) {
    for (size_t i = 0; i < body->particle_count; i++) {
        const size_t slot = all->slot_of[body->first_particle + i];
        const sk_vec4 x = all->vector[SK_X][slot], v = all->vector[SK_V][slot];
        const real at[3] = {x.x, x.y, x.z}, way[3] = {ahead * v.x, ahead * v.y, ahead * v.z};
        for (int k = 0; k < 3; k++) {
            low[k] = sk_min(low[k], sk_min(at[k], at[k] + way[k]));
            high[k] = sk_max(high[k], sk_max(at[k], at[k] + way[k]));
        }
    }
}

static void begin_box(real low[3], real high[3]) {
    for (int k = 0; k < 3; k++) low[k] = SK_REAL_MAX, high[k] = -SK_REAL_MAX;
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
        any = body_at(world, i) && (body_at(world, i)->rest.asleep || body_at(world, i)->rest.from);
    if (!any) return; // nobody sleeps, or is about to
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = body_at(world, i);
        if (!body) continue;
        const size_t begin = body->first_particle, end = begin + body->particle_count;
        if (begin >= first + count || first >= end) continue;
        of_bodies += (end < first + count ? end : first + count) - (begin > first ? begin : first);
        if (!body->rest.roused) begin_box(body->rest.low, body->rest.high);
        widen(&world->particles, body, 0, body->rest.low, body->rest.high); // whom it leaves is to know
        body->rest.roused = true;
    }
    if (of_bodies < count) sk_world_rouse(world); // some are of no body
}

/* Where nothing may sleep: steps are done elsewhere, or are parts of steps. */
static bool is_sleepless(const skein_world *world) {
    return world->device || world->share;
}

/* ---- what is known of them in a step ---- */

/* A body that is there, and the box around it. */
typedef struct sleeper {
    sk_body *body;
    const sk_common *common;
    real low[3], high[3];
    bool unmoving; /* all of it is pinned, and was not led in the last step, nor is in the next */
    bool led;      /* some of it is, in the next */
    bool tied;     /* to a particle of no body, that moves */
    bool ready, awake;
    uint64_t near; /* whom it may touch: a sum, which knows no order */
    uint32_t index; /* among these, in the order of bodies */
} sleeper;

/* Two whose boxes meet, one of which stands pinned. */
typedef struct lean {
    uint32_t pinned, other; /* their indices */
} lean;

typedef struct room {
    skein_world *world;
    sleeper *of;
    size_t count;
    uint32_t *island; /* of sleepers, by their index: a union */
    bool *disturbed;  /* of islands, by their root: somebody in it does not sleep */
    sleeper **by_index;
    struct {
        lean *data;
        size_t count, capacity;
    } leans;
    real near; /* m: boxes that are nearer may touch; below 0: none does */
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

/* Whether it stands there, pinned. */
static bool is_unmoving(const skein_world *world, const sk_body *body) {
    const sk_particles *all = &world->particles;
    bool unmoving = !body->rest.roused;
    for (size_t i = 0; i < body->particle_count && unmoving; i++) {
        const size_t slot = all->slot_of[body->first_particle + i];
        const sk_vec4 x = all->vector[SK_X][slot], old = all->vector[SK_PREVIOUS][slot];
        unmoving = !(x.w > 0) && !memcmp(&old, &x, 3 * sizeof(real));
    }
    return unmoving;
}

bool sk_world_stands(const skein_world *world, const sk_body *body) {
    bool stands = body->enabled && !body->rest.asleep;
    for (size_t i = 0; i < body->particle_count && stands; i++) stands = world->particles.pinned[body->first_particle + i];
    return stands;
}

static void release_room(room *r) {
    sk_allocator *allocator = &r->world->allocator;
    sk_release(allocator, r->of);
    sk_release(allocator, r->by_index);
    sk_release(allocator, r->island);
    sk_release(allocator, r->disturbed);
    sk_release(allocator, r->leans.data);
}

/* All bodies that are there, and one that was and is to be known to have gone. False when there is no memory. */
static bool list_bodies(skein_world *world, double ahead, room *r) {
    sk_allocator *allocator = &world->allocator;
    const size_t most = world->objects.count + 1;
    *r = (room){.world = world, .near = reach_of_rules(world)};
    r->of = sk_allocate(allocator, most * sizeof *r->of);
    r->by_index = sk_allocate(allocator, most * sizeof *r->by_index);
    r->island = sk_allocate(allocator, most * sizeof *r->island);
    r->disturbed = sk_allocate(allocator, most * sizeof *r->disturbed);
    if (!r->of || !r->by_index || !r->island || !r->disturbed) {
        release_room(r);
        return false;
    }
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = body_at(world, i);
        if (!body || !body->enabled || !body->particle_count) continue;
        sleeper *s = &r->of[r->count];
        *s = (sleeper){.body = body, .common = &world->objects.data[i]->common.plain, .index = (uint32_t)r->count};
        r->island[r->count] = (uint32_t)r->count;
        begin_box(s->low, s->high);
        if (body->rest.roused) memcpy(s->low, body->rest.low, sizeof s->low), memcpy(s->high, body->rest.high, sizeof s->high);
        widen(&world->particles, body, (real)ahead, s->low, s->high);
        s->unmoving = is_unmoving(world, body);
        r->count++;
    }
    return true;
}

/* The body that a particle is of, the last one that was found first; NULL: of none. */
static sleeper *find_owner(const room *r, uint32_t particle, sleeper *last) {
    for (size_t n = 0; n <= r->count; n++) {
        sleeper *s = n ? &r->of[n - 1] : last;
        if (s && particle - s->body->first_particle < s->body->particle_count) return s;
    }
    return NULL;
}

/* Whose pins are led elsewhere in the next step, by the program or by motions, and his box has the place. `loose`: some of no
 * body's are. False when there is no memory. */
static bool follow_pins(const room *r, double dt, bool *loose) {
    skein_world *world = r->world;
    const sk_particles *all = &world->particles;
    sleeper *s = NULL;
    *loose = false;
    if (!world->pins.count && !world->motions.count) return true;
    if (!sk_world_lead(world, world->time + dt)) return false;
    for (size_t i = 0; i < world->led.count; i++) {
        const uint32_t particle = world->led.data[i].particle;
        const sk_vec4 x = all->vector[SK_X][all->slot_of[particle]];
        const double *place = world->led.data[i].place;
        const real to[3] = {(real)place[0], (real)place[1], (real)place[2]};
        if (!sk_particle_counts(all, particle) || !all->pinned[particle] || !memcmp(to, &x, sizeof to)) continue;
        s = find_owner(r, particle, s);
        *loose |= !s;
        if (!s) continue;
        s->led = true;
        s->unmoving = false;
        for (int k = 0; k < 3; k++) s->low[k] = sk_min(s->low[k], to[k]), s->high[k] = sk_max(s->high[k], to[k]);
    }
    world->led.count = 0;
    return true;
}

/* Whether a particle of no body may move. */
static bool is_loose(const skein_world *world, uint32_t particle, bool loose_led) {
    const sk_particles *all = &world->particles;
    const size_t slot = all->slot_of[particle];
    return all->vector[SK_X][slot].w > 0 || loose_led || memcmp(&all->vector[SK_X][slot], &all->vector[SK_PREVIOUS][slot], 3 * sizeof(real)) != 0;
}

/* Joins bodies that a constraint of the program's is on. */
static void join_linked(const room *r, bool loose_led) {
    const skein_world *world = r->world;
    for (size_t i = 0; i < world->objects.count; i++) {
        if (world->objects.data[i]->category != SKEIN_CONSTRAINT) continue;
        const sk_batch *batch = world->objects.data[i]->as.batch;
        sleeper *first = NULL, *last = NULL;
        bool loose = false;
        for (size_t k = 0; k < batch->count * batch->arity; k++) {
            sleeper *s = find_owner(r, batch->particle[k], last);
            if (!s) loose |= sk_particle_counts(&world->particles, batch->particle[k]) && is_loose(world, batch->particle[k], loose_led);
            if (!s || s == last) continue;
            if (!first) first = s;
            sk_union_join(r->island, first->index, s->index);
            last = s;
        }
        if (first) first->tied |= loose;
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

/* Joins two whose boxes meet. What stands pinned joins nobody: two that lie on it do not know of each other. */
static bool meet(room *r, sleeper *a, sleeper *b) {
    a->near += sk_hash_word(SK_HASH_START, b->body->first_particle);
    b->near += sk_hash_word(SK_HASH_START, a->body->first_particle);
    if (a->unmoving && b->unmoving) return true;
    if (!a->unmoving && !b->unmoving) {
        sk_union_join(r->island, a->index, b->index);
        return true;
    }
    if (!SK_RESERVE(&r->world->allocator, &r->leans, r->leans.count + 1)) return false;
    r->leans.data[r->leans.count++] = a->unmoving ? (lean){a->index, b->index} : (lean){b->index, a->index};
    return true;
}

/* Finds out who may touch whom. False when there is no memory. */
static bool join(room *r, bool loose_led) {
    bool good = true;
    join_linked(r, loose_led);
    if (r->count) qsort(r->of, r->count, sizeof *r->of, compare_low);
    for (size_t n = 0; n < r->count; n++) r->by_index[r->of[n].index] = &r->of[n];
    for (size_t a = 0; a < r->count && r->near >= 0; a++)
        for (size_t b = a + 1; b < r->count && r->of[b].low[0] - r->near <= r->of[a].high[0] && good; b++)
            if (boxes_meet(&r->of[a], &r->of[b], r->near)) good = meet(r, &r->of[a], &r->of[b]);
    return good;
}

/* Marks the islands of those who are awake. */
static void mark_disturbed(const room *r) {
    if (r->count) memset(r->disturbed, 0, r->count * sizeof *r->disturbed);
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

/* Whether a rule that is made may be another one at another time: one by formulas with t in them, or by what cannot be read. */
static bool may_change(const sk_object *object) {
    if (!object->making) return false;
    if (!object->making->by_text) return true;
    for (size_t f = 0; f < object->kind->field_count; f++) {
        const skein_field *field = &object->kind->fields[f];
        const char *text = field->type == SKEIN_FIELD_TEXT ? sk_field_load(field, object->params).text : NULL;
        if (text && has_name(text, "t")) return true;
    }
    return false;
}

/* Where a collider is now, and when the next step is over, in the frame that leads it. */
static void find_poses(const skein_world *world, const sk_collider *collider, double dt, sk_pose pose[2]) {
    pose[0] = sk_collider_pose_unled(collider, world->time);
    pose[1] = sk_collider_pose_at(collider, world->time + dt);
    if (!collider->led) return;
    sk_collider then = *collider;
    pose[0] = sk_collider_pose_at(collider, world->time);
    then.travel.moving = false;
    then.frame = sk_world_frame_ahead(world, collider->common->name);
    pose[1] = sk_collider_pose_at(&then, world->time + dt);
}

/* How far the vertices of a mesh are led in the next step, at most, m. */
static double way_of_vertices(const sk_collider *collider) {
    const sk_trimesh *m = collider->type->surface ? collider->type->surface(collider->params) : NULL;
    return m ? sk_trimesh_way(m) * (collider->type->scale ? collider->type->scale(collider->params) : 1) : 0;
}

/* Whether a collider is elsewhere, or another, when the next step is over. */
static bool moves_on(const sk_object *object, const sk_pose pose[2]) {
    const sk_collider *collider = object->as.collider;
    const bool made = object->making && !collider->type->take; // by a formula, or by functions of the program's
    if (memcmp(&pose[0].position, &pose[1].position, sizeof pose[0].position) != 0) return true;
    if (memcmp(pose[0].rotation, pose[1].rotation, sizeof pose[0].rotation) != 0) return true;
    if (memcmp(&pose[0].axis, &pose[1].axis, sizeof pose[0].axis) != 0) return true;
    return collider->common->spin != 0 || way_of_vertices(collider) > 0 || (made && may_change(object));
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
    const double axis[3] = {(double)(b->axis.x - a->axis.x), (double)(b->axis.y - a->axis.y), (double)(b->axis.z - a->axis.z)};
    double turned = 0;
    for (int i = 0; i < 9; i++) turned += pow((double)b->rotation[i] - (double)a->rotation[i], 2);
    for (int k = 0; k < 3; k++) turned += axis[k] * axis[k];
    return sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]) + sqrt(turned) * reach_of(a, s);
}

/* Whether all of a body's box is away from a collider. Not known where its distance is that of a formula, which is none. */
static bool is_far(const skein_world *world, const sk_collider *collider, const sk_pose *pose, const sleeper *s, double clear) {
    real middle[3][SK_LANES];
    double half = 0;
    sk_sixteen_contacts contacts;
    for (int k = 0; k < 3; k++) {
        half += pow((double)(s->high[k] - s->low[k]) / 2, 2);
        for (int l = 0; l < SK_LANES; l++) middle[k][l] = (s->low[k] + s->high[k]) / 2;
    }
    if (collider->type->making && !collider->type->take) return false;
    sk_probe_sixteen_of[world->isa](collider, pose, middle, &contacts);
    return (double)contacts.distance[0] > sqrt(half) + clear;
}

/* What is met on the way from one pose to the other is no farther from one of them than half that way. Vertices that are led are
 * looked for where they are. */
static bool is_met_by(const skein_world *world, const sk_collider *collider, const sk_pose pose[2], const sleeper *s, double dt) {
    const double spins = dt * fabs(collider->common->spin) * reach_of(&pose[0], s);
    const double clear = 2 * collider->common->thickness + way_between(&pose[0], &pose[1], s) + spins + way_of_vertices(collider);
    for (int i = 0; i < 2; i++)
        if (!is_far(world, collider, &pose[i], s, clear) && !(distance_at(world, collider, &pose[i], s) > clear)) return true;
    return false;
}

/* Whether a collider that moves is near a body in the next step. */
static bool is_met(const skein_world *world, const sleeper *s, double dt) {
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        sk_pose pose[2];
        if (object->category != SKEIN_COLLIDER || !object->as.collider->common->enabled) continue;
        const char *on = object->as.collider->common->on;
        if (on[0] && !sk_names_mean(on, s->common->name, s->common->groups)) continue;
        find_poses(world, object->as.collider, dt, pose);
        if (moves_on(object, pose) && is_met_by(world, object->as.collider, pose, s, dt)) return true;
    }
    return false;
}

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

/* ---- waking ---- */

/* Those who are to wake, and all that these may touch; what stands pinned wakes where somebody comes near it. */
static void wake_islands(const room *r, double dt) {
    skein_world *world = r->world;
    for (size_t n = 0; n < r->count; n++) {
        sleeper *s = &r->of[n];
        const bool called = s->body->rest.roused || s->led || s->tied || world->roused || !(s->common->sleep > 0);
        s->awake = s->body->rest.asleep ? called || is_met(world, s, dt) : !s->unmoving || s->tied;
    }
    mark_disturbed(r);
    for (size_t i = 0; i < r->leans.count; i++)
        if (is_disturbed(r, r->by_index[r->leans.data[i].other])) wake(world, r->by_index[r->leans.data[i].pinned]->body);
    for (size_t n = 0; n < r->count; n++)
        if (is_disturbed(r, &r->of[n])) wake(world, r->of[n].body);
}

/* What is known of rest begins anew for all that was changed. */
static void forget_what_was_roused(skein_world *world) {
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = body_at(world, i);
        if (!body || !(world->roused || body->rest.roused)) continue;
        forget_places(world, body);
        body->rest.roused = false;
    }
    world->roused = false;
}

/* Wakes whom it must, where somebody sleeps; all rules and constraints are as they will be in the step. */
static skein_status wake_some(skein_world *world, double dt, skein_error *error) {
    const double ways = 2; // it may get faster
    bool loose;
    room r;
    if (!list_bodies(world, ways * dt, &r)) return sk_fail_memory(error, "bodies that sleep");
    const bool good = follow_pins(&r, dt, &loose) && sk_world_look_ahead(world, dt) && join(&r, loose);
    if (good) wake_islands(&r, dt);
    release_room(&r);
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
static bool watch(skein_world *world, sleeper *s, double dt) {
    const sk_particles *all = &world->particles;
    sk_body *body = s->body;
    const real far = (real)(s->common->sleep * still_for);
    bool still = body->rest.from != NULL && body->rest.near == s->near;
    s->ready = s->unmoving;
    if (!(s->common->sleep > 0)) {
        forget_places(world, body);
        return true;
    }
    if (!body->rest.from && !(body->rest.from = sk_allocate(&world->allocator, body->particle_count * sizeof *body->rest.from)))
        return false;
    for (size_t i = 0; i < body->particle_count && still; i++) {
        const sk_vec3 off = sk_sub(sk_xyz(all->vector[SK_X][all->slot_of[body->first_particle + i]]), body->rest.from[i]);
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
static void let_sleep(const room *r, double dt) {
    skein_world *world = r->world;
    for (size_t n = 0; n < r->count; n++) {
        sleeper *s = &r->of[n];
        sk_body *body = s->body;
        if (!body->rest.asleep && s->ready && s->common->sleep > 0 && (s->led || is_driven(world, s) || is_met(world, s, dt))) {
            s->ready = false;
            forget_places(world, body); // it may lose its hold when that ends
        }
        s->awake = !body->rest.asleep && (!s->ready || s->led || s->tied);
    }
    mark_disturbed(r);
    for (size_t i = 0; i < r->leans.count; i++)
        if (is_disturbed(r, r->by_index[r->leans.data[i].other])) r->by_index[r->leans.data[i].pinned]->ready = false;
    for (size_t n = 0; n < r->count; n++) {
        const sleeper *s = &r->of[n];
        if (s->ready && s->common->sleep > 0 && !s->body->rest.asleep && !is_disturbed(r, s)) fall_asleep(world, s->body);
    }
}

skein_status sk_world_let_sleep(skein_world *world, double dt, skein_error *error) {
    bool any = false, ready = false, good = true, loose;
    for (size_t i = 0; i < world->objects.count; i++)
        any |= body_at(world, i) && (world->objects.data[i]->common.plain.sleep > 0 || body_at(world, i)->rest.from);
    if (!any || is_sleepless(world)) return SKEIN_OK;
    room r;
    if (!list_bodies(world, 0, &r)) return sk_fail_memory(error, "bodies that sleep");
    good = follow_pins(&r, dt, &loose) && join(&r, loose);
    for (size_t n = 0; n < r.count && good; n++) {
        if (r.of[n].body->rest.asleep) continue;
        good = watch(world, &r.of[n], dt);
        ready |= r.of[n].ready && r.of[n].common->sleep > 0;
    }
    good = good && (!ready || sk_world_look_ahead(world, dt));
    if (good && ready) let_sleep(&r, dt);
    release_room(&r);
    return good ? SKEIN_OK : sk_fail_memory(error, "bodies that sleep");
}

bool skein_body_asleep(const skein_world *world, skein_handle handle) {
    const sk_object *object = world ? sk_object_of(world, handle) : NULL;
    return object && object->category == SKEIN_BODY && object->as.body->rest.asleep;
}
