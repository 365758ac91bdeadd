/* A limit on turning and climbing: what steers turns the direction of flight by so many degrees a second at most, and
 * nothing flies steeper than so many degrees. Speeds stay.
 *
 *          new   /o        o: the direction before, v - s, where s is what has steered
 *          v ..-'          n: what of v is square to it
 *      o ---->             turned by at most t:  |v| (o cos t + n/|n| sin t) */
#include "base/elementary.h"
#include "base/kernels.h"
#include "forces/force.h"

typedef struct turn_limit_params {
    double turn, climb;
} turn_limit_params;

#define SK_UNIT turn_limit
SK_KERNELS(sk_row_kernel, kernel);

#ifdef SK_ISA

/* Turns v no farther from the direction of `before` than the angle. Straight back means to the side first. */
SK_INLINE void turn(sk_wide4 *v, sk_wide3 before, real cosine, real sine, sk_mask moved) {
    const sk_wide zero = {0}, one = sk_splat(1);
    sk_wide square = v->x * v->x + v->y * v->y + v->z * v->z, old = sk_dot_wide(before, before);
    sk_mask flies = moved & sk_positive(square) & sk_positive(old);
    sk_wide speed = sk_wide_sqrt(square), per = one / sk_select(flies, sk_wide_sqrt(old), one);
    sk_wide3 o = {before.x * per, before.y * per, before.z * per};
    sk_wide along = v->x * o.x + v->y * o.y + v->z * o.z;
    sk_mask over = flies & sk_more(cosine * speed, along);
    if (!sk_any(over)) return;
    sk_wide3 n = {v->x - along * o.x, v->y - along * o.y, v->z - along * o.z};
    sk_wide side = sk_dot_wide(n, n);
    sk_mask back = sk_at_most(side, (real)1e-12 * square);
    // to the side in the level; of what flies straight up or down, along x
    sk_mask level = sk_more(o.x * o.x + o.z * o.z, sk_splat((real)1e-6));
    n.x = sk_select(back, sk_select(level, o.z, one), n.x);
    n.y = sk_select(back, zero, n.y);
    n.z = sk_select(back, sk_keep(level, -o.x), n.z);
    side = sk_wide_sqrt(sk_dot_wide(n, n));
    sk_wide a = speed * cosine, b = speed * sine / sk_select(sk_positive(side), side, one);
    v->x = sk_select(over, a * o.x + b * n.x, v->x);
    v->y = sk_select(over, a * o.y + b * n.y, v->y);
    v->z = sk_select(over, a * o.z + b * n.z, v->z);
}

/* Flattens what is steeper than the angle. What flies straight up or down goes along x. */
SK_INLINE void flatten(sk_wide4 *v, real cosine, real sine, sk_mask moved) {
    sk_wide level = v->x * v->x + v->z * v->z, square = level + v->y * v->y;
    sk_mask over = moved & sk_more(v->y * v->y, sine * sine * square);
    if (!sk_any(over)) return;
    sk_wide speed = sk_wide_sqrt(square), across = sk_wide_sqrt(level);
    sk_mask some = sk_positive(across);
    sk_wide s = speed * cosine / sk_select(some, across, sk_splat(1)), rise = speed * sine;
    sk_wide x = sk_select(some, s * v->x, speed * cosine);
    v->x = sk_select(over, x, v->x);
    v->z = sk_select(over, s * v->z, v->z);
    v->y = sk_select(over, sk_select(sk_negative(v->y), -rise, rise), v->y);
}

void SK_KERNEL(kernel)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_force *force = row->rule;
    const turn_limit_params *params = force->params;
    const double radian = 3.141592653589793 / 180;
    double angle = params->turn * radian * row->dt, turn_sine, turn_cosine, climb_sine, climb_cosine;
    bool turns = row->source[2] != SK_NONE && angle < 3.14159, climbs = params->climb < 90;
    sk_sincos(turns ? angle : 0, &turn_sine, &turn_cosine);
    sk_sincos(params->climb * radian, &climb_sine, &climb_cosine);
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_mask moved = sk_lanes_between(slot, force->moved.first_slot, force->moved.end_slot);
        if (turns) {
            sk_wide4 s = sk_load_part(run->vector[row->source[2]], slot, packed);
            sk_wide3 before = {v.x - s.x, v.y - s.y, v.z - s.z};
            turn(&v, before, (real)turn_cosine, (real)turn_sine, moved);
        }
        if (climbs) flatten(&v, (real)climb_cosine, (real)climb_sine, moved);
        sk_store_moved(run->vector[SK_V], slot, packed, v);
    }
}

#else

static const skein_field fields[] = {
    SK_REAL(turn_limit_params, turn, "turn", "degrees/s", 180, 0, 1e6, "what steers turns nothing faster than this"),
    SK_REAL(turn_limit_params, climb, "climb", "degrees", 90, 0, 90, "nothing flies steeper, up or down; 90: no limit"),
};

static void pack(const void *data, float (*block)[4]) {
    const turn_limit_params *params = data;
    const double radian = 3.141592653589793 / 180;
    double sine = 1, cosine = 0; // no limit
    if (params->climb < 90) sk_sincos(params->climb * radian, &sine, &cosine);
    block[0][0] = (float)(params->turn * radian), block[0][1] = (float)cosine, block[0][2] = (float)sine;
}

const sk_force_type sk_turn_limit = {
    .kind = {"turn_limit", "nothing turns faster or flies steeper than this", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(turn_limit_params)},
    .domain = SK_OVER_PARTICLES,
    .deed = SK_BOUNDS,
    .once = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .shader = {.file = "forces/turn_limit", .size = 1, .pack = pack},
};
#endif
