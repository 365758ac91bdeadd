/* All that is within a radius of a line between two points: a rod with round ends. */
#include "base/kernels.h"
#include "colliders/collider.h"

typedef struct capsule_params {
    double from[3], to[3], radius;
} capsule_params;

/* The line as it is turned now. */
typedef struct capsule_axis {
    sk_vec3 half;    /* from the middle to `to` */
    sk_vec3 aside;   /* a unit vector across */
    real per_square; /* 1/|half|^2; 0 where both ends are in one place */
} capsule_axis;

#define SK_UNIT capsule
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

static capsule_axis axis_now(const capsule_params *params, const sk_pose *pose) {
    const real *r = pose->rotation;
    sk_vec3 h = {(real)(0.5 * (params->to[0] - params->from[0])), (real)(0.5 * (params->to[1] - params->from[1])),
                 (real)(0.5 * (params->to[2] - params->from[2]))};
    sk_vec3 half = {r[0] * h.x + r[1] * h.y + r[2] * h.z, r[3] * h.x + r[4] * h.y + r[5] * h.z,
                    r[6] * h.x + r[7] * h.y + r[8] * h.z};
    real square = sk_dot(half, half);
    if (!(square > 0)) return (capsule_axis){{0, 0, 0}, {0, 1, 0}, 0};
    // up, as far as that is across; of an upright one, along x
    real along = half.y / square;
    sk_vec3 up = {-along * half.x, 1 - along * half.y, -along * half.z};
    real rise = sk_length(up);
    sk_vec3 aside = rise > (real)1e-3 ? sk_scale(1 / rise, up) : sk_v3(1, 0, 0);
    return (capsule_axis){half, aside, 1 / square};
}
void SK_KERNEL(probe)(const void *data, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) {
    real radius = (real)((const capsule_params *)data)->radius;
    capsule_axis axis = axis_now(data, pose);
    sk_vec3 half = axis.half, aside = axis.aside;
    sk_wide3 d = {p->x - pose->position.x, p->y - pose->position.y, p->z - pose->position.z};
    // the nearest point of the line is at the middle plus t halves of it
    sk_wide t = (d.x * half.x + d.y * half.y + d.z * half.z) * axis.per_square, one = sk_splat(1);
    t = sk_select(sk_more(t, one), one, t);
    t = sk_select(sk_more(-one, t), -one, t);
    d = (sk_wide3){d.x - t * half.x, d.y - t * half.y, d.z - t * half.z};
    sk_wide length = sk_wide_sqrt(sk_dot_wide(d, d));
    // on the line itself every way aside is as good
    sk_mask apart = sk_positive(length);
    sk_wide below = sk_select(apart, length, one);
    contact->normal =
        (sk_wide3){sk_select(apart, d.x / below, sk_splat(aside.x)), sk_select(apart, d.y / below, sk_splat(aside.y)),
                   sk_select(apart, d.z / below, sk_splat(aside.z))};
    contact->distance = length - radius;
}

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

static void pack(const void *data, float (*block)[4]) {
    const capsule_params *params = data;
    for (int k = 0; k < 3; k++) block[0][k] = (float)(0.5 * (params->to[k] - params->from[k]));
    block[0][3] = (float)params->radius;
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
    .shader = {.file = "colliders/capsule", .size = 1, .pack = pack},
};
#endif
