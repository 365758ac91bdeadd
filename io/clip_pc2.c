/* The exporter "pc2": a point cache of the whole run (io/pc2.h). */
#include "io/clip.h"
#include "io/pc2.h"

static const skein_field fields[] = {
    IO_CLIP_FIELD_EVERY(1, 1, "one sample each so many frames"),
    IO_CLIP_FIELD_UP,
    IO_CLIP_FIELD_SCALE,
};

static void *create(const io_clip *clip, const char *path, skein_error *error) {
    io_pc2_header header = {(uint32_t)clip->mesh.vertex_count, 0, (float)clip->params->every, IO_PC2_UNKNOWN};
    return io_pc2_create(path, header, error);
}

static skein_status add(void *file, const double *positions, skein_error *error) {
    return io_pc2_add(file, positions, error);
}

static skein_status commit(void *file, skein_error *error) {
    return io_pc2_commit(file, error);
}

static skein_status keep(void *file, const char *path, skein_error *error) {
    return io_pc2_keep(file, path, error);
}

static void abandon(void *file) {
    io_pc2_abandon(file);
}

const io_clip_format io_clip_pc2 = {
    .kind = {.name = "pc2",
             .help = "PC2 point cache of the whole run: every vertex of every frame, to lay over the mesh.",
             .category = SKEIN_EXPORTER,
             .fields = fields,
             .field_count = sizeof fields / sizeof *fields,
             .params_size = sizeof(io_clip_params)},
    .ending = ".pc2",
    .by_default = true,
    .create = create,
    .add = add,
    .commit = commit,
    .keep = keep,
    .abandon = abandon,
};
