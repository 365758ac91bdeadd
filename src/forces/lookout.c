/* A lookout: particles look ahead along their flight, and steer away from every collider that they see there. Each
 * collider has an op of its own, whose kernel is in colliders/avoid.c. */
#include "forces/force.h"

typedef struct lookout_params {
    double ahead, clearance, strength;
} lookout_params;

static const skein_field fields[] = {
    SK_REAL(lookout_params, ahead, "ahead", "s", 1, 0, 1e6, "how far ahead, as a time of flight"),
    SK_REAL(lookout_params, clearance, "clearance", "m", 1, 0, 1e9, "nearer to a collider than this is too near"),
    SK_REAL(lookout_params, strength, "strength", "m/s2", 50, 0, SK_FAR,
            "the acceleration away where the way leads into one"),
};

static void look(const void *data, double out[3]) {
    const lookout_params *params = data;
    out[0] = params->ahead, out[1] = params->clearance, out[2] = params->strength;
}

const sk_force_type sk_lookout = {
    .kind = {"lookout", "looks ahead, and steers clear of every collider", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(lookout_params)},
    .domain = SK_OVER_COLLIDERS,
    .phase = SK_STEERS,
    .look = look,
};
