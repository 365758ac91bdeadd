/* Bodies that come and go: disabled, enabled again, removed, and the indices that are used again. */
#include "all_methods.h"
#include "gpu.h"

static const double step_length = 1.0 / 120;

/* ---- A world of everything, with or without one body ---------------------------------------------- */

typedef struct everything {
    skein_world *world;
    skein_handle bodies[4], tie;
    uint32_t first[4], count[4];
} everything;

enum { CLOTH, LATTICE, BIRDS, ROPE, NOBODY };

static skein_status add_body(everything *e, int which) {
    static const char *const kinds[] = {"cloth", "lattice", "flock", "rope"};
    skein_surface surface;
    const skein_setting *settings =
        which == CLOTH     ? SKEIN_SETTINGS(SKEIN_PAIR("grid", 20, 18), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("stretch.stiffness", 300), SKEIN_REAL("shear.stiffness", 100),
                                            SKEIN_TEXT("name", "cloth"))
        : which == LATTICE ? SKEIN_SETTINGS(SKEIN_TEXT("name", "lattice"), SKEIN_REAL("structural.stiffness", 200),
                                            SKEIN_REAL("shear.stiffness", 100), SKEIN_REAL("bending.stiffness", 0))
        : which == BIRDS   ? SKEIN_SETTINGS(SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", 37),
                                            SKEIN_VEC3("spread", 3, 3, 3), SKEIN_REAL("speed", 1))
                           : SKEIN_SETTINGS(SKEIN_TEXT("name", "rope"), SKEIN_REAL("stretch.stiffness", 300),
                                            SKEIN_REAL("bend.stiffness", 0));
    skein_status status = skein_body_add(e->world, kinds[which], NULL, settings, &e->bodies[which]);
    if (status) return status;
    OK(e->world, skein_body_surface(e->world, e->bodies[which], &surface));
    e->first[which] = surface.first_particle, e->count[which] = surface.particle_count;
    return SKEIN_OK;
}

static everything make_everything(const char *method, int threads, int without) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    everything e = {.world = skein_world_create(&desc, NULL)};
    OK(e.world, skein_method_set(e.world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 3))));
    add_moving(e.world, 0.1, 5, 1, 0, 0, 1, 0);
    for (int b = CLOTH; b < NOBODY; b++)
        if (b != without) OK(e.world, add_body(&e, b));
    add_moving(e.world, 0.2, 5, 2, 0, 1, 0, 0);
    add_gravity(e.world);
    OK(e.world, skein_force_add(e.world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.3)), NULL));
    OK(e.world, skein_force_add(e.world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 1, 0, 2)), NULL));
    OK(e.world, skein_force_add(e.world, "separation",
                                SKEIN_SETTINGS(SKEIN_REAL("radius", 0.08), SKEIN_REAL("strength", 0.01)), NULL));
    if (without != BIRDS)
        OK(e.world, skein_force_add(e.world, "flocking", SKEIN_SETTINGS(SKEIN_TEXT("on", "birds")), NULL));
    OK(e.world, skein_collider_add(e.world, "plane",
                                   SKEIN_SETTINGS(SKEIN_REAL("offset", -0.3), SKEIN_REAL("friction", 0.3)), NULL));
    return e;
}

/* To those who are there it is as if a body that is disabled, or was removed, had never been. */
static void others_move_as_if_it_had_never_been(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (int gone = CLOTH; gone < NOBODY; gone++)
            for (int removed = 0; removed < 2; removed++) {
                everything e = make_everything(all_methods[m], 1 + gone % 2, NOBODY);
                everything never = make_everything(all_methods[m], 1, gone);
                if (removed) OK(e.world, skein_remove(e.world, e.bodies[gone]));
                else OK(e.world, skein_set(e.world, e.bodies[gone], "enabled", skein_number(0)));
                for (int i = 0; i < 5; i++) {
                    OK(e.world, skein_world_step(e.world, step_length));
                    OK(never.world, skein_world_step(never.world, step_length));
                    if (skein_world_hash(e.world) != skein_world_hash(never.world))
                        fail_msg("%s, body %d, removed %d: others move otherwise", all_methods[m], gone, removed);
                }
                skein_statistics a = statistics_of(e.world), b = statistics_of(never.world);
                a.memory_bytes = b.memory_bytes = 0;
                assert_memory_equal(&a, &b, sizeof a);
                size_t springs[2], contacts[2];
                OK(e.world, skein_springs_copy(e.world, NULL, 0, &springs[0]));
                OK(never.world, skein_springs_copy(never.world, NULL, 0, &springs[1]));
                OK(e.world, skein_contacts_copy(e.world, NULL, 0, &contacts[0]));
                OK(never.world, skein_contacts_copy(never.world, NULL, 0, &contacts[1]));
                assert_true(springs[0] == springs[1] && contacts[0] == contacts[1]);
                skein_world_destroy(e.world), skein_world_destroy(never.world);
            }
}

/* It stays where it is, and goes on from there with the velocity it had. */
static void a_body_goes_on_where_it_stood(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 4);
        skein_handle birds;
        add_gravity(world);
        OK(world, skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 5)), &birds));
        uint32_t loose = add_particle(world, 1, 0, 0, 0);
        steps(world, 6, step_length);
        vec3 x = position_of(world, 2), v = velocity_of(world, 2);
        OK(world, skein_set(world, birds, "enabled", skein_number(0)));
        assert_true(!skein_particle_present(world, 2) && skein_particle_present(world, loose));
        steps(world, 6, step_length);
        double between[3];
        OK(world, skein_positions_blend(world, 0.5, 2, 1, between));
        assert_true(length3(minus(position_of(world, 2), x)) == 0 && length3(minus(velocity_of(world, 2), v)) == 0);
        assert_true(between[0] == x.x && between[1] == x.y && between[2] == x.z);
        OK(world, skein_set(world, birds, "enabled", skein_number(1)));
        assert_true(length3(minus(position_of(world, 2), x)) == 0 && length3(minus(velocity_of(world, 2), v)) == 0);
        steps(world, 6, step_length);
        // a free fall of the time that it took part in
        double t = 6 * step_length;
        assert_near(velocity_of(world, 2).y, v.y - 9.81 * t, 2e-5 * (1 + fabs(v.y)));
        assert_near(position_of(world, 2).x, x.x + v.x * t, 1e-4);
        assert_near(velocity_of(world, loose).y, -9.81 * 3 * t, 1e-4);
        OK(world, skein_set(world, birds, "enabled", skein_number(0)));
        OK(world, skein_world_reset(world)); // also of those who take no part
        skein_world *fresh = new_world(all_methods[m], 4);
        OK(fresh, skein_body_add(fresh, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 5)), NULL));
        assert_true(length3(minus(position_of(world, 2), position_of(fresh, 2))) == 0);
        skein_world_destroy(world), skein_world_destroy(fresh);
    }
}

/* What is written while a body takes no part is where it goes on from. */
static void a_disabled_body_can_be_placed(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 4);
    skein_handle birds;
    OK(world, skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 3)), &birds));
    OK(world, skein_set(world, birds, "enabled", skein_number(0)));
    steps(world, 1, 0.1);
    place_particle(world, 1, 1, 2, 3);
    throw_particle(world, 1, 10, 0, 0);
    OK(world, skein_set(world, birds, "enabled", skein_number(1)));
    steps(world, 1, 0.1);
    assert_near(position_of(world, 1).x, 2, 1e-5);
    assert_near(position_of(world, 1).y, 2, 0);
    skein_world_destroy(world);
}

/* ---- Constraints of the program's own --------------------------------------------------------------- */

static void constraints_lose_what_is_gone(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 4);
        skein_handle birds, ties;
        size_t count;
        uint32_t a = add_particle(world, 0, 0, 0, 0), b = add_particle(world, 1, 1, 0, 0);
        OK(world, skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 2), SKEIN_REAL("speed", 0)),
                                 &birds));
        const uint32_t pairs[] = {a, b, b, 2, 2, 3};
        OK(world, skein_constraint_add(world, "distance", pairs, 3, SKEIN_SETTINGS(SKEIN_REAL("stiffness", 10)), &ties));
        place_particle(world, b, 1.5, 0, 0);
        OK(world, skein_set(world, birds, "enabled", skein_number(0)));
        steps(world, 2, 1e-3);
        assert_true(velocity_of(world, b).x < 0 && fabs(velocity_of(world, b).y) < 1e-9); // by the first alone
        OK(world, skein_springs_copy(world, NULL, 0, &count));
        assert_int_equal(count, 1);
        assert_int_equal(statistics_of(world).constraints, 1);
        OK(world, skein_set(world, birds, "enabled", skein_number(1)));
        OK(world, skein_springs_copy(world, NULL, 0, &count));
        assert_int_equal(count, 3);
        OK(world, skein_set(world, birds, "enabled", skein_number(0)));
        OK(world, skein_remove(world, birds));
        // others that get the indices are not tied to anybody
        OK(world, skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 2)), &birds));
        skein_surface surface;
        OK(world, skein_body_surface(world, birds, &surface));
        assert_int_equal(surface.first_particle, 2);
        assert_int_equal(skein_particle_count(world), 4);
        OK(world, skein_springs_copy(world, NULL, 0, &count));
        assert_int_equal(count, 1);
        steps(world, 2, 1e-3);
        assert_true(skein_handle_valid(world, ties));
        skein_world_destroy(world);
    }
}

/* A pressure acts on a whole surface or not at all. */
static void a_pressure_rests(void **state) {
    (void)state;
    static const uint32_t closed[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    skein_world *world = new_world("symplectic_euler", 4);
    skein_handle birds, pressure;
    OK(world,
       skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 4), SKEIN_REAL("speed", 0)), &birds));
    OK(world, skein_constraint_add(world, "pressure", closed, 4, SKEIN_SETTINGS(SKEIN_REAL("pressure", 3)), &pressure));
    OK(world, skein_set(world, birds, "enabled", skein_number(0)));
    steps(world, 3, 1e-3);
    assert_int_equal(statistics_of(world).constraints, 0);
    OK(world, skein_set(world, birds, "enabled", skein_number(1)));
    steps(world, 1, 1e-3);
    assert_int_equal(statistics_of(world).constraints, 1);
    OK(world, skein_remove(world, birds));
    OK(world,
       skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 4), SKEIN_REAL("speed", 0)), &birds));
    steps(world, 3, 1e-3);
    assert_true(length3(velocity_of(world, 0)) == 0);
    skein_world_destroy(world);
}

/* ---- Indices and memory ----------------------------------------------------------------------------- */

static void indices_of_others_stay(void **state) {
    (void)state;
    everything e = make_everything("xpbd", 1, NOBODY);
    steps(e.world, 3, step_length);
    vec3 last = position_of(e.world, e.first[ROPE] + 2), loose = position_of(e.world, e.first[ROPE] + e.count[ROPE]);
    size_t count = skein_particle_count(e.world);
    OK(e.world, skein_remove(e.world, e.bodies[LATTICE]));
    assert_int_equal(skein_particle_count(e.world), count);
    assert_false(skein_handle_valid(e.world, e.bodies[LATTICE]));
    assert_true(length3(minus(position_of(e.world, e.first[ROPE] + 2), last)) == 0);
    assert_true(length3(minus(position_of(e.world, e.first[ROPE] + e.count[ROPE]), loose)) == 0);
    steps(e.world, 1, step_length);
    // of nobody: all zero, and nothing can be written there
    size_t nobody = e.first[LATTICE] + 1;
    place_particle(e.world, nobody, 1, 2, 3);
    throw_particle(e.world, nobody, 1, 2, 3);
    OK(e.world, skein_particle_pin(e.world, nobody, false));
    skein_view view = skein_position_view(e.world);
    for (int k = 0; k < 4; k++) assert_true(view.xyzw[4 * view.slot_of[nobody] + (size_t)k] == 0);
    assert_true(length3(position_of(e.world, nobody)) == 0 && length3(velocity_of(e.world, nobody)) == 0);
    // the next of its size lies where it lay, and moves as it did in a world of its own
    everything fresh = {.world = new_world("xpbd", 3)}, again = {.world = e.world};
    OK(again.world, add_body(&again, LATTICE));
    assert_int_equal(again.first[LATTICE], e.first[LATTICE]);
    assert_int_equal(skein_particle_count(e.world), count);
    OK(fresh.world, add_body(&fresh, LATTICE));
    for (uint32_t i = 0; i < again.count[LATTICE]; i++)
        assert_true(length3(minus(position_of(e.world, again.first[LATTICE] + i), position_of(fresh.world, i))) == 0);
    skein_surface surface;
    OK(e.world, skein_body_surface(e.world, again.bodies[LATTICE], &surface));
    for (size_t v = 0; v < surface.vertex_count; v++)
        assert_in_range(surface.particle_of_vertex[v], again.first[LATTICE],
                        again.first[LATTICE] + again.count[LATTICE] - 1);
    steps(e.world, 3, step_length);
    skein_world_destroy(e.world), skein_world_destroy(fresh.world);
}

/* A cloth that took over indices is the same cloth, in strips and with tethers, to the bit. */
static void a_body_in_used_indices_is_the_same(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (int which = CLOTH; which < NOBODY; which++) {
            everything used = {.world = new_world(all_methods[m], 3)}, fresh = {.world = new_world(all_methods[m], 3)};
            OK(used.world, add_body(&used, LATTICE));
            OK(used.world, add_body(&used, CLOTH));
            OK(used.world, skein_remove(used.world, used.bodies[LATTICE]));
            OK(used.world, skein_remove(used.world, used.bodies[CLOTH]));
            OK(used.world, add_body(&used, which));
            OK(fresh.world, add_body(&fresh, which));
            assert_int_equal(used.first[which], 0);
            add_gravity(used.world), add_gravity(fresh.world);
            steps(used.world, 5, step_length), steps(fresh.world, 5, step_length);
            assert_true(skein_world_hash(used.world) == skein_world_hash(fresh.world));
            skein_world_destroy(used.world), skein_world_destroy(fresh.world);
        }
}

/* A game in which things come and go for hours. */
static void memory_does_not_grow(void **state) {
    (void)state;
    everything e = make_everything("xpbd", 1, NOBODY);
    uint64_t seed = 3;
    size_t most[2] = {0, 0}, indices[2] = {0, 0};
    skein_handle live[6] = {{0, 0, 0}}, rules[2] = {{0, 0, 0}};
    for (int i = 0; i < 600; i++) {
        skein_handle *place = &live[(size_t)random_between(&seed, 0, COUNT(live))], *rule = &rules[i % 2];
        if (skein_handle_valid(e.world, *place)) OK(e.world, skein_remove(e.world, *place));
        if (skein_handle_valid(e.world, *rule)) OK(e.world, skein_remove(e.world, *rule));
        skein_setting rows[] = {
            SKEIN_PAIR("grid", (double)(int)random_between(&seed, 2, 8), (double)(int)random_between(&seed, 2, 8)),
            {NULL, {0, {0, 0, 0}, NULL}}};
        OK(e.world, skein_body_add(e.world, "cloth", NULL, rows, place));
        OK(e.world, skein_force_add(e.world, "wind", NULL, rule));
        if (i % 20 == 0) OK(e.world, skein_world_step(e.world, step_length));
        skein_statistics s;
        if (i % 20 == 0) OK(e.world, skein_world_statistics(e.world, &s));
        if (i % 20 == 0 && s.memory_bytes > most[i >= 300]) most[i >= 300] = s.memory_bytes;
        if (skein_particle_count(e.world) > indices[i >= 300]) indices[i >= 300] = skein_particle_count(e.world);
    }
    printf("%zu and %zu bytes, %zu and %zu indices\n", most[0], most[1], indices[0], indices[1]);
    assert_true((double)most[1] < 1.15 * (double)most[0]);
    assert_true((double)indices[1] < 1.15 * (double)indices[0]);
    assert_int_equal(skein_object_count(e.world, SKEIN_BODY), 4 + COUNT(live));
    // in the order of their making: the newest is the last one
    skein_handle newest;
    OK(e.world, skein_force_add(e.world, "wind", NULL, &newest));
    size_t forces = skein_object_count(e.world, SKEIN_FORCE);
    assert_true(skein_handle_equal(skein_object_at(e.world, SKEIN_FORCE, forces - 1), newest));
    assert_true(newest.index < 40);
    skein_world_destroy(e.world);
}

/* ---- Looking ------------------------------------------------------------------------------------------- */

static void nobody_meets_what_is_not_there(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 2);
    skein_handle cloth, birds;
    skein_hit hit;
    uint32_t particle;
    double t;
    OK(world, skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5)), &cloth));
    OK(world, skein_body_add(world, "flock", NULL,
                             SKEIN_SETTINGS(SKEIN_REAL("count", 9), SKEIN_VEC3("position", 50, 50, 50)), &birds));
    vec3 x = position_of(world, 12);
    const double at[3] = {x.x, x.y, x.z};
    const double above[3] = {x.x + 0.01, x.y + 5, x.z + 0.01}, front[3] = {x.x + 0.01, x.y + 0.01, x.z + 5};
    const double down[3] = {0, -1, 0}, back[3] = {0, 0, -1};
    skein_hit from[2];
    OK(world, skein_ray_cast(world, above, down, SKEIN_BODY, &from[0]));
    OK(world, skein_ray_cast(world, front, back, SKEIN_BODY, &from[1]));
    const double *origin = isfinite(from[0].t) ? above : front, *along = isfinite(from[0].t) ? down : back;
    for (int turn = 0; turn < 3; turn++) {
        OK(world, skein_ray_cast(world, origin, along, SKEIN_BODY, &hit));
        assert_true(isfinite(hit.t) == (turn == 0));
        OK(world, skein_particle_near_point(world, at, &particle, NULL));
        assert_true((particle < 25) == (turn == 0));
        OK(world, skein_particle_near_ray(world, origin, along, 0.02, 0, &particle, &t));
        assert_true(isfinite(t) == (turn == 0));
        if (turn == 0) OK(world, skein_set(world, cloth, "enabled", skein_number(0)));
        if (turn == 1) OK(world, skein_remove(world, cloth));
    }
    OK(world, skein_remove(world, birds));
    FAILS(world, SKEIN_ERROR_VALUE, "no particles", skein_particle_near_point(world, at, &particle, NULL));
    steps(world, 2, 0.01); // of nobody
    assert_int_equal(statistics_of(world).particles, 0);
    skein_world_destroy(world);
}

/* A rule that names a body which was removed waits for the next one of its name; a wrong name is still an error. */
static void rules_wait_for_the_next_of_a_name(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 2);
    skein_handle birds, rule;
    const skein_setting named[] = {SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", 9), {NULL, {0, {0, 0, 0}, NULL}}};
    OK(world, skein_body_add(world, "flock", NULL, named, &birds));
    OK(world, skein_force_add(world, "attraction", SKEIN_SETTINGS(SKEIN_TEXT("on", "birds")), &rule));
    OK(world, skein_force_add(world, "flocking",
                              SKEIN_SETTINGS(SKEIN_TEXT("on", "birds"), SKEIN_TEXT("neighbours", "birds")), NULL));
    OK(world, skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("particle", 3)), NULL));
    steps(world, 2, 0.01);
    OK(world, skein_remove(world, birds));
    add_particle(world, 1, 0, 0, 0);
    steps(world, 2, 0.01);
    OK(world, skein_body_add(world, "flock", NULL, named, &birds));
    vec3 v = velocity_of(world, 0);
    steps(world, 2, 0.01);
    assert_true(length3(minus(velocity_of(world, 0), v)) > 0.01);
    OK(world, skein_set(world, rule, "on", skein_text("gulls")));
    FAILS(world, SKEIN_ERROR_NAME, "gulls", skein_world_step(world, 0.01));
    skein_world_destroy(world);
}

/* A motion of a body that was removed leads nobody, not even who gets its indices, until there is one of its name. */
static void motions_wait_for_the_next_of_a_name(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 2);
    skein_handle flag, motion;
    const uint32_t first_two[] = {0, 1};
    const double places[] = {5, 0, 0, 6, 0, 0};
    const skein_track track = {first_two, places, 2, 1, 1};
    const skein_setting named[] = {
        SKEIN_TEXT("name", "flag"), SKEIN_PAIR("grid", 3, 3), SKEIN_TEXT("pins", "0"), {NULL, {0, {0, 0, 0}, NULL}}};
    const skein_setting other[] = {
        SKEIN_TEXT("name", "other"), SKEIN_PAIR("grid", 3, 3), SKEIN_TEXT("pins", "0"), {NULL, {0, {0, 0, 0}, NULL}}};
    OK(world, skein_body_add(world, "cloth", NULL, named, &flag));
    OK(world, skein_motion_add(world, "translate", NULL,
                               SKEIN_SETTINGS(SKEIN_TEXT("on", "flag"), SKEIN_VEC3("velocity", 1, 0, 0)), &motion));
    OK(world, skein_motion_add(world, "cache", &track, NULL, NULL));
    steps(world, 1, 0.01);
    assert_true(fabs(position_of(world, 0).x - 5) < 1e-6); // the last one counts
    OK(world, skein_remove(world, flag));
    skein_handle second;
    OK(world, skein_body_add(world, "cloth", NULL, other, &second)); // it gets the indices
    skein_surface surface;
    OK(world, skein_body_surface(world, second, &surface));
    assert_int_equal(surface.first_particle, 0);
    vec3 built = position_of(world, 0);
    steps(world, 3, 0.01);
    assert_true(length3(minus(position_of(world, 0), built)) == 0);
    OK(world, skein_remove(world, second));
    OK(world, skein_body_add(world, "cloth", NULL, named, &flag));
    steps(world, 3, 0.01);
    assert_true(position_of(world, 0).x > built.x + 0.01);
    skein_world_destroy(world);
}

static void a_card_refuses_in_plain_words(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 2);
    skein_handle birds;
    OK(world, skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 40)), &birds));
    add_particle(world, 1, 0, 0, 0);
    to_card(world);
    steps(world, 2, 0.01);
    vec3 x = position_of(world, 1);
    OK(world, skein_set(world, birds, "enabled", skein_number(0)));
    FAILS(world, SKEIN_ERROR_VALUE, "40 particles are of bodies that are disabled", skein_world_step(world, 0.01));
    OK(world, skein_set(world, birds, "enabled", skein_number(1)));
    assert_true(length3(minus(position_of(world, 1), x)) == 0);
    steps(world, 2, 0.01);
    assert_true(length3(minus(position_of(world, 1), x)) > 0);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(others_move_as_if_it_had_never_been),
        cmocka_unit_test(a_body_goes_on_where_it_stood),
        cmocka_unit_test(a_disabled_body_can_be_placed),
        cmocka_unit_test(constraints_lose_what_is_gone),
        cmocka_unit_test(a_pressure_rests),
        cmocka_unit_test(indices_of_others_stay),
        cmocka_unit_test(a_body_in_used_indices_is_the_same),
        cmocka_unit_test(memory_does_not_grow),
        cmocka_unit_test(nobody_meets_what_is_not_there),
        cmocka_unit_test(rules_wait_for_the_next_of_a_name),
        cmocka_unit_test(motions_wait_for_the_next_of_a_name),
        cmocka_unit_test(a_card_refuses_in_plain_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
