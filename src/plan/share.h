/* A world that has a part of a run, which several processes share (skein/share.h): what its plan does otherwise.
 *
 * Where particles are sorted into cells, the first op asks the program for the border and lays cells over the whole run's
 * box, and the last one puts members of a cell in the order of the whole run. Owned by the world. */
#ifndef SK_PLAN_SHARE_H
#define SK_PLAN_SHARE_H

#include <skein/share.h>

#include "plan/op.h"

typedef struct sk_share {
    skein_part given;
    sk_op_kernel *frame; /* of the op that begins a sort, else: for what is all in this part */
    sk_isa isa;
    bool failed; /* an exchange of this step has */
} sk_share;

/* Has the plan's sorts ask for the border. */
void sk_share_plan(sk_plan *plan, sk_share *share, sk_isa isa);
/* Whether what an op does with a particle depends on that alone, on those in cells, or on those that it is joined with. */
bool sk_op_can_be_shared(const sk_op *op);
/* Whether it is the latter: a sweep of constraints, or what only bodies have that live in one part. */
bool sk_op_is_joined(const sk_op *op);

#endif
