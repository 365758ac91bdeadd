/* A solid ball. */
#include "base/kernels.h"
#include "colliders/collider.h"

typedef struct sphere_params {
    double centre[3], radius, mass;
} sphere_params;

#define SK_UNIT sphere
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

void SK_KERNEL(probe)(const void *data, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) {
    real radius = (real)((const sphere_params *)data)->radius;
    sk_wide3 d = {p->x - pose->position.x, p->y - pose->position.y, p->z - pose->position.z};
    sk_wide length = sk_wide_sqrt(sk_dot_wide(d, d));
    // at the very centre every way out is as good: take up
    sk_mask apart = sk_positive(length);
    sk_wide inverse = 1 / sk_select(apart, length, sk_splat(1));
    contact->normal = (sk_wide3){d.x * inverse, sk_select(apart, d.y * inverse, sk_splat(1)), d.z * inverse};
    contact->distance = length - radius;
}

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

static void pack(const void *params, float (*block)[4]) {
    block[0][0] = (float)((const sphere_params *)params)->radius;
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
    .shader = {.file = "colliders/sphere", .size = 1, .pack = pack},
};
#endif
