/* Boxes of a search: of vertices, features and leaves, as they are expected to go on, and who is looked for. */
#include <string.h>

#include "base/tasks.h"
#include "contact/search/search.h"

enum { AT_ONCE = 1024 }; /* vertices or leaves that a thread takes at a time */

/* ---- how near a pair has to be ---- */

/* A vertex' part of it: what is no nearer than the sum of both features' parts, along one axis and on one side before a
 * substep and after it, is neither near nor closes (bound.c). */
static real part_of(const sk_touch *touch, real reach) {
    return reach + ((real)0.5 * SK_NEAR_THICKNESSES + SK_SEARCH_ROUNDING) * touch->thickness;
}

/* ---- boxes ---- */

static sk_box no_box(void) {
    const sk_quad most = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0};
    return (sk_box){{most, most}, {-most, -most}};
}

/* A feature's box: around its corners, and wider by the most that one of them asks for, which is its fourth number. */
static void box_of(const sk_box *corner_box, const uint32_t *vertex, int count, sk_box *box) {
    *box = corner_box[vertex[0]];
    for (int k = 1; k < count; k++) sk_box_widen(box, &corner_box[vertex[k]]);
    for (int end = 0; end < 2; end++) {
        real part = box->high[end][3];
        box->low[end] -= (sk_quad){part, part, part, 0};
        box->high[end] += (sk_quad){part, part, part, 0};
    }
}

static sk_quad quad_of(sk_vec3 x) {
    return (sk_quad){x.x, x.y, x.z, 0};
}

/* The box of a way, whatever share of it is gone, in the frame of courses; of a place, where the way is none. Where all boxes are of
 * ways, they are in the frame of what all go together, in which they are smaller. */
static sk_box box_of_way(const sk_touch *touch, size_t v, bool way) {
    sk_vec3 from = sk_sub(sk_xyz(touch->p[v]), touch->shift[0]), none = from, all = from;
    if (way) { // of none of its way it goes what all go together, whether the frame does or not
        none = touch->still ? sk_sub(sk_xyz(touch->stand[v]), touch->shift[0])
                            : sk_sub(sk_add(sk_xyz(touch->stand[v]), touch->common), touch->shift[1]);
        all = sk_add(none, sk_way_left(touch, v));
    }
    sk_quad low = sk_least_quad(quad_of(from), sk_least_quad(quad_of(none), quad_of(all)));
    sk_quad high = sk_most_quad(quad_of(from), sk_most_quad(quad_of(none), quad_of(all)));
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

/* What is nowhere meets nobody. */
static bool is_nowhere(const sk_box *box) {
    const real far = (real)1e15;
    bool any = false;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) any |= !(box->low[end][k] >= -far && box->high[end][k] <= far);
    return any;
}

void sk_touch_leaf_box(sk_touch *touch, size_t i, bool torn) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *leaf = &skin->leaf[i];
    sk_box *box = &touch->leaf_box[i], other;
    if (leaf->triangles) box_of(touch->corner_box, skin->triangle[leaf->first_triangle], 3, box);
    else box_of(touch->corner_box, skin->edge[leaf->first_edge], 2, box);
    for (size_t k = 1; k < leaf->triangles; k++) {
        box_of(touch->corner_box, skin->triangle[leaf->first_triangle + k], 3, &other);
        sk_box_widen(box, &other);
    }
    touch->featured[i] = 0;
    if (!torn && !is_nowhere(box)) return;
    *box = no_box();
    __atomic_store_n(&touch->tangle.torn, true, __ATOMIC_RELAXED);
}

void sk_touch_feature_boxes(sk_touch *touch, size_t i) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *leaf = &skin->leaf[i];
    touch->featured[i] = SK_IS_FEATURED;
    for (uint32_t k = 0, v = leaf->first_vertex; k < leaf->vertices; k++, v++)
        box_of(touch->corner_box, &v, 1, &touch->vertex_box[v]);
    for (size_t k = 0, e = leaf->first_edge; k < leaf->edges; k++, e++)
        box_of(touch->corner_box, skin->edge[e], 2, &touch->edge_box[e]);
    for (size_t k = 0, t = leaf->first_triangle; k < leaf->triangles; k++, t++)
        box_of(touch->corner_box, skin->triangle[t], 3, &touch->triangle_box[t]);
}

/* The box of those of a leaf's features that are looked for. */
static void make_hot_box(sk_touch *touch, size_t i) {
    const sk_leaf *leaf = &touch->skin.leaf[i];
    sk_box box = no_box();
    bool met = touch->leaf_box[i].low[0][0] <= touch->leaf_box[i].high[0][0]; // it has not blown up
    sk_hot hot = met ? touch->hot[i] : (sk_hot){0, 0, 0};
    for (uint32_t v = leaf->first_vertex; hot.vertices; v++, hot.vertices >>= 1)
        if (hot.vertices & 1) sk_box_widen(&box, &touch->vertex_box[v]);
    for (uint32_t e = leaf->first_edge; hot.edges; e++, hot.edges >>= 1)
        if (hot.edges & 1) sk_box_widen(&box, &touch->edge_box[e]);
    for (uint32_t t = leaf->first_triangle; hot.triangles; t++, hot.triangles >>= 1)
        if (hot.triangles & 1) sk_box_widen(&box, &touch->triangle_box[t]);
    touch->hot_box[i] = box;
}

static void mark_leaves_of(const sk_skin *skin, size_t v, uint8_t *leaves) {
    for (uint32_t k = skin->leaf_start[v]; k < skin->leaf_start[v + 1]; k++) leaves[skin->leaf_of[k]] = 1;
}

static void make_leaf_boxes(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    for (size_t i = begin; i < end; i++) {
        if (sk_spread_has(&touch->spread, i)) { // nobody meets it
            if (touch->moved[i]) touch->leaf_box[i] = touch->hot_box[i] = no_box();
            if (touch->moved[i]) touch->featured[i] = SK_IS_OUT;
            continue;
        }
        if (touch->moved[i]) sk_touch_leaf_box(touch, i, touch->torn[i]);
        if (touch->everybody) {
            touch->hot_box[i] = touch->leaf_box[i];
        } else if (touch->anew[i]) {
            if (!touch->featured[i]) sk_touch_feature_boxes(touch, i), sk_touch_leaf_cells(touch, i);
            make_hot_box(touch, i);
        }
    }
}

static void make_features(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    for (size_t i = begin; i < end; i++)
        if (touch->featured[i] == SK_TO_BE_FEATURED) sk_touch_feature_boxes(touch, i), sk_touch_leaf_cells(touch, i);
}

/* Threads may find the same leaf: all say the same of it. */
static void find_unfeatured(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    const uint32_t *first = touch->first.data, *partner = touch->partner.data;
    for (size_t i = begin; i < end; i++)
        for (int k = 0; k < 2; k++) {
            uint8_t *featured = &touch->featured[k ? partner[i] : first[i]];
            if (!__atomic_load_n(featured, __ATOMIC_RELAXED))
                __atomic_store_n(featured, SK_TO_BE_FEATURED, __ATOMIC_RELAXED);
        }
}

void sk_touch_box_features(sk_touch *touch) {
    enum { PARTNERS_AT_ONCE = 4096 };
    sk_parallel_pieces(touch->tasks, 0, touch->partner.count, PARTNERS_AT_ONCE, find_unfeatured, touch);
    if (!memchr(touch->featured, SK_TO_BE_FEATURED, touch->skin.leaf_count)) return;
    sk_parallel_pieces(touch->tasks, 0, touch->skin.leaf_count, AT_ONCE, make_features, touch);
}

/* Boxes of all vertices, or of those that are lost and, of courses, those that are wild: where these are now is what counts. */
typedef struct boxing {
    sk_touch *touch;
    bool all, ways;
    bool wild; /* are to have new ones */
} boxing;

static void box_some_vertices(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const boxing *job = data;
    sk_touch *touch = job->touch;
    for (size_t v = begin; v < end; v++) {
        if (sk_vertex_is_out(&touch->spread, v)) continue;
        bool lost = touch->lost[v], wild = touch->wild[v];
        if (job->all || lost || (wild && job->wild))
            make_vertex_box(touch, v, touch->still || (job->ways && (lost | wild)));
    }
}

/* Who has gone out since has no boxes any more, and who has come in has some again. */
static void move_turned(sk_touch *touch) {
    sk_spread *spread = &touch->spread;
    for (size_t p = 0; p < spread->count; p++) {
        for (uint32_t i = spread->leaves.start[p]; i < spread->leaves.start[p + 1] && spread->turned[p]; i++)
            touch->moved[spread->leaves.number[i]] = 1;
        spread->turned[p] = 0;
    }
}

void sk_touch_make_boxes(sk_touch *touch, sk_touch_search_sort sort) {
    bool all = sort == SK_SEARCH_ALL || !touch->boxed || touch->still;
    size_t leaves = touch->skin.leaf_count;
    if (all) touch->cells = sk_cells_a_metre(touch), touch->tangle.torn = false;
    if (all)
        for (size_t i = 0; i < leaves; i++) touch->moved[i] = touch->featured[i] != SK_IS_OUT;
    else memcpy(touch->moved, touch->anew, leaves);
    move_turned(touch);
    boxing job = {touch, all, sort == SK_SEARCH_WAYS, sort == SK_SEARCH_LOST};
    sk_parallel_pieces(touch->tasks, 0, touch->skin.vertex_count, AT_ONCE, box_some_vertices, &job);
    for (size_t v = 0; v < touch->skin.vertex_count && job.wild && touch->wild_count && !all; v++)
        if (touch->wild[v]) mark_leaves_of(&touch->skin, v, touch->moved);
    sk_parallel_pieces(touch->tasks, 0, leaves, AT_ONCE, make_leaf_boxes, touch);
}

/* ---- who is looked for ---- */

static sk_hot hot_of(const sk_touch *touch, const sk_leaf *leaf) {
    const sk_skin *skin = &touch->skin;
    const uint8_t *lost = touch->lost, *vertex = lost + leaf->first_vertex;
    const uint32_t(*edge)[2] = (const uint32_t(*)[2])skin->edge + leaf->first_edge;
    const uint32_t(*t)[3] = (const uint32_t(*)[3])skin->triangle + leaf->first_triangle;
    uint32_t vertices = 0, edges = 0, triangles = 0;
    for (uint32_t k = 0; k < leaf->vertices; k++) vertices |= (uint32_t)vertex[k] << k;
    for (uint32_t k = 0; k < leaf->edges; k++) edges |= (uint32_t)(lost[edge[k][0]] | lost[edge[k][1]]) << k;
    for (uint32_t k = 0; k < leaf->triangles; k++)
        triangles |= (uint32_t)(lost[t[k][0]] | lost[t[k][1]] | lost[t[k][2]]) << k;
    return (sk_hot){(uint8_t)vertices, (uint8_t)edges, (uint8_t)triangles};
}

static void mark_some_hot(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    for (size_t i = begin; i < end; i++) {
        sk_hot hot = touch->anew[i] ? hot_of(touch, &touch->skin.leaf[i]) : (sk_hot){0, 0, 0};
        touch->hot[i] = hot;
    }
}

void sk_touch_mark_hot(sk_touch *touch) {
    const sk_skin *skin = &touch->skin;
    const uint8_t *lost = touch->lost;
    touch->everybody = !memchr(lost, 0, skin->vertex_count);
    memset(touch->anew, touch->everybody, skin->leaf_count);
    for (size_t v = 0; v < skin->vertex_count && !touch->everybody; v++)
        if (lost[v]) mark_leaves_of(skin, v, touch->anew);
    sk_parallel_pieces(touch->tasks, 0, skin->leaf_count, AT_ONCE, mark_some_hot, touch);
}
