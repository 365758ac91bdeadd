/* The pointer as a predator: where a rule flees from a line of sight, the pointer over the picture is that line.
 *
 * What the scene itself gives such a rule is kept meanwhile, and put back once the pointer leaves the picture, or before
 * anybody else looks at the rule or changes it. Kinds are known by their fields. Called by the stage's files, on the
 * stage's thread. */
#ifndef SKEIN_VIEWER_HUNT_H
#define SKEIN_VIEWER_HUNT_H

#include "skein/skein.h"

typedef struct viewer_stage viewer_stage;

/* A rule that the pointer leads, and what it was before. */
typedef struct viewer_led {
    size_t side, index;
    double opened; /* when its world was: another world has rules of its own */
    skein_value position, line, enabled;
} viewer_led;

typedef struct viewer_hunt {
    viewer_led *led;
    size_t count, room;
} viewer_hunt;

/* All rules that can be led are, along the ray of the pointer. */
void viewer_hunt_lead(viewer_stage *stage);
/* They are again what they were. */
void viewer_hunt_rest(viewer_stage *stage);
/* The same, if the pointer leads this force. */
void viewer_hunt_leave(viewer_stage *stage, size_t side, size_t index);
void viewer_hunt_release(viewer_hunt *hunt);

#endif
