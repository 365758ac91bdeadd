/* Pairs that are kept from substep to substep: those of the last search for all, in their order, and those that came
 * since then, search after search. Those with a vertex that is looked for anew go: of the many they stay where they are,
 * as pairs of nobody. So a search for a few costs as much as those few. What is near is put in the order of all. */
#include <string.h>

#include "base/tasks.h"
#include "contact/touch.h"

/* What a bound has settled stays so, although it was looked for anew. */
static void stay_settled(sk_pairs *fresh, uint64_t key, uint8_t settled) {
    size_t low = 0, high = fresh->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (fresh->key[middle] < key) low = middle + 1;
        else high = middle;
    }
    if (low < fresh->count && fresh->key[low] == key) fresh->settled[low] = settled;
}

static void all_stay_settled(const sk_pairs *pairs, sk_pairs *fresh) {
    for (size_t k = 0; k < pairs->count; k++)
        if (pairs->settled[k]) stay_settled(fresh, pairs->key[k], pairs->settled[k]);
}

static inline bool goes(const sk_touch *touch, const sk_pairs *pairs, size_t k) {
    const uint8_t *lost = touch->lost;
    return lost[pairs->corner[0][k]] | lost[pairs->corner[1][k]] | lost[pairs->corner[2][k]] | lost[pairs->corner[3][k]];
}

typedef struct going {
    const sk_touch *touch;
    sk_pairs *pairs, *fresh;
} going;

static void let_some_go(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const going *job = data;
    sk_pairs *kept = job->pairs;
    for (size_t k = begin; k < end; k++) {
        if (!goes(job->touch, kept, k)) continue;
        if (kept->settled[k]) stay_settled(job->fresh, kept->key[k], kept->settled[k]);
        for (int c = 0; c < 4; c++) kept->corner[c][k] = 0;
        kept->thickness[k] = -1;
        kept->settled[k] = 0;
    }
}

/* Makes those that go pairs of nobody: never near, nor closing. */
static void let_go(const sk_touch *touch, sk_pairs *kept, sk_pairs *fresh) {
    enum { AT_ONCE = 8192 };
    going job = {touch, kept, fresh};
    sk_parallel_pieces(touch->tasks, 0, kept->count, AT_ONCE, let_some_go, &job);
}

/* Takes those that go out. */
static void take_out(const sk_touch *touch, sk_pairs *late, sk_pairs *fresh) {
    size_t count = late->count;
    late->count = 0;
    for (size_t k = 0; k < count; k++) {
        if (!goes(touch, late, k)) sk_pairs_copy_all(late, late, k);
        else if (late->settled[k]) stay_settled(fresh, late->key[k], late->settled[k]);
    }
}

bool sk_touch_keep(sk_touch *touch, sk_allocator *allocator, int sort, bool all, bool midst) {
    sk_pairs *kept = &touch->kept[sort], *late = &touch->late[sort], *fresh = &touch->fresh;
    if (all) {
        for (int i = 0; midst && i < 2; i++) all_stay_settled(i ? late : kept, fresh);
        sk_pairs other = *kept;
        *kept = *fresh, *fresh = other;
        late->count = 0;
        return true;
    }
    let_go(touch, kept, fresh);
    if (midst) let_go(touch, late, fresh);
    else take_out(touch, late, fresh);
    if (!sk_pairs_reserve(late, allocator, late->count + fresh->count)) return false;
    sk_pairs_take(late, fresh, 0, fresh->count);
    sk_pairs_pad(late);
    return true;
}

void sk_touch_leave_out(sk_touch *touch) {
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (int i = 0; i < 2; i++) {
            sk_pairs *pairs = i ? &touch->late[sort] : &touch->kept[sort];
            const size_t count = pairs->count;
            pairs->count = 0;
            for (size_t k = 0; k < count; k++) {
                bool out = sk_spread_has(&touch->spread, sk_first_leaf(pairs->key[k])) ||
                           sk_spread_has(&touch->spread, sk_second_leaf(pairs->key[k]));
                if (!out && pairs->thickness[k] > 0) sk_pairs_copy_all(pairs, pairs, k);
            }
            sk_pairs_pad(pairs);
        }
}

/* ---- those that are near ---- */

/* The end of what is in order, from `first` on. */
static size_t end_of_run(const sk_pair_place *place, size_t first, size_t count) {
    size_t end = first + (first < count);
    while (end < count && place[end - 1].key < place[end].key) end++;
    return end;
}

/* Merges each two runs of `from`; returns whether there were more than two. */
static bool merge_runs(const sk_pair_place *from, sk_pair_place *to, size_t count) {
    bool more = false;
    for (size_t first = 0; first < count;) {
        size_t middle = end_of_run(from, first, count), end = end_of_run(from, middle, count);
        for (size_t i = first, k = middle, at = first; at < end; at++)
            to[at] = k == end || (i < middle && from[i].key < from[k].key) ? from[i++] : from[k++];
        first = end;
        more |= first < count;
    }
    return more;
}

static bool reserve_order(sk_touch *touch, sk_allocator *allocator, size_t most) {
    return SK_RESERVE(allocator, &touch->order, most + 1) && SK_RESERVE(allocator, &touch->other_order, most + 1);
}

/* Puts places in order, in one of both arrays. */
static const sk_pair_place *in_order(sk_pair_place *place, sk_pair_place *other, size_t count) {
    for (bool more = end_of_run(place, 0, count) < count; more;) {
        more = merge_runs(place, other, count);
        sk_pair_place *swapped = place;
        place = other, other = swapped;
    }
    return place;
}

/* Lists late pairs that are near, in order. */
static const sk_pair_place *list_late(sk_touch *touch, sk_allocator *allocator, const sk_pairs *late, size_t *count) {
    if (!reserve_order(touch, allocator, late->count)) return NULL;
    sk_pair_place *place = touch->order.data;
    *count = 0;
    for (size_t b = 0; b < late->count; b += 8)
        for (uint64_t bits = sk_pairs_that(late, b, SK_IS_NEAR); bits; bits &= bits - 1) {
            size_t k = b + sk_first_of(bits);
            place[(*count)++] = (sk_pair_place){late->key[k], (uint32_t)k};
        }
    return in_order(place, touch->other_order.data, *count);
}

const sk_pair_place *sk_touch_order_divided(sk_touch *touch, sk_allocator *allocator, int sort) {
    const sk_divided_list *list = &touch->divided[sort];
    if (!reserve_order(touch, allocator, list->count)) return NULL;
    for (size_t i = 0; i < list->count; i++) touch->order.data[i] = (sk_pair_place){list->data[i].key, (uint32_t)i};
    return in_order(touch->order.data, touch->other_order.data, list->count);
}

/* Of kept pairs some blocks of eight, and of late ones, in order, those that belong between them: where they are listed. */
enum { MOST_CUTS = 64 };
typedef struct near_cut {
    size_t block, late, at;
} near_cut;

typedef struct near_job {
    const sk_pairs *kept;
    const sk_pair_place *place;
    uint32_t *entry;
    near_cut cut[MOST_CUTS + 1];
} near_job;

/* How many pairs are near. */
static void count_near(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    near_job *job = data;
    for (size_t c = begin; c < end; c++) {
        size_t count = 0;
        for (size_t b = job->cut[c].block; b < job->cut[c + 1].block; b++)
            count += (size_t)__builtin_popcountll(sk_pairs_that(job->kept, 8 * b, SK_IS_NEAR));
        job->cut[c].at = count;
    }
}

static void list_near(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const near_job *job = data;
    for (size_t c = begin; c < end; c++) {
        size_t i = job->cut[c].late, last = job->cut[c + 1].late, n = job->cut[c].at;
        for (size_t b = 8 * job->cut[c].block; b < 8 * job->cut[c + 1].block; b += 8)
            for (uint64_t bits = sk_pairs_that(job->kept, b, SK_IS_NEAR); bits; bits &= bits - 1) {
                size_t k = b + sk_first_of(bits);
                while (i < last && job->place[i].key < job->kept->key[k]) job->entry[n++] = 2 * job->place[i++].at + 1;
                job->entry[n++] = 2 * (uint32_t)k;
            }
        while (i < last) job->entry[n++] = 2 * job->place[i++].at + 1;
    }
}

/* Cuts kept pairs into as many pieces as are worth it. */
static size_t cut_near(near_job *job, size_t late) {
    const size_t worth = 512; // blocks
    size_t blocks = (job->kept->count + 7) / 8, cuts = blocks / worth + 1;
    if (cuts > MOST_CUTS) cuts = MOST_CUTS;
    for (size_t c = 0, i = 0; c <= cuts; c++) {
        size_t block = blocks * c / cuts;
        while (i < late && c && (c == cuts || job->place[i].key < job->kept->key[8 * block])) i++;
        job->cut[c] = (near_cut){block, i, 0};
    }
    return cuts;
}

/* Takes those out that are around where something is tangled. */
static void take_tangled_out(const sk_touch *touch, sk_pair_list *near, int sort) {
    size_t count = near->count;
    near->count = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t entry = near->data[i];
        const sk_pairs *pairs = sk_pairs_of(touch, sort, entry);
        const size_t k = entry / 2;
        const uint32_t v[4] = {pairs->corner[0][k], pairs->corner[1][k], pairs->corner[2][k], pairs->corner[3][k]};
        if (!sk_pair_is_tangled(touch, v, sort)) near->data[near->count++] = entry;
    }
}

bool sk_touch_find_near(sk_touch *touch, sk_allocator *allocator, int sort) {
    const sk_pairs *kept = &touch->kept[sort], *late = &touch->late[sort];
    sk_pair_list *near = &touch->near[sort];
    near->count = 0;
    size_t late_count, n = 0;
    const sk_pair_place *place = list_late(touch, allocator, late, &late_count);
    if (!place || !SK_RESERVE(allocator, near, kept->count + late_count + 1)) return false;
    near_job job = {.kept = kept, .place = place, .entry = near->data};
    size_t cuts = cut_near(&job, late_count);
    sk_parallel_pieces(touch->tasks, 0, cuts, 1, count_near, &job);
    for (size_t c = 0; c < cuts; c++) {
        size_t count = job.cut[c].at + job.cut[c + 1].late - job.cut[c].late;
        job.cut[c].at = n, n += count;
    }
    sk_parallel_pieces(touch->tasks, 0, cuts, 1, list_near, &job);
    near->count = n;
    if (touch->tangle.any) take_tangled_out(touch, near, sort);
    return true;
}
