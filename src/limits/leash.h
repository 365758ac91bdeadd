/* Leashes: free particles held near the places where motions would lead them if they were pinned.
 *
 *   pull       a spring to the place, of so many N/m: a soft pin
 *   most       the largest distance from the place
 *   backstop   not into a ball behind the surface that those places make
 *
 *        place o-------->  n           the ball's middle is radius + backstop behind the place, along the surface's normal: what
 *        stop  |  .-----.              follows comes no farther than `backstop` behind it
 *              ( middle  )
 *
 * Places move in a straight line from the start of a step to its end, as pins do. One op at the end of a substep, among
 * the limits; slots are independent. The pull is implicit, so that none is too stiff: at rest it gives by m g/k,
 * whatever the substep. */
#ifndef SK_LIMITS_LEASH_H
#define SK_LIMITS_LEASH_H

#include "particles/particles.h"
#include "plan/op.h"

typedef struct sk_leash {
    sk_vec3 from, to;           /* the place when the step begins and when it ends */
    sk_vec3 stop_from, stop_to; /* the centre of the ball behind it, likewise */
    real pull, most, radius;    /* N/m, 0: none; m, infinite: none; m, 0: none */
    bool held;                  /* by any of these */
} sk_leash;

/* A world's leashes, by slot, for the present step. */
typedef struct sk_leashes {
    sk_leash *data;
    size_t count, capacity;
    double start, dt; /* s */
    bool any;         /* some motion has leashes */
} sk_leashes;

extern const sk_kernels sk_leash_hold;

#endif
