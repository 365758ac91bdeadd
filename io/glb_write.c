/* The exporter "glb": binary glTF 2.0 of a short clip, for web pages, game engines and Blender.
 *
 *   12 bytes   "glTF", 2, the file's length          the first frame is the mesh; each other sample is a morph
 *   chunk      JSON: what follows, as glTF says      target, the way from there (positions and normals), and the
 *   chunk      BIN: indices, vertices, targets,      animation gives sample k the weight 1 at its time and 0 at all
 *              times, weights                        others: between two samples it is the line from one to the other
 *
 * A vertex where texture coordinates meet in a seam becomes one vertex for each of them: the mesh's own come first, in
 * their order. Faces become triangles, as fans. A body without faces is points.
 *
 * Owns: the file's layout. Since the JSON stands first and tells the number of samples, samples are kept in memory
 * until the end. Invariant: glTF's rules, as gltf-validator tells them: bounds are those of the floats that are
 * written, normals are of length 1, all lies at multiples of 4.
 */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/bytes.h"
#include "io/clip.h"

enum { FLOAT = 5126, UINT = 5125, ARRAY_BUFFER = 34962, ELEMENT_ARRAY_BUFFER = 34963, POINTS = 0, TRIANGLES = 4 };

typedef struct glb {
    char *path, *name;
    double seconds; /* from one sample to the next */
    /* the mesh's polygons, for normals */
    skein_mesh mesh;
    uint32_t *sizes, *corners;
    skein_normals weighting;
    /* glTF's vertices: vertex_of[g] of the mesh, with uvs[2 g]; and triangles of them */
    uint32_t *vertex_of, *indices;
    float *uvs; /* or NULL */
    size_t vertex_count, index_count;
    /* samples: positions, then normals, of the mesh's vertices */
    float **samples;
    size_t sample_count, sample_capacity;
    double *normals; /* room */
} glb;

static void glb_free(glb *g) {
    if (!g) return;
    for (size_t s = 0; s < g->sample_count; s++) free(g->samples[s]);
    free(g->samples);
    free(g->sizes);
    free(g->corners);
    free(g->vertex_of);
    free(g->indices);
    free(g->uvs);
    free(g->normals);
    free(g->path);
    free(g->name);
    free(g);
}

/* ---- the mesh as glTF has it ---- */

/* The vertex of glTF for a corner: the mesh's own, or of the chain behind it the one with the corner's coordinates. */
static uint32_t split_corner(glb *g, uint32_t vertex, const float uv[2], uint32_t *next, bool *placed) {
    uint32_t at = vertex;
    if (!placed[vertex]) {
        placed[vertex] = true;
        memcpy(g->uvs + 2 * (size_t)at, uv, 2 * sizeof *uv);
        return at;
    }
    for (;; at = next[at]) {
        if (g->uvs[2 * (size_t)at] == uv[0] && g->uvs[2 * (size_t)at + 1] == uv[1]) return at;
        if (!next[at]) break;
    }
    uint32_t added = (uint32_t)g->vertex_count++;
    next[at] = added;
    g->vertex_of[added] = vertex;
    memcpy(g->uvs + 2 * (size_t)added, uv, 2 * sizeof *uv);
    return added;
}

/* Vertices, and corners of vertices, with no more room than as many vertices as there may be. */
static bool split_vertices(glb *g, const io_clip *clip, uint32_t *corners) {
    size_t most = g->mesh.vertex_count + (clip->corner_uv ? g->mesh.face_vertex_count : 0);
    uint32_t *next = calloc(most + 1, sizeof *next);
    bool *placed = calloc(g->mesh.vertex_count + 1, sizeof *placed);
    g->vertex_of = malloc((most + 1) * sizeof *g->vertex_of);
    g->uvs = clip->corner_uv ? calloc(most + 1, 2 * sizeof *g->uvs) : NULL;
    g->vertex_count = g->mesh.vertex_count;
    bool good = next && placed && g->vertex_of && (g->uvs || !clip->corner_uv);
    for (uint32_t v = 0; good && v < g->vertex_count; v++) g->vertex_of[v] = v;
    for (size_t c = 0; good && c < g->mesh.face_vertex_count; c++) {
        uint32_t vertex = g->corners[c];
        if (!g->uvs) {
            corners[c] = vertex;
            continue;
        }
        // an image's first row is its upper one in glTF
        float uv[2] = {clip->corner_uv[2 * c], 1 - clip->corner_uv[2 * c + 1]};
        corners[c] = split_corner(g, vertex, uv, next, placed);
    }
    free(next);
    free(placed);
    return good;
}

static bool cut_triangles(glb *g, const uint32_t *corners) {
    size_t triangles = g->mesh.face_vertex_count - 2 * g->mesh.face_count, corner = 0;
    g->indices = malloc((3 * triangles + 1) * sizeof *g->indices);
    for (size_t f = 0; g->indices && f < g->mesh.face_count; corner += g->sizes[f++])
        for (uint32_t k = 2; k < g->sizes[f]; k++) {
            uint32_t *out = g->indices + g->index_count;
            out[0] = corners[corner];
            out[1] = corners[corner + k - 1];
            out[2] = corners[corner + k];
            g->index_count += 3;
        }
    return g->indices != NULL;
}

static bool copy_mesh(glb *g, const io_clip *clip) {
    const skein_mesh *m = &clip->mesh;
    g->sizes = malloc((m->face_count + 1) * sizeof *g->sizes);
    g->corners = malloc((m->face_vertex_count + 1) * sizeof *g->corners);
    g->normals = malloc((m->vertex_count + 1) * 3 * sizeof *g->normals);
    uint32_t *corners = malloc((m->face_vertex_count + 1) * sizeof *corners);
    bool good = g->sizes && g->corners && g->normals && corners;
    if (good && m->face_count) {
        memcpy(g->sizes, m->face_sizes, m->face_count * sizeof *g->sizes);
        memcpy(g->corners, m->face_vertices, m->face_vertex_count * sizeof *g->corners);
    }
    g->mesh = *m;
    g->mesh.positions = NULL;
    g->mesh.face_sizes = g->sizes;
    g->mesh.face_vertices = g->corners;
    good = good && split_vertices(g, clip, corners) && cut_triangles(g, corners);
    free(corners);
    return good;
}

/* ---- samples ---- */

/* Bytes of the chunk of numbers, for so many samples. */
static double size_of(const glb *g, double samples) {
    double vertices = (double)g->vertex_count;
    return 4 * (double)g->index_count + vertices * (g->uvs ? 8 : 0) + samples * vertices * (g->index_count ? 24 : 12) +
           4 * samples * samples;
}

static const double most_bytes = 4294967295.0 - (1 << 24); /* of a GLB; the rest is for the JSON */

static skein_status check_size(const glb *g, double samples, skein_error *error) {
    if (size_of(g, samples) <= most_bytes) return SKEIN_OK;
    return io_error_set(error, SKEIN_ERROR_LIMIT, g->path,
                        "%.0f frames of %zu vertices are %.1f GB, and a GLB holds 4: take fewer frames, or one in so "
                        "many (\"every\"), or write usda, pc2 or mdd",
                        samples, g->vertex_count, size_of(g, samples) / 1e9);
}

static void *create(const io_clip *clip, const char *path, skein_error *error) {
    glb *g = calloc(1, sizeof *g);
    if (g) {
        g->path = strdup(path);
        g->name = strdup(clip->name);
        g->seconds = clip->params->every / clip->fps;
        g->weighting = (skein_normals)clip->params->normals;
    }
    if (!g || !g->path || !g->name || !copy_mesh(g, clip)) {
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        glb_free(g);
        return NULL;
    }
    if (!check_size(g, clip->samples, error)) return g;
    glb_free(g);
    return NULL;
}

static skein_status add(void *file, const double *positions, skein_error *error) {
    glb *g = file;
    size_t numbers = 3 * g->mesh.vertex_count;
    skein_status status = check_size(g, (double)g->sample_count + 1, error);
    if (!status) status = io_clip_check_positions(g->path, positions, g->mesh.vertex_count, error);
    if (!status) {
        skein_mesh mesh = g->mesh;
        mesh.positions = positions;
        status = skein_mesh_normals(&mesh, g->weighting, g->normals, error);
    }
    if (status) return status;
    float *sample = malloc((2 * numbers + 1) * sizeof *sample);
    if (!sample || !io_grow(&g->samples, &g->sample_capacity, g->sample_count + 1, sizeof *g->samples)) {
        free(sample);
        return io_error_set(error, SKEIN_ERROR_MEMORY, g->path,
                            "out of memory for frame %zu: a GLB is kept in memory "
                            "until it is whole; take one frame in so many (\"every\")",
                            g->sample_count);
    }
    for (size_t i = 0; i < numbers; i++) {
        sample[i] = (float)positions[i];
        sample[numbers + i] = (float)g->normals[i];
    }
    g->samples[g->sample_count++] = sample;
    return SKEIN_OK;
}

/* ---- the JSON ---- */

/* Writers of one number chunk: bytes so far, and the JSON's lists. */
typedef struct layout {
    json_t *views, *accessors;
    size_t bytes;
} layout;

/* A view of `size` bytes from here on; stride and target 0: none. Returns its place. */
static size_t add_view(layout *l, size_t size, int stride, int target) {
    json_t *view =
        json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset", (json_int_t)l->bytes, "byteLength", (json_int_t)size);
    if (stride) json_object_set_new(view, "byteStride", json_integer(stride));
    if (target) json_object_set_new(view, "target", json_integer(target));
    json_array_append_new(l->views, view);
    l->bytes += size;
    return json_array_size(l->views) - 1;
}

/* Returns its place. */
static size_t add_accessor(layout *l, size_t view, size_t offset, size_t count, int component, const char *type) {
    json_array_append_new(l->accessors, json_pack("{s:I, s:I, s:I, s:i, s:s}", "bufferView", (json_int_t)view,
                                                  "byteOffset", (json_int_t)offset, "count", (json_int_t)count,
                                                  "componentType", component, "type", type));
    return json_array_size(l->accessors) - 1;
}

static void bound_accessor(layout *l, size_t place, const float *least, const float *most, int count) {
    json_t *accessor = json_array_get(l->accessors, place), *lists[2] = {json_array(), json_array()};
    for (int k = 0; k < count; k++) {
        json_array_append_new(lists[0], json_real((double)least[k]));
        json_array_append_new(lists[1], json_real((double)most[k]));
    }
    json_object_set_new(accessor, "min", lists[0]);
    json_object_set_new(accessor, "max", lists[1]);
}

/* A number of sample `s` as it is written: the first sample's own, of the others the way from there. `from`: 0 for
 * positions, else where normals begin. */
static float value_of(const glb *g, size_t s, size_t from, size_t vertex, size_t k) {
    size_t at = from + 3 * (size_t)g->vertex_of[vertex] + k;
    return s ? g->samples[s][at] - g->samples[0][at] : g->samples[0][at];
}

static void bound_positions(const glb *g, layout *l, size_t place, size_t s) {
    float least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t v = 0; v < g->vertex_count; v++)
        for (size_t k = 0; k < 3; k++) {
            float x = value_of(g, s, 0, v, k);
            least[k] = x < least[k] ? x : least[k];
            most[k] = x > most[k] ? x : most[k];
        }
    bound_accessor(l, place, least, most, 3);
}

/* POSITION and NORMAL of a sample, which lie behind each other in the view. */
static json_t *describe_sample(const glb *g, layout *l, size_t view, size_t s) {
    size_t bytes = 12 * g->vertex_count, kinds = g->index_count ? 2 : 1;
    size_t position = add_accessor(l, view, kinds * s * bytes, g->vertex_count, FLOAT, "VEC3");
    bound_positions(g, l, position, s);
    json_t *attributes = json_pack("{s:I}", "POSITION", (json_int_t)position);
    if (g->index_count)
        json_object_set_new(
            attributes, "NORMAL",
            json_integer((json_int_t)add_accessor(l, view, (kinds * s + 1) * bytes, g->vertex_count, FLOAT, "VEC3")));
    return attributes;
}

static json_t *describe_primitive(const glb *g, layout *l) {
    size_t bytes = 12 * g->vertex_count * (g->index_count ? 2 : 1);
    json_t *primitive = json_pack("{s:i, s:i}", "mode", g->index_count ? TRIANGLES : POINTS, "material", 0);
    if (g->index_count) {
        size_t view = add_view(l, 4 * g->index_count, 0, ELEMENT_ARRAY_BUFFER);
        json_object_set_new(primitive, "indices",
                            json_integer((json_int_t)add_accessor(l, view, 0, g->index_count, UINT, "SCALAR")));
    }
    size_t uv_view = g->uvs ? add_view(l, 8 * g->vertex_count, 8, ARRAY_BUFFER) : 0;
    size_t view = add_view(l, bytes * g->sample_count, 12, ARRAY_BUFFER);
    json_t *attributes = describe_sample(g, l, view, 0), *targets = json_array();
    if (g->uvs)
        json_object_set_new(attributes, "TEXCOORD_0",
                            json_integer((json_int_t)add_accessor(l, uv_view, 0, g->vertex_count, FLOAT, "VEC2")));
    json_object_set_new(primitive, "attributes", attributes);
    for (size_t s = 1; s < g->sample_count; s++) json_array_append_new(targets, describe_sample(g, l, view, s));
    if (g->sample_count > 1) json_object_set(primitive, "targets", targets);
    json_decref(targets);
    return primitive;
}

/* The weights over time, and what the targets are called. */
static void describe_motion(const glb *g, layout *l, json_t *root, json_t *mesh) {
    size_t targets = g->sample_count - 1;
    if (!targets) return;
    json_t *names = json_array(), *weights = json_array();
    char name[32];
    for (size_t s = 1; s <= targets; s++) {
        snprintf(name, sizeof name, "sample %zu", s);
        json_array_append_new(names, json_string(name));
        json_array_append_new(weights, json_integer(0));
    }
    json_object_set_new(mesh, "weights", weights);
    json_object_set_new(mesh, "extras", json_pack("{s:o}", "targetNames", names));
    size_t view = add_view(l, 4 * g->sample_count, 0, 0);
    size_t times = add_accessor(l, view, 0, g->sample_count, FLOAT, "SCALAR");
    float first = 0, last = (float)((double)targets * g->seconds);
    bound_accessor(l, times, &first, &last, 1);
    view = add_view(l, 4 * g->sample_count * targets, 0, 0);
    size_t values = add_accessor(l, view, 0, g->sample_count * targets, FLOAT, "SCALAR");
    json_object_set_new(root, "animations",
                        json_pack("[{s:s, s:[{s:I, s:I, s:s}], s:[{s:i, s:{s:i, s:s}}]}]", "name", "motion", "samplers",
                                  "input", (json_int_t)times, "output", (json_int_t)values, "interpolation", "LINEAR",
                                  "channels", "sampler", 0, "target", "node", 0, "path", "weights"));
}

/* The whole JSON, to be freed, and how many bytes of numbers it tells of; NULL without memory. */
static char *describe(const glb *g, size_t *bytes) {
    layout l = {json_array(), json_array(), 0};
    json_t *name = json_string(g->name); // NULL where it is no UTF-8
    json_t *root = json_pack("{s:{s:s, s:s}, s:i, s:[{s:[i]}], s:[{s:i}], s:[{s:b, s:{s:[f,f,f,f], s:i, s:f}}]}",
                             "asset", "version", "2.0", "generator", "Skein " SKEIN_VERSION, "scene", 0, "scenes",
                             "nodes", 0, "nodes", "mesh", 0, "materials", "doubleSided", 1, "pbrMetallicRoughness",
                             "baseColorFactor", 0.8, 0.8, 0.8, 1.0, "metallicFactor", 0, "roughnessFactor", 0.8);
    json_t *mesh = json_pack("{s:[o]}", "primitives", describe_primitive(g, &l));
    if (name) {
        json_object_set(mesh, "name", name);
        json_object_set(json_array_get(json_object_get(root, "nodes"), 0), "name", name);
    }
    describe_motion(g, &l, root, mesh);
    json_object_set_new(root, "meshes", json_pack("[o]", mesh));
    json_object_set_new(root, "bufferViews", l.views);
    json_object_set_new(root, "accessors", l.accessors);
    json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)l.bytes));
    char *text = root ? json_dumps(root, JSON_COMPACT) : NULL;
    json_decref(name);
    json_decref(root);
    *bytes = l.bytes;
    return text;
}

/* ---- the numbers ---- */

static void write_u32(io_output *output, uint32_t value) {
    unsigned char bytes[4];
    io_put_u32(bytes, value);
    io_output_write(output, bytes, 4);
}

static void write_float(io_output *output, float value) {
    write_u32(output, io_float_bits(value));
}

/* In the order of the views. */
static void write_numbers(const glb *g, io_output *output) {
    size_t normals = 3 * g->mesh.vertex_count, targets = g->sample_count - 1;
    for (size_t i = 0; i < g->index_count; i++) write_u32(output, g->indices[i]);
    for (size_t i = 0; g->uvs && i < 2 * g->vertex_count; i++) write_float(output, g->uvs[i]);
    for (size_t s = 0; s < g->sample_count; s++)
        for (size_t from = 0; from <= (g->index_count ? normals : 0); from += normals)
            for (size_t v = 0; v < g->vertex_count; v++)
                for (size_t k = 0; k < 3; k++) write_float(output, value_of(g, s, from, v, k));
    for (size_t s = 0; targets && s < g->sample_count; s++) write_float(output, (float)((double)s * g->seconds));
    for (size_t s = 0; targets && s < g->sample_count; s++)
        for (size_t t = 1; t <= targets; t++) write_float(output, s == t ? 1 : 0);
}

/* What there is of samples, as a whole file. */
static skein_status write_file(const glb *g, const char *path, skein_error *error) {
    if (!g->sample_count) return io_error_set(error, SKEIN_ERROR_VALUE, path, IO_NOTHING_KEPT);
    size_t bytes;
    char *text = describe(g, &bytes);
    if (!text) return io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    size_t length = strlen(text), padded = (length + 3) / 4 * 4; // all numbers are of four bytes
    io_output *output = io_output_open(path, error);
    skein_status status = output ? SKEIN_OK : SKEIN_ERROR_FILE;
    if (output) {
        io_output_write(output, "glTF", 4);
        write_u32(output, 2);
        write_u32(output, (uint32_t)(12 + 8 + padded + 8 + bytes));
        write_u32(output, (uint32_t)padded);
        io_output_write(output, "JSON", 4);
        io_output_write(output, text, length);
        io_output_write(output, "   ", padded - length);
        write_u32(output, (uint32_t)bytes);
        io_output_write(output, "BIN", 4);
        write_numbers(g, output);
        status = io_output_commit(output, error);
    }
    free(text);
    return status;
}

static skein_status commit(void *file, skein_error *error) {
    glb *g = file;
    skein_status status = write_file(g, g->path, error);
    glb_free(g);
    return status;
}

static skein_status keep(void *file, const char *path, skein_error *error) {
    skein_status status = write_file(file, path, error);
    glb_free(file);
    return status;
}

static void abandon(void *file) {
    glb_free(file);
}

static const skein_field fields[] = {
    IO_CLIP_FIELD_EVERY(1, 1, "one sample each so many frames"),
    IO_CLIP_FIELD_NORMALS,
    IO_CLIP_FIELD_SCALE,
};

const io_clip_format io_clip_glb = {
    .kind = {.name = "glb",
             .help = "Binary glTF of a short clip: the mesh, a morph target each frame and their animation; y is up.",
             .category = SKEIN_EXPORTER,
             .fields = fields,
             .field_count = sizeof fields / sizeof *fields,
             .params_size = sizeof(io_clip_params)},
    .ending = ".glb",
    .create = create,
    .add = add,
    .commit = commit,
    .keep = keep,
    .abandon = abandon,
};
