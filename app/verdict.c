/* The judgement of a run: its energy, stretch and speed at the end, against what they were as it went on. */
#include "app/verdict.h"

#include <math.h>
#include <stdio.h>

/* Energy may not have grown by more than this share of the kinetic energy that there was at the most, while as much of
 * what it grew by still moves: methods of the first order make some, and contact pushes things up. Elastic energy does
 * not tell: stiff springs that position methods have not yet solved hold much of it, for a while. Nor is the rounding
 * of potential energy, a difference of large numbers, any growth. */
static const double most_growth = 0.5, moving_share = 0.3, rounding = 1e-3;

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
    // what begins inside a collider is pushed out of it
    bool driven = start->max_penetration > 0 || skein_world_is_driven(loaded->world);
    app_verdict v = {.loaded = loaded,
                     .driven = driven,
                     .start_stretch = start->max_stretch,
                     .start_elastic = start->elastic_energy};
    app_verdict_note(&v, start);
    return v;
}

void app_verdict_note(app_verdict *v, const skein_statistics *now) {
    v->most_moving = fmax(v->most_moving, now->kinetic_energy);
    v->most_potential = fmax(v->most_potential, fabs(now->potential_energy));
}

/* A scene that begins with long edges may keep them. */
static bool is_torn(const app_verdict *v, const skein_statistics *end) {
    return end->max_stretch > v->loaded->settings.most_stretch && end->max_stretch > 1.01 * v->start_stretch;
}

static double growth_of(const app_verdict *v, const skein_statistics *end) {
    return -end->dissipated_energy - fmax(end->elastic_energy - v->start_elastic, 0);
}

static bool has_grown(const app_verdict *v, const skein_statistics *end) {
    double growth = growth_of(v, end);
    return !v->driven && growth > most_growth * v->most_moving && growth > rounding * v->most_potential &&
           end->kinetic_energy > moving_share * fmax(v->most_moving, growth);
}

bool app_verdict_end(app_verdict *v, const skein_statistics *end) {
    char remedy[200];
    app_verdict_note(v, end);
    v->words[0] = 0;
    app_remedy(v->loaded, remedy, sizeof remedy);
    if (is_torn(v, end))
        snprintf(
            v->words, sizeof v->words,
            "ended far beyond its bounds: an edge is stretched by %.0f %%, and the scene's most_stretch is %.0f %%; %s",
            100 * end->max_stretch, 100 * v->loaded->settings.most_stretch, remedy);
    else if (has_grown(v, end))
        snprintf(v->words, sizeof v->words,
                 "ended far beyond its bounds: its energy has grown by %.3g J, and nothing does work on it; %s",
                 growth_of(v, end), remedy);
    if (v->words[0]) fprintf(stderr, "skein: %s: %s\n", v->loaded->path, v->words);
    return !v->words[0];
}
