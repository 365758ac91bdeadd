/* What commands that take long share: a progress bar, interrupts, and stepping a frame with its faults told. */
#ifndef SKEIN_APP_PROGRESS_H
#define SKEIN_APP_PROGRESS_H

#include "app/command.h"

/* On a terminal a bar that is drawn again in place, 20 times a second at most; else ten lines in all. */
typedef struct app_progress {
    const char *what; /* "frame" */
    bool quiet, terminal;
    bool line_open; /* the cursor stands behind the bar */
    int frames;
    double start, last;
    char failure[APP_FAILURE_SIZE]; /* what app_step_frame() printed when it failed, or "" */
} app_progress;

app_progress app_progress_start(const char *what, int frames, bool quiet);
void app_progress_show(app_progress *p, int frame); /* so many are done */
void app_progress_end(app_progress *p);             /* before any other words */

/* From here on SIGINT and SIGTERM ask for an early end; a second one ends the process at once. */
void app_catch_interrupts(void);
/* Interrupts as that signal would; false where nobody listens. For handlers of signals. */
bool app_interrupt(int number);
int app_interrupted(void); /* the signal's number, or 0 */

/* Steps the world to its frame number `frame`, counted from 1; false after a printed fault: the step failed, or
 * the state blew up. */
bool app_step_frame(const app_scene *loaded, int frame, int steps, double dt, app_progress *p);

#endif
