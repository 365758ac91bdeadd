/* For the calls that change a world: each tells its recording, if there is one (world/record.c). */
#ifndef SK_WORLD_RECORD_H
#define SK_WORLD_RECORD_H

#include <skein/record.h>

#include "world/snapshot.h"

void sk_record_step(skein_world *world, double dt); /* before it is taken */
void sk_record_field(skein_world *world, const sk_object *object, const char *name, const skein_value *value);
void sk_record_numbers(skein_world *world, sk_vector vector, size_t first, size_t count, const double *xyz);
void sk_record_hold(skein_world *world, size_t particle, bool held);
void sk_record_pins(skein_world *world, const uint32_t *particles, size_t count, const double *xyz);
void sk_record_teleport(skein_world *world, const sk_object *object);
void sk_record_vertices(skein_world *world, const sk_object *object, size_t count, const double *xyz);
void sk_record_cut(skein_world *world, const sk_body *body); /* its faces are cut as they now are */
void sk_record_clock(skein_world *world, double seconds);
void sk_record_reset(skein_world *world);
/* All of the state anew, after what is seldom done. */
void sk_record_state(skein_world *world);
/* The recording ends here: what is done cannot be recorded. */
void sk_record_stop(skein_world *world, const char *why);
/* Forgets the recording of a world that goes, once it is ended. */
void sk_record_release(skein_world *world);

skein_status sk_replay(skein_world *world, const void *bytes, size_t size, skein_difference *difference,
                       sk_set_method *set);

#endif
