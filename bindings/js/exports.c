/* What JavaScript calls: a scene with its world, and texts in JSON. skein.js is the only caller.
 *
 * Owns: a js_scene, the world that is built from a scene, the document that notes each change, and the hand that pulls.
 * Numbers go as they are, arrays by pointers into the module's memory, everything else as JSON that the caller frees.
 * What fails says why by js_faults(): a list of {status, where, message}, in the words that the command has. */
#include <jansson.h>
#include <math.h>
#include <skein/cut.h>
#include <skein/formula.h>
#include <skein/record.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/list.h"
#include "bindings/js/files.h"
#include "io/clip.h"
#include "io/scene_settings.h"
#include "io/uncut.h"
#include "render/view.h"
#include "viewer/grab.h"

#if defined __wasm__
#define EXPORT(name_) __attribute__((export_name(#name_), used)) name_
#else // for tests/test_page.c
#define EXPORT(name_) name_
#endif

typedef struct js_bytes {
    char *data;
    size_t size, capacity;
} js_bytes;

typedef struct js_scene {
    js_files files;
    io_scene *scene;
    skein_world *world; /* NULL where there was a fault */
    json_t *faults;
    double dt;
    int steps_per_frame;
    viewer_grab grab;
    skein_statistics statistics;
    js_bytes recording;
} js_scene;

/* ---- memory and faults ---- */

void *EXPORT(js_take)(size_t size) {
    return malloc(size ? size : 1);
}

void EXPORT(js_give)(void *memory) {
    free(memory);
}

static void note_fault(void *user, const skein_error *error) {
    js_scene *js = user;
    json_t *fault = json_object();
    json_object_set_new(fault, "status", json_string(skein_status_text(error->status)));
    json_object_set_new(fault, "where", json_string(error->where));
    json_object_set_new(fault, "message", json_string(error->message));
    json_array_append_new(js->faults, fault);
}

/* Notes what the world says of a call that failed; returns whether it did. */
static bool failed(js_scene *js, skein_status status) {
    if (status) note_fault(js, skein_world_error(js->world));
    return status != SKEIN_OK;
}

/* What went wrong since this was last asked: a list, to be freed. */
char *EXPORT(js_faults)(js_scene *js) {
    char *text = json_dumps(js->faults, JSON_COMPACT);
    json_array_clear(js->faults);
    return text;
}

/* ---- opening ---- */

js_scene *EXPORT(js_new)(void) {
    js_scene *js = calloc(1, sizeof *js);
    if (js && !(js->faults = json_array())) {
        free(js);
        return NULL;
    }
    return js;
}

/* Gives a file that the scene may name; `bytes` are from js_take() and become the scene's. */
bool EXPORT(js_file_add)(js_scene *js, const char *path, char *bytes, size_t size) {
    char *copy = strdup(path);
    if (!copy || !io_grow(&js->files.data, &js->files.capacity, js->files.count + 1, sizeof *js->files.data)) {
        free(copy);
        return false;
    }
    js->files.data[js->files.count++] = (js_file){copy, bytes, size};
    return true;
}

/* The sets, and before them one that takes away what a scene wants to be written: a film, say, of which nothing is known
 * here. NULL when there is no memory; free it. */
static const char **without_output(const char *text, size_t size, const char *const *sets) {
    static const char member[] = "\"output\"";
    bool has = false;
    size_t count = 0, at = 0;
    for (size_t i = 0; i + sizeof member <= size && !has; i++) has = !memcmp(text + i, member, sizeof member - 1);
    while (sets && sets[count]) count++;
    const char **all = malloc((count + 2) * sizeof *all);
    if (!all) return NULL;
    if (has) all[at++] = "output=[]";
    for (size_t i = 0; i < count; i++) all[at++] = sets[i];
    all[at] = NULL;
    return all;
}

/* Reads a scene and builds its world; a path of a mesh without a text becomes a scene about it, as in the command. `sets` are "path=value", NULL-terminated, or NULL; `threads` are those that the world may have. False: js_faults() tells. */
bool EXPORT(js_open)(js_scene *js, const char *text, size_t size, const char *path, const char *const *sets,
                     int threads) {
    const skein_kind *const kinds[] = {render_view_kind(), NULL}; // besides the library's; nothing is exported here
    io_faults faults = {note_fault, js, 0, NULL};
    const js_files *before = js_files_use(&js->files);
    const char **all = without_output(text, size, sets);
    if (all && !size && io_path_is_mesh(path)) js->scene = io_scene_of_mesh(path, all, kinds, &faults);
    else if (all) js->scene = io_scene_read_text(text, size, path, all, kinds, &faults);
    free(all);
    if (js->scene) {
        skein_world_desc desc = skein_default_world_desc();
        desc.thread_count = threads;
        js->world = io_scene_build(js->scene, &desc, &faults);
        js->steps_per_frame = io_scene_steps_per_frame(io_scene_get(js->scene), &js->dt);
    }
    js_files_use(before);
    return js->world != NULL;
}

void EXPORT(js_close)(js_scene *js) {
    if (!js) return;
    skein_world_destroy(js->world);
    free(js->recording.data);
    io_scene_free(js->scene);
    json_decref(js->faults);
    for (size_t i = 0; i < js->files.count; i++) {
        free(js->files.data[i].path);
        free((void *)(uintptr_t)js->files.data[i].bytes);
    }
    free(js->files.data);
    free(js);
}

/* ---- what it is ---- */

/* The scene's own settings and its view, with the defaults of both; to be freed. */
char *EXPORT(js_settings)(const js_scene *js) {
    const io_scene_settings *s = io_scene_get(js->scene);
    const render_view *view = io_scene_view(js->scene);
    json_t *json = json_pack("{s:s, s:s, s:i, s:f, s:f, s:i, s:b}", "name", s->name, "description", s->description,
                             "frames", (int)s->frames, "fps", s->fps, "dt", js->dt, "stepsPerFrame",
                             js->steps_per_frame, "byKey", s->advance == IO_BY_KEY);
    json_t *given = json_object_get(io_scene_document(js->scene), "view"), *radius = json_real(view->particle_radius);
    json_object_set_new(json, "particleRadius", radius);
    json_object_set(json, "view", json_is_object(given) ? given : json_object());
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

static json_t *value_json(const skein_field *field, const skein_value *value) {
    char *text = io_value_json(field, value);
    json_t *json = text ? json_loads(text, JSON_DECODE_ANY, NULL) : NULL;
    free(text);
    return json ? json : json_null();
}

/* A field's present value and whether it can be set now go into its description. */
static void describe_state(const skein_world *world, skein_handle handle, const skein_kind *kind, json_t *fields) {
    size_t index;
    json_t *json;
    json_array_foreach(fields, index, json) {
        const char *name = json_string_value(json_object_get(json, "name"));
        const skein_field *field = skein_field_find(kind, name, NULL);
        skein_value value;
        if (!field || strchr(name, '*') || skein_get(world, handle, name, &value)) continue;
        json_object_set_new(json, "value", value_json(field, &value));
        json_object_set_new(json, "live", json_boolean(skein_field_is_live(world, handle, name)));
    }
}

/* The objects of a category with their fields and values; to be freed. */
char *EXPORT(js_objects)(const js_scene *js, int category) {
    json_t *list = json_array();
    for (size_t i = 0; i < skein_object_count(js->world, (skein_category)category); i++) {
        skein_handle handle = skein_object_at(js->world, (skein_category)category, i);
        const skein_kind *kind = skein_object_kind(js->world, handle);
        json_t *json = app_kind_json(kind);
        describe_state(js->world, handle, kind, json_object_get(json, "fields"));
        json_array_append_new(list, json);
    }
    char *text = json_dumps(list, JSON_COMPACT);
    json_decref(list);
    return text;
}

/* The tables: all kinds of a category, that of scenes or that of views among them; to be freed. */
char *EXPORT(js_kinds)(int category) {
    json_t *list = json_array();
    for (size_t i = 0; skein_kind_at((skein_category)category, i); i++)
        json_array_append_new(list, app_kind_json(skein_kind_at((skein_category)category, i)));
    if (category == SKEIN_SCENE) json_array_append_new(list, app_kind_json(io_scene_kind()));
    if (category == SKEIN_VIEW) json_array_append_new(list, app_kind_json(render_view_kind()));
    char *text = json_dumps(list, JSON_COMPACT);
    json_decref(list);
    return text;
}

/* The scene with what was set since, from which the same world can be opened; to be freed. */
char *EXPORT(js_document)(const js_scene *js) {
    return io_scene_text(js->scene);
}

int EXPORT(js_version)(void) {
    return skein_version();
}

/* ---- fields ---- */

/* Notes in the document what a living object was given, so that it can be opened again with it. */
static void note_set(js_scene *js, const char *path, const char *field, const char *value, io_faults *faults) {
    const skein_kind *const kinds[] = {render_view_kind(), NULL}; // besides the library's; nothing is exported here
    size_t size = strlen(path) + strlen(field) + strlen(value) + 3;
    char *set = malloc(size);
    json_t *notes = json_array();
    if (set && notes) {
        snprintf(set, size, "%s.%s=%s", path, field, value);
        io_scene_override(io_scene_document(js->scene), set, kinds, faults, notes);
    }
    json_decref(notes);
    free(set);
}

/* Sets a field of the object `index` of a category to a value in JSON, as scenes have it. `path` is its place in the
 * scene, for the document and for faults. False: js_faults() tells, and nothing has changed. */
bool EXPORT(js_set)(js_scene *js, int category, size_t index, const char *path, const char *field, const char *value) {
    skein_handle handle = skein_object_at(js->world, (skein_category)category, index);
    const skein_kind *kind = skein_object_kind(js->world, handle);
    io_faults faults = {note_fault, js, 0, NULL};
    io_place place = {"", path, &faults};
    json_t *json = json_loads(value, JSON_DECODE_ANY, NULL), *object = json_object();
    io_settings settings = {0};
    bool good = json && object && !json_object_set(object, field, json);
    if (!kind || !good) io_fault(place, field, SKEIN_ERROR_VALUE, "there is no such object, or the value is no JSON");
    else if (!strchr(field, '.')) good = io_settings_read(&settings, place, object, kind, NULL);
    else { // the reader of scenes knows groups as objects in objects
        const char *at = field;
        json_t *inner = json;
        json_incref(inner);
        for (const char *end = field + strlen(field); end > field;) {
            for (at = end; at > field && at[-1] != '.'; at--) {}
            char *key = strndup(at, (size_t)(end - at));
            json_t *outer = json_object();
            json_object_set_new(outer, key ? key : "", inner);
            free(key);
            inner = outer;
            end = at > field ? at - 1 : field;
        }
        good = io_settings_read(&settings, place, inner, kind, NULL);
        json_decref(inner);
    }
    for (size_t i = 0; good && kind && i < settings.count; i++)
        if (skein_set(js->world, handle, settings.data[i].name, settings.data[i].value)) {
            const skein_error *error = skein_world_error(js->world);
            io_fault_shown(place, error->where[0] ? error->where : field, error->status, error->message);
            good = false;
        }
    if (good && kind) note_set(js, path, field, value, &faults);
    io_settings_free(&settings);
    json_decref(object);
    json_decref(json);
    return good && kind;
}

/* A field's value as JSON, to be freed; NULL after a fault. */
char *EXPORT(js_get)(js_scene *js, int category, size_t index, const char *field) {
    skein_handle handle = skein_object_at(js->world, (skein_category)category, index);
    skein_value value;
    if (failed(js, skein_get(js->world, handle, field, &value))) return NULL;
    return io_value_json(skein_field_find(skein_object_kind(js->world, handle), field, NULL), &value);
}

/* ---- stepping ---- */

/* Takes so many steps, and leads what is pulled before each. False: js_faults() tells. */
bool EXPORT(js_step)(js_scene *js, int steps) {
    for (int i = 0; i < steps; i++) {
        viewer_grab_lead(&js->grab, js->world, js->dt);
        if (failed(js, skein_world_step(js->world, js->dt))) return false;
    }
    return true;
}

bool EXPORT(js_reset)(js_scene *js) {
    js->grab = (viewer_grab){0};
    return !failed(js, skein_world_reset(js->world));
}

double EXPORT(js_time)(const js_scene *js) {
    return skein_world_time(js->world);
}

bool EXPORT(js_time_set)(js_scene *js, double seconds) {
    return !failed(js, skein_world_time_set(js->world, seconds));
}

uint64_t EXPORT(js_hash)(const js_scene *js) {
    return skein_world_hash(js->world);
}

/* layout.js says what lies where, by the header; NULL after a fault. */
const skein_statistics *EXPORT(js_statistics)(js_scene *js) {
    return failed(js, skein_world_statistics(js->world, &js->statistics)) ? NULL : &js->statistics;
}

/* ---- the state ---- */

size_t EXPORT(js_count)(const js_scene *js) {
    return skein_particle_count(js->world);
}

/* Where the state itself lies: four floats a slot, and each particle's slot. */
const float *EXPORT(js_slots)(const js_scene *js, bool velocities) {
    return velocities ? skein_velocity_view(js->world).xyzw : skein_position_view(js->world).xyzw;
}
const uint32_t *EXPORT(js_slot_of)(const js_scene *js) {
    return skein_position_view(js->world).slot_of;
}

/* How many slots there are: some may be nobody's. */
size_t EXPORT(js_slot_count)(const js_scene *js) {
    skein_view view = skein_position_view(js->world);
    size_t most = 0;
    for (size_t i = 0; i < view.count; i++)
        if (view.slot_of[i] >= most) most = view.slot_of[i] + (size_t)1;
    return most;
}

/* Copies all positions or velocities, three floats each in the order of particles. */
bool EXPORT(js_copy)(js_scene *js, bool velocities, float *out) {
    size_t count = skein_particle_count(js->world);
    return !failed(js, velocities ? skein_velocities_copy_to(js->world, 0, count, skein_floats(out, 0))
                                  : skein_positions_copy_to(js->world, 0, count, skein_floats(out, 0)));
}

bool EXPORT(js_state_set)(js_scene *js, bool velocities, size_t first, size_t count, const double *xyz) {
    return !failed(js, velocities ? skein_velocities_set(js->world, first, count, xyz)
                                  : skein_positions_set(js->world, first, count, xyz));
}

/* ---- snapshots and recordings ---- */

size_t EXPORT(js_snapshot_size)(const js_scene *js) {
    return skein_snapshot_size(js->world);
}

/* How many bytes it took; 0 after a fault. */
size_t EXPORT(js_snapshot_write)(js_scene *js, void *out, size_t size) {
    size_t written = 0;
    return failed(js, skein_snapshot_write(js->world, out, size, &written)) ? 0 : written;
}

/* The hand lets go: what it held is as the snapshot has it. */
bool EXPORT(js_snapshot_read)(js_scene *js, const void *bytes, size_t size) {
    if (failed(js, skein_snapshot_read(js->world, bytes, size))) return false;
    js->grab = (viewer_grab){0};
    return true;
}

static bool put_recorded(void *user, const void *bytes, size_t size) {
    js_bytes *to = user;
    if (!io_grow(&to->data, &to->capacity, to->size + size, 1)) return false;
    memcpy(to->data + to->size, bytes, size);
    to->size += size;
    return true;
}

bool EXPORT(js_record_begin)(js_scene *js, const char *note) {
    js->recording.size = 0;
    skein_recorder to = {put_recorded, &js->recording, note};
    return !failed(js, skein_record_begin(js->world, &to));
}

bool EXPORT(js_record_end)(js_scene *js) {
    return !failed(js, skein_record_end(js->world));
}

/* What was recorded; it is there until the next recording begins. */
const char *EXPORT(js_recorded)(const js_scene *js) {
    return js->recording.data;
}
size_t EXPORT(js_recorded_size)(const js_scene *js) {
    return js->recording.size;
}

/* Does a recording again; what came of it as JSON to be freed, NULL after a fault. */
char *EXPORT(js_replay)(js_scene *js, const void *bytes, size_t size) {
    skein_difference d;
    if (failed(js, skein_replay(js->world, bytes, size, &d))) return NULL;
    json_t *json = json_pack("{s:I, s:b, s:i, s:b, s:b, s:b, s:b, s:s}", "steps", (json_int_t)d.steps, "found", d.found,
                             "particle", (int)d.particle, "exact", d.exact, "position", d.position, "velocity",
                             d.velocity, "whole", d.is_whole, "stopped", d.stopped);
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

/* ---- files for other programs ---- */

/* Where the vertices of a surface are; to be freed. */
static double *places_of(const js_scene *js, const skein_surface *s) {
    skein_view view = skein_position_view(js->world);
    double *places = malloc((3 * s->vertex_count + 1) * sizeof *places);
    for (size_t v = 0; places && v < s->vertex_count; v++) {
        const float *p = view.xyzw + 4 * (size_t)view.slot_of[s->particle_of_vertex[v]];
        for (size_t k = 0; k < 3; k++) places[3 * v + k] = (double)p[k];
    }
    return places;
}

/* A body as it stands, in a format of one frame ("obj", "ply", "stl"), as the command writes it. `out` receives where the
 * bytes are, to be freed, and how many. */
bool EXPORT(js_clip)(js_scene *js, size_t body, const char *name, uint32_t out[2]) {
    static const io_clip_format *const formats[] = {&io_clip_obj, &io_clip_ply, &io_clip_stl};
    const io_clip_format *format = NULL;
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (!strcmp(formats[i]->kind.name, name)) format = formats[i];
    skein_handle handle = skein_object_at(js->world, SKEIN_BODY, body);
    io_faults faults = {note_fault, js, 0, NULL};
    io_place place = {"", name, &faults};
    skein_error error = {0};
    skein_surface s;
    out[0] = out[1] = 0;
    if (!format) {
        io_fault(place, "", SKEIN_ERROR_NAME, "is no format of one frame: expected obj, ply or stl");
        return false;
    }
    if (failed(js, skein_body_surface(js->world, handle, &s))) return false;
    if (format->needs_faces && !s.face_count) {
        io_fault(place, "", SKEIN_ERROR_VALUE, "the body has no faces");
        return false;
    }
    uint32_t *lists = NULL;
    const skein_mesh whole = {NULL, s.vertex_count, s.face_sizes, s.face_count, s.face_vertices, s.face_vertex_count};
    double *places = io_surface_uncut(js->world, handle, &s, &lists) ? places_of(js, &s) : NULL;
    io_clip_params params = {.normals = SKEIN_NORMALS_AREA, .scale = 1};
    io_clip clip = {.name = "body",
                    .mesh = {places, s.vertex_count, s.face_sizes, s.face_count, s.face_vertices, s.face_vertex_count},
                    .corner_uv = s.corner_uv,
                    .fps = io_scene_get(js->scene)->fps,
                    .samples = 1,
                    .read_path = "",
                    .params = &params};
    io_mesh read = {0};
    char *path = format->keeps_marks ? io_scene_mesh_path(js->scene, body) : NULL;
    const js_files *before = js_files_use(&js->files);
    if (path && !io_mesh_read(path, &read, (io_warnings){NULL, NULL}, NULL) && io_mesh_has_faces_of(&read, &whole)) {
        io_mesh_uncut(&read, js->world, handle);
        clip.read = &read;
        clip.read_path = path;
    }
    skein_status status =
        places ? format->write(&clip, name, &error) : io_error_set(&error, SKEIN_ERROR_MEMORY, name, "out of memory");
    js_files_use(before);
    if (status) note_fault(js, &error);
    js_file file = js_file_take_written();
    out[0] = (uint32_t)(uintptr_t)file.bytes;
    out[1] = (uint32_t)file.size;
    io_mesh_free(&read);
    free(path);
    free(places);
    free(lists);
    return !status;
}

/* ---- formulas ---- */

static void add_text(void *user, const char *text) {
    put_recorded(user, text, strlen(text));
}

/* A formula by itself: {"value": its operations as text with those of its gradient, ...} or {"fault": words, with the
 * place shown}; to be freed. `particles` of 0: as many as it names; `result` is a skein_formula_result. */
char *EXPORT(js_formula)(const char *text, int particles, bool velocities, int result) {
    skein_formula_desc desc = {.text = text,
                               .particles = particles,
                               .velocities = velocities,
                               .comparison = result == SKEIN_FORMULA_NUMBER,
                               .result = (skein_formula_result)result};
    skein_formula_mark mark = {0};
    skein_error error = {0};
    js_bytes shown = {0};
    skein_formula *formula = skein_formula_create(&desc, &mark, &error);
    json_t *json = json_object();
    if (formula) {
        skein_formula_info info = skein_formula_about(formula);
        if (skein_formula_emit(formula, SKEIN_FORMULA_GRAPH, add_text, &shown, &error)) shown.size = 0;
        json_object_set_new(json, "graph", json_stringn(shown.data, shown.size));
        json_object_set_new(json, "operations", json_integer((json_int_t)info.operations));
        json_object_set_new(json, "particles", json_integer(info.particles));
        if (skein_formula_warning(formula, 0, NULL))
            json_object_set_new(json, "warning", json_string(skein_formula_warning(formula, 0, NULL)));
    } else {
        char lines[1024] = "";
        skein_formula_show(text, &mark, lines, sizeof lines);
        json_object_set_new(json, "fault", json_string(error.message));
        json_object_set_new(json, "shown", json_string(lines));
        json_object_set_new(json, "line", json_integer((json_int_t)mark.line));
        json_object_set_new(json, "column", json_integer((json_int_t)mark.column));
        json_object_set_new(json, "width", json_integer((json_int_t)mark.width));
    }
    skein_formula_destroy(formula);
    free(shown.data);
    char *words = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return words;
}

/* The functions of the language, {usage, help} each; to be freed. */
char *EXPORT(js_functions)(void) {
    json_t *list = json_array();
    const char *usage, *help;
    for (size_t i = 0; skein_formula_function(i, &usage, &help); i++)
        json_array_append_new(list, json_pack("{ssss}", "usage", usage, "help", help));
    char *text = json_dumps(list, JSON_COMPACT);
    json_decref(list);
    return text;
}

/* ---- elsewhere at once ---- */

/* A body's: `way` has a rotation's rows and then a shift. */
bool EXPORT(js_body_teleport)(js_scene *js, size_t body, const double way[12]) {
    return !failed(js, skein_body_teleport(js->world, skein_object_at(js->world, SKEIN_BODY, body), way, way + 9));
}

/* Where a collider was set since the last step is no way, but where it stands. */
bool EXPORT(js_collider_teleport)(js_scene *js, size_t collider) {
    return !failed(js, skein_collider_teleport(js->world, skein_object_at(js->world, SKEIN_COLLIDER, collider)));
}

/* Where a mesh collider's vertices are from now on, `count` of them. */
bool EXPORT(js_collider_vertices)(js_scene *js, size_t collider, const double *positions, size_t count) {
    skein_handle handle = skein_object_at(js->world, SKEIN_COLLIDER, collider);
    return !failed(js, skein_collider_vertices_set(js->world, handle, positions, count));
}

/* ---- the hand ---- */

bool EXPORT(js_is_held)(const js_scene *js, uint32_t particle) {
    return viewer_is_held(js->world, particle);
}

bool EXPORT(js_hold)(js_scene *js, size_t particle, bool held) {
    return !failed(js, skein_particle_pin(js->world, particle, held));
}

bool EXPORT(js_move_pin)(js_scene *js, uint32_t particle, double x, double y, double z) {
    const double place[3] = {x, y, z};
    return !failed(js, skein_pins_move(js->world, &particle, 1, place));
}

/* Pulls a particle to a place from now on. */
void EXPORT(js_pull)(js_scene *js, uint32_t particle, double x, double y, double z) {
    if (!js->grab.holding || js->grab.particle != particle) {
        viewer_grab_release(&js->grab, js->world);
        viewer_grab_take(&js->grab, js->world, 0, particle);
    }
    js->grab.goal[0] = x;
    js->grab.goal[1] = y;
    js->grab.goal[2] = z;
    js->grab.moved = true;
}

void EXPORT(js_let_go)(js_scene *js) {
    viewer_grab_release(&js->grab, js->world);
}

/* The particle that a pointer is over: a surface's corner or the nearest ball, whichever the ray meets first. `ray` is
 * origin and direction, a ball's radius, and how much wider the pointer gets with each metre. -1: none. */
int EXPORT(js_pick)(const js_scene *js, const double ray[8], double *t) {
    skein_hit hit = {.t = INFINITY};
    uint32_t particle;
    double along = INFINITY;
    int picked = -1;
    *t = INFINITY;
    if (!skein_ray_cast(js->world, ray, ray + 3, SKEIN_BODY, &hit) && hit.t < INFINITY) {
        picked = (int)hit.particle;
        *t = hit.t;
    }
    if (!skein_particle_near_ray(js->world, ray, ray + 3, ray[6], ray[7], &particle, &along) && along < *t) {
        picked = (int)particle;
        *t = along;
    }
    if (picked >= 0 && !skein_ray_cast(js->world, ray, ray + 3, SKEIN_COLLIDER, &hit) && hit.t < *t - 2 * ray[6])
        picked = -1;
    return picked;
}

/* Cuts a body by a blade, three corners. Returns how many faces that took away; -1 after a fault. */
int EXPORT(js_cut)(js_scene *js, size_t body, const double (*blade)[3]) {
    size_t count;
    skein_handle handle = skein_object_at(js->world, SKEIN_BODY, body);
    return failed(js, skein_cut(js->world, handle, blade, &count)) ? -1 : (int)count;
}

bool EXPORT(js_mend)(js_scene *js, size_t body) {
    return !failed(js, skein_cut_mend(js->world, skein_object_at(js->world, SKEIN_BODY, body)));
}

/* A byte for each face of a body's surface, whether it is cut, and how often that has changed; false after a fault. */
bool EXPORT(js_cuts)(js_scene *js, size_t body, uint32_t out[3]) {
    skein_cuts cuts;
    if (failed(js, skein_body_cuts(js->world, skein_object_at(js->world, SKEIN_BODY, body), &cuts))) return false;
    out[0] = (uint32_t)(uintptr_t)cuts.face, out[1] = (uint32_t)cuts.count, out[2] = (uint32_t)cuts.changes;
    return true;
}

/* ---- what is drawn ---- */

/* A body's surface: pointers and counts, in the order of layout below. */
bool EXPORT(js_surface)(js_scene *js, size_t body, uint32_t out[10]) {
    skein_surface s;
    if (failed(js, skein_body_surface(js->world, skein_object_at(js->world, SKEIN_BODY, body), &s))) return false;
    const void *pointers[] = {s.particle_of_vertex, s.face_sizes, s.face_vertices, s.corner_uv};
    for (int i = 0; i < 4; i++) out[i] = (uint32_t)(uintptr_t)pointers[i];
    const size_t counts[] = {s.first_particle, s.particle_count,    s.vertex_count,
                             s.face_count,     s.face_vertex_count, s.grid_rows};
    for (int i = 0; i < 6; i++) out[4 + i] = (uint32_t)counts[i];
    return true;
}

/* A surface's vertices and unit normals now, three floats each. */
bool EXPORT(js_vertices)(js_scene *js, size_t body, float *positions, float *normals) {
    return !failed(js, skein_body_vertices_copy(js->world, skein_object_at(js->world, SKEIN_BODY, body), 1,
                                                skein_floats(positions, 0), skein_floats(normals, 0)));
}

/* A collider's place and rotation (rows of a matrix): twelve numbers. */
bool EXPORT(js_pose)(js_scene *js, size_t collider, double out[12]) {
    skein_pose pose;
    if (failed(js, skein_collider_pose(js->world, skein_object_at(js->world, SKEIN_COLLIDER, collider), &pose)))
        return false;
    memcpy(out, pose.position, sizeof pose.position);
    memcpy(out + 3, pose.rotation, sizeof pose.rotation);
    return true;
}

/* What a collider or body looks like, whatever its kind is; JSON to be freed. */
char *EXPORT(js_shape)(js_scene *js, int category, size_t index) {
    static const char *const sorts[] = {"surface", "plane", "ball", "bowl", "capsule", "box", "chain", "birds"};
    skein_shape s;
    skein_handle handle = skein_object_at(js->world, (skein_category)category, index);
    if (failed(js, skein_shape_of(js->world, handle, &s))) return NULL;
    json_t *json = json_pack("{s:s, s:f, s:[f,f,f], s:[f,f,f]}", "sort", sorts[s.sort], "radius", s.radius, "axis",
                             s.axis[0], s.axis[1], s.axis[2], "size", s.size[0], s.size[1], s.size[2]);
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

/* A collider's distances at points, or a field's forces (three numbers each), into `out`. */
bool EXPORT(js_probe)(js_scene *js, bool force, size_t index, size_t count, const double *points, double *out) {
    skein_handle handle = skein_object_at(js->world, force ? SKEIN_FORCE : SKEIN_COLLIDER, index);
    return !failed(js, force ? skein_force_probe(js->world, handle, count, points, out)
                             : skein_collider_probe(js->world, handle, count, points, out, NULL));
}

/* ---- contacts ---- */

/* The number of an object within its category. */
static double place_of(const skein_world *world, skein_category category, skein_handle object) {
    size_t count = skein_object_count(world, category);
    for (size_t i = 0; i < count; i++) {
        skein_handle other = skein_object_at(world, category, i);
        if (!memcmp(&other, &object, sizeof other)) return (double)i;
    }
    return -1;
}

/* Particles that touch colliders, six numbers each: the particle, the collider's number, the normal, the gap. `out` receives
 * where they are, to be freed, and how many contacts. */
bool EXPORT(js_contacts)(js_scene *js, uint32_t out[2]) {
    size_t count = 0, most = 0;
    skein_contact *contacts = NULL;
    double *numbers = NULL;
    bool good = !failed(js, skein_contacts_copy(js->world, NULL, 0, &most));
    if (good) contacts = malloc((most + 1) * sizeof *contacts), numbers = malloc((6 * most + 1) * sizeof *numbers);
    good = good && contacts && numbers && !failed(js, skein_contacts_copy(js->world, contacts, most, &count));
    for (size_t i = 0; good && i < count && i < most; i++) {
        const skein_contact *c = &contacts[i];
        double *to = numbers + 6 * i;
        to[0] = c->particle, to[1] = place_of(js->world, SKEIN_COLLIDER, c->collider);
        memcpy(to + 2, c->normal, sizeof c->normal);
        to[5] = c->gap;
    }
    free(contacts);
    if (!good) free(numbers);
    out[0] = good ? (uint32_t)(uintptr_t)numbers : 0;
    out[1] = good ? (uint32_t)count : 0;
    return good;
}

/* Features of surfaces that touch, fifteen numbers each: the rule's number, whether they are edges, four particles, their
 * weights, the normal, the gap and the thickness. */
bool EXPORT(js_surface_contacts)(js_scene *js, uint32_t out[2]) {
    size_t count = 0, most = 0;
    skein_surface_contact *contacts = NULL;
    double *numbers = NULL;
    bool good = !failed(js, skein_surface_contacts_copy(js->world, NULL, 0, &most));
    if (good) contacts = malloc((most + 1) * sizeof *contacts), numbers = malloc((15 * most + 1) * sizeof *numbers);
    good = good && contacts && numbers && !failed(js, skein_surface_contacts_copy(js->world, contacts, most, &count));
    for (size_t i = 0; good && i < count && i < most; i++) {
        const skein_surface_contact *c = &contacts[i];
        double *to = numbers + 15 * i;
        to[0] = place_of(js->world, SKEIN_FORCE, c->rule), to[1] = c->edges;
        for (int k = 0; k < 4; k++) to[2 + k] = c->particle[k];
        memcpy(to + 6, c->weight, sizeof c->weight);
        memcpy(to + 10, c->normal, sizeof c->normal);
        to[13] = c->gap, to[14] = c->thickness;
    }
    free(contacts);
    if (!good) free(numbers);
    out[0] = good ? (uint32_t)(uintptr_t)numbers : 0;
    out[1] = good ? (uint32_t)count : 0;
    return good;
}

/* Constraint `index` of an object, operation by operation, with their derivatives; JSON to be freed, NULL after a fault. */
char *EXPORT(js_operations)(js_scene *js, int category, size_t object, size_t index) {
    enum { MOST = 256, MOST_COORDINATES = 24 };
    skein_constraint_value value;
    skein_handle handle = skein_object_at(js->world, (skein_category)category, object);
    skein_operation *operations = malloc(MOST * sizeof *operations);
    double *derivatives = malloc(MOST * MOST_COORDINATES * sizeof *derivatives);
    json_t *list = json_array();
    size_t count = 0;
    bool good =
        operations && derivatives &&
        !failed(js, skein_constraint_evaluate(js->world, handle, index, &value, NULL, NULL, 0)) &&
        !failed(js, skein_constraint_operations(js->world, handle, index, operations, derivatives, MOST, &count));
    size_t wide = good ? 3 * value.particle_count : 0;
    for (size_t i = 0; good && i < count && i < MOST; i++) {
        const skein_operation *o = &operations[i];
        json_t *operands = json_array(), *slopes = json_array();
        for (int k = 0; k < o->operand_count; k++)
            json_array_append_new(operands, json_integer((json_int_t)o->operand[k]));
        for (size_t k = 0; k < wide; k++) json_array_append_new(slopes, json_real(derivatives[i * wide + k]));
        json_array_append_new(list, json_pack("{s:s, s:s, s:f, s:o, s:o}", "name", o->name, "label", o->label, "value",
                                              o->value, "operands", operands, "derivatives", slopes));
    }
    free(operations);
    free(derivatives);
    char *text = good ? json_dumps(list, JSON_COMPACT) : NULL;
    json_decref(list);
    return text;
}

/* Pairs of particles that a rule keeps at a distance: copies up to `most`, two indices each; returns how many. */
size_t EXPORT(js_springs)(js_scene *js, uint32_t *out, size_t most) {
    size_t count = 0;
    skein_spring *springs = most ? malloc(most * sizeof *springs) : NULL;
    if ((most && !springs) || failed(js, skein_springs_copy(js->world, springs, springs ? most : 0, &count))) count = 0;
    for (size_t i = 0; i < most && i < count; i++) memcpy(out + 2 * i, springs[i].particle, 2 * sizeof *out);
    free(springs);
    return count;
}

/* Constraint `index` of an object as it stands, with its gradient; JSON to be freed, NULL after a fault. */
char *EXPORT(js_constraint)(js_scene *js, int category, size_t object, size_t index) {
    enum { MOST = 8 };
    skein_constraint_value value;
    uint32_t particles[MOST];
    double gradient[3 * MOST];
    skein_handle handle = skein_object_at(js->world, (skein_category)category, object);
    if (failed(js, skein_constraint_evaluate(js->world, handle, index, &value, particles, gradient, MOST))) return NULL;
    json_t *json = json_pack("{s:f, s:s, s:s, s:b, s:b}", "value", value.value, "label", value.label, "text",
                             value.text, "oneSided", value.one_sided, "energy", value.is_energy);
    json_t *indices = json_array(), *vectors = json_array();
    for (size_t i = 0; i < MOST && i < value.particle_count; i++) {
        json_array_append_new(indices, json_integer(particles[i]));
        json_array_append_new(vectors, json_pack("[f,f,f]", gradient[3 * i], gradient[3 * i + 1], gradient[3 * i + 2]));
    }
    json_object_set_new(json, "particles", indices);
    json_object_set_new(json, "gradient", vectors);
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

size_t EXPORT(js_constraint_count)(js_scene *js, int category, size_t object) {
    size_t count = 0;
    skein_handle handle = skein_object_at(js->world, (skein_category)category, object);
    return failed(js, skein_constraint_count(js->world, handle, &count)) ? 0 : count;
}
