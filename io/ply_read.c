/* Reads PLY, as text or binary in either order of bytes: see mesh.h for what a mesh that was read promises.
 *
 *   ply
 *   format ascii 1.0                            or binary_little_endian, binary_big_endian
 *   element vertex N / property float x ...     x, y, z; s and t, u and v, or texture_u and texture_v if they are there
 *   element face M / property list uchar int vertex_indices
 *   end_header                                  then N vertices and M faces
 *
 * Other elements and properties are passed over. Owns: the header as a list of elements, each with its properties, and
 * one way to take the next value from the body, whatever it is made of. Since the header says what is to come, a file
 * that was cut off is always noticed.
 *
 * Format: Turk, The PLY Polygon File Format, 1994.
 */
#include "io/bytes.h"
#include "io/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ELEMENTS = 16, MOST_PROPERTIES = 64 };

typedef enum ply_type { PLY_NONE, PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32, PLY_F64 } ply_type;
typedef enum ply_role { PLY_OTHER, PLY_X, PLY_Y, PLY_Z, PLY_S, PLY_T, PLY_CORNERS } ply_role;

typedef struct ply_property {
    ply_type type, count; /* count: of a list's number of values; PLY_NONE: no list */
    ply_role role;
} ply_property;

typedef struct ply_element {
    char name[16];
    uint64_t count;
    ply_property properties[MOST_PROPERTIES];
    size_t property_count;
} ply_element;

enum { PLY_ASCII, PLY_LITTLE, PLY_BIG };

typedef struct ply_reader {
    io_scan scan;
    io_mesh *mesh;
    int format; /* PLY_ASCII, PLY_LITTLE or PLY_BIG */
    ply_element elements[MOST_ELEMENTS];
    size_t element_count;
    uint64_t vertices; /* as the header promises */
    const char *begin; /* of the file */
    bool has_uv;
} ply_reader;

#define FAIL(reader_, line_, ...) \
    io_error_at((reader_)->scan.error, SKEIN_ERROR_SYNTAX, (reader_)->scan.path, (line_), __VA_ARGS__)

static skein_status fail_memory(const ply_reader *reader) {
    return io_error_set(reader->scan.error, SKEIN_ERROR_MEMORY, reader->scan.path,
                        "out of memory after %zu vertices and %zu faces", reader->mesh->vertex_count,
                        reader->mesh->face_count);
}

/* ---- Header -------------------------------------------------------------------------------- */

static ply_type type_of(io_word word) {
    static const char *const names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                           {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                           {"float", "float32"}, {"double", "float64"}};
    for (int i = 0; i < 8; i++)
        if (io_word_is(word, names[i][0]) || io_word_is(word, names[i][1])) return (ply_type)(PLY_I8 + i);
    return PLY_NONE;
}

static ply_role role_of(const ply_element *element, io_word word, bool is_list) {
    static const struct {
        const char *name;
        ply_role role;
    } roles[] = {{"x", PLY_X}, {"y", PLY_Y}, {"z", PLY_Z},         {"s", PLY_S},        {"t", PLY_T},
                 {"u", PLY_S}, {"v", PLY_T}, {"texture_u", PLY_S}, {"texture_v", PLY_T}};
    if (!strcmp(element->name, "face"))
        return is_list && (io_word_is(word, "vertex_indices") || io_word_is(word, "vertex_index")) ? PLY_CORNERS
                                                                                                   : PLY_OTHER;
    for (size_t i = 0; !strcmp(element->name, "vertex") && !is_list && i < sizeof roles / sizeof *roles; i++)
        if (io_word_is(word, roles[i].name)) return roles[i].role;
    return PLY_OTHER;
}

static skein_status read_format(ply_reader *reader, size_t line) {
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    io_word word = {"", "", line};
    char quote[IO_QUOTE_SIZE];
    bool there = io_scan_word(&reader->scan, &word);
    for (int i = 0; there && i < 3; i++)
        if (io_word_is(word, names[i])) {
            reader->format = i;
            if (io_scan_word(&reader->scan, &word) && io_word_is(word, "1.0")) return SKEIN_OK;
            return FAIL(reader, line, "expected version 1.0 of PLY");
        }
    return FAIL(reader, line, "%s: expected the format ascii, binary_little_endian or binary_big_endian",
                io_quote(word.begin, word.end, quote));
}

static skein_status read_element(ply_reader *reader, size_t line) {
    io_word name, number;
    if (reader->element_count == MOST_ELEMENTS)
        return io_error_at(reader->scan.error, SKEIN_ERROR_LIMIT, reader->scan.path, line,
                           "more than %d elements: none of the others is needed, delete them", MOST_ELEMENTS);
    if (!io_scan_word(&reader->scan, &name) || !io_scan_word(&reader->scan, &number))
        return FAIL(reader, line, "expected an element's name and number");
    ply_element *element = &reader->elements[reader->element_count++];
    size_t length = (size_t)(name.end - name.begin);
    *element = (ply_element){.name = "other"};
    if (length < sizeof element->name) {
        memcpy(element->name, name.begin, length);
        element->name[length] = 0;
    }
    bool vertices = !strcmp(element->name, "vertex");
    skein_status status = io_scan_count(&reader->scan, number, "the number of elements",
                                        vertices ? IO_MESH_MOST_VERTICES : UINT64_MAX / 64, &element->count);
    if (vertices) reader->vertices = element->count;
    return status;
}

static skein_status read_property(ply_reader *reader, size_t line) {
    io_word word = {"", "", line};
    char quote[IO_QUOTE_SIZE];
    if (!reader->element_count) return FAIL(reader, line, "a property of no element");
    ply_element *element = &reader->elements[reader->element_count - 1];
    if (element->property_count == MOST_PROPERTIES)
        return io_error_at(reader->scan.error, SKEIN_ERROR_LIMIT, reader->scan.path, line,
                           "more than %d properties: x, y, z, s, t and vertex_indices are needed, delete others",
                           MOST_PROPERTIES);
    ply_property property = {PLY_NONE, PLY_NONE, PLY_OTHER};
    bool good = io_scan_word(&reader->scan, &word), is_list = good && io_word_is(word, "list");
    if (is_list) {
        good = io_scan_word(&reader->scan, &word) && (property.count = type_of(word)) != PLY_NONE;
        if (good && property.count >= PLY_F32) return FAIL(reader, line, "a list's number of values has to be whole");
        good = good && io_scan_word(&reader->scan, &word);
    }
    if (!good || !(property.type = type_of(word)))
        return FAIL(reader, line, "%s: expected a type: char, uchar, short, ushort, int, uint, float or double",
                    io_quote(word.begin, word.end, quote));
    if (!io_scan_word(&reader->scan, &word)) return FAIL(reader, line, "expected a property's name");
    property.role = role_of(element, word, is_list);
    reader->has_uv |= property.role == PLY_T;
    element->properties[element->property_count++] = property;
    return SKEIN_OK;
}

static bool has_role(const ply_reader *reader, const char *name, ply_role role) {
    for (size_t e = 0; e < reader->element_count; e++)
        for (size_t p = 0; !strcmp(reader->elements[e].name, name) && p < reader->elements[e].property_count; p++)
            if (reader->elements[e].properties[p].role == role) return true;
    return false;
}

/* Whether what a mesh needs is promised. */
static skein_status check_header(const ply_reader *reader, bool has_format) {
    size_t line = reader->scan.line, vertices = 0, faces = 0;
    for (size_t e = 0; e < reader->element_count; e++) {
        vertices += !strcmp(reader->elements[e].name, "vertex");
        faces += !strcmp(reader->elements[e].name, "face");
    }
    if (!has_format) return FAIL(reader, line, "the header has no line 'format'");
    if (vertices > 1 || faces > 1) return FAIL(reader, line, "the header has an element twice");
    for (ply_role role = PLY_X; role <= PLY_Z; role++)
        if (!has_role(reader, "vertex", role))
            return FAIL(reader, line, "the header promises no vertices with x, y and z");
    if (!has_role(reader, "face", PLY_CORNERS))
        return FAIL(reader, line,
                    "the header promises no faces (a list 'vertex_indices'): points alone, and strips of "
                    "triangles, are not read");
    if (reader->vertices) return SKEIN_OK;
    return FAIL(reader, line, "no vertices in the file");
}

static skein_status read_header(ply_reader *reader) {
    io_scan *scan = &reader->scan;
    io_word word;
    bool has_format = false;
    if (!io_scan_word(scan, &word) || !io_word_is(word, "ply"))
        return FAIL(reader, 1, "the file does not begin with 'ply': it is no PLY");
    while (io_scan_next_line_word(scan, &word)) {
        char quote[IO_QUOTE_SIZE];
        skein_status status = SKEIN_OK;
        if (io_word_is(word, "end_header")) return check_header(reader, has_format);
        if (io_word_is(word, "format")) {
            status = read_format(reader, word.line);
            has_format = true;
        } else if (io_word_is(word, "element")) status = read_element(reader, word.line);
        else if (io_word_is(word, "property")) status = read_property(reader, word.line);
        else if (!io_word_is(word, "comment") && !io_word_is(word, "obj_info"))
            status = FAIL(reader, word.line, "%s: expected element, property, comment or end_header",
                          io_quote(word.begin, word.end, quote));
        if (status) return status;
    }
    return FAIL(reader, scan->line, "the header has no end: expected 'end_header'");
}

/* ---- Body: one value after the other --------------------------------------------------------- */

static skein_status fail_cut(const ply_reader *reader, const ply_element *element, uint64_t item) {
    return io_error_set(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path,
                        "the file ends in %s %llu of %llu: it is cut off, or its header is wrong", element->name,
                        (unsigned long long)item + 1, (unsigned long long)element->count);
}

static double number_of(const unsigned char *bytes, ply_type type, bool is_big) {
    uint64_t bits = 0;
    static const size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    for (size_t k = 0, size = sizes[type]; k < size; k++) bits |= (uint64_t)bytes[is_big ? size - 1 - k : k] << (8 * k);
    double wide;
    switch (type) {
    case PLY_I8: return (int8_t)bits;
    case PLY_I16: return (int16_t)bits;
    case PLY_I32: return (int32_t)bits;
    case PLY_F32: return (double)io_bits_float((uint32_t)bits);
    case PLY_F64: memcpy(&wide, &bits, sizeof wide); return wide;
    default: return (double)bits;
    }
}

static skein_status read_value(ply_reader *reader, const ply_element *element, uint64_t item, ply_type type,
                               double *value) {
    static const size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    io_scan *scan = &reader->scan;
    if (reader->format == PLY_ASCII) {
        io_word word;
        if (!io_scan_word(scan, &word) && !io_scan_next_line_word(scan, &word)) return fail_cut(reader, element, item);
        *value = NAN;
        if (io_number_parse(word.begin, word.end, value) != IO_NUMBER_NONE) return SKEIN_OK;
        char quote[IO_QUOTE_SIZE];
        return FAIL(reader, word.line, "%s: expected a number of %s %llu", io_quote(word.begin, word.end, quote),
                    element->name, (unsigned long long)item);
    }
    if ((size_t)(scan->end - scan->at) < sizes[type]) return fail_cut(reader, element, item);
    *value = number_of((const unsigned char *)scan->at, type, reader->format == PLY_BIG);
    scan->at += sizes[type];
    return SKEIN_OK;
}

/* Where a fault is: by lines in a text, by bytes in a binary file. */
static skein_status fail_item(const ply_reader *reader, const ply_element *element, uint64_t item, const char *what) {
    if (reader->format == PLY_ASCII)
        return FAIL(reader, reader->scan.line, "%s %llu %s", element->name, (unsigned long long)item, what);
    return io_error_set(reader->scan.error, SKEIN_ERROR_SYNTAX, reader->scan.path, "byte %zu: %s %llu %s",
                        (size_t)(reader->scan.at - reader->begin), element->name, (unsigned long long)item, what);
}

static bool is_whole(double value, double most) {
    return value >= 0 && value <= most && value == floor(value);
}

static skein_status read_corners(ply_reader *reader, const ply_element *element, uint64_t item, ply_type type,
                                 uint32_t size) {
    io_mesh *mesh = reader->mesh;
    for (uint32_t c = 0; c < size; c++) {
        double value;
        skein_status status = read_value(reader, element, item, type, &value);
        if (status) return status;
        if (!is_whole(value, (double)reader->vertices - 1))
            return fail_item(reader, element, item, "has a corner that is no vertex");
        if (!io_mesh_add_corner(mesh, (uint32_t)value, reader->has_uv ? (uint32_t)value : IO_NO_UV))
            return fail_memory(reader);
    }
    skein_status status = io_scan_close_face(&reader->scan, mesh, reader->scan.line, size, 0);
    if (status == SKEIN_ERROR_SYNTAX && reader->format != PLY_ASCII)
        return fail_item(reader, element, item, "has fewer than three corners, or one of them twice");
    return status;
}

/* A list: of corners, or passed over. */
static skein_status read_list(ply_reader *reader, const ply_element *element, uint64_t item, ply_property property) {
    double size, value;
    skein_status status = read_value(reader, element, item, property.count, &size);
    if (!status && !is_whole(size, UINT32_MAX))
        status = fail_item(reader, element, item, "has a list of no whole number");
    if (status) return status;
    if (property.role == PLY_CORNERS) return read_corners(reader, element, item, property.type, (uint32_t)size);
    for (uint32_t i = 0; i < (uint32_t)size && !status; i++)
        status = read_value(reader, element, item, property.type, &value);
    return status;
}

static skein_status read_item(ply_reader *reader, const ply_element *element, uint64_t item) {
    double numbers[PLY_CORNERS + 1] = {0};
    for (size_t p = 0; p < element->property_count; p++) {
        ply_property property = element->properties[p];
        skein_status status = property.count
                                  ? read_list(reader, element, item, property)
                                  : read_value(reader, element, item, property.type, &numbers[property.role]);
        if (status) return status;
    }
    if (strcmp(element->name, "vertex")) return SKEIN_OK;
    for (int role = PLY_X; role <= PLY_T; role++)
        if (!isfinite(numbers[role])) return fail_item(reader, element, item, "has a number that is not finite");
    bool good = io_mesh_add_vertex(reader->mesh, &numbers[PLY_X]);
    if (reader->has_uv) good = good && io_mesh_add_uv(reader->mesh, &numbers[PLY_S]);
    return good ? SKEIN_OK : fail_memory(reader);
}

static skein_status read_body(ply_reader *reader) {
    skein_status status = SKEIN_OK;
    if (reader->format == PLY_ASCII) status = io_scan_check_text(&reader->scan);
    else io_scan_line(&reader->scan); // behind "end_header"
    for (size_t e = 0; e < reader->element_count && !status; e++) {
        const ply_element *element = &reader->elements[e];
        if (!element->property_count) continue; // nothing stands there, however often
        for (uint64_t i = 0; i < element->count && !status; i++) status = read_item(reader, element, i);
    }
    return status;
}

skein_status io_ply_read(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                         skein_error *error) {
    (void)warnings;
    *out = (io_mesh){0};
    ply_reader *reader = calloc(1, sizeof *reader);
    if (!reader) return io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    reader->scan = (io_scan){.continues = false, .path = path, .error = error};
    reader->mesh = out;
    reader->begin = text;
    skein_status status = io_scan_start(&reader->scan, text, size);
    if (!status) status = read_header(reader);
    if (!status) status = read_body(reader);
    if (!status && !out->face_count) status = io_error_set(error, SKEIN_ERROR_SYNTAX, path, "no faces in the file");
    free(reader);
    if (status) io_mesh_free(out);
    return status;
}
