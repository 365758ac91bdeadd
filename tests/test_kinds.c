/* Constraints of three and four particles, and those that are texts: against each other, and against closed forms. */
#include "all_methods.h"
#include "helpers.h"
#include "irregular.h"
#include "world/world.h"
#include <skein/formula.h>

/* Each built-in kind, as a text. */
static const struct {
    const char *kind, *text;
    size_t arity;
} kinds[] = {
    {"distance", "length(p0 - p1) - rest(length(p0 - p1))", 2},
    {"dihedral",
     "let a = dihedral(p0, p1, p2, p3) - rest(dihedral(p0, p1, p2, p3));\n"
     "select(a > pi, a - 2 * pi, select(a < -pi, a + 2 * pi, a))",
     4},
    {"isometric",
     "let e = p1 - p0; let f = p2 - p0; let g = p3 - p0; let h = p2 - p1; let i = p3 - p1;\n"
     "let s = sqrt(2 / (length(cross(e, f)) + length(cross(e, g))));\n"
     "let k0 = s * dot(e, f) / length(cross(e, f)); let k1 = s * dot(e, g) / length(cross(e, g));\n"
     "let k2 = -s * dot(e, h) / length(cross(e, h)); let k3 = -s * dot(e, i) / length(cross(e, i));\n"
     "length(rest(k2 + k3) * p0 + rest(k0 + k1) * p1 - rest(k0 + k2) * p2 - rest(k1 + k3) * p3)",
     4},
    {"straight", "let a = p0 - p1; let b = p2 - p1; length(rest(1 / length(a)) * a + rest(1 / length(b)) * b)", 3},
    {"twist", "let a = cross(p1 - p0, p3 - p0); length(p0 - p1 + p2 - p3) * rest(1 / sqrt(length(a)))", 4},
    {"area", "length(cross(p1 - p0, p2 - p0)) / 2 - rest(length(cross(p1 - p0, p2 - p0)) / 2)", 3},
    {"volume", "dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6 - rest(dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6)", 4},
    {"angle", "angle(p0 - p1, p2 - p1) - rest(angle(p0 - p1, p2 - p1))", 3},
};

enum { ELEMENTS = 10000 };

/* Elements that share no particle, at random places, then at others; some are coincident, flat or needles there. */
static skein_world *scatter(const char *method, size_t arity, double *rest, double *now) {
    uint64_t seed = 7;
    size_t count = ELEMENTS * arity;
    skein_world *world = new_world(method, 1);
    for (size_t i = 0; i < 3 * count; i++) rest[i] = random_between(&seed, -1, 1);
    for (size_t i = 0; i < 3 * count; i++) now[i] = rest[i] + random_between(&seed, -0.3, 0.3);
    for (size_t e = 0; e < ELEMENTS; e += 50) {
        double *x = now + 3 * arity * e;
        if (e % 200 == 0) memcpy(x + 3, x, 3 * sizeof *x); // two in one place
        else if (e % 200 == 50)
            for (size_t i = 1; i < 3 * arity; i += 3) x[i] = 0.5; // flat
        else if (e % 200 == 100)
            for (int k = 0; k < 3; k++) x[k + 3] = x[k] + (k == 1) * 1e-6; // a needle
        else
            for (size_t i = 0; i < 3 * arity; i++) x[i] *= 1e-3; // tiny
    }
    double *mass = malloc(count * sizeof *mass);
    for (size_t i = 0; i < count; i++) mass[i] = 1;
    // as the world keeps them
    for (size_t i = 0; i < 3 * count; i++) rest[i] = (double)(skein_real)rest[i], now[i] = (double)(skein_real)now[i];
    OK(world, skein_particles_add(world, count, rest, NULL, mass, NULL));
    free(mass);
    return world;
}

static uint32_t *in_order(size_t count) {
    uint32_t *particles = malloc(count * sizeof *particles);
    for (size_t i = 0; i < count; i++) particles[i] = (uint32_t)i;
    return particles;
}

/* One step of h from rest: the velocity is h times the force over 1 kg. */
static void push_once(skein_world *world, const double *now, size_t count, double *velocity) {
    OK(world, skein_positions_set(world, 0, count, now));
    OK(world, skein_world_step(world, 1e-3));
    OK(world, skein_velocities_copy(world, 0, count, velocity));
}

/* The kernel that was emitted, the tape, and the graph in double (which other tests hold against central differences
 * and dual numbers) at 10,000 states. */
static void kernels_tapes_and_graphs_agree(void **state) {
    (void)state;
    for (size_t k = 0; k < COUNT(kinds); k++) {
        size_t arity = kinds[k].arity, count = ELEMENTS * arity;
        double *rest = malloc(3 * count * sizeof *rest), *now = malloc(3 * count * sizeof *now);
        double *by_kernel = malloc(3 * count * sizeof *now), *by_tape = malloc(3 * count * sizeof *now);
        uint32_t *particles = in_order(count);
        skein_world *world = scatter("symplectic_euler", arity, rest, now);
        OK(world, skein_constraint_add(world, kinds[k].kind, particles, ELEMENTS,
                                       SKEIN_SETTINGS(SKEIN_REAL("stiffness", 1)), NULL));
        push_once(world, now, count, by_kernel);
        skein_world_destroy(world);
        world = scatter("symplectic_euler", arity, rest, now);
        OK(world, skein_constraint_add(
                      world, "formula", particles, ELEMENTS,
                      SKEIN_SETTINGS(SKEIN_TEXT("constraint", kinds[k].text), SKEIN_REAL("stiffness", 1)), NULL));
        push_once(world, now, count, by_tape);
        skein_world_destroy(world);

        skein_formula *f = skein_formula_create(&(skein_formula_desc){.text = kinds[k].text}, NULL, NULL);
        assert_non_null(f);
        double worst[2] = {0, 0}, largest = 0;
        for (size_t e = 0; e < ELEMENTS; e++) {
            skein_formula_value v;
            const double *x = now + 3 * arity * e;
            skein_formula_point at = {.positions = x, .rest_positions = rest + 3 * arity * e};
            assert_int_equal(skein_formula_evaluate(f, &at, &v, NULL), SKEIN_OK);
            double steepest = 0;
            for (size_t i = 0; i < 3 * arity; i++) steepest = fmax(steepest, fabs(v.by_position[0][i]));
            for (size_t i = 0; i < 3 * arity; i++) {
                double a = by_kernel[3 * arity * e + i] / 1e-3, b = by_tape[3 * arity * e + i] / 1e-3;
                double ought = -v.number[0] * v.by_position[0][i];
                assert_true(isfinite(a) && isfinite(b));
                if (e % 50 == 0) continue; // there rounding decides which way is which: finite is enough
                // the value is off by some roundings of what it is made of, its gradient by more the steeper it is
                double scale = steepest * (1 + steepest) * (1 + fabs(v.number[0]));
                worst[0] = fmax(worst[0], fabs(a - ought) / scale);
                worst[1] = fmax(worst[1], fabs(b - ought) / scale);
                largest = fmax(largest, fabs(ought));
            }
        }
        printf("%s: kernel off by %.3g roundings, tape by %.3g, force up to %.2g\n", kinds[k].kind, worst[0] / EPSILON,
               worst[1] / EPSILON, largest);
        assert_true(largest > 0.01);
        assert_under(worst[0], 100 * EPSILON);
        assert_under(worst[1], 100 * EPSILON);
        skein_formula_destroy(f);
        free(rest), free(now), free(by_kernel), free(by_tape), free(particles);
    }
}

/* ---- a kind's text goes the kind's way ---- */

static skein_world *hang(const char *method, const char *kind, const char *field, const char *text) {
    bool implicit = !strcmp(method, "backward_euler");
    skein_world *world = new_world(method, implicit ? 4 : 64);
    add_gravity(world);
    for (int i = 0; i < 6; i++) add_particle(world, i ? 0.1 : 0, 0.1 * i, 1, 0.03 * i * i);
    uint32_t pairs[10];
    for (uint32_t i = 0; i < 10; i++) pairs[i] = (i + 1) / 2;
    skein_setting settings[] = {SKEIN_REAL("stiffness", 200),
                                SKEIN_REAL("damping", 0.05),
                                SKEIN_TEXT(field, text),
                                {NULL, {0, {0, 0, 0}, NULL}}};
    if (!text) settings[2].name = NULL;
    if (!strcmp(kind, "energy"))
        settings[0] = (skein_setting)SKEIN_REAL("scale", 200), settings[1] = settings[2], settings[2].name = NULL;
    OK(world, skein_constraint_add(world, kind, pairs, 5, settings, NULL));
    return world;
}

static double farthest(skein_world *a, skein_world *b, size_t count) {
    double off = 0;
    for (size_t i = 0; i < count; i++) off = fmax(off, length3(minus(position_of(a, i), position_of(b, i))));
    return off;
}

static void a_formula_distance_goes_as_the_built_in_one(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *built_in = hang(all_methods[m], "distance", "", NULL);
        skein_world *text = hang(all_methods[m], "formula", "constraint", kinds[0].text);
        steps(built_in, 60, 1.0 / 60);
        steps(text, 60, 1.0 / 60);
        double off = farthest(built_in, text, 6), moved = length3(minus(position_of(text, 5), (vec3){0.5, 1, 0.75}));
        printf("%s: %.2g of %.2g m\n", all_methods[m], off, moved);
        // an implicit solve ends within its tolerance, and leaves out what the formula does not tell it
        assert_under(off, strcmp(all_methods[m], "backward_euler") ? 2e4 * EPSILON : 2e-3);
        assert_true(moved > 0.1);
        assert_share(statistics_of(text).elastic_energy, statistics_of(built_in).elastic_energy, 0.02);
        skein_world_destroy(built_in);
        skein_world_destroy(text);
    }
}

/* E = C^2/2 under XPBD and PBD is C itself; under forces it is the same force. */
static void an_energy_goes_as_its_constraint(void **state) {
    (void)state;
    const char *energy = "0.5 * (length(p0 - p1) - rest(length(p0 - p1)))^2";
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *a = hang(all_methods[m], "formula", "constraint", kinds[0].text);
        OK(a, skein_set_path(a, "constraints.0.damping", skein_number(0)));
        skein_world *b = hang(all_methods[m], "energy", "energy", energy);
        steps(a, 30, 1.0 / 60);
        steps(b, 30, 1.0 / 60);
        double off = farthest(a, b, 6);
        printf("%s: %.2g m\n", all_methods[m], off);
        assert_under(off, strcmp(all_methods[m], "backward_euler") ? 1e5 * EPSILON : 2e-2);
        assert_share(statistics_of(b).elastic_energy, statistics_of(a).elastic_energy, 0.05);
        skein_world_destroy(a);
        skein_world_destroy(b);
    }
}

/* A length that breathes, rigid: the particle follows it. */
static void a_formula_in_t_moves_what_hangs_on_it(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 10);
    add_particle(world, 0, 0, 0, 0);
    add_particle(world, 1, 0, -0.5, 0);
    OK(world, skein_constraint_add(world, "formula", (const uint32_t[]){0, 1}, 1,
                                   SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) - L * (1 + 0.2 * sin(t))"),
                                                  SKEIN_REAL("parameters.L", 0.5), SKEIN_REAL("stiffness", HUGE_VAL)),
                                   NULL));
    for (int i = 1; i <= 300; i++) {
        steps(world, 1, 1.0 / 60);
        assert_near(-position_of(world, 1).y, 0.5 * (1 + 0.2 * sin(i / 60.0)), 1e-5);
    }
    OK(world, skein_set_path(world, "constraints.0.parameters.L", skein_number(0.25)));
    steps(world, 1, 1.0 / 60);
    assert_near(-position_of(world, 1).y, 0.25 * (1 + 0.2 * sin(301 / 60.0)), 1e-5);
    // dC/dt has the text's own change in it: damping alone drags the particle along
    skein_world_destroy(world);
}

/* Damping against dC/dt = grad C . v + the partial derivative: a rest length that grows at 0.3 m/s drags a free end. */
static void damping_knows_that_the_formula_moves(void **state) {
    (void)state;
    static const char *const methods[] = {"symplectic_euler", "rk4", "xpbd"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world = new_world(methods[m], 4);
        add_particle(world, 0, 0, 0, 0);
        add_particle(world, 1, 1, 0, 0);
        OK(world, skein_constraint_add(world, "formula", (const uint32_t[]){0, 1}, 1,
                                       SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) - 1 - 0.3 * t"),
                                                      SKEIN_REAL("stiffness", 1e-6), SKEIN_REAL("damping", 5)),
                                       NULL));
        for (int i = 1; i <= 60; i++) steps(world, 1, 1.0 / 60);
        assert_share(velocity_of(world, 1).x, 0.3 * (1 - exp(-5)), 0.03);
        skein_world_destroy(world);
    }
}

/* A rope is only a rope when it is taut: free fall until then, and never longer. */
static void one_sided_formulas_only_hold_back(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 20);
    add_gravity(world);
    add_particle(world, 0, 0, 0, 0);
    add_particle(world, 1, 0.1, 0, 0);
    OK(world,
       skein_constraint_add(
           world, "formula", (const uint32_t[]){0, 1}, 1,
           SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) <= 1"), SKEIN_REAL("stiffness", HUGE_VAL)), NULL));
    double g = 9.81;
    steps(world, 24, 1.0 / 60);
    assert_near(position_of(world, 1).y, -0.5 * g * 0.4 * 0.4, 0.02);
    assert_share(velocity_of(world, 1).y, -g * 0.4, 1e-3);
    for (int i = 0; i < 120; i++) {
        steps(world, 1, 1.0 / 60);
        assert_true(length3(position_of(world, 1)) < 1 + 1e-4);
    }
    assert_near(length3(position_of(world, 1)), 1, 0.2);
    skein_world_destroy(world);
}

/* Undamped forces of a one-sided formula on particles that many share: finite, and the same on every instruction set.
 * (They once read velocities that nobody had fetched.) */
static void undamped_formulas_need_no_velocities(void **state) {
    (void)state;
    static const char *const sets[] = {"sse", "avx2", "avx512"};
    uint64_t hash[COUNT(sets)];
    for (size_t k = 0; k < COUNT(sets); k++) {
        setenv("SKEIN_SIMD", sets[k], 1);
        skein_world *world = new_world("symplectic_euler", 3);
        unsetenv("SKEIN_SIMD");
        uint64_t seed = 3;
        uint32_t particles[4 * 147];
        for (int i = 0; i < 150; i++)
            add_particle(world, 0.1, random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                         random_between(&seed, -1, 1));
        for (uint32_t i = 0; i < 4 * 147; i++) particles[i] = i / 4 + i % 4;
        const char *text = "dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6 - 0.01 >= 0";
        OK(world,
           skein_constraint_add(world, "formula", particles, 147,
                                SKEIN_SETTINGS(SKEIN_TEXT("constraint", text), SKEIN_REAL("stiffness", 3)), NULL));
        steps(world, 20, 1.0 / 60);
        skein_statistics s = statistics_of(world);
        assert_int_equal(s.nonfinite, 0);
        assert_true(s.kinetic_energy > 0);
        hash[k] = s.state_hash;
        skein_world_destroy(world);
    }
    assert_true(hash[0] == hash[1] && hash[1] == hash[2]);
}

/* ---- closed forms ---- */

/* The last particle alone is free and moves along one direction: omega = |dC/dx| sqrt(k/m). */
static double frequency_of(const char *kind, size_t arity, const double *positions, const double *direction) {
    skein_world *world = new_world("rk4", 1);
    uint32_t particles[4] = {0, 1, 2, 3};
    for (size_t i = 0; i < arity; i++)
        add_particle(world, i + 1 == arity ? 0.2 : 0, positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
    OK(world, skein_constraint_add(world, kind, particles, 1, SKEIN_SETTINGS(SKEIN_REAL("stiffness", 5)), NULL));
    const double *x = positions + 3 * (arity - 1), a = 5e-3;
    place_particle(world, arity - 1, x[0] + a * direction[0], x[1] + a * direction[1], x[2] + a * direction[2]);
    double last = a, crossed[3];
    for (int n = 1, count = 0; count < 3; n++) {
        steps(world, 1, 2e-3);
        vec3 p = position_of(world, arity - 1);
        double s = (p.x - x[0]) * direction[0] + (p.y - x[1]) * direction[1] + (p.z - x[2]) * direction[2];
        if (s * last < 0) crossed[count++] = (n - s / (s - last)) * 2e-3;
        last = s;
        assert_true(n < 20000);
    }
    skein_world_destroy(world);
    return 2 * PI / (crossed[2] - crossed[0]);
}

static void small_swings_have_the_frequency_of_the_gradient(void **state) {
    (void)state;
    double root = sqrt(5 / 0.2), up[] = {0, 1, 0};
    // folded flat over the x axis, with the free corner 0.5 beside it: the angle changes by 2 a radian a metre
    double hinge[] = {0, 0, 0, 1, 0, 0, 0.4, 0, 0.5, 0.4, 0, -0.5};
    assert_share(frequency_of("dihedral", 4, hinge, up), root / 0.5, 2e-3);
    // the same corner under curvature: sqrt(1/A) (cot + cot) with both of the free corner's: l/h
    assert_share(frequency_of("isometric", 4, hinge, up), root * sqrt(1 / (2 * 0.25)) * (1 / 0.5), 2e-3);
    // the end of a line: 1/l; a corner of a cell: the root of its area
    double line[] = {-0.3, 0, 0, 0, 0, 0, 0.4, 0, 0};
    assert_share(frequency_of("straight", 3, line, up), root / 0.4, 2e-3);
    double cell[] = {0, 0, 0, 0.6, 0, 0, 0.6, 0, 0.5, 0, 0, 0.5};
    assert_share(frequency_of("twist", 4, cell, up), root / sqrt(0.3), 2e-3);
    double triangle[] = {0, 0, 0, 0.6, 0, 0, 0.2, 0.5, 0};
    assert_share(frequency_of("area", 3, triangle, up), root * 0.6 / 2, 5e-3);
    double tetrahedron[] = {0, 0, 0, 0, 0, 0.8, 0.7, 0, 0, 0.2, 0.5, 0.1};
    assert_share(frequency_of("volume", 4, tetrahedron, up), root * 0.5 * 0.8 * 0.7 / 3, 2e-3);
    double arm[] = {-1, 0, 0, 0, 0, 0, 0.4, 0, 0};
    arm[0] = 0, arm[2] = 0.7; // a right angle, so that it has a sign
    assert_share(frequency_of("angle", 3, arm, (const double[]){0, 0, 1}), root / 0.4, 2e-3);
}

/* A sheet that is held along one edge sags by w L^4/(8 B): of n cells, which bend at their ends only, ((n + 1)/n)^2 as
 * much. It may also bend across, as sheets with a Poisson's ratio do, which makes it softer by some percent. */
static double sag_of(const char *method, int substeps, const char *by, int rows, int columns, double length) {
    const double width = length / 3, density = 0.2, g = 9.81, sag = 0.04 * length;
    double rigidity = density * g * pow(length, 4) / (8 * sag);
    skein_world *world = new_world(method, substeps);
    char pins[80];
    // two columns are held, as a clamp does; the sheet is longer by that
    double cell = length / (columns - 2), whole = length + cell;
    snprintf(pins, sizeof pins, "box -9 -9 -9 %g 9 9", -whole / 2 + 1.5 * cell);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", rows, columns), SKEIN_PAIR("size", whole, width),
                                            SKEIN_TEXT("pins", pins), SKEIN_REAL("density", density),
                                            SKEIN_TEXT("bend.by", by), SKEIN_REAL("bend.rigidity", rigidity),
                                            SKEIN_REAL("stretch.stiffness", 1e4), SKEIN_REAL("shear.stiffness", 1e4),
                                            SKEIN_REAL("stretch.tether", HUGE_VAL)),
                             NULL));
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 25)), NULL));
    steps(world, 150, 1.0 / 60);
    double lowest = 0;
    for (size_t i = 0; i < skein_particle_count(world); i++) lowest = fmin(lowest, position_of(world, i).y);
    skein_world_destroy(world);
    return -lowest / sag;
}

static void a_held_sheet_sags_as_a_beam(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    // lines bend along the sheet, and not across, as a beam does
    static const struct {
        const char *by;
        double within;
    } ways[] = {{"angle", 0.2}, {"curvature", 0.2}, {"lines", 0.02}};
    for (size_t w = 0; w < COUNT(ways); w++) {
        double coarse = sag_of("backward_euler", 1, ways[w].by, 5, 12, 0.3),
               fine = sag_of("backward_euler", 1, ways[w].by, 7, 17, 0.3);
        coarse *= pow(10.0 / 11, 2), fine *= pow(15.0 / 16, 2);
        printf("%s: %.3f, %.3f of the beam's\n", ways[w].by, coarse, fine);
        assert_near(coarse, 1, ways[w].within);
        assert_share(fine, coarse, 0.03);
    }
}

/* Of a cloth that bends by its shape position methods take bending in every second substep, if they come in pairs, with
 * the same rigidity: the sag of a long strip does not depend on substeps. */
static void a_held_strip_sags_the_same_with_any_substeps(void **state) {
    (void)state;
    static const int substeps[] = {20, 25, 40, 80};
    for (size_t i = 0; i < COUNT(substeps); i++) {
        double is = sag_of("xpbd", substeps[i], "shape", 4, 12, 10) * pow(10.0 / 11, 2);
        printf("%d substeps: %.3f of the beam's\n", substeps[i], is);
        assert_near(is, 1, 0.05);
    }
}

/* An irregular strip of cells of 1 cm, held by its first two columns; `rise`: of the middle, in m. */
static skein_world *irregular_strip(const char *by, double rise, double turn) {
    enum { ROWS = 6, COLUMNS = 17 };
    skein_world *world = new_world("backward_euler", 1);
    skein_mesh mesh = irregular_mesh(ROWS, COLUMNS, false);
    double *p = (double *)mesh.positions;
    for (size_t i = 0; i < mesh.vertex_count; i++) {
        p[3 * i] *= 0.01, p[3 * i + 2] *= 0.01;
        p[3 * i + 1] = rise * sin(acos(-1.0) * p[3 * i] / (0.01 * (COLUMNS - 1)));
    }
    add_and_free(world, mesh, p,
                 SKEIN_SETTINGS(SKEIN_VEC3("rotation", 0, turn, turn), SKEIN_TEXT("pins", "box -9 -9 -9 0.013 9 9"),
                                SKEIN_TEXT("bend.by", by), SKEIN_REAL("bend.rigidity", 0.02),
                                SKEIN_REAL("stretch.tether", HUGE_VAL)));
    return world;
}

static const char *bends_by(const skein_world *world) {
    for (size_t i = 0; i < world->rules.batches.count; i++)
        if (!strcmp(world->rules.batches.data[i]->label, "bend")) return world->rules.batches.data[i]->type->kind.name;
    return "nothing";
}

/* What began flat, however it lay, bends by curvature where nothing else is said, and is as stiff as by angles; what was bent does by these. */
static void a_mesh_that_began_flat_bends_by_curvature(void **state) {
    (void)state;
    static const struct {
        const char *by;
        double rise, turn;
        const char *then;
    } sheets[] = {{"shape", 0, 0, "isometric"},    {"shape", 0, 40, "isometric"}, {"shape", 1e-7, 40, "isometric"},
                  {"shape", 0.002, 0, "dihedral"}, {"angle", 0, 0, "dihedral"},   {"curvature", 0.002, 0, "isometric"}};
    for (size_t i = 0; i < COUNT(sheets); i++) {
        skein_world *world = irregular_strip(sheets[i].by, sheets[i].rise, sheets[i].turn);
        assert_string_equal(bends_by(world), sheets[i].then);
        skein_world_destroy(world);
    }
    double sag[2];
    for (int k = 0; k < 2; k++) {
        skein_world *world = irregular_strip(k ? "angle" : "shape", 0, 0);
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 25)), NULL));
        steps(world, 150, 1.0 / 60);
        sag[k] = 0;
        for (size_t i = 0; i < skein_particle_count(world); i++) sag[k] = fmax(sag[k], -position_of(world, i).y);
        skein_world_destroy(world);
    }
    printf("an irregular strip sags by %.1f mm by curvature, %.1f by angles\n", 1e3 * sag[0], 1e3 * sag[1]);
    assert_true(sag[0] > 0.003 && sag[0] < 0.05); // of 15 cm
    assert_share(sag[0], sag[1], 0.05);
}

/* ---- large turns ---- */

/* A rigid fold is taken back by half a radian of its gradient at a time, a smaller one at once; by PBD and by XPBD, whose multipliers
 * may be kept. The one corner that is free turns about the edge: by the arctangent of half its height. */
static void a_large_turn_is_taken_back_by_and_by(void **state) {
    (void)state;
    for (int c = 0; c < 6; c++) {
        skein_world *world = new_world(c % 2 ? "xpbd" : "pbd", 1);
        double from = c < 4 ? 1.4 : 0.3, height = 0.7;
        OK(world, skein_set_path(world, "method.iterations", skein_number(c / 2 == 1 ? 2 : 1)));
        for (int i = 0; i < 3; i++) add_particle(world, 0, i == 1, i == 2 ? -1 : 0, 0);
        add_particle(world, 1, 0.4, height, 0);
        uint32_t hinge[] = {0, 1, 2, 3};
        OK(world,
           skein_constraint_add(world, "dihedral", hinge, 1, SKEIN_SETTINGS(SKEIN_REAL("stiffness", HUGE_VAL)), NULL));
        OK(world, skein_positions_set(world, 3, 1, (double[]){0.4, height * cos(from), height * sin(from)}));
        steps(world, 1, 0.01);
        vec3 now = position_of(world, 3);
        double by = from - atan2(now.z, now.y), once = atan(c < 4 ? 0.5 : from);
        assert_near(by, c / 2 == 1 ? once + atan(0.5 * height / hypot(height, 0.5 * height)) : once,
                    c / 2 == 1 ? 0.1 : 1e-5);
        skein_world_destroy(world);
    }
}

/* A tube of fine cloth, hung by a few of its points, crumples: angles are large there, and as good as rigid. Without a bound on turns
 * its edges were stretched by 134 % (99th percentile), without bending by 10. */
static void a_fine_mesh_that_crumples_stays_together(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    for (int m = 0; m < 2; m++) {
        skein_world *world = new_world(m ? "pbd" : "xpbd", 10);
        add_irregular_tube(world, 120, 60, 0.002, SKEIN_SETTINGS(SKEIN_TEXT("pins", "box -9 0.015 -9 9 9 9")));
        add_gravity(world);
        steps(world, 60, 1.0 / 60);
        assert_under(statistics_of(world).p99_stretch, 0.2);
        assert_under(statistics_of(world).max_stretch, 1.5);
        skein_world_destroy(world);
    }
}

/* ---- what is refused ---- */

static void bad_constraints_are_refused(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 4);
    uint32_t particles[] = {0, 1, 2, 2};
    for (int i = 0; i < 4; i++) add_particle(world, 1, i, i * i, 0);
    size_t arity;
    skein_error const *error = skein_world_error(world);
    assert_int_not_equal(skein_constraint_add(world, "formula", particles, 1,
                                              SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1")), NULL),
                         SKEIN_OK);
    assert_non_null(strstr(error->where, "constraint"));
    assert_int_not_equal(skein_constraint_add(world, "formula", particles, 1,
                                              SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) - L")), NULL),
                         SKEIN_OK);
    FAILS(world, SKEIN_ERROR_VALUE, "names no particle",
          skein_constraint_add(world, "formula", particles, 1, SKEIN_SETTINGS(SKEIN_TEXT("constraint", "t")), NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "named twice", skein_constraint_add(world, "volume", particles, 1, NULL, NULL));
    OK(world, skein_constraint_arity(world, "formula", SKEIN_SETTINGS(SKEIN_TEXT("constraint", "dot(p0, p4)")), &arity));
    assert_int_equal(arity, 5);
    OK(world, skein_constraint_arity(world, "volume", NULL, &arity));
    assert_int_equal(arity, 4);
    skein_handle handle;
    OK(world, skein_constraint_add(world, "formula", particles, 1,
                                   SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) - 1")), &handle));
    FAILS(world, SKEIN_ERROR_VALUE, "made for 2",
          skein_set(world, handle, "constraint", skein_text("dot(p0, cross(p1, p2))")));
    FAILS(world, SKEIN_ERROR_VALUE, "rest(...)",
          skein_set(world, handle, "constraint", skein_text("length(p0 - p1) - rest(length(p0 - p1))")));
    OK(world, skein_set(world, handle, "constraint", skein_text("length(p0 - p1) - 2")));
    OK(world, skein_set(world, handle, "stiffness", skein_number(HUGE_VAL)));
    steps(world, 1, 0.01);
    assert_near(length3(minus(position_of(world, 0), position_of(world, 1))), 2, 1e-5);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_large_turn_is_taken_back_by_and_by),
        cmocka_unit_test(a_fine_mesh_that_crumples_stays_together),
        cmocka_unit_test(kernels_tapes_and_graphs_agree),
        cmocka_unit_test(a_formula_distance_goes_as_the_built_in_one),
        cmocka_unit_test(an_energy_goes_as_its_constraint),
        cmocka_unit_test(a_formula_in_t_moves_what_hangs_on_it),
        cmocka_unit_test(damping_knows_that_the_formula_moves),
        cmocka_unit_test(one_sided_formulas_only_hold_back),
        cmocka_unit_test(undamped_formulas_need_no_velocities),
        cmocka_unit_test(small_swings_have_the_frequency_of_the_gradient),
        cmocka_unit_test(a_held_sheet_sags_as_a_beam),
        cmocka_unit_test(a_held_strip_sags_the_same_with_any_substeps),
        cmocka_unit_test(a_mesh_that_began_flat_bends_by_curvature),
        cmocka_unit_test(bad_constraints_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
