/* An implicit solve in reverse; see adjoint.h.
 *
 * It found the v at which the momentum's balance m (v - v0) = h F(x0 + h v, v) holds, so that by the implicit function
 * theorem, whatever iterations led there, with y the solution of one linear system
 *
 *   A^T y = V- + h X-,    A = m - h dF/dv - h^2 dF/dx
 *
 *   F- = h y,    V0- = m y,    X0- = X- + (dF/dx)^T F-         what is pinned: V0- = V- + h X- + (dF/dv + h dF/dx)^T F-
 *
 * A is the true derivative. The matrix that Newton's method takes is another one: without what would make it
 * indefinite, springs under pressure say. Products with A^T are what forces hand on (adjoint_force.c); the forward
 * solve's matrix, by its conjugate gradients or its factor, is the preconditioner of GMRES, a flexible one
 * (Saad 1993), for conjugate gradients that stop early are not the same matrix each time. */
#include <math.h>
#include <string.h>

#include "plan/newton.h"
#include "world/adjoint.h"

enum { CYCLES = 10 };
/* Shares of the right side: where it is solved, what is left of it at the worst, and what the preconditioner leaves. */
static const double solved_share = 1e-9, worst_share = 1e-6, precondition_share = 1e-2;

bool sk_adjoint_opens(const sk_op *op) {
    bool opens = false;
    for (int isa = 0; isa < SK_ISA_COUNT; isa++) opens |= op->kernel && op->kernel == sk_solve_open.version[isa];
    return opens;
}

bool sk_adjoint_begin_solve(sk_adjoint *a, const sk_op *solve) {
    sk_krylov *k = &a->krylov;
    k->op = solve;
    bool good = true;
    for (size_t i = 0; i <= SK_KRYLOV; i++) good &= (k->basis[i] = sk_adjoint_new_numbers(a)) != NULL;
    for (size_t i = 0; i < SK_KRYLOV; i++) good &= (k->change[i] = sk_adjoint_new_numbers(a)) != NULL;
    real **const others[] = {&k->right, &k->left, &k->by_x, &k->by_v};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        good &= (*others[i] = sk_adjoint_new_numbers(a)) != NULL;
    k->by_effect = sk_allocate(&a->world->allocator, (a->effect_count + 1) * sizeof *k->by_effect);
    return good && k->by_effect;
}

void sk_adjoint_end_solve(sk_adjoint *a) {
    sk_krylov *k = &a->krylov;
    sk_allocator *allocator = &a->world->allocator;
    for (size_t i = 0; i <= SK_KRYLOV; i++) sk_release(allocator, k->basis[i]);
    for (size_t i = 0; i < SK_KRYLOV; i++) sk_release(allocator, k->change[i]);
    real *const others[] = {k->right, k->left, k->by_x, k->by_v};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) sk_release(allocator, others[i]);
    sk_release(allocator, k->by_effect);
}

/* ---- vectors ---- */

static double dot(const sk_adjoint *a, const real *p, const real *q) {
    real sum[SK_LANES] = {0};
    double all = 0;
    for (size_t i = 0; i < a->reals; i += SK_LANES)
        for (size_t l = 0; l < SK_LANES; l++) sum[l] += p[i + l] * q[i + l];
    for (size_t l = 0; l < SK_LANES; l++) all += (double)sum[l];
    return all;
}

static void add(const sk_adjoint *a, real *to, double factor, const real *p) {
    for (size_t i = 0; i < a->reals; i++) to[i] += (real)factor * p[i];
}

static void scale(const sk_adjoint *a, real *to, double factor, const real *p) {
    for (size_t i = 0; i < a->reals; i++) to[i] = (real)factor * p[i];
}

static void swap(real **p, real **q) {
    real *r = *p;
    *p = *q, *q = r;
}

/* ---- the matrix, and what is near its inverse ---- */

typedef struct reverse_solve {
    sk_adjoint *a;
    const sk_op *op;    /* the solve, */
    const sk_op *looks; /* and of it the ops that F is made by */
    size_t look_count;
    const sk_taped *at;
    double time, h;
    sk_run run;
    skein_status status;
    skein_error *error;
} reverse_solve;

/* X- and V- of h y as the adjoint of F, in by_x and by_v: without what they have already. */
static void hand_on(reverse_solve *s, const real *y, bool with_effects) {
    sk_adjoint *a = s->a;
    sk_krylov *k = &a->krylov;
    size_t effect_count = a->effect_count;
    memset(k->by_x, 0, a->reals * sizeof(real));
    memset(k->by_v, 0, a->reals * sizeof(real));
    scale(a, a->of[SK_F], s->h, y);
    swap(&a->of[SK_X], &k->by_x), swap(&a->of[SK_V], &k->by_v);
    if (!with_effects) a->effect_count = 0;
    if (!s->status) s->status = sk_adjoint_reverse_looks(a, s->looks, s->look_count, s->at, s->time, s->error);
    a->effect_count = effect_count;
    swap(&a->of[SK_X], &k->by_x), swap(&a->of[SK_V], &k->by_v);
    memset(a->of[SK_F], 0, a->reals * sizeof(real));
    k->products++;
}

/* out = A^T y, of what is free. */
static void multiply(reverse_solve *s, const real *y, real *out, bool with_effects) {
    sk_adjoint *a = s->a;
    const real *x = a->krylov.by_x, *v = a->krylov.by_v, h = (real)s->h;
    hand_on(s, y, with_effects);
    x = a->krylov.by_x, v = a->krylov.by_v;
    for (size_t i = 0; i < a->reals; i++) {
        real free = a->inverse_mass[i] > 0 ? 1 : 0;
        out[i] = a->mass[i] * y[i] - free * (v[i] + h * x[i]);
    }
}

/* out = about A^-1 r, by the forward solve's matrix. */
static void precondition(reverse_solve *s, const real *r, real *out) {
    sk_adjoint *a = s->a;
    memcpy(s->run.vector[SK_RESIDUAL], r, a->reals * sizeof(real));
    sk_newton_invert(&s->run, s->op, precondition_share);
    const real *change = (const real *)(const void *)s->run.vector[SK_CHANGE];
    for (size_t i = 0; i < a->reals; i++) out[i] = a->inverse_mass[i] > 0 ? change[i] : 0;
}

/* ---- GMRES ---- */

/* A column of the upper Hessenberg matrix becomes one of a triangle, by the rotations so far and a new one, which the right
 * side takes part in. */
static void rotate(double (*h)[SK_KRYLOV], double *c, double *s, double *g, size_t j) {
    for (size_t i = 0; i < j; i++) {
        double p = h[i][j], q = h[i + 1][j];
        h[i][j] = c[i] * p + s[i] * q;
        h[i + 1][j] = c[i] * q - s[i] * p;
    }
    double size = hypot(h[j][j], h[j + 1][j]);
    c[j] = size > 0 ? h[j][j] / size : 1;
    s[j] = size > 0 ? h[j + 1][j] / size : 0;
    h[j][j] = size;
    g[j + 1] = -s[j] * g[j];
    g[j] = c[j] * g[j];
}

/* y += what makes the residual `left`, of this size, least among so many directions; stops at `enough`. */
static void cycle(reverse_solve *s, real *y, double size, double enough) {
    sk_adjoint *a = s->a;
    sk_krylov *k = &a->krylov;
    double h[SK_KRYLOV + 1][SK_KRYLOV], c[SK_KRYLOV], sine[SK_KRYLOV], g[SK_KRYLOV + 1] = {size};
    size_t count = 0;
    scale(a, k->basis[0], 1 / size, k->left);
    while (count < SK_KRYLOV && fabs(g[count]) > enough && !s->status) {
        size_t j = count;
        real *next = k->basis[j + 1];
        precondition(s, k->basis[j], k->change[j]);
        multiply(s, k->change[j], next, false);
        for (size_t i = 0; i <= j; i++) {
            h[i][j] = dot(a, next, k->basis[i]);
            add(a, next, -h[i][j], k->basis[i]);
        }
        h[j + 1][j] = sqrt(dot(a, next, next));
        if (!isfinite(h[j + 1][j])) return;
        if (h[j + 1][j] > 0) scale(a, next, 1 / h[j + 1][j], next);
        bool ends = !(h[j + 1][j] > 0);
        rotate(h, c, sine, g, j);
        if (!(h[j][j] > 0)) break; // no direction at all
        count++;
        if (ends) break;
    }
    for (size_t i = count; i-- > 0;) {
        for (size_t j = i + 1; j < count; j++) g[i] -= h[i][j] * g[j];
        g[i] /= h[i][i];
        add(a, y, g[i], k->change[i]);
    }
}

/* A^T y = right, y in the place of `left` at the end; by_x, by_v and fields have what y hands on. Returns what is left as a
 * share of the right side. */
static double solve(reverse_solve *s, real *y) {
    sk_adjoint *a = s->a;
    sk_krylov *k = &a->krylov;
    double whole = sqrt(dot(a, k->right, k->right)), size = whole, before;
    memset(y, 0, a->reals * sizeof(real));
    memcpy(k->left, k->right, a->reals * sizeof(real));
    memcpy(k->by_effect, a->by_effect, a->effect_count * sizeof *k->by_effect);
    sk_newton_linearise(&s->run, s->op);
    for (int i = 0; i < CYCLES && size > 0; i++) {
        before = size;
        cycle(s, y, size, solved_share * whole);
        if (i) memcpy(a->by_effect, k->by_effect, a->effect_count * sizeof *k->by_effect);
        multiply(s, y, k->left, true);
        for (size_t n = 0; n < a->reals; n++) k->left[n] = k->right[n] - k->left[n];
        size = sqrt(dot(a, k->left, k->left));
        if (size <= 2 * solved_share * whole || !(size < 0.5 * before)) break; // or all that rounding lets it
    }
    return whole > 0 ? size / whole : 0;
}

/* ---- a substep's solve ---- */

static void find_looks(reverse_solve *s) {
    const sk_op *op = s->op + 1, *end = op + s->op->length;
    while (op < end && (!sk_op_type_of(op)->leads || op->part != SK_NEWTON_RESIDUAL)) op++;
    while (op < end && !sk_adjoint_looks_at_state(op)) op++;
    s->looks = op;
    while (op < end && sk_adjoint_looks_at_state(op)) op++;
    s->look_count = (size_t)(op - s->looks);
}

skein_status sk_adjoint_reverse_solve(sk_adjoint *a, const sk_taped *at, double time, skein_error *error) {
    sk_krylov *k = &a->krylov;
    reverse_solve s = {.a = a, .op = k->op, .at = at, .time = time, .h = k->op->dt, .error = error};
    real *x = a->of[SK_X], *v = a->of[SK_V], *x0 = a->of[SK_X0], *v0 = a->of[SK_V0], h = (real)s.h;
    find_looks(&s);
    s.run = sk_world_run_context(a->world);
    s.run.vector[SK_X] = (sk_vec4 *)(void *)at->x;
    s.run.vector[SK_V] = (sk_vec4 *)(void *)at->v;
    s.run.time = time;
    for (const sk_op *op = s.op; op-- > a->world->plan.data;) // S, as the forward solve had it
        if (sk_adjoint_opens(op)) sk_run_ops(&s.run, a->world->tasks, op, 1);
    for (size_t i = 0; i < a->reals; i++) k->right[i] = a->inverse_mass[i] > 0 ? v[i] + h * x[i] : 0;
    real *y = a->moved;
    double left = solve(&s, y);
    if (s.status) return s.status;
    if (!(left <= worst_share))
        return sk_fail(error, SKEIN_ERROR_VALUE, "gradient",
                       "at %.6g s the linear system of a substep could not be solved: %.2g of its right side is left",
                       time, left);
    for (size_t i = 0; i < a->reals; i++) {
        bool free = a->inverse_mass[i] > 0;
        v0[i] += free ? a->mass[i] * y[i] : v[i] + h * x[i] + k->by_v[i] + h * k->by_x[i];
        x0[i] += x[i] + k->by_x[i];
        x[i] = v[i] = 0;
    }
    return SKEIN_OK;
}
