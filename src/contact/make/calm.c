/* Lists of patches: which leaves lie around a leaf, the pairs of their features that have no corner in common, and the
 * vertices of all these. Made with the skin, once. */
#include <string.h>

#include "contact/search/search.h"

enum { MOST_AROUND = 64 }; /* leaves: around a vertex with many more, all would be listed with all */

/* ---- leaves around leaves ---- */

/* Calls for each vertex of a leaf's features; the same one may come more than once. */
static size_t corners_of(const sk_skin *skin, const sk_leaf *leaf, uint32_t corner[16]) {
    size_t count = 0;
    for (size_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++)
        for (int c = 0; c < 3; c++) corner[count++] = skin->triangle[t][c];
    for (size_t e = leaf->first_edge; !leaf->triangles && e < leaf->first_edge + leaf->edges; e++)
        for (int c = 0; c < 2; c++) corner[count++] = skin->edge[e][c];
    return count;
}

/* Leaves that have a vertex in common with this one, in order; how many there are. */
static size_t list_around(const sk_skin *skin, size_t a, uint32_t *last, uint32_t *out, size_t most) {
    uint32_t corner[16];
    size_t count = 0, corners = corners_of(skin, &skin->leaf[a], corner);
    for (size_t c = 0; c < corners; c++)
        for (uint32_t k = skin->leaf_start[corner[c]]; k < skin->leaf_start[corner[c] + 1]; k++) {
            uint32_t b = skin->leaf_of[k];
            if (last[b] == a) continue;
            last[b] = (uint32_t)a;
            if (count == most) return most + 1;
            size_t to = count++;
            for (; to && out[to - 1] > b; to--) out[to] = out[to - 1];
            out[to] = b;
        }
    return count;
}

static bool list_rings(sk_calm *calm, const sk_skin *skin, sk_allocator *allocator) {
    size_t leaves = skin->leaf_count, count = 0;
    uint32_t around[MOST_AROUND];
    uint32_t *last = sk_allocate(allocator, (leaves + 1) * sizeof *last);
    uint8_t *crowded = sk_allocate(allocator, leaves + 1);
    bool good = last && crowded && (calm->ring_start = sk_allocate(allocator, (leaves + 2) * sizeof *calm->ring_start));
    if (good) memset(last, 0xff, leaves * sizeof *last);
    for (size_t a = 0; a < leaves && good; a++)
        crowded[a] = list_around(skin, a, last, around, MOST_AROUND) > MOST_AROUND;
    for (int fill = 0; fill < 2 && good; fill++) {
        if (fill) good = (calm->ring = sk_allocate(allocator, (count + 1) * sizeof *calm->ring)) != NULL;
        memset(last, 0xff, leaves * sizeof *last);
        count = 0;
        for (size_t a = 0; a < leaves && good; a++) {
            calm->ring_start[a] = (uint32_t)count;
            size_t n = crowded[a] ? 0 : list_around(skin, a, last, around, MOST_AROUND);
            for (size_t i = 0; i < n; i++) {
                if (crowded[around[i]]) continue;
                if (fill) calm->ring[count] = around[i];
                count++;
            }
        }
        if (good) calm->ring_start[leaves] = (uint32_t)count;
    }
    sk_release(allocator, last);
    sk_release(allocator, crowded);
    return good;
}

/* ---- pairs ---- */

/* Where pairs of a patch go: counted first, and then put down. */
typedef struct listing {
    sk_calm *calm;
    const sk_skin *skin;
    size_t count[SK_PAIR_SORTS];
    bool fill;
} listing;

static void put(listing *list, int sort, uint64_t key, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    size_t at = list->count[sort]++;
    if (!list->fill) return;
    const uint32_t v[4] = {a, b, c, d};
    for (int k = 0; k < 4; k++) list->calm->corner[sort][k][at] = v[k];
    list->calm->key[sort][at] = key;
}

static void put_corners(listing *list, uint64_t key, const sk_leaf *a, const sk_leaf *b) {
    for (uint32_t i = 0; i < a->vertices; i++)
        for (uint32_t k = 0; k < b->triangles; k++) {
            const uint32_t v = a->first_vertex + i, *t = list->skin->triangle[b->first_triangle + k];
            if (v != t[0] && v != t[1] && v != t[2]) put(list, SK_CORNERS, key + 2 * i + k, v, t[0], t[1], t[2]);
        }
}

static void put_edges(listing *list, uint64_t key, const sk_leaf *a, const sk_leaf *b) {
    for (uint32_t i = 0; i < a->edges; i++)
        for (uint32_t k = a == b ? i + 1 : 0; k < b->edges; k++) {
            const uint32_t *one = list->skin->edge[a->first_edge + i], *two = list->skin->edge[b->first_edge + k];
            if (one[0] != two[0] && one[0] != two[1] && one[1] != two[0] && one[1] != two[1])
                put(list, SK_EDGES, key + 5 * i + k, one[0], one[1], two[0], two[1]);
        }
}

/* The pairs of a leaf with those around it that are no earlier ones: as search/features.c lists them. */
static void put_leaf(listing *list, const sk_ignored *ignored, uint32_t a) {
    const sk_skin *skin = list->skin;
    for (uint32_t i = list->calm->ring_start[a]; i < list->calm->ring_start[a + 1]; i++) {
        uint32_t b = list->calm->ring[i];
        if (b < a || sk_is_ignored(ignored, a, b)) continue;
        const uint64_t key = sk_leaves_key(a, b);
        put_corners(list, key, &skin->leaf[a], &skin->leaf[b]);
        if (b != a) put_corners(list, key + SK_LEAVES_PAIRS / 2, &skin->leaf[b], &skin->leaf[a]);
        put_edges(list, key, &skin->leaf[a], &skin->leaf[b]);
    }
}

static void fill_block(listing *list, int sort, size_t first) {
    size_t at = list->count[sort];
    for (; at > first && at % SK_PATCH_LANES; at++) {
        if (!list->fill) continue;
        for (int k = 0; k < 4; k++) list->calm->corner[sort][k][at] = list->calm->corner[sort][k][first];
        list->calm->key[sort][at] = UINT64_MAX;
    }
    list->count[sort] = at;
}

static void list_pairs(listing *list, const sk_touch *touch) {
    sk_calm *calm = list->calm;
    const size_t leaves = touch->skin.leaf_count;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) list->count[sort] = 0;
    for (size_t p = 0; p < calm->patch_count; p++) {
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) calm->start[sort][p] = (uint32_t)list->count[sort];
        for (size_t slot = p * SK_PATCH_LEAVES; slot < (p + 1) * SK_PATCH_LEAVES && slot < leaves; slot++)
            put_leaf(list, &touch->ignored, touch->tree.leaf_at[slot]);
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
            fill_block(list, sort, calm->start[sort][p]);
            size_t count = list->count[sort] - calm->start[sort][p];
            if (count > calm->most) calm->most = count;
        }
    }
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) calm->start[sort][calm->patch_count] = (uint32_t)list->count[sort];
}

static bool make_pairs(sk_touch *touch, sk_allocator *allocator) {
    sk_calm *calm = &touch->calm;
    bool good = true;
    for (int sort = 0; sort < SK_PAIR_SORTS && good; sort++)
        good = (calm->start[sort] = sk_allocate(allocator, (calm->patch_count + 1) * sizeof **calm->start)) != NULL;
    listing list = {.calm = calm, .skin = &touch->skin};
    if (good) list_pairs(&list, touch);
    for (int sort = 0; sort < SK_PAIR_SORTS && good; sort++) {
        size_t room = list.count[sort] + SK_PATCH_LANES;
        for (int c = 0; c < 4 && good; c++)
            good = (calm->corner[sort][c] = sk_allocate(allocator, room * sizeof(uint32_t))) != NULL;
        good = good && (calm->thickness[sort] = sk_allocate(allocator, room * sizeof(real)));
        good = good && (calm->key[sort] = sk_allocate(allocator, room * sizeof(uint64_t)));
    }
    list.fill = true;
    if (good) list_pairs(&list, touch);
    return good;
}

/* ---- vertices ---- */

/* The vertices of a patch's pairs, each once; how many. */
static size_t vertices_of(const sk_calm *calm, size_t p, uint32_t *last, uint32_t *out) {
    size_t count = 0;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t k = calm->start[sort][p]; k < calm->start[sort][p + 1]; k++)
            for (int c = 0; c < 4; c++) {
                uint32_t v = calm->corner[sort][c][k];
                if (last[v] == p) continue;
                last[v] = (uint32_t)p;
                out[count++] = v;
            }
    return count;
}

static real square_apart(const sk_vec4 *x, uint32_t a, uint32_t b) {
    sk_vec3 r = sk_sub(sk_xyz(x[a]), sk_xyz(x[b]));
    return sk_dot(r, r);
}

/* The square of how far c is from the line through a and b, times the square of how far these are apart. */
static real square_off(const sk_vec4 *x, uint32_t a, uint32_t b, uint32_t c) {
    sk_vec3 u = sk_sub(sk_xyz(x[b]), sk_xyz(x[a])), v = sk_sub(sk_xyz(x[c]), sk_xyz(x[a]));
    real along = sk_dot(u, v);
    return sk_dot(u, u) * sk_dot(v, v) - along * along;
}

static void swap(uint32_t *vertex, size_t a, size_t b) {
    uint32_t other = vertex[a];
    vertex[a] = vertex[b], vertex[b] = other;
}

/* Puts three vertices first that are far apart, and far from a line. */
static void lead_with_three(const sk_vec4 *built, uint32_t *vertex, size_t count) {
    size_t far = 1, off = 2;
    if (count < 3) return;
    for (size_t i = 1; i < count; i++)
        if (square_apart(built, vertex[0], vertex[i]) > square_apart(built, vertex[0], vertex[far])) far = i;
    swap(vertex, 1, far);
    for (size_t i = 2; i < count; i++)
        if (square_off(built, vertex[0], vertex[1], vertex[i]) > square_off(built, vertex[0], vertex[1], vertex[off]))
            off = i;
    swap(vertex, 2, off);
}

static void fill_lane(sk_calm *calm, size_t p, const uint32_t *vertex, size_t count) {
    size_t sixteen = p / SK_PATCH_LANES, rows = calm->row_start[sixteen + 1] - calm->row_start[sixteen];
    uint32_t *row = calm->row + calm->row_start[sixteen] * SK_PATCH_LANES + p % SK_PATCH_LANES;
    for (size_t i = 0; i < rows; i++) row[i * SK_PATCH_LANES] = count ? vertex[i < count ? i : 0] : 0;
}

/* Counts the rows, and then fills them. */
static void list_vertices(sk_calm *calm, const sk_skin *skin, uint32_t *last, uint32_t *vertex, bool fill) {
    size_t vertices = skin->vertex_count;
    size_t sixteens = (calm->patch_count + SK_PATCH_LANES - 1) / SK_PATCH_LANES;
    memset(last, 0xff, vertices * sizeof *last);
    if (!fill) memset(calm->row_start, 0, (sixteens + 1) * sizeof *calm->row_start);
    if (!fill) memset(calm->of_vertex_start, 0, (vertices + 2) * sizeof *calm->of_vertex_start);
    for (size_t p = 0; p < calm->patch_count; p++) {
        size_t count = vertices_of(calm, p, last, vertex);
        uint32_t *rows = &calm->row_start[p / SK_PATCH_LANES + 1];
        if (!fill && *rows < 3) *rows = 3;
        if (!fill && count > *rows) *rows = (uint32_t)count;
        if (fill) lead_with_three(skin->built, vertex, count);
        if (fill) fill_lane(calm, p, vertex, count);
        for (size_t i = 0; i < count; i++) {
            if (fill) calm->of_vertex[calm->of_vertex_start[vertex[i] + 1]++] = (uint32_t)p;
            else calm->of_vertex_start[vertex[i] + 2]++;
        }
    }
    if (fill) return;
    for (size_t i = 0; i < sixteens; i++) calm->row_start[i + 1] += calm->row_start[i];
    for (size_t v = 0; v < vertices; v++) calm->of_vertex_start[v + 2] += calm->of_vertex_start[v + 1];
}

static bool make_vertices(sk_calm *calm, sk_allocator *allocator, const sk_skin *skin) {
    size_t vertices = skin->vertex_count;
    size_t sixteens = (calm->patch_count + SK_PATCH_LANES - 1) / SK_PATCH_LANES;
    uint32_t *last = sk_allocate(allocator, (vertices + 1) * sizeof *last);
    uint32_t *vertex = sk_allocate(allocator, (vertices + 1) * sizeof *vertex);
    calm->row_start = sk_allocate(allocator, (sixteens + 1) * sizeof *calm->row_start);
    calm->holds = sk_allocate(allocator, (sixteens + 1) * sizeof *calm->holds);
    calm->of_vertex_start = sk_allocate(allocator, (vertices + 3) * sizeof *calm->of_vertex_start);
    bool good = last && vertex && calm->row_start && calm->holds && calm->of_vertex_start;
    if (good) {
        list_vertices(calm, skin, last, vertex, false);
        size_t rows = calm->row_start[sixteens], listed = calm->of_vertex_start[vertices + 1];
        calm->row = sk_allocate(allocator, (rows + 1) * SK_PATCH_LANES * sizeof *calm->row);
        calm->from = sk_allocate(allocator, (rows + 1) * 3 * SK_PATCH_LANES * sizeof *calm->from);
        calm->of_vertex = sk_allocate(allocator, (listed + 1) * sizeof *calm->of_vertex);
        good = calm->row && calm->from && calm->of_vertex;
        // lanes of no patch are those of the first vertex
        if (good) memset(calm->row, 0, (rows + 1) * SK_PATCH_LANES * sizeof *calm->row);
        if (good) memset(calm->from, 0, (rows + 1) * 3 * SK_PATCH_LANES * sizeof *calm->from);
    }
    if (good) list_vertices(calm, skin, last, vertex, true);
    sk_release(allocator, last);
    sk_release(allocator, vertex);
    return good;
}

bool sk_calm_make(sk_touch *touch, sk_allocator *allocator) {
    sk_calm *calm = &touch->calm;
    size_t leaves = touch->skin.leaf_count;
    sk_calm_release(calm, allocator);
    calm->patch_count = (leaves + SK_PATCH_LEAVES - 1) / SK_PATCH_LEAVES;
    calm->patch = sk_allocate(allocator, (calm->patch_count + SK_PATCH_LANES) * sizeof *calm->patch);
    calm->of_leaf = sk_allocate(allocator, (leaves + 1) * sizeof *calm->of_leaf);
    bool good = calm->patch && calm->of_leaf;
    for (size_t slot = 0; slot < leaves && good; slot++)
        calm->of_leaf[touch->tree.leaf_at[slot]] = (uint32_t)(slot / SK_PATCH_LEAVES);
    good = good && list_rings(calm, &touch->skin, allocator) && make_pairs(touch, allocator) &&
           make_vertices(calm, allocator, &touch->skin);
    if (good) sk_calm_forget(touch);
    else sk_calm_release(calm, allocator);
    return good;
}

void sk_calm_release(sk_calm *calm, sk_allocator *allocator) {
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        for (int c = 0; c < 4; c++) sk_release(allocator, calm->corner[sort][c]);
        sk_release(allocator, calm->start[sort]);
        sk_release(allocator, calm->thickness[sort]);
        sk_release(allocator, calm->key[sort]);
    }
    sk_release(allocator, calm->patch);
    sk_release(allocator, calm->of_leaf);
    sk_release(allocator, calm->ring_start);
    sk_release(allocator, calm->ring);
    sk_release(allocator, calm->row_start);
    sk_release(allocator, calm->row);
    sk_release(allocator, calm->from);
    sk_release(allocator, calm->holds);
    sk_release(allocator, calm->of_vertex_start);
    sk_release(allocator, calm->of_vertex);
    sk_release(allocator, calm->scratch);
    sk_release(allocator, calm->found);
    *calm = (sk_calm){.patch_count = 0};
}
