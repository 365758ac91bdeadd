/* What the library's own kinds compute from value and gradient besides forces and projections (projection.h): the
 * matrix of an implicit solve, and limits; once for each instruction set. The kind that includes this has defined
 * SK_FORMULA as the file of its formula in emitted/, whose words the macros below define. */

#define TEXT(text)
#define FORMULA(name) SK_INLINE void name(sk_element *e)
#define RESTS(name) SK_INLINE void name(sk_element *e)
#define REAL sk_wide
#define NUMBER(x) sk_splat((real)(x))
#define AXIS_0 x
#define AXIS_1 y
#define AXIS_2 z
#define POSITION(particle, axis) e->x[particle].AXIS_##axis
#define PARAMETER(index) e->rest[index]
#define VALUE(component, x) e->value = (x)
#define GRADIENT(component, particle, axis, g) e->gradient[particle].AXIS_##axis = (g)
#define OPPOSITE(particle, of)                                     \
    e->opposite = true;                                            \
    e->gradient[particle] = (sk_wide3) {                           \
        -e->gradient[of].x, -e->gradient[of].y, -e->gradient[of].z \
    }
#define UNIT_DIVISOR(x) e->divided = true, e->divisor = (x)
#define RECIPROCAL(x) reciprocal(x)
#define SQRT(x) sk_wide_sqrt(x)
#define REST(index, x) e->rest[index] = (x)
#define ABS(x) sk_wide_abs(x)
#define LESS(a, b, yes, no) sk_select(sk_more(b, a), yes, no)
#define ATAN2(y, x) sk_wide_atan2(y, x)

SK_INLINE sk_wide reciprocal(sk_wide x) {
    sk_wide least = sk_splat(SK_LEAST_NORMAL);
    return sk_keep(sk_at_most(least, sk_wide_abs(x)), 1 / x);
}

#include SK_FORMULA

/* A kind with SK_ONE_SIDED keeps its C at 0 or more: elements with C >= 0 are slack, and do nothing. */
#ifdef SK_ONE_SIDED
#define SK_IS_ONE_SIDED true
#else
#define SK_IS_ONE_SIDED false
#endif

/* How far an element is beyond slack, and its stiffness there. Elements that are just taut have it in full, so that
 * stability estimates (world/stability.c) of a sheet at rest include its diagonals. */
SK_INLINE sk_wide excess_of(const sk_element *e) {
    return SK_IS_ONE_SIDED ? -e->value : e->value;
}
SK_INLINE sk_wide stiffness_at(const sk_element *e, sk_wide stiffness) {
    if (!SK_IS_ONE_SIDED) return stiffness;
    return sk_keep(sk_at_most(e->value, (real)1e-4 * e->rest[0]), stiffness);
}

/* The matrix a k + b c of an element at its position, times a direction. The stiffness is k (grad C)(grad C)^T,
 * positive semidefinite whatever C is (Gauss-Newton). A kind with SK_ACROSS adds the geometric stiffness, tension
 * across the gradient, if it is positive. */
SK_INLINE void apply(sk_element *e, const sk_element_constants *c) {
    sk_wide stiffness = stiffness_at(e, e->stiffness), push = c->both * stiffness, along = sum_along(e, e->other);
    e->across = (sk_wide3){{0}, {0}, {0}};
    if (e->divided) {
        sk_wide inverse = inverse_divisor(e);
#ifdef SK_ACROSS
        sk_wide across = c->elastic * sk_keep(sk_positive(excess_of(e)), stiffness * excess_of(e) * inverse);
        push -= across;
        e->across = (sk_wide3){across * (e->other[0].x - e->other[1].x), across * (e->other[0].y - e->other[1].y),
                               across * (e->other[0].z - e->other[1].z)};
#endif
        push = push * inverse * inverse;
    }
    push *= along;
    SK_EACH_PARTICLE (i) e->scale[i] = push;
}

#ifdef SK_VECTOR
/* The same for a kind whose value is |L|: the stiffness is k J^T J, J = dL/dx, also where L is 0, and the damping
 * c (grad C)(grad C)^T. The kind's spread(e, v, g) leaves J^T v in g. */
SK_INLINE sk_wide3 sk_axis_wide(int axis) {
    return (sk_wide3){sk_splat(axis == 0), sk_splat(axis == 1), sk_splat(axis == 2)};
}

SK_INLINE void apply_vector(sk_element *e, const sk_element_constants *c) {
    sk_wide3 sum[SK_ARITY], g[SK_ARITY];
    sk_wide damped = (c->both - c->elastic) * e->stiffness * sum_along(e, e->other);
    SK_EACH_PARTICLE (i)
        sum[i] = (sk_wide3){damped * e->gradient[i].x, damped * e->gradient[i].y, damped * e->gradient[i].z};
    for (int axis = 0; axis < 3; axis++) {
        sk_wide along = {0};
        spread(e, sk_axis_wide(axis), g);
        SK_EACH_PARTICLE (i) along += sk_dot_wide(g[i], e->other[i]);
        along = c->elastic * e->stiffness * along;
        SK_EACH_PARTICLE (i) sum[i].x += along * g[i].x, sum[i].y += along * g[i].y, sum[i].z += along * g[i].z;
    }
    SK_EACH_PARTICLE (i) e->gradient[i] = sum[i], e->scale[i] = sk_splat(1);
}
#endif

#ifdef SK_LINEAR
/* Projection for a kind whose value is |L|, where L = sum of c x is linear in the positions. Its gradient is c L/|L|,
 * so the displacements are -w c L / (sum of w c^2 + soft), without a root, and right also if L is 0. The kind's
 * linear() leaves c in `scale` and L in the first gradient. */
SK_INLINE void project_linear(sk_element *e) {
    linear(e);
    sk_wide below = e->soft;
    SK_EACH_PARTICLE (i) {
        sk_wide moves = e->w[i] * e->scale[i];
        below += moves * e->scale[i];
        e->scale[i] = moves;
        e->gradient[i] = e->gradient[0];
    }
    sk_wide s = sk_keep(sk_positive(below), -1 / below);
    SK_EACH_PARTICLE (i) e->scale[i] = s * e->scale[i];
}
#endif

#define SK_LIMIT_ROUNDING ((real)(sizeof(real) == 4 ? 1e-6 : 1e-15))

/* Moves elements back to the bound, as if rigid there, or so many times as far. Lanes without an element, whose rest value is 0, are
 * never over it. False if all are within. Sweeps that go too far come one after the other, and pass over what rounding may be: of a free
 * sheet whose bound is 0 they made 9 % of momentum in 10,000 substeps. */
SK_INLINE bool limit(sk_element *e, const sk_element_constants *c, bool moving) {
#ifdef SK_SHARES
    SK_EACH_PARTICLE (i) e->w[i] *= e->rest[1 + i];
#endif
    sk_wide most = c->bound * e->rest[0];
#ifdef SK_BEYOND
    if (!sk_any(SK_BEYOND(e, most) & sk_positive(e->rest[0]))) return false;
#endif
    formula(e);
    sk_wide weight = weight_of(e), below = weight;
    if (e->divided) below = e->divisor * weight;
    sk_wide over = most;
    if (c->elastic > 1) {
        sk_wide size = e->rest[0];
        SK_EACH_PARTICLE (i) size += sk_wide_abs(e->x[i].x) + sk_wide_abs(e->x[i].y) + sk_wide_abs(e->x[i].z);
        sk_wide rounding = SK_LIMIT_ROUNDING * size, little = (real)1e-4 * e->rest[0];
        over += sk_select(sk_more(rounding, little), little, rounding);
    }
    e->over = sk_more(e->value, over) & sk_positive(below) & sk_positive(e->rest[0]);
    if (!sk_any(e->over)) return false;
    sk_wide s = c->elastic * (most - e->value) / below;
    SK_EACH_PARTICLE (i) e->scale[i] = s * e->w[i];
    if (!moving) return true;
    sk_wide parting = sum_along(e, e->other), square = e->divided ? e->divisor * below : weight;
    sk_wide stop = sk_keep(sk_positive(parting), -parting / square);
    SK_EACH_PARTICLE (i) e->velocity_scale[i] = stop * e->w[i];
    return true;
}

/* Computes what a mode needs of a part of elements. False if nothing moves. */
SK_INLINE bool work_out(sk_element *e, const sk_element_constants *c, sk_element_mode mode) {
    e->divided = e->opposite = e->timed = e->is_energy = false, e->judged = e->one_sided = SK_IS_ONE_SIDED;
#ifdef SK_LINEAR
    if (mode == SK_MODE_PROJECT) {
        project_linear(e);
        return true;
    }
#endif
    if (mode == SK_MODE_LIMIT || mode == SK_MODE_LIMIT_MOVING) return limit(e, c, mode == SK_MODE_LIMIT_MOVING);
    formula(e);
    if (SK_IS_ONE_SIDED) e->active = sk_negative(e->value);
#ifdef SK_VECTOR
    if (mode == SK_MODE_APPLY) {
        apply_vector(e, c);
        return true;
    }
#endif
    if (mode == SK_MODE_APPLY) apply(e, c);
    else answer(e, c, mode);
    return true;
}

#undef TEXT
#undef FORMULA
#undef RESTS
#undef REAL
#undef NUMBER
#undef AXIS_0
#undef AXIS_1
#undef AXIS_2
#undef POSITION
#undef PARAMETER
#undef VALUE
#undef GRADIENT
#undef OPPOSITE
#undef UNIT_DIVISOR
#undef RECIPROCAL
#undef SQRT
#undef REST
#undef ABS
#undef LESS
#undef ATAN2
