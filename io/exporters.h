/* The exporters of io/ and their fields, described like every other kind: clips (io/clip.h), then recordings.
 *
 * Owns: the list, and the parameters of recordings. Called by the scene reader and by `skein list`. Invariant: a
 * parameter struct has a member for each field of its table, at the table's offset; a choice is stored
 * as its place in the list.
 */
#ifndef SKEIN_IO_EXPORTERS_H
#define SKEIN_IO_EXPORTERS_H

#include <skein/skein.h>

#include "io/clip.h"

/* csv and hdf5. */
typedef struct io_recording_params {
    int32_t every; /* frames from one sample to the next */
} io_recording_params;

/* The exporters, `index` from 0; NULL past the end. */
const skein_kind *io_exporter_at(size_t index);

#endif
