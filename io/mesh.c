/* Polygon meshes as files: storage, the choice of a reader, and the text scanner the readers share.
 *
 * Numbers: a short decimal is a whole number below 2^53 times or over a power of ten up to 10^22, both
 * exact, so one operation rounds it correctly (Clinger, How to Read Floating Point Numbers Accurately,
 * 1990). Longer ones go to strtod as digits and an exponent without a point, which reads the same in
 * every locale. See mesh.h for the contracts.
 */
#include "io/mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Storage ------------------------------------------------------------------------------- */

void io_mesh_free(io_mesh *mesh) {
    free(mesh->positions);
    free(mesh->face_sizes);
    free(mesh->face_vertices);
    free(mesh->face_uvs);
    free(mesh->uvs);
    for (size_t i = 0; i < mesh->mark_count; i++) free(mesh->marks[i].line);
    free(mesh->marks);
    *mesh = (io_mesh){0};
}

skein_mesh io_mesh_view(const io_mesh *mesh) {
    return (skein_mesh){.positions = mesh->positions,
                        .vertex_count = mesh->vertex_count,
                        .face_sizes = mesh->face_sizes,
                        .face_count = mesh->face_count,
                        .face_vertices = mesh->face_vertices,
                        .face_vertex_count = mesh->face_vertex_count};
}

bool io_mesh_add_vertex(io_mesh *mesh, const double position[3]) {
    if (!io_grow(&mesh->positions, &mesh->vertex_capacity, mesh->vertex_count + 1, 3 * sizeof(double))) return false;
    memcpy(mesh->positions + 3 * mesh->vertex_count++, position, 3 * sizeof(double));
    return true;
}

bool io_mesh_add_uv(io_mesh *mesh, const double uv[2]) {
    if (!io_grow(&mesh->uvs, &mesh->uv_capacity, mesh->uv_count + 1, 2 * sizeof(double))) return false;
    memcpy(mesh->uvs + 2 * mesh->uv_count++, uv, 2 * sizeof(double));
    return true;
}

bool io_mesh_add_corner(io_mesh *mesh, uint32_t vertex, uint32_t uv) {
    size_t need = mesh->face_vertex_count + 1;
    if (!io_grow(&mesh->face_vertices, &mesh->corner_capacity, need, sizeof(uint32_t)) ||
        !io_grow(&mesh->face_uvs, &mesh->corner_uv_capacity, need, sizeof(uint32_t)))
        return false;
    mesh->face_vertices[mesh->face_vertex_count] = vertex;
    mesh->face_uvs[mesh->face_vertex_count++] = uv;
    return true;
}

bool io_mesh_add_face(io_mesh *mesh, uint32_t size) {
    if (!io_grow(&mesh->face_sizes, &mesh->face_capacity, mesh->face_count + 1, sizeof(uint32_t))) return false;
    mesh->face_sizes[mesh->face_count++] = size;
    return true;
}

bool io_mesh_add_mark(io_mesh *mesh, char *line) {
    if (!line || !io_grow(&mesh->marks, &mesh->mark_capacity, mesh->mark_count + 1, sizeof *mesh->marks)) {
        free(line);
        return false;
    }
    mesh->marks[mesh->mark_count++] = (io_mesh_mark){mesh->face_count, line};
    return true;
}

bool io_mesh_has_faces_of(const io_mesh *read, const skein_mesh *mesh) {
    return !read->tetrahedra && read->vertex_count == mesh->vertex_count && read->face_count == mesh->face_count &&
           read->face_vertex_count == mesh->face_vertex_count &&
           !memcmp(read->face_sizes, mesh->face_sizes, mesh->face_count * sizeof *mesh->face_sizes) &&
           !memcmp(read->face_vertices, mesh->face_vertices, mesh->face_vertex_count * sizeof *mesh->face_vertices);
}

/* ---- Reading ------------------------------------------------------------------------------- */

typedef skein_status mesh_reader(const char *text, size_t size, const char *path, io_mesh *out, io_warnings warnings,
                                 skein_error *error);

static bool ends_with(const char *path, const char *ending) {
    size_t length = strlen(path), ending_length = strlen(ending);
    if (length <= ending_length) return false;
    for (const char *p = path + length - ending_length; *ending; p++, ending++)
        if ((*p >= 'A' && *p <= 'Z' ? *p + 32 : *p) != *ending) return false;
    return true;
}

/* A new format is its reader and a row here. */
static const struct {
    const char *ending;
    mesh_reader *read;
} formats[] = {{".obj", io_obj_read}, {".off", io_off_read},  {".ply", io_ply_read},
               {".stl", io_stl_read}, {".glb", io_gltf_read}, {".gltf", io_gltf_read}};

bool io_path_is_mesh(const char *path) {
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (ends_with(path, formats[i].ending)) return true;
    return ends_with(path, ".node");
}

skein_status io_mesh_read(const char *path, io_mesh *out, io_warnings warnings, skein_error *error) {
    // A text of 16 GiB holds some hundred million faces; beyond that it is a wrong file.
    const uint64_t most = (uint64_t)1 << 34;
    const size_t limit = most < SIZE_MAX / 4 ? (size_t)most : SIZE_MAX / 4;

    *out = (io_mesh){0};
    if (ends_with(path, ".node") || ends_with(path, ".ele"))
        return io_tetrahedra_read_files(path, limit, out, warnings, error);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        if (!ends_with(path, formats[i].ending)) continue;
        io_bytes text;
        skein_status status = io_file_read(path, limit, &text, error);
        if (status == SKEIN_OK) status = formats[i].read(text.data, text.size, path, out, warnings, error);
        io_bytes_free(&text);
        return status;
    }
    return io_error_set(error, SKEIN_ERROR_FILE, path,
                        "not a mesh file by its ending: expected .obj, .off, .ply, .stl, .glb, .gltf or .node");
}

/* ---- Lines and words ----------------------------------------------------------------------- */

static skein_status utf16_error(const io_scan *scan) {
    return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, 1,
                       "the file is UTF-16 text: save it as UTF-8 (or plain ASCII)");
}

skein_status io_scan_start(io_scan *scan, const char *text, size_t size) {
    scan->at = text;
    scan->end = text + size;
    scan->line = 1;
    if (size == 0)
        return io_error_set(scan->error, SKEIN_ERROR_SYNTAX, scan->path, "the file is empty: expected a mesh");
    if (size >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0) scan->at += 3;
    // With its mark, or without: then every other byte of plain letters is zero.
    if (size >= 2 && (memcmp(text, "\xFF\xFE", 2) == 0 || memcmp(text, "\xFE\xFF", 2) == 0)) return utf16_error(scan);
    if (size >= 4 && ((text[0] && !text[1] && text[2] && !text[3]) || (!text[0] && text[1] && !text[2] && text[3])))
        return utf16_error(scan);
    return SKEIN_OK;
}

/* The length of the line's end at `p`: 0 where there is none. */
static size_t newline_length(const char *p, const char *end) {
    if (p >= end || (*p != '\n' && *p != '\r')) return 0;
    return *p == '\r' && p + 1 < end && p[1] == '\n' ? 2 : 1;
}

skein_status io_scan_check_text(const io_scan *scan) {
    const char *zero = scan->at < scan->end ? memchr(scan->at, '\0', (size_t)(scan->end - scan->at)) : NULL;
    if (!zero) return SKEIN_OK;
    // Only now are lines worth counting.
    size_t line = scan->line;
    for (const char *p = scan->at; p < zero; p++) {
        size_t length = newline_length(p, zero);
        line += length > 0;
        p += length == 2;
    }
    return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, line,
                       "a NUL byte: the file is binary or damaged, expected text");
}

bool io_scan_word(io_scan *scan, io_word *word) {
    const char *p = scan->at, *end = scan->end;
    for (;;) {
        while (p < end && (*p == ' ' || *p == '\t' || *p == '\v' || *p == '\f')) p++;
        size_t newline = scan->continues && p < end && *p == '\\' ? newline_length(p + 1, end) : 0;
        if (newline == 0) break;
        p += 1 + newline;
        scan->line++;
    }
    word->begin = p;
    word->line = scan->line;
    for (; p < end; p++) {
        char c = *p;
        if (c > '#' && c != '\\') continue; // almost all
        if (c == ' ' || (c >= '\t' && c <= '\r')) break;
        // A comment; but 1.#INF, as one C library prints it, is a (bad) number.
        if (c == '#' && (p == word->begin || p[-1] != '.')) break;
        if (c == '\\' && scan->continues && newline_length(p + 1, end) > 0) break;
    }
    scan->at = word->end = p;
    return word->end > word->begin;
}

bool io_scan_line(io_scan *scan) {
    // What is left of a line may go on on the next one; a comment never does.
    io_word word;
    while (scan->continues && io_scan_word(scan, &word))
        ;
    const char *p = scan->at;
    while (p < scan->end && *p != '\n' && *p != '\r') p++;
    scan->at = p + newline_length(p, scan->end);
    scan->line += scan->at > p;
    return scan->at < scan->end;
}

const char *io_scan_cut_hint(const io_scan *scan) {
    return scan->at >= scan->end ? "; the file ends here, is it cut off?" : "";
}

bool io_word_is(io_word word, const char *text) {
    size_t length = (size_t)(word.end - word.begin);
    return strlen(text) == length && memcmp(word.begin, text, length) == 0;
}

bool io_scan_next_line_word(io_scan *scan, io_word *word) {
    while (io_scan_line(scan))
        if (io_scan_word(scan, word)) return true;
    return false;
}

skein_status io_scan_count(const io_scan *scan, io_word word, const char *name, uint64_t most, uint64_t *value) {
    const char *p = word.begin;
    uint64_t number = 0;
    for (; p < word.end && *p >= '0' && *p <= '9'; p++)
        number = number < 1000000000000000000u ? number * 10 + (uint64_t)(*p - '0') : number;
    char quote[IO_QUOTE_SIZE];
    if (p < word.end)
        return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, word.line, "%s is %s: expected a whole number",
                           name, io_quote(word.begin, word.end, quote));
    if (number > most)
        return io_error_at(scan->error, SKEIN_ERROR_LIMIT, scan->path, word.line, "%s is %s: at most %llu are possible",
                           name, io_quote(word.begin, word.end, quote), (unsigned long long)most);
    *value = number;
    return SKEIN_OK;
}

skein_status io_scan_number(const io_scan *scan, io_word word, const char *expected, double *value) {
    io_number kind = io_number_parse(word.begin, word.end, value);
    if (kind == IO_NUMBER_FINE) return SKEIN_OK;
    char quote[IO_QUOTE_SIZE];
    io_quote(word.begin, word.end, quote);
    if (kind == IO_NUMBER_NOT_FINITE)
        return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, word.line, "%s is %s: expected a finite number",
                           expected, quote);
    bool comma = memchr(word.begin, ',', (size_t)(word.end - word.begin)) != NULL;
    return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, word.line,
                       "%s is %s: expected a number such as 0.5, -2 or 1e-3%s", expected, quote,
                       comma ? " (a point, not a comma)" : "");
}

static int compare_u32(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* The first two corners that are the same vertex: found in `corners` as they are where there are few,
 * in a sorted copy where there are many. UINT32_MAX if all differ. False: no memory. */
static bool find_repeat(const uint32_t *corners, size_t size, uint32_t *repeat) {
    *repeat = UINT32_MAX;
    if (size <= 16) {
        for (size_t i = 1; i < size; i++)
            for (size_t j = 0; j < i; j++)
                if (corners[i] == corners[j]) *repeat = corners[i];
        return true;
    }
    uint32_t *sorted = malloc(size * sizeof *sorted);
    if (!sorted) return false;
    memcpy(sorted, corners, size * sizeof *sorted);
    qsort(sorted, size, sizeof *sorted, compare_u32);
    for (size_t i = 1; i < size; i++)
        if (sorted[i] == sorted[i - 1]) *repeat = sorted[i];
    free(sorted);
    return true;
}

skein_status io_scan_close_face(const io_scan *scan, io_mesh *mesh, size_t line, size_t size, uint32_t base) {
    if (size < 3)
        return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, line, "a face of %zu %s: expected 3 or more%s",
                           size, size == 1 ? "corner" : "corners", io_scan_cut_hint(scan));
    uint32_t repeat;
    if (size > UINT32_MAX || !find_repeat(mesh->face_vertices + mesh->face_vertex_count - size, size, &repeat) ||
        !io_mesh_add_face(mesh, (uint32_t)size))
        return io_error_at(scan->error, SKEIN_ERROR_MEMORY, scan->path, line, "out of memory after %zu faces",
                           mesh->face_count);
    if (repeat != UINT32_MAX)
        return io_error_at(scan->error, SKEIN_ERROR_SYNTAX, scan->path, line,
                           "vertex %lu twice in one face: expected different corners (a hole must be cut open)",
                           (unsigned long)repeat + base);
    return SKEIN_OK;
}

/* ---- Numbers ------------------------------------------------------------------------------- */

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Digits and a point [begin, end) times 10^exponent, by strtod. 770 digits decide every rounding;
 * of the rest it only counts whether they are all zero. */
static double parse_long(const char *begin, const char *end, int64_t exponent) {
    enum { MOST_DIGITS = 780 };
    char text[MOST_DIGITS + 40];
    size_t count = 0;
    bool after_point = false, rest = false;
    for (const char *p = begin; p < end; p++) {
        if (*p == '.') {
            after_point = true;
        } else if (count < MOST_DIGITS) {
            if (count > 0 || *p != '0') text[count++] = *p;
            exponent -= after_point;
        } else {
            rest = rest || *p != '0';
            exponent += !after_point;
        }
    }
    if (count == 0) return 0;
    if (rest) {
        text[count++] = '1';
        exponent--;
    }
    exponent = exponent > 99999 ? 99999 : exponent < -99999 ? -99999 : exponent;
    snprintf(text + count, sizeof text - count, "e%d", (int)exponent);
    return strtod(text, NULL);
}

/* nan, inf, infinity, nan(ind), 1.#INF, 1.#QNAN: what C libraries print for what is no number. */
static bool is_not_finite(const char *begin, const char *end) {
    size_t length = (size_t)(end - begin);
    if (length >= 3 && (begin[0] | 32) == 'n' && (begin[1] | 32) == 'a' && (begin[2] | 32) == 'n')
        return length == 3 || begin[3] == '(';
    if (length >= 3 && (begin[0] | 32) == 'i' && (begin[1] | 32) == 'n' && (begin[2] | 32) == 'f')
        return length == 3 || (length == 8 && (begin[7] | 32) == 'y');
    return length >= 4 && is_digit(begin[0]) && begin[1] == '.' && begin[2] == '#';
}

io_number io_number_parse(const char *begin, const char *end, double *value) {
    static const double ten_to[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *p = begin;
    bool negative = p < end && *p == '-', after_point = false, exact = true;
    p += p < end && (*p == '-' || *p == '+');

    // Digits, as a whole number as long as it fits.
    const char *digits = p;
    uint64_t whole = 0;
    int64_t shift = 0, exponent = 0;
    size_t digit_count = 0;
    for (; p < end; p++) {
        if (*p == '.' && !after_point) {
            after_point = true;
            continue;
        }
        if (!is_digit(*p)) break;
        digit_count++;
        if (whole < 1000000000000000000u) {
            whole = whole * 10 + (uint64_t)(*p - '0');
            shift -= after_point;
        } else exact = false;
    }
    const char *digits_end = p;
    if (digit_count == 0 || (p < end && (*p | 32) != 'e'))
        return is_not_finite(digits, end) ? IO_NUMBER_NOT_FINITE : IO_NUMBER_NONE;

    // The exponent; one beyond a billion counts as a billion.
    if (p < end) {
        bool down = ++p < end && *p == '-';
        p += p < end && (*p == '-' || *p == '+');
        if (p == end) return IO_NUMBER_NONE;
        for (; p < end && is_digit(*p); p++) exponent = exponent < 1000000000 ? exponent * 10 + (*p - '0') : exponent;
        if (p < end) return IO_NUMBER_NONE;
        exponent = down ? -exponent : exponent;
    }

    int64_t power = shift + exponent;
    double size;
    if (exact && whole <= (uint64_t)1 << 53 && power >= -22 && power <= 22)
        size = power < 0 ? (double)whole / ten_to[-power] : (double)whole * ten_to[power];
    else size = parse_long(digits, digits_end, exponent);
    *value = negative ? -size : size;
    return isfinite(size) ? IO_NUMBER_FINE : IO_NUMBER_NOT_FINITE;
}
