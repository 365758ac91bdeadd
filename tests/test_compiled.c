/* Formulas that a C compiler has compiled (tests/compiled.sh emits them, the build compiles and links them): the bits
 * of the tape under every method, and what is refused. */
#include "helpers.h"
#include <skein/compiled.h>
#include <skein/formula.h>

extern const skein_compiled compiled_spring, compiled_bend, compiled_room, compiled_all, compiled_energy;

/* As in compiled.sh, but for what makes no difference: blanks, names, and the order of parameters. */
static const struct subject {
    const char *name, *kind, *text;
    const skein_compiled *compiled;
    uint32_t arity;
    skein_setting parameter[3];
    double stiffness;
} subjects[] = {
    {"spring",
     "formula",
     "length(p0-p1) - L*(1 + 0.2*sin(t))",
     &compiled_spring,
     2,
     {SKEIN_REAL("parameters.L", 0.5)},
     300},
    {"bend",
     "formula",
     "let bend = dihedral(p0, p1, p2, p3) - rest(dihedral(p0, p1, p2, p3));\n"
     "select(bend > pi, bend - 2 * pi, select(bend < -pi, bend + 2 * pi, bend))",
     &compiled_bend,
     4,
     {{NULL, {0, {0, 0, 0}, NULL}}},
     2},
    {"room",
     "formula",
     "let six = 6; dot(cross(p1 - p0, p2 - p0), p3 - p0)/six >= share*rest(dot(cross(p1 - p0, p2 - p0), p3 - p0)/6)",
     &compiled_room,
     4,
     {SKEIN_REAL("parameters.share", 1.05)},
     3000},
    {"all",
     "formula",
     "let d = p0 - p1; let s = dot(d, d);\n"
     "exp(-s) + 0.1*log(s - 0.2) + 0.3*tan(0.2*d.x) + acos(d.y)*asin(0.9*d.z) - (s + 0.1)^power + \n"
     "abs(d.x)*cos(t) + 0.1*atan2(d.y, d.z) + sqrt(s - 0.01)",
     &compiled_all,
     2,
     {SKEIN_REAL("parameters.power", 0.7)},
     20},
    {"energy",
     "energy",
     "let s = length(p1 - p0) / rest(length(p1 - p0)); let a = length(cross(p1 - p0, p2 - p0));\n"
     "k / 2 * (s - 1)^2 + m * log(a / rest(a))^2",
     &compiled_energy,
     3,
     {SKEIN_REAL("parameters.k", 40), SKEIN_REAL("parameters.m", 0.2)},
     1},
};

/* What the walks are: projection, projection that keeps its multipliers, forces with damping and without, solves. */
static const struct way {
    const char *method;
    double damping, iterations;
} ways[] = {{"pbd", 0, 2},
            {"xpbd", 0, 1},
            {"xpbd", 0, 3},
            {"xpbd", 0.5, 1},
            {"symplectic_euler", 0, 0},
            {"rk4", 0.5, 0},
            {"backward_euler", 0, 0},
            {"backward_euler", 0.5, 0}};

enum place { LOOSE, CLOTH, FAR };
#define FARTHEST 9e14 // m; nothing may be farther

enum { SIDE = 7, PARTICLES = SIDE * SIDE * 3, ELEMENTS = 150 };

/* Particles near a grid's places, some held, a strip-wise cloth among them where it is asked for, and constraints all
 * over. */
static skein_world *make(const struct subject *s, const struct way *w, enum place place) {
    uint64_t seed = 11;
    bool projects = !strcmp(w->method, "pbd") || !strcmp(w->method, "xpbd");
    skein_world *world = skein_world_create(NULL, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(
                  world, w->method,
                  projects ? SKEIN_SETTINGS(SKEIN_REAL("substeps", 3), SKEIN_REAL("iterations", w->iterations)) : NULL));
    add_gravity(world);
    uint32_t first = 0, count = PARTICLES;
    if (place == CLOTH) {
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 18, 9), SKEIN_PAIR("size", 6, 3)), NULL));
        count = 18 * 9;
    } else {
        for (int i = 0; i < PARTICLES; i++)
            add_particle(world, i % 11 ? 0.2 + 0.01 * (i % 7) : 0, 0.5 * (i % SIDE) + random_between(&seed, -0.1, 0.1),
                         0.5 * (i / SIDE % SIDE) + random_between(&seed, -0.1, 0.1),
                         0.5 * (i / SIDE / SIDE) + random_between(&seed, -0.1, 0.1));
        // so far away that products are too large for a number (in float), each in a direction; and some in one place
        for (int i = 0; i < PARTICLES && place == FAR; i++) {
            double far = pow(FARTHEST, 0.3 + 0.7 * i / PARTICLES);
            if (i / 4 % 4 == 0)
                place_particle(world, (size_t)i, i % 3 ? 0 : far, i % 3 == 1 ? far : 0, i % 3 > 1 ? far : 0);
            else if (i % 16 == 5) place_particle(world, (size_t)i, 0.5, 0.5, 0.5);
        }
    }
    uint32_t particles[4 * ELEMENTS];
    for (uint32_t e = 0; e < ELEMENTS; e++) {
        static const uint32_t corner[] = {0, 1, SIDE, SIDE * SIDE};
        uint32_t at = (uint32_t)random_between(&seed, 0, count - SIDE * SIDE - 1);
        for (uint32_t k = 0; k < s->arity; k++) particles[s->arity * e + k] = first + at + corner[k];
    }
    bool energy = !strcmp(s->kind, "energy");
    skein_setting settings[6] = {SKEIN_TEXT(energy ? "energy" : "constraint", s->text),
                                 SKEIN_REAL(energy ? "scale" : "stiffness", s->stiffness)};
    size_t next = 2;
    if (!energy && w->damping > 0) settings[next++] = (skein_setting)SKEIN_REAL("damping", w->damping);
    for (size_t i = 0; i < 3 && s->parameter[i].name; i++) settings[next++] = s->parameter[i];
    OK(world, skein_constraint_add(world, s->kind, particles, ELEMENTS, settings, NULL));
    return world;
}

static void state_of(skein_world *world, skein_real *state) {
    skein_view x = skein_position_view(world), v = skein_velocity_view(world);
    for (size_t i = 0; i < x.count; i++) {
        memcpy(state + 8 * i, x.xyzw + 4 * (size_t)x.slot_of[i], 4 * sizeof *state);
        memcpy(state + 8 * i + 4, v.xyzw + 4 * (size_t)v.slot_of[i], 4 * sizeof *state);
    }
}

/* How far the steps took the particles; 0 for a constraint that does nothing. */
static double compare(const struct subject *s, const struct way *w, enum place place) {
    enum { STEPS = 4 };
    static skein_real tape[8 * 200], compiled[8 * 200], idle[8 * 200];
    skein_world *world[3];
    for (int i = 0; i < 3; i++) world[i] = make(s, w, place);
    skein_handle constraint = skein_object_at(world[1], SKEIN_CONSTRAINT, 0);
    assert_false(skein_formula_is_compiled(world[1], constraint));
    OK(world[1], skein_formula_register(world[1], s->compiled));
    assert_true(skein_formula_is_compiled(world[1], constraint));
    OK(world[2], skein_set(world[2], skein_object_at(world[2], SKEIN_CONSTRAINT, 0), "enabled", skein_number(0)));
    double moved = 0;
    for (int step = 0; step < STEPS; step++) {
        for (int i = 0; i < 3; i++) OK(world[i], skein_world_step(world[i], 0.01));
        state_of(world[0], tape);
        state_of(world[1], compiled);
        state_of(world[2], idle);
        size_t count = skein_particle_count(world[0]);
        for (size_t i = 0; i < 8 * count; i++) {
            moved = fmax(moved, fabs((double)(tape[i] - idle[i])));
            if (memcmp(&tape[i], &compiled[i], sizeof *tape) && (tape[i] != 0 || compiled[i] != 0))
                fail_msg("%s under %s, damping %g, %s: step %d, particle %zu, number %zu: %.9g by tape, %.9g compiled",
                         s->name, w->method, w->damping, ((const char *[]){"loose", "cloth", "far"})[place], step,
                         i / 8, i % 8, (double)tape[i], (double)compiled[i]);
        }
    }
    for (int i = 0; i < 3; i++) skein_world_destroy(world[i]);
    return moved;
}

static void the_bits_are_those_of_the_tape(void **state) {
    (void)state;
    if (SPARING) skip(); // far_away_too goes the same ways
    for (size_t s = 0; s < COUNT(subjects); s++)
        for (size_t w = 0; w < COUNT(ways); w++) {
            double moved = compare(&subjects[s], &ways[w], LOOSE);
            if (!(moved > 1e-4))
                fail_msg("%s under %s does next to nothing: %g", subjects[s].name, ways[w].method, moved);
        }
}

/* There particles are in packed blocks while a plan runs. */
static void in_strips_too(void **state) {
    (void)state;
    assert_true(compare(&subjects[0], &ways[1], CLOTH) > 1e-4);
    assert_true(compare(&subjects[3], &ways[3], CLOTH) > 1e-4);
    assert_true(compare(&subjects[0], &ways[5], CLOTH) > 1e-4);
}

/* What is not finite is left out by both. */
static void far_away_too(void **state) {
    (void)state;
    for (size_t s = 0; s < COUNT(subjects); s++)
        for (size_t w = 0; w < COUNT(ways); w++)
            if (strcmp(ways[w].method, "backward_euler")) compare(&subjects[s], &ways[w], FAR);
}

/* ---- which formula it is ---- */

static uint64_t hash_of(const char *text, bool second, const char *const *parameters) {
    skein_error error;
    skein_formula_desc desc = {.text = text, .parameters = parameters, .second = second, .comparison = true};
    skein_formula *f = skein_formula_create(&desc, NULL, &error);
    if (!f) fail_msg("%s: %s", text, error.message);
    uint64_t hash = skein_formula_hash(f);
    skein_formula_destroy(f);
    return hash;
}

static void hashes_tell_what_is_computed(void **state) {
    (void)state;
    const char *const l[] = {"L", NULL}, *const lk[] = {"k", "L", NULL}, *const r[] = {"R", NULL};
    uint64_t hash = hash_of("length(p0 - p1) - L", false, l);
    assert_true(hash == hash_of("let d = p0-p1; // along it\nlength(d)-L", false, l));
    assert_true(hash == hash_of("length(p0 - p1) - L", false, lk));
    assert_true(hash != hash_of("length(p0 - p1) - R", false, r));
    assert_true(hash != hash_of("length(p0 - p1) - L", true, l));
    assert_true(hash != hash_of("length(p0 - p1) >= L", false, l));
    assert_true(hash != hash_of("length(p0 - p2) - L", false, l));
    assert_true(hash != hash_of("length(p0 - p1) - 1.0000000001", false, l));
    assert_true(hash_of("length(p0) - 1", false, l) != hash_of("length(p0) - 1.0000000001", false, l));
    // what a rest value is made of is not computed by it
    assert_true(hash_of("p0.x - rest(p0.x)", false, l) == hash_of("p0.x - rest(p0.y)", false, l));
}

static void a_changed_text_goes_back_to_its_tape(void **state) {
    (void)state;
    skein_world *world = make(&subjects[0], &ways[1], LOOSE);
    skein_handle constraint = skein_object_at(world, SKEIN_CONSTRAINT, 0);
    OK(world, skein_formula_register(world, &compiled_spring));
    steps(world, 2, 0.01);
    OK(world, skein_set(world, constraint, "constraint", skein_text("length(p0 - p1) - 2*L")));
    assert_false(skein_formula_is_compiled(world, constraint));
    steps(world, 2, 0.01);
    OK(world, skein_set(world, constraint, "constraint", skein_text(subjects[0].text)));
    assert_true(skein_formula_is_compiled(world, constraint));
    steps(world, 2, 0.01);
    assert_null(skein_formula_of(world, skein_object_at(world, SKEIN_FORCE, 0)));
    assert_false(skein_formula_is_compiled(world, (skein_handle){.index = 99, .generation = 1}));
    skein_world_destroy(world);
}

static void what_does_not_fit_is_refused(void **state) {
    (void)state;
    skein_world *world = make(&subjects[0], &ways[1], LOOSE);
    skein_compiled c = compiled_spring;
    c.hash ^= 1;
    FAILS(world, SKEIN_ERROR_VALUE, "emit and compile it again", skein_formula_register(world, &c));
    c = compiled_spring, c.text = (const char *const[]){"length(p0 - ", "p1) - 2*L", NULL};
    FAILS(world, SKEIN_ERROR_VALUE, "is not what its text says", skein_formula_register(world, &c));
    c = compiled_spring, c.energy = true;
    FAILS(world, SKEIN_ERROR_VALUE, "emit and compile it again", skein_formula_register(world, &c));
    c = compiled_spring, c.abi++;
    FAILS(world, SKEIN_ERROR_VALUE, "has ABI 3, and this library 2", skein_formula_register(world, &c));
    c = compiled_spring, c.real_size = 12 - c.real_size;
    FAILS(world, SKEIN_ERROR_VALUE, "-DSKEIN_DOUBLE", skein_formula_register(world, &c));
    assert_false(skein_formula_is_compiled(world, skein_object_at(world, SKEIN_CONSTRAINT, 0)));
    skein_world_destroy(world);
}

static void nothing(void *user, const char *text) {
    (void)user, (void)text;
}

static void only_constraints_can_be_compiled(void **state) {
    (void)state;
    static const struct {
        const char *text, *name, *part;
    } bad[] = {{"p0 - p1", "a", "is a vector"},
               {"dot(v0, p0)", "a", "velocities"},
               {"t", "a", "names none"},
               {"p0.x", "2a", "cannot be a name in C"},
               {"p0.x", "a-b", "cannot be a name in C"}};
    for (size_t i = 0; i < COUNT(bad); i++) {
        skein_error error = {SKEIN_OK, "", ""};
        skein_formula *f =
            skein_formula_create(&(skein_formula_desc){.text = bad[i].text, .velocities = true}, NULL, &error);
        assert_non_null(f);
        assert_int_not_equal(skein_formula_emit_compiled(f, bad[i].name, nothing, NULL, &error), SKEIN_OK);
        if (!strstr(error.message, bad[i].part)) fail_msg("'%s' has no '%s'", error.message, bad[i].part);
        skein_formula_destroy(f);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bits_are_those_of_the_tape),
        cmocka_unit_test(in_strips_too),
        cmocka_unit_test(far_away_too),
        cmocka_unit_test(hashes_tell_what_is_computed),
        cmocka_unit_test(a_changed_text_goes_back_to_its_tape),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(only_constraints_can_be_compiled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
