/* A limit on turning and climbing: steering turns the direction of flight by at most so many degrees a second, and no
 * particle flies steeper than so many degrees. Speeds stay the same.
 *
 *          new   /o        o: the direction before, v - s, where s is this substep's steering
 *          v ..-'          n: the part of v at right angles to it
 *      o ---->             turned by at most t:  |v| (o cos t + n/|n| sin t) */
#include "base/arithmetic.h"
#include "forces/force.h"

typedef struct turn_limit_params {
    double turn, climb;
} turn_limit_params;

// ---- arithmetic ----
/* Turns v to within the angle from the direction of `before`. A full reversal starts to the side. */
SK_INLINE vec3 turn_limit_turned(vec3 v, vec3 before, scalar angle_cosine, scalar angle_sine) {
    num square = dot(v, v), old = dot(before, before);
    flag flies = both(square > 0, old > 0);
    num speed = root(square);
    vec3 o = times(1 / pick(flies, root(old), 1), before);
    num along = dot(v, o);
    flag over = both(flies, angle_cosine * speed > along);
    if (none(over)) return v;
    vec3 n = minus(v, times(along, o));
    // sideways in the horizontal plane; along x for a particle that flies straight up or down
    flag back = dot(n, n) <= PARAM(1e-12) * square, level = o.x * o.x + o.z * o.z > PARAM(1e-6);
    n = pick3(back, vec3_of(pick(level, o.z, 1), 0, pick(level, -o.x, 0)), n);
    num side = root(dot(n, n)), a = speed * angle_cosine, b = speed * angle_sine / pick(side > 0, side, 1);
    return pick3(over, plus(times(a, o), times(b, n)), v);
}

/* Flattens flight steeper than the angle. A particle that flies straight up or down turns along x. */
SK_INLINE vec3 turn_limit_flattened(vec3 v, scalar climb_cosine, scalar climb_sine) {
    num level = v.x * v.x + v.z * v.z, square = level + v.y * v.y;
    flag over = v.y * v.y > climb_sine * climb_sine * square;
    if (none(over)) return v;
    num speed = root(square), ahead = root(level);
    flag some = ahead > 0;
    num s = speed * climb_cosine / pick(some, ahead, 1), rise = speed * climb_sine;
    return pick3(over, vec3_of(pick(some, s * v.x, speed * climb_cosine), pick(v.y < 0, -rise, rise), s * v.z), v);
}

SK_INLINE vec3 turn_limit_bound(turn_limit_params p, vec4 x, vec3 v, vec4 steering, exact dt) {
    const exact radian = 3.141592653589793 / 180;
    exact angle = p.turn * radian * dt, climb = p.climb * radian;
    scalar turn_cosine = PARAM(cosine(angle)), turn_sine = PARAM(sine(angle));
    scalar climb_cosine = PARAM(cosine(climb)), climb_sine = PARAM(sine(climb));
    vec3 by = xyz(steering), kept = v;
    if (angle < 3.14159) kept = pick3(dot(by, by) > 0, turn_limit_turned(v, minus(v, by), turn_cosine, turn_sine), v);
    if (p.climb < 90) kept = turn_limit_flattened(kept, climb_cosine, climb_sine);
    return kept;
}
// ---- end of arithmetic ----

#define SK_UNIT turn_limit
SK_KERNELS(sk_op_kernel, kernel);
#define PARAMS turn_limit_params
#define BOUND turn_limit_bound
#include "forces/each_particle.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(turn_limit_params, turn, "turn", "degrees/s", 180, 0, 1e6, "what steers turns nothing faster than this"),
    SK_REAL(turn_limit_params, climb, "climb", "degrees", 90, 0, 90, "nothing flies steeper, up or down; 90: no limit"),
};

const sk_force_type sk_turn_limit = {
    .kind = {"turn_limit", "nothing turns faster or flies steeper than this", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(turn_limit_params)},
    .domain = SK_OVER_PARTICLES,
    .phase = SK_BOUNDS,
    .once = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .shader = {.arithmetic = "forces/turn_limit"},
};
#endif
