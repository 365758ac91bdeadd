/* What surfaces meet: the parts of bodies that rules of contact are shown. */
#include <string.h>

#include "world/world.h"

/* The edges of bodies that have no triangles: ropes. */
static bool list_edges(const skein_world *world, sk_allocator *allocator, uint32_t (**edges)[2], size_t *count) {
    size_t most = 0;
    *count = 0;
    *edges = NULL;
    for (int pass = 0; pass < 2; pass++) {
        if (pass && !(*edges = sk_allocate(allocator, (most + 1) * sizeof **edges))) return false;
        for (size_t i = 0; i < world->objects.count; i++) {
            const sk_object *object = world->objects.data[i];
            if (object->category != SKEIN_BODY || object->as.body->triangle_count) continue;
            for (size_t b = 0; b < object->as.body->batch_count; b++) {
                const sk_batch *batch = object->as.body->batch[b];
                if (!batch->measured || batch->arity != 2) continue;
                most += batch->count;
                for (size_t e = 0; pass && e < batch->count; e++, ++*count)
                    for (int k = 0; k < 2; k++) (*edges)[*count][k] = batch->particle[2 * e + (size_t)k];
            }
        }
    }
    return true;
}

static size_t count_those_that_meet(const skein_world *world) {
    size_t count = 0;
    for (size_t i = 0; i < world->rules.forces.count; i++)
        count += *world->rules.forces.data[i]->enabled && world->rules.forces.data[i]->type->meeting;
    return count;
}

double sk_object_number(const sk_object *object, const char *name) {
    const skein_field *field = sk_field_named(object->kind->fields, object->kind->field_count, name);
    return field ? sk_field_load(field, object->params).number[0] : 0;
}

void sk_world_ease_meetings(skein_world *world, const sk_body *body) {
    const uint32_t first = body ? body->first_particle : 0, end = body ? first + body->particle_count : UINT32_MAX;
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        sk_easing *easing = &world->rules.forces.data[i]->easing;
        if (!world->rules.forces.data[i]->type->meeting) continue;
        const bool others = easing->asks < easing->asks_end;
        easing->asks = others && easing->asks < first ? easing->asks : first;
        easing->asks_end = others && easing->asks_end > end ? easing->asks_end : end;
    }
}

void sk_world_ease_changed(skein_world *world, const sk_object *object, const char *field) {
    static const char *const of_rule[] = {"thickness", "enabled", "on", "ignore"}, *const of_body[] = {
                                                                                       "contact.thickness", "name",
                                                                                       "groups"};
    const bool is_rule = object->category == SKEIN_FORCE && object->as.force->type->meeting;
    for (size_t i = 0; is_rule && i < sizeof of_rule / sizeof *of_rule; i++)
        if (!strcmp(field, of_rule[i]))
            object->as.force->easing.asks = 0, object->as.force->easing.asks_end = UINT32_MAX;
    for (size_t i = 0; object->category == SKEIN_BODY && i < sizeof of_body / sizeof *of_body; i++)
        if (!strcmp(field, of_body[i])) sk_world_ease_meetings(world, object->as.body);
}

/* Bodies with what they are called, so that rules can tell them apart. */
static size_t list_bodies(const skein_world *world, sk_meeting_body *bodies) {
    size_t count = 0;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_BODY) continue;
        size_t first = object->as.body->first_particle;
        bodies[count++] = (sk_meeting_body){first,
                                            first + object->as.body->particle_count,
                                            object->common.plain.name,
                                            object->common.plain.groups,
                                            sk_object_number(object, "contact.thickness"),
                                            sk_object_number(object, "contact.friction")};
    }
    return count;
}

/* Each name in the pairs that rules ignore is a body's or a group's, or was; in those of rules that are not enabled, too. */
static skein_status check_ignored(const skein_world *world, skein_error *error) {
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        const sk_force *force = world->rules.forces.data[i];
        if (!force->type->meeting) continue;
        const char *text = force->type->meeting->ignored(force->params);
        skein_status status = SKEIN_OK;
        for (sk_word name; !status && (name = sk_names_next(&text, ",:")).length;)
            status = sk_world_check_name(world, force->label, name, error);
        if (status) return status;
    }
    return SKEIN_OK;
}

/* What can be in contact; its lists are its own. False when there is no memory. */
typedef struct meeting_lists {
    sk_meeting_parts parts;
    uint32_t (*edges)[2];
    sk_meeting_body *bodies;
} meeting_lists;

static void release_lists(skein_world *world, meeting_lists *l) {
    sk_release(&world->allocator, l->edges);
    sk_release(&world->allocator, l->bodies);
}

static bool list_parts(skein_world *world, size_t rules, meeting_lists *l) {
    size_t edge_count;
    *l = (meeting_lists){.edges = NULL};
    bool good = list_edges(world, &world->allocator, &l->edges, &edge_count);
    l->bodies = sk_allocate(&world->allocator, (world->objects.count + 1) * sizeof *l->bodies);
    l->parts = (sk_meeting_parts){.triangle = (const uint32_t(*)[3])world->triangles.corner,
                                  .triangle_count = world->triangles.count,
                                  .edge = (const uint32_t(*)[2])l->edges,
                                  .edge_count = edge_count,
                                  .body = l->bodies,
                                  .body_count = l->bodies ? list_bodies(world, l->bodies) : 0,
                                  .arrangement = world->arrangement,
                                  .rule_count = rules,
                                  .collider = world->rules.colliders.data,
                                  .collider_count = world->rules.colliders.count};
    if (good && l->bodies) return true;
    release_lists(world, l);
    return false;
}

/* Once for a rule. */
static void tell_of_crowded(skein_world *world, const sk_meeting_parts *parts) {
    for (size_t i = 0; world->desc.log && i < world->rules.forces.count; i++) {
        sk_force *force = world->rules.forces.data[i];
        if (!*force->enabled || !force->type->meeting) continue;
        double edge, thickness;
        const sk_meeting_body *body = force->type->meeting->crowded(force, &world->allocator, parts, &edge, &thickness);
        if (body)
            sk_world_log(
                world, SKEIN_LOG_WARNING,
                "%s: %s is %.2g m thick, and its edges are %.2g m long in the mean: all of it is near dozens of others, which can take "
                "several times as long as a thickness of %.1g m (its contact.thickness, or this force's thickness)",
                force->label, body->name[0] ? body->name : "a body", thickness, edge, 0.25 * edge);
    }
}

skein_status sk_world_prepare_meetings(skein_world *world, skein_error *error) {
    skein_status status = check_ignored(world, error);
    size_t rules = count_those_that_meet(world);
    if (status || !rules) return status;
    meeting_lists lists;
    bool good = list_parts(world, rules, &lists);
    if (!good) return sk_fail_memory(error, "contact");
    for (size_t i = 0; i < world->rules.forces.count && good; i++) {
        sk_force *force = world->rules.forces.data[i];
        if (*force->enabled && force->type->meeting)
            good = force->type->meeting->prepare(force, &world->allocator, &world->particles, &lists.parts, world->isa);
    }
    if (good) tell_of_crowded(world, &lists.parts);
    release_lists(world, &lists);
    return good ? SKEIN_OK : sk_fail_memory(error, "contact");
}

/* ---- among those that sleep, whom no rule is shown, and with what is pinned ---- */

/* Who is pinned and awake, and who sleeps if they are asked for, as being here, and nobody else. */
static void mark_sleepers(const skein_world *world, bool asleep, uint8_t *presence) {
    const sk_particles *all = &world->particles;
    for (size_t i = 0; i < all->count; i++) presence[i] = asleep && all->presence[i] == SK_ASLEEP ? SK_HERE : SK_ASIDE;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_body *body = sk_world_body_at(world, i);
        if (body && sk_world_stands(world, body))
            memset(presence + body->first_particle, SK_HERE, body->particle_count);
    }
}

/* Prepares `own`, a rule like another that meets nobody but those, with its lists of whom. False when there is no memory. */
static bool prepare_for_sleepers(skein_world *world, const sk_force *force, size_t rules, bool asleep, sk_force *own) {
    sk_allocator *allocator = &world->allocator;
    sk_particles particles = world->particles;
    meeting_lists lists;
    *own = *force;
    own->state = NULL;
    own->only = (sk_only){.data = NULL};
    if (!list_parts(world, rules, &lists)) return false;
    particles.presence = sk_allocate(allocator, particles.count * sizeof *particles.presence);
    if (particles.presence) mark_sleepers(world, asleep, particles.presence);
    const bool good = particles.presence && sk_world_list_sleepers(world, *force->on, &own->only) &&
                      force->type->meeting->prepare(own, allocator, &particles, &lists.parts, world->isa);
    sk_release(allocator, particles.presence);
    release_lists(world, &lists);
    return good;
}

static void end_for_sleepers(skein_world *world, sk_force *own) {
    own->type->meeting->release(own, &world->allocator);
    sk_release(&world->allocator, own->only.data);
}

/* They do not move, so that is counted once. */
static bool count_among_sleepers(skein_world *world, size_t *count) {
    const size_t rules = count_those_that_meet(world);
    bool good = true;
    size_t all = 0;
    for (size_t i = 0; i < world->rules.forces.count && good && !world->sleepers_known && world->particles.asleep_count;
         i++) {
        const sk_force *force = world->rules.forces.data[i];
        if (!*force->enabled || !force->type->meeting) continue;
        for (int asleep = 1; asleep >= 0 && good; asleep--) { // what is pinned alone is counted already
            sk_force own;
            size_t its = 0;
            good = prepare_for_sleepers(world, force, rules, asleep, &own) &&
                   force->type->meeting->crossings(&own, &world->allocator, world->particles.vector[SK_X],
                                                   world->particles.slot_of, &its);
            end_for_sleepers(world, &own);
            all += asleep ? its : (size_t)0 - its;
        }
    }
    if (good && !world->sleepers_known) world->sleepers_known = true, world->crossings_asleep = all;
    *count += world->crossings_asleep;
    return good;
}

skein_status sk_world_count_crossings(skein_world *world, size_t *count, skein_error *error) {
    *count = 0;
    skein_status status = sk_world_prepare_meetings(world, error);
    for (size_t i = 0; i < world->rules.forces.count && !status; i++) {
        sk_force *force = world->rules.forces.data[i];
        size_t own = 0;
        if (!*force->enabled || !force->type->meeting) continue;
        if (!force->type->meeting->crossings(force, &world->allocator, world->particles.vector[SK_X],
                                             world->particles.slot_of, &own))
            return sk_fail_memory(error, "contact");
        *count += own;
    }
    if (!status && !count_among_sleepers(world, count)) return sk_fail_memory(error, "contact");
    return status;
}

void sk_world_tell_of_meetings(skein_world *world) {
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        sk_force *force = world->rules.forces.data[i];
        bool first = false;
        if (*force->enabled && force->type->meeting)
            world->contact_overflows += force->type->meeting->gave_up(force, &first);
        if (first)
            sk_world_log(world, SKEIN_LOG_WARNING,
                         "%s: more pairs were near each other than there is room for, and nothing touched for a substep "
                         "or more: the thickness is too large for the bodies, or they have blown up",
                         force->label);
    }
}

void sk_world_end_meeting(skein_world *world, sk_force *force) {
    if (force->type->meeting) force->type->meeting->release(force, &world->allocator);
}

static bool list_contacts(skein_world *world, sk_force *force, size_t object, skein_surface_contact *out, size_t most,
                          size_t *count) {
    size_t own = 0, room = most > *count ? most - *count : 0;
    skein_surface_contact *to = room ? out + *count : NULL;
    if (!force->type->meeting->touching(force, &world->allocator, world->particles.vector[SK_X],
                                        world->particles.slot_of, to, room, &own))
        return false;
    for (size_t k = 0; k < own && k < room; k++) to[k].rule = sk_handle_at(world, object);
    *count += own;
    return true;
}

/* Of those that sleep, and none of what is pinned with itself: that is listed already. */
static bool list_contacts_of_sleepers(skein_world *world, const sk_force *force, size_t object,
                                      skein_surface_contact *out, size_t most, size_t *count) {
    const size_t rules = count_those_that_meet(world);
    sk_force own;
    size_t found = 0;
    bool good =
        prepare_for_sleepers(world, force, rules, true, &own) && list_contacts(world, &own, object, NULL, 0, &found);
    skein_surface_contact *all = good ? sk_allocate(&world->allocator, (found + 1) * sizeof *all) : NULL;
    const size_t room = found;
    found = 0;
    good = all && list_contacts(world, &own, object, all, room, &found);
    for (size_t k = 0; good && k < found; k++) {
        bool asleep = false;
        for (int c = 0; c < 4; c++) asleep |= world->particles.presence[all[k].particle[c]] == SK_ASLEEP;
        if (!asleep) continue;
        if (*count < most) out[*count] = all[k];
        ++*count;
    }
    sk_release(&world->allocator, all);
    end_for_sleepers(world, &own);
    return good;
}

skein_status skein_surface_contacts_copy(skein_world *world, skein_surface_contact *out, size_t most, size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, count);
    if (most) SK_NEED(world, out);
    skein_error *error = sk_world_error(world);
    *count = 0;
    skein_status status = sk_world_fetch(world);
    if (!status) status = sk_world_arrange(world, error);
    if (!status) status = sk_world_find_whom(world, error);
    if (!status) status = sk_world_prepare_meetings(world, error);
    for (size_t i = 0; i < world->objects.count && !status; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_FORCE || !*object->as.force->enabled || !object->as.force->type->meeting)
            continue;
        sk_force *force = object->as.force;
        if (!list_contacts(world, force, i, out, most, count) ||
            (world->particles.asleep_count && !list_contacts_of_sleepers(world, force, i, out, most, count)))
            return sk_fail_memory(error, "contact");
    }
    return status;
}
