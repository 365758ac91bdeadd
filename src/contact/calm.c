/* Which patches are calm: how much their vertices have moved against each other since distances were looked at, sixteen
 * patches at a time, and the distances themselves, of those that have moved too much. */
#include <string.h>

#include "base/kernels.h"
#include "base/tasks.h"
#include "contact/touch.h"
#define SK_UNIT calm

/* How far vertices of each of sixteen patches have moved against each other, at most; squares. A patch may turn as a whole:
 * that takes no distance away. */
typedef struct sk_moves {
    SK_VECTOR_ALIGNED real begin[SK_PATCH_LANES]; /* since distances were looked at, before this substep; */
    SK_VECTOR_ALIGNED real whole[SK_PATCH_LANES]; /* after it, where all of the ways are gone; */
    SK_VECTOR_ALIGNED real any[SK_PATCH_LANES];   /* on any shares of them; */
    SK_VECTOR_ALIGNED real way[SK_PATCH_LANES];   /* in this substep, where it may not turn, on whole ways; */
    SK_VECTOR_ALIGNED real share[SK_PATCH_LANES]; /* and on any shares of them */
} sk_moves;

/* To places q, from p, where all go `common`; without p, of q alone. */
typedef void sk_moves_kernel(const sk_vec4 *p, const sk_vec3 *common, const sk_vec4 *q, const sk_calm *calm,
                             size_t group, sk_moves *moves);
SK_KERNELS(sk_moves_kernel, moves);

#ifdef SK_ISA
#include "contact/lanes.h"

/* A box around moves. */
typedef struct moves_box {
    sk_wide3 low, high;
} moves_box;

SK_INLINE moves_box around(moves_box box, sk_wide3 move) {
    box.low = (sk_wide3){sk_least_wide(box.low.x, move.x), sk_least_wide(box.low.y, move.y),
                         sk_least_wide(box.low.z, move.z)};
    box.high = (sk_wide3){sk_most_wide(box.high.x, move.x), sk_most_wide(box.high.y, move.y),
                          sk_most_wide(box.high.z, move.z)};
    return box;
}

SK_INLINE sk_wide square_across(moves_box box) {
    sk_wide3 r = {box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z};
    return sk_dot_wide(r, r);
}

SK_INLINE sk_wide3 minus(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}

SK_INLINE sk_wide3 scaled(sk_wide a, sk_wide3 b) {
    return (sk_wide3){a * b.x, a * b.y, a * b.z};
}

SK_INLINE sk_wide3 cross(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

SK_INLINE sk_wide3 unit(sk_wide3 a) {
    const sk_wide least = sk_splat((real)1e-30), square = sk_dot_wide(a, a);
    return scaled(sk_splat(1) / sk_wide_sqrt(sk_most_wide(square, least)), a);
}

SK_INLINE sk_wide3 place_of(const sk_vec4 *x, const uint32_t *vertex) {
    sk_wide4 now = sk_gather(x, vertex);
    return (sk_wide3){now.x, now.y, now.z};
}

SK_INLINE sk_wide3 began_at(const real *from) {
    return (sk_wide3){*sk_row(from), *sk_row(from + SK_PATCH_LANES), *sk_row(from + 2 * SK_PATCH_LANES)};
}

/* Three directions that turn with a patch: of its first three vertices. They are at right angles where these are not all but
 * on a line; else nothing is known of moves. */
typedef struct frame {
    sk_wide3 x, y, z;
    sk_mask good;
} frame;

SK_INLINE frame frame_of(sk_wide3 a, sk_wide3 b, sk_wide3 c) {
    const sk_wide least = sk_splat((real)1e-4), some = sk_splat((real)1e-18);
    sk_wide3 along = minus(b, a), other = minus(c, a);
    frame f = {.x = unit(along)};
    sk_wide3 across = cross(f.x, other);
    f.z = unit(across);
    f.y = cross(f.z, f.x);
    f.good = sk_more(sk_dot_wide(across, across), least * sk_dot_wide(other, other) + some) &
             sk_more(sk_dot_wide(along, along), some);
    return f;
}

/* How far a vertex is from where it would be, had its patch only turned; in directions of the patch. */
SK_INLINE sk_wide3 off(const frame *now, const frame *then, sk_wide3 at, sk_wide3 began) {
    return (sk_wide3){sk_dot_wide(now->x, at) - sk_dot_wide(then->x, began),
                      sk_dot_wide(now->y, at) - sk_dot_wide(then->y, began),
                      sk_dot_wide(now->z, at) - sk_dot_wide(then->z, began)};
}

void SK_KERNEL(moves)(const sk_vec4 *p, const sk_vec3 *common, const sk_vec4 *q, const sk_calm *calm, size_t group,
                      sk_moves *moves) {
    enum { ROW = SK_PATCH_LANES, PLACES = 3 * SK_PATCH_LANES };
    const size_t first = calm->row_start[group], end = calm->row_start[group + 1];
    for (size_t l = 0; l < SK_PATCH_LANES && end > first; l += SK_PART) {
        const uint32_t *vertex = calm->row + first * ROW + l;
        const real *from = calm->from + first * PLACES + l;
        const sk_wide far = sk_splat(SK_REAL_MAX);
        const moves_box nothing = {{far, far, far}, {-far, -far, -far}};
        moves_box whole = nothing, begin = nothing, way = nothing;
        sk_wide3 here = place_of(q, vertex), there = began_at(from); // the first vertex, now and then
        frame now = frame_of(here, place_of(q, vertex + ROW), place_of(q, vertex + 2 * ROW));
        frame then = frame_of(there, began_at(from + PLACES), began_at(from + 2 * PLACES));
        if (p) here = minus(here, (sk_wide3){sk_splat(common->x), sk_splat(common->y), sk_splat(common->z)});
        for (size_t r = first; r < end; r++, vertex += ROW, from += PLACES) {
            sk_wide3 to = place_of(q, vertex), began = minus(began_at(from), there);
            if (p) to = minus(to, (sk_wide3){sk_splat(common->x), sk_splat(common->y), sk_splat(common->z)});
            whole = around(whole, off(&now, &then, minus(to, here), began));
            if (!p) continue;
            sk_wide3 at = place_of(p, vertex);
            begin = around(begin, off(&now, &then, minus(at, here), began));
            way = around(way, minus(to, at));
        }
        const sk_mask good = now.good & then.good;
        *(sk_wide *)(void *)(moves->whole + l) = sk_select(good, square_across(whole), far);
        if (!p) continue;
        const sk_wide3 none = {sk_splat(0), sk_splat(0), sk_splat(0)};
        const moves_box any = around(around(whole, begin.low), begin.high);
        *(sk_wide *)(void *)(moves->begin + l) = sk_select(good, square_across(begin), far);
        *(sk_wide *)(void *)(moves->any + l) = sk_select(good, square_across(any), far);
        *(sk_wide *)(void *)(moves->way + l) = square_across(way);
        *(sk_wide *)(void *)(moves->share + l) = square_across(around(way, none));
    }
}
#else
static sk_moves_kernel *const moves_kernel[SK_ISA_COUNT] = SK_EACH_ISA(moves);

/* Gaps are not known better than this share of the thickness, and what is left of them has to be more. */
static const real rounding = (real)0.004;
/* Who is to be calm for long has to have more room, as shares of the thickness: pairs of those that cease to be are all kept until
 * then. But not while hardly any do: features of fine meshes, which are built nearer to each other than they are thick, never have it,
 * and a body of them that falls as it was built had 226,000 pairs to look at in each substep. */
static const real wide_room = (real)0.2, narrow_room = (real)0.008;
/* A pair that loses less than nine tenths of its gap in a substep does not close. It loses no more than its corners move
 * against each other in it; and its gap before the substep is its distance then. */
static const real closing_share = (real)0.85;

/* ---- one patch ---- */

/* Its pairs are kept from now on, until all are searched for: as they are before the substep, unless all are looked at anyway. */
static bool keep_pairs(sk_touch *touch, sk_allocator *allocator, size_t p, bool look) {
    sk_calm *calm = &touch->calm;
    calm->patch[p].calm = false;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        sk_pairs *late = &touch->late[sort];
        size_t first = calm->start[sort][p], end = calm->start[sort][p + 1], before = late->count;
        if (!sk_pairs_reserve(late, allocator, before + end - first)) return false;
        for (size_t k = first; k < end && calm->key[sort][k] != UINT64_MAX; k++) {
            const uint64_t key = calm->key[sort][k];
            if (touch->torn[sk_first_leaf(key)] | touch->torn[sk_second_leaf(key)]) continue;
            size_t to = late->count++;
            for (int c = 0; c < 4; c++) late->corner[c][to] = calm->corner[sort][c][k];
            late->key[to] = key;
            late->thickness[to] = calm->thickness[sort][k];
            late->settled[to] = 0;
        }
        sk_pairs_pad(late);
        if (!look || late->count == before) continue;
        sk_pairs fresh = sk_pairs_between(late, before / SK_PATCH_LANES * SK_PATCH_LANES, late->count);
        sk_closest[sort][touch->isa](touch->p, &fresh);
    }
    return true;
}

/* Moves are counted from x on. */
static void move_from(sk_calm *calm, size_t p, const sk_vec4 *x) {
    const size_t group = p / SK_PATCH_LANES, lane = p % SK_PATCH_LANES;
    for (size_t r = calm->row_start[group]; r < calm->row_start[group + 1]; r++) {
        sk_vec4 at = x[calm->row[r * SK_PATCH_LANES + lane]];
        real *from = calm->from + r * 3 * SK_PATCH_LANES + lane;
        from[0] = at.x, from[SK_PATCH_LANES] = at.y, from[2 * SK_PATCH_LANES] = at.z;
    }
}

/* The square of how far apart the moves of two vertices are at most, on any shares of their ways in this substep. */
static real moved_in_substep(const sk_touch *touch, size_t p) {
    const sk_calm *calm = &touch->calm;
    const size_t group = p / SK_PATCH_LANES, lane = p % SK_PATCH_LANES;
    sk_vec3 low = {0, 0, 0}, high = {0, 0, 0};
    for (size_t r = calm->row_start[group]; r < calm->row_start[group + 1]; r++) {
        uint32_t v = calm->row[r * SK_PATCH_LANES + lane];
        sk_vec3 d = sk_sub(sk_sub(sk_xyz(touch->q[v]), sk_xyz(touch->p[v])), touch->common);
        low = (sk_vec3){sk_min(low.x, d.x), sk_min(low.y, d.y), sk_min(low.z, d.z)};
        high = (sk_vec3){sk_max(high.x, d.x), sk_max(high.y, d.y), sk_max(high.z, d.z)};
    }
    const sk_vec3 across = sk_sub(high, low);
    return sk_dot(across, across);
}

enum { SCRATCH_ROWS = 6, LINE = 64 }; /* a cache line between threads */

static size_t scratch_row(const sk_calm *calm) {
    return (calm->most + 2 * LINE - 1) / LINE * LINE;
}

/* Room for what each thread finds out. */
static bool reserve_scratch(const sk_touch *touch, sk_calm *calm, sk_allocator *allocator) {
    int threads = touch->tasks ? sk_tasks_count(touch->tasks) : 1;
    if (threads <= calm->threads) return true;
    sk_release(allocator, calm->scratch);
    sk_release(allocator, calm->found);
    calm->threads = 0;
    calm->scratch = sk_allocate(allocator, (size_t)threads * SCRATCH_ROWS * scratch_row(calm) * sizeof *calm->scratch);
    calm->found = sk_allocate(allocator, (size_t)threads * scratch_row(calm));
    if (!calm->scratch || !calm->found) return false;
    calm->threads = threads;
    return true;
}

/* The patch's pairs as those that kernels look at. */
static sk_pairs pairs_of(const sk_calm *calm, size_t p, int sort, int thread) {
    const size_t row = scratch_row(calm), first = (size_t)thread * row;
    sk_pairs pairs = {.count = calm->start[sort][p + 1] - calm->start[sort][p], .closes = calm->found + first};
    for (int c = 0; c < 4; c++) pairs.corner[c] = calm->corner[sort][c] + calm->start[sort][p];
    pairs.thickness = calm->thickness[sort] + calm->start[sort][p];
    real **out[] = {&pairs.distance,  &pairs.normal[0], &pairs.normal[1],
                    &pairs.normal[2], &pairs.share[0],  &pairs.share[1]};
    for (size_t i = 0; i < sizeof out / sizeof *out; i++) *out[i] = calm->scratch + SCRATCH_ROWS * first + i * row;
    return pairs;
}

static real least_of(sk_quad a) {
    return sk_min(sk_min(a[0], a[1]), sk_min(a[2], a[3]));
}

/* Looks at all distances; they hold from there on, if the patch is calm: if it has so much room, a share of the thickness. */
static bool look_at(sk_touch *touch, size_t p, const sk_vec4 *x, real room, int thread) {
    sk_calm *calm = &touch->calm;
    sk_calm_patch *patch = &calm->patch[p];
    const sk_quad far = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX};
    sk_quad slacks = far, distances = far;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        sk_pairs pairs = pairs_of(calm, p, sort, thread);
        sk_closest[sort][touch->isa](x, &pairs);
        for (size_t k = 0; k < pairs.count; k += 4) { // blocks are full
            sk_quad distance, thickness;
            memcpy(&distance, pairs.distance + k, sizeof distance);
            memcpy(&thickness, pairs.thickness + k, sizeof thickness);
            slacks = sk_least_quad(slacks, distance - sk_quad_times(SK_NEAR_THICKNESSES, thickness));
            distances = sk_least_quad(distances, distance);
        }
    }
    const real slack = least_of(slacks) - rounding * touch->thickness, nearest = least_of(distances);
    // of a gap so much does not count, and of thin bodies beside thick ones that is much
    const real none = 2 * SK_LEAST_GAP * touch->thickness;
    // (what is no number is not calm)
    patch->calm = !calm->never && slack > room * touch->thickness && nearest < SK_REAL_MAX;
    if (!patch->calm) return false;
    patch->slack = slack, patch->distance = nearest - none;
    move_from(calm, p, x);
    return true;
}

/* ---- all patches ---- */

void sk_calm_forget(sk_touch *touch) {
    sk_calm *calm = &touch->calm;
    for (size_t p = 0; p < calm->patch_count; p++) calm->patch[p] = (sk_calm_patch){.calm = false};
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) calm->known[sort] = false;
}

/* Pairs are as thick as those that are searched for. */
static void know_thicknesses(sk_touch *touch) {
    sk_calm *calm = &touch->calm;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        if (calm->known[sort]) continue;
        sk_pairs all = {.count = calm->start[sort][calm->patch_count], .thickness = calm->thickness[sort]};
        for (int c = 0; c < 4; c++) all.corner[c] = calm->corner[sort][c];
        sk_touch_set_thickness(touch, &all, 0, sort);
        calm->known[sort] = true;
    }
}

/* How much more a patch may move without being looked at: all of it in one substep, too. */
static real room_of(const sk_calm_patch *patch, real any) {
    if (!patch->calm) return SK_REAL_MAX;
    const real moved = sk_sqrt(any);
    return sk_min(patch->slack - moved, closing_share * (patch->distance - moved));
}

/* Whether a patch is left out by panels that are spread (spread.h), and so is of no interest. */
static bool is_out(const sk_touch *touch, size_t p) {
    return touch->spread.out_count && touch->spread.patch_out[p];
}

static bool are_all_out(const sk_touch *touch, size_t begin, size_t end) {
    return touch->spread.out_count && !memchr(touch->spread.patch_out + begin, 0, end - begin);
}

/* What is asked of patches, sixteen after sixteen; threads take them as they come. */
typedef struct asking {
    sk_touch *touch;
    bool all;
} asking;

enum { PATCHES_AT_ONCE = 4 * SK_PATCH_LANES };

/* What has been found out of all, in their order: the pairs of those that ceased to be calm are kept. */
static bool conclude(sk_touch *touch, sk_allocator *allocator, bool look) {
    sk_calm *calm = &touch->calm;
    calm->least = SK_REAL_MAX;
    for (size_t p = 0; p < calm->patch_count; p++) {
        if (calm->patch[p].ceased && !is_out(touch, p)) {
            calm->ceased++;
            if (!keep_pairs(touch, allocator, p, look)) return false;
        }
        if (p % SK_PATCH_LANES == 0) calm->least = sk_min(calm->least, calm->holds[p / SK_PATCH_LANES]);
    }
    return true;
}

static void look_at_some(void *data, int thread, size_t begin, size_t end) {
    const asking *job = data;
    sk_touch *touch = job->touch;
    sk_calm *calm = &touch->calm;
    const real room = job->all ? calm->room : rounding, wanted = job->all ? room * touch->thickness : 0;
    sk_moves moves;
    for (size_t p = begin; p < end; p += SK_PATCH_LANES) {
        real least = SK_REAL_MAX;
        calm->holds[p / SK_PATCH_LANES] = least;
        if (are_all_out(touch, p, p + SK_PATCH_LANES < end ? p + SK_PATCH_LANES : end)) continue;
        moves_kernel[touch->isa](NULL, NULL, touch->p, calm, p / SK_PATCH_LANES, &moves);
        for (size_t i = p; i < p + SK_PATCH_LANES && i < end; i++) {
            if (is_out(touch, i)) continue;
            sk_calm_patch *patch = &calm->patch[i];
            bool was = patch->calm;
            real slack = patch->slack - wanted;
            bool known = was ? slack > 0 && moves.whole[i - p] <= slack * slack : !job->all;
            if (!known && look_at(touch, i, touch->p, room, thread)) moves.whole[i - p] = 0;
            patch->ceased = !known && was && !patch->calm && !job->all;
            least = sk_min(least, room_of(patch, moves.whole[i - p]));
        }
        calm->holds[p / SK_PATCH_LANES] = least;
    }
}

bool sk_calm_look(sk_touch *touch, sk_allocator *allocator, bool all) {
    sk_calm *calm = &touch->calm;
    asking job = {touch, all};
    if (!reserve_scratch(touch, calm, allocator)) return false;
    know_thicknesses(touch);
    calm->gone = 0;
    if (all) {
        const int searches = 8; // what has crumpled goes on; and in a storm nobody is seen to cease
        if (touch->storm || 100 * calm->ceased > calm->patch_count) calm->wide_for = searches;
        else if (calm->wide_for) calm->wide_for--;
        calm->room = calm->wide_for ? wide_room : narrow_room;
        calm->ceased = 0;
    }
    sk_parallel_pieces(touch->tasks, 0, calm->patch_count, PATCHES_AT_ONCE, look_at_some, &job);
    return conclude(touch, allocator, false);
}

/* Whether a patch is calm that had moved by `begin` before a substep, moves by `way` in it and then has by `moved`; all squares. */
static bool is_calm(const sk_calm_patch *patch, real begin, real moved, real way) {
    const real gap = patch->distance - sk_sqrt(begin);
    return patch->calm && gap > 0 && moved <= patch->slack * patch->slack &&
           way <= closing_share * closing_share * gap * gap;
}

/* Looks at a patch where the substep begins: whether it is calm on any shares of the ways from there; `moved` by no more than that. */
static bool is_calm_from_start(sk_touch *touch, size_t p, real *moved, int thread) {
    if (!look_at(touch, p, touch->p, rounding, thread)) return false;
    *moved = moved_in_substep(touch, p);
    return is_calm(&touch->calm.patch[p], 0, *moved, *moved);
}

/* Whether a patch is still calm, and by how much it has `moved` since it was looked at, on any shares; in a storm that is asked of all,
 * else of those that were. */
static bool follow_patch(sk_touch *touch, size_t p, const sk_moves *moves, size_t lane, real *moved, int thread) {
    sk_calm_patch *patch = &touch->calm.patch[p];
    const real begin = moves->begin[lane], way = moves->way[lane];
    *moved = moves->any[lane];
    patch->whole = !is_calm(patch, begin, *moved, moves->share[lane]);
    if (!patch->whole || is_calm(patch, begin, moves->whole[lane], way)) return true;
    if (!touch->storm && look_at(touch, p, touch->q, rounding, thread)) {
        *moved = 0;
        if (is_calm(patch, way, 0, way))
            return true; // its gaps before were no less than they are after it, less the way
    }
    patch->whole = false;
    return is_calm_from_start(touch, p, moved, thread);
}

bool sk_calm_holds(sk_touch *touch, real way) {
    sk_calm *calm = &touch->calm;
    if (!(calm->gone + 2 * way <= calm->least)) return false;
    calm->gone += 2 * way;
    return true;
}

static void follow_some(void *data, int thread, size_t begin, size_t end) {
    const asking *job = data;
    sk_touch *touch = job->touch;
    sk_calm *calm = &touch->calm;
    sk_moves moves;
    for (size_t p = begin; p < end; p += SK_PATCH_LANES) {
        real *holds = &calm->holds[p / SK_PATCH_LANES], least = SK_REAL_MAX;
        bool known = !touch->storm && calm->gone <= *holds;
        for (size_t i = p; i < p + SK_PATCH_LANES && i < end; i++) calm->patch[i].ceased = false;
        if (known) continue;
        *holds = least;
        if (are_all_out(touch, p, p + SK_PATCH_LANES < end ? p + SK_PATCH_LANES : end)) continue;
        moves_kernel[touch->isa](touch->p, &touch->common, touch->q, calm, p / SK_PATCH_LANES, &moves);
        for (size_t i = p; i < p + SK_PATCH_LANES && i < end; i++) {
            if (is_out(touch, i)) continue;
            sk_calm_patch *patch = &calm->patch[i];
            const bool was = patch->calm;
            real moved = 0;
            if (was || touch->storm) patch->calm = follow_patch(touch, i, &moves, i - p, &moved, thread);
            patch->ceased = was && !patch->calm && !touch->storm;
            least = sk_min(least, room_of(patch, moved));
        }
        *holds = touch->storm ? -1 : sk_min(SK_REAL_MAX, calm->gone + least);
    }
}

bool sk_calm_follow(sk_touch *touch, sk_allocator *allocator) {
    sk_calm *calm = &touch->calm;
    asking job = {touch, false};
    if (!reserve_scratch(touch, calm, allocator)) return false;
    calm->gone += 2 * touch->longest;
    sk_parallel_pieces(touch->tasks, 0, calm->patch_count, PATCHES_AT_ONCE, follow_some, &job);
    return conclude(touch, allocator, true);
}

bool sk_calm_disturb(sk_touch *touch, sk_allocator *allocator, size_t v) {
    sk_calm *calm = &touch->calm;
    for (uint32_t k = calm->of_vertex_start[v]; k < calm->of_vertex_start[v + 1]; k++) {
        const sk_calm_patch *patch = &calm->patch[calm->of_vertex[k]];
        if (!patch->calm || !patch->whole) continue;
        calm->ceased++;
        if (!keep_pairs(touch, allocator, calm->of_vertex[k], true)) return false;
    }
    return true;
}
#endif
