/* A solid box, turned as one likes. Kept off by its thickness, it has round edges. */
#include "base/rotation.h"
#include "colliders/shape.h"

typedef struct box_params {
    double centre[3], size[3], rotation[3];
} box_params;

#define SK_UNIT box
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

// ---- arithmetic ----
SK_INLINE num box_beyond(num over) {
    return pick(over > 0, over, 0);
}

SK_INLINE sk_contact box_probe(box_params p, sk_pose where, vec3 x) {
    // in the box's own axes, on the positive side of each: how far beyond the faces
    vec3 own = turned_back(where, minus(x, position_of(where)));
    vec3 side = vec3_of(pick(own.x < 0, -1, 1), pick(own.y < 0, -1, 1), pick(own.z < 0, -1, 1));
    vec3 over = vec3_of(own.x * side.x - PARAM(0.5 * p.size[0]), own.y * side.y - PARAM(0.5 * p.size[1]),
                        own.z * side.z - PARAM(0.5 * p.size[2]));
    // outside, to the nearest point of the box
    vec3 beyond = vec3_of(box_beyond(over.x), box_beyond(over.y), box_beyond(over.z));
    num away = root(dot(beyond, beyond));
    flag outside = away > 0;
    // inside, through the nearest face
    flag y_first = over.y > over.x;
    num inside = pick(y_first, over.y, over.x);
    flag z_first = over.z > inside;
    inside = pick(z_first, over.z, inside);
    vec3 face =
        vec3_of(pick(either(y_first, z_first), 0, 1), pick(z_first, 0, pick(y_first, 1, 0)), pick(z_first, 1, 0));
    num below = pick(outside, away, 1);
    vec3 normal =
        vec3_of(side.x * pick(outside, beyond.x / below, face.x), side.y * pick(outside, beyond.y / below, face.y),
                side.z * pick(outside, beyond.z / below, face.z));
    return contact_of(turned(where, normal), pick(outside, away, inside));
}
// ---- end of arithmetic ----

SK_PROBE(box)

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
    .passing = SK_CONVEX,
    .shader = {.arithmetic = "colliders/box"},
};
#endif
