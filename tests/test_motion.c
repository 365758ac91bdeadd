/* Motion against closed forms: free fall, air, wind, and what is conserved. */
#include "helpers.h"

static const double g = 9.81;

/* Particles of different masses fall alike, and as the method's recurrence says:
 * v' = v - g h, x' = x + h v', so x(n) = x0 + v0 n h - g h^2 n (n + 1) / 2. */
static void free_fall_is_the_methods_recurrence(void **state) {
    (void)state;
    static const double masses[] = {0.001, 1, 7};
    enum { SUBSTEPS = 8, STEPS = 90 };
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], SUBSTEPS);
        add_gravity(world);
        for (size_t i = 0; i < COUNT(masses); i++) add_moving(world, masses[i], (double)i, 2, 0, 0.5, 3, -0.25);
        uint32_t held = add_particle(world, 0, 9, 2, 0);
        double h = 1.0 / 90 / SUBSTEPS;
        for (int n = 1; n <= STEPS; n++) {
            steps(world, 1, 1.0 / 90);
            double k = (double)n * SUBSTEPS, t = k * h;
            // a rounding a substep; position methods must not put the rounding of positions, divided by h, on top
            double rounding = 4 * EPSILON * k;
            for (size_t i = 0; i < COUNT(masses); i++) {
                vec3 x = position_of(world, i), v = velocity_of(world, i);
                assert_near(v.y, 3 - g * t, rounding);
                assert_near(v.x, 0.5, rounding);
                assert_near(v.z, -0.25, rounding);
                double drift = 4 * EPSILON * k + rounding * t;
                assert_near(x.y, 2 + 3 * t - g * h * h * k * (k + 1) / 2, drift);
                assert_near(x.x, (double)i + 0.5 * t, drift);
                assert_near(x.z, -0.25 * t, drift);
            }
        }
        assert_under(length3(minus(position_of(world, held), (vec3){9, 2, 0})), 0);
        assert_near(skein_world_time(world), 1, 1e-9);
        skein_world_destroy(world);
    }
}

/* Gravity is a vector, and no gravity is legal. */
static void gravity_has_any_direction(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 100);
        OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_VEC3("acceleration", 1, 2, -3)), NULL));
        OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_VEC3("acceleration", 0, 0, 0)), NULL));
        add_particle(world, 2, 0, 0, 0);
        steps(world, 10, 0.1);
        vec3 v = velocity_of(world, 0);
        assert_share(v.x, 1, 1e-3);
        assert_share(v.y, 2, 1e-3);
        assert_share(v.z, -3, 1e-3);
        skein_world_destroy(world);
    }
}

/* v(t) = (m g / K)(1 - exp(-K t / m)) for air damping F = -K v; `rate` is K / m for every mass. */
static void air_damping_is_exponential(void **state) {
    (void)state;
    static const double masses[] = {0.5, 2};
    double damping = 1.25, rate = 0.8;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int by_rate = 0; by_rate < 2; by_rate++) {
            skein_world *world = new_world(method_names[m], 10);
            add_gravity(world);
            OK(world, skein_force_add(world, "drag",
                                      by_rate ? SKEIN_SETTINGS(SKEIN_REAL("rate", rate))
                                              : SKEIN_SETTINGS(SKEIN_REAL("linear", damping)),
                                      NULL));
            for (size_t i = 0; i < COUNT(masses); i++) add_particle(world, masses[i], 0, 0, 0);
            for (int n = 1; n <= 6 * 90; n++) {
                steps(world, 1, 1.0 / 90);
                if (n % 45) continue;
                for (size_t i = 0; i < COUNT(masses); i++) {
                    double per_second = by_rate ? rate : damping / masses[i];
                    double ought = -g / per_second * (1 - exp(-per_second * n / 90));
                    assert_share(velocity_of(world, i).y, ought, 0.01);
                }
            }
            skein_world_destroy(world);
        }
}

/* Quadratic drag: falls at v = sqrt(m g / q) in the end, on the way as v tanh(g t / v). */
static void quadratic_drag_ends_at_terminal_speed(void **state) {
    (void)state;
    double mass = 0.4, q = 0.05, terminal = sqrt(mass * g / q);
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 10);
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("quadratic", q)), NULL));
        add_particle(world, mass, 0, 0, 0);
        steps(world, 90, 1.0 / 90);
        assert_share(velocity_of(world, 0).y, -terminal * tanh(g / terminal), 0.005);
        steps(world, 9 * 90, 1.0 / 90);
        assert_share(velocity_of(world, 0).y, -terminal, 0.002);
        skein_world_destroy(world);
    }
}

/* Plain wind is one force for all: light particles fly faster. */
static void wind_is_divided_by_mass(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 4);
        OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0.3, -0.2, 0.1)), NULL));
        for (int i = 0; i < 3; i++) add_particle(world, 0.5 * (i + 1), 0, 0, 0);
        add_particle(world, 0, 0, 0, 0);
        steps(world, 90, 1.0 / 90);
        for (int i = 0; i < 3; i++) {
            vec3 v = velocity_of(world, (size_t)i);
            double mass = 0.5 * (i + 1);
            assert_share(v.x, 0.3 / mass, 1e-3);
            assert_share(v.y, -0.2 / mass, 1e-3);
            assert_share(v.z, 0.1 / mass, 1e-3);
        }
        assert_under(length3(velocity_of(world, 3)), 0);
        skein_world_destroy(world);
    }
}

/* ---- Wind on triangles -------------------------------------------------------------------------- */

enum { SHEET = 3 }; /* vertices along a side */

/* A sheet of 0.8 x 0.5 m without any stiffness, turned, in a wind; it moves with `motion`. */
static skein_world *sheet_in_wind(const char *method, vec3 turn, vec3 wind, vec3 motion, double drag, double lift) {
    skein_world *world = new_world(method, 1);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", SHEET, SHEET), SKEIN_PAIR("size", 0.8, 0.5),
                                            SKEIN_REAL("density", 2), SKEIN_VEC3("rotation", turn.x, turn.y, turn.z),
                                            SKEIN_VEC3("velocity", motion.x, motion.y, motion.z),
                                            SKEIN_REAL("stretch.stiffness", 0), SKEIN_REAL("shear.stiffness", 0),
                                            SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 0)),
                             NULL));
    OK(world, skein_force_add(world, "surface_wind",
                              SKEIN_SETTINGS(SKEIN_VEC3("velocity", wind.x, wind.y, wind.z), SKEIN_REAL("drag", drag),
                                             SKEIN_REAL("lift", lift), SKEIN_REAL("density", 1.2)),
                              NULL));
    return world;
}

/* The force on the whole sheet: momentum gained in one short step. */
static vec3 wind_force(const char *method, vec3 turn, vec3 wind, vec3 motion, double drag, double lift) {
    skein_world *world = sheet_in_wind(method, turn, wind, motion, drag, lift);
    skein_statistics before = statistics_of(world);
    steps(world, 1, 1.0 / 64);
    skein_statistics after = statistics_of(world);
    skein_world_destroy(world);
    return (vec3){64 * (after.momentum[0] - before.momentum[0]), 64 * (after.momentum[1] - before.momentum[1]),
                  64 * (after.momentum[2] - before.momentum[2])};
}

static void wind_on_a_sheet_follows_its_formula(void **state) {
    (void)state;
    double area = 0.4, full = 0.5 * 1.2 * area * 0.9 * 9; // 1/2 rho A drag v^2 at 3 m/s
    vec3 still = {0, 0, 0}, level = {0, 0, 0};
    for (size_t m = 0; m < COUNT(method_names); m++) {
        const char *method = method_names[m];
        double off = 100 * EPSILON * full;
        // square to the wind: drag alone, whatever the lift, from either side and however the sheet is turned
        for (int lift = 0; lift < 2; lift++) {
            vec3 f = wind_force(method, level, (vec3){0, 3, 0}, still, 0.9, 0.4 * lift);
            assert_near(f.y, full, off);
            assert_under(f.x, off);
            assert_under(f.z, off);
            assert_near(wind_force(method, level, (vec3){0, -3, 0}, still, 0.9, 0.4 * lift).y, -full, off);
            assert_near(wind_force(method, (vec3){180, 0, 0}, (vec3){0, 3, 0}, still, 0.9, 0.4 * lift).y, full, off);
            assert_near(wind_force(method, (vec3){90, 0, 0}, (vec3){0, 0, 3}, still, 0.9, 0.4 * lift).z, full, off);
        }
        // edge-on: nothing
        assert_under(length3(wind_force(method, level, (vec3){3, 0, -2}, still, 0.9, 0.4)), off);
        // still air slows a sheet that flies: only the air's velocity past the sheet counts
        assert_near(wind_force(method, level, still, (vec3){0, 3, 0}, 0.9, 0.4).y, -full, off);
        assert_near(wind_force(method, level, still, (vec3){0, -3, 0}, 0.9, 0.4).y, full, off);
        assert_near(wind_force(method, level, (vec3){0, 4, 0}, (vec3){0, 1, 0}, 0.9, 0.4).y, full, off);
        assert_under(length3(wind_force(method, level, (vec3){1, 4, 0}, (vec3){1, 4, 0}, 0.9, 0.4)), off);
        // askew at 30 degrees to the sheet: drag along the wind, lift along the normal
        double s = sin(PI / 6), c = cos(PI / 6), half = 0.5 * 1.2 * area * 9;
        vec3 askew = wind_force(method, level, (vec3){3 * c, 3 * s, 0}, still, 0.9, 0.4);
        assert_near(askew.x, half * (0.9 - 0.4) * s * c, off);
        assert_near(askew.y, half * ((0.9 - 0.4) * s * s + 0.4 * s), off);
        assert_under(askew.z, off);
        // from the other side the lift is turned round
        askew = wind_force(method, level, (vec3){3 * c, -3 * s, 0}, still, 0.9, 0.4);
        assert_near(askew.x, half * (0.9 - 0.4) * s * c, off);
        assert_near(askew.y, -half * ((0.9 - 0.4) * s * s + 0.4 * s), off);
    }
}

/* Triangles that have lost their area, and air that stands still to them, make no numbers that are none. */
static void wind_on_nothing_is_nothing(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world =
            sheet_in_wind(method_names[m], (vec3){0, 0, 0}, (vec3){1, 4, 0}, (vec3){1, 4, 0}, 0.9, 0.4);
        steps(world, 1, 1.0 / 64);
        for (size_t i = 0; i < SHEET * SHEET; i++) place_particle(world, i, i < 5 ? 1 : 1.125, 0, 0);
        throw_particle(world, 8, 0, 1, 0);
        steps(world, 2, 1.0 / 64);
        assert_int_equal(statistics_of(world).nonfinite, 0);
        assert_under(length3(minus(velocity_of(world, 8), (vec3){0, 1, 0})), 0);
        skein_world_destroy(world);
    }
}

/* A triangle gives each corner a third: of quads cut from their first corner, the two corners of the cut get two
 * triangles' shares. */
static void wind_is_shared_by_the_corners(void **state) {
    (void)state;
    skein_world *world = sheet_in_wind("symplectic_euler", (vec3){0, 0, 0}, (vec3){0, 3, 0}, (vec3){0, 0, 0}, 1, 0.4);
    skein_surface surface;
    OK(world, skein_body_surface(world, skein_object_at(world, SKEIN_BODY, 0), &surface));
    double shares[SHEET * SHEET] = {0};
    for (size_t f = 0; f < surface.face_count; f++) {
        static const int cut[6] = {0, 1, 2, 0, 2, 3};
        for (int k = 0; k < 6; k++) shares[surface.face_vertices[4 * f + (size_t)cut[k]]] += 1;
    }
    steps(world, 1, 1.0 / 64);
    double each = 0.5 * 1.2 * 0.4 * 9 / 8 / 3; // eight triangles, three corners each
    for (size_t i = 0; i < SHEET * SHEET; i++) {
        double mass = (double)skein_velocity_view(world).xyzw[4 * skein_velocity_view(world).slot_of[i] + 3];
        assert_near(64 * mass * velocity_of(world, i).y, shares[i] * each, 20 * EPSILON);
    }
    skein_world_destroy(world);
}

/* ---- What is conserved -------------------------------------------------------------------------- */

/* A tangle without outer forces: damped springs between random particles, separation, and a loose cloth that its
 * strain limit holds together. Its momentum may change by roundings only. */
static void momentum_is_conserved(void **state) {
    (void)state;
    enum { LOOSE = 60 };
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 10);
        uint64_t seed = 3;
        for (int i = 0; i < LOOSE; i++)
            add_moving(world, random_between(&seed, 0.05, 0.3), random_between(&seed, -0.5, 0.5),
                       random_between(&seed, -0.5, 0.5), random_between(&seed, -0.5, 0.5), random_between(&seed, -1, 2),
                       random_between(&seed, -1, 2), random_between(&seed, -1, 1));
        uint32_t pairs[2 * LOOSE];
        for (uint32_t i = 0; i < LOOSE; i++) pairs[2 * i] = i, pairs[2 * i + 1] = (i * 7 + 11) % LOOSE;
        OK(world, skein_constraint_add(world, "distance", pairs, LOOSE,
                                       SKEIN_SETTINGS(SKEIN_REAL("stiffness", 50), SKEIN_REAL("damping", 0.5)), NULL));
        OK(world, skein_force_add(world, "separation",
                                  SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3), SKEIN_REAL("strength", 2)), NULL));
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 6, 7), SKEIN_REAL("density", 3),
                                                SKEIN_REAL("stretch.limit", 0.02), SKEIN_REAL("stretch.stiffness", 100),
                                                SKEIN_REAL("stretch.damping", 0.2)),
                                 NULL));
        for (uint32_t i = LOOSE; i < LOOSE + 42; i++)
            throw_particle(world, i, random_between(&seed, -2, 3), random_between(&seed, -2, 2),
                           random_between(&seed, -2, 2));
        skein_statistics before = statistics_of(world);
        double scale = 0; // sum of |m v|
        skein_view view = skein_velocity_view(world);
        for (size_t i = 0; i < view.count; i++)
            scale += (double)view.xyzw[4 * view.slot_of[i] + 3] * length3(velocity_of(world, i));
        steps(world, 60, 1.0 / 60);
        skein_statistics after = statistics_of(world);
        // XPBD corrects velocities by what positions moved: a rounding of those is divided by the substep
        double rounding = (m ? 1500 : 20) * EPSILON * scale;
        for (int k = 0; k < 3; k++) assert_near(after.momentum[k], before.momentum[k], rounding);
        // something did happen
        assert_true(after.kinetic_energy < 0.9 * before.kinetic_energy ||
                    after.kinetic_energy > 1.1 * before.kinetic_energy);
        skein_world_destroy(world);
    }
}

/* Springs pull along their own line, so that symplectic Euler keeps the angular momentum too. */
static void angular_momentum_is_conserved(void **state) {
    (void)state;
    enum { PARTICLES = 12 };
    skein_world *world = new_world("symplectic_euler", 20);
    uint64_t seed = 5;
    uint32_t pairs[2 * PARTICLES];
    for (uint32_t i = 0; i < PARTICLES; i++) {
        add_moving(world, random_between(&seed, 0.5, 2), random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                   random_between(&seed, -1, 1), random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                   random_between(&seed, -1, 1));
        pairs[2 * i] = i, pairs[2 * i + 1] = (i * 5 + 3) % PARTICLES;
    }
    OK(world, skein_constraint_add(world, "distance", pairs, PARTICLES,
                                   SKEIN_SETTINGS(SKEIN_REAL("stiffness", 30), SKEIN_REAL("damping", 0.4)), NULL));
    vec3 sums[2] = {{0, 0, 0}, {0, 0, 0}};
    double scale = 0;
    for (int when = 0; when < 2; when++) {
        skein_view view = skein_velocity_view(world);
        for (size_t i = 0; i < PARTICLES; i++) {
            double mass = (double)view.xyzw[4 * view.slot_of[i] + 3];
            vec3 x = position_of(world, i), v = velocity_of(world, i);
            sums[when].x += mass * (x.y * v.z - x.z * v.y);
            sums[when].y += mass * (x.z * v.x - x.x * v.z);
            sums[when].z += mass * (x.x * v.y - x.y * v.x);
            scale += mass * length3(x) * length3(v);
        }
        if (!when) steps(world, 120, 1.0 / 60);
    }
    assert_under(length3(minus(sums[1], sums[0])), 20 * EPSILON * scale);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_fall_is_the_methods_recurrence),
        cmocka_unit_test(gravity_has_any_direction),
        cmocka_unit_test(air_damping_is_exponential),
        cmocka_unit_test(quadratic_drag_ends_at_terminal_speed),
        cmocka_unit_test(wind_is_divided_by_mass),
        cmocka_unit_test(wind_on_a_sheet_follows_its_formula),
        cmocka_unit_test(wind_on_nothing_is_nothing),
        cmocka_unit_test(wind_is_shared_by_the_corners),
        cmocka_unit_test(momentum_is_conserved),
        cmocka_unit_test(angular_momentum_is_conserved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
