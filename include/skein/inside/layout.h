/* Reaching single particles in a state vector, whatever the layout of their block.
 *
 * While a plan runs, slots [0, packed) are in packed blocks (x16 y16 z16 w16) and the rest in quads; a
 * row says how many are packed when it runs. Outside a step everything is quads. */
#ifndef SK_BASE_LAYOUT_H
#define SK_BASE_LAYOUT_H

#include <skein/inside/vector.h>

/* Where a slot's x is, and how far y, z and w are from each other. */
static inline real *sk_place(sk_vec4 *vector, size_t packed, size_t slot, size_t *stride) {
    real *reals = (real *)(void *)vector;
    *stride = slot < packed ? 16 : 1;
    return slot < packed ? reals + (slot & ~(size_t)15) * 4 + (slot & 15) : reals + slot * 4;
}

static inline sk_vec4 sk_load(const sk_vec4 *vector, size_t packed, size_t slot) {
    size_t stride;
    const real *at = sk_place((sk_vec4 *)(uintptr_t)vector, packed, slot, &stride);
    return (sk_vec4){at[0], at[stride], at[2 * stride], at[3 * stride]};
}

/* Adds to x, y and z; w is a mass and stays. */
static inline void sk_add_at(sk_vec4 *vector, size_t packed, size_t slot, sk_vec3 v) {
    size_t stride;
    real *at = sk_place(vector, packed, slot, &stride);
    at[0] += v.x;
    at[stride] += v.y;
    at[2 * stride] += v.z;
}

static inline void sk_store_at(sk_vec4 *vector, size_t packed, size_t slot, sk_vec3 v) {
    size_t stride;
    real *at = sk_place(vector, packed, slot, &stride);
    at[0] = v.x;
    at[stride] = v.y;
    at[2 * stride] = v.z;
}

#endif
