/* The bound on vertices' ways in a substep: after it no pair has met, wherever other rules wanted its corners to be.
 *
 * For each pair that may close, its nearest points before the substep give a normal; the gap is what lies between its
 * features along it. Corners move along straight lines, so a gap that is left at the end was there all the way. Where
 * none is left, a plane between the features is what neither may pass, and corners go but a share of their ways. Other
 * pairs are looked at again with these shares, until no more planes are needed. Where a plane across an axis keeps
 * features far apart, before and after, it does for any shares, and no other is needed.
 *
 * A plane goes along with what both features do: where a bundle of folds is pulled along, nobody is stopped by who goes
 * before him. It holds for the shares that it was found with; when they get smaller the pair is looked at again, at most
 * twice so, and then has a plane that stands, which holds for any smaller share. (Where all stood, in the frame of what the whole
 * mesh does in the mean, a sheet that was led by one vertex at 5 m/s on a circle of 0.5 m got 1,000 % of stretch and 300 to 500
 * crossings, in frames of a second; with planes that go along 11 %, none, in 50 ms; at 10 m/s it has them again. Three times:
 * 11 % at 10 m/s, too, but of 56 wound sheets 3 were driven through themselves by their pins, and of as many with two none.)
 * Planes that stand do so in the frame of what all go together, or of what pins do, if that is less, as far as it leads nobody into a collider.
 * (Always in that of all, pins that stood came up against what hung beside them while bodies flew by, and yielded to nobody: of 12 curtains at which dice
 * were thrown from both sides, with as many substeps as that takes, 11 were driven through themselves, 1,987 crossings and 624 ms a frame; now none,
 * 39 ms. Always in that of pins a sheet from under which a plate was led away at 540 m/s flew 44 m high; in that of the world of 24 sheets led in circles by
 * one pin at 8 and 10 m/s seven were torn.) */
#include <string.h>

#include "base/tasks.h"
#include "contact/touch.h"
#include "plan/solve.h"

/* ---- ways ---- */

/* A mean of ways. */
typedef struct mean_way {
    double x, y, z;
    size_t count;
} mean_way;

static inline void add_way(mean_way *mean, sk_vec3 way) {
    mean->x += (double)way.x, mean->y += (double)way.y, mean->z += (double)way.z;
    mean->count++;
}

static sk_vec3 mean_of(const mean_way *sum) {
    const double share = sum->count ? 1 / (double)sum->count : 0;
    return (sk_vec3){(real)(share * sum->x), (real)(share * sum->y), (real)(share * sum->z)};
}

/* What all vertices that are free go together, in the mean, or what pinned ones do, whichever is less. */
static sk_vec3 common_way(const sk_touch *touch) {
    mean_way of_free = {0, 0, 0, 0}, of_pinned = {0, 0, 0, 0};
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const sk_vec3 way = sk_sub(sk_xyz(touch->q[v]), sk_xyz(touch->p[v]));
        if (!(sk_dot(way, way) < (real)1e12)) continue; // blown up
        if (touch->inverse[v] > 0) add_way(&of_free, way);
        else add_way(&of_pinned, way);
    }
    const sk_vec3 with_pins = mean_of(&of_pinned), mean = mean_of(&of_free);
    return of_pinned.count && sk_dot(with_pins, with_pins) < sk_dot(mean, mean) ? with_pins : mean;
}

/* What of a common way leads no one into the collider that holds them up: planes that go along with what falls would
 * take what is pressed on the ground into it. Along each normal the way leads as far as who is held up goes; sideways
 * nothing is changed, so that what slides together is not held back. */
static sk_vec3 supported_way(const sk_touch *touch, const sk_run *run, const sk_op *op, sk_vec3 way) {
    const sk_vec4 *support = run->vector[SK_SUPPORT];
    if (!support || !*run->supported) return way;
    uint32_t *held_up = touch->waiting; // nobody waits yet
    size_t count = 0;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const sk_vec3 n = sk_xyz(sk_load(support, op->packed, touch->slot[v]));
        if (sk_dot(n, n) > 0) held_up[count++] = (uint32_t)v;
    }
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < count; i++) {
            const uint32_t v = held_up[i];
            const sk_vec3 n = sk_xyz(sk_load(support, op->packed, touch->slot[v]));
            const real missing = sk_dot(n, sk_sub(sk_sub(sk_xyz(touch->q[v]), sk_xyz(touch->p[v])), way));
            if (missing > 0 && missing < (real)1e6) way = sk_add(way, sk_scale(missing, n));
        }
    return way;
}

typedef struct loading {
    sk_touch *touch;
    const sk_run *run;
    const sk_op *op;
} loading;

static void load_some_ends(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const loading *job = data;
    for (size_t v = begin; v < end; v++)
        job->touch->q[v] = sk_load(job->run->vector[SK_X], job->op->packed, job->touch->slot[v]);
}

/* Threads raise the same number: the most stays, whoever comes first. */
static void raise_to(real *most, real one) {
    real now;
    __atomic_load(most, &now, __ATOMIC_RELAXED);
    while (one > now && !__atomic_compare_exchange(most, &now, &one, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
}

static void find_some_ways(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = ((const loading *)data)->touch;
    real longest = 0;
    for (size_t v = begin; v < end; v++) {
        sk_vec3 way = sk_sub(sk_sub(sk_xyz(touch->q[v]), sk_xyz(touch->p[v])), touch->common);
        real length = sk_length(way);
        if (!(length < (real)1e6)) way = (sk_vec3){0, 0, 0}, length = 0; // blown up: it meets nobody
        touch->way[v] = (sk_vec4){way.x, way.y, way.z, length};
        longest = sk_max(longest, length);
        touch->share[v] = touch->next_share[v] = 1;
    }
    raise_to(&touch->longest, longest);
}

/* Loads the places before and after the substep, and finds out what ways lead from one to the other. */
static void load_ways(sk_touch *touch, const sk_run *run, const sk_op *op) {
    enum { AT_ONCE = 2048 };
    const size_t count = touch->skin.vertex_count;
    loading job = {touch, run, op};
    touch->aimed = false;
    touch->stand = touch->p;
    sk_touch_load(touch, op->packed);
    sk_parallel_pieces(touch->tasks, 0, count, AT_ONCE, load_some_ends, &job);
    touch->common = supported_way(touch, run, op, common_way(touch));
    touch->longest = 0;
    sk_parallel_pieces(touch->tasks, 0, count, AT_ONCE, find_some_ways, &job);
}

bool sk_touch_search_ways(sk_touch *touch, sk_allocator *allocator) {
    for (size_t v = 0; v < touch->skin.vertex_count; v++)
        if (touch->lost[v] && !touch->wild[v]) sk_touch_put_course(touch, v, true);
    return sk_touch_renew(touch, allocator, SK_SEARCH_WAYS);
}

/* ---- planes ---- */

/* A pair along its normal: where its corners are, and how far they go at their present shares. */
typedef struct line {
    uint32_t v[4];
    real at[4], way[4], whole_way[4];
    int first; /* corners of the first feature: the upper one */
} line;

static line line_of(const sk_touch *touch, const sk_pairs *pairs, int sort, size_t k) {
    line l = {.first = sort == SK_EDGES ? 2 : 1};
    sk_vec3 n = {pairs->normal[0][k], pairs->normal[1][k], pairs->normal[2][k]};
    for (int c = 0; c < 4; c++) {
        uint32_t v = l.v[c] = pairs->corner[c][k];
        l.at[c] = sk_dot(n, sk_sub(sk_xyz(touch->stand[v]), sk_xyz(touch->stand[l.v[0]])));
        l.whole_way[c] = sk_dot(n, sk_xyz(touch->way[v]));
        l.way[c] = touch->share[v] * l.whole_way[c];
    }
    return l;
}

/* The lowest of the upper feature and the highest of the lower one, before and after; and that of pinned corners alone. */
typedef struct gap {
    real low, high, low_after, high_after, pinned_low, pinned_high;
} gap;

static gap gap_of(const sk_touch *touch, const line *l) {
    gap g = {SK_REAL_MAX, -SK_REAL_MAX, SK_REAL_MAX, -SK_REAL_MAX, SK_REAL_MAX, -SK_REAL_MAX};
    for (int c = 0; c < 4; c++) {
        real at = l->at[c], after = at + l->way[c];
        bool pinned = !(touch->inverse[l->v[c]] > 0);
        if (c < l->first) {
            g.low = sk_min(g.low, at), g.low_after = sk_min(g.low_after, after);
            if (pinned) g.pinned_low = sk_min(g.pinned_low, after);
        } else {
            g.high = sk_max(g.high, at), g.high_after = sk_max(g.high_after, after);
            if (pinned) g.pinned_high = sk_max(g.pinned_high, after);
        }
    }
    return g;
}

/* Divides the room between the features, as they use it; what is pinned takes all that it wants. */
static void divide(const gap *g, real room, real *upper, real *lower) {
    real down = sk_max(0, g->low - g->low_after), up = sk_max(0, g->high_after - g->high);
    *upper = down + up > 0 ? room * (down / (down + up)) : 0;
    *lower = room - *upper;
    real pinned_down = g->low - g->pinned_low, pinned_up = g->pinned_high - g->high;
    if (pinned_down > *upper) *upper = pinned_down, *lower = sk_max(0, room - pinned_down);
    if (pinned_up > *lower) *lower = pinned_up, *upper = sk_max(0, room - pinned_up);
}

/* Threads lower shares of the same vertices: the least one stays, whoever comes first. */
static void lower_to(real *next, real share) {
    real now;
    __atomic_load(next, &now, __ATOMIC_RELAXED);
    while (share < now && !__atomic_compare_exchange(next, &now, &share, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
}

/* Lowers the shares of corners that would pass their side of the plane. */
static bool lower_shares(sk_touch *touch, const line *l, const gap *g, real upper, real lower) {
    bool lowered = false;
    for (int c = 0; c < 4; c++) {
        uint32_t v = l->v[c];
        if (!(touch->inverse[v] > 0)) continue;
        bool is_upper = c < l->first;
        real way = is_upper ? -l->whole_way[c] : l->whole_way[c];
        real room = is_upper ? l->at[c] - g->low + upper : g->high + lower - l->at[c];
        if (!(way > 0) || !(room < touch->share[v] * way)) continue;
        real share = sk_max(0, room) / way * (real)0.9999;
        lower_to(&touch->next_share[v], share);
        lowered = true;
    }
    return lowered;
}

/* Whether its features are apart along an axis before and after, on one side, by what is not near. */
static bool are_apart(const sk_touch *touch, const line *l) {
    const real near = SK_NEAR_THICKNESSES * touch->thickness;
    sk_vec3 low[2][2], high[2][2]; // of each feature, before and after
    for (int c = 0; c < 4; c++)
        for (int end = 0; end < 2; end++) {
            sk_vec3 x = sk_xyz((end ? touch->stand : touch->p)[l->v[c]]);
            if (end) x = sk_add(x, sk_scale(touch->share[l->v[c]], sk_xyz(touch->way[l->v[c]])));
            int f = c >= l->first;
            bool new = c == 0 || c == l->first;
            low[f][end] =
                new ? x : (sk_vec3){sk_min(low[f][end].x, x.x), sk_min(low[f][end].y, x.y), sk_min(low[f][end].z, x.z)};
            high[f][end] =
                new ? x
                    : (sk_vec3){sk_max(high[f][end].x, x.x), sk_max(high[f][end].y, x.y), sk_max(high[f][end].z, x.z)};
        }
    bool apart = false;
    for (int f = 0; f < 2; f++) {
        sk_vec3 a = sk_sub(low[f][0], high[1 - f][0]), b = sk_sub(low[f][1], high[1 - f][1]);
        apart |= (a.x >= near && b.x >= near) || (a.y >= near && b.y >= near) || (a.z >= near && b.z >= near);
    }
    return apart;
}

/* Threads put pairs down as they come. */
static void note_divided(sk_touch *touch, const sk_pairs *pairs, int sort, size_t k) {
    sk_divided_list *list = &touch->divided[sort];
    list->data[__atomic_fetch_add(&list->count, 1, __ATOMIC_RELAXED)] =
        (sk_divided){.key = pairs->key[k],
                     .corner = {pairs->corner[0][k], pairs->corner[1][k], pairs->corner[2][k], pairs->corner[3][k]},
                     .normal = {pairs->normal[0][k], pairs->normal[1][k], pairs->normal[2][k]},
                     .thickness = pairs->thickness[k]};
}

/* What both features go together along the normal. */
static real together(const gap *g) {
    const real upper = g->low_after - g->low, lower = g->high_after - g->high;
    return upper > 0 && lower > 0 ? sk_min(upper, lower) : upper < 0 && lower < 0 ? sk_max(upper, lower) : 0;
}

/* A gap as it is seen by what goes along. */
static gap seen_along(gap g, real along) {
    g.low_after -= along, g.high_after -= along, g.pinned_low -= along, g.pinned_high -= along;
    return g;
}

/* Whether a pair would close, and needs planes. They go along with what both features do together, if that leaves them room, for so
 * many rounds as `settled` has marks for; when their corners' shares have been lowered again so that it closes all the same, they stand. */
static bool settle_pair(sk_touch *touch, sk_pairs *pairs, int sort, size_t k, real least) {
    const real known = (real)1.001; // of the room that planes have left
    line l = line_of(touch, pairs, sort, k);
    gap g = gap_of(touch, &l);
    const uint8_t settled = pairs->settled[k];
    real before = g.low - g.high, after = g.low_after - g.high_after;
    real room = sk_max(0, (1 - SK_LEFT_OVER) * (before - least));
    if (after >= before || after >= before - (settled ? known * room : room) || are_apart(touch, &l)) return false;
    if (!settled) note_divided(touch, pairs, sort, k);
    const real along = touch->implicit || settled == SK_GOES_ALONG_AGAIN ? 0 : together(&g);
    pairs->settled[k] = along == 0 ? SK_IS_DIVIDED : settled ? SK_GOES_ALONG_AGAIN : SK_GOES_ALONG;
    const gap seen = seen_along(g, along);
    real upper, lower;
    divide(&seen, room, &upper, &lower);
    if (upper + lower > sk_max(0, before)) { // by what is pinned
        pairs->settled[k] = SK_IS_FORCED;
        __atomic_store_n(&touch->tangle.forced, true, __ATOMIC_RELAXED);
    }
    return lower_shares(touch, &l, &g, upper - along, lower + along);
}

/* A round, by several threads: what is looked at, and whether anything has been found. */
typedef struct bound_round {
    sk_touch *touch;
    int sort;
    bool first, found;
    real least;
} bound_round;

static void take_some_shares(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    bound_round *job = data;
    sk_touch *touch = job->touch;
    const sk_vec3 common = touch->common, gone = sk_sub(touch->shift[1], touch->shift[0]);
    const real jump = sk_most_jump(touch);
    bool any = false;
    memset(touch->lost + begin, 0, end - begin);
    for (size_t v = begin; v < end; v++) {
        touch->lowered[v] = touch->next_share[v] < touch->share[v];
        if (!touch->lowered[v]) continue;
        real share = touch->share[v] = touch->next_share[v];
        sk_vec3 step = sk_scale(share, sk_xyz(touch->way[v])),
                to = sk_add(sk_add(sk_xyz(touch->stand[v]), common), step);
        if (touch->wild[v]) continue;
        sk_vec3 off = sk_sub(sk_sub(to, touch->shift[1]), sk_expected(&touch->course[v], touch->now + 1));
        sk_vec3 other = sk_sub(sk_sub(sk_add(common, step), gone), touch->course[v].step);
        touch->lost[v] =
            sk_dot(off, off) > touch->course[v].reach * touch->course[v].reach || sk_dot(other, other) > jump * jump;
        any |= touch->lost[v];
    }
    if (any) __atomic_store_n(&job->found, true, __ATOMIC_RELAXED);
}

/* Takes the shares that a round has found; returns whether a vertex is lost where it goes now. */
static bool take_shares(sk_touch *touch) {
    enum { AT_ONCE = 2048 };
    bound_round job = {.touch = touch};
    sk_parallel_pieces(touch->tasks, 0, touch->skin.vertex_count, AT_ONCE, take_some_shares, &job);
    return job.found;
}

/* Those that are held back may come near their own surface: pairs of patches that were calm are kept, and vertices of panels
 * that were spread are lost; in a storm, whose searches are for all, so are all others. */
static bool disturb(sk_touch *touch, sk_allocator *allocator, bool *lost) {
    bool good = true;
    for (size_t v = 0; v < touch->skin.vertex_count && good; v++) {
        if (!touch->lowered[v]) continue;
        good = sk_calm_disturb(touch, allocator, v);
        if (touch->spread.count) sk_spread_disturb(touch, v);
    }
    const bool came_in = sk_spread_come_in(touch);
    if (came_in && touch->storm) memset(touch->lost, 1, touch->skin.vertex_count);
    *lost |= came_in;
    return good;
}

typedef struct closing {
    const sk_touch *touch;
    const sk_pairs *pairs;
    int sort;
    sk_closing_values values;
} closing;

static void find_closing(void *data, size_t begin, size_t end) {
    const closing *job = data;
    sk_pairs some = sk_pairs_between(job->pairs, begin, end);
    sk_closing[job->sort][job->touch->isa](job->touch->stand, job->touch->way, &job->values, &some);
}

/* Of those from a pair on. */
typedef struct listing {
    sk_closing_list *list;
    const sk_pairs *pairs;
    size_t first;
    uint32_t late;
} listing;

/* Threads put what they have found there as they come. */
static void put_closing(sk_closing_list *list, const sk_closing_pair *found, size_t count) {
    size_t at = __atomic_fetch_add(&list->count, count, __ATOMIC_RELAXED);
    memcpy(list->data + at, found, count * sizeof *found);
}

/* Of blocks of eight. */
static void list_some_that_may(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    enum { SOME = 128 };
    const listing *job = data;
    const sk_pairs *pairs = job->pairs;
    sk_closing_pair found[SOME];
    size_t n = 0;
    for (size_t b = 8 * begin; b < 8 * end; b += 8) {
        for (uint64_t bits = sk_pairs_that(pairs, b, SK_MAY_CLOSE); bits; bits &= bits - 1) {
            size_t k = b + sk_first_of(bits);
            if (k < job->first || !(pairs->thickness[k] > 0)) continue;
            found[n++] =
                (sk_closing_pair){2 * (uint32_t)k + job->late,
                                  {pairs->corner[0][k], pairs->corner[1][k], pairs->corner[2][k], pairs->corner[3][k]}};
        }
        if (n + 8 <= SOME && b + 8 < 8 * end) continue;
        if (n) put_closing(job->list, found, n);
        n = 0;
    }
}

bool sk_touch_list_closing(sk_touch *touch, sk_allocator *allocator, real least, bool all) {
    enum { BLOCKS_AT_ONCE = 1024 };
    const real known = (real)0.01; // thicknesses: nearest points of edges that are all but parallel
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        sk_closing_list *list = &touch->may_close[sort];
        sk_pairs *pairs[] = {&touch->kept[sort], &touch->late[sort]};
        size_t first[] = {0, all ? 0 : touch->told_apart[sort]};
        size_t room = all ? pairs[0]->count + pairs[1]->count : list->count + pairs[1]->count - first[1];
        if (!SK_RESERVE(allocator, list, room + 1)) return false;
        if (all) list->count = 0;
        for (uint32_t late = all ? 0 : 1; late < 2; late++) {
            closing job = {touch, pairs[late], sort, {least, known * touch->thickness, touch->longest}};
            sk_parallel_for(touch->tasks, first[late] / 16 * 16, pairs[late]->count, find_closing, &job);
            listing found = {list, pairs[late], first[late], late};
            sk_parallel_pieces(touch->tasks, first[late] / 8, (pairs[late]->count + 7) / 8, BLOCKS_AT_ONCE,
                               list_some_that_may, &found);
        }
        touch->told_apart[sort] = pairs[1]->count;
    }
    return true;
}

static void settle_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    bound_round *job = data;
    sk_touch *touch = job->touch;
    const uint8_t *lowered = touch->lowered;
    const sk_closing_pair *list = touch->may_close[job->sort].data;
    bool any = false;
    for (size_t i = begin; i < end; i++) {
        const uint32_t *v = list[i].corner, entry = list[i].entry;
        if (touch->tangle.any && sk_pair_is_tangled(touch, v, job->sort)) continue;
        if (!job->first && !(lowered[v[0]] | lowered[v[1]] | lowered[v[2]] | lowered[v[3]])) continue;
        sk_pairs *pairs = entry & 1 ? &touch->late[job->sort] : &touch->kept[job->sort];
        size_t k = entry / 2;
        if (job->first ? pairs->closes[k] & SK_CLOSES : pairs->settled[k] < SK_IS_DIVIDED)
            any |= settle_pair(touch, pairs, job->sort, k, job->least);
    }
    if (any) __atomic_store_n(&job->found, true, __ATOMIC_RELAXED);
}

/* The first round looks at all pairs, the others at those with a corner whose share the round before has lowered. */
static bool settle_pairs(sk_touch *touch, int sort, bool first, real least) {
    enum { AT_ONCE = 2048 };
    bound_round job = {.touch = touch, .sort = sort, .first = first, .least = least};
    sk_parallel_pieces(touch->tasks, 0, touch->may_close[sort].count, AT_ONCE, settle_some, &job);
    return job.found;
}

static void unsettle(sk_pairs *pairs) {
    if (pairs->count) memset(pairs->settled, 0, pairs->count);
}

/* Each round looks at shares as the round before left them, so no order counts. */
static bool find_shares(sk_touch *touch, sk_allocator *allocator, real least) {
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        unsettle(&touch->kept[sort]), unsettle(&touch->late[sort]);
        touch->divided[sort].count = 0;
    }
    if (!sk_touch_list_closing(touch, allocator, least, true)) return false;
    for (bool first = true;; first = false) {
        bool lowered = false;
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
            sk_divided_list *list = &touch->divided[sort];
            if (!SK_RESERVE(allocator, list, list->count + touch->may_close[sort].count)) return false;
            lowered |= settle_pairs(touch, sort, first, least);
        }
        if (!lowered) return true;
        if (touch->corrects) sk_touch_hold_taut(touch);
        bool lost = take_shares(touch);
        if (!disturb(touch, allocator, &lost) || (lost && !sk_touch_search_ways(touch, allocator)) ||
            !sk_touch_list_closing(touch, allocator, least, lost && touch->storm))
            return false;
    }
}

/* ---- the op ---- */

/* Who is held back is where the bound lets it, and its velocity what impact.c says. */
static bool store_ways(sk_touch *touch, sk_allocator *allocator, const sk_run *run, const sk_op *op, bool solved) {
    bool any = false;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        if (!(touch->share[v] < 1)) continue;
        any = true;
        const sk_vec3 from = sk_add(sk_xyz(touch->stand[v]), touch->common);
        sk_store_at(run->vector[SK_X], op->packed, touch->slot[v],
                    sk_add(from, sk_scale(touch->share[v], sk_xyz(touch->way[v]))));
    }
    if (!any) return true;
    sk_touch_lose_velocities(touch, run, op);
    return !solved || sk_touch_share_velocities(touch, allocator, run, op);
}

/* Where all panels lie spread out, and no pairs are kept, it is asked whether they still do, and nothing else. */
static bool stay_all_out(sk_touch *touch, const sk_vec4 *x, const sk_op *op) {
    const real way = sk_spread_longest_way(touch, x, op->packed);
    touch->shift[1] = touch->shift[0];
    if (sk_spread_holds(&touch->spread, way)) return true;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) touch->q[v] = sk_load(x, op->packed, touch->slot[v]);
    memset(touch->lost, 0, touch->skin.vertex_count);
    return !sk_spread_follow(touch, way);
}

static bool bound(sk_touch *touch, sk_run *run, const sk_op *op, bool solved) {
    real least = SK_LEAST_GAP * touch->thickness;
    const sk_vec4 *x = run->vector[SK_X];
    const bool all_out = sk_spread_is_all_out(&touch->spread) && !sk_pairs_kept(touch),
               some_out = touch->spread.out_count > 0;
    bool lost = all_out;
    if (all_out && stay_all_out(touch, x, op)) {
        if (touch->before != touch->copied) touch->before = NULL; // the method keeps it no longer
        return true;
    }
    if (touch->before != touch->copied) sk_touch_copy_start(touch);
    if (!all_out) {
        sk_touch_set_frame(touch, x, op->packed, touch->now + 1, 1);
        lost = sk_touch_mark_lost(touch, x, op->packed, touch->now + 1, 1) || touch->wild_count;
    }
    if (!lost && !some_out && !sk_pairs_kept(touch) && sk_calm_holds(touch, touch->farthest)) return true;
    load_ways(touch, run, op);
    if (touch->storm) touch->shift[1] = touch->common;
    if (all_out) sk_spread_follow_held(touch);
    else if (some_out) lost |= sk_spread_follow(touch, SK_REAL_MAX);
    if (!lost && some_out && !sk_pairs_kept(touch) && sk_calm_holds(touch, touch->farthest)) return true;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) touch->lost[v] |= touch->wild[v];
    sk_torn_know(touch, op->packed);
    bool good = sk_calm_follow(touch, run->allocator) && (!lost || sk_touch_search_ways(touch, run->allocator));
    if (good && sk_pairs_kept(touch)) {
        const bool was = touch->tangle.forced;
        touch->tangle.forced = false;
        good = find_shares(touch, run->allocator, least);
        if (good && touch->tangle.forced && sk_touch_is_passed(touch)) {
            touch->tangle.forced = false;
            good = sk_touch_yield(touch, run->allocator, least) && find_shares(touch, run->allocator, least);
        }
        touch->tangle.forced |= was;
        good = good && store_ways(touch, run->allocator, run, op, solved);
    }
    return good;
}

void sk_touch_bound(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    const sk_force *force = op->rule;
    sk_touch *touch = force->state;
    if (!touch) return;
    if (touch->found) {
        if (touch->before != touch->copied) touch->before = run->vector[op->source[2]];
        touch->followed = bound(touch, run, op, true);
        touch->start_is_kept = op->source[2] != SK_NONE;
        touch->frame_step = sk_sub(touch->shift[1], touch->shift[0]);
        run->no_memory |= !touch->followed;
    }
    if (touch->tangle.any) sk_touch_part_solids(touch, run, op);
    bool keeps = touch->found && touch->followed;
    run->no_memory |= !sk_tangle_leave(touch, run->allocator, run->vector[SK_X], keeps, run->last_iteration);
}

void sk_touch_hold(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = ((const sk_force *)op->rule)->state;
    if (!touch || !touch->found) return;
    const size_t count = touch->skin.vertex_count;
    touch->spread.never = true;
    sk_spread_end(touch);
    for (size_t v = 0; v < count; v++) touch->share[v] = 1; // of who has no pairs, the bound says nothing
    run->no_memory |= !bound(touch, run, op, false) || !sk_touch_look_again(touch, run->allocator);
    for (size_t v = 0; v < count; v++) {
        if (!(touch->share[v] < 1) || !(touch->inverse[v] > 0)) continue;
        sk_store_at(run->vector[SK_FILTER0], op->packed, touch->slot[v], (sk_vec3){0, 0, 0});
        sk_store_at(run->vector[SK_FILTER1], op->packed, touch->slot[v], (sk_vec3){0, 0, 0});
        run->solve->held++;
    }
}
