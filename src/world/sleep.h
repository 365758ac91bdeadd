/* What sleep asks of a step (sleep.c): which bodies may touch which (neighbours.c), and what moves them whatever they do
 * themselves (movers.c). */
#ifndef SK_WORLD_SLEEP_H
#define SK_WORLD_SLEEP_H

#include "world/nearness.h"

/* A body that is there, and the box around it. */
typedef struct sk_sleeper {
    sk_body *body;
    const sk_common *common;
    real low[3], high[3];
    bool unmoving; /* all of it is pinned, and was not led in the last step, nor is in the next */
    bool led;      /* some of it is, in the next */
    bool tied;     /* to a particle of no body, that moves */
    bool ready, awake;
    uint64_t near;  /* whom it may touch: a sum, which knows no order */
    uint32_t index; /* among these, in the order of bodies */
} sk_sleeper;

/* Two whose boxes meet, one of which stands pinned. */
typedef struct sk_lean {
    uint32_t pinned, other; /* their indices */
} sk_lean;

/* ---- neighbours.c ---- */

typedef struct sk_neighbours {
    skein_world *world;
    sk_sleeper *of, **by_index;
    size_t count;
    uint32_t *island; /* of sleepers, by their index: a union of those that may touch */
    bool *disturbed;  /* of islands, by their root: somebody in it does not sleep */
    struct {
        sk_lean *data;
        size_t count, capacity;
    } leans;
    real near; /* m: boxes that are nearer may touch; below 0: none does */
} sk_neighbours;

/* Finds all bodies that are there, with boxes that have their ways of `ahead` seconds and where pins are led in the next step
 * of dt, and who may touch whom. False when there is no memory; else it is to be released. */
bool sk_neighbours_find(skein_world *world, double ahead, double dt, sk_neighbours *all);
void sk_neighbours_release(sk_neighbours *all);
/* Marks the islands of those who are awake; and whether a body is in one of these. */
void sk_neighbours_mark(const sk_neighbours *all);
bool sk_is_disturbed(const sk_neighbours *all, const sk_sleeper *s);

/* ---- movers.c ---- */

/* Whether a rule, a constraint of the program's or a motion moves a body whatever it does itself. */
bool sk_is_driven(const skein_world *world, const sk_sleeper *s);
/* Whether a collider that moves is near a body in the next step of dt. Motions have been looked at (sk_world_look_ahead). */
bool sk_is_met(const skein_world *world, const sk_sleeper *s, double dt);

#endif
