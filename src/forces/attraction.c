/* Attraction: every particle is drawn to a centre with the same acceleration at any distance. If `flatness` makes the
 * vertical part larger, particles gather in a ring round the centre, of radius v^2/strength at speed v.
 *
 *   d = (centre - x), with d.y flatness times as large:   v += strength dt d/|d| */
#include "base/arithmetic.h"
#include "forces/force.h"

typedef struct attraction_params {
    double centre[3], strength, flatness;
} attraction_params;

// ---- arithmetic ----
SK_INLINE vec4 attraction_steer(attraction_params p, vec3 x, exact dt) {
    vec3 d = minus(PARAM3(p.centre), x);
    d.y = PARAM(p.flatness) * d.y;
    num square = dot(d, d);
    return vec4_of(times(pick(square > 0, PARAM(dt * p.strength) / root(square), 0), d), 0);
}
// ---- end of arithmetic ----

#define SK_UNIT attraction
SK_KERNELS(sk_op_kernel, kernel);
#define PARAMS attraction_params
#define STEER attraction_steer
#include "forces/each_particle.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_VEC3(attraction_params, centre, "centre", "m", 0, 0, 0, "where everything is drawn to"),
    SK_REAL(attraction_params, strength, "strength", "m/s2", 5, -SK_FAR, SK_FAR, "the acceleration, at any distance"),
    SK_REAL(attraction_params, flatness, "flatness", "", 2.5, 0, 1e6,
            "how many times more the vertical counts: over 1 makes a ring, 1 is the same all round"),
};

const sk_force_type sk_attraction = {
    .kind = {"attraction", "draws everything to a centre, equally at any distance; flatter in the vertical",
             SKEIN_FORCE, fields, sizeof fields / sizeof *fields, sizeof(attraction_params)},
    .domain = SK_OVER_PARTICLES,
    .phase = SK_STEERS,
    .kernel = {SK_EACH_ISA(kernel)},
    .shader = {.arithmetic = "forces/attraction"},
};
#endif
