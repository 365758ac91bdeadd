/* The stiffness of forces that depend on place, as 3 x 3 blocks of a part of particles (for files of kernels).
 *
 * An implicit solve uses the symmetric part of -dF/dx and -dF/dv with negative eigenvalues set to 0, since conjugate
 * gradients need a positive definite matrix. The solution does not depend on that, only how fast it is found. */

typedef struct stiffness_block {
    sk_wide xx, yy, zz, xy, xz, yz;
} stiffness_block;

/* One Jacobi rotation: makes a_pq 0, where r is the third axis, and rotates the columns p and q of the axes. */
SK_INLINE void rotate(sk_wide *pp, sk_wide *qq, sk_wide *pq, sk_wide *pr, sk_wide *qr, sk_wide3 *p, sk_wide3 *q) {
    sk_wide one = sk_splat(1), none = {0};
    sk_mask off = sk_differ(*pq, none);
    sk_wide theta = (*qq - *pp) / (2 * sk_select(off, *pq, one));
    sk_wide size = sk_wide_abs(theta) + sk_wide_sqrt(theta * theta + 1);
    sk_wide t = sk_keep(off, sk_select(sk_negative(theta), -one, one) / size);
    sk_wide c = 1 / sk_wide_sqrt(t * t + 1), s = t * c;
    *pp -= t * *pq, *qq += t * *pq, *pq = none;
    sk_wide kept = *pr;
    *pr = c * kept - s * *qr, *qr = s * kept + c * *qr;
    sk_wide3 old = *p;
    *p = (sk_wide3){c * old.x - s * q->x, c * old.y - s * q->y, c * old.z - s * q->z};
    *q = (sk_wide3){s * old.x + c * q->x, s * old.y + c * q->y, s * old.z + c * q->z};
}

SK_INLINE void add_axis(stiffness_block *sum, sk_wide value, sk_wide3 u) {
    sk_wide l = sk_keep(sk_positive(value), value);
    sum->xx += l * u.x * u.x, sum->yy += l * u.y * u.y, sum->zz += l * u.z * u.z;
    sum->xy += l * u.x * u.y, sum->xz += l * u.x * u.z, sum->yz += l * u.y * u.z;
}

/* The lanes in which no principal minor is negative. */
SK_INLINE sk_mask is_positive(const stiffness_block *a) {
    sk_wide xy = a->xx * a->yy - a->xy * a->xy, xz = a->xx * a->zz - a->xz * a->xz, yz = a->yy * a->zz - a->yz * a->yz;
    sk_wide all = a->xx * yz - a->xy * (a->xy * a->zz - a->yz * a->xz) + a->xz * (a->xy * a->yz - a->yy * a->xz);
    return ~(sk_negative(a->xx) | sk_negative(a->yy) | sk_negative(a->zz) | sk_negative(xy) | sk_negative(xz) |
             sk_negative(yz) | sk_negative(all));
}

/* Sets the negative eigenvalues of a block to 0. */
SK_INLINE void make_positive(stiffness_block *a) {
    enum { TURNS = 5 };
    sk_mask good = is_positive(a);
    if (!sk_any(~good)) return;
    sk_wide one = sk_splat(1), none = {0};
    sk_wide3 x = {one, none, none}, y = {none, one, none}, z = {none, none, one};
    stiffness_block d = *a, sum = {none, none, none, none, none, none};
    for (int turn = 0; turn < TURNS; turn++) {
        rotate(&d.xx, &d.yy, &d.xy, &d.xz, &d.yz, &x, &y);
        rotate(&d.xx, &d.zz, &d.xz, &d.xy, &d.yz, &x, &z);
        rotate(&d.yy, &d.zz, &d.yz, &d.xy, &d.xz, &y, &z);
    }
    add_axis(&sum, d.xx, x);
    add_axis(&sum, d.yy, y);
    add_axis(&sum, d.zz, z);
    a->xx = sk_select(good, a->xx, sum.xx), a->yy = sk_select(good, a->yy, sum.yy);
    a->zz = sk_select(good, a->zz, sum.zz), a->xy = sk_select(good, a->xy, sum.xy);
    a->xz = sk_select(good, a->xz, sum.xz), a->yz = sk_select(good, a->yz, sum.yz);
}

/* dst += block times direction */
SK_INLINE void add_product(sk_run *run, const sk_op *op, size_t slot, const stiffness_block *a) {
    bool packed = slot < op->packed;
    sk_wide4 p = sk_load_part(run->vector[op->source[1]], slot, packed);
    sk_wide4 d = sk_load_part(run->vector[op->dst], slot, packed);
    d.x += a->xx * p.x + a->xy * p.y + a->xz * p.z;
    d.y += a->xy * p.x + a->yy * p.y + a->yz * p.z;
    d.z += a->xz * p.x + a->yz * p.y + a->zz * p.z;
    sk_store_part(run->vector[op->dst], slot, packed, d);
}

/* dst += the diagonal (xx yy zz), second source += the rest (xy xz yz) */
SK_INLINE void add_block(sk_run *run, const sk_op *op, size_t slot, const stiffness_block *a) {
    bool packed = slot < op->packed;
    sk_wide4 d = sk_load_part(run->vector[op->dst], slot, packed);
    sk_wide4 o = sk_load_part(run->vector[op->source[1]], slot, packed);
    d.x += a->xx, d.y += a->yy, d.z += a->zz;
    o.x += a->xy, o.y += a->xz, o.z += a->yz;
    sk_store_part(run->vector[op->dst], slot, packed, d);
    sk_store_part(run->vector[op->source[1]], slot, packed, o);
}
