/* Vectors of sixteen, for what is written by hand; once for each instruction set (no include guard). */

SK_INLINE sk_wide3 SK_ISA(minus)(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}
SK_INLINE sk_wide3 SK_ISA(sum)(sk_wide s, sk_wide3 a, sk_wide t, sk_wide3 b) {
    return (sk_wide3){s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}
SK_INLINE sk_wide3 SK_ISA(cross)(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
SK_INLINE sk_wide3 SK_ISA(scale)(sk_wide s, sk_wide3 a) {
    return (sk_wide3){s * a.x, s * a.y, s * a.z};
}
/* 1/x where x is positive, else 0. */
SK_INLINE sk_wide SK_ISA(over)(sk_wide x) {
    return SK_ISA(sk_keep)(SK_ISA(sk_positive)(x), 1 / x);
}
