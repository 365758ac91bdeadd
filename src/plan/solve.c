/* The arithmetic of an implicit solve: vectors, partial sums, and the decisions between them. */
#include "plan/solve.h"

#include <math.h>

#include "base/kernels.h"
#include "base/wide_types.h"

#define SK_UNIT solve
SK_KERNELS(sk_row_kernel, product);
SK_KERNELS(sk_row_kernel, mass);
SK_KERNELS(sk_row_kernel, momentum);
SK_KERNELS(sk_row_kernel, cell_sum);
SK_KERNELS(sk_row_kernel, filter);
SK_KERNELS(sk_row_kernel, open);
SK_KERNELS(sk_row_kernel, factor);
SK_KERNELS(sk_row_kernel, backsolve);
SK_KERNELS(sk_row_kernel, dot);
SK_KERNELS(sk_row_kernel, norm);
SK_KERNELS(sk_row_kernel, rounding);

#ifdef SK_ISA

SK_INLINE sk_wide4 load(const sk_run *run, const sk_row *row, int vector, size_t slot) {
    return sk_load_part(run->vector[vector], slot, slot < row->packed);
}

/* Writes x, y and z of a block; w is left as it is. */
SK_INLINE void store(sk_run *run, const sk_row *row, int vector, size_t slot, sk_wide x, sk_wide y, sk_wide z) {
    sk_wide4 old = load(run, row, vector, slot);
    sk_store_part(run->vector[vector], slot, slot < row->packed, (sk_wide4){x, y, z, old.w});
}

#define FOR_BLOCKS for (size_t slot = begin; slot < end; slot += SK_PART)

void SK_KERNEL(product)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    FOR_BLOCKS {
        sk_wide4 p = load(run, row, (int)row->source[0], slot), q = load(run, row, (int)row->source[1], slot);
        store(run, row, (int)row->dst, slot, p.x * q.x, p.y * q.y, p.z * q.z);
    }
}

void SK_KERNEL(mass)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    FOR_BLOCKS {
        sk_wide m = load(run, row, SK_V, slot).w;
        store(run, row, (int)row->dst, slot, m, m, m);
    }
}

void SK_KERNEL(momentum)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    FOR_BLOCKS {
        sk_wide4 p = load(run, row, (int)row->source[0], slot), q = load(run, row, (int)row->source[1], slot);
        sk_wide4 d = load(run, row, (int)row->dst, slot);
        sk_wide m = load(run, row, SK_V, slot).w;
        store(run, row, (int)row->dst, slot, d.x + m * (p.x - q.x), d.y + m * (p.y - q.y), d.z + m * (p.z - q.z));
    }
}

void SK_KERNEL(cell_sum)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    real a = (real)(row->coefficient[0] * run->cell[row->cell]);
    FOR_BLOCKS {
        sk_wide4 p = load(run, row, (int)row->source[0], slot), q = load(run, row, (int)row->source[1], slot);
        store(run, row, (int)row->dst, slot, p.x + a * q.x, p.y + a * q.y, p.z + a * q.z);
    }
}

void SK_KERNEL(filter)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    FOR_BLOCKS {
        sk_wide4 d = load(run, row, SK_FILTER0, slot), o = load(run, row, SK_FILTER1, slot);
        sk_wide4 p = load(run, row, (int)row->dst, slot);
        store(run, row, (int)row->dst, slot, d.x * p.x + o.x * p.y + o.y * p.z, o.x * p.x + d.y * p.y + o.z * p.z,
              o.y * p.x + o.z * p.y + d.z * p.z);
    }
}

void SK_KERNEL(open)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    FOR_BLOCKS {
        sk_mask is_free = sk_positive(load(run, row, SK_X, slot).w);
        sk_wide one = sk_keep(is_free, sk_splat(1)), none = {0};
        store(run, row, SK_FILTER0, slot, one, one, one);
        store(run, row, SK_FILTER1, slot, none, none, none);
    }
}

SK_INLINE sk_wide at_least(sk_wide a, sk_wide least) {
    return sk_select(sk_more(a, least), a, least);
}

/* 1/a, and 0 for slots without a particle. */
SK_INLINE sk_wide inverse(sk_wide a) {
    return sk_keep(sk_positive(a), 1 / a);
}

/* L D L^T, unit triangular L: 1/D in the first vector, l21 l31 l32 in the second. */
void SK_KERNEL(factor)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    FOR_BLOCKS {
        sk_wide4 d = load(run, row, SK_BLOCK0, slot), o = load(run, row, SK_BLOCK1, slot);
        sk_wide least = load(run, row, SK_INERTIA, slot).x;
        sk_wide i1 = inverse(at_least(d.x, least));
        sk_wide l21 = o.x * i1, l31 = o.y * i1;
        sk_wide i2 = inverse(at_least(d.y - l21 * o.x, least));
        sk_wide u = o.z - l31 * o.x, l32 = u * i2;
        sk_wide i3 = inverse(at_least(d.z - l31 * o.y - l32 * u, least));
        store(run, row, SK_BLOCK0, slot, i1, i2, i3);
        store(run, row, SK_BLOCK1, slot, l21, l31, l32);
    }
}

void SK_KERNEL(backsolve)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    FOR_BLOCKS {
        sk_wide4 i = load(run, row, SK_BLOCK0, slot), l = load(run, row, SK_BLOCK1, slot);
        sk_wide4 r = load(run, row, (int)row->source[0], slot);
        sk_wide y2 = r.y - l.x * r.x, y3 = r.z - l.y * r.x - l.z * y2;
        sk_wide z = y3 * i.z, y = y2 * i.y - l.z * z, x = r.x * i.x - l.x * y - l.y * z;
        store(run, row, (int)row->dst, slot, x, y, z);
    }
}

/* Adds a part's numbers to four sums, lane by lane, and leaves the sum of all sixteen when its block ends. */
SK_INLINE void leave(sk_run *run, size_t slot, sk_wide value, double sum[4]) {
    size_t lane = slot % SK_LANES;
    for (size_t k = 0; k < 4 && !lane; k++) sum[k] = 0;
    for (size_t l = 0; l < SK_PART; l++) sum[(lane + l) % 4] += (double)value[l];
    if (lane + SK_PART < SK_LANES) return;
    *(double *)(void *)(run->vector[SK_SUMS] + (slot - lane)) = (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

void SK_KERNEL(dot)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    double sum[4];
    FOR_BLOCKS {
        sk_wide4 p = load(run, row, (int)row->source[0], slot), q = load(run, row, (int)row->source[1], slot);
        leave(run, slot, p.x * q.x + p.y * q.y + p.z * q.z, sum);
    }
}

void SK_KERNEL(norm)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    double sum[4];
    FOR_BLOCKS {
        sk_wide4 p = load(run, row, (int)row->source[0], slot);
        sk_wide w = load(run, row, SK_X, slot).w;
        leave(run, slot, w * (p.x * p.x + p.y * p.y + p.z * p.z), sum);
    }
}

/* A position is rounded to its size times epsilon; the springs at it turn that into a force. Velocities and forces
 * are rounded themselves. */
void SK_KERNEL(rounding)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    double sum[4];
    real h = (real)row->dt, epsilon = (real)row->coefficient[0];
    FOR_BLOCKS {
        sk_wide4 x = load(run, row, SK_X, slot), v = load(run, row, SK_V, slot);
        sk_wide4 f = load(run, row, SK_F, slot), d = load(run, row, SK_BLOCK0, slot);
        sk_wide inertia = load(run, row, SK_INERTIA, slot).x;
        sk_wide far = x.x * x.x + x.y * x.y + x.z * x.z, fast = v.x * v.x + v.y * v.y + v.z * v.z;
        sk_wide strong = f.x * f.x + f.y * f.y + f.z * f.z, springs = (d.x + d.y + d.z - 3 * inertia) / h;
        sk_wide square = far * springs * springs + fast * inertia * inertia + h * h * strong;
        leave(run, slot, epsilon * epsilon * (x.w * square), sum);
    }
}
#undef FOR_BLOCKS

#else

const sk_kernels sk_solve_product = {SK_EACH_ISA(product)};
const sk_kernels sk_solve_mass = {SK_EACH_ISA(mass)};
const sk_kernels sk_solve_momentum = {SK_EACH_ISA(momentum)};
const sk_kernels sk_solve_cell_sum = {SK_EACH_ISA(cell_sum)};
const sk_kernels sk_solve_filter = {SK_EACH_ISA(filter)};
const sk_kernels sk_solve_open = {SK_EACH_ISA(open)};
const sk_kernels sk_solve_factor = {SK_EACH_ISA(factor)};
const sk_kernels sk_solve_backsolve = {SK_EACH_ISA(backsolve)};
const sk_kernels sk_solve_dot = {SK_EACH_ISA(dot)};
const sk_kernels sk_solve_norm = {SK_EACH_ISA(norm)};
const sk_kernels sk_solve_rounding = {SK_EACH_ISA(rounding)};

/* ---- scalars ---- */

double sk_solve_sum(const sk_run *run) {
    enum { BLOCK = 1024 };
    double all = 0;
    for (size_t first = 0; first < run->slot_count; first += BLOCK) {
        size_t last = first + BLOCK < run->slot_count ? first + BLOCK : run->slot_count;
        double sum = 0;
        for (size_t slot = first; slot < last; slot += SK_PART)
            sum += *(const double *)(const void *)(run->vector[SK_SUMS] + slot);
        all += sum;
    }
    return all;
}

static bool is_solved(const double *cell, double tolerance) {
    return cell[SK_CELL_PRESENT] <= tolerance * tolerance * cell[SK_CELL_START] ||
           cell[SK_CELL_PRESENT] <= cell[SK_CELL_ROUNDING];
}

/* A residual that is not finite cannot get better. */
static bool is_lost(double residual) {
    return !(residual <= SK_REAL_MAX);
}

void sk_solve_start(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row, (void)begin, (void)end;
    double *cell = run->cell;
    cell[SK_CELL_START] = sk_solve_sum(run);
    cell[SK_CELL_ROUNDING] = cell[SK_CELL_TURN] = cell[SK_CELL_SOLVED] = 0;
}

void sk_solve_line_start(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row, (void)begin, (void)end;
    run->cell[SK_CELL_SLOPE] = sk_solve_sum(run);
    run->cell[SK_CELL_SHARE] = 1;
    run->cell[SK_CELL_LINE_DONE] = 0;
}

/* One turn is always made, however small the residual: among it may be a weight that moves everything. */
void sk_solve_judge(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)begin, (void)end;
    double *cell = run->cell;
    cell[SK_CELL_PRESENT] = sk_solve_sum(run);
    bool solved = is_solved(cell, row->coefficient[0]) && (cell[SK_CELL_TURN] > 0 || cell[SK_CELL_PRESENT] <= 0);
    solved |= is_lost(cell[SK_CELL_PRESENT]);
    cell[SK_CELL_TURN]++;
    cell[SK_CELL_SOLVED] = solved;
    cell[SK_CELL_CG_DONE] = cell[SK_CELL_LINE_DONE] = 0;
    cell[SK_CELL_NEWTON_TURNS] += !solved;
}

void sk_solve_note_rounding(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row, (void)begin, (void)end;
    run->cell[SK_CELL_ROUNDING] = sk_solve_sum(run);
}

void sk_solve_cg_start(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row, (void)begin, (void)end;
    double *cell = run->cell;
    cell[SK_CELL_RZ] = sk_solve_sum(run);
    // what the first turn has to show is comparable in its own norm alone
    if (cell[SK_CELL_TURN] == 1 || cell[SK_CELL_IN_FACTOR] != cell[SK_CELL_FACTORED]) {
        cell[SK_CELL_RZ_START] = cell[SK_CELL_RZ];
        cell[SK_CELL_IN_FACTOR] = cell[SK_CELL_FACTORED];
    }
    cell[SK_CELL_SLOPE] = 0;
    cell[SK_CELL_SHARE] = 1;
    if (!(cell[SK_CELL_RZ] > 0)) cell[SK_CELL_CG_DONE] = 1;
}

void sk_solve_cg_alpha(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row, (void)begin, (void)end;
    double *cell = run->cell, curvature = sk_solve_sum(run);
    bool good = curvature > 0 && !is_lost(curvature);
    cell[SK_CELL_ALPHA] = good ? cell[SK_CELL_RZ] / curvature : 0;
    // every direction is as far from the first residual as from the present one
    cell[SK_CELL_SLOPE] += cell[SK_CELL_ALPHA] * cell[SK_CELL_RZ];
    cell[SK_CELL_CG_DONE] = !good;
}

void sk_solve_cg_beta(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)begin, (void)end;
    double *cell = run->cell, rz = sk_solve_sum(run), tolerance = row->coefficient[0];
    cell[SK_CELL_BETA] = rz / cell[SK_CELL_RZ];
    cell[SK_CELL_RZ] = rz;
    cell[SK_CELL_CG_TURNS]++;
    if (!(rz > tolerance * tolerance * cell[SK_CELL_RZ_START])) cell[SK_CELL_CG_DONE] = 1;
}

/* The potential whose minimum is sought falls along the change while R times the change is positive. Too far past
 * the minimum, the secant says where it was. (Comparing potentials would compare roundings.) */
void sk_solve_line_judge(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row, (void)begin, (void)end;
    double *cell = run->cell, before = cell[SK_CELL_SLOPE], slope = sk_solve_sum(run);
    cell[SK_CELL_LINE_DONE] = slope >= -0.5 * fabs(before);
    if (cell[SK_CELL_LINE_DONE] != 0) return;
    double share = before > 0 && !is_lost(-slope) ? before / (before - slope) : 0;
    cell[SK_CELL_SHARE] *= share > 0.1 ? share : 0.1;
}

void sk_solve_end(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)begin, (void)end;
    double *cell = run->cell, start = cell[SK_CELL_START];
    cell[SK_CELL_PRESENT] = sk_solve_sum(run);
    double left = start > 0 ? sqrt(cell[SK_CELL_PRESENT] / start) : 0;
    if (!(left <= cell[SK_CELL_WORST])) cell[SK_CELL_WORST] = left;
    if (start != 0 && !is_solved(cell, row->coefficient[0])) cell[SK_CELL_UNSOLVED]++;
}
#endif
