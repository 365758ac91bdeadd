/* Reads meshes of tetrahedra as TetGen and others write them: two texts of one name, see mesh.h for what a mesh that
 * was read promises.
 *
 *   ball.node   points 3 attributes markers        then a line each: number x y z [attributes] [marker]
 *   ball.ele    tetrahedra 4 attributes            then a line each: number a b c d [attributes]
 *
 * Numbers count from 0 or from 1; which is told by the first point's. Comments begin with '#'; blank lines stand
 * anywhere. Attributes and markers are passed over, but must be there as promised.
 *
 * Format: the TetGen manual, section 5.2 (Si 2020).
 */
#include "io/mesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ATTRIBUTES = 1000 };

/* One of the two texts, after its first line. */
typedef struct part {
    io_scan scan;
    io_mesh *mesh;
    const char *one, *many; /* "point", "points" */
    uint64_t count;         /* of them */
    uint64_t extra;         /* values in a line after those that are read */
    uint64_t base;          /* number of the first */
} part;

static skein_status fail_memory(const part *p) {
    return io_error_at(p->scan.error, SKEIN_ERROR_MEMORY, p->scan.path, p->scan.line,
                       "out of memory after %zu points and %zu tetrahedra", p->mesh->vertex_count, p->mesh->face_count);
}

/* The next whole number of the line. */
static skein_status next_count(part *p, const char *name, uint64_t most, uint64_t *value) {
    io_word word;
    if (!io_scan_word(&p->scan, &word))
        return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, p->scan.line, "the line ends before %s%s",
                           name, io_scan_cut_hint(&p->scan));
    return io_scan_count(&p->scan, word, name, most, value);
}

/* The first line: how many, `width` (3 coordinates or 4 corners), attributes, and markers where points have them. */
static skein_status read_header(part *p, const char *text, size_t size, uint64_t width, const char *width_name,
                                const char *hint, bool markers) {
    skein_status status = io_scan_start(&p->scan, text, size);
    if (!status) status = io_scan_check_text(&p->scan);
    if (status) return status;
    io_word word;
    if (!io_scan_word(&p->scan, &word) && !io_scan_next_line_word(&p->scan, &word))
        return io_error_set(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path,
                            "nothing but comments in the file: expected the number of %s", p->many);
    char name[64];
    uint64_t columns = 0, attributes = 0, marker = 0;
    snprintf(name, sizeof name, "the number of %s", p->many);
    status = io_scan_count(&p->scan, word, name, IO_MESH_MOST_VERTICES, &p->count);
    if (!status) status = next_count(p, width_name, UINT32_MAX, &columns);
    if (!status && columns != width)
        return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, word.line, "%s is %llu: expected %llu%s",
                           width_name, (unsigned long long)columns, (unsigned long long)width, hint);
    // the rest of the line may be left out
    if (!status && io_scan_word(&p->scan, &word))
        status = io_scan_count(&p->scan, word, "the number of attributes", MOST_ATTRIBUTES, &attributes);
    if (!status && markers && io_scan_word(&p->scan, &word))
        status = io_scan_count(&p->scan, word, "the number of markers", 1, &marker);
    if (!status && !p->count)
        return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, word.line, "no %s in the file", p->many);
    p->extra = attributes + marker;
    return status;
}

/* Goes to the line of the i-th one and reads its number, which must follow the one before. */
static skein_status begin_line(part *p, uint64_t i, bool finds_base) {
    io_word word;
    uint64_t number;
    char name[64];
    if (!io_scan_next_line_word(&p->scan, &word))
        return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, p->scan.line,
                           "the file ends after %llu of %llu %s: it is cut off, or its header is wrong",
                           (unsigned long long)i, (unsigned long long)p->count, p->many);
    snprintf(name, sizeof name, "a %s's number", p->one);
    skein_status status = io_scan_count(&p->scan, word, name, UINT64_MAX, &number);
    if (status) return status;
    if (finds_base && i == 0 && number <= 1) p->base = number;
    if (number != p->base + i)
        return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, word.line,
                           "%s %llu where %llu is the next: expected all of them in order, from 0 or 1", p->one,
                           (unsigned long long)number, (unsigned long long)(p->base + i));
    return SKEIN_OK;
}

/* The values after those that are read: as many as the header has promised, and no more. */
static skein_status end_line(part *p, uint64_t number) {
    io_word word;
    uint64_t count = 0;
    double value;
    while (io_scan_word(&p->scan, &word)) {
        skein_status status = io_scan_number(&p->scan, word, "an attribute", &value);
        if (status) return status;
        count++;
    }
    if (count == p->extra) return SKEIN_OK;
    return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, p->scan.line,
                       "%s %llu has %llu values after its own: the header promises %llu%s", p->one,
                       (unsigned long long)number, (unsigned long long)count, (unsigned long long)p->extra,
                       count < p->extra ? io_scan_cut_hint(&p->scan) : "");
}

static skein_status read_points(part *p) {
    static const char *const names[3] = {"x", "y", "z"};
    for (uint64_t i = 0; i < p->count; i++) {
        double at[3];
        skein_status status = begin_line(p, i, true);
        for (int k = 0; k < 3 && !status; k++) {
            io_word word;
            if (!io_scan_word(&p->scan, &word))
                return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, p->scan.line,
                                   "the line ends before %s%s", names[k], io_scan_cut_hint(&p->scan));
            status = io_scan_number(&p->scan, word, names[k], &at[k]);
        }
        if (!status) status = end_line(p, p->base + i);
        if (status) return status;
        if (!io_mesh_add_vertex(p->mesh, at)) return fail_memory(p);
    }
    return SKEIN_OK;
}

static skein_status read_tetrahedra(part *p) {
    size_t points = p->mesh->vertex_count;
    for (uint64_t i = 0; i < p->count; i++) {
        uint64_t corner[4];
        skein_status status = begin_line(p, i, false);
        for (int k = 0; k < 4 && !status; k++) {
            status = next_count(p, "a corner", UINT64_MAX, &corner[k]);
            if (!status && (corner[k] < p->base || corner[k] - p->base >= points))
                return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, p->scan.line,
                                   "point %llu in a tetrahedron, but there are %zu points, %llu to %llu",
                                   (unsigned long long)corner[k], points, (unsigned long long)p->base,
                                   (unsigned long long)(p->base + points - 1));
            for (int l = 0; l < k && !status; l++)
                if (corner[l] == corner[k])
                    return io_error_at(p->scan.error, SKEIN_ERROR_SYNTAX, p->scan.path, p->scan.line,
                                       "point %llu twice in one tetrahedron", (unsigned long long)corner[k]);
        }
        if (!status) status = end_line(p, p->base + i);
        if (status) return status;
        for (int k = 0; k < 4; k++)
            if (!io_mesh_add_corner(p->mesh, (uint32_t)(corner[k] - p->base), IO_NO_UV)) return fail_memory(p);
        if (!io_mesh_add_face(p->mesh, 4)) return fail_memory(p);
    }
    return SKEIN_OK;
}

static void warn_of_rest(part *p, io_warnings warnings) {
    io_word word;
    if (io_scan_next_line_word(&p->scan, &word))
        io_warn(warnings, "%s:%zu: what follows the last %s was passed over", p->scan.path, word.line, p->one);
}

skein_status io_tetrahedra_read(const io_text *node, const io_text *ele, io_mesh *out, io_warnings warnings,
                                skein_error *error) {
    *out = (io_mesh){.tetrahedra = true};
    part points = {.scan = {.path = node->path, .error = error}, .mesh = out, .one = "point", .many = "points"};
    skein_status status = read_header(&points, node->text, node->size, 3, "the number of coordinates",
                                      ": a mesh of the plane has no tetrahedra", true);
    if (!status) status = read_points(&points);
    if (!status) warn_of_rest(&points, warnings);
    part cells = {.scan = {.path = ele->path, .error = error},
                  .mesh = out,
                  .one = "tetrahedron",
                  .many = "tetrahedra",
                  .base = points.base};
    if (!status)
        status = read_header(&cells, ele->text, ele->size, 4, "the number of corners of a tetrahedron",
                             ": those with more points on their edges are not read", false);
    if (!status) status = read_tetrahedra(&cells);
    if (!status) warn_of_rest(&cells, warnings);
    if (status) io_mesh_free(out);
    return status;
}

/* The path with another ending of as many letters as it takes; NULL when there is no memory. */
static char *with_ending(const char *path, const char *ending) {
    const char *dot = strrchr(path, '.');
    size_t stem = dot ? (size_t)(dot - path) : strlen(path);
    char *other = malloc(stem + strlen(ending) + 1);
    if (!other) return NULL;
    memcpy(other, path, stem);
    strcpy(other + stem, ending);
    return other;
}

skein_status io_tetrahedra_read_files(const char *path, size_t most, io_mesh *out, io_warnings warnings,
                                      skein_error *error) {
    static const char *const endings[2] = {".node", ".ele"};
    char *paths[2] = {with_ending(path, endings[0]), with_ending(path, endings[1])};
    io_bytes bytes[2] = {{NULL, 0}, {NULL, 0}};
    skein_status status =
        paths[0] && paths[1] ? SKEIN_OK : io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    for (int i = 0; i < 2 && !status; i++) status = io_file_read_beside(path, paths[i], most, &bytes[i], error);
    if (!status) {
        io_text node = {bytes[0].data, bytes[0].size, paths[0]}, ele = {bytes[1].data, bytes[1].size, paths[1]};
        status = io_tetrahedra_read(&node, &ele, out, warnings, error);
    }
    for (int i = 0; i < 2; i++) {
        io_bytes_free(&bytes[i]);
        free(paths[i]);
    }
    return status;
}
