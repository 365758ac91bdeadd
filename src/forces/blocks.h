/* Stiffness of forces by place, as 3 x 3 blocks of sixteen particles (no include guard: for files of kernels).
 *
 * An implicit solve takes the symmetric part of -dF/dx and -dF/dv, and of that the positive part: conjugate gradients
 * need a positive definite matrix, and where a potential curves downwards the solve is better off without. The answer
 * does not depend on it, only how fast it is found. */

typedef struct SK_ISA(block) {
    sk_wide xx, yy, zz, xy, xz, yz;
} SK_ISA(block);

/* One Jacobi rotation: takes a_pq to 0, with r the third axis, and turns the columns p and q of the axes. */
SK_INLINE void SK_ISA(rotate)(sk_wide *pp, sk_wide *qq, sk_wide *pq, sk_wide *pr, sk_wide *qr, sk_wide3 *p,
                              sk_wide3 *q) {
    sk_wide one = SK_ISA(sk_splat)(1), none = {0};
    sk_mask off = SK_ISA(sk_differ)(*pq, none);
    sk_wide theta = (*qq - *pp) / (2 * SK_ISA(sk_select)(off, *pq, one));
    sk_wide size = SK_ISA(sk_wide_abs)(theta) + SK_ISA(sk_wide_sqrt)(theta * theta + 1);
    sk_wide t = SK_ISA(sk_keep)(off, SK_ISA(sk_select)(SK_ISA(sk_negative)(theta), -one, one) / size);
    sk_wide c = 1 / SK_ISA(sk_wide_sqrt)(t * t + 1), s = t * c;
    *pp -= t * *pq, *qq += t * *pq, *pq = none;
    sk_wide kept = *pr;
    *pr = c * kept - s * *qr, *qr = s * kept + c * *qr;
    sk_wide3 old = *p;
    *p = (sk_wide3){c * old.x - s * q->x, c * old.y - s * q->y, c * old.z - s * q->z};
    *q = (sk_wide3){s * old.x + c * q->x, s * old.y + c * q->y, s * old.z + c * q->z};
}

SK_INLINE void SK_ISA(add_axis)(SK_ISA(block) * sum, sk_wide value, sk_wide3 u) {
    sk_wide l = SK_ISA(sk_keep)(SK_ISA(sk_positive)(value), value);
    sum->xx += l * u.x * u.x, sum->yy += l * u.y * u.y, sum->zz += l * u.z * u.z;
    sum->xy += l * u.x * u.y, sum->xz += l * u.x * u.z, sum->yz += l * u.y * u.z;
}

/* The lanes in which no principal minor is under 0. */
SK_INLINE sk_mask SK_ISA(is_positive)(const SK_ISA(block) * a) {
    sk_wide xy = a->xx * a->yy - a->xy * a->xy, xz = a->xx * a->zz - a->xz * a->xz, yz = a->yy * a->zz - a->yz * a->yz;
    sk_wide all = a->xx * yz - a->xy * (a->xy * a->zz - a->yz * a->xz) + a->xz * (a->xy * a->yz - a->yy * a->xz);
    return ~(SK_ISA(sk_negative)(a->xx) | SK_ISA(sk_negative)(a->yy) | SK_ISA(sk_negative)(a->zz) |
             SK_ISA(sk_negative)(xy) | SK_ISA(sk_negative)(xz) | SK_ISA(sk_negative)(yz) | SK_ISA(sk_negative)(all));
}

/* What is left of a block with its negative eigenvalues taken as 0. */
SK_INLINE void SK_ISA(make_positive)(SK_ISA(block) * a) {
    enum { TURNS = 5 };
    sk_mask good = SK_ISA(is_positive)(a);
    if (!SK_ISA(sk_any)(~good)) return;
    sk_wide one = SK_ISA(sk_splat)(1), none = {0};
    sk_wide3 x = {one, none, none}, y = {none, one, none}, z = {none, none, one};
    SK_ISA(block) d = *a, sum = {none, none, none, none, none, none};
    for (int turn = 0; turn < TURNS; turn++) {
        SK_ISA(rotate)(&d.xx, &d.yy, &d.xy, &d.xz, &d.yz, &x, &y);
        SK_ISA(rotate)(&d.xx, &d.zz, &d.xz, &d.xy, &d.yz, &x, &z);
        SK_ISA(rotate)(&d.yy, &d.zz, &d.yz, &d.xy, &d.xz, &y, &z);
    }
    SK_ISA(add_axis)(&sum, d.xx, x);
    SK_ISA(add_axis)(&sum, d.yy, y);
    SK_ISA(add_axis)(&sum, d.zz, z);
    a->xx = SK_ISA(sk_select)(good, a->xx, sum.xx), a->yy = SK_ISA(sk_select)(good, a->yy, sum.yy);
    a->zz = SK_ISA(sk_select)(good, a->zz, sum.zz), a->xy = SK_ISA(sk_select)(good, a->xy, sum.xy);
    a->xz = SK_ISA(sk_select)(good, a->xz, sum.xz), a->yz = SK_ISA(sk_select)(good, a->yz, sum.yz);
}

/* dst += block direction */
SK_INLINE void SK_ISA(add_product)(sk_run *run, const sk_row *row, size_t slot, const SK_ISA(block) * a) {
    bool packed = slot < row->packed;
    sk_wide4 p = SK_ISA(sk_load_block)(run->vector[row->source[1]], slot, packed);
    sk_wide4 d = SK_ISA(sk_load_block)(run->vector[row->dst], slot, packed);
    d.x += a->xx * p.x + a->xy * p.y + a->xz * p.z;
    d.y += a->xy * p.x + a->yy * p.y + a->yz * p.z;
    d.z += a->xz * p.x + a->yz * p.y + a->zz * p.z;
    SK_ISA(sk_store_block)(run->vector[row->dst], slot, packed, d);
}

/* dst += the diagonal, second source += the rest */
SK_INLINE void SK_ISA(add_block)(sk_run *run, const sk_row *row, size_t slot, const SK_ISA(block) * a) {
    bool packed = slot < row->packed;
    sk_wide4 d = SK_ISA(sk_load_block)(run->vector[row->dst], slot, packed);
    sk_wide4 o = SK_ISA(sk_load_block)(run->vector[row->source[1]], slot, packed);
    d.x += a->xx, d.y += a->yy, d.z += a->zz;
    o.x += a->xy, o.y += a->xz, o.z += a->yz;
    SK_ISA(sk_store_block)(run->vector[row->dst], slot, packed, d);
    SK_ISA(sk_store_block)(run->vector[row->source[1]], slot, packed, o);
}
