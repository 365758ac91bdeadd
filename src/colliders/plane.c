/* A half space: solid below the plane normal . p = offset. */
#include "base/status.h"
#include "colliders/shape.h"

typedef struct plane_params {
    double normal[3], offset;
} plane_params;

#define SK_UNIT plane
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

// ---- arithmetic ----
SK_INLINE sk_contact plane_probe(plane_params p, sk_pose where, vec3 x) {
    return contact_of(axis_of(where), dot(axis_of(where), minus(x, position_of(where))));
}
// ---- end of arithmetic ----

SK_PROBE(plane)

#else

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

static void axis(const void *data, double unit[3]) {
    const plane_params *params = data;
    double length = normal_length(params);
    for (int k = 0; k < 3; k++) unit[k] = params->normal[k] / length;
}

static void tell_shape(const void *data, skein_shape *shape) {
    shape->sort = SKEIN_SHAPE_PLANE;
    axis(data, shape->axis);
}

const sk_collider_type sk_plane = {
    .kind = {"plane", "everything below a plane of any normal and offset", SKEIN_COLLIDER, fields,
             sizeof fields / sizeof *fields, sizeof(plane_params)},
    .check = check,
    .place = place,
    .axis = axis,
    .probe = SK_EACH_ISA(probe),
    .shape = tell_shape,
    .shader = {.arithmetic = "colliders/plane"},
};
#endif
