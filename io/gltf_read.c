/* Reads glTF 2.0, as .glb or as .gltf: see mesh.h for what a mesh that was read promises.
 *
 * All meshes of the scene's nodes become one, each where its node puts it. Triangles, strips and fans are read, with
 * their first texture coordinates; materials, skins, morph targets and animations are not: a mesh is as it stands
 * without them. Vertices at exactly the same place become one, since glTF parts them where normals or texture
 * coordinates do.
 *
 * Buffers are the chunk of a .glb, base64 in the JSON, or files in the same folder; no file elsewhere is ever opened.
 * Owns: nothing. Every number of the file is checked before it is used: it may be anyone's.
 */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/bytes.h"
#include "io/weld.h"

enum { MOST_BUFFERS = 64, MOST_DEPTH = 64, MOST_CORNERS = 1 << 28, POINTS = 0, TRIANGLES = 4, STRIP = 5, FAN = 6 };

typedef struct gltf_reader {
    const char *path;
    skein_error *error;
    io_mesh *mesh;
    io_weld weld;
    json_t *root;
    io_bytes buffers[MOST_BUFFERS]; /* those that were looked at; data NULL: not yet */
    const unsigned char *chunk;     /* of a .glb, or NULL */
    size_t chunk_size;
    bool *visited; /* a node each */
    size_t flat, passed_over;
    uint64_t corners; /* so far, of all: a mesh may stand at many nodes */
} gltf_reader;

#define FAIL(reader_, ...) io_error_set((reader_)->error, SKEIN_ERROR_SYNTAX, (reader_)->path, __VA_ARGS__)

static skein_status fail_memory(const gltf_reader *r) {
    return io_error_set(r->error, SKEIN_ERROR_MEMORY, r->path, "out of memory after %zu vertices and %zu faces",
                        r->mesh->vertex_count, r->mesh->face_count);
}

/* ---- JSON ----------------------------------------------------------------------------------- */

/* An item of one of the lists at the top, or NULL. */
static const json_t *item_of(const gltf_reader *r, const char *list, json_int_t place) {
    return place < 0 ? NULL : json_array_get(json_object_get(r->root, list), (size_t)place);
}

/* A whole number from 0 on; `missing` where there is none; -1 where it is something else. */
static json_int_t whole_of(const json_t *object, const char *key, json_int_t missing) {
    const json_t *value = json_object_get(object, key);
    if (!value) return missing;
    return json_is_integer(value) && json_integer_value(value) >= 0 ? json_integer_value(value) : -1;
}

/* ---- Buffers -------------------------------------------------------------------------------- */

static int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

static skein_status read_base64(const gltf_reader *r, const char *text, io_bytes *out) {
    out->data = malloc(strlen(text) / 4 * 3 + 4);
    if (!out->data) return fail_memory(r);
    uint32_t bits = 0;
    for (int have = 0; *text && *text != '='; text++) {
        int digit = base64_digit(*text);
        if (digit < 0) return FAIL(r, "a buffer in the file is no base64");
        bits = bits << 6 | (uint32_t)digit;
        have += 6;
        if (have < 8) continue;
        have -= 8;
        out->data[out->size++] = (char)(bits >> have & 0xff);
    }
    return SKEIN_OK;
}

/* A file in the folder of the mesh; its name may have %20 and the like in it. */
static skein_status read_beside(const gltf_reader *r, const char *uri, size_t most, io_bytes *out) {
    const char *slash = strrchr(r->path, '/');
    size_t folder = slash ? (size_t)(slash + 1 - r->path) : 0, at = folder;
    char *path = malloc(folder + strlen(uri) + 1);
    if (!path) return fail_memory(r);
    memcpy(path, r->path, folder);
    for (const char *c = uri; *c; c++) {
        unsigned value = (unsigned char)*c;
        char hex[3] = {c[0] == '%' ? c[1] : 0, c[0] == '%' && c[1] ? c[2] : 0, 0}, *end;
        if (hex[0] && hex[1]) {
            value = (unsigned)strtoul(hex, &end, 16);
            if (end != hex + 2) value = '%';
            else c += 2;
        }
        path[at++] = (char)value;
    }
    path[at] = 0;
    bool here = at - folder < 256 && !strchr(path + folder, '/') && !strchr(path + folder, '\\') && path[folder] &&
                path[folder] != '.' && strlen(path) == at;
    char quote[IO_QUOTE_SIZE];
    skein_status status = here ? io_file_read_beside(r->path, path, most, out, r->error)
                               : FAIL(r, "the buffer %s is not read: put it into the folder of the file",
                                      io_quote(uri, uri + strlen(uri), quote));
    free(path);
    return status;
}

/* The bytes of a buffer, and how many there are. */
static skein_status find_buffer(gltf_reader *r, json_int_t place, const unsigned char **bytes, size_t *size) {
    const json_t *buffer = item_of(r, "buffers", place);
    const char *uri = json_string_value(json_object_get(buffer, "uri"));
    json_int_t length = whole_of(buffer, "byteLength", -1);
    if (!buffer || length < 1) return FAIL(r, "buffer %lld is not there, or has no byteLength", (long long)place);
    if (place >= MOST_BUFFERS)
        return io_error_set(r->error, SKEIN_ERROR_LIMIT, r->path, "more than %d buffers: save it as one .glb",
                            MOST_BUFFERS);
    io_bytes *own = &r->buffers[place];
    if (!uri && place == 0 && r->chunk) {
        *bytes = r->chunk;
        *size = r->chunk_size;
    } else {
        const char *data = uri && !strncmp(uri, "data:", 5) ? strstr(uri, ";base64,") : NULL;
        skein_status status = SKEIN_OK;
        if (!uri) status = FAIL(r, "buffer %lld has no bytes", (long long)place);
        else if (!data && !strncmp(uri, "data:", 5))
            status = FAIL(r, "buffer %lld in the file is no base64", (long long)place);
        else if (!own->data && data) status = read_base64(r, data + 8, own);
        else if (!own->data) status = read_beside(r, uri, SIZE_MAX / 2, own);
        if (status) return status;
        *bytes = (const unsigned char *)own->data;
        *size = own->size;
    }
    if ((uint64_t)length <= *size) {
        *size = (size_t)length;
        return SKEIN_OK;
    }
    return FAIL(r, "buffer %lld has %zu bytes of the %lld that it promises: it is cut off", (long long)place, *size,
                (long long)length);
}

/* ---- Accessors -------------------------------------------------------------------------------- */

/* Numbers in a buffer: `count` groups of `width`, each `stride` bytes behind the other. */
typedef struct numbers {
    const unsigned char *bytes;
    size_t count, stride, width;
    int type; /* 5120 ... 5126 */
    bool normalized;
} numbers;

static size_t size_of(int type) {
    switch (type) {
    case 5120:
    case 5121: return 1;
    case 5122:
    case 5123: return 2;
    case 5125:
    case 5126: return 4;
    default: return 0;
    }
}

static skein_status find_numbers(gltf_reader *r, json_int_t place, const char *type, size_t width, numbers *n) {
    const json_t *accessor = item_of(r, "accessors", place);
    const char *has = json_string_value(json_object_get(accessor, "type"));
    if (!accessor || !has || strcmp(has, type))
        return FAIL(r, "accessor %lld is not there, or is no %s", (long long)place, type);
    if (json_object_get(accessor, "sparse"))
        return FAIL(r, "accessor %lld is sparse, which is not read: save the mesh without", (long long)place);
    const json_t *view = item_of(r, "bufferViews", whole_of(accessor, "bufferView", -1));
    json_int_t count = whole_of(accessor, "count", -1), offset = whole_of(accessor, "byteOffset", 0);
    json_int_t begin = whole_of(view, "byteOffset", 0), length = whole_of(view, "byteLength", -1);
    *n = (numbers){.width = width,
                   .type = (int)whole_of(accessor, "componentType", -1),
                   .normalized = json_is_true(json_object_get(accessor, "normalized"))};
    size_t item = width * size_of(n->type), size = 0;
    json_int_t stride = whole_of(view, "byteStride", (json_int_t)item);
    if (!view || !item || count < 1 || offset < 0 || begin < 0 || length < 1 || stride < (json_int_t)item ||
        stride > 252)
        return FAIL(r, "accessor %lld or its view is not as glTF 2.0 has it", (long long)place);
    skein_status status = find_buffer(r, whole_of(view, "buffer", -1), &n->bytes, &size);
    if (status) return status;
    // no sum passes 2^63: each is below the size of what is in memory, looked at one after the other
    bool inside = (uint64_t)begin <= size && (uint64_t)length <= size - (uint64_t)begin && offset <= length &&
                  (uint64_t)(length - offset) >= item &&
                  (uint64_t)(count - 1) <= ((uint64_t)(length - offset) - item) / (uint64_t)stride;
    if (!inside) return FAIL(r, "accessor %lld reaches beyond its view or buffer", (long long)place);
    n->bytes += (size_t)begin + (size_t)offset;
    n->count = (size_t)count;
    n->stride = (size_t)stride;
    return SKEIN_OK;
}

static double number_at(const numbers *n, size_t item, size_t k) {
    const unsigned char *at = n->bytes + item * n->stride + k * size_of(n->type);
    switch (n->type) {
    case 5121: return n->normalized ? at[0] / 255.0 : at[0];
    case 5123: return (at[0] + 256 * at[1]) / (n->normalized ? 65535.0 : 1.0);
    case 5125: return (double)io_get_u32(at);
    case 5126: return (double)io_get_float(at);
    default: return 0;
    }
}

/* ---- Primitives ------------------------------------------------------------------------------- */

typedef struct primitive {
    numbers positions, uvs, indices;
    bool has_uvs, has_indices;
    size_t first_uv;
    uint32_t *vertices; /* of the mesh, for each of the primitive's */
} primitive;

static skein_status find_primitive(gltf_reader *r, const json_t *json, primitive *p) {
    const json_t *attributes = json_object_get(json, "attributes");
    skein_status status = find_numbers(r, whole_of(attributes, "POSITION", -1), "VEC3", 3, &p->positions);
    if (!status && p->positions.type != 5126) status = FAIL(r, "positions have to be floats");
    p->has_uvs = json_object_get(attributes, "TEXCOORD_0") != NULL;
    p->has_indices = json_object_get(json, "indices") != NULL;
    if (!status && p->has_uvs) status = find_numbers(r, whole_of(attributes, "TEXCOORD_0", -1), "VEC2", 2, &p->uvs);
    if (!status && p->has_uvs && p->uvs.count < p->positions.count)
        status = FAIL(r, "a mesh has fewer texture coordinates than vertices");
    if (!status && p->has_indices) status = find_numbers(r, whole_of(json, "indices", -1), "SCALAR", 1, &p->indices);
    if (!status && p->has_indices && p->indices.type == 5126) status = FAIL(r, "indices have to be whole");
    r->corners += p->positions.count + (p->has_indices ? p->indices.count : 0);
    if (!status && r->corners > MOST_CORNERS)
        status = io_error_set(r->error, SKEIN_ERROR_LIMIT, r->path,
                              "more than %d vertices and corners, those of a mesh counted at each of its nodes",
                              MOST_CORNERS);
    return status;
}

static skein_status add_vertices(gltf_reader *r, primitive *p, const double matrix[16]) {
    p->first_uv = r->mesh->uv_count;
    p->vertices = malloc((p->positions.count + 1) * sizeof *p->vertices);
    if (!p->vertices) return fail_memory(r);
    for (size_t v = 0; v < p->positions.count; v++) {
        double at[3], placed[3];
        for (size_t k = 0; k < 3; k++) at[k] = number_at(&p->positions, v, k);
        for (size_t k = 0; k < 3; k++) {
            placed[k] = matrix[k] * at[0] + matrix[4 + k] * at[1] + matrix[8 + k] * at[2] + matrix[12 + k];
            if (!isfinite(placed[k])) return FAIL(r, "vertex %zu of a mesh is not finite", v);
        }
        if (!io_weld_vertex(&r->weld, r->mesh, placed, &p->vertices[v])) return fail_memory(r);
        double uv[2] = {0, 0};
        for (size_t k = 0; p->has_uvs && k < 2; k++) uv[k] = number_at(&p->uvs, v, k);
        if (!isfinite(uv[0]) || !isfinite(uv[1])) return FAIL(r, "a texture coordinate of vertex %zu is not finite", v);
        uv[1] = 1 - uv[1]; // glTF counts down from an image's upper edge
        if (p->has_uvs && (r->mesh->uv_count >= IO_NO_UV - 1 || !io_mesh_add_uv(r->mesh, uv))) return fail_memory(r);
    }
    return SKEIN_OK;
}

static skein_status add_triangle(gltf_reader *r, const primitive *p, const size_t corners[3]) {
    uint32_t v[3];
    size_t own[3];
    for (int c = 0; c < 3; c++) {
        double index = p->has_indices ? number_at(&p->indices, corners[c], 0) : (double)corners[c];
        if (index >= (double)p->positions.count)
            return FAIL(r, "index %.0f in a mesh of %zu vertices", index, p->positions.count);
        own[c] = (size_t)index;
        v[c] = p->vertices[own[c]];
    }
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        r->flat++;
        return SKEIN_OK;
    }
    bool good = true;
    for (int c = 0; c < 3; c++)
        good = good && io_mesh_add_corner(r->mesh, v[c], p->has_uvs ? (uint32_t)(p->first_uv + own[c]) : IO_NO_UV);
    return good && io_mesh_add_face(r->mesh, 3) ? SKEIN_OK : fail_memory(r);
}

static skein_status add_triangles(gltf_reader *r, const primitive *p, json_int_t mode) {
    size_t count = p->has_indices ? p->indices.count : p->positions.count;
    size_t step = mode == TRIANGLES ? 3 : 1;
    skein_status status = SKEIN_OK;
    for (size_t i = 0; i + 2 < count && !status; i += step) {
        bool turned = mode == STRIP && i % 2; // every other triangle of a strip runs backwards
        size_t corners[3] = {mode == FAN ? 0 : i, i + (turned ? 2 : 1), i + (turned ? 1 : 2)};
        status = add_triangle(r, p, corners);
    }
    return status;
}

static skein_status add_primitive(gltf_reader *r, const json_t *json, const double matrix[16]) {
    json_int_t mode = whole_of(json, "mode", TRIANGLES);
    primitive p = {.vertices = NULL};
    if (mode != TRIANGLES && mode != STRIP && mode != FAN) {
        r->passed_over++;
        return SKEIN_OK;
    }
    skein_status status = find_primitive(r, json, &p);
    if (!status) status = add_vertices(r, &p, matrix);
    if (!status) status = add_triangles(r, &p, mode);
    free(p.vertices);
    return status;
}

static skein_status add_mesh(gltf_reader *r, json_int_t place, const double matrix[16]) {
    const json_t *mesh = item_of(r, "meshes", place), *json;
    size_t index;
    if (!mesh) return FAIL(r, "there is no mesh %lld", (long long)place);
    json_array_foreach((json_t *)(uintptr_t)json_object_get(mesh, "primitives"), index, json) {
        skein_status status = add_primitive(r, json, matrix);
        if (status) return status;
    }
    return SKEIN_OK;
}

/* ---- Nodes -------------------------------------------------------------------------------------- */

static void read_list(const json_t *node, const char *key, double *out, size_t count) {
    const json_t *list = json_object_get(node, key);
    for (size_t i = 0; json_array_size(list) == count && i < count; i++)
        out[i] = json_number_value(json_array_get(list, i));
}

/* Its matrix, column after column; or made of its translation, rotation (a quaternion) and scale. */
static void read_matrix(const json_t *node, double m[16]) {
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    read_list(node, "translation", t, 3);
    read_list(node, "rotation", q, 4);
    read_list(node, "scale", s, 3);
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double turn[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
                            2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
                            2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
    memset(m, 0, 16 * sizeof *m);
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 0; k < 3; k++) m[4 * c + k] = s[c] * turn[3 * c + k];
    for (size_t k = 0; k < 3; k++) m[12 + k] = t[k];
    m[15] = 1;
    read_list(node, "matrix", m, 16);
}

static skein_status add_node(gltf_reader *r, json_int_t place, const double above[16], int depth) {
    const json_t *node = item_of(r, "nodes", place), *child;
    if (!node) return FAIL(r, "there is no node %lld", (long long)place);
    if (r->visited[place]) return FAIL(r, "node %lld is in the scene twice: nodes have to be a tree", (long long)place);
    if (depth > MOST_DEPTH)
        return io_error_set(r->error, SKEIN_ERROR_LIMIT, r->path, "nodes are nested more than %d deep", MOST_DEPTH);
    r->visited[place] = true;
    double own[16], m[16];
    read_matrix(node, own);
    for (size_t c = 0; c < 4; c++)
        for (size_t k = 0; k < 4; k++) {
            m[4 * c + k] = 0;
            for (size_t i = 0; i < 4; i++) m[4 * c + k] += above[4 * i + k] * own[4 * c + i];
        }
    skein_status status = SKEIN_OK;
    if (json_object_get(node, "mesh")) status = add_mesh(r, whole_of(node, "mesh", -1), m);
    size_t index;
    json_array_foreach((json_t *)(uintptr_t)json_object_get(node, "children"), index, child) {
        if (status) break;
        status = add_node(r, json_is_integer(child) ? json_integer_value(child) : -1, m, depth + 1);
    }
    return status;
}

/* The scene's nodes; of a file without a scene all meshes, as they stand. */
static skein_status add_scene(gltf_reader *r) {
    static const double unit[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const json_t *scene = item_of(r, "scenes", whole_of(r->root, "scene", 0)), *node;
    skein_status status = SKEIN_OK;
    size_t index, meshes = json_array_size(json_object_get(r->root, "meshes"));
    r->visited = calloc(json_array_size(json_object_get(r->root, "nodes")) + 1, sizeof *r->visited);
    if (!r->visited) return fail_memory(r);
    if (!scene)
        for (size_t m = 0; m < meshes && !status; m++) status = add_mesh(r, (json_int_t)m, unit);
    json_array_foreach((json_t *)(uintptr_t)json_object_get(scene, "nodes"), index, node) {
        if (status) break;
        status = add_node(r, json_is_integer(node) ? json_integer_value(node) : -1, unit, 0);
    }
    return status;
}

/* ---- The file ------------------------------------------------------------------------------------- */

static skein_status parse(gltf_reader *r, const char *text, size_t size) {
    json_error_t fault;
    r->root = json_loadb(text, size, 0, &fault);
    if (!r->root)
        return io_error_at(r->error, SKEIN_ERROR_SYNTAX, r->path, fault.line > 0 ? (size_t)fault.line : 1,
                           "the JSON of the file: %s", fault.text);
    const char *version = json_string_value(json_object_get(json_object_get(r->root, "asset"), "version"));
    if (!version || version[0] != '2')
        return FAIL(r, "%s%s: expected glTF 2.0", version ? "glTF of version " : "no glTF: it has no version",
                    version ? version : "");
    const char *needed = json_string_value(json_array_get(json_object_get(r->root, "extensionsRequired"), 0));
    char quote[IO_QUOTE_SIZE];
    if (needed)
        return FAIL(r, "it needs the extension %s, which is not read: save the mesh without (no compression)",
                    io_quote(needed, needed + strlen(needed), quote));
    return SKEIN_OK;
}

/* The chunks of a .glb. */
static skein_status parse_chunks(gltf_reader *r, const unsigned char *bytes, size_t size) {
    if (size < 20 || io_get_u32(bytes + 4) != 2) return FAIL(r, "a .glb of another version, or cut off: expected 2");
    if (io_get_u32(bytes + 8) > size)
        return FAIL(r, "the file has %zu of the %lu bytes that its header promises: it is cut off", size,
                    (unsigned long)io_get_u32(bytes + 8));
    uint64_t length = io_get_u32(bytes + 12);
    if (memcmp(bytes + 16, "JSON", 4) || length > size - 20)
        return FAIL(r, "the first chunk is no JSON, or is cut off");
    size_t next = 20 + (size_t)length;
    if (size - next >= 8 && !memcmp(bytes + next + 4, "BIN", 4)) {
        r->chunk_size = io_get_u32(bytes + next);
        r->chunk = bytes + next + 8;
        if (r->chunk_size > size - next - 8) return FAIL(r, "the chunk of numbers is cut off");
    }
    return parse(r, (const char *)bytes + 20, (size_t)length);
}

static void tell(const gltf_reader *r, io_warnings warnings) {
    if (r->flat)
        io_warn(warnings, "%s: %zu triangle%s with two corners at one place %s left out", r->path, r->flat,
                r->flat == 1 ? "" : "s", r->flat == 1 ? "is" : "are");
    if (r->passed_over) io_warn(warnings, "%s: points and lines in the file are left out", r->path);
}

skein_status io_gltf_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                          skein_error *error) {
    *out = (io_mesh){0};
    gltf_reader r = {.path = path, .error = error, .mesh = out};
    skein_status status;
    if (size >= 4 && !memcmp(text, "glTF", 4)) status = parse_chunks(&r, (const unsigned char *)text, size);
    else status = parse(&r, text, size);
    if (!status) status = add_scene(&r);
    if (!status && !out->face_count)
        status = FAIL(&r, "no triangles in the file%s", r.passed_over ? ", only points or lines" : "");
    for (size_t b = 0; b < MOST_BUFFERS; b++) io_bytes_free(&r.buffers[b]);
    io_weld_free(&r.weld);
    free(r.visited);
    json_decref(r.root);
    if (status) io_mesh_free(out);
    else tell(&r, warnings);
    return status;
}
