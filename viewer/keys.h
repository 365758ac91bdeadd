/* The keys: one table says what each does, when it applies and how it is taught.
 *
 * The stage hands every key here; F1 and `skein view --help` print the same table. */
#ifndef SKEIN_VIEWER_KEYS_H
#define SKEIN_VIEWER_KEYS_H

#include "viewer/stage.h"

/* A key goes down, or repeats; false if it has no meaning now. */
bool viewer_key_down(viewer_stage *stage, int code, int mods);
void viewer_key_up(viewer_stage *stage, int code);
/* The key's name and what it does, `index` from 0; NULL past the end. */
const char *viewer_key_help(size_t index, const char **name);

#endif
