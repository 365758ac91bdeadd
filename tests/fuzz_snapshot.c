/* Feeds any bytes to a world as a snapshot, as they are and with their sum put right.
 *
 * Called as fuzz/fuzz.h says. Invariant: every call returns, with a status; one that fails has words; what was read
 * can be stepped and written; nothing is allocated by what the bytes say; and all memory comes back. */
#include "fuzz/fuzz.h"
#include "world/snapshot.h"

static void judge(const skein_world *world, skein_status status) {
    const skein_error *error = skein_world_error(world);
    require(status == SKEIN_OK || (error->status == status && error->message[0]));
}

static void read_and_go_on(skein_world *world, const unsigned char *bytes, size_t size) {
    skein_status status = skein_snapshot_read(world, bytes, size);
    judge(world, status);
    if (status) return;
    if (fuzz_is_cheap(world, 10000)) judge(world, skein_world_step(world, 1.0 / 60));
    size_t room = skein_snapshot_size(world);
    unsigned char *again = malloc(room);
    require(again != NULL);
    judge(world, skein_snapshot_write(world, again, room, NULL));
    require(skein_snapshot_look(again, room, &(skein_snapshot_info){0}, NULL) == SKEIN_OK);
    free(again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    size_t used = 0;
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = fuzz_allocate, desc.release = fuzz_release, desc.memory_user = &used;
    desc.thread_count = 1;
    skein_world *world = skein_world_create(&desc, NULL);
    require(world != NULL);
    judge(world, skein_body_add(world, "rope", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 3)), NULL));
    judge(world, skein_collider_add(world, "sphere", NULL, NULL));
    read_and_go_on(world, data, size);
    unsigned char *copy = malloc(size + 1);
    require(copy != NULL);
    if (size) memcpy(copy, data, size);
    if (size > SK_SNAPSHOT_HEAD) {
        sk_byte_writer head = {copy, size, 16};
        sk_put_u64(&head, size);
        sk_snapshot_seal(copy, size);
        read_and_go_on(world, copy, size);
    }
    free(copy);
    skein_world_destroy(world);
    require(used == 0);
    return 0;
}
