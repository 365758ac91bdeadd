/* The second half of the scene reader: from the document to a world, object by object. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/mesh.h"
#include "io/scene_settings.h"

typedef struct builder {
    skein_world *world;
    const char *file;
    io_faults *faults;
} builder;

/* A fault that the library found: its place is a field's name. */
static void report_library_fault(io_place place, const skein_error *error) {
    io_fault(place, error->where, error->status, "%s", error->message);
}

/* ---- meshes and constraints: what settings cannot hold ---- */

/* The mesh's path, relative to the scene's folder. */
static void mesh_path(const char *scene, const char *mesh, char *path, size_t size) {
    const char *slash = strrchr(scene, '/');
    if (mesh[0] == '/' || !slash) snprintf(path, size, "%s", mesh);
    else snprintf(path, size, "%.*s/%s", (int)(slash - scene), scene, mesh);
}

typedef struct warning_sink {
    io_place place;
    const skein_world_desc *desc;
} warning_sink;

static void pass_warning(void *user, const char *line) {
    const warning_sink *sink = user;
    if (sink->desc && sink->desc->log) sink->desc->log(sink->desc->log_user, SKEIN_LOG_WARNING, line);
}

static bool add_body(builder *b, io_place place, const char *type, const io_settings *settings, const skein_world_desc *desc) {
    const char *file = io_settings_text(settings, "mesh");
    io_mesh mesh = {0};
    skein_mesh view = {0};
    if (file && file[0]) {
        char path[1024];
        skein_error error = {SKEIN_OK, "", ""};
        warning_sink sink = {place, desc};
        mesh_path(b->file, file, path, sizeof path);
        if (io_mesh_read(path, &mesh, (io_warnings){pass_warning, &sink}, &error)) {
            io_fault(place, "mesh", error.status, "%s: %s", error.where, error.message);
            return false;
        }
        view = io_mesh_view(&mesh);
    }
    bool good = !skein_body_add(b->world, type, mesh.vertex_count ? &view : NULL, settings->data, NULL);
    if (!good) report_library_fault(place, skein_world_error(b->world));
    io_mesh_free(&mesh);
    return good;
}

/* "particles": a flat list of indices, or a list of lists, one a constraint. */
static bool add_constraint(builder *b, io_place place, const char *type, const json_t *object, const io_settings *settings, size_t arity) {
    const json_t *list = json_object_get(object, "particles"), *item;
    size_t capacity = 0, count = 0, index;
    uint32_t *particles = NULL;
    bool good = json_is_array(list);
    json_array_foreach(list, index, item) {
        size_t inner_count = json_is_array(item) ? json_array_size(item) : 1;
        for (size_t i = 0; i < inner_count && good; i++) {
            const json_t *number = json_is_array(item) ? json_array_get(item, i) : item;
            long long value = json_integer_value(number);
            good = json_is_integer(number) && value >= 0 && value < UINT32_MAX && io_grow(&particles, &capacity, count + 1, sizeof *particles);
            if (good) particles[count++] = (uint32_t)value;
        }
    }
    if (!good || !count || count % arity) {
        io_fault(place, "particles", SKEIN_ERROR_VALUE, "expected a list of particle numbers, %zu for each %s, such as [[0, 1], [1, 2]]", arity, type);
        good = false;
    } else if (skein_constraint_add(b->world, type, particles, count / arity, settings->data, NULL)) {
        report_library_fault(place, skein_world_error(b->world));
        good = false;
    }
    free(particles);
    return good;
}

/* ---- objects ---- */

/* The kind that an object names by its "type"; NULL after a fault. */
static const skein_kind *kind_of(io_place place, const json_t *object, skein_category category) {
    if (!json_is_object(object)) {
        io_fault(place, "", SKEIN_ERROR_VALUE, "expected an object: { \"type\": ..., ... }");
        return NULL;
    }
    const char *type = json_string_value(json_object_get(object, "type"));
    if (!type) {
        io_fault(place, "type", SKEIN_ERROR_VALUE, "expected the name of a %s; `skein list` shows them", skein_category_text(category));
        return NULL;
    }
    skein_error error = {SKEIN_OK, "", ""};
    const skein_kind *kind = skein_kind_find(category, type, &error);
    if (!kind) io_fault(place, "type", error.status, "%s", error.message);
    return kind;
}

static void add_object(builder *b, io_place place, const json_t *object, skein_category category, const skein_world_desc *desc) {
    const skein_kind *kind = kind_of(place, object, category);
    if (!kind) return;
    static const char *const skip[] = {"type", NULL}, *const skip_particles[] = {"type", "particles", NULL};
    io_settings settings;
    if (io_settings_read(&settings, place, object, kind, category == SKEIN_CONSTRAINT ? skip_particles : skip)) {
        skein_status status = SKEIN_OK;
        switch (category) {
        case SKEIN_BODY: add_body(b, place, kind->name, &settings, desc); break;
        case SKEIN_CONSTRAINT: add_constraint(b, place, kind->name, object, &settings, 2); break;
        case SKEIN_FORCE: status = skein_force_add(b->world, kind->name, settings.data, NULL); break;
        case SKEIN_COLLIDER: status = skein_collider_add(b->world, kind->name, settings.data, NULL); break;
        default: status = skein_method_set(b->world, kind->name, settings.data); break;
        }
        if (status) report_library_fault(place, skein_world_error(b->world));
    }
    io_settings_free(&settings);
}

static void add_list(builder *b, const json_t *root, const char *section, skein_category category, const skein_world_desc *desc) {
    const json_t *list = json_object_get(root, section), *item;
    if (!list) return;
    if (!json_is_array(list)) {
        io_fault((io_place){b->file, section, b->faults}, "", SKEIN_ERROR_VALUE, "expected a list: [ { \"type\": ... }, ... ]");
        return;
    }
    size_t index;
    json_array_foreach(list, index, item) {
        char path[64];
        snprintf(path, sizeof path, "%s.%zu", section, index);
        add_object(b, (io_place){b->file, path, b->faults}, item, category, desc);
    }
}

skein_world *io_world_from_document(const json_t *root, const char *file, const skein_world_desc *desc, io_faults *faults) {
    skein_error error = {SKEIN_OK, "", ""};
    builder b = {skein_world_create(desc, &error), file, faults};
    io_place top = {file, "", faults};
    if (!b.world) {
        io_fault(top, error.where, error.status, "%s", error.message);
        return NULL;
    }
    if (json_object_get(root, "method"))
        add_object(&b, (io_place){file, "method", faults}, json_object_get(root, "method"), SKEIN_METHOD, desc);
    add_list(&b, root, "bodies", SKEIN_BODY, desc);
    add_list(&b, root, "constraints", SKEIN_CONSTRAINT, desc);
    add_list(&b, root, "forces", SKEIN_FORCE, desc);
    add_list(&b, root, "colliders", SKEIN_COLLIDER, desc);
    if (!faults->count && !skein_particle_count(b.world))
        io_fault(top, "bodies", SKEIN_ERROR_VALUE, "the scene has no particles: add a body");
    if (!faults->count) return b.world;
    skein_world_destroy(b.world);
    return NULL;
}
