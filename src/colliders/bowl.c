/* A ball from inside: everything outside of it is solid. */
#include "colliders/shape.h"

typedef struct bowl_params {
    double centre[3], radius, mass;
} bowl_params;

#define SK_UNIT bowl
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

// ---- arithmetic ----
SK_INLINE sk_contact bowl_probe(bowl_params p, sk_pose where, vec3 x) {
    vec3 d = minus(position_of(where), x);
    num away = root(dot(d, d));
    // in the very middle no way leads to the wall: there is no contact
    flag apart = away > 0;
    num below = pick(apart, away, 1);
    return contact_of(vec3_of(d.x / below, pick(apart, d.y / below, 1), d.z / below),
                      pick(apart, PARAM(p.radius) - away, PARAM(1e15)));
}
// ---- end of arithmetic ----

SK_PROBE(bowl)

#else

static const skein_field fields[] = {
    SK_VEC3(bowl_params, centre, "centre", "m", 0, 0, 0, "the middle, before any motion"),
    SK_REAL(bowl_params, radius, "radius", "m", 1, 1e-9, SK_FAR, "the radius"),
    SK_REAL(bowl_params, mass, "mass", "kg", 0, 0, SK_FAR,
            "instead of the restitution: particles bounce as off a wall of that mass, which stays; 0 is none"),
};

static void place(const void *data, double position[3]) {
    const bowl_params *params = data;
    for (int k = 0; k < 3; k++) position[k] = params->centre[k];
}

static double mass_of(const void *params) {
    return ((const bowl_params *)params)->mass;
}

static void tell_shape(const void *data, skein_shape *shape) {
    *shape = (skein_shape){.sort = SKEIN_SHAPE_BOWL, .radius = ((const bowl_params *)data)->radius};
}

const sk_collider_type sk_bowl = {
    .kind = {"bowl", "the inside of a ball: what is in it stays in it", SKEIN_COLLIDER, fields,
             sizeof fields / sizeof *fields, sizeof(bowl_params)},
    .place = place,
    .mass = mass_of,
    .probe = SK_EACH_ISA(probe),
    .shape = tell_shape,
    .shader = {.arithmetic = "colliders/bowl"},
};
#endif
