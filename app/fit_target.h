/* What skein fit aims at: a point cache, matched to a body's particles and to the steps of a run. */
#ifndef SKEIN_APP_FIT_TARGET_H
#define SKEIN_APP_FIT_TARGET_H

#include "app/command.h"

typedef struct app_fit_target {
    uint32_t *particles; /* of which places are known, */
    size_t particle_count;
    size_t *steps; /* after how many steps, */
    size_t sample_count;
    double *places; /* three numbers for each particle at each of them, in metres, y up */
} app_fit_target;

/* Reads a PC2 file that has the points of a body (its name, or NULL where there is only one), up to a frame. Its axes
 * and its unit are those that --up and --scale say. False after a printed fault; freed in any case. */
bool app_fit_target_read(app_fit_target *target, const app_scene *loaded, const app_arguments *arguments);
void app_fit_target_free(app_fit_target *target);

#endif
