/* Rows of reals as vectors, and the less and the more of two. (Of what is no number, the second is taken.) For kernels. */
#ifndef SK_CONTACT_LANES_H
#define SK_CONTACT_LANES_H

SK_INLINE const sk_wide *sk_row(const real *reals) {
    return (const sk_wide *)(const void *)reals;
}

SK_INLINE sk_wide *sk_row_to(real *reals) {
    return (sk_wide *)(void *)reals;
}

SK_INLINE sk_wide sk_least_wide(sk_wide a, sk_wide b) {
    return sk_select(sk_more(b, a), a, b);
}

SK_INLINE sk_wide sk_most_wide(sk_wide a, sk_wide b) {
    return sk_select(sk_more(a, b), a, b);
}

#endif
