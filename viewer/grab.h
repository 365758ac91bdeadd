/* The hand: particles that the mouse picks, pulls, pins and frees.
 *
 * A pulled particle is held, and led after the cursor by the way that a spring would bring it, as a pin that moves: that
 * works under every method, whether it has velocities or not, and needs no stiffness that a step could be too long for.
 * Where the springs around it are stretched too far, the hand gives way. Called by the stage. */
#ifndef SKEIN_VIEWER_GRAB_H
#define SKEIN_VIEWER_GRAB_H

#include "skein/skein.h"

typedef struct viewer_grab {
    bool holding;
    bool was_held; /* before it was grabbed */
    bool moved;    /* the pointer has: it is no click */
    size_t side;
    uint32_t particle;
    double goal[3];  /* where the cursor has it */
    double led[3];   /* m/s, in the last step: what it flies on with */
    double depth[3]; /* a point of the plane that the cursor moves in, facing the camera */
    /* the springs that it hangs on */
    uint32_t neighbours[16];
    double rests[16];
    int neighbour_count;
} viewer_grab;

/* Takes hold of a particle. */
void viewer_grab_take(viewer_grab *grab, skein_world *world, size_t side, uint32_t particle);
/* Before each step of dt: leads the particle on. */
void viewer_grab_lead(viewer_grab *grab, skein_world *world, double dt);
/* Lets go; a particle that was held before stays where it is now. */
void viewer_grab_release(viewer_grab *grab, skein_world *world);
bool viewer_is_held(const skein_world *world, uint32_t particle);
/* Pins a particle, or frees it; returns whether it is pinned now. */
bool viewer_toggle_pin(skein_world *world, uint32_t particle);

#endif
