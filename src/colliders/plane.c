/* A half space: solid below the plane normal . p = offset. */
#include "base/status.h"
#include "colliders/collider.h"

typedef struct plane_params {
    double normal[3], offset;
} plane_params;

static const skein_field fields[] = {
    SK_VEC3(plane_params, normal, "normal", "", 0, 1, 0, "out of the solid; any length but 0"),
    SK_REAL(plane_params, offset, "offset", "m", 0, -SK_FAR, SK_FAR, "distance of the plane from the origin along it"),
};

static double normal_length(const plane_params *params) {
    const double *n = params->normal;
    return __builtin_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static skein_status check(const void *data, skein_error *error) {
    if (normal_length(data) > 0) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, "normal", "a plane's normal cannot be zero");
}

static void place(const void *data, double position[3]) {
    const plane_params *params = data;
    double length = normal_length(params);
    for (int k = 0; k < 3; k++) position[k] = params->normal[k] / length * params->offset;
}

static void probe(const void *data, const sk_pose *pose, const sk_vec4 *x, size_t count, sk_contact *contact) {
    const plane_params *params = data;
    double length = normal_length(params);
    sk_vec3 built = {(real)(params->normal[0] / length), (real)(params->normal[1] / length),
                     (real)(params->normal[2] / length)};
    const real *r = pose->rotation;
    sk_vec3 normal = {r[0] * built.x + r[1] * built.y + r[2] * built.z, r[3] * built.x + r[4] * built.y + r[5] * built.z,
                      r[6] * built.x + r[7] * built.y + r[8] * built.z};
    for (size_t i = 0; i < count; i++)
        contact[i] = (sk_contact){normal, sk_dot(normal, sk_sub(sk_xyz(x[i]), pose->position))};
}

const sk_collider_type sk_plane = {
    .kind = {"plane", "everything below a plane of any normal and offset", SKEIN_COLLIDER, fields,
             sizeof fields / sizeof *fields, sizeof(plane_params)},
    .check = check,
    .place = place,
    .probe = probe,
};
