/* A solid box, turned as one likes. Kept off by its thickness, it has round edges. */
#include "base/kernels.h"
#include "base/rotation.h"
#include "colliders/collider.h"

typedef struct box_params {
    double centre[3], size[3], rotation[3];
} box_params;

#define SK_UNIT box
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

void SK_KERNEL(probe)(const void *data, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) {
    const box_params *params = data;
    const real *r = pose->rotation;
    sk_wide3 d = {p->x - pose->position.x, p->y - pose->position.y, p->z - pose->position.z}, sign, over, side;
    sk_wide one = sk_splat(1), none = {0};
    // in the box's own axes, on the positive side of each: how far beyond the faces
    sk_wide3 own = {r[0] * d.x + r[3] * d.y + r[6] * d.z, r[1] * d.x + r[4] * d.y + r[7] * d.z,
                    r[2] * d.x + r[5] * d.y + r[8] * d.z};
    sign.x = sk_select(sk_negative(own.x), -one, one);
    sign.y = sk_select(sk_negative(own.y), -one, one);
    sign.z = sk_select(sk_negative(own.z), -one, one);
    over.x = own.x * sign.x - (real)(0.5 * params->size[0]);
    over.y = own.y * sign.y - (real)(0.5 * params->size[1]);
    over.z = own.z * sign.z - (real)(0.5 * params->size[2]);
    // outside, to the nearest point of the box
    sk_wide3 out = {sk_keep(sk_positive(over.x), over.x), sk_keep(sk_positive(over.y), over.y),
                    sk_keep(sk_positive(over.z), over.z)};
    sk_wide length = sk_wide_sqrt(sk_dot_wide(out, out));
    sk_mask outside = sk_positive(length);
    // inside, through the nearest face
    sk_mask y_first = sk_more(over.y, over.x);
    sk_wide inside = sk_select(y_first, over.y, over.x);
    sk_mask z_first = sk_more(over.z, inside);
    inside = sk_select(z_first, over.z, inside);
    side.x = sk_select(y_first | z_first, none, one);
    side.y = sk_select(z_first, none, sk_keep(y_first, one));
    side.z = sk_keep(z_first, one);
    sk_wide below = sk_select(outside, length, one);
    sk_wide nx = sign.x * sk_select(outside, out.x / below, side.x),
            ny = sign.y * sk_select(outside, out.y / below, side.y),
            nz = sign.z * sk_select(outside, out.z / below, side.z);
    contact->normal = (sk_wide3){r[0] * nx + r[1] * ny + r[2] * nz, r[3] * nx + r[4] * ny + r[5] * nz,
                                 r[6] * nx + r[7] * ny + r[8] * nz};
    contact->distance = sk_select(outside, length, inside);
}

#else

static const skein_field fields[] = {
    SK_VEC3(box_params, centre, "centre", "m", 0, 0, 0, "the middle, before any motion"),
    SK_SIZE3(box_params, size, "size", "m", 1, 1, 1, "along x, y and z before it is turned"),
    SK_VEC3(box_params, rotation, "rotation", "deg", 0, 0, 0, "turned about x, then y, then z, before any motion"),
};

static void place(const void *data, double position[3]) {
    const box_params *params = data;
    for (int k = 0; k < 3; k++) position[k] = params->centre[k];
}

static void turn(const void *data, double rotation[9]) {
    sk_rotation_of_degrees(((const box_params *)data)->rotation, rotation);
}

static void pack(const void *params, float (*block)[4]) {
    for (int k = 0; k < 3; k++) block[0][k] = (float)(0.5 * ((const box_params *)params)->size[k]);
}

static void tell_shape(const void *data, skein_shape *shape) {
    shape->sort = SKEIN_SHAPE_BOX;
    for (int k = 0; k < 3; k++) shape->size[k] = ((const box_params *)data)->size[k];
}

const sk_collider_type sk_box = {
    .kind = {"box", "a box of any size, turned as one likes", SKEIN_COLLIDER, fields, sizeof fields / sizeof *fields,
             sizeof(box_params)},
    .place = place,
    .turn = turn,
    .probe = SK_EACH_ISA(probe),
    .shape = tell_shape,
    .shader = {.file = "colliders/box", .size = 1, .pack = pack},
};
#endif
