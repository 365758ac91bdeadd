/* Whether a run ended as one can, in words (io/verdict.h has the numbers).
 *
 * Noted while the run goes on and judged at its end. Called by run and render. */
#ifndef SKEIN_APP_VERDICT_H
#define SKEIN_APP_VERDICT_H

#include "app/command.h"
#include "io/verdict.h"

typedef struct app_verdict {
    const app_scene *loaded;
    io_verdict numbers;
    char words[400]; /* what is wrong with its end, with the remedy; or "" */
} app_verdict;

/* Before the first step. */
app_verdict app_verdict_begin(app_scene *loaded, const skein_statistics *start);
/* Now and then. */
void app_verdict_note(app_verdict *verdict, const skein_statistics *now);
/* Judges the end: false, after it said so, where the run is far beyond its bounds. */
bool app_verdict_end(app_verdict *verdict, const skein_statistics *end);

/* What could have kept a run of the scene from blowing up, in words. */
const char *app_remedy(const app_scene *loaded, char *text, size_t size);

#endif
