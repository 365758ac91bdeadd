/* Boxes around bodies, and how near colliders are to them. */
#include <math.h>

#include "world/nearness.h"

/* ---- boxes ---- */

void sk_box_widen(const sk_particles *all, const sk_body *body, real ahead, real low[3], real high[3]) {
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

void sk_box_begin(real low[3], real high[3]) {
    for (int k = 0; k < 3; k++) low[k] = SK_REAL_MAX, high[k] = -SK_REAL_MAX;
}

/* ---- colliders ---- */

void sk_collider_find_poses(const skein_world *world, const sk_collider *collider, double dt, sk_pose pose[2]) {
    pose[0] = sk_collider_pose_unled(collider, world->time);
    pose[1] = sk_collider_pose_at(collider, world->time + dt);
    if (!collider->led) return;
    sk_collider then = *collider;
    pose[0] = sk_collider_pose_at(collider, world->time);
    then.travel.moving = false;
    then.frame = sk_world_frame_ahead(world, collider->common->name);
    pose[1] = sk_collider_pose_at(&then, world->time + dt);
}

double sk_collider_distance(const skein_world *world, const sk_collider *collider, const sk_pose *pose,
                            const sk_body *body) {
    const sk_particles *all = &world->particles;
    double least = INFINITY;
    for (size_t first = 0; first < body->particle_count; first += SK_LANES) {
        real p[3][SK_LANES] = {{0}};
        sk_sixteen_contacts contacts;
        const size_t left = body->particle_count - first, lanes = left < SK_LANES ? left : SK_LANES;
        for (size_t l = 0; l < SK_LANES; l++) { // the first again where there is nobody
            const sk_vec4 x = all->vector[SK_X][all->slot_of[body->first_particle + first + (l < lanes ? l : 0)]];
            p[0][l] = x.x, p[1][l] = x.y, p[2][l] = x.z;
        }
        sk_probe_sixteen_of[world->isa](collider, pose, p, SK_REAL_MAX, &contacts);
        for (size_t l = 0; l < lanes; l++) least = fmin(least, (double)contacts.distance[l]);
    }
    return least;
}

bool sk_collider_is_far(const skein_world *world, const sk_collider *collider, const sk_pose *pose, const real low[3],
                        const real high[3], double clear) {
    real middle[3][SK_LANES];
    double half = 0;
    sk_sixteen_contacts contacts;
    for (int k = 0; k < 3; k++) {
        half += pow((double)(high[k] - low[k]) / 2, 2);
        for (int l = 0; l < SK_LANES; l++) middle[k][l] = (low[k] + high[k]) / 2;
    }
    if (collider->type->making && !collider->type->take) return false;
    sk_probe_sixteen_of[world->isa](collider, pose, middle, SK_REAL_MAX, &contacts);
    return (double)contacts.distance[0] > sqrt(half) + clear;
}
