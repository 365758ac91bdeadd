/* Lines about what happens; see events.h. */
#include "viewer/events.h"

#include <stdarg.h>
#include <string.h>
#include <time.h>

double viewer_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

bool viewer_events_open(viewer_events *events, const char *path) {
    events->file = !path ? NULL : !strcmp(path, "-") ? stdout : fopen(path, "w");
    if (!path) return true;
    if (events->file) setvbuf(events->file, NULL, _IOLBF, 0);
    return events->file != NULL;
}

void viewer_events_close(viewer_events *events) {
    if (events->file && events->file != stdout) fclose(events->file);
    events->file = NULL;
}

void viewer_event(const viewer_events *events, const char *format, ...) {
    if (!events->file) return;
    char line[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line - 1, format, arguments);
    va_end(arguments);
    strcat(line, "\n");
    fputs(line, events->file); // one call: a line stays whole
}
