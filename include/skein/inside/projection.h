/* From a constraint's value and gradient to what its particles get: a force, or a move of PBD and XPBD. The one place where
 * this is said: for the library's own kinds (src/constraints/element_arithmetic.h), for texts on tapes (formula.c) and for
 * texts that are compiled (compiled_formula.h). Whoever includes it has wide.h, and says how many particles an element has
 * (SK_ARITY), and how many rest values (SK_RESTS); or SK_ARITY as the most that there may be, SK_ARITY_OF(element), and
 * SK_READS(element, particle).
 *
 *     force       -(k C + c dC/dt) grad C
 *     move        w dl grad C, with dl = -C / (sum of w |grad C|^2 + a), a = 1/(k h^2)
 *     damped      dl = (-C - a l - g dC) / ((1 + g) sum of w |grad C|^2 + a), g = c/(k h), with dC what the move since the
 *                 substep's start changes C by, and l the sum of all dl in the substep
 *
 * (Macklin, Mueller, Chentanez: XPBD, 2016, with g in place of its gamma.) An energy E is the constraint C = sqrt(2 E)
 * without ever dividing by the root: C^2 takes part in place of C, so that where E and its gradient are 0, so is the move.
 * A one-sided constraint only ever pushes. An infinite compliance times 0 is nothing, and so is what has no weight. */

#ifndef SK_ARITY_OF
#define SK_ARITY_OF(e) SK_ARITY
#define SK_READS(e, i) true
#endif

/* Loops over an element's particles; unrolled, so that what they fill stays in registers. */
#ifdef __clang__
#define SK_UNROLLED
#else
#define SK_UNROLLED _Pragma("GCC unroll 8")
#endif
#define SK_EACH_PARTICLE_OF(e, i) SK_UNROLLED for (int i = 0; i < SK_ARITY_OF(e); i++)
#define SK_EACH_PARTICLE(i) SK_EACH_PARTICLE_OF (NULL, i) /* where their number is known */

typedef enum sk_element_mode {
    SK_MODE_FORCE,
    SK_MODE_APPLY, /* the matrix of an implicit solve times a direction */
    SK_MODE_PROJECT,
    SK_MODE_PROJECT_KEPT,   /* with multipliers that are kept from pass to pass */
    SK_MODE_PROJECT_DAMPED, /* and with damping */
    SK_MODE_LIMIT,
    SK_MODE_LIMIT_MOVING
} sk_element_mode;

/* What a mode reads and writes besides positions. Several sweeps a substep keep multipliers, and most are not damped: where
 * particles were is then not asked for (a jelly of 20^3 takes 0.58 ms instead of 0.74, with AVX2 0.85 for 1.16, with SSE, which has
 * no registers for it, 1.6 for 2.55). */
SK_INLINE bool keeps_multiplier(sk_element_mode mode) {
    return mode == SK_MODE_PROJECT_KEPT || mode == SK_MODE_PROJECT_DAMPED;
}
SK_INLINE bool positions_are_enough(sk_element_mode mode) {
    return mode == SK_MODE_PROJECT || mode == SK_MODE_PROJECT_KEPT || mode == SK_MODE_LIMIT;
}

/* What the formula leaves is its value, and its gradient G / divisor. Most kinds have no divisor; that of a distance
 * is its length, so that one division serves the direction and the multiplier. */
typedef struct sk_element {
    sk_wide3 x[SK_ARITY];
    sk_wide w[SK_ARITY];      /* inverse masses */
    sk_wide3 other[SK_ARITY]; /* velocities; of damped projection the positions at the substep's start; a direction */
    sk_wide rest[SK_RESTS + !SK_RESTS], stiffness, multiplier;
    sk_wide soft;                    /* 1/(k h^2) */
    sk_wide value, divisor, by_time; /* of C, or of an energy E */
    sk_wide3 gradient[SK_ARITY];     /* G */
    bool divided, opposite;          /* there is a divisor, and G / divisor has length 1; G of the second is minus the
                                         first's. Constants, once all is inlined. */
    bool judged, timed, is_energy, one_sided; /* texts' alone, else false: there is `active`; there is `by_time` */
    int arity;                                /* of a text, which need not read every particle */
    bool reads[SK_ARITY];
    sk_mask active;                   /* finite, and not on the free side */
    sk_wide scale[SK_ARITY];          /* what comes out, a force or a move, is scale G */
    sk_wide velocity_scale[SK_ARITY]; /* likewise of velocity, from a limit that moves */
    sk_mask over;                     /* a limit: the lanes that are over it, which alone move */
    sk_wide3 across;                  /* of a kind with SK_ACROSS: what is applied besides, to the first */
} sk_element;

/* What is the same for all elements of a row. */
typedef struct sk_element_constants {
    real damping_time;  /* c/k, s */
    real per_step;      /* 1/h^2, times the projections that share the stiffness */
    real gamma;         /* c/(k h) */
    real step;          /* h, s */
    real bound;         /* of the relative violation */
    real elastic, both; /* of an implicit solve: the stiffness counts so many times, alone and with its damping */
} sk_element_constants;

/* G . u of all particles. */
SK_INLINE sk_wide sum_along(const sk_element *e, const sk_wide3 *u) {
    if (e->opposite) {
        sk_wide3 d = {u[0].x - u[1].x, u[0].y - u[1].y, u[0].z - u[1].z};
        return sk_dot_wide(e->gradient[0], d);
    }
    sk_wide sum = sk_dot_wide(e->gradient[0], u[0]);
    SK_EACH_PARTICLE_OF (e, i) sum = i ? sum + sk_dot_wide(e->gradient[i], u[i]) : sum;
    return sum;
}

/* 1/divisor. Where it is 0 the gradient has no direction: there is no force, and no NaN. */
SK_INLINE sk_wide inverse_divisor(const sk_element *e) {
    return sk_keep(sk_positive(e->divisor), 1 / e->divisor);
}

/* The sum of w |gradient|^2. */
SK_INLINE sk_wide weight_of(const sk_element *e) {
    sk_wide sum = {0};
    SK_EACH_PARTICLE_OF (e, i) {
        sk_wide one = e->divided ? e->w[i] : e->w[i] * sk_dot_wide(e->gradient[i], e->gradient[i]);
        sum = i ? sum + one : one;
    }
    return sum;
}

/* What of a text is not finite gets 0s, and is not active; nor is what is on the free side. Where the sum of w |gradient|^2
 * (if there is `w`) and the value are far from what a number can hold, all are finite, and no sum of all is needed. */
SK_INLINE void judge(sk_element *e, bool weighed) {
    e->active = ~(sk_mask){0};
    bool small = false;
    if (weighed) {
        sk_wide size = weight_of(e) + sk_wide_abs(e->value) + sk_wide_abs(e->by_time);
        small = sk_more_bits(sk_splat((real)1e30), size) == (1u << SK_PART) - 1;
    }
    if (!small) {
        sk_wide sum = e->value;
        SK_EACH_PARTICLE_OF (e, i) sum += e->gradient[i].x, sum += e->gradient[i].y, sum += e->gradient[i].z;
        sum += e->by_time;
        e->active = ~sk_differ(sum - sum, (sk_wide){0}); // infinities and NaN go through sums
        e->value = sk_keep(e->active, e->value), e->by_time = sk_keep(e->active, e->by_time);
        SK_EACH_PARTICLE_OF (e, i) {
            sk_wide3 g = e->gradient[i];
            e->gradient[i] = (sk_wide3){sk_keep(e->active, g.x), sk_keep(e->active, g.y), sk_keep(e->active, g.z)};
        }
    }
    if (e->one_sided) e->active &= sk_negative(e->value);
}

/* The value's change by velocities, in a second, or by moves in `step`. */
SK_INLINE sk_wide change_by(const sk_element *e, const sk_wide3 *u, real step) {
    sk_wide change = sum_along(e, u);
    if (e->divided) change = change * inverse_divisor(e);
    if (e->timed) change = change + step * e->by_time;
    return change;
}

/* An energy's C^2, and its compliance in proportion. */
SK_INLINE sk_wide square_of(const sk_element *e) {
    return sk_keep(sk_positive(e->value), 2 * e->value);
}
SK_INLINE sk_wide soft_of(const sk_element *e, sk_wide square) {
    return sk_keep(sk_positive(square), e->soft * square);
}

SK_INLINE sk_wide only_active(const sk_element *e, sk_mask active, sk_wide a) {
    return e->judged ? sk_keep(active, a) : a;
}

SK_INLINE sk_wide pull(const sk_element *e, const sk_element_constants *c) {
    if (e->is_energy) return sk_keep(e->active, -e->stiffness);
    sk_wide push = e->stiffness * (-e->value - c->damping_time * change_by(e, e->other, 1));
    if (e->divided) push = push * inverse_divisor(e);
    return only_active(e, e->active, push);
}

/* above / below, of which a kind with SK_MOST_CHANGE takes no more than would change C by that (which has no divisor then): a
 * gradient says nothing about where it leads after more. */
SK_INLINE sk_wide multiplier_of(sk_wide above, sk_wide weight, sk_wide below) {
#ifdef SK_MOST_CHANGE
    sk_wide most = sk_splat((real)SK_MOST_CHANGE);
    sk_mask over = sk_more(sk_wide_abs(above) * weight, most * below);
    above = sk_select(over, sk_select(sk_negative(above), -most, most), above);
    below = sk_select(over, weight, below);
#else
    (void)weight;
#endif
    return sk_keep(sk_positive(below), above / below);
}

SK_INLINE sk_wide project(const sk_element *e) {
    sk_wide above = -e->value, weight = weight_of(e), below = weight;
    if (e->is_energy) {
        sk_wide square = square_of(e);
        above = -square, below = below + soft_of(e, square);
    } else {
        below = below + e->soft;
    }
    if (e->divided) below = e->divisor * below;
    return only_active(e, e->active, multiplier_of(above, weight, below));
}

/* The multiplier is kept up to date. */
SK_INLINE sk_wide project_kept(sk_element *e, const sk_element_constants *c, sk_element_mode mode) {
    sk_wide held = sk_keep(sk_differ(e->multiplier, (sk_wide){0}), e->soft * e->multiplier), weight = weight_of(e);
    if (e->is_energy) {
        sk_wide square = square_of(e), root = sk_wide_sqrt(square), below = weight + soft_of(e, square);
        sk_wide s = sk_keep(e->active & sk_positive(below), root * (-root - held) / below);
        e->multiplier += root * s;
        return s;
    }
    sk_wide below = weight + e->soft, above = -e->value - held;
    if (mode == SK_MODE_PROJECT_DAMPED) {
        sk_wide3 moved[SK_ARITY];
        SK_EACH_PARTICLE_OF (e, i)
            moved[i] = (sk_wide3){e->x[i].x - e->other[i].x, e->x[i].y - e->other[i].y, e->x[i].z - e->other[i].z};
        below = (1 + c->gamma) * weight + e->soft;
        above -= c->gamma * change_by(e, moved, c->step);
    }
    sk_wide change = multiplier_of(above, weight, below);
    change = only_active(e, e->one_sided ? e->active | sk_positive(e->multiplier) : e->active, change);
    if (e->one_sided) change = sk_select(sk_negative(e->multiplier + change), -e->multiplier, change);
    e->multiplier += change;
    return e->divided ? change * inverse_divisor(e) : change;
}

/* Each particle gets `scale` G. */
SK_INLINE void answer(sk_element *e, const sk_element_constants *c, sk_element_mode mode) {
    sk_wide s = mode == SK_MODE_FORCE ? pull(e, c) : mode == SK_MODE_PROJECT ? project(e) : project_kept(e, c, mode);
    SK_EACH_PARTICLE_OF (e, i) e->scale[i] = mode == SK_MODE_FORCE ? s : s * e->w[i];
}

/* ---- what comes of it ---- */

/* scale G, without the sign that the second of two opposite gradients has; that is in `with_sign`. */
SK_INLINE sk_wide3 moved(const sk_element *e, const sk_wide *scale, int i) {
    sk_wide3 g = e->gradient[i];
    if (e->opposite) g = e->gradient[0]; // (by its address clang would keep the element in memory)
    return (sk_wide3){scale[i] * g.x, scale[i] * g.y, scale[i] * g.z};
}
SK_INLINE sk_wide3 with_sign(const sk_element *e, int i, sk_wide3 a, sk_wide3 d) {
    if (e->opposite && i) return (sk_wide3){a.x - d.x, a.y - d.y, a.z - d.z};
    return (sk_wide3){a.x + d.x, a.y + d.y, a.z + d.z};
}

/* Where a particle comes to, from a. Limits leave lanes as they are that are within, as if nobody had asked. */
SK_INLINE sk_wide3 put(const sk_element *e, int i, sk_wide3 a, const sk_wide *scale, sk_element_mode mode) {
    sk_wide3 to = with_sign(e, i, a, moved(e, scale, i));
    if (mode != SK_MODE_LIMIT && mode != SK_MODE_LIMIT_MOVING) return to;
    return (sk_wide3){sk_select(e->over, to.x, a.x), sk_select(e->over, to.y, a.y), sk_select(e->over, to.z, a.z)};
}

/* What a sum gets: the second of two opposite gradients has the sign in `with_sign`. */
SK_INLINE sk_wide3 given(const sk_element *e, int i, sk_element_mode mode) {
    sk_wide3 d = moved(e, e->scale, i);
#ifdef SK_ACROSS
    if (mode == SK_MODE_APPLY) d = (sk_wide3){d.x + e->across.x, d.y + e->across.y, d.z + e->across.z};
#endif
    (void)mode;
    return d;
}
