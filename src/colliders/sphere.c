/* A solid ball. */
#include "colliders/collider.h"

typedef struct sphere_params {
    double centre[3], radius;
} sphere_params;

static const skein_field fields[] = {
    SK_VEC3(sphere_params, centre, "centre", "m", 0, 0, 0, "the centre, before any motion"),
    SK_REAL(sphere_params, radius, "radius", "m", 0.5, 1e-9, SK_FAR, "the radius"),
};

static void place(const void *data, double position[3]) {
    const sphere_params *params = data;
    for (int k = 0; k < 3; k++) position[k] = params->centre[k];
}

static void probe(const void *data, const sk_pose *pose, const sk_vec4 *x, size_t count, sk_contact *contact) {
    real radius = (real)((const sphere_params *)data)->radius;
    for (size_t i = 0; i < count; i++) {
        sk_vec3 d = sk_sub(sk_xyz(x[i]), pose->position);
        real length = sk_length(d);
        // at the very centre every way out is as good: take up
        sk_vec3 normal = length > 0 ? sk_v3(d.x / length, d.y / length, d.z / length) : sk_v3(0, 1, 0);
        contact[i] = (sk_contact){normal, length - radius};
    }
}

const sk_collider_type sk_sphere = {
    .kind = {"sphere", "a ball, solid inside", SKEIN_COLLIDER, fields, sizeof fields / sizeof *fields,
             sizeof(sphere_params)},
    .place = place,
    .probe = probe,
};
