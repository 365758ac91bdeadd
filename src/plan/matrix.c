/* The sparse matrix of a solve: its pattern of blocks, found once a plan, the filter, and the calls of the solver. */
#include "plan/matrix.h"

#include <stdlib.h>
#include <string.h>

#include "plan/solve.h"

/* ---- the pattern ---- */

static int compare_indices(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Calls `visit` for every pair of particles of every element. */
static void visit_pairs(const sk_matrix_part *parts, size_t part_count,
                        void (*visit)(void *data, uint32_t low, uint32_t high, uint32_t *pair), void *data) {
    for (size_t i = 0; i < part_count; i++) {
        const sk_matrix_part *part = &parts[i];
        uint32_t *pair = part->pair;
        for (size_t e = 0; e < part->count; e++)
            for (size_t p = 1; p < part->arity; p++)
                for (size_t q = 0; q < p; q++) {
                    uint32_t a = part->particle[e * part->arity + p], b = part->particle[e * part->arity + q];
                    visit(data, a < b ? a : b, a < b ? b : a, pair++);
                }
    }
}

static void count_pair(void *data, uint32_t low, uint32_t high, uint32_t *pair) {
    (void)high, (void)pair;
    ((sk_matrix *)data)->first[low + 1]++;
}

/* `start` still holds where the next entry of each particle's list goes. */
static void list_pair(void *data, uint32_t low, uint32_t high, uint32_t *pair) {
    (void)pair;
    sk_matrix *m = data;
    m->below[m->start[low]++] = high;
}

static void find_pair(void *data, uint32_t low, uint32_t high, uint32_t *pair) {
    const sk_matrix *m = data;
    const uint32_t *found =
        bsearch(&high, m->below + m->first[low], m->first[low + 1] - m->first[low], sizeof high, compare_indices);
    *pair = (uint32_t)(found - m->below);
}

/* Sorts each particle's list, and keeps each neighbour once. */
static void order_lists(sk_matrix *m) {
    size_t kept = 0;
    for (size_t i = 0; i < m->particles; i++) {
        size_t begin = m->first[i], end = m->first[i + 1], mine = kept;
        m->first[i] = mine;
        qsort(m->below + begin, end - begin, sizeof *m->below, compare_indices);
        for (size_t k = begin; k < end; k++)
            if (kept == mine || m->below[kept - 1] != m->below[k]) m->below[kept++] = m->below[k];
    }
    m->first[m->particles] = kept;
}

/* Writes the row of every entry, column by column. */
static void write_rows(sk_matrix *m) {
    int64_t at = 0;
    for (size_t i = 0; i < m->particles; i++)
        for (size_t c = 0; c < 3; c++) {
            m->start[3 * i + c] = at;
            for (size_t r = c; r < 3; r++) m->row[at++] = (int64_t)(3 * i + r);
            for (size_t k = m->first[i]; k < m->first[i + 1]; k++)
                for (size_t r = 0; r < 3; r++) m->row[at++] = (int64_t)(3 * (size_t)m->below[k] + r);
        }
    m->start[3 * m->particles] = at;
}

bool sk_matrix_shape(sk_matrix *m, sk_allocator *allocator, size_t particles, const sk_matrix_part *parts,
                     size_t part_count) {
    sk_matrix_release(m, allocator);
    m->particles = particles;
    m->first = sk_allocate(allocator, (particles + 1) * sizeof *m->first);
    m->start = sk_allocate(allocator, (3 * particles + 1) * sizeof *m->start);
    m->given = sk_allocate(allocator, 3 * particles * sizeof *m->given);
    m->found = sk_allocate(allocator, 3 * particles * sizeof *m->found);
    bool good = m->first && m->start && m->given && m->found;
    if (good) {
        visit_pairs(parts, part_count, count_pair, m);
        for (size_t i = 0; i < particles; i++) m->start[i] = (int64_t)(m->first[i + 1] += m->first[i]);
        for (size_t i = particles; i-- > 0;) m->start[i] = i ? m->start[i - 1] : 0;
        m->below = sk_allocate(allocator, (m->first[particles] + 1) * sizeof *m->below);
        good = m->below != NULL;
    }
    if (good) {
        visit_pairs(parts, part_count, list_pair, m);
        order_lists(m);
        size_t entries = 6 * particles + 9 * m->first[particles];
        m->row = sk_allocate(allocator, entries * sizeof *m->row);
        m->value = sk_allocate(allocator, entries * sizeof *m->value);
        good = m->row && m->value && m->first[particles] <= UINT32_MAX;
    }
    if (good) {
        write_rows(m);
        visit_pairs(parts, part_count, find_pair, m);
    } else {
        sk_matrix_release(m, allocator);
    }
    return good;
}

void sk_matrix_release(sk_matrix *m, sk_allocator *allocator) {
    void *arrays[] = {m->first, m->below, m->start, m->row, m->value, m->given, m->found};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    *m = (sk_matrix){.solver = m->solver};
}

skein_sparse_matrix sk_matrix_view(const sk_matrix *m, bool with_values) {
    return (skein_sparse_matrix){3 * m->particles, m->start, m->row, with_values ? m->value : NULL};
}

/* ---- the values ---- */

void sk_matrix_clear(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_matrix *m = run->matrix;
    (void)begin, (void)end;
    memset(m->value, 0, (size_t)m->start[3 * m->particles] * sizeof *m->value);
    for (size_t i = 0; i < m->particles; i++) {
        sk_vec4 d = sk_load(run->vector[op->source[0]], op->packed, run->slot_of[i]);
        sk_vec4 o = sk_load(run->vector[op->source[1]], op->packed, run->slot_of[i]);
        double xx = (double)d.x, yy = (double)d.y, zz = (double)d.z;
        double xy = (double)o.x, xz = (double)o.y, yz = (double)o.z;
        sk_matrix_add_diagonal(m, (uint32_t)i, (double[3][3]){{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}});
    }
}

/* Loads a particle's filter; true if it is the identity. */
static bool load_filter(const sk_run *run, size_t packed, size_t particle, double s[3][3]) {
    size_t slot = run->slot_of[particle];
    sk_vec4 d = sk_load(run->vector[SK_FILTER0], packed, slot), o = sk_load(run->vector[SK_FILTER1], packed, slot);
    s[0][0] = (double)d.x, s[1][1] = (double)d.y, s[2][2] = (double)d.z;
    s[0][1] = s[1][0] = (double)o.x, s[0][2] = s[2][0] = (double)o.y, s[1][2] = s[2][1] = (double)o.z;
    return d.x == 1 && d.y == 1 && d.z == 1 && o.x == 0 && o.y == 0 && o.z == 0;
}

static void multiply(double a[3][3], double b[3][3], double c[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

/* S D S + size (1 - S): held directions get about the stiffness of free ones, which keeps the matrix well scaled. */
static void filter_diagonal(sk_matrix *m, size_t particle, double s[3][3]) {
    size_t n;
    double *x = sk_matrix_column(m, particle, &n), *y = x + 3 + 3 * n, *z = y + 2 + 3 * n;
    double d[3][3] = {{x[0], x[1], x[2]}, {x[1], y[0], y[1]}, {x[2], y[1], z[0]}}, sd[3][3], sds[3][3];
    double size = (x[0] + y[0] + z[0]) / 3;
    if (!(size > 0)) size = 1;
    multiply(s, d, sd);
    multiply(sd, s, sds);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) sds[i][j] += size * ((i == j) - s[i][j]);
    x[0] = sds[0][0], x[1] = sds[1][0], x[2] = sds[2][0], y[0] = sds[1][1], y[1] = sds[2][1], z[0] = sds[2][2];
}

static void filter_pair(sk_matrix *m, size_t column, size_t k, double left[3][3], double right[3][3]) {
    size_t n;
    double *x = sk_matrix_column(m, column, &n) + 3 + 3 * k, *y = x + 3 * n + 2, *z = y + 3 * n + 1;
    double *of[3] = {x, y, z}, b[3][3], sb[3][3], sbs[3][3];
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++) b[r][c] = of[c][r];
    multiply(left, b, sb);
    multiply(sb, right, sbs);
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++) of[c][r] = sbs[r][c];
}

/* A = S A S + (1 - S), the latter scaled. False if a number is not finite. */
static bool filter_matrix(const sk_run *run, sk_matrix *m, size_t packed) {
    for (size_t i = 0; i < m->particles; i++) {
        double s[3][3], t[3][3];
        bool open = load_filter(run, packed, i, s);
        if (!open) filter_diagonal(m, i, s);
        for (size_t k = m->first[i]; k < m->first[i + 1]; k++)
            if (!load_filter(run, packed, m->below[k], t) || !open) filter_pair(m, i, k - m->first[i], t, s);
    }
    double sum = 0;
    for (int64_t k = 0; k < m->start[3 * m->particles]; k++) sum += m->value[k] * 0;
    return sum == 0;
}

void sk_matrix_factor(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_matrix *m = run->matrix;
    (void)begin, (void)end;
    bool finite = filter_matrix(run, m, op->packed);
    skein_sparse_matrix matrix = sk_matrix_view(m, true);
    run->solve->factors++;
    run->solve->factored = finite && m->solver.factor(m->solver.user, &matrix);
    run->solve->failures += !run->solve->factored;
}

void sk_matrix_solve(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_matrix *m = run->matrix;
    const sk_vec4 *from = run->vector[op->source[0]];
    sk_vec4 *to = run->vector[op->dst];
    (void)begin, (void)end;
    if (!run->solve->factored) return;
    for (size_t i = 0; i < m->particles; i++) {
        sk_vec4 b = sk_load(from, op->packed, run->slot_of[i]);
        m->given[3 * i] = (double)b.x, m->given[3 * i + 1] = (double)b.y, m->given[3 * i + 2] = (double)b.z;
    }
    double sum = 0;
    bool good = m->solver.solve(m->solver.user, m->given, m->found);
    for (size_t i = 0; i < 3 * m->particles && good; i++) sum += m->found[i] * 0;
    if (!good || sum != 0) {
        run->solve->factored = false;
        run->solve->failures++;
        return;
    }
    memset(to, 0, run->slot_count * sizeof *to); // also slots without a particle
    for (size_t i = 0; i < m->particles; i++) {
        const double *x = m->found + 3 * i;
        sk_store_at(to, op->packed, run->slot_of[i], sk_v3((real)x[0], (real)x[1], (real)x[2]));
    }
}
