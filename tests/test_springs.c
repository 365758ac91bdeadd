/* Springs against closed forms: period and damping of an oscillator, a pendulum, hanging weights; and that
 * stiffness is a property of the material: not of the substeps, the iterations or the resolution. */
#include "helpers.h"

static const double g = 9.81;

/* A mass on a spring along x: held at 0, rest length 1, pulled out to 1 + `stretch`. */
static skein_world *oscillator(const char *method, int substeps, int iterations, double mass, double stiffness,
                               double damping, double stretch) {
    skein_world *world = new_world(method, substeps);
    if (iterations) OK(world, skein_set_path(world, "method.iterations", skein_number(iterations)));
    uint32_t anchor = add_particle(world, 0, 0, 0, 0), bob = add_particle(world, mass, 1, 0, 0);
    add_spring(world, anchor, bob, stiffness, damping);
    place_particle(world, bob, 1 + stretch, 0, 0);
    return world;
}

/* Times at which the mass passes its rest length outwards, and the greatest stretch between them. */
typedef struct swing {
    double period; /* s, the mean of those seen */
    double decay;  /* 1/s, of the amplitude */
    int turns;
} swing;

static swing watch(skein_world *world, double dt, int turns) {
    double before = position_of(world, 1).x - 1, top = before, first = 0, last = 0, first_top = 0, last_top = 0;
    swing seen = {0, 0, -1};
    for (int n = 1; n < 5000 && seen.turns < turns; n++) {
        steps(world, 1, dt);
        double now = position_of(world, 1).x - 1;
        if (now > top) top = now;
        if (before < 0 && now >= 0) {
            double crossing = dt * (n - 1 + before / (before - now));
            if (++seen.turns == 0) first = crossing;
            // the top that belongs to the swing before this crossing
            if (seen.turns == 1) first_top = top;
            last = crossing, last_top = top, top = 0;
        }
        before = now;
    }
    if (seen.turns > 0) seen.period = (last - first) / seen.turns;
    if (seen.turns > 1) seen.decay = log(first_top / last_top) / (seen.period * (seen.turns - 1));
    return seen;
}

/* The period of a damped oscillator, 2 pi / sqrt(k/m - (c/2m)^2), and its decay, exp(-c t / 2m). */
static void an_oscillator_has_its_period_and_decay(void **state) {
    (void)state;
    static const double masses[] = {0.5, 3}, dampings[] = {0, 0.2, 0.6};
    double stiffness = 25;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t i = 0; i < COUNT(masses); i++)
            for (size_t c = 0; c < COUNT(dampings); c++) {
                double decay = dampings[c] / (2 * masses[i]), omega = sqrt(stiffness / masses[i] - decay * decay);
                // XPBD moves positions by whole roundings of theirs: in float more substeps make that worse
                bool exact = m == 0 || EPSILON < 1e-10;
                double rate = EPSILON < 1e-10 ? 9000 : 1800;
                skein_world *world =
                    oscillator(method_names[m], (int)(rate / 180), 0, masses[i], stiffness, dampings[c], 0.25);
                swing seen = watch(world, 1.0 / 180, 5);
                assert_int_equal(seen.turns, 5);
                assert_share(seen.period, 2 * PI / omega, exact ? 5e-4 : 6e-3);
                // XPBD is implicit Euler here (see below): its own decay is omega^2 h / 2
                double own = m ? omega * omega / rate / 2 : 0;
                assert_near(seen.decay, decay + own, exact ? 1e-4 + 1e-3 * decay : 1e-3 + 0.025 * decay);
                skein_world_destroy(world);
            }
}

/* One constraint is solved exactly by one pass, so XPBD is implicit Euler: (1 + h c/m + h^2 k/m) v' = v - h k/m C.
 * More passes find nothing left to do, with damping and without. */
static void an_xpbd_oscillator_is_implicit_euler(void **state) {
    (void)state;
    static const double dampings[] = {0, 1.5, 40};
    static const int iterations[] = {1, 2, 7};
    double mass = 0.7, stiffness = 300;
    for (size_t c = 0; c < COUNT(dampings); c++)
        for (size_t i = 0; i < COUNT(iterations); i++) {
            enum { SUBSTEPS = 3 };
            skein_world *world = oscillator("xpbd", SUBSTEPS, iterations[i], mass, stiffness, dampings[c], 0.1);
            double h = 1.0 / 90 / SUBSTEPS, x = 0.1, v = 0;
            for (int n = 0; n < 60; n++) {
                steps(world, 1, 1.0 / 90);
                for (int k = 0; k < SUBSTEPS; k++) {
                    v = (v - h * stiffness / mass * x) / (1 + h * dampings[c] / mass + h * h * stiffness / mass);
                    x += h * v;
                }
                // positions near 1 m: their rounding over a substep is a velocity
                assert_near(position_of(world, 1).x - 1, x, 50 * EPSILON);
                assert_near(velocity_of(world, 1).x, v, 50 * EPSILON / h);
            }
            skein_world_destroy(world);
        }
}

/* Symplectic Euler: v' = v - h (k C + c v)/m, x' = x + h v'. */
static void a_symplectic_oscillator_is_its_recurrence(void **state) {
    (void)state;
    double mass = 0.7, stiffness = 300, damping = 1.5, h = 1.0 / 270, x = 0.1, v = 0;
    skein_world *world = oscillator("symplectic_euler", 3, 0, mass, stiffness, damping, 0.1);
    for (int n = 0; n < 60; n++) {
        steps(world, 1, 1.0 / 90);
        for (int k = 0; k < 3; k++) {
            v -= h * (stiffness * x + damping * v) / mass;
            x += h * v;
        }
        assert_near(position_of(world, 1).x - 1, x, 50 * EPSILON);
        assert_near(velocity_of(world, 1).x, v, 50 * EPSILON / h);
    }
    skein_world_destroy(world);
}

/* Damping acts along the spring only: two masses that circle each other at rest length keep their speed. */
static void damping_leaves_other_motion_alone(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 20);
        add_moving(world, 1, -0.5, 0, 0, 0.3, -1, 0.2);
        add_moving(world, 1, 0.5, 0, 0, 0.3, 1, 0.2);
        add_spring(world, 0, 1, 2000, 5);
        steps(world, 120, 1.0 / 60);
        // the turning pulls the spring out to r with k (2r - 1) = v^2/r: angular momentum r v stays
        vec3 across = minus(position_of(world, 1), position_of(world, 0)),
             apart = minus(velocity_of(world, 1), velocity_of(world, 0));
        double turning = fabs(across.x * apart.y - across.y * apart.x);
        assert_share(turning, 2, m ? 0.02 : 1e-3);
        assert_share(velocity_of(world, 0).z, 0.2, 0.01);
        assert_share(velocity_of(world, 0).x + velocity_of(world, 1).x, 0.6, 0.01);
        skein_world_destroy(world);
    }
}

/* A rigid rod swings as a pendulum: T = 2 pi sqrt(L/g) (1 + a^2/16) for an amplitude of a. */
static void a_rigid_pendulum_keeps_time(void **state) {
    (void)state;
    double length = 0.7, angle = 0.2;
    skein_world *world = new_world("xpbd", 20);
    add_gravity(world);
    uint32_t pivot = add_particle(world, 0, 0, 2, 0),
             bob = add_particle(world, 0.3, length * sin(angle), 2 - length * cos(angle), 0);
    add_spring(world, pivot, bob, INFINITY, 0);
    double first = 0, last = 0, before = 1, widest = 0;
    int turns = -1;
    for (int n = 1; n <= 90 * 10; n++) {
        steps(world, 1, 1.0 / 90);
        vec3 d = minus(position_of(world, bob), (vec3){0, 2, 0});
        assert_share(length3(d), length, 1e-5);
        if (n > 90 * 8 && fabs(d.x) > widest) widest = fabs(d.x);
        if (before < 0 && d.x >= 0) {
            last = (n - 1 + before / (before - d.x)) / 90;
            if (++turns == 0) first = last;
        }
        before = d.x;
    }
    assert_share((last - first) / turns, 2 * PI * sqrt(length / g) * (1 + angle * angle / 16), 2e-3);
    assert_share(widest, length * sin(angle), 0.05); // and hardly tires
    skein_world_destroy(world);
}

/* Ends in one place have no direction to part in, and a spring without stiffness has nothing to say: neither makes
 * numbers that are none. */
static void springs_without_a_direction_or_stiffness_are_harmless(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int iterations = 1; iterations <= (m ? 3 : 1); iterations++)
            for (int damped = 0; damped < 2; damped++) {
                skein_world *world = new_world(method_names[m], 4);
                if (m) OK(world, skein_set_path(world, "method.iterations", skein_number(iterations)));
                for (int i = 0; i < 4; i++) add_particle(world, 1, i, 0, 0);
                add_spring(world, 0, 1, 100, damped ? 0.5 : 0);
                add_spring(world, 2, 3, 0, damped ? 0.5 : 0);
                place_particle(world, 1, 0, 0, 0); // onto its other end
                place_particle(world, 3, 9, 0, 0);
                throw_particle(world, 3, 1, 2, 3);
                steps(world, 9, 1.0 / 90);
                assert_int_equal(statistics_of(world).nonfinite, 0);
                assert_under(length3(minus(position_of(world, 1), position_of(world, 0))), 0);
                assert_near(velocity_of(world, 3).x, 1, m ? 1e-3 : 1e-5);
                assert_under(length3(velocity_of(world, 2)), 1e-6);
                skein_world_destroy(world);
            }
}

/* Springs between a body and loose particles: one step's impulse is h k C for symplectic Euler, and for XPBD, implicit,
 * h k C / (1 + h^2 k (w + w')); equal and opposite, and nobody else feels it. */
static void springs_join_bodies_and_loose_particles(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int damped = 0; damped < 2; damped++) {
            skein_world *world = new_world(method_names[m], 1);
            OK(world,
               skein_body_add(world, "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_PAIR("grid", 6, 7), SKEIN_REAL("density", 50),
                                             SKEIN_REAL("stretch.stiffness", 0), SKEIN_REAL("stretch.tether", INFINITY),
                                             SKEIN_REAL("shear.stiffness", 0), SKEIN_TEXT("bend.by", "springs"),
                                             SKEIN_REAL("bend.stiffness", 0)),
                              NULL));
            vec3 knot = position_of(world, 16);
            uint32_t weight = add_particle(world, 0.5, knot.x, knot.y - 0.5, knot.z),
                     other = add_particle(world, 2, 3, 3, 3);
            uint32_t pairs[] = {16, weight, other, weight};
            OK(world, skein_constraint_add(
                          world, "distance", pairs, 2,
                          SKEIN_SETTINGS(SKEIN_REAL("stiffness", 30), SKEIN_REAL("damping", damped ? 1e-9 : 0)), NULL));
            place_particle(world, weight, knot.x, knot.y - 0.75, knot.z); // the first is 0.25 m too long
            vec3 apart = minus(position_of(world, weight), (vec3){3, 3, 3});
            place_particle(world, other, 3, 3, 3);
            double h = 1.0 / 32, knot_mass = 50.0 / 5 / 6;
            double first = h * 30 * 0.25, soft = h * h * 30;
            if (m) first /= 1 + soft * (1 / 0.5 + 1 / knot_mass);
            steps(world, 1, h);
            assert_near(knot_mass * velocity_of(world, 16).y, -first, 1e-5);
            vec3 v = velocity_of(world, other), u = velocity_of(world, weight);
            assert_near(0.5 * u.y + knot_mass * velocity_of(world, 16).y + 2 * v.y, 0, 1e-5);
            assert_near(0.5 * u.x + 2 * v.x, 0, 1e-5);
            assert_near(v.x * apart.y, v.y * apart.x, 0.05 * fabs(v.y * apart.x) + 1e-6); // along its own line
            for (size_t i = 0; i < 42; i++)
                if (i != 16) assert_under(length3(velocity_of(world, i)), 0);
            skein_world_destroy(world);
        }
}

/* Nothing is lost where pairs come twice: springs side by side are one of twice the stiffness. */
static void the_same_pair_twice_is_twice_as_stiff(void **state) {
    (void)state;
    enum { SIDE = 7 };
    vec3 place[2][SIDE * SIDE];
    for (int twice = 0; twice < 2; twice++) {
        skein_world *world = new_world("symplectic_euler", 10);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_REAL("density", 5),
                                                SKEIN_REAL("stretch.stiffness", 0), SKEIN_REAL("shear.stiffness", 0),
                                                SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 0),
                                                SKEIN_REAL("stretch.limit", INFINITY)),
                                 NULL));
        uint32_t pairs[2 * 2 * SIDE * SIDE];
        size_t count = 0;
        for (int turn = 0; turn <= twice; turn++)
            for (uint32_t i = 0; i < SIDE * SIDE; i++)
                if (i % SIDE) pairs[2 * count] = turn ? i : i - 1, pairs[2 * count++ + 1] = turn ? i - 1 : i;
        OK(world, skein_constraint_add(world, "distance", pairs, count,
                                       SKEIN_SETTINGS(SKEIN_REAL("stiffness", twice ? 10 : 20)), NULL));
        for (uint32_t i = 0; i < SIDE * SIDE; i++)
            throw_particle(world, i, 0.1 * (double)(i % 5), 0.2 * (double)(i % 3), -0.3 * (double)(i % 4));
        steps(world, 20, 1.0 / 90);
        for (size_t i = 0; i < SIDE * SIDE; i++) place[twice][i] = position_of(world, i);
        skein_world_destroy(world);
    }
    for (size_t i = 0; i < SIDE * SIDE; i++) assert_under(length3(minus(place[0][i], place[1][i])), 1e-5);
}

/* ---- Stiffness has units ------------------------------------------------------------------------ */

/* Weights on a row of springs: each spring bears the weight below it, so the lowest hangs
 * m g / k (n + (n - 1) + ... + 1) lower. Whatever the substeps and the iterations. */
static void hanging_weights_sag_as_much_however_they_are_stepped(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    enum { WEIGHTS = 6 };
    static const struct {
        const char *method;
        int substeps, iterations;
    } ways[] = {{"symplectic_euler", 10, 0},
                {"symplectic_euler", 35, 0},
                {"xpbd", 10, 1},
                {"xpbd", 40, 1},
                {"xpbd", 10, 4},
                {"xpbd", 3, 20},
                {"xpbd", 1, 60}};
    double mass = 0.1, stiffness = 60, sag = mass * g / stiffness * (WEIGHTS * (WEIGHTS + 1) / 2);
    for (size_t w = 0; w < COUNT(ways); w++) {
        skein_world *world = new_world(ways[w].method, ways[w].substeps);
        if (ways[w].iterations) OK(world, skein_set_path(world, "method.iterations", skein_number(ways[w].iterations)));
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 5)), NULL));
        for (int i = 0; i <= WEIGHTS; i++) add_particle(world, i ? mass : 0, 0, -0.2 * i, 0);
        for (uint32_t i = 0; i < WEIGHTS; i++) add_spring(world, i, i + 1, stiffness, 0.5);
        steps(world, 90 * 5, 1.0 / 90);
        assert_share(-0.2 * WEIGHTS - position_of(world, WEIGHTS).y, sag, 0.02);
        assert_share(-0.2 - position_of(world, 1).y, mass * g / stiffness * WEIGHTS, 0.02);
        skein_world_destroy(world);
    }
}

/* A strip of cloth, half a metre wide, hangs straight down from its upper edge: rows x columns vertices, as a grid or
 * cut into triangles. How far its lower edge, a metre below, sags in the end. */
static double sag_of_strip(const char *method, int substeps, int rows, int columns, double shear, bool triangles) {
    skein_world *world = new_world(method, substeps);
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 4)), NULL));
    double positions[3 * 9 * 5];
    uint32_t sizes[8 * 4 * 2], corners[8 * 4 * 6];
    size_t faces = 0, filled = 0;
    for (int r = 0; r < rows && triangles; r++)
        for (int c = 0; c < columns; c++) {
            double *p = positions + 3 * (r * columns + c);
            p[0] = 0.5 * c / (columns - 1), p[1] = 0.5 - 1.0 * r / (rows - 1), p[2] = 0;
        }
    for (uint32_t r = 0; r + 1 < (uint32_t)rows && triangles; r++)
        for (uint32_t c = 0; c + 1 < (uint32_t)columns; c++) {
            uint32_t a = r * (uint32_t)columns + c, b = a + (uint32_t)columns, quad[4] = {a, b, b + 1, a + 1};
            static const int cut[6] = {0, 1, 2, 0, 2, 3};
            // cut this way and that in turn, as a chessboard: no direction is preferred
            for (int k = 0; k < 6; k++) corners[filled++] = quad[((uint32_t)cut[k] + r + c) % 4];
            sizes[faces++] = 3, sizes[faces++] = 3;
        }
    skein_mesh mesh = {positions, (size_t)(rows * columns), sizes, faces, corners, filled};
    OK(world, skein_body_add(world, "cloth", triangles ? &mesh : NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", triangles ? 0 : rows, triangles ? 0 : columns),
                                            SKEIN_PAIR("size", 0.5, 1), SKEIN_VEC3("rotation", triangles ? 0 : 90, 0, 0),
                                            SKEIN_REAL("density", 0.5), SKEIN_TEXT("pins", "top edge"),
                                            SKEIN_REAL("stretch.stiffness", 20), SKEIN_REAL("stretch.damping", 0.02),
                                            SKEIN_REAL("shear.stiffness", shear), SKEIN_TEXT("bend.by", "springs"),
                                            SKEIN_REAL("bend.stiffness", 0), SKEIN_REAL("stretch.limit", INFINITY),
                                            SKEIN_REAL("stretch.tether", INFINITY)),
                             NULL));
    steps(world, 60 * 4, 1.0 / 60);
    double sag = 0;
    for (int c = 0; c < columns; c++) sag -= (position_of(world, (size_t)((rows - 1) * columns + c)).y + 0.5) / columns;
    skein_world_destroy(world);
    return sag;
}

/* A sheet of stiffness K that hangs from its edge is longer by density g L^2 / 2K, at any resolution. (A grid puts its
 * masses at the ends of cells: the same, for at either edge it puts half as much.) */
static void cloth_sags_as_much_at_any_resolution(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    double ought = 0.5 * g * 1 / (2 * 20);
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int n = 5; n <= 17; n = 2 * n - 1)
            assert_share(sag_of_strip(method_names[m], n > 9 ? 24 : 16, n, (n + 1) / 2, 0, false), ought, 0.02);
    // shear makes it a little stiffer, but alike at both resolutions; so do triangles
    for (int triangles = 0; triangles < 2; triangles++) {
        double coarse = sag_of_strip("xpbd", 12, 5, 3, 4, triangles),
               fine = sag_of_strip("xpbd", 16, 9, 5, 4, triangles);
        assert_share(fine, coarse, 0.04);
        assert_share(coarse, ought, 0.25);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_oscillator_has_its_period_and_decay),
        cmocka_unit_test(an_xpbd_oscillator_is_implicit_euler),
        cmocka_unit_test(a_symplectic_oscillator_is_its_recurrence),
        cmocka_unit_test(damping_leaves_other_motion_alone),
        cmocka_unit_test(a_rigid_pendulum_keeps_time),
        cmocka_unit_test(springs_without_a_direction_or_stiffness_are_harmless),
        cmocka_unit_test(springs_join_bodies_and_loose_particles),
        cmocka_unit_test(the_same_pair_twice_is_twice_as_stiff),
        cmocka_unit_test(hanging_weights_sag_as_much_however_they_are_stepped),
        cmocka_unit_test(cloth_sags_as_much_at_any_resolution),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
