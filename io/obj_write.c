/* Writes Wavefront OBJ: see mesh.h for the contract.
 *
 *   # header: version, units, counts
 *   v x y z        every vertex, in the mesh's order, used or not
 *   vn x y z       as many normals: the same number serves both
 *   vt u v         where the mesh that was read has them
 *   f a//a b//b c//c ..., a/t/a with texture coordinates, and before them the lines o, g, s, usemtl and mtllib as read
 */
#include "io/clip.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

size_t io_float_print(float value, char out[IO_FLOAT_SIZE]) {
    assert(isfinite(value));
    // Nine digits and an exponent as printf rounds them; whatever the locale's point is, it is skipped.
    char text[32], digits[9];
    snprintf(text, sizeof text, "%.8e", fabs((double)value));
    size_t at = 0;
    int count = 0;
    const char *p = text;
    for (; *p != 'e'; p++)
        if (is_digit(*p) && count < 9) digits[count++] = *p;
    int exponent = atoi(p + 1);
    while (count > 1 && digits[count - 1] == '0') count--;

    // Laid out as %g does: with an exponent only where the number would be long.
    if (value < 0) out[at++] = '-';
    bool scientific = exponent < -4 || exponent > 8;
    int first = scientific || exponent > 0 ? 0 : exponent, units = scientific ? 0 : exponent;
    for (int digit = first; digit < count || digit <= units; digit++) {
        if (digit == units + 1) out[at++] = '.';
        out[at++] = digit >= 0 && digit < count ? digits[digit] : '0';
    }
    out[at] = '\0';
    if (scientific)
        at += (size_t)snprintf(out + at, IO_FLOAT_SIZE - at, "e%c%02d", exponent < 0 ? '-' : '+', abs(exponent));
    return at;
}

/* "v 1 2 3" */
static void write_vector(io_output *output, const char *keyword, const double vector[3]) {
    char line[4 + 3 * IO_FLOAT_SIZE];
    size_t at = strlen(keyword);
    memcpy(line, keyword, at);
    for (int k = 0; k < 3; k++) {
        line[at++] = ' ';
        at += io_float_print((float)vector[k], line + at);
    }
    line[at++] = '\n';
    io_output_write(output, line, at);
}

/* "f 1//1 2//2 3//3", or "f 1/4/1 ..." with texture coordinates (NULL: none). */
static void write_face(io_output *output, const uint32_t *corners, const uint32_t *uvs, uint32_t size) {
    io_output_write(output, "f", 1);
    for (uint32_t corner = 0; corner < size; corner++) {
        uint64_t number = (uint64_t)corners[corner] + 1;
        io_output_write(output, " ", 1);
        io_output_count(output, number);
        io_output_write(output, "/", 1);
        if (uvs && uvs[corner] != IO_NO_UV) io_output_count(output, (uint64_t)uvs[corner] + 1);
        io_output_write(output, "/", 1);
        io_output_count(output, number);
    }
    io_output_write(output, "\n", 1);
}

static void write_uv(io_output *output, const double uv[2]) {
    char line[4 + 2 * IO_FLOAT_SIZE] = "vt";
    size_t at = 2;
    for (int k = 0; k < 2; k++) {
        line[at++] = ' ';
        at += io_float_print(isfinite((float)uv[k]) ? (float)uv[k] : 0, line + at);
    }
    line[at++] = '\n';
    io_output_write(output, line, at);
}

/* A line as it was read; a file of materials is looked for where the mesh was. */
static void write_mark(io_output *output, const char *line, const char *read_path) {
    static const char library[] = "mtllib ";
    const char *slash = strrchr(read_path, '/');
    char folder[PATH_MAX] = "";
    if (!strncmp(line, library, sizeof library - 1) && line[sizeof library - 1] != '/') {
        snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash + 1 - read_path) : 0, read_path);
        char *whole = realpath(slash ? folder : ".", NULL);
        io_output_printf(output, "%s%s/%s\n", library, whole ? whole : ".", line + sizeof library - 1);
        free(whole);
    } else {
        io_output_write(output, line, strlen(line));
        io_output_write(output, "\n", 1);
    }
}

/* All faces, and before each what was said of it. */
static void write_faces(io_output *output, const skein_mesh *mesh, const io_mesh *read, const char *read_path) {
    size_t mark = 0, corner = 0;
    for (size_t f = 0; f < mesh->face_count; corner += mesh->face_sizes[f++]) {
        for (; read && mark < read->mark_count && read->marks[mark].face <= f; mark++)
            write_mark(output, read->marks[mark].line, read_path);
        write_face(output, mesh->face_vertices + corner, read ? read->face_uvs + corner : NULL, mesh->face_sizes[f]);
    }
}

/* `note` says units and axes. */
static skein_status write_file(const char *path, const skein_mesh *mesh, skein_normals normals, const io_mesh *read,
                               const char *read_path, const char *note, skein_error *error) {
    skein_error unseen;
    error = error ? error : &unseen;
    skein_status status = io_clip_check_positions(path, mesh->positions, mesh->vertex_count, error);
    if (status != SKEIN_OK) return status;
    double *vectors = malloc((mesh->vertex_count + 1) * 3 * sizeof *vectors);
    if (!vectors)
        return io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory for %zu normals", mesh->vertex_count);
    status = skein_mesh_normals(mesh, normals, vectors, error);

    io_output *output = status ? NULL : io_output_open(path, error);
    if (output) {
        io_output_printf(output, "# Skein %s: %s; %zu vertices, %zu faces\n", SKEIN_VERSION, note, mesh->vertex_count,
                         mesh->face_count);
        for (size_t v = 0; v < mesh->vertex_count; v++) write_vector(output, "v", mesh->positions + 3 * v);
        for (size_t v = 0; v < mesh->vertex_count; v++) write_vector(output, "vn", vectors + 3 * v);
        for (size_t t = 0; read && t < read->uv_count; t++) write_uv(output, read->uvs + 2 * t);
        write_faces(output, mesh, read, read_path);
        status = io_output_commit(output, error);
    } else status = error->status;
    free(vectors);
    return status;
}

skein_status io_obj_write(const char *path, const skein_mesh *mesh, skein_normals normals, skein_error *error) {
    return write_file(path, mesh, normals, NULL, "", "metres, y up", error);
}

skein_status io_obj_write_as(const char *path, const skein_mesh *mesh, skein_normals normals, const io_mesh *read,
                             const char *read_path, skein_error *error) {
    return write_file(path, mesh, normals, read, read_path, "metres, y up", error);
}

skein_status io_obj_write_clip(const io_clip *clip, const char *path, skein_error *error) {
    const io_clip_params *p = clip->params;
    char note[64] = "metres", scale[IO_FLOAT_SIZE];
    io_float_print((float)p->scale, scale);
    if (p->scale != 1) snprintf(note, sizeof note, "a metre is %s", scale);
    strcat(note, p->up == IO_UP_Z ? ", z up" : ", y up");
    return write_file(path, &clip->mesh, (skein_normals)p->normals, clip->read, clip->read_path, note, error);
}
