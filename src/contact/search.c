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

enum { AT_ONCE = 1024 }; /* vertices or leaves that a thread takes at a time */

/* ---- how near a pair has to be ---- */

/* A vertex' part of it: what is no nearer than the sum of both features' parts, along one axis and on one side before a
 * substep and after it, is neither near nor closes (bound.c). */
static real part_of(const sk_touch *touch, real reach) {
    return reach + ((real)0.5 * SK_NEAR_THICKNESSES + rounding) * touch->thickness;
}

/* ---- boxes ---- */

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

/* The way that a vertex may still go. */
static sk_vec3 way_left(const sk_touch *touch, size_t v) {
    return sk_scale(touch->share[v], sk_xyz(touch->way[v]));
}

/* The box of a way, whatever share of it is gone, in the frame of courses; of a place, where the way is none. */
static sk_box box_of_way(const sk_touch *touch, size_t v, bool way) {
    sk_vec3 from = sk_sub(sk_xyz(touch->p[v]), touch->shift[0]), none = from, all = from;
    if (way) { // of none of its way it goes what all go together, whether the frame does or not
        none = sk_sub(sk_add(sk_xyz(touch->p[v]), touch->common), touch->shift[1]);
        all = sk_add(none, way_left(touch, v));
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
    sk_box *box = &touch->leaf_box[i], other;
    if (leaf->triangles) box_of(touch->corner_box, skin->triangle[leaf->first_triangle], 3, box);
    else box_of(touch->corner_box, skin->edge[leaf->first_edge], 2, box);
    for (size_t k = 1; k < leaf->triangles; k++) {
        box_of(touch->corner_box, skin->triangle[leaf->first_triangle + k], 3, &other);
        sk_box_widen(box, &other);
    }
    touch->featured[i] = 0;
    if (!has_blown_up(touch, leaf, box)) return;
    const sk_quad most = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0};
    *box = (sk_box){{most, most}, {-most, -most}};
    __atomic_store_n(&touch->tangle.torn, true, __ATOMIC_RELAXED);
}

void sk_touch_feature_boxes(sk_touch *touch, size_t i) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *leaf = &skin->leaf[i];
    touch->featured[i] = 1;
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
    const sk_quad most = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0};
    sk_box box = {{most, most}, {-most, -most}};
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
        if (touch->moved[i]) sk_touch_leaf_box(touch, i);
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
        if (touch->featured[i] == 2) sk_touch_feature_boxes(touch, i), sk_touch_leaf_cells(touch, i);
}

/* Threads may find the same leaf: all say the same of it. */
static void find_unfeatured(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    const uint32_t *first = touch->first.data, *partner = touch->partner.data;
    for (size_t i = begin; i < end; i++)
        for (int k = 0; k < 2; k++) {
            uint8_t *featured = &touch->featured[k ? partner[i] : first[i]];
            if (!__atomic_load_n(featured, __ATOMIC_RELAXED)) __atomic_store_n(featured, 2, __ATOMIC_RELAXED);
        }
}

/* Of features, boxes are made where their leaf meets another: few do, of a surface that touches nothing. */
static void box_features(sk_touch *touch) {
    enum { PARTNERS_AT_ONCE = 4096 };
    sk_parallel_pieces(touch->tasks, 0, touch->partner.count, PARTNERS_AT_ONCE, find_unfeatured, touch);
    if (!memchr(touch->featured, 2, touch->skin.leaf_count)) return;
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
        bool lost = touch->lost[v], wild = touch->wild[v];
        if (job->all || lost || (wild && job->wild)) make_vertex_box(touch, v, touch->still || (job->ways && (lost | wild)));
    }
}

static void make_boxes(sk_touch *touch, sk_touch_search_sort sort) {
    bool all = sort == SK_SEARCH_ALL || !touch->boxed || touch->still;
    size_t leaves = touch->skin.leaf_count;
    if (all) touch->cells = sk_cells_a_metre(touch), touch->tangle.torn = false;
    if (all) memset(touch->moved, 1, leaves);
    else memcpy(touch->moved, touch->anew, leaves);
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

/* Marks vertices that are lost, edges and triangles that have one, and the leaves of all these. */
static void mark_hot(sk_touch *touch) {
    const sk_skin *skin = &touch->skin;
    const uint8_t *lost = touch->lost;
    touch->everybody = !memchr(lost, 0, skin->vertex_count);
    memset(touch->anew, touch->everybody, skin->leaf_count);
    for (size_t v = 0; v < skin->vertex_count && !touch->everybody; v++)
        if (lost[v]) mark_leaves_of(skin, v, touch->anew);
    sk_parallel_pieces(touch->tasks, 0, skin->leaf_count, AT_ONCE, mark_some_hot, touch);
}

/* ---- pairs ---- */

/* Takes those that may come near over. */
static void keep_near(const sk_touch *touch, const sk_pairs *pairs, sk_pairs *fresh, int sort, bool ways) {
    sk_nearing_values values = {.near = SK_NEAR_THICKNESSES * touch->thickness,
                                .rounding = 2 * rounding * touch->thickness,
                                .closing = closing_share,
                                .per = 1 / (touch->until - touch->now)};
    if (ways)
        values = (sk_nearing_values){.near = (SK_NEAR_THICKNESSES + rounding) * touch->thickness,
                                     .shares = 1 - 1 / closing_share};
    const size_t first = fresh->count;
    sk_nearing[sort][touch->isa](touch->at, touch->in_the_end, &values, pairs, fresh);
    memset(fresh->settled + first, 0, fresh->count - first);
    sk_touch_set_thickness(touch, fresh, first, sort);
}

enum { BATCH = 2048 }; /* pairs: what is done with them is done while they are in the cache */

/* Lists pairs of features whose boxes may meet, of a part's next leaves. */
static void fill_batch(const sk_parts_job *job, sk_search_part *part) {
    const uint32_t *first = job->touch->first.data, *partner = job->touch->partner.data;
    for (part->batch.count = 0; part->next < part->end;) {
        size_t room = (BATCH - part->batch.count) / SK_LEAVES_PAIRS, count = 1;
        if (!room) break;
        if (room > part->end - part->next) room = part->end - part->next;
        const uint32_t a = first[part->next];
        while (count < room && first[part->next + count] == a) count++;
        sk_features[job->sort][job->touch->isa](job->touch, &part->batch, a, partner + part->next, count);
        part->next += count;
    }
    sk_pairs_pad(&part->batch);
}

/* Finds those of a part's leaves that may come near. */
static void find_fresh(const sk_parts_job *job, sk_search_part *part) {
    while (part->next < part->end) {
        if (part->batch.capacity < BATCH || part->fresh.capacity < part->fresh.count + BATCH) return;
        fill_batch(job, part);
        keep_near(job->touch, &part->batch, &part->fresh, job->sort, job->search == SK_SEARCH_WAYS);
    }
    sk_pairs_pad(&part->fresh);
}

static bool grow_fresh(sk_search_part *part, sk_allocator *allocator) {
    return sk_pairs_reserve(&part->batch, allocator, BATCH) &&
           sk_pairs_reserve(&part->fresh, allocator, 2 * part->fresh.capacity + 4 * BATCH);
}

/* Puts what the parts have found together, one after the other. */
static void put_together(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    size_t before = 0;
    for (int i = 0; i < touch->part_count; i++) {
        const sk_pairs *fresh = &touch->part[i].fresh;
        size_t first = begin > before ? begin - before : 0, last = end > before ? end - before : 0;
        if (last > fresh->count) last = fresh->count;
        if (first < last) sk_pairs_put(&touch->fresh, before + first, fresh, first, last);
        before += fresh->count;
    }
}

/* Finds the pairs of a sort that may come near, in order. */
static bool list_fresh(sk_touch *touch, sk_allocator *allocator, int sort, sk_touch_search_sort search) {
    enum { WORTH = 256, PAIRS_AT_ONCE = 16384 };
    sk_parts_job job = {.touch = touch, .sort = sort, .search = (int)search, .work = find_fresh, .grow = grow_fresh};
    for (int i = 0; i < SK_MOST_PARTS; i++) touch->part[i].fresh.count = 0;
    if (!sk_touch_work(&job, allocator, touch->partner.count, WORTH)) return false;
    size_t count = 0;
    for (int i = 0; i < touch->part_count; i++) count += touch->part[i].fresh.count;
    sk_pairs other = touch->fresh;
    touch->fresh = touch->part[0].fresh, touch->part[0].fresh = other;
    if (touch->part_count == 1) return true;
    // of the first part all is in its place
    size_t first = touch->fresh.count;
    touch->part[0].fresh.count = first;
    if (!sk_pairs_reserve(&touch->fresh, allocator, count)) return false;
    sk_parallel_pieces(touch->tasks, first, count, PAIRS_AT_ONCE, put_together, touch);
    touch->fresh.count = count;
    sk_pairs_pad(&touch->fresh);
    return true;
}

/* ---- the search ---- */

/* A horizon at which what goes its own way has gone some thicknesses. */
static void look_ahead(sk_touch *touch) {
    // where little is kept, boxes may be wide, and it is who leaves its course that is looked for
    const real least = touch->untouched ? 6 : 2;
    // what is kept for longer than some substeps costs more than the next search
    const real longest = touch->untouched ? 640 : 40;
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

/* From where to where vertices go in this substep: most are known if somebody has asked before. */
static void aim(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    for (size_t v = begin; v < end; v++) {
        if (touch->aimed && !touch->lost[v]) continue;
        sk_vec3 to = sk_add(sk_xyz(touch->p[v]), way_left(touch, v));
        touch->at[v] = touch->p[v];
        touch->in_the_end[v] = (sk_vec4){to.x, to.y, to.z, 0};
    }
}

/* Where vertices are expected now, with how far off they may be, and in the end. */
static void expect(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    const real jump = SK_MOST_JUMP * touch->thickness;
    for (size_t v = begin; v < end; v++) {
        const sk_course *course = &touch->course[v];
        if (touch->wild[v]) { // its pairs to come are found on its ways
            sk_vec3 here = sk_sub(sk_xyz(touch->p[v]), touch->shift[0]);
            touch->at[v] = touch->in_the_end[v] = (sk_vec4){here.x, here.y, here.z, 0};
            continue;
        }
        sk_vec3 at = sk_expected(course, touch->now), to = sk_expected(course, touch->until);
        touch->at[v] = (sk_vec4){at.x, at.y, at.z, course->reach};
        // (between two places within its reach it is no farther than across)
        touch->in_the_end[v] = (sk_vec4){to.x, to.y, to.z, sk_min(2 * course->reach, jump)};
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
    touch->still = touch->tree.still = search == SK_SEARCH_WAYS && is_many(touch);
    touch->refit |= all || touch->still || !touch->boxed;
    make_boxes(touch, search);
    touch->boxed = !touch->still;
    touch->found = false;
    bool gives_up = false, good = sk_touch_partners(touch, allocator, most, false, &gives_up);
    if (gives_up) {
        touch->given_up++;
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) touch->kept[sort].count = touch->late[sort].count = 0;
    }
    box_features(touch);
    bool ways = search == SK_SEARCH_WAYS;
    sk_parallel_pieces(touch->tasks, 0, count, AT_ONCE, ways ? aim : expect, touch);
    touch->aimed = ways;
    for (int sort = 0; sort < SK_PAIR_SORTS && good && !gives_up; sort++)
        good = list_fresh(touch, allocator, sort, search) &&
               sk_touch_keep(touch, allocator, sort, everybody, ways);
    touch->found = good && !gives_up;
    return good;
}
