/* The clips of a run: for each body and each format of io/clip.h that is asked for, a file that grows, a sequence, or
 * the last frame. Used by app/outputs.c alone. */
#ifndef SKEIN_APP_CLIPS_H
#define SKEIN_APP_CLIPS_H

#include "app/command.h"
#include "app/outputs.h"

typedef struct app_clips app_clips;

/* What is written where: FOLDER/NAME.ENDING, by the bodies' names. All lives as long as the clips. */
typedef struct app_clips_plan {
    const app_scene *loaded;
    const io_export *exports;
    size_t export_count;
    const char *folder;
    char (*names)[APP_NAME_SIZE];
    size_t body_count;
} app_clips_plan;

/* Begins the files that grow. NULL after a fault, with `error`. */
app_clips *app_clips_begin(const app_clips_plan *plan, skein_error *error);
/* Adds the present state as a frame, 0 being the start. */
skein_status app_clips_frame(app_clips *clips, int frame, skein_error *error);
/* Writes the last frames, completes all and hands each file to `done`, with its status; frees. */
typedef void app_clips_done(void *user, const char *path, skein_status status, const skein_error *error);
void app_clips_finish(app_clips *clips, app_clips_done *done, void *user);
/* The same for a run that failed: what grew is kept as NAME.failed.ENDING, sequences as they are. Frees. */
void app_clips_keep(app_clips *clips, app_clips_done *done, void *user);
/* Removes all that was written; frees. NULL is allowed. */
void app_clips_abandon(app_clips *clips);

#endif
