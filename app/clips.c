/* The clips of a run: which files a body and a format make, their names, and what each frame puts in. */
#include "app/clips.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/clip.h"
#include "io/uncut.h"

/* One body in one format. */
typedef struct clip {
    const io_clip_format *format;
    const io_clip_params *params;
    void *file; /* that grows, or NULL */
    size_t body;
    int next; /* frame of a sequence, to be written next: all before are there */
} clip;

struct app_clips {
    app_clips_plan plan;
    clip *data; /* count */
    size_t count;
    double *positions; /* room for the largest body */
};

static const char *ending_of(const clip *c) {
    return c->format->ending;
}

static void name_file(const app_clips *clips, const clip *c, const char *middle, char path[APP_PATH_SIZE]) {
    snprintf(path, APP_PATH_SIZE, "%s/%s%s%s", clips->plan.folder, clips->plan.names[c->body], middle, ending_of(c));
}

static void name_frame(const app_clips *clips, const clip *c, int frame, char path[APP_PATH_SIZE]) {
    char middle[16];
    snprintf(middle, sizeof middle, "_%04d", frame);
    name_file(clips, c, middle, path);
}

static skein_handle handle_of(const app_clips *clips, size_t body) {
    return skein_object_at(clips->plan.loaded->world, SKEIN_BODY, body);
}

static skein_status surface_of(const app_clips *clips, size_t body, skein_surface *surface) {
    return skein_body_surface(clips->plan.loaded->world, handle_of(clips, body), surface);
}

/* Where the vertices are, those that welding has joined too, in the file's axes and units. */
static skein_status gather(const app_clips *clips, const clip *c, skein_surface *s) {
    skein_status status = surface_of(clips, c->body, s);
    skein_view view = skein_position_view(clips->plan.loaded->world);
    if (status) return status;
    for (size_t v = 0; v < s->vertex_count; v++) {
        const skein_real *p = view.xyzw + 4 * (size_t)view.slot_of[s->particle_of_vertex[v]];
        for (size_t k = 0; k < 3; k++) clips->positions[3 * v + k] = (double)p[k];
    }
    io_clip_place(c->params, clips->positions, s->vertex_count);
    return SKEIN_OK;
}

static skein_mesh mesh_of(const app_clips *clips, const skein_surface *s) {
    return (skein_mesh){clips->positions, s->vertex_count,  s->face_sizes,
                        s->face_count,    s->face_vertices, s->face_vertex_count};
}

static io_clip describe(const app_clips *clips, const clip *c, const skein_surface *s) {
    const app_scene *loaded = clips->plan.loaded;
    return (io_clip){.name = clips->plan.names[c->body],
                     .mesh = mesh_of(clips, s),
                     .corner_uv = s->corner_uv,
                     .fps = loaded->settings.fps,
                     .samples = c->params->every ? (uint32_t)(loaded->settings.frames / c->params->every) + 1 : 1,
                     .read_path = "",
                     .params = c->params};
}

/* ---- beginning ---- */

/* One body in one format; nothing for a body that the format cannot show. */
static skein_status begin_clip(app_clips *clips, const io_clip_format *format, const io_export *wanted, size_t body,
                               skein_error *error) {
    clip *c = &clips->data[clips->count];
    *c = (clip){.format = format, .params = wanted->params, .body = body};
    skein_surface s;
    uint32_t *room;
    if (gather(clips, c, &s)) return SKEIN_OK;
    if (!io_surface_uncut(clips->plan.loaded->world, handle_of(clips, body), &s, &room))
        return io_error_set(error, SKEIN_ERROR_MEMORY, "", "out of memory");
    if (format->needs_faces && !s.face_count) {
        if (wanted->asked && !clips->plan.loaded->quiet)
            fprintf(stderr, "skein: warning: '%s' has no faces: no %s of it\n", clips->plan.names[body],
                    format->kind.name);
        free(room);
        return SKEIN_OK;
    }
    char path[APP_PATH_SIZE];
    io_clip described = describe(clips, c, &s);
    name_file(clips, c, "", path);
    if (format->create) c->file = format->create(&described, path, error);
    free(room);
    if (format->create && !c->file) return error->status;
    clips->count++;
    return SKEIN_OK;
}

static bool reserve(app_clips *clips) {
    size_t most = 1;
    skein_surface s;
    for (size_t b = 0; b < clips->plan.body_count; b++)
        if (!surface_of(clips, b, &s) && s.vertex_count > most) most = s.vertex_count;
    clips->positions = malloc(3 * most * sizeof *clips->positions);
    clips->data = calloc(clips->plan.export_count * clips->plan.body_count + 1, sizeof *clips->data);
    return clips->positions && clips->data;
}

app_clips *app_clips_begin(const app_clips_plan *plan, skein_error *error) {
    app_clips *clips = calloc(1, sizeof *clips);
    if (clips) clips->plan = *plan;
    skein_status status = SKEIN_OK;
    if (!clips || !reserve(clips)) status = io_error_set(error, SKEIN_ERROR_MEMORY, "", "out of memory");
    for (size_t e = 0; e < plan->export_count && !status; e++) {
        const io_clip_format *format = io_clip_format_named(plan->exports[e].kind->name);
        if (!format || (!plan->exports[e].asked && !format->by_default)) continue;
        for (size_t b = 0; b < plan->body_count && !status; b++)
            status = begin_clip(clips, format, &plan->exports[e], b, error);
    }
    if (!status) return clips;
    app_clips_abandon(clips);
    return NULL;
}

/* ---- frames ---- */

/* What a mesh's file says of its faces, those of `whole`, for a format that keeps it: it is read again, since nothing else
 * of a run needs it. To be freed. */
static void read_again(const app_clips *clips, const clip *c, const skein_mesh *whole, io_clip *described,
                       io_mesh *read, char **path, const char *to) {
    *read = (io_mesh){0};
    *path = c->format->keeps_marks ? io_scene_mesh_path(clips->plan.loaded->scene, c->body) : NULL;
    if (!*path) return;
    if (!io_mesh_read(*path, read, (io_warnings){NULL, NULL}, NULL) && io_mesh_has_faces_of(read, whole)) {
        io_mesh_uncut(read, clips->plan.loaded->world, handle_of(clips, c->body));
        described->read = read;
        described->read_path = *path;
    } else if (!read->tetrahedra && c->next == 0)
        fprintf(stderr,
                "skein: warning: %s: it is no longer the mesh that was run: %s has no texture coordinates, objects, "
                "groups and materials of it\n",
                *path, to);
}

static skein_status write_frame(const app_clips *clips, const clip *c, const char *path, skein_error *error) {
    skein_surface s;
    io_mesh read;
    char *read_path;
    uint32_t *room;
    if (gather(clips, c, &s)) return SKEIN_OK;
    skein_mesh whole = mesh_of(clips, &s);
    if (!io_surface_uncut(clips->plan.loaded->world, handle_of(clips, c->body), &s, &room))
        return io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    io_clip described = describe(clips, c, &s);
    read_again(clips, c, &whole, &described, &read, &read_path, path);
    skein_status status = c->format->write(&described, path, error);
    io_mesh_free(&read);
    free(read_path);
    free(room);
    return status;
}

static skein_status add_frame(const app_clips *clips, clip *c, int frame, skein_error *error) {
    char path[APP_PATH_SIZE];
    skein_surface s;
    if (!c->params->every || frame % c->params->every) return SKEIN_OK;
    if (c->file) return gather(clips, c, &s) ? SKEIN_OK : c->format->add(c->file, clips->positions, error);
    name_frame(clips, c, frame, path);
    skein_status status = write_frame(clips, c, path, error);
    if (!status) c->next = frame + c->params->every;
    return status;
}

skein_status app_clips_frame(app_clips *clips, int frame, skein_error *error) {
    skein_status status = SKEIN_OK;
    for (size_t i = 0; i < clips->count && !status; i++) status = add_frame(clips, &clips->data[i], frame, error);
    return status;
}

/* ---- the end ---- */

static void free_clips(app_clips *clips) {
    free(clips->positions);
    free(clips->data);
    free(clips);
}

/* Hands the files of a sequence on. */
static void tell_sequence(const app_clips *clips, const clip *c, app_clips_done *done, void *user) {
    char path[APP_PATH_SIZE];
    for (int frame = 0; frame < c->next; frame += c->params->every) {
        name_frame(clips, c, frame, path);
        done(user, path, SKEIN_OK, NULL);
    }
}

void app_clips_finish(app_clips *clips, app_clips_done *done, void *user) {
    char path[APP_PATH_SIZE];
    for (size_t i = 0; i < clips->count; i++) {
        clip *c = &clips->data[i];
        skein_error error = {SKEIN_OK, "", ""};
        name_file(clips, c, "", path);
        if (c->params->every && !c->file) {
            tell_sequence(clips, c, done, user);
            continue;
        }
        skein_status status = c->file ? c->format->commit(c->file, &error) : write_frame(clips, c, path, &error);
        c->file = NULL;
        done(user, path, status, &error);
    }
    free_clips(clips);
}

void app_clips_keep(app_clips *clips, app_clips_done *done, void *user) {
    char path[APP_PATH_SIZE];
    for (size_t i = 0; i < clips->count; i++) {
        clip *c = &clips->data[i];
        skein_error error = {SKEIN_OK, "", ""};
        if (c->file) {
            name_file(clips, c, ".failed", path);
            skein_status status = c->format->keep(c->file, path, &error);
            done(user, path, status, &error);
        } else if (c->params->every) tell_sequence(clips, c, done, user);
    }
    free_clips(clips);
}

void app_clips_abandon(app_clips *clips) {
    if (!clips) return;
    char path[APP_PATH_SIZE];
    for (size_t i = 0; i < clips->count; i++) {
        clip *c = &clips->data[i];
        if (c->file) c->format->abandon(c->file);
        else
            for (int frame = 0; frame < c->next; frame += c->params->every) {
                name_frame(clips, c, frame, path);
                unlink(path);
            }
    }
    free_clips(clips);
}
