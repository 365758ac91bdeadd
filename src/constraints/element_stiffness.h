/* The blocks of the matrix h^2 k + h c of a kind's elements, for implicit solves; once for each instruction set, after
 * element_arithmetic.h, which has that matrix times a direction (`apply`). An element of the op is an element of the
 * batch. Elements may share particles, so results are added one after the other: of sixteen elements first those of
 * their first particles, in the order of the elements, and so on. */

/* A part of sixteen elements: the unit of their gradient (or the gradient itself), their stiffness times h^2 and
 * damping times h. */
typedef struct stiff_elements {
    uint32_t slot[SK_ARITY][SK_PART];
    size_t count;
    sk_element e;
    sk_wide along, across, elastic; /* along: both; elastic: without damping */
} stiff_elements;

SK_INLINE void stiffen(stiff_elements *s, const sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_batch *batch = op->rule;
    const sk_material *material = batch->params;
    real k = (real)material->stiffness, elastic = (real)op->coefficient[0];
    real both = elastic + (real)(op->coefficient[1] * sk_batch_damping_time(batch));
    sk_element *e = &s->e;
    s->count = end - begin < SK_PART ? end - begin : SK_PART;
    memset(e->x, 0, sizeof e->x);
    memset(e->rest, 0, sizeof e->rest);
    sk_wide stiff = {0};
    for (size_t l = 0; l < s->count; l++) {
        size_t element = begin + l;
        SK_EACH_PARTICLE (i) {
            s->slot[i][l] = batch->slot[SK_ARITY * element + (size_t)i];
            sk_vec4 x = sk_load(run->vector[SK_X], op->packed, s->slot[i][l]);
            e->x[i].x[l] = x.x, e->x[i].y[l] = x.y, e->x[i].z[l] = x.z;
        }
        for (int r = 0; r < SK_RESTS; r++) e->rest[r][l] = batch->rest[(size_t)r * batch->count + element];
        stiff[l] = batch->scale ? k * batch->scale[element] : k;
    }
    e->divided = e->opposite = false;
    formula(e);
    stiff = stiffness_at(e, stiff);
    s->along = both * stiff, s->elastic = elastic * stiff;
    s->across = (sk_wide){0};
    if (!e->divided) return;
    sk_wide inverse = inverse_divisor(e);
    SK_EACH_PARTICLE (i) {
        sk_wide3 *g = &e->gradient[i];
        *g = (sk_wide3){inverse * g->x, inverse * g->y, inverse * g->z};
    }
#ifdef SK_ACROSS
    s->across = elastic * sk_keep(sk_positive(excess_of(e)), stiff * excess_of(e) * inverse);
#endif
}

/* The matrix of an element is the sum of these terms, each push g g^T, and `across`. */
#ifdef SK_VECTOR
enum { SK_TERMS = 4 };
SK_INLINE sk_wide term(const stiff_elements *s, int t, sk_wide3 *g) {
    if (t < 3) spread(&s->e, sk_axis_wide(t), g);
    else memcpy(g, s->e.gradient, sizeof s->e.gradient);
    return t < 3 ? s->elastic : s->along - s->elastic;
}
#else
enum { SK_TERMS = 1 };
SK_INLINE sk_wide term(const stiff_elements *s, int t, sk_wide3 *g) {
    (void)t;
    memcpy(g, s->e.gradient, sizeof s->e.gradient);
    return s->along - s->across;
}
#endif

/* What is to be added for the particles of sixteen elements. */
typedef struct additions {
    uint32_t slot[SK_ARITY][SK_LANES];
    sk_vec3 value[SK_ARITY][SK_LANES];
} additions;

SK_INLINE void note(additions *a, const stiff_elements *s, size_t first, int i, sk_wide3 value) {
    for (size_t l = 0; l < s->count; l++) {
        a->slot[i][first + l] = s->slot[i][l];
        a->value[i][first + l] = sk_v3(value.x[l], value.y[l], value.z[l]);
    }
}

SK_INLINE void add(sk_vec4 *vector, size_t packed, const additions *a, size_t count) {
    SK_EACH_PARTICLE (i)
        for (size_t l = 0; l < count; l++) sk_add_at(vector, packed, a->slot[i][l], a->value[i][l]);
}

/* The blocks' xx yy zz go to dst, xy xz yz to the second source. */
void SK_KERNEL(diagonal)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    stiff_elements s;
    additions diagonal, off;
    for (size_t at = begin; at < end; at += SK_LANES) {
        size_t count = end - at < SK_LANES ? end - at : SK_LANES;
        for (size_t first = 0; first < count; first += SK_PART) {
            stiffen(&s, run, op, at + first, at + count);
            sk_wide3 on[SK_ARITY], beside[SK_ARITY], g[SK_ARITY];
            SK_EACH_PARTICLE (i)
                on[i] = (sk_wide3){s.across, s.across, s.across}, beside[i] = (sk_wide3){{0}, {0}, {0}};
            for (int t = 0; t < SK_TERMS; t++) {
                sk_wide push = term(&s, t, g);
                SK_EACH_PARTICLE (i) {
                    sk_wide3 n = g[i], sn = {push * n.x, push * n.y, push * n.z};
                    on[i].x += sn.x * n.x, on[i].y += sn.y * n.y, on[i].z += sn.z * n.z;
                    beside[i].x += sn.x * n.y, beside[i].y += sn.x * n.z, beside[i].z += sn.y * n.z;
                }
            }
            SK_EACH_PARTICLE (i) note(&diagonal, &s, first, i, on[i]), note(&off, &s, first, i, beside[i]);
        }
        add(run->vector[op->dst], op->packed, &diagonal, count);
        add(run->vector[op->source[1]], op->packed, &off, count);
    }
}

/* Adds the elements' blocks to the matrix. */
void SK_KERNEL(blocks)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    enum { PAIRS = SK_ARITY * (SK_ARITY - 1) / 2 };
    const sk_batch *batch = op->rule;
    stiff_elements s;
    for (size_t at = begin; at < end; at += SK_PART) {
        stiffen(&s, run, op, at, end);
        for (int t = 0; t < SK_TERMS; t++) {
            sk_wide3 n[SK_ARITY];
            sk_wide push = term(&s, t, n);
            for (size_t l = 0; l < s.count; l++) {
                double g[SK_ARITY][3];
                SK_EACH_PARTICLE (i)
                    g[i][0] = (double)n[i].x[l], g[i][1] = (double)n[i].y[l], g[i][2] = (double)n[i].z[l];
                sk_matrix_add_square(run->matrix, SK_ARITY, batch->particle + SK_ARITY * (at + l),
                                     batch->pair + PAIRS * (at + l), g, (double)push[l], t ? 0 : (double)s.across[l]);
            }
        }
    }
}
