/* Newton's method and conjugate gradients by themselves, on a system whose answer is known: no world, no plan but the
 * parts, each a kernel here. What is sought is v with b - A v - c v^3 = 0, A a symmetric matrix of N x N. */
#include "plan/newton.h"

#include "helpers.h"

enum { N = 6, ROWS = 1 + 2 * SK_NEWTON_PARTS };

typedef struct problem {
    sk_newton params; /* first: the solve's rule */
    double a[N][N], b[N], c;
    double v[N], guess[N], change[N], r[N], z[N], p[N], q[N], jacobian[N][N];
    size_t along; /* how many velocities the line searches tried */
} problem;

static double dot(const double *x, const double *y) {
    double sum = 0;
    for (int i = 0; i < N; i++) sum += x[i] * y[i];
    return sum;
}

static void leave(sk_run *run, double first, double second) {
    double *sums = (double *)(void *)run->vector[SK_SUMS];
    sums[0] = first, sums[1] = second;
}

static problem *problem_of(const sk_op *op) {
    return (problem *)(uintptr_t)op->rule;
}

static void guess(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    problem *o = problem_of(op);
    (void)run, (void)begin, (void)end;
    for (int i = 0; i < N; i++) o->change[i] = o->v[i], o->guess[i] = o->v[i] = 0;
}

static void along(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    problem *o = problem_of(op);
    (void)begin, (void)end;
    o->along++;
    for (int i = 0; i < N; i++) o->v[i] = o->guess[i] + run->solve->scale * o->change[i];
}

static void residual(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    problem *o = problem_of(op);
    (void)begin, (void)end;
    for (int i = 0; i < N; i++) o->r[i] = o->b[i] - dot(o->a[i], o->v) - o->c * o->v[i] * o->v[i] * o->v[i];
    leave(run, dot(o->r, o->change), dot(o->r, o->r));
}

static void linearise(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    problem *o = problem_of(op);
    (void)begin, (void)end;
    memcpy(o->jacobian, o->a, sizeof o->a);
    for (int i = 0; i < N; i++) {
        o->jacobian[i][i] += 3 * o->c * o->v[i] * o->v[i];
        o->guess[i] = o->v[i], o->change[i] = 0;
    }
    leave(run, 0, 0);
}

static void precondition(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    problem *o = problem_of(op);
    (void)begin, (void)end;
    memcpy(o->z, o->r, sizeof o->z);
    leave(run, dot(o->r, o->z), 0);
}

static void multiply(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    problem *o = problem_of(op);
    double s = run->solve->scale;
    (void)begin, (void)end;
    for (int i = 0; i < N; i++) o->p[i] = o->z[i] + s * o->p[i];
    for (int i = 0; i < N; i++) o->q[i] = dot(o->jacobian[i], o->p);
    leave(run, dot(o->p, o->q), 0);
}

static void step(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    problem *o = problem_of(op);
    double s = run->solve->scale;
    for (int i = 0; i < N; i++) o->change[i] += s * o->p[i], o->r[i] -= s * o->q[i];
    precondition(run, op, begin, end);
}

static void run_kernels(sk_run *run, const sk_op *ops, size_t count) {
    for (size_t r = 0; r < count; r++) ops[r].kernel(run, &ops[r], 0, 0);
}

/* The account of a solve from v as it is. */
static sk_solve solve(problem *o) {
    static sk_op_kernel *const kernels[SK_NEWTON_PARTS] = {
        [SK_NEWTON_GUESS] = guess,       [SK_NEWTON_ALONG] = along,         [SK_NEWTON_HOLD] = NULL,
        [SK_NEWTON_RESIDUAL] = residual, [SK_NEWTON_LINEARISE] = linearise, [SK_NEWTON_PRECONDITION] = precondition,
        [SK_NEWTON_MULTIPLY] = multiply, [SK_NEWTON_STEP] = step,
    };
    sk_op ops[ROWS] = {{.kind = SK_OP_SOLVE, .kernel = sk_newton_solve, .rule = &o->params}};
    size_t count = 1;
    for (int part = SK_NEWTON_PARTS; part-- > 0;) { // in any order
        ops[count++] = (sk_op){.kind = SK_OP_PART, .part = part, .length = kernels[part] != NULL};
        if (kernels[part]) ops[count++] = (sk_op){.kind = SK_OP_CALL, .kernel = kernels[part], .rule = o};
    }
    ops[0].length = count - 1;
    sk_vec4 sums[16] = {{0}};
    sk_solve state = {.scale = 0};
    sk_run run = {.slot_count = 16, .solve = &state, .ops = run_kernels};
    run.vector[SK_SUMS] = sums;
    ops[0].kernel(&run, &ops[0], 0, 1);
    return state;
}

/* A chain with ends that are held: 2 on the diagonal, -1 beside it; N different eigenvalues. */
static problem chain(double c) {
    problem o = {.params = {1e-9, 20, 100}, .c = c};
    for (int i = 0; i < N; i++) {
        o.a[i][i] = 2, o.b[i] = 1 + i;
        if (i) o.a[i][i - 1] = o.a[i - 1][i] = -1;
    }
    return o;
}

static void a_linear_system_takes_one_turn(void **state) {
    (void)state;
    problem o = chain(0);
    sk_solve s = solve(&o);
    assert_int_equal(s.newton_iterations, 1);
    assert_true(s.iterations <= N); // in exact arithmetic there are no more directions
    assert_int_equal(s.unsolved, 0);
    for (int i = 0; i < N; i++) { // second differences of k^3/6 are k
        double k = i + 1, l = N + 1;
        assert_near(o.v[i], k * (l * l - k * k) / 6, 1e-7);
    }
}

static void a_curved_one_is_solved_from_anywhere(void **state) {
    (void)state;
    static const double starts[] = {0, 1, -50, 1e4};
    for (size_t k = 0; k < COUNT(starts); k++) {
        problem o = chain(3);
        for (int i = 0; i < N; i++) o.v[i] = starts[k];
        sk_solve s = solve(&o);
        assert_int_equal(s.unsolved, 0);
        assert_true(s.newton_iterations <= 12 && s.residual <= 1e-9);
        for (int i = 0; i < N; i++) assert_near(dot(o.a[i], o.v) + 3 * o.v[i] * o.v[i] * o.v[i], o.b[i], 1e-6);
    }
}

/* Too long a first guess is shortened, by as many tries as it takes. */
static void a_long_guess_is_shortened(void **state) {
    (void)state;
    problem near = chain(3), far = chain(3);
    for (int i = 0; i < N; i++) far.v[i] = 1e4;
    near.params.iterations = far.params.iterations = 0; // the first guess and nothing more
    solve(&near), solve(&far);
    assert_int_equal(near.along, 1);
    assert_true(far.along > 2 && fabs(far.v[0]) < 10);
}

static void what_is_left_is_told(void **state) {
    (void)state;
    problem o = chain(3);
    o.params.iterations = 1;
    sk_solve s = solve(&o);
    assert_true(s.unsolved == 1 && s.newton_iterations == 1 && s.residual > 1e-9);
    o = chain(0);
    o.params.iterations = 1, o.params.cg_iterations = 2;
    s = solve(&o);
    assert_true(s.unsolved == 1 && s.iterations == 2);
    // a residual that is no number is not gone on with
    o = chain(0);
    o.b[2] = NAN;
    s = solve(&o);
    assert_true(s.unsolved == 1 && s.newton_iterations == 0);
    // where there is nothing to do nothing is done
    o = chain(0);
    memset(o.b, 0, sizeof o.b);
    s = solve(&o);
    assert_true(s.unsolved == 0 && s.newton_iterations == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_linear_system_takes_one_turn),
        cmocka_unit_test(a_curved_one_is_solved_from_anywhere),
        cmocka_unit_test(a_long_guess_is_shortened),
        cmocka_unit_test(what_is_left_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
