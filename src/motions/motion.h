/* Motions: where pins are led as time goes by.
 *
 * A *type* is one file: its fields, and `move`, which takes a place and makes it the one that the motion leads to at a
 * time. A pin's motions act one after the other, in the order of their making, and begin where the particle was built:
 * so its place follows from the time alone, and stepping again from an earlier time leads the same way. The world asks
 * for the places at the end of a step and leads the pins there (world/motions.c, world/pins.c).
 *
 * A motion is a moving frame, too: of a step, bodies that live in it are carried along by a share before anything else is
 * done, and colliders that go with it stand where it puts them (world/frames.c). */
#ifndef SK_MOTIONS_MOTION_H
#define SK_MOTIONS_MOTION_H

#include "base/fields.h"
#include "formula/parameters.h"

/* What every motion has besides its own fields. Begins as the common fields of all rules do. */
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

/* Places that were given with it: one of each particle for each sample. */
typedef struct sk_track {
    double (*places)[3]; /* sample_count x particle_count */
    uint32_t *particles;
    size_t particle_count, sample_count;
    double interval; /* s, from sample to sample */
} sk_track;

typedef struct sk_motion sk_motion;

typedef struct sk_motion_type {
    skein_kind kind;
    const char *given; /* the field that stands for a track in a scene; NULL: it takes none */
    /* NULL if the parameters are good as they are. */
    skein_status (*check)(const void *params, skein_error *error);
    /* The place of the motion's particle `i`, `time` seconds (0 or more) after its start. */
    void (*move)(const sk_motion *motion, size_t i, double time, double place[3]);
    const sk_making *making; /* what is made from its texts; NULL: nothing */
} sk_motion_type;

struct sk_motion {
    const sk_motion_type *type;
    const void *params;
    const sk_motion_common *common;
    const char *label;
    sk_track track;
    /* whom it leads, as far as they are pinned: found by the world */
    uint32_t *particle, *column; /* column: their places in the track */
    size_t count;
    double middle[3];     /* the mean of their places as they were built */
    bool knows_colliders; /* all that it names were there once */
    double *share;        /* of the largest distance, one for each of them; NULL: 1 */
};

/* Whether a jump is said to come after the time `from`, up to `to` (s after the start); and what is wrong with the text of such times. */
bool sk_motion_jumps(const sk_motion_common *common, double from, double to);
/* Reads up to `most` numbers of the map; how many there are, or -1 where something else is among them. */
int64_t sk_motion_read_map(const sk_motion_common *common, double *share, size_t most);
skein_status sk_motion_check_jumps(const sk_motion_common *common, skein_error *error);

/* Fields of sk_motion_common. */
extern const skein_field sk_motion_fields[];
extern const size_t sk_motion_field_count;

#endif
