/* Feeds any bytes to a world as a recording, as they are and with their chain of sums put right.
 *
 * Called as fuzz/fuzz.h says. Invariant: every call returns, with a status; one that fails has words; nothing is
 * allocated by what the bytes say; and all memory comes back. */
#include <skein/record.h>

#include "base/bytes.h"
#include "fuzz/fuzz.h"

/* So that what stands in entries is looked at, and not only that it was changed. */
static void mend(unsigned char *bytes, size_t size) {
    sk_byte_reader r = {bytes, size, 16, false};
    uint64_t chain = SK_HASH_START;
    if (size < 16 || !sk_take_text(&r)) return;
    while (sk_left(&r)) {
        unsigned what = sk_take_u8(&r);
        uint64_t length = sk_take_u64(&r);
        const unsigned char *entry = length <= sk_left(&r) ? sk_take(&r, (size_t)length) : NULL;
        if (!entry || sk_left(&r) < 8) return;
        chain = sk_hash_word(sk_hash_word(chain, what), sk_byte_sum(entry, (size_t)length));
        sk_byte_writer w = {bytes, size, r.at};
        sk_put_u64(&w, chain);
        r.at += 8;
    }
}

static void judge(const uint8_t *bytes, size_t size) {
    size_t used = 0;
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = fuzz_allocate, desc.release = fuzz_release, desc.memory_user = &used;
    desc.thread_count = 1;
    skein_world *world = skein_world_create(&desc, NULL);
    skein_difference d;
    require(world != NULL);
    require(!skein_body_add(world, "rope", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 3)), NULL));
    require(!skein_collider_add(world, "sphere", NULL, NULL));
    if (fuzz_is_cheap(world, 10000)) {
        skein_status status = skein_replay(world, bytes, size, &d);
        require(!status || (skein_world_error(world)->status == status && skein_world_error(world)->message[0]));
    }
    skein_world_destroy(world);
    require(used == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    judge(data, size);
    unsigned char *copy = malloc(size + 1);
    require(copy != NULL);
    if (size) memcpy(copy, data, size);
    mend(copy, size);
    judge(copy, size);
    free(copy);
    return 0;
}
