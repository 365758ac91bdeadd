/* The frames that were: to scrub through, and to branch from.
 *
 * Positions, velocities, pins and cuts of each frame, as exact as the world has them, as many as fit into the memory that
 * it is given; the oldest are forgotten. Invariant: frames first..last are kept, each in its own place of the ring. */
#ifndef SKEIN_VIEWER_HISTORY_H
#define SKEIN_VIEWER_HISTORY_H

#include "skein/skein.h"

/* What is cut, of the faces of all bodies one after another, from a frame on. */
typedef struct viewer_history_cut {
    uint64_t frame;
    unsigned char *face;
} viewer_history_cut;

typedef struct viewer_history {
    skein_real *state; /* `room` frames of `particles` x 6 */
    unsigned char *held;
    double *times;
    size_t particles, room;
    uint64_t first, last;
    bool empty;
    double *scratch;          /* particles x 3 */
    viewer_history_cut *cuts; /* cut_count, by their frames; none: all is whole */
    size_t cut_count, cut_room, faces;
    uint64_t cut_changes; /* of the bodies' cuts, when last looked at */
} viewer_history;

/* Forgets all, and makes room for frames of this world. False where there is no memory. */
bool viewer_history_begin(viewer_history *history, const skein_world *world);
void viewer_history_release(viewer_history *history);
/* Keeps the world as it is as frame number `frame`, which follows the last; later frames are forgotten. */
void viewer_history_keep(viewer_history *history, const skein_world *world, uint64_t frame);
/* Makes the world what it was; false if that frame is not kept. */
bool viewer_history_restore(viewer_history *history, skein_world *world, uint64_t frame);

#endif
