/* The turntable scene: a cloth settles on a ball, the ball begins to spin. Friction alone takes the cloth along. */
#include "helpers.h"

static skein_world *turntable(const char *method, int substeps, int side, double stiffness, double friction,
                              double start) {
    skein_world *world = new_world(method, substeps);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_VEC3("position", 0, 1.12, 0),
                                            SKEIN_REAL("density", 0.25), SKEIN_REAL("stretch.stiffness", stiffness),
                                            SKEIN_REAL("shear.stiffness", stiffness / 10),
                                            SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 20)),
                             NULL));
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.3)), NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.6)), NULL));
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.6, 0), SKEIN_REAL("radius", 0.5),
                                                SKEIN_REAL("thickness", 0.006), SKEIN_REAL("friction", friction),
                                                SKEIN_VEC3("motion.axis", 0, 1, 0), SKEIN_REAL("motion.spin", 2),
                                                SKEIN_REAL("motion.start", start)),
                                 NULL));
    return world;
}

/* Turns of the particles about the ball's axis, from their angular momentum: rad/s. */
static double spin_of(const skein_world *world) {
    double momentum = 0, inertia = 0;
    skein_view view = skein_velocity_view(world);
    for (size_t i = 0; i < view.count; i++) {
        double mass = (double)view.xyzw[4 * view.slot_of[i] + 3];
        vec3 x = position_of(world, i), v = velocity_of(world, i);
        momentum += mass * (x.z * v.x - x.x * v.z);
        inertia += mass * (x.x * x.x + x.z * x.z);
    }
    return momentum / inertia;
}

static const struct {
    const char *method;
    int substeps, side;
    double stiffness;
} ways[] = {{"xpbd", 12, 49, 1e4}, {"symplectic_euler", 40, 25, 400}}; // the scene's, and a softer one

/* Once it has caught up, the cloth turns as the ball does. */
static void a_rough_ball_takes_along(void **state) {
    (void)state;
    for (size_t w = 0; w < COUNT(ways); w++) {
        skein_world *world = turntable(ways[w].method, ways[w].substeps, ways[w].side, ways[w].stiffness, 5, 2);
        steps(world, 120, 1.0 / 60);
        assert_under(spin_of(world), 0.005); // the ball does not spin yet
        steps(world, 180, 1.0 / 60);
        for (int n = 0; n < 60; n++) {
            steps(world, 1, 1.0 / 60);
            assert_share(spin_of(world), 2, 0.02);
        }
        skein_statistics s = statistics_of(world);
        assert_int_equal(s.nonfinite, 0);
        assert_true(s.max_stretch < 0.06 && s.max_penetration < 1e-4);
        skein_world_destroy(world);
    }
}

/* Without friction nothing turns the cloth. (Nor does anything hold it: it glides off after a second or two.) */
static void a_smooth_ball_spins_alone(void **state) {
    (void)state;
    for (size_t w = 0; w < COUNT(ways); w++) {
        skein_world *world = turntable(ways[w].method, ways[w].substeps, ways[w].side, ways[w].stiffness, 0, 0);
        for (int n = 0; n < 70; n++) {
            steps(world, 1, 1.0 / 60);
            assert_under(spin_of(world), 0.01);
        }
        assert_true(statistics_of(world).contacts > 50);
        skein_world_destroy(world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rough_ball_takes_along),
        cmocka_unit_test(a_smooth_ball_spins_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
