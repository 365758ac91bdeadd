/* Deals pairs that are near to slabs of space, so that threads may push what lies in different ones. Pairs that share a corner have an
 * order; what is far from each other needs none.
 *
 *     slab      0     |     1     |     2     |     3         round 1   pairs within slabs 0, 1, 2, 3
 *            x---x    |  x---x    x-----x     |  x--x               2   those across boundaries 0 and 2
 *                  x--|--x        |        x--|--x                  3   those across boundary 1
 *                                                                   4   those that are in three slabs or more */
#include <math.h>

#include "base/tasks.h"
#include "contact/touch.h"

enum { PAIRS_AT_ONCE = 1024 /* by one thread, at least */, VERTICES_AT_ONCE = 4096, MOST_PIECES = 32 };

typedef struct deal {
    sk_touch *touch;
    real gain, friction; /* m, by which a pair may come nearer to its thickness; the rule's */
    int axis;
    real per, first; /* slabs a metre, and the number of the first of them */
    size_t all, a_piece;
    size_t place[MOST_PIECES][SK_PUSH_CLASSES]; /* how many are dealt there, and then where */
} deal;

static void set_push(const deal *d, int sort, uint32_t entry, sk_push *push) {
    sk_touch *touch = d->touch;
    const sk_pairs *pairs = sk_pairs_of(touch, sort, entry);
    const size_t k = entry / 2;
    const real distance = pairs->distance[k];
    if (distance < SK_NO_GAP * touch->thickness) sk_touch_choose_side(touch, sort, entry);
    for (int c = 0; c < 4; c++) push->corner[c] = pairs->corner[c][k];
    for (int c = 0; c < 3; c++) push->normal[c] = pairs->normal[c][k];
    sk_weights_of(pairs, sort, k, push->weight);
    // what has come too near in some other way gets its thickness back over some substeps, not as a blow
    const real goal = sk_pair_goal(touch, push->corner[0], push->corner[2], pairs->thickness[k], distance);
    push->wanted = sk_min(goal, distance + d->gain);
    push->friction = sk_pair_friction(touch, push->corner[0], push->corner[2], d->friction);
    const sk_quad before = sk_quad_sum(touch->p, push->corner, push->weight);
    for (int c = 0; c < 3; c++) push->before[c] = before[c];
}

static real along(const deal *d, size_t vertex) {
    const sk_vec4 *p = &d->touch->p[vertex];
    return d->axis == 0 ? p->x : d->axis == 1 ? p->y : p->z;
}

static void set_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const deal *d = data;
    const sk_pair_list *near = d->touch->near;
    for (size_t i = begin; i < end; i++) {
        const size_t corners = near[SK_CORNERS].count;
        const int sort = i < corners ? SK_CORNERS : SK_EDGES;
        set_push(d, sort, near[sort].data[sort == SK_EDGES ? i - corners : i], &d->touch->pushes.pair.data[i]);
    }
}

/* Cuts the longest extent of where pairs begin, and no pair that comes or goes moves a cut: at multiples of a power of two. */
static void cut_slabs(deal *d) {
    const sk_push *pair = d->touch->pushes.pair.data;
    sk_quad least = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0}, most = -least;
    for (size_t i = 0; i < d->all; i++) {
        const sk_quad at = sk_quad_at(&d->touch->p[pair[i].corner[0]]);
        least = sk_least_quad(at, least), most = sk_most_quad(at, most);
    }
    const sk_quad extent = most - least;
    d->axis = extent[0] >= extent[1] && extent[0] >= extent[2] ? 0 : extent[1] >= extent[2] ? 1 : 2;
    const real longest = extent[d->axis];
    int exponent = 0;
    if (longest > (real)1e-9 && longest < (real)1e9) frexp((double)longest, &exponent);
    d->per = (real)ldexp(SK_MOST_SLABS, -exponent);
    d->first = (real)floor((double)(d->per * least[d->axis]));
}

const size_t sk_slab_round[] = {0, SK_MOST_SLABS, SK_MOST_SLABS * 3 / 2, SK_SLAB_CLASSES - 1, SK_SLAB_CLASSES};

/* In which slab each vertex begins, once: a pair asks four times, and is one of ten at its vertex. */
static void place_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const deal *d = data;
    for (size_t v = begin; v < end; v++) {
        const real at = d->per * along(d, v) - d->first;
        const int slab = at > 0 ? at < SK_MOST_SLABS - 1 ? (int)at : SK_MOST_SLABS - 1 : 0; // of no number, the first
        d->touch->slab[v] = (uint8_t)slab;
    }
}

/* In which class of its sort a pair with these corners is. */
static int class_of(const uint8_t *slab_of, const uint32_t corner[4]) {
    int least = SK_MOST_SLABS, most = 0;
    for (int c = 0; c < 4; c++) {
        const int slab = slab_of[corner[c]];
        least = slab < least ? slab : least, most = slab > most ? slab : most;
    }
    if (least == most) return least;
    return most > least + 1 ? SK_SLAB_CLASSES - 1 : SK_MOST_SLABS + least / 2 + least % 2 * (SK_MOST_SLABS / 2);
}

static void classify_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    deal *d = data;
    sk_push_list *pushes = &d->touch->pushes;
    size_t *count = d->place[begin / d->a_piece];
    for (size_t i = begin; i < end; i++) {
        const int first = i < d->touch->near[SK_CORNERS].count ? 0 : SK_SLAB_CLASSES;
        count[pushes->class_of.data[i] = (uint8_t)(first + class_of(d->touch->slab, pushes->pair.data[i].corner))]++;
    }
}

static void deal_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    deal *d = data;
    sk_push_list *pushes = &d->touch->pushes;
    size_t *place = d->place[begin / d->a_piece];
    for (size_t i = begin; i < end; i++) pushes->dealt.data[place[pushes->class_of.data[i]]++] = (uint32_t)i;
}

static void in_pieces(deal *d, sk_piece_body *body) {
    sk_parallel_pieces(d->touch->tasks, 0, d->all, d->a_piece, body, d);
}

bool sk_touch_deal(sk_touch *touch, sk_allocator *allocator, real gain, real friction) {
    sk_push_list *pushes = &touch->pushes;
    if (pushes->known) return true;
    deal d = {.touch = touch,
              .gain = gain,
              .friction = friction,
              .all = touch->near[SK_CORNERS].count + touch->near[SK_EDGES].count};
    if (!SK_RESERVE(allocator, &pushes->pair, d.all) || !SK_RESERVE(allocator, &pushes->class_of, d.all) ||
        !SK_RESERVE(allocator, &pushes->dealt, d.all))
        return false;
    d.a_piece = d.all / MOST_PIECES + 1 > PAIRS_AT_ONCE ? d.all / MOST_PIECES + 1 : PAIRS_AT_ONCE;
    in_pieces(&d, set_some);
    cut_slabs(&d);
    sk_parallel_pieces(touch->tasks, 0, touch->skin.vertex_count, VERTICES_AT_ONCE, place_some, &d);
    in_pieces(&d, classify_some);
    size_t at = 0;
    for (int of = 0; of < SK_PUSH_CLASSES; of++) {
        pushes->start[of] = at;
        for (int piece = 0; piece < MOST_PIECES; piece++) {
            const size_t count = d.place[piece][of];
            d.place[piece][of] = at;
            at += count;
        }
    }
    pushes->start[SK_PUSH_CLASSES] = at;
    in_pieces(&d, deal_some);
    pushes->known = true;
    return true;
}
