/* Flocks in the window; see flock.h. */
#include "viewer/flock.h"

#include <math.h>
#include <string.h>

#include "render/linear.h"
#include "render/world_birds.h"

/* Where one looks follows where the bird flies within so many seconds; its beak is so many spans ahead of it. */
static const double head_follows = 0.25, beak = 0.3;

/* The first flock; false where there is none. */
static bool find_flock(const skein_world *world, skein_surface *flock) {
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, i);
        if (render_are_birds(world, body, NULL) && !skein_body_surface(world, body, flock)) return true;
    }
    return false;
}

bool viewer_is_bird(const skein_world *world, uint32_t particle) {
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, i);
        skein_surface flock;
        if (render_are_birds(world, body, NULL) && !skein_body_surface(world, body, &flock) &&
            particle >= flock.first_particle && particle - flock.first_particle < flock.particle_count)
            return true;
    }
    return false;
}

/* What the flock is drawn to: the centre of the first rule that has one; else the origin. */
static void find_centre(const skein_world *world, double centre[3]) {
    memset(centre, 0, 3 * sizeof *centre);
    for (size_t i = 0; i < skein_object_count(world, SKEIN_FORCE); i++) {
        skein_handle force = skein_object_at(world, SKEIN_FORCE, i);
        skein_value value, enabled;
        if (!skein_field_find(skein_object_kind(world, force), "centre", NULL)) continue;
        if (skein_get(world, force, "enabled", &enabled) || enabled.number[0] == 0) continue;
        if (skein_get(world, force, "centre", &value)) continue;
        memcpy(centre, value.number, 3 * sizeof *centre);
        return;
    }
}

bool viewer_flock_measure(skein_world *world, skein_order *order) {
    skein_surface flock;
    double centre[3];
    if (!find_flock(world, &flock)) return false;
    find_centre(world, centre);
    return !skein_order_measure(world, flock.first_particle, flock.particle_count, centre, 0, order);
}

/* ---- Riding ---- */

/* The bird nearest to the line of sight, in front of the camera; UINT32_MAX where there is none. */
static uint32_t bird_in_sight(const skein_world *world, const render_camera *lens) {
    skein_surface flock;
    if (!find_flock(world, &flock)) return UINT32_MAX;
    double right[3], up[3], back[3], least = INFINITY;
    uint32_t found = UINT32_MAX;
    render_camera_axes(lens, right, up, back);
    for (size_t i = 0; i < flock.particle_count; i++) {
        double x[3], off[3];
        size_t particle = flock.first_particle + i;
        if (!skein_particle_present(world, particle) || skein_positions_copy(world, particle, 1, x)) continue;
        for (int k = 0; k < 3; k++) off[k] = x[k] - lens->eye[k];
        double depth = -render_dot(off, back);
        double aside = hypot(render_dot(off, right), render_dot(off, up)) / depth;
        if (depth > 0 && aside < least) least = aside, found = (uint32_t)particle;
    }
    return found;
}

bool viewer_ride_toggle(viewer_ride *ride, const skein_world *world, viewer_camera *camera) {
    if (ride->rides) {
        ride->rides = false;
        camera->lens = ride->was;
        return true;
    }
    uint32_t bird = ride->chosen ? ride->bird : bird_in_sight(world, &camera->lens);
    if (bird == UINT32_MAX) return false;
    ride->was = camera->lens;
    ride->chosen = ride->rides = true;
    ride->bird = bird;
    memset(ride->ahead, 0, sizeof ride->ahead);
    return true;
}

/* Where it looks follows where the bird flies, as the world's time goes on; at once when that jumps. */
static void turn_head(viewer_ride *ride, const double v[3], double time) {
    double speed = sqrt(render_dot(v, v)), seconds = time - ride->time;
    bool cut = render_dot(ride->ahead, ride->ahead) == 0 || seconds < 0 || seconds > 1;
    double share = cut ? 1 : 1 - exp(-seconds / head_follows);
    for (int k = 0; k < 3 && speed > 0 && isfinite(speed); k++)
        ride->ahead[k] += share * (v[k] / speed - ride->ahead[k]);
    ride->time = time;
}

void viewer_ride_move(viewer_ride *ride, const skein_world *world, viewer_camera *camera, double blend, double span) {
    double x[3], v[3];
    bool known = ride->rides && !skein_velocities_copy(world, ride->bird, 1, v) &&
                 !(blend < 1 ? skein_positions_blend(world, blend, ride->bird, 1, x)
                             : skein_positions_copy(world, ride->bird, 1, x));
    if (!known) return;
    turn_head(ride, v, skein_world_time(world));
    double ahead[3] = {ride->ahead[0], ride->ahead[1], ride->ahead[2]};
    if (render_dot(ahead, ahead) == 0) ahead[2] = 1; // it stands
    render_normalise(ahead);
    // never straight up or down, where there is no upright
    double level = hypot(ahead[0], ahead[2]);
    if (level < 0.05) ahead[2] += ahead[2] < 0 ? -0.05 : 0.05;
    render_normalise(ahead);
    for (int k = 0; k < 3; k++) {
        camera->lens.eye[k] = x[k] + beak * span * ahead[k];
        camera->lens.target[k] = camera->lens.eye[k] + 10 * span * ahead[k];
    }
    const double up[3] = {0, 1, 0};
    memcpy(camera->lens.up, up, sizeof up);
    camera->lens.near = 0.02 * span;
    camera->moved = true;
}
