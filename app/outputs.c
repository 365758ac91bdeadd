#include "app/outputs.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "io/exporters.h"
#include "io/mesh.h"
#include "io/pc2.h"
#ifdef SKEIN_RENDER
#include "render/picture.h"
#endif

enum { MOST_EXPORTS = 16, FOLDER_SIZE = 1024, PATH_SIZE = FOLDER_SIZE + 160 };

/* One body's growing file. */
typedef struct cache {
    io_pc2_writer *writer;
    char path[PATH_SIZE];
    size_t body;
    int every;
} cache;

struct app_outputs {
    const app_scene *loaded;
    char folder[FOLDER_SIZE];
    char stem[128]; /* the scene's name, for pictures */
    io_export exports[MOST_EXPORTS];
    size_t export_count;
    cache *caches;
    size_t cache_count;
    double *positions; /* room for the largest body */
};

/* A name that is safe as a file's: letters, digits, '-', '_' and '.'. */
static void file_name(const char *name, char *out, size_t size) {
    size_t length = 0;
    for (; *name && length + 1 < size; name++)
        out[length++] = isalnum((unsigned char)*name) || strchr("-_.", *name) ? *name : '_';
    out[length] = 0;
    if (!length || out[0] == '.') snprintf(out, size, "scene");
}

/* Makes every folder of a path. */
static bool make_folders(const char *path) {
    char part[FOLDER_SIZE];
    if (strlen(path) >= sizeof part) {
        errno = ENAMETOOLONG;
        return false;
    }
    snprintf(part, sizeof part, "%s", path);
    for (char *at = part + 1; *at; at++) {
        if (*at != '/') continue;
        *at = 0;
        if (mkdir(part, 0777) && errno != EEXIST) return false;
        *at = '/';
    }
    if (mkdir(part, 0777) && errno != EEXIST) return false;
    struct stat info;
    errno = ENOTDIR;
    return !stat(part, &info) && S_ISDIR(info.st_mode);
}

/* A body's name; the second of a name (and a nameless second) is told by its place. */
static void body_name(const skein_world *world, size_t body, char *out, size_t size) {
    skein_handle handle = skein_object_at(world, SKEIN_BODY, body);
    skein_value name = {0, {0, 0, 0}, ""}, other;
    skein_get(world, handle, "name", &name);
    const char *text = name.text[0] ? name.text : skein_object_kind(world, handle)->name;
    file_name(text, out, size);
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++) {
        skein_handle rival = skein_object_at(world, SKEIN_BODY, i);
        if (i == body || skein_get(world, rival, "name", &other)) continue;
        if (strcmp(other.text[0] ? other.text : skein_object_kind(world, rival)->name, text)) continue;
        size_t length = strlen(out);
        snprintf(out + length, size - length, "-%zu", body);
        return;
    }
}

static bool begin_cache(app_outputs *outputs, size_t body, int every) {
    skein_surface surface;
    const skein_world *world = outputs->loaded->world;
    if (skein_body_surface(world, skein_object_at(world, SKEIN_BODY, body), &surface)) return true;
    cache *c = &outputs->caches[outputs->cache_count];
    char name[128];
    body_name(world, body, name, sizeof name);
    snprintf(c->path, sizeof c->path, "%s/%s.pc2", outputs->folder, name);
    c->body = body;
    c->every = every;
    skein_error error = {SKEIN_OK, "", ""};
    io_pc2_header header = {(uint32_t)surface.vertex_count, 0, (float)every, IO_PC2_UNKNOWN};
    c->writer = io_pc2_create(c->path, header, &error);
    if (c->writer) outputs->cache_count++;
    else app_print_error(&error);
    return c->writer != NULL;
}

app_outputs *app_outputs_begin(const app_scene *loaded, const char *folder) {
    app_outputs *outputs = calloc(1, sizeof *outputs);
    size_t bodies = skein_object_count(loaded->world, SKEIN_BODY), most = 1;
    if (!outputs) return NULL;
    outputs->loaded = loaded;
    snprintf(outputs->folder, sizeof outputs->folder, "%s", folder);
    for (size_t length = strlen(outputs->folder); length > 1 && outputs->folder[length - 1] == '/';) outputs->folder[--length] = 0;
    file_name(loaded->settings.name && loaded->settings.name[0] ? loaded->settings.name : "scene", outputs->stem, sizeof outputs->stem);
    outputs->export_count = io_scene_exports(loaded->scene, outputs->exports, MOST_EXPORTS);
    if (!make_folders(outputs->folder)) {
        fprintf(stderr, "skein: %s: cannot make the folder: %s\n", outputs->folder, strerror(errno));
        app_outputs_abandon(outputs);
        return NULL;
    }
    for (size_t b = 0; b < bodies; b++) {
        skein_surface surface;
        if (!skein_body_surface(loaded->world, skein_object_at(loaded->world, SKEIN_BODY, b), &surface) && surface.vertex_count > most)
            most = surface.vertex_count;
    }
    outputs->positions = malloc(3 * most * sizeof *outputs->positions);
    outputs->caches = calloc(bodies * MOST_EXPORTS + 1, sizeof *outputs->caches);
    bool good = outputs->positions && outputs->caches;
    for (size_t e = 0; e < outputs->export_count && good; e++)
        if (!strcmp(outputs->exports[e].kind->name, "pc2"))
            for (size_t b = 0; b < bodies && good; b++) good = begin_cache(outputs, b, ((const io_pc2_params *)outputs->exports[e].params)->every);
    if (good) return outputs;
    app_outputs_abandon(outputs);
    return NULL;
}

/* A body's vertices, where welding has joined them too. */
static void gather_vertices(const app_outputs *outputs, const skein_surface *surface) {
    skein_view view = skein_position_view(outputs->loaded->world);
    for (size_t v = 0; v < surface->vertex_count; v++) {
        const skein_real *p = view.xyzw + 4 * (size_t)view.slot_of[surface->particle_of_vertex[v]];
        for (size_t k = 0; k < 3; k++) outputs->positions[3 * v + k] = (double)p[k];
    }
}

bool app_outputs_frame(app_outputs *outputs, int frame) {
    for (size_t i = 0; i < outputs->cache_count; i++) {
        cache *c = &outputs->caches[i];
        if (frame % c->every) continue;
        skein_surface surface;
        skein_body_surface(outputs->loaded->world, skein_object_at(outputs->loaded->world, SKEIN_BODY, c->body), &surface);
        gather_vertices(outputs, &surface);
        skein_error error = {SKEIN_OK, "", ""};
        if (io_pc2_add(c->writer, outputs->positions, &error)) {
            app_print_error(&error);
            return false;
        }
    }
    return true;
}

static bool write_obj(const app_outputs *outputs, size_t body, const io_obj_params *params, char *path) {
    skein_surface surface;
    char name[128];
    body_name(outputs->loaded->world, body, name, sizeof name);
    snprintf(path, PATH_SIZE, "%s/%s.obj", outputs->folder, name);
    skein_body_surface(outputs->loaded->world, skein_object_at(outputs->loaded->world, SKEIN_BODY, body), &surface);
    gather_vertices(outputs, &surface);
    skein_mesh mesh = {outputs->positions, surface.vertex_count, surface.face_sizes, surface.face_count, surface.face_vertices,
                       surface.face_vertex_count};
    skein_error error = {SKEIN_OK, "", ""};
    if (!io_obj_write(path, &mesh, (io_normals)params->normals, &error)) return true;
    app_print_error(&error);
    return false;
}

#ifdef SKEIN_RENDER
static bool write_picture(const app_outputs *outputs, const render_picture_options *options, char *path) {
    snprintf(path, PATH_SIZE, "%s/%s.png", outputs->folder, outputs->stem);
    skein_error error = {SKEIN_OK, "", ""};
    if (!render_picture(outputs->loaded->world, path, options, &error)) return true;
    app_print_error(&error);
    return false;
}
#endif

bool app_outputs_finish(app_outputs *outputs, void (*wrote)(void *user, const char *path), void *user) {
    bool good = true;
    char path[PATH_SIZE];
    skein_error error = {SKEIN_OK, "", ""};
    for (size_t i = 0; i < outputs->cache_count; i++) {
        cache *c = &outputs->caches[i];
        bool committed = !io_pc2_commit(c->writer, &error);
        c->writer = NULL;
        if (committed) wrote(user, c->path);
        else app_print_error(&error);
        good &= committed;
    }
    for (size_t e = 0; e < outputs->export_count; e++) {
        const char *kind = outputs->exports[e].kind->name;
        for (size_t b = 0; !strcmp(kind, "obj") && b < skein_object_count(outputs->loaded->world, SKEIN_BODY); b++) {
            bool written = write_obj(outputs, b, outputs->exports[e].params, path);
            if (written) wrote(user, path);
            good &= written;
        }
#ifdef SKEIN_RENDER
        if (!strcmp(kind, "png")) {
            bool written = write_picture(outputs, outputs->exports[e].params, path);
            if (written) wrote(user, path);
            good &= written;
        }
#endif
    }
    app_outputs_abandon(outputs);
    return good;
}

void app_outputs_abandon(app_outputs *outputs) {
    if (!outputs) return;
    for (size_t i = 0; outputs->caches && i < outputs->cache_count; i++) io_pc2_abandon(outputs->caches[i].writer);
    free(outputs->caches);
    free(outputs->positions);
    free(outputs);
}
