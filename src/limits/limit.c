#include "limits/limit.h"

void sk_limit_release(sk_limit *limit, sk_allocator *allocator) {
    if (!limit) return;
    sk_release(allocator, limit->particle);
    sk_release(allocator, limit->slot);
    sk_release(allocator, limit->length);
    sk_release(allocator, limit);
}

void sk_limit_refresh(sk_limit *limit, const uint32_t *slot_of) {
    if (!limit->particle) return;
    for (size_t i = 0; i < limit->count * (1 + limit->anchors); i++) limit->slot[i] = slot_of[limit->particle[i]];
}
