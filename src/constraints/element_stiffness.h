/* The rest of what an implicit solve asks of a kind's elements, once for each instruction set, after
 * element_arithmetic.h, which has the matrix h^2 k + h c of each element times a direction (`apply`): that matrix's
 * blocks. An element of the row is an element of the batch. They may share particles, so what is worked out is added one
 * after the other: of sixteen elements first what their first particles get, in the order of the elements, and so on. */

/* A part of sixteen elements: the unit of their gradient (or the gradient itself), their stiffness times h^2 and
 * damping times h. */
typedef struct stiff_elements {
    uint32_t slot[SK_ARITY][SK_PART];
    size_t count;
    sk_element e;
    sk_wide along, across;
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
    s->along = both * stiff;
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

/* What the particles of sixteen elements get. */
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
            sk_wide push = s.along - s.across;
            SK_EACH_PARTICLE (i) {
                sk_wide3 n = s.e.gradient[i], sn = {push * n.x, push * n.y, push * n.z};
                note(&diagonal, &s, first, i,
                     (sk_wide3){s.across + sn.x * n.x, s.across + sn.y * n.y, s.across + sn.z * n.z});
                note(&off, &s, first, i, (sk_wide3){sn.x * n.y, sn.x * n.z, sn.y * n.z});
            }
        }
        add(run->vector[op->dst], op->packed, &diagonal, count);
        add(run->vector[op->source[1]], op->packed, &off, count);
    }
}

/* The element's own rows and columns of the matrix. */
void SK_KERNEL(blocks)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    enum { PAIRS = SK_ARITY * (SK_ARITY - 1) / 2 };
    const sk_batch *batch = op->rule;
    stiff_elements s;
    for (size_t at = begin; at < end; at += SK_PART) {
        stiffen(&s, run, op, at, end);
        sk_wide push = s.along - s.across;
        for (size_t l = 0; l < s.count; l++) {
            double g[SK_ARITY][3];
            SK_EACH_PARTICLE (i) {
                g[i][0] = (double)s.e.gradient[i].x[l], g[i][1] = (double)s.e.gradient[i].y[l];
                g[i][2] = (double)s.e.gradient[i].z[l];
            }
            sk_matrix_add_square(run->matrix, SK_ARITY, batch->particle + SK_ARITY * (at + l),
                                 batch->pair + PAIRS * (at + l), g, (double)push[l], (double)s.across[l]);
        }
    }
}
