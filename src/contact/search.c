/* The search for pairs: of vertices that are lost, or of all. Each vertex is expected on a straight course, and boxes go
 * on with it: two that are apart, along one axis and on one side, both when the time begins and when it ends, do not meet
 * in between. So what goes along with its neighbours, however fast, is as far from others as if it stood. Boxes are wider
 * than their features by the reach of vertices and half of how near a pair has to be; of leaves whose boxes may meet,
 * features whose boxes may; of these, those that no plane keeps apart. Pairs are kept in the order of leaves, which is
 * always the same. */
#include <math.h>
#include <string.h>

#include "base/tasks.h"
#include "contact/touch.h"

/* What is nearer than this share of its way may close in a substep: a little more than 1 / (1 - SK_LEFT_OVER). */
static const real closing_share = (real)1.13;
/* Thicknesses: nearest points of edges that are all but parallel are no better known. */
static const real rounding = (real)0.002;

/* ---- how near a pair has to be ---- */

/* A vertex' part of it: what is no nearer than the sum of both features' parts, along one axis and on one side before a
 * substep and after it, is neither near nor closes (bound.c). */
static real part_of(const sk_touch *touch, real reach) {
    return reach + ((real)0.5 * SK_NEAR_THICKNESSES + rounding) * touch->thickness;
}

/* ---- boxes ---- */

static inline sk_quad least_of(sk_quad a, sk_quad b) {
    for (int k = 0; k < 4; k++) a[k] = a[k] < b[k] ? a[k] : b[k];
    return a;
}

static inline sk_quad most_of(sk_quad a, sk_quad b) {
    for (int k = 0; k < 4; k++) a[k] = a[k] > b[k] ? a[k] : b[k];
    return a;
}

static inline void widen(sk_box *box, const sk_box *by) {
    for (int end = 0; end < 2; end++) {
        box->low[end] = least_of(box->low[end], by->low[end]);
        box->high[end] = most_of(box->high[end], by->high[end]);
    }
}

/* A feature's box: around its corners, and wider by the most that one of them asks for, which is its fourth number. */
static void box_of(const sk_box *corner_box, const uint32_t *vertex, int count, sk_box *box) {
    *box = corner_box[vertex[0]];
    for (int k = 1; k < count; k++) widen(box, &corner_box[vertex[k]]);
    for (int end = 0; end < 2; end++) {
        real part = box->high[end][3];
        box->low[end] -= (sk_quad){part, part, part, 0};
        box->high[end] += (sk_quad){part, part, part, 0};
    }
}

static sk_quad quad_of(sk_vec3 x) {
    return (sk_quad){x.x, x.y, x.z, 0};
}

/* The box of a way, whatever share of it is gone, in the frame of courses; of a place, where the way is none. */
static sk_box box_of_way(const sk_touch *touch, size_t v, bool way) {
    sk_vec3 from = sk_sub(sk_xyz(touch->p[v]), touch->shift[0]), to = from;
    if (way) to = sk_sub(sk_add(sk_add(sk_xyz(touch->p[v]), touch->common), sk_xyz(touch->way[v])), touch->shift[1]);
    sk_quad low = least_of(quad_of(from), quad_of(to)), high = most_of(quad_of(from), quad_of(to));
    return (sk_box){{low, low}, {high, high}};
}

static void make_vertex_box(sk_touch *touch, size_t v, bool way) {
    const sk_course *course = &touch->course[v];
    bool stands = way || touch->wild[v];
    sk_quad from = quad_of(course->from), to = quad_of(sk_expected(course, touch->until));
    sk_box box = {{from, to}, {from, to}};
    if (stands) box = box_of_way(touch, v, way);
    for (int end = 0; end < 2; end++) box.high[end][3] = part_of(touch, stands ? 0 : course->reach);
    touch->corner_box[v] = box;
}

static real square_between(const sk_vec4 *p, uint32_t a, uint32_t b) {
    real x = p[a].x - p[b].x, y = p[a].y - p[b].y, z = p[a].z - p[b].z;
    return x * x + y * y + z * z;
}

/* Whether the longest side is four times as long as it was built. */
static bool is_torn(const sk_touch *touch, const uint32_t *vertex, int count) {
    const real most = 4 * 4;
    real now = 0, built = 0;
    for (int k = 0; k < count; k++) {
        uint32_t a = vertex[k], b = vertex[(k + 1) % count];
        now = sk_max(now, square_between(touch->p, a, b));
        built = sk_max(built, square_between(touch->skin.built, a, b));
    }
    return built > 0 && now > most * built;
}

/* What has blown up meets nobody: its boxes overlap with all others, and a step would take minutes. */
static bool has_blown_up(const sk_touch *touch, const sk_leaf *leaf, const sk_box *box) {
    bool torn = !leaf->triangles && is_torn(touch, touch->skin.edge[leaf->first_edge], 2);
    for (size_t k = 0; k < leaf->triangles; k++)
        torn |= is_torn(touch, touch->skin.triangle[leaf->first_triangle + k], 3);
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) torn |= !(box->low[end][k] >= (real)-1e15 && box->high[end][k] <= (real)1e15);
    return torn;
}

void sk_touch_leaf_box(sk_touch *touch, size_t i) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *leaf = &skin->leaf[i];
    sk_box *box = &touch->leaf_box[i];
    for (uint32_t k = 0, v = leaf->first_vertex; k < leaf->vertices; k++, v++)
        box_of(touch->corner_box, &v, 1, &touch->vertex_box[v]);
    for (size_t k = 0, e = leaf->first_edge; k < leaf->edges; k++, e++)
        box_of(touch->corner_box, skin->edge[e], 2, &touch->edge_box[e]);
    for (size_t k = 0, t = leaf->first_triangle; k < leaf->triangles; k++, t++)
        box_of(touch->corner_box, skin->triangle[t], 3, &touch->triangle_box[t]);
    *box = leaf->triangles ? touch->triangle_box[leaf->first_triangle] : touch->edge_box[leaf->first_edge];
    for (size_t k = 1; k < leaf->triangles; k++) widen(box, &touch->triangle_box[leaf->first_triangle + k]);
    if (!has_blown_up(touch, leaf, box)) return;
    const sk_quad most = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0};
    *box = (sk_box){{most, most}, {-most, -most}};
}

/* The box of those of a leaf's features that are looked for. */
static void make_hot_box(sk_touch *touch, size_t i) {
    const sk_leaf *leaf = &touch->skin.leaf[i];
    const sk_quad most = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0};
    sk_box box = {{most, most}, {-most, -most}};
    bool met = touch->leaf_box[i].low[0][0] <= touch->leaf_box[i].high[0][0]; // it has not blown up
    for (size_t v = leaf->first_vertex; met && v < (size_t)leaf->first_vertex + leaf->vertices; v++)
        if (touch->lost[v]) widen(&box, &touch->vertex_box[v]);
    for (size_t e = leaf->first_edge; met && e < (size_t)leaf->first_edge + leaf->edges; e++)
        if (touch->hot_edge[e]) widen(&box, &touch->edge_box[e]);
    for (size_t t = leaf->first_triangle; met && t < (size_t)leaf->first_triangle + leaf->triangles; t++)
        if (touch->hot_triangle[t]) widen(&box, &touch->triangle_box[t]);
    touch->hot_box[i] = box;
}

static void mark_leaves_of(const sk_skin *skin, size_t v, uint8_t *leaves) {
    for (uint32_t k = skin->leaf_start[v]; k < skin->leaf_start[v + 1]; k++) leaves[skin->leaf_of[k]] = 1;
}

static void make_leaf_boxes(void *data, size_t begin, size_t end) {
    sk_touch *touch = data;
    for (size_t i = begin; i < end; i++) {
        if (touch->moved[i]) sk_touch_leaf_box(touch, i);
        if (touch->anew[i]) make_hot_box(touch, i);
    }
}

static void make_boxes(sk_touch *touch, sk_touch_search_sort sort) {
    bool all = sort == SK_SEARCH_ALL || !touch->boxed || touch->still;
    size_t leaves = touch->skin.leaf_count;
    if (all) memset(touch->moved, 1, leaves);
    else memcpy(touch->moved, touch->anew, leaves);
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        bool was_wild = touch->wild[v] && sort == SK_SEARCH_LOST; // where it is now is what counts
        if (!(all | touch->lost[v] | was_wild)) continue;
        make_vertex_box(touch, v, touch->still || (sort == SK_SEARCH_WAYS && (touch->lost[v] | touch->wild[v])));
        if (was_wild) mark_leaves_of(&touch->skin, v, touch->moved);
    }
    sk_parallel_for(touch->tasks, 0, leaves, make_leaf_boxes, touch);
}

/* ---- who is looked for ---- */

/* Marks edges and triangles that have a lost vertex, and the leaves that have one. */
static void mark_hot(sk_touch *touch) {
    const sk_skin *skin = &touch->skin;
    const uint8_t *lost = touch->lost;
    memset(touch->anew, 0, skin->leaf_count);
    for (size_t v = 0; v < skin->vertex_count; v++)
        if (lost[v]) mark_leaves_of(skin, v, touch->anew);
    for (size_t i = 0; i < skin->leaf_count; i++) {
        const sk_leaf *leaf = &skin->leaf[i];
        if (!touch->anew[i]) continue;
        for (size_t e = leaf->first_edge; e < (size_t)leaf->first_edge + leaf->edges; e++)
            touch->hot_edge[e] = lost[skin->edge[e][0]] | lost[skin->edge[e][1]];
        for (size_t t = leaf->first_triangle; t < (size_t)leaf->first_triangle + leaf->triangles; t++)
            touch->hot_triangle[t] = lost[skin->triangle[t][0]] | lost[skin->triangle[t][1]] | lost[skin->triangle[t][2]];
    }
}

/* So that none is marked the next time. */
static void forget_hot(sk_touch *touch) {
    const sk_skin *skin = &touch->skin;
    for (size_t i = 0; i < skin->leaf_count; i++) {
        const sk_leaf *leaf = &skin->leaf[i];
        if (!touch->anew[i]) continue;
        memset(touch->hot_edge + leaf->first_edge, 0, leaf->edges);
        memset(touch->hot_triangle + leaf->first_triangle, 0, leaf->triangles);
    }
}

/* ---- pairs ---- */

static inline void put(sk_pairs *pairs, uint64_t key, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    size_t k = pairs->count++;
    pairs->corner[0][k] = a, pairs->corner[1][k] = b, pairs->corner[2][k] = c, pairs->corner[3][k] = d;
    pairs->key[k] = key;
}

/* Vertices of leaf a with triangles of leaf b, of which one is looked for. */
static void put_corners(const sk_touch *touch, sk_pairs *fresh, uint64_t key, const sk_leaf *a, uint32_t b_number) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *b = &skin->leaf[b_number];
    for (uint32_t v = a->first_vertex; v < a->first_vertex + a->vertices; v++) {
        const sk_box box = touch->vertex_box[v];
        if (!sk_boxes_meet(&box, &touch->leaf_box[b_number])) continue;
        for (uint32_t t = b->first_triangle; t < b->first_triangle + b->triangles; t++) {
            const uint32_t *corner = skin->triangle[t];
            if ((touch->lost[v] | touch->hot_triangle[t]) && sk_boxes_meet(&box, &touch->triangle_box[t]) &&
                v != corner[0] && v != corner[1] && v != corner[2])
                put(fresh, key + 2 * (v - a->first_vertex) + t - b->first_triangle, v, corner[0], corner[1], corner[2]);
        }
    }
}

static void put_edges(const sk_touch *touch, sk_pairs *fresh, uint64_t key, uint32_t a_number, uint32_t b_number) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *a = &skin->leaf[a_number], *b = &skin->leaf[b_number];
    for (uint32_t e = a->first_edge; e < a->first_edge + a->edges; e++) {
        const sk_box box = touch->edge_box[e];
        if (!sk_boxes_meet(&box, &touch->leaf_box[b_number])) continue;
        const uint32_t *one = skin->edge[e];
        for (uint32_t f = a == b ? e + 1 : b->first_edge; f < b->first_edge + b->edges; f++) {
            const uint32_t *two = skin->edge[f];
            if ((touch->hot_edge[e] | touch->hot_edge[f]) && sk_boxes_meet(&box, &touch->edge_box[f]) &&
                one[0] != two[0] && one[0] != two[1] && one[1] != two[0] && one[1] != two[1])
                put(fresh, key + 5 * (e - a->first_edge) + f - b->first_edge, one[0], one[1], two[0], two[1]);
        }
    }
}

/* Leaves those that may come near. */
static void keep_near(const sk_touch *touch, sk_pairs *pairs, int sort, sk_touch_search_sort search) {
    bool ways = search == SK_SEARCH_WAYS;
    sk_nearing_values values = {.near = SK_NEAR_THICKNESSES * touch->thickness,
                                .rounding = 2 * rounding * touch->thickness,
                                .closing = closing_share,
                                .per = 1 / (touch->until - touch->now)};
    if (ways)
        values = (sk_nearing_values){.near = (SK_NEAR_THICKNESSES + rounding) * touch->thickness,
                                     .shares = 1 - 1 / closing_share};
    sk_closest[sort][touch->isa](touch->at, pairs);
    sk_nearing[sort][touch->isa](touch->at, touch->in_the_end, &values, pairs);
    size_t count = pairs->count;
    pairs->count = 0;
    for (size_t k = 0; k < count; k++) {
        pairs->settled[k] = 0;
        if (pairs->closes[k]) sk_pairs_copy(pairs, pairs, k);
    }
    sk_pairs_pad(pairs);
}

/* A surface as it was built is not pushed apart: features of one piece are as thick as their distance then allows. */
static void set_thickness(const sk_touch *touch, sk_pairs *pairs, int sort) {
    const real share = (real)0.9;
    sk_closest[sort][touch->isa](touch->skin.built, pairs);
    const uint32_t *piece = touch->skin.piece;
    for (size_t k = 0; k < pairs->count; k++) {
        bool same = piece[pairs->corner[0][k]] == piece[pairs->corner[2][k]];
        pairs->thickness[k] = same ? sk_min(touch->thickness, share * pairs->distance[k]) : touch->thickness;
    }
}

/* The leaf whose partners have the i-th of all. */
static uint32_t leaf_with(const sk_touch *touch, size_t i) {
    uint32_t low = 0, high = (uint32_t)touch->skin.leaf_count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (touch->start[middle + 1] > i) high = middle;
        else low = middle + 1;
    }
    return low;
}

enum { MOST = 64 }; /* pairs of two leaves: 2 x 4 x 2 corners, 5 x 5 edges */

/* Lists the pairs of features of a part's leaves that may meet, and keeps those that may come near. */
static void find_fresh(const sk_parts_job *job, sk_search_part *part) {
    const sk_touch *touch = job->touch;
    sk_pairs fresh = part->fresh; // so that its arrays stay in registers
    uint32_t a = leaf_with(touch, part->next);
    for (; part->next < part->end && fresh.count + MOST <= fresh.capacity; part->next++) {
        while (touch->start[a + 1] <= part->next) a++;
        uint32_t b = touch->partner.data[part->next];
        uint64_t key = (uint64_t)a << 36 | (uint64_t)b << 8;
        if (job->sort == SK_EDGES) {
            put_edges(touch, &fresh, key, a, b);
            continue;
        }
        put_corners(touch, &fresh, key, &touch->skin.leaf[a], b);
        if (b != a) put_corners(touch, &fresh, key + MOST / 2, &touch->skin.leaf[b], a);
    }
    part->fresh.count = fresh.count;
    if (part->next < part->end) return;
    sk_pairs_pad(&part->fresh);
    keep_near(touch, &part->fresh, job->sort, (sk_touch_search_sort)job->search);
    set_thickness(touch, &part->fresh, job->sort);
    if (job->search == SK_SEARCH_WAYS) sk_closest[job->sort][touch->isa](touch->p, &part->fresh);
}

static bool grow_fresh(sk_search_part *part, sk_allocator *allocator) {
    return sk_pairs_reserve(&part->fresh, allocator, 2 * part->fresh.capacity + 16 * MOST);
}

/* Finds the pairs of a sort that may come near, in order. */
static bool list_fresh(sk_touch *touch, sk_allocator *allocator, int sort, sk_touch_search_sort search) {
    const size_t worth = 256;
    sk_parts_job job = {.touch = touch, .sort = sort, .search = (int)search, .work = find_fresh, .grow = grow_fresh};
    for (int i = 0; i < SK_MOST_PARTS; i++) touch->part[i].fresh.count = 0;
    if (!sk_touch_work(&job, allocator, touch->partner.count, worth)) return false;
    size_t count = 0;
    for (int i = 0; i < touch->part_count; i++) count += touch->part[i].fresh.count;
    if (touch->part_count == 1) {
        sk_pairs other = touch->fresh;
        touch->fresh = touch->part[0].fresh, touch->part[0].fresh = other;
        return true;
    }
    touch->fresh.count = 0;
    if (!sk_pairs_reserve(&touch->fresh, allocator, count)) return false;
    for (int i = 0; i < touch->part_count; i++)
        sk_pairs_take(&touch->fresh, &touch->part[i].fresh, 0, touch->part[i].fresh.count);
    sk_pairs_pad(&touch->fresh);
    return true;
}

/* ---- the search ---- */

/* A horizon at which what goes its own way has gone some thicknesses. */
static void look_ahead(sk_touch *touch) {
    const real least = 2, longest = 640;
    // where few have left their courses, they will keep to them for longer
    real last = touch->now, most = 4 * touch->lost_since < touch->skin.vertex_count ? sk_max(10, 2 * last) : 10;
    real longer = touch->lost_since ? 0 : 2 * last;
    touch->lost_since = 0;
    most = sk_min(most, longest), longer = sk_min(longer, longest);
    size_t count = touch->skin.vertex_count;
    double drift[3] = {0, 0, 0}, sum = 0;
    for (size_t v = 0; v < count; v++) {
        sk_vec3 step = touch->course[v].step;
        drift[0] += (double)step.x, drift[1] += (double)step.y, drift[2] += (double)step.z;
    }
    double share = 1 / (double)count;
    touch->drift = (sk_vec3){(real)(share * drift[0]), (real)(share * drift[1]), (real)(share * drift[2])};
    for (size_t v = 0; v < count; v++) sum += (double)sk_length(sk_sub(touch->course[v].step, touch->drift));
    real ahead = touch->thickness / (real)(share * sum + 1e-9);
    touch->until = ahead < least ? least : ahead < most ? ahead : most; // of what is no number, too
    if (longer > touch->until) touch->until = longer;
    touch->now = 0;
}

/* Where vertices are expected now, with how far off they may be, and in the end. */
static void expect(sk_touch *touch, sk_touch_search_sort sort) {
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const sk_course *course = &touch->course[v];
        if (sort == SK_SEARCH_WAYS) {
            sk_vec3 end = sk_add(sk_xyz(touch->p[v]), sk_xyz(touch->way[v]));
            touch->at[v] = touch->p[v];
            touch->in_the_end[v] = (sk_vec4){end.x, end.y, end.z, 0};
            continue;
        }
        if (touch->wild[v]) { // its pairs to come are found on its ways
            sk_vec3 here = sk_sub(sk_xyz(touch->p[v]), touch->shift[0]);
            touch->at[v] = touch->in_the_end[v] = (sk_vec4){here.x, here.y, here.z, 0};
            continue;
        }
        sk_vec3 at = sk_expected(course, touch->now), end = sk_expected(course, touch->until);
        touch->at[v] = (sk_vec4){at.x, at.y, at.z, course->reach};
        touch->in_the_end[v] = (sk_vec4){end.x, end.y, end.z, 0};
    }
}

/* Whether more than one vertex in thirty is lost. */
static bool is_many(const sk_touch *touch) {
    size_t count = touch->skin.vertex_count, lost = 0;
    for (size_t v = 0; v < count; v++) lost += touch->lost[v];
    return 30 * lost > count;
}

bool sk_touch_search(sk_touch *touch, sk_allocator *allocator, sk_touch_search_sort search) {
    const size_t most_a_vertex = 1000; // what is everywhere at once: gigabytes of pairs, and minutes a step
    size_t count = touch->skin.vertex_count, most = most_a_vertex * (count + 64) / 13;
    bool all = search == SK_SEARCH_ALL, everybody = all || touch->storm;
    touch->searches++;
    touch->searched_since = all ? 0 : touch->searched_since + 1;
    if (all) look_ahead(touch);
    else
        for (size_t v = 0; v < count; v++) touch->lost_since += touch->lost[v];
    mark_hot(touch);
    // for a whole substep and many vertices, smaller boxes that stand are worth making all anew
    touch->still = search == SK_SEARCH_WAYS && is_many(touch);
    touch->refit |= all || touch->still || !touch->boxed;
    make_boxes(touch, search);
    touch->boxed = !touch->still;
    touch->found = false;
    bool gives_up = false, good = sk_touch_partners(touch, allocator, most, &gives_up);
    if (gives_up) {
        touch->given_up++;
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) touch->kept[sort].count = touch->late[sort].count = 0;
    }
    if (good && !gives_up) expect(touch, search);
    for (int sort = 0; sort < SK_PAIR_SORTS && good && !gives_up; sort++) {
        good = list_fresh(touch, allocator, sort, search) && sk_touch_keep(touch, allocator, sort, everybody);
    }
    forget_hot(touch);
    touch->found = good && !gives_up;
    return good;
}
