/* A solid ball. */
#include "colliders/shape.h"

typedef struct sphere_params {
    double centre[3], radius, mass;
} sphere_params;

#define SK_UNIT sphere
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

// ---- arithmetic ----
SK_INLINE sk_contact sphere_probe(sphere_params p, sk_pose where, vec3 x) {
    vec3 d = minus(x, position_of(where));
    num away = root(dot(d, d));
    // at the very centre every way out is as good: take up
    flag apart = away > 0;
    num per = 1 / pick(apart, away, 1);
    return contact_of(vec3_of(per * d.x, pick(apart, per * d.y, 1), per * d.z), away - PARAM(p.radius));
}
// ---- end of arithmetic ----

SK_PROBE(sphere)

#else

static const skein_field fields[] = {
    SK_VEC3(sphere_params, centre, "centre", "m", 0, 0, 0, "the centre, before any motion"),
    SK_REAL(sphere_params, radius, "radius", "m", 0.5, 1e-9, SK_FAR, "the radius"),
    SK_REAL(sphere_params, mass, "mass", "kg", 0, 0, SK_FAR,
            "instead of the restitution: particles bounce as off a ball of that mass, which stays; 0 is none"),
};

static void place(const void *data, double position[3]) {
    const sphere_params *params = data;
    for (int k = 0; k < 3; k++) position[k] = params->centre[k];
}

static double mass_of(const void *params) {
    return ((const sphere_params *)params)->mass;
}

static void tell_shape(const void *data, skein_shape *shape) {
    *shape = (skein_shape){.sort = SKEIN_SHAPE_BALL, .radius = ((const sphere_params *)data)->radius};
}

const sk_collider_type sk_sphere = {
    .kind = {"sphere", "a ball, solid inside", SKEIN_COLLIDER, fields, sizeof fields / sizeof *fields,
             sizeof(sphere_params)},
    .place = place,
    .mass = mass_of,
    .probe = SK_EACH_ISA(probe),
    .shape = tell_shape,
    .passing = SK_CONVEX,
    .shader = {.arithmetic = "colliders/sphere"},
};
#endif
