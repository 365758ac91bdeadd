/* Feeds any bytes to the reader of .node and .ele, and judges what it makes of them.
 *
 *   points \0 tetrahedra      the two files of a name
 *
 * Owns nothing. Called as fuzz/fuzz.h says.
 * Invariant: a mesh that was read keeps the promise of io/mesh.h, of four corners each, and is taken by the library or
 * refused with words; a refusal has a place and words. */
#include <math.h>

#include "fuzz/fuzz.h"
#include "io/mesh.h"

static void judge_mesh(const io_mesh *mesh) {
    require(mesh->tetrahedra && mesh->vertex_count > 0 && mesh->face_count > 0);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) require(isfinite(mesh->positions[i]));
    require(mesh->face_vertex_count == 4 * mesh->face_count);
    for (size_t t = 0; t < mesh->face_count; t++) {
        require(mesh->face_sizes[t] == 4);
        const uint32_t *corner = mesh->face_vertices + 4 * t;
        for (int a = 0; a < 4; a++) {
            require(corner[a] < mesh->vertex_count);
            for (int b = 0; b < a; b++) require(corner[a] != corner[b]);
        }
    }
}

static void judge_body(const io_mesh *mesh) {
    size_t used = 0;
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = fuzz_allocate;
    desc.release = fuzz_release;
    desc.memory_user = &used;
    skein_world *world = skein_world_create(&desc, NULL);
    require(world != NULL);
    skein_mesh view = io_mesh_view(mesh);
    skein_status status = skein_body_add(world, "tetrahedra", &view, NULL, NULL);
    require(status == skein_world_error(world)->status);
    require(status == SKEIN_OK || skein_world_error(world)->message[0]);
    skein_world_destroy(world);
    require(used == 0);
}

static void ignore(void *user, const char *line) {
    (void)user;
    require(strlen(line) > 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    io_text node = {.path = "input.node"}, ele = {.path = "input.ele"};
    char *points = fuzz_take_part(&data, &size, &node.size), *corners = fuzz_take_part(&data, &size, &ele.size);
    node.text = points;
    ele.text = corners;
    io_mesh mesh;
    skein_error error = {SKEIN_OK, "", ""};
    skein_status status = io_tetrahedra_read(&node, &ele, &mesh, (io_warnings){ignore, NULL}, &error);
    if (status == SKEIN_OK) {
        judge_mesh(&mesh);
        judge_body(&mesh);
    } else require(error.status == status && strncmp(error.where, "input.", 6) == 0 && error.message[0]);
    io_mesh_free(&mesh);
    free(points);
    free(corners);
    return 0;
}
