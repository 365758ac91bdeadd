/* What is fast does not pass: particles and cloth at up to 400 m/s against thin boxes, formulas' walls and shells, balls and capsules,
 * standing, coming towards them or turning into them, under every method; and what flies by is let by. */
#include "all_methods.h"
#include "helpers.h"

static const double dt = 1.0 / 60;

/* A plate 1 mm thick and 60 m wide, level, by its kind. */
static skein_handle add_plate(skein_world *world, const char *kind, double thickness, double velocity) {
    skein_handle handle;
    bool box = !strcmp(kind, "box");
    skein_setting settings[] = {SKEIN_VEC3("rotation", 0, 30, 0), SKEIN_REAL("thickness", thickness),
                                SKEIN_VEC3("motion.velocity", 0, velocity, 0), SKEIN_VEC3("size", 60, 0.001, 60),
                                SKEIN_END};
    if (!box) settings[3] = (skein_setting)SKEIN_TEXT("surface", "abs(p.y) - 0.0005");
    OK(world, skein_collider_add(world, kind, settings, &handle));
    return handle;
}

static void nothing_passes_a_plate(void **state) {
    (void)state;
    static const double speeds[] = {2, 20, 200, 400}, thicknesses[] = {0, 0.0005, 0.002, 0.01}, aslant[] = {0, 30, -80};
    static const char *const kinds[] = {"box", "formula"};
    for (size_t i = 0; i < COUNT(all_methods); i++)
        for (int n = 0; n < 4 * 4 * 3 * 2 * 2; n++) {
            double speed = speeds[n % 4], thickness = thicknesses[n / 4 % 4], side = aslant[n / 16 % 3];
            const char *kind = kinds[n / 48 % 2];
            bool comes = n / 96;
            if (SPARING && n % 7) continue;
            skein_world *world = new_world(all_methods[i], 5);
            add_gravity(world);
            skein_handle plate = add_plate(world, kind, thickness, comes ? speed / 2 : 0);
            add_moving(world, 0.1, 0.1, 0.5, 0.2, side, -speed, 0.3 * side);
            for (int f = 0; f < 12; f++) {
                steps(world, 1, dt);
                skein_pose pose;
                OK(world, skein_collider_pose(world, plate, &pose));
                double above = position_of(world, 0).y - pose.position[1] - 0.0005;
                if (!(above >= -1e-5))
                    print_error("%s, %s at %g m/s, %g aslant, thickness %g%s: %g m above\n", all_methods[i], kind,
                                speed, side, thickness, comes ? ", which comes" : "", above);
                assert_true(above >= -1e-5);
            }
            // it does not stick to it either: it lies on the plate, as slow along it as friction leaves it
            assert_true(position_of(world, 0).y < 0.5 + 12 * dt * speed);
            skein_world_destroy(world);
        }
}

/* Straight down at their middle: a ball and a capsule of 2 cm, over which a substep leaps 60 times. */
static void nothing_passes_what_is_round(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++)
        for (int n = 0; n < 8; n++) {
            double speed = n % 2 ? 20 : 400, radius = n / 2 % 2 ? 0.01 : 0.3;
            bool ball = n / 4;
            skein_world *world = new_world(all_methods[i], 5);
            OK(world,
               skein_collider_add(world, ball ? "sphere" : "capsule",
                                  SKEIN_SETTINGS(SKEIN_REAL("radius", radius), SKEIN_REAL("thickness", 0.001)), NULL));
            add_moving(world, 0.1, 0, 1, 0, 0, -speed, 0);
            steps(world, 6, dt);
            assert_true(fabs(position_of(world, 0).y - (radius + 0.001)) < 1e-4 || speed < 60);
            assert_true(position_of(world, 0).y > radius);
            assert_under(length3(velocity_of(world, 0)), speed < 60 ? 21 : 1e-3);
            skein_world_destroy(world);
        }
}

/* A ball of a shell 1 mm thick: a hollow's far wall faces the start of what leaps through the near one. */
static void a_shell_keeps_in_and_out(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++)
        for (int n = 0; n < 4; n++) {
            double speed = n % 2 ? 30 : 300;
            bool inside = n / 2;
            skein_world *world = new_world(all_methods[i], 5);
            OK(world, skein_collider_add(world, "formula",
                                         SKEIN_SETTINGS(SKEIN_TEXT("surface", "abs(length(p) - 0.4) - 0.0005"),
                                                        SKEIN_REAL("thickness", 0.002)),
                                         NULL));
            add_moving(world, 0.1, 0.05, inside ? 0 : 0.9, -0.05, 0.1 * speed, -speed, 0);
            for (int f = 0; f < 30; f++) {
                steps(world, 1, dt);
                double away = length3(position_of(world, 0)) - 0.4;
                if (!(inside ? away < -0.0005 + 1e-5 : away > 0.0005 - 1e-5))
                    print_error("%s at %g m/s, from %s: %g m out of the shell's middle in frame %d\n", all_methods[i],
                                speed, inside ? "inside" : "outside", away, f);
                assert_true(inside ? away < -0.0005 + 1e-5 : away > 0.0005 - 1e-5);
            }
            skein_world_destroy(world);
        }
}

/* A speed is given back by the restitution, and what is along the surface stays without friction. */
static void it_bounces_as_ever(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++) {
        skein_world *world = new_world(all_methods[i], 5);
        OK(world, skein_collider_add(world, "box",
                                     SKEIN_SETTINGS(SKEIN_VEC3("size", 60, 0.001, 60), SKEIN_REAL("friction", 0),
                                                    SKEIN_REAL("restitution", 0.5)),
                                     NULL));
        add_moving(world, 0.1, 0, 1, 0, 50, -200, 0);
        steps(world, 1, dt);
        vec3 v = velocity_of(world, 0);
        assert_near(v.x, 50, 0.01);
        assert_near(v.y, 100, 0.1);
        skein_world_destroy(world);
    }
}

/* A blade that turns through 20 degrees a substep takes along what it meets; and what is beside a plate or above it flies on, to the bit. */
static void what_is_beside_flies_by(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++) {
        vec3 end[2];
        for (int with = 0; with < 2; with++) {
            skein_world *world = new_world(all_methods[i], 5);
            if (with)
                OK(world,
                   skein_collider_add(
                       world, "box",
                       SKEIN_SETTINGS(SKEIN_VEC3("size", 1, 0.001, 1), SKEIN_VEC3("rotation", 10, 20, 30)), NULL));
            add_moving(world, 0.1, 0.9, 2, 0.1, 3, -390, 0);
            add_moving(world, 0.1, 0.9, 2, 0.1, -3, 390, 0);
            steps(world, 10, dt);
            end[with] = position_of(world, 0);
            skein_world_destroy(world);
        }
        if (strcmp(all_methods[i], "backward_euler"))
            assert_true(end[0].x == end[1].x && end[0].y == end[1].y && end[0].z == end[1].z);
        skein_world *world = new_world(all_methods[i], 5);
        OK(world,
           skein_collider_add(world, "box",
                              SKEIN_SETTINGS(SKEIN_VEC3("size", 2, 0.001, 0.2), SKEIN_VEC3("motion.axis", 0, 0, 1),
                                             SKEIN_REAL("motion.spin", 20 * PI / 180 * 300)),
                              NULL));
        add_particle(world, 0.1, 0.5, 0.1, 0);
        steps(world, 1, dt); // a third of a turn: the blade was where it is
        assert_true(length3(minus(position_of(world, 0), (vec3){0.5, 0.1, 0})) > 0.1);
        skein_world_destroy(world);
    }
}

/* A cloth of 1 m at 200 m/s, flat and aslant, against a thin plate: all of it stays above. */
static void a_cloth_does_not_pass(void **state) {
    (void)state;
    static const char *const methods[] = {"xpbd", "pbd", "backward_euler", "symplectic_euler"};
    for (size_t i = 0; i < COUNT(methods); i++)
        for (int tilt = 0; tilt <= 40; tilt += 40) {
            skein_world *world = new_world(methods[i], 20);
            add_gravity(world);
            add_plate(world, "box", 0.002, 0);
            int side = SPARING ? 9 : 20;
            OK(world,
               skein_body_add(world, "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_VEC3("position", 0, 1, 0),
                                             SKEIN_VEC3("rotation", tilt, 0, 0), SKEIN_VEC3("velocity", 0, -200, 0),
                                             SKEIN_REAL("stretch.stiffness", 100), SKEIN_REAL("shear.stiffness", 20)),
                              NULL));
            for (int f = 0; f < 20; f++) {
                steps(world, 1, dt);
                for (uint32_t p = 0; p < skein_particle_count(world); p++)
                    assert_true(position_of(world, p).y > 0.0005 - 1e-5);
            }
            skein_world_destroy(world);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_passes_a_plate),   cmocka_unit_test(nothing_passes_what_is_round),
        cmocka_unit_test(a_shell_keeps_in_and_out), cmocka_unit_test(it_bounces_as_ever),
        cmocka_unit_test(what_is_beside_flies_by),  cmocka_unit_test(a_cloth_does_not_pass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
