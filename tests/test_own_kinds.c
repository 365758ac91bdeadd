/* Kinds that a program registers (skein/kinds.h): each moves, is set, checked and found as the library's own are, under
 * every method, and what is wrong with one is said when it is registered. */
#include <skein/kinds.h>

#include "all_methods.h"
#include "helpers.h"

static const double dt = 1.0 / 60;

/* ---- the kinds ---- */

/* By formula: a spring to a line, a m/s2 for each metre, and drag that grows with height. */
static const skein_field swirl_fields[] = {
    SKEIN_FIELD_OF_FORMULA("pull", "1/s2", 3, 0, 1e6, "towards the line"),
    SKEIN_FIELD_OF_FORMULA("rub", "1/s", 0.1, 0, 1e6, "against the motion"),
};
static const skein_force_type swirl = {
    .kind = {"swirl", "draws to the vertical", SKEIN_FORCE, swirl_fields, COUNT(swirl_fields), 0},
    .formula = "vec3(-pull * p.x, 0.5, -pull * p.z) - rub * v",
};
static const char swirl_text[] = "vec3(-k * p.x, 0.5, -k * p.z) - c * v";

/* The same by a function. */
typedef struct swirl_params {
    double pull, rub;
} swirl_params;
static const skein_field swirl_c_fields[] = {
    SKEIN_FIELD_OF_REAL(swirl_params, pull, "pull", "1/s2", 3, 0, 1e6, "towards the line"),
    SKEIN_FIELD_OF_REAL(swirl_params, rub, "rub", "1/s", 0.1, 0, 1e6, "against the motion"),
};
static void swirl_force(const void *data, double time, const skein_lanes *in, skein_real force[3][SKEIN_LANES]) {
    const swirl_params *params = data;
    const skein_real pull = (skein_real)params->pull, rub = (skein_real)params->rub;
    (void)time;
    for (int i = 0; i < SKEIN_LANES; i++) {
        force[0][i] = in->mass[i] * (-pull * in->x[0][i] - rub * in->v[0][i]);
        force[1][i] = in->mass[i] * ((skein_real)0.5 - rub * in->v[1][i]);
        force[2][i] = in->mass[i] * (-pull * in->x[2][i] - rub * in->v[2][i]);
    }
}
static double swirl_energy(const void *data, double time, const double x[3], double mass) {
    (void)time;
    return mass * (0.5 * ((const swirl_params *)data)->pull * (x[0] * x[0] + x[2] * x[2]) - 0.5 * x[1]);
}
static const skein_force_type swirl_c = {
    .kind = {"swirl_c", "the same, by a function", SKEIN_FORCE, swirl_c_fields, COUNT(swirl_c_fields),
             sizeof(swirl_params)},
    .on_velocity = true,
    .force = swirl_force,
    .energy = swirl_energy,
};

static const skein_field well_fields[] = {SKEIN_FIELD_OF_FORMULA("depth", "1/s2", 2, 0, 1e6, "of the well")};
static const skein_force_type well = {
    .kind = {"well", "a potential", SKEIN_FORCE, well_fields, COUNT(well_fields), 0},
    .potential = "0.5 * depth * dot(p, p)",
};

static const skein_field rod_fields[] = {
    SKEIN_FIELD_OF_FORMULA("longer", "", 1, 1e-3, 1e3, "times as long as it was made"),
    SKEIN_FIELD_OF_FORMULA("stiffness", "N/m", 50, 0, 1e9, "of the rod"),
};
static const skein_constraint_type rod = {
    .kind = {"rod", "a spring that may be longer than it was made", SKEIN_CONSTRAINT, rod_fields, COUNT(rod_fields), 0},
    .formula = "length(p0 - p1) - longer * rest(length(p0 - p1))",
};

/* A ball by its distance. */
typedef struct ball_params {
    double centre[3], radius;
} ball_params;
static const skein_field ball_fields[] = {
    SKEIN_FIELD_OF_VEC3(ball_params, centre, "centre", "m", 0, 0, 0, "the middle"),
    SKEIN_FIELD_OF_REAL(ball_params, radius, "radius", "m", 0.5, 1e-9, 1e9, "the radius"),
};
static void ball_place(const void *data, double position[3]) {
    memcpy(position, ((const ball_params *)data)->centre, 3 * sizeof *position);
}
static double ball_distance(const void *data, double time, const double p[3], double normal[3]) {
    (void)time;
    for (int k = 0; k < 3; k++) normal[k] = p[k];
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - ((const ball_params *)data)->radius;
}
static const skein_collider_type ball = {
    .kind = {"own_ball", "a ball", SKEIN_COLLIDER, ball_fields, COUNT(ball_fields), sizeof(ball_params)},
    .place = ball_place,
    .distance = ball_distance,
};
static const skein_field egg_fields[] = {SKEIN_FIELD_OF_FORMULA("size", "m", 0.5, 1e-3, 1e3, "its half width")};
static const skein_collider_type egg = {
    .kind = {"egg", "a ball by formula", SKEIN_COLLIDER, egg_fields, COUNT(egg_fields), 0},
    .formula = "length(p) - size",
};

static const skein_field lift_fields[] = {
    SKEIN_FIELD_OF_REAL(swirl_params, pull, "speed", "m/s", 1, -10, 10, "upwards")};
static void lift_move(const void *data, double time, double place[3]) {
    place[1] += ((const swirl_params *)data)->pull * time;
}
static const skein_motion_type lift = {
    .kind = {"lift", "straight up", SKEIN_MOTION, lift_fields, COUNT(lift_fields), sizeof(swirl_params)},
    .move = lift_move,
};

typedef struct chain_params {
    int32_t count;
    double stiffness;
} chain_params;
static const skein_field chain_fields[] = {
    SKEIN_FIELD_OF_INT(chain_params, count, "count", "", 5, 2, 1000, "of particles"),
    SKEIN_FIELD_OF_REAL(chain_params, stiffness, "stiffness", "N/m", 100, 0, 1e9, "of each spring"),
};
static skein_status chain_build(skein_builder *builder, const void *data, const skein_mesh *mesh) {
    const chain_params *params = data;
    double x[1000][3] = {{0}}, mass[1000] = {0};
    uint32_t pairs[1000][2];
    if (mesh) return skein_build_fail(builder, "mesh", "a chain takes none");
    for (int i = 0; i < params->count; i++) {
        x[i][0] = 0.1 * i, mass[i] = i ? 0.1 : 0;
        pairs[i][0] = (uint32_t)i, pairs[i][1] = (uint32_t)i + 1;
    }
    size_t count = (size_t)params->count;
    skein_status status = skein_build_particles(builder, count, x[0], NULL, mass);
    if (!status) status = skein_build_springs(builder, "links", count - 1, pairs[0], params->stiffness, 1);
    if (!status) status = skein_build_triangles(builder, 1, (const uint32_t[]){0, 1, 1000});
    return status;
}
static skein_status chain_build_well(skein_builder *builder, const void *data, const skein_mesh *mesh) {
    skein_status status = chain_build(builder, data, mesh);
    return status == SKEIN_ERROR_VALUE && !mesh ? skein_build_triangles(builder, 0, NULL) : status;
}
static const skein_body_type bad_chain = {
    .kind = {"bad_chain", "a fault in its triangles", SKEIN_BODY, chain_fields, COUNT(chain_fields),
             sizeof(chain_params)},
    .build = chain_build,
};
static const skein_body_type chain = {
    .kind = {"chain", "springs in a row", SKEIN_BODY, chain_fields, COUNT(chain_fields), sizeof(chain_params)},
    .build = chain_build_well,
    .shape = SKEIN_SHAPE_CHAIN,
};

typedef struct own_euler_params {
    int32_t substeps;
} own_euler_params;
static const skein_field euler_fields[] = {
    SKEIN_FIELD_OF_INT(own_euler_params, substeps, "substeps", "", 20, 1, 1000, "parts of a step"),
};
static void write_euler(skein_plan_builder *w, const void *data, double step) {
    const own_euler_params *params = data;
    double h = step / params->substeps;
    size_t repeat = skein_write_repeat(w, (size_t)params->substeps, h);
    skein_write_forces(w);
    skein_write_kick(w, SKEIN_V, SKEIN_V, h, SKEIN_F);
    skein_write_steering(w);
    skein_write_sum(w, SKEIN_X, 1, SKEIN_X, h, SKEIN_V);
    skein_write_stage_time(w, 1);
    skein_write_contacts(w);
    skein_write_end(w, repeat);
}
static const skein_method_type own_euler = {
    .kind = {"own_euler", "symplectic Euler once more", SKEIN_METHOD, euler_fields, COUNT(euler_fields),
             sizeof(own_euler_params)},
    .write = write_euler,
};

/* ---- worlds that have them ---- */

static skein_kinds *kinds;

static int set_up(void **state) {
    static const skein_kind *const all[] = {&swirl.kind, &swirl_c.kind, &well.kind,  &rod.kind,       &ball.kind,
                                            &egg.kind,   &lift.kind,    &chain.kind, &bad_chain.kind, &own_euler.kind};
    skein_error error = {SKEIN_OK, "", ""};
    (void)state;
    kinds = skein_kinds_create(&error);
    for (size_t i = 0; kinds && i < COUNT(all); i++)
        if (skein_kind_register(kinds, all[i], &error)) return fprintf(stderr, "%s: %s\n", error.where, error.message);
    return !kinds;
}

static int tear_down(void **state) {
    (void)state;
    skein_kinds_destroy(kinds);
    return 0;
}

static skein_world *make_world(const char *method) {
    skein_world_desc desc = skein_default_world_desc();
    desc.kinds = kinds;
    desc.thread_count = 2;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    if (method) OK(world, skein_method_set(world, method, NULL));
    return world;
}

static void add_cloth(skein_world *world) {
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 9), SKEIN_REAL("stretch.stiffness", 100),
                                            SKEIN_REAL("shear.stiffness", 10), SKEIN_REAL("bend.rigidity", 0),
                                            SKEIN_REAL("stretch.tether", INFINITY), SKEIN_VEC3("velocity", 0.1, 0.2, 0)),
                             NULL));
}

static uint64_t run(skein_world *world, int count) {
    for (int i = 0; i < count; i++) OK(world, skein_world_step(world, dt));
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

static uint64_t run_force(const char *method, const char *kind, const skein_setting *settings) {
    skein_world *world = make_world(method);
    add_cloth(world);
    OK(world, skein_force_add(world, kind, settings, NULL));
    return run(world, 10);
}

/* ---- forces ---- */

/* The kind is its formula: the bits of a force_field with the same text, and each field has an effect. */
static void a_force_by_formula_moves_under_every_method(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        uint64_t own = run_force(all_methods[m], "swirl", SKEIN_SETTINGS(SKEIN_REAL("pull", 5)));
        assert_int_equal(own, run_force(all_methods[m], "force_field",
                                        SKEIN_SETTINGS(SKEIN_TEXT("force", swirl_text), SKEIN_REAL("parameters.k", 5),
                                                       SKEIN_REAL("parameters.c", 0.1))));
        assert_int_not_equal(own, run_force(all_methods[m], "swirl", NULL));
        assert_int_not_equal(
            own, run_force(all_methods[m], "swirl", SKEIN_SETTINGS(SKEIN_REAL("pull", 5), SKEIN_REAL("rub", 2))));
    }
}

/* A particle on a spring of 3 1/s2: x = cos(sqrt(3) t), whatever says so. */
static void forces_by_functions_swing_as_springs_do(void **state) {
    (void)state;
    static const char *const which[] = {"swirl", "swirl_c"};
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t k = 0; k < 2; k++) {
            if (!strcmp(all_methods[m], "pbd")) continue; // it has no accelerations of its own to be right about
            skein_world *world = make_world(NULL);
            OK(world, skein_method_set(world, all_methods[m], SKEIN_SETTINGS(SKEIN_REAL("substeps", 400))));
            add_particle(world, 2, 1, 0, 0);
            OK(world, skein_force_add(world, which[k], SKEIN_SETTINGS(SKEIN_REAL("rub", 0)), NULL));
            for (int i = 0; i < 60; i++) OK(world, skein_world_step(world, dt));
            assert_near(position_of(world, 0).x, cos(sqrt(3)), 2e-3);
            assert_near(position_of(world, 0).y, 0.25, 2e-3);
            skein_world_destroy(world);
        }
}

static void their_energy_is_counted(void **state) {
    (void)state;
    skein_world *world = make_world("rk4");
    skein_statistics now;
    add_particle(world, 2, 1, 2, 3);
    OK(world, skein_force_add(world, "swirl_c", NULL, NULL));
    OK(world, skein_world_statistics(world, &now));
    assert_near(now.potential_energy, 2 * (0.5 * 3 * 10 - 0.5 * 2), 1e-4);
    OK(world, skein_force_add(world, "well", SKEIN_SETTINGS(SKEIN_REAL("depth", 4)), NULL));
    OK(world, skein_world_statistics(world, &now));
    assert_near(now.potential_energy, 28 + 2 * 0.5 * 4 * 14, 1e-3);
    skein_world_destroy(world);
}

/* ---- the others ---- */

static void a_constraint_finds_its_length(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = make_world(NULL);
        skein_handle handle;
        OK(world, skein_method_set(world, all_methods[m], SKEIN_SETTINGS(SKEIN_REAL("substeps", 20))));
        add_particle(world, 0, 0, 0, 0);
        add_particle(world, 1, 0.5, 0, 0);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 10)), NULL));
        OK(world, skein_constraint_add(world, "rod", (const uint32_t[]){0, 1}, 1,
                                       SKEIN_SETTINGS(SKEIN_REAL("longer", 2)), &handle));
        for (int i = 0; i < 240; i++) OK(world, skein_world_step(world, dt));
        assert_near(position_of(world, 1).x, 1, 2e-3);
        OK(world, skein_set(world, handle, "longer", skein_number(3)));
        for (int i = 0; i < 240; i++) OK(world, skein_world_step(world, dt));
        assert_near(position_of(world, 1).x, 1.5, 3e-3);
        skein_world_destroy(world);
    }
}

/* What is thrown on a ball's top comes to lie there, moved and turned as colliders are. */
static void colliders_hold(void **state) {
    (void)state;
    static const char *const which[] = {"own_ball", "egg", "sphere"};
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t k = 0; k < 3; k++) {
            skein_world *world = make_world(all_methods[m]);
            skein_handle handle;
            add_particle(world, 1, 2, 1.3, 0);
            OK(world, skein_force_add(world, "gravity", NULL, NULL));
            OK(world, skein_collider_add(world, which[k],
                                         SKEIN_SETTINGS(SKEIN_VEC3("centre", 2, 0.5, 0), SKEIN_REAL("friction", 1),
                                                        SKEIN_REAL("restitution", 0), SKEIN_REAL("thickness", 0.01)),
                                         &handle));
            for (int i = 0; i < 90; i++) OK(world, skein_world_step(world, dt));
            assert_near(position_of(world, 0).y, 1.01, 2e-3);
            skein_world_destroy(world);
        }
}

static void shapes_are_told(void **state) {
    (void)state;
    skein_world *world = make_world(NULL);
    static const struct {
        const char *kind;
        skein_shape_sort sort;
    } all[] = {{"own_ball", SKEIN_SHAPE_SURFACE}, {"egg", SKEIN_SHAPE_SURFACE}, {"formula", SKEIN_SHAPE_SURFACE},
               {"sphere", SKEIN_SHAPE_BALL},      {"plane", SKEIN_SHAPE_PLANE}, {"bowl", SKEIN_SHAPE_BOWL},
               {"capsule", SKEIN_SHAPE_CAPSULE},  {"box", SKEIN_SHAPE_BOX}};
    skein_shape shape;
    skein_handle handle;
    for (size_t i = 0; i < COUNT(all); i++) {
        OK(world, skein_collider_add(world, all[i].kind, NULL, &handle));
        OK(world, skein_shape_of(world, handle, &shape));
        assert_int_equal(shape.sort, all[i].sort);
    }
    assert_near(shape.size[2], 1, 0);
    OK(world, skein_body_add(world, "chain", NULL, NULL, &handle));
    OK(world, skein_shape_of(world, handle, &shape));
    assert_int_equal(shape.sort, SKEIN_SHAPE_CHAIN);
    OK(world, skein_body_add(world, "flock", NULL, NULL, &handle));
    OK(world, skein_shape_of(world, handle, &shape));
    assert_int_equal(shape.sort, SKEIN_SHAPE_BIRDS);
    OK(world, skein_force_add(world, "gravity", NULL, &handle));
    FAILS(world, SKEIN_ERROR_HANDLE, "force", skein_shape_of(world, handle, &shape));
    skein_world_destroy(world);
}

/* The same rows as ours: the same bits, with cloth, contact and wind. */
static void a_method_is_what_it_writes(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int own = 0; own < 2; own++) {
        skein_world *world = make_world(own ? "own_euler" : "symplectic_euler");
        skein_statistics now;
        add_cloth(world);
        OK(world, skein_force_add(world, "gravity", NULL, NULL));
        OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, -0.6, 0)), NULL));
        for (int i = 0; i < 20; i++) OK(world, skein_world_step(world, dt));
        OK(world, skein_world_statistics(world, &now));
        assert_int_equal(now.substeps, 400);
        assert_true(now.contacts > 0);
        OK(world, skein_set_path(world, "method.substeps", skein_number(30)));
        hash[own] = run(world, 2);
    }
    assert_int_equal(hash[0], hash[1]);
    skein_world *world = make_world("own_euler");
    add_particle(world, 1, 0, 0, 0), add_particle(world, 1, 1, 0, 0);
    OK(world, skein_constraint_add(world, "distance", (const uint32_t[]){0, 1}, 1,
                                   SKEIN_SETTINGS(SKEIN_REAL("stiffness", INFINITY)), NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "own_euler needs finite stiffness", skein_world_step(world, dt));
    skein_world_destroy(world);
}

/* A chain of five hangs: its k-th spring bears what is below it. */
static void a_body_hangs_and_is_led(void **state) {
    (void)state;
    skein_world *world = make_world(NULL);
    skein_handle body, motion;
    skein_value value;
    OK(world, skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 20))));
    OK(world, skein_body_add(world, "chain", NULL, SKEIN_SETTINGS(SKEIN_TEXT("name", "hanging")), &body));
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 2)), NULL));
    OK(world, skein_motion_add(world, "lift", NULL, SKEIN_SETTINGS(SKEIN_REAL("speed", 0)), &motion));
    for (int i = 0; i < 900; i++) OK(world, skein_world_step(world, dt));
    double below = 4 * 0.1 * 9.81, length = 0;
    for (int i = 0; i < 4; i++, below -= 0.1 * 9.81) length += 0.1 + below / 100;
    assert_near(position_of(world, 4).y, -length, 2e-3);
    OK(world, skein_get(world, body, "count", &value));
    assert_near(value.number[0], 5, 0);
    FAILS(world, SKEIN_ERROR_VALUE, "", skein_set(world, body, "count", skein_number(6)));
    OK(world, skein_set(world, motion, "speed", skein_number(0.1)));
    OK(world, skein_world_step(world, dt));
    assert_near(position_of(world, 0).y, 0.1 * 901 * dt, 1e-4);
    size_t before = skein_particle_count(world);
    FAILS(world, SKEIN_ERROR_VALUE, "no particle 1000", skein_body_add(world, "bad_chain", NULL, NULL, NULL));
    assert_int_equal(skein_particle_count(world), before);
    skein_world_destroy(world);
}

/* ---- how they are found, and refused ---- */

static void they_are_listed_and_checked(void **state) {
    (void)state;
    skein_error error = {SKEIN_OK, "", ""};
    size_t ours = 0, all = 0;
    while (skein_kind_at(SKEIN_FORCE, ours)) ours++;
    while (skein_kinds_at(kinds, SKEIN_FORCE, all)) all++;
    assert_int_equal(all, ours + 3);
    assert_string_equal(skein_kinds_at(kinds, SKEIN_FORCE, ours)->name, "swirl");
    assert_null(skein_kind_find(SKEIN_FORCE, "swirl", NULL));
    assert_null(skein_kinds_find(kinds, SKEIN_FORCE, "swirll", &error));
    assert_non_null(strstr(error.message, "did you mean 'swirl'"));
    const skein_kind *kind = skein_kinds_find(kinds, SKEIN_FORCE, "swirl", NULL);
    assert_int_equal(kind->field_count, 2); // and no text that could be set
    skein_world *world = make_world(NULL), *another = new_world("xpbd", 1);
    skein_handle handle;
    skein_value value;
    FAILS(another, SKEIN_ERROR_NAME, "no force 'swirl'", skein_force_add(another, "swirl", NULL, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "pull",
          skein_force_add(world, "swirl", SKEIN_SETTINGS(SKEIN_REAL("pull", -1)), NULL));
    FAILS(world, SKEIN_ERROR_NAME, "did you mean 'pull'",
          skein_force_add(world, "swirl", SKEIN_SETTINGS(SKEIN_REAL("pul", 1)), NULL));
    OK(world, skein_force_add(world, "swirl", NULL, &handle));
    OK(world, skein_set_path(world, "forces.0.pull", skein_number(8)));
    OK(world, skein_get(world, handle, "pull", &value));
    assert_near(value.number[0], 8, 0);
    assert_string_equal(skein_object_kind(world, handle)->name, "swirl");
    skein_world_destroy(world), skein_world_destroy(another);
}

#define REFUSED(status_, part_, ...)                                                      \
    do {                                                                                  \
        const skein_force_type type_ = __VA_ARGS__;                                       \
        skein_error error_ = {SKEIN_OK, "", ""};                                          \
        assert_int_equal(skein_kind_register(kinds, &type_.kind, &error_), (status_));    \
        if (!strstr(error_.message, (part_)) && !strstr(error_.where, (part_)))           \
            fail_msg("'%s': '%s', expected '%s'", error_.where, error_.message, (part_)); \
    } while (0)

static void what_is_wrong_is_said_when_it_is_registered(void **state) {
    (void)state;
    static const skein_field far[] = {SKEIN_FIELD_OF_REAL(swirl_params, rub, "rub", "", 0, 0, 1, "beyond")};
    static const skein_field common[] = {SKEIN_FIELD_OF_REAL(swirl_params, pull, "enabled", "", 0, 0, 1, "taken")};
    static const skein_field twice[] = {SKEIN_FIELD_OF_FORMULA("a", "", 0, 0, 1, "x"),
                                        SKEIN_FIELD_OF_FORMULA("a", "", 0, 0, 1, "x")};
    static const skein_field unused[] = {SKEIN_FIELD_OF_FORMULA("unused", "", 0, 0, 1, "x")};
    REFUSED(SKEIN_ERROR_NAME, "already", {.kind = {"drag", "x", SKEIN_FORCE, NULL, 0, 0}, .formula = "p"});
    REFUSED(SKEIN_ERROR_NAME, "already", {.kind = {"swirl", "x", SKEIN_FORCE, NULL, 0, 0}, .formula = "p"});
    REFUSED(SKEIN_ERROR_NAME, "letters", {.kind = {"a b", "x", SKEIN_FORCE, NULL, 0, 0}, .formula = "p"});
    REFUSED(SKEIN_ERROR_SYNTAX, "column", {.kind = {"bad", "x", SKEIN_FORCE, NULL, 0, 0}, .formula = "p +"});
    REFUSED(SKEIN_ERROR_NAME, "unused", {.kind = {"bad", "x", SKEIN_FORCE, unused, 1, 0}, .formula = "p"});
    REFUSED(SKEIN_ERROR_NAME, "two fields", {.kind = {"bad", "x", SKEIN_FORCE, twice, 2, 0}, .formula = "a * p"});
    REFUSED(SKEIN_ERROR_NAME, "every force", {.kind = {"bad", "x", SKEIN_FORCE, common, 1, 16}, .force = swirl_force});
    REFUSED(SKEIN_ERROR_VALUE, "params_size", {.kind = {"bad", "x", SKEIN_FORCE, far, 1, 8}, .force = swirl_force});
    REFUSED(SKEIN_ERROR_VALUE, "needs a formula", {.kind = {"bad", "x", SKEIN_FORCE, NULL, 0, 0}});
    REFUSED(SKEIN_ERROR_VALUE, "not registered", {.kind = {"bad", "x", SKEIN_SCENE, NULL, 0, 0}, .formula = "p"});
    assert_null(skein_kinds_find(kinds, SKEIN_FORCE, "bad", NULL));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_force_by_formula_moves_under_every_method),
        cmocka_unit_test(forces_by_functions_swing_as_springs_do),
        cmocka_unit_test(their_energy_is_counted),
        cmocka_unit_test(a_constraint_finds_its_length),
        cmocka_unit_test(colliders_hold),
        cmocka_unit_test(shapes_are_told),
        cmocka_unit_test(a_method_is_what_it_writes),
        cmocka_unit_test(a_body_hangs_and_is_led),
        cmocka_unit_test(they_are_listed_and_checked),
        cmocka_unit_test(what_is_wrong_is_said_when_it_is_registered),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
