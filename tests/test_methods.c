/* Methods against closed forms: one step of the oscillator tells them apart, their orders of convergence, what they
 * say of their own amplification, a pendulum, a hanging chain; and what they leave behind. */
#include "all_methods.h"
#include "helpers.h"
#include "world/world.h"

/* A particle of 1 kg at distance 2 + x from a held one, on a spring of rest length 2: the oscillator in x. */
static skein_world *oscillator(const char *method, int substeps, double omega, double zeta, double x, double v) {
    skein_world *world = new_world(method, substeps);
    uint32_t held = add_particle(world, 0, 0, 0, 0), free_one = add_particle(world, 1, 2, 0, 0);
    add_spring(world, held, free_one, omega * omega, 2 * zeta * omega);
    place_particle(world, free_one, 2 + x, 0, 0);
    throw_particle(world, free_one, v, 0, 0);
    return world;
}

/* ---- one step tells them apart ---- */

static void one_step_of_the_oscillator(void **state) {
    (void)state;
    static const struct {
        const char *method;
        double square; // of the amplitude, after a step of omega h = 0.5
    } rows[] = {
        {"explicit_euler", 1.25},     {"lookahead_euler", 0.8125}, {"midpoint", 1.015625},
        {"rk4", 0.99978976779513884}, {"backward_euler", 0.8},
    };
    for (size_t m = 0; m < COUNT(rows); m++) {
        skein_world *world = oscillator(rows[m].method, 1, 1, 0, 1, 0);
        if (!strcmp(rows[m].method, "backward_euler"))
            OK(world, skein_set_path(world, "method.tolerance", skein_number(1e-12)));
        steps(world, 1, 0.5);
        double x = position_of(world, 1).x - 2, v = velocity_of(world, 1).x;
        assert_near(x * x + v * v, rows[m].square, 8 * EPSILON);
        skein_world_destroy(world);
    }
}

/* Every method's matrix is what its substep does, with damping too. */
static void amplification_is_what_a_substep_does(void **state) {
    (void)state;
    static const double z[] = {0.3, 1.1}, zeta[] = {0, 0.2, 1.5};
    int told = 0;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t i = 0; i < COUNT(z); i++)
            for (size_t k = 0; k < COUNT(zeta); k++)
                for (int column = 0; column < 2; column++) {
                    skein_world *world = oscillator(all_methods[m], 1, 1, zeta[k], !column, column);
                    double matrix[4];
                    if (world->method->amplify) {
                        told++;
                        world->method->amplify(z[i], zeta[k], matrix);
                        steps(world, 1, z[i]);
                        assert_near(position_of(world, 1).x - 2, matrix[column], 40 * EPSILON);
                        assert_near(velocity_of(world, 1).x, matrix[2 + column], 40 * EPSILON);
                    }
                    skein_world_destroy(world);
                }
    assert_int_equal(told, 6 * COUNT(z) * COUNT(zeta) * 2);
}

/* ---- order of convergence ---- */

/* The error at t = 1 of an oscillator with omega = 2 and damping ratio zeta. */
static double error_of(const char *method, double zeta, int count) {
    const double omega = 2, damped = omega * sqrt(1 - zeta * zeta);
    skein_world *world = oscillator(method, count, omega, zeta, 0.5, 0);
    if (!strcmp(method, "backward_euler")) OK(world, skein_set_path(world, "method.tolerance", skein_number(1e-10)));
    steps(world, 1, 1);
    double decay = 0.5 * exp(-zeta * omega), ratio = zeta * omega / damped;
    double x = decay * (cos(damped) + ratio * sin(damped)), v = -decay * omega * omega / damped * sin(damped);
    double dx = position_of(world, 1).x - 2 - x, dv = velocity_of(world, 1).x - v;
    skein_world_destroy(world);
    return sqrt(omega * omega * dx * dx + dv * dv);
}

static void orders_of_convergence(void **state) {
    (void)state;
    bool is_double = sizeof(skein_real) == sizeof(double);
    for (size_t m = 0; m < COUNT(orders); m++)
        for (int damped = 0; damped < 2; damped++) {
            // fine enough for the order to show, and far from rounding: which in float leaves the fourth little room
            int coarse = orders[m].order == 1 ? 400 : orders[m].order == 2 ? 100 : 20;
            if (!is_double) coarse = orders[m].order == 1 ? 100 : orders[m].order == 2 ? 20 : 4;
            double zeta = damped ? 0.1 : 0, first = error_of(orders[m].method, zeta, coarse),
                   second = error_of(orders[m].method, zeta, 2 * coarse), order = log2(first / second);
            if (fabs(order - orders[m].order) > 0.1)
                print_message("%s: %.3f with a damping ratio of %g\n", orders[m].method, order, zeta);
            assert_near(order, orders[m].order, is_double ? 0.1 : 0.35);
        }
}

/* ---- a pendulum ---- */

/* The period of a pendulum of length 1 from 60 degrees: 4 K(sin 30) sqrt(l/g), K by the arithmetic-geometric mean. */
static double pendulum_period(double g) {
    double a = 1, b = cos(PI / 6);
    for (int i = 0; i < 30; i++) {
        double mean = (a + b) / 2;
        b = sqrt(a * b);
        a = mean;
    }
    return 2 * PI / a / sqrt(g);
}

static void a_pendulum_keeps_its_period(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    static const struct {
        const char *method;
        int substeps;
        double share;
    } rows[] = {{"backward_euler", 400, 0.01}, {"symplectic_euler", 100, 0.002}, {"leapfrog", 100, 0.002},
                {"rk4", 100, 0.002},           {"midpoint", 200, 0.002},         {"pbd", 100, 0.004},
                {"xpbd", 100, 0.004},          {"lookahead_euler", 400, 0.01}};
    for (size_t m = 0; m < COUNT(rows); m++) {
        skein_world *world = new_world(rows[m].method, rows[m].substeps);
        add_gravity(world);
        uint32_t held = add_particle(world, 0, 0, 0, 0);
        uint32_t bob = add_particle(world, 1, sin(PI / 3), -cos(PI / 3), 0);
        add_spring(world, held, bob, 2e4, 0);
        double period = pendulum_period(9.81), dt = period / 100, before = 1, crossing = 0;
        // the second time that it comes through the middle is at three quarters
        int seen = 0;
        for (int n = 1; n < 130 && seen < 2; n++) {
            steps(world, 1, dt);
            double x = position_of(world, bob).x;
            if (x * before < 0 && ++seen == 2) crossing = (n - x / (x - before)) * dt;
            before = x;
        }
        assert_int_equal(seen, 2);
        assert_share(crossing, 0.75 * period, rows[m].share);
        assert_share(length3(position_of(world, bob)), 1, 0.002);
        skein_world_destroy(world);
    }
}

/* ---- a chain ---- */

/* The depth of a catenary of length `length` between two points of one height, `span` apart. */
static double catenary_sag(double span, double length) {
    double low = 1e-3, high = 1e3; // 2 a sinh(span / 2a) falls with a
    for (int i = 0; i < 200; i++) {
        double a = (low + high) / 2;
        if (2 * a * sinh(span / (2 * a)) > length) low = a;
        else high = a;
    }
    return low * (cosh(span / (2 * low)) - 1);
}

static void a_chain_hangs_as_a_catenary(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    enum { LINKS = 20 };
    const double length = 1.5, span = 1;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        if (!strcmp(all_methods[m], "explicit_euler"))
            continue; // stable only with substeps that are out of the question
#ifdef SK_ONE_ISA
        if (m % 3) continue; // sanitizers need not see them all
#endif
        skein_world *world = new_world(all_methods[m], 20);
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 5)), NULL));
        uint32_t pairs[2 * LINKS];
        for (uint32_t i = 0; i <= LINKS; i++) {
            // a flat zigzag of the right length to begin with
            double x = span * i / LINKS, rise = sqrt(length * length - span * span) / LINKS;
            add_particle(world, i && i < LINKS ? 0.02 : 0, x, i % 2 ? -rise : 0, 0);
            if (i) pairs[2 * i - 2] = i - 1, pairs[2 * i - 1] = i;
        }
        OK(world, skein_constraint_add(world, "distance", pairs, LINKS,
                                       SKEIN_SETTINGS(SKEIN_REAL("stiffness", 5000), SKEIN_REAL("damping", 0.7)), NULL));
        steps(world, 180, 1.0 / 60);
        assert_under(statistics_of(world).kinetic_energy, 1e-4);
        assert_share(-position_of(world, LINKS / 2).y, catenary_sag(span, length), 0.01);
        skein_world_destroy(world);
    }
}

/* ---- what they leave behind ---- */

/* A method's own vectors go with it. */
static void temporaries_are_there_only_while_wanted(void **state) {
    (void)state;
    enum { PARTICLES = 500 };
    skein_world *world = new_world("symplectic_euler", 2);
    add_gravity(world);
    for (int i = 0; i < PARTICLES; i++) add_particle(world, 1, i, 0, 0);
    steps(world, 2, 0.01);
    size_t plain = statistics_of(world).memory_bytes;
    OK(world, skein_method_set(world, "rk4", NULL));
    steps(world, 1, 0.01);
    size_t more = statistics_of(world).memory_bytes;
    assert_true(more >= plain + 2 * PARTICLES * 4 * sizeof(skein_real));
    steps(world, 2, 0.01);
    assert_int_equal(statistics_of(world).memory_bytes, more);
    for (int i = 0; i < PARTICLES; i++) add_particle(world, 1, i, 1, 0); // they move, and are made again
    steps(world, 2, 0.01);
    assert_int_equal(statistics_of(world).nonfinite, 0);
    OK(world, skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 2))));
    steps(world, 1, 0.01);
    size_t back = statistics_of(world).memory_bytes;
    assert_true(back < more + 100 * PARTICLES * sizeof(skein_real));
    for (int v = SK_T0; v < SK_VECTOR_COUNT; v++) assert_null(world->particles.vector[v]);
    skein_world_destroy(world);
}

static void force_methods_refuse_what_is_rigid(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = oscillator(all_methods[m], 1, 1, 0, 0, 0);
        OK(world, skein_set_path(world, "constraints.0.stiffness", skein_number(INFINITY)));
        if (strstr(all_methods[m], "pbd")) steps(world, 1, 0.01);
        else FAILS(world, SKEIN_ERROR_VALUE, all_methods[m], skein_world_step(world, 0.01));
        skein_world_destroy(world);
    }
}

/* What hangs on a spring under PBD. Of n passes each has a = k h^2/nm and b = c h/nm, and makes of an error C that was
 * C0 when the substep began (C + b C0)/(1 + a + b). It rests where together they take back what gravity adds in a
 * substep; with one pass, or undamped and soft, that is m g/k, which the spring says. */
static void pbd_is_as_soft_as_its_springs(void **state) {
    (void)state;
    static const double stiffness[] = {0, 400, 36000, INFINITY}, dampings[] = {0, 30};
    const double h = 1.0 / 60;
    for (size_t k = 0; k < COUNT(stiffness); k++)
        for (int passes = 1; passes < 9; passes += 3)
            for (size_t c = 0; c < COUNT(dampings); c++) {
                skein_world *world = new_world("pbd", 1);
                OK(world, skein_set_path(world, "method.iterations", skein_number(passes)));
                add_gravity(world);
                OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 10)), NULL));
                uint32_t held = add_particle(world, 0, 0, 0, 0), bob = add_particle(world, 1, 0, -1, 0);
                add_spring(world, held, bob, stiffness[k], dampings[c]);
                steps(world, 240, h);
                double sag = -position_of(world, bob).y - 1, a = stiffness[k] * h * h / passes;
                double b = dampings[c] * h / passes, ought = 9.81 * h * h * (1 + b / a) / (pow(1 + a + b, passes) - 1);
                if (!stiffness[k]) assert_true(sag > 2);
                else assert_near(sag, isinf(a) ? 0 : ought, 1e-3 * sag + 1e-6);
                skein_world_destroy(world);
            }
}

/* Under XPBD what hangs on a spring sags by m g/k, whatever the passes: their multipliers are kept, damped or not. */
static void xpbd_is_as_soft_at_any_number_of_passes(void **state) {
    (void)state;
    for (int passes = 1; passes < 9; passes += 3)
        for (int damped = 0; damped < 2; damped++) {
            const double stiffness = 400;
            skein_world *world = new_world("xpbd", 1);
            OK(world, skein_set_path(world, "method.iterations", skein_number(passes)));
            add_gravity(world);
            OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 10)), NULL));
            uint32_t held = add_particle(world, 0, 0, 0, 0), bob = add_particle(world, 1, 0, -1, 0);
            add_spring(world, held, bob, stiffness, damped ? 5 : 0);
            steps(world, 240, 1.0 / 60);
            assert_near(-position_of(world, bob).y - 1, 9.81 / stiffness, 1e-5);
            skein_world_destroy(world);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_step_of_the_oscillator),
        cmocka_unit_test(amplification_is_what_a_substep_does),
        cmocka_unit_test(orders_of_convergence),
        cmocka_unit_test(a_pendulum_keeps_its_period),
        cmocka_unit_test(a_chain_hangs_as_a_catenary),
        cmocka_unit_test(temporaries_are_there_only_while_wanted),
        cmocka_unit_test(force_methods_refuse_what_is_rigid),
        cmocka_unit_test(pbd_is_as_soft_as_its_springs),
        cmocka_unit_test(xpbd_is_as_soft_at_any_number_of_passes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
