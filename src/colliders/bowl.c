/* A ball from inside: everything outside of it is solid. */
#include "base/kernels.h"
#include "colliders/collider.h"

typedef struct bowl_params {
    double centre[3], radius, mass;
} bowl_params;

#define SK_UNIT bowl
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

void SK_KERNEL(probe)(const void *data, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) {
    real radius = (real)((const bowl_params *)data)->radius;
    sk_wide3 d = {pose->position.x - p->x, pose->position.y - p->y, pose->position.z - p->z};
    sk_wide length = sk_wide_sqrt(sk_dot_wide(d, d));
    // in the very middle no way leads to the wall: there is no contact
    sk_mask apart = sk_positive(length);
    sk_wide below = sk_select(apart, length, sk_splat(1));
    contact->normal = (sk_wide3){d.x / below, sk_select(apart, d.y / below, sk_splat(1)), d.z / below};
    contact->distance = sk_select(apart, radius - length, sk_splat((real)SK_FAR));
}

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

static void pack(const void *params, float (*block)[4]) {
    block[0][0] = (float)((const bowl_params *)params)->radius;
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
    .shader = {.file = "colliders/bowl", .size = 1, .pack = pack},
};
#endif
