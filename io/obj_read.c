/* Reads Wavefront OBJ: see mesh.h for what a mesh that was read promises.
 *
 *   v x y z [w | r g b | w r g b]   a vertex; what follows z is checked and left out
 *   vt u [v [w]]                    a texture coordinate
 *   f a b c ...                     a face; a corner is v, v/vt, v//vn or v/vt/vn
 *
 * Indices count from 1 over the whole file; negative ones count back from the latest line so far. A
 * positive one may point ahead, so those that do are kept with their line and judged at the end. All
 * else that a mesh of faces can do without is passed over; what would have drawn something, and words
 * that OBJ does not know, are warnings.
 *
 * Format: Wavefront Technologies, Advanced Visualizer Manual, appendix B1 (1995).
 */
#include "io/mesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How often something was passed over, and where first. */
typedef struct tally {
    size_t count, line;
} tally;

/* A positive index past the vertices there were at its line. */
typedef struct forward {
    uint64_t index; /* as in the file */
    size_t line;
} forward;

/* A corner's indices as in the file; what follows the second slash is a normal's. */
typedef struct corner {
    int64_t vertex, uv;
    bool has_uv;
} corner;

typedef struct obj_reader {
    io_scan scan;
    io_mesh *mesh;
    forward *forwards;
    size_t forward_count, forward_capacity;
    tally weights, uvs, undrawn, unknown;
    size_t object;       /* the last mark that names one, and 1 more */
    size_t object_count; /* that have faces */
    size_t object_faces; /* faces there were before it */
    bool in_face;
} obj_reader;

static const char *const passed_over[] = {"vn",       "vp",   "mg",         "usemap",    "maplib", "cstype",
                                          "deg",      "bmat", "step",       "parm",      "trim",   "hole",
                                          "scrv",     "sp",   "end",        "con",       "bevel",  "c_interp",
                                          "d_interp", "lod",  "shadow_obj", "trace_obj", "ctech",  "stech"};
static const char *const kept[] = {"o", "g", "s", "usemtl", "mtllib"};
static const char *const undrawn[] = {"l", "p", "curv", "curv2", "surf", "call", "bsp", "bzp", "cdc", "cdp", "res"};

static void count_in(tally *t, size_t line) {
    if (t->count++ == 0) t->line = line;
}

static skein_status fail_memory(const obj_reader *reader) {
    return io_error_at(reader->scan.error, SKEIN_ERROR_MEMORY, reader->scan.path, reader->scan.line,
                       "out of memory after %zu vertices and %zu faces", reader->mesh->vertex_count,
                       reader->mesh->face_count);
}

/* ---- Vertices ------------------------------------------------------------------------------ */

static skein_status read_vertex(obj_reader *reader, size_t line) {
    static const char *const names[8] = {"x", "y", "z", "the value after z", "a colour", "a colour", "a colour", ""};
    double values[8];
    int count = 0;
    for (io_word word; count < 8 && io_scan_word(&reader->scan, &word); count++) {
        skein_status status = io_scan_number(&reader->scan, word, names[count], &values[count]);
        if (status != SKEIN_OK) return status;
    }
    if (count < 3 || count == 5 || count == 8)
        return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, line,
                           "a vertex of %d%s numbers: expected x y z, perhaps with a weight or a colour%s", count,
                           count == 8 ? " or more" : "", count < 3 ? io_scan_cut_hint(&reader->scan) : "");
    if ((count == 4 || count == 7) && values[3] != 1) count_in(&reader->weights, line);
    if (reader->mesh->vertex_count == IO_MESH_MOST_VERTICES)
        return io_error_at(reader->scan.error, SKEIN_ERROR_LIMIT, reader->scan.path, line, "more than %lu vertices",
                           (unsigned long)IO_MESH_MOST_VERTICES);
    return io_mesh_add_vertex(reader->mesh, values) ? SKEIN_OK : fail_memory(reader);
}

/* One to three numbers, of which two are kept. */
static skein_status read_uv(obj_reader *reader, size_t line) {
    double values[3] = {0, 0, 0};
    int count = 0;
    for (io_word word; io_scan_word(&reader->scan, &word); count++) {
        // Exporters write nan here for faces without area; it does no harm to a particle.
        if (count < 3 && io_number_parse(word.begin, word.end, &values[count]) == IO_NUMBER_NOT_FINITE) {
            values[count] = 0;
            count_in(&reader->uvs, line);
        } else if (count < 3) {
            skein_status status = io_scan_number(&reader->scan, word, "a texture coordinate", &values[count]);
            if (status != SKEIN_OK) return status;
        }
    }
    if (count < 1 || count > 3)
        return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, line,
                           "a texture coordinate of %d numbers: expected 1 to 3%s", count,
                           count < 1 ? io_scan_cut_hint(&reader->scan) : "");
    return io_mesh_add_uv(reader->mesh, values) ? SKEIN_OK : fail_memory(reader);
}

/* ---- Faces --------------------------------------------------------------------------------- */

/* A whole number with a sign at `p`; one too long to matter is cut off. Returns its end, `p` if none. */
static const char *read_index(const char *p, const char *end, int64_t *index) {
    const char *begin = p;
    bool negative = p < end && *p == '-';
    p += p < end && (*p == '-' || *p == '+');
    const char *digits = p;
    int64_t value = 0;
    for (; p < end && *p >= '0' && *p <= '9'; p++)
        if (value < 100000000000000) value = value * 10 + (*p - '0');
    *index = negative ? -value : value;
    return p > digits ? p : begin;
}

/* v, v/vt, v//vn, v/vt/vn, and the "v/" and "v//" some programs write. */
static skein_status read_corner(const obj_reader *reader, io_word word, corner *out) {
    int64_t indices[3] = {0, 0, 0};
    bool given[3] = {false, false, false};
    const char *p = word.begin;
    for (int part = 0; part < 3; part++) {
        const char *after = read_index(p, word.end, &indices[part]);
        given[part] = after > p;
        p = after;
        if (part == 2 || p == word.end || *p != '/') break;
        p++;
    }
    *out = (corner){indices[0], indices[1], given[1]};
    int64_t most = (int64_t)IO_MESH_MOST_VERTICES;
    if (given[0] && p == word.end && indices[0] <= most && indices[0] >= -most) return SKEIN_OK;
    char quote[IO_QUOTE_SIZE];
    if (given[0] && p == word.end)
        return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, word.line,
                           "a face's corner is %s: a mesh has at most %lld vertices",
                           io_quote(word.begin, word.end, quote), (long long)most);
    return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, word.line,
                       "a face's corner is %s: expected one such as 7, 7/2, 7//3 or 7/2/3",
                       io_quote(word.begin, word.end, quote));
}

static skein_status fail_range(const obj_reader *reader, size_t line, int64_t index) {
    size_t count = reader->mesh->vertex_count;
    if (index == 0)
        return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, line,
                           "vertex 0 in a face: OBJ counts from 1, or back from -1");
    if (index < 0)
        return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, line,
                           "vertex %lld in a face, but only %zu %s come before it", (long long)index, count,
                           count == 1 ? "vertex" : "vertices");
    return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, line,
                       "vertex %lld in a face, but the file has %zu %s", (long long)index, count,
                       count == 1 ? "vertex" : "vertices");
}

/* From the file's index to ours. */
static skein_status resolve_vertex(obj_reader *reader, size_t line, int64_t index, uint32_t *vertex) {
    size_t count = reader->mesh->vertex_count;
    if (index < 0 && (uint64_t)-index <= count) {
        *vertex = (uint32_t)(count - (uint64_t)-index);
        return SKEIN_OK;
    }
    if (index <= 0) return fail_range(reader, line, index);
    *vertex = (uint32_t)(index - 1);
    if ((uint64_t)index <= count) return SKEIN_OK;
    // It points ahead: judged when all vertices are known.
    if (!io_grow(&reader->forwards, &reader->forward_capacity, reader->forward_count + 1, sizeof(forward)))
        return fail_memory(reader);
    reader->forwards[reader->forward_count++] = (forward){(uint64_t)index, line};
    return SKEIN_OK;
}

/* A place that cannot be stands as IO_NO_UV - 1 until the end. */
static uint32_t resolve_uv(const obj_reader *reader, int64_t index) {
    int64_t place = index > 0 ? index - 1 : index < 0 ? (int64_t)reader->mesh->uv_count + index : -1;
    return place >= 0 && place < (int64_t)IO_NO_UV - 1 ? (uint32_t)place : IO_NO_UV - 1;
}

static skein_status read_face(obj_reader *reader, size_t line) {
    size_t size = 0;
    for (io_word word; io_scan_word(&reader->scan, &word); size++) {
        corner c;
        uint32_t vertex = 0;
        skein_status status = read_corner(reader, word, &c);
        if (status == SKEIN_OK) status = resolve_vertex(reader, word.line, c.vertex, &vertex);
        if (status != SKEIN_OK) return status;
        if (!io_mesh_add_corner(reader->mesh, vertex, c.has_uv ? resolve_uv(reader, c.uv) : IO_NO_UV))
            return fail_memory(reader);
    }
    return io_scan_close_face(&reader->scan, reader->mesh, line, size, 1);
}

/* ---- Lines --------------------------------------------------------------------------------- */

static bool is_one_of(io_word word, const char *const *list, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (io_word_is(word, list[i])) return true;
    return false;
}

/* Keeps a line for the writer: its words, a blank between each two. */
static skein_status keep_line(obj_reader *reader, io_word word) {
    char *line = NULL;
    size_t length = 0, capacity = 0;
    bool object = io_word_is(word, "o"), good = true;
    do {
        size_t size = (size_t)(word.end - word.begin);
        good = io_grow(&line, &capacity, length + size + 2, 1);
        if (!good) break;
        if (length) line[length++] = ' ';
        memcpy(line + length, word.begin, size);
        line[length += size] = 0;
    } while (io_scan_word(&reader->scan, &word));
    if (!good) free(line);
    if (!good || !io_mesh_add_mark(reader->mesh, line)) return fail_memory(reader);
    if (object) {
        reader->object_count += reader->mesh->face_count > reader->object_faces;
        reader->object_faces = reader->mesh->face_count;
        reader->object = reader->mesh->mark_count;
    }
    return SKEIN_OK;
}

/* A fault in a face says whose it is, where the file has names: that is where to mend it. */
static void name_object(const obj_reader *reader) {
    skein_error *error = reader->scan.error;
    if (!error || !reader->in_face || !reader->object) return;
    const char *line = reader->mesh->marks[reader->object - 1].line, *name = line + strcspn(line, " ");
    size_t length = strlen(error->message);
    char quote[IO_QUOTE_SIZE];
    name += *name == ' ';
    snprintf(error->message + length, sizeof error->message - length,
             "; it belongs to the object %s: mend or delete the face there", io_quote(name, name + strlen(name), quote));
}

/* A word that is neither vertex nor face. */
static skein_status pass_over(obj_reader *reader, io_word word) {
    if (is_one_of(word, kept, sizeof kept / sizeof *kept)) return keep_line(reader, word);
    if (is_one_of(word, passed_over, sizeof passed_over / sizeof *passed_over)) return SKEIN_OK;
    if (is_one_of(word, undrawn, sizeof undrawn / sizeof *undrawn)) {
        count_in(&reader->undrawn, word.line);
        return SKEIN_OK;
    }
    for (const char *p = word.begin; p < word.end; p++)
        if (*p < ' ' || *p > '~') {
            char quote[IO_QUOTE_SIZE];
            return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, word.line,
                               "the line begins with %s: the file is binary or damaged, expected OBJ text",
                               io_quote(word.begin, word.end, quote));
        }
    count_in(&reader->unknown, word.line);
    return SKEIN_OK;
}

static skein_status read_line(obj_reader *reader) {
    io_word word;
    if (!io_scan_word(&reader->scan, &word)) return SKEIN_OK;
    if (io_word_is(word, "v")) return read_vertex(reader, word.line);
    reader->in_face = io_word_is(word, "f") || io_word_is(word, "fo");
    if (reader->in_face) return read_face(reader, word.line);
    if (io_word_is(word, "vt")) return read_uv(reader, word.line);
    return pass_over(reader, word);
}

/* What only the whole file can tell. */
static skein_status finish(obj_reader *reader) {
    io_mesh *mesh = reader->mesh;
    const io_scan *scan = &reader->scan;
    if (mesh->vertex_count == 0)
        return io_error_set(scan->error, SKEIN_ERROR_SYNTAX, scan->path,
                            "no vertices in the file: expected lines such as \"v 0 1 0\"");
    if (mesh->face_count == 0)
        return io_error_set(scan->error, SKEIN_ERROR_SYNTAX, scan->path,
                            "no faces in the file: expected lines such as \"f 1 2 3\"");
    for (size_t i = 0; i < reader->forward_count; i++)
        if (reader->forwards[i].index > mesh->vertex_count)
            return fail_range(reader, reader->forwards[i].line, (int64_t)reader->forwards[i].index);
    for (size_t i = 0; i < mesh->face_vertex_count; i++)
        if (mesh->face_uvs[i] != IO_NO_UV && mesh->face_uvs[i] >= mesh->uv_count) {
            mesh->face_uvs[i] = IO_NO_UV;
            reader->uvs.count++;
        }
    return SKEIN_OK;
}

static void warn_tally(io_warnings warnings, const char *path, tally t, const char *what) {
    if (t.count == 0) return;
    char place[32] = "";
    if (t.line > 0) snprintf(place, sizeof place, ":%zu", t.line);
    io_warn(warnings, "%s%s: %s (%zu in the file)", path, place, what, t.count);
}

skein_status io_obj_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                         skein_error *error) {
    *out = (io_mesh){0};
    obj_reader reader = {.scan = {.continues = true, .path = path, .error = error}, .mesh = out};
    skein_status status = io_scan_start(&reader.scan, text, size);
    if (status == SKEIN_OK) status = io_scan_check_text(&reader.scan);
    if (status == SKEIN_OK) do
            status = read_line(&reader);
        while (status == SKEIN_OK && io_scan_line(&reader.scan));
    if (status != SKEIN_OK) name_object(&reader);
    if (status == SKEIN_OK) status = finish(&reader);
    if (status == SKEIN_OK) {
        warn_tally(warnings, path, reader.unknown, "a line that OBJ does not know was passed over");
        warn_tally(warnings, path, reader.undrawn, "points, lines and curves are not read, only faces");
        warn_tally(warnings, path, reader.weights, "a vertex's weight other than 1 was left out");
        warn_tally(warnings, path, reader.uvs, "a texture coordinate that does not exist was left out");
        reader.object_count += out->face_count > reader.object_faces;
        if (reader.object_count > 1)
            io_warn(warnings,
                    "%s: its %zu objects become one body; save each as a file of its own for a body of its own", path,
                    reader.object_count);
    } else io_mesh_free(out);
    free(reader.forwards);
    return status;
}
