/* Where things are: rays against surfaces and colliders, the nearest particles; against closed forms. And what a hand
 * that leads particles relies on: pinned particles that move, and a clock that is set. */
#include "all_methods.h"
#include "helpers.h"

static skein_hit cast(const skein_world *world, vec3 origin, vec3 direction, skein_category category) {
    const double from[3] = {origin.x, origin.y, origin.z}, along[3] = {direction.x, direction.y, direction.z};
    skein_hit hit;
    OK(world, skein_ray_cast(world, from, along, category, &hit));
    return hit;
}

static skein_world *empty_world(void) {
    return new_world("xpbd", 1);
}

static double dot3(vec3 a, vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vec3 unit(vec3 a) {
    double length = length3(a);
    return (vec3){a.x / length, a.y / length, a.z / length};
}

/* ---- Bodies ------------------------------------------------------------------------------------------ */

/* A level sheet of 5 x 5 particles from (-1, 2, -1) to (1, 2, 1), tilted rays from above and below. */
static void rays_meet_a_sheet(void **state) {
    skein_world *world = empty_world();
    skein_handle body;
    (void)state;
    OK(world,
       skein_body_add(
           world, "cloth", NULL,
           SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5), SKEIN_PAIR("size", 2, 2), SKEIN_VEC3("position", 0, 2, 0)), &body));
    uint64_t seed = 1;
    int met = 0;
    for (int i = 0; i < 400; i++) {
        vec3 from = {random_between(&seed, -2, 2), i % 2 ? 5 : -1, random_between(&seed, -2, 2)};
        vec3 to = {random_between(&seed, -1.5, 1.5), 2, random_between(&seed, -1.5, 1.5)};
        vec3 way = minus(to, from);
        bool inside = fabs(to.x) < 1 && fabs(to.z) < 1;
        if (fabs(fabs(to.x) - 1) < 1e-3 || fabs(fabs(to.z) - 1) < 1e-3) continue;
        vec3 any_length = {0.3 * way.x, 0.3 * way.y, 0.3 * way.z};
        skein_hit hit = cast(world, from, any_length, SKEIN_BODY);
        assert_int_equal(hit.t < INFINITY, inside);
        if (!inside) continue;
        met++;
        assert_near(hit.t, length3(way), 1e-5);
        assert_near(hit.point[0], to.x, 1e-5);
        assert_near(hit.point[2], to.z, 1e-5);
        assert_near(hit.normal[1], i % 2 ? 1 : -1, 1e-5); // towards the origin
        assert_int_equal(hit.object.index, body.index);
        // the nearest corner of the face: no particle at all is nearer
        uint32_t nearest;
        OK(world, skein_particle_near_point(world, hit.point, &nearest, NULL));
        vec3 a = minus(position_of(world, hit.particle), to), b = minus(position_of(world, nearest), to);
        assert_near(length3(a), length3(b), 1e-5);
    }
    assert_true(met > 100);
    // away from it, and along it
    assert_true(isinf(cast(world, (vec3){0, 5, 0}, (vec3){0, 1, 0}, SKEIN_BODY).t));
    assert_true(isinf(cast(world, (vec3){0, 3, 0}, (vec3){1, 0, 0}, SKEIN_BODY).t));
    // what is not visible is not met
    OK(world, skein_set(world, body, "visible", skein_number(0)));
    assert_true(isinf(cast(world, (vec3){0.1, 5, 0.2}, (vec3){0, -1, 0}, SKEIN_BODY).t));
    skein_world_destroy(world);
}

/* ---- Colliders -------------------------------------------------------------------------------------- */

/* Where a ray meets a ball at the origin: the first root, or where it comes out. */
static double meet_ball(vec3 from, vec3 along, double radius, bool leave) {
    double b = dot3(from, along), c = dot3(from, from) - radius * radius, root = b * b - c;
    return root < 0 ? INFINITY : -b + (leave ? 1 : -1) * sqrt(root);
}

/* A ball, one that a formula says which is no distance, and a bowl. */
static void rays_meet_balls_and_bowls(void **state) {
    skein_world *ball = empty_world(), *bowl = empty_world(), *said = empty_world();
    (void)state;
    OK(said, skein_collider_add(said, "formula", SKEIN_SETTINGS(SKEIN_TEXT("surface", "dot(p, p) - 0.64")), NULL));
    OK(ball, skein_collider_add(ball, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.8)), NULL));
    OK(bowl, skein_collider_add(bowl, "bowl", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.8)), NULL));
    uint64_t seed = 2;
    int met = 0;
    for (int i = 0; i < 400; i++) {
        vec3 from, to;
        from = unit((vec3){random_between(&seed, -1, 1), random_between(&seed, -1, 1), random_between(&seed, -1, 1)});
        from = (vec3){3 * from.x, 3 * from.y, 3 * from.z};
        to = (vec3){random_between(&seed, -1, 1), random_between(&seed, -1, 1), random_between(&seed, -1, 1)};
        vec3 along = unit(minus(to, from));
        double ought = meet_ball(from, along, 0.8, false), out = meet_ball(from, along, 0.8, true);
        if (ought < INFINITY && out - ought < 0.05) continue; // it only grazes
        skein_hit hit = cast(ball, from, along, SKEIN_COLLIDER);
        assert_int_equal(hit.t < INFINITY, ought < INFINITY);
        skein_hit formula = cast(said, from, along, SKEIN_COLLIDER);
        assert_int_equal(formula.t < INFINITY, ought < INFINITY);
        skein_hit wall = cast(bowl, from, along, SKEIN_COLLIDER);
        assert_int_equal(wall.t < INFINITY, out < INFINITY);
        if (isinf(ought)) continue;
        met++;
        // rounding in the distance, on a surface that leans so much against the ray
        double lean = (out - ought) / 2 / 0.8, off = 2e-5 / lean;
        assert_near(hit.t, ought, off);
        assert_near(formula.t, ought, off);
        assert_int_equal(hit.particle, UINT32_MAX);
        for (int k = 0; k < 3; k++) assert_near(hit.normal[k], hit.point[k] / 0.8, 1e-3);
        // one looks into a bowl from outside, and sees its far wall
        assert_near(wall.t, out, off);
        for (int k = 0; k < 3; k++) assert_near(wall.normal[k], -wall.point[k] / 0.8, 1e-3);
    }
    assert_true(met > 100);
    skein_world_destroy(said);
    skein_world_destroy(ball);
    skein_world_destroy(bowl);
}

static void rays_meet_planes_at_any_angle(void **state) {
    skein_world *world = empty_world();
    skein_handle plane;
    (void)state;
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", 0.25)), &plane));
    for (int degrees = 1; degrees < 90; degrees += 4) {
        double angle = degrees * PI / 180;
        skein_hit hit = cast(world, (vec3){0.3, 1.25, -0.4}, (vec3){cos(angle), -sin(angle), 0}, SKEIN_COLLIDER);
        assert_share(hit.t, 1 / sin(angle), 1e-3);
        assert_near(hit.normal[1], 1, 1e-6);
    }
    assert_true(isinf(cast(world, (vec3){0, 1, 0}, (vec3){1, 0.01, 0}, SKEIN_COLLIDER).t));
    OK(world, skein_set(world, plane, "enabled", skein_number(0)));
    assert_true(isinf(cast(world, (vec3){0, 1, 0}, (vec3){0, -1, 0}, SKEIN_COLLIDER).t));
    skein_world_destroy(world);
}

/* A box's front face, its edge on from a slant; a rod's round end; and the nearest of both. */
static void rays_meet_boxes_and_capsules(void **state) {
    skein_world *world = empty_world();
    skein_handle box, rod;
    (void)state;
    OK(world, skein_collider_add(world, "box",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0, 0), SKEIN_VEC3("size", 2, 1, 0.5)), &box));
    OK(world,
       skein_collider_add(
           world, "capsule",
           SKEIN_SETTINGS(SKEIN_VEC3("from", 3, 0, 0), SKEIN_VEC3("to", 5, 0, 0), SKEIN_REAL("radius", 0.5)), &rod));
    skein_hit hit = cast(world, (vec3){0.7, 0.3, 4}, (vec3){0, 0, -2}, SKEIN_COLLIDER);
    assert_near(hit.t, 3.75, 1e-4);
    assert_near(hit.normal[2], 1, 1e-4);
    assert_int_equal(hit.object.index, box.index);
    hit = cast(world, (vec3){-4, -4, 0.1}, (vec3){1, 1, 0}, SKEIN_COLLIDER); // enters by the lower face, at x = -0.5
    assert_near(hit.point[0], -0.5, 1e-4);
    assert_near(hit.normal[1], -1, 1e-4);
    hit = cast(world, (vec3){9, 0, 0}, (vec3){-1, 0, 0}, SKEIN_COLLIDER);
    assert_near(hit.t, 3.5, 1e-4);
    assert_int_equal(hit.object.index, rod.index);
    hit = cast(world, (vec3){4, 3, 0.3}, (vec3){0, -1, 0}, SKEIN_COLLIDER);
    assert_near(hit.point[1], 0.4, 1e-4); // sqrt(0.5^2 - 0.3^2)
    assert_near(hit.normal[2], 0.6, 1e-3);
    skein_world_destroy(world);
}

/* ---- Particles --------------------------------------------------------------------------------------- */

static void finds_the_nearest_particles(void **state) {
    enum { MANY = 300 };
    skein_world *world = empty_world();
    uint64_t seed = 3;
    uint32_t particle;
    double distance;
    (void)state;
    FAILS(world, SKEIN_ERROR_VALUE, "no particles",
          skein_particle_near_point(world, (const double[]){0, 0, 0}, &particle, &distance));
    for (int i = 0; i < MANY; i++)
        add_particle(world, 1, random_between(&seed, -1, 1), random_between(&seed, -1, 1), random_between(&seed, -1, 1));
    for (int i = 0; i < 50; i++) {
        vec3 p = {random_between(&seed, -1, 1), random_between(&seed, -1, 1), random_between(&seed, -1, 1)};
        const double point[3] = {p.x, p.y, p.z};
        OK(world, skein_particle_near_point(world, point, &particle, &distance));
        assert_near(distance, length3(minus(position_of(world, particle), p)), 1e-12);
        for (uint32_t k = 0; k < MANY; k++) assert_true(length3(minus(position_of(world, k), p)) >= distance);
        // a ray from outside straight at a particle finds it, or one before it in its way
        vec3 goal = position_of(world, particle), from = {4, 3, 2}, way = minus(goal, from);
        const double eye[3] = {from.x, from.y, from.z}, along[3] = {way.x, way.y, way.z};
        double t;
        uint32_t met;
        OK(world, skein_particle_near_ray(world, eye, along, 1e-5, 0, &met, &t));
        assert_int_equal(met, particle);
        assert_near(t, length3(way), 1e-5);
    }
    skein_world_destroy(world);
}

/* A cone of 0.01 m a metre: 5 m away 0.05 m beside it is as much as it takes. */
static void a_ray_has_a_width(void **state) {
    skein_world *world = empty_world();
    uint32_t particle;
    double t;
    const double from[3] = {0, 0, 5}, way[3] = {0, 0, -1};
    (void)state;
    add_particle(world, 1, 0.049, 0, 0);
    OK(world, skein_particle_near_ray(world, from, way, 0, 0.01, &particle, &t));
    assert_int_equal(particle, 0);
    assert_near(t, 5, 1e-6);
    place_particle(world, 0, 0.051, 0, 0);
    OK(world, skein_particle_near_ray(world, from, way, 0, 0.01, &particle, &t));
    assert_true(isinf(t));
    OK(world, skein_particle_near_ray(world, from, way, 0.002, 0.01, &particle, &t));
    assert_int_equal(particle, 0);
    place_particle(world, 0, 0, 0, 6); // behind the eye
    OK(world, skein_particle_near_ray(world, from, way, 1, 1, &particle, &t));
    assert_true(isinf(t));
    skein_world_destroy(world);
}

static void refuses_bad_rays(void **state) {
    skein_world *world = empty_world();
    skein_hit hit;
    uint32_t particle;
    double t;
    const double origin[3] = {0, 0, 0}, nowhere[3] = {0, 0, 0}, wild[3] = {NAN, 0, 1}, along[3] = {0, 0, 1};
    (void)state;
    add_particle(world, 1, 0, 0, 1);
    FAILS(world, SKEIN_ERROR_VALUE, "not 0", skein_ray_cast(world, origin, nowhere, SKEIN_BODY, &hit));
    FAILS(world, SKEIN_ERROR_VALUE, "finite", skein_ray_cast(world, origin, wild, SKEIN_COLLIDER, &hit));
    FAILS(world, SKEIN_ERROR_VALUE, "bodies and colliders", skein_ray_cast(world, origin, along, SKEIN_FORCE, &hit));
    FAILS(world, SKEIN_ERROR_VALUE, "radius", skein_particle_near_ray(world, origin, along, -1, 0, &particle, &t));
    FAILS(world, SKEIN_ERROR_VALUE, "radius", skein_particle_near_ray(world, origin, along, 0, 0, &particle, &t));
    skein_world_destroy(world);
}

/* ---- What a hand relies on ------------------------------------------------------------------------------ */

/* Under every method a pinned particle moves with its velocity, whatever pulls at it, and the spring on it follows. */
static void held_particles_move_with_their_velocity(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 8);
        uint32_t hand = add_particle(world, 0.1, 0, 0, 0), load = add_particle(world, 0.1, 0, -1, 0);
        add_gravity(world);
        add_spring(world, hand, load, 50, 0.5);
        OK(world, skein_particle_pin(world, hand, true));
        throw_particle(world, hand, 0.5, 0.25, -0.125);
        steps(world, 60, 1.0 / 60);
        vec3 at = position_of(world, hand), follows = position_of(world, load);
        assert_near(at.x, 0.5, 1e-4);
        assert_near(at.y, 0.25, 1e-4);
        assert_near(at.z, -0.125, 1e-4);
        assert_true(follows.x > 0.1);
        // let go it flies on
        OK(world, skein_particle_pin(world, hand, false));
        assert_near(velocity_of(world, hand).x, 0.5, 1e-6);
        skein_world_destroy(world);
    }
}

/* Positions, velocities and time that were copied take a world back: the same steps give the same bits. */
static void a_world_goes_back_to_a_copy(void **state) {
    enum { COUNT_OF_ALL = 36 };
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 20);
        double x[3 * COUNT_OF_ALL], v[3 * COUNT_OF_ALL];
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 6, 6), SKEIN_TEXT("pins", "top corners"),
                                                SKEIN_REAL("density", 1), SKEIN_REAL("stretch.stiffness", 50),
                                                SKEIN_REAL("shear.stiffness", 10), SKEIN_TEXT("bend.by", "springs"),
                                                SKEIN_REAL("bend.stiffness", 1)),
                                 NULL));
        add_gravity(world);
        OK(world, skein_collider_add(world, "sphere", // it moves: where it is depends on the clock
                                     SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, -0.7, 0), SKEIN_REAL("radius", 0.3),
                                                    SKEIN_VEC3("motion.velocity", 0, 1, 0)),
                                     NULL));
        steps(world, 10, 1.0 / 120);
        double time = skein_world_time(world);
        OK(world, skein_positions_copy(world, 0, COUNT_OF_ALL, x));
        OK(world, skein_velocities_copy(world, 0, COUNT_OF_ALL, v));
        steps(world, 30, 1.0 / 120);
        uint64_t ought = skein_world_hash(world);
        steps(world, 7, 1.0 / 120);
        OK(world, skein_positions_set(world, 0, COUNT_OF_ALL, x));
        OK(world, skein_velocities_set(world, 0, COUNT_OF_ALL, v));
        OK(world, skein_world_time_set(world, time));
        steps(world, 30, 1.0 / 120);
        if (skein_world_hash(world) != ought) fail_msg("%s has other bits", all_methods[m]);
        FAILS(world, SKEIN_ERROR_VALUE, "0 to 1e15", skein_world_time_set(world, -1));
        FAILS(world, SKEIN_ERROR_VALUE, "0 to 1e15", skein_world_time_set(world, NAN));
        assert_near(skein_world_time(world), time + 0.25, 1e-9);
        skein_world_destroy(world);
    }
}

/* A step that is measured is a step: the same bits under every method; its passes have names and times. */
static void measures_the_passes_of_a_step(void **state) {
    enum { MOST = 64 };
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *worlds[2];
        skein_pass passes[MOST];
        size_t count = 0, few = 0;
        for (int w = 0; w < 2; w++) {
            worlds[w] = new_world(all_methods[m], 20);
            OK(worlds[w],
               skein_body_add(worlds[w], "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_PAIR("grid", 20, 20), SKEIN_TEXT("pins", "top corners"),
                                             SKEIN_REAL("density", 2), SKEIN_REAL("stretch.stiffness", 50),
                                             SKEIN_REAL("shear.stiffness", 10), SKEIN_TEXT("bend.by", "springs"),
                                             SKEIN_REAL("bend.stiffness", 1)),
                              NULL));
            add_gravity(worlds[w]);
            OK(worlds[w], skein_collider_add(worlds[w], "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -0.1)), NULL));
        }
        for (int i = 0; i < (SPARING ? 3 : 20); i++) {
            OK(worlds[0], skein_world_step(worlds[0], 1.0 / 120));
            OK(worlds[1], skein_world_profile(worlds[1], 1.0 / 120, passes, MOST, &count));
        }
        if (skein_world_hash(worlds[0]) != skein_world_hash(worlds[1])) fail_msg("%s has other bits", all_methods[m]);
        assert_near(skein_world_time(worlds[0]), skein_world_time(worlds[1]), 0);
        assert_true(count > 3 && count < MOST);
        bool plane = false;
        for (size_t p = 0; p < count; p++) {
            assert_true(passes[p].seconds >= 0 && passes[p].seconds < 10);
            plane |= !strcmp(passes[p].label, "plane");
            for (size_t q = 0; q < p; q++)
                assert_false(passes[p].kind == passes[q].kind && !strcmp(passes[p].label, passes[q].label));
        }
        assert_true(plane);
        OK(worlds[1], skein_world_profile(worlds[1], 1.0 / 120, passes, 2, &few));
        assert_true(few >= count);
        FAILS(worlds[1], SKEIN_ERROR_VALUE, "more than 0", skein_world_profile(worlds[1], 0, passes, MOST, &count));
        for (int w = 0; w < 2; w++) skein_world_destroy(worlds[w]);
    }
}

static void tells_which_fields_can_change(void **state) {
    skein_world *world = empty_world();
    skein_handle body;
    (void)state;
    OK(world, skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 3)), &body));
    assert_true(skein_field_is_live(world, body, "stretch.stiffness"));
    assert_true(skein_field_is_live(world, body, "visible"));
    assert_false(skein_field_is_live(world, body, "grid"));
    assert_false(skein_field_is_live(world, body, "no_such_field"));
    assert_true(skein_field_is_live(world, skein_object_at(world, SKEIN_METHOD, 0), "substeps"));
    assert_false(skein_field_is_live(world, (skein_handle){.index = 99, .generation = 1}, "stretch.stiffness"));
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_meet_a_sheet),
        cmocka_unit_test(rays_meet_balls_and_bowls),
        cmocka_unit_test(rays_meet_planes_at_any_angle),
        cmocka_unit_test(rays_meet_boxes_and_capsules),
        cmocka_unit_test(finds_the_nearest_particles),
        cmocka_unit_test(a_ray_has_a_width),
        cmocka_unit_test(refuses_bad_rays),
        cmocka_unit_test(held_particles_move_with_their_velocity),
        cmocka_unit_test(a_world_goes_back_to_a_copy),
        cmocka_unit_test(measures_the_passes_of_a_step),
        cmocka_unit_test(tells_which_fields_can_change),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
