/* A scene back to JSON: as it was read, with what was set in it. Called by the command (reports) and the window (what
 * was tuned). Numbers keep all their digits, so that the file opens to the same bits. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/scene_settings.h"

char *io_scene_text(const io_scene *scene) {
    char *text = json_dumps(io_scene_document(scene), JSON_INDENT(2)), *line = NULL;
    size_t length = text ? strlen(text) : 0;
    if (text) line = realloc(text, length + 2);
    if (line) memcpy(line + length, "\n", 2);
    else free(text);
    return line;
}

char *io_scene_note(const io_scene *scene, const char *path, char *const *words, int count) {
    char *whole = realpath(path, NULL);
    json_t *note = json_object(), *line = json_array();
    for (int i = 0; i < count; i++) {
        json_t *word = json_string(words[i]);
        json_array_append_new(line, word ? word : json_string("(not UTF-8)"));
    }
    json_object_set_new(note, "skein", json_string(SKEIN_VERSION));
    json_object_set_new(note, "path", json_string(whole ? whole : path));
    json_object_set_new(note, "command_line", line);
    json_object_set(note, "scene", io_scene_document(scene));
    char *text = json_dumps(note, JSON_COMPACT);
    json_decref(note);
    free(whole);
    return text;
}

/* ---- files that it names ---- */

/* Whether a member holds the path of a file, relative to the scene's folder. */
static bool is_path(const char *member) {
    static const char *const members[] = {"mesh", "image", "cache", "file"};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        if (!strcmp(member, members[i])) return true;
    return false;
}

/* Makes the paths in a value, however deep, paths from anywhere. False when there is no memory. */
static bool place_paths(json_t *value, const char *scene) {
    const char *name;
    json_t *item;
    size_t index;
    json_array_foreach(value, index, item) if (!place_paths(item, scene)) return false;
    json_object_foreach(value, name, item) {
        if (!json_is_string(item) || !is_path(name)) {
            if (!place_paths(item, scene)) return false;
            continue;
        }
        if (!json_string_length(item)) continue;
        char *beside = io_path_beside(scene, json_string_value(item)), *whole = beside ? realpath(beside, NULL) : NULL;
        // what is not there keeps its name: the reader will say so
        bool good = beside && (!whole || !json_string_set(item, whole));
        free(whole);
        free(beside);
        if (!good) return false;
    }
    return true;
}

/* The folder of a path, without links; NULL if it has none. Free it. */
static char *folder_of(const char *path) {
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup("."), *whole;
    whole = folder ? realpath(folder, NULL) : NULL;
    free(folder);
    return whole;
}

char *io_scene_text_anywhere(const io_scene *scene) {
    json_t *root = json_deep_copy(io_scene_document(scene));
    char *text = root && place_paths(root, io_scene_path(scene)) ? json_dumps(root, JSON_INDENT(2)) : NULL;
    size_t length = text ? strlen(text) : 0;
    char *line = text ? realloc(text, length + 2) : NULL;
    json_decref(root);
    if (line) memcpy(line + length, "\n", 2);
    else free(text);
    return line;
}

bool io_scene_each_file(const struct json_t *value, bool (*take)(void *user, const char *path), void *user) {
    const char *name;
    json_t *item;
    size_t index;
    bool good = true;
    json_array_foreach((json_t *)(uintptr_t)value, index, item) good = good && io_scene_each_file(item, take, user);
    json_object_foreach((json_t *)(uintptr_t)value, name, item) {
        const char *path = is_path(name) ? json_string_value(item) : NULL;
        good = good && (path && path[0] == '/' ? take(user, path) : io_scene_each_file(item, take, user));
    }
    return good;
}

/* ---- what a scene is, in a number ---- */

static uint64_t add_bytes(uint64_t hash, const void *bytes, size_t size) {
    for (const unsigned char *at = bytes; size; size--) hash = (hash ^ *at++) * 0x100000001b3u;
    return hash;
}

/* The bytes of the files that a value names, however deep. */
static uint64_t add_files(uint64_t hash, json_t *value, const char *scene) {
    const char *name;
    json_t *item;
    size_t index;
    json_array_foreach(value, index, item) hash = add_files(hash, item, scene);
    json_object_foreach(value, name, item) {
        char *path = json_is_string(item) && is_path(name) ? io_path_beside(scene, json_string_value(item)) : NULL;
        io_bytes bytes;
        if (path && !io_file_read(path, SIZE_MAX, &bytes, NULL)) {
            hash = add_bytes(hash, bytes.data, bytes.size);
            io_bytes_free(&bytes);
            json_object_set_new(value, name, json_null()); // wherever it lies
        }
        free(path);
        hash = add_files(hash, item, scene);
    }
    return hash;
}

uint64_t io_scene_hash(const io_scene *scene) {
    static const char *const passive[] = {"view", "output", "name", "description", "threads"};
    json_t *root = json_deep_copy(io_scene_document(scene));
    for (size_t i = 0; i < sizeof passive / sizeof *passive; i++) json_object_del(root, passive[i]);
    uint64_t hash = add_files(0xcbf29ce484222325u, root, io_scene_path(scene));
    char *text = json_dumps(root, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(17));
    if (text) hash = add_bytes(hash, text, strlen(text));
    free(text);
    json_decref(root);
    return hash;
}

skein_status io_scene_write(const io_scene *scene, const char *path, skein_error *error) {
    char *from = folder_of(io_scene_path(scene)), *to = folder_of(path);
    bool moves = !from || !to || strcmp(from, to) != 0;
    free(from);
    free(to);
    json_t *root = json_deep_copy(io_scene_document(scene));
    char *text = root && (!moves || place_paths(root, io_scene_path(scene))) ? json_dumps(root, JSON_INDENT(2)) : NULL;
    json_decref(root);
    if (!text) return io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    io_output *output = io_output_open(path, error);
    skein_status status = SKEIN_ERROR_FILE;
    if (output) {
        io_output_write(output, text, strlen(text));
        io_output_write(output, "\n", 1);
        status = io_output_commit(output, error);
    }
    free(text);
    return status;
}

/* ---- single values ---- */

static json_t *number_of(const skein_field *field, double x) {
    bool whole = field->type == SKEIN_FIELD_INT || field->type == SKEIN_FIELD_INT2 || field->type == SKEIN_FIELD_INT3;
    if (isinf(x)) return json_string("infinite");
    return whole ? json_integer((json_int_t)x) : json_real(x);
}

/* The n-th word of "area|uniform|angle"; NULL past the end or when there is no memory. */
static json_t *word_of(const char *choices, double place) {
    for (; choices && place >= 1; place--) {
        choices = strchr(choices, '|');
        if (choices) choices++;
    }
    return choices ? json_stringn(choices, strcspn(choices, "|")) : NULL;
}

char *io_value_json(const skein_field *field, const skein_value *value) {
    int count = io_field_numbers(field);
    json_t *json = NULL;
    if (field->type == SKEIN_FIELD_BOOL) json = json_boolean(value->number[0] != 0);
    else if (field->type == SKEIN_FIELD_CHOICE && !value->text) json = word_of(field->choices, value->number[0]);
    else if (count == 0) json = json_string(value->text ? value->text : "");
    else if (count == 1) json = number_of(field, value->number[0]);
    else {
        json = json_array();
        for (int i = 0; json && i < count; i++) json_array_append_new(json, number_of(field, value->number[i]));
    }
    char *text = json ? json_dumps(json, JSON_ENCODE_ANY) : NULL;
    json_decref(json);
    return text;
}
