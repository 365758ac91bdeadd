/* Pins that move: led by places for the end of a step, or by their velocities; and that a cloth does not feel how fast
 * the world is in which it hangs. */
#include "all_methods.h"
#include "helpers.h"
#include "sparing.h"

static const char *const isas[] = {"sse", "avx2", "avx512"}; // what SKEIN_SIMD takes; what is not there is sse

typedef enum sheet_kind { A_GRID, A_MESH } sheet_kind;

enum { ROWS = 9, COLUMNS = 11, VERTICES = ROWS * COLUMNS };
static const double dt = 1.0 / 60;

/* A sheet in the plane z = 0, 0.5 m wide and 0.4 m high, whose top edge is pinned; without air. As a mesh it has
 * triangles of all forms, and its vertices are in no order. What swings without damping would grow under
 * explicit_euler, however little it is at first: rounding, say. */
static skein_world *hanging_sheet(const char *method, int substeps, sheet_kind kind, const char *isa, size_t *count) {
    setenv("SKEIN_SIMD", isa, 1);
    skein_world *world = new_world(method, substeps);
    unsetenv("SKEIN_SIMD");
    double xyz[3 * VERTICES];
    uint32_t number[VERTICES], sizes[2 * VERTICES], corners[6 * VERTICES];
    uint64_t seed = 7;
    for (uint32_t i = 0; i < VERTICES; i++) number[i] = i;
    for (uint32_t i = VERTICES - 1; i > 0; i--) {
        uint32_t j = (uint32_t)random_between(&seed, 0, i + 1), kept = number[i];
        number[i] = number[j], number[j] = kept;
    }
    char pins[8 * COLUMNS] = "";
    size_t faces = 0;
    for (uint32_t r = 0; r < ROWS; r++)
        for (uint32_t c = 0; c < COLUMNS; c++) {
            double off = r && c && r + 1 < ROWS && c + 1 < COLUMNS ? 0.012 : 0;
            double *p = &xyz[3 * number[r * COLUMNS + c]];
            p[0] = 0.05 * c - 0.25 + random_between(&seed, -off, off), p[2] = 0;
            p[1] = 0.4 - 0.05 * r + random_between(&seed, -off, off);
            if (!r) snprintf(pins + strlen(pins), 8, " %u", number[c]);
            if (r + 1 == ROWS || c + 1 == COLUMNS) continue;
            uint32_t a = number[r * COLUMNS + c], b = number[r * COLUMNS + c + 1], d = number[(r + 1) * COLUMNS + c],
                     e = number[(r + 1) * COLUMNS + c + 1];
            uint32_t both[2][6] = {{a, b, e, a, e, d}, {a, b, d, b, e, d}};
            memcpy(corners + 3 * faces, both[(r + c) % 2], sizeof both[0]);
            sizes[faces++] = 3, sizes[faces++] = 3;
        }
    skein_mesh mesh = {xyz, VERTICES, sizes, faces, corners, 3 * faces};
    const skein_setting of_grid[] =
        {SKEIN_PAIR("grid", ROWS, COLUMNS),  SKEIN_PAIR("size", 0.5, 0.4),        SKEIN_VEC3("rotation", 90, 0, 0),
         SKEIN_VEC3("position", 0, 0.2, 0),  SKEIN_TEXT("pins", "top edge"),      SKEIN_REAL("stretch.stiffness", 60),
         SKEIN_REAL("shear.stiffness", 30),  SKEIN_REAL("stretch.damping", 0.05), SKEIN_REAL("shear.damping", 0.03),
         SKEIN_TEXT("bend.by", "springs"),   SKEIN_REAL("bend.stiffness", 4),     SKEIN_REAL("bend.damping", 0.01),
         SKEIN_REAL("stretch.tether", 0.01), SKEIN_REAL("stretch.limit", 0.05),   {0}},
                        of_mesh[] = {SKEIN_TEXT("pins", pins),
                                     SKEIN_REAL("stretch.stiffness", 60),
                                     SKEIN_REAL("stretch.damping", 0.05),
                                     SKEIN_TEXT("bend.by", "springs"),
                                     SKEIN_REAL("bend.stiffness", 4),
                                     SKEIN_REAL("bend.damping", 0.01),
                                     SKEIN_REAL("stretch.tether", 0.01),
                                     SKEIN_REAL("stretch.limit", 0.05),
                                     {0}};
    OK(world, skein_body_add(world, "cloth", kind == A_MESH ? &mesh : NULL, kind == A_MESH ? of_mesh : of_grid, NULL));
    add_gravity(world);
    *count = skein_particle_count(world);
    return world;
}

/* Its pins, and where they stand. */
static size_t list_pins(const skein_world *world, uint32_t *pins, double *places) {
    skein_view view = skein_position_view(world);
    size_t found = 0;
    for (uint32_t i = 0; i < view.count; i++) {
        if (view.xyzw[4 * view.slot_of[i] + 3] > 0) continue;
        OK(world, skein_positions_copy(world, i, 1, places + 3 * found));
        pins[found++] = i;
    }
    return found;
}

static void move_pins(skein_world *world, size_t count, const uint32_t *pins, const double *places, double x, double z) {
    double at[3 * COLUMNS];
    for (size_t i = 0; i < count; i++) {
        at[3 * i] = places[3 * i] + x, at[3 * i + 1] = places[3 * i + 1], at[3 * i + 2] = places[3 * i + 2] + z;
    }
    OK(world, skein_pins_move(world, pins, count, at));
}

/* ---- the call ---- */

/* A pin that is led is at its place after the step, exactly, and at rest; substep by substep it goes straight. A light
 * particle that hangs on it by a stiff spring, damped so that it follows, shows the way in between. */
static void pins_go_where_they_are_told(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (int inertia = 1; inertia >= !!strcmp(all_methods[m], "pbd"); inertia--) {
            skein_world *world = new_world(all_methods[m], 10);
            if (!inertia) OK(world, skein_set_path(world, "method.inertia", skein_number(0)));
            uint32_t pin = add_particle(world, 0, 1, 2, 3), other = add_particle(world, 0, 0, 0, 0);
            add_moving(world, 1, 5, 5, 5, 1, 0, 0); // something that is free
            add_gravity(world);
            const double there[] = {1.3, 1.9, 3.7, 0.1, 0.2, 0.3}, again[] = {1.1, 2, 3};
            OK(world, skein_pins_move(world, (uint32_t[]){other, pin}, 2, (double[]){9, 9, 9, 0, 0, 0}));
            OK(world, skein_pins_move(world, (uint32_t[]){pin, other}, 2, there)); // the last counts
            assert_true(position_of(world, pin).x == 1);
            steps(world, 1, dt);
            for (uint32_t i = 0; i < 2; i++) {
                vec3 p = position_of(world, i), v = velocity_of(world, i);
                assert_true(p.x == (double)(skein_real)there[3 * i] && p.y == (double)(skein_real)there[3 * i + 1] &&
                            p.z == (double)(skein_real)there[3 * i + 2]);
                assert_true(v.x == 0 && v.y == 0 && v.z == 0);
            }
            vec3 half;
            OK(world, skein_positions_blend(world, 0.5, pin, 1, &half.x));
            assert_near(half.x, 1.15, 10 * EPSILON);
            steps(world, 3, dt); // it stays
            assert_true(position_of(world, pin).x == (double)(skein_real)1.3);
            OK(world, skein_pins_move(world, &pin, 1, again));
            steps(world, 1, dt);
            assert_true(position_of(world, pin).x == (double)(skein_real)1.1);
            assert_true(position_of(world, other).z == (double)(skein_real)0.3);
            skein_world_destroy(world);
        }
}

/* The way of what a pin drags along, in one step of n substeps: as in n steps of one, in each of which it is told. */
static void pins_go_straight_through_the_substeps(void **state) {
    (void)state;
    enum { SUBSTEPS = 8 };
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        vec3 end[2];
        for (int fine = 0; fine < 2; fine++) {
            skein_world *world = new_world(all_methods[m], fine ? 1 : SUBSTEPS);
            uint32_t pin = add_particle(world, 0, 0, 0, 0), hung = add_particle(world, 0.1, 0, -1, 0);
            add_spring(world, pin, hung, 500, 2);
            add_gravity(world);
            for (int k = 1; k <= (fine ? SUBSTEPS : 1); k++) {
                double part = fine ? (double)k / SUBSTEPS : 1;
                OK(world, skein_pins_move(world, &pin, 1, (double[]){0.1 * part, 0.05 * part, 0}));
                steps(world, 1, fine ? dt / SUBSTEPS : dt);
            }
            end[fine] = position_of(world, hung);
            assert_true(fabs(end[fine].y + 1) > 1e-4); // it was lifted
            skein_world_destroy(world);
        }
        assert_near(end[0].x, end[1].x, 100 * EPSILON);
        assert_near(end[0].y, end[1].y, 100 * EPSILON);
    }
}

static void pins_say_what_is_wrong(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 4);
    uint32_t pin = add_particle(world, 0, 0, 0, 0), loose = add_particle(world, 1, 1, 0, 0);
    const double there[] = {1, 1, 1, 2, 2, 2}, nowhere[] = {1, 1, 1, 0, NAN, 0}, far[] = {0, 1e16, 0};
    FAILS(world, SKEIN_ERROR_VALUE, "particle 1 is not pinned",
          skein_pins_move(world, (uint32_t[]){pin, loose}, 2, there));
    FAILS(world, SKEIN_ERROR_VALUE, "no particle 7", skein_pins_move(world, (uint32_t[]){pin, 7}, 2, there));
    FAILS(world, SKEIN_ERROR_VALUE, "no particle 2", skein_pins_move(world, (uint32_t[]){pin, 2}, 2, there));
    FAILS(world, SKEIN_ERROR_VALUE, "finite", skein_pins_move(world, (uint32_t[]){pin, pin}, 2, nowhere));
    FAILS(world, SKEIN_ERROR_VALUE, "finite", skein_pins_move(world, &pin, 1, far));
    steps(world, 1, dt); // none of them is left behind
    assert_true(position_of(world, pin).x == 0);
    OK(world, skein_pins_move(world, &pin, 1, (double[]){1e14, 0, 0}));
    FAILS(world, SKEIN_ERROR_VALUE, "too fast", skein_world_step(world, 1e-3));
    assert_true(position_of(world, pin).x == 0 && velocity_of(world, pin).x == 0);
    OK(world, skein_pins_move(world, NULL, 1, (double[]){1, 0, 0}));
    steps(world, 1, dt);
    assert_true(position_of(world, pin).x == 1);
    skein_world_destroy(world);
}

/* Places wait for a step; a reset forgets them, and so does what is let go. */
static void places_are_forgotten_with_their_pins(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 4);
    uint32_t pin = add_particle(world, 1, 0, 0, 0), other = add_particle(world, 0, 3, 0, 0);
    OK(world, skein_particle_pin(world, pin, true));
    for (int k = 0; k < 100; k++) // far more than there are particles: the list does not grow
        OK(world, skein_pins_move(world, (uint32_t[]){pin, other}, 2, (double[]){1, 0, 0, 4, 0.01 * k, 0}));
    OK(world, skein_particle_pin(world, pin, false));
    steps(world, 1, dt);
    assert_true(position_of(world, pin).x == 0 && velocity_of(world, pin).x == 0);
    assert_true(position_of(world, other).y == (double)(skein_real)0.99);
    uint64_t hash = skein_world_hash(world);
    OK(world, skein_pins_move(world, &other, 1, (double[]){7, 0, 0}));
    assert_true(skein_world_hash(world) == hash);
    OK(world, skein_world_reset(world));
    steps(world, 1, dt);
    assert_true(position_of(world, other).x == 3);
    skein_world_destroy(world);
}

/* A copy of the state goes on as the world did, to the bit, whatever had been led before. */
static void a_copy_goes_on_the_same(void **state) {
    (void)state;
    uint32_t pins[COLUMNS];
    double places[3 * COLUMNS];
    uint64_t hash[2];
    skein_world *worlds[2];
    size_t count;
    for (int k = 0; k < 2; k++) worlds[k] = hanging_sheet("leapfrog", 30, A_MESH, "avx2", &count);
    size_t found = list_pins(worlds[0], pins, places);
    for (int step = 0; step < 10; step++) {
        move_pins(worlds[0], found, pins, places, 0.02 * step, 0.01 * step);
        steps(worlds[0], 1, dt);
    }
    double *copy = calloc(6 * count, sizeof *copy);
    OK(worlds[0], skein_positions_copy(worlds[0], 0, count, copy));
    OK(worlds[0], skein_velocities_copy(worlds[0], 0, count, copy + 3 * count));
    OK(worlds[1], skein_positions_set(worlds[1], 0, count, copy));
    OK(worlds[1], skein_velocities_set(worlds[1], 0, count, copy + 3 * count));
    OK(worlds[1], skein_world_time_set(worlds[1], skein_world_time(worlds[0]))); // differences of times round by it
    for (int k = 0; k < 2; k++) {
        for (int step = 10; step < 20; step++) {
            if (step < 15) move_pins(worlds[k], found, pins, places, 0.02 * step, 0.01 * step);
            steps(worlds[k], 1, dt);
        }
        hash[k] = skein_world_hash(worlds[k]);
        skein_world_destroy(worlds[k]);
    }
    assert_true(hash[0] == hash[1]);
    free(copy);
}

/* ---- the world's own speed ---- */

/* Substeps at which each method holds the sheet. */
static int substeps_of(const char *method) {
    bool one_sided = !strcmp(method, "lookahead_euler") || !strcmp(method, "midpoint");
    return !strcmp(method, "explicit_euler") ? 100 : !strcmp(method, "backward_euler") ? 4 : one_sided ? 60 : 20;
}

typedef enum moved_by { BY_PLACES, BY_VELOCITIES } moved_by;

typedef struct stretch {
    double worst, mean; /* of the largest of each frame */
} stretch;

/* Until it hangs still. */
static void settle(skein_world *world, const char *method) {
    skein_handle air;
    OK(world, skein_method_set(world, "backward_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 4))));
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 20)), &air));
    steps(world, 90, dt);
    OK(world, skein_remove(world, air));
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps_of(method)))));
}

/* The stretch of a sheet that is let go with a swing, in a world that moves at this speed. It begins so far back that
 * it is never far from the origin: away from there floats have fewer digits.
 *
 * Under explicit_euler the jerk at the end of a tether is an event of a few substeps, and a float's rounding is what
 * the stretch then hangs on: a sheet at rest, but 1 m farther on, has one that is 10 % off. There the sheet hangs
 * still. */
static stretch stretch_at(double speed, const char *method, sheet_kind kind, const char *isa, moved_by by) {
    bool swings = strcmp(method, "explicit_euler") != 0;
    int frames = swings ? 30 : 10;
    uint32_t pins[COLUMNS];
    double places[3 * COLUMNS];
    stretch of = {0, 0};
    size_t count;
    skein_world *world = hanging_sheet(method, substeps_of(method), kind, isa, &count);
    if (!swings) settle(world, method);
    double *xyz = calloc(6 * count, sizeof *xyz), *v = xyz + 3 * count;
    OK(world, skein_positions_copy(world, 0, count, xyz));
    for (size_t i = 0; i < count; i++) {
        xyz[3 * i] -= 0.5 * speed * frames * dt;
        v[3 * i] = speed, v[3 * i + 2] = swings ? 0.8 * xyz[3 * i + 1] : 0;
    }
    OK(world, skein_positions_set(world, 0, count, xyz));
    OK(world, skein_velocities_set(world, 0, count, v));
    size_t found = list_pins(world, pins, places);
    for (size_t i = 0; i < found; i++) throw_particle(world, pins[i], speed, 0, 0);
    for (int frame = 1; frame <= frames; frame++) {
        if (by == BY_PLACES) move_pins(world, found, pins, places, speed * frame * dt, 0);
        steps(world, 1, dt);
        double now = statistics_of(world).max_stretch;
        of.worst = fmax(of.worst, now);
        of.mean += now / frames;
    }
    skein_world_destroy(world);
    free(xyz);
    return of;
}

/* Galileo: what hangs in a ship does not see how fast it goes. */
static void stretch_knows_no_speed(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (int kind = A_GRID; kind <= A_MESH; kind++)
            for (size_t i = 0; i < COUNT(isas); i++) {
                if (i && (SPARING || m % 3 != 1)) continue; // bits are the same on all of them: test_bits.c
                stretch still = stretch_at(0, all_methods[m], (sheet_kind)kind, isas[i], BY_PLACES);
                assert_true(still.mean > 0.005); // tethers are taut at times
                for (int by = BY_PLACES; by <= BY_VELOCITIES; by++)
                    for (int speed = SPARING ? 30 : 3; speed <= 30; speed *= 10) {
                        stretch moving = stretch_at(speed, all_methods[m], (sheet_kind)kind, isas[i], (moved_by)by);
                        assert_share(moving.mean, still.mean, 0.02);
                        assert_share(moving.worst, still.worst, 0.02);
                    }
            }
}

/* ---- pins that are told their places once a frame ---- */

/* 3 m/s after half a second. */
static double way(double t) {
    return t < 0.5 ? 3 * t * t : 0.75 + 3 * (t - 0.5);
}

/* The largest stretch while the pins run away with the sheet, flat side first, there being some air. */
static double stretch_of_run(const char *method, sheet_kind kind, const char *isa, int substeps, int steps_a_frame) {
    uint32_t pins[COLUMNS];
    double places[3 * COLUMNS], worst = 0;
    size_t count;
    skein_world *world = hanging_sheet(method, substeps / steps_a_frame, kind, isa, &count);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 1)), NULL));
    size_t found = list_pins(world, pins, places);
    for (int frame = 0; frame < 60; frame++) {
        for (int k = 1; k <= steps_a_frame; k++) {
            move_pins(world, found, pins, places, 0, way((frame + (double)k / steps_a_frame) * dt));
            steps(world, 1, dt / steps_a_frame);
        }
        worst = fmax(worst, statistics_of(world).max_stretch);
    }
    skein_world_destroy(world);
    return worst;
}

/* Told once a frame, pins stretch the sheet about as much as told in every substep. */
static void once_a_frame_is_enough(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (int kind = A_GRID; kind <= A_MESH; kind++)
            for (size_t i = 0; i < COUNT(isas); i++) {
                if (i && (SPARING || m % 3 != 1)) continue;
                int substeps = substeps_of(all_methods[m]);
                double coarse = stretch_of_run(all_methods[m], (sheet_kind)kind, isas[i], substeps, 1),
                       fine = stretch_of_run(all_methods[m], (sheet_kind)kind, isas[i], substeps, substeps);
                assert_true(fine > 0.002 && coarse <= 1.3 * fine);
            }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pins_go_where_they_are_told), cmocka_unit_test(pins_go_straight_through_the_substeps),
        cmocka_unit_test(pins_say_what_is_wrong),      cmocka_unit_test(places_are_forgotten_with_their_pins),
        cmocka_unit_test(a_copy_goes_on_the_same),     cmocka_unit_test(stretch_knows_no_speed),
        cmocka_unit_test(once_a_frame_is_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
