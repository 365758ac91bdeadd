/* From a formula's value and gradient to forces, moves and limits: the same for every kind, once for each instruction
 * set (no include guard). The kind that includes this has defined SK_FORMULA as the file of its formula in
 * emitted/, and the macros below say what that file's words mean here. */

#define FORMULA(name) SK_INLINE void SK_ISA(name)(sk_element * e)
#define RESTS(name) SK_INLINE void SK_ISA(name)(sk_element * e)
#define REAL sk_wide
#define NUMBER(x) SK_ISA(sk_splat)((real)(x))
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
#define RECIPROCAL(x) SK_ISA(reciprocal)(x)
#define SQRT(x) SK_ISA(sk_wide_sqrt)(x)
#define REST(index, x) e->rest[index] = (x)
#define ABS(x) SK_ISA(sk_wide_abs)(x)
#define LESS(a, b, yes, no) SK_ISA(sk_select)(SK_ISA(sk_more)(b, a), yes, no)
#define ATAN2(y, x) SK_ISA(sk_wide_atan2)(y, x)

SK_INLINE sk_wide SK_ISA(reciprocal)(sk_wide x) {
    sk_wide least = SK_ISA(sk_splat)(SK_LEAST_NORMAL);
    return SK_ISA(sk_keep)(SK_ISA(sk_at_most)(least, SK_ISA(sk_wide_abs)(x)), 1 / x);
}

#include SK_FORMULA

/* G . u of all particles. */
SK_INLINE sk_wide SK_ISA(along)(const sk_element *e, const sk_wide3 *u) {
    if (e->opposite) {
        sk_wide3 d = {u[0].x - u[1].x, u[0].y - u[1].y, u[0].z - u[1].z};
        return SK_ISA(sk_dot_wide)(e->gradient[0], d);
    }
    sk_wide sum = SK_ISA(sk_dot_wide)(e->gradient[0], u[0]);
    SK_EACH_PARTICLE (i) sum = i ? sum + SK_ISA(sk_dot_wide)(e->gradient[i], u[i]) : sum;
    return sum;
}

/* 1/divisor. Where it is 0 the gradient has no direction: there is no force, and no NaN. */
SK_INLINE sk_wide SK_ISA(inverse_divisor)(const sk_element *e) {
    return SK_ISA(sk_keep)(SK_ISA(sk_positive)(e->divisor), 1 / e->divisor);
}

/* The sum of w |gradient|^2. */
SK_INLINE sk_wide SK_ISA(weight)(const sk_element *e) {
    sk_wide sum = {0};
    SK_EACH_PARTICLE (i) {
        sk_wide one = e->divided ? e->w[i] : e->w[i] * SK_ISA(sk_dot_wide)(e->gradient[i], e->gradient[i]);
        sum = i ? sum + one : one;
    }
    return sum;
}

SK_INLINE void SK_ISA(pull)(sk_element *e, const sk_element_constants *c) {
    sk_wide rate = SK_ISA(along)(e, e->other), push;
    if (e->divided) {
        sk_wide inverse = SK_ISA(inverse_divisor)(e);
        push = (e->stiffness * (-e->value - c->damping_time * (rate * inverse))) * inverse;
    } else {
        push = e->stiffness * (-e->value - c->damping_time * rate);
    }
    SK_EACH_PARTICLE (i) e->scale[i] = push;
}

SK_INLINE void SK_ISA(project)(sk_element *e) {
    sk_wide below = SK_ISA(weight)(e) + e->soft;
    if (e->divided) below = e->divisor * below;
    sk_wide s = SK_ISA(sk_keep)(SK_ISA(sk_positive)(below), -e->value / below);
    SK_EACH_PARTICLE (i) e->scale[i] = s * e->w[i];
}

SK_INLINE void SK_ISA(project_damped)(sk_element *e, const sk_element_constants *c) {
    sk_wide3 moved[SK_ARITY];
    SK_EACH_PARTICLE (i)
        moved[i] = (sk_wide3){e->x[i].x - e->other[i].x, e->x[i].y - e->other[i].y, e->x[i].z - e->other[i].z};
    sk_wide inverse = e->divided ? SK_ISA(inverse_divisor)(e) : SK_ISA(sk_splat)(1);
    sk_wide below = (1 + c->gamma) * SK_ISA(weight)(e) + e->soft;
    // a multiplier of 0 against an infinite compliance is nothing
    sk_wide held = SK_ISA(sk_keep)(SK_ISA(sk_differ)(e->multiplier, (sk_wide){0}), e->soft * e->multiplier);
    sk_wide above = -e->value - held - c->gamma * (SK_ISA(along)(e, moved) * inverse);
    sk_wide change = SK_ISA(sk_keep)(SK_ISA(sk_positive)(below), above / below);
    e->multiplier += change;
    sk_wide s = e->divided ? change * inverse : change;
    SK_EACH_PARTICLE (i) e->scale[i] = s * e->w[i];
}

/* Back to the bound, as if rigid there. Lanes without an element have a rest value of 0: for them any is right. */
SK_INLINE void SK_ISA(limit)(sk_element *e, const sk_element_constants *c, bool moving) {
    sk_wide weight = SK_ISA(weight)(e), most = c->bound * e->rest[0], below = weight;
    if (e->divided) below = e->divisor * weight;
    sk_mask over = SK_ISA(sk_more)(e->value, most) & SK_ISA(sk_positive)(below) & SK_ISA(sk_positive)(e->rest[0]);
    sk_wide s = SK_ISA(sk_keep)(over, (most - e->value) / below);
    SK_EACH_PARTICLE (i) e->scale[i] = s * e->w[i];
    if (!moving) return;
    sk_wide parting = SK_ISA(along)(e, e->other), square = e->divided ? e->divisor * below : weight;
    sk_wide stop = SK_ISA(sk_keep)(over & SK_ISA(sk_positive)(parting), -parting / square);
    SK_EACH_PARTICLE (i) e->velocity_scale[i] = stop * e->w[i];
}

SK_INLINE void SK_ISA(work_out)(sk_element *e, const sk_element_constants *c, sk_element_mode mode) {
    e->divided = e->opposite = false;
    SK_ISA(formula)(e);
    if (mode == SK_MODE_FORCE) SK_ISA(pull)(e, c);
    else if (mode == SK_MODE_PROJECT) SK_ISA(project)(e);
    else if (mode == SK_MODE_PROJECT_DAMPED) SK_ISA(project_damped)(e, c);
    else SK_ISA(limit)(e, c, mode == SK_MODE_LIMIT_MOVING);
}

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
