/* Backward Euler with a factor of its whole matrix: the matrix is the one that conjugate gradients multiply by, the
 * motion is the one that they find alone, and a solver that fails costs no more than time. */
#include "helpers.h"
#include "methods/plan_builder_solve.h"
#include "solvers/cholmod.h"
#include "world/world.h"

/* ---- a solver of the test's own: dense, and it can fail ---- */

typedef struct dense {
    size_t size, analysed, factored, solved, released;
    double *matrix;                 /* lower triangle of L, size x size */
    size_t fail_factor, fail_solve; /* from so many on; SIZE_MAX: never */
    skein_status fail_analyse;
    bool poison; /* a failing solve says that it worked, and leaves NaN */
    bool keep;   /* the matrix itself is kept, not its factor */
} dense;

static skein_status analyse(void *user, const skein_sparse_matrix *pattern, skein_error *error) {
    dense *d = user;
    d->analysed++;
    assert_null(pattern->value);
    assert_int_equal(pattern->start[0], 0);
    for (size_t c = 0; c < pattern->size; c++) {
        assert_true(pattern->row[pattern->start[c]] == (int64_t)c);
        for (int64_t k = pattern->start[c] + 1; k < pattern->start[c + 1]; k++)
            assert_true(pattern->row[k] > pattern->row[k - 1] && pattern->row[k] < (int64_t)pattern->size);
    }
    d->size = pattern->size;
    free(d->matrix);
    d->matrix = calloc(d->size * d->size, sizeof *d->matrix);
    assert_non_null(d->matrix);
    if (!d->fail_analyse) return SKEIN_OK;
    *error = (skein_error){d->fail_analyse, "", "the test says no"};
    return d->fail_analyse;
}

static bool factor(void *user, const skein_sparse_matrix *matrix) {
    dense *d = user;
    size_t n = d->size;
    double *l = d->matrix;
    if (d->factored++ >= d->fail_factor) return false;
    assert_int_equal(matrix->size, n);
    memset(l, 0, n * n * sizeof *l);
    for (size_t c = 0; c < n; c++)
        for (int64_t k = matrix->start[c]; k < matrix->start[c + 1]; k++)
            l[(size_t)matrix->row[k] * n + c] = matrix->value[k];
    for (size_t j = 0; j < n && !d->keep; j++)
        for (size_t i = j; i < n; i++) {
            double sum = l[i * n + j];
            for (size_t k = 0; k < j; k++) sum -= l[i * n + k] * l[j * n + k];
            if (i == j && !(sum > 0)) return false;
            l[i * n + j] = i == j ? sqrt(sum) : sum / l[j * n + j];
        }
    return true;
}

static bool solve(void *user, const double *b, double *x) {
    dense *d = user;
    size_t n = d->size;
    const double *l = d->matrix;
    if (d->solved++ >= d->fail_solve) {
        x[n / 2] = NAN;
        return d->poison;
    }
    for (size_t i = 0; i < n; i++) {
        x[i] = b[i];
        for (size_t k = 0; k < i; k++) x[i] -= l[i * n + k] * x[k];
        x[i] /= l[i * n + i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++) x[i] -= l[k * n + i] * x[k];
        x[i] /= l[i * n + i];
    }
    return true;
}

static void release(void *user) {
    dense *d = user;
    d->released++;
    free(d->matrix);
    d->matrix = NULL;
}

static dense sound(void) {
    return (dense){.fail_factor = SIZE_MAX, .fail_solve = SIZE_MAX};
}

static void give_dense(skein_world *world, dense *d) {
    OK(world, skein_sparse_solver_set(world, &(skein_sparse_solver){"dense", d, analyse, factor, solve, release}));
}

static void take_cholesky(skein_world *world, int substeps) {
    OK(world,
       skein_method_set(world, "backward_euler",
                        SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps), SKEIN_TEXT("preconditioner", "cholesky"))));
}

/* ---- the matrix ---- */

/* Constraints of a kind on twelve particles that stand about, so that each has several. */
static skein_world *tangle(const char *kind, const char *field, const char *text, dense *d) {
    enum { PARTICLES = 12, ELEMENTS = 9 };
    skein_world *world = new_world("backward_euler", 1);
    give_dense(world, d);
    take_cholesky(world, 1);
    uint64_t seed = 5;
    for (int i = 0; i < PARTICLES; i++)
        add_particle(world, 0.1 + 0.02 * i, random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                     random_between(&seed, -1, 1));
    bool energy = !strcmp(kind, "energy");
    skein_setting settings[] = {{energy ? "scale" : "stiffness", skein_number(300)},
                                {"damping", skein_number(2)},
                                {field, skein_text(text)},
                                {NULL, {0, {0, 0, 0}, NULL}}};
    if (energy) settings[1] = settings[2];
    if (energy || !text) settings[2].name = NULL;
    size_t arity;
    uint32_t corners[8 * ELEMENTS];
    OK(world, skein_constraint_arity(world, kind, settings, &arity));
    for (uint32_t e = 0; e < ELEMENTS; e++)
        for (uint32_t p = 0; p < arity; p++) corners[e * arity + p] = (e * 5 + p * (e % 2 ? 7 : 1)) % PARTICLES;
    OK(world, skein_constraint_add(world, kind, corners, ELEMENTS, settings, NULL));
    for (size_t i = 0; i < PARTICLES; i++) { // strained, so that tension across counts, too
        vec3 p = position_of(world, i);
        place_particle(world, i, 1.3 * p.x, 1.4 * p.y + 0.1 * p.x, 1.2 * p.z - 0.05 * p.y);
    }
    return world;
}

static void run_rows(skein_world *world, sk_plan *plan, sk_run *run) {
    sk_run_ops(run, world->tasks, plan->data, plan->count);
    plan->count = 0;
}

static void the_matrix_is_what_conjugate_gradients_multiply_by(void **state) {
    (void)state;
    static const struct {
        const char *kind, *field, *text;
    } rows[] = {
        {"distance", NULL, NULL},
        {"dihedral", NULL, NULL},
        {"isometric", NULL, NULL},
        {"area", NULL, NULL},
        {"volume", NULL, NULL},
        {"angle", NULL, NULL},
        {"attachment", NULL, NULL},
        {"formula", "constraint", "length(p0 + p1 - 2*p2) - 0.2"},
        {"formula", "constraint", "length(p0 - p7) + length(p1 - p6) + length(p2 - p5) + length(p3 - p4) - 2"},
        {"formula", "constraint", "p0.y + 0.5 * p0.x - 3"},
        {"energy", "energy", "0.5 * length(p0 - p1)^2 + 0.1 * (p2.x - p0.y)^4"},
    };
    for (size_t k = 0; k < COUNT(rows); k++) {
        dense d = sound();
        skein_world *world = tangle(rows[k].kind, rows[k].field, rows[k].text, &d);
        OK(world, skein_world_explain(world, 0.01, NULL, NULL)); // makes the shape, and the vectors
        size_t particles = skein_particle_count(world), n = 3 * particles;
        const sk_vector none = (sk_vector)SK_BLOCK0, p = (sk_vector)SK_DIRECTION, product = (sk_vector)SK_PRODUCT;
        sk_plan plan = {0};
        sk_plan_builder builder = {
            .plan = &plan, .allocator = &world->allocator, .rules = &world->rules, .isa = world->isa};
        builder.slot_count = world->particles.slot_count, builder.particle_count = particles, builder.h = 0.01;
        sk_run run = sk_world_run_context(world);
        sk_solve solve = {.scale = 0};
        run.solve = &solve;
        uint64_t seed = 1;
        sk_write_clear(&builder, none);
        sk_write_clear(&builder, (sk_vector)SK_BLOCK1);
        sk_write_clear(&builder, product);
        sk_write_pass(&builder, &sk_solve_open, (sk_vector)SK_FILTER0, SK_X, (sk_vector)SK_FILTER1, "");
        run_rows(world, &plan, &run);
        for (size_t i = 0; i < particles; i++) {
            sk_vec4 *at = &run.vector[p][run.slot_of[i]];
            at->x = (real)random_between(&seed, -1, 1), at->y = (real)random_between(&seed, -1, 1);
            at->z = (real)random_between(&seed, -1, 1);
        }
        d.keep = true;
        sk_write_apply(&builder, product, p, 0.5, 0.25);
        sk_write_factor(&builder, none, (sk_vector)SK_BLOCK1, 0.5, 0.25);
        run_rows(world, &plan, &run);
        assert_int_equal(d.factored, 1);
        double off = 0, largest = 0;
        for (size_t r = 0; r < n; r++) {
            double sum = 0;
            for (size_t c = 0; c < n; c++) {
                const real *u = &run.vector[p][run.slot_of[c / 3]].x;
                sum += d.matrix[c <= r ? r * n + c : c * n + r] * (double)u[c % 3];
            }
            double is = (double)(&run.vector[product][run.slot_of[r / 3]].x)[r % 3];
            off = fmax(off, fabs(is - sum)), largest = fmax(largest, fabs(is));
        }
        printf("%s: off by %.2g of %.3g\n", rows[k].kind, off, largest);
        assert_true(largest > 1);
        assert_under(off, 100 * EPSILON * largest);
        sk_release(&world->allocator, plan.data);
        skein_world_destroy(world);
        assert_int_equal(d.released, 1);
    }
}

/* ---- motion ---- */

/* A small stiff cloth that falls on a ball and slides. */
static skein_world *small_cloth(dense *d) {
    skein_world *world = new_world("backward_euler", 2);
    if (d) give_dense(world, d);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 6, 6), SKEIN_VEC3("position", 0.05, 0.62, 0),
                                            SKEIN_REAL("stretch.stiffness", 2e3), SKEIN_REAL("shear.stiffness", 300),
                                            SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 20),
                                            SKEIN_TEXT("pins", "0"), SKEIN_TEXT("shear.diagonals", "springs"),
                                            SKEIN_REAL("stretch.damping", 5)),
                             NULL));
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 3)), NULL));
    OK(world, skein_force_add(world, "potential", SKEIN_SETTINGS(SKEIN_TEXT("energy", "2 * p.x^2")), NULL));
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.2, 0), SKEIN_REAL("radius", 0.35),
                                                SKEIN_REAL("friction", 0.8)),
                                 NULL));
    return world;
}

static double farthest(skein_world *a, skein_world *b) {
    double off = 0;
    for (size_t i = 0; i < 36; i++) off = fmax(off, length3(minus(position_of(a, i), position_of(b, i))));
    return off;
}

/* Both are solved to the same tolerance. In float that is all rounding, which sliding and folding make larger. */
static const double far_enough = sizeof(skein_real) == sizeof(double) ? 1e-4 : 5e-3;

static void the_motion_is_that_of_conjugate_gradients_alone(void **state) {
    (void)state;
    dense d = sound();
    skein_world *alone = small_cloth(NULL), *world = small_cloth(&d);
    take_cholesky(world, 2);
    double off = 0;
    size_t contacts = 0, iterations[2] = {0, 0}, turns = 0;
    for (int n = 0; n < 35; n++) {
        steps(alone, 1, 1.0 / 60);
        steps(world, 1, 1.0 / 60);
        skein_statistics a = statistics_of(alone), b = statistics_of(world);
        assert_int_equal(b.unsolved, 0);
        assert_int_equal(b.solver_failures, 0);
        assert_int_equal(a.solver_factors, 0);
        assert_int_equal(b.solver_factors, b.newton_iterations);
        contacts += b.contacts;
        iterations[0] += a.cg_iterations, iterations[1] += b.cg_iterations;
        turns += b.newton_iterations;
        off = fmax(off, farthest(alone, world));
    }
    printf("%zu contacts, %zu iterations of Newton's method, %zu of conjugate gradients instead of %zu, off by %.2g m\n",
           contacts, turns, iterations[1], iterations[0], off);
    assert_under(off, far_enough);
    assert_true(contacts > 50);
    assert_true(6 * iterations[1] < iterations[0]);
    assert_int_equal(d.analysed, 1);
    // a field that changes is no new arrangement; a constraint is
    OK(world, skein_set_path(world, "bodies.0.stretch.stiffness", skein_number(3e3)));
    steps(world, 1, 1.0 / 60);
    assert_int_equal(d.analysed, 1);
    add_spring(world, 0, 35, 1, 0);
    steps(world, 1, 1.0 / 60);
    assert_int_equal(d.analysed, 2);
    skein_world_destroy(alone);
    skein_world_destroy(world);
}

/* ---- failures ---- */

static void a_factor_that_fails_leaves_the_blocks(void **state) {
    (void)state;
    skein_world *alone = small_cloth(NULL);
    steps(alone, 20, 1.0 / 60);
    dense d = sound();
    d.fail_factor = 0;
    skein_world *world = small_cloth(&d);
    take_cholesky(world, 2);
    steps(world, 20, 1.0 / 60);
    skein_statistics s = statistics_of(world);
    assert_true(s.solver_failures > 0 && s.solver_failures == s.solver_factors);
    assert_true(skein_world_hash(world) == skein_world_hash(alone)); // as if it had not been asked for
    // what fails now and then
    for (int poison = 0; poison < 2; poison++) {
        size_t failures = 0;
        OK(world, skein_world_reset(world));
        for (int n = 0; n < 20; n++) {
            d.fail_factor = d.factored + (n % 3 != 0), d.fail_solve = d.solved + (size_t)(n % 5);
            d.poison = poison;
            steps(world, 1, 1.0 / 60);
            s = statistics_of(world);
            failures += s.solver_failures;
            assert_true(s.nonfinite == 0 && s.unsolved == 0);
        }
        assert_true(failures > 10);
        printf("%zu failures, off by %.2g m\n", failures, farthest(alone, world));
        assert_under(farthest(alone, world), far_enough);
    }
    skein_world_destroy(alone);
    skein_world_destroy(world);
}

static void what_analysing_says_the_step_says(void **state) {
    (void)state;
    dense d = sound(), other = sound();
    d.fail_analyse = SKEIN_ERROR_LIMIT;
    skein_world *world = small_cloth(&d);
    take_cholesky(world, 2);
    FAILS(world, SKEIN_ERROR_LIMIT, "the test says no", skein_world_step(world, 0.01));
    FAILS(world, SKEIN_ERROR_LIMIT, "the test says no", skein_world_step(world, 0.01));
    d.fail_analyse = SKEIN_OK;
    steps(world, 1, 0.01);
    FAILS(world, SKEIN_ERROR_VALUE, "needs analyse, factor and solve",
          skein_sparse_solver_set(world, &(skein_sparse_solver){"half", &other, analyse, NULL, solve, release}));
    assert_true(d.released == 0 && other.released == 0);
    give_dense(world, &other);
    assert_int_equal(d.released, 1);
    steps(world, 1, 0.01);
    assert_true(other.analysed == 1 && other.factored > 0);
    OK(world, skein_sparse_solver_set(world, NULL));
    assert_int_equal(other.released, 1);
    FAILS(world, SKEIN_ERROR_VALUE, "tools/setup build", skein_world_step(world, 0.01));
    FAILS(world, SKEIN_ERROR_VALUE, "method.preconditioner", skein_world_step(world, 0.01));
    OK(world, skein_set_path(world, "method.preconditioner", skein_text("blocks")));
    steps(world, 1, 0.01);
    skein_world_destroy(world);
    assert_int_equal(other.released, 1);
}

/* ---- CHOLMOD ---- */

/* A square metre of stiff cloth that swings down from two corners, in one substep a step. */
static skein_world *stiff_cloth(int side, int threads, bool cholesky, int turns) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    skein_error error;
    if (cholesky) assert_int_equal(skein_cholmod_attach(world, &error), SKEIN_OK);
    OK(world, skein_method_set(world, "backward_euler",
                               SKEIN_SETTINGS(SKEIN_REAL("substeps", 1), SKEIN_REAL("newton_iterations", turns),
                                              SKEIN_REAL("cg_iterations", 15),
                                              SKEIN_TEXT("preconditioner", cholesky ? "cholesky" : "blocks"))));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("density", 2), SKEIN_REAL("stretch.stiffness", 1e4),
                                            SKEIN_REAL("shear.stiffness", 1e3), SKEIN_TEXT("bend.by", "springs"),
                                            SKEIN_REAL("bend.stiffness", 100)),
                             NULL));
    add_gravity(world);
    return world;
}

static void cholmod_solves_what_blocks_leave(void **state) {
    (void)state;
    if (!skein_cholmod_is_here()) skip();
    enum { STEPS = 10 };
    size_t left[2] = {0, 0}, iterations[2] = {0, 0};
    for (int cholesky = 0; cholesky < 2; cholesky++) {
        skein_world *world =
            stiff_cloth(17, 1, cholesky, sizeof(skein_real) == 8 ? 40 : 12); // rounding ends them in float
        for (int n = 0; n < STEPS; n++) {
            steps(world, 1, 1.0 / 30);
            skein_statistics s = statistics_of(world);
            left[cholesky] += s.unsolved, iterations[cholesky] += s.cg_iterations;
            assert_int_equal(s.solver_failures, 0);
            assert_int_equal(s.solver_factors, cholesky ? s.newton_iterations : 0);
        }
        skein_world_destroy(world);
    }
    printf("of %d steps blocks left %zu (%zu iterations), a factor %zu (%zu)\n", STEPS, left[0], iterations[0], left[1],
           iterations[1]);
    assert_true(left[0] > STEPS / 2);
    assert_int_equal(left[1], 0);
}

/* Enough particles to be cut over threads. */
static void a_factor_gives_the_same_bits_again(void **state) {
    (void)state;
    if (!skein_cholmod_is_here()) skip();
    skein_world *one = stiff_cloth(65, 1, true, 1), *two = stiff_cloth(65, 2, true, 1);
    steps(one, 1, 1.0 / 60);
    steps(two, 1, 1.0 / 60);
    uint64_t hash = skein_world_hash(one);
    assert_true(skein_world_hash(two) == hash);
    OK(one, skein_world_reset(one));
    steps(one, 1, 1.0 / 60);
    assert_true(skein_world_hash(one) == hash);
    skein_world_destroy(one);
    skein_world_destroy(two);
}

static void without_cholmod_attaching_says_so(void **state) {
    (void)state;
    skein_world *world = new_world("backward_euler", 1);
    skein_error error;
    skein_status status = skein_cholmod_attach(world, &error);
    if (skein_cholmod_is_here()) {
        assert_int_equal(status, SKEIN_OK);
    } else {
        assert_int_equal(status, SKEIN_ERROR_VALUE);
        assert_non_null(strstr(error.message, "tools/setup build"));
    }
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_matrix_is_what_conjugate_gradients_multiply_by),
        cmocka_unit_test(the_motion_is_that_of_conjugate_gradients_alone),
        cmocka_unit_test(a_factor_that_fails_leaves_the_blocks),
        cmocka_unit_test(what_analysing_says_the_step_says),
        cmocka_unit_test(cholmod_solves_what_blocks_leave),
        cmocka_unit_test(a_factor_gives_the_same_bits_again),
        cmocka_unit_test(without_cholmod_attaching_says_so),
    };
    return cmocka_run_group_tests_name("sparse solvers", tests, NULL, NULL);
}
