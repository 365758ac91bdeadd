/* Tests of meshes in other formats than OBJ: what is written as PLY, STL and GLB is read back as the same mesh, and
 * small files made by hand, in tests/corpus/mesh, are read as what they say. */
#include "test_command.h"

#include <math.h>

#include "io/clip.h"

static io_mesh read_mesh(const char *path) {
    io_mesh mesh;
    skein_error error = {SKEIN_OK, "", ""};
    if (io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, &error)) fail_msg("%s: %s", error.where, error.message);
    return mesh;
}

/* ---- Files by hand ---------------------------------------------------------------------------------------- */

static void one_triangle_is_read_from_every_ply(void **state) {
    (void)state;
    static const double places[] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, uvs[] = {0, 0, 1, 0, 0, 1};
    static const uint32_t corners[] = {0, 1, 2};
    static const char *const names[] = {"ascii.ply", "little.ply", "big.ply", "base64.gltf"};
    for (size_t i = 0; i < COUNT(names); i++) {
        char path[64];
        snprintf(path, sizeof path, "tests/corpus/mesh/%s", names[i]);
        io_mesh mesh = read_mesh(path);
        assert_int_equal(mesh.vertex_count, 3);
        assert_int_equal(mesh.face_count, 1);
        assert_int_equal(mesh.face_sizes[0], 3);
        assert_memory_equal(mesh.positions, places, sizeof places);
        assert_memory_equal(mesh.face_vertices, corners, sizeof corners);
        assert_int_equal(mesh.uv_count, i == 0 ? 3 : 0);
        if (i == 0) assert_memory_equal(mesh.uvs, uvs, sizeof uvs);
        io_mesh_free(&mesh);
    }
}

static void triangles_of_an_stl_share_their_corners(void **state) {
    (void)state;
    static const uint32_t corners[] = {0, 1, 2, 1, 3, 2}; // -0 is the same place as 0
    for (int i = 0; i < 2; i++) {
        io_mesh mesh = read_mesh(i ? "tests/corpus/mesh/text.stl" : "tests/corpus/mesh/binary.stl");
        assert_int_equal(mesh.vertex_count, 4);
        assert_int_equal(mesh.face_count, 2);
        assert_memory_equal(mesh.face_vertices, corners, sizeof corners);
        io_mesh_free(&mesh);
    }
}

/* A strip of two triangles, under two nodes: turned by 90 degrees about z, twice as large, and 5 m along z. */
static void nodes_of_a_glb_place_its_meshes(void **state) {
    (void)state;
    static const double places[] = {0, 0, 5, 0, 2, 5, -2, 0, 5, -2, 2, 5};
    static const uint32_t corners[] = {0, 1, 2, 1, 3, 2};
    static const double uvs[] = {0, 0, 1, 0, 0, 1, 1, 1};
    io_mesh mesh = read_mesh("tests/corpus/mesh/strip.glb");
    assert_int_equal(mesh.vertex_count, 4);
    for (size_t i = 0; i < 12; i++) assert_float_equal(mesh.positions[i], places[i], 1e-12);
    assert_int_equal(mesh.face_count, 2);
    assert_memory_equal(mesh.face_vertices, corners, sizeof corners);
    assert_memory_equal(mesh.face_uvs, corners, sizeof corners);
    for (size_t i = 0; i < 8; i++) assert_float_equal(mesh.uvs[i], uvs[i], 1e-12);
    io_mesh_free(&mesh);
}

static void a_gltf_reads_numbers_beside_it(void **state) {
    (void)state;
    const float places[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    FILE *file = fopen(in_folder("of it.bin"), "wb");
    assert_int_equal(fwrite(places, 4, 9, file), 9);
    assert_int_equal(fclose(file), 0);
    write_scene(in_folder("a.gltf"),
                "{'asset': {'version': '2.0'}, 'buffers': [{'byteLength': 36, 'uri': 'of%20it.bin'}],"
                "'bufferViews': [{'buffer': 0, 'byteLength': 36}],"
                "'accessors': [{'bufferView': 0, 'componentType': 5126, 'count': 3, 'type': 'VEC3'}],"
                "'meshes': [{'primitives': [{'attributes': {'POSITION': 0}}]}]}");
    io_mesh mesh = read_mesh(in_folder("a.gltf"));
    assert_int_equal(mesh.vertex_count, 3);
    assert_true(mesh.positions[3] == 1);
    io_mesh_free(&mesh);
}

/* ---- There and back ------------------------------------------------------------------------------------------ */

/* A closed mesh of quadrilaterals and triangles: a cube with a roof, and seams in its texture. */
static const double house[] = {0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 1, 0.5, 1.7, 0.1};
static const uint32_t house_sizes[] = {4, 4, 4, 4, 4, 3, 3, 3, 3};
static const uint32_t house_corners[] = {0, 1, 2, 3, 0, 4, 5, 1, 1, 5, 6, 2, 2, 6, 7, 3,
                                         3, 7, 4, 0, 4, 8, 5, 5, 8, 6, 6, 8, 7, 7, 8, 4};

static void write_house(const io_clip_format *format, const char *path) {
    static const io_clip_params params = {.every = 1, .scale = 1};
    static float uv[2 * COUNT(house_corners)];
    for (size_t i = 0; i < COUNT(uv); i++) uv[i] = (float)(i % 7) / 8;
    skein_error error = {SKEIN_OK, "", ""};
    io_clip clip = {
        .name = "house",
        .mesh = {house, COUNT(house) / 3, house_sizes, COUNT(house_sizes), house_corners, COUNT(house_corners)},
        .corner_uv = uv,
        .fps = 30,
        .samples = 1,
        .read_path = "",
        .params = &params};
    if (format->write) {
        assert_int_equal(format->write(&clip, path, &error), SKEIN_OK);
        return;
    }
    void *file = format->create(&clip, path, &error);
    assert_int_equal(format->add(file, house, &error), SKEIN_OK);
    assert_int_equal(format->commit(file, &error), SKEIN_OK);
}

static double volume(const io_mesh *mesh) {
    double sum = 0;
    const uint32_t *corners = mesh->face_vertices;
    for (size_t f = 0; f < mesh->face_count; corners += mesh->face_sizes[f++])
        for (uint32_t k = 2; k < mesh->face_sizes[f]; k++) {
            const double *a = mesh->positions + 3 * corners[0], *b = mesh->positions + 3 * corners[k - 1],
                         *c = mesh->positions + 3 * corners[k];
            sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0]);
        }
    return sum / 6;
}

static void a_mesh_comes_back_from_every_format(void **state) {
    (void)state;
    io_mesh mesh;
    // PLY keeps all: order, and faces of any size
    write_house(&io_clip_ply, in_folder("house.ply"));
    mesh = read_mesh(in_folder("house.ply"));
    skein_mesh ought = {house, COUNT(house) / 3, house_sizes, COUNT(house_sizes), house_corners, COUNT(house_corners)};
    assert_true(io_mesh_has_faces_of(&mesh, &ought));
    for (size_t i = 0; i < COUNT(house); i++) assert_true((float)mesh.positions[i] == (float)house[i]);
    double enclosed = volume(&mesh);
    assert_true(fabs(enclosed) > 1);
    io_mesh_free(&mesh);
    // STL and GLB keep the triangles, and what they enclose: 14 of them, whose corners meet in nine places
    static const char *const names[] = {"house.stl", "house.glb"};
    for (int i = 0; i < 2; i++) {
        write_house(i ? &io_clip_glb : &io_clip_stl, in_folder(names[i]));
        mesh = read_mesh(in_folder(names[i]));
        assert_int_equal(mesh.vertex_count, 9);
        assert_int_equal(mesh.face_count, 14);
        assert_float_equal(volume(&mesh), enclosed, 1e-7);
        assert_true(i == 0 || mesh.uv_count > 9); // seams: more than vertices
        io_mesh_free(&mesh);
    }
}

/* Bytes of the binary files, by their descriptions. */
static void ply_and_stl_have_the_bytes_of_their_formats(void **state) {
    (void)state;
    io_bytes bytes;
    skein_error error;
    write_house(&io_clip_stl, in_folder("house.stl"));
    assert_int_equal(io_file_read(in_folder("house.stl"), 1 << 20, &bytes, &error), SKEIN_OK);
    assert_int_equal(bytes.size, 84 + 14 * 50);
    assert_int_equal(bytes.data[80], 14);
    assert_memory_not_equal(bytes.data, "solid", 5);
    float first[12]; // of the floor: 0, 1, 2, facing down
    static const float floor[12] = {0, -1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1};
    memcpy(first, bytes.data + 84, sizeof first);
    for (int k = 0; k < 12; k++) assert_true(first[k] == floor[k]);
    io_bytes_free(&bytes);

    write_house(&io_clip_ply, in_folder("house.ply"));
    assert_int_equal(io_file_read(in_folder("house.ply"), 1 << 20, &bytes, &error), SKEIN_OK);
    const char *body = strstr(bytes.data, "end_header\n") + 11;
    assert_int_equal(bytes.size - (size_t)(body - bytes.data), 9 * 24 + 9 + 4 * COUNT(house_corners));
    assert_memory_equal(bytes.data, "ply\nformat binary_little_endian 1.0\ncomment Skein ", 50);
    assert_contains(bytes.data, "; a metre is 1, y up\nelement vertex 9\nproperty float x\n");
    assert_contains(bytes.data, "element face 9\nproperty list uchar int vertex_indices\nend_header\n");
    float vertex[6];
    memcpy(vertex, body + 24, sizeof vertex);
    assert_true(vertex[0] == 1 && vertex[1] == 0 && vertex[2] == 0);
    assert_float_equal(vertex[3] * vertex[3] + vertex[4] * vertex[4] + vertex[5] * vertex[5], 1, 1e-6);
    io_bytes_free(&bytes);
}

/* Each kind of file is a scene by itself, and its cloth falls. */
static void every_mesh_runs_as_a_scene(void **state) {
    (void)state;
    static const char *const names[] = {"ascii.ply", "binary.stl", "strip.glb", "base64.gltf"};
    for (size_t i = 0; i < COUNT(names); i++) {
        char path[64];
        snprintf(path, sizeof path, "tests/corpus/mesh/%s", names[i]);
        outcome o = SKEIN("run", path, "--frames", "2");
        assert_status(o, 0);
        outcome_free(&o);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(one_triangle_is_read_from_every_ply), TEST(triangles_of_an_stl_share_their_corners),
        TEST(nodes_of_a_glb_place_its_meshes),     TEST(a_gltf_reads_numbers_beside_it),
        TEST(a_mesh_comes_back_from_every_format), TEST(ply_and_stl_have_the_bytes_of_their_formats),
        TEST(every_mesh_runs_as_a_scene),
    };
    return cmocka_run_group_tests_name("meshes in", tests, NULL, NULL);
}
