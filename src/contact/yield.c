/* Who stands in the way of pins, and yields to them.
 *
 * What is pinned or led goes all of its way in a substep. In the frame of a bound it may go by more
 * than there is room for: one edge is led up through what hangs from another. Then no share of
 * their ways keeps corners off it, for with none they stand, and are passed. So they stand elsewhere: moved along the pair's
 * normal, until there is room; and so, in turn, do those in the way of these. Only that is moved which must be: all others stay
 * in the frame, so that what slides over a pinned border goes on.
 *
 * Pairs are gone through in the order of their keys, so that no thread counts. And it is only those that come near each other on
 * straight ways to where corners stood when others were last looked for: of these all are known, whatever has gone on before. Who is
 * pushed by who was pushed is so found in the next search. */
#include <stdlib.h>
#include <string.h>

#include "base/tasks.h"
#include "contact/touch.h"

enum { NOBODY = SK_STANDS, ROUNDS = 32, SEARCHES = 8 };

/* A pair where its corners stand, along its normal. */
typedef struct standing {
    const uint32_t *v;
    sk_vec3 normal;
    real at[4], before; /* m; the gap that there was */
    real low, high;     /* of the upper feature the lowest, and of the lower one the highest */
    int first, rank[2]; /* the least of a feature */
} standing;

static standing standing_of(const sk_touch *touch, const sk_yielding *pair) {
    const uint32_t *v = pair->corner;
    standing s = {.v = v,
                  .first = pair->sort == SK_EDGES ? 2 : 1,
                  .low = SK_REAL_MAX,
                  .high = -SK_REAL_MAX,
                  .rank = {NOBODY, NOBODY}};
    s.normal = pair->normal;
    const sk_vec3 from = sk_xyz(touch->p[v[0]]);
    real low = SK_REAL_MAX, high = -SK_REAL_MAX;
    for (int c = 0; c < 4; c++) {
        const bool upper = c < s.first;
        const real at = sk_dot(s.normal, sk_sub(sk_xyz(touch->p[v[c]]), from));
        s.at[c] = sk_dot(s.normal, sk_sub(sk_xyz(touch->stand[v[c]]), from));
        if (upper) low = sk_min(low, at), s.low = sk_min(s.low, s.at[c]);
        else high = sk_max(high, at), s.high = sk_max(s.high, s.at[c]);
        if (touch->rank[v[c]] < s.rank[!upper]) s.rank[!upper] = touch->rank[v[c]];
    }
    s.before = low - high;
    return s;
}

static bool is_pinned(const sk_touch *touch, uint32_t v) {
    return !(touch->inverse[v] > 0);
}

/* How near features may come to each other. */
static real least_of(const sk_touch *touch, real distance) {
    return sk_min((real)0.05 * touch->thickness, (real)0.5 * distance);
}

/* Whether somebody of it is in the way of pins. */
static bool has_too_little(const sk_touch *touch, const standing *s) {
    const real none = SK_NO_GAP * touch->thickness, enough = (real)0.5 * touch->thickness;
    if (s->rank[0] + s->rank[1] == 0 || !(s->before > none) ||
        !(s->low - s->high < (real)0.999 * sk_min(s->before, enough)))
        return false;
    sk_vec3 x[2][4];
    for (int c = 0; c < 4; c++) x[0][c] = sk_xyz(touch->p[s->v[c]]), x[1][c] = sk_xyz(touch->stand[s->v[c]]);
    return sk_passes[s->first == 2 ? SK_EDGES : SK_CORNERS][touch->isa]((const sk_vec3(*)[4])x,
                                                                        SK_NEAR_THICKNESSES * touch->thickness);
}

/* Moves corners of the feature that is farther from pins, or of both; whether it has. */
static bool yield_pair(sk_touch *touch, const standing *s) {
    const bool both = s->rank[0] == s->rank[1];
    const real least = (real)0.1 * touch->thickness, enough = (real)0.5 * touch->thickness;
    const real keep = sk_max(least, sk_min(s->before, enough)),
               part = both ? (real)0.5 * (keep - (s->low - s->high)) : 0;
    bool moved = false;
    for (int c = 0; c < 4; c++) {
        const bool upper = c < s->first;
        if (!both && upper != (s->rank[0] > s->rank[1])) continue;
        const real missing = (upper ? s->high + keep - s->at[c] : s->at[c] - (s->low - keep)) - part;
        const uint32_t v = s->v[c];
        if (!(missing > 0) || is_pinned(touch, v)) continue;
        const sk_vec3 to = sk_add(sk_xyz(touch->stand[v]), sk_scale(upper ? missing : -missing, s->normal));
        const int rank = s->rank[upper] + (both ? 0 : 1);
        touch->stand[v] = (sk_vec4){to.x, to.y, to.z, touch->p[v].w};
        touch->rank[v] = (uint8_t)(rank < NOBODY ? rank : NOBODY - 1);
        moved = true;
    }
    return moved;
}

/* By sort and key. */
static int compare(const void *a, const void *b) {
    const sk_yielding *one = a, *other = b;
    if (one->sort != other->sort) return one->sort - other->sort;
    return (one->key > other->key) - (one->key < other->key);
}

static bool is_listed(const sk_yielding *list, size_t count, const sk_yielding *pair) {
    return count && bsearch(pair, list, count, sizeof *list, compare) != NULL;
}

/* Adds the pairs that come near each other on straight ways to where their corners stand now, some of which are not where they were. */
static bool list_pairs(sk_touch *touch, sk_allocator *allocator) {
    const real near =
        (real)0.6 * touch->thickness; // more than what they are to have, and less than what all are known of
    sk_yielding_list *list = &touch->yielding;
    const size_t before = list->count;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t i = 0; i < touch->may_close[sort].count; i++) {
            const sk_closing_pair *one = &touch->may_close[sort].data[i];
            const uint32_t *v = one->corner;
            if (touch->rank[v[0]] == NOBODY && touch->rank[v[1]] == NOBODY && touch->rank[v[2]] == NOBODY &&
                touch->rank[v[3]] == NOBODY)
                continue;
            if (touch->tangle.any && sk_pair_is_tangled(touch, v, sort)) continue;
            const sk_pairs *pairs = one->entry & 1 ? &touch->late[sort] : &touch->kept[sort];
            const size_t k = one->entry / 2;
            const sk_yielding pair = {.key = pairs->key[k],
                                      .corner = {v[0], v[1], v[2], v[3]},
                                      .normal = {pairs->normal[0][k], pairs->normal[1][k], pairs->normal[2][k]},
                                      .sort = (uint8_t)sort};
            sk_vec3 x[2][4];
            for (int c = 0; c < 4; c++) x[0][c] = sk_xyz(touch->p[v[c]]), x[1][c] = sk_xyz(touch->stand[v[c]]);
            if (is_listed(list->data, before, &pair) || !sk_passes[sort][touch->isa]((const sk_vec3(*)[4])x, near))
                continue;
            if (!SK_RESERVE(allocator, list, list->count + 1)) return false;
            list->data[list->count++] = pair;
        }
    if (list->count) qsort(list->data, list->count, sizeof *list->data, compare);
    return true;
}

/* All that have too little room when the round begins, in the order of their keys; whether any has moved. */
static bool yield_round(sk_touch *touch) {
    const sk_yielding_list *list = &touch->yielding;
    bool moved = false;
    for (size_t i = 0; i < list->count; i++) {
        const standing s = standing_of(touch, &list->data[i]);
        list->data[i].now = has_too_little(touch, &s);
    }
    for (size_t i = 0; i < list->count; i++) {
        if (!list->data[i].now) continue;
        const standing s = standing_of(touch, &list->data[i]);
        if (has_too_little(touch, &s)) moved |= yield_pair(touch, &s);
    }
    return moved;
}

/* Ways from where they stand now, and who is to be looked for on them; whether that has changed anything. */
static bool find_ways(sk_touch *touch) {
    bool changed = false;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        touch->lost[v] = (touch->rank[v] != NOBODY || touch->wild[v]) && !sk_vertex_is_out(&touch->spread, v);
        const sk_vec3 moved = sk_sub(sk_xyz(touch->stand[v]), sk_xyz(touch->p[v]));
        sk_vec3 way = sk_sub(sk_sub(sk_sub(sk_xyz(touch->q[v]), sk_xyz(touch->p[v])), touch->common), moved);
        real length = sk_length(way) + sk_length(moved);
        if (!(length < (real)1e6)) way = (sk_vec3){0, 0, 0}, length = 0; // blown up
        const sk_vec4 whole = {way.x, way.y, way.z, length};
        changed |= memcmp(&whole, &touch->way[v], sizeof whole) != 0;
        touch->way[v] = whole;
        touch->longest = sk_max(touch->longest, length);
    }
    return changed;
}

/* Those that go nowhere but with all: what is pinned stands where it goes. */
static void begin(sk_touch *touch) {
    memcpy(touch->yielded, touch->p, touch->skin.vertex_count * sizeof *touch->p);
    touch->stand = touch->yielded;
    touch->aimed = false; // shares are whole again
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const bool pinned = is_pinned(touch, (uint32_t)v);
        touch->rank[v] = pinned ? 0 : NOBODY;
        touch->share[v] = touch->next_share[v] = 1;
        touch->lowered[v] = 0;
        if (!pinned) continue;
        const sk_vec3 to = sk_sub(sk_xyz(touch->q[v]), touch->common), way = sk_sub(to, sk_xyz(touch->p[v]));
        if (!(sk_dot(way, way) < (real)1e12)) continue; // blown up
        touch->stand[v] = (sk_vec4){to.x, to.y, to.z, touch->p[v].w};
    }
}

/* Where somebody goes so far, or so many pairs come near each other on straight ways, all has blown up: it would take seconds a
 * substep. (Of others that may close, how many are known depends on what has gone on before.) */
static bool is_hopeless(const sk_touch *touch) {
    const real most_cells = 16, near = (real)0.6 * touch->thickness;
    if (!(touch->longest < most_cells * touch->skin.longest)) return true;
    const size_t most = 4 * touch->skin.vertex_count,
                 known = touch->may_close[SK_CORNERS].count + touch->may_close[SK_EDGES].count;
    size_t count = 0;
    for (int sort = 0; sort < SK_PAIR_SORTS && known > most; sort++)
        for (size_t i = 0; i < touch->may_close[sort].count; i++) {
            const uint32_t *v = touch->may_close[sort].data[i].corner;
            sk_vec3 x[2][4];
            for (int c = 0; c < 4; c++) {
                x[0][c] = sk_xyz(touch->p[v[c]]);
                x[1][c] = sk_add(sk_xyz(touch->stand[v[c]]), sk_way_left(touch, v[c]));
            }
            count += sk_passes[sort][touch->isa]((const sk_vec3(*)[4])x, near);
        }
    return count > most;
}

bool sk_touch_is_passed(const sk_touch *touch) {
    if (is_hopeless(touch)) return false;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t i = 0; i < touch->may_close[sort].count; i++) {
            const sk_closing_pair *one = &touch->may_close[sort].data[i];
            const sk_pairs *pairs = one->entry & 1 ? &touch->late[sort] : &touch->kept[sort];
            const size_t k = one->entry / 2;
            if (pairs->settled[k] != SK_IS_FORCED || (touch->tangle.any && sk_pair_is_tangled(touch, one->corner, sort)))
                continue;
            sk_vec3 x[2][4];
            for (int c = 0; c < 4; c++) {
                const uint32_t v = one->corner[c];
                x[0][c] = sk_xyz(touch->p[v]);
                x[1][c] = sk_add(x[0][c], sk_scale(touch->share[v], sk_xyz(touch->way[v])));
            }
            if (sk_passes[sort][touch->isa]((const sk_vec3(*)[4])x, least_of(touch, pairs->distance[k]))) return true;
        }
    return false;
}

/* Each search finds who is near on these ways, and then all is found out anew: what was known before counts for nothing, and so the
 * first is made where pins alone stand elsewhere. */
bool sk_touch_yield(sk_touch *touch, sk_allocator *allocator, real least) {
    touch->yielding.count = 0;
    begin(touch);
    bool changed = find_ways(touch);
    for (int search = 0; search < SEARCHES && (changed || !search); search++) {
        if (!sk_touch_search_ways(touch, allocator) || !sk_touch_list_closing(touch, allocator, least, true) ||
            !list_pairs(touch, allocator))
            return false;
        if (search && is_hopeless(touch)) break;
        begin(touch);
        for (int round = 0; round < ROUNDS && yield_round(touch); round++) {}
        changed = find_ways(touch);
    }
    return !changed || sk_touch_search_ways(touch, allocator);
}
