/* The second half of the scene reader: from the document to a world, object by object. */
#include <skein/attach.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/cache.h"
#include "io/groups.h"
#include "io/mesh.h"
#include "io/own_kinds.h"
#include "io/reach.h"
#include "io/scene_names.h"
#include "io/scene_settings.h"
#include "solvers/cholmod.h"

typedef struct builder {
    skein_world *world;
    const char *file;
    const skein_world_desc *desc;
    io_faults *faults;
    bool body_missing; /* a body had a fault, so that particles have other numbers than the scene means */
    bool collider_missing;
} builder;

/* A fault that the library found: its place is a field's name, or nothing. */
static void report_library_fault(const builder *b, io_place place, const char *nothing) {
    const skein_error *error = skein_world_error(b->world);
    io_fault(place, error->where[0] ? error->where : nothing, error->status, "%s", error->message);
}

/* The same about an object of a kind. What is wrong in a formula is shown there, in lines of their own. */
static void report_object_fault(const builder *b, io_place place, const skein_kind *kind, const char *nothing) {
    const skein_error *error = skein_world_error(b->world);
    const skein_field *field = skein_field_find(kind, error->where, NULL);
    bool formula = field && field->type == SKEIN_FIELD_TEXT && skein_field_find(kind, "parameters.*", NULL);
    if (formula) io_fault_shown(place, error->where, error->status, error->message);
    else report_library_fault(b, place, nothing);
}

/* ---- bodies: the mesh is read here ---- */

static void pass_warning(void *user, const char *line) {
    const skein_world_desc *desc = user;
    if (desc->log) desc->log(desc->log_user, SKEIN_LOG_WARNING, line);
}

/* Reads a mesh whose path is relative to the scene's folder. */
static bool read_mesh(const builder *b, io_place place, const char *file, io_mesh *mesh) {
    char *path = io_path_beside(b->file, file);
    skein_status status = SKEIN_ERROR_MEMORY;
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    // the library only reads a world's description, and so does pass_warning
    io_warnings warnings = {b->desc ? pass_warning : NULL, (void *)(uintptr_t)b->desc};
    if (path && !io_reach_check(place, "mesh", file, path)) {
        free(path);
        return false;
    }
    if (path) status = io_mesh_read(path, mesh, warnings, &error);
    // the folder that tools/fetch-mesh fills
    bool fetched = path && status == SKEIN_ERROR_FILE && strstr(path, "meshes/fetched/") && access(path, F_OK);
    free(path);
    if (status)
        io_fault(place, "mesh", status, "%s%s%s%s", error.where, error.where[0] ? ": " : "", error.message,
                 fetched ? "; `make demo` or `tools/fetch-mesh` in Skein's source fetches it" : "");
    return !status;
}

/* Hands a mesh's texture coordinates on, corner by corner. A corner without any, or with what no picture has, gets 0.
 */
static bool add_uv(const builder *b, io_place place, skein_handle body, const io_mesh *mesh) {
    const double most = 1e9;
    if (!mesh->uv_count) return true;
    float *corner_uv = calloc(mesh->face_vertex_count, 2 * sizeof *corner_uv);
    if (!corner_uv) {
        io_fault(place, "mesh", SKEIN_ERROR_MEMORY, "out of memory");
        return false;
    }
    for (size_t c = 0; c < mesh->face_vertex_count; c++) {
        if (mesh->face_uvs[c] == IO_NO_UV) continue;
        const double *uv = &mesh->uvs[2 * (size_t)mesh->face_uvs[c]];
        for (size_t k = 0; k < 2; k++) corner_uv[2 * c + k] = uv[k] >= -most && uv[k] <= most ? (float)uv[k] : 0;
    }
    bool good = !skein_body_uv_set(b->world, body, corner_uv, mesh->face_vertex_count);
    if (!good) report_library_fault(b, place, "mesh");
    free(corner_uv);
    return good;
}

static bool add_body(const builder *b, io_place place, const skein_kind *kind, const io_settings *settings) {
    const char *file = io_settings_text(settings, "mesh");
    bool has_mesh = file && file[0];
    io_mesh mesh = {0};
    if (has_mesh && !read_mesh(b, place, file, &mesh)) return false;
    // as polygons they would be faces without any sense
    if (mesh.tetrahedra && strcmp(kind->name, "tetrahedra") != 0) {
        io_fault(place, "mesh", SKEIN_ERROR_MESH,
                 "'%s' is made of tetrahedra: a %s needs faces, from .obj, .ply, .stl, .glb or .off", file, kind->name);
        io_mesh_free(&mesh);
        return false;
    }
    skein_mesh view = io_mesh_view(&mesh);
    skein_handle body;
    bool good = !skein_body_add(b->world, kind->name, has_mesh ? &view : NULL, settings->data, &body);
    if (!good) report_library_fault(b, place, "");
    good = good && add_uv(b, place, body, &mesh);
    io_mesh_free(&mesh);
    return good;
}

/* A collider may be made from a mesh, too. */
static bool add_collider(const builder *b, io_place place, const skein_kind *kind, const io_settings *settings) {
    const char *file = skein_field_find(kind, "mesh", NULL) ? io_settings_text(settings, "mesh") : NULL;
    bool has_mesh = file && file[0];
    io_mesh mesh = {0};
    if (has_mesh && !read_mesh(b, place, file, &mesh)) return false;
    if (mesh.tetrahedra) {
        io_fault(place, "mesh", SKEIN_ERROR_MESH,
                 "'%s' is made of tetrahedra: a %s needs faces, from .obj, .ply, .stl, .glb or .off", file, kind->name);
        io_mesh_free(&mesh);
        return false;
    }
    skein_mesh view = io_mesh_view(&mesh);
    bool good = !skein_collider_add_mesh(b->world, kind->name, has_mesh ? &view : NULL, settings->data, NULL);
    if (!good) report_object_fault(b, place, kind, "");
    io_mesh_free(&mesh);
    return good;
}

/* ---- constraints: the particles are read here ---- */

typedef struct index_list {
    uint32_t *data;
    size_t count, capacity;
} index_list;

/* `index` is the number's place in the list, for the message. */
static bool add_index(index_list *list, io_place place, size_t index, const json_t *json) {
    char words[IO_JSON_WORDS_SIZE], member[40];
    long long value = json_integer_value(json);
    snprintf(member, sizeof member, "particles.%zu", index);
    if (!json_is_integer(json) || value < 0 || value >= UINT32_MAX) {
        io_fault(place, member, SKEIN_ERROR_VALUE, "expected the number of a particle, not %s",
                 io_json_words(json, words));
        return false;
    }
    if (!io_grow(&list->data, &list->capacity, list->count + 1, sizeof *list->data)) {
        io_fault(place, member, SKEIN_ERROR_MEMORY, "out of memory");
        return false;
    }
    list->data[list->count++] = (uint32_t)value;
    return true;
}

/* [[0, 1], [1, 2]]: a list for each constraint; or all of them in one flat list. */
static bool read_indices(index_list *list, io_place place, const json_t *json, size_t arity) {
    char words[IO_JSON_WORDS_SIZE], member[40];
    for (size_t i = 0; i < json_array_size(json); i++) {
        const json_t *item = json_array_get(json, i);
        snprintf(member, sizeof member, "particles.%zu", i);
        if (!json_is_array(item)) {
            if (!add_index(list, place, i, item)) return false;
        } else if (json_array_size(item) != arity) {
            io_fault(place, member, SKEIN_ERROR_VALUE, "expected the numbers of %zu particles, not %s", arity,
                     io_json_words(item, words));
            return false;
        }
        for (size_t k = 0; k < json_array_size(item); k++)
            if (!add_index(list, place, i, json_array_get(item, k))) return false;
    }
    if (list->count && list->count % arity == 0) return true;
    io_fault(place, "particles", SKEIN_ERROR_VALUE,
             "expected the numbers of %zu particles for each constraint, [[0, 1], [1, 2]], say; %s%s", arity,
             json ? "not " : "it is missing", json ? io_json_words(json, words) : "");
    return false;
}

/* A member that nobody reads would be a misspelt one. */
static bool only_known(io_place place, const json_t *json) {
    static const char *const known[] = {"body", "over", "pins", "to"};
    char hint[IO_HINT_SIZE], member[128];
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)(uintptr_t)json, key, value) {
        size_t k = 0;
        while (k < 4 && strcmp(key, known[k]) != 0) k++;
        if (k < 4) continue;
        snprintf(member, sizeof member, "particles.%s", key);
        io_hint(key, known, 4, hint);
        io_fault(place, member, SKEIN_ERROR_NAME, "there is no '%.100s' here%s", key,
                 hint[0] ? hint : ": expected {\"body\": \"flag\", \"over\": \"edges\"}, say");
        return false;
    }
    return true;
}

enum { BODY_WORDS_SIZE = 256 };

/* What a body that is not there may have been meant to be: the nearest name, or else all that there are. */
static const char *hint_body(const builder *b, const char *given, char words[BODY_WORDS_SIZE]) {
    enum { MOST = 64 };
    const char *names[MOST];
    char path[64], hint[IO_HINT_SIZE];
    size_t count = 0, at = 0;
    for (size_t i = 0; i < skein_object_count(b->world, SKEIN_BODY) && count < MOST; i++) {
        skein_value name;
        snprintf(path, sizeof path, "bodies.%zu.name", i);
        if (!skein_get_path(b->world, path, &name) && name.text[0]) names[count++] = name.text;
    }
    snprintf(words, BODY_WORDS_SIZE, "%s", io_group_words(b->world, given));
    if (!words[0]) snprintf(words, BODY_WORDS_SIZE, "%s", io_hint(given, names, count, hint));
    if (words[0]) return words;
    if (!count) snprintf(words, BODY_WORDS_SIZE, ": no body of the scene has a name; a number says which, from 0 on");
    for (size_t i = 0; i < count && at < BODY_WORDS_SIZE; i++)
        at += (size_t)snprintf(words + at, BODY_WORDS_SIZE - at, "%s'%s'", i ? ", " : ": the scene has ", names[i]);
    return words;
}

/* The body that a member names, or says the number of. */
static bool find_body(const builder *b, io_place place, const json_t *json, const char *member, skein_handle *handle) {
    char shown[IO_JSON_WORDS_SIZE], path[128], words[BODY_WORDS_SIZE];
    const json_t *body = json_object_get(json, member);
    *handle = (skein_handle){UINT32_MAX, 0, 0};
    for (size_t i = 0; i < skein_object_count(b->world, SKEIN_BODY); i++) {
        skein_handle at = skein_object_at(b->world, SKEIN_BODY, i);
        skein_value name;
        snprintf(path, sizeof path, "bodies.%zu.name", i);
        bool named = json_is_string(body) && !skein_get_path(b->world, path, &name) &&
                     !strcmp(name.text, json_string_value(body));
        if (named || (json_is_integer(body) && json_integer_value(body) == (json_int_t)i)) *handle = at;
    }
    if (skein_handle_valid(b->world, *handle)) return true;
    snprintf(path, sizeof path, "particles.%s", member);
    if (b->body_missing) return false;
    if (json_is_string(body))
        io_fault(place, path, SKEIN_ERROR_NAME, "there is no body '%s'%s", json_string_value(body),
                 hint_body(b, json_string_value(body), words));
    else if (json_is_integer(body))
        io_fault(place, path, SKEIN_ERROR_NAME,
                 "there is no body %" JSON_INTEGER_FORMAT ": the scene has %zu, counted from 0",
                 json_integer_value(body), skein_object_count(b->world, SKEIN_BODY));
    else
        io_fault(place, path, SKEIN_ERROR_NAME, "expected the name or number of a body%s", io_json_instead(body, shown));
    return false;
}

/* {"body": "flag", "over": "hinges"}: the body by its name or number. */
static bool find_elements(const builder *b, io_place place, index_list *list, const json_t *json, size_t arity) {
    static const char *const words[] = {"edges", "triangles", "hinges", "tetrahedra"};
    static const size_t arities[] = {2, 3, 4, 4};
    char shown[IO_JSON_WORDS_SIZE];
    const json_t *over = json_object_get(json, "over");
    skein_handle handle;
    if (!find_body(b, place, json, "body", &handle)) return false;
    size_t what = 0, count;
    while (what < 4 && !(json_is_string(over) && !strcmp(json_string_value(over), words[what]))) what++;
    if (what == 4 || arities[what] != arity) {
        io_fault(
            place, "particles.over", SKEIN_ERROR_VALUE,
            "expected \"edges\" (of 2 particles), \"triangles\" (3), \"hinges\" or \"tetrahedra\" (4) for a constraint on "
            "%zu particles%s",
            arity, io_json_instead(over, shown));
        return false;
    }
    skein_body_elements(b->world, handle, (skein_elements)what, NULL, 0, &count);
    if (!io_grow(&list->data, &list->capacity, count * arity, sizeof *list->data) ||
        skein_body_elements(b->world, handle, (skein_elements)what, list->data, count, &count)) {
        io_fault(place, "particles", SKEIN_ERROR_MEMORY, "out of memory");
        return false;
    }
    list->count = count * arity;
    if (!count) io_fault(place, "particles.over", SKEIN_ERROR_VALUE, "the body has no %s", words[what]);
    return count > 0;
}

/* {"body": "flag", "pins": [0, 16], "to": "jelly"}: each of them with the triangle of the other body that is nearest. */
static bool find_attachments(const builder *b, io_place place, index_list *list, const json_t *json, size_t arity) {
    skein_handle body, to;
    size_t count = 0;
    if (arity != 4 || json_object_get(json, "over")) {
        io_fault(place, "particles", SKEIN_ERROR_VALUE,
                 "\"to\" is for constraints on a particle and a triangle, such as attachment, and without \"over\"");
        return false;
    }
    if (!find_body(b, place, json, "body", &body) || !find_body(b, place, json, "to", &to)) return false;
    const json_t *pins = json_object_get(json, "pins");
    char *joined = json_is_string(pins) ? NULL : io_json_join(pins);
    const char *text = json_is_string(pins) ? json_string_value(pins) : joined;
    if (!text || !text[0]) {
        io_fault(place, "particles.pins", SKEIN_ERROR_VALUE,
                 "expected which particles are tied: [0, 1], {\"box\": [...]} or {\"sphere\": [...]}");
        free(joined);
        return false;
    }
    skein_status status = skein_body_select(b->world, body, text, NULL, 0, &count);
    if (!status && !io_grow(&list->data, &list->capacity, 5 * count, sizeof *list->data)) {
        free(joined);
        io_fault(place, "particles", SKEIN_ERROR_MEMORY, "out of memory");
        return false;
    }
    uint32_t *chosen = list->data ? list->data + 4 * count : NULL; // behind what is made of them
    if (!status) status = skein_body_select(b->world, body, text, chosen, count, &count);
    if (!status) status = skein_attachments_find(b->world, chosen, count, to, list->data);
    free(joined);
    list->count = 4 * count;
    if (status) report_library_fault(b, place, "particles");
    else if (!count) io_fault(place, "particles.pins", SKEIN_ERROR_VALUE, "there is no such particle in the body");
    return !status && count > 0;
}

static bool read_particles(const builder *b, io_place place, index_list *list, const json_t *json, size_t arity) {
    if (!json_is_object(json)) return read_indices(list, place, json, arity);
    if (!only_known(place, json)) return false;
    return json_object_get(json, "to") ? find_attachments(b, place, list, json, arity)
                                       : find_elements(b, place, list, json, arity);
}

static void add_constraint(const builder *b, io_place place, const skein_kind *kind, const json_t *object,
                           const io_settings *settings) {
    index_list list = {0};
    size_t arity;
    if (skein_constraint_arity(b->world, kind->name, settings->data, &arity))
        report_object_fault(b, place, kind, "particles");
    else if (read_particles(b, place, &list, json_object_get(object, "particles"), arity) && !b->body_missing &&
             skein_constraint_add(b->world, kind->name, list.data, list.count / arity, settings->data, NULL))
        report_object_fault(b, place, kind, "particles");
    free(list.data);
}

/* ---- motions: the point cache is read here ---- */

static bool add_motion(const builder *b, io_place place, const skein_kind *kind, const io_settings *settings) {
    io_cache cache = {0};
    bool has_file = skein_field_find(kind, "file", NULL) != NULL;
    if (b->body_missing && has_file) return false; // its points would be counted against the wrong bodies
    if (has_file && !io_cache_read(&cache, b->world, place, settings)) return false;
    bool good = !skein_motion_add(b->world, kind->name, has_file ? &cache.track : NULL, settings->data, NULL);
    if (!good) report_library_fault(b, place, "");
    io_cache_free(&cache);
    return good;
}

/* ---- objects ---- */

/* The kind that an object names by its "type"; NULL after a fault. */
static const skein_kind *kind_of(io_place place, const json_t *object, skein_category category) {
    char words[IO_JSON_WORDS_SIZE];
    if (!json_is_object(object)) {
        io_fault(place, "", SKEIN_ERROR_VALUE, "expected an object, { \"type\": ... }, not %s",
                 io_json_words(object, words));
        return NULL;
    }
    const json_t *type = json_object_get(object, "type");
    if (!json_is_string(type)) {
        io_fault(place, "type", SKEIN_ERROR_VALUE, "expected the name of a %s%s; `skein list` shows them",
                 skein_category_text(category), io_json_instead(type, words));
        return NULL;
    }
    skein_error error = {SKEIN_OK, "", ""};
    const skein_kind *kind = io_kind_find(category, json_string_value(type), &error);
    if (!kind) io_fault(place, "type", error.status, "%s", error.message);
    return kind;
}

static bool add_of_kind(const builder *b, io_place place, const json_t *object, const skein_kind *kind,
                        const io_settings *settings) {
    skein_status status = SKEIN_OK;
    switch (kind->category) {
    case SKEIN_BODY: return add_body(b, place, kind, settings);
    case SKEIN_CONSTRAINT: add_constraint(b, place, kind, object, settings); break;
    case SKEIN_FORCE: status = skein_force_add(b->world, kind->name, settings->data, NULL); break;
    case SKEIN_COLLIDER: return add_collider(b, place, kind, settings);
    case SKEIN_MOTION: return add_motion(b, place, kind, settings);
    default: status = skein_method_set(b->world, kind->name, settings->data); break;
    }
    if (status) report_object_fault(b, place, kind, "");
    return !status;
}

static void add_object(builder *b, const char *path, const json_t *object, skein_category category) {
    static const char *const skip[] = {"type", NULL}, *const skip_particles[] = {"type", "particles", NULL},
                             *const skip_budget[] = {"type", "budget_ms", NULL}; // which is the scene's
    io_place place = {b->file, path, b->faults};
    const skein_kind *kind = kind_of(place, object, category);
    io_settings settings = {0};
    bool read = kind && io_settings_read(&settings, place, object, kind,
                                         category == SKEIN_CONSTRAINT ? skip_particles
                                         : category == SKEIN_METHOD   ? skip_budget
                                                                      : skip);
    if (read)
        io_names_check(place, b->world, kind, &settings, (io_names_whole){!b->body_missing, !b->collider_missing});
    bool good = read && add_of_kind(b, place, object, kind, &settings);
    if (!good && category == SKEIN_BODY) b->body_missing = true;
    if (!good && category == SKEIN_COLLIDER) b->collider_missing = true;
    io_settings_free(&settings);
}

static void add_section(builder *b, const json_t *root, const io_scene_section *section) {
    const json_t *value = json_object_get(root, section->name);
    char words[IO_JSON_WORDS_SIZE];
    if (!value) return;
    if (section->category == SKEIN_METHOD) {
        add_object(b, section->name, value, SKEIN_METHOD);
        return;
    }
    if (!json_is_array(value)) {
        io_fault((io_place){b->file, section->name, b->faults}, "", SKEIN_ERROR_VALUE,
                 "expected a list, [ { \"type\": ... }, ... ], not %s", io_json_words(value, words));
        b->body_missing |= section->category == SKEIN_BODY;
        b->collider_missing |= section->category == SKEIN_COLLIDER;
        return;
    }
    for (size_t i = 0; i < json_array_size(value); i++) {
        char path[64];
        snprintf(path, sizeof path, "%s.%zu", section->name, i);
        add_object(b, path, json_array_get(value, i), section->category);
    }
}

skein_world *io_world_from_document(const json_t *root, const char *file, double dt, const skein_world_desc *desc,
                                    io_faults *faults) {
    skein_error error = {SKEIN_OK, "", ""};
    skein_world_desc known = desc ? *desc : skein_default_world_desc();
    if (!known.kinds) known.kinds = io_kinds();
    builder b = {skein_world_create(&known, &error), file, desc, faults, false, false};
    io_place top = {file, "", faults};
    if (!b.world) {
        io_fault(top, error.where, error.status, "%s", error.message);
        return NULL;
    }
    if (skein_cholmod_is_here() && skein_cholmod_attach(b.world, &error))
        io_fault(top, "", error.status, "%s", error.message);
    for (size_t i = 0; io_scene_section_at(i); i++) {
        skein_category category = io_scene_section_at(i)->category;
        if (category != SKEIN_EXPORTER && category != SKEIN_VIEW) add_section(&b, root, io_scene_section_at(i));
    }
    if (!b.body_missing && !skein_particle_count(b.world))
        io_fault(top, "bodies", SKEIN_ERROR_VALUE, "the scene has no particles: add a body");
    // a method may not take these rules: the plan knows
    if (!faults->count && skein_world_explain(b.world, dt, NULL, NULL)) report_library_fault(&b, top, "");
    if (!faults->count) return b.world;
    skein_world_destroy(b.world);
    return NULL;
}
