/* What went first when a state was not finite any more. Called by stage.c. */
#ifndef SKEIN_VIEWER_BLOW_UP_H
#define SKEIN_VIEWER_BLOW_UP_H

#include "viewer/player.h"

/* Whether every place is finite, and in reach of a picture. */
bool viewer_is_finite(const skein_world *world);
/* Goes back to the last frame that was finite and steps on from there until it is not: `words` say which particle of which
 * body that was, and which spring was stretched most before. Then the player stands at that frame. False where no such
 * frame is kept; then `words` say only that. */
bool viewer_explain_blow_up(viewer_player *player, char *words, size_t size);

#endif
