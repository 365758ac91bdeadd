/* What an implicit solve asks of constraints between two particles, once for each instruction set (no include
 * guard): the matrix h^2 k + h c of each element times a direction, and its diagonal blocks.
 *
 * The kind that includes this has defined SK_ISA(stiffness), the stiffness along the element and across it; what
 * it gives must not be negative, so that the matrix is positive definite. An element of the row is an element of
 * the batch. Sixteen are worked out at once; they may share particles, so they are added one after the other,
 * in their order. */

/* Sixteen elements: where they are, how they lie, and their stiffness times h^2 and damping times h. */
typedef struct SK_ISA(stiff_pairs) {
    uint32_t slot[2][SK_LANES];
    size_t count;
    sk_wide3 unit;
    sk_wide along, across;
} SK_ISA(stiff_pairs);

SK_INLINE SK_ISA(stiff_pairs) SK_ISA(stiffen)(const sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_batch *batch = row->rule;
    const sk_material *material = batch->params;
    real k = (real)material->stiffness, elastic = (real)row->coefficient[0];
    real both = elastic + (real)(row->coefficient[1] * sk_batch_damping_time(batch));
    SK_ISA(stiff_pairs) p;
    p.count = end - begin < SK_LANES ? end - begin : SK_LANES;
    sk_wide3 d = {{0}, {0}, {0}};
    sk_wide rest = {0}, stiff = {0}, along, across;
    for (size_t l = 0; l < p.count; l++) {
        size_t e = begin + l;
        p.slot[0][l] = batch->slot[2 * e], p.slot[1][l] = batch->slot[2 * e + 1];
        sk_vec4 a = sk_load(run->vector[SK_X], row->packed, p.slot[0][l]);
        sk_vec4 b = sk_load(run->vector[SK_X], row->packed, p.slot[1][l]);
        d.x[l] = a.x - b.x, d.y[l] = a.y - b.y, d.z[l] = a.z - b.z;
        rest[l] = batch->rest[e];
        stiff[l] = batch->scale ? k * batch->scale[e] : k;
    }
    sk_wide length = SK_ISA(sk_wide_sqrt)(SK_ISA(sk_dot_wide)(d, d));
    sk_wide inverse = SK_ISA(sk_keep)(SK_ISA(sk_positive)(length), 1 / length);
    SK_ISA(stiffness)(stiff, rest, length, inverse, &along, &across);
    p.unit = (sk_wide3){inverse * d.x, inverse * d.y, inverse * d.z};
    p.along = both * along;
    p.across = elastic * across;
    return p;
}

static void SK_ISA(apply)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_vec4 *q = run->vector[row->source[1]];
    sk_vec4 *dst = run->vector[row->dst];
    for (size_t e = begin; e < end; e += SK_LANES) {
        SK_ISA(stiff_pairs) p = SK_ISA(stiffen)(run, row, e, end);
        sk_wide3 u = {{0}, {0}, {0}};
        for (size_t l = 0; l < p.count; l++) {
            sk_vec4 a = sk_load(q, row->packed, p.slot[0][l]), b = sk_load(q, row->packed, p.slot[1][l]);
            u.x[l] = a.x - b.x, u.y[l] = a.y - b.y, u.z[l] = a.z - b.z;
        }
        sk_wide s = (p.along - p.across) * SK_ISA(sk_dot_wide)(p.unit, u);
        sk_wide3 f = {s * p.unit.x + p.across * u.x, s * p.unit.y + p.across * u.y, s * p.unit.z + p.across * u.z};
        for (size_t l = 0; l < p.count; l++) {
            sk_add_at(dst, row->packed, p.slot[0][l], sk_v3(f.x[l], f.y[l], f.z[l]));
            sk_add_at(dst, row->packed, p.slot[1][l], sk_v3(-f.x[l], -f.y[l], -f.z[l]));
        }
    }
}

/* The blocks' xx yy zz go to dst, xy xz yz to the second source. */
static void SK_ISA(diagonal)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_vec4 *diagonal = run->vector[row->dst], *off = run->vector[row->source[1]];
    for (size_t e = begin; e < end; e += SK_LANES) {
        SK_ISA(stiff_pairs) p = SK_ISA(stiffen)(run, row, e, end);
        sk_wide s = p.along - p.across;
        sk_wide3 n = p.unit, sn = {s * n.x, s * n.y, s * n.z};
        sk_wide3 d = {p.across + sn.x * n.x, p.across + sn.y * n.y, p.across + sn.z * n.z};
        sk_wide3 o = {sn.x * n.y, sn.x * n.z, sn.y * n.z};
        for (size_t l = 0; l < p.count; l++)
            for (int k = 0; k < 2; k++) {
                sk_add_at(diagonal, row->packed, p.slot[k][l], sk_v3(d.x[l], d.y[l], d.z[l]));
                sk_add_at(off, row->packed, p.slot[k][l], sk_v3(o.x[l], o.y[l], o.z[l]));
            }
    }
}
