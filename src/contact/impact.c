/* What the velocities of those become whom the bound holds back.
 *
 * But of who is pinned or tangled, they are not lost: a cloth of 0.2 kg stopped a cube of 1 kg in the air, and cubes that lay on a cloth drove off with it. Nor are they
 * kept as they are until a push takes them, in one of the next substeps, when what holds them is near. Where cloth is thinner than the
 * ways of a substep, as silk is, that takes some, gravity and springs add to what is held each time, and a heap of it that lay still had
 * velocities of 20 m/s, and twice the energy that it had fallen with.
 *
 * So each pair that planes divide takes from both of its features what they had too much, as what does not bounce: of the upper one the
 * corner that would lie lowest, of the lower one the one that would lie highest, get velocities along the normal with which they close as
 * fast as they did. Momentum stays (angular momentum but for the way between the corners, across the normal); energy is never made, since
 * each pair brings the velocities to the nearest ones that do, in the measure of masses. One after the other, in the order of all pairs, once.
 *
 * What is less than half a thickness in a substep stays as it is: there is a push in the next one, and it knows friction. Where all was
 * shared, 20 kg on a loose cloth on a floor crept at up to 9 cm/s, since normals of what all but touches lean anywhere; from a tenth on
 * silk had some of its velocities, from 0.2 to 1 none, and the load crept at 0 to 1 cm/s, as it does where nothing is shared.
 *
 * Corners, since planes stop corners: where the nearest points of the features met, a triangle's far corner that would turn
 * through the other feature kept all of its velocity, and silk lay with 23 m/s. */
#include <string.h>

#include "base/union_find.h"
#include "contact/touch.h"

/* ---- momentum ---- */

static void add_momentum(sk_whole *whole, double mass, sk_vec3 v) {
    whole->mass += mass;
    whole->momentum[0] += mass * (double)v.x, whole->momentum[1] += mass * (double)v.y,
        whole->momentum[2] += mass * (double)v.z;
}

/* Of all pieces, and of groups. */
static void forget_momenta(sk_touch *touch) {
    for (size_t i = 0; i < touch->skin.vertex_count; i++) {
        sk_whole *whole = &touch->tangle.whole[i];
        whole->held = false, whole->mass = 0;
        memset(whole->momentum, 0, sizeof whole->momentum), memset(whole->gained, 0, sizeof whole->gained);
    }
}

static void gain(const sk_run *run, const sk_op *op, uint32_t slot, const double what[3], double share) {
    sk_add_at(run->vector[SK_V], op->packed, slot,
              (sk_vec3){(real)(share * what[0]), (real)(share * what[1]), (real)(share * what[2])});
}

/* ---- who loses it ---- */

/* What pieces of the skin lose of what they are held back by: nothing; what all lose together who are tangled in one group is given back to
 * all of them; or all of it, since somebody is pinned, or has yielded to a pin. */
enum { LOSES_NOTHING, SHARES_LOSS, LOSES_ALL };

/* The first piece of a group, which has what the group has lost, and the mass of who shares it. */
static sk_whole *group_of(const sk_touch *touch, uint32_t piece) {
    return &touch->tangle.whole[sk_union_root(touch->tangle.group, piece)];
}

/* Two solids are led out of each other as they are, and gain nothing by it. Whether there is anything else. */
static bool find_tangled(sk_touch *touch) {
    const sk_skin *skin = &touch->skin;
    bool any = false;
    for (size_t i = 0; i < touch->tangle.crossing.count; i++) {
        const sk_crossing *crossing = &touch->tangle.crossing.data[i];
        const uint32_t one = skin->piece[skin->edge[crossing->edge][0]],
                       other = skin->piece[skin->triangle[crossing->triangle][0]];
        if (skin->closed[one] && skin->closed[other]) continue;
        touch->loses[one] = touch->loses[other] = SHARES_LOSS;
        any = true;
    }
    return any;
}

/* Who holds each other back is of one group, whether it is tangled or not. */
static void join_divided(sk_touch *touch) {
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t i = 0; i < touch->divided[sort].count; i++) {
            const uint32_t *v = touch->divided[sort].data[i].corner;
            sk_union_join(touch->tangle.group, touch->skin.piece[v[0]], touch->skin.piece[v[sort == SK_EDGES ? 2 : 1]]);
        }
}

/* Whether anybody shares what he loses. */
static bool find_losing(sk_touch *touch) {
    const sk_skin *skin = &touch->skin;
    memset(touch->loses, LOSES_NOTHING, skin->vertex_count);
    const bool shared = touch->tangle.any && !touch->implicit && find_tangled(touch);
    if (shared) join_divided(touch);
    for (size_t v = 0; v < skin->vertex_count; v++) {
        if (touch->inverse[v] > 0 && !sk_has_yielded(touch, v)) continue;
        touch->loses[skin->piece[v]] = LOSES_ALL;
        if (shared) group_of(touch, skin->piece[v])->held = true;
    }
    return shared;
}

/* Nothing that leads into who holds a group up comes back: pins, or the colliders below it. (What has a jelly's weight on it is light: its own
 * share of what the jelly had lost was all that a floor took. So a jelly and a cloth tangled in it fell on and on while they lay there, up to
 * 23 m/s, and were as fast as that when they came apart.) */
static void lose_to_supports(sk_touch *touch, const sk_run *run, const sk_op *op) {
    const sk_vec4 *support = run->vector[SK_SUPPORT];
    for (size_t v = 0; v < touch->skin.vertex_count && support; v++) {
        const sk_vec3 n = sk_xyz(sk_load(support, op->packed, touch->slot[v]));
        if (!(sk_dot(n, n) > 0)) continue;
        double *lost = group_of(touch, touch->skin.piece[v])->momentum;
        const double into = lost[0] * (double)n.x + lost[1] * (double)n.y + lost[2] * (double)n.z;
        if (into < 0) lost[0] -= into * (double)n.x, lost[1] -= into * (double)n.y, lost[2] -= into * (double)n.z;
    }
}

/* Gives each of a group that is tangled his share of the momentum that the group has lost. */
static void give_back(sk_touch *touch, const sk_run *run, const sk_op *op) {
    lose_to_supports(touch, run, op);
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const uint32_t piece = touch->skin.piece[v];
        const sk_whole *group = group_of(touch, piece);
        if (touch->loses[piece] != SHARES_LOSS || group->held) continue;
        gain(run, op, touch->slot[v], group->momentum, 1 / group->mass);
    }
}

/* A surface that is pinned loses what it is held back by to its pins: wound tightly, it would go through itself. And what is tangled to what
 * it is tangled in: who is led apart pulls on springs again and again. (A cloth in a jelly of 8 kg had 1,800 J after 150 frames, and more
 * each; where it was lost to nobody they drove off, with 500 J after 400.) */
void sk_touch_lose_velocities(sk_touch *touch, const sk_run *run, const sk_op *op) {
    const real rate = (real)(1 / op->dt);
    const bool shared = find_losing(touch);
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const uint32_t piece = touch->skin.piece[v];
        const uint8_t loses = touch->loses[piece];
        if (loses == LOSES_NOTHING) continue;
        sk_vec3 change = {0, 0, 0};
        if (touch->share[v] < 1) {
            const sk_vec3 to = sk_xyz(sk_load(run->vector[SK_X], op->packed, touch->slot[v]));
            change = sk_scale(rate, sk_sub(to, sk_xyz(touch->q[v])));
            sk_add_at(run->vector[SK_V], op->packed, touch->slot[v], change);
        }
        if (loses == SHARES_LOSS)
            add_momentum(group_of(touch, piece), 1 / (double)touch->inverse[v], sk_scale(-1, change));
    }
    if (shared) give_back(touch, run, op);
}

/* ---- who is led apart ---- */

/* Of the vertices of the skin, and of who is within its solids, the piece and the slot. */
static sk_whole *moving(const sk_touch *touch, size_t i, uint32_t *slot) {
    const sk_skin *skin = &touch->skin;
    const bool inner = i >= skin->vertex_count;
    if (inner) i -= skin->vertex_count;
    *slot = inner ? touch->inner_slot[i] : touch->slot[i];
    return &touch->tangle.whole[inner ? skin->inner[i].piece : skin->piece[i]];
}

/* 1/kg; 0: somebody of it is pinned. */
static double inverse_of(const sk_whole *whole) {
    return whole->held || !(whole->mass > 0) ? 0 : 1 / whole->mass;
}

static double speed_along(const sk_whole *whole, const double n[3]) {
    const double share = whole->mass > 0 ? 1 / whole->mass : 0;
    return share * (whole->momentum[0] * n[0] + whole->momentum[1] * n[1] + whole->momentum[2] * n[2]);
}

/* As what does not bounce: none comes nearer than the way that they are led. */
static void part(sk_whole *one, sk_whole *other) {
    const sk_vec3 way = sk_sub(one->way, other->way);
    const double length = (double)sk_length(way), gives = inverse_of(one) + inverse_of(other);
    if (!(length > 0) || !(gives > 0)) return;
    const double n[3] = {(double)way.x / length, (double)way.y / length, (double)way.z / length};
    const double nearing = speed_along(other, n) - speed_along(one, n);
    if (!(nearing > 0)) return;
    const double blow = nearing / gives;
    for (int d = 0; d < 3; d++) {
        if (inverse_of(one) > 0) one->momentum[d] += blow * n[d], one->gained[d] += blow * n[d] / one->mass;
        if (inverse_of(other) > 0) other->momentum[d] -= blow * n[d], other->gained[d] -= blow * n[d] / other->mass;
    }
}

/* Whether a crossing is of two solids, and which. */
static bool of_solids(const sk_touch *touch, size_t i, sk_whole *solid[2]) {
    const sk_skin *skin = &touch->skin;
    const sk_crossing *crossing = &touch->tangle.crossing.data[i];
    const uint32_t one = skin->piece[skin->edge[crossing->edge][0]],
                   other = skin->piece[skin->triangle[crossing->triangle][0]];
    solid[0] = &touch->tangle.whole[one], solid[1] = &touch->tangle.whole[other];
    return one != other && skin->closed[one] && skin->closed[other];
}

/* Solids that are stuck have no contact, and what is led has no speed of it: so one above another fell as it was led up, faster and faster, until it was
 * through (two cubes of 1 m that began 0.4 m above each other had up to 499 J). */
void sk_touch_part_solids(sk_touch *touch, const sk_run *run, const sk_op *op) {
    const sk_skin *skin = &touch->skin;
    const size_t count = skin->vertex_count + skin->inner_count, crossings = touch->tangle.crossing.count;
    sk_whole *solid[2];
    size_t first = 0;
    while (first < crossings && !of_solids(touch, first, solid)) first++;
    if (first == crossings) return;
    uint32_t slot;
    for (size_t i = 0; i < skin->vertex_count; i++) {
        sk_whole *whole = &touch->tangle.whole[i];
        whole->held = false, whole->mass = 0;
        memset(whole->momentum, 0, sizeof whole->momentum), memset(whole->gained, 0, sizeof whole->gained);
    }
    for (size_t i = 0; i < count; i++) {
        sk_whole *one = moving(touch, i, &slot);
        const real inverse = sk_load(run->vector[SK_X], op->packed, slot).w;
        const sk_vec4 v = sk_load(run->vector[SK_V], op->packed, slot);
        one->held |= !(inverse > 0);
        if (inverse > 0) add_momentum(one, 1 / (double)inverse, sk_xyz(v));
    }
    for (size_t i = first; i < crossings; i++)
        if (of_solids(touch, i, solid)) part(solid[0], solid[1]);
    for (size_t i = 0; i < count; i++) {
        const sk_whole *one = moving(touch, i, &slot);
        if (sk_load(run->vector[SK_X], op->packed, slot).w > 0) gain(run, op, slot, one->gained, 1);
    }
}

/* ---- who shares it ---- */

/* How far a vertex has gone, less what all go together. */
static sk_vec3 gone(const sk_touch *touch, size_t v) {
    return sk_add(sk_sub(sk_xyz(touch->stand[v]), sk_xyz(touch->p[v])), sk_way_left(touch, v));
}

/* What is too small to be shared, thicknesses a substep. */
static const real least = (real)0.5;

/* Of corners [first, end) the one that would lie farthest along n. */
static int farthest(const sk_touch *touch, const uint32_t v[4], int first, int end, sk_vec3 n) {
    int best = first;
    real most = -SK_REAL_MAX;
    for (int c = first; c < end; c++) {
        const real at = sk_dot(n, sk_add(sk_xyz(touch->stand[v[c]]), sk_xyz(touch->way[v[c]])));
        if (at > most) most = at, best = c;
    }
    return best;
}

static void share_in_pair(const sk_touch *touch, const sk_run *run, const sk_op *op, int sort, const sk_divided *pair) {
    const uint32_t *v = pair->corner;
    const sk_vec3 n = pair->normal;
    const int second = sort == SK_EDGES ? 2 : 1;
    const uint32_t upper = v[farthest(touch, v, 0, second, sk_scale(-1, n))],
                   lower = v[farthest(touch, v, second, 4, n)];
    const real gives[2] = {touch->inverse[upper], touch->inverse[lower]};
    if (!(gives[0] + gives[1] > 0)) return;
    sk_vec4 *velocity = run->vector[SK_V];
    const size_t slot[2] = {touch->slot[upper], touch->slot[lower]};
    const sk_vec3 parted = sk_scale((real)(1 / op->dt), sk_sub(gone(touch, upper), gone(touch, lower)));
    const sk_vec3 part =
        sk_sub(sk_xyz(sk_load(velocity, op->packed, slot[0])), sk_xyz(sk_load(velocity, op->packed, slot[1])));
    const real missing = sk_dot(n, sk_sub(parted, part));
    if (!(missing > least * pair->thickness / (real)op->dt)) return;
    const sk_vec3 blow = sk_scale(missing / (gives[0] + gives[1]), n);
    sk_add_at(velocity, op->packed, slot[0], sk_scale(gives[0], blow));
    sk_add_at(velocity, op->packed, slot[1], sk_scale(-gives[1], blow));
}

/* What a vertex' velocity has too much of who is held back; 0 where that is little. */
static sk_vec3 excess_of(const sk_touch *touch, const sk_run *run, const sk_op *op, size_t v) {
    const real rate = (real)(1 / op->dt);
    const sk_vec3 none = {0, 0, 0};
    if (!(touch->share[v] < 1) || !(touch->inverse[v] > 0)) return none;
    const sk_vec3 went = sk_scale(rate, sk_add(gone(touch, v), touch->common));
    const sk_vec3 excess = sk_sub(sk_xyz(sk_load(run->vector[SK_V], op->packed, touch->slot[v])), went);
    return sk_length(excess) > least * touch->thickness * rate ? excess : none;
}

/* Who is held back where he is, and pulled at by springs all the same, gets faster and faster, for pairs take only what brings their features
 * together, once each, and springs lose nothing while nobody moves. So who has more than that gives a part of it to all of his group, the larger the more he
 * has, and what holds the group up takes its share. (Of 160 sacks of cloth in each other, with boxes in and on them, 3 had 1,200 to 6,500 J after 8 s;
 * now 53 at most. Where all of it was lost to nobody, a box on a sack drove off by that.) */
static void lose_excess(sk_touch *touch, const sk_run *run, const sk_op *op) {
    const real lost = (real)0.01, most = (real)0.1,
               rate = (real)(1 / op->dt); // of what is a thickness a substep; at most
    const size_t count = touch->skin.vertex_count;
    bool any = false;
    for (size_t v = 0; v < count && !any; v++) any = sk_length(excess_of(touch, run, op, v)) > 0;
    if (!any) return;
    for (uint32_t i = 0; i < count && !touch->tangle.any; i++)
        touch->tangle.group[i] = i; // or crossings have joined it
    join_divided(touch);
    forget_momenta(touch);
    memset(touch->loses, SHARES_LOSS, count);
    for (size_t v = 0; v < count; v++) {
        sk_whole *group = group_of(touch, touch->skin.piece[v]);
        const sk_vec3 all = excess_of(touch, run, op, v);
        const sk_vec3 excess = sk_scale(sk_min(most, lost * sk_length(all) / (touch->thickness * rate)), all);
        if (touch->inverse[v] > 0) add_momentum(group, 1 / (double)touch->inverse[v], excess);
        else group->held = true;
        sk_add_at(run->vector[SK_V], op->packed, touch->slot[v], sk_scale(-1, excess));
    }
    give_back(touch, run, op);
}

bool sk_touch_share_velocities(sk_touch *touch, sk_allocator *allocator, const sk_run *run, const sk_op *op) {
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        const sk_divided_list *list = &touch->divided[sort];
        const sk_pair_place *place = sk_touch_order_divided(touch, allocator, sort);
        if (!place) return false;
        for (size_t i = 0; i < list->count; i++)
            if (!i || place[i].key != place[i - 1].key) share_in_pair(touch, run, op, sort, &list->data[place[i].at]);
    }
    if (!sk_tangle_reserve(touch, allocator)) return false;
    lose_excess(touch, run, op);
    return true;
}
