/* Bodies of tetrahedra: the reader of .node and .ele, broken files, and the body against closed forms. */
#include "all_methods.h"
#include "helpers.h"
#include "io/mesh.h"

#include <dirent.h>

#ifndef SKEIN_SOURCE_DIR
#define SKEIN_SOURCE_DIR "."
#endif

/* ---- files ---- */

static skein_status read_texts(const char *node, const char *ele, io_mesh *mesh, skein_error *error) {
    io_text texts[2] = {{node, strlen(node), "a.node"}, {ele, strlen(ele), "a.ele"}};
    return io_tetrahedra_read(&texts[0], &texts[1], mesh, (io_warnings){NULL, NULL}, error);
}

static void numbers_count_from_zero_or_one(void **state) {
    (void)state;
    static const char *const texts[][2] = {
        {"4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1.5\n", "1 4 0\n0 0 1 2 3\n"},
        {"# points\n\n4 3 2 1 # with attributes\r\n1 0 0 0 9 9 1\n 2 1 0 0 9 9 0\n3 0 1 0 9 -9e1 0\n\n4 0 0 1.5 9 9 0",
         "1 4 1\n1  1 2 3 4  -7 # a region"},
        {"4 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1.5\n", "1 4\n1 1 2 3 4"},
    };
    for (size_t i = 0; i < COUNT(texts); i++) {
        io_mesh mesh;
        skein_error error = {SKEIN_OK, "", ""};
        if (read_texts(texts[i][0], texts[i][1], &mesh, &error)) fail_msg("%s: %s", error.where, error.message);
        assert_true(mesh.tetrahedra && mesh.vertex_count == 4 && mesh.face_count == 1 && mesh.face_sizes[0] == 4);
        for (uint32_t k = 0; k < 4; k++) assert_int_equal(mesh.face_vertices[k], k);
        assert_true(mesh.positions[3] == 1 && mesh.positions[7] == 1 && mesh.positions[11] == 1.5);
        io_mesh_free(&mesh);
    }
}

/* Every pair in tests/bad/tetrahedra: where (a line of 0: the file as a whole), and what is said. */
static const struct {
    const char *name, *ending;
    int line;
    const char *message;
} bad_files[] = {
    {"points_cut_off", ".node", 4, "the file ends after 2 of 4 points: it is cut off, or its header is wrong"},
    {"points_of_the_plane", ".node", 1,
     "the number of coordinates is 2: expected 3: a mesh of the plane has no tetrahedra"},
    {"point_out_of_order", ".node", 3, "point 3 where 2 is the next: expected all of them in order, from 0 or 1"},
    {"point_from_two", ".node", 2, "point 2 where 0 is the next: expected all of them in order, from 0 or 1"},
    {"point_without_z", ".node", 3, "the line ends before z"},
    {"point_not_finite", ".node", 3, "x is 'nan': expected a finite number"},
    {"marker_missing", ".node", 3, "point 2 has 0 values after its own: the header promises 1"},
    {"marker_not_promised", ".node", 2, "point 1 has 1 values after its own: the header promises 0"},
    {"header_of_words", ".node", 1, "the number of points is 'many': expected a whole number"},
    {"header_cut_off", ".node", 1, "the line ends before the number of coordinates"},
    {"only_comments", ".node", 0, "nothing but comments in the file: expected the number of points"},
    {"no_points", ".node", 1, "no points in the file"},
    {"empty_node", ".node", 0, "the file is empty: expected a mesh"},
    {"cells_cut_off", ".ele", 3, "the file ends after 1 of 2 tetrahedra: it is cut off, or its header is wrong"},
    {"cells_of_ten", ".ele", 1,
     "the number of corners of a tetrahedron is 10: expected 4: those with more points on their edges are not read"},
    {"no_cells", ".ele", 1, "no tetrahedra in the file"},
    {"cell_of_three", ".ele", 2, "the line ends before a corner"},
    {"cell_out_of_range", ".ele", 2, "point 5 in a tetrahedron, but there are 4 points, 1 to 4"},
    {"cell_point_zero", ".ele", 2, "point 0 in a tetrahedron, but there are 4 points, 1 to 4"},
    {"cell_point_twice", ".ele", 2, "point 2 twice in one tetrahedron"},
    {"cell_negative", ".ele", 2, "a corner is '-4': expected a whole number"},
    {"cell_from_zero", ".ele", 2, "tetrahedron 0 where 1 is the next: expected all of them in order, from 0 or 1"},
    {"cell_attribute_missing", ".ele", 2, "tetrahedron 1 has 0 values after its own: the header promises 1"},
    {"binary_cells", ".ele", 1, "a NUL byte: the file is binary or damaged, expected text"},
    {"without_cells", ".ele", 0, "cannot read: no such file or directory"},
};

static void broken_files_are_told(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(bad_files); i++) {
        char path[1024], place[100];
        snprintf(path, sizeof path, "%s/tests/bad/tetrahedra/%s%s", SKEIN_SOURCE_DIR, bad_files[i].name,
                 i % 2 ? ".node" : ".ele");
        int length = snprintf(place, sizeof place, "/tetrahedra/%s%s:%d", bad_files[i].name, bad_files[i].ending,
                              bad_files[i].line);
        if (!bad_files[i].line) place[length -= 2] = '\0';
        io_mesh mesh;
        skein_error error = {SKEIN_OK, "", ""};
        skein_status status = io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, &error);
        assert_int_not_equal(status, SKEIN_OK);
        assert_int_equal(status, error.status);
        assert_string_equal(error.message, bad_files[i].message);
        assert_string_equal(error.where + strlen(error.where) - (size_t)length, place);
        assert_null(mesh.positions);
        assert_int_equal(io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, NULL), status);
    }
    DIR *bad = opendir(SKEIN_SOURCE_DIR "/tests/bad/tetrahedra");
    assert_non_null(bad);
    size_t count = 0;
    for (struct dirent *entry; (entry = readdir(bad)) != NULL;) count += entry->d_name[0] != '.';
    closedir(bad);
    assert_int_equal(count, 2 * COUNT(bad_files) - 1); // one has no .ele
}

/* ---- the body ---- */

static io_mesh read_ball(void) {
    io_mesh mesh;
    skein_error error = {SKEIN_OK, "", ""};
    if (io_mesh_read(SKEIN_SOURCE_DIR "/meshes/ball.ele", &mesh, (io_warnings){NULL, NULL}, &error))
        fail_msg("%s: %s", error.where, error.message);
    return mesh;
}

static double volume_of(const vec3 *p) {
    vec3 a = minus(p[1], p[0]), b = minus(p[2], p[0]), c = minus(p[3], p[0]);
    return ((a.y * b.z - a.z * b.y) * c.x + (a.z * b.x - a.x * b.z) * c.y + (a.x * b.y - a.y * b.x) * c.z) / 6;
}

/* Of the ball's tetrahedra as they lie now, all told; and the farthest that one is from its own in the mesh, relative.
 */
static double volume_now(const skein_world *world, const io_mesh *mesh, double *worst) {
    double sum = 0;
    *worst = 0;
    for (size_t t = 0; t < mesh->face_count; t++) {
        vec3 now[4], rest[4];
        for (size_t k = 0; k < 4; k++) {
            uint32_t i = mesh->face_vertices[4 * t + k];
            now[k] = position_of(world, i);
            memcpy(&rest[k], mesh->positions + 3 * (size_t)i, sizeof rest[k]);
        }
        *worst = fmax(*worst, fabs(volume_of(now) / volume_of(rest) - 1));
        sum += fabs(volume_of(now));
    }
    return sum;
}

static skein_handle add_ball(skein_world *world, const io_mesh *mesh, double height, double stiffness, double bulk) {
    skein_handle ball;
    skein_mesh view = io_mesh_view(mesh);
    OK(world, skein_body_add(world, "tetrahedra", &view,
                             SKEIN_SETTINGS(SKEIN_VEC3("position", 0, height, 0), SKEIN_REAL("stiffness", stiffness),
                                            SKEIN_REAL("volume.stiffness", bulk), SKEIN_REAL("density", 500)),
                             &ball));
    return ball;
}

/* What is in the ball: every edge once, all of the mass, and a closed surface that looks outward. */
static void a_ball_has_all_its_parts(void **state) {
    (void)state;
    io_mesh mesh = read_ball();
    for (size_t t = 0; t < mesh.face_count; t++) { // every corner faces outward now and then
        uint32_t *c = mesh.face_vertices + 4 * t, first = c[0];
        c[0] = c[t % 4], c[t % 4] = first;
    }
    skein_world *world = new_world("xpbd", 1);
    skein_handle ball = add_ball(world, &mesh, 0, 1e4, 1e5);
    assert_int_equal(skein_particle_count(world), 127);
    assert_int_equal(statistics_of(world).constraints, 560 + 726); // Euler: 127 - 726 + 1160 - 560 = 1
    double worst, volume = volume_now(world, &mesh, &worst), mass = 0, outer = 0;
    skein_view v = skein_velocity_view(world);
    for (size_t i = 0; i < v.count; i++) mass += (double)v.xyzw[4 * v.slot_of[i] + 3];
    assert_share(mass, 500 * volume, 1e-6);
    assert_true(volume > 0.85 * 4 / 3 * PI * 0.25 * 0.25 * 0.25 && volume < 4 / 3.0 * PI * 0.25 * 0.25 * 0.25);
    skein_surface s;
    OK(world, skein_body_surface(world, ball, &s));
    assert_true(s.vertex_count == 42 && s.face_count == 80);
    for (size_t f = 0; f < s.face_count; f++) {
        vec3 p[4] = {{0, 0, 0}};
        for (size_t k = 0; k < 3; k++) p[k + 1] = position_of(world, s.particle_of_vertex[s.face_vertices[3 * f + k]]);
        assert_true(volume_of(p) > 0);
        outer += volume_of(p);
    }
    assert_share(outer, volume, 1e-6); // Gauss
    skein_world_destroy(world);
    io_mesh_free(&mesh);
}

/* Stretched by e to all sides the edges hold 3 E V e^2 and the volumes K V ((1 + e)^3 - 1)^2/2, whatever the mesh. */
static void a_swollen_ball_holds_what_it_should(void **state) {
    (void)state;
    io_mesh mesh = read_ball();
    static const double moduli[][2] = {{1e4, 0}, {0, 1e5}, {2e4, 3e4}};
    for (size_t m = 0; m < COUNT(moduli); m++) {
        skein_world *world = new_world("xpbd", 1);
        add_ball(world, &mesh, 0, moduli[m][0], moduli[m][1]);
        double worst, volume = volume_now(world, &mesh, &worst), e = 0.02, swollen = pow(1 + e, 3) - 1;
        for (size_t i = 0; i < mesh.vertex_count; i++) {
            const double *p = mesh.positions + 3 * i;
            place_particle(world, i, (1 + e) * p[0], (1 + e) * p[1], (1 + e) * p[2]);
        }
        assert_share(statistics_of(world).elastic_energy,
                     volume * (3 * moduli[m][0] * e * e + moduli[m][1] * swollen * swollen / 2), 2e-4);
        skein_world_destroy(world);
    }
    io_mesh_free(&mesh);
}

/* Volumes that are rigid come back by themselves, each and all, from a ball that was squeezed flat by a tenth. */
static void volumes_come_back(void **state) {
    (void)state;
    io_mesh mesh = read_ball();
    skein_world *world = new_world("pbd", 1);
    OK(world, skein_set_path(world, "method.inertia", skein_number(0)));
    OK(world, skein_set_path(world, "method.iterations", skein_number(200)));
    add_ball(world, &mesh, 0, 0, INFINITY);
    for (size_t i = 0; i < mesh.vertex_count; i++) {
        const double *p = mesh.positions + 3 * i;
        place_particle(world, i, p[0], 0.9 * p[1], p[2]);
    }
    double worst, volume = volume_now(world, &mesh, &worst), whole = volume / 0.9;
    assert_share(worst, 0.1, 1e-3);
    steps(world, 1, 0.01);
    assert_share(volume_now(world, &mesh, &worst), whole, 1e-4);
    assert_under(worst, 2e-3);
    skein_world_destroy(world);
    io_mesh_free(&mesh);
}

/* Under every method it falls as a stone does, lands, and is pressed no flatter than the others' is. */
static void a_ball_lands_under_every_method(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    io_mesh mesh = read_ball();
    double first = 0;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], strcmp(all_methods[m], "explicit_euler") ? 40 : 200);
        add_gravity(world);
        OK(world, skein_collider_add(world, "plane", NULL, NULL));
        add_ball(world, &mesh, 0.352, 5e4, 1e5);
        OK(world, skein_set_path(world, "bodies.0.damping", skein_number(150)));
        steps(world, 6, 1.0 / 60);
        assert_near(position_of(world, 0).y, 0.352 - 9.81 * 0.1 * 0.1 / 2, 2e-3);
        double lowest = 1, worst;
        for (int n = 0; n < 18; n++) {
            steps(world, 1, 1.0 / 60);
            lowest = fmin(lowest, position_of(world, 0).y);
        }
        double volume = volume_now(world, &mesh, &worst);
        print_message("%s: its middle comes down to %.4f\n", all_methods[m], lowest);
        if (m == 0) first = lowest;
        assert_true(lowest < 0.235 && lowest > 0.15);
        assert_near(lowest, first, 0.01);
        assert_true(volume > 0.03 && volume < 0.0655 && statistics_of(world).nonfinite == 0);
        skein_world_destroy(world);
    }
    io_mesh_free(&mesh);
}

/* Corners may come in any order: those of the other hand give the same body. */
static void the_order_of_corners_does_not_matter(void **state) {
    (void)state;
    io_mesh mesh = read_ball();
    double energy[2];
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        skein_world *world = new_world("xpbd", 5);
        for (size_t t = 0; t < mesh.face_count && mirrored; t += 2) {
            uint32_t *c = mesh.face_vertices + 4 * t, first = c[0];
            c[0] = c[1], c[1] = first;
        }
        add_ball(world, &mesh, 0, 1e4, 1e5);
        for (size_t i = 0; i < mesh.vertex_count; i++)
            place_particle(world, i, 1.1 * mesh.positions[3 * i], mesh.positions[3 * i + 1], mesh.positions[3 * i + 2]);
        energy[mirrored] = statistics_of(world).elastic_energy;
        skein_world_destroy(world);
    }
    assert_share(energy[1], energy[0], 1e-5);
    io_mesh_free(&mesh);
}

/* ---- what is refused ---- */

static char heard[512];
static void hear(void *user, skein_log_level level, const char *message) {
    (void)user;
    (void)level;
    snprintf(heard, sizeof heard, "%s", message);
}

static void meshes_that_are_none_are_refused(void **state) {
    (void)state;
    static const double p[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 1, 1, 1, 2, 2, 2};
    static const uint32_t three[] = {3}, four[] = {4, 4, 4}, flat[] = {0, 1, 2, 4}, good[] = {0, 1, 2, 3},
                          far[] = {0, 1, 2, 7}, crowd[] = {0, 1, 2, 3, 0, 1, 2, 5, 0, 1, 2, 6};
    const struct {
        skein_mesh mesh;
        const char *message;
    } rows[] = {
        {{p, 4, three, 1, good, 3}, "0 has 3 corners, and a tetrahedron 4"},
        {{p, 5, four, 1, flat, 4}, "tetrahedron 0, of the points 0 1 2 4, is flat"},
        {{p, 4, four, 1, far, 4}, "tetrahedron 0 names point 7, but there are only 4"},
        {{p, 4, four, 1, flat, 4}, "tetrahedron 0 names point 4, but there are only 4"}, // one past the last
        {{p, 7, four, 1, crowd, 8}, "8 corners for 1 tetrahedra"},
        {{p, 7, four, 3, crowd, 8}, "8 corners for 3 tetrahedra"},
        {{p, 7, four, 3, crowd, 12}, "3 tetrahedra share the face 0 1 2"},
        {{p, 4, four, 0, good, 0}, "4 points and 0 tetrahedra"},
        {{(const double[]){0, 0, 0, 1, 0, 0, 0, 1, 0, 0, NAN, 1}, 4, four, 1, good, 4}, "point 3"},
    };
    skein_world_desc desc = skein_default_world_desc();
    desc.log = hear;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    FAILS(world, SKEIN_ERROR_VALUE, "needs a mesh", skein_body_add(world, "tetrahedra", NULL, NULL, NULL));
    for (size_t i = 0; i < COUNT(rows); i++)
        FAILS(world, SKEIN_ERROR_MESH, rows[i].message, skein_body_add(world, "tetrahedra", &rows[i].mesh, NULL, NULL));
    const skein_mesh one = {p, 4, four, 1, good, 4}, lonely = {p, 6, four, 1, good, 4};
    FAILS(world, SKEIN_ERROR_NAME, "names no part of a body of tetrahedra",
          skein_body_add(world, "tetrahedra", &one, SKEIN_SETTINGS(SKEIN_TEXT("pins", "top face")), NULL));
    assert_int_equal(skein_particle_count(world), 0);
    OK(world, skein_body_add(world, "tetrahedra", &lonely, SKEIN_SETTINGS(SKEIN_TEXT("pins", "0, box 0.9 -1 -1 2 1 1")),
                             NULL));
    assert_non_null(strstr(heard, "2 points are in no tetrahedron, and pinned"));
    assert_int_equal(statistics_of(world).pinned_particles, 4);
    skein_world_destroy(world);
}

/* ---- memory ---- */

typedef struct purse {
    size_t left;
} purse;

static void *take(void *user, size_t size, size_t alignment) {
    purse *p = user;
    if (!p->left) return NULL;
    p->left--;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void give_back(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}

/* It may end at any point: the body is there whole, or not at all. */
static void memory_may_end_at_any_point(void **state) {
    (void)state;
    io_mesh mesh = read_ball();
    skein_mesh view = io_mesh_view(&mesh);
    bool built = false;
    for (size_t most = 0; !built; most++) {
        purse p = {SIZE_MAX};
        skein_world_desc desc = skein_default_world_desc();
        desc.allocate = take, desc.release = give_back, desc.memory_user = &p;
        skein_world *world = skein_world_create(&desc, NULL);
        assert_non_null(world);
        p.left = most;
        skein_status status = skein_body_add(world, "tetrahedra", &view, SKEIN_SETTINGS(SKEIN_TEXT("pins", "0")), NULL);
        assert_true(status == SKEIN_OK || status == SKEIN_ERROR_MEMORY);
        built = status == SKEIN_OK;
        assert_int_equal(skein_particle_count(world), built ? 127 : 0);
        assert_int_equal(skein_object_count(world, SKEIN_BODY), built);
        p.left = SIZE_MAX;
        OK(world, skein_world_step(world, 0.01));
        skein_world_destroy(world);
        assert_true(most < 200);
    }
    io_mesh_free(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_count_from_zero_or_one),
        cmocka_unit_test(broken_files_are_told),
        cmocka_unit_test(a_ball_has_all_its_parts),
        cmocka_unit_test(a_swollen_ball_holds_what_it_should),
        cmocka_unit_test(volumes_come_back),
        cmocka_unit_test(a_ball_lands_under_every_method),
        cmocka_unit_test(the_order_of_corners_does_not_matter),
        cmocka_unit_test(meshes_that_are_none_are_refused),
        cmocka_unit_test(memory_may_end_at_any_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
