/* Forces and potentials that are formulas, held against closed forms under every method. */
#include <complex.h>

#include "all_methods.h"
#include "helpers.h"

static int order_of(const char *method) {
    for (size_t i = 0; i < COUNT(orders); i++)
        if (!strcmp(orders[i].method, method)) return orders[i].order;
    return 1; // position methods take forces as symplectic Euler does
}

static skein_world *alone(const char *method, int substeps, const char *kind, const skein_setting *settings, vec3 x,
                          vec3 v) {
    skein_world *world = new_world(method, substeps);
    OK(world, skein_force_add(world, kind, settings, NULL));
    add_moving(world, 2, x.x, x.y, x.z, v.x, v.y, v.z);
    return world;
}

/* ---- Closed forms ------------------------------------------------------------------------------- */

/* A uniform field and the potential of a height are gravity. */
static void uniform_fields_are_gravity(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        vec3 x[3], v[3];
        double energy[3];
        for (int i = 0; i < 3; i++) {
            skein_world *world =
                i == 0 ? alone(all_methods[m], 7, "gravity", NULL, (vec3){1, 2, 3}, (vec3){0, 4, 1})
                : i == 1
                    ? alone(all_methods[m], 7, "force_field",
                            SKEIN_SETTINGS(SKEIN_TEXT("force", "vec3(0, -g, 0)"), SKEIN_REAL("parameters.g", 9.81)),
                            (vec3){1, 2, 3}, (vec3){0, 4, 1})
                    : alone(all_methods[m], 7, "potential", SKEIN_SETTINGS(SKEIN_TEXT("energy", "9.81*p.y")),
                            (vec3){1, 2, 3}, (vec3){0, 4, 1});
            steps(world, 60, 1.0 / 60);
            x[i] = position_of(world, 0), v[i] = velocity_of(world, 0);
            energy[i] = statistics_of(world).potential_energy;
            skein_world_destroy(world);
        }
        for (int i = 1; i < 3; i++) {
            assert_under(length3(minus(x[i], x[0])), 100 * EPSILON);
            assert_under(length3(minus(v[i], v[0])), 100 * EPSILON);
        }
        assert_share(energy[2], energy[0], 10 * EPSILON);
        assert_true(energy[1] == 0);
    }
}

/* How far a run is from where it ought to be after `time`; each method's error shrinks as its order says. */
typedef vec3 closed_form(double t);

static double error_of(const char *method, int substeps, const char *kind, const skein_setting *settings,
                       closed_form *ought) {
    const double step = 0.25, end = 2, small = 1e-5;
    vec3 x = ought(0), ahead = ought(small), behind = ought(-small), away = minus(ahead, behind);
    vec3 v = {away.x / (2 * small), away.y / (2 * small), away.z / (2 * small)};
    skein_world *world = alone(method, substeps, kind, settings, x, v);
    steps(world, (int)(end / step), step);
    double off = length3(minus(position_of(world, 0), ought(end)));
    assert_int_equal(statistics_of(world).guarded, 0);
    skein_world_destroy(world);
    return off;
}

static void check_orders(const char *kind, const skein_setting *settings, closed_form *ought) {
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        int order = order_of(all_methods[m]), substeps = order == 4 ? 1 : order == 2 ? 8 : 100;
        double coarse = error_of(all_methods[m], substeps, kind, settings, ought);
        double fine = error_of(all_methods[m], 2 * substeps, kind, settings, ought);
        double least = pow(2, order) * 0.75;
        if (!(coarse < 0.05 && (fine * least <= coarse || fine < 2e-6)))
            print_message("%s of %s: %g, then %g\n", all_methods[m], kind, coarse, fine);
        assert_true(coarse < 0.05);
        assert_true(fine * least <= coarse || fine < 2e-6);
    }
}

static vec3 harmonic(double t) {
    return (vec3){cos(2 * t), 0.5 * sin(2 * t), 0.3 * cos(t)};
}

static void wells_swing(void **state) {
    (void)state;
    check_orders("potential",
                 SKEIN_SETTINGS(SKEIN_TEXT("energy", "0.5*(k*(p.x^2 + p.y^2) + p.z^2)"), SKEIN_REAL("parameters.k", 4)),
                 harmonic);
    // the same for particles of 2 kg, in newtons
    check_orders("potential",
                 SKEIN_SETTINGS(SKEIN_TEXT("energy", "k*(p.x^2 + p.y^2) + p.z^2"), SKEIN_REAL("parameters.k", 4),
                                SKEIN_TEXT("per", "particle")),
                 harmonic);
    check_orders("force_field", SKEIN_SETTINGS(SKEIN_TEXT("force", "-vec3(4*p.x, 4*p.y, p.z)")), harmonic);
    check_orders("force_field",
                 SKEIN_SETTINGS(SKEIN_TEXT("force", "-vec3(8*p.x, 8*p.y, 2*p.z)"), SKEIN_TEXT("per", "particle")),
                 harmonic);
}

/* Driven by time alone: x'' = a sin(w t). Each stage of a method has to look at its own time. */
static vec3 driven(double t) {
    return (vec3){-4.0 / 9 * sin(3 * t), 1 + t, cos(3 * t) / 9};
}

static void time_is_that_of_the_stage(void **state) {
    (void)state;
    check_orders("force_field",
                 SKEIN_SETTINGS(SKEIN_TEXT("force", "vec3(a*sin(w*t), 0, -cos(w*t))"), SKEIN_REAL("parameters.a", 4),
                                SKEIN_REAL("parameters.w", 3)),
                 driven);
    check_orders("potential", SKEIN_SETTINGS(SKEIN_TEXT("energy", "-4*sin(3*t)*p.x + cos(3*t)*p.z")), driven);
}

/* Air that turns at w takes a particle along: z'' = -k (z' - i w z) in the plane. */
static vec3 whirled(double t) {
    const double k = 2, w = 1.5;
    double complex root = csqrt(k * k + 4 * I * k * w), s = (-k + root) / 2, r = (-k - root) / 2;
    double complex z = 0.6 * cexp(s * t) + 0.4 * cexp(r * t);
    return (vec3){creal(z), 0, -cimag(z)}; // y is up: from z to x it turns to the left
}

static void air_that_turns_takes_along(void **state) {
    (void)state;
    check_orders("force_field",
                 SKEIN_SETTINGS(SKEIN_TEXT("force", "let air = cross(vec3(0, w, 0), p);\n-k*(v - air)"),
                                SKEIN_REAL("parameters.k", 2), SKEIN_REAL("parameters.w", 1.5)),
                 whirled);
}

/* Kepler: a = 1, e = 0.5; after 2 pi/sqrt(mu) it is back, and leapfrog keeps energy and areas. */
static void planets_come_back(void **state) {
    (void)state;
    const double mu = 4, e = 0.5, period = PI;
    static const char *const methods[] = {"leapfrog", "rk4"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world =
            alone(methods[m], 20, "potential",
                  SKEIN_SETTINGS(SKEIN_TEXT("energy", "-mu/length(p)"), SKEIN_REAL("parameters.mu", mu)),
                  (vec3){1 - e, 0, 0}, (vec3){0, sqrt(mu * (1 + e) / (1 - e)), 0});
        skein_statistics before = statistics_of(world);
        assert_share(before.kinetic_energy + before.potential_energy, -2 * mu / 2, 1e-6); // of 2 kg
        steps(world, 100, period / 100);
        skein_statistics after = statistics_of(world);
        vec3 x = position_of(world, 0);
        assert_under(length3(minus(x, (vec3){1 - e, 0, 0})), 2e-3);
        assert_near(after.kinetic_energy + after.potential_energy, -mu, 1e-3);
        assert_share(after.angular_momentum[2], before.angular_momentum[2], 1e-5);
        skein_world_destroy(world);
    }
}

/* ---- Implicit --------------------------------------------------------------------------------------- */

/* One substep of backward Euler in a well is (x + h v)/(1 + h^2 k), and takes one iteration of Newton's method. */
static void stiff_wells_are_solved_at_once(void **state) {
    (void)state;
    const double h = 1.0 / 60, k = 1e6;
    static const char *const kinds[] = {"potential", "force_field"};
    for (size_t i = 0; i < COUNT(kinds); i++) {
        skein_world *world =
            alone("backward_euler", 1, kinds[i],
                  i ? SKEIN_SETTINGS(SKEIN_TEXT("force", "-k*p"), SKEIN_REAL("parameters.k", k))
                    : SKEIN_SETTINGS(SKEIN_TEXT("energy", "k*dot(p, p)/2"), SKEIN_REAL("parameters.k", k)),
                  (vec3){0.3, -0.2, 0.1}, (vec3){1, 2, 3});
        steps(world, 1, h);
        vec3 x = position_of(world, 0);
        assert_near(x.x, (0.3 + h * 1) / (1 + h * h * k), 2e-6);
        assert_near(x.y, (-0.2 + h * 2) / (1 + h * h * k), 2e-6);
        skein_statistics s = statistics_of(world);
        assert_true(s.unsolved == 0 && s.newton_iterations <= 2);
        steps(world, 20, h);
        assert_under(length3(position_of(world, 0)), 1e-5);
        assert_under(statistics_of(world).kinetic_energy, 1e-6);
        skein_world_destroy(world);
    }
}

/* The second derivatives are all there: a well that is stiff along one slanted axis only is solved at once, too. */
static void slanted_wells_are_solved_at_once(void **state) {
    (void)state;
    const double h = 1.0 / 60, k = 1e5, axis[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    skein_world *world =
        alone("backward_euler", 1, "potential",
              SKEIN_SETTINGS(SKEIN_TEXT("energy", "k/2*dot(p, vec3(2, 3, 6)/7)^2"), SKEIN_REAL("parameters.k", k)),
              (vec3){0.3, -0.2, 0.1}, (vec3){1, 2, 3});
    vec3 start = {0.3 + h * 1, -0.2 + h * 2, 0.1 + h * 3};
    steps(world, 1, h);
    double along = start.x * axis[0] + start.y * axis[1] + start.z * axis[2], lost = along - along / (1 + h * h * k);
    vec3 x = position_of(world, 0);
    assert_near(x.x, start.x - lost * axis[0], 2e-6);
    assert_near(x.y, start.y - lost * axis[1], 2e-6);
    assert_near(x.z, start.z - lost * axis[2], 2e-6);
    assert_true(statistics_of(world).newton_iterations <= 2 && statistics_of(world).cg_iterations <= 6);
    skein_world_destroy(world);
}

/* Drag by a formula: v/(1 + h c), however large c is. */
static void stiff_drag_is_solved_at_once(void **state) {
    (void)state;
    skein_world *world = alone("backward_euler", 1, "force_field",
                               SKEIN_SETTINGS(SKEIN_TEXT("force", "-c*v"), SKEIN_REAL("parameters.c", 1e4)),
                               (vec3){0, 0, 0}, (vec3){1, 2, 3});
    steps(world, 1, 0.01);
    assert_share(velocity_of(world, 0).y, 2 / (1 + 0.01 * 1e4), 1e-4);
    assert_true(statistics_of(world).newton_iterations <= 2);
    skein_world_destroy(world);
}

/* Between two wells the potential curves downwards: the solve comes to an end all the same, in one of them. */
static void hills_are_left(void **state) {
    (void)state;
    skein_world *world = new_world("backward_euler", 1);
    OK(world,
       skein_force_add(world, "potential",
                       SKEIN_SETTINGS(SKEIN_TEXT("energy", "5000*(p.x^2 - 1)^2 + 20*sin(5*p.y)*cos(4*p.z)")), NULL));
    OK(world, skein_force_add(world, "force_field", SKEIN_SETTINGS(SKEIN_TEXT("force", "-v")), NULL));
    uint64_t seed = 5;
    for (int i = 0; i < 40; i++)
        add_particle(world, random_between(&seed, 0.1, 2), random_between(&seed, -0.1, 0.1),
                     random_between(&seed, -2, 2), random_between(&seed, -2, 2));
    size_t unsolved = 0;
    for (int i = 0; i < 300; i++) {
        steps(world, 1, 1.0 / 30);
        unsolved += statistics_of(world).unsolved;
    }
    assert_int_equal(unsolved, 0);
    for (size_t i = 0; i < 40; i++) assert_near(fabs(position_of(world, i).x), 1, 1e-3);
    skein_world_destroy(world);
}

/* ---- The rest ----------------------------------------------------------------------------------- */

static void awkward_fields_are_finite(void **state) {
    (void)state;
    static const char *const forces[] = {"p/length(p)^3", "vec3(1/p.x, log(p.y), sqrt(p.z))", "exp(100*p)",
                                         "normalize(v)*1e37*1e37", "vec3(p.x^0.3, acos(p.y*9), tan(p.z))"};
    static const char *const energies[] = {"1/length(p)", "log(p.x)", "exp(300*p.y)", "sqrt(p.z)", "p.x^0.3"};
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t i = 0; i < COUNT(forces) + COUNT(energies); i++) {
            skein_world *world = new_world(all_methods[m], 2);
            char text[100];
            bool force = i < COUNT(forces);
            if (force && strstr(forces[i], "exp")) snprintf(text, sizeof text, "vec3(exp(100*p.x), 0, 0)");
            else snprintf(text, sizeof text, "%s", force ? forces[i] : energies[i - COUNT(forces)]);
            OK(world, skein_force_add(world, force ? "force_field" : "potential",
                                      SKEIN_SETTINGS(SKEIN_TEXT(force ? "force" : "energy", text)), NULL));
            add_particle(world, 1, 0, 0, 0);
            add_particle(world, 1, 1e14, 1e14, 3);
            add_particle(world, 0, 0, 0, 0);
            skein_statistics before = statistics_of(world);
            if (!before.guarded) print_message("%s: nothing guarded\n", text);
            if (before.guarded > 2) print_message("%s: %zu guarded\n", text, before.guarded);
            assert_true(before.guarded >= 1 && before.guarded <= 2);
            assert_true(isfinite(before.potential_energy));
            steps(world, 3, 1.0 / 60);
            skein_statistics after = statistics_of(world);
            if (after.nonfinite) print_message("%s under %s\n", text, all_methods[m]);
            assert_int_equal(after.nonfinite, 0);
            skein_world_destroy(world);
        }
}

static uint64_t hash_under(const char *isa, const char *method, int threads) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    if (isa[0]) setenv("SKEIN_SIMD", isa, 1);
    skein_world *world = skein_world_create(&desc, NULL);
    unsetenv("SKEIN_SIMD");
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 15))));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 20, 20), SKEIN_REAL("stretch.stiffness", 20),
                                            SKEIN_REAL("shear.stiffness", 2), SKEIN_TEXT("bend.by", "springs"),
                                            SKEIN_REAL("bend.stiffness", 1)),
                             NULL));
    OK(world, skein_force_add(world, "potential",
                              SKEIN_SETTINGS(SKEIN_TEXT("energy", "a*sin(5*p.x - t)*cos(p.z) + p.y^2"),
                                             SKEIN_REAL("parameters.a", 2)),
                              NULL));
    OK(world,
       skein_force_add(world, "force_field",
                       SKEIN_SETTINGS(SKEIN_TEXT("force", "cross(v, vec3(0, exp(-dot(p, p)), 1)) - 0.1*v")), NULL));
    steps(world, 12, 1.0 / 60);
    assert_int_equal(statistics_of(world).nonfinite, 0);
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

static void bits_do_not_depend_on_the_machine(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    static const char *const methods[] = {"symplectic_euler", "backward_euler", "xpbd"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        uint64_t hash = hash_under("", methods[m], 1);
#ifndef SK_ONE_ISA
        static const char *const isas[] = {"sse", "avx2", "avx512"};
        for (size_t i = 0; i < COUNT(isas); i++) {
            uint64_t other = hash_under(isas[i], methods[m], 1);
            if (other != hash)
                print_message("%s, %s: %llx, not %llx\n", methods[m], isas[i], (unsigned long long)other,
                              (unsigned long long)hash);
            assert_true(other == hash);
        }
#endif
        assert_true(hash_under("", methods[m], 3) == hash);
    }
}

static void texts_change_while_they_live(void **state) {
    (void)state;
    skein_world *world = alone("leapfrog", 4, "force_field",
                               SKEIN_SETTINGS(SKEIN_TEXT("force", "vec3(0, a, 0)"), SKEIN_REAL("parameters.a", 1)),
                               (vec3){0, 0, 0}, (vec3){0, 0, 0});
    skein_handle force = skein_object_at(world, SKEIN_FORCE, 0);
    steps(world, 10, 0.1);
    assert_near(velocity_of(world, 0).y, 1, 1e-5);
    FAILS(world, SKEIN_ERROR_VALUE, "expected a vector", skein_set(world, force, "force", skein_text("a")));
    FAILS(world, SKEIN_ERROR_SYNTAX, "column 8", skein_set(world, force, "force", skein_text("vec3(0,")));
    OK(world, skein_set_path(world, "forces.0.parameters.a", skein_number(-1)));
    steps(world, 10, 0.1);
    assert_near(velocity_of(world, 0).y, 0, 1e-5);
    OK(world, skein_set(world, force, "force", skein_text("-a*v + vec3(1, 0, 0)"))); // a is -1: it grows
    steps(world, 10, 0.1);
    assert_near(velocity_of(world, 0).x, exp(1) - 1, 1e-2);
    skein_world_destroy(world);
}

/* What a picture of a field asks for. */
static void fields_are_probed(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    const double points[] = {1, 2, 3, -1, 0.5, 0};
    double forces[6];
    skein_handle field, well, gravity;
    OK(world,
       skein_force_add(world, "force_field",
                       SKEIN_SETTINGS(SKEIN_TEXT("force", "k*vec3(p.y, t, -p.x) - 5*v"), SKEIN_REAL("parameters.k", 2)),
                       &field));
    OK(world, skein_force_add(world, "potential", SKEIN_SETTINGS(SKEIN_TEXT("energy", "dot(p, p)*p.y")), &well));
    OK(world, skein_force_add(world, "gravity", NULL, &gravity));
    add_particle(world, 1, 9, 9, 9);
    steps(world, 4, 0.25);
    OK(world, skein_force_probe(world, field, 2, points, forces));
    static const double by_field[] = {4, 2, -2, 1, 2, 2};
    for (int i = 0; i < 6; i++) assert_near(forces[i], by_field[i], 1e-12);
    OK(world, skein_force_probe(world, well, 2, points, forces));
    for (int i = 0; i < 2; i++) {
        const double *p = points + 3 * i, square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
        for (int k = 0; k < 3; k++) assert_near(forces[3 * i + k], -2 * p[k] * p[1] - (k == 1) * square, 1e-12);
    }
    FAILS(world, SKEIN_ERROR_VALUE, "gravity is no field", skein_force_probe(world, gravity, 1, points, forces));
    OK(world, skein_remove(world, field));
    FAILS(world, SKEIN_ERROR_HANDLE, "stale", skein_force_probe(world, field, 1, points, forces));
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(uniform_fields_are_gravity),
        cmocka_unit_test(wells_swing),
        cmocka_unit_test(time_is_that_of_the_stage),
        cmocka_unit_test(air_that_turns_takes_along),
        cmocka_unit_test(planets_come_back),
        cmocka_unit_test(stiff_wells_are_solved_at_once),
        cmocka_unit_test(slanted_wells_are_solved_at_once),
        cmocka_unit_test(stiff_drag_is_solved_at_once),
        cmocka_unit_test(hills_are_left),
        cmocka_unit_test(awkward_fields_are_finite),
        cmocka_unit_test(bits_do_not_depend_on_the_machine),
        cmocka_unit_test(texts_change_while_they_live),
        cmocka_unit_test(fields_are_probed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
