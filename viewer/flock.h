/* Flocks in the window: how they fly together, and the bird that is chosen.
 *
 * A bird is chosen by a click; its zones and neighbours are drawn then (render/world_flock.c), and the camera can ride
 * on it. Kinds are known by their fields. Called by the stage's files, on the stage's thread. */
#ifndef SKEIN_VIEWER_FLOCK_H
#define SKEIN_VIEWER_FLOCK_H

#include "skein/skein.h"
#include "viewer/camera.h"

typedef struct viewer_ride {
    bool chosen, rides;
    uint32_t bird;     /* a particle of the first side */
    double ahead[3];   /* where it looks, smoothed */
    double time;       /* of the world, then */
    render_camera was; /* before the ride */
} viewer_ride;

/* Whether the particle belongs to a flock. */
bool viewer_is_bird(const skein_world *world, uint32_t particle);
/* The first flock's order about the centre that it is drawn to; false where there is no flock. */
bool viewer_flock_measure(skein_world *world, skein_order *order);

/* Begins a ride, on the chosen bird or else on the one nearest to where the camera looks; or ends it, and the camera is
 * where it was. False where there is no bird. */
bool viewer_ride_toggle(viewer_ride *ride, const skein_world *world, viewer_camera *camera);
/* Brings the camera of a ride to the bird's beak, as it stands between the last two steps (skein_pacer_blend()); birds
 * are so large from tip to tip (m). */
void viewer_ride_move(viewer_ride *ride, const skein_world *world, viewer_camera *camera, double blend, double span);

#endif
