/* What the plan of a part's world (plan/share.h) keeps from one op of a sort to the next.
 *
 * Cells are laid over the whole run's box, but a part looks into those around its own particles alone: its *window*. Only
 * the lines in it are counted, so that the memory of all others is never touched, and takes none. */
#ifndef SK_PLAN_SHARE_PART_H
#define SK_PLAN_SHARE_PART_H

#include "plan/share.h"

/* A share of the world that has this part; NULL: no memory. */
sk_share *sk_share_create(sk_allocator *allocator, const skein_part *part);
void sk_share_destroy(sk_share *share, sk_allocator *allocator); /* NULL is allowed */

#endif
