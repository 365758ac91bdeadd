/* What is near is dealt to slabs of space (contact/slabs.c): each pair once, in its order, and what threads push at the same time has no corner
 * in common. */
#include "near_pairs.h"

enum { SIDE = SPARING ? 24 : 40, STEPS = SPARING ? 8 : 30 };

/* A sheet that folds as it falls on another one, both on a ball; wider by far along one axis, and somewhere. Or both begin in one place. */
static skein_world *folding(const double size[2], double turn, const double at[3], int threads, int apart) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 5))));
    add_gravity(world);
    OK(world,
       skein_collider_add(world, "sphere",
                          SKEIN_SETTINGS(SKEIN_REAL("radius", 0.2), SKEIN_VEC3("centre", at[0], at[1], at[2])), NULL));
    for (int sheet = 0; sheet < 2; sheet++) {
        const int l = sheet * apart;
        OK(world, skein_body_add(
                      world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_PAIR("size", size[0], size[1]),
                                     SKEIN_VEC3("position", at[0] + 0.02 * l, at[1] + 0.22 + 0.012 * l, at[2]),
                                     SKEIN_VEC3("rotation", 0, turn + 20 * l, 0), SKEIN_VEC3("velocity", 0, -1 - l, 0)),
                      NULL));
    }
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.012)), NULL));
    return world;
}

/* Marks a pair's corners as those of a class; none may be of another one of the same round. */
static void mark(const sk_push *pair, int class, int *of) {
    for (int c = 0; c < 4; c++) {
        assert_true(of[pair->corner[c]] < 0 || of[pair->corner[c]] == class);
        of[pair->corner[c]] = class;
    }
}

/* How many pairs there are in each round. */
static void check_dealt(const sk_touch *touch, size_t in_round[SK_SLAB_ROUNDS]) {
    const sk_push_list *pushes = &touch->pushes;
    const size_t corners = touch->near[SK_CORNERS].count, all = corners + touch->near[SK_EDGES].count;
    assert_int_equal(pushes->start[0], 0);
    assert_int_equal(pushes->start[SK_SLAB_CLASSES], corners);
    assert_int_equal(pushes->start[SK_PUSH_CLASSES], all);
    bool *seen = calloc(all + 1, sizeof *seen);
    int *of = malloc((touch->skin.vertex_count + 1) * sizeof *of);
    assert_true(seen && of);
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (int r = 0; r < SK_SLAB_ROUNDS; r++) {
            for (size_t v = 0; v <= touch->skin.vertex_count; v++) of[v] = -1;
            const size_t first = (size_t)sort * SK_SLAB_CLASSES;
            for (size_t class = first + sk_slab_round[r]; class < first + sk_slab_round[r + 1]; class ++)
                for (size_t i = pushes->start[class]; i < pushes->start[class + 1]; i++) {
                    const uint32_t pair = pushes->dealt.data[i];
                    assert_true(pair < all && !seen[pair]);
                    assert_true(i == pushes->start[class] || pushes->dealt.data[i - 1] < pair);
                    seen[pair] = true;
                    mark(&pushes->pair.data[pair], (int)class, of);
                    in_round[r]++;
                }
        }
    free(seen);
    free(of);
}

static void what_is_pushed_together_has_no_corner_in_common(void **state) {
    (void)state;
    static const double sizes[][2] = {{1, 1}, {2.5, 0.6}, {2.5, 0.6}, {0.5, 0.5}}, turns[] = {0, 0, 90, 30};
    static const double places[][3] = {{0, 0, 0}, {-70, 3, 11}, {5, -40, 300}, {0.01, 0, -0.02}};
    for (size_t c = 0; c < COUNT(turns); c++) {
        skein_world *world = folding(sizes[c], turns[c], places[c], 1, 1);
        (void)statistics_of(world);
        size_t in_round[SK_SLAB_ROUNDS] = {0}, looked = 0;
        for (int i = 0; i < STEPS; i++) {
            steps(world, 1, 1.0 / 60);
            const sk_touch *touch = touch_of(world);
            if (!touch->pushes.known || !(touch->near[SK_CORNERS].count + touch->near[SK_EDGES].count)) continue;
            check_dealt(touch, in_round);
            looked++;
        }
        assert_true(looked > 2);
        for (int r = 0; r < SK_SLAB_ROUNDS - 1 && c < 3; r++)
            assert_true(in_round[r] > 100); // a thing of millimetres has few cuts
        skein_world_destroy(world);
    }
}

/* So much is pushed that threads share it; also where sides have to be chosen. */
static void threads_share_pushes_and_change_no_bit(void **state) {
    (void)state;
    static const double size[] = {1, 1}, at[] = {0, 0, 0};
    setenv("SKEIN_THREADS", "always", 1);
    for (int apart = 0; apart < 2; apart++) {
        uint64_t hash[2];
        for (int t = 0; t < 2; t++) {
            skein_world *world = folding(size, 0, at, t ? 3 : 1, apart);
            size_t most = 0;
            for (int i = 0; i < (apart ? STEPS : 3); i++) {
                steps(world, 1, 1.0 / 60);
                const sk_touch *touch = touch_of(world);
                const size_t pairs = touch && touch->pushes.known ? touch->pushes.start[SK_MOST_SLABS] : 0;
                most = pairs > most ? pairs : most;
            }
            assert_true(SPARING || most > 1000);
            hash[t] = skein_world_hash(world);
            skein_world_destroy(world);
        }
        assert_true(hash[0] == hash[1]);
    }
    unsetenv("SKEIN_THREADS");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_pushed_together_has_no_corner_in_common),
                                       cmocka_unit_test(threads_share_pushes_and_change_no_bit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
