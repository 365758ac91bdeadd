/* Birds: one small mesh, an instance for each, placed by the card from positions and velocities.
 *
 * Called by draw.c. A flock's numbers either come with the frame, or lie in buffers of this context already, where a
 * world computes them on the card: then nothing is copied. What a bird does with its wings, and how it leans into a
 * turn, is kept here from frame to frame: the beat goes faster with the speed, and the lean follows the turn. */
#ifndef SKEIN_RENDER_BIRDS_H
#define SKEIN_RENDER_BIRDS_H

#include "render/frame.h"
#include "skein/skein.h"

/* Start from {0}. */
typedef struct render_flight {
    unsigned arrays, mesh;
    unsigned drawn, depth, advance; /* programs */
    unsigned positions, velocities; /* of all flocks whose numbers came with the frame */
    unsigned slots;                 /* of the others */
    unsigned postures;              /* of all birds: heading, phase of the beat, lean */
    size_t bird_room, posture_count;
    double time; /* of the frame that the postures are of */
} render_flight;

skein_status render_flight_create(render_flight *flight, skein_error *error);
void render_flight_destroy(render_flight *flight);
/* Brings the frame's flocks to the card, and moves their wings on to the frame's time. */
skein_status render_flight_bring(render_flight *flight, const render_frame *frame, skein_error *error);
/* Draws them; with `depth`, for a light's map. `part`: so many triangles at a time, as draw.h says; 0: all. */
void render_flight_draw(const render_flight *flight, const render_frame *frame, bool depth, size_t part);

#endif
