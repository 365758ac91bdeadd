/* The arithmetic of an implicit solve on whole vectors: one pass each, over any range of blocks. */
#include "plan/solve.h"

#include "base/kernels.h"

#define SK_UNIT solve
SK_KERNELS(sk_op_kernel, open);
SK_KERNELS(sk_op_kernel, guess);
SK_KERNELS(sk_op_kernel, along);
SK_KERNELS(sk_op_kernel, imbalance);
SK_KERNELS(sk_op_kernel, norm);
SK_KERNELS(sk_op_kernel, mass);
SK_KERNELS(sk_op_kernel, factor);
SK_KERNELS(sk_op_kernel, direction);
SK_KERNELS(sk_op_kernel, curvature);
SK_KERNELS(sk_op_kernel, step);
SK_KERNELS(sk_op_kernel, precondition);

/* A block's two partial sums. */
static inline double *sums_of(const sk_run *run, size_t block) {
    return (double *)(void *)run->vector[SK_SUMS] + 2 * block;
}

#ifdef SK_ISA

SK_INLINE sk_wide4 load(const sk_run *run, const sk_op *op, int vector, size_t slot) {
    return sk_load_part(run->vector[vector], slot, slot < op->packed);
}

SK_INLINE sk_wide3 load3(const sk_run *run, const sk_op *op, int vector, size_t slot) {
    sk_wide4 a = load(run, op, vector, slot);
    return (sk_wide3){a.x, a.y, a.z};
}

/* Writes x, y and z of a part; w keeps its value. */
SK_INLINE void store(sk_run *run, const sk_op *op, int vector, size_t slot, sk_wide3 a) {
    bool packed = slot < op->packed;
    sk_wide w = packed ? a.x : load(run, op, vector, slot).w;
    sk_store_moved(run->vector[vector], slot, packed, (sk_wide4){a.x, a.y, a.z, w});
}

/* a + s b */
SK_INLINE sk_wide3 plus(sk_wide3 a, real s, sk_wide3 b) {
    return (sk_wide3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

SK_INLINE sk_wide3 filtered(const sk_run *run, const sk_op *op, size_t slot, sk_wide3 p) {
    sk_wide3 d = load3(run, op, SK_FILTER0, slot), o = load3(run, op, SK_FILTER1, slot);
    return (sk_wide3){d.x * p.x + o.x * p.y + o.y * p.z, o.x * p.x + d.y * p.y + o.z * p.z,
                      o.y * p.x + o.z * p.y + d.z * p.z};
}

/* Adds a part's values to four sums, lane by lane, and stores the sum of all sixteen lanes when the block ends. */
SK_INLINE void leave(sk_run *run, size_t slot, sk_wide value, double sum[4], int which) {
    size_t lane = slot % SK_LANES;
    for (size_t k = 0; k < 4 && !lane; k++) sum[k] = 0;
    for (size_t l = 0; l < SK_PART; l++) sum[(lane + l) % 4] += (double)value[l];
    if (lane + SK_PART == SK_LANES) sums_of(run, slot / SK_LANES)[which] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

#define FOR_PARTS for (size_t slot = begin; slot < end; slot += SK_PART)

void SK_KERNEL(open)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    FOR_PARTS {
        sk_wide one = sk_keep(sk_positive(load(run, op, SK_X, slot).w), sk_splat(1)), none = {0};
        store(run, op, SK_FILTER0, slot, (sk_wide3){one, one, one});
        store(run, op, SK_FILTER1, slot, (sk_wide3){none, none, none});
    }
}

void SK_KERNEL(guess)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    FOR_PARTS {
        sk_wide3 v = load3(run, op, SK_V0, slot), change = filtered(run, op, slot, v), rest = plus(v, -1, change);
        store(run, op, SK_CHANGE, slot, change);
        store(run, op, SK_GUESS, slot, rest);
        store(run, op, SK_V, slot, rest);
    }
}

void SK_KERNEL(along)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    real s = (real)run->solve->scale;
    FOR_PARTS {
        sk_wide3 guess = load3(run, op, SK_GUESS, slot), change = load3(run, op, SK_CHANGE, slot);
        store(run, op, SK_V, slot, plus(guess, s, change));
    }
}

void SK_KERNEL(imbalance)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    double sum[4];
    real h = (real)op->dt;
    FOR_PARTS {
        sk_wide4 v = load(run, op, SK_V, slot);
        sk_wide3 f = load3(run, op, SK_F, slot), rub = load3(run, op, SK_FRICTION, slot);
        sk_wide3 v0 = load3(run, op, SK_V0, slot), change = load3(run, op, SK_CHANGE, slot);
        sk_wide3 r = {(h * f.x + h * rub.x) + v.w * (v0.x - v.x), (h * f.y + h * rub.y) + v.w * (v0.y - v.y),
                      (h * f.z + h * rub.z) + v.w * (v0.z - v.z)};
        r = filtered(run, op, slot, r);
        store(run, op, SK_RESIDUAL, slot, r);
        leave(run, slot, sk_dot_wide(r, change), sum, 0);
    }
}

void SK_KERNEL(norm)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    double sum[4];
    FOR_PARTS {
        sk_wide3 p = load3(run, op, (int)op->source[0], slot);
        leave(run, slot, load(run, op, SK_X, slot).w * sk_dot_wide(p, p), sum, 1);
    }
}

void SK_KERNEL(mass)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    FOR_PARTS {
        sk_wide m = load(run, op, SK_V, slot).w;
        store(run, op, (int)op->dst, slot, (sk_wide3){m, m, m});
    }
}

SK_INLINE sk_wide at_least(sk_wide a, sk_wide least) {
    return sk_select(sk_more(a, least), a, least);
}

/* 1/a, and 0 for slots without a particle. */
SK_INLINE sk_wide inverse(sk_wide a) {
    return sk_keep(sk_positive(a), 1 / a);
}

/* The R w R that rounding alone may cause: positions are rounded by their size times epsilon, which springs turn into
 * forces; velocities and forces are rounded themselves. */
SK_INLINE sk_wide rounding(const sk_run *run, const sk_op *op, size_t slot, sk_wide springs, sk_wide inertia) {
    const real epsilon = (real)(sizeof(real) == sizeof(double) ? 1e-16 : 5e-8), h = (real)op->dt;
    sk_wide4 x = load(run, op, SK_X, slot);
    sk_wide3 v = load3(run, op, SK_V, slot), f = load3(run, op, SK_F, slot), p = {x.x, x.y, x.z};
    sk_wide far = sk_dot_wide(p, p), fast = sk_dot_wide(v, v), strong = sk_dot_wide(f, f);
    sk_wide square = far * springs * springs + fast * inertia * inertia + h * h * strong;
    return epsilon * epsilon * (x.w * square);
}

/* L D L^T with unit lower triangular L: writes 1/D to the first vector, and l21 l31 l32 to the second. */
void SK_KERNEL(factor)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    double sum[4];
    FOR_PARTS {
        sk_wide3 d = load3(run, op, SK_BLOCK0, slot), o = load3(run, op, SK_BLOCK1, slot);
        sk_wide least = load(run, op, SK_INERTIA, slot).x;
        leave(run, slot, rounding(run, op, slot, (d.x + d.y + d.z - 3 * least) / (real)op->dt, least), sum, 0);
        sk_wide i1 = inverse(at_least(d.x, least));
        sk_wide l21 = o.x * i1, l31 = o.y * i1;
        sk_wide i2 = inverse(at_least(d.y - l21 * o.x, least));
        sk_wide u = o.z - l31 * o.x, l32 = u * i2;
        sk_wide i3 = inverse(at_least(d.z - l31 * o.y - l32 * u, least));
        store(run, op, SK_BLOCK0, slot, (sk_wide3){i1, i2, i3});
        store(run, op, SK_BLOCK1, slot, (sk_wide3){l21, l31, l32});
    }
}

void SK_KERNEL(direction)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    real s = (real)run->solve->scale;
    bool first = run->solve->scale == 0;
    FOR_PARTS {
        sk_wide3 p = load3(run, op, SK_PRODUCT, slot), m = load3(run, op, SK_INERTIA, slot);
        if (!first) p = plus(p, s, load3(run, op, SK_DIRECTION, slot));
        store(run, op, SK_DIRECTION, slot, p);
        store(run, op, SK_PRODUCT, slot, (sk_wide3){m.x * p.x, m.y * p.y, m.z * p.z});
    }
}

void SK_KERNEL(curvature)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    double sum[4];
    FOR_PARTS {
        sk_wide3 q = filtered(run, op, slot, load3(run, op, SK_PRODUCT, slot));
        store(run, op, SK_PRODUCT, slot, q);
        leave(run, slot, sk_dot_wide(load3(run, op, SK_DIRECTION, slot), q), sum, 0);
    }
}

void SK_KERNEL(step)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    real s = (real)run->solve->scale;
    FOR_PARTS {
        sk_wide3 change = load3(run, op, SK_CHANGE, slot), r = load3(run, op, SK_RESIDUAL, slot);
        store(run, op, SK_CHANGE, slot, plus(change, s, load3(run, op, SK_DIRECTION, slot)));
        store(run, op, SK_RESIDUAL, slot, plus(r, -s, load3(run, op, SK_PRODUCT, slot)));
    }
}

/* BLOCK^-1 r, from the block's factors. */
SK_INLINE sk_wide3 by_block(const sk_run *run, const sk_op *op, size_t slot, sk_wide3 r) {
    sk_wide3 i = load3(run, op, SK_BLOCK0, slot), l = load3(run, op, SK_BLOCK1, slot);
    sk_wide y2 = r.y - l.x * r.x, y3 = r.z - l.y * r.x - l.z * y2;
    sk_wide z = y3 * i.z, y = y2 * i.y - l.z * z;
    return (sk_wide3){r.x * i.x - l.x * y - l.y * z, y, z};
}

void SK_KERNEL(precondition)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    double sum[4];
    bool factored = run->solve->factored;
    FOR_PARTS {
        sk_wide3 r = load3(run, op, SK_RESIDUAL, slot);
        sk_wide3 z = factored ? load3(run, op, SK_PRODUCT, slot) : by_block(run, op, slot, r);
        z = filtered(run, op, slot, z);
        store(run, op, SK_PRODUCT, slot, z);
        leave(run, slot, sk_dot_wide(r, z), sum, 0);
    }
}
#undef FOR_PARTS

#else

const sk_kernels sk_solve_open = {SK_EACH_ISA(open)};
const sk_kernels sk_solve_guess = {SK_EACH_ISA(guess)};
const sk_kernels sk_solve_along = {SK_EACH_ISA(along)};
const sk_kernels sk_solve_imbalance = {SK_EACH_ISA(imbalance)};
const sk_kernels sk_solve_norm = {SK_EACH_ISA(norm)};
const sk_kernels sk_solve_mass = {SK_EACH_ISA(mass)};
const sk_kernels sk_solve_factor = {SK_EACH_ISA(factor)};
const sk_kernels sk_solve_direction = {SK_EACH_ISA(direction)};
const sk_kernels sk_solve_curvature = {SK_EACH_ISA(curvature)};
const sk_kernels sk_solve_step = {SK_EACH_ISA(step)};
const sk_kernels sk_solve_precondition = {SK_EACH_ISA(precondition)};

double sk_solve_sum(const sk_run *run, int which) {
    enum { RUN = 64 }; /* blocks that have a partial sum of their own */
    double all = 0;
    size_t count = run->slot_count / SK_LANES;
    for (size_t first = 0; first < count; first += RUN) {
        double sum = 0;
        for (size_t i = first; i < count && i < first + RUN; i++) sum += sums_of(run, i)[which];
        all += sum;
    }
    return all;
}
#endif
