/* Panels of flat sheets that lie spread out are left out of searches: that changes no bit, however sheets swing, fold and meet.
 * Worlds are run with it and without. (What is left out is held against all pairs in test_near_pairs.c, too.) */
#include "irregular.h"
#include "near_pairs.h"

enum { FRAMES = !PLAIN ? 8 : 40, SIDE = !PLAIN ? 30 : 50 };

/* How many panels were out and not, over a run, and how often some came in. */
typedef struct tally {
    size_t out, in, came;
} tally;

typedef void scene(skein_world *world);

static void add_contact(skein_world *world, double thickness) {
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", thickness)), NULL));
}

/* Moves what it has made as a program would, in the midst of a run: a sheet is narrower, and has waves. */
static void move_by_hand(skein_world *world) {
    size_t count = skein_particle_count(world);
    double *x = malloc(3 * count * sizeof *x);
    OK(world, skein_positions_copy(world, 0, count, x));
    for (size_t i = 0; i < count; i++) x[3 * i] *= 0.8, x[3 * i + 1] += 0.03 * sin(20 * x[3 * i]);
    OK(world, skein_positions_set(world, 0, count, x));
    free(x);
}

/* How panels go out: never, where it pays, or wherever they may. */
typedef enum going { NEVER, MOST, EAGER } going;

static uint64_t hash_of(scene *make, int substeps, int threads, going how, bool moved, tally *all) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    add_gravity(world);
    make(world);
    assert_int_equal(statistics_of(world).crossings, 0); // which makes ready what contact keeps
    assert_true(touch_of(world)->spread.count > 4);
    touch_of(world)->spread.never = how == NEVER;
    touch_of(world)->spread.eager = how == EAGER;
    size_t before = 0;
    for (int i = 0; i < FRAMES; i++) {
        if (moved && i == FRAMES / 2) move_by_hand(world);
        steps(world, 1, 1.0 / 60);
        const sk_spread *spread = &touch_of(world)->spread;
        all->out += spread->out_count, all->in += spread->count - spread->out_count;
        all->came += spread->out_count < before;
        before = spread->out_count;
    }
    assert_int_equal(statistics_of(world).crossings, 0);
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

/* With it and without, by one thread and two: the same bits. Of all panels, at least such a share was out. */
static tally check(scene *make, int substeps, bool moved, double share) {
    tally none = {0, 0, 0}, most = none, one = none, two = none;
    uint64_t hash = hash_of(make, substeps, 1, NEVER, moved, &none);
    assert_int_equal(none.out, 0);
    assert_true(hash_of(make, substeps, 1, MOST, moved, &most) == hash);
    assert_true(hash_of(make, substeps, 1, EAGER, moved, &one) == hash);
    assert_true(hash_of(make, substeps, 2, EAGER, moved, &two) == hash);
    assert_true(most.out <= one.out && (share < 0.6 || most.out > 0));
    assert_int_equal(one.out, two.out);
    if ((double)one.out < share * (double)(one.out + one.in)) print_message("%zu out, %zu in\n", one.out, one.in);
    assert_true((double)one.out >= share * (double)(one.out + one.in));
    return one;
}

static void add_sheet(skein_world *world, const char *pins, const double at[3], const double turned[3],
                      const double velocity[3]) {
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_TEXT("pins", pins),
                                            SKEIN_VEC3("position", at[0], at[1], at[2]),
                                            SKEIN_VEC3("rotation", turned[0], turned[1], turned[2]),
                                            SKEIN_VEC3("velocity", velocity[0], velocity[1], velocity[2])),
                             NULL));
}

static const double still[3] = {0, 0, 0};

static void hanging(skein_world *world) {
    add_contact(world, 0.004);
    add_sheet(world, "top edge", (double[]){0, 2, 0}, (double[]){90, 0, 0}, still);
}

static void what_hangs_is_out(void **state) {
    (void)state;
    tally all = check(hanging, 10, false, 1);
    assert_int_equal(all.in, 0);
}

static void swinging(skein_world *world) {
    add_contact(world, 0.004);
    add_sheet(world, "top corners", (double[]){0, 2, 0}, (double[]){0, 25, 0}, still);
}

static void what_swings_is_mostly_out(void **state) {
    (void)state;
    check(swinging, 10, false, 0.6);
    tally moved = check(swinging, 10, true, 0.4);
    assert_true(moved.came > 0);
}

static void swinging_irregular(skein_world *world) {
    add_contact(world, 0.003);
    add_irregular(
        world, !PLAIN ? 20 : 40,
        SKEIN_SETTINGS(SKEIN_TEXT("pins", !PLAIN ? "0 61" : "0 41"), SKEIN_VEC3("position", 0, 2, 0))); // two corners
}

static void meshes_are_out_too(void **state) {
    (void)state;
    check(swinging_irregular, 10, false, 0.2);
}

/* Two that fly into each other, over a plane, and a third far off. */
static void meeting(skein_world *world) {
    add_contact(world, 0.006);
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.4)), NULL));
    add_sheet(world, "", (double[]){0, 0.5, 0}, (double[]){10, 30, 5}, (double[]){0, 1, 0});
    add_sheet(world, "", (double[]){0.2, 0.8, 0.1}, (double[]){-5, 60, 12}, (double[]){-1, -3, 0});
    add_sheet(world, "left edge", (double[]){5, 2, 0}, (double[]){30, 40, 0}, still);
}

static void what_meets_comes_in(void **state) {
    (void)state;
    tally all = check(meeting, 4, false, 0.1);
    assert_true(all.came > 0 && all.in > all.out / 20);
}

static void falling(skein_world *world) {
    add_contact(world, 0.004);
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.4)), NULL));
    add_sheet(world, "", (double[]){0, 0.55, 0}, (double[]){83, 10, 0}, still);
}

static void what_folds_comes_in(void **state) {
    (void)state;
    tally all = check(falling, 8, false, 0.05);
    assert_true(!PLAIN || (all.came > 0 && all.in > all.out / 20));
}

/* A ring, cut through: what lies on both sides of the cut is far apart along the sheet, and near on its plane. */
static void cut_ring(skein_world *world) {
    enum { ROUND = 96, ACROSS = 10, COUNT = (ROUND + 1) * ACROSS, FACES = ROUND * (ACROSS - 1) };
    static double positions[COUNT][3];
    static uint32_t sizes[FACES], vertices[FACES][4];
    for (uint32_t i = 0; i <= ROUND; i++)
        for (uint32_t k = 0; k < ACROSS; k++) {
            double angle = 0.02 + (6.2832 - 0.04) * i / ROUND, r = 0.2 + 0.02 * k;
            positions[i * ACROSS + k][0] = r * cos(angle), positions[i * ACROSS + k][2] = -r * sin(angle);
        }
    for (uint32_t i = 0; i < ROUND; i++)
        for (uint32_t k = 0; k + 1 < ACROSS; k++) {
            uint32_t a = i * ACROSS + k, f = i * (ACROSS - 1) + k;
            sizes[f] = 4;
            vertices[f][0] = a, vertices[f][1] = a + 1, vertices[f][2] = a + ACROSS + 1, vertices[f][3] = a + ACROSS;
        }
    skein_mesh mesh = {.positions = positions[0],
                       .vertex_count = COUNT,
                       .face_sizes = sizes,
                       .face_count = FACES,
                       .face_vertices = vertices[0],
                       .face_vertex_count = 4 * FACES};
    add_contact(world, 0.004);
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.1)), NULL));
    OK(world,
       skein_body_add(world, "cloth", &mesh,
                      SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.4, 0), SKEIN_VEC3("rotation", 60, 20, 0)), NULL));
}

static void beside_a_cut_nobody_is_out(void **state) {
    (void)state;
    check(cut_ring, 6, false, 0);
}

/* One that stands, and one that falls on its edge from rest: with few substeps, far in each. */
static void landing(skein_world *world) {
    add_contact(world, 0.006);
    add_sheet(world, "top edge", (double[]){0, 1, 0}, (double[]){90, 0, 0}, still);
    add_sheet(world, "", (double[]){0, 1.56, 0}, (double[]){0, 20, 0}, still);
}

static void what_is_off_its_course_is_seen(void **state) {
    (void)state;
    tally all = check(landing, 4, false, 0.1);
    assert_true(all.came > 0);
}

/* ---- what is asked of a substep ---- */

/* A world of sheets that are all out, where vertices are about to go from where they are to the same places. */
static skein_world *world_about_to_go(scene *make) {
    skein_world *world = new_world("xpbd", 10);
    add_gravity(world);
    make(world);
    steps(world, 1, 1.0 / 60);
    sk_touch *touch = touch_of(world);
    assert_true(sk_spread_is_all_out(&touch->spread));
    assert_int_equal(statistics_of(world).crossings, 0); // which loads where they are
    memcpy(touch->q, touch->p, touch->skin.vertex_count * sizeof *touch->q);
    touch->common = (sk_vec3){0, 0, 0};
    touch->spread.stale = true; // where they are is looked at first
    return world;
}

static void what_stays_is_out(void **state) {
    (void)state;
    skein_world *world = world_about_to_go(hanging);
    sk_touch *touch = touch_of(world);
    assert_false(sk_spread_follow(touch, SK_REAL_MAX));
    assert_true(sk_spread_is_all_out(&touch->spread));
    skein_world_destroy(world);
}

/* As far apart as need be before and after, but a pair's normal may no longer say so: the bound has to look. */
static void what_changes_fast_comes_in(void **state) {
    (void)state;
    for (int fast = 0; fast < 2; fast++) {
        skein_world *world = world_about_to_go(hanging);
        sk_touch *touch = touch_of(world);
        const real way = (fast ? (real)0.1 : (real)0.005) / (SIDE - 1); // a tenth of a cell, to and fro
        for (size_t v = 0; v < touch->skin.vertex_count; v++)
            touch->q[v].x += (touch->skin.particle[v] % SIDE) % 2 ? way : -way;
        assert_int_equal(sk_spread_follow(touch, SK_REAL_MAX), fast);
        assert_int_equal(touch->spread.out_count, fast ? 0 : touch->spread.count);
        skein_world_destroy(world);
    }
}

static void layered(skein_world *world) {
    add_contact(world, 0.004);
    for (int l = 0; l < 2; l++) add_sheet(world, "", (double[]){0, 1 + 0.03 * l, 0}, still, still);
}

/* Who is held back goes what all go together, and that leads those above into those below; but only where somebody is. */
static void the_common_way_counts_where_somebody_is_held_back(void **state) {
    (void)state;
    for (int held = 0; held < 2; held++) {
        skein_world *world = world_about_to_go(layered);
        sk_touch *touch = touch_of(world);
        touch->common = (sk_vec3){0, (real)-0.03, 0};
        if (held) sk_spread_disturb(touch, 0);
        if (held) assert_true(sk_spread_come_in(touch));
        touch->spread.stale = true;
        assert_int_equal(sk_spread_follow(touch, SK_REAL_MAX), held);
        assert_int_equal(touch->spread.out_count, held ? 0 : touch->spread.count);
        skein_world_destroy(world);
    }
}

/* Panels that have the vertex, and all in whose blocks ways lead through these; nobody else. */
static void one_held_back_brings_in_those_around(void **state) {
    (void)state;
    skein_world *world = world_about_to_go(hanging);
    sk_touch *touch = touch_of(world);
    const sk_spread *spread = &touch->spread;
    const uint32_t v = (uint32_t)touch->skin.vertex_count / 2,
                   p = spread->of_leaf[touch->skin.leaf_of[touch->skin.leaf_start[v]]];
    memset(touch->lost, 0, touch->skin.vertex_count);
    sk_spread_disturb(touch, v);
    assert_true(spread->came_in && sk_spread_come_in(touch) && !spread->came_in && touch->lost[v] && touch->wild[v]);
    size_t in = 0;
    for (size_t i = 0; i < spread->count; i++) in += !spread->out[i];
    assert_true(in >= 4 && in <= 36 && spread->out_count == spread->count - in);
    for (uint32_t i = spread->beside.start[p]; i < spread->beside.start[p + 1]; i++)
        assert_false(spread->out[spread->beside.number[i]]);
    for (size_t l = 0; l < touch->skin.leaf_count; l++) // all of what came in is looked for
        for (uint32_t t = touch->skin.leaf[l].first_triangle, k = 0;
             k < touch->skin.leaf[l].triangles && !sk_spread_has(spread, l); k++, t++)
            for (int c = 0; c < 3; c++) assert_true(touch->lost[touch->skin.triangle[t][c]]);
    assert_true(sk_spread_end(touch));
    assert_int_equal(spread->out_count, 0);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_hangs_is_out),
        cmocka_unit_test(what_swings_is_mostly_out),
        cmocka_unit_test(meshes_are_out_too),
        cmocka_unit_test(what_meets_comes_in),
        cmocka_unit_test(what_folds_comes_in),
        cmocka_unit_test(beside_a_cut_nobody_is_out),
        cmocka_unit_test(what_is_off_its_course_is_seen),
        cmocka_unit_test(what_stays_is_out),
        cmocka_unit_test(what_changes_fast_comes_in),
        cmocka_unit_test(the_common_way_counts_where_somebody_is_held_back),
        cmocka_unit_test(one_held_back_brings_in_those_around),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
