/* What the velocities of those become whom the bound holds back.
 *
 * They are not lost: a cloth of 0.2 kg stopped a cube of 1 kg in the air, and cubes that lay on a cloth drove off with it. Nor are they
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
#include "contact/touch.h"

/* How far a vertex has gone, less what all go together. */
static sk_vec3 gone(const sk_touch *touch, size_t v) {
    return sk_add(sk_sub(sk_xyz(touch->stand[v]), sk_xyz(touch->p[v])), sk_way_left(touch, v));
}

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
    const real least = (real)0.5; // thicknesses a substep
    const uint32_t *v = pair->corner;
    const sk_vec3 n = pair->normal;
    const int second = sort == SK_EDGES ? 2 : 1;
    const uint32_t upper = v[farthest(touch, v, 0, second, sk_scale(-1, n))], lower = v[farthest(touch, v, second, 4, n)];
    const real gives[2] = {touch->inverse[upper], touch->inverse[lower]};
    if (!(gives[0] + gives[1] > 0)) return;
    sk_vec4 *velocity = run->vector[SK_V];
    const size_t slot[2] = {touch->slot[upper], touch->slot[lower]};
    const sk_vec3 parted = sk_scale((real)(1 / op->dt), sk_sub(gone(touch, upper), gone(touch, lower)));
    const sk_vec3 part = sk_sub(sk_xyz(sk_load(velocity, op->packed, slot[0])), sk_xyz(sk_load(velocity, op->packed, slot[1])));
    const real missing = sk_dot(n, sk_sub(parted, part));
    if (!(missing > least * pair->thickness / (real)op->dt)) return;
    const sk_vec3 blow = sk_scale(missing / (gives[0] + gives[1]), n);
    sk_add_at(velocity, op->packed, slot[0], sk_scale(gives[0], blow));
    sk_add_at(velocity, op->packed, slot[1], sk_scale(-gives[1], blow));
}

bool sk_touch_share_velocities(sk_touch *touch, sk_allocator *allocator, const sk_run *run, const sk_op *op) {
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        const sk_divided_list *list = &touch->divided[sort];
        const sk_pair_place *place = sk_touch_order_divided(touch, allocator, sort);
        if (!place) return false;
        for (size_t i = 0; i < list->count; i++)
            if (!i || place[i].key != place[i - 1].key) share_in_pair(touch, run, op, sort, &list->data[place[i].at]);
    }
    return true;
}
