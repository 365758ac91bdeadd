/* What is near is moved apart, pair by pair, where a method corrects positions; and what goes through each other is led apart. */
#include <string.h>

#include "contact/touch.h"

/* Of the first three. */
static inline real dot_of(sk_quad a, sk_quad b) {
    sk_quad c = a * b;
    return c[0] + c[1] + c[2];
}

/* Pushes features apart to a distance, and rubs them by what that took. */
static void push_apart(sk_touch *touch, const uint32_t v[4], const real weight[4], sk_quad n, real wanted, real friction) {
    sk_vec4 *q = touch->q;
    sk_quad apart = sk_quad_sum(q, v, weight);
    const real missing = wanted - dot_of(n, apart);
    if (!(missing > 0)) return; // as of most
    const real resist = sk_pair_resist(touch, v, weight);
    if (!(resist > 0)) return;
    sk_quad slip = apart - sk_quad_sum(touch->p, v, weight);
    slip[3] = 0;
    slip -= sk_quad_times(dot_of(slip, n), n);
    real length = sk_sqrt(dot_of(slip, slip)), rub = friction * missing;
    real share = length > rub ? rub / length : 1;
    sk_quad move = sk_quad_times(missing / resist, n) - sk_quad_times(friction > 0 ? share / resist : 0, slip);
    for (int c = 0; c < 4; c++) {
        sk_quad to = sk_quad_at(&q[v[c]]) + sk_quad_times(weight[c] * touch->inverse[v[c]], move);
        to[3] = 1; // moved
        memcpy(&q[v[c]], &to, sizeof to);
    }
}

static void push_pair(sk_touch *touch, const sk_pairs *near, int sort, size_t k, real gain, real friction) {
    real weight[4];
    const uint32_t v[4] = {near->corner[0][k], near->corner[1][k], near->corner[2][k], near->corner[3][k]};
    sk_weights_of(near, sort, k, weight);
    const sk_quad n = {near->normal[0][k], near->normal[1][k], near->normal[2][k], 0};
    // what has come too near in some other way gets its thickness back over some substeps, not as a blow
    const real goal = sk_pair_goal(touch, v[0], v[2], near->thickness[k], near->distance[k]);
    push_apart(touch, v, weight, n, sk_min(goal, near->distance[k] + gain), friction);
}

/* Puts a vertex that was pushed back to its slot, with the velocity that it got. */
static void store(const sk_touch *touch, const sk_run *run, const sk_op *op, size_t v) {
    if (!(touch->q[v].w > 0)) return;
    const size_t slot = touch->slot[v];
    const sk_vec3 old = sk_xyz(sk_load(run->vector[SK_X], op->packed, slot)), now = sk_xyz(touch->q[v]);
    sk_store_at(run->vector[SK_X], op->packed, slot, now);
    if (op->source[1] != SK_NONE) sk_add_at(run->vector[op->source[1]], op->packed, slot, sk_scale((real)(1 / op->dt), sk_sub(now, old)));
}

void sk_touch_push_face(sk_touch *touch, const sk_run *run, const sk_op *op, const sk_face *face) {
    const uint32_t surface = (uint32_t)touch->skin.vertex_count, v[4] = {face->corner[0], face->corner[1], face->corner[2], surface};
    const real weight[4] = {face->weight[0], face->weight[1], face->weight[2], -1};
    const sk_vec3 from = sk_sub(face->at, face->way);
    for (int c = 0; c < 3; c++) {
        touch->q[v[c]] = sk_load(run->vector[SK_X], op->packed, touch->slot[v[c]]);
        touch->q[v[c]].w = 0;
    }
    touch->q[surface] = (sk_vec4){face->at.x, face->at.y, face->at.z, 0};
    touch->p[surface] = (sk_vec4){from.x, from.y, from.z, 0};
    touch->inverse[surface] = 0;
    push_apart(touch, v, weight, (sk_quad){face->normal.x, face->normal.y, face->normal.z, 0}, face->wanted, face->friction);
    for (int c = 0; c < (face->weight[2] > 0 ? 3 : 2); c++) store(touch, run, op, v[c]);
}

static void push_near(sk_touch *touch, sk_run *run, const sk_op *op) {
    const sk_contact_params *params = ((const sk_force *)op->rule)->params;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        touch->q[v] = sk_load(run->vector[SK_X], op->packed, touch->slot[v]);
        touch->q[v].w = 0;
    }
    const real gain = (real)(60 * op->dt * (double)touch->thickness); // a thickness in a sixtieth of a second
    const real none = SK_NO_GAP * touch->thickness;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t i = 0; i < touch->near[sort].count; i++) {
            uint32_t entry = touch->near[sort].data[i];
            const sk_pairs *pairs = sk_pairs_of(touch, sort, entry);
            size_t k = entry / 2;
            if (pairs->distance[k] < none) sk_touch_choose_side(touch, sort, entry);
            real friction = sk_pair_friction(touch, pairs->corner[0][k], pairs->corner[2][k], (real)params->friction);
            push_pair(touch, pairs, sort, k, gain, friction);
        }
    for (size_t v = 0; v < touch->skin.vertex_count; v++) store(touch, run, op, v);
}

void sk_touch_lead(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = ((const sk_force *)op->rule)->state;
    if (!touch) return;
    // what is led apart gets no speed of it
    sk_tangle_lead(touch, run->vector[SK_X], op->source[1] == SK_NONE ? run->vector[SK_X0] : NULL, op->packed);
}

void sk_touch_push_on(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = ((const sk_force *)op->rule)->state;
    if (touch && touch->near[SK_CORNERS].count + touch->near[SK_EDGES].count) push_near(touch, run, op);
}

void sk_touch_push(sk_run *run, const sk_op *op, size_t from, size_t end) {
    sk_touch *touch = ((const sk_force *)op->rule)->state;
    if (!touch) return;
    touch->implicit = false;
    touch->corrects = op->source[1] == SK_NONE; // velocities are made of positions afterwards
    sk_touch_push_on(run, op, from, end);
    sk_touch_lead(run, op, from, end);
}
