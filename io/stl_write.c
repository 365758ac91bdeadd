/* The exporter "stl": a frame as binary STL, for printing and for what reads nothing else.
 *
 *   80 bytes of text, uint32 triangles, then of each: its normal, three corners (12 floats), and two bytes of zero
 *
 * Faces become triangles, as fans. Owns: the file's layout. Format: 3D Systems, StereoLithography Interface
 * Specification, 1988.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/bytes.h"
#include "io/clip.h"

enum { HEAD_BYTES = 80, TRIANGLE_BYTES = 50 };

/* The unit normal; of a triangle without area 0, which readers take for "work it out". */
static void find_normal(const double *const corners[3], double normal[3]) {
    double a[3], b[3], length;
    for (int k = 0; k < 3; k++) {
        a[k] = corners[1][k] - corners[0][k];
        b[k] = corners[2][k] - corners[0][k];
    }
    for (int k = 0; k < 3; k++) normal[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int k = 0; k < 3; k++) normal[k] = length > 0 ? normal[k] / length : 0;
}

static void write_triangle(io_output *output, const double *const corners[3]) {
    unsigned char bytes[TRIANGLE_BYTES] = {0};
    double normal[3];
    find_normal(corners, normal);
    for (size_t k = 0; k < 3; k++) {
        io_put_float(bytes + 4 * k, (float)normal[k]);
        for (size_t c = 0; c < 3; c++) io_put_float(bytes + 12 * (c + 1) + 4 * k, (float)corners[c][k]);
    }
    io_output_write(output, bytes, sizeof bytes);
}

static void write_triangles(io_output *output, const skein_mesh *mesh) {
    const uint32_t *corners = mesh->face_vertices;
    for (size_t f = 0; f < mesh->face_count; corners += mesh->face_sizes[f++])
        for (uint32_t k = 2; k < mesh->face_sizes[f]; k++) {
            const uint32_t used[3] = {corners[0], corners[k - 1], corners[k]};
            const double *at[3];
            for (int c = 0; c < 3; c++) at[c] = mesh->positions + 3 * (size_t)used[c];
            write_triangle(output, at);
        }
}

static skein_status write_frame(const io_clip *clip, const char *path, skein_error *error) {
    const skein_mesh *m = &clip->mesh;
    size_t triangles = m->face_vertex_count - 2 * m->face_count;
    skein_status status = io_clip_check_positions(path, m->positions, m->vertex_count, error);
    if (!status && triangles > UINT32_MAX)
        status = io_error_set(error, SKEIN_ERROR_LIMIT, path, "an STL file holds at most 4294967295 triangles, not %zu",
                              triangles);
    if (status) return status;
    io_output *output = io_output_open(path, error);
    if (!output) return SKEIN_ERROR_FILE;
    char head[HEAD_BYTES] = {0}, scale[IO_FLOAT_SIZE]; // it must not begin with "solid": that is a text
    unsigned char count[4];
    io_float_print((float)clip->params->scale, scale);
    snprintf(head, sizeof head, "Skein %s; a metre is %s, %c up", SKEIN_VERSION, scale,
             clip->params->up == IO_UP_Z ? 'z' : 'y');
    io_output_write(output, head, sizeof head);
    io_put_u32(count, (uint32_t)triangles);
    io_output_write(output, count, sizeof count);
    write_triangles(output, m);
    return io_output_commit(output, error);
}

static const skein_field fields[] = {
    IO_CLIP_FIELD_EVERY(0, 0, "0: one file, of the last frame; else one each so many frames, NAME_0000.stl on"),
    IO_CLIP_FIELD_UP,
    IO_CLIP_FIELD_SCALE,
};

const io_clip_format io_clip_stl = {
    .kind = {.name = "stl",
             .help = "Binary STL of the last frame, or a sequence: triangles alone, each with its normal.",
             .category = SKEIN_EXPORTER,
             .fields = fields,
             .field_count = sizeof fields / sizeof *fields,
             .params_size = sizeof(io_clip_params)},
    .ending = ".stl",
    .needs_faces = true,
    .write = write_frame,
};
