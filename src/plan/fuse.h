/* Fusing: several neighbouring ops become one, so that each block of a vector is read and written once. It depends on
 * nothing but the ops, and results keep their bits.
 *
 *   combine V  = V + h (gravity, drag)           combine X = X + h V, V + h (gravity, drag); X0 = X
 *   combine X0 = X                               repeat 10 times
 *   combine X  = X + h V                 -->         project X
 *   project X                                        combine X = V + 1/h (X - X0); X + h V, V + h (gravity, drag)
 *   combine V  = V + 1/h (X - X0 - h V)
 *
 * The left side is a repeat of ten iterations. If other ops read X0 or V0 too (contact, damping), each iteration keeps
 * its correction, and only the three ops at its start are fused. `skein explain --unfused` shows the ops before. */
#ifndef SK_PLAN_FUSE_H
#define SK_PLAN_FUSE_H

#include "plan/op.h"

/* Fuses ops in repeats that are not nested in others. False without memory: the plan is then unchanged. */
bool sk_plan_fuse(sk_plan *plan, sk_allocator *allocator, sk_isa isa);

#endif
