/* The exporter "usda": a clip as Universal Scene Description, in text.
 *
 *   #usda 1.0 (...)                axes, units, the first and last frame and how many there are a second
 *   def Mesh "cape" {              (a body without faces: Points)
 *     faces, primvars:st           once, a texture coordinate for each corner
 *     points.timeSamples           a list of points for each sample; its time is the number of the frame
 *     normals.timeSamples, extent.timeSamples
 *   }
 *
 * Points go into the file as they come; normals into a part file of their own, NAME.normals.PID.part, which is copied
 * behind the points at the end. Owns: the layout. Invariant: while the file grows, its part ends as a whole file does,
 * with all samples so far but without normals.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/clip.h"

enum { FRAME_DIGITS = 10 };

typedef struct usda {
    io_output *output, *normals;
    char *path;
    skein_mesh mesh; /* faces, for normals */
    uint32_t *sizes, *corners;
    skein_normals weighting;
    int32_t every;
    uint64_t last_frame_at; /* where the header tells it */
    uint64_t whole;         /* bytes up to the end of the last sample, behind which the end stands */
    uint64_t normals_whole;
    double *room;      /* normals of one sample */
    float (*boxes)[6]; /* least and most of each sample */
    size_t samples, capacity;
} usda;

static void usda_free(usda *u) {
    if (!u) return;
    io_output_abandon(u->output);
    io_output_abandon(u->normals);
    free(u->path);
    free(u->sizes);
    free(u->corners);
    free(u->room);
    free(u->boxes);
    free(u);
}

/* ---- the text's parts ---- */

static void write_text(io_output *output, const char *text) {
    io_output_write(output, text, strlen(text));
}

/* A name as USD allows it: letters, digits and '_', no digit first. */
static void write_name(io_output *output, const char *name) {
    if (!*name || (*name >= '0' && *name <= '9')) write_text(output, "_");
    for (; *name; name++) {
        bool fine = (*name >= 'a' && *name <= 'z') || (*name >= 'A' && *name <= 'Z') || (*name >= '0' && *name <= '9');
        io_output_write(output, fine ? name : "_", 1);
    }
}

/* A double, in 15 digits, whatever the locale's point is. */
static void write_number(io_output *output, double value) {
    char text[32];
    snprintf(text, sizeof text, "%.15g", value);
    for (char *c = text; *c; c++)
        if (!strchr("0123456789+-e", *c)) *c = '.';
    write_text(output, text);
}

/* "(1, 2, 3)" */
static void write_tuple(io_output *output, const double *numbers, size_t count) {
    char text[3 * (IO_FLOAT_SIZE + 2) + 2] = "(";
    size_t at = 1;
    for (size_t k = 0; k < count; k++) {
        at += io_float_print((float)numbers[k], text + at);
        memcpy(text + at, k + 1 < count ? ", " : ")", 2);
        at += k + 1 < count ? 2 : 1;
    }
    io_output_write(output, text, at);
}

/* "    24: [(...), (...)],\n" */
static void write_sample(io_output *output, uint64_t frame, const double *tuples, size_t count) {
    write_text(output, "        ");
    io_output_count(output, frame);
    write_text(output, ": [");
    for (size_t i = 0; i < count; i++) {
        if (i) write_text(output, ", ");
        write_tuple(output, tuples + 3 * i, 3);
    }
    write_text(output, "],\n");
}

static void write_counts(io_output *output, const char *name, const uint32_t *counts, size_t count) {
    write_text(output, name);
    for (size_t i = 0; i < count; i++) {
        if (i) write_text(output, ", ");
        io_output_count(output, counts[i]);
    }
    write_text(output, "]\n");
}

static void write_coordinates(io_output *output, const float *uv, size_t count) {
    write_text(output, "    texCoord2f[] primvars:st = [");
    for (size_t i = 0; i < count; i++) {
        double pair[2] = {(double)uv[2 * i], (double)uv[2 * i + 1]};
        if (i) write_text(output, ", ");
        write_tuple(output, pair, 2);
    }
    write_text(output, "] (\n        interpolation = \"faceVarying\"\n    )\n");
}

/* All up to the first sample. */
static void write_head(usda *u, const io_clip *clip) {
    io_output *o = u->output;
    write_text(o, "#usda 1.0\n(\n    defaultPrim = \"");
    write_name(o, clip->name);
    write_text(o, "\"\n    doc = \"Skein " SKEIN_VERSION "\"\n    endTimeCode = ");
    u->last_frame_at = io_output_place(o);
    write_text(o, "0         \n    framesPerSecond = ");
    write_number(o, clip->fps);
    write_text(o, "\n    metersPerUnit = ");
    write_number(o, 1 / clip->params->scale);
    write_text(o, "\n    startTimeCode = 0\n    timeCodesPerSecond = ");
    write_number(o, clip->fps);
    write_text(o, "\n    upAxis = \"");
    write_text(o, clip->params->up == IO_UP_Z ? "Z" : "Y");
    write_text(o, "\"\n)\n\ndef ");
    write_text(o, u->mesh.face_count ? "Mesh \"" : "Points \"");
    write_name(o, clip->name);
    write_text(o, "\"\n{\n");
    if (u->mesh.face_count) {
        write_text(o, "    uniform bool doubleSided = 1\n");
        write_counts(o, "    int[] faceVertexCounts = [", u->sizes, u->mesh.face_count);
        write_counts(o, "    int[] faceVertexIndices = [", u->corners, u->mesh.face_vertex_count);
        write_text(o, "    uniform token subdivisionScheme = \"none\"\n");
        if (clip->corner_uv) write_coordinates(o, clip->corner_uv, u->mesh.face_vertex_count);
    }
    write_text(o, "    point3f[] points.timeSamples = {\n");
    u->whole = io_output_place(o);
}

static void write_end(io_output *output) {
    write_text(output, "    }\n}\n");
}

/* ---- a clip ---- */

static bool copy_mesh(usda *u, const skein_mesh *mesh) {
    u->sizes = malloc((mesh->face_count + 1) * sizeof *u->sizes);
    u->corners = malloc((mesh->face_vertex_count + 1) * sizeof *u->corners);
    u->room = malloc((mesh->vertex_count + 1) * 3 * sizeof *u->room);
    if (!u->sizes || !u->corners || !u->room) return false;
    if (mesh->face_count) {
        memcpy(u->sizes, mesh->face_sizes, mesh->face_count * sizeof *u->sizes);
        memcpy(u->corners, mesh->face_vertices, mesh->face_vertex_count * sizeof *u->corners);
    }
    u->mesh = *mesh;
    u->mesh.positions = NULL;
    u->mesh.face_sizes = u->sizes;
    u->mesh.face_vertices = u->corners;
    return true;
}

/* The file, and the part of normals. */
static bool open_files(usda *u, const char *path, skein_error *error) {
    size_t size = strlen(path) + sizeof ".normals";
    char *beside = malloc(size);
    if (!beside) {
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return false;
    }
    snprintf(beside, size, "%s.normals", path);
    u->output = io_output_open(path, error);
    if (u->output && !io_output_part(u->output)) {
        io_error_set(error, SKEIN_ERROR_FILE, path,
                     "cannot write: a USD file is changed while it grows, which a pipe "
                     "or device is not");
        io_output_abandon(u->output);
        u->output = NULL;
    }
    if (u->output && u->mesh.face_count) u->normals = io_output_open(beside, error);
    free(beside);
    return u->output && (u->normals || !u->mesh.face_count);
}

static void *create(const io_clip *clip, const char *path, skein_error *error) {
    usda *u = calloc(1, sizeof *u);
    if (!u || !(u->path = strdup(path)) || !copy_mesh(u, &clip->mesh))
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    else if (open_files(u, path, error)) {
        u->weighting = (skein_normals)clip->params->normals;
        u->every = clip->params->every;
        write_head(u, clip);
        return u;
    }
    usda_free(u);
    return NULL;
}

static void note_box(usda *u, const double *positions) {
    float *box = u->boxes[u->samples];
    for (size_t k = 0; k < 3; k++) box[k] = INFINITY, box[3 + k] = -INFINITY;
    for (size_t i = 0; i < 3 * u->mesh.vertex_count; i++) {
        float x = (float)positions[i];
        box[i % 3] = fminf(box[i % 3], x);
        box[3 + i % 3] = fmaxf(box[3 + i % 3], x);
    }
}

/* Behind the last whole sample. A sample that could not be written is taken back. */
static void rewind_end(usda *u) {
    io_output_flush(u->output);
    io_output_cut(u->output, u->whole);
}

static void tell_last_frame(usda *u) {
    char text[FRAME_DIGITS + 1];
    uint64_t frame = u->samples ? (uint64_t)(u->samples - 1) * (uint64_t)u->every : 0;
    snprintf(text, sizeof text, "%-*llu", FRAME_DIGITS, (unsigned long long)frame);
    io_output_patch(u->output, u->last_frame_at, text, FRAME_DIGITS);
}

static skein_status add(void *file, const double *positions, skein_error *error) {
    usda *u = file;
    uint64_t frame = (uint64_t)u->samples * (uint64_t)u->every;
    skein_mesh mesh = u->mesh;
    mesh.positions = positions;
    skein_status status = io_clip_check_positions(u->path, positions, u->mesh.vertex_count, error);
    if (!status && !io_grow(&u->boxes, &u->capacity, u->samples + 1, sizeof *u->boxes))
        status = io_error_set(error, SKEIN_ERROR_MEMORY, u->path, "out of memory");
    if (!status && u->normals) status = skein_mesh_normals(&mesh, u->weighting, u->room, error);
    if (!status) status = io_output_status(u->output, error);
    if (status) return status;
    note_box(u, positions);
    if (u->samples) rewind_end(u);
    write_sample(u->output, frame, positions, u->mesh.vertex_count);
    uint64_t whole = io_output_place(u->output);
    write_end(u->output);
    if (u->normals) {
        write_sample(u->normals, frame, u->room, u->mesh.vertex_count);
        io_output_flush(u->normals);
        status = io_output_status(u->normals, error);
    }
    io_output_flush(u->output);
    if (!status) status = io_output_status(u->output, error);
    if (status) return status;
    u->whole = whole;
    u->normals_whole = u->normals ? io_output_place(u->normals) : 0;
    u->samples++;
    tell_last_frame(u);
    return io_output_status(u->output, error);
}

/* What stands behind the points: with all, or, where that does not fit on the disk, only the end. */
static void write_rest(usda *u, bool all) {
    rewind_end(u);
    if (!all) {
        write_end(u->output);
        tell_last_frame(u);
        return;
    }
    write_text(u->output, "    }\n");
    if (u->normals) {
        write_text(u->output, "    normal3f[] normals (\n        interpolation = \"vertex\"\n    )\n"
                              "    normal3f[] normals.timeSamples = {\n");
        io_clip_append_part(u->output, io_output_part(u->normals), 0, u->normals_whole);
        write_text(u->output, "    }\n");
    }
    write_text(u->output, "    float3[] extent.timeSamples = {\n");
    for (size_t s = 0; s < u->samples; s++) {
        double box[6];
        for (size_t k = 0; k < 6; k++) box[k] = (double)u->boxes[s][k];
        write_sample(u->output, (uint64_t)s * (uint64_t)u->every, box, 2);
    }
    write_end(u->output);
    tell_last_frame(u);
}

static skein_status commit(void *file, skein_error *error) {
    usda *u = file;
    skein_status status = io_output_status(u->output, error);
    if (!status) {
        write_rest(u, true);
        status = io_output_commit(u->output, error);
        u->output = NULL;
    }
    usda_free(u);
    return status;
}

static skein_status keep(void *file, const char *path, skein_error *error) {
    usda *u = file;
    skein_status status = SKEIN_OK;
    if (!u->samples) status = io_error_set(error, SKEIN_ERROR_VALUE, path, IO_NOTHING_KEPT);
    if (!status) {
        write_rest(u, true);
        if (io_output_status(u->output, NULL)) write_rest(u, false);
        status = io_output_keep(u->output, path, UINT64_MAX, NULL, error);
        u->output = NULL;
    }
    usda_free(u);
    return status;
}

static void abandon(void *file) {
    usda_free(file);
}

static const skein_field fields[] = {
    IO_CLIP_FIELD_EVERY(1, 1, "one sample each so many frames"),
    IO_CLIP_FIELD_NORMALS,
    IO_CLIP_FIELD_UP,
    IO_CLIP_FIELD_SCALE,
};

const io_clip_format io_clip_usda = {
    .kind = {.name = "usda",
             .help = "USD as text: the mesh with points and normals of every frame, axes, units and frame rate.",
             .category = SKEIN_EXPORTER,
             .fields = fields,
             .field_count = sizeof fields / sizeof *fields,
             .params_size = sizeof(io_clip_params)},
    .ending = ".usda",
    .create = create,
    .add = add,
    .commit = commit,
    .keep = keep,
    .abandon = abandon,
};
