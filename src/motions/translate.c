/* Translation at a constant velocity. */
#include "motions/motion.h"

typedef struct translate_params {
    double velocity[3];
} translate_params;

static const skein_field fields[] = {
    SK_VEC3(translate_params, velocity, "velocity", "m/s", 0, 0, 0, "from the start on"),
};

static void move(const sk_motion *motion, size_t i, double time, double place[3]) {
    const translate_params *params = motion->params;
    (void)i;
    for (int k = 0; k < 3; k++) place[k] += time * params->velocity[k];
}

const sk_motion_type sk_translate = {
    .kind = {"translate", "leads pins straight on", SKEIN_MOTION, fields, sizeof fields / sizeof *fields,
             sizeof(translate_params)},
    .move = move,
};
