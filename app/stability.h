/* Stable substeps in words, for `skein stability` and `skein check`. */
#ifndef SKEIN_APP_STABILITY_H
#define SKEIN_APP_STABILITY_H

#include "app/command.h"

/* Warns where the scene's own substep is larger than its method can take. False after a printed fault. */
bool app_warn_of_instability(app_scene *loaded);
/* Warns where a position method's substep is so short that what forces do in it gets lost in rounding. */
void app_warn_of_rounding(app_scene *loaded);

#endif
