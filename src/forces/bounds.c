/* Bounds: a box or a ball that particles leave by no more than a step.
 *
 *   wall       a particle that is outside, or would be after this substep, has its velocity mirrored inwards
 *   periodic   a particle outside a box comes in again at the opposite side; neighbours do not reach across */
#include "forces/force.h"

#include "base/arithmetic.h"
#include "base/status.h"

typedef struct bounds_params {
    int32_t shape, edge;
    double centre[3], size[3], radius;
} bounds_params;

enum { BOX, BALL };
enum { WALL, PERIODIC };

// ---- arithmetic ----
/* The speed along one axis, mirrored if the particle leaves. */
SK_INLINE num bounds_mirrored(num at, num speed, scalar h, scalar low, scalar high) {
    num next = at + h * speed;
    flag leaves = either(both(next > high, speed > 0), both(next < low, speed < 0));
    return pick(leaves, -speed, speed);
}

SK_INLINE vec3 bounds_in_box(bounds_params p, vec3 x, vec3 v, scalar h) {
    return vec3_of(
        bounds_mirrored(x.x, v.x, h, PARAM(p.centre[0] - 0.5 * p.size[0]), PARAM(p.centre[0] + 0.5 * p.size[0])),
        bounds_mirrored(x.y, v.y, h, PARAM(p.centre[1] - 0.5 * p.size[1]), PARAM(p.centre[1] + 0.5 * p.size[1])),
        bounds_mirrored(x.z, v.z, h, PARAM(p.centre[2] - 0.5 * p.size[2]), PARAM(p.centre[2] + 0.5 * p.size[2])));
}

SK_INLINE vec3 bounds_in_ball(bounds_params p, vec3 x, vec3 v, scalar h) {
    vec3 d = minus(plus(x, times(h, v)), PARAM3(p.centre));
    num square = dot(d, d), leaving = dot(d, v);
    scalar radius = PARAM(p.radius);
    flag over = both(square > radius * radius, leaving > 0);
    return minus(v, times(pick(over, 2 * leaving / square, 0), d));
}

SK_INLINE vec3 bounds_bound(bounds_params p, vec4 x, vec3 v, vec4 steering, exact dt) {
    vec3 kept;
    if (p.shape != 0) kept = bounds_in_ball(p, xyz(x), v, PARAM(dt));
    else kept = bounds_in_box(p, xyz(x), v, PARAM(dt));
    return pick3(x.w > 0, kept, v);
}

/* The shift along one axis: the size of the box, if the particle is outside. */
SK_INLINE num bounds_back(num at, scalar size, scalar low, scalar high) {
    return pick(at > high, -size, pick(at < low, size, 0));
}

SK_INLINE vec3 bounds_shift(bounds_params p, vec3 x) {
    return vec3_of(
        bounds_back(x.x, PARAM(p.size[0]), PARAM(p.centre[0] - 0.5 * p.size[0]), PARAM(p.centre[0] + 0.5 * p.size[0])),
        bounds_back(x.y, PARAM(p.size[1]), PARAM(p.centre[1] - 0.5 * p.size[1]), PARAM(p.centre[1] + 0.5 * p.size[1])),
        bounds_back(x.z, PARAM(p.size[2]), PARAM(p.centre[2] - 0.5 * p.size[2]), PARAM(p.centre[2] + 0.5 * p.size[2])));
}
// ---- end of arithmetic ----

#define SK_UNIT bounds
SK_KERNELS(sk_op_kernel, kernel);
#define PARAMS bounds_params
#define BOUND bounds_bound
#define SHIFT bounds_shift
#include "forces/each_particle.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_CHOICE(bounds_params, shape, "shape", BOX, "box|sphere", "what is not left"),
    SK_CHOICE(bounds_params, edge, "edge", WALL, "wall|periodic",
              "what leaves is turned back, or comes in at the other side of the box"),
    SK_VEC3(bounds_params, centre, "centre", "m", 0, 0, 0, "its middle"),
    SK_SIZE3(bounds_params, size, "size", "m", 100, 100, 100, "of the box, from side to side"),
    SK_REAL(bounds_params, radius, "radius", "m", 50, 1e-6, 1e9, "of the sphere"),
};

static skein_status check(const void *data, size_t particle_count, skein_error *error) {
    const bounds_params *params = data;
    (void)particle_count;
    if (params->edge == PERIODIC && params->shape == BALL)
        return sk_fail(error, SKEIN_ERROR_VALUE, "edge", "a sphere has no other side: periodic bounds are a box");
    return SKEIN_OK;
}

static bool shifts(const void *params) {
    return ((const bounds_params *)params)->edge == PERIODIC;
}

const sk_force_type sk_bounds = {
    .kind = {"bounds", "a box or a sphere that is not left", SKEIN_FORCE, fields, sizeof fields / sizeof *fields,
             sizeof(bounds_params)},
    .domain = SK_OVER_PARTICLES,
    .phase = SK_BOUNDS,
    .once = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .check = check,
    .shader = {.arithmetic = "forces/bounds", .shifts = shifts},
};
#endif
