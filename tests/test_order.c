/* The order of springs, hinges and tetrahedra of meshes, which go from face to face: sixteen can be worked at once, and
 * what is swept one after the other does not build up. */
#include "constraints/sweep.h"
#include "helpers.h"
#include "world/world.h"

enum { SIDE = 40, BROAD_SIDE = 150 };

/* A unit square of triangles, whose rows, or if asked all vertices, are numbered out of order, so that it is no grid. */
typedef struct square {
    double corners[BROAD_SIDE * BROAD_SIDE][3];
    uint32_t sizes[2 * BROAD_SIDE * BROAD_SIDE], faces[2 * BROAD_SIDE * BROAD_SIDE][3];
    skein_mesh mesh;
} square;

static uint32_t number_of(uint32_t vertex, uint32_t side, bool renumbered) {
    return renumbered ? vertex * 7919u % (side * side) : vertex / side * 17 % side * side + vertex % side;
}

static square *make_square(uint32_t side, bool renumbered) {
    square *s = calloc(1, sizeof *s);
    size_t faces = 0;
    for (uint32_t r = 0; r < side; r++)
        for (uint32_t c = 0; c < side; c++) {
            double *at = s->corners[number_of(r * side + c, side, renumbered)];
            at[0] = (c + 0.3 * sin(5.0 * r + c)) / side, at[2] = (r + 0.3 * cos(3.0 * c + r)) / side;
        }
    for (uint32_t r = 0; r + 1 < side; r++)
        for (uint32_t c = 0; c + 1 < side; c++) {
            uint32_t a = r * side + c, k[4] = {a, a + 1, a + side + 1, a + side}, turn = (r * c + c) % 2;
            for (uint32_t t = 0; t < 2; t++, faces++) {
                s->sizes[faces] = 3;
                for (uint32_t i = 0; i < 3; i++)
                    s->faces[faces][i] = number_of(k[(turn + 2 * t + i) % 4], side, renumbered);
            }
        }
    s->mesh = (skein_mesh){s->corners[0], side * side, s->sizes, faces, s->faces[0], 3 * faces};
    return s;
}

static skein_world *make_cloth(uint32_t side, const char *pins, const char *bending, bool renumbered) {
    square *s = make_square(side, renumbered);
    skein_world *world = skein_world_create(NULL, NULL);
    OK(world, skein_body_add(world, "cloth", &s->mesh,
                             SKEIN_SETTINGS(SKEIN_TEXT("pins", pins), SKEIN_TEXT("bend.by", bending),
                                            SKEIN_REAL("stretch.limit", 0.1)),
                             NULL));
    free(s);
    return world;
}

/* Each batch has about as many elements as its groups have lanes; dependent ones stand apart, at the cost of some. */
static void assert_full_groups(skein_world *world, size_t batches) {
    OK(world, skein_world_explain(world, 1.0 / 60, NULL, NULL));
    size_t full = 0;
    for (size_t b = 0; b < world->rules.batches.count; b++) {
        const sk_batch *batch = world->rules.batches.data[b];
        size_t groups = 0;
        if (!batch->count) continue; // the shear of triangles
        for (size_t s = 0; s < batch->sweep_count; s++) {
            assert_false(batch->sweeps[s].strips);
            groups += batch->sweeps[s].group_count;
        }
        double share = batch->only_bounds ? 0.3 : 0.4; // spans are long: fewer share no particle
        if ((double)batch->count < share * SK_LANES * (double)groups)
            fail_msg("%s: %zu elements in %zu groups of %d", batch->label, batch->count, groups, SK_LANES);
        full++;
    }
    assert_int_equal(full, batches);
}

static void groups_of_meshes_are_full(void **state) {
    (void)state;
    static const char *const pins[] = {"", "0 39", "box -1 -1 -1 2 1 0.01"}, *const bendings[] = {"angle", "curvature",
                                                                                                  "springs"};
    for (size_t p = 0; p < COUNT(pins); p++)
        for (size_t b = 0; b < COUNT(bendings); b++)
            for (int renumbered = 0; renumbered < 2; renumbered++) {
                skein_world *world = make_cloth(SIDE, pins[p], bendings[b], renumbered);
                assert_full_groups(world, 4); // folds and edges, and spans, short and long
                skein_world_destroy(world);
            }
}

/* A block of cells of six tetrahedra each. */
static void groups_of_tetrahedra_are_full(void **state) {
    (void)state;
    enum { N = 9, POINTS = (N + 1) * (N + 1) * (N + 1), COUNT_OF = 6 * N * N * N };
    static double points[POINTS][3];
    static uint32_t sizes[COUNT_OF], corners[COUNT_OF][4];
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const uint32_t strides[3] = {(N + 1) * (N + 1), N + 1, 1};
    size_t made = 0;
    for (uint32_t i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++) points[i][k] = 0.1 * (i / strides[k] % (N + 1));
    for (uint32_t cell = 0; cell < N * N * N; cell++)
        for (int o = 0; o < 6; o++, made++) {
            uint32_t at = cell / (N * N) * strides[0] + cell / N % N * strides[1] + cell % N;
            sizes[made] = 4;
            corners[made][0] = at;
            for (int k = 0; k < 3; k++) corners[made][k + 1] = at += strides[orders[o][k]];
        }
    skein_mesh mesh = {points[0], POINTS, sizes, COUNT_OF, corners[0], 4 * COUNT_OF};
    skein_world *world = skein_world_create(NULL, NULL);
    OK(world, skein_body_add(world, "tetrahedra", &mesh, NULL, NULL));
    assert_full_groups(world, 2);
    skein_world_destroy(world);
}

/* In the file's order each spring shares a particle with the next, and what one sweep leaves over went on through the
 * whole mesh: a sheet that only falls was torn to 1e10 % by its own roundings. */
static void a_mesh_without_pins_falls_as_it_is(void **state) {
    (void)state;
    static const char *const bendings[] = {"angle", "curvature", "springs"};
    for (size_t b = 0; b < COUNT(bendings); b++)
        for (int renumbered = 0; renumbered < 2; renumbered++) {
            skein_world *world = make_cloth(SIDE, "", bendings[b], renumbered);
            OK(world, skein_force_add(world, "gravity", NULL, NULL));
            OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 10))));
            for (int i = 0; i < 90; i++) OK(world, skein_world_step(world, 1.0 / 60));
            skein_statistics s;
            OK(world, skein_world_statistics(world, &s));
            if (!(s.max_stretch < 1e4 * EPSILON)) fail_msg("%s: stretched by %g", bendings[b], s.max_stretch);
            skein_world_destroy(world);
        }
}

/* A broad mesh walks along its axis, though its vertices are numbered anyhow and nothing holds it: in memory as in
 * space, for threads that follow each other. The answer is in the mesh's own order all the same. */
static void a_broad_mesh_walks_without_pins(void **state) {
    (void)state;
    skein_world *world = make_cloth(BROAD_SIDE, "", "springs", true);
    square *s = make_square(BROAD_SIDE, true);
    assert_full_groups(world, 4);
    for (size_t b = 0; b < world->rules.batches.count; b++)
        for (size_t i = 0; i < world->rules.batches.data[b]->sweep_count && !world->rules.batches.data[b]->only_bounds;
             i++)
            assert_non_null(world->rules.batches.data[b]->sweeps[i].slab_start);
    double *x = malloc(3 * s->mesh.vertex_count * sizeof *x);
    OK(world, skein_positions_copy(world, 0, s->mesh.vertex_count, x));
    for (size_t i = 0; i < s->mesh.vertex_count; i++)
        for (int k = 0; k < 3; k++) assert_true(fabs(x[3 * i + (size_t)k] - s->corners[i][k]) < 1e-6);
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 10))));
    for (int i = 0; i < 10; i++) OK(world, skein_world_step(world, 1.0 / 60));
    skein_statistics now;
    OK(world, skein_world_statistics(world, &now));
    assert_true(now.max_stretch < 1e4 * EPSILON);
    free(x);
    free(s);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(groups_of_meshes_are_full),
        cmocka_unit_test(groups_of_tetrahedra_are_full),
        cmocka_unit_test(a_mesh_without_pins_falls_as_it_is),
        cmocka_unit_test(a_broad_mesh_walks_without_pins),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
