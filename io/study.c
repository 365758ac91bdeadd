/* Reading a study: what is varied, what is measured, and the scene that all of it begins from (docs/studies.md).
 *
 * Faults are told like a scene's, with their places: "vary.forces.0.alignment". */
#include "io/study.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/study_inside.h"

static const char *const members[] = {"study",  "name", "description", "scene", "set", "vary",
                                      "repeat", "seed", "measure",     "plot",  NULL};

/* ---- members ---- */

/* Reports members of an object that nobody reads. */
static void check_members(io_place place, const json_t *object, const char *const *known) {
    const char *name;
    json_t *value;
    size_t count = 0;
    char hint[IO_HINT_SIZE];
    while (known[count]) count++;
    json_object_foreach((json_t *)(uintptr_t)object, name, value) {
        size_t k = 0;
        while (k < count && strcmp(known[k], name)) k++;
        if (k == count)
            io_fault(place, name, SKEIN_ERROR_NAME, "there is no member '%s'%s", name,
                     io_hint(name, known, count, hint));
    }
}

/* A number between two bounds, or `otherwise` where the member is not there. */
static double number_in(io_place place, const json_t *object, const char *name, double least, double most, bool whole,
                        double otherwise) {
    const json_t *value = json_object_get(object, name);
    char words[IO_JSON_WORDS_SIZE];
    if (!value) return otherwise;
    double x = json_number_value(value);
    if (json_is_number(value) && x >= least && x <= most && (!whole || x == floor(x))) return x;
    io_fault(place, name, SKEIN_ERROR_VALUE, "expected a %snumber, %.9g to %.9g%s", whole ? "whole " : "", least, most,
             io_json_instead(value, words));
    return otherwise;
}

/* ---- what is varied ---- */

/* To twelve digits, so that ends and steps of a range are what people would write; whole numbers as such. */
static json_t *rounded(double x) {
    char text[32];
    snprintf(text, sizeof text, "%.12g", x);
    x = strtod(text, NULL);
    return x == floor(x) && fabs(x) < 1e15 ? json_integer((json_int_t)x) : json_real(x);
}

static bool is_log(io_place place, const json_t *object, const char *name, double from, double to) {
    const json_t *scale = json_object_get(object, "scale");
    char words[IO_JSON_WORDS_SIZE];
    if (!scale) return false;
    const char *word = json_string_value(scale);
    bool log_scale = word && !strcmp(word, "log");
    if (!log_scale && (!word || strcmp(word, "linear") != 0))
        io_fault(place, name, SKEIN_ERROR_VALUE, "scale: expected \"linear\" or \"log\"%s",
                 io_json_instead(scale, words));
    if (!log_scale || (from > 0 && to > 0)) return log_scale;
    io_fault(place, name, SKEIN_ERROR_VALUE, "a range on a logarithmic scale has ends over 0, not %.9g and %.9g", from,
             to);
    return false;
}

/* The values of {"from": 0, "to": 3, "count": 7} or {"from": 0, "to": 3, "step": 0.5}. */
static json_t *read_range(io_place place, const char *name, const json_t *range) {
    static const char *const known[] = {"from", "to", "count", "step", "scale", NULL};
    const json_t *from = json_object_get(range, "from"), *to = json_object_get(range, "to"),
                 *count = json_object_get(range, "count"), *step = json_object_get(range, "step");
    double a = json_number_value(from), b = json_number_value(to), n = json_number_value(count);
    json_t *values = json_array();
    char inside[300];
    snprintf(inside, sizeof inside, "vary.%.250s", name);
    check_members((io_place){place.file, inside, place.faults}, range, known);
    if (!json_is_number(from) || !json_is_number(to) || !count == !step) {
        io_fault(
            place, name, SKEIN_ERROR_VALUE,
            "expected a range { \"from\": 0, \"to\": 3, \"count\": 7 }, or with \"step\" in the place of \"count\"");
        return values;
    }
    bool by_ratio = is_log(place, range, name, a, b);
    if (step) {
        double s = json_number_value(step);
        if (!json_is_number(step) || !(s * (b - a) > 0) || by_ratio)
            io_fault(place, name, SKEIN_ERROR_VALUE, "step: expected a number that leads from %.9g to %.9g%s", a, b,
                     by_ratio ? ", on a linear scale" : "");
        else n = floor((b - a) / s * (1 + 1e-9) + 1e-9) + 1, b = a + (n - 1) * s;
    } else if (!json_is_integer(count) || n < 1)
        io_fault(place, name, SKEIN_ERROR_VALUE, "count: expected a whole number, 1 or more");
    if (n > IO_STUDY_MOST_ROWS) {
        io_fault(place, name, SKEIN_ERROR_LIMIT, "%.9g values are more than the %d rows that a study may have", n,
                 IO_STUDY_MOST_ROWS);
        return values;
    }
    for (double i = 0; i < n; i++) {
        double share = n > 1 ? i / (n - 1) : 0;
        json_array_append_new(values, rounded(by_ratio ? a * pow(b / a, share) : a + (b - a) * share));
    }
    return values;
}

/* {"random": [0, 3], "scale": "log", "whole": true} */
static void read_random(io_place place, study_varied *v, const json_t *spec) {
    static const char *const known[] = {"random", "scale", "whole", NULL};
    const json_t *ends = json_object_get(spec, "random"), *whole = json_object_get(spec, "whole");
    char inside[300];
    snprintf(inside, sizeof inside, "vary.%.250s", v->path);
    check_members((io_place){place.file, inside, place.faults}, spec, known);
    v->is_random = true;
    v->from = json_number_value(json_array_get(ends, 0)), v->to = json_number_value(json_array_get(ends, 1));
    v->whole = json_is_true(whole);
    if (json_array_size(ends) != 2 || !json_is_number(json_array_get(ends, 0)) ||
        !json_is_number(json_array_get(ends, 1)) || !(v->from <= v->to))
        io_fault(place, v->path, SKEIN_ERROR_VALUE, "random: expected the least and the most, [0, 3]");
    if (whole && !json_is_boolean(whole)) io_fault(place, v->path, SKEIN_ERROR_VALUE, "whole: expected true or false");
    v->by_ratio = is_log(place, spec, v->path, v->from, v->to);
    if (v->whole && (v->by_ratio || v->from != floor(v->from) || v->to != floor(v->to)))
        io_fault(place, v->path, SKEIN_ERROR_VALUE, "whole numbers are drawn between whole numbers, on a linear scale");
}

static void read_varied(io_study *study, io_place top, const json_t *vary) {
    io_place place = {top.file, "vary", top.faults};
    const char *path;
    json_t *spec;
    char words[IO_JSON_WORDS_SIZE];
    if (!json_is_object(vary) || !json_object_size(vary)) {
        io_fault(top, "vary", SKEIN_ERROR_VALUE,
                 "expected fields and their values, { \"forces.0.alignment\": [1, 2] }%s", io_json_instead(vary, words));
        return;
    }
    json_object_foreach((json_t *)(uintptr_t)vary, path, spec) {
        if (study->varied_count == IO_STUDY_MOST_VARIED) {
            io_fault(place, path, SKEIN_ERROR_LIMIT, "a study varies %d fields at most", IO_STUDY_MOST_VARIED);
            return;
        }
        study_varied *v = &study->varied[study->varied_count++];
        v->path = path; // of the document, which stays
        if (!path[0] || strpbrk(path, "=\n,\""))
            io_fault(place, path, SKEIN_ERROR_NAME, "expected the path of a field, as --set has it");
        if (json_is_array(spec)) v->values = json_incref(spec);
        else if (json_is_object(spec) && json_object_get(spec, "random")) read_random(place, v, spec);
        else if (json_is_object(spec)) v->values = read_range(place, path, spec);
        else
            io_fault(place, path, SKEIN_ERROR_VALUE, "expected a list, a range or { \"random\": [least, most] }%s",
                     io_json_instead(spec, words));
        if (v->values && json_array_size(v->values) == 0)
            io_fault(place, path, SKEIN_ERROR_VALUE, "a list without values leaves no rows");
    }
}

static void count_rows(io_study *study, io_place top, const json_t *root) {
    study->repeat = (size_t)number_in(top, root, "repeat", 1, IO_STUDY_MOST_ROWS, true, 1);
    double rows = (double)study->repeat;
    bool chance = false;
    for (size_t v = 0; v < study->varied_count; v++)
        if (study->varied[v].values) rows *= (double)json_array_size(study->varied[v].values);
        else chance = true;
    if (rows > IO_STUDY_MOST_ROWS)
        io_fault(top, "vary", SKEIN_ERROR_LIMIT, "%.9g rows: a study has %d at most", rows, IO_STUDY_MOST_ROWS);
    if (study->repeat > 1 && !chance)
        io_fault(top, "repeat", SKEIN_ERROR_VALUE,
                 "rows would come out alike, to the bit: vary something at random, a body's seed say: "
                 "{ \"bodies.0.seed\": { \"random\": [1, 1000000], \"whole\": true } }");
    study->rows = (size_t)rows;
}

/* ---- what is measured ---- */

static const char *text_in(io_place place, const json_t *object, const char *name) {
    const json_t *value = json_object_get(object, name);
    char words[IO_JSON_WORDS_SIZE];
    if (!value || json_is_string(value)) return json_string_value(value);
    io_fault(place, name, SKEIN_ERROR_VALUE, "expected a text%s", io_json_instead(value, words));
    return NULL;
}

static void read_measure(io_study *study, io_place top, size_t index, const json_t *spec) {
    static const char *const known[] = {"measure", "body", "over", "from", "every", "name", NULL};
    static const char *const overs[] = {"end", "mean", "least", "most"};
    char path[32], hint[IO_HINT_SIZE], name[400];
    snprintf(path, sizeof path, "measure.%zu", index);
    io_place place = {top.file, path, top.faults};
    io_study_wanted *w = &study->wanted[study->wanted_count++];
    if (json_is_object(spec)) check_members(place, spec, known);
    const char *what = json_is_string(spec) ? json_string_value(spec) : text_in(place, spec, "measure");
    const char *body = text_in(place, spec, "body"), *over = text_in(place, spec, "over"),
               *given = text_in(place, spec, "name");
    while (over && (size_t)w->over < COUNT_OF(overs) && strcmp(overs[w->over], over) != 0) w->over++;
    if ((size_t)w->over == COUNT_OF(overs)) {
        io_fault(place, "over", SKEIN_ERROR_VALUE, "expected \"end\", \"mean\", \"least\" or \"most\", not \"%s\"",
                 over);
        w->over = IO_STUDY_END;
    }
    w->every = (int)number_in(place, spec, "every", 1, 1e6, true, 1);
    w->from = number_in(place, spec, "from", 0, 1e9, false, 0);
    w->what = what ? io_study_quantity_find(what, hint) : NULL;
    if (!what) io_fault(place, "", SKEIN_ERROR_VALUE, "expected the name of a measure, or { \"measure\": NAME }");
    else if (!w->what)
        io_fault(place, "", SKEIN_ERROR_NAME, "there is no measure '%s'%s; docs/studies.md lists all", what, hint);
    else if (body && !io_study_quantity_of_body(w->what))
        io_fault(place, "body", SKEIN_ERROR_VALUE, "%s is of the whole world, not of a body", what);
    snprintf(name, sizeof name, "%s%s%.150s%s%s", body ? body : "", body ? "." : "", what ? what : "?",
             w->over ? "_" : "", w->over ? overs[w->over] : "");
    w->name = strdup(given ? given : name);
    w->body = body ? strdup(body) : NULL;
    study->good &= w->name && (!body || w->body);
}

static void read_measures(io_study *study, io_place top, const json_t *list) {
    size_t index;
    json_t *spec;
    if (!json_array_size(list))
        io_fault(top, "measure", SKEIN_ERROR_VALUE, "expected a list of what is to be kept, [\"kinetic_energy\"]");
    if (json_array_size(list) > IO_STUDY_MOST_MEASURES) {
        io_fault(top, "measure", SKEIN_ERROR_LIMIT, "a study measures %d things at most", IO_STUDY_MOST_MEASURES);
        return;
    }
    json_array_foreach((json_t *)(uintptr_t)list, index, spec) read_measure(study, top, index, spec);
}

/* Every column has a name of its own. */
static void check_columns(const io_study *study, io_place top) {
    for (size_t m = 0; m < study->wanted_count; m++) {
        const char *name = study->wanted[m].name;
        bool taken = false;
        for (size_t k = 0; k < m; k++) taken |= !strcmp(name, study->wanted[k].name);
        for (size_t v = 0; v < study->varied_count; v++) taken |= !strcmp(name, study->varied[v].path);
        for (size_t c = 0; io_study_column_at(c); c++) taken |= !strcmp(name, io_study_column_at(c));
        if (!name[0] || strpbrk(name, "\n\"/,") || taken)
            io_fault(top, "measure", SKEIN_ERROR_NAME, "the column '%s' %s: give one a \"name\"", name,
                     taken ? "is there twice" : "has no name, or one with a comma, a quote or a slash");
    }
}

static void check_plot(io_study *study, io_place top) {
    static const char *const known[] = {"x", "y", "show", "title", "labels", NULL};
    const json_t *plot = study->plot = json_object_get(study->root, "plot");
    io_place place = {top.file, "plot", top.faults};
    if (!plot) return;
    if (!json_is_object(plot)) {
        io_fault(top, "plot", SKEIN_ERROR_VALUE,
                 "expected an object, { \"x\": PATH, \"y\": PATH, \"show\": [MEASURE] }");
        return;
    }
    check_members(place, plot, known);
    for (int k = 0; k < 2; k++) {
        const char *axis = text_in(place, plot, known[k]);
        size_t v = 0;
        while (axis && v < study->varied_count && strcmp(axis, study->varied[v].path) != 0) v++;
        if (axis && v == study->varied_count) io_fault(place, known[k], SKEIN_ERROR_NAME, "'%s' is not varied", axis);
    }
    const json_t *show = json_object_get(plot, "show"), *labels = json_object_get(plot, "labels");
    for (size_t i = 0; i < json_array_size(show); i++) {
        const char *name = json_string_value(json_array_get(show, i));
        size_t m = 0;
        while (name && m < study->wanted_count && strcmp(name, study->wanted[m].name) != 0) m++;
        if (!name || m == study->wanted_count)
            io_fault(place, "show", SKEIN_ERROR_NAME, "'%s' is not measured", name ? name : "?");
    }
    if ((show && !json_is_array(show)) || (labels && !json_is_object(labels)))
        io_fault(place, "", SKEIN_ERROR_VALUE, "expected a list to \"show\", and \"labels\" as { COLUMN: TEXT }");
    text_in(place, plot, "title");
}

/* ---- the scene ---- */

/* The study's own changes to its scene, as sets; to be freed with free_sets(). */
static char **read_sets(io_place top, const json_t *set) {
    const char *path;
    json_t *value;
    size_t count = 0;
    char **sets = calloc(json_object_size(set) + 2, sizeof *sets), words[IO_JSON_WORDS_SIZE];
    if (set && !json_is_object(set))
        io_fault(top, "set", SKEIN_ERROR_VALUE, "expected fields and their values, { \"frames\": 600 }%s",
                 io_json_instead(set, words));
    if (sets) sets[count++] = strdup("output=[]"); // a study has its own
    json_object_foreach((json_t *)(uintptr_t)set, path, value) if (sets) sets[count++] = study_set_text(path, value);
    return sets;
}

void study_free_sets(char **sets) {
    for (size_t i = 0; sets && sets[i]; i++) free(sets[i]);
    free(sets);
}

static io_scene *open_scene(io_study *study, io_place top, const json_t *scene, const char *const *sets) {
    char path[IO_PLACE_SIZE];
    io_scene *opened = NULL;
    if (json_is_object(scene)) {
        char *text = json_dumps(scene, JSON_REAL_PRECISION(17));
        if (text) opened = io_scene_read_text(text, strlen(text), top.file, sets, study->exporters, top.faults);
        free(text);
        return opened;
    }
    const char *word = json_string_value(scene);
    if (!word || !word[0]) {
        char words[IO_JSON_WORDS_SIZE];
        io_fault(top, "scene", SKEIN_ERROR_VALUE, "expected a scene's name, its file's path from here, or a scene%s",
                 io_json_instead(scene, words));
        return NULL;
    }
    char *beside = io_path_beside(top.file, word);
    FILE *there = beside ? fopen(beside, "rb") : NULL;
    if (there) fclose(there);
    if (there) opened = io_scene_read(beside, sets, study->exporters, top.faults);
    else if (io_scene_find(word, path)) opened = io_scene_read(path, sets, study->exporters, top.faults);
    else io_scene_not_found(word, top.faults);
    free(beside);
    return opened;
}

/* The scene as its rows begin from it, the paths of its files from the root on; and a first row, which shows the faults
 * that only building finds. */
static void read_scene(io_study *study, io_place top) {
    char **sets = read_sets(top, json_object_get(study->root, "set"));
    io_scene *scene =
        sets ? open_scene(study, top, json_object_get(study->root, "scene"), (const char *const *)sets) : NULL;
    study_free_sets(sets);
    if (!scene) {
        top.faults->count += !top.faults->count;
        return;
    }
    study->scene_text = io_scene_text_anywhere(scene);
    study->good &= study->scene_text != NULL;
    io_scene_free(scene);
    if (!study->good || top.faults->count || !study->rows) return;
    char **first = study_sets(study, 0);
    scene = first ? io_scene_read_text(study->scene_text, strlen(study->scene_text), top.file,
                                       (const char *const *)first, study->exporters, top.faults)
                  : NULL;
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = 1;
    skein_world *world = scene ? io_scene_build(scene, &desc, top.faults) : NULL;
    skein_error error;
    for (size_t m = 0; world && m < study->wanted_count; m++) {
        io_study_wanted now = study->wanted[m];
        io_study_note note = {0, 0, 0, 0, 0};
        now.over = IO_STUDY_END;
        if (io_study_measure_now(world, &now, &note, 1, 0, true, &error))
            io_fault(top, "measure", error.status, "%s", error.message);
    }
    skein_world_destroy(world);
    io_scene_free(scene);
    study_free_sets(first);
}

/* ---- the whole ---- */

/* What its folder keeps: the same study about the scene beside it. */
static bool write_text(io_study *study) {
    json_t *copy = json_deep_copy(study->root);
    json_object_set_new(copy, "scene", json_string("scene.json"));
    json_object_del(copy, "set");
    char *text = copy ? json_dumps(copy, JSON_INDENT(2)) : NULL;
    json_decref(copy);
    size_t length = text ? strlen(text) : 0;
    study->text = text ? malloc(length + 2) : NULL;
    if (study->text) snprintf(study->text, length + 2, "%s\n", text);
    free(text);
    return study->text != NULL;
}

static void read_name(io_study *study, io_place top) {
    const char *slash = strrchr(top.file, '/'), *stem = slash ? slash + 1 : top.file;
    const char *given = text_in(top, study->root, "name");
    size_t length = strcspn(stem, ".");
    text_in(top, study->root, "description");
    study->name = given && given[0] ? strdup(given) : length ? strndup(stem, length) : strdup("study");
    study->good &= study->name != NULL;
}

io_study *io_study_read_text(const char *text, size_t size, const char *path, const skein_kind *const *exporters,
                             io_faults *faults) {
    io_place top = {path, "", faults};
    json_error_t wrong;
    size_t before = faults->count;
    io_study *study = calloc(1, sizeof *study);
    if (study) study->root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &wrong);
    if (!study || !study->root) {
        if (study)
            io_fault(top, "", SKEIN_ERROR_SYNTAX, "line %d, column %d: %s", wrong.line, wrong.column, wrong.text);
        free(study);
        return NULL;
    }
    study->exporters = exporters;
    study->built = SKEIN_VERSION;
    study->good = true;
    if (!json_is_object(study->root)) io_fault(top, "", SKEIN_ERROR_SYNTAX, "a study is an object, { ... }");
    else {
        check_members(top, study->root, members);
        number_in(top, study->root, "study", 1, 1, true, 1);
        study->seed = (uint64_t)number_in(top, study->root, "seed", 0, 9e15, true, 1);
        read_name(study, top);
        read_varied(study, top, json_object_get(study->root, "vary"));
        if (faults->count == before) count_rows(study, top, study->root);
        read_measures(study, top, json_object_get(study->root, "measure"));
        if (study->good) check_columns(study, top);
        if (study->good) check_plot(study, top);
        if (faults->count == before) read_scene(study, top);
        study->good = study->good && write_text(study);
    }
    if (!study->good) io_fault(top, "", SKEIN_ERROR_MEMORY, "out of memory");
    if (faults->count == before) return study;
    io_study_free(study);
    return NULL;
}

io_study *io_study_read(const char *path, const skein_kind *const *exporters, io_faults *faults) {
    io_bytes bytes;
    skein_error error = {SKEIN_OK, "", ""};
    if (io_file_read(path, IO_MOST_SCENE_BYTES, &bytes, &error)) {
        faults->count++;
        if (faults->report) faults->report(faults->user, &error);
        return NULL;
    }
    io_study *study = io_study_read_text(bytes.data, bytes.size, path, exporters, faults);
    io_bytes_free(&bytes);
    return study;
}

void io_study_free(io_study *study) {
    if (!study) return;
    for (size_t v = 0; v < study->varied_count; v++) json_decref(study->varied[v].values);
    for (size_t m = 0; m < study->wanted_count; m++) {
        free(study->wanted[m].name);
        free(study->wanted[m].body);
    }
    json_decref(study->root);
    free(study->name);
    free(study->scene_text);
    free(study->text);
    free(study);
}

void io_study_built(io_study *study, const char *version) {
    study->built = version;
}
