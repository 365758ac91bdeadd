/* The judgement of a run, said. */
#include "app/verdict.h"

#include <math.h>
#include <stdio.h>

const char *app_remedy(const app_scene *loaded, char *text, size_t size) {
    skein_value substeps = skein_number(1);
    skein_get_path(loaded->world, "method.substeps", &substeps);
    double now = substeps.number[0], more = loaded->needed > now ? loaded->needed : 2 * now;
    if (isinf(loaded->needed))
        snprintf(text, size, "undamped springs grow under %s at any step: take another method", app_method(loaded));
    else
        snprintf(text, size, "set method.substeps to %.0f or more, or take less stiffness or another method",
                 fmin(more, 100000));
    return text;
}

app_verdict app_verdict_begin(app_scene *loaded, const skein_statistics *start) {
    return (app_verdict){.loaded = loaded,
                         .numbers = io_verdict_begin(loaded->world, loaded->settings.most_stretch, start)};
}

void app_verdict_note(app_verdict *v, const skein_statistics *now) {
    io_verdict_note(&v->numbers, now);
}

bool app_verdict_end(app_verdict *v, const skein_statistics *end) {
    char remedy[200];
    double growth;
    v->words[0] = 0;
    io_ending ending = io_verdict_end(&v->numbers, end, &growth);
    app_remedy(v->loaded, remedy, sizeof remedy);
    if (ending == IO_ENDED_TORN)
        snprintf(
            v->words, sizeof v->words,
            "ended far beyond its bounds: an edge is stretched by %.0f %%, and the scene's most_stretch is %.0f %%; %s",
            100 * end->max_stretch, 100 * v->loaded->settings.most_stretch, remedy);
    else if (ending == IO_ENDED_GROWN)
        snprintf(v->words, sizeof v->words,
                 "ended far beyond its bounds: its energy has grown by %.3g J, and nothing does work on it; %s", growth,
                 remedy);
    if (v->words[0]) fprintf(stderr, "skein: %s: %s\n", v->loaded->path, v->words);
    return !v->words[0];
}
