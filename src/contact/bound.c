/* The bound on vertices' ways in a substep: after it no pair has met, wherever other rules wanted its corners to be.
 *
 * For each pair that may close, its nearest points before the substep give a normal; the gap is what lies between its
 * features along it. Corners move along straight lines, so a gap that is left at the end was there all the way. Where
 * none is left, a plane between the features is what neither may pass, and corners go but a share of their ways. Such
 * planes stand still in the frame of what all go together, and hold for any smaller share, too; other pairs are looked
 * at again with these shares, until no more planes are needed. */
#include "contact/touch.h"

/* Of a gap, a tenth is left in a substep; what is less than a four hundredth of the thickness does not close at all. */
static const real left_over = (real)0.1, least_gap = (real)0.0025;

/* ---- ways ---- */

/* What all vertices go together, in the mean. */
static sk_vec3 common_way(const sk_touch *touch) {
    double sum[3] = {0, 0, 0};
    size_t count = 0;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        sk_vec3 way = sk_sub(sk_xyz(touch->q[v]), sk_xyz(touch->p[v]));
        if (!(touch->inverse[v] > 0) || !(sk_dot(way, way) < (real)1e12)) continue; // pinned, or blown up
        sum[0] += (double)way.x, sum[1] += (double)way.y, sum[2] += (double)way.z;
        count++;
    }
    double share = count ? 1 / (double)count : 0;
    return (sk_vec3){(real)(share * sum[0]), (real)(share * sum[1]), (real)(share * sum[2])};
}

/* Loads the places after the substep and what ways lead there; returns whether one may leave its vertex' reach. */
static bool load_ways(sk_touch *touch, const sk_run *run, const sk_row *row, sk_vec3 *common) {
    size_t count = touch->skin.vertex_count;
    for (size_t v = 0; v < count; v++)
        touch->q[v] = sk_load(run->vector[SK_X], row->packed, run->slot_of[touch->skin.particle[v]]);
    *common = common_way(touch);
    bool leaves = false;
    touch->most_way = 0;
    for (size_t v = 0; v < count; v++) {
        sk_vec3 way = sk_sub(sk_sub(sk_xyz(touch->q[v]), sk_xyz(touch->p[v])), *common);
        real length = sk_length(way);
        if (!(length < (real)1e6)) way = (sk_vec3){0, 0, 0}, length = 0; // blown up: it meets nobody
        touch->way[v] = (sk_vec4){way.x, way.y, way.z, length};
        leaves |= touch->p[v].w + length > touch->reach[v];
        touch->most_way = sk_max(touch->most_way, length);
    }
    return leaves;
}

/* ---- pairs that may close ---- */

/* Those that could lose their gap, were all of both ways along the normal. */
static bool find_closing(sk_touch *touch, sk_allocator *allocator, int sort, real least) {
    const sk_pairs *kept = &touch->kept[sort];
    sk_pairs *closing = &touch->closing[sort];
    closing->count = 0;
    if (!sk_pairs_reserve(closing, allocator, kept->count)) return false;
    for (size_t k = 0; k < kept->count; k++) {
        real moved[2], way[2];
        if ((1 - left_over) * (kept->distance[k] - 2 * touch->most_moved - least) >= 2 * touch->most_way) continue;
        sk_most_of_features(kept, sort, k, touch->way, way);
        if (way[0] + way[1] <= 0) continue;
        sk_most_of_features(kept, sort, k, touch->p, moved);
        real gap = kept->distance[k] - moved[0] - moved[1];
        if ((1 - left_over) * (gap - least) < way[0] + way[1]) sk_pairs_copy(closing, kept, k);
    }
    sk_pairs_pad(closing);
    sk_closest[sort][touch->isa](touch->p, closing);
    for (size_t k = 0; k < closing->count; k++) closing->settled[k] = 0;
    return true;
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
        l.at[c] = sk_dot(n, sk_sub(sk_xyz(touch->p[v]), sk_xyz(touch->p[l.v[0]])));
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
        if (share < touch->next_share[v]) touch->next_share[v] = share;
        lowered = true;
    }
    return lowered;
}

/* Whether a pair would close, and needs planes. */
static bool settle_pair(sk_touch *touch, sk_pairs *pairs, int sort, size_t k, real least) {
    line l = line_of(touch, pairs, sort, k);
    gap g = gap_of(touch, &l);
    real before = g.low - g.high, after = g.low_after - g.high_after;
    real room = sk_max(0, (1 - left_over) * (before - least));
    if (after >= before || after >= before - room) return false;
    pairs->settled[k] = 1;
    real upper, lower;
    divide(&g, room, &upper, &lower);
    return lower_shares(touch, &l, &g, upper, lower);
}

/* Each round looks at all shares as the round before left them, so no order counts. */
static void find_shares(sk_touch *touch, real least) {
    size_t count = touch->skin.vertex_count;
    for (size_t v = 0; v < count; v++) touch->share[v] = touch->next_share[v] = 1;
    for (bool lowered = true; lowered;) {
        lowered = false;
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
            for (size_t k = 0; k < touch->closing[sort].count; k++)
                if (!touch->closing[sort].settled[k]) lowered |= settle_pair(touch, &touch->closing[sort], sort, k, least);
        for (size_t v = 0; v < count; v++) touch->share[v] = touch->next_share[v];
    }
}

/* ---- the row ---- */

static void store_ways(const sk_touch *touch, const sk_run *run, const sk_row *row, sk_vec3 common) {
    const real rate = (real)(1 / row->dt);
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        if (!(touch->share[v] < 1)) continue;
        sk_vec3 to = sk_add(sk_add(sk_xyz(touch->p[v]), common), sk_scale(touch->share[v], sk_xyz(touch->way[v])));
        size_t slot = run->slot_of[touch->skin.particle[v]];
        sk_store_at(run->vector[SK_X], row->packed, slot, to);
        sk_add_at(run->vector[SK_V], row->packed, slot, sk_scale(rate, sk_sub(to, sk_xyz(touch->q[v]))));
    }
}

void sk_touch_bound(sk_run *run, const sk_row *row, size_t from, size_t end) {
    (void)from, (void)end;
    const sk_force *force = row->rule;
    sk_touch *touch = force->state;
    if (!touch || !touch->skin.vertex_count) return;
    real thickness = (real)((const sk_contact_params *)force->params)->thickness, least = least_gap * thickness;
    sk_vec3 common;
    bool good = true;
    if (load_ways(touch, run, row, &common)) good = sk_touch_renew(touch, run->allocator, thickness);
    for (int sort = 0; sort < SK_PAIR_SORTS && good; sort++) good = find_closing(touch, run->allocator, sort, least);
    if (!good) {
        run->no_memory = true;
        return;
    }
    if (touch->closing[SK_CORNERS].count + touch->closing[SK_EDGES].count) {
        find_shares(touch, least);
        store_ways(touch, run, row, common);
    }
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        sk_vec4 *s = &touch->s[v];
        s->x += common.x, s->y += common.y, s->z += common.z;
    }
}
