/* Snapshots as files: see snapshot.h. */
#include "io/snapshot.h"

#include <stdlib.h>
#include <string.h>

skein_status io_snapshot_write(const skein_world *world, const char *note, const char *path, skein_error *error) {
    size_t size = skein_snapshot_size(world), written = 0;
    void *bytes = malloc(size);
    if (!bytes) return io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    skein_status status = skein_snapshot_write(world, bytes, size, &written);
    if (status && error) *error = *skein_world_error(world);
    io_output *output = status ? NULL : io_output_open(path, error);
    if (output) {
        io_output_write(output, bytes, written);
        io_output_write(output, note, strlen(note));
        io_output_sync(output);
        status = io_output_commit(output, error);
    } else if (!status) status = SKEIN_ERROR_FILE;
    free(bytes);
    return status;
}

skein_status io_snapshot_read(const char *path, io_snapshot *out, skein_error *error) {
    *out = (io_snapshot){.note = ""};
    skein_status status = io_file_read(path, SIZE_MAX / 4, &out->bytes, error);
    if (status) return status;
    status = skein_snapshot_look(out->bytes.data, out->bytes.size, &out->info, error);
    if (status) {
        if (error) {
            skein_error words = *error;
            io_error_set(error, status, path, "%s", words.message);
        }
        io_snapshot_free(out);
        return status;
    }
    out->note = out->bytes.data + out->info.size;
    return SKEIN_OK;
}

void io_snapshot_free(io_snapshot *snapshot) {
    io_bytes_free(&snapshot->bytes);
    snapshot->note = "";
}
