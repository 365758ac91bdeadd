/* Spans of a sheet that is no grid: pairs of particles some edges apart, which get no farther from each other than along
 * the sheet. They are found by walks straight across the faces, as over a paper model unfolded in the plane:
 *
 *     v ------.------.----- T     the walk goes on from face to face until it has crossed so many edges;
 *      \  /\ / \  /\  \  / \      the span ends at the corner w that is nearest to where it got to
 *       \/__\___\/__\__\/___w     and is as long as the straight line in the unfolded strip of faces */
#ifndef SK_BODIES_SPANS_H
#define SK_BODIES_SPANS_H

#include "bodies/body.h"
#include "bodies/sheet.h"

/* Bounds that the body's tether bound holds. `axes`: two directions in space that walks follow where the sheet lets
 * them; rank[particle]: its place in memory, in whose order spans come, or NULL: neighbours far apart; `may_grow`: of a closed sheet, as a balloon is, there are none. */
skein_status sk_spans_add(const sk_sheet *sheet, const double (*axes)[3], const uint32_t *rank, bool may_grow,
                          skein_world *world, sk_body *body, skein_error *error);

#endif
