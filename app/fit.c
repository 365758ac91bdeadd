/* skein fit: numbers of a scene from a target. What searches is a module (fit/fit.h): it takes double precision. */
#include "fit/fit.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/fit_target.h"
#include "app/progress.h"
#include "io/module.h"

enum { MOST_FIELDS = 64, MOST_ITERATIONS = 1000000 };

/* All that a fit has. */
typedef struct fitting {
    app_scene loaded;
    app_fit_target target;
    char *words; /* of --vary, cut into pieces */
    fit_field fields[MOST_FIELDS];
    size_t field_count;
    int most_iterations;
    bool quiet, calm;
    double began; /* s */
} fitting;

/* ---- what varies ---- */

static double bound_of(char *text, double otherwise, bool *good) {
    char *end;
    if (!*text) return otherwise;
    double x = strtod(text, &end);
    *good &= end != text && !*end && isfinite(x);
    return x;
}

/* "bodies.0.stretch.stiffness" or "bodies.0.stretch.stiffness=10..1e4", with either bound, or both. */
static bool add_field(fitting *f, char *word) {
    char *equals = strchr(word, '='), *dots = equals ? strstr(equals, "..") : NULL;
    bool good = word[0] && word != equals && (!equals || dots);
    fit_field field = {word, -INFINITY, INFINITY};
    if (equals) *equals = 0;
    if (dots) {
        *dots = 0;
        field.least = bound_of(equals + 1, -INFINITY, &good);
        field.most = bound_of(dots + 2, INFINITY, &good);
        good &= field.least < field.most;
    }
    for (size_t i = 0; i < f->field_count && good; i++)
        if (!strcmp(f->fields[i].path, word)) {
            fprintf(stderr, "skein fit: --vary %s: it is named twice\n", word);
            return false;
        }
    if (good && f->field_count < MOST_FIELDS) {
        f->fields[f->field_count++] = field;
        return true;
    }
    if (good) fprintf(stderr, "skein fit: --vary: there are more than %d fields\n", MOST_FIELDS);
    else
        fprintf(stderr,
                "skein fit: --vary %s%s: expected a field, bodies.0.stretch.stiffness say, with bounds or without: "
                "bodies.0.stretch.stiffness=10..1e4\n",
                word, equals && !dots ? "=..." : "");
    return false;
}

static bool read_fields(fitting *f, const app_arguments *arguments) {
    const char *const *given = app_values(arguments, "--vary");
    size_t length = 1;
    for (size_t i = 0; given && given[i]; i++) length += strlen(given[i]) + 1;
    if (!given) {
        fprintf(stderr, "skein fit: which fields are to be found? --vary bodies.0.stretch.stiffness,...\n");
        return false;
    }
    if (!(f->words = calloc(length, 1))) return false;
    char *at = f->words;
    for (size_t i = 0; given[i]; i++) {
        memcpy(at, given[i], strlen(given[i]) + 1);
        for (char *word = at, *next; word; word = next) {
            if ((next = strchr(word, ','))) *next++ = 0;
            if (!add_field(f, word)) return false;
        }
        at += strlen(given[i]) + 1;
    }
    return true;
}

/* ---- meanwhile ---- */

static bool go_on(void *user, const fit_state *state) {
    const fitting *f = user;
    if (!f->calm && state->moved) {
        fprintf(stderr, "iteration %d of %d at most, %d runs, %.1f s: misfit %.4g m;", state->iterations,
                f->most_iterations, state->evaluations, app_seconds() - f->began, state->misfit);
        for (size_t i = 0; i < state->count; i++) fprintf(stderr, " %.5g", state->numbers[i].found);
        fprintf(stderr, "\n");
    }
    return !app_interrupted();
}

/* ---- the end ---- */

static const char *const ends[] = {"converged", "iterations", "stuck", "interrupted"};

static json_t *number(double x) {
    return isfinite(x) ? json_real(x) : json_null();
}

/* {"bodies.0.stretch.stiffness": 100.1, "forces.0.acceleration": [0, -9.8, 0]} */
static json_t *numbers_of(const fitting *f, const fit_outcome *o, bool found) {
    json_t *all = json_object();
    for (size_t i = 0, end; i < o->count; i = end) {
        const char *path = f->fields[o->numbers[i].field].path;
        for (end = i + 1; end < o->count && o->numbers[end].component; end++) continue;
        json_t *list = json_array();
        for (size_t k = i; k < end; k++)
            json_array_append_new(list, number(found ? o->numbers[k].found : o->numbers[k].began));
        json_object_set(all, path, end - i > 1 ? list : json_array_get(list, 0));
        json_decref(list);
    }
    return all;
}

static json_t *report(const fitting *f, const fit_outcome *o, const app_arguments *arguments) {
    json_t *line = json_array();
    json_array_append_new(line, json_string("fit"));
    for (int i = 0; i < arguments->argc; i++) json_array_append_new(line, json_string(arguments->argv[i]));
    json_t *all = json_object();
    const struct {
        const char *key;
        json_t *value;
    } members[] = {{"skein", json_string(SKEIN_VERSION)},
                   {"commit", json_string(app_commit)},
                   {"command_line", line},
                   {"scene", json_string(f->loaded.path)},
                   {"method", json_string(app_method(&f->loaded))},
                   {"precision", json_string("double")},
                   {"target", json_string(app_value(arguments, "--target"))},
                   {"samples", json_integer((json_int_t)f->target.sample_count)},
                   {"points", json_integer((json_int_t)f->target.particle_count)},
                   {"steps", json_integer((json_int_t)f->target.steps[f->target.sample_count - 1])},
                   {"began", numbers_of(f, o, false)},
                   {"found", numbers_of(f, o, true)},
                   {"iterations", json_integer(o->iterations)},
                   {"runs", json_integer(o->evaluations)},
                   {"began_misfit", number(o->began)},
                   {"misfit", number(o->misfit)},
                   {"end", json_string(ends[o->end])},
                   {"seconds", number(app_seconds() - f->began)}};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        json_object_set_new(all, members[i].key, members[i].value);
    return all;
}

static void print(const fitting *f, const fit_outcome *o) {
    static const char *const words[] = {"found", "not there yet: more --iterations go on",
                                        "as near as the search comes", "interrupted"};
    printf("%s: misfit %.4g m, at first %.4g m, after %d iteration%s and %d runs in %.1f s\n", words[o->end], o->misfit,
           o->began, o->iterations, o->iterations == 1 ? "" : "s", o->evaluations, app_seconds() - f->began);
    for (size_t i = 0; i < o->count; i++) {
        const fit_number *n = &o->numbers[i];
        const char *path = f->fields[n->field].path;
        bool many = n->component || (i + 1 < o->count && o->numbers[i + 1].component);
        printf("  %s%s = %.8g, began as %.8g\n", path,
               !many ? "" : (const char *const[]){" x", " y", " z"}[n->component], n->found, n->began);
    }
}

/* The scene again, with what was found in it. */
static bool write_scene(const fitting *f, const fit_outcome *o, const app_arguments *arguments, const char *path) {
    json_t *found = numbers_of(f, o, true);
    const char *const *given = app_values(arguments, "--set"), *name;
    size_t count = 0, most = 0;
    while (given && given[most]) most++;
    const char **sets = calloc(most + json_object_size(found) + 1, sizeof *sets);
    char **own = calloc(json_object_size(found) + 1, sizeof *own);
    json_t *value;
    bool good = sets && own;
    for (size_t i = 0; i < most && good; i++) sets[count++] = given[i];
    size_t first = count;
    json_object_foreach(found, name, value) {
        char *json = good ? json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(17)) : NULL;
        json_t *set = json ? json_sprintf("%s=%s", name, json) : NULL;
        good = good && set && (own[count - first] = strdup(json_string_value(set)));
        if (good) sets[count] = own[count - first], count++;
        json_decref(set);
        free(json);
    }
    app_scene again = {.quiet = true};
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    bool written = good && !app_load(app_word(arguments), sets, &again) && !io_scene_write(again.scene, path, &error);
    if (!written && (!good || again.scene)) app_print_error(&error);
    app_unload(&again);
    for (size_t i = 0; own && own[i]; i++) free(own[i]);
    free(own), free(sets);
    json_decref(found);
    return written;
}

static int conclude(const fitting *f, const fit_outcome *o, const app_arguments *arguments) {
    const char *out = app_value(arguments, "--out");
    bool json = app_given(arguments, "--json");
    if (out && !write_scene(f, o, arguments, out)) return EXIT_FAILURE_RUN;
    if (json) {
        json_t *document = report(f, o, arguments);
        if (!json_dumpf(document, stdout, JSON_INDENT(2))) printf("\n");
        json_decref(document);
    } else if (!f->quiet) {
        print(f, o);
        if (out) printf("wrote %s\n", out);
    }
    return o->end == FIT_STOPPED      ? EXIT_SIGNAL + app_interrupted()
           : o->end == FIT_ITERATIONS ? EXIT_FAILURE_RUN
                                      : EXIT_OK;
}

/* ---- the search ---- */

/* The scene for the module: what it is about, without what is written and shown of it. */
static char *text_of(const app_scene *loaded) {
    char *whole = io_scene_text_anywhere(loaded->scene), *text = NULL;
    json_t *document = whole ? json_loads(whole, 0, NULL) : NULL;
    json_object_del(document, "view");
    json_object_del(document, "output");
    if (document) text = json_dumps(document, JSON_REAL_PRECISION(17));
    json_decref(document);
    free(whole);
    return text;
}

static int run_fit(fitting *f, const app_arguments *arguments) {
    double dt;
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    const fit_content *fit = io_module_load("fit", &error);
    if (!fit) {
        fprintf(
            stderr,
            "skein fit: it takes a module that this skein was built without: 'tools/setup build' installs what it takes "
            "(liblbfgs), and 'make' builds it (%s: %s)\n",
            error.where, error.message);
        return EXIT_FAILURE_RUN;
    }
    char *text = text_of(&f->loaded);
    io_scene_steps_per_frame(&f->loaded.settings, &dt);
    const app_fit_target *t = &f->target;
    fit_request request = {text,      f->loaded.path,  dt,        t->particles,   t->particle_count,  t->steps,
                           t->places, t->sample_count, f->fields, f->field_count, f->most_iterations, go_on,
                           f};
    fit_outcome outcome = {0};
    app_catch_interrupts();
    f->began = app_seconds();
    int status = EXIT_FAULT;
    if (text && fit->run(&request, &outcome, &error)) status = conclude(f, &outcome, arguments);
    else app_print_error(&error);
    fit->release(&outcome);
    free(text);
    return status;
}

static int fit(app_arguments *arguments) {
    fitting f = {.quiet = app_given(arguments, "--quiet"), .most_iterations = 50};
    app_override_texts texts;
    f.calm = f.quiet || app_given(arguments, "--no-progress");
    f.loaded.quiet = f.quiet;
    const char *most = app_value(arguments, "--iterations");
    char *end = NULL;
    long count = most ? strtol(most, &end, 10) : f.most_iterations;
    if (most && (end == most || *end || count < 1 || count > MOST_ITERATIONS)) {
        fprintf(stderr, "skein fit: --iterations %s: expected a whole number, 1 to %d\n", most, MOST_ITERATIONS);
        return EXIT_FAULT;
    }
    f.most_iterations = (int)count;
    int status = EXIT_FAULT;
    if (read_fields(&f, arguments) && app_override(arguments, texts)) {
        status = app_load(app_word(arguments), app_values(arguments, "--set"), &f.loaded);
        if (!status && !app_fit_target_read(&f.target, &f.loaded, arguments)) status = EXIT_FAULT;
        if (!status) status = run_fit(&f, arguments);
        app_fit_target_free(&f.target);
        app_unload(&f.loaded);
    }
    free(f.words);
    return status;
}

static const app_option options[] = {
    {"--target", "CACHE.pc2", "where the body's vertices (or particles) ought to be: a point cache", false,
     APP_TAKES_FILE},
    {"--vary", "PATH[=LEAST..MOST],...", "fields to find, with bounds if they are to have some; may be repeated", true,
     APP_TAKES_ANY},
    {"--body", "NAME", "the body that the target shows, where there are several", false, APP_TAKES_ANY},
    {"--iterations", "N", "of L-BFGS, at most; 50 if not given", false, APP_TAKES_ANY},
    {"--out", "FOUND.json", "write the scene with what was found", false, APP_TAKES_FILE},
    {"--json", NULL, "print the report as JSON", false, APP_TAKES_ANY},
    {"--up", "y|z", "the axis that points up in the target; y if not given", false, APP_TAKES_ANY},
    {"--scale", "S", "length of a metre in it: 100 for centimetres; 1 if not given", false, APP_TAKES_ANY},
    {"--frames", "N", "match the target up to this frame, instead of the scene's last", false, APP_TAKES_ANY},
    {"--fps", "F", "frames a second, instead of the scene's: those of the target", false, APP_TAKES_ANY},
    APP_SET_OPTION,
    APP_THREADS_OPTION,
    APP_BOUNDS_OPTIONS,
    APP_NO_PROGRESS_OPTION,
    APP_QUIET_OPTION,
    APP_END_OF_OPTIONS};

const app_command app_fit_command = {
    "fit",
    "SCENE --target CACHE.pc2 --vary PATH[=LEAST..MOST],... [options]",
    "find stiffness, damping, gravity, wind or drag with which a scene moves like a point cache\n\n"
    "  skein fit scenes/hanging.json --target measured.pc2 --vary bodies.0.stretch.stiffness,bodies.0.bend.rigidity\n\n"
    "Begins with the scene's own numbers, and makes the mean squared distance from the cache, over all of its frames, as\n"
    "small as it can, by L-BFGS on the gradient of the run; each run with its gradient costs some four runs. Numbers that\n"
    "cannot be negative vary in their logarithm: a start within a factor of ten is near enough as a rule. Runs are in\n"
    "double precision. Collisions, contact, limits and tethers have no gradient yet\n"
    "(docs/gradients.md): those are refused, with what stands in the way.\n\n"
    "The report (--json) has found, iterations, misfit (m, the root of the mean squared distance) and end: converged,\n"
    "iterations (more would go on), stuck (no step gets nearer: as near as numbers allow) or interrupted.\n\n"
    "Exit status 0: found; 1: the iterations did not do, or a file could not be written; 2: a fault in the scene, the\n"
    "target or the arguments; 130: interrupted, with the best so far.",
    options,
    "scene",
    false,
    APP_TAKES_SCENE,
    fit,
    NULL,
};
