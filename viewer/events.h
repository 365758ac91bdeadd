/* What happens in the window, as lines of text: for scripts, tests, and whoever wants to know.
 *
 *     pointer 320 180                     a line is a word and what belongs to it
 *     state paused=1 frame=12 ...
 *
 * All threads write; a line is written whole. `skein view --events FILE` asks for it. */
#ifndef SKEIN_VIEWER_EVENTS_H
#define SKEIN_VIEWER_EVENTS_H

#include <stdbool.h>
#include <stdio.h>

double viewer_seconds(void); /* of a clock that only goes on */

typedef struct viewer_events {
    FILE *file; /* NULL: nobody listens */
} viewer_events;

/* "-" is standard output; a NULL path is nobody. False (with errno) if the file cannot be written. */
bool viewer_events_open(viewer_events *events, const char *path);
void viewer_events_close(viewer_events *events);
void viewer_event(const viewer_events *events, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
