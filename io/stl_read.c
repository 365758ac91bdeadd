/* Reads STL, binary or as text: see mesh.h for what a mesh that was read promises.
 *
 *   binary   80 bytes of anything, uint32 triangles, of each 12 floats (normal, corners) and 2 bytes
 *   text     solid NAME / facet normal x y z / outer loop / vertex x y z (three) / endloop / endfacet ... / endsolid
 *
 * A file is binary where its size says so; many binary ones begin with "solid", too. Corners at the same place become
 * one vertex. Triangles with two corners at one place are left out, with a warning.
 */
#include "io/bytes.h"
#include "io/weld.h"

#include <math.h>
#include <string.h>

enum { HEAD_BYTES = 84, TRIANGLE_BYTES = 50 };

typedef struct stl_reader {
    const char *path;
    skein_error *error;
    io_mesh *mesh;
    io_weld weld;
    size_t flat; /* triangles that were left out */
} stl_reader;

static skein_status add_triangle(stl_reader *reader, double corners[3][3]) {
    uint32_t v[3];
    for (int c = 0; c < 3; c++)
        if (!io_weld_vertex(&reader->weld, reader->mesh, corners[c], &v[c]))
            return io_error_set(reader->error, SKEIN_ERROR_MEMORY, reader->path, "out of memory after %zu vertices",
                                reader->mesh->vertex_count);
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
        reader->flat++;
        return SKEIN_OK;
    }
    bool good = true;
    for (int c = 0; c < 3; c++) good = good && io_mesh_add_corner(reader->mesh, v[c], IO_NO_UV);
    if (good && io_mesh_add_face(reader->mesh, 3)) return SKEIN_OK;
    return io_error_set(reader->error, SKEIN_ERROR_MEMORY, reader->path, "out of memory after %zu triangles",
                        reader->mesh->face_count);
}

static skein_status read_binary(stl_reader *reader, const unsigned char *bytes, uint32_t count) {
    for (uint32_t t = 0; t < count; t++) {
        const unsigned char *at = bytes + HEAD_BYTES + (size_t)t * TRIANGLE_BYTES + 12;
        double corners[3][3];
        for (size_t i = 0; i < 9; i++) {
            corners[i / 3][i % 3] = (double)io_get_float(at + 4 * i);
            if (!isfinite(corners[i / 3][i % 3]))
                return io_error_set(reader->error, SKEIN_ERROR_SYNTAX, reader->path,
                                    "triangle %lu of %lu has a coordinate that is not finite", (unsigned long)t + 1,
                                    (unsigned long)count);
        }
        skein_status status = add_triangle(reader, corners);
        if (status) return status;
    }
    return SKEIN_OK;
}

/* Fails where the next word is another one. */
static skein_status expect(io_scan *scan, const char *ought) {
    io_word word;
    char quote[IO_QUOTE_SIZE];
    if (!io_scan_word(scan, &word) && !io_scan_next_line_word(scan, &word))
        return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, scan->line,
                           "the file ends where '%s' is expected: it is cut off", ought);
    if (io_word_is(word, ought)) return SKEIN_OK;
    return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, word.line, "%s: expected '%s'",
                       io_quote(word.begin, word.end, quote), ought);
}

static skein_status read_numbers(io_scan *scan, double numbers[3]) {
    static const char *const names[] = {"x", "y", "z"};
    io_word word;
    for (int k = 0; k < 3; k++) {
        if (!io_scan_word(scan, &word))
            return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, scan->line,
                               "the line ends where %s is expected%s", names[k], io_scan_cut_hint(scan));
        skein_status status = io_scan_number(scan, word, names[k], &numbers[k]);
        if (status) return status;
    }
    return SKEIN_OK;
}

/* Behind "facet". The normal may be anything, nan too: it is not needed. */
static skein_status read_facet(stl_reader *reader, io_scan *scan) {
    double corners[3][3];
    io_word word;
    while (io_scan_word(scan, &word)) continue;
    skein_status status = expect(scan, "outer");
    if (!status) status = expect(scan, "loop");
    for (int c = 0; c < 3 && !status; c++) {
        status = expect(scan, "vertex");
        if (!status) status = read_numbers(scan, corners[c]);
    }
    if (!status) status = expect(scan, "endloop");
    if (!status) status = expect(scan, "endfacet");
    return status ? status : add_triangle(reader, corners);
}

static skein_status read_text(stl_reader *reader, const char *text, size_t size) {
    io_scan scan = {.continues = false, .path = reader->path, .error = reader->error};
    io_word word;
    skein_status status = io_scan_start(&scan, text, size);
    if (!status) status = io_scan_check_text(&scan);
    if (status) return status;
    bool open = false;
    if (!io_scan_word(&scan, &word) && !io_scan_next_line_word(&scan, &word)) word = (io_word){text, text, 1};
    // the name behind "solid" is what stands in its line
    do {
        char quote[IO_QUOTE_SIZE];
        if (io_word_is(word, "solid") || io_word_is(word, "endsolid")) open = io_word_is(word, "solid");
        else if (open && io_word_is(word, "facet")) status = read_facet(reader, &scan);
        else
            status = io_error_at(scan.error, SKEIN_ERROR_SYNTAX, scan.path, word.line, "%s: expected '%s'",
                                 io_quote(word.begin, word.end, quote), open ? "facet' or 'endsolid" : "solid");
    } while (!status && io_scan_next_line_word(&scan, &word));
    if (!status && open)
        status = io_error_at(scan.error, SKEIN_ERROR_SYNTAX, scan.path, scan.line,
                             "the file ends after %zu triangles, without 'endsolid': it is cut off",
                             reader->mesh->face_count);
    return status;
}

static skein_status read_any(stl_reader *reader, const char *text, size_t size) {
    const unsigned char *bytes = (const unsigned char *)text;
    uint32_t count = size >= HEAD_BYTES ? io_get_u32(bytes + 80) : 0;
    uint64_t ought = HEAD_BYTES + (uint64_t)count * TRIANGLE_BYTES;
    if (size >= HEAD_BYTES && ought == size) return read_binary(reader, bytes, count);
    if (size >= 5 && !memcmp(text, "solid", 5)) return read_text(reader, text, size);
    if (size < HEAD_BYTES)
        return io_error_set(reader->error, SKEIN_ERROR_SYNTAX, reader->path,
                            "%zu bytes are no STL file: expected 'solid', or at least 84 bytes", size);
    return io_error_set(reader->error, SKEIN_ERROR_SYNTAX, reader->path,
                        "the header promises %lu triangles, %llu bytes, but the file has %zu%s", (unsigned long)count,
                        (unsigned long long)ought, size, ought > size ? ": it is cut off, or no STL" : "");
}

skein_status io_stl_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                         skein_error *error) {
    *out = (io_mesh){0};
    stl_reader reader = {.path = path, .error = error, .mesh = out};
    skein_status status = read_any(&reader, text, size);
    io_weld_free(&reader.weld);
    if (!status && !out->face_count)
        status = io_error_set(error, SKEIN_ERROR_SYNTAX, path, "no triangles in the file%s",
                              reader.flat ? " but such with two corners at one place" : "");
    if (status) io_mesh_free(out);
    else if (reader.flat)
        io_warn(warnings, "%s: %zu triangle%s with two corners at one place %s left out", path, reader.flat,
                reader.flat == 1 ? "" : "s", reader.flat == 1 ? "is" : "are");
    return status;
}
