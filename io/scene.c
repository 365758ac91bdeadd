/* The reader of scenes' own part: the document, its view, exporters and paths. Objects are built in scene_build.c. */
#include "io/budget.h"
#include "io/groups.h"
#include "io/reach.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/mesh.h"
#include "io/scene_settings.h"

enum { SCENE_VERSION = 1, MOST_EXPORTS = 16, MOST_STEPS_PER_FRAME = 1000000 };

struct io_scene {
    json_t *root;  /* an object */
    json_t *notes; /* texts for the log */
    char *path;
    io_scene_settings settings;
    io_export exports[MOST_EXPORTS];
    size_t export_count;
    const skein_kind *view_kind; /* NULL: this program draws nothing */
    void *view;
    io_budget *budget;
};

/* ---- what stands at the top of a scene ---- */

#define FIELD(member, name, type, unit, initial, least, most, text, help) \
    { name, type, offsetof(io_scene_settings, member), unit, {initial, 0, 0}, least, most, NULL, text, help }

static const skein_field scene_fields[] = {
    FIELD(version, "skein", SKEIN_FIELD_INT, "", SCENE_VERSION, 1, SCENE_VERSION, NULL, "version of the scene format"),
    FIELD(name, "name", SKEIN_FIELD_TEXT, "", 0, 0, 0, "", "a title; the picture's file is called so"),
    FIELD(description, "description", SKEIN_FIELD_TEXT, "", 0, 0, 0, "", "what it shows"),
    FIELD(frames, "frames", SKEIN_FIELD_INT, "", 240, 0, 100000000, NULL, "how many frames a run makes"),
    FIELD(fps, "fps", SKEIN_FIELD_REAL, "1/s", 60, 1e-3, 1e6, NULL, "frames a second of simulated time"),
    FIELD(step, "step", SKEIN_FIELD_REAL, "s", 1.0 / 60, 1e-9, 1e3, NULL,
          "the longest step; a frame is cut into as many equal steps as it takes"),
    FIELD(most_stretch, "most_stretch", SKEIN_FIELD_REAL, "", 1, 0, (double)INFINITY, NULL,
          "a run that ends with an edge longer than its rest length times 1 + this fails; \"infinite\" is none"),
    FIELD(
        budget_ms, "method.budget_ms", SKEIN_FIELD_REAL, "ms", 0, 0, 1e9, NULL,
        "picks the method's substeps: as many as a frame takes no longer with, here and now; 0: they are as they stand"),
    FIELD(
        threads, "threads", SKEIN_FIELD_INT, "", 0, 0, 64, NULL,
        "the most threads to run on, 0: one a processor; steps take as many as are faster, and the result is the same"),
    {"advance",
     SKEIN_FIELD_CHOICE,
     offsetof(io_scene_settings, advance),
     "",
     {0, 0, 0},
     0,
     0,
     "time|key",
     NULL,
     "in a window: by itself, as time goes on; or one step at a press of Enter, or of any key without another meaning"},
};

static const io_scene_section sections[] = {
    {"method", SKEIN_METHOD, "what turns rules into motion: { \"type\": \"xpbd\", \"substeps\": 10 }, say"},
    {"bodies", SKEIN_BODY, "a list: [ { \"type\": \"cloth\", ... }, ... ]"},
    {"constraints", SKEIN_CONSTRAINT,
     "a list; each has \"particles\", too: [[0, 1], [1, 2]], or {\"body\": \"flag\", \"over\": \"edges\"}"},
    {"forces", SKEIN_FORCE, "a list"},
    {"colliders", SKEIN_COLLIDER, "a list"},
    {"motions", SKEIN_MOTION, "a list: [ { \"type\": \"translate\", \"on\": \"flag\", ... }, ... ]"},
    {"output", SKEIN_EXPORTER,
     "a list of exporters: [\"obj\", { \"type\": \"pc2\", \"every\": 2 }]; all but \"film\" if it is missing"},
    {"view", SKEIN_VIEW, "how pictures are drawn: { \"wireframe\": true, \"colour\": \"speed\" }, say"},
};
enum { SECTION_COUNT = sizeof sections / sizeof *sections };

const skein_kind *io_scene_kind(void) {
    static const skein_kind kind = {"scene",
                                    "a file of bodies, rules and a method, in JSON and SI units",
                                    SKEIN_SCENE,
                                    scene_fields,
                                    sizeof scene_fields / sizeof *scene_fields,
                                    sizeof(io_scene_settings)};
    return &kind;
}

const io_scene_section *io_scene_section_at(size_t index) {
    return index < SECTION_COUNT ? &sections[index] : NULL;
}

/* ---- settings into plain structs: the scene's own and the exporters' ---- */

static int32_t choice_place(const char *choices, const char *word) {
    int32_t place = 0;
    // it is there: the value was checked
    for (size_t length = strlen(word); strcspn(choices, "|") != length || strncmp(choices, word, length); place++)
        choices = strchr(choices, '|') + 1;
    return place;
}

/* Stores a checked value at a field's offset, as the library does; texts are copied. */
static bool store(const skein_field *field, void *params, const skein_value *value) {
    char *at = (char *)params + field->offset;
    switch (field->type) {
    case SKEIN_FIELD_BOOL: *(bool *)at = value->number[0] != 0; break;
    case SKEIN_FIELD_INT:
    case SKEIN_FIELD_INT2:
    case SKEIN_FIELD_INT3:
        for (int i = 0; i < io_field_numbers(field); i++) ((int32_t *)(void *)at)[i] = (int32_t)value->number[i];
        break;
    case SKEIN_FIELD_REAL:
    case SKEIN_FIELD_REAL2:
    case SKEIN_FIELD_VEC3: memcpy(at, value->number, (size_t)io_field_numbers(field) * sizeof(double)); break;
    case SKEIN_FIELD_CHOICE:
        *(int32_t *)(void *)at = value->text ? choice_place(field->choices, value->text) : (int32_t)value->number[0];
        break;
    case SKEIN_FIELD_TEXT:
        free(*(char **)(void *)at);
        *(char **)(void *)at = strdup(value->text ? value->text : "");
        return *(char **)(void *)at != NULL;
    }
    return true;
}

/* The defaults, then the settings. False when there is no memory. */
static bool fill_params(const skein_kind *kind, void *params, const io_settings *settings) {
    bool good = true;
    for (size_t i = 0; i < kind->field_count; i++) {
        const skein_field *field = &kind->fields[i];
        skein_value value = {0, {field->initial[0], field->initial[1], field->initial[2]}, field->text};
        good &= store(field, params, &value);
        for (size_t s = 0; s < settings->count; s++)
            if (!strcmp(settings->data[s].name, field->name)) good &= store(field, params, &settings->data[s].value);
    }
    return good;
}

static void clear_params(const skein_kind *kind, void *params) {
    for (size_t i = 0; i < kind->field_count; i++)
        if (kind->fields[i].type == SKEIN_FIELD_TEXT) free(*(char **)(void *)((char *)params + kind->fields[i].offset));
}

/* ---- the view ---- */

/* The path of a file that the scene names: relative to the scene's folder. NULL when there is no memory. */
char *io_path_beside(const char *scene, const char *file) {
    const char *slash = file[0] == '/' || !file[0] ? NULL : strrchr(scene, '/');
    size_t folder = slash ? (size_t)(slash + 1 - scene) : 0, size = folder + strlen(file) + 1;
    char *path = malloc(size);
    if (path) snprintf(path, size, "%.*s%s", (int)folder, scene, file);
    return path;
}

/* Makes the paths in the view's parameters paths from here; a file that cannot be read is a fault now, not at the end
 * of a run. False when there is no memory. */
static bool place_paths(io_scene *scene, io_place place) {
    for (size_t i = 0; i < scene->view_kind->field_count; i++) {
        const skein_field *field = &scene->view_kind->fields[i];
        if (field->type != SKEIN_FIELD_TEXT || strcmp(field->unit, "path")) continue;
        char **text = (char **)(void *)((char *)scene->view + field->offset),
             *path = io_path_beside(scene->path, *text);
        if (!path) return false;
        if (!io_reach_check(place, field->name, *text, path)) path[0] = 0;
        else if (path[0] && access(path, R_OK))
            io_fault(place, field->name, SKEIN_ERROR_FILE, "%s: cannot read: %s", path,
                     errno == ENOENT ? "no such file or directory" : strerror(errno));
        free(*text);
        *text = path;
    }
    return true;
}

/* A program that draws nothing passes the view over. */
static void read_view(io_scene *scene, io_place place, const skein_kind *const *kinds) {
    const json_t *object = json_object_get(scene->root, "view");
    char words[IO_JSON_WORDS_SIZE];
    io_place inside = {place.file, "view", place.faults};
    if (object && !json_is_object(object))
        io_fault(place, "view", SKEIN_ERROR_VALUE, "expected an object, { \"wireframe\": true }, say, not %s",
                 io_json_words(object, words));
    while (*kinds && (*kinds)->category != SKEIN_VIEW) kinds++;
    if (!*kinds) return;
    io_settings settings = {0};
    if (json_is_object(object)) io_settings_read(&settings, inside, object, *kinds, NULL);
    scene->view_kind = *kinds;
    scene->view = calloc(1, (*kinds)->params_size);
    if (!scene->view || !fill_params(*kinds, scene->view, &settings) || !place_paths(scene, inside))
        io_fault(inside, "", SKEIN_ERROR_MEMORY, "out of memory");
    io_settings_free(&settings);
}

const void *io_scene_view(const io_scene *scene) {
    return scene->view;
}

/* ---- exporters ---- */

static const skein_kind *find_exporter(io_place place, const json_t *object, const skein_kind *const *exporters) {
    char hint[IO_HINT_SIZE], words[IO_JSON_WORDS_SIZE];
    const char *names[MOST_EXPORTS], *member = json_is_object(object) ? "type" : "";
    size_t count = 0;
    const json_t *name = json_is_object(object) ? json_object_get(object, "type") : object;
    for (; count < MOST_EXPORTS && *exporters; exporters++) {
        if ((*exporters)->category != SKEIN_EXPORTER) continue;
        names[count++] = (*exporters)->name;
        if (json_is_string(name) && !strcmp((*exporters)->name, json_string_value(name))) return *exporters;
    }
    const char *word = json_is_string(name) ? json_string_value(name) : "";
    if (!strcmp(word, "png") || !strcmp(word, "film"))
        io_fault(place, member, SKEIN_ERROR_NAME,
                 "'%s' needs pictures, which this program was built without: build it with SKEIN_RENDER=ON", word);
    else if (json_is_string(name))
        io_fault(place, member, SKEIN_ERROR_NAME, "there is no exporter '%s'%s", word,
                 io_hint(word, names, count, hint));
    else
        io_fault(place, member, SKEIN_ERROR_VALUE, "expected the name of an exporter, such as \"obj\"%s",
                 io_json_instead(name, words));
    return NULL;
}

static void add_export(io_scene *scene, io_place place, const json_t *object, bool asked,
                       const skein_kind *const *exporters) {
    const skein_kind *kind = find_exporter(place, object, exporters);
    if (!kind) return;
    for (size_t i = 0; i < scene->export_count; i++) {
        if (scene->exports[i].kind != kind) continue;
        io_fault(place, "", SKEIN_ERROR_VALUE, "a second %s would write the same files", kind->name);
        return;
    }
    static const char *const skip[] = {"type", NULL};
    io_settings settings = {0};
    if (!json_is_object(object) || io_settings_read(&settings, place, object, kind, skip)) {
        void *params = calloc(1, kind->params_size);
        // there is room: no more kinds are looked at, and each is there once
        if (params) scene->exports[scene->export_count++] = (io_export){kind, params, asked};
        if (!params || !fill_params(kind, params, &settings)) io_fault(place, "", SKEIN_ERROR_MEMORY, "out of memory");
    }
    io_settings_free(&settings);
}

static void read_outputs(io_scene *scene, io_place place, const skein_kind *const *exporters) {
    json_t *outputs = json_object_get(scene->root, "output"), *standard = NULL, *item;
    char words[IO_JSON_WORDS_SIZE];
    if (!outputs) outputs = standard = json_array();
    for (size_t i = 0; standard && exporters[i]; i++)
        if (exporters[i]->category == SKEIN_EXPORTER) json_array_append_new(standard, json_string(exporters[i]->name));
    if (!json_is_array(outputs))
        io_fault(place, "output", SKEIN_ERROR_VALUE, "expected a list of exporters, such as [\"obj\", \"pc2\"], not %s",
                 io_json_words(outputs, words));
    size_t index;
    json_array_foreach(outputs, index, item) {
        char path[64];
        snprintf(path, sizeof path, "output.%zu", index);
        add_export(scene, (io_place){place.file, path, place.faults}, item, !standard, exporters);
    }
    json_decref(standard);
}

size_t io_scene_exports(const io_scene *scene, io_export *exports, size_t most) {
    size_t count = scene->export_count < most ? scene->export_count : most;
    memcpy(exports, scene->exports, count * sizeof *exports);
    return count;
}

skein_status io_scene_exports_set(io_scene *scene, const char *name, const skein_value *value, size_t *count,
                                  skein_error *error) {
    *count = 0;
    for (size_t i = 0; i < scene->export_count; i++) {
        io_export *e = &scene->exports[i];
        const skein_field *field = skein_field_find(e->kind, name, NULL);
        if (!field) continue;
        skein_status status = skein_field_check(field, value, error);
        if (status) return status;
        if (!store(field, (void *)(uintptr_t)e->params, value))
            return io_error_set(error, SKEIN_ERROR_MEMORY, name, "out of memory");
        ++*count;
    }
    return SKEIN_OK;
}

/* ---- reading ---- */

/* Steps that make a frame, as a number of any size. */
static double steps_per_frame(const io_scene_settings *settings) {
    return fmax(ceil(1 / (settings->fps * settings->step) - 1e-6), 1);
}

int io_scene_steps_per_frame(const io_scene_settings *settings, double *dt) {
    double steps = fmin(steps_per_frame(settings), MOST_STEPS_PER_FRAME); // more was a fault
    *dt = 1 / (settings->fps * steps);
    return (int)steps;
}

/* The scene's own fields. What has a fault keeps its default. */
static void read_top(io_scene *scene, io_place place) {
    const char *others[SECTION_COUNT + 1] = {NULL};
    for (size_t i = 0; i < SECTION_COUNT; i++) others[i] = sections[i].name;
    io_settings settings;
    io_settings_read(&settings, place, scene->root, io_scene_kind(), others);
    io_settings_read_one(&settings, place, "method.budget_ms",
                         json_object_get(json_object_get(scene->root, "method"), "budget_ms"), io_scene_kind());
    if (!fill_params(io_scene_kind(), &scene->settings, &settings))
        io_fault(place, "", SKEIN_ERROR_MEMORY, "out of memory");
    io_settings_free(&settings);
    const io_scene_settings *s = &scene->settings;
    if (steps_per_frame(s) > MOST_STEPS_PER_FRAME)
        io_fault(place, "step", SKEIN_ERROR_LIMIT, "a frame of %g s is more than %d steps of %g s", 1 / s->fps,
                 MOST_STEPS_PER_FRAME, s->step);
}

/* Whether the document is a scene of a version that this reader knows: with any other, each further fault
 * would be noise. */
static bool is_a_scene(const json_t *root, io_place place) {
    char words[IO_JSON_WORDS_SIZE];
    const json_t *version = json_object_get(root, "skein");
    if (!json_is_object(root)) {
        io_fault(place, "", SKEIN_ERROR_SYNTAX, "expected an object: { \"bodies\": [...], ... }, not %s",
                 io_json_words(root, words));
        return false;
    }
    if (!json_is_integer(version) || json_integer_value(version) <= SCENE_VERSION) return true;
    io_fault(place, "skein", SKEIN_ERROR_VALUE, "the scene is of version %lld; this skein reads version %d",
             (long long)json_integer_value(version), SCENE_VERSION);
    return false;
}

static json_t *parse(const char *text, size_t size, const char *path, io_faults *faults) {
    // some editors begin UTF-8 with a mark
    if (size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3)) text += 3, size -= 3;
    size_t blank = 0;
    while (blank < size && memchr(" \t\r\n", text[blank], 4)) blank++;
    bool utf16 = size >= 2 && (!memcmp(text, "\xff\xfe", 2) || !memcmp(text, "\xfe\xff", 2));
    if (blank == size || utf16) {
        io_fault((io_place){path, "", faults}, "", SKEIN_ERROR_SYNTAX,
                 utf16 ? "the file is UTF-16: expected UTF-8"
                       : "the file is empty: expected a scene, { \"bodies\": [...], ... }");
        return NULL;
    }
    json_error_t syntax;
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_ANY, &syntax);
    if (root) return root;
    char where[256];
    size_t length = strlen(path), room = sizeof where - 40;
    snprintf(where, sizeof where, "%s%s:%d:%d", length > room ? "..." : "", length > room ? path + length - room : path,
             syntax.line, syntax.column);
    bool nul = json_error_code(&syntax) == json_error_null_character;
    io_fault((io_place){where, "", faults}, "", SKEIN_ERROR_SYNTAX, "%s",
             nul ? "\\u0000 is not allowed in a text" : syntax.text);
    return NULL;
}

io_scene *io_scene_read_text(const char *text, size_t size, const char *path, const char *const *sets,
                             const skein_kind *const *exporters, io_faults *faults) {
    io_place place = {path, "", faults};
    json_t *root = parse(text, size, path, faults);
    if (!root) return NULL;
    io_scene *scene = calloc(1, sizeof *scene);
    if (!scene || !(scene->path = strdup(path)) || !(scene->notes = json_array()) ||
        !(scene->budget = calloc(1, sizeof *scene->budget))) {
        json_decref(root);
        if (scene) free(scene->path), json_decref(scene->notes);
        free(scene);
        io_fault(place, "", SKEIN_ERROR_MEMORY, "out of memory");
        return NULL;
    }
    scene->root = root;
    for (; json_is_object(root) && sets && *sets; sets++)
        io_scene_override(root, *sets, exporters, faults, scene->notes);
    if (is_a_scene(root, place)) {
        read_top(scene, place);
        read_outputs(scene, place, exporters);
        read_view(scene, place, exporters);
        return scene;
    }
    io_scene_free(scene);
    return NULL;
}

io_scene *io_scene_read(const char *path, const char *const *sets, const skein_kind *const *exporters,
                        io_faults *faults) {
    skein_error error = {SKEIN_OK, "", ""};
    io_bytes bytes;
    if (io_path_is_mesh(path)) return io_scene_of_mesh(path, sets, exporters, faults);
    if (io_file_read(path, IO_MOST_SCENE_BYTES, &bytes, &error)) {
        io_fault((io_place){path, "", faults}, "", error.status, "%s", error.message);
        return NULL;
    }
    io_scene *scene = io_scene_read_text(bytes.data, bytes.size, path, sets, exporters, faults);
    io_bytes_free(&bytes);
    return scene;
}

void io_scene_free(io_scene *scene) {
    if (!scene) return;
    for (size_t i = 0; i < scene->export_count; i++) {
        clear_params(scene->exports[i].kind, (void *)(uintptr_t)scene->exports[i].params);
        free((void *)(uintptr_t)scene->exports[i].params);
    }
    clear_params(io_scene_kind(), &scene->settings);
    if (scene->view) clear_params(scene->view_kind, scene->view);
    free(scene->view);
    free(scene->budget);
    json_decref(scene->root);
    json_decref(scene->notes);
    free(scene->path);
    free(scene);
}

json_t *io_scene_document(const io_scene *scene) {
    return scene->root;
}

char *io_scene_mesh_path(const io_scene *scene, size_t body) {
    const char *file =
        json_string_value(json_object_get(json_array_get(json_object_get(scene->root, "bodies"), body), "mesh"));
    return file && file[0] ? io_path_beside(scene->path, file) : NULL;
}

const char *io_scene_path(const io_scene *scene) {
    return scene->path;
}

const io_scene_settings *io_scene_get(const io_scene *scene) {
    return &scene->settings;
}

/* Whether the bodies are there that the view names. */
static bool has_its_bodies(const io_scene *scene, const skein_world *world, io_faults *faults) {
    const io_place place = {scene->path, "view", faults};
    for (size_t i = 0; scene->view && i < scene->view_kind->field_count; i++) {
        const skein_field *field = &scene->view_kind->fields[i];
        char path[300];
        skein_value value;
        if (field->type != SKEIN_FIELD_TEXT || strcmp(field->unit, "body")) continue;
        const char *name = *(char *const *)(const void *)((const char *)scene->view + field->offset);
        snprintf(path, sizeof path, "bodies.%.250s.name", name);
        if (!name[0] || !strcmp(name, "all") || !skein_get_path(world, path, &value)) continue;
        io_fault(place, field->name, SKEIN_ERROR_NAME,
                 "there is no body '%.100s'%s: expected a body's name, its number from 0, or \"all\"", name,
                 io_group_words(world, name));
        return false;
    }
    return true;
}

const io_budget *io_scene_budget(const io_scene *scene) {
    return scene->budget;
}

/* Chooses by the budget, and puts the choice in its place. */
static bool keep_to_budget(const io_scene *scene, skein_world *world, io_faults *faults) {
    json_t *method = json_object_get(scene->root, "method");
    const io_place place = {scene->path, "method", faults};
    skein_error error = {SKEIN_OK, "", ""};
    if (!(scene->settings.budget_ms > 0) || !json_object_get(method, "budget_ms")) return true;
    skein_status status = io_budget_choose(world, &scene->settings, scene->budget, &error);
    if (!status) {
        json_object_del(method, "budget_ms");
        if (!json_object_set_new(method, "substeps", json_integer(scene->budget->chosen.substeps))) return true;
        status = SKEIN_ERROR_MEMORY;
        io_error_set(&error, status, "", "out of memory");
    }
    io_fault(place, "budget_ms", status, "%s", error.message);
    return false;
}

skein_world *io_scene_build(const io_scene *scene, const skein_world_desc *desc, io_faults *faults) {
    double dt;
    io_scene_steps_per_frame(&scene->settings, &dt);
    for (size_t i = 0; desc && desc->log && i < json_array_size(scene->notes); i++)
        desc->log(desc->log_user, SKEIN_LOG_INFO, json_string_value(json_array_get(scene->notes, i)));
    skein_world *world = io_world_from_document(scene->root, scene->path, dt, desc, faults);
    bool had = scene->budget->ms > 0;
    if (!world || (has_its_bodies(scene, world, faults) && keep_to_budget(scene, world, faults))) {
        char text[400];
        if (world && !had && scene->budget->ms > 0 && desc && desc->log) {
            io_budget_text(scene->budget, text, sizeof text);
            desc->log(desc->log_user, SKEIN_LOG_INFO, text);
        }
        return world;
    }
    skein_world_destroy(world);
    return NULL;
}
