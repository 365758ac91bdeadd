/* The exporters and their fields: see exporters.h for the contract.
 *
 * A new format of a clip is a file of its own and a row in io/clip.c; a new recording has its row here.
 */
#include "io/exporters.h"

#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

static const skein_field recording_fields[] = {
    {.name = "every",
     .type = SKEIN_FIELD_INT,
     .offset = offsetof(io_recording_params, every),
     .unit = "frames",
     .initial = {1, 0, 0},
     .least = 1,
     .most = 1000000,
     .help = "one sample each so many frames"},
};

static const skein_kind kinds[] = {
    {.name = "csv",
     .help = "Positions and velocities of the run as comma separated values; only where a scene asks for it.",
     .category = SKEIN_EXPORTER,
     .fields = recording_fields,
     .field_count = COUNT(recording_fields),
     .params_size = sizeof(io_recording_params)},
    {.name = "hdf5",
     .help = "The same as HDF5, with an XDMF index beside it for ParaView; only where a scene asks for it.",
     .category = SKEIN_EXPORTER,
     .fields = recording_fields,
     .field_count = COUNT(recording_fields),
     .params_size = sizeof(io_recording_params)},
};

const skein_kind *io_exporter_at(size_t index) {
    size_t clips = 0;
    const io_clip_format *format;
    for (; (format = io_clip_format_at(clips)); clips++)
        if (clips == index) return &format->kind;
    return index - clips < COUNT(kinds) ? &kinds[index - clips] : NULL;
}
