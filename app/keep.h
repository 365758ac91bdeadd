/* What a run leaves for `skein run --resume`: the scene as it runs, a journal of its frames and log lines, and now and
 * then a snapshot with what the report knows by then.
 *
 *   FOLDER/resume/            of --out FOLDER; of --out clip.mdd it is clip.mdd.resume/
 *       run.json              how it was called
 *       scene.json            the scene with all changes, the paths of its meshes absolute
 *       frames.journal        positions and velocities of each frame, and the lines of the log
 *       frame-000120.snapshot the two newest
 *
 * Resumed, the frames before the snapshot go through the same writers as they did, and so all outputs are those of a
 * run that was never broken; then the world goes on from the snapshot. */
#ifndef SKEIN_APP_KEEP_H
#define SKEIN_APP_KEEP_H

#include "app/outputs.h"
#include "app/report.h"

typedef struct app_keep app_keep;

/* Begins a run's resume folder, and forgets what an earlier run left in it. `every`: frames from one snapshot to the
 * next. NULL after a printed fault. */
app_keep *app_keep_begin(app_report *report, const char *out, int every);
/* Notes the frame that stands, 0 being the start, and takes a snapshot where one is due, or `now`. False after a
 * printed fault. */
bool app_keep_frame(app_keep *keep, app_report *report, bool now);
/* Notes the last line of the log. */
bool app_keep_line(app_keep *keep, const char *line);
const char *app_keep_failure(const app_keep *keep);
/* At the end: of a run that is complete the parts of files that killed runs before it left go. NULL is allowed. */
void app_keep_end(app_keep *keep, bool complete);

/* What a folder says of the run that is to go on. */
typedef struct app_kept {
    char folder[APP_FOLDER_SIZE];                                        /* where run.json stands */
    char out[APP_FOLDER_SIZE], log[APP_PATH_SIZE], scene[APP_PATH_SIZE]; /* "" where there is none */
    char up[8], scale[40], device[16];                                   /* as they were given, or "" */
    int every;
    json_t *run; /* the document */
} app_kept;

/* Reads run.json. An exit status, after a printed fault. */
int app_kept_read(const char *folder, app_kept *kept);
void app_kept_free(app_kept *kept);
/* Brings a world that was just loaded to the newest snapshot that is whole, and shows `outputs` (or NULL) and the log
 * each frame before it. Then goes on with the journal. Where there is no snapshot yet the run begins anew. False after
 * a printed fault. */
bool app_kept_go_on(const app_kept *kept, app_report *report, app_outputs *outputs, app_keep **keep);

#endif
