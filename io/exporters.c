/* The exporters and their fields: see exporters.h for the contract.
 *
 * A new exporter is one struct of parameters, one table of fields and one row in `kinds`.
 */
#include "io/exporters.h"

#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

static const skein_field obj_fields[] = {
    {.name = "normals",
     .type = SKEIN_FIELD_CHOICE,
     .offset = offsetof(io_obj_params, normals),
     .unit = "",
     .initial = {SKEIN_NORMALS_AREA, 0, 0},
     .least = SKEIN_NORMALS_AREA,
     .most = SKEIN_NORMALS_ANGLE,
     .choices = "area|uniform|angle",
     .help = "what a face counts in its vertices' normals: its area, one, or its angle at the vertex"},
};

static const skein_field pc2_fields[] = {
    {.name = "every",
     .type = SKEIN_FIELD_INT,
     .offset = offsetof(io_pc2_params, every),
     .unit = "frames",
     .initial = {1, 0, 0},
     .least = 1,
     .most = 1000000,
     .help = "one sample each so many frames"},
};

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
    {.name = "obj",
     .help = "Wavefront OBJ of the last frame: the mesh as it came, with unit vertex normals.",
     .category = SKEIN_EXPORTER,
     .fields = obj_fields,
     .field_count = COUNT(obj_fields),
     .params_size = sizeof(io_obj_params)},
    {.name = "pc2",
     .help = "PC2 point cache of the whole run: every vertex of every frame, to lay over the mesh.",
     .category = SKEIN_EXPORTER,
     .fields = pc2_fields,
     .field_count = COUNT(pc2_fields),
     .params_size = sizeof(io_pc2_params)},
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
    return index < COUNT(kinds) ? &kinds[index] : NULL;
}
