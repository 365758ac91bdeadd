/* Registered motions by functions. */
#include "outside/outside.h"

static void move(const sk_motion *motion, size_t i, double time, double place[3]) {
    const skein_motion_type *given = sk_outside_of(motion->params)->given;
    (void)i;
    given->move(sk_given_params(motion->params), time, place);
}

void sk_outside_motion(sk_outside *outside, const skein_motion_type *given) {
    (void)given;
    outside->type.motion.move = move;
    outside->type.motion.making = &outside->making;
}
