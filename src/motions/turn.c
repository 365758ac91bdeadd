/* Rotation about an axis at a constant rate. */
#include "base/rotation.h"
#include "base/status.h"
#include "motions/motion.h"

typedef struct turn_params {
    double centre[3], axis[3], speed;
} turn_params;

static const skein_field fields[] = {
    SK_VEC3(turn_params, centre, "centre", "m", 0, 0, 0, "a point of the axis"),
    SK_VEC3(turn_params, axis, "axis", "", 0, 1, 0, "of any length but 0; seen along it they go clockwise"),
    SK_REAL(turn_params, speed, "speed", "rad/s", 1, -1e6, 1e6, "angular speed from the start on"),
};

static double length_of(const double v[3]) {
    return __builtin_sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static skein_status check(const void *params, skein_error *error) {
    if (length_of(((const turn_params *)params)->axis) > 0) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, "axis", "an axis cannot be zero");
}

static void move(const sk_motion *motion, size_t i, double time, double place[3]) {
    const turn_params *params = motion->params;
    double length = length_of(params->axis), unit[3], arm[3], matrix[9];
    (void)i;
    for (int k = 0; k < 3; k++) unit[k] = params->axis[k] / length, arm[k] = place[k] - params->centre[k];
    sk_rotation_about(unit, params->speed * time, matrix);
    for (int k = 0; k < 3; k++)
        place[k] = params->centre[k] + matrix[3 * k] * arm[0] + matrix[3 * k + 1] * arm[1] + matrix[3 * k + 2] * arm[2];
}

const sk_motion_type sk_turn = {
    .kind = {"turn", "leads pins round an axis", SKEIN_MOTION, fields, sizeof fields / sizeof *fields,
             sizeof(turn_params)},
    .check = check,
    .move = move,
};
