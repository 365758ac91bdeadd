/* What a run leaves behind: point caches and films that grow frame by frame, meshes and pictures at the end. */
#ifndef SKEIN_APP_OUTPUTS_H
#define SKEIN_APP_OUTPUTS_H

#include "app/command.h"

typedef struct app_outputs app_outputs;

enum { APP_NAME_SIZE = 128, APP_FOLDER_SIZE = 1024, APP_PATH_SIZE = APP_FOLDER_SIZE + APP_NAME_SIZE + 32 };

/* Whether what follows --out is one file, "a/cape.usda", and no folder: the format's name, or NULL. Its folder goes
 * into `folder`. */
const char *app_outputs_file(const char *out, char folder[APP_FOLDER_SIZE]);

/* `out` is a folder, or a file: then each body's file has its name, with the body's behind it where there are more than
 * one. Makes the folder, takes it for this run alone, and begins what grows with the run. Returns an exit status, after
 * a printed fault: EXIT_FAULT where the folder cannot be, or another run writes there. */
int app_outputs_begin(const app_scene *loaded, const char *out, bool quiet, app_outputs **begun);
/* Adds the world's present state as a frame, 0 being the start. False after a printed fault. */
bool app_outputs_frame(app_outputs *outputs, int frame);
/* Writes what comes last, gives all files their names and names each to `wrote`. False after a printed
 * fault. Frees `outputs` in any case. */
bool app_outputs_finish(app_outputs *outputs, void (*wrote)(void *user, const char *path), void *user);
/* The same for a run that failed: keeps the frames that were finished, under names that say so, NAME.failed.pc2 beside
 * what may stand under NAME.pc2, and names each to `wrote`. What only the end can show (a mesh, a picture) is not
 * written. Frees `outputs`. */
void app_outputs_keep(app_outputs *outputs, void (*wrote)(void *user, const char *path), void *user);
/* Why app_outputs_frame() failed last, or "". */
const char *app_outputs_failure(const app_outputs *outputs);
/* Leaves all as it was: no files, and no folders that were made for them. NULL is allowed. */
void app_outputs_abandon(app_outputs *outputs);
/* The same, but the folders stay: others are to write there. */
void app_outputs_leave(app_outputs *outputs);

#endif
