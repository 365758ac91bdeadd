/* What snapshots and records of inputs share: values of fields as bytes. */
#ifndef SK_WORLD_SNAPSHOT_H
#define SK_WORLD_SNAPSHOT_H

#include "base/bytes.h"
#include "world/world.h"

/* The newest version. Written is the oldest that holds what there is: see snapshot.c. */
enum { SK_SNAPSHOT_VERSION = 6, SK_SNAPSHOT_HEAD = 36 };

void sk_put_value(sk_byte_writer *w, const skein_value *value);
/* A text of it stands in the reader's bytes. */
skein_value sk_take_value(sk_byte_reader *r);
/* What skein_snapshot_read() says; `set` sets a method by its name. */
typedef skein_status sk_set_method(skein_world *world, const char *kind, const skein_setting *settings);
skein_status sk_snapshot_read(skein_world *world, const void *bytes, size_t size, sk_set_method *set);
/* Writes the sum of what stands behind the head into it: a snapshot that was changed on purpose is whole again. */
void sk_snapshot_seal(unsigned char *bytes, size_t size);

#endif
