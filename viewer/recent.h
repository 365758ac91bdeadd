/* The scenes that were opened last, kept between sittings in the user's folder for such state: XDG_STATE_HOME, or
 * ~/.local/state. Called by the stage. */
#ifndef SKEIN_VIEWER_RECENT_H
#define SKEIN_VIEWER_RECENT_H

#include "viewer/exchange.h"

typedef struct viewer_recent {
    char path[VIEWER_RECENTS][VIEWER_TEXT]; /* absolute; the newest first */
    size_t count;
} viewer_recent;

/* Reads the list; those that are gone are left out. Nothing is said where there is no list yet. */
void viewer_recent_read(viewer_recent *recent);
/* Puts a scene in front, and writes the list. False, with words, where that cannot be written. */
bool viewer_recent_add(viewer_recent *recent, const char *path, skein_error *error);

#endif
