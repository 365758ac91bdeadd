/* What holds free particles near the places where motions would lead them (limits/leash.h): filled in before each step. */
#include <math.h>
#include <string.h>

#include "world/world.h"

bool sk_motion_is_leash(const sk_motion *motion) {
    const sk_motion_common *common = motion->common;
    return common->enabled &&
           (common->pull > 0 || common->max_distance < SK_UNBOUNDED || common->backstop < SK_UNBOUNDED);
}

bool sk_world_has_leashes(const skein_world *world) {
    for (size_t i = 0; i < world->motions.count; i++)
        if (sk_motion_is_leash(world->motions.data[i])) return true;
    return false;
}

/* The normals of the surface that places make, not of length 1, by particle; 0 where a triangle's corners are not all led. */
static void find_normals(const skein_world *world, const double (*place)[3], double (*normal)[3]) {
    memset(normal, 0, world->particles.count * sizeof *normal);
    for (size_t t = 0; t < world->triangles.count; t++) {
        const uint32_t *corner = world->triangles.corner[t];
        const double *a = place[corner[0]], *b = place[corner[1]], *c = place[corner[2]];
        double u[3], v[3];
        for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
        const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        for (int k = 0; k < 3 && n[0] * n[0] + n[1] * n[1] + n[2] * n[2] >= 0; k++)
            for (int i = 0; i < 3; i++) normal[corner[i]][k] += n[k];
    }
}

/* Places of all that is led, by particle; NaN of all others. */
static bool find_places(skein_world *world, double time, double (*place)[3]) {
    for (size_t i = 0; i < world->particles.count; i++) place[i][0] = place[i][1] = place[i][2] = NAN;
    if (!sk_world_lead(world, time)) return false;
    for (size_t i = 0; i < world->led.count; i++)
        memcpy(place[world->led.data[i].particle], world->led.data[i].place, sizeof *place);
    return true;
}

/* What is carried along begins where it was carried to; but who sits on a collider, there where that begins. */
static void carry_places(const skein_world *world, double (*place)[3]) {
    for (size_t i = 0; i < world->carried.count; i++) {
        const sk_carried *run = &world->carried.data[i];
        for (size_t p = run->first; p < run->first + run->count; p++) {
            double to[3];
            sk_frame_place(&run->way, place[p], to);
            memcpy(place[p], to, sizeof to);
        }
    }
    for (size_t i = 0; i < world->motions.count && world->carried.count; i++) {
        const sk_motion *motion = world->motions.data[i];
        if (!motion->common->enabled || !motion->type->carrier || !motion->seats.place) continue;
        double since = fmax(0, world->time - motion->common->start);
        for (size_t k = 0; k < motion->count; k++) motion->type->move(motion, k, since, place[motion->particle[k]]);
    }
}

/* The middle of the ball that is so far behind a place. */
static sk_vec3 middle_of(const double place[3], const double normal[3], double behind) {
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    double share = length > 0 ? behind / length : 0;
    const double middle[3] = {place[0] - share * normal[0], place[1] - share * normal[1], place[2] - share * normal[2]};
    return sk_v3_of(middle);
}

typedef struct step_places {
    double (*from)[3], (*to)[3], (*normal_from)[3], (*normal_to)[3];
} step_places;

/* Adds what one motion says: of several the tightest counts. */
static void add_leashes(skein_world *world, const sk_motion *motion, const step_places *at) {
    const sk_motion_common *common = motion->common;
    for (size_t i = 0; i < motion->count; i++) {
        uint32_t p = motion->particle[i];
        if (!sk_particle_is_here(&world->particles, p) || !(at->to[p][0] <= SK_FAR)) continue;
        sk_leash *leash = &world->leashes.data[world->particles.slot_of[p]];
        double share = motion->share ? motion->share[i] : 1, most = common->max_distance * share;
        if (!leash->held) leash->most = (real)SK_UNBOUNDED;
        leash->held = true;
        leash->from = sk_v3_of(at->from[p]), leash->to = sk_v3_of(at->to[p]);
        if ((real)common->pull > leash->pull) leash->pull = (real)common->pull;
        if (common->max_distance < SK_UNBOUNDED && (real)most < leash->most) leash->most = (real)most;
        const double *n = at->normal_to[p];
        if (!(common->backstop < SK_UNBOUNDED) || !(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0)) continue;
        double behind = common->backstop + common->backstop_radius;
        leash->radius = (real)common->backstop_radius;
        leash->stop_from = middle_of(at->from[p], at->normal_from[p], behind);
        leash->stop_to = middle_of(at->to[p], n, behind);
    }
}

skein_status sk_world_set_leashes(skein_world *world, double dt, skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    size_t count = world->particles.count, slots = world->particles.slot_count;
    world->leashes.count = 0;
    if (!world->leashes.any || !count) return SKEIN_OK;
    double(*room)[3] = sk_allocate(allocator, 4 * count * sizeof *room);
    bool good = room && SK_RESERVE(allocator, &world->leashes, slots);
    const step_places at = {room, room + count, room + 2 * count, room + 3 * count};
    good = good && find_places(world, world->time, at.from) && find_places(world, world->time + dt, at.to);
    if (good) {
        carry_places(world, at.from);
        find_normals(world, (const double(*)[3])at.from, at.normal_from);
        find_normals(world, (const double(*)[3])at.to, at.normal_to);
        memset(world->leashes.data, 0, slots * sizeof *world->leashes.data);
        world->leashes.count = slots;
        world->leashes.start = world->time, world->leashes.dt = dt;
        for (size_t i = 0; i < world->motions.count; i++)
            if (sk_motion_is_leash(world->motions.data[i])) add_leashes(world, world->motions.data[i], &at);
    }
    sk_release(allocator, room);
    return good ? SKEIN_OK : sk_fail_memory(error, "the leashes of motions");
}
