/* The search for pairs: of vertices that are lost, or of all. Each vertex is expected on a straight course, and boxes go
 * on with it: two that are apart, along one axis and on one side, both when the time begins and when it ends, do not meet
 * in between. So what goes along with its neighbours, however fast, is as far from others as if it stood. Boxes are wider
 * than their features by the reach of vertices and half of how near a pair has to be; of leaves whose boxes may meet,
 * features whose boxes may; of these, those that no plane keeps apart. Pairs are kept in the order of leaves, which is
 * always the same. */
#include <math.h>
#include <string.h>

#include "base/tasks.h"
#include "contact/search/search.h"

/* What is nearer than this share of its way may close in a substep: a little more than 1 / (1 - SK_LEFT_OVER). */
static const real closing_share = (real)1.13;
enum { VERTICES_AT_ONCE = 1024 };

/* ---- pairs ---- */

/* Takes those that may come near over. */
static void keep_near(const sk_touch *touch, const sk_pairs *pairs, sk_pairs *fresh, int sort, bool ways) {
    sk_nearing_values values = {.near = SK_NEAR_THICKNESSES * touch->thickness,
                                .rounding = 2 * SK_SEARCH_ROUNDING * touch->thickness,
                                .closing = closing_share,
                                .per = 1 / (touch->until - touch->now)};
    if (ways)
        values = (sk_nearing_values){.near = (SK_NEAR_THICKNESSES + SK_SEARCH_ROUNDING) * touch->thickness,
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
    size_t count = touch->skin.vertex_count, out = 0;
    for (size_t v = 0; v < count; v++) out += sk_vertex_is_out(&touch->spread, v);
    // where few have left their courses, they will keep to them for longer
    real last = touch->now, most = 4 * touch->lost_since < count - out ? sk_max(10, 2 * last) : 10;
    real longer = touch->lost_since ? 0 : 2 * last;
    touch->lost_since = 0;
    most = sk_min(most, longest), longer = sk_min(longer, longest);
    double drift[3] = {0, 0, 0}, sum = 0;
    for (size_t v = 0; v < count; v++) {
        if (sk_vertex_is_out(&touch->spread, v)) continue;
        sk_vec3 step = touch->course[v].step;
        drift[0] += (double)step.x, drift[1] += (double)step.y, drift[2] += (double)step.z;
    }
    double share = out < count ? 1 / (double)(count - out) : 0;
    touch->drift = (sk_vec3){(real)(share * drift[0]), (real)(share * drift[1]), (real)(share * drift[2])};
    for (size_t v = 0; v < count; v++)
        if (!sk_vertex_is_out(&touch->spread, v)) sum += (double)sk_length(sk_sub(touch->course[v].step, touch->drift));
    real ahead = touch->thickness / (real)(share * sum + 1e-9);
    touch->until = ahead < least ? least : ahead < most ? ahead : most; // of what is no number, too
    if (longer > touch->until) touch->until = longer;
    if (out == count) touch->until = longest;
    touch->now = 0;
}

/* From where to where vertices go in this substep, and how far off these ways they may stand: most are known if somebody has
 * asked before. */
static void aim(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    for (size_t v = begin; v < end; v++) {
        if ((touch->aimed && !touch->lost[v]) || sk_vertex_is_out(&touch->spread, v)) continue;
        const sk_vec4 here = touch->p[v], stand = touch->stand[v];
        const sk_vec3 to = sk_add(sk_xyz(stand), sk_way_left(touch, v));
        const real off = touch->stand == touch->p ? 0 : sk_length(sk_sub(sk_xyz(stand), sk_xyz(here)));
        touch->at[v] = (sk_vec4){here.x, here.y, here.z, off};
        touch->in_the_end[v] = (sk_vec4){to.x, to.y, to.z, 0};
    }
}

/* Where vertices are expected now, with how far off they may be, and in the end. */
static void expect(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    const real jump = sk_most_jump(touch);
    for (size_t v = begin; v < end; v++) {
        if (sk_vertex_is_out(&touch->spread, v)) continue;
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
    sk_touch_mark_hot(touch);
    // for a whole substep and many vertices, smaller boxes that stand are worth making all anew
    touch->still = touch->tree.still = search == SK_SEARCH_WAYS && is_many(touch);
    touch->refit |= !touch->boxed;
    sk_touch_make_boxes(touch, search);
    touch->boxed = !touch->still;
    touch->found = false;
    bool gives_up = false, good = sk_touch_partners(touch, allocator, most, false, &gives_up);
    if (gives_up) {
        touch->given_up++;
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) touch->kept[sort].count = touch->late[sort].count = 0;
    }
    sk_touch_box_features(touch);
    bool ways = search == SK_SEARCH_WAYS;
    sk_parallel_pieces(touch->tasks, 0, count, VERTICES_AT_ONCE, ways ? aim : expect, touch);
    touch->aimed = ways;
    for (int sort = 0; sort < SK_PAIR_SORTS && good && !gives_up; sort++)
        good = list_fresh(touch, allocator, sort, search) && sk_touch_keep(touch, allocator, sort, everybody, ways);
    touch->found = good && !gives_up;
    return good;
}
