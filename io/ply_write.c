/* The exporter "ply": a frame as binary PLY, with unit normals of its vertices.
 *
 *   ply / format binary_little_endian 1.0 / element vertex N: float x y z nx ny nz / element face M: list / end_header
 *   vertices, then faces: their number of corners (one byte where all have fewer than 256, else four), and the corners
 *
 * Owns: the file's layout. Format: Turk, The PLY Polygon File Format, 1994.
 */
#include <stdlib.h>
#include <string.h>

#include "io/bytes.h"
#include "io/clip.h"

static void write_head(io_output *output, const io_clip *clip, bool small) {
    const skein_mesh *m = &clip->mesh;
    char scale[IO_FLOAT_SIZE];
    io_float_print((float)clip->params->scale, scale);
    io_output_printf(output, "ply\nformat binary_little_endian 1.0\ncomment Skein %s; a metre is %s, %c up\n",
                     SKEIN_VERSION, scale, clip->params->up == IO_UP_Z ? 'z' : 'y');
    io_output_printf(output, "element vertex %zu\n", m->vertex_count);
    static const char *const names[] = {"x", "y", "z", "nx", "ny", "nz"};
    for (size_t k = 0; k < (m->face_count ? 6 : 3); k++) io_output_printf(output, "property float %s\n", names[k]);
    if (m->face_count)
        io_output_printf(output, "element face %zu\nproperty list %s int vertex_indices\n", m->face_count,
                         small ? "uchar" : "uint");
    io_output_printf(output, "end_header\n");
}

static void write_vertices(io_output *output, const skein_mesh *mesh, const double *normals) {
    unsigned char bytes[24];
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        for (size_t k = 0; k < 3; k++) {
            io_put_float(bytes + 4 * k, (float)mesh->positions[3 * v + k]);
            io_put_float(bytes + 12 + 4 * k, (float)normals[3 * v + k]);
        }
        io_output_write(output, bytes, mesh->face_count ? 24 : 12);
    }
}

static void write_faces(io_output *output, const skein_mesh *mesh, bool small) {
    unsigned char bytes[4];
    size_t corner = 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        io_put_u32(bytes, mesh->face_sizes[f]);
        io_output_write(output, bytes, small ? 1 : 4);
        for (uint32_t k = 0; k < mesh->face_sizes[f]; k++) {
            io_put_u32(bytes, mesh->face_vertices[corner++]);
            io_output_write(output, bytes, 4);
        }
    }
}

static skein_status write_frame(const io_clip *clip, const char *path, skein_error *error) {
    const skein_mesh *m = &clip->mesh;
    skein_status status = io_clip_check_positions(path, m->positions, m->vertex_count, error);
    double *normals = status ? NULL : malloc((m->vertex_count + 1) * 3 * sizeof *normals);
    if (!status && !normals) status = io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    if (!status) status = skein_mesh_normals(m, (skein_normals)clip->params->normals, normals, error);
    io_output *output = status ? NULL : io_output_open(path, error);
    if (output) {
        bool small = true;
        for (size_t f = 0; f < m->face_count; f++) small &= m->face_sizes[f] < 256;
        write_head(output, clip, small);
        write_vertices(output, m, normals);
        write_faces(output, m, small);
        status = io_output_commit(output, error);
    } else if (!status) status = SKEIN_ERROR_FILE;
    free(normals);
    return status;
}

static const skein_field fields[] = {
    IO_CLIP_FIELD_EVERY(0, 0, "0: one file, of the last frame; else one each so many frames, NAME_0000.ply on"),
    IO_CLIP_FIELD_NORMALS,
    IO_CLIP_FIELD_UP,
    IO_CLIP_FIELD_SCALE,
};

const io_clip_format io_clip_ply = {
    .kind = {.name = "ply",
             .help = "Binary PLY of the last frame, or a sequence: the mesh as it came, with unit vertex normals.",
             .category = SKEIN_EXPORTER,
             .fields = fields,
             .field_count = sizeof fields / sizeof *fields,
             .params_size = sizeof(io_clip_params)},
    .ending = ".ply",
    .write = write_frame,
};
