/* Vectors of sixteen, for what is written by hand; for files of kernels (base/kernels.h). */

SK_INLINE sk_wide3 minus(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}
SK_INLINE sk_wide3 weighted_sum(sk_wide s, sk_wide3 a, sk_wide t, sk_wide3 b) {
    return (sk_wide3){s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}
SK_INLINE sk_wide3 cross(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
SK_INLINE sk_wide3 scale(sk_wide s, sk_wide3 a) {
    return (sk_wide3){s * a.x, s * a.y, s * a.z};
}
/* 1/x where x is positive, else 0. */
SK_INLINE sk_wide inverse_of(sk_wide x) {
    return sk_keep(sk_positive(x), 1 / x);
}
