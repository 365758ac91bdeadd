/* What snapshots and records of inputs share: values of fields as bytes. */
#ifndef SK_WORLD_SNAPSHOT_H
#define SK_WORLD_SNAPSHOT_H

#include "base/bytes.h"
#include "world/world.h"

enum { SK_SNAPSHOT_VERSION = 1, SK_SNAPSHOT_HEAD = 36 };

void sk_put_value(sk_byte_writer *w, const skein_value *value);
/* A text of it stands in the reader's bytes. */
skein_value sk_take_value(sk_byte_reader *r);
/* Writes the sum of what stands behind the head into it: a snapshot that was changed on purpose is whole again. */
void sk_snapshot_seal(unsigned char *bytes, size_t size);

#endif
