/* Fusing: rows that say one thing each become rows that say several, since each block of a vector is then read and
 * written once. It looks at nothing but rows, and the bits stay.
 *
 *   combine V  = V + h (gravity, drag)           combine X = X + h V, V + h (gravity, drag); X0 = X
 *   combine X0 = X                               repeat 10 times
 *   combine X  = X + h V                 -->         project X
 *   project X                                        combine X = V + 1/h (X - X0); X + h V, V + h (gravity, drag)
 *   combine V  = V + 1/h (X - X0 - h V)
 *
 * to the left a repeat of ten turns. If others look at X0 or V0 as well (contact, damping), each turn keeps its
 * correction, and only the three rows at its start are one. `skein explain --unfused` shows the rows before. */
#ifndef SK_PLAN_FUSE_H
#define SK_PLAN_FUSE_H

#include "plan/row.h"

/* Fuses what can be fused in repeats that are not within others. False where memory is wanting: then the plan is as it was. */
bool sk_plan_fuse(sk_plan *plan, sk_allocator *allocator, sk_isa isa);

#endif
