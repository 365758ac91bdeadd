/* Leashes: free particles that are held near the places where motions would lead them, were they pinned.
 *
 *   softness   a pull to the place, of so many N/m: a pin that gives way
 *   most       no farther from it than that
 *   backstop   not into a ball behind the surface that those places make
 *
 *        place o-------->  n           the ball's middle is radius + backstop behind the place, along the surface's normal: what
 *        stop  |  .-----.              follows comes no farther than `backstop` behind it
 *              ( middle  )
 *
 * Places go straight from the start of a step to its end, as pins do. One op at the end of a substep, among the limits; each slot
 * for itself. The pull is implicit, so that none is too stiff: what it gives by at rest is m g/k, at any step. */
#ifndef SK_LIMITS_LEASH_H
#define SK_LIMITS_LEASH_H

#include "particles/particles.h"
#include "plan/op.h"

typedef struct sk_leash {
    sk_vec3 from, to;             /* the place when the step begins and when it ends */
    sk_vec3 stop_from, stop_to;   /* the middle of the ball behind it */
    real pull, most, radius;      /* N/m, 0: none; m, infinite: none; m, 0: none */
    bool held;                    /* by any of these */
} sk_leash;

/* Those of a world, by slot; what is in it is of the present step. */
typedef struct sk_leashes {
    sk_leash *data;
    size_t count, capacity;
    double start, dt; /* s */
    bool any;         /* some motion has some */
} sk_leashes;

extern const sk_kernels sk_leash_hold;

#endif
