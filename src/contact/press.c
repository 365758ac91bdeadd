/* What is near within an implicit solve: pairs press their features apart by forces, which the solve balances against all
 * others. A push of positions after the solve, as other methods take it, knows nothing of springs: the next solve pulls
 * back what it has stretched, is stopped by the bound, and from substep to substep a crumpled tube is stretched threefold.
 *
 * Each pair that is near when the substep begins has, along the normal n that it has there and by the weights w of its corners,
 *
 *   k (wanted - n . sum w x)^2 / 2   below `wanted`,   k = 4 (thickness / d)^2 m / h^2,   1/m = sum w^2 / mass
 *
 * as its potential, where d is the distance that it has and `wanted` lies a quarter of the way from there to its thickness, and
 * no farther than half as far again. So it is a spring that is damped as it gives way, and throws nothing; at a thickness it
 * holds what a substep brings of inertia and weight, and yields to stiff springs, but the less the nearer it is. What comes
 * nearer all the same is left to the bound. Friction has a potential of the slip's speed: its force is of one size, mu times
 * the force that presses when the substep begins, but where the slip all but rests. It never speeds anything up.
 *
 * All of it follows from the state when the substep begins, in the order of pairs. */
#include <string.h>

#include "base/memory.h"
#include "contact/touch.h"

static sk_touch *touch_of(const sk_op *op) {
    return ((const sk_force *)op->rule)->state;
}

static inline sk_vec3 sum_of(const sk_press *press, const sk_vec4 *x, size_t packed) {
    sk_vec3 sum = {0, 0, 0};
    for (int c = 0; c < 4; c++)
        sum = sk_add(sum, sk_scale(press->weight[c], sk_xyz(sk_load(x, packed, press->slot[c]))));
    return sum;
}

static inline void spread(const sk_press *press, sk_vec3 what, sk_vec4 *to, size_t packed) {
    for (int c = 0; c < 4; c++) sk_add_at(to, packed, press->slot[c], sk_scale(press->weight[c], what));
}

/* How it presses what is so far apart; false where all of it is pinned. */
static bool set_press(const sk_touch *touch, sk_press *press, real resist, real distance, real thickness, real friction,
                      real h) {
    if (!(resist > 0)) return false;
    const real stiffness = 4, part = (real)0.25, nearest = (real)0.005; // the last: of the thickness
    const real near = sk_max(distance, nearest * thickness), missing = sk_max(0, thickness - distance);
    const real tight = sk_max(1, thickness / near);
    // what has come too near in some other way gets its thickness back over some substeps, not as a blow
    const real gain = sk_min(sk_min(part * missing, (real)0.5 * near), 60 * h * touch->thickness);
    press->wanted = sk_min(thickness, distance + gain);
    press->stiffness = stiffness * tight * tight / (resist * h * h);
    press->grip = press->stiffness * gain * friction;
    press->rest = (real)0.2 * touch->thickness; // in a second
    return true;
}

/* Takes a pair over as it is when the substep begins; false where all of it is pinned. */
static bool begin_press(sk_touch *touch, const sk_op *op, int sort, uint32_t entry, sk_press *press) {
    const sk_contact_params *params = ((const sk_force *)op->rule)->params;
    const sk_pairs *pairs = sk_pairs_of(touch, sort, entry);
    const size_t k = entry / 2;
    const real h = (real)op->dt, distance = pairs->distance[k];
    const uint32_t v[4] = {pairs->corner[0][k], pairs->corner[1][k], pairs->corner[2][k], pairs->corner[3][k]};
    const real thickness = sk_pair_goal(touch, v[0], v[2], pairs->thickness[k], distance);
    if (distance < SK_NO_GAP * touch->thickness) sk_touch_choose_side(touch, sort, entry);
    sk_weights_of(pairs, sort, k, press->weight);
    for (int c = 0; c < 4; c++) {
        press->slot[c] = touch->slot[v[c]];
        press->at[c] = v[c];
    }
    press->normal = (sk_vec3){pairs->normal[0][k], pairs->normal[1][k], pairs->normal[2][k]};
    press->surface = (sk_vec3){0, 0, 0};
    return set_press(touch, press, sk_pair_resist(touch, v, press->weight), distance, thickness,
                     sk_pair_friction(touch, v[0], v[2], (real)params->friction), h);
}

/* The same of an edge or triangle that is near a collider, which is where it will be. */
static bool begin_face(const sk_touch *touch, const sk_face *face, real h, sk_press *press) {
    const uint32_t v[4] = {face->corner[0], face->corner[1], face->corner[2], face->corner[0]};
    real at = 0;
    for (int c = 0; c < 4; c++) {
        press->weight[c] = c < 3 ? face->weight[c] : 0;
        press->slot[c] = touch->slot[v[c]], press->at[c] = v[c];
        at += press->weight[c] * sk_dot(face->normal, sk_xyz(touch->p[v[c]]));
    }
    press->normal = face->normal;
    press->surface = sk_scale(1 / h, face->way);
    const real distance = at - sk_dot(face->normal, sk_sub(face->at, face->way));
    const bool presses =
        set_press(touch, press, sk_pair_resist(touch, v, press->weight), distance, face->thickness, face->friction, h);
    press->wanted += sk_dot(face->normal, face->at);
    return presses;
}

/* Numbers the vertices that press in the order in which they come, so that a product passes over these alone. */
static void number_corners(sk_touch *touch) {
    touch->press.slot_count = 0;
    memset(touch->press.number, 0, touch->skin.vertex_count * sizeof *touch->press.number);
    for (size_t i = 0; i < touch->press.pair.count; i++) {
        sk_press *press = &touch->press.pair.data[i];
        for (int c = 0; c < 4; c++) {
            uint32_t *at = &touch->press.number[press->at[c]];
            if (!*at) {
                touch->press.slot[touch->press.slot_count++] = press->slot[c];
                *at = (uint32_t)touch->press.slot_count;
            }
            press->at[c] = *at - 1;
        }
    }
}

void sk_press_begin(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = touch_of(op);
    if (!touch) return;
    touch->implicit = true, touch->corrects = false;
    touch->press.pair.count = touch->press.now.count = 0;
    sk_touch_start_faces(touch, run, op);
    const size_t most = touch->near[SK_CORNERS].count + touch->near[SK_EDGES].count + touch->faces.near.count;
    if (!most) return;
    if (!SK_RESERVE(run->allocator, &touch->press.pair, most) || !SK_RESERVE(run->allocator, &touch->press.now, most)) {
        run->no_memory = true;
        return;
    }
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t i = 0; i < touch->near[sort].count; i++) {
            sk_press *next = &touch->press.pair.data[touch->press.pair.count];
            touch->press.pair.count += begin_press(touch, op, sort, touch->near[sort].data[i], next);
        }
    for (size_t i = 0; i < touch->faces.near.count; i++)
        touch->press.pair.count += begin_face(touch, &touch->faces.near.data[i], (real)op->dt,
                                              &touch->press.pair.data[touch->press.pair.count]);
    number_corners(touch);
}

/* Its slip across the normal, and how fast that is. */
static inline sk_vec3 slip_of(const sk_press *press, const sk_run *run, size_t packed, real *speed) {
    sk_vec3 slip = sk_sub(sum_of(press, run->vector[SK_V], packed), press->surface), n = press->normal;
    slip = sk_sub(slip, sk_scale(sk_dot(n, slip), n));
    *speed = sk_length(slip);
    return slip;
}

static inline real missing_of(const sk_press *press, const sk_run *run, size_t packed) {
    return press->wanted - sk_dot(press->normal, sum_of(press, run->vector[SK_X], packed));
}

void sk_press_force(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    const sk_touch *touch = touch_of(op);
    for (size_t i = 0; touch && i < touch->press.pair.count; i++) {
        const sk_press *press = &touch->press.pair.data[i];
        const real missing = missing_of(press, run, op->packed);
        sk_vec3 sum = {0, 0, 0};
        if (missing > 0) sum = sk_scale(press->stiffness * missing, press->normal);
        if (press->grip > 0) {
            real speed;
            sk_vec3 slip = slip_of(press, run, op->packed, &speed);
            sum = sk_sub(sum, sk_scale(press->grip / sk_max(speed, press->rest), slip));
        } else if (!(missing > 0)) continue;
        spread(press, sum, run->vector[op->dst], op->packed);
    }
}

/* What the matrix has of a pair, times a k + b c: push n n^T + rub (1 - n n^T - t t^T), where t is the slip's direction. Of who
 * slips, friction does not change along it. */
static bool linearise(const sk_press *press, const sk_run *run, const sk_op *op, sk_quad column[3]) {
    const real push = missing_of(press, run, op->packed) > 0 ? (real)op->coefficient[0] * press->stiffness : 0;
    real speed = 0, rub = 0;
    sk_vec3 n = press->normal, t = {0, 0, 0};
    if (press->grip > 0) {
        sk_vec3 slip = slip_of(press, run, op->packed, &speed);
        rub = (real)op->coefficient[1] * press->grip / sk_max(speed, press->rest);
        if (speed > press->rest) t = sk_scale(1 / speed, slip);
    }
    if (!(push > 0) && !(rub > 0)) return false;
    const real more = push - rub;
    column[0] = (sk_quad){more * n.x * n.x - rub * t.x * t.x + rub, more * n.x * n.y - rub * t.x * t.y,
                          more * n.x * n.z - rub * t.x * t.z, 0};
    column[1] =
        (sk_quad){column[0][1], more * n.y * n.y - rub * t.y * t.y + rub, more * n.y * n.z - rub * t.y * t.z, 0};
    column[2] = (sk_quad){column[0][2], column[1][2], more * n.z * n.z - rub * t.z * t.z + rub, 0};
    return true;
}

void sk_press_diagonal(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = touch_of(op);
    if (!touch) return;
    touch->press.now.count = 0;
    for (size_t i = 0; i < touch->press.pair.count; i++) {
        const sk_press *press = &touch->press.pair.data[i];
        sk_pressing *now = &touch->press.now.data[touch->press.now.count];
        sk_quad column[3];
        if (!linearise(press, run, op, column)) continue;
        for (int c = 0; c < 4; c++) {
            const real square = press->weight[c] * press->weight[c];
            const sk_vec3 own = {column[0][0], column[1][1], column[2][2]},
                          off = {column[0][1], column[0][2], column[1][2]};
            sk_add_at(run->vector[op->dst], op->packed, press->slot[c], sk_scale(square, own));
            sk_add_at(run->vector[op->source[1]], op->packed, press->slot[c], sk_scale(square, off));
            now->at[c] = press->at[c];
            now->weight[c] = press->weight[c];
        }
        memcpy(now->column, column, sizeof column);
        touch->press.now.count++;
    }
}

/* Of those pairs alone that press or rub: products are what an iteration of conjugate gradients waits for. */
void sk_press_apply(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = touch_of(op);
    if (!touch || !touch->press.now.count) return;
    sk_vec4 *p = touch->q, *sum = touch->way; // which a bound loads anew
    for (size_t v = 0; v < touch->press.slot_count; v++) {
        p[v] = sk_load(run->vector[op->source[1]], op->packed, touch->press.slot[v]);
        sum[v] = (sk_vec4){0, 0, 0, 0};
    }
    for (size_t i = 0; i < touch->press.now.count; i++) {
        const sk_pressing *now = &touch->press.now.data[i];
        sk_quad apart = sk_quad_sum(p, now->at, now->weight);
        sk_quad product = sk_quad_times(apart[0], now->column[0]) + sk_quad_times(apart[1], now->column[1]) +
                          sk_quad_times(apart[2], now->column[2]);
        for (int c = 0; c < 4; c++) {
            sk_quad to = sk_quad_at(&sum[now->at[c]]) + sk_quad_times(now->weight[c], product);
            memcpy(&sum[now->at[c]], &to, sizeof to);
        }
    }
    for (size_t v = 0; v < touch->press.slot_count; v++)
        sk_add_at(run->vector[op->dst], op->packed, touch->press.slot[v], sk_xyz(sum[v]));
}
