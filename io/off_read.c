/* Reads the Object File Format: see mesh.h for what a mesh that was read promises.
 *
 *   OFF                       or COFF, NOFF, STOFF ...: the letters tell what follows each x y z
 *   vertices faces [edges]    on the same line or the next
 *   x y z [more]              one line a vertex; normals, colours and texture places are left out
 *   n i j k ... [colour]      one line a face; indices count from 0
 *
 * Comments begin with '#'; blank lines stand anywhere. Since the header says what is to come, a file
 * that was cut off is always noticed.
 *
 * Format: the Geomview manual, section 4.2.5 (1996).
 */
#include "io/mesh.h"

#include <string.h>

typedef struct off_reader {
    io_scan scan;
    io_mesh *mesh;
    bool has_normals, has_colours, has_uvs;
    size_t vertices, faces; /* as the header promises */
} off_reader;

static skein_status fail_memory(const off_reader *reader) {
    return io_error_at(reader->scan.error, SKEIN_ERROR_MEMORY, reader->scan.path, reader->scan.line,
                       "out of memory after %zu vertices and %zu faces", reader->mesh->vertex_count,
                       reader->mesh->face_count);
}

/* ---- Header -------------------------------------------------------------------------------- */

/* [ST][C][N]OFF */
static skein_status read_keyword(off_reader *reader, io_word word) {
    const char *p = word.begin;
    size_t length = (size_t)(word.end - word.begin);
    if (length > 5 && p[0] == 'S' && p[1] == 'T') {
        reader->has_uvs = true;
        p += 2;
    }
    if (p < word.end && *p == 'C') {
        reader->has_colours = true;
        p++;
    }
    if (p < word.end && *p == 'N') {
        reader->has_normals = true;
        p++;
    }
    if (word.end - p == 3 && memcmp(p, "OFF", 3) == 0) return SKEIN_OK;
    char quote[IO_QUOTE_SIZE];
    bool other = length >= 4 && memcmp(word.end - 3, "OFF", 3) == 0;
    return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, word.line,
                       "the file begins with %s: expected %s", io_quote(word.begin, word.end, quote),
                       other ? "OFF, COFF or NOFF, with three coordinates a vertex" : "OFF");
}

static skein_status read_header(off_reader *reader) {
    io_scan *scan = &reader->scan;
    io_word word;
    if (!io_scan_word(scan, &word) && !io_scan_next_line_word(scan, &word))
        return io_error_set(scan->error, SKEIN_ERROR_SYNTAX, scan->path,
                            "nothing but comments in the file: expected OFF");
    skein_status status = read_keyword(reader, word);
    if (status != SKEIN_OK) return status;
    bool here = io_scan_word(scan, &word);
    if (here && io_word_is(word, "BINARY"))
        return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, word.line,
                           "binary OFF is not read: save the mesh as text");
    if ((status = io_scan_check_text(scan)) != SKEIN_OK) return status;
    uint64_t vertices = 0, faces = 0;
    io_word second;
    if ((!here && !io_scan_next_line_word(scan, &word)) || !io_scan_word(scan, &second))
        return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, scan->line,
                           "the header is not complete: expected the numbers of vertices, faces and edges");
    status = io_scan_count(&reader->scan, word, "the number of vertices", IO_MESH_MOST_VERTICES, &vertices);
    if (status == SKEIN_OK) status = io_scan_count(&reader->scan, second, "the number of faces", SIZE_MAX / 16, &faces);
    // The number of edges is often 0, wrong or not there.
    if (status == SKEIN_OK && (vertices == 0 || faces == 0))
        status =
            io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, word.line,
                        "no %s in the file: the header promises %llu vertices and %llu faces",
                        vertices == 0 ? "vertices" : "faces", (unsigned long long)vertices, (unsigned long long)faces);
    reader->vertices = (size_t)vertices;
    reader->faces = (size_t)faces;
    return status;
}

/* ---- Body ---------------------------------------------------------------------------------- */

static skein_status read_vertex(off_reader *reader, io_word word) {
    static const char *const names[4] = {"x", "y", "z", "a value after z"};
    io_scan *scan = &reader->scan;
    double values[4];
    size_t count = 0, line = word.line;
    do {
        skein_status status = io_scan_number(scan, word, names[count < 3 ? count : 3], &values[count < 3 ? count : 3]);
        if (status != SKEIN_OK) return status;
        count++;
    } while (io_scan_word(scan, &word));

    // Colours are written without the C as well, but never by one or two numbers: that is a face.
    bool plain = !reader->has_normals && !reader->has_colours && !reader->has_uvs;
    size_t least = 3 + (reader->has_normals ? 3u : 0) + (reader->has_colours ? 1u : 0) + (reader->has_uvs ? 2u : 0);
    if (count < least || (plain && (count == 4 || count == 5)))
        return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, line,
                           "vertex %zu of %zu has %zu numbers: expected %zu%s%s", reader->mesh->vertex_count,
                           reader->vertices, count, least, plain ? "" : " or more",
                           count < least ? io_scan_cut_hint(scan) : "; is the header's number right?");
    return io_mesh_add_vertex(reader->mesh, values) ? SKEIN_OK : fail_memory(reader);
}

static skein_status read_face(off_reader *reader, io_word word) {
    io_scan *scan = &reader->scan;
    size_t line = word.line;
    uint64_t size, index;
    skein_status status = io_scan_count(&reader->scan, word, "a face's number of corners", UINT32_MAX, &size);
    if (status != SKEIN_OK) return status;
    for (uint64_t corner = 0; corner < size; corner++) {
        if (!io_scan_word(scan, &word))
            return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, line,
                               "the line ends after %llu of a face's %llu corners%s", (unsigned long long)corner,
                               (unsigned long long)size, io_scan_cut_hint(scan));
        if ((status = io_scan_count(&reader->scan, word, "a face's corner", IO_MESH_MOST_VERTICES, &index)) != SKEIN_OK)
            return status;
        if (index >= reader->vertices)
            return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, word.line,
                               "vertex %llu in a face, but the file has %zu vertices, 0 to %zu",
                               (unsigned long long)index, reader->vertices, reader->vertices - 1);
        if (!io_mesh_add_corner(reader->mesh, (uint32_t)index, IO_NO_UV)) return fail_memory(reader);
    }
    // Up to four numbers of colour, of no use here but a sign that the line is whole.
    double colour;
    while (io_scan_word(scan, &word))
        if ((status = io_scan_number(scan, word, "a face's colour", &colour)) != SKEIN_OK) return status;
    return io_scan_close_face(scan, reader->mesh, line, (size_t)size, 0);
}

static skein_status fail_cut(const off_reader *reader, const char *what, size_t have, size_t promised) {
    return io_error_at(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, reader->scan.line,
                       "the file ends after %zu of %zu %s: it is cut off, or its header is wrong", have, promised, what);
}

static skein_status read_body(off_reader *reader) {
    skein_status status = SKEIN_OK;
    io_word word;
    for (size_t i = 0; i < reader->vertices && status == SKEIN_OK; i++)
        status = io_scan_next_line_word(&reader->scan, &word) ? read_vertex(reader, word)
                                                              : fail_cut(reader, "vertices", i, reader->vertices);
    for (size_t i = 0; i < reader->faces && status == SKEIN_OK; i++)
        status = io_scan_next_line_word(&reader->scan, &word) ? read_face(reader, word)
                                                              : fail_cut(reader, "faces", i, reader->faces);
    return status;
}

skein_status io_off_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                         skein_error *error) {
    *out = (io_mesh){0};
    off_reader reader = {.scan = {.continues = false, .path = path, .error = error}, .mesh = out};
    skein_status status = io_scan_start(&reader.scan, text, size);
    if (status == SKEIN_OK) status = read_header(&reader);
    if (status == SKEIN_OK) status = read_body(&reader);
    if (status != SKEIN_OK) {
        io_mesh_free(out);
        return status;
    }
    io_word word;
    if (io_scan_next_line_word(&reader.scan, &word))
        io_warn(warnings, "%s:%zu: what follows the last face was passed over", path, word.line);
    return SKEIN_OK;
}
