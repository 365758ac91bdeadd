/* Which bodies may touch which: those whose boxes meet, or that a constraint of the program's joins. What is all pinned, and stands,
 * joins nobody: two that lie on it do not know of each other, but it knows both (`leans`). */
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/union_find.h"
#include "world/sleep.h"

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
        if (sk_world_body_at(world, i))
            reach = fmax(reach, 2 * sk_object_number(world->objects.data[i], "contact.thickness"));
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
    for (size_t i = 0; i < body->particle_count && stands; i++)
        stands = world->particles.pinned[body->first_particle + i];
    return stands;
}

void sk_neighbours_release(sk_neighbours *r) {
    sk_allocator *allocator = &r->world->allocator;
    sk_release(allocator, r->of);
    sk_release(allocator, r->by_index);
    sk_release(allocator, r->island);
    sk_release(allocator, r->disturbed);
    sk_release(allocator, r->leans.data);
}

/* All bodies that are there. False when there is no memory. */
static bool list_bodies(skein_world *world, double ahead, sk_neighbours *r) {
    sk_allocator *allocator = &world->allocator;
    const size_t most = world->objects.count + 1;
    *r = (sk_neighbours){.world = world, .near = reach_of_rules(world)};
    r->of = sk_allocate(allocator, most * sizeof *r->of);
    r->by_index = sk_allocate(allocator, most * sizeof *r->by_index);
    r->island = sk_allocate(allocator, most * sizeof *r->island);
    r->disturbed = sk_allocate(allocator, most * sizeof *r->disturbed);
    if (!r->of || !r->by_index || !r->island || !r->disturbed) {
        sk_neighbours_release(r);
        return false;
    }
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_body *body = sk_world_body_at(world, i);
        if (!body || !body->enabled || !body->particle_count) continue;
        sk_sleeper *s = &r->of[r->count];
        *s = (sk_sleeper){.body = body, .common = &world->objects.data[i]->common.plain, .index = (uint32_t)r->count};
        r->island[r->count] = (uint32_t)r->count;
        sk_box_begin(s->low, s->high);
        if (body->rest.roused)
            memcpy(s->low, body->rest.low, sizeof s->low), memcpy(s->high, body->rest.high, sizeof s->high);
        sk_box_widen(&world->particles, body, (real)ahead, s->low, s->high);
        s->unmoving = is_unmoving(world, body);
        r->count++;
    }
    return true;
}

/* The body that a particle is of, the last one that was found first; NULL: of none. */
static sk_sleeper *find_owner(const sk_neighbours *r, uint32_t particle, sk_sleeper *last) {
    for (size_t n = 0; n <= r->count; n++) {
        sk_sleeper *s = n ? &r->of[n - 1] : last;
        if (s && particle - s->body->first_particle < s->body->particle_count) return s;
    }
    return NULL;
}

/* Whose pins are led elsewhere in the next step, by the program or by motions, and his box has the place. `loose`: some of no
 * body's are. False when there is no memory. */
static bool follow_pins(const sk_neighbours *r, double dt, bool *loose) {
    skein_world *world = r->world;
    const sk_particles *all = &world->particles;
    sk_sleeper *s = NULL;
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
    return all->vector[SK_X][slot].w > 0 || loose_led ||
           memcmp(&all->vector[SK_X][slot], &all->vector[SK_PREVIOUS][slot], 3 * sizeof(real)) != 0;
}

/* Joins bodies that a constraint of the program's is on. */
static void join_linked(const sk_neighbours *r, bool loose_led) {
    const skein_world *world = r->world;
    for (size_t i = 0; i < world->objects.count; i++) {
        if (world->objects.data[i]->category != SKEIN_CONSTRAINT) continue;
        const sk_batch *batch = world->objects.data[i]->as.batch;
        sk_sleeper *first = NULL, *last = NULL;
        bool loose = false;
        for (size_t k = 0; k < batch->count * batch->arity; k++) {
            sk_sleeper *s = find_owner(r, batch->particle[k], last);
            if (!s)
                loose |= sk_particle_counts(&world->particles, batch->particle[k]) &&
                         is_loose(world, batch->particle[k], loose_led);
            if (!s || s == last) continue;
            if (!first) first = s;
            sk_union_join(r->island, first->index, s->index);
            last = s;
        }
        if (first) first->tied |= loose;
    }
}

static int compare_low(const void *a, const void *b) {
    const sk_sleeper *one = a, *other = b;
    if (one->low[0] != other->low[0]) return one->low[0] < other->low[0] ? -1 : 1;
    return (one->index > other->index) - (one->index < other->index);
}

static bool boxes_meet(const sk_sleeper *a, const sk_sleeper *b, real near) {
    bool meet = true;
    for (int k = 0; k < 3; k++) meet &= a->low[k] - near <= b->high[k] && b->low[k] - near <= a->high[k];
    return meet;
}

/* Joins two whose boxes meet. What stands pinned joins nobody: two that lie on it do not know of each other. */
static bool meet(sk_neighbours *r, sk_sleeper *a, sk_sleeper *b) {
    a->near += sk_hash_word(SK_HASH_START, b->body->first_particle);
    b->near += sk_hash_word(SK_HASH_START, a->body->first_particle);
    if (a->unmoving && b->unmoving) return true;
    if (!a->unmoving && !b->unmoving) {
        sk_union_join(r->island, a->index, b->index);
        return true;
    }
    if (!SK_RESERVE(&r->world->allocator, &r->leans, r->leans.count + 1)) return false;
    r->leans.data[r->leans.count++] = a->unmoving ? (sk_lean){a->index, b->index} : (sk_lean){b->index, a->index};
    return true;
}

/* Finds out who may touch whom. False when there is no memory. */
static bool join(sk_neighbours *r, bool loose_led) {
    bool good = true;
    join_linked(r, loose_led);
    if (r->count) qsort(r->of, r->count, sizeof *r->of, compare_low);
    for (size_t n = 0; n < r->count; n++) r->by_index[r->of[n].index] = &r->of[n];
    for (size_t a = 0; a < r->count && r->near >= 0; a++)
        for (size_t b = a + 1; b < r->count && r->of[b].low[0] - r->near <= r->of[a].high[0] && good; b++)
            if (boxes_meet(&r->of[a], &r->of[b], r->near)) good = meet(r, &r->of[a], &r->of[b]);
    return good;
}

void sk_neighbours_mark(const sk_neighbours *r) {
    if (r->count) memset(r->disturbed, 0, r->count * sizeof *r->disturbed);
    for (size_t n = 0; n < r->count; n++)
        if (r->of[n].awake) r->disturbed[sk_union_root(r->island, r->of[n].index)] = true;
}

bool sk_is_disturbed(const sk_neighbours *r, const sk_sleeper *s) {
    return r->disturbed[sk_union_root(r->island, s->index)];
}

bool sk_neighbours_find(skein_world *world, double ahead, double dt, sk_neighbours *all) {
    bool loose;
    if (!list_bodies(world, ahead, all)) return false;
    if (follow_pins(all, dt, &loose) && join(all, loose)) return true;
    sk_neighbours_release(all);
    return false;
}
