/* The implicit method: solved in earnest, stable where no explicit method is, at rest where the others rest. */
#include "helpers.h"
#include "world/world.h"

enum { SIDE = 4, CUBE = SIDE * SIDE * SIDE };
static const double edge = 0.1; /* between neighbours, m */

/* A block of SIDE^3 particles of 0.1 kg with springs to all neighbours, its lowest layer at y; at the indices 0 and up.
 */
static skein_world *cube_world(double stiffness, double damping, double y) {
    skein_world *world = new_world("backward_euler", 1);
    uint32_t pairs[2 * 13 * CUBE], count = 0;
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++)
            for (int k = 0; k < SIDE; k++) add_particle(world, 0.1, i * edge, y + j * edge, k * edge);
    for (int a = 0; a < CUBE; a++)
        for (int b = a + 1; b < CUBE; b++) {
            int di = b / (SIDE * SIDE) - a / (SIDE * SIDE), dj = b / SIDE % SIDE - a / SIDE % SIDE,
                dk = b % SIDE - a % SIDE;
            if (abs(di) > 1 || abs(dj) > 1 || abs(dk) > 1) continue;
            pairs[2 * count] = (uint32_t)a, pairs[2 * count + 1] = (uint32_t)b;
            count++;
        }
    OK(world,
       skein_constraint_add(world, "distance", pairs, count,
                            SKEIN_SETTINGS(SKEIN_REAL("stiffness", stiffness), SKEIN_REAL("damping", damping)), NULL));
    add_gravity(world);
    return world;
}

static vec3 centre_of(const skein_world *world) {
    vec3 sum = {0, 0, 0};
    for (size_t i = 0; i < CUBE; i++) {
        vec3 p = position_of(world, i);
        sum.x += p.x / CUBE, sum.y += p.y / CUBE, sum.z += p.z / CUBE;
    }
    return sum;
}

/* A hundred times the largest explicit step: 2/omega, with omega^2 at most 26 k/m. */
static double far_too_stiff(double dt) {
    double limit = 4 * 0.1 / (26 * dt * dt);
    return 100 * 100 * limit;
}

/* It falls, lands, and stands; what a turn of the method is to leave behind it leaves. */
static void a_stiff_cube_stands_at_large_steps(void **state) {
    (void)state;
    const double dt = 1.0 / 30;
    bool is_double = sizeof(skein_real) == sizeof(double);
    skein_world *world = cube_world(far_too_stiff(dt), 0, 0.3);
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.5)), NULL));
    double highest = 0;
    for (int n = 0; n < 120; n++) {
        steps(world, 1, dt);
        skein_statistics s = statistics_of(world);
        assert_int_equal(s.nonfinite, 0);
        assert_int_equal(s.unsolved, 0);
        // at rest there is nothing to solve but rounding
        if (is_double && s.kinetic_energy > 1e-12) assert_true(s.residual <= 1e-5);
        assert_true(s.newton_iterations > 0 && s.cg_iterations > 0);
        assert_true(s.max_stretch < 0.02);
        if (n > 15) highest = fmax(highest, centre_of(world).y);
    }
    skein_statistics s = statistics_of(world);
    assert_under(s.kinetic_energy, 1e-6);
    assert_true(s.contacts == SIDE * SIDE);
    assert_near(centre_of(world).y, 0.002 + 1.5 * edge, 1e-3);
    assert_true(highest < 0.002 + 1.5 * edge + 0.01);
    skein_world_destroy(world);
}

/* Free flight: momentum goes by weight alone, angular momentum stays to the method's order. */
static void a_flying_cube_keeps_its_momentum(void **state) {
    (void)state;
    skein_world *world = cube_world(1e4, 5, 0);
    for (size_t i = 0; i < CUBE; i++) {
        vec3 p = position_of(world, i);
        throw_particle(world, i, 1 - 2 * p.y, 2 + 2 * p.x, 0.5);
    }
    skein_statistics before = statistics_of(world);
    steps(world, 100, 0.002);
    skein_statistics after = statistics_of(world);
    double mass = 0.1 * CUBE;
    assert_near(after.momentum[0], before.momentum[0], 1e-4 * mass);
    assert_near(after.momentum[1], before.momentum[1] - mass * 9.81 * 0.2, 2e-4 * mass);
    assert_near(after.momentum[2], before.momentum[2], 1e-4 * mass);
    // it falls as the method falls: x = x0 + v0 t - g h^2 n (n + 1)/2
    double h = 0.002, fall = 9.81 * h * h * 100 * 101 / 2;
    assert_near(centre_of(world).y - 1.5 * edge, before.momentum[1] / mass * 0.2 - fall, 1e-3);
    skein_world_destroy(world);
}

/* On a slope it stays where friction can hold it, and slides at g (sin a - mu cos a) where it cannot. */
static void slopes_hold_or_let_slide(void **state) {
    (void)state;
    const double angle = PI / 6, dt = 1.0 / 120;
    for (int slides = 0; slides < 2; slides++) {
        double mu = slides ? 0.3 : 0.8;
        skein_world *world = cube_world(1e4, 50, 0.002);
        // gravity is turned instead of the plane
        OK(world,
           skein_set_path(world, "forces.0.acceleration", skein_vector(9.81 * sin(angle), -9.81 * cos(angle), 0)));
        OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", mu)), NULL));
        steps(world, 30, dt); // settles
        vec3 start = centre_of(world);
        double speed = statistics_of(world).momentum[0] / (0.1 * CUBE);
        steps(world, 60, dt);
        vec3 end = centre_of(world);
        double later = statistics_of(world).momentum[0] / (0.1 * CUBE);
        if (slides) assert_share((later - speed) / 0.5, 9.81 * (sin(angle) - mu * cos(angle)), 0.05);
        else assert_under(end.x - start.x, 1e-3);
        assert_near(end.y, start.y, 2e-3);
        skein_world_destroy(world);
    }
}

/* Drag is in the matrix: any rate is stable, and decays as the method does. */
static void drag_is_implicit(void **state) {
    (void)state;
    skein_world *world = new_world("backward_euler", 1);
    add_moving(world, 2, 0, 0, 0, 3, 0, 0);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 500)), NULL));
    steps(world, 1, 0.1);
    assert_share(velocity_of(world, 0).x, 3.0 / 51, 1e-4);
    OK(world, skein_set_path(world, "forces.0.rate", skein_number(0)));
    OK(world, skein_set_path(world, "forces.0.quadratic", skein_number(1000)));
    throw_particle(world, 0, 3, 0, 0);
    steps(world, 1, 0.1);
    // m (v - 3) = -h c v^2
    double v = (-2 + sqrt(4 + 4 * 100 * 6)) / 200;
    assert_share(velocity_of(world, 0).x, v, 1e-4);
    skein_world_destroy(world);
}

/* Held particles, particles in one place, springs of no stiffness: all as if nothing were wrong. */
static void degenerate_worlds_are_solved(void **state) {
    (void)state;
    skein_world *world = new_world("backward_euler", 2);
    add_gravity(world);
    steps(world, 1, 0.01); // nobody there
    uint32_t a = add_particle(world, 0, 0, 0, 0), b = add_particle(world, 1, 0, 0, 0),
             c = add_particle(world, 1e-6, 0, -1, 0);
    uint32_t d = add_particle(world, 1000, 1, -1, 0);
    add_spring(world, a, b, 1e4, 1);
    add_spring(world, b, c, 1e6, 0);
    add_spring(world, c, d, 0, 0);
    steps(world, 20, 0.01);
    skein_statistics s = statistics_of(world);
    assert_int_equal(s.nonfinite, 0);
    assert_under(length3(position_of(world, a)), 0);
    assert_near(position_of(world, d).y, -1 - 9.81 * 0.005 * 0.005 * 40 * 41 / 2, 1e-3);
    assert_true(length3(position_of(world, b)) < 0.1);
    skein_world_destroy(world);
}

/* Between two walls that meet: held by both, and out of the corner by neither. */
static void corners_hold_both_ways(void **state) {
    (void)state;
    skein_world *world = new_world("backward_euler", 1);
    OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_VEC3("acceleration", -3, -9.81, 0)), NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0)), NULL));
    OK(world, skein_collider_add(world, "plane",
                                 SKEIN_SETTINGS(SKEIN_VEC3("normal", 1, 0, 0), SKEIN_REAL("friction", 0)), NULL));
    uint32_t a = add_moving(world, 1, 0.5, 0.5, 0, -1, 0, 0.5);
    steps(world, 200, 0.01);
    assert_near(position_of(world, a).x, 0.002, 1e-5);
    assert_near(position_of(world, a).y, 0.002, 1e-5);
    assert_near(velocity_of(world, a).z, 0.5, 1e-4);
    skein_world_destroy(world);
}

/* Newton's method takes few iterations: for a stretched spring that turns, and for one that is thrown at its own end,
 * which takes the first guess and the line search to solve. */
static void few_turns_solve_one_spring(void **state) {
    (void)state;
    static const struct { double x, vx, vy; } rows[] = {{2, 0, 8}, {1, -30, 0}, {0.3, 5, -20}, {4, -100, 3}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        skein_world *world = new_world("backward_euler", 1);
        uint32_t a = add_particle(world, 0, 0, 0, 0), b = add_particle(world, 1, 1, 0, 0);
        add_spring(world, a, b, 1e4, 0);
        place_particle(world, b, rows[i].x, 0, 0);
        throw_particle(world, b, rows[i].vx, rows[i].vy, 0);
        double before = statistics_of(world).elastic_energy + statistics_of(world).kinetic_energy;
        steps(world, 1, 0.1);
        skein_statistics s = statistics_of(world);
        assert_int_equal(s.unsolved, 0);
        assert_true(s.newton_iterations <= 8);
        assert_true(s.elastic_energy + s.kinetic_energy <= before);
        skein_world_destroy(world);
    }
}

/* A bounce keeps the speed that restitution says. */
static void restitution_is_kept(void **state) {
    (void)state;
    skein_world *world = new_world("backward_euler", 20);
    add_gravity(world);
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("restitution", 0.5)), NULL));
    uint32_t ball = add_particle(world, 1, 0, 1.002, 0);
    double highest = 0;
    for (int n = 0; n < 60; n++) {
        steps(world, 1, 1.0 / 60);
        if (velocity_of(world, ball).y > 0) highest = fmax(highest, position_of(world, ball).y);
    }
    assert_share(highest - 0.002, 0.25, 0.01);
    skein_world_destroy(world);
}

typedef struct counter {
    size_t calls;
} counter;

static void *count_allocation(void *user, size_t size, size_t alignment) {
    ((counter *)user)->calls++;
    return aligned_alloc(alignment, size);
}
static void release(void *user, void *memory, size_t size) {
    (void)user, (void)size;
    free(memory);
}

static void nothing_is_allocated_after_the_second_step(void **state) {
    (void)state;
    counter count = {0};
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = count_allocation, desc.release = release, desc.memory_user = &count;
    skein_world *world = skein_world_create(&desc, NULL);
    OK(world, skein_method_set(world, "backward_euler", NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 8, 8), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("stretch.stiffness", 100)),
                             NULL));
    add_gravity(world);
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -0.1)), NULL));
    steps(world, 2, 0.01);
    size_t before = count.calls;
    steps(world, 20, 0.01);
    assert_int_equal(count.calls, before);
    skein_world_destroy(world);
}

/* A tangent leads into a hollow wall; what is pulled off it harder than that leaves it nevertheless. */
static void nothing_is_glued_to_a_hollow(void **state) {
    (void)state;
    skein_world *world = new_world("backward_euler", 1);
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0, 3, 0)), NULL));
    OK(world,
       skein_collider_add(world, "bowl", SKEIN_SETTINGS(SKEIN_REAL("radius", 1), SKEIN_REAL("friction", 0.3)), NULL));
    add_moving(world, 1, 0, -0.998, 0, 1, 0, 0);
    steps(world, 100, 1e-3);
    assert_near(position_of(world, 0).x, 0.1, 1e-4);
    assert_near(position_of(world, 0).y, -0.998 + 0.5 * 3 * 0.01, 3e-4);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stiff_cube_stands_at_large_steps),
        cmocka_unit_test(a_flying_cube_keeps_its_momentum),
        cmocka_unit_test(slopes_hold_or_let_slide),
        cmocka_unit_test(drag_is_implicit),
        cmocka_unit_test(degenerate_worlds_are_solved),
        cmocka_unit_test(corners_hold_both_ways),
        cmocka_unit_test(few_turns_solve_one_spring),
        cmocka_unit_test(restitution_is_kept),
        cmocka_unit_test(nothing_is_glued_to_a_hollow),
        cmocka_unit_test(nothing_is_allocated_after_the_second_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
