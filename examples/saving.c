/* Saving: a game's state in memory and on the disk, and back, with the same bits from there on. */
#include <skein/skein.h>
#include <stdio.h>
#include <stdlib.h>

/* The same calls build the same world: a snapshot holds what has happened in it, not what it was built of. */
static skein_world *build(void) {
    const skein_setting cloth[] = {SKEIN_PAIR("grid", 33, 33), SKEIN_TEXT("pins", "top corners"), SKEIN_END};
    skein_world *world = skein_world_create(NULL, NULL);
    if (world && !skein_body_add(world, "cloth", NULL, cloth, NULL) && !skein_force_add(world, "gravity", NULL, NULL))
        return world;
    skein_world_destroy(world);
    return NULL;
}

static bool run(skein_world *world, int steps) {
    bool good = true;
    for (int i = 0; i < steps && good; i++) good = !skein_world_step(world, SKEIN_DEFAULT_STEP);
    return good;
}

int main(int argc, char **argv) {
    const char *path = argc > 1 ? argv[1] : "saved.snapshot";
    skein_world *world = build(), *other = build();
    size_t size = world ? skein_snapshot_size(world) : 0, written = 0;
    void *bytes = malloc(size + 1), *read = malloc(size + 1);
    bool good = world && other && bytes && read;

    /* a snapshot after a second, and on for another */
    good = good && run(world, 60) && !skein_snapshot_write(world, bytes, size, &written) && run(world, 60);
    uint64_t first = good ? skein_world_hash(world) : 0;
    /* to a file: the bytes are the format, with a head that says version, precision and size */
    FILE *file = good ? fopen(path, "wb") : NULL;
    good = file && fwrite(bytes, 1, written, file) == written;
    good = file && !fclose(file) && good;
    file = good ? fopen(path, "rb") : NULL;
    good = file && fread(read, 1, written, file) == written;
    if (file) fclose(file);
    /* into another world, or another run of the program */
    if (good && skein_snapshot_read(other, read, written)) {
        fprintf(stderr, "saving: %s: %s\n", path, skein_world_error(other)->message);
        good = false;
    }
    good = good && run(other, 60);
    if (good)
        printf("%zu bytes; gone on from, the state's hash is %s\n", written,
               skein_world_hash(other) == first ? "the same" : "another");
    good = good && skein_world_hash(other) == first;
    free(bytes);
    free(read);
    skein_world_destroy(world);
    skein_world_destroy(other);
    return !good;
}
