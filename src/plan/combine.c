/* Kernels: arithmetic on whole state vectors, and converting their blocks between quads and packed layout. */
#include "base/kernels.h"
#include "plan/op.h"

#define SK_UNIT combine
SK_KERNELS(sk_op_kernel, sum);
SK_KERNELS(sk_op_kernel, correction);
SK_KERNELS(sk_op_kernel, kick);
SK_KERNELS(sk_op_kernel, wipe);
SK_KERNELS(sk_op_kernel, steer);
SK_KERNELS(sk_op_kernel, lead);
SK_KERNELS(sk_op_kernel, predict);
SK_KERNELS(sk_op_kernel, pull);
SK_KERNELS(sk_op_kernel, predict_uniform);
SK_KERNELS(sk_op_kernel, correct_and_predict);
SK_KERNELS(sk_op_kernel, rest);
SK_KERNELS(sk_op_kernel, pack);
SK_KERNELS(sk_op_kernel, unpack);

#ifdef SK_ISA

/* The lanes of part `at` of a row of quads that hold no w (every fourth lane is one). */
SK_INLINE sk_mask without_w(size_t at) {
    static const SK_VECTOR_ALIGNED sk_lane_int xyz[SK_LANES] = {-1, -1, -1, 0, -1, -1, -1, 0,
                                                                -1, -1, -1, 0, -1, -1, -1, 0};
    return ((const sk_mask *)(const void *)xyz)[at % SK_PARTS];
}

/* Sets dst[at] to VALUE, an expression in the vectors' parts [at], over the blocks of [begin, end). Components w keep
 * their values: packed blocks have a row for each component, quads are masked. */
#define FOR_PARTS(VALUE)                                                             \
    for (size_t slot = begin; slot < end; slot += SK_LANES) {                        \
        size_t at = slot * 4 / SK_PART;                                              \
        if (slot < op->packed)                                                       \
            for (int part = 0; part < 3 * SK_PARTS; part++, at++) dst[at] = (VALUE); \
        else                                                                         \
            for (int part = 0; part < 4 * SK_PARTS; part++, at++)                    \
                dst[at] = sk_select(without_w(at), (VALUE), dst[at]);                \
    }

void SK_KERNEL(sum)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_wide *dst = (sk_wide *)(void *)run->vector[op->dst];
    const sk_wide *p = (const sk_wide *)(const void *)run->vector[op->source[0]];
    const sk_wide *q = (const sk_wide *)(const void *)run->vector[op->source[1]];
    const sk_wide *r = (const sk_wide *)(const void *)run->vector[op->source[2]];
    sk_wide a = sk_splat((real)op->coefficient[0]), b = sk_splat((real)op->coefficient[1]);
    sk_wide c = sk_splat((real)op->coefficient[2]);
    if (op->source[0] == SK_NONE) FOR_PARTS((sk_wide){0})
    else if (op->source[1] == SK_NONE) FOR_PARTS(a * p[at])
    else if (op->source[2] == SK_NONE) FOR_PARTS(a * p[at] + b * q[at])
    else FOR_PARTS(a * p[at] + b * q[at] + c * r[at])
}

void SK_KERNEL(correction)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_wide *dst = (sk_wide *)(void *)run->vector[op->dst];
    const sk_wide *p = (const sk_wide *)(const void *)run->vector[op->source[0]];
    const sk_wide *q = (const sk_wide *)(const void *)run->vector[op->source[1]];
    real a = (real)op->coefficient[0], b = (real)op->coefficient[1];
    // the same operations that predicted p, so that a p that nothing has moved since gives exactly 0
    if (b == 0) FOR_PARTS(dst[at] + a * (p[at] - q[at]))
    else FOR_PARTS(dst[at] + a * (p[at] - (q[at] + b * dst[at])))
}

void SK_KERNEL(kick)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    real a = (real)op->coefficient[0];
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 p = sk_load_part(run->vector[op->source[0]], slot, packed),
                 q = sk_load_part(run->vector[op->source[1]], slot, packed);
        sk_wide k = a * sk_load_part(run->vector[SK_X], slot, packed).w;
        p.x += k * q.x, p.y += k * q.y, p.z += k * q.z;
        if (op->dst != op->source[0]) p.w = sk_load_part(run->vector[op->dst], slot, packed).w;
        sk_store_part(run->vector[op->dst], slot, packed, p);
    }
}

void SK_KERNEL(wipe)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    memset(run->vector[op->dst] + begin, 0, (end - begin) * sizeof(sk_vec4));
}

void SK_KERNEL(steer)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 v = sk_load_part(run->vector[op->dst], slot, packed),
                 s = sk_load_part(run->vector[op->source[1]], slot, packed);
        sk_mask free = sk_positive(sk_load_part(run->vector[SK_X], slot, packed).w);
        v.x += sk_keep(free, s.x), v.y += sk_keep(free, s.y), v.z += sk_keep(free, s.z);
        sk_store_moved(run->vector[op->dst], slot, packed, v);
    }
}

/* dst += a q, where the inverse mass is 0. */
void SK_KERNEL(lead)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    real a = (real)op->coefficient[0];
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 x = sk_load_part(run->vector[op->dst], slot, packed),
                 v = sk_load_part(run->vector[op->source[1]], slot, packed);
        sk_wide k = sk_keep(~sk_positive(x.w), sk_splat(a));
        x.x += k * v.x, x.y += k * v.y, x.z += k * v.z;
        sk_store_part(run->vector[op->dst], slot, packed, x);
    }
}

/* The start of a position method's substep in one pass, given the new velocity v: V = v, V0 = V, X0 = X, X += h V;
 * or X0 = X + h V where only the correction reads X0. */
SK_INLINE void set_out(sk_run *run, const sk_op *op, size_t slot, bool packed, sk_wide4 x, sk_wide4 v) {
    real h = (real)op->dt;
    sk_store_moved(run->vector[SK_V], slot, packed, v);
    if (op->source[2] == SK_V0) sk_store_moved(run->vector[SK_V0], slot, packed, v);
    if (op->source[2] != SK_X) sk_store_moved(run->vector[SK_X0], slot, packed, x);
    x.x += h * v.x, x.y += h * v.y, x.z += h * v.z;
    sk_store_moved(run->vector[SK_X], slot, packed, x);
    if (op->source[2] == SK_X) sk_store_moved(run->vector[SK_X0], slot, packed, x);
}

void SK_KERNEL(predict)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed), v = sk_load_part(run->vector[SK_V], slot, packed),
                 f = sk_load_part(run->vector[SK_F], slot, packed);
        sk_wide k = (real)op->dt * x.w;
        v.x += k * f.x, v.y += k * f.y, v.z += k * f.z;
        set_out(run, op, slot, packed, x, v);
    }
}

/* A uniform force, rounded to `real`, and the substep h through which it changes velocities. */
typedef struct uniform_pull {
    sk_vec3 a, f;
    real linear, rate, h;
    bool by_mass; /* all of it is proportional to mass, so that the mass cancels */
} uniform_pull;

SK_INLINE uniform_pull pull_of(const sk_op *op) {
    const sk_uniform_force *uniform = op->rule;
    uniform_pull p = {sk_v3_of(uniform->acceleration),
                      sk_v3_of(uniform->force),
                      (real)uniform->linear,
                      (real)uniform->rate,
                      (real)op->dt,
                      false};
    p.by_mass = p.linear == 0 && p.f.x == 0 && p.f.y == 0 && p.f.z == 0;
    return p;
}

SK_INLINE sk_wide4 pulled(const uniform_pull *p, sk_wide w, sk_wide4 v) {
    sk_wide k = sk_keep(sk_positive(w), sk_splat(p->h));
    if (p->by_mass) {
        v.x += k * (p->a.x - p->rate * v.x);
        v.y += k * (p->a.y - p->rate * v.y);
        v.z += k * (p->a.z - p->rate * v.z);
    } else {
        sk_wide drag = p->rate + p->linear * w;
        v.x += k * ((p->a.x + p->f.x * w) - drag * v.x);
        v.y += k * ((p->a.y + p->f.y * w) - drag * v.y);
        v.z += k * ((p->a.z + p->f.z * w) - drag * v.z);
    }
    return v;
}

void SK_KERNEL(pull)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    uniform_pull pull = pull_of(op);
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_store_moved(run->vector[SK_V], slot, packed,
                       pulled(&pull, sk_load_part(run->vector[SK_X], slot, packed).w, v));
    }
}

#ifdef SK_WHOLE_QUADS
/* Both uniform predictions over quads [begin, end) as they lie: converting them to x, y, z, w and back was most of the
 * work. If `corrects`, a (X - X0) is added to the velocity first; the `last` iteration does only that. Both flags are
 * constants where this is inlined: testing them for each vector took as long as half its arithmetic. */
SK_INLINE void predict_in_quads(sk_run *run, const sk_op *op, size_t begin, size_t end, real a, bool corrects,
                                bool last) {
    const bool saves_v = op->source[2] == SK_V0, saves_end = op->source[2] == SK_X;
    const uniform_pull p = pull_of(op);
    const sk_wide acceleration = sk_each_quad(p.a.x, p.a.y, p.a.z), force = sk_each_quad(p.f.x, p.f.y, p.f.z);
    sk_wide *x_of = (sk_wide *)(void *)run->vector[SK_X], *v_of = (sk_wide *)(void *)run->vector[SK_V],
            *x0_of = (sk_wide *)(void *)run->vector[SK_X0], *v0_of = (sk_wide *)(void *)run->vector[SK_V0];
    for (size_t i = begin * 4 / SK_PART; i < end * 4 / SK_PART; i++) {
        sk_wide x = x_of[i], v = v_of[i];
        if (corrects) v = sk_with_fourth(v + a * (x - x0_of[i]), v);
        if (!last) {
            sk_wide w = sk_fourth_of_each(x), k = sk_keep(sk_positive(w), sk_splat(p.h)), pull = acceleration,
                    drag = sk_splat(p.rate);
            if (!p.by_mass) pull = acceleration + force * w, drag = p.rate + p.linear * w;
            v = sk_with_fourth(v + k * (pull - drag * v), v);
        }
        v_of[i] = v;
        if (last) continue;
        sk_wide gone = sk_with_fourth(x + p.h * v, x);
        if (saves_v) v0_of[i] = v;
        x0_of[i] = saves_end ? gone : x;
        x_of[i] = gone;
    }
}
#endif

/* Where the slots that are handled part by part end: packed ones, or all where quads are not handled whole. */
SK_INLINE size_t end_of_packed(const sk_op *op, size_t begin, size_t end) {
#ifdef SK_WHOLE_QUADS
    size_t packed = op->packed < begin ? begin : op->packed;
    return packed < end ? packed : end;
#else
    (void)op, (void)begin;
    return end;
#endif
}

void SK_KERNEL(predict_uniform)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    uniform_pull pull = pull_of(op);
    size_t stop = end_of_packed(op, begin, end);
    for (size_t slot = begin; slot < stop; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed), v = sk_load_part(run->vector[SK_V], slot, packed);
        set_out(run, op, slot, packed, x, pulled(&pull, x.w, v));
    }
#ifdef SK_WHOLE_QUADS
    predict_in_quads(run, op, stop, end, 0, false, false);
#endif
}

void SK_KERNEL(correct_and_predict)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    uniform_pull pull = pull_of(op);
    real a = (real)op->coefficient[0];
    size_t stop = end_of_packed(op, begin, end);
    for (size_t slot = begin; slot < stop; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed), v = sk_load_part(run->vector[SK_V], slot, packed),
                 x0 = sk_load_part(run->vector[SK_X0], slot, packed);
        v.x += a * (x.x - x0.x), v.y += a * (x.y - x0.y), v.z += a * (x.z - x0.z);
        if (run->last_iteration) sk_store_moved(run->vector[SK_V], slot, packed, v);
        else set_out(run, op, slot, packed, x, pulled(&pull, x.w, v));
    }
#ifdef SK_WHOLE_QUADS
    if (run->last_iteration) predict_in_quads(run, op, stop, end, a, true, true);
    else predict_in_quads(run, op, stop, end, a, true, false);
#endif
}

/* Components of at most coefficient[0] become 0: too slow to be seen. NaN stays, and a zero keeps its sign. */
void SK_KERNEL(rest)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_wide *dst = (sk_wide *)(void *)run->vector[op->dst];
    const sk_wide least = sk_splat((real)op->coefficient[0]), zero = {0};
    FOR_PARTS(sk_select(sk_at_most(sk_wide_abs(dst[at]), least) & sk_differ(dst[at], zero), zero, dst[at]))
}
#undef FOR_PARTS

/* In place: each block is loaded whole before any of it is stored. */
SK_INLINE void change_layout(sk_vec4 *vector, size_t begin, size_t end, bool packed) {
    for (size_t slot = begin; slot < end; slot += SK_LANES) {
        sk_wide4 part[SK_PARTS];
        for (size_t i = 0; i < SK_PARTS; i++) part[i] = sk_load_part(vector, slot + i * SK_PART, !packed);
        for (size_t i = 0; i < SK_PARTS; i++) sk_store_part(vector, slot + i * SK_PART, packed, part[i]);
    }
}

void SK_KERNEL(pack)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    change_layout(run->vector[op->dst], begin, end, true);
}

void SK_KERNEL(unpack)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    change_layout(run->vector[op->dst], begin, end, false);
}

#else

const sk_kernels sk_combine_sum = {SK_EACH_ISA(sum)};
const sk_kernels sk_combine_correction = {SK_EACH_ISA(correction)};
const sk_kernels sk_combine_kick = {SK_EACH_ISA(kick)};
const sk_kernels sk_combine_wipe = {SK_EACH_ISA(wipe)};
const sk_kernels sk_combine_steer = {SK_EACH_ISA(steer)};
const sk_kernels sk_combine_lead = {SK_EACH_ISA(lead)};
const sk_kernels sk_combine_predict = {SK_EACH_ISA(predict)};
const sk_kernels sk_combine_pull = {SK_EACH_ISA(pull)};
const sk_kernels sk_combine_predict_uniform = {SK_EACH_ISA(predict_uniform)};
const sk_kernels sk_combine_correct_and_predict = {SK_EACH_ISA(correct_and_predict)};
const sk_kernels sk_combine_rest = {SK_EACH_ISA(rest)};
const sk_kernels sk_pack = {SK_EACH_ISA(pack)};
const sk_kernels sk_unpack = {SK_EACH_ISA(unpack)};
#endif
