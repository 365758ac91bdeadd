/* Feeds any bytes to the readers of OBJ, OFF, PLY, STL and glTF, and judges what they make of them.
 *
 * Owns nothing. Called as fuzz/fuzz.h says.
 * Invariant: a mesh that was read keeps the promise of io/mesh.h; a refusal has a place and words.
 */
#include <math.h>

#include "fuzz/fuzz.h"
#include "io/mesh.h"

static void judge_mesh(const io_mesh *mesh) {
    require(mesh->vertex_count > 0 && mesh->face_count > 0);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) require(isfinite(mesh->positions[i]));
    size_t corner = 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        uint32_t size = mesh->face_sizes[f];
        require(size >= 3 && size <= mesh->face_vertex_count - corner);
        for (uint32_t i = 0; i < size; i++, corner++) {
            require(mesh->face_vertices[corner] < mesh->vertex_count);
            require(mesh->face_uvs[corner] == IO_NO_UV || mesh->face_uvs[corner] < mesh->uv_count);
            require(i == 0 || mesh->face_vertices[corner] != mesh->face_vertices[corner - 1]);
        }
    }
    require(corner == mesh->face_vertex_count);
}

static void judge_normals(const io_mesh *mesh) {
    skein_mesh view = io_mesh_view(mesh);
    double *normals = malloc(3 * mesh->vertex_count * sizeof *normals);
    require(normals != NULL);
    for (int mode = SKEIN_NORMALS_AREA; mode <= SKEIN_NORMALS_ANGLE; mode++) {
        require(!skein_mesh_normals(&view, (skein_normals)mode, normals, NULL));
        for (const double *n = normals; n < normals + 3 * mesh->vertex_count; n += 3)
            require(fabs(sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) - 1) < 1e-12);
    }
    free(normals);
}

static void ignore(void *user, const char *line) {
    (void)user;
    require(strlen(line) > 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const struct {
        skein_status (*read)(const char *, size_t, const char *, io_mesh *, io_warnings, skein_error *);
    } formats[] = {{io_obj_read}, {io_off_read}, {io_ply_read}, {io_stl_read}, {io_gltf_read}};
    for (size_t format = 0; format < sizeof formats / sizeof *formats; format++) {
        io_mesh mesh;
        skein_error error = {SKEIN_OK, "", ""};
        skein_status status = formats[format].read((const char *)data, size, "no/folder/input", &mesh,
                                                   (io_warnings){ignore, NULL}, &error);
        if (status == SKEIN_OK) {
            judge_mesh(&mesh);
            judge_normals(&mesh);
        } else {
            // a long path, of a buffer beside the file, keeps its end
            require(!strncmp(error.where, "no/folder/", 10) || !strncmp(error.where, "...", 3));
            require(error.status == status && error.message[0]);
        }
        io_mesh_free(&mesh);
    }
    return 0;
}
