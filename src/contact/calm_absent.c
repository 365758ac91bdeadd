/* No patch is ever calm, where what the library takes counts more than time: every pair around a leaf is searched for, with
 * the same bits. Instead of calm.c and make/calm.c in WebAssembly, which pages wait for. */
#include "contact/touch.h"

bool sk_calm_make(sk_touch *touch, sk_allocator *allocator) {
    sk_calm_release(&touch->calm, allocator);
    // nobody lies around any leaf
    touch->calm.ring_start = sk_allocate(allocator, (touch->skin.leaf_count + 2) * sizeof *touch->calm.ring_start);
    return touch->calm.ring_start != NULL;
}

void sk_calm_release(sk_calm *calm, sk_allocator *allocator) {
    sk_release(allocator, calm->ring_start);
    *calm = (sk_calm){.patch_count = 0};
}

void sk_calm_forget(sk_touch *touch) {
    (void)touch;
}

bool sk_calm_look(sk_touch *touch, sk_allocator *allocator, bool all) {
    (void)touch, (void)allocator, (void)all;
    return true;
}

bool sk_calm_holds(sk_touch *touch, real way) {
    (void)touch, (void)way;
    return true;
}

bool sk_calm_follow(sk_touch *touch, sk_allocator *allocator) {
    (void)touch, (void)allocator;
    return true;
}

bool sk_calm_disturb(sk_touch *touch, sk_allocator *allocator, size_t v) {
    (void)touch, (void)allocator, (void)v;
    return true;
}
