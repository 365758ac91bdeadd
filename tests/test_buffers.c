/* Positions, velocities, vertices and normals in memory of the caller's own layout. */
#include "helpers.h"

/* What a program gives a graphics card, say: positions and normals in float, with something of its own between. */
typedef struct vertex {
    float uv[2], position[3];
    uint32_t colour;
    float normal[3];
} vertex;

static skein_world *falling_cloth(skein_handle *cloth) {
    skein_world *world = new_world("xpbd", 4);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 7), SKEIN_VEC3("position", 1, 2, 3),
                                            SKEIN_TEXT("pins", "top corners")),
                             cloth));
    add_gravity(world);
    steps(world, 7, 0.01);
    return world;
}

static void copies_with_a_stride(void **state) {
    (void)state;
    enum { N = 35, FIRST = 4, COUNT_OF_ALL = 30, STRIDE = 5 };
    skein_handle cloth;
    skein_world *world = falling_cloth(&cloth);
    skein_status (*const plain[])(const skein_world *, size_t, size_t, double *) = {skein_positions_copy,
                                                                                    skein_velocities_copy};
    skein_status (*const strided[])(const skein_world *, size_t, size_t, skein_buffer) = {skein_positions_copy_to,
                                                                                          skein_velocities_copy_to};
    for (int what = 0; what < 2; what++) {
        double ought[3 * COUNT_OF_ALL], wide[STRIDE * COUNT_OF_ALL], tight[3 * COUNT_OF_ALL];
        float narrow[STRIDE * COUNT_OF_ALL], narrow_tight[3 * COUNT_OF_ALL];
        for (size_t i = 0; i < COUNT(wide); i++) wide[i] = narrow[i] = 77;
        OK(world, plain[what](world, FIRST, COUNT_OF_ALL, ought));
        OK(world, strided[what](world, FIRST, COUNT_OF_ALL, skein_doubles(wide + 1, STRIDE * sizeof *wide)));
        OK(world, strided[what](world, FIRST, COUNT_OF_ALL, skein_floats(narrow + 1, STRIDE * sizeof *narrow)));
        OK(world, strided[what](world, FIRST, COUNT_OF_ALL, skein_doubles(tight, 0)));
        OK(world, strided[what](world, FIRST, COUNT_OF_ALL, skein_floats(narrow_tight, 0)));
        assert_memory_equal(tight, ought, sizeof ought);
        for (size_t i = 0; i < COUNT_OF_ALL; i++) {
            assert_memory_equal(wide + STRIDE * i + 1, ought + 3 * i, 3 * sizeof *ought);
            for (size_t k = 0; k < 3; k++) {
                assert_true(narrow[STRIDE * i + 1 + k] == (float)ought[3 * i + k]);
                assert_true(narrow_tight[3 * i + k] == (float)ought[3 * i + k]);
            }
            // what lies between is the caller's
            assert_true(wide[STRIDE * i] == 77 && wide[STRIDE * i + 4] == 77);
            assert_true(narrow[STRIDE * i] == 77 && narrow[STRIDE * i + 4] == 77);
        }
        FAILS(world, SKEIN_ERROR_VALUE, "a stride of 11 bytes: expected 0, or 12 or more",
              strided[what](world, 0, 1, skein_floats(narrow, 11)));
        FAILS(world, SKEIN_ERROR_VALUE, "expected 0, or 24 or more",
              strided[what](world, 0, 1, skein_doubles(wide, 12)));
        FAILS(world, SKEIN_ERROR_VALUE, "the world has 35", strided[what](world, N, 1, skein_doubles(wide, 0)));
        FAILS(world, SKEIN_ERROR_VALUE, "expected SKEIN_FLOAT32",
              strided[what](world, 0, 1, (skein_buffer){wide, 0, (skein_number_type)7}));
    }
    skein_world_destroy(world);
}

static void a_surface_goes_into_a_vertex_buffer(void **state) {
    (void)state;
    skein_handle cloth;
    skein_world *world = falling_cloth(&cloth);
    skein_surface s;
    OK(world, skein_body_surface(world, cloth, &s));
    vertex buffer[35];
    assert_int_equal(s.vertex_count, COUNT(buffer));
    for (size_t i = 0; i < COUNT(buffer); i++) buffer[i] = (vertex){.uv = {5, 6}, .colour = 0xabcdef};
    static const double blends[] = {1, 0, 0.25};
    for (size_t b = 0; b < COUNT(blends); b++) {
        double at[3 * 35], normals[3 * 35];
        OK(world, skein_body_vertices_copy(world, cloth, blends[b], skein_floats(buffer[0].position, sizeof *buffer),
                                           skein_floats(buffer[0].normal, sizeof *buffer)));
        for (size_t v = 0; v < COUNT(buffer); v++)
            OK(world, skein_positions_blend(world, blends[b], s.particle_of_vertex[v], 1, at + 3 * v));
        const skein_mesh mesh = {at, 35, s.face_sizes, s.face_count, s.face_vertices, s.face_vertex_count};
        assert_int_equal(skein_mesh_normals(&mesh, SKEIN_NORMALS_AREA, normals, NULL), SKEIN_OK);
        for (size_t v = 0; v < COUNT(buffer); v++) {
            for (size_t k = 0; k < 3; k++) {
                assert_true(buffer[v].position[k] == (float)at[3 * v + k]);
                assert_true(buffer[v].normal[k] == (float)normals[3 * v + k]);
            }
            assert_true(buffer[v].uv[0] == 5 && buffer[v].uv[1] == 6 && buffer[v].colour == 0xabcdef);
        }
    }
    // either alone
    double normals[3 * 35], positions[3 * 35];
    OK(world, skein_body_vertices_copy(world, cloth, 1, skein_doubles(NULL, 0), skein_doubles(normals, 0)));
    OK(world, skein_body_vertices_copy(world, cloth, 1, skein_doubles(positions, 0), skein_doubles(NULL, 0)));
    OK(world, skein_body_vertices_copy(world, cloth, 1, skein_floats(buffer[0].position, sizeof *buffer),
                                       skein_floats(buffer[0].normal, sizeof *buffer)));
    for (size_t i = 0; i < COUNT(normals); i++)
        assert_true((float)normals[i] == buffer[i / 3].normal[i % 3] &&
                    (float)positions[i] == buffer[i / 3].position[i % 3]);
    FAILS(world, SKEIN_ERROR_VALUE, "finite",
          skein_body_vertices_copy(world, cloth, NAN, skein_doubles(positions, 0), skein_doubles(NULL, 0)));
    FAILS(world, SKEIN_ERROR_VALUE, "normals",
          skein_body_vertices_copy(world, cloth, 1, skein_doubles(positions, 0), skein_doubles(normals, 8)));
    skein_world_destroy(world);
}

/* A roof of two faces, one of 3 x 2 m that slopes and one of 1 x 2 m that is level: at the ridge their normals are
 * weighted by area. Welded, a vertex that is written twice has one normal. */
static void normals_are_weighted_by_area(void **state) {
    (void)state;
    static const double corners[] = {-1, 0, 0, -1, 0, 2, 0, 0, 2, 0, 0, 0, /* twice: */ 0,
                                     0,  0, 0, 0,  2, 3, 3, 2, 3, 3, 0};
    static const uint32_t sizes[] = {4, 4}, faces[] = {0, 1, 2, 3, 4, 5, 6, 7};
    const skein_mesh mesh = {corners, 8, sizes, 2, faces, 8};
    skein_world *world = new_world("xpbd", 1);
    skein_handle roof;
    OK(world, skein_body_add(world, "cloth", &mesh, SKEIN_SETTINGS(SKEIN_REAL("weld", 1e-3)), &roof));
    double n[8 * 3];
    OK(world, skein_body_vertices_copy(world, roof, 1, skein_doubles(NULL, 0), skein_doubles(n, 0)));
    // level: 2 m2 along y; sloping: sqrt(18) x 2 m2 along (-1, 1, 0)/sqrt(2), which is (-6, 6, 0)
    double x = -6 / sqrt(36 + 64), y = 8 / sqrt(36 + 64), d = sqrt(0.5);
    const double ought[8][3] = {{0, 1, 0}, {0, 1, 0}, {x, y, 0},  {x, y, 0},
                                {x, y, 0}, {x, y, 0}, {-d, d, 0}, {-d, d, 0}};
    for (int v = 0; v < 8; v++)
        for (int k = 0; k < 3; k++) assert_near(n[3 * v + k], ought[v][k], 4 * EPSILON);
    skein_world_destroy(world);
}

static void meshes_that_are_none_have_no_normals(void **state) {
    (void)state;
    static const double corners[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
    double n[9];
    skein_error error;
    const uint32_t three[] = {3}, two[] = {2}, four[] = {4}, good[] = {0, 2, 1}, bad[] = {0, 2, 3};
    const skein_mesh meshes[] = {
        {corners, 3, three, 1, bad, 3}, {corners, 3, two, 1, good, 3}, {corners, 3, four, 1, good, 3}};
    static const char *const words[] = {"face 0 names vertex 3: the mesh has 3", "face 0 has 2 corners",
                                        "face 0 has 4 corners"};
    for (int m = 0; m < 3; m++) {
        assert_int_equal(skein_mesh_normals(&meshes[m], SKEIN_NORMALS_ANGLE, n, &error), SKEIN_ERROR_MESH);
        assert_non_null(strstr(error.message, words[m]));
    }
    const skein_mesh right = {corners, 3, three, 1, good, 3};
    assert_int_equal(skein_mesh_normals(&right, (skein_normals)3, n, &error), SKEIN_ERROR_VALUE);
    assert_int_equal(skein_mesh_normals(&right, SKEIN_NORMALS_ANGLE, n, &error), SKEIN_OK);
    for (int v = 0; v < 3; v++) assert_true(n[3 * v] == 0 && n[3 * v + 1] == 1 && n[3 * v + 2] == 0);
}

/* A body without faces has vertices, and normals that are of unit length. */
static void a_rope_has_vertices(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    skein_handle rope;
    skein_surface s;
    OK(world, skein_body_add(world, "rope", NULL, NULL, &rope));
    OK(world, skein_body_surface(world, rope, &s));
    double *xyz = calloc(6 * s.vertex_count + 1, sizeof *xyz), *n = xyz + 3 * s.vertex_count;
    assert_non_null(xyz);
    OK(world, skein_body_vertices_copy(world, rope, 1, skein_doubles(xyz, 0), skein_doubles(n, 0)));
    for (size_t v = 0; v < s.vertex_count; v++) {
        assert_near(n[3 * v] * n[3 * v] + n[3 * v + 1] * n[3 * v + 1] + n[3 * v + 2] * n[3 * v + 2], 1, 1e-12);
        vec3 p = position_of(world, s.particle_of_vertex[v]);
        assert_true(p.x == xyz[3 * v] && p.y == xyz[3 * v + 1] && p.z == xyz[3 * v + 2]);
    }
    free(xyz);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(copies_with_a_stride),         cmocka_unit_test(a_surface_goes_into_a_vertex_buffer),
        cmocka_unit_test(normals_are_weighted_by_area), cmocka_unit_test(meshes_that_are_none_have_no_normals),
        cmocka_unit_test(a_rope_has_vertices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
