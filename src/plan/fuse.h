/* Fusing: ops that say one thing each become ops that say several, since each block of a vector is then read and
 * written once. It looks at nothing but ops, and the bits stay.
 *
 *   combine V  = V + h (gravity, drag)           combine X = X + h V, V + h (gravity, drag); X0 = X
 *   combine X0 = X                               repeat 10 times
 *   combine X  = X + h V                 -->         project X
 *   project X                                        combine X = V + 1/h (X - X0); X + h V, V + h (gravity, drag)
 *   combine V  = V + 1/h (X - X0 - h V)
 *
 * to the left a repeat of ten iterations. If others look at X0 or V0 as well (contact, damping), each iteration keeps
 * its correction, and only the three ops at its start are one. `skein explain --unfused` shows the ops before. */
#ifndef SK_PLAN_FUSE_H
#define SK_PLAN_FUSE_H

#include "plan/op.h"

/* Fuses what can be fused in repeats that are not within others. False where memory is wanting: then the plan is as it was. */
bool sk_plan_fuse(sk_plan *plan, sk_allocator *allocator, sk_isa isa);

#endif
