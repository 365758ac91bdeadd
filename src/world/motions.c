/* Motions in a world: whom each leads, and the places for the end of a step. What is led is then on its way by
 * world/pins.c, as if a program had said so. */
#include <stdio.h>
#include <string.h>

#include "colliders/seat.h"
#include "particles/selection.h"
#include "world/choose.h"
#include "world/world.h"

/* ---- adding and releasing ---- */

void sk_motion_release(sk_motion *motion, sk_allocator *allocator) {
    sk_release(allocator, motion->track.places);
    sk_release(allocator, motion->track.particles);
    sk_release(allocator, motion->particle);
    sk_release(allocator, motion->column);
    sk_release(allocator, motion->share);
    sk_release(allocator, motion->seats.data);
    sk_release(allocator, motion->seats.particle);
    sk_release(allocator, motion);
}

skein_status sk_world_check_track(const skein_world *world, const sk_motion_type *type, const skein_track *track) {
    skein_error *error = sk_world_error(world);
    if (!type->given)
        return track ? sk_fail(error, SKEIN_ERROR_VALUE, "", "%s takes no places", type->kind.name) : SKEIN_OK;
    if (!track || !track->sample_count || !track->particle_count)
        return sk_fail(error, SKEIN_ERROR_VALUE, type->given, "%s needs places: at least one sample of one particle",
                       type->kind.name);
    if (!(track->interval > 0) || !(track->interval <= SK_FAR))
        return sk_fail(error, SKEIN_ERROR_VALUE, type->given, "an interval of %g s: expected more than 0",
                       track->interval);
    if (track->sample_count > SIZE_MAX / 1024 / track->particle_count)
        return sk_fail(error, SKEIN_ERROR_LIMIT, type->given, "%zu samples of %zu particles are too many",
                       track->sample_count, track->particle_count);
    for (size_t i = 0; i < track->particle_count; i++)
        if (track->particles[i] >= world->particles.count)
            return sk_fail(error, SKEIN_ERROR_VALUE, type->given, "there is no particle %u (the world has %zu)",
                           track->particles[i], world->particles.count);
    for (size_t i = 0; i < 3 * track->sample_count * track->particle_count; i++)
        if (!(track->places[i] >= -SK_FAR && track->places[i] <= SK_FAR))
            return sk_fail(error, SKEIN_ERROR_VALUE, type->given,
                           "sample %zu, place %zu: numbers must be finite, under 1e15", i / 3 / track->particle_count,
                           i / 3 % track->particle_count);
    return SKEIN_OK;
}

sk_motion *sk_motion_create(sk_allocator *allocator, const sk_motion_type *type, const skein_track *track) {
    sk_motion *motion = sk_allocate(allocator, sizeof *motion);
    if (!motion) return NULL;
    memset(motion, 0, sizeof *motion);
    motion->type = type;
    if (!track) return motion;
    size_t count = track->particle_count * track->sample_count;
    motion->track = (sk_track){sk_allocate(allocator, count * sizeof *motion->track.places),
                               sk_allocate(allocator, track->particle_count * sizeof *motion->track.particles),
                               track->particle_count, track->sample_count, track->interval};
    if (!motion->track.places || !motion->track.particles) {
        sk_motion_release(motion, allocator);
        return NULL;
    }
    memcpy(motion->track.places, track->places, count * sizeof *motion->track.places);
    memcpy(motion->track.particles, track->particles, track->particle_count * sizeof *motion->track.particles);
    return motion;
}

/* ---- whom they lead ---- */

/* Whom words are about. */
typedef struct wording {
    skein_world *world;
    const sk_body *body;
    double (*position)[3];
    bool *chosen;
    skein_error *error;
} wording;

/* What words name is a matter of one body. */
static skein_status choose_words(void *data, const char *words) {
    const wording *w = data;
    if (w->body) return sk_body_choose_words(w->world, w->body, w->position, words, w->chosen, w->error);
    return sk_fail(
        w->error, SKEIN_ERROR_NAME, "pins",
        "'%s': expected numbers, \"box x y z x y z\" or \"sphere x y z radius\"; words are about one body: say "
        "which it is \"on\"; without \"pins\" it leads all that are pinned",
        words);
}

skein_status sk_world_choose(skein_world *world, const sk_body *body, size_t first, size_t count, const char *text,
                             bool *chosen, skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    bool vertices = body && body->vertex_count;
    size_t numbers = vertices ? body->vertex_count : count;
    double(*position)[3] = sk_allocate(allocator, count * sizeof *position);
    uint32_t *number = sk_allocate(allocator, numbers * sizeof *number);
    skein_status status = position && number ? SKEIN_OK : sk_fail_memory(error, "the pins of a motion");
    for (size_t i = 0; i < count && !status; i++) {
        sk_vec3 p = world->particles.built[first + i];
        position[i][0] = (double)p.x, position[i][1] = (double)p.y, position[i][2] = (double)p.z;
    }
    for (size_t i = 0; i < numbers && !status; i++)
        number[i] = vertices ? body->particle_of_vertex[i] - (uint32_t)first : (uint32_t)i;
    wording words = {world, body, position, chosen, error};
    sk_selectable of = {allocator,
                        position,
                        count,
                        number,
                        numbers,
                        vertices ? "vertex" : "particle",
                        body ? "the body" : "the world",
                        choose_words,
                        &words};
    if (!status) status = sk_selection_apply(text, &of, "pins", chosen, error);
    sk_release(allocator, position);
    sk_release(allocator, number);
    return status;
}

/* The particles of those bodies that a motion is `on`, and whom lies between them; without it, all. None, where the bodies
 * that it names were removed. */
static void find_range(const skein_world *world, const char *on, size_t *first, size_t *count) {
    size_t cursor = 0, end = 0;
    *first = on[0] ? SIZE_MAX : 0, *count = on[0] ? 0 : world->particles.count;
    for (const sk_body *body; on[0] && (body = sk_world_next_named(world, on, &cursor));) {
        if (body->first_particle < *first) *first = body->first_particle;
        if ((size_t)body->first_particle + body->particle_count > end)
            end = (size_t)body->first_particle + body->particle_count;
    }
    if (end > *first) *count = end - *first;
}

/* Marks those of its particles that a motion leads, from `first` on; with `pins`, those of each body that these name. */
static skein_status choose_all(skein_world *world, const char *on, const char *pins, size_t first, size_t count,
                               bool *chosen, skein_error *error) {
    skein_status status = SKEIN_OK;
    size_t cursor = 0;
    if (!on[0] && pins[0]) return sk_world_choose(world, NULL, first, count, pins, chosen, error);
    if (!on[0]) memset(chosen, 1, count * sizeof *chosen);
    for (const sk_body *body; on[0] && !status && (body = sk_world_next_named(world, on, &cursor));) {
        bool *its = chosen + (body->first_particle - first);
        if (pins[0])
            status = sk_world_choose(world, body, body->first_particle, body->particle_count, pins, its, error);
        else memset(its, 1, body->particle_count * sizeof *its);
    }
    return status;
}

/* Lists those that are chosen, in order; of a motion with a track, those that are in it. */
static bool list_particles(sk_allocator *allocator, sk_motion *motion, size_t first, size_t count, const bool *chosen) {
    const sk_track *track = &motion->track;
    size_t from = motion->type->given ? track->particle_count : count;
    sk_release(allocator, motion->particle);
    sk_release(allocator, motion->column);
    motion->count = 0;
    motion->particle = sk_allocate(allocator, from * sizeof *motion->particle);
    motion->column = sk_allocate(allocator, from * sizeof *motion->column);
    if (!motion->particle || !motion->column) return false;
    for (size_t i = 0; i < from; i++) {
        size_t particle = motion->type->given ? track->particles[i] : first + i;
        if (particle < first || particle - first >= count || !chosen[particle - first]) continue;
        motion->column[motion->count] = (uint32_t)i;
        motion->particle[motion->count++] = (uint32_t)particle;
    }
    return true;
}

/* Whether there are the bodies that a motion is `on`. */
static skein_status check_bodies(const skein_world *world, const sk_motion *motion, skein_error *error) {
    return sk_world_check_names(world, motion->label, motion->common->on, error);
}

/* What is to be said besides of a name that should be a collider's. */
static const char *group_words(const skein_world *world, sk_word name) {
    return sk_world_has_group(world, name) ? ": it is that of a group of bodies" : "";
}

/* Whether there are the colliders that a motion names. One that was there once may be removed. */
static skein_status find_colliders(const skein_world *world, sk_motion *motion, skein_error *error) {
    const char *names = motion->common->colliders;
    for (sk_word name; !motion->knows_colliders && (name = sk_names_next(&names, ",")).length;) {
        bool found = false;
        for (size_t i = 0; i < world->rules.colliders.count && !found; i++)
            found = sk_word_is(name, world->rules.colliders.data[i]->common->name);
        if (!found)
            return sk_fail(error, SKEIN_ERROR_NAME, motion->label, "there is no collider of the name '%.*s'%s",
                           (int)name.length, name.at, group_words(world, name));
    }
    motion->knows_colliders = true;
    return SKEIN_OK;
}

/* ---- those that follow a collider's triangles ---- */

/* The collider of that name; without one, that which alone has triangles. */
static const sk_collider *carrier_named(const skein_world *world, const char *name, size_t *meshes) {
    const sk_collider *found = NULL;
    *meshes = 0;
    for (size_t i = 0; i < world->rules.colliders.count; i++) {
        const sk_collider *collider = world->rules.colliders.data[i];
        *meshes += collider->type->surface != NULL;
        if (name[0] ? !found && !strcmp(collider->common->name, name) : collider->type->surface != NULL)
            found = collider;
    }
    return name[0] || *meshes == 1 ? found : NULL;
}

/* The collider whose triangles a motion follows. One that was there once may be removed: then nobody is led. */
static skein_status find_carrier(const skein_world *world, const sk_motion *motion, const sk_collider **collider,
                                 double *offset, skein_error *error) {
    size_t meshes;
    *collider = NULL;
    if (!motion->type->carrier) return SKEIN_OK;
    const char *name = motion->type->carrier(motion->params, offset);
    *collider = carrier_named(world, name, &meshes);
    if (*collider ? (*collider)->type->surface != NULL : motion->seats.data && !meshes) return SKEIN_OK;
    if (!name[0])
        return sk_fail(error, SKEIN_ERROR_NAME, "to", "expected the name of a mesh collider: there are %zu", meshes);
    if (!*collider && sk_world_has_group(world, sk_word_of(name)))
        return sk_fail(error, SKEIN_ERROR_NAME, "to",
                       "'%s' is a group of bodies: expected the name of one mesh collider", name);
    if (!*collider)
        return sk_fail(error, SKEIN_ERROR_NAME, "to",
                       "there is no collider of the name '%s' (to a body leads a constraint \"attachment\")", name);
    return sk_fail(error, SKEIN_ERROR_VALUE, "to",
                   "the collider '%s' is a %s, which has no triangles: take one of type \"mesh\"", name,
                   (*collider)->type->kind.name);
}

static skein_status refuse_frame(const sk_motion *motion, skein_error *error) {
    const skein_field *field = sk_motion_refused(motion->type, motion->common);
    if (!field) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, field->name,
                   "a motion of type \"%s\" is no moving frame: give this to the one that leads the collider",
                   motion->type->kind.name);
}

static void place_seat(const sk_seats *seats, size_t i, double time, double place[3]) {
    sk_collider_seat_place(seats->collider, &seats->data[i], time, place);
}

static bool have_seats(const sk_motion *motion, const sk_collider *collider, double offset) {
    const sk_seats *seats = &motion->seats;
    return seats->data && seats->collider == collider && seats->count == motion->count && !(seats->offset < offset) &&
           !(seats->offset > offset) && !(seats->start < motion->common->start) &&
           !(seats->start > motion->common->start) &&
           !memcmp(seats->particle, motion->particle, motion->count * sizeof *seats->particle);
}

/* Seats are kept as long as nothing is said anew: a collider that has been moved since by its fields carries them along. */
static skein_status find_seats(skein_world *world, sk_motion *motion, skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    const sk_collider *collider;
    double offset = 0;
    skein_status status = find_carrier(world, motion, &collider, &offset, error);
    if (status || !motion->type->carrier) return status;
    if (refuse_frame(motion, error)) return error->status;
    if (have_seats(motion, collider, offset)) return SKEIN_OK;
    motion->seats.place = NULL;
    motion->seats.collider = collider;
    if (!collider) return SKEIN_OK;
    sk_release(allocator, motion->seats.data);
    sk_release(allocator, motion->seats.particle);
    motion->seats = (sk_seats){NULL,
                               collider,
                               sk_allocate(allocator, (motion->count + 1) * sizeof *motion->seats.data),
                               sk_allocate(allocator, (motion->count + 1) * sizeof *motion->seats.particle),
                               motion->count,
                               motion->common->start,
                               offset};
    if (!motion->seats.data || !motion->seats.particle) {
        motion->seats.count = 0;
        return sk_fail_memory(error, "the seats of a motion");
    }
    for (size_t i = 0; i < motion->count; i++) {
        sk_vec3 built = world->particles.built[motion->particle[i]];
        const double at[3] = {(double)built.x, (double)built.y, (double)built.z};
        motion->seats.particle[i] = motion->particle[i];
        sk_collider_find_seat(collider, motion->common->start, at, offset, &motion->seats.data[i]);
    }
    motion->seats.place = place_seat;
    return SKEIN_OK;
}

skein_status sk_world_check_motion(skein_world *world, const sk_motion *motion, skein_error *error) {
    const char *on = motion->common->on, *pins = motion->common->pins;
    skein_status status = check_bodies(world, motion, error);
    sk_motion asked = *motion;
    asked.knows_colliders = false;
    if (!status) status = sk_motion_check_jumps(motion->common, error);
    const sk_collider *carrier;
    double offset;
    if (!status) status = find_carrier(world, motion, &carrier, &offset, error);
    if (!status && motion->type->carrier) status = refuse_frame(motion, error);
    if (!status) status = find_colliders(world, &asked, error);
    size_t shares;
    if (!status) status = sk_motion_read_map(motion->common, NULL, 0, &shares, error);
    if (status || !pins[0]) return status;
    size_t first, count;
    find_range(world, on, &first, &count);
    bool *chosen = sk_allocate(&world->allocator, count * sizeof *chosen);
    status = chosen ? choose_all(world, on, pins, first, count, chosen, error)
                    : sk_fail_memory(error, "the pins of a motion");
    sk_release(&world->allocator, chosen);
    return status;
}

/* The shares of a motion's map. */
static skein_status find_map(skein_world *world, sk_motion *motion, skein_error *error) {
    sk_release(&world->allocator, motion->share);
    motion->share = NULL;
    if (!motion->common->map[0]) return SKEIN_OK;
    motion->share = sk_allocate(&world->allocator, (motion->count + 1) * sizeof *motion->share);
    if (!motion->share) return sk_fail_memory(error, "a motion's map");
    size_t count;
    skein_status status = sk_motion_read_map(motion->common, motion->share, motion->count, &count, error);
    if (!status && count == motion->count) return SKEIN_OK;
    sk_release(&world->allocator, motion->share);
    motion->share = NULL;
    if (status) return status;
    return sk_fail(error, SKEIN_ERROR_VALUE, "map",
                   "%zu numbers, and it leads %zu particles, or could: expected one for each", count, motion->count);
}

static skein_status find_particles(skein_world *world, sk_motion *motion, skein_error *error) {
    if (check_bodies(world, motion, error)) return error->status;
    // one whose bodies were removed leads nobody, until somebody is called so again
    size_t first, count;
    find_range(world, motion->common->on, &first, &count);
    bool *chosen = sk_allocate(&world->allocator, count * sizeof *chosen);
    skein_status status = chosen
                              ? choose_all(world, motion->common->on, motion->common->pins, first, count, chosen, error)
                              : sk_fail_memory(error, "the pins of a motion");
    if (!status && !list_particles(&world->allocator, motion, first, count, chosen))
        status = sk_fail_memory(error, "the pins of a motion");
    sk_release(&world->allocator, chosen);
    size_t held = 0;
    memset(motion->middle, 0, sizeof motion->middle);
    for (size_t i = 0; i < motion->count && !status; i++) {
        sk_vec3 built = world->particles.built[motion->particle[i]];
        const double at[3] = {(double)built.x, (double)built.y, (double)built.z};
        for (int k = 0; k < 3; k++) motion->middle[k] += at[k] / (double)motion->count;
        held += world->particles.pinned[motion->particle[i]];
    }
    if (!status) status = find_colliders(world, motion, error);
    if (!status) status = find_map(world, motion, error);
    if (!status) status = find_seats(world, motion, error);
    if (!status && !held && count && motion->common->enabled && !motion->common->colliders[0] &&
        !sk_world_has_leashes(world))
        sk_world_log(world, SKEIN_LOG_WARNING, "%s: none of the particles that it is to lead is pinned: pin them",
                     motion->label);
    return status;
}

void sk_world_seat_all(skein_world *world) {
    bool unseated = false;
    for (size_t i = 0; i < world->motions.count; i++)
        unseated |= world->motions.data[i]->type->carrier && !world->motions.data[i]->seats.data;
    skein_error ignored; // the next step finds what is wrong again, and says it
    if (unseated && world->motions_stale) sk_world_find_pins(world, &ignored);
}

/* Whether it is one of the fields that are looked at here. */
static bool names_field(const char *where) {
    static const char *const fields[] = {"pins", "to",        "colliders",  "inertia",
                                         "jump", "jump_turn", "jump_times", "map"};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (!strcmp(where, fields[i])) return true;
    return false;
}

skein_status sk_world_find_pins(skein_world *world, skein_error *error) {
    if (!world->motions_stale) return SKEIN_OK;
    for (size_t i = 0; i < world->motions.count; i++) {
        skein_status status = find_particles(world, world->motions.data[i], error);
        if (!status) continue;
        char field[sizeof error->where];
        snprintf(field, sizeof field, "%s", error->where);
        if (names_field(field)) snprintf(error->where, sizeof error->where, "motions.%zu.%.40s", i, field);
        return status;
    }
    sk_release(&world->allocator, world->led_at);
    size_t places = world->motions.count ? world->particles.count : 0;
    world->led_at = sk_allocate(&world->allocator, places * sizeof *world->led_at);
    if (!world->led_at) return sk_fail_memory(error, "the pins of motions");
    for (size_t i = 0; i < places; i++) world->led_at[i] = SK_NOBODY;
    world->motions_stale = false;
    world->leashes.any = sk_world_has_leashes(world);
    world->rules.leashes = world->leashes.any ? &world->leashes : NULL;
    return sk_world_place_colliders(world) ? SKEIN_OK : sk_fail_memory(error, "frames of motions");
}

/* ---- a step ---- */

/* Adds the places that one motion leads to; a pin that is led already goes on from there. */
static void lead(skein_world *world, const sk_motion *motion, double time) {
    double since = time - motion->common->start;
    if (since < 0) since = 0;
    if (motion->type->carrier && !motion->seats.place) return;
    for (size_t i = 0; i < motion->count; i++) {
        uint32_t particle = motion->particle[i];
        if (!world->particles.pinned[particle] && !world->leashes.any) continue;
        sk_vec3 built = world->particles.built[particle];
        if (world->led_at[particle] == SK_NOBODY) {
            world->led_at[particle] = (uint32_t)world->led.count;
            world->led.data[world->led.count++] =
                (sk_pin){particle, {(double)built.x, (double)built.y, (double)built.z}};
        }
        motion->type->move(motion, i, since, world->led.data[world->led_at[particle]].place);
    }
}

bool sk_world_lead(skein_world *world, double time) {
    size_t most = world->pins.count;
    for (size_t i = 0; i < world->motions.count; i++) most += world->motions.data[i]->count;
    world->led.count = 0;
    if (!most) return true;
    if (!SK_RESERVE(&world->allocator, &world->led, most)) return false;
    for (size_t i = 0; i < world->motions.count; i++)
        if (world->motions.data[i]->common->enabled) lead(world, world->motions.data[i], time);
    for (size_t i = 0; i < world->led.count; i++) world->led_at[world->led.data[i].particle] = SK_NOBODY;
    for (size_t i = 0; i < world->pins.count; i++) world->led.data[world->led.count++] = world->pins.data[i];
    return true;
}
