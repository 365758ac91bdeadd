/* The order of a flock, by the forces that it flies under. */
#ifndef SKEIN_IO_ORDER_H
#define SKEIN_IO_ORDER_H

#include <skein/skein.h>

/* Measures a body: about the centre of the first attraction, else about the origin; groups are of birds that are in
 * reach of each other by the first flocking rule. Fails as skein_order_measure() and skein_body_surface() do. */
skein_status io_order_measure(skein_world *world, skein_handle body, skein_order *out);
/* Whether a body is one of birds. */
bool io_is_flock(const skein_world *world, skein_handle body);

#endif
