/* Motions: prescribed paths of pins.
 *
 * A *type* is one file: its fields, and `move`, which replaces a place by the one that the motion leads it to at a
 * time. A pin's motions act one after the other, in the order in which they were made, beginning where the particle was
 * built: so its place depends on the time alone, and stepping again from an earlier time gives the same path. The world
 * asks for the places at the end of a step and leads the pins there (world/motions.c, world/pins.c).
 *
 * A motion is also a moving frame: before each step, bodies that live in it are carried along by a share of it, and
 * colliders attached to it are placed by it (world/frames.c). */
#ifndef SK_MOTIONS_MOTION_H
#define SK_MOTIONS_MOTION_H

#include "base/fields.h"
#include "formula/parameters.h"

/* The members common to all motions. They begin with the common members of all rules. */
typedef struct sk_motion_common {
    char *name;
    bool enabled;
    char *on, *pins;
    double start;
    char *colliders;
    double inertia, jump, jump_turn; /* see motion.c */
    char *jump_times;
    double pull, max_distance, backstop, backstop_radius;
    char *map;
} sk_motion_common;

/* Places that were given with a motion: one for each particle in each sample. */
typedef struct sk_track {
    double (*places)[3]; /* sample_count x particle_count */
    uint32_t *particles;
    size_t particle_count, sample_count;
    double interval; /* s, from sample to sample */
} sk_track;

/* Where those whom a motion leads sit on a collider's triangles: found once, by the places where all were built. */
typedef struct sk_seats {
    /* Where i is at a time (s); NULL: there is no such collider (any more), and nobody is led. */
    void (*place)(const struct sk_seats *seats, size_t i, double time, double place[3]);
    const struct sk_collider *collider;
    struct sk_seat *data; /* of each that is led (colliders/seat.h) */
    uint32_t *particle;   /* for whom they were found, */
    size_t count;
    double start, offset; /* and by which fields */
} sk_seats;

typedef struct sk_motion sk_motion;

typedef struct sk_motion_type {
    skein_kind kind;
    const char *given; /* the field that stands for a track in a scene; NULL: it takes none */
    /* Checks the parameters together; NULL: there is nothing to check. */
    skein_status (*check)(const void *params, skein_error *error);
    /* The place of the motion's particle `i`, `time` seconds (0 or more) after its start. */
    void (*move)(const sk_motion *motion, size_t i, double time, double place[3]);
    const sk_making *making; /* what is made from its texts; NULL: nothing */
    /* Of types that follow a collider's triangles, else NULL: its name, and the offset of seats (colliders/seat.h). */
    const char *(*carrier)(const void *params, double *offset);
} sk_motion_type;

struct sk_motion {
    const sk_motion_type *type;
    const void *params;
    const sk_motion_common *common;
    const char *label;
    sk_track track;
    /* the particles that it leads as far as they are pinned: found by the world */
    uint32_t *particle, *column; /* column: their places in the track */
    size_t count;
    double middle[3];     /* the mean of their places as they were built */
    bool knows_colliders; /* all colliders that it names have existed */
    double *share;        /* each particle's share of the largest distance; NULL: 1 */
    sk_seats seats;       /* of a type with a carrier */
};

/* Whether a type makes use of a common field: one that follows a collider is no moving frame, and takes none of its fields. */
bool sk_motion_takes(const sk_motion_type *type, const char *field);
/* The first field that is set to something else than its default, although the type does not take it; NULL: none is. */
const skein_field *sk_motion_refused(const sk_motion_type *type, const sk_motion_common *common);
/* Whether a jump is set for a time after `from`, up to `to` (s after the start). */
bool sk_motion_jumps(const sk_motion_common *common, double from, double to);
/* Reads up to `most` numbers of the map, and counts all; fails if it holds anything else. */
skein_status sk_motion_read_map(const sk_motion_common *common, double *share, size_t most, size_t *count,
                                skein_error *error);
skein_status sk_motion_check_jumps(const sk_motion_common *common, skein_error *error);

/* Fields of sk_motion_common. */
extern const skein_field sk_motion_fields[];
extern const size_t sk_motion_field_count;

#endif
