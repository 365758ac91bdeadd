/* The exporter "obj": the last frame as Wavefront OBJ, or a file each so many frames (io/obj_write.c). */
#include "io/clip.h"

static const skein_field fields[] = {
    IO_CLIP_FIELD_NORMALS,
    IO_CLIP_FIELD_EVERY(0, 0, "0: one file, of the last frame; else one each so many frames, NAME_0000.obj on"),
    IO_CLIP_FIELD_UP,
    IO_CLIP_FIELD_SCALE,
};

const io_clip_format io_clip_obj = {
    .kind = {.name = "obj",
             .help = "Wavefront OBJ of the last frame, or a sequence: the mesh as it came, with unit vertex normals.",
             .category = SKEIN_EXPORTER,
             .fields = fields,
             .field_count = sizeof fields / sizeof *fields,
             .params_size = sizeof(io_clip_params)},
    .ending = ".obj",
    .by_default = true,
    .keeps_marks = true,
    .write = io_obj_write_clip,
};
