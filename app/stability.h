/* Stable substeps in words, for `skein stability` and `skein check`. */
#ifndef SKEIN_APP_STABILITY_H
#define SKEIN_APP_STABILITY_H

#include "app/command.h"

/* Warns where the scene's own substep is larger than its method can take. False after a printed fault. */
bool app_warn_of_instability(app_scene *loaded);

#endif
