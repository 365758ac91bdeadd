/* Leaves of contact's skin: which triangles are one, and their order. */
#include "contact/touch.h"
#include "irregular.h"
#include "world/world.h"

static const sk_skin *skin_of(skein_world *world) {
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.001)), NULL));
    steps(world, 1, 1e-3);
    return &((const sk_touch *)world->rules.forces.data[0]->state)->skin;
}

static int in_common(const uint32_t a[3], const uint32_t b[3]) {
    int count = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) count += a[i] == b[k];
    return count;
}

/* Each has up to two triangles, with an edge in common; all features are there once. How many have one triangle. */
static size_t check_leaves(const sk_skin *skin, size_t triangles, size_t edges) {
    size_t single = 0, vertex = 0, edge = 0, triangle = 0;
    for (size_t i = 0; i < skin->leaf_count; i++) {
        const sk_leaf *leaf = &skin->leaf[i];
        assert_int_equal(leaf->first_vertex, vertex);
        assert_int_equal(leaf->first_edge, edge);
        assert_int_equal(leaf->first_triangle, triangle);
        vertex += leaf->vertices, edge += leaf->edges, triangle += leaf->triangles;
        assert_in_range(leaf->triangles, 1, 2);
        assert_true(leaf->vertices <= 4 && leaf->edges <= 5);
        single += leaf->triangles == 1;
        if (leaf->triangles == 2)
            assert_int_equal(in_common(skin->triangle[leaf->first_triangle], skin->triangle[leaf->first_triangle + 1]),
                             2);
    }
    assert_int_equal(vertex, skin->vertex_count);
    assert_int_equal(triangle, triangles);
    assert_int_equal(edge, edges);
    return single;
}

/* How far apart in order leaves are that have a vertex in common, in the mean. */
static double spread_of(const sk_skin *skin) {
    double sum = 0;
    for (size_t v = 0; v < skin->vertex_count; v++) {
        uint32_t first = skin->leaf_of[skin->leaf_start[v]], last = skin->leaf_of[skin->leaf_start[v + 1] - 1];
        sum += (last - first) / (double)skin->vertex_count;
    }
    return sum;
}

static void cells_of_a_grid_are_leaves(void **state) {
    (void)state;
    static const size_t grids[][2] = {{20, 30}, {4, 200}, {200, 3}};
    for (size_t g = 0; g < COUNT(grids); g++) {
        const size_t rows = grids[g][0], columns = grids[g][1], cells = (rows - 1) * (columns - 1);
        skein_world *world = new_world("xpbd", 1);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", (double)rows, (double)columns),
                                                SKEIN_PAIR("size", 0.01 * (double)columns, 0.02 * (double)rows)),
                                 NULL));
        const sk_skin *skin = skin_of(world);
        assert_int_equal(skin->leaf_count, cells);
        assert_int_equal(check_leaves(skin, 2 * cells, cells + rows * (columns - 1) + (rows - 1) * columns), 0);
        for (size_t i = 0; i < cells; i++) { // in their order: row after row
            const uint32_t first = skin->particle[skin->triangle[skin->leaf[i].first_triangle][0]];
            const size_t row = i / (columns - 1);
            assert_in_range(first, row * columns, (row + 2) * columns - 1);
        }
        skein_world_destroy(world);
    }
}

/* A closed sheet of triangles in any order, as scanners write them. */
static void triangles_that_lie_about_are_paired_and_follow_a_curve(void **state) {
    (void)state;
    enum { ALONG = 60, AROUND = 50, TRIANGLES = 2 * (ALONG - 1) * AROUND };
    for (int shuffled = 0; shuffled < 2; shuffled++) {
        skein_world *world = new_world("xpbd", 1);
        skein_mesh mesh = irregular_mesh(ALONG, AROUND, true);
        uint32_t *corner = (uint32_t *)mesh.face_vertices, seed = 5;
        double *p = (double *)mesh.positions;
        for (size_t i = 0; i < mesh.vertex_count; i++) {
            const double angle = 2 * acos(-1.0) / AROUND * p[3 * i];
            p[3 * i] = 0.3 * cos(angle), p[3 * i + 1] = 0.3 * sin(angle), p[3 * i + 2] *= 0.04;
        }
        for (size_t t = TRIANGLES; t > 1 && shuffled; t--) {
            seed = 1664525 * seed + 1013904223;
            const size_t other = (seed >> 8) % t;
            for (int k = 0; k < 3; k++) {
                const uint32_t kept = corner[3 * (t - 1) + (size_t)k];
                corner[3 * (t - 1) + (size_t)k] = corner[3 * other + (size_t)k], corner[3 * other + (size_t)k] = kept;
            }
        }
        add_and_free(world, mesh, p, SKEIN_SETTINGS(SKEIN_TEXT("bend.by", "springs")));
        const sk_skin *skin = skin_of(world);
        const size_t single = check_leaves(skin, TRIANGLES, (ALONG - 1) * AROUND * 2 + ALONG * AROUND);
        const double spread = spread_of(skin);
        if (shuffled) assert_true(single * 50 < TRIANGLES);
        print_message("%zu of %d triangles alone; leaves of a vertex %.0f apart\n", single, TRIANGLES, spread);
        assert_true(spread < 400); // at random it would be two thirds of all
        skein_world_destroy(world);
    }
}

/* Three triangles at one edge, two on each other, and one without area: each in one leaf, and no three. */
static void odd_triangles_are_in_leaves_too(void **state) {
    (void)state;
    static const double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.3, 0.8, 0.9, 2, 0, 0};
    static const uint32_t corners[] = {0, 1, 2, 1, 0, 3, 0, 1, 4, 2, 1, 0, 0, 1, 5}, sizes[] = {3, 3, 3, 3, 3};
    const skein_mesh mesh = {.positions = positions,
                             .vertex_count = 6,
                             .face_sizes = sizes,
                             .face_count = 5,
                             .face_vertices = corners,
                             .face_vertex_count = 15};
    skein_world *world = new_world("xpbd", 1);
    OK(world, skein_body_add(world, "cloth", &mesh, SKEIN_SETTINGS(SKEIN_TEXT("bend.by", "springs")), NULL));
    assert_int_equal(check_leaves(skin_of(world), 5, 9), 1);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_of_a_grid_are_leaves),
        cmocka_unit_test(triangles_that_lie_about_are_paired_and_follow_a_curve),
        cmocka_unit_test(odd_triangles_are_in_leaves_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
