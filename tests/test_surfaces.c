/* Formulas as colliders: held against the shapes that the library has, and against closed forms where they move. */
#include "all_methods.h"
#include "helpers.h"

static const double frame = 1.0 / 60;

/* A shape, and the same as a formula. */
static const struct {
    const char *kind;
    skein_setting own[4], formula[6];
} pairs[] = {
    {"plane",
     {SKEIN_REAL("offset", 0.2), SKEIN_VEC3("normal", 0.6, 0.8, 0)},
     {SKEIN_VEC3("centre", 0.2 * 0.6, 0.2 * 0.8, 0), SKEIN_TEXT("surface", "dot(vec3(s, c, 0), p)"),
      SKEIN_REAL("parameters.s", 0.6), SKEIN_REAL("parameters.c", 0.8)}},
    {"plane", {SKEIN_VEC3("normal", 0, 1, 0)}, {SKEIN_TEXT("surface", "p.y*2")}},
    {"sphere",
     {SKEIN_VEC3("centre", 0.05, -0.5, 0), SKEIN_REAL("radius", 0.7)},
     {SKEIN_VEC3("centre", 0.05, -0.5, 0), SKEIN_TEXT("surface", "length(p) - R"), SKEIN_REAL("parameters.R", 0.7)}},
    {"bowl",
     {SKEIN_VEC3("centre", 0, 1.5, 0), SKEIN_REAL("radius", 1.5)},
     {SKEIN_TEXT("surface", "R - distance(p, vec3(0, height, 0))"), SKEIN_REAL("parameters.height", 1.5),
      SKEIN_REAL("parameters.R", 1.5)}},
    {"capsule",
     {SKEIN_VEC3("from", -0.5, 0, 0), SKEIN_VEC3("to", 0.5, 0, 0), SKEIN_REAL("radius", 0.2)},
     {SKEIN_TEXT("surface", "length(p - vec3(clamp(p.x, -l, l), 0, 0)) - r"), SKEIN_REAL("parameters.l", 0.5),
      SKEIN_REAL("parameters.r", 0.2)}},
};

/* All settings of up to three lists. */
static const skein_setting *join(skein_setting out[24], const skein_setting *const *lists) {
    size_t count = 0;
    for (; *lists; lists++)
        for (const skein_setting *s = *lists; s->name; s++) out[count++] = *s;
    out[count].name = NULL;
    return out;
}

static void add_pair(skein_world *world, size_t pair, bool formula, const skein_setting *more) {
    skein_setting settings[24];
    join(settings, (const skein_setting *const[]){formula ? pairs[pair].formula : pairs[pair].own, more, NULL});
    OK(world, skein_collider_add(world, formula ? "formula" : pairs[pair].kind, settings, NULL));
}

enum { CLOUD = 100 };

/* Gaps and normals of a cloud of particles. */
static void distances_are_those_of_the_shapes(void **state) {
    (void)state;
    for (size_t pair = 0; pair < COUNT(pairs); pair++) {
        skein_contact contacts[2][CLOUD];
        for (int formula = 0; formula < 2; formula++) {
            skein_world *world = new_world("xpbd", 1);
            add_pair(world, pair, formula, SKEIN_SETTINGS(SKEIN_REAL("thickness", 100)));
            uint64_t seed = 7;
            for (int i = 0; i < CLOUD; i++)
                add_particle(world, 1, random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                             random_between(&seed, -1, 1));
            size_t count;
            OK(world, skein_contacts_copy(world, contacts[formula], CLOUD, &count));
            assert_int_equal(count, CLOUD);
            skein_world_destroy(world);
        }
        // the second plane is given as twice its distance
        for (int i = 0; i < CLOUD; i++) {
            assert_near(contacts[1][i].gap, contacts[0][i].gap, 8 * EPSILON);
            for (int k = 0; k < 3; k++) assert_near(contacts[1][i].normal[k], contacts[0][i].normal[k], 32 * EPSILON);
        }
    }
}

/* A handful of particles that fall, hit and slide, under a collider that stands or moves. */
static skein_world *rain(const char *method, size_t pair, bool formula, const skein_setting *more) {
    skein_world *world = new_world(method, 10);
    add_gravity(world);
    add_pair(world, pair, formula, more);
    uint64_t seed = 3;
    for (int i = 0; i < 20; i++)
        add_moving(world, 0.1 + 0.1 * i, random_between(&seed, -0.6, 0.6), random_between(&seed, 0.3, 0.8),
                   random_between(&seed, -0.3, 0.3), random_between(&seed, -1, 1), 0, random_between(&seed, -1, 1));
    steps(world, 40, frame);
    return world;
}

static void motion_is_that_of_the_shapes(void **state) {
    (void)state;
    static const skein_setting still[] = {SKEIN_REAL("friction", 0.4), {NULL, {0, {0, 0, 0}, NULL}}};
    static const skein_setting moving[] = {SKEIN_REAL("friction", 0.4),    SKEIN_VEC3("motion.velocity", 0.1, 0.2, 0),
                                           SKEIN_REAL("motion.spin", 2),   SKEIN_VEC3("motion.axis", 0, 1, 0.2),
                                           SKEIN_REAL("restitution", 0.5), {NULL, {0, {0, 0, 0}, NULL}}};
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t pair = 0; pair < COUNT(pairs); pair++)
            for (int moves = 0; moves < 2; moves++) {
                // a bowl that is given by its height turns about another point
                if (moves && pair == 3) continue;
                skein_world *world[2];
                for (int formula = 0; formula < 2; formula++)
                    world[formula] = rain(all_methods[m], pair, formula, moves ? moving : still);
                double off = 0;
                size_t touching = statistics_of(world[0]).contacts;
                for (size_t i = 0; i < 20; i++)
                    off = fmax(off, length3(minus(position_of(world[1], i), position_of(world[0], i))));
                // where rounding decides in which substep a particle meets the surface, they part by a part of that
                double most = 1; // XX
                if (off > most || getenv("SHOW"))
                    print_message("%s, pair %zu, %d: off by %g\n", all_methods[m], pair, moves, off);
                assert_under(off, most);
                if (pair == 1 && !moves) assert_true(touching > 0);
                for (int formula = 0; formula < 2; formula++) skein_world_destroy(world[formula]);
            }
}

/* ---- The four terrains --------------------------------------------------------------------------- */

static const struct {
    const char *kind;
    skein_setting own[5], formula[6];
    vec3 at;
    double turn;
    int frames;
    bool rests;
} terrains[] = {
    {"plane",
     {SKEIN_VEC3("normal", 0, 1, 0), SKEIN_REAL("friction", 0.5)},
     {SKEIN_TEXT("surface", "p.y"), SKEIN_REAL("friction", 0.5)},
     {0, 0.5, 0},
     0,
     120,
     true},
    {"plane",
     {SKEIN_VEC3("normal", 0.42261826, 0.90630779, 0), SKEIN_REAL("friction", 0.55)},
     {SKEIN_TEXT("surface", "p.x*sin(25*pi/180) + p.y*cos(25*pi/180)"), SKEIN_REAL("friction", 0.55)},
     {0.116, 0.249, 0},
     -25,
     120,
     true},
    {"bowl",
     {SKEIN_VEC3("centre", 0, 1.5, 0), SKEIN_REAL("radius", 1.5), SKEIN_REAL("friction", 0.2)},
     {SKEIN_VEC3("centre", 0, 1.5, 0), SKEIN_TEXT("surface", "R - length(p)"), SKEIN_REAL("parameters.R", 1.5),
      SKEIN_REAL("friction", 0.2)},
     {-0.595, 0.469, 0},
     -30,
     240,
     true},
    {"sphere",
     {SKEIN_VEC3("centre", 0, 0.7, 0), SKEIN_REAL("radius", 0.7), SKEIN_REAL("friction", 0.2)},
     {SKEIN_TEXT("surface", "length(p - vec3(0, R, 0)) - R"), SKEIN_REAL("parameters.R", 0.7),
      SKEIN_REAL("friction", 0.2)},
     {0.12, 1.7, 0},
     0,
     50,
     false},
};

static skein_world *cube_on(const char *method, size_t i, bool formula) {
    skein_world *world = new_world(method, 20);
    add_gravity(world);
    OK(world, skein_collider_add(world, formula ? "formula" : terrains[i].kind,
                                 formula ? terrains[i].formula : terrains[i].own, NULL));
    OK(world, skein_body_add(world, "lattice", NULL,
                             SKEIN_SETTINGS(SKEIN_VEC3("grid", 3, 3, 3), SKEIN_VEC3("size", 0.5, 0.5, 0.5),
                                            SKEIN_VEC3("position", terrains[i].at.x, terrains[i].at.y, terrains[i].at.z),
                                            SKEIN_VEC3("rotation", 0, 0, terrains[i].turn), SKEIN_REAL("mass", 10),
                                            SKEIN_REAL("structural.stiffness", 1000),
                                            SKEIN_REAL("structural.damping", 5), SKEIN_REAL("shear.stiffness", 500),
                                            SKEIN_REAL("shear.damping", 2.5), SKEIN_REAL("bending.stiffness", 250),
                                            SKEIN_REAL("bending.damping", 1.2), SKEIN_REAL("struts", 1)),
                             NULL));
    return world;
}

static vec3 middle_of(const skein_world *world) {
    vec3 sum = {0, 0, 0};
    size_t count = skein_particle_count(world);
    for (size_t i = 0; i < count; i++) {
        vec3 p = position_of(world, i);
        sum.x += p.x / (double)count, sum.y += p.y / (double)count, sum.z += p.z / (double)count;
    }
    return sum;
}

/* A jelly cube comes to rest where it does on the built-in terrain; on the ball, the way is compared. */
static void cubes_rest_where_they_do_on_the_shapes(void **state) {
    (void)state;
    static const char *const methods[] = {"symplectic_euler", "xpbd"};
    for (size_t m = 0; m < COUNT(methods); m++)
        for (size_t i = 0; i < COUNT(terrains); i++) {
            vec3 end[2];
            for (int formula = 0; formula < 2; formula++) {
                skein_world *world = cube_on(methods[m], i, formula);
                steps(world, terrains[i].frames, frame);
                end[formula] = middle_of(world);
                skein_statistics s = statistics_of(world);
                if (terrains[i].rests) assert_under(s.kinetic_energy, 2e-3);
                assert_under(s.max_penetration, 1e-4);
                assert_true(s.contacts > 0);
                skein_world_destroy(world);
            }
            double off = length3(minus(end[1], end[0]));
            if (off > 2e-3) print_message("%s, terrain %zu: off by %g m\n", methods[m], i, off);
            assert_under(off, 2e-3);
        }
}

/* ---- Surfaces that move by themselves ---------------------------------------------------------- */

/* What lies on a slow piston goes up and down with it. */
static void a_piston_carries(void **state) {
    (void)state;
    const double w = 4, a = 0.1; // 1.6 m/s2: it stays in touch
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 20);
        add_gravity(world);
        OK(world, skein_collider_add(world, "formula",
                                     SKEIN_SETTINGS(SKEIN_TEXT("surface", "p.y - a*sin(w*t)"),
                                                    SKEIN_REAL("parameters.a", a), SKEIN_REAL("parameters.w", w)),
                                     NULL));
        uint32_t p = add_moving(world, 2, 0, 0.002, 0, 0, a * w, 0);
        double worst = 0, worst_speed = 0;
        for (int i = 1; i <= 120; i++) {
            steps(world, 1, frame);
            double t = skein_world_time(world), off = fabs(position_of(world, p).y - 0.002 - a * sin(w * t));
            double fast = fabs(velocity_of(world, p).y - a * w * cos(w * t));
            worst = fmax(worst, off), worst_speed = fmax(worst_speed, fast);
        }
        if (worst > 1e-5 || worst_speed > 0.02)
            print_message("%s: off by %g m, %g m/s\n", all_methods[m], worst, worst_speed);
        assert_under(worst, 1e-5);
        assert_under(worst_speed, 0.02);
        skein_world_destroy(world);
    }
}

/* Off a wall that comes with speed u it bounces to 2 u - v; a formula that is not a distance has the same speed. */
static void bounces_know_the_surfaces_speed(void **state) {
    (void)state;
    static const char *const surfaces[] = {"p.x - u*t", "5*(p.x - u*t)", "exp(p.x - u*t) - 1"};
    const double u = 0.5, v = 2;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t s = 0; s < COUNT(surfaces); s++) {
            skein_world *world = new_world(all_methods[m], 1);
            OK(world, skein_collider_add(world, "formula",
                                         SKEIN_SETTINGS(SKEIN_TEXT("surface", surfaces[s]), SKEIN_REAL("restitution", 1),
                                                        SKEIN_REAL("parameters.u", u), SKEIN_REAL("friction", 0)),
                                         NULL));
            uint32_t p = add_moving(world, 1, 0.1, 0, 0, -v, 1, 0);
            steps(world, 100, 1e-3);
            vec3 after = velocity_of(world, p);
            if (fabs(after.x - v - 2 * u) > 0.02)
                print_message("%s, %s: %g m/s\n", all_methods[m], surfaces[s], after.x);
            assert_near(after.x, v + 2 * u, 0.02);
            assert_near(after.y, 1, 1e-5);
            skein_world_destroy(world);
        }
}

/* ---- While it lives ------------------------------------------------------------------------------ */

/* What a program sees of a collider at any point, and that is refused of other things. */
static void colliders_are_probed(void **state) {
    (void)state;
    enum { MANY = 37 };
    double points[3 * MANY], distances[MANY], normals[3 * MANY];
    skein_world *world = new_world("xpbd", 1);
    skein_handle sphere, formula, gravity;
    OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.5)), &sphere));
    OK(world,
       skein_collider_add(
           world, "formula",
           SKEIN_SETTINGS(SKEIN_TEXT("surface", "length(p) - 0.5"), SKEIN_VEC3("motion.velocity", 1, 0, 0)), &formula));
    OK(world, skein_force_add(world, "gravity", NULL, &gravity));
    add_particle(world, 1, 0, 9, 0);
    steps(world, 1, 0.25);
    uint64_t seed = 9;
    for (int i = 0; i < 3 * MANY; i++) points[i] = random_between(&seed, -2, 2);
    for (int moved = 0; moved < 2; moved++) {
        OK(world, skein_collider_probe(world, moved ? formula : sphere, MANY, points, distances, normals));
        for (int i = 0; i < MANY; i++) {
            vec3 off = {points[3 * i] - (moved ? 0.25 : 0), points[3 * i + 1], points[3 * i + 2]};
            assert_near(distances[i], length3(off) - 0.5, 1e-6);
            assert_near(normals[3 * i], off.x / length3(off), 1e-6);
            assert_near(normals[3 * i + 2], off.z / length3(off), 1e-6);
        }
    }
    OK(world, skein_collider_probe(world, sphere, MANY, points, NULL, NULL));
    FAILS(world, SKEIN_ERROR_HANDLE, "no such collider",
          skein_collider_probe(world, gravity, MANY, points, distances, NULL));
    skein_world_destroy(world);
}

static void surfaces_change_while_they_live(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 10);
    skein_handle handle;
    add_gravity(world);
    OK(world,
       skein_collider_add(world, "formula",
                          SKEIN_SETTINGS(SKEIN_TEXT("surface", "p.y - h"), SKEIN_REAL("parameters.h", 0.1)), &handle));
    uint32_t p = add_particle(world, 1, 0, 0.3, 0);
    steps(world, 40, frame);
    assert_near(position_of(world, p).y, 0.102, 1e-4);
    OK(world, skein_set(world, handle, "parameters.h", skein_number(0.2)));
    steps(world, 16, frame); // it comes out at its recovery of 1 m/s
    assert_near(position_of(world, p).y, 0.202, 1e-4);
    FAILS(world, SKEIN_ERROR_NAME, "did you mean 'length'",
          skein_set(world, handle, "surface", skein_text("lenght(p) - h")));
    steps(world, 16, frame);
    assert_near(position_of(world, p).y, 0.202, 1e-4);
    OK(world, skein_set(world, handle, "surface", skein_text("p.y - 2*h")));
    steps(world, 16, frame);
    assert_near(position_of(world, p).y, 0.402, 1e-4);
    FAILS(world, SKEIN_ERROR_VALUE, "the same everywhere", skein_set(world, handle, "surface", skein_text("1")));
    FAILS(world, SKEIN_ERROR_VALUE, "rest pose", skein_set(world, handle, "surface", skein_text("rest(p.x) - p.x")));
    FAILS(world, SKEIN_ERROR_NAME, "velocity", skein_set(world, handle, "surface", skein_text("p.x + v.x")));
    FAILS(world, SKEIN_ERROR_LIMIT, "only p", skein_set(world, handle, "surface", skein_text("p1.x")));
    FAILS(world, SKEIN_ERROR_VALUE, "expected a number", skein_set(world, handle, "surface", skein_text("p")));
    skein_value value;
    OK(world, skein_get(world, handle, "surface", &value));
    assert_string_equal(value.text, "p.y - 2*h");
    skein_world_destroy(world);
}

/* Where there is no value or no slope nothing breaks, and it is counted. */
static void awkward_places_are_finite(void **state) {
    (void)state;
    static const char *const surfaces[] = {"length(p) - 0.5",  "1/p.x",         "log(p.y)",      "sqrt(p.y)",
                                           "1e30*exp(80*p.x)", "p.x^2 + p.y^2", "acos(p.x) - 1", "p.x^2 - 1",
                                           "abs(p.y)",         "p.y^0.5 - 0.1"};
    for (size_t s = 0; s < COUNT(surfaces); s++)
        for (size_t m = 0; m < COUNT(all_methods); m++) {
            skein_world *world = new_world(all_methods[m], 2);
            add_gravity(world);
            OK(world, skein_collider_add(world, "formula", SKEIN_SETTINGS(SKEIN_TEXT("surface", surfaces[s])), NULL));
            add_particle(world, 1, 0, 0, 0);
            add_particle(world, 1, 1e14, -1e14, 3);
            add_particle(world, 1, 1, 0, 0);
            if (s < 4) assert_true(statistics_of(world).guarded > 0);
            steps(world, 5, frame);
            assert_int_equal(statistics_of(world).nonfinite, 0);
            skein_world_destroy(world);
        }
}

/* The middle of a ball: up is out, as for the sphere. */
static void guards_are_counted(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    OK(world,
       skein_collider_add(world, "formula",
                          SKEIN_SETTINGS(SKEIN_TEXT("surface", "length(p) - 0.5"), SKEIN_REAL("recovery", 1e6)), NULL));
    add_particle(world, 1, 0, 0, 0);
    add_particle(world, 1, 0, 2, 0);
    add_particle(world, 0, 0, 0, 0);
    assert_int_equal(statistics_of(world).guarded, 1); // the held one goes nowhere
    steps(world, 1, frame);
    assert_near(position_of(world, 0).y, 0.502, 1e-5);
    assert_int_equal(statistics_of(world).guarded, 0);
    skein_world_destroy(world);
}

static uint64_t hash_under(const char *isa, const char *method) {
    if (isa[0]) setenv("SKEIN_SIMD", isa, 1);
    skein_world *world = new_world(method, 5);
    unsetenv("SKEIN_SIMD");
    add_gravity(world);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 9), SKEIN_VEC3("position", 0, 0.4, 0),
                                            SKEIN_REAL("stretch.stiffness", 100), SKEIN_REAL("shear.stiffness", 10)),
                             NULL));
    OK(world, skein_collider_add(world, "formula",
                                 SKEIN_SETTINGS(SKEIN_TEXT("surface", "p.y - a*sin(3*p.x - t)*cos(p.z)"),
                                                SKEIN_REAL("parameters.a", 0.2), SKEIN_VEC3("rotation", 10, 20, 30),
                                                SKEIN_REAL("motion.spin", 1)),
                                 NULL));
    steps(world, 30, frame);
    assert_true(statistics_of(world).contacts > 0 && !statistics_of(world).nonfinite);
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

static void instruction_sets_agree(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        uint64_t hash = hash_under("", method_names[m]);
#ifndef SK_ONE_ISA
        static const char *const isas[] = {"sse", "avx2", "avx512"};
        for (size_t i = 0; i < COUNT(isas); i++) assert_true(hash_under(isas[i], method_names[m]) == hash);
#endif
        assert_true(hash_under("", method_names[m]) == hash);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_those_of_the_shapes),
        cmocka_unit_test(motion_is_that_of_the_shapes),
        cmocka_unit_test(cubes_rest_where_they_do_on_the_shapes),
        cmocka_unit_test(a_piston_carries),
        cmocka_unit_test(bounces_know_the_surfaces_speed),
        cmocka_unit_test(colliders_are_probed),
        cmocka_unit_test(surfaces_change_while_they_live),
        cmocka_unit_test(awkward_places_are_finite),
        cmocka_unit_test(guards_are_counted),
        cmocka_unit_test(instruction_sets_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
