/* All that is within a radius of a line between two points: a rod with round ends. */
#include "colliders/shape.h"

typedef struct capsule_params {
    double from[3], to[3], radius;
} capsule_params;

#define SK_UNIT capsule
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

// ---- arithmetic ----
SK_INLINE sk_contact capsule_probe(capsule_params p, sk_pose where, vec3 x) {
    vec3 half_line = turned(where, vec3_of(PARAM(0.5 * (p.to[0] - p.from[0])), PARAM(0.5 * (p.to[1] - p.from[1])),
                                           PARAM(0.5 * (p.to[2] - p.from[2])))); // from the middle to `to`
    num square = dot(half_line, half_line);
    flag is_line = square > 0;
    // the nearest point of the line is at the middle plus t halves of it
    vec3 d = minus(x, position_of(where));
    num t = dot(d, half_line) * pick(is_line, 1 / square, 0);
    t = pick(t > 1, 1, pick(t < -1, -1, t));
    d = minus(d, times(t, half_line));
    num away = root(dot(d, d)), below = pick(away > 0, away, 1);
    if (none(away <= 0)) return contact_of(vec3_of(d.x / below, d.y / below, d.z / below), away - PARAM(p.radius));
    // on the line itself every way aside is as good: up, as far as that is across; of an upright one, along x
    vec3 up = minus(vec3_of(0, 1, 0), times(pick(is_line, half_line.y / square, 0), half_line));
    num rise = root(dot(up, up));
    vec3 aside = pick3(rise > PARAM(1e-3), times(1 / rise, up), vec3_of(1, 0, 0));
    return contact_of(pick3(away > 0, vec3_of(d.x / below, d.y / below, d.z / below), aside), away - PARAM(p.radius));
}
// ---- end of arithmetic ----

SK_PROBE(capsule)

#else

static const skein_field fields[] = {
    SK_VEC3(capsule_params, from, "from", "m", -0.5, 0, 0, "one end of its line, before any motion"),
    SK_VEC3(capsule_params, to, "to", "m", 0.5, 0, 0, "the other end"),
    SK_REAL(capsule_params, radius, "radius", "m", 0.1, 1e-9, SK_FAR, "around the line"),
};

static void place(const void *data, double position[3]) {
    const capsule_params *params = data;
    for (int k = 0; k < 3; k++) position[k] = 0.5 * (params->from[k] + params->to[k]);
}

static void axis(const void *data, double unit[3]) {
    const capsule_params *params = data;
    double d[3], square = 0;
    for (int k = 0; k < 3; k++) d[k] = params->to[k] - params->from[k], square += d[k] * d[k];
    for (int k = 0; k < 3; k++) unit[k] = square > 0 ? d[k] / __builtin_sqrt(square) : k == 1;
}

static void tell_shape(const void *data, skein_shape *shape) {
    const capsule_params *params = data;
    *shape = (skein_shape){.sort = SKEIN_SHAPE_CAPSULE, .radius = params->radius};
    for (int k = 0; k < 3; k++) shape->axis[k] = 0.5 * (params->to[k] - params->from[k]);
}

const sk_collider_type sk_capsule = {
    .kind = {"capsule", "a rod with round ends: a ball drawn along a line", SKEIN_COLLIDER, fields,
             sizeof fields / sizeof *fields, sizeof(capsule_params)},
    .place = place,
    .axis = axis,
    .probe = SK_EACH_ISA(probe),
    .shape = tell_shape,
    .passing = SK_CONVEX,
    .shader = {.arithmetic = "colliders/capsule"},
};
#endif
