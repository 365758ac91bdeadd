/* With the triangles of a mesh collider: rigidly moved, or deformed by a program. */
#include "motions/motion.h"

typedef struct attach_params {
    char *to;
    double offset;
} attach_params;

static const skein_field fields[] = {
    SK_TEXT(
        attach_params, to, "to", "",
        "the name of the mesh collider, or empty where there is one: each is tied to the triangle that is nearest where both were built"),
    SK_REAL(attach_params, offset, "offset", "m", SK_UNBOUNDED, -SK_FAR, SK_UNBOUNDED,
            "how far off the nearest point, along the triangle's normal; infinite: there where it was built"),
};

static const char *carrier(const void *data, double *offset) {
    const attach_params *params = data;
    *offset = params->offset;
    return params->to;
}

/* At its start all are where they were built. */
static void move(const sk_motion *motion, size_t i, double time, double place[3]) {
    const sk_seats *seats = &motion->seats;
    if (!seats->place || i >= seats->count) return;
    if (time > 0 || seats->offset < SK_UNBOUNDED) seats->place(seats, i, motion->common->start + time, place);
}

const sk_motion_type sk_attach = {
    .kind = {"attach", "leads pins with the nearest triangles of a mesh collider, however it moves", SKEIN_MOTION,
             fields, sizeof fields / sizeof *fields, sizeof(attach_params)},
    .move = move,
    .carrier = carrier,
};
