/* A limit on speed: |v| is at most the limit plus what predators have added to it in this substep. It is applied
 * between the kick and the drift of methods that have them (methods/plan_builder_steer.c). */
#include "base/arithmetic.h"
#include "forces/force.h"

typedef struct speed_limit_params {
    double limit;
} speed_limit_params;

// ---- arithmetic ----
SK_INLINE vec3 speed_limit_bound(speed_limit_params p, vec4 x, vec3 v, vec4 steering, exact dt) {
    num most = PARAM(p.limit) + steering.w, square = dot(v, v);
    most = pick(most > 0, most, 0);
    flag over = square > most * most;
    if (none(over)) return v;
    return times(pick(over, most / root(square), 1), v);
}
// ---- end of arithmetic ----

#define SK_UNIT speed_limit
SK_KERNELS(sk_op_kernel, kernel);
#define PARAMS speed_limit_params
#define BOUND speed_limit_bound
#include "forces/each_particle.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(speed_limit_params, limit, "limit", "m/s", 9, 0, SK_FAR, "the highest speed; what flees may be faster"),
};

const sk_force_type sk_speed_limit = {
    .kind = {"speed_limit", "nothing is faster than this", SKEIN_FORCE, fields, sizeof fields / sizeof *fields,
             sizeof(speed_limit_params)},
    .domain = SK_OVER_PARTICLES,
    .phase = SK_BOUNDS,
    .kernel = {SK_EACH_ISA(kernel)},
    .shader = {.arithmetic = "forces/speed_limit"},
};
#endif
