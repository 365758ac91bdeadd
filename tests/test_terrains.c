/* Jelly cubes on terrains: sliding, staying, resting, and bouncing off what has a mass. */
#include "helpers.h"
#include "world/world.h"

static const double g = 9.81, frame = 1.0 / 60;

/* A jelly cube of half a metre and 10 kg, soft enough for forces at 20 substeps a frame. */
static skein_handle add_cube(skein_world *world, int n, vec3 middle, double turn) {
    skein_handle handle;
    OK(world,
       skein_body_add(world, "lattice", NULL,
                      SKEIN_SETTINGS(SKEIN_VEC3("grid", n, n, n), SKEIN_VEC3("size", 0.5, 0.5, 0.5),
                                     SKEIN_REAL("mass", 10), SKEIN_VEC3("position", middle.x, middle.y, middle.z),
                                     SKEIN_VEC3("rotation", 0, 0, turn), SKEIN_REAL("structural.stiffness", 1000),
                                     SKEIN_REAL("structural.damping", 5), SKEIN_REAL("shear.stiffness", 500),
                                     SKEIN_REAL("shear.damping", 2.5), SKEIN_REAL("bending.stiffness", 250),
                                     SKEIN_REAL("bending.damping", 1.2), SKEIN_REAL("struts", 1)),
                      &handle));
    return handle;
}

static vec3 middle_of(const skein_world *world, size_t first, size_t count) {
    vec3 sum = {0, 0, 0};
    for (size_t i = first; i < first + count; i++) {
        vec3 p = position_of(world, i);
        sum.x += p.x / (double)count, sum.y += p.y / (double)count, sum.z += p.z / (double)count;
    }
    return sum;
}

/* ---- Friction ------------------------------------------------------------------------------------- */

static void a_cube_slides_or_stays(void **state) {
    (void)state;
    static const double slope = 25 * PI / 180, part[] = {0.7, 1.15};
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t i = 0; i < COUNT(part); i++) {
            double friction = part[i] * tan(slope), off = 0.25 + 0.002, down[3];
            skein_world *world = new_world(method_names[m], 20);
            add_gravity(world);
            OK(world, skein_collider_add(world, "plane",
                                         SKEIN_SETTINGS(SKEIN_VEC3("normal", 3 * sin(slope), 3 * cos(slope), 0),
                                                        SKEIN_REAL("friction", friction)),
                                         NULL));
            add_cube(world, 4, (vec3){off * sin(slope), off * cos(slope), 0}, -25);
            for (int second = 0; second < 3; second++) {
                steps(world, 20, frame);
                vec3 p = middle_of(world, 0, 64);
                down[second] = p.x * cos(slope) - p.y * sin(slope);
                assert_under(p.z, 0.01);
            }
            double acceleration = (down[2] - 2 * down[1] + down[0]) * 9;
            if (part[i] < 1) assert_share(acceleration, g * (sin(slope) - friction * cos(slope)), 0.05);
            else assert_near(down[2], down[1], 1e-3);
            skein_world_destroy(world);
        }
}

/* At rest friction holds against any force along the surface up to mu times what presses, and no more. */
static void friction_holds_at_rest(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int more = 0; more < 2; more++) {
            skein_world *world = new_world(method_names[m], 10);
            add_gravity(world);
            double pull = 0.4 * 2 * g * (more ? 1.1 : 0.9);
            OK(world,
               skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0.6 * pull, 0, 0.8 * pull)), NULL));
            OK(world,
               skein_collider_add(world, "box",
                                  SKEIN_SETTINGS(SKEIN_VEC3("size", 9, 2, 9), SKEIN_REAL("friction", 0.4)), NULL));
            add_particle(world, 2, 0, 1.002, 0);
            steps(world, 60, frame);
            vec3 p = position_of(world, 0), v = velocity_of(world, 0);
            if (more) {
                // a position method rounds the push of a substep, of which a tenth is left
                assert_share(v.x, 0.6 * 0.1 * 0.4 * g, 0.04);
                assert_share(v.z, 0.8 * 0.1 * 0.4 * g, 0.04);
            } else {
                assert_under(hypot(p.x, p.z), 1e-5);
            }
            skein_world_destroy(world);
        }
}

/* ---- Bounces ---------------------------------------------------------------------------------------- */

typedef struct heard {
    int warnings;
    char last[512];
} heard;

static void hear(void *user, skein_log_level level, const char *message) {
    heard *h = user;
    h->warnings += level == SKEIN_LOG_WARNING;
    snprintf(h->last, sizeof h->last, "%s", message);
}

/* The speed after a particle of mass m hits a shape of mass M straight at 1 m/s; it slides at 2 m/s besides. */
static double speed_after(const char *method, const char *shape, double m, double M, heard *h) {
    skein_world_desc desc = skein_default_world_desc();
    desc.log = hear;
    desc.log_user = h;
    skein_world *world = skein_world_create(&desc, NULL);
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
    // the mass counts, not the restitution
    OK(world, skein_collider_add(world, shape,
                                 SKEIN_SETTINGS(SKEIN_REAL("radius", 1), SKEIN_REAL("mass", M),
                                                SKEIN_REAL("restitution", 0.9), SKEIN_REAL("friction", 0)),
                                 NULL));
    bool inside = !strcmp(shape, "bowl");
    add_moving(world, m, inside ? 0.999 : 1.001, 0, 0, inside ? 1 : -1, 2, 0);
    steps(world, 1, 1e-5);
    vec3 v = velocity_of(world, 0);
    assert_near(v.y, 2, 1e-3);
    OK(world, skein_set_path(world, "colliders.0.friction", skein_number(0.1)));
    steps(world, 1, 1e-5);
    assert_int_equal(h->warnings, M > 0 && M < m); // once, not at every change
    skein_world_destroy(world);
    return inside ? -v.x : v.x;
}

static void a_mass_says_how_things_bounce(void **state) {
    (void)state;
    static const char *const shapes[] = {"sphere", "bowl"}, *const methods[] = {"symplectic_euler", "xpbd",
                                                                                "backward_euler"};
    static const double masses[][3] = {{1, 3, 0.5}, {2, 2, 0}, {1, 1e9, 1}, {0.5, 4.5, 0.8}, {3, 1, 0}, {1, 0, 0.9}};
    for (size_t m = 0; m < COUNT(methods); m++)
        for (size_t s = 0; s < COUNT(shapes); s++)
            for (size_t i = 0; i < COUNT(masses); i++) {
                heard h = {0, ""};
                assert_near(speed_after(methods[m], shapes[s], masses[i][0], masses[i][1], &h), masses[i][2], 2e-3);
                if (i == 4) assert_non_null(strstr(h.last, "its mass of 1 kg is less than that of a particle, 3 kg"));
            }
}

/* ---- Cubes ------------------------------------------------------------------------------------------ */

/* With restitution 0 it does not hop: it slides to the middle of the bowl and rests. */
static void a_cube_in_a_bowl_does_not_hop(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 20);
        add_gravity(world);
        OK(world, skein_collider_add(world, "bowl",
                                     SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 1.5, 0), SKEIN_REAL("radius", 1.5),
                                                    SKEIN_REAL("friction", 0.2)),
                                     NULL));
        add_cube(world, 4, (vec3){-0.595, 0.469, 0}, -30);
        double lowest = INFINITY;
        for (int n = 0; n < 110; n++) {
            steps(world, 1, frame);
            double y = middle_of(world, 0, 64).y;
            lowest = fmin(lowest, y);
            assert_true(y - lowest < 0.05 * 0.5);
        }
        skein_statistics s = statistics_of(world);
        assert_under(hypot(middle_of(world, 0, 64).x, middle_of(world, 0, 64).z), 0.02);
        assert_true(s.kinetic_energy < 0.05 && s.nonfinite == 0 && s.max_penetration < 1e-5);
        skein_world_destroy(world);
    }
}

/* Cubes in one world do not know of each other: each does what it would do alone. */
static void several_cubes_stand_in_one_world(void **state) {
    (void)state;
    static const double places[][3] = {{0, 0.27, 0}, {3, 0.3, 0}, {0, 0.28, 2}};
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *all = new_world(method_names[m], 20);
        add_gravity(all);
        OK(all, skein_collider_add(all, "plane", NULL, NULL));
        for (int c = 0; c < 3; c++) add_cube(all, 3 + c, (vec3){places[c][0], places[c][1], places[c][2]}, 5);
        steps(all, 10, frame);
        size_t first = 0;
        for (int c = 0; c < 3; c++) {
            skein_world *one = new_world(method_names[m], 20);
            add_gravity(one);
            OK(one, skein_collider_add(one, "plane", NULL, NULL));
            add_cube(one, 3 + c, (vec3){places[c][0], places[c][1], places[c][2]}, 5);
            steps(one, 10, frame);
            for (size_t i = 0; i < skein_particle_count(one); i++) {
                vec3 p = position_of(one, i), q = position_of(all, first + i);
                assert_memory_equal(&p, &q, sizeof p);
            }
            first += skein_particle_count(one);
            skein_world_destroy(one);
        }
        assert_int_equal(skein_object_count(all, SKEIN_BODY), 3);
        skein_world_destroy(all);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cube_slides_or_stays),           cmocka_unit_test(friction_holds_at_rest),
        cmocka_unit_test(a_mass_says_how_things_bounce),    cmocka_unit_test(a_cube_in_a_bowl_does_not_hop),
        cmocka_unit_test(several_cubes_stand_in_one_world),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
