/* The shapes of colliders against a reference in double precision: distance and normal at random points and at those
 * where a formula might divide by zero, standing, moved and turned. */
#include "helpers.h"
#include "world/world.h"

static const double tolerance = 60; /* roundings, at coordinates of a few metres */

typedef struct answer {
    double distance;
    vec3 normal;
    double doubt; /* how near the point is to where the normal jumps */
} answer;

/* ---- The reference ------------------------------------------------------------------------------- */

static vec3 plus_scaled(vec3 a, double s, vec3 b) {
    return (vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static double dot3(vec3 a, vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vec3 turned(vec3 p, int axis, double degrees) {
    double s = sin(degrees * PI / 180), c = cos(degrees * PI / 180);
    if (axis == 0) return (vec3){p.x, c * p.y - s * p.z, s * p.y + c * p.z};
    if (axis == 1) return (vec3){c * p.x + s * p.z, p.y, c * p.z - s * p.x};
    return (vec3){c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

static answer of_ball(vec3 p, vec3 centre, double radius) {
    vec3 d = minus(p, centre);
    double length = length3(d);
    return (answer){length - radius, plus_scaled((vec3){0, 0, 0}, 1 / length, d), length};
}

static answer of_bowl(vec3 p, vec3 centre, double radius) {
    answer a = of_ball(p, centre, radius);
    return (answer){-a.distance, plus_scaled((vec3){0, 0, 0}, -1, a.normal), a.doubt};
}

static answer of_capsule(vec3 p, vec3 from, vec3 to, double radius) {
    vec3 way = minus(to, from);
    double square = dot3(way, way), t = square > 0 ? dot3(minus(p, from), way) / square : 0;
    return of_ball(p, plus_scaled(from, t < 0 ? 0 : t > 1 ? 1 : t, way), radius);
}

/* By trial of all the ways out of it, or to it. */
static answer of_box(vec3 p, vec3 centre, vec3 size, vec3 degrees) {
    vec3 q = turned(turned(turned(minus(p, centre), 2, -degrees.z), 1, -degrees.y), 0, -degrees.x);
    double x[3] = {q.x, q.y, q.z}, half[3] = {size.x / 2, size.y / 2, size.z / 2}, to[3], n[3] = {0, 0, 0};
    double best = INFINITY, second = INFINITY, square = 0;
    for (int k = 0; k < 3; k++) {
        to[k] = x[k] - fmax(-half[k], fmin(half[k], x[k]));
        square += to[k] * to[k];
    }
    answer a = {sqrt(square), {0, 0, 0}, sqrt(square)};
    if (square > 0) {
        for (int k = 0; k < 3; k++) n[k] = to[k] / a.distance;
    } else {
        for (int face = 0; face < 6; face++) {
            double way = half[face / 2] - (face % 2 ? 1 : -1) * x[face / 2];
            if (way < best) {
                second = best, best = way;
                for (int k = 0; k < 3; k++) n[k] = k == face / 2 ? (face % 2 ? 1 : -1) : 0;
            } else if (way < second) {
                second = way;
            }
        }
        a = (answer){-best, {0, 0, 0}, second - best};
    }
    a.normal = turned(turned(turned((vec3){n[0], n[1], n[2]}, 0, degrees.x), 1, degrees.y), 2, degrees.z);
    return a;
}

/* ---- The library's ------------------------------------------------------------------------------- */

static answer probe(const skein_world *world, double time, vec3 p) {
    const sk_collider *collider = world->rules.colliders.data[0];
    sk_pose pose = sk_collider_pose_at(collider, time);
    answer out = {0, {0, 0, 0}, 0};
    for (int version = 0; version < 2; version++) {
        // the point in one lane, others near it
        skein_real many[3][SK_LANES];
        sk_sixteen_contacts contact;
        int lane = version ? 11 : 0;
        for (int l = 0; l < SK_LANES; l++) {
            many[0][l] = (skein_real)(p.x + (l - lane)), many[1][l] = (skein_real)p.y;
            many[2][l] = (skein_real)(p.z - 0.1 * (l - lane));
        }
        sk_probe_sixteen_of[version ? world->isa : 0](collider, &pose, many, SK_REAL_MAX, &contact);
        answer now = {
            (double)contact.distance[lane],
            {(double)contact.normal[0][lane], (double)contact.normal[1][lane], (double)contact.normal[2][lane]},
            0};
        if (version) assert_memory_equal(&now, &out, sizeof now); // the same bits in any lane and set
        out = now;
    }
    assert_near(length3(out.normal), 1, 10 * EPSILON);
    return out;
}

static void compare(const skein_world *world, double time, vec3 p, answer ought, vec3 back_degrees) {
    answer is = probe(world, time, p);
    double scale = tolerance * EPSILON * (1 + length3(p));
    assert_near(is.distance, ought.distance, scale);
    if (ought.doubt < 1e-3) return;
    vec3 normal = turned(ought.normal, 2, back_degrees.z);
    assert_under(length3(minus(is.normal, normal)), scale / fmin(1, ought.doubt));
}

typedef enum shape { BALL, BOWL, ROD, BOX } shape;

static answer reference(shape s, vec3 p, const double *n) {
    vec3 a = {n[0], n[1], n[2]}, b = {n[3], n[4], n[5]}, c = {n[6], n[7], n[8]};
    return s == BALL   ? of_ball(p, a, n[9])
           : s == BOWL ? of_bowl(p, a, n[9])
           : s == ROD  ? of_capsule(p, a, b, n[9])
                       : of_box(p, a, b, c);
}

static skein_world *world_of(shape s, const double *n) {
    skein_world *world = skein_world_create(NULL, NULL);
    skein_handle handle;
    const skein_setting *settings[] = {
        SKEIN_SETTINGS(SKEIN_VEC3("centre", n[0], n[1], n[2]), SKEIN_REAL("radius", n[9])),
        SKEIN_SETTINGS(SKEIN_VEC3("centre", n[0], n[1], n[2]), SKEIN_REAL("radius", n[9])),
        SKEIN_SETTINGS(SKEIN_VEC3("from", n[0], n[1], n[2]), SKEIN_VEC3("to", n[3], n[4], n[5]),
                       SKEIN_REAL("radius", n[9])),
        SKEIN_SETTINGS(SKEIN_VEC3("centre", n[0], n[1], n[2]), SKEIN_VEC3("size", n[3], n[4], n[5]),
                       SKEIN_VEC3("rotation", n[6], n[7], n[8]))};
    static const char *const kinds[] = {"sphere", "bowl", "capsule", "box"};
    OK(world, skein_collider_add(world, kinds[s], settings[s], &handle));
    OK(world, skein_set(world, handle, "recovery", skein_number(1e6))); // what is put inside is out at once
    return world;
}

/* Numbers of a shape: its centre or first end, its second end or size, its turns, its radius. */
static void random_shape(uint64_t *seed, double *n) {
    for (int k = 0; k < 3; k++) {
        n[k] = random_between(seed, -1, 1);
        n[3 + k] = random_between(seed, 0.1, 2);
        n[6 + k] = random_between(seed, -200, 200);
    }
    n[9] = random_between(seed, 0.1, 1.5);
}

static void shapes_agree_with_the_reference(void **state) {
    (void)state;
    uint64_t seed = 5;
    for (shape s = BALL; s <= BOX; s++)
        for (int i = 0; i < 30; i++) {
            double n[10];
            random_shape(&seed, n);
            skein_world *world = world_of(s, n);
            for (int k = 0; k < 100; k++) {
                vec3 p = {(skein_real)random_between(&seed, -2.5, 2.5), (skein_real)random_between(&seed, -2.5, 2.5),
                          (skein_real)random_between(&seed, -2.5, 2.5)};
                compare(world, 0, p, reference(s, p, n), (vec3){0, 0, 0});
            }
            skein_world_destroy(world);
        }
}

/* Moved and turned about its own point, it is the standing shape at the point moved and turned back. */
static void shapes_move(void **state) {
    (void)state;
    uint64_t seed = 6;
    for (shape s = BALL; s <= BOX; s++)
        for (int i = 0; i < 20; i++) {
            double n[10], time = 0.75, spin = 2;
            random_shape(&seed, n);
            skein_world *world = world_of(s, n);
            vec3 v = {0.3, -0.2, 0.1}, own = s == ROD ? (vec3){(n[0] + n[3]) / 2, (n[1] + n[4]) / 2, (n[2] + n[5]) / 2}
                                                      : (vec3){n[0], n[1], n[2]};
            OK(world, skein_set_path(world, "colliders.0.motion.velocity", skein_vector(v.x, v.y, v.z)));
            OK(world, skein_set_path(world, "colliders.0.motion.axis", skein_vector(0, 0, 3)));
            OK(world, skein_set_path(world, "colliders.0.motion.spin", skein_number(spin)));
            for (int k = 0; k < 50; k++) {
                vec3 p = {(skein_real)random_between(&seed, -2, 2), (skein_real)random_between(&seed, -2, 2),
                          (skein_real)random_between(&seed, -2, 2)};
                double degrees = spin * time * 180 / PI;
                vec3 back = plus_scaled(own, 1, turned(plus_scaled(minus(p, own), -time, v), 2, -degrees));
                compare(world, time, p, reference(s, back, n), (vec3){0, 0, degrees});
            }
            skein_pose pose;
            OK(world, skein_collider_pose(world, skein_object_at(world, SKEIN_COLLIDER, 0), &pose));
            assert_near(pose.position[0], own.x, 1e-6);
            skein_world_destroy(world);
        }
}

/* In the middle, on an axis, on edges and corners, a hair beside them, and far off: a unit normal and a number. */
static void degenerate_points_have_a_normal(void **state) {
    (void)state;
    static const double plain[10] = {0, 0, 0, 1, 2, 3, 0, 0, 0, 1}, upright[10] = {0, -1, 0, 0, 1, 0, 0, 0, 0, 0.5},
                        point[10] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0.5};
    static const vec3 places[] = {{0, 0, 0},           {0.5, 1, 1.5},      {0.5, 0, 0},         {0, 1, 0},
                                  {0.5, 1, 0},         {0, 0.5, 0},        {1, 2, 3},           {0.25, 0.5, 0.75},
                                  {1e-30, 0, 0},       {0, -1e-30, 1e-30}, {1e12, -1e12, 1e12}, {1, 0, 0},
                                  {0.5 + 1e-7, 1, 1.5}};
    for (shape s = BALL; s <= BOX; s++)
        for (size_t i = 0; i < COUNT(places); i++) {
            skein_world *world = world_of(s, plain);
            answer is = probe(world, 0, places[i]);
            assert_true(isfinite(is.distance));
            if (s != BOWL && i < 9) assert_near(is.distance, reference(s, places[i], plain).distance, 1e-5);
            skein_world_destroy(world);
        }
    // the middle of a bowl is no contact, however thick its skin
    skein_world *world = world_of(BOWL, plain);
    OK(world, skein_set_path(world, "colliders.0.thickness", skein_number(5)));
    assert_true(probe(world, 0, (vec3){0, 0, 0}).distance > 1e6);
    add_particle(world, 1, 0, 0, 0);
    steps(world, 1, 0.01);
    assert_true(length3(position_of(world, 0)) == 0);
    assert_int_equal(statistics_of(world).contacts, 0);
    skein_world_destroy(world);
    // on the line of an upright rod, and in the middle of one without a length
    world = world_of(ROD, upright);
    for (int k = -8; k <= 8; k++) {
        answer is = probe(world, 0, (vec3){0, 0.2 * k, 0});
        assert_near(is.distance, fmax(0, fabs(0.2 * k) - 1) - 0.5, 1e-6);
        if (abs(k) < 5) assert_under(is.normal.y, 1e-6);
    }
    skein_world_destroy(world);
    world = world_of(ROD, point);
    assert_near(probe(world, 0, (vec3){0, 0, 0}).distance, -0.5, 1e-7);
    assert_near(probe(world, 0, (vec3){0, 3, 4}).distance, 4.5, 1e-6);
    skein_world_destroy(world);
}

/* Each shape keeps a particle out (or in), under both ways of a contact. */
static void shapes_push_out(void **state) {
    (void)state;
    static const double n[10] = {0, 0, 0, 1, 2, 3, 0, 0, 30, 1};
    uint64_t seed = 7;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (shape s = BALL; s <= BOX; s++) {
            skein_world *world = world_of(s, n);
            OK(world, skein_method_set(world, method_names[m], SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
            for (int i = 0; i < 50; i++)
                add_particle(world, 1, random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                             random_between(&seed, -1, 1));
            steps(world, 2, 1e-3); // a move through a corner may need a second one
            assert_under(statistics_of(world).max_penetration, 1e-5);
            for (size_t i = 0; i < 50; i++) assert_true(probe(world, 0, position_of(world, i)).distance > 0.002 - 1e-5);
            skein_world_destroy(world);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_agree_with_the_reference),
        cmocka_unit_test(shapes_move),
        cmocka_unit_test(degenerate_points_have_a_normal),
        cmocka_unit_test(shapes_push_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
