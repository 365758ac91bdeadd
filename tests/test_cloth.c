/* The cloth builder: exact counts of springs, masses, welding, pins, the lengths of tethers, and the faults of
 * meshes that it warns about or refuses. */
#include "helpers.h"
#include "world/world.h"

/* ---- Meshes ------------------------------------------------------------------------------------- */

/* A mesh under construction; a square of quads (or of triangles) and whatever a test adds by hand. */
typedef struct draft {
    double positions[3 * 2000];
    uint32_t sizes[2000], corners[8000];
    size_t vertices, faces, filled;
} draft;

static skein_mesh mesh_of(const draft *d) {
    return (skein_mesh){d->positions, d->vertices, d->sizes, d->faces, d->corners, d->filled};
}

static uint32_t vertex(draft *d, double x, double y, double z) {
    double *p = d->positions + 3 * d->vertices;
    p[0] = x, p[1] = y, p[2] = z;
    return (uint32_t)d->vertices++;
}

static void face(draft *d, uint32_t size, const uint32_t *corners) {
    d->sizes[d->faces++] = size;
    memcpy(d->corners + d->filled, corners, size * sizeof *corners);
    d->filled += size;
}
#define FACE(draft_, ...) \
    face((draft_), (uint32_t)COUNT(((const uint32_t[]){__VA_ARGS__})), (const uint32_t[]){__VA_ARGS__})

/* rows x columns vertices in the xy-plane, a metre wide and high, the first row on top. */
static draft *upright(size_t rows, size_t columns, bool triangles) {
    draft *d = calloc(1, sizeof *d);
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            vertex(d, (double)c / (double)(columns - 1), 1 - (double)r / (double)(rows - 1), 0);
    for (size_t r = 0; r + 1 < rows; r++)
        for (size_t c = 0; c + 1 < columns; c++) {
            uint32_t a = (uint32_t)(r * columns + c), b = a + (uint32_t)columns;
            if (triangles) {
                FACE(d, a, b, b + 1);
                FACE(d, a, b + 1, a + 1);
            } else {
                FACE(d, a, b, b + 1, a + 1);
            }
        }
    return d;
}

/* A unit cube whose six quads have corners of their own: 24 vertices in 8 places. */
static draft *loose_cube(void) {
    draft *d = calloc(1, sizeof *d);
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            uint32_t corner[4];
            static const int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
            for (int k = 0; k < 4; k++) {
                double p[3];
                p[axis] = side, p[(axis + 1) % 3] = around[k][0], p[(axis + 2) % 3] = around[k][1];
                corner[k] = vertex(d, p[0], p[1], p[2]);
            }
            face(d, 4, corner);
        }
    return d;
}

/* These tests are of springs over folds; test_kinds.c has those of bending by angle. */
#define BY_SPRINGS SKEIN_TEXT("bend.by", "springs")

/* ---- Worlds and what is in them ------------------------------------------------------------------- */

typedef struct notes {
    char text[4096];
    int warnings;
} notes;

static void note(void *user, skein_log_level level, const char *message) {
    notes *n = user;
    assert_null(strchr(message, '\n'));
    n->warnings += level == SKEIN_LOG_WARNING;
    snprintf(n->text + strlen(n->text), sizeof n->text - strlen(n->text), "%s\n", message);
}

static skein_world *world_with_notes(notes *n) {
    memset(n, 0, sizeof *n);
    skein_world_desc desc = skein_default_world_desc();
    desc.log = note, desc.log_user = n;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    return world;
}

static const sk_batch *batch_named(const skein_world *world, const char *label) {
    for (size_t i = 0; i < world->rules.batches.count; i++)
        if (!strcmp(world->rules.batches.data[i]->label, label)) return world->rules.batches.data[i];
    fail();
    return NULL;
}

static size_t springs(const skein_world *world, const char *label) {
    return batch_named(world, label)->count;
}

static int compare_keys(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* No pair twice, whatever the kinds; no spring from a particle to itself; rest lengths as built. */
static void assert_springs_are_sound(const skein_world *world) {
    size_t count = 0, filled = 0;
    for (size_t i = 0; i < world->rules.batches.count; i++) count += world->rules.batches.data[i]->count;
    uint64_t *keys = malloc((count + 1) * sizeof *keys);
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        for (size_t e = 0; e < batch->count && !batch->coarse; e++) { // (bounds may be where springs are)
            uint32_t a = batch->particle[2 * e], b = batch->particle[2 * e + 1];
            assert_true(a != b && a < world->particles.count && b < world->particles.count);
            keys[filled++] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
            double rest = length3(minus(position_of(world, a), position_of(world, b)));
            assert_near((double)batch->rest[e], rest, 4 * EPSILON * (1 + rest));
        }
    }
    qsort(keys, filled, sizeof *keys, compare_keys);
    for (size_t i = 1; i < filled; i++) assert_true(keys[i] != keys[i - 1]);
    free(keys);
}

static double mass_of(const skein_world *world, size_t particle) {
    skein_view view = skein_velocity_view(world);
    return (double)view.xyzw[4 * view.slot_of[particle] + 3];
}

static bool is_held(const skein_world *world, size_t particle) {
    skein_view view = skein_position_view(world);
    return !(view.xyzw[4 * view.slot_of[particle] + 3] > 0);
}

static void build(skein_world *world, const draft *d, const skein_setting *settings) {
    skein_mesh mesh = mesh_of(d);
    OK(world, skein_body_add(world, "cloth", &mesh, settings, NULL));
}

/* ---- Springs ------------------------------------------------------------------------------------ */

static void triangles_have_edges_and_bending_pairs(void **state) {
    (void)state;
    draft *d = upright(17, 17, true);
    assert_int_equal(d->vertices, 289);
    assert_int_equal(d->faces, 512);
    skein_world *world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_int_equal(skein_particle_count(world), 289);
    assert_int_equal(springs(world, "stretch"), 800);
    assert_int_equal(springs(world, "shear"), 0);
    assert_int_equal(springs(world, "bend"), 736);
    assert_int_equal(statistics_of(world).constraints, 1536);
    assert_springs_are_sound(world);
    skein_surface surface;
    OK(world, skein_body_surface(world, skein_object_at(world, SKEIN_BODY, 0), &surface));
    assert_int_equal(surface.face_count, 512);
    assert_int_equal(surface.vertex_count, 289);
    assert_int_equal(surface.grid_rows, 0);
    assert_memory_equal(surface.face_vertices, d->corners, d->filled * sizeof *d->corners);
    skein_world_destroy(world);
    free(d);
}

static void a_grid_has_edges_diagonals_and_straight_bending(void **state) {
    (void)state;
    static const int sides[][2] = {{128, 128}, {2, 2}, {2, 7}, {9, 4}};
    for (size_t i = 0; i < COUNT(sides); i++) {
        int n = sides[i][0], m = sides[i][1];
        skein_world *world = new_world("xpbd", 1);
        OK(world, skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", n, m)), NULL));
        assert_int_equal(skein_particle_count(world), n * m);
        assert_int_equal(springs(world, "stretch"), n * (m - 1) + m * (n - 1));
        assert_int_equal(springs(world, "shear"), 2 * (n - 1) * (m - 1));
        assert_int_equal(springs(world, "bend"), n * (m - 2) + m * (n - 2));
        if (i == 0) assert_int_equal(statistics_of(world).constraints, 97026);
        assert_springs_are_sound(world);
        // bending goes straight on: two columns or two rows over
        const sk_batch *bend = batch_named(world, "bend");
        for (size_t e = 0; e < bend->count; e++) {
            int a = (int)bend->particle[2 * e], b = (int)bend->particle[2 * e + 1], step = abs(b - a);
            assert_true((step == 2 && a / m == b / m) || step == 2 * m);
        }
        skein_world_destroy(world);
    }
    // the same quads read as a mesh have the same springs
    draft *d = upright(9, 4, false);
    skein_world *world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_int_equal(springs(world, "stretch"), 9 * 3 + 4 * 8);
    assert_int_equal(springs(world, "shear"), 2 * 8 * 3);
    assert_int_equal(springs(world, "bend"), 9 * 2 + 4 * 7);
    assert_springs_are_sound(world);
    skein_world_destroy(world);
    free(d);
}

/* Where the pair across an edge is an edge itself, or across several edges at once, it still is one spring. */
static void no_pair_gets_two_springs(void **state) {
    (void)state;
    // a tetrahedron: the pair across each edge is the edge opposite
    draft *d = calloc(1, sizeof *d);
    for (int k = 0; k < 4; k++) vertex(d, k == 1, k == 2, k == 3);
    FACE(d, 0, 2, 1);
    FACE(d, 0, 1, 3);
    FACE(d, 0, 3, 2);
    FACE(d, 1, 2, 3);
    skein_world *world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_true(springs(world, "stretch") == 6 && springs(world, "bend") == 0);
    assert_springs_are_sound(world);
    skein_world_destroy(world);

    // an octahedron: four edges share each of the three long diagonals
    memset(d, 0, sizeof *d);
    for (int k = 0; k < 6; k++)
        vertex(d, k == 0 ? 1 : k == 1 ? -1 : 0, k == 2 ? 1 : k == 3 ? -1 : 0, k == 4 ? 1 : k == 5 ? -1 : 0);
    for (uint32_t n = 0; n < 8; n++) FACE(d, n & 1, 2 + (n >> 1 & 1), 4 + (n >> 2 & 1));
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_true(springs(world, "stretch") == 12 && springs(world, "bend") == 3);
    assert_springs_are_sound(world);
    skein_world_destroy(world);

    // a hexagon beside a triangle: six edges and six corners two apart; the fold joins the tip to both neighbours
    memset(d, 0, sizeof *d);
    for (int k = 0; k < 6; k++) vertex(d, cos(k * PI / 3), sin(k * PI / 3), 0);
    vertex(d, 2, 2, 0);
    FACE(d, 0, 1, 2, 3, 4, 5);
    FACE(d, 1, 0, 6);
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_true(springs(world, "stretch") == 8 && springs(world, "shear") == 6 && springs(world, "bend") == 2);
    assert_springs_are_sound(world);
    skein_world_destroy(world);

    // a heap of random faces: edges with many faces on them, faces on one another
    memset(d, 0, sizeof *d);
    uint64_t seed = 23;
    for (int k = 0; k < 30; k++)
        vertex(d, random_between(&seed, 0, 1), random_between(&seed, 0, 1), random_between(&seed, 0, 1));
    for (int f = 0; f < 200; f++) {
        uint32_t corners[6], size = (uint32_t)random_between(&seed, 3, 7);
        for (uint32_t k = 0; k < size; k++) {
            bool again;
            do {
                corners[k] = (uint32_t)random_between(&seed, 0, 30);
                again = false;
                for (uint32_t j = 0; j < k; j++) again |= corners[j] == corners[k];
            } while (again);
        }
        face(d, size, corners);
    }
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_springs_are_sound(world);
    skein_world_destroy(world);
    free(d);
}

/* The spring's share of the material: its stiffness over the sheet's. */
static double share_of(const skein_world *world, const char *label, uint32_t a, uint32_t b) {
    const sk_batch *batch = batch_named(world, label);
    for (size_t e = 0; e < batch->count; e++) {
        uint32_t p = batch->particle[2 * e], q = batch->particle[2 * e + 1];
        if ((p == a && q == b) || (p == b && q == a)) return (double)batch->scale[e];
    }
    fail();
    return 0;
}

/* Shares are areas over squared lengths: an edge of square cells stands for a cell (on the border half of one), a
 * diagonal for its own; triangles stand whole behind each of their edges, and twice behind a fold. */
static void springs_share_the_material_by_area(void **state) {
    (void)state;
    double off = 8 * EPSILON;
    skein_world *world = new_world("xpbd", 1);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 5, 5), SKEIN_PAIR("size", 4, 4)), NULL));
    assert_near(share_of(world, "stretch", 6, 7), 1, off);
    assert_near(share_of(world, "stretch", 7, 12), 1, off);
    assert_near(share_of(world, "stretch", 1, 2), 0.5, off);
    assert_near(share_of(world, "stretch", 5, 10), 0.5, off);
    assert_near(share_of(world, "shear", 6, 12), 1, off);
    assert_near(share_of(world, "shear", 1, 5), 1, off);
    assert_near(share_of(world, "bend", 6, 8), 1, off);
    assert_near(share_of(world, "bend", 6, 16), 1, off);
    assert_near(share_of(world, "bend", 1, 3), 0.5, off);
    skein_world_destroy(world);

    draft *d = upright(5, 5, true); // cut from upper left to lower right
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_near(share_of(world, "stretch", 6, 7), 1, off);
    assert_near(share_of(world, "stretch", 1, 2), 0.5, off);
    assert_near(share_of(world, "stretch", 6, 12), 0.5, off);
    assert_near(share_of(world, "bend", 7, 11), 1, off);   // over the diagonal 6-12
    assert_near(share_of(world, "bend", 6, 17), 0.4, off); // over the edge 11-12, two down and one across
    skein_world_destroy(world);

    // where the pair over a fold is an edge already, the edge keeps its own share
    memset(d, 0, sizeof *d);
    for (int k = 0; k < 4; k++) vertex(d, k == 1, k == 2, k == 3);
    FACE(d, 0, 2, 1);
    FACE(d, 0, 1, 3);
    FACE(d, 0, 3, 2);
    FACE(d, 1, 2, 3);
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_near(share_of(world, "stretch", 0, 3), 1, off);
    assert_near(share_of(world, "stretch", 1, 2), (0.5 + sqrt(0.75)) / 2, off);
    skein_world_destroy(world);

    // a needle would be stiffer than any step can bear: 500 times the sheet
    memset(d, 0, sizeof *d);
    vertex(d, 0, 0, 0), vertex(d, 1e-3, 0, 0), vertex(d, 0, 1, 0);
    FACE(d, 0, 1, 2);
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_near(share_of(world, "stretch", 0, 1), 100, 1e-3);
    assert_near(share_of(world, "stretch", 0, 2), 5e-4, 1e-9);
    skein_world_destroy(world);
    free(d);
}

/* ---- Masses, places ----------------------------------------------------------------------------- */

static void mass_is_density_times_area(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 4, 5), SKEIN_PAIR("size", 2, 0.6),
                                            SKEIN_REAL("density", 0.3)),
                             NULL));
    double cell = 2.0 / 4 * 0.6 / 3 * 0.3;
    for (size_t r = 0; r < 4; r++)
        for (size_t c = 0; c < 5; c++) {
            double share = (r == 0 || r == 3 ? 0.5 : 1) * (c == 0 || c == 4 ? 0.5 : 1);
            assert_share(mass_of(world, 5 * r + c), share * cell, 4 * EPSILON);
        }
    skein_world_destroy(world);

    // a triangle of 3 m2 beside a quad of 4 m2, twice as large by `scale`: four times the area
    draft *d = calloc(1, sizeof *d);
    vertex(d, 0, 0, 0), vertex(d, 2, 0, 0), vertex(d, 2, 2, 0), vertex(d, 0, 2, 0), vertex(d, 5, 0, 0);
    FACE(d, 0, 1, 2, 3);
    FACE(d, 1, 4, 2);
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("density", 0.25), SKEIN_REAL("scale", 2)));
    static const double ought[] = {1, 1 + 1, 1 + 1, 1, 1};
    for (size_t i = 0; i < 5; i++) assert_share(mass_of(world, i), ought[i], 4 * EPSILON);
    skein_world_destroy(world);
    free(d);
}

/* Scaled, turned about x, then y, then z, then moved. */
static void a_sheet_is_placed_as_asked(void **state) {
    (void)state;
    draft *d = calloc(1, sizeof *d);
    vertex(d, 1, 0, 0), vertex(d, 0, 1, 0), vertex(d, 0, 0, 1), vertex(d, 1, 1, 1);
    FACE(d, 0, 1, 2);
    skein_world *world = new_world("xpbd", 1);
    build(world, d,
          SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("scale", 2), SKEIN_VEC3("rotation", 90, 0, 90),
                         SKEIN_VEC3("position", 10, 20, 30), SKEIN_VEC3("velocity", 1, 2, 3), SKEIN_TEXT("pins", "2")));
    // about x: y to z, z to -y; then about z: x to y, y to -x
    assert_under(length3(minus(position_of(world, 0), (vec3){10, 22, 30})), 1e-5);
    assert_under(length3(minus(position_of(world, 1), (vec3){10, 20, 32})), 1e-5);
    assert_under(length3(minus(position_of(world, 2), (vec3){12, 20, 30})), 1e-5);
    assert_under(length3(minus(velocity_of(world, 0), (vec3){1, 2, 3})), 0);
    assert_under(length3(velocity_of(world, 2)), 0); // a pin does not move, nor does a vertex of no face
    assert_under(length3(velocity_of(world, 3)), 0);
    skein_world_destroy(world);

    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_VEC3("rotation", 0, 30, 0)));
    assert_under(length3(minus(position_of(world, 0), (vec3){cos(PI / 6), 0, -0.5})), 1e-6);
    assert_under(length3(minus(position_of(world, 2), (vec3){0.5, 0, cos(PI / 6)})), 1e-6);
    skein_world_destroy(world);
    free(d);

    world = new_world("xpbd", 1);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 3, 5), SKEIN_PAIR("size", 4, 1)), NULL));
    assert_under(length3(minus(position_of(world, 0), (vec3){-2, 0, -0.5})), 0);
    assert_under(length3(minus(position_of(world, 4), (vec3){2, 0, -0.5})), 0);
    assert_under(length3(minus(position_of(world, 10), (vec3){-2, 0, 0.5})), 0);
    skein_world_destroy(world);
}

/* ---- Welding ------------------------------------------------------------------------------------ */

static void welding_joins_particles_and_keeps_vertices(void **state) {
    (void)state;
    draft *d = loose_cube();
    notes n;
    skein_world *world = world_with_notes(&n);
    // corners a little apart, to both sides of where a hash cell might end
    uint64_t seed = 29;
    for (size_t i = 0; i < 3 * d->vertices; i++) d->positions[i] += random_between(&seed, -2e-4, 2e-4);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("weld", 1e-3), SKEIN_REAL("density", 2)));
    assert_int_equal(n.warnings, 0);
    assert_int_equal(skein_particle_count(world), 8);
    assert_int_equal(springs(world, "stretch"), 12);
    assert_int_equal(springs(world, "shear"), 12);
    assert_int_equal(springs(world, "bend"), 0); // straight across an edge of a cube lies the diagonal of the next face
    assert_springs_are_sound(world);
    double mass = 0;
    for (size_t i = 0; i < 8; i++) mass += mass_of(world, i);
    assert_share(mass, 12, 1e-3);
    // the surface has all vertices, each led to the particle in its place; particles come in the vertices' order
    skein_surface surface;
    OK(world, skein_body_surface(world, skein_object_at(world, SKEIN_BODY, 0), &surface));
    assert_true(surface.vertex_count == 24 && surface.particle_count == 8 && surface.face_count == 6);
    assert_memory_equal(surface.face_vertices, d->corners, d->filled * sizeof *d->corners);
    uint32_t highest = 0;
    for (size_t v = 0; v < 24; v++) {
        const double *p = d->positions + 3 * v;
        uint32_t particle = surface.particle_of_vertex[v];
        assert_under(length3(minus(position_of(world, particle), (vec3){p[0], p[1], p[2]})), 1e-3);
        assert_true(particle <= highest);
        highest += particle == highest;
    }
    assert_int_equal(highest, 8);
    skein_world_destroy(world);

    // too small a distance joins nothing
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("weld", 1e-7)));
    assert_int_equal(skein_particle_count(world), 24);
    skein_world_destroy(world);
    free(d);

    // a face that falls together keeps its place in the surface, without springs of its own
    d = upright(2, 3, false);
    d->positions[3 * 2] = d->positions[3 * 1] + 1e-9, d->positions[3 * 5] = d->positions[3 * 4] + 1e-9;
    world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("weld", 1e-6)));
    assert_int_equal(skein_particle_count(world), 4);
    assert_int_equal(springs(world, "stretch"), 4);
    assert_string_equal(n.text, "cloth: 1 face without an area, such as face 1; they add no mass\n");
    assert_springs_are_sound(world);
    skein_world_destroy(world);
    free(d);

    // a quad of which two corners join, in the middle of its list or over its end, is a triangle
    for (uint32_t moved = 1; moved < 4; moved += 2) {
        d = upright(2, 2, false); // corners 0, 2, 3, 1
        memcpy(d->positions + 3 * moved, d->positions + 3 * (moved - 1), 3 * sizeof *d->positions);
        world = world_with_notes(&n);
        build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("weld", 1e-6), SKEIN_REAL("density", 6)));
        assert_string_equal(n.text, "");
        assert_int_equal(skein_particle_count(world), 3);
        assert_true(springs(world, "stretch") == 3 && springs(world, "shear") == 0);
        for (size_t i = 0; i < 3; i++) assert_share(mass_of(world, i), 1, 4 * EPSILON);
        skein_world_destroy(world);
        free(d);
    }

    // near two others, a vertex joins the first; those two stay apart
    d = upright(2, 3, false);
    static const double places[3] = {0, 1.5, 0.75};
    for (size_t v = 0; v < 6; v++) d->positions[3 * v] = places[v % 3];
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("weld", 0.9)));
    OK(world, skein_body_surface(world, skein_object_at(world, SKEIN_BODY, 0), &surface));
    assert_int_equal(skein_particle_count(world), 4);
    assert_true(surface.particle_of_vertex[2] == 0 && surface.particle_of_vertex[1] == 1 &&
                surface.particle_of_vertex[5] == 2);
    skein_world_destroy(world);
    free(d);
}

/* What has no area is a matter of shape, not of size: a sheet of a thousandth of a millimetre is a sheet. */
static void small_sheets_are_sheets(void **state) {
    (void)state;
    notes n;
    draft *d = upright(3, 3, true);
    skein_world *world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("scale", 1e-6), SKEIN_REAL("density", 1)));
    assert_string_equal(n.text, "");
    double mass = 0;
    for (size_t i = 0; i < 9; i++) mass += mass_of(world, i);
    assert_share(mass, 1e-12, 1e-5);
    skein_world_destroy(world);
    free(d);
}

/* ---- Faults ------------------------------------------------------------------------------------- */

static void faults_of_meshes_are_warnings(void **state) {
    (void)state;
    notes n;
    // three faces on the edge 0-1
    draft *d = calloc(1, sizeof *d);
    vertex(d, 0, 0, 0), vertex(d, 1, 0, 0), vertex(d, 0, 1, 0), vertex(d, 0, -1, 0), vertex(d, 0, 0, 1);
    FACE(d, 0, 1, 2);
    FACE(d, 1, 0, 3);
    FACE(d, 0, 1, 4);
    skein_world *world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("name", "fin")));
    assert_string_equal(n.text, "fin: 1 edge with three faces or more, such as 0-1; they get no bending\n");
    assert_int_equal(n.warnings, 1);
    assert_int_equal(springs(world, "bend"), 0);
    skein_world_destroy(world);

    // a face without an area, and a vertex of no face: both stay, one without mass
    memset(d, 0, sizeof *d);
    vertex(d, 0, 0, 0), vertex(d, 1, 0, 0), vertex(d, 0, 1, 0), vertex(d, 0.5, 0, 0), vertex(d, 9, 9, 9);
    FACE(d, 0, 1, 2);
    FACE(d, 1, 0, 3);
    world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_non_null(strstr(n.text, "cloth: 1 face without an area, such as face 1; they add no mass\n"));
    assert_non_null(strstr(n.text, "2 vertices are of no face, such as 3; without a mass they stay where they are\n"));
    assert_int_equal(n.warnings, 2);
    assert_true(is_held(world, 4) && is_held(world, 3) && !is_held(world, 0));
    add_gravity(world);
    steps(world, 10, 1.0 / 90);
    assert_under(length3(minus(position_of(world, 4), (vec3){9, 9, 9})), 0);
    assert_int_equal(statistics_of(world).nonfinite, 0);
    skein_world_destroy(world);

    // a sliver, as scanners leave them
    memset(d, 0, sizeof *d);
    vertex(d, 0, 0, 0), vertex(d, 1, 0, 0), vertex(d, 1, 1, 0), vertex(d, 0, 1, 0), vertex(d, 0.02, 1, 0);
    FACE(d, 0, 1, 2);
    FACE(d, 0, 2, 4);
    FACE(d, 0, 4, 3);
    world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_string_equal(
        n.text, "cloth: 1 edge is shorter than a tenth of the mean, which is 0.92 m, such as 3-4 with 0.02 m; such are "
                "stretched most: weld (a distance, such as 0.09) joins what is nearer\n");
    skein_world_destroy(world);

    // two squares beside each other whose common border was never joined
    memset(d, 0, sizeof *d);
    for (int k = 0; k < 2; k++) vertex(d, k, 0, 0), vertex(d, k + 1, 0, 0), vertex(d, k + 1, 1, 0), vertex(d, k, 1, 0);
    FACE(d, 0, 1, 2, 3);
    FACE(d, 4, 5, 6, 7);
    world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_non_null(strstr(n.text, "cloth: 2 parts that do not touch"));
    assert_non_null(strstr(n.text, "cloth: 2 border vertices lie on another one"));
    assert_non_null(strstr(n.text, "weld"));
    assert_int_equal(n.warnings, 2);
    skein_world_destroy(world);
    world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("weld", 1e-6)));
    assert_string_equal(n.text, "");
    skein_world_destroy(world);

    // three such sheets, far apart: parts, but no seams; and without a log nobody minds
    for (int k = 4; k < 8; k++) d->positions[3 * k] += 5;
    world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_non_null(strstr(n.text, "2 parts that do not touch; a second one has vertex 4"));
    assert_int_equal(n.warnings, 1);
    skein_world_destroy(world);
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    skein_world_destroy(world);

    // sheets that cross each other inside touch nowhere that matters
    memset(d, 0, sizeof *d);
    draft *square = upright(3, 3, false);
    for (int k = 0; k < 2; k++)
        for (size_t v = 0; v < 9; v++) {
            double x = square->positions[3 * v] - 0.5, y = square->positions[3 * v + 1] - 0.5, turn = k ? sqrt(0.5) : 0;
            vertex(d, k ? turn * (x - y) : x, k ? turn * (x + y) : y, 0);
        }
    for (uint32_t f = 0; f < 8; f++) {
        uint32_t a = f / 4 * 9 + f % 4 / 2 * 3 + f % 2;
        FACE(d, a, a + 3, a + 4, a + 1);
    }
    world = world_with_notes(&n);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_non_null(strstr(n.text, "cloth: 2 parts that do not touch"));
    assert_int_equal(n.warnings, 1);
    skein_world_destroy(world);
    free(square);

    // a sound mesh is met with silence
    draft *sound = upright(5, 5, true);
    world = world_with_notes(&n);
    build(world, sound, SKEIN_SETTINGS(BY_SPRINGS));
    assert_string_equal(n.text, "");
    skein_world_destroy(world);
    free(sound);
    free(d);
}

static void impossible_meshes_are_refused(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    draft *d = upright(3, 3, false);
    skein_mesh mesh = mesh_of(d);
    mesh.face_count = 0, mesh.face_vertex_count = 0;
    FAILS(world, SKEIN_ERROR_MESH, "vertices and faces", skein_body_add(world, "cloth", &mesh, NULL, NULL));
    mesh = mesh_of(d), mesh.vertex_count = 0;
    FAILS(world, SKEIN_ERROR_MESH, "vertices and faces", skein_body_add(world, "cloth", &mesh, NULL, NULL));
    mesh = mesh_of(d), mesh.vertex_count = 8;
    FAILS(world, SKEIN_ERROR_MESH, "face 3 names vertex 8, but there are only 8",
          skein_body_add(world, "cloth", &mesh, NULL, NULL));
    d->sizes[1] = 2;
    FAILS(world, SKEIN_ERROR_MESH, "face 1 has 2 corners", skein_body_add(world, "cloth", &mesh, NULL, NULL));
    d->sizes[1] = 400;
    FAILS(world, SKEIN_ERROR_MESH, "face 1 has 400 corners", skein_body_add(world, "cloth", &mesh, NULL, NULL));
    d->sizes[1] = 4;
    mesh = mesh_of(d), mesh.face_count = 3;
    FAILS(world, SKEIN_ERROR_MESH, "4 corners belong to no face", skein_body_add(world, "cloth", &mesh, NULL, NULL));
    mesh = mesh_of(d);
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e300};
    for (size_t i = 0; i < COUNT(bad); i++) {
        d->positions[3 * 4 + 1] = bad[i];
        FAILS(world, SKEIN_ERROR_MESH, "vertex 4", skein_body_add(world, "cloth", &mesh, NULL, NULL));
    }
    d->positions[3 * 4 + 1] = 0.5;
    FAILS(world, SKEIN_ERROR_VALUE, "not both",
          skein_body_add(world, "cloth", &mesh, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 3, 3)), NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "a mesh or a grid", skein_body_add(world, "cloth", NULL, NULL, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "1 x 5",
          skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 1, 5)), NULL));
    // nothing of all that stayed, and the world is as good as new
    assert_int_equal(skein_particle_count(world), 0);
    assert_int_equal(skein_object_count(world, SKEIN_BODY), 0);
    assert_int_equal(statistics_of(world).constraints, 0);
    OK(world, skein_body_add(world, "cloth", &mesh, NULL, NULL));
    assert_int_equal(skein_particle_count(world), 9);
    skein_world_destroy(world);
    free(d);
}

/* ---- Pins --------------------------------------------------------------------------------------- */

/* The pinned particles, as a line of numbers. */
static void list_held(const skein_world *world, char *text, size_t size) {
    text[0] = 0;
    for (size_t i = 0; i < skein_particle_count(world); i++)
        if (is_held(world, i)) snprintf(text + strlen(text), size - strlen(text), "%zu ", i);
}

/* Builds with these pins, from the mesh or (NULL) as a grid of 3 x 4, and compares the list. */
static void assert_pins(const draft *d, const char *pins, const char *held) {
    skein_world *world = new_world("xpbd", 1);
    skein_mesh mesh;
    if (d) mesh = mesh_of(d);
    OK(world, skein_body_add(world, "cloth", d ? &mesh : NULL,
                             d ? SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("pins", pins))
                               : SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 3, 4), SKEIN_PAIR("size", 3, 2),
                                                SKEIN_TEXT("pins", pins)),
                             NULL));
    char text[512];
    list_held(world, text, sizeof text);
    assert_string_equal(text, held);
    skein_world_destroy(world);
}

static void assert_no_pins(const draft *d, const char *pins, skein_status status, const char *words) {
    skein_world *world = new_world("xpbd", 1);
    skein_mesh mesh;
    if (d) mesh = mesh_of(d);
    skein_status is = skein_body_add(world, "cloth", d ? &mesh : NULL,
                                     d ? SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("pins", pins))
                                       : SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 3, 4), SKEIN_TEXT("pins", pins)),
                                     NULL);
    const skein_error *error = skein_world_error(world);
    if (is != status || !strstr(error->message, words)) fprintf(stderr, "'%s': %s\n", pins, error->message);
    assert_int_equal(is, status);
    assert_non_null(strstr(error->message, words));
    assert_string_equal(error->where, "pins");
    assert_int_equal(skein_particle_count(world), 0);
    skein_world_destroy(world);
}

/* Pages of a book: where two meet there is a hinge; three or four at one edge have no angle between two of them, and
 * none. */
static void only_two_faces_make_a_hinge(void **state) {
    (void)state;
    static const double p[][3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.2}, {0, 0, 1}, {0.1, 0, -1}};
    static const uint32_t sizes[] = {3, 3, 3, 3}, corners[] = {0, 1, 2, 1, 0, 3, 0, 1, 4, 1, 0, 5};
    for (size_t pages = 1; pages <= 4; pages++) {
        const skein_mesh mesh = {p[0], 2 + pages, sizes, pages, corners, 3 * pages};
        skein_world *world = new_world("xpbd", 1);
        skein_handle cloth;
        size_t edges;
        OK(world, skein_body_add(world, "cloth", &mesh, NULL, &cloth));
        OK(world, skein_body_elements(world, cloth, SKEIN_EDGES, NULL, 0, &edges));
        assert_int_equal(edges, 1 + 2 * pages);
        assert_int_equal(statistics_of(world).constraints - edges, pages == 2);
        skein_world_destroy(world);
    }
}

/*   0  1  2  3      the grid's vertices; x to the right from -1.5 to 1.5, z down from -1 to 1
 *   4  5  6  7
 *   8  9 10 11  */
static void pins_of_a_grid(void **state) {
    (void)state;
    assert_pins(NULL, "", "");
    assert_pins(NULL, "corners", "0 3 8 11 ");
    assert_pins(NULL, "top corners", "0 3 ");
    assert_pins(NULL, "bottom corners", "8 11 ");
    assert_pins(NULL, "left corners", "0 8 ");
    assert_pins(NULL, "right corners", "3 11 ");
    assert_pins(NULL, "top edge", "0 1 2 3 ");
    assert_pins(NULL, "bottom edge", "8 9 10 11 ");
    assert_pins(NULL, "left edge", "0 4 8 ");
    assert_pins(NULL, "right edge", "3 7 11 ");
    assert_pins(NULL, "border", "0 1 2 3 4 7 8 9 10 11 ");
    assert_pins(NULL, "all", "0 1 2 3 4 5 6 7 8 9 10 11 ");
    assert_pins(NULL, "5", "5 ");
    assert_pins(NULL, "  7 0   10 ", "0 7 10 ");
    assert_pins(NULL, "-1 -12", "0 11 ");
    assert_pins(NULL, "4..6", "4 5 6 ");
    assert_pins(NULL, "0 7..7 9..-1", "0 7 9 10 11 ");
    assert_pins(NULL, "box -2 -1 -2  -1.4 1 2", "0 4 8 ");
    assert_pins(NULL, "box -1.4 1 2  -2 -1 -2", "0 4 8 ");   // corners in any order
    assert_pins(NULL, "box -0.5 0 -1  0.5 0 0", "1 2 5 6 "); // its own border is inside
    assert_pins(NULL, "sphere 0.5 0 0  1.01", "2 5 6 7 10 ");
    assert_pins(NULL, "sphere 0 0 0 0.5", "5 6 ");
    assert_pins(NULL, "sphere 0 0 0 1.15", "1 2 5 6 9 10 "); // the corners of 1 x 2 are 1.118 away
    assert_pins(NULL, "top corners, 9, sphere -0.5 0 0 0.1,", "0 3 5 9 ");
    assert_no_pins(NULL, "top cornres", SKEIN_ERROR_NAME, "did you mean 'top corners'?");
    assert_no_pins(NULL, "upper left", SKEIN_ERROR_NAME, "names no part of a cloth");
    assert_no_pins(NULL, "12", SKEIN_ERROR_VALUE, "vertex 12 is out of range: the mesh has 12, 0 to 11");
    assert_no_pins(NULL, "0 -13", SKEIN_ERROR_VALUE, "vertex -13 is out of range");
    assert_no_pins(NULL, "99999999999999999999", SKEIN_ERROR_VALUE, "out of range");
    assert_no_pins(NULL, "1.5", SKEIN_ERROR_VALUE, "expected whole numbers");
    assert_no_pins(NULL, "6..4", SKEIN_ERROR_VALUE, "expected a first number .. a last one");
    assert_no_pins(NULL, "1..2..3", SKEIN_ERROR_VALUE, "expected a first number .. a last one");
    assert_no_pins(NULL, "4..", SKEIN_ERROR_VALUE, "expected whole numbers");
    assert_no_pins(NULL, "4..12", SKEIN_ERROR_VALUE, "vertex 12 is out of range");
    assert_no_pins(NULL, "3 four", SKEIN_ERROR_VALUE, "expected whole numbers");
    assert_no_pins(NULL, "box 1 2 3", SKEIN_ERROR_VALUE, "expected box and 6 numbers");
    assert_no_pins(NULL, "box 1 2 3 4 5 six", SKEIN_ERROR_VALUE, "expected box and 6 numbers");
    assert_no_pins(NULL, "box 0 0 0 1 1", SKEIN_ERROR_VALUE, "expected box and 6 numbers");
    assert_no_pins(NULL, "box 0 0 0 1 1 1 1", SKEIN_ERROR_VALUE, "expected box and 6 numbers");
    assert_no_pins(NULL, "box -inf 0 0 1 1 1", SKEIN_ERROR_VALUE, "expected box and 6 numbers");
    char crowd[2000] = "box"; // more than any place for numbers holds
    for (size_t i = 3; i + 2 < sizeof crowd; i += 2) memcpy(crowd + i, " 1", 3);
    assert_no_pins(NULL, crowd, SKEIN_ERROR_VALUE, "expected box and 6 numbers");
    assert_no_pins(NULL, "sphere 1 2 3", SKEIN_ERROR_VALUE, "expected sphere and 4 numbers");
    assert_no_pins(NULL, "sphere 1 2 3 4 5", SKEIN_ERROR_VALUE, "expected sphere and 4 numbers");
    assert_no_pins(NULL, "sphere 0 0 0 nan", SKEIN_ERROR_VALUE, "expected sphere and 4 numbers");
    assert_no_pins(NULL, "box 5 5 5 6 6 6", SKEIN_ERROR_VALUE, "no particle is in there");
    assert_no_pins(NULL, "corners, sphere 0 9 0 0.1", SKEIN_ERROR_VALUE, "no particle is in there");
}

static void pins_of_a_mesh(void **state) {
    (void)state;
    // upright, the first row on top, in triangles and quads
    for (int triangles = 0; triangles < 2; triangles++) {
        draft *d = upright(3, 4, triangles);
        assert_pins(d, "corners", "0 3 8 11 ");
        assert_pins(d, "top corners", "0 3 ");
        assert_pins(d, "bottom corners", "8 11 ");
        assert_pins(d, "left corners", "0 8 ");
        assert_pins(d, "right corners", "3 11 ");
        assert_pins(d, "top edge", "0 1 2 3 ");
        assert_pins(d, "bottom edge", "8 9 10 11 ");
        assert_pins(d, "left edge", "0 4 8 ");
        assert_pins(d, "right edge", "3 7 11 ");
        assert_pins(d, "border", "0 1 2 3 4 7 8 9 10 11 ");
        assert_pins(d, "all", "0 1 2 3 4 5 6 7 8 9 10 11 ");
        assert_pins(d, "box -1 0.9 -1 2 2 1", "0 1 2 3 ");
        // lying flat it has no top; but it still has a left
        for (size_t v = 0; v < d->vertices; v++) {
            double *p = d->positions + 3 * v;
            p[2] = 1 - p[1], p[1] = 0;
        }
        assert_no_pins(d, "top edge", SKEIN_ERROR_MESH, "lies flat, its border has no top");
        assert_no_pins(d, "bottom corners", SKEIN_ERROR_MESH, "lies flat, its border has no bottom");
        assert_pins(d, "left edge", "0 4 8 ");
        assert_pins(d, "corners", "0 3 8 11 ");
        free(d);
    }
    // a disc: a border, but it turns nowhere
    draft *d = calloc(1, sizeof *d);
    uint32_t hub = vertex(d, 0, 0, 0);
    for (int k = 0; k < 24; k++) vertex(d, cos(k * PI / 12), sin(k * PI / 12), 0);
    for (uint32_t k = 0; k < 24; k++) FACE(d, hub, 1 + k, 1 + (k + 1) % 24);
    assert_no_pins(d, "corners", SKEIN_ERROR_MESH, "border is round");
    assert_no_pins(d, "top corners", SKEIN_ERROR_MESH, "border is round");
    assert_pins(d, "top edge", "7 ");
    assert_pins(d, "-1, 0", "0 24 ");
    free(d);
    // a cube is closed once it is welded; numbers still count vertices
    d = loose_cube();
    skein_mesh mesh = mesh_of(d);
    skein_world *world = new_world("xpbd", 1);
    static const char *const words[] = {"corners", "border", "top edge", "left corners"};
    for (size_t i = 0; i < COUNT(words); i++)
        FAILS(world, SKEIN_ERROR_MESH, "closed",
              skein_body_add(world, "cloth", &mesh,
                             SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("weld", 1e-6), SKEIN_TEXT("pins", words[i])), NULL));
    OK(world, skein_body_add(world, "cloth", &mesh,
                             SKEIN_SETTINGS(BY_SPRINGS, SKEIN_REAL("weld", 1e-6), SKEIN_TEXT("pins", "23 22")), NULL));
    skein_surface surface;
    OK(world, skein_body_surface(world, skein_object_at(world, SKEIN_BODY, 0), &surface));
    assert_int_equal(statistics_of(world).pinned_particles, 2);
    assert_true(is_held(world, surface.particle_of_vertex[23]) && is_held(world, surface.particle_of_vertex[22]));
    skein_world_destroy(world);
    free(d);
}

/* ---- Tethers ------------------------------------------------------------------------------------ */

static const sk_limit *tethers_of(const skein_world *world) {
    for (size_t i = 0; i < world->rules.limits.count; i++)
        if (!strcmp(world->rules.limits.data[i]->label, "tethers")) return world->rules.limits.data[i];
    return NULL;
}

/* On a flat sheet every tether is as long as the straight line to its anchor. `anchors`: of each particle. */
static void assert_straight_tethers(const skein_world *world, size_t anchors) {
    const sk_limit *limit = tethers_of(world);
    assert_non_null(limit);
    assert_int_equal(limit->anchors, anchors);
    assert_int_equal(limit->count,
                     skein_particle_count(world) - statistics_of((skein_world *)(uintptr_t)world).pinned_particles);
    for (size_t e = 0; e < limit->count; e++) {
        const uint32_t *particle = limit->particle + e * (1 + anchors);
        for (size_t k = 1; k <= anchors; k++) {
            assert_true(is_held(world, particle[k]));
            double straight = length3(minus(position_of(world, particle[0]), position_of(world, particle[k])));
            assert_near((double)limit->length[e * anchors + k - 1], straight, 1e-6);
        }
    }
}

static void tethers_of_a_flat_sheet_are_straight(void **state) {
    (void)state;
    static const struct {
        const char *pins;
        size_t anchors;
    } holds[] = {{"0", 1}, {"top corners", 2}, {"corners", 4}, {"210", 1}, {"37 140 201", 3}};
    static const double turns[][3] = {{0, 0, 0}, {90, 0, 0}, {31, 12, -55}};
    for (size_t i = 0; i < COUNT(holds); i++)
        for (size_t t = 0; t < COUNT(turns); t++) {
            skein_world *world = new_world("xpbd", 1);
            OK(world, skein_body_add(world, "cloth", NULL,
                                     SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 14, 19),
                                                    SKEIN_PAIR("size", 1.3, 0.7), SKEIN_TEXT("pins", holds[i].pins),
                                                    SKEIN_VEC3("rotation", turns[t][0], turns[t][1], turns[t][2])),
                                     NULL));
            assert_straight_tethers(world, holds[i].anchors);
            skein_world_destroy(world);
        }
    // the same read as a mesh, in quads and in triangles
    for (int triangles = 0; triangles < 2; triangles++)
        for (size_t i = 0; i < COUNT(holds); i++) {
            draft *d = upright(15, 17, triangles);
            skein_world *world = new_world("xpbd", 1);
            build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("pins", holds[i].pins)));
            assert_straight_tethers(world, holds[i].anchors);
            skein_world_destroy(world);
            free(d);
        }
}

/* A whole edge holds by the nearest pin: straight down. */
static void tethers_to_an_edge_go_to_the_nearest_pin(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        skein_world *world = new_world("xpbd", 1);
        draft *d = upright(12, 10, kind == 2);
        if (kind) build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("pins", "top edge")));
        else
            OK(world,
               skein_body_add(world, "cloth", NULL,
                              SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 12, 10), SKEIN_TEXT("pins", "top edge")),
                              NULL));
        assert_straight_tethers(world, 1);
        const sk_limit *limit = tethers_of(world);
        for (size_t e = 0; e < limit->count; e++)
            assert_int_equal(limit->particle[2 * e] % 10, limit->particle[2 * e + 1]);
        skein_world_destroy(world);
        free(d);
    }
}

/* Many pins strewn over a grid of oblong cells: each particle is tied to the nearest one, found here by trying all. */
static void tethers_of_a_grid_go_to_the_nearest_of_many(void **state) {
    (void)state;
    static const double sizes[][2] = {{1.3, 0.7}, {0.2, 2}, {3, 0.1}};
    for (size_t t = 0; t < COUNT(sizes); t++) {
        skein_world *world = new_world("xpbd", 1);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 23, 17),
                                                SKEIN_PAIR("size", sizes[t][0], sizes[t][1]),
                                                SKEIN_VEC3("rotation", 31, 12, -55),
                                                SKEIN_TEXT("pins", "40 41 77 78 112 200 205 261 311 340")),
                                 NULL));
        assert_straight_tethers(world, 1);
        const sk_limit *limit = tethers_of(world);
        for (size_t e = 0; e < limit->count; e++)
            for (uint32_t pin = 0; pin < 23 * 17; pin++) {
                double way = length3(minus(position_of(world, limit->particle[2 * e]), position_of(world, pin)));
                if (is_held(world, pin)) assert_true((double)limit->length[e] < way + 1e-6);
            }
        skein_world_destroy(world);
    }
}

/* Along a fold the way is that of the sheet before it was folded, not the short cut through the air. */
static void tethers_follow_folds(void **state) {
    (void)state;
    draft *d = upright(11, 13, true), *flat = upright(11, 13, true);
    for (size_t v = 0; v < d->vertices; v++) {
        double *p = d->positions + 3 * v, over = p[0] - 0.5; // folded by 120 degrees along x = 0.5
        if (over > 0) p[0] = 0.5 - over * 0.5, p[2] = over * sqrt(0.75);
    }
    skein_world *world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("pins", "0")));
    const sk_limit *limit = tethers_of(world);
    for (size_t e = 0; e < limit->count; e++) {
        const double *p = flat->positions + 3 * limit->particle[2 * e], *o = flat->positions;
        assert_near((double)limit->length[e], hypot(p[0] - o[0], p[1] - o[1]), 1e-6);
    }
    skein_world_destroy(world);
    free(d);
    free(flat);
}

/* Around the inner corner of an L the way bends there; there is no short cut through the missing quarter. */
static void tethers_go_around_corners(void **state) {
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        enum { SIDE = 13 };
        draft *whole = upright(SIDE, SIDE, triangles), *d = calloc(1, sizeof *d);
        memcpy(d->positions, whole->positions, sizeof d->positions);
        d->vertices = whole->vertices;
        for (size_t f = 0, from = 0; f < whole->faces; from += whole->sizes[f++]) {
            const uint32_t *c = whole->corners + from;
            double x = 0, y = 0;
            for (uint32_t k = 0; k < whole->sizes[f]; k++) {
                x += d->positions[3 * c[k]] / whole->sizes[f];
                y += d->positions[3 * c[k] + 1] / whole->sizes[f];
            }
            if (x < 0.5 || y < 0.5) face(d, whole->sizes[f], c); // the upper right quarter is missing
        }
        skein_world *world = new_world("xpbd", 1);
        build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("pins", "6"))); // (0.5, 1), where the cut begins
        const sk_limit *limit = tethers_of(world);
        const double *pin = d->positions + 3 * 6;
        size_t behind = 0;
        for (size_t e = 0; e < limit->count; e++) {
            const double *p = d->positions + 3 * limit->particle[2 * e];
            bool hidden = p[0] > 0.5 && (1 - p[1]) > 0; // right of the corner at (0.5, 0.5)
            double straight = hypot(p[0] - pin[0], p[1] - pin[1]), around = 0.5 + hypot(p[0] - 0.5, p[1] - 0.5);
            double ought = hidden ? around : straight;
            assert_near((double)limit->length[e], ought, 0.02 * ought);
            assert_true((double)limit->length[e] > ought - 1e-6);
            behind += hidden;
        }
        assert_int_equal(behind, 6 * 7);
        skein_world_destroy(world);
        free(whole);
        free(d);
    }
}

/* On a sheet that bulges no way is exact; but left and right are alike: quads are cut both ways. */
static void tethers_do_not_prefer_a_diagonal(void **state) {
    (void)state;
    enum { SIDE = 12 };
    draft *d = upright(SIDE, SIDE, false);
    for (size_t v = 0; v < d->vertices; v++) {
        double *p = d->positions + 3 * v;
        p[2] = p[0] * (1 - p[0]) * (1 + p[1]);
    }
    skein_world *world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("pins", "top corners")));
    const sk_limit *limit = tethers_of(world);
    double length[2][SIDE * SIDE] = {{0}, {0}};
    for (size_t e = 0; e < limit->count; e++)
        for (size_t k = 0; k < 2; k++)
            length[limit->particle[3 * e + 1 + k] ? 1 : 0][limit->particle[3 * e]] = (double)limit->length[2 * e + k];
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        size_t mirrored = i / SIDE * SIDE + SIDE - 1 - i % SIDE;
        assert_near(length[0][i], length[1][mirrored], 1e-6);
    }
    skein_world_destroy(world);
    free(d);
}

/* Parts without a pin hang on nothing; without pins there are no tethers at all. */
static void tethers_need_a_way(void **state) {
    (void)state;
    draft *d = upright(3, 3, false);
    for (int k = 0; k < 4; k++) vertex(d, 5 + (k == 1 || k == 2), 5 + (k > 1), 0);
    FACE(d, 9, 10, 11, 12);
    skein_world *world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS, SKEIN_TEXT("pins", "0 2")));
    add_gravity(world);
    steps(world, 90, 1.0 / 90);
    assert_near(position_of(world, 10).y, 5 - 9.81 * 90 * 91 / 2 / 8100, 1e-3); // falls freely
    assert_true(position_of(world, 8).y > -0.02);
    skein_world_destroy(world);
    world = new_world("xpbd", 1);
    build(world, d, SKEIN_SETTINGS(BY_SPRINGS));
    assert_null(tethers_of(world));
    skein_world_destroy(world);
    free(d);
}

/* ---- Spans ---- */

/* A disc of a metre across in the xz-plane: a vertex in the middle and rings of 6, 12, 18 ... around it. No grid. */
static draft *disc(uint32_t rings) {
    draft *d = calloc(1, sizeof *d);
    vertex(d, 0, 0, 0);
    for (uint32_t r = 1, inner = 0, first = 1; r <= rings; r++) {
        uint32_t count = 6 * r, inner_count = r > 1 ? count - 6 : 1;
        for (uint32_t k = 0; k < count; k++) {
            double turn = 2 * acos(-1) * k / count;
            vertex(d, 0.5 * r / rings * cos(turn), 0, 0.5 * r / rings * sin(turn));
        }
        for (uint32_t side = 0, i = 0, o = 0; side < 6; side++)
            for (uint32_t k = 0; k < r; k++) {
                FACE(d, inner + i % inner_count, first + (o + 1) % count, first + o);
                o++;
                if (k + 1 == r) break;
                FACE(d, inner + i % inner_count, inner + (i + 1) % inner_count, first + o % count);
                i++;
            }
        inner = first, first += count;
    }
    return d;
}

/* Calls for every span: on a flat mesh it is as long as it looks, on a rolled one as it was before, not as the chord. */
static void check_spans(const skein_world *world, const draft *flat, double edge, double nearly) {
    size_t count = 0, of_particle[2000] = {0};
    for (size_t b = 0; b < world->rules.batches.count; b++) {
        const sk_batch *batch = world->rules.batches.data[b];
        if (strcmp(batch->label, "span")) continue;
        for (size_t e = 0; e < batch->count; e++, count++) {
            uint32_t i = batch->particle[2 * e], j = batch->particle[2 * e + 1];
            const double *p = flat->positions + 3 * i, *q = flat->positions + 3 * j;
            double apart = hypot(p[0] - q[0], p[2] - q[2]);
            assert_near((double)batch->rest[e], apart, nearly * apart);
            assert_true(apart > 3 * edge && apart < 26 * edge);
            of_particle[i]++, of_particle[j]++;
        }
    }
    assert_true(count > flat->vertices * 3); // two walks of 5 edges from each, and most of those of 20
    for (size_t i = 0; i < flat->vertices; i++) assert_true(of_particle[i] > 0);
}

static void spans_of_a_mesh_are_as_long_as_the_way(void **state) {
    (void)state;
    enum { RINGS = 18 };
    draft *flat = disc(RINGS), *rolled = disc(RINGS);
    skein_world *world = new_world("xpbd", 1);
    build(world, flat, SKEIN_SETTINGS(SKEIN_TEXT("pins", "0"))); // as it lies
    check_spans(world, flat, 0.5 / RINGS, 1e-5);
    skein_world_destroy(world);
    for (size_t v = 0; v < rolled->vertices; v++) { // half around a roll
        double *p = rolled->positions + 3 * v, turn = acos(-1) * p[0];
        p[0] = sin(turn) / acos(-1), p[1] = cos(turn) / acos(-1);
    }
    world = new_world("xpbd", 1);
    build(world, rolled,
          SKEIN_SETTINGS(SKEIN_TEXT("pins", "0"), SKEIN_REAL("scale", 2), SKEIN_VEC3("rotation", 30, 40, 50)));
    for (size_t k = 0; k < 3 * flat->vertices; k++) flat->positions[k] *= 2;
    check_spans(world, flat, 1.0 / RINGS, 0.01);
    skein_world_destroy(world);
    free(flat);
    free(rolled);
}

/* Let go from level by two points of its rim. With few substeps single edges get a third longer without spans. */
static void spans_hold_a_mesh_that_swings(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    enum { RINGS = 18 };
    draft *d = disc(RINGS);
    char pins[40];
    snprintf(pins, sizeof pins, "%d %d", 1 + 3 * RINGS * (RINGS - 1), 1 + 3 * RINGS * (RINGS - 1) + 3 * RINGS);
    skein_world *world = new_world("xpbd", 3);
    build(world, d, SKEIN_SETTINGS(SKEIN_TEXT("pins", pins)));
    add_gravity(world);
    double most = 0, p99 = 0;
    for (int n = 0; n < 150; n++) {
        steps(world, 1, 1.0 / 60);
        most = fmax(most, statistics_of(world).max_stretch), p99 = fmax(p99, statistics_of(world).p99_stretch);
    }
    assert_under(most, 0.25);
    assert_under(p99, 0.125);
    skein_world_destroy(world);
    free(d);
}

/* Stretch bounds hold, whatever the springs: a sheet like rubber, under either method. */
static void stretch_bounds_are_kept(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int bound = 0; bound < 3; bound++) { // none, the limit, the tethers
            skein_world *world = new_world(method_names[m], 20);
            OK(world,
               skein_body_add(world, "cloth", NULL,
                              SKEIN_SETTINGS(BY_SPRINGS, SKEIN_PAIR("grid", 9, 9), SKEIN_TEXT("pins", "top edge"),
                                             SKEIN_VEC3("rotation", 90, 0, 0), SKEIN_REAL("stretch.stiffness", 5),
                                             SKEIN_REAL("shear.stiffness", 1), SKEIN_REAL("bend.stiffness", 0),
                                             SKEIN_REAL("stretch.limit", bound == 1 ? 0.03 : INFINITY),
                                             SKEIN_REAL("stretch.tether", bound == 2 ? 0.02 : INFINITY)),
                              NULL));
            add_gravity(world);
            OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 3)), NULL));
            steps(world, 300, 1.0 / 90);
            skein_statistics s = statistics_of(world);
            double lowest = 0;
            for (size_t i = 72; i < 81; i++) lowest = fmin(lowest, position_of(world, i).y + 0.5);
            assert_true(s.p99_stretch <= s.max_stretch);
            if (bound == 0) assert_true(s.max_stretch > 0.2 && lowest < -0.15);
            if (bound == 1) assert_true(s.max_stretch < 0.06 && s.max_stretch > 0.025);
            if (bound == 2) assert_near(lowest, -0.02, 1e-4);
            skein_world_destroy(world);
        }
}

/* Bending that is taken in every second substep comes to rest as that of every one does, however stiff it is: moves that
 * were too long for two substeps once tore such a sheet. */
static void stiff_sheets_come_to_rest(void **state) {
    (void)state;
    for (int substeps = 8; substeps < 10; substeps++)
        for (double rigidity = 0.01; rigidity < 200; rigidity *= 100) {
            skein_world *world = new_world("xpbd", substeps);
            OK(world, skein_body_add(world, "cloth", NULL,
                                     SKEIN_SETTINGS(SKEIN_PAIR("grid", 17, 17), SKEIN_TEXT("pins", "top corners"),
                                                    SKEIN_REAL("bend.rigidity", rigidity)),
                                     NULL));
            OK(world, skein_force_add(world, "gravity", NULL, NULL));
            OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 2)), NULL));
            steps(world, 180, 1.0 / 60);
            skein_statistics s = statistics_of(world);
            assert_under(s.kinetic_energy, 0.05);
            assert_under(s.max_stretch, 0.005);
            skein_world_destroy(world);
        }
}

/* A square metre of one cell, of which a corner is moved along its diagonal by `out`, with nothing to resist but shear. */
static skein_world *pulled_cell(const char *method, double out) {
    skein_world *world = new_world(method, 1);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 2, 2), SKEIN_REAL("stretch.stiffness", 0),
                                            SKEIN_REAL("density", 4), SKEIN_REAL("shear.stiffness", 30),
                                            SKEIN_TEXT("shear.diagonals", "ties"), SKEIN_REAL("bend.rigidity", 0)),
                             NULL));
    vec3 p = position_of(world, 3);
    place_particle(world, 3, p.x + out / sqrt(2), p.y, p.z + out / sqrt(2));
    return world;
}

/* Lengthened, a tied diagonal holds k d^2 / 2 with the stiffness of both, and pulls back by k d; shortened it is slack: nothing
 * moves, under any method. A tenth of a second on, the ends (1 kg each) are where an oscillator of k and half their mass is. */
static void ties_resist_being_lengthened_alone(void **state) {
    (void)state;
    static const char *const methods[] = {"explicit_euler", "symplectic_euler", "midpoint", "rk4",
                                          "leapfrog",       "backward_euler",   "xpbd",     "pbd"};
    const double k = 2 * 30, out = 0.05;
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *slack = pulled_cell(methods[m], -out), *taut = pulled_cell(methods[m], out);
        assert_near(statistics_of(slack).elastic_energy, 0, 100 * EPSILON);
        assert_near(statistics_of(taut).elastic_energy, 0.5 * k * out * out, 1e-5);
        vec3 there = position_of(slack, 3);
        steps(slack, 100, 0.001), steps(taut, 100, 0.001);
        assert_near(position_of(slack, 3).x, there.x, 10 * EPSILON);
        assert_near(statistics_of(slack).kinetic_energy, 0, 1e-9);
        double moved = hypot(position_of(taut, 3).x - 0.5, position_of(taut, 3).z - 0.5);
        if (strcmp(methods[m], "pbd") != 0) // whose stiffness goes by iterations
            assert_near(moved, 0.5 * out * (1 + cos(sqrt(2 * k) * 0.1)), 0.01 * out);
        skein_world_destroy(slack);
        skein_world_destroy(taut);
    }
}

/* Which diagonals a sheet has by its pins: ties where all are within three edges and an eighth of its extent. */
static void diagonals_go_by_the_pins(void **state) {
    (void)state;
    static const struct {
        int side;
        const char *pins, *diagonals;
        bool ties;
    } rows[] = {{33, "", "pins", false},
                {33, "0", "pins", true},
                {33, "0, 3", "pins", true},
                {33, "0, 4", "pins", false},
                {33, "top corners", "pins", false},
                {33, "top corners", "ties", true},
                {33, "0", "springs", false},
                {3, "top edge", "pins", false},
                {3, "4", "pins", true}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        skein_world *world = new_world("xpbd", 1);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", rows[i].side, rows[i].side),
                                                SKEIN_TEXT("pins", rows[i].pins),
                                                SKEIN_TEXT("shear.diagonals", rows[i].diagonals)),
                                 NULL));
        assert_near(share_of(world, "shear", 0, (uint32_t)rows[i].side + 1), rows[i].ties ? 2 : 1, 1e-4);
        skein_world_destroy(world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_have_edges_and_bending_pairs),
        cmocka_unit_test(a_grid_has_edges_diagonals_and_straight_bending),
        cmocka_unit_test(no_pair_gets_two_springs),
        cmocka_unit_test(springs_share_the_material_by_area),
        cmocka_unit_test(ties_resist_being_lengthened_alone),
        cmocka_unit_test(diagonals_go_by_the_pins),
        cmocka_unit_test(mass_is_density_times_area),
        cmocka_unit_test(a_sheet_is_placed_as_asked),
        cmocka_unit_test(welding_joins_particles_and_keeps_vertices),
        cmocka_unit_test(small_sheets_are_sheets),
        cmocka_unit_test(faults_of_meshes_are_warnings),
        cmocka_unit_test(impossible_meshes_are_refused),
        cmocka_unit_test(only_two_faces_make_a_hinge),
        cmocka_unit_test(pins_of_a_grid),
        cmocka_unit_test(pins_of_a_mesh),
        cmocka_unit_test(tethers_of_a_flat_sheet_are_straight),
        cmocka_unit_test(tethers_to_an_edge_go_to_the_nearest_pin),
        cmocka_unit_test(tethers_of_a_grid_go_to_the_nearest_of_many),
        cmocka_unit_test(tethers_follow_folds),
        cmocka_unit_test(tethers_go_around_corners),
        cmocka_unit_test(tethers_do_not_prefer_a_diagonal),
        cmocka_unit_test(tethers_need_a_way),
        cmocka_unit_test(spans_of_a_mesh_are_as_long_as_the_way),
        cmocka_unit_test(spans_hold_a_mesh_that_swings),
        cmocka_unit_test(stretch_bounds_are_kept),
        cmocka_unit_test(stiff_sheets_come_to_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
