/* Features of leaves that are compared in cells, against their boxes one by one: none that may meet is left out, for
 * any instruction set, however wide a leaf is and wherever it lies, and hardly any come in vain. */
#include "base/isa.h"
#include "contact/search/search.h"
#include "helpers.h"

enum { LEAVES = 48, MOST = LEAVES * SK_LEAVES_PAIRS };

typedef struct scene {
    sk_touch touch;
    sk_leaf leaf[LEAVES];
    sk_hot hot[LEAVES];
    uint32_t edge[LEAVES * SK_LEAF_EDGES][2], triangle[LEAVES * 2][3];
    sk_box vertex_box[LEAVES * SK_LEAF_VERTICES], edge_box[LEAVES * SK_LEAF_EDGES], triangle_box[LEAVES * 2];
    sk_box leaf_box[LEAVES];
    sk_edge_cells edge_cells[LEAVES];
    sk_corner_cells corner_cells[LEAVES];
    uint64_t random;
} scene;

static double random_share(scene *s) {
    s->random = s->random * 6364136223846793005u + 1442695040888963407u;
    return (double)(s->random >> 40) / (double)(1 << 24);
}

static uint32_t random_below(scene *s, uint32_t end) {
    return (uint32_t)(random_share(s) * end);
}

/* Some box in a leaf's that is so wide, from a corner on; where it goes on, its end lies elsewhere there. */
static sk_box random_box(scene *s, const double corner[3], double width) {
    sk_box box = {0};
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) {
            double low = corner[k] + width * random_share(s) * 0.7, high = low + width * random_share(s) * 0.3;
            box.low[end][k] = (real)low, box.high[end][k] = (real)high;
        }
    if (s->touch.still) box.low[1] = box.low[0], box.high[1] = box.high[0];
    return box;
}

static void add_to_leaf(scene *s, size_t i, const sk_box *box) {
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) {
            s->leaf_box[i].low[end][k] = sk_min(s->leaf_box[i].low[end][k], box->low[end][k]);
            s->leaf_box[i].high[end][k] = sk_max(s->leaf_box[i].high[end][k], box->high[end][k]);
        }
}

static void fill_leaf(scene *s, size_t i, const double corner[3], double width) {
    sk_skin *skin = &s->touch.skin;
    sk_leaf *leaf = &s->leaf[i];
    *leaf = (sk_leaf){(uint32_t)skin->vertex_count, (uint32_t)skin->edge_count,        (uint32_t)skin->triangle_count,
                      (uint8_t)random_below(s, 5),  (uint8_t)(1 + random_below(s, 5)), (uint8_t)random_below(s, 3)};
    s->hot[i] = (sk_hot){(uint8_t)random_below(s, 16), (uint8_t)random_below(s, 32), (uint8_t)random_below(s, 4)};
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++)
            s->leaf_box[i].low[end][k] = SK_REAL_MAX, s->leaf_box[i].high[end][k] = -SK_REAL_MAX;
    for (int n = 0; n < leaf->vertices; n++) {
        s->vertex_box[skin->vertex_count] = random_box(s, corner, width);
        add_to_leaf(s, i, &s->vertex_box[skin->vertex_count++]);
    }
    for (int n = 0; n < leaf->edges; n++) {
        for (int c = 0; c < 2; c++) s->edge[skin->edge_count][c] = random_below(s, 3 * LEAVES);
        s->edge_box[skin->edge_count] = random_box(s, corner, width);
        add_to_leaf(s, i, &s->edge_box[skin->edge_count++]);
    }
    for (int n = 0; n < leaf->triangles; n++) {
        for (int c = 0; c < 3; c++) s->triangle[skin->triangle_count][c] = random_below(s, 3 * LEAVES);
        s->triangle_box[skin->triangle_count] = random_box(s, corner, width);
        add_to_leaf(s, i, &s->triangle_box[skin->triangle_count++]);
    }
}

/* Leaves about a place, whose widths are some lengths of edges; one in `wide` is a thousand times as wide. */
static scene *new_scene(uint64_t seed, double place, uint32_t wide, bool still) {
    scene *s = aligned_alloc(64, (sizeof *s + 63) / 64 * 64);
    memset(s, 0, sizeof *s);
    s->random = seed;
    sk_touch *touch = &s->touch;
    touch->skin.leaf = s->leaf, touch->skin.edge = s->edge, touch->skin.triangle = s->triangle;
    touch->hot = s->hot, touch->vertex_box = s->vertex_box, touch->edge_box = s->edge_box;
    touch->triangle_box = s->triangle_box, touch->leaf_box = s->leaf_box;
    touch->edge_cells = s->edge_cells, touch->corner_cells = s->corner_cells;
    touch->thickness = (real)0.004, touch->skin.spacing = (real)0.006, touch->still = still;
    touch->cells = sk_cells_a_metre(touch);
    for (size_t i = 0; i < LEAVES; i++) {
        double corner[3], width = 0.01 + 0.03 * random_share(s);
        for (int k = 0; k < 3; k++) corner[k] = (k == 1 ? -place : place) + 0.03 * random_share(s);
        if (wide && i % wide == 0) { // the others lie in its midst
            width *= 1000;
            for (int k = 0; k < 3; k++) corner[k] -= 0.5 * width;
        }
        fill_leaf(s, i, corner, width);
        sk_touch_leaf_cells(touch, i);
    }
    return s;
}

static bool has(const uint32_t *some, int count, uint32_t v) {
    bool any = false;
    for (int k = 0; k < count; k++) any |= some[k] == v;
    return any;
}

/* Lists the keys of a vertex' leaf and a triangle's whose boxes meet. */
static size_t corners_of(const scene *s, uint32_t a, uint32_t b, uint64_t key, uint64_t *out) {
    const sk_leaf *one = &s->leaf[a], *two = &s->leaf[b];
    size_t count = 0;
    for (uint32_t i = 0; i < one->vertices; i++)
        for (uint32_t k = 0; k < two->triangles; k++) {
            uint32_t v = one->first_vertex + i, t = two->first_triangle + k;
            bool asked = (s->hot[a].vertices >> i & 1) || (s->hot[b].triangles >> k & 1);
            if (asked && !has(s->triangle[t], 3, v) && sk_boxes_meet(&s->vertex_box[v], &s->triangle_box[t]))
                out[count++] = key + 2 * i + k;
        }
    return count;
}

static size_t edges_of(const scene *s, uint32_t a, uint32_t b, uint64_t key, uint64_t *out) {
    const sk_leaf *one = &s->leaf[a], *two = &s->leaf[b];
    size_t count = 0;
    for (uint32_t i = 0; i < one->edges; i++)
        for (uint32_t k = a == b ? i + 1 : 0; k < two->edges; k++) {
            uint32_t e = one->first_edge + i, f = two->first_edge + k;
            bool asked = (s->hot[a].edges >> i & 1) || (s->hot[b].edges >> k & 1);
            bool joined = has(s->edge[f], 2, s->edge[e][0]) || has(s->edge[f], 2, s->edge[e][1]);
            if (asked && !joined && sk_boxes_meet(&s->edge_box[e], &s->edge_box[f])) out[count++] = key + 5 * i + k;
        }
    return count;
}

/* Every key of `must` is among the pairs, which are in order; returns how many more there are. */
static size_t more_than(const sk_pairs *pairs, const uint64_t *must, size_t count) {
    size_t m = 0;
    for (size_t k = 0; k < pairs->count; k++) {
        if (k) assert_true(pairs->key[k - 1] < pairs->key[k]);
        m += m < count && must[m] == pairs->key[k];
    }
    assert_int_equal(m, count);
    return pairs->count - count;
}

/* How many pairs come of a scene, of which how many in vain. */
static void compare(const scene *s, sk_isa isa, size_t *all, size_t *in_vain) {
    static uint64_t must[MOST];
    sk_allocator allocator = sk_default_allocator();
    sk_pairs pairs = {0};
    assert_true(sk_pairs_reserve(&pairs, &allocator, MOST + 16));
    for (uint32_t a = 0; a < LEAVES; a++)
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
            uint32_t partner[LEAVES];
            size_t count = 0, wanted = 0;
            for (uint32_t b = a; b < LEAVES; b++)
                if (sk_boxes_meet(&s->leaf_box[a], &s->leaf_box[b])) partner[count++] = b;
            for (size_t i = 0; i < count; i++) {
                uint32_t b = partner[i];
                uint64_t key = sk_leaves_key(a, b);
                if (sort == SK_EDGES) wanted += edges_of(s, a, b, key, must + wanted);
                else wanted += corners_of(s, a, b, key, must + wanted);
                if (sort == SK_CORNERS && a != b)
                    wanted += corners_of(s, b, a, key + SK_LEAVES_PAIRS / 2, must + wanted);
            }
            pairs.count = 0;
            sk_features[sort][isa](&s->touch, &pairs, a, partner, count);
            *in_vain += more_than(&pairs, must, wanted);
            *all += wanted;
        }
    sk_pairs_release(&pairs, &allocator);
}

typedef struct tried {
    double place;  /* m: of all leaves, along each axis */
    uint32_t wide; /* one leaf in so many is a thousand times as wide */
    bool still;
    size_t most; /* in vain, in a hundred */
} tried;

static void compare_all(const tried *how) {
    const sk_isa widest = sk_isa_choose();
    for (int isa = 0; isa <= (int)widest; isa++) {
        size_t all = 0, in_vain = 0;
        for (uint64_t seed = 1; seed <= 10; seed++) {
            scene *s = new_scene(seed, how->place, how->wide, how->still);
            compare(s, (sk_isa)isa, &all, &in_vain);
            free(s);
        }
        assert_true(all > 500);
        assert_true(100 * in_vain <= how->most * all);
    }
}

static void none_is_left_out(void **state) {
    (void)state;
    compare_all(&(tried){.place = 0, .most = 3});
    compare_all(&(tried){.place = 0, .still = true, .most = 3});
    // cells are counted from here and there; half of their numbers' range away they are those of the other half
    for (double place = 0.25; place < 200; place *= 1.7) {
        compare_all(&(tried){.place = place, .most = 3});
        compare_all(&(tried){.place = -place, .still = true, .most = 3});
    }
}

/* What is wider than cells can tell apart is compared as it is. */
static void wide_leaves_are_compared(void **state) {
    (void)state;
    compare_all(&(tried){.place = 0, .wide = 3, .most = 3});
    compare_all(&(tried){.place = -7, .wide = 2, .still = true, .most = 3});
    compare_all(&(tried){.place = 0, .wide = 1, .most = 0});
}

/* So far away that there is no number for a cell, and all lie in one place. */
static void what_is_far_away_is_compared(void **state) {
    (void)state;
    compare_all(&(tried){.place = 3e5, .most = 3});
    compare_all(&(tried){.place = 1e9, .most = 0});
    compare_all(&(tried){.place = 1e14, .still = true, .most = 0});
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(none_is_left_out),
        cmocka_unit_test(wide_leaves_are_compared),
        cmocka_unit_test(what_is_far_away_is_compared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
