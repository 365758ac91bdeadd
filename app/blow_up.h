/* What a run leaves when it blows up: a small folder that does it again.
 *
 *   FOLDER/blow_up/           of --out FOLDER
 *       README.txt            what went first, and the command that does it again
 *       run.json, scene.json  as in a resume folder (app/keep.h), but for outputs
 *       frame-000112.snapshot the last good state that was kept
 *       before.snapshot       the state before the step in which it was lost */
#ifndef SKEIN_APP_BLOW_UP_H
#define SKEIN_APP_BLOW_UP_H

#include "app/outputs.h"
#include "app/report.h"

/* The newest good state, kept in memory. */
typedef struct app_good {
    void *bytes;
    size_t size, capacity;
    int frame;
} app_good;

/* Keeps the state as it stands, every so many frames. Where there is no memory the one before stays. */
void app_good_note(app_good *good, const app_report *report);
/* After a run that blew up: goes on from the good state until it does again, finds out what went first, and writes the
 * folder. Says where it is, or why it cannot be. Nothing where the state is finite. */
void app_blow_up_leave(app_good *good, app_report *report, const char *folder);
void app_good_free(app_good *good);

#endif
