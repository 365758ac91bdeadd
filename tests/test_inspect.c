/* Looking into constraints: values and gradients of every kind against slopes and against the forces of a step, and
 * formulas operation by operation. */
#include "helpers.h"

enum { PARTICLES = 8, COORDINATES = 3 * PARTICLES };

static const uint32_t in_order[PARTICLES] = {0, 1, 2, 3, 4, 5, 6, 7};
static const uint32_t tetrahedron[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};

typedef struct one {
    skein_world *world;
    skein_handle constraint;
    double at[COORDINATES];
} one;

static void place(one *o, const double at[COORDINATES]) {
    OK(o->world, skein_positions_set(o->world, 0, PARTICLES, at));
}

/* A constraint of the k-th kind that was made at rest, on particles that have since been moved a little. Coordinates are
 * of few digits, so that a float holds them and their neighbours a 1024th off. */
static one make(size_t k, const char *method, const skein_setting *settings) {
    static const double around[COORDINATES] = {0, 0, 0, 1, 0.25, 0, 0.25, 1, 0.25, 0.5,  0.5, 1,
                                               2, 0, 0, 2, 1,    0, 2,    1, 1,    1.25, 2,   0.5};
    static const double masses[PARTICLES] = {1, 2, 1.5, 0.5, 1, 1, 1, 1};
    const char *kind = skein_kind_at(SKEIN_CONSTRAINT, k)->name;
    bool surface = !strcmp(kind, "enclosed_volume") || !strcmp(kind, "pressure");
    one o = {.world = new_world(method, 1)};
    uint64_t seed = 5 + k;
    OK(o.world, skein_particles_add(o.world, PARTICLES, around, NULL, masses, NULL));
    OK(o.world,
       skein_constraint_add(o.world, kind, surface ? tetrahedron : in_order, surface ? 4 : 1, settings, &o.constraint));
    for (size_t i = 0; i < COORDINATES; i++)
        o.at[i] = around[i] + floor(random_between(&seed, -0.1, 0.1) * 1024) / 1024;
    place(&o, o.at);
    return o;
}

typedef struct looked {
    skein_constraint_value value;
    uint32_t particles[PARTICLES];
    double gradient[COORDINATES];
} looked;

static looked look(const one *o) {
    looked l = {.value = {0}};
    OK(o->world, skein_constraint_evaluate(o->world, o->constraint, 0, &l.value, l.particles, l.gradient, PARTICLES));
    assert_true(l.value.particle_count >= 2 && l.value.particle_count <= PARTICLES);
    return l;
}

static const double step = 1.0 / 1024;

/* Central differences of double values at places that a float holds: off by the third derivative alone. */
static void the_gradient_is_the_slope(void **state) {
    (void)state;
    size_t kinds = 0;
    for (size_t k = 0; skein_kind_at(SKEIN_CONSTRAINT, k); k++, kinds++) {
        one o = make(k, "xpbd", NULL);
        looked here = look(&o);
        assert_true(fabs(here.value.value) > 1e-6 && !here.value.guarded && here.value.by_time == 0);
        double size = 0;
        for (size_t p = 0; p < here.value.particle_count; p++)
            for (size_t a = 0; a < 3; a++) {
                double at[COORDINATES];
                size_t i = 3 * here.particles[p] + a;
                memcpy(at, o.at, sizeof at);
                at[i] = o.at[i] + step;
                place(&o, at);
                double above = look(&o).value.value;
                at[i] = o.at[i] - step;
                place(&o, at);
                double slope = (above - look(&o).value.value) / (2 * step);
                assert_near(here.gradient[3 * p + a], slope, 1e-3 * fmax(fabs(slope), fabs(here.value.value)) + 1e-5);
                size += fabs(slope);
            }
        assert_true(size > 1e-3);
        skein_world_destroy(o.world);
    }
    assert_true(kinds >= 10);
}

/* -k C grad C, of energies -k grad E, is what moves particles in a step of a force method. */
static void forces_follow_from_it(void **state) {
    (void)state;
    const double dt = 1.0 / 1024;
    for (size_t k = 0; skein_kind_at(SKEIN_CONSTRAINT, k); k++) {
        one o = make(k, "symplectic_euler", NULL);
        looked l = look(&o);
        double v[COORDINATES], most = 0;
        assert_true(l.value.stiffness > 0 && isfinite(l.value.stiffness));
        steps(o.world, 1, dt);
        OK(o.world, skein_velocities_copy(o.world, 0, PARTICLES, v));
        skein_view masses = skein_velocity_view(o.world);
        for (size_t i = 0; i < COORDINATES; i++) most = fmax(most, fabs(v[i]));
        assert_true(most > 1e-8); // an isometric one is soft, and starts nearly flat
        for (size_t p = 0; p < l.value.particle_count; p++)
            for (size_t a = 0; a < 3; a++) {
                uint32_t i = l.particles[p];
                double mass = (double)masses.xyzw[4 * (size_t)masses.slot_of[i] + 3];
                double factor = -l.value.stiffness * (l.value.is_energy ? 1 : l.value.value);
                assert_near(v[3 * i + a], dt * factor * l.gradient[3 * p + a] / mass, 1e-3 * most);
            }
        skein_world_destroy(o.world);
    }
}

/* Each operation's derivatives against its own slopes; the last one's are the gradient. */
static void operations_lead_to_the_value(void **state) {
    (void)state;
    enum { MOST = 400 };
    static skein_operation here[MOST], above[MOST], below[MOST];
    static double derivatives[MOST * COORDINATES];
    size_t with_formulas = 0;
    for (size_t k = 0; skein_kind_at(SKEIN_CONSTRAINT, k); k++) {
        one o = make(k, "xpbd", NULL);
        looked l = look(&o);
        size_t count, again, coordinates = 3 * l.value.particle_count;
        OK(o.world, skein_constraint_operations(o.world, o.constraint, 0, here, derivatives, MOST, &count));
        assert_true(count <= MOST);
        assert_int_equal(count > 0, l.value.text[0] != 0);
        with_formulas += count > 0;
        for (size_t i = 0; i < count; i++)
            for (int n = 0; n < here[i].operand_count; n++) assert_true(here[i].operand[n] < i);
        for (size_t c = 0; c < coordinates && count; c++) {
            double at[COORDINATES];
            memcpy(at, o.at, sizeof at);
            size_t moved = 3 * l.particles[c / 3] + c % 3;
            at[moved] += step;
            place(&o, at);
            OK(o.world, skein_constraint_operations(o.world, o.constraint, 0, above, NULL, MOST, &again));
            assert_int_equal(again, count);
            at[moved] -= 2 * step;
            place(&o, at);
            OK(o.world, skein_constraint_operations(o.world, o.constraint, 0, below, NULL, MOST, &again));
            for (size_t i = 0; i < count; i++) {
                double slope = (above[i].value - below[i].value) / (2 * step), size = fabs(slope) + fabs(here[i].value);
                assert_near(derivatives[i * coordinates + c], slope, 1e-4 * size + 1e-4);
            }
            assert_near(derivatives[(count - 1) * coordinates + c], l.gradient[c], 1e-9 * (1 + fabs(l.gradient[c])));
        }
        if (count) assert_near(here[count - 1].value, l.value.value, 1e-9 * (1 + fabs(l.value.value)));
        skein_world_destroy(o.world);
    }
    assert_true(with_formulas >= 8);
}

/* The lesson in numbers: after the first solve of C = (|p0 - p1|^2 - L^2)/2 from 1 m, L = 0.5, the points are 0.625 m
 * apart, and that is the gradient of the second. */
static void the_second_solve_of_the_lesson(void **state) {
    (void)state;
    skein_world *world = new_world("pbd", 1);
    OK(world, skein_set_path(world, "method.inertia", skein_number(0)));
    add_particle(world, 1, -0.5, 0, 0);
    add_particle(world, 1, 0.5, 0, 0);
    skein_handle spring;
    OK(world, skein_constraint_add(world, "formula", in_order, 1,
                                   SKEIN_SETTINGS(SKEIN_TEXT("constraint", "0.5*(dot(p0-p1,p0-p1) - L^2)"),
                                                  SKEIN_REAL("parameters.L", 0.5), SKEIN_REAL("stiffness", INFINITY)),
                                   &spring));
    static const double values[2] = {0.375, 0.0703125}, slopes[2] = {1, 0.625};
    for (int solve = 0; solve < 2; solve++) {
        skein_constraint_value value;
        uint32_t particles[2];
        double gradient[6];
        OK(world, skein_constraint_evaluate(world, spring, 0, &value, particles, gradient, 2));
        assert_near(value.value, values[solve], 1e-7);
        assert_true(isinf(value.stiffness));
        assert_string_equal(value.text, "0.5*(dot(p0-p1,p0-p1) - L^2)");
        for (int c = 0; c < 6; c++) assert_near(gradient[c], c % 3 ? 0 : c ? slopes[solve] : -slopes[solve], 1e-6);
        steps(world, 1, 1);
    }
    // by name: what its leaves are called, and that they are what they say
    skein_operation operations[60];
    size_t count, leaves = 0;
    OK(world, skein_constraint_operations(world, spring, 0, operations, NULL, 60, &count));
    for (size_t i = 0; i < count && count <= 60; i++) {
        const skein_operation *now = &operations[i];
        if (!strcmp(now->label, "L")) leaves += !strcmp(now->name, "parameter") && now->value == 0.5;
        if (!strcmp(now->label, "p1.x")) leaves += !strcmp(now->name, "input") && now->value == position_of(world, 1).x;
    }
    assert_int_equal(leaves, 2);
    skein_world_destroy(world);
}

/* A cloth's constraints are those of its parts, its springs among them as they are listed. */
static void a_body_has_the_constraints_of_its_parts(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 4);
    skein_handle cloth;
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 4), SKEIN_TEXT("pins", "top corners")), &cloth));
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
    steps(world, 10, 1.0 / 60);
    skein_statistics statistics;
    skein_spring springs[200];
    size_t count, spring_count, seen = 0, folds = 0;
    uint64_t hash = skein_world_hash(world);
    OK(world, skein_world_statistics(world, &statistics));
    OK(world, skein_springs_copy(world, springs, 200, &spring_count));
    OK(world, skein_constraint_count(world, cloth, &count));
    assert_int_equal(count, statistics.constraints);
    for (size_t i = 0; i < count; i++) {
        skein_constraint_value value;
        uint32_t particles[8];
        double gradient[24];
        OK(world, skein_constraint_evaluate(world, cloth, i, &value, particles, gradient, 8));
        folds += value.particle_count > 2 && !strncmp(value.label, "bend", 4);
        if (value.particle_count != 2) continue;
        const skein_spring *spring = &springs[seen++];
        vec3 off = minus(position_of(world, particles[0]), position_of(world, particles[1]));
        assert_int_equal(particles[0], spring->particle[0]);
        assert_int_equal(particles[1], spring->particle[1]);
        assert_near(value.value, length3(off) * (1 - 1 / (1 + (double)spring->strain)), 1e-6);
        assert_near(gradient[0], off.x / length3(off), 1e-6);
        assert_near(gradient[5], -off.z / length3(off), 1e-6);
    }
    assert_int_equal(seen, spring_count);
    assert_true(folds > 0);
    assert_true(skein_world_hash(world) == hash);
    OK(world, skein_set(world, cloth, "enabled", skein_number(0)));
    OK(world, skein_constraint_count(world, cloth, &count));
    assert_int_equal(count, 0);
    skein_world_destroy(world);
}

/* By t, where a text names it; one-sided; a length of 0 is guarded. */
static void what_else_it_says(void **state) {
    (void)state;
    one o = make(0, "xpbd", NULL);
    skein_handle late;
    OK(o.world,
       skein_constraint_add(
           o.world, "formula", in_order, 1,
           SKEIN_SETTINGS(SKEIN_TEXT("name", "late"), SKEIN_TEXT("constraint", "length(p0 - p1) >= 3*t^2")), &late));
    steps(o.world, 3, 0.125);
    double together[COORDINATES] = {0};
    place(&o, together);
    o.constraint = late;
    looked l = look(&o);
    assert_true(l.value.one_sided && !l.value.is_energy && l.value.guarded);
    assert_string_equal(l.value.label, "late");
    assert_near(l.value.value, -3 * 0.375 * 0.375, 1e-9);
    assert_near(l.value.by_time, -6 * 0.375, 1e-9);
    for (int c = 0; c < 6; c++) assert_true(l.gradient[c] == 0);
    skein_world_destroy(o.world);
}

static void says_what_is_wrong(void **state) {
    (void)state;
    one o = make(0, "xpbd", NULL);
    skein_handle wind;
    skein_constraint_value value;
    skein_operation operations[2];
    size_t count = 7;
    OK(o.world, skein_force_add(o.world, "wind", NULL, &wind));
    FAILS(o.world, SKEIN_ERROR_HANDLE, "of a force", skein_constraint_count(o.world, wind, &count));
    assert_int_equal(count, 0);
    FAILS(o.world, SKEIN_ERROR_VALUE, "there is no constraint 1: the object has 1",
          skein_constraint_evaluate(o.world, o.constraint, 1, &value, NULL, NULL, 0));
    FAILS(o.world, SKEIN_ERROR_VALUE, "there is no constraint 9",
          skein_constraint_operations(o.world, o.constraint, 9, NULL, NULL, 0, &count));
    OK(o.world, skein_constraint_operations(o.world, o.constraint, 0, NULL, NULL, 0, &count));
    assert_true(count > 2);
    OK(o.world, skein_constraint_operations(o.world, o.constraint, 0, operations, NULL, 2, &count));
    OK(o.world, skein_remove(o.world, o.constraint));
    FAILS(o.world, SKEIN_ERROR_HANDLE, "stale",
          skein_constraint_evaluate(o.world, o.constraint, 0, &value, NULL, NULL, 0));
    skein_world_destroy(o.world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_gradient_is_the_slope),
        cmocka_unit_test(forces_follow_from_it),
        cmocka_unit_test(operations_lead_to_the_value),
        cmocka_unit_test(the_second_solve_of_the_lesson),
        cmocka_unit_test(a_body_has_the_constraints_of_its_parts),
        cmocka_unit_test(what_else_it_says),
        cmocka_unit_test(says_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
