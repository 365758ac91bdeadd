/* A predator: particles within its reach R flee from it, and may fly faster while they do.
 *
 *   d = predator - x, without its part along the line of sight:   v += d/|d| (|d|^2/R^2 - 1) strength dt,
 *   which points away, and their speed limit is `alarm` higher in this substep
 *
 * It is a place seen along a line (for example under the mouse: it acts at any depth), or a point in space if there is
 * no line, or one of the particles. */
#include "forces/force.h"

#include "base/arithmetic.h"
#include "base/status.h"

typedef struct predator_params {
    double position[3], line[3], radius, strength, alarm;
    int32_t particle;
} predator_params;

// ---- arithmetic ----
SK_INLINE vec4 predator_steer(predator_params p, vec3 x, exact dt) {
    vec3 d = minus(PARAM3(p.position), x), none_at_all = vec3_of(0, 0, 0);
    vec3 line = times(PARAM(p.particle >= 0 ? 0 : 1), PARAM3(p.line)); // a predator that is a particle has no line
    num along = root(dot(line, line));
    line = times(pick(along > 0, 1 / along, 0), line);
    d = minus(d, times(dot(d, line), line));
    num square = dot(d, d);
    flag near = square < PARAM(p.radius * p.radius);
    if (none(near)) return vec4_of(none_at_all, 0);
    // at distance 0 there is no direction to flee in
    num k = PARAM(dt * p.strength) * (square / PARAM(p.radius * p.radius) - 1) / root(square);
    return vec4_of(times(pick(both(near, square > 0), k, 0), d), pick(near, PARAM(p.alarm), 0));
}
// ---- end of arithmetic ----

#define SK_UNIT predator
SK_KERNELS(sk_op_kernel, kernel);
#define PARAMS predator_params
#define STEER predator_steer
#define LOOKS_FROM position
#define SELDOM
#include "forces/each_particle.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_VEC3(predator_params, position, "position", "m", 0, 0, 0, "where it is, where no particle is given"),
    SK_VEC3(predator_params, line, "line", "", 0, 0, 0,
            "the line of sight that it acts along, at any depth; 0 0 0: it is in one place"),
    SK_INT(predator_params, particle, "particle", "", -1, -1, 4294967294.0 / 2, "the particle that it is; -1: none"),
    SK_REAL(predator_params, radius, "radius", "m", 100, 0, 1e9, "how far it is feared"),
    SK_REAL(predator_params, strength, "strength", "m/s2", 100, -SK_FAR, SK_FAR,
            "the acceleration away when it is very near"),
    SK_REAL(predator_params, alarm, "alarm", "m/s", 5, -SK_FAR, SK_FAR,
            "how much higher the speed limit is for those who flee"),
};

static skein_status check(const void *data, size_t particle_count, skein_error *error) {
    const predator_params *params = data;
    if (params->particle >= 0 && (size_t)params->particle >= particle_count)
        return sk_fail(error, SKEIN_ERROR_VALUE, "particle", "there is no particle %d: the world has %zu",
                       params->particle, particle_count);
    return SKEIN_OK;
}

static int32_t particle(const void *params) {
    return ((const predator_params *)params)->particle;
}

const sk_force_type sk_predator = {
    .kind = {"predator", "what is near flees from it: a place, a line of sight or a particle", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(predator_params)},
    .domain = SK_OVER_PARTICLES,
    .phase = SK_STEERS,
    .kernel = {SK_EACH_ISA(kernel)},
    .check = check,
    .particle = particle,
    .shader = {.arithmetic = "forces/predator"},
};
#endif
