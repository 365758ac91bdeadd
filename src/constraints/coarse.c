/* The kernel that carries the movement of a coarse grid's particles to those in between. */
#include "constraints/coarse.h"

#include "base/kernels.h"

#define SK_UNIT coarse
SK_KERNELS(sk_op_kernel, carry);

#ifdef SK_ISA

/* The displacements of a block's particles: x, y and z in parts. */
typedef struct moves {
    sk_wide d[3 * SK_PARTS];
} moves;

SK_INLINE moves moves_of(const sk_run *run, const sk_op *op, size_t slot) {
    const sk_wide *x = (const sk_wide *)(const void *)(run->vector[SK_X] + slot),
                  *x0 = (const sk_wide *)(const void *)(run->vector[SK_X0] + slot),
                  *v = (const sk_wide *)(const void *)(run->vector[SK_V] + slot);
    real h = (real)op->coefficient[1];
    moves m;
    for (int i = 0; i < 3 * SK_PARTS; i++) m.d[i] = x[i] - (h == 0 ? x0[i] : x0[i] + h * v[i]);
    return m;
}

/* In lanes l of [first, end) lane l + shift of `m`, elsewhere lane l of `other`. */
SK_INLINE moves turned(const moves *m, int shift, size_t first, size_t end, const moves *other) {
    moves to;
    for (int i = 0; i < 3 * SK_PARTS; i += SK_PARTS) {
        sk_rotate_lanes(to.d + i, m->d + i, shift);
        for (int p = 0; p < SK_PARTS; p++) {
            sk_mask in = sk_lanes_between((size_t)p * SK_PART, first, end);
            to.d[i + p] = sk_select(in, to.d[i + p], other->d[i + p]);
        }
    }
    return to;
}

SK_INLINE moves between(const moves *a, const moves *b, real f) {
    moves m;
    for (int i = 0; i < 3 * SK_PARTS; i++) m.d[i] = a->d[i] + f * (b->d[i] - a->d[i]);
    return m;
}

SK_INLINE void add_moves(sk_run *run, size_t slot, const moves *a, const moves *b, real g) {
    sk_wide *x = (sk_wide *)(void *)(run->vector[SK_X] + slot);
    for (int p = 0; p < SK_PARTS; p++) {
        sk_mask free = sk_positive(x[3 * SK_PARTS + p]);
        for (int i = p; i < 3 * SK_PARTS; i += SK_PARTS)
            x[i] = sk_plus_where(free, x[i], a->d[i] + g * (b->d[i] - a->d[i]));
    }
}

/* Two neighbouring columns of the coarse grid in a strip row, and the blocks between them: within a strip, or from the
 * last column of the strip before (left of the first block), or to the first one of the strip after. */
typedef struct gap {
    size_t left, right, width; /* their blocks, and the distance in blocks */
    size_t begin, end;         /* blocks of the strip between them */
    int turn_left, turn_right;
    size_t lanes; /* how many lanes, the first ones, have a right column */
} gap;

SK_INLINE gap find_gap(const sk_coarse *coarse, size_t strip, size_t i, size_t count) {
    const sk_coarse_grid *grid = &coarse->grid;
    size_t last = grid->first + (count - 1) * grid->step;
    gap g = {.left = last, .right = grid->first, .width = strip - last + grid->first, .end = grid->first};
    if (i == 0) g.turn_left = -1;
    else g.left = g.begin = grid->first + (i - 1) * grid->step;
    if (i && i < count) g.right = g.end = g.left + grid->step, g.width = grid->step;
    if (i == count) g.turn_right = 1, g.end = strip;
    size_t right = g.right + (i == count ? strip : 0);
    g.lanes = right < coarse->columns ? (coarse->columns - right + strip - 1) / strip : 0;
    if (g.lanes > SK_LANES) g.lanes = SK_LANES;
    return g;
}

/* The displacements of both columns of a gap in a strip row; where there is no left or right one, the other's. */
SK_INLINE void find_moves(const sk_run *run, const sk_op *op, size_t first_slot, const gap *g, moves *a, moves *b) {
    moves left = moves_of(run, op, first_slot + g->left * SK_LANES);
    moves right = moves_of(run, op, first_slot + g->right * SK_LANES);
    *a = left, *b = right;
    if (g->turn_left) *a = turned(&left, g->turn_left, 1, SK_LANES, &right);
    if (g->turn_right || g->lanes < SK_LANES) *b = turned(&right, g->turn_right, 0, g->lanes, a);
}

/* Carries to the rows from one row of the coarse grid to the next; also to those before the first, after the last. */
static void carry_band(sk_run *run, const sk_op *op, size_t r) {
    const sk_coarse *coarse = op->rule;
    const sk_coarse_grid *grid = &coarse->grid, *finer = &coarse->finer;
    size_t strip = op->walk.width, line = strip * SK_LANES, first = op->walk.first_slot;
    bool last = r + grid->row_step >= op->walk.rows;
    size_t begin = r == grid->row_first ? finer->row_first : r, end = last ? op->walk.rows : r + grid->row_step;
    size_t count = sk_coarse_columns(grid, strip);
    for (size_t i = 0; i <= count; i++) {
        gap g = find_gap(coarse, strip, i, count);
        size_t from = finer->first;
        while (from < g.begin) from += finer->step;
        if (from >= g.end) continue;
        moves a, b, next_a, next_b;
        find_moves(run, op, first + r * line, &g, &a, &b);
        next_a = a, next_b = b;
        if (!last) find_moves(run, op, first + (r + grid->row_step) * line, &g, &next_a, &next_b);
        for (size_t to = begin; to < end; to += finer->row_step) {
            real f = to < r ? 0 : (real)(to - r) / (real)grid->row_step;
            moves left = between(&a, &next_a, f), right = between(&b, &next_b, f);
            for (size_t k = from; k < g.end; k += finer->step) {
                if (to == r && k == g.left && !g.turn_left) continue; // it is in the coarse grid itself
                size_t way = g.turn_left ? k + strip - g.left : k - g.left;
                add_moves(run, first + to * line + k * SK_LANES, &left, &right, (real)way / (real)g.width);
            }
        }
    }
}

/* Element e is the band that begins at row e + row_first, so that it reads and writes no row before e. */
void SK_KERNEL(carry)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_coarse_grid *grid = &((const sk_coarse *)op->rule)->grid;
    for (size_t e = begin; e < end; e++)
        if (e % grid->row_step == 0 && e + grid->row_first < op->walk.rows) carry_band(run, op, e + grid->row_first);
}

#else

const sk_kernels sk_coarse_carry = {SK_EACH_ISA(carry)};
#endif
