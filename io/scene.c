#include "io/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/scene_settings.h"

enum { SCENE_VERSION = 1, MOST_EXPORTS = 16, MOST_SCENE_BYTES = 64 << 20 };

struct io_scene {
    json_t *root;
    char *path;
    io_scene_settings settings;
    io_export exports[MOST_EXPORTS];
    size_t export_count;
};

#define FIELD(member, name, type, unit, initial, least, most, text, help)                                             \
    {name, type, offsetof(io_scene_settings, member), unit, {initial, 0, 0}, least, most, NULL, text, help}

static const skein_field scene_fields[] = {
    FIELD(version, "skein", SKEIN_FIELD_INT, "", SCENE_VERSION, 1, SCENE_VERSION, NULL, "version of the scene format"),
    FIELD(name, "name", SKEIN_FIELD_TEXT, "", 0, 0, 0, "", "a title"),
    FIELD(description, "description", SKEIN_FIELD_TEXT, "", 0, 0, 0, "", "what it shows"),
    FIELD(frames, "frames", SKEIN_FIELD_INT, "", 240, 0, 100000000, NULL, "how many frames a run makes"),
    FIELD(fps, "fps", SKEIN_FIELD_REAL, "1/s", 60, 1e-3, 1e6, NULL, "frames a second of simulated time"),
    FIELD(step, "step", SKEIN_FIELD_REAL, "s", 1.0 / 60, 1e-9, 1e3, NULL,
          "the longest step; a frame is cut into as many equal steps as it takes"),
    FIELD(threads, "threads", SKEIN_FIELD_INT, "", 1, 1, 64, NULL, "threads to run on; the result is the same"),
};

const skein_kind *io_scene_kind(void) {
    static const skein_kind kind = {"scene", "a file of bodies, rules and a method, in JSON and SI units", SKEIN_SCENE, scene_fields,
                                    sizeof scene_fields / sizeof *scene_fields, sizeof(io_scene_settings)};
    return &kind;
}

int io_scene_steps_per_frame(const io_scene_settings *settings, double *dt) {
    double steps = ceil(1 / (settings->fps * settings->step) - 1e-6);
    if (steps < 1) steps = 1;
    if (steps > 1e6) steps = 1e6;
    *dt = 1 / (settings->fps * steps);
    return (int)steps;
}

/* ---- settings into plain structs (the scene's own and the exporters') ---- */

/* Stores a checked value at a field's offset, as the library does; texts are copied. */
static bool store(const skein_field *field, void *params, const skein_value *value) {
    char *at = (char *)params + field->offset;
    switch (field->type) {
    case SKEIN_FIELD_BOOL: *(bool *)at = value->number[0] != 0; break;
    case SKEIN_FIELD_INT:
    case SKEIN_FIELD_INT2:
        for (int i = 0; i < value->count; i++) ((int32_t *)(void *)at)[i] = (int32_t)value->number[i];
        break;
    case SKEIN_FIELD_REAL:
    case SKEIN_FIELD_REAL2:
    case SKEIN_FIELD_VEC3: memcpy(at, value->number, (size_t)value->count * sizeof(double)); break;
    case SKEIN_FIELD_CHOICE: {
        int32_t place = (int32_t)value->number[0];
        if (value->text) {
            place = 0;
            for (const char *word = field->choices; strcspn(word, "|") != strlen(value->text) || strncmp(word, value->text, strlen(value->text)); place++)
                word = strchr(word, '|') + 1; // it is there: the value was checked
        }
        *(int32_t *)(void *)at = place;
        break;
    }
    case SKEIN_FIELD_TEXT:
        free(*(char **)(void *)at);
        *(char **)(void *)at = strdup(value->text);
        return *(char **)(void *)at != NULL;
    }
    return true;
}

static bool fill_params(const skein_kind *kind, void *params, const io_settings *settings) {
    bool good = true;
    for (size_t i = 0; i < kind->field_count; i++) {
        const skein_field *field = &kind->fields[i];
        int count = field->type == SKEIN_FIELD_VEC3 ? 3 : field->type == SKEIN_FIELD_INT2 || field->type == SKEIN_FIELD_REAL2 ? 2 : 1;
        skein_value value = {count, {field->initial[0], field->initial[1], field->initial[2]}, field->type == SKEIN_FIELD_TEXT ? field->text : NULL};
        good &= store(field, params, &value);
        for (size_t s = 0; settings && s < settings->count; s++)
            if (!strcmp(settings->data[s].name, field->name)) good &= store(field, params, &settings->data[s].value);
    }
    return good;
}

/* ---- exporters ---- */

static const skein_kind *find_exporter(const char *name, const skein_kind *const *exporters) {
    for (; *exporters; exporters++)
        if (!strcmp((*exporters)->name, name)) return *exporters;
    return NULL;
}

static void add_export(io_scene *scene, io_place place, const json_t *object, const skein_kind *const *exporters) {
    const char *type = json_is_string(object) ? json_string_value(object) : json_string_value(json_object_get(object, "type"));
    const skein_kind *kind = type ? find_exporter(type, exporters) : NULL;
    if (!kind) {
        io_fault(place, "type", SKEIN_ERROR_NAME, "%s%s%s: expected an exporter; `skein list exporters` shows them", type ? "'" : "", type ? type : "missing",
                 type ? "'" : "");
        return;
    }
    if (scene->export_count == MOST_EXPORTS) {
        io_fault(place, "", SKEIN_ERROR_LIMIT, "more than %d outputs", MOST_EXPORTS);
        return;
    }
    io_settings settings = {0};
    static const char *const skip[] = {"type", NULL};
    bool good = !json_is_object(object) || io_settings_read(&settings, place, object, kind, skip);
    void *params = good ? calloc(1, kind->params_size) : NULL;
    if (params && fill_params(kind, params, &settings)) scene->exports[scene->export_count++] = (io_export){kind, params};
    else free(params);
    io_settings_free(&settings);
}

size_t io_scene_exports(const io_scene *scene, io_export *exports, size_t most) {
    size_t count = scene->export_count < most ? scene->export_count : most;
    memcpy(exports, scene->exports, count * sizeof *exports);
    return count;
}

/* ---- reading ---- */

static const char *const sections[] = {"method", "bodies", "constraints", "forces", "colliders", "output", NULL};

static void read_outputs(io_scene *scene, io_place place, const skein_kind *const *exporters) {
    const json_t *outputs = json_object_get(scene->root, "output");
    json_t *standard = json_array();
    for (size_t i = 0; exporters[i]; i++) json_array_append_new(standard, json_string(exporters[i]->name));
    if (!outputs) outputs = standard;
    if (!json_is_array(outputs)) io_fault(place, "output", SKEIN_ERROR_VALUE, "expected a list of exporters, such as [\"obj\", \"pc2\"]");
    size_t index;
    json_t *item;
    json_array_foreach(outputs, index, item) {
        char path[64];
        snprintf(path, sizeof path, "output.%zu", index);
        add_export(scene, (io_place){place.file, path, place.faults}, item, exporters);
    }
    json_decref(standard);
}

io_scene *io_scene_read(const char *path, const char *const *sets, const skein_kind *const *exporters, io_faults *faults) {
    io_place place = {path, "", faults};
    skein_error error = {SKEIN_OK, "", ""};
    io_bytes bytes;
    if (io_file_read(path, MOST_SCENE_BYTES, &bytes, &error)) {
        faults->count++;
        if (faults->report) faults->report(faults->user, &error);
        return NULL;
    }
    json_error_t syntax;
    json_t *root = json_loadb(bytes.data, bytes.size, JSON_REJECT_DUPLICATES, &syntax);
    io_bytes_free(&bytes);
    if (!root) {
        char where[256];
        snprintf(where, sizeof where, "%s:%d:%d", path, syntax.line, syntax.column);
        io_fault((io_place){where, "", faults}, "", SKEIN_ERROR_SYNTAX, "%s", syntax.text);
        return NULL;
    }
    io_scene *scene = calloc(1, sizeof *scene);
    io_settings settings = {0};
    bool good = scene != NULL && (scene->path = strdup(path)) != NULL;
    if (good) scene->root = root;
    else json_decref(root);
    if (good && !json_is_object(root)) {
        io_fault(place, "", SKEIN_ERROR_SYNTAX, "expected an object: { \"bodies\": [...], ... }");
        good = false;
    }
    for (; good && sets && *sets; sets++) good = io_scene_override(root, *sets, place);
    if (good) good = io_settings_read(&settings, place, root, io_scene_kind(), sections);
    // the world is built all the same, to name the faults that are in there
    if (scene && scene->root && json_is_object(root)) {
        fill_params(io_scene_kind(), &scene->settings, good ? &settings : NULL);
        read_outputs(scene, place, exporters);
    }
    io_settings_free(&settings);
    if (scene && json_is_object(scene->root)) return scene;
    io_scene_free(scene);
    return NULL;
}

void io_scene_free(io_scene *scene) {
    if (!scene) return;
    for (size_t i = 0; i < scene->export_count; i++) free((void *)(uintptr_t)scene->exports[i].params);
    json_decref(scene->root);
    free(scene->settings.name);
    free(scene->settings.description);
    free(scene->path);
    free(scene);
}

const io_scene_settings *io_scene_get(const io_scene *scene) {
    return &scene->settings;
}

skein_world *io_scene_build(io_scene *scene, const skein_world_desc *desc, io_faults *faults) {
    return io_world_from_document(scene->root, scene->path, desc, faults);
}
