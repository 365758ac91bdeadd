/* How near bodies and colliders are before a step, for who sleeps (sleep.c) and for how many substeps there are to be (finer.c). */
#ifndef SK_WORLD_NEARNESS_H
#define SK_WORLD_NEARNESS_H

#include "world/world.h"

/* A box that has nothing in it; and widens one by where a body is, and by where it will be so many seconds ahead. */
void sk_box_begin(real low[3], real high[3]);
void sk_box_widen(const sk_particles *all, const sk_body *body, real ahead, real low[3], real high[3]);
/* Where a collider is now, and when the next step is over, in the frame that leads it: what moves has been looked at
 * (sk_world_look_ahead). */
void sk_collider_find_poses(const skein_world *world, const sk_collider *collider, double dt, sk_pose pose[2]);
/* How far apart the particles of a body and a collider are at a pose. */
double sk_collider_distance(const skein_world *world, const sk_collider *collider, const sk_pose *pose,
                            const sk_body *body);
/* Whether all of a box is farther from a collider than `clear`. Not known where its distance is that of a formula, which is none. */
bool sk_collider_is_far(const skein_world *world, const sk_collider *collider, const sk_pose *pose, const real low[3],
                        const real high[3], double clear);

#endif
