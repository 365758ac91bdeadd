/* The public API: handles, fields, reading and writing the state, reset, the pacer, callbacks, errors. */
#include "helpers.h"

static const double dt = 1.0 / 90;

/* A hanging cloth with something of each category. */
typedef struct scene {
    skein_world *world;
    skein_handle cloth, gravity, drag, ball, spring;
} scene;

static scene make_scene(const skein_world_desc *desc) {
    scene s;
    skein_error error;
    s.world = skein_world_create(desc, &error);
    assert_non_null(s.world);
    OK(s.world, skein_body_add(s.world, "cloth", NULL,
                               SKEIN_SETTINGS(SKEIN_TEXT("name", "sheet"), SKEIN_PAIR("grid", 7, 7),
                                              SKEIN_VEC3("position", 0, 1, 0), SKEIN_TEXT("pins", "top corners")),
                               &s.cloth));
    add_moving(s.world, 0.5, 0, 1.2, 0, 0.1, 0, 0);
    add_particle(s.world, 0.5, 0.2, 1.3, 0);
    OK(s.world,
       skein_constraint_add(s.world, "distance", (const uint32_t[]){49, 50}, 1,
                            SKEIN_SETTINGS(SKEIN_TEXT("name", "rod"), SKEIN_REAL("stiffness", 300)), &s.spring));
    OK(s.world, skein_force_add(s.world, "gravity", NULL, &s.gravity));
    OK(s.world, skein_force_add(s.world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.3)), &s.drag));
    OK(s.world, skein_collider_add(s.world, "sphere",
                                   SKEIN_SETTINGS(SKEIN_TEXT("name", "ball"), SKEIN_VEC3("centre", 0, 0.6, 0),
                                                  SKEIN_REAL("radius", 0.3)),
                                   &s.ball));
    return s;
}

/* ---- Handles ------------------------------------------------------------------------------------ */

static void handles_go_stale(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    skein_handle handles[] = {s.spring, s.gravity, s.ball};
    for (size_t i = 0; i < COUNT(handles); i++) {
        skein_value value;
        skein_category category = skein_object_kind(s.world, handles[i])->category;
        size_t before = skein_object_count(s.world, category);
        assert_true(skein_handle_valid(s.world, handles[i]));
        steps(s.world, 1, dt);
        OK(s.world, skein_remove(s.world, handles[i]));
        assert_false(skein_handle_valid(s.world, handles[i]));
        assert_null(skein_object_kind(s.world, handles[i]));
        assert_int_equal(skein_object_count(s.world, category), before - 1);
        FAILS(s.world, SKEIN_ERROR_HANDLE, "stale", skein_remove(s.world, handles[i]));
        FAILS(s.world, SKEIN_ERROR_HANDLE, "stale", skein_set(s.world, handles[i], "enabled", skein_number(1)));
        FAILS(s.world, SKEIN_ERROR_HANDLE, "stale", skein_get(s.world, handles[i], "enabled", &value));
        steps(s.world, 1, dt); // without it
    }
    // a new object does not answer to an old handle
    skein_handle again;
    OK(s.world, skein_force_add(s.world, "gravity", NULL, &again));
    assert_true(skein_handle_valid(s.world, again) && !skein_handle_valid(s.world, s.gravity));
    assert_false(skein_handle_equal(again, s.gravity));
    // handles that never were, of no world and of this one
    static const skein_handle wild[] = {{0, 0, 0},  {UINT32_MAX, 0, 0}, {UINT32_MAX, 1, 0},
                                        {77, 1, 0}, {0, 2, 0},          {0, 3, 0}};
    for (size_t i = 0; i < 2 * COUNT(wild); i++) {
        skein_handle handle = wild[i / 2];
        if (i % 2) handle.world = s.cloth.world;
        assert_false(skein_handle_valid(s.world, handle));
        assert_int_equal(skein_remove(s.world, handle), SKEIN_ERROR_HANDLE);
    }
    skein_world_destroy(s.world);
}

/* What a handle names in one world it does not name in another, not even where the same calls made both. */
static void handles_know_their_world(void **state) {
    (void)state;
    scene a = make_scene(NULL), b = make_scene(NULL);
    const skein_handle foreign[] = {b.cloth, b.gravity, b.drag,
                                    b.ball,  b.spring,  skein_object_at(b.world, SKEIN_METHOD, 0)};
    for (size_t i = 0; i < COUNT(foreign); i++) {
        skein_value value;
        assert_true(skein_handle_valid(b.world, foreign[i]) || i == COUNT(foreign) - 1);
        assert_non_null(skein_object_kind(b.world, foreign[i]));
        assert_false(skein_handle_valid(a.world, foreign[i]));
        assert_null(skein_object_kind(a.world, foreign[i]));
        assert_false(skein_field_is_live(a.world, foreign[i], "enabled"));
        FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world", skein_remove(a.world, foreign[i]));
        FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world",
              skein_set(a.world, foreign[i], "enabled", skein_number(0)));
        FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world", skein_get(a.world, foreign[i], "enabled", &value));
        FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world", skein_user_set(a.world, foreign[i], &value));
        assert_null(skein_user(a.world, foreign[i]));
    }
    skein_surface surface;
    skein_pose pose;
    double xyz[3] = {0};
    size_t count;
    FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world", skein_body_surface(a.world, b.cloth, &surface));
    FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world",
          skein_body_elements(a.world, b.cloth, SKEIN_EDGES, NULL, 0, &count));
    FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world", skein_collider_pose(a.world, b.ball, &pose));
    FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world", skein_collider_probe(a.world, b.ball, 1, xyz, xyz, NULL));
    FAILS(a.world, SKEIN_ERROR_HANDLE, "of another world", skein_force_probe(a.world, b.drag, 1, xyz, xyz));
    assert_int_equal(skein_object_count(a.world, SKEIN_COLLIDER), 1);
    // what this world hands out is its own
    skein_hit hit;
    OK(a.world, skein_ray_cast(a.world, (const double[]){0, 5, 0}, (const double[]){0, -1, 0}, SKEIN_BODY, &hit));
    assert_true(skein_handle_equal(hit.object, a.cloth) && !skein_handle_equal(hit.object, b.cloth));
    assert_true(skein_handle_equal(skein_object_at(a.world, SKEIN_FORCE, 1), a.drag));
    // nor does it name anything in a world that comes later, even to the same place
    skein_world_destroy(b.world);
    for (int i = 0; i < 8; i++) {
        scene later = make_scene(NULL);
        assert_false(skein_handle_valid(later.world, foreign[0]));
        skein_world_destroy(later.world);
    }
    skein_world_destroy(a.world);
}

static void objects_carry_a_pointer_of_the_users(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    const skein_handle all[] = {s.cloth, s.gravity, s.drag, s.ball, s.spring};
    int mine[COUNT(all)];
    for (size_t i = 0; i < COUNT(all); i++) {
        assert_null(skein_user(s.world, all[i]));
        OK(s.world, skein_user_set(s.world, all[i], &mine[i]));
    }
    steps(s.world, 2, dt);
    OK(s.world, skein_set(s.world, s.ball, "radius", skein_number(0.2)));
    OK(s.world, skein_world_reset(s.world));
    OK(s.world, skein_remove(s.world, s.drag));
    for (size_t i = 0; i < COUNT(all); i++) assert_ptr_equal(skein_user(s.world, all[i]), i == 2 ? NULL : &mine[i]);
    OK(s.world, skein_user_set(s.world, s.cloth, NULL));
    assert_null(skein_user(s.world, s.cloth));
    FAILS(s.world, SKEIN_ERROR_HANDLE, "stale", skein_user_set(s.world, s.drag, mine));
    skein_handle method = skein_object_at(s.world, SKEIN_METHOD, 0);
    FAILS(s.world, SKEIN_ERROR_HANDLE, "of a method", skein_user_set(s.world, method, mine));
    assert_null(skein_user(s.world, method));
    skein_world_destroy(s.world);
}

/* What is added or removed between two steps counts from the next one on. */
static void rules_come_and_go_between_steps(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 1);
        add_particle(world, 1, 0, 1, 0);
        steps(world, 1, 0.1);
        skein_handle gravity, ground;
        OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_VEC3("acceleration", 0, -10, 0)), &gravity));
        steps(world, 1, 0.1);
        assert_near(velocity_of(world, 0).y, -1, 1e-6);
        steps(world, 1, 0.2); // and the plan follows the step's length
        assert_near(velocity_of(world, 0).y, -3, 1e-6);
        assert_near(position_of(world, 0).y, 1 - 0.1 - 0.6, 1e-6);
        OK(world, skein_remove(world, gravity));
        steps(world, 1, 0.1);
        assert_near(velocity_of(world, 0).y, -3, 1e-6);
        OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0)), &ground));
        steps(world, 3, 0.1);
        assert_near(position_of(world, 0).y, 0, 1e-6);
        OK(world, skein_remove(world, ground));
        throw_particle(world, 0, 0, -1, 0);
        steps(world, 1, 0.1);
        assert_near(position_of(world, 0).y, -0.1, 1e-6);
        skein_world_destroy(world);
    }
}

static void handles_have_a_category(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    skein_surface surface;
    skein_pose pose;
    FAILS(s.world, SKEIN_ERROR_HANDLE, "no such body", skein_body_surface(s.world, s.ball, &surface));
    FAILS(s.world, SKEIN_ERROR_HANDLE, "no such body", skein_body_surface(s.world, s.gravity, &surface));
    FAILS(s.world, SKEIN_ERROR_HANDLE, "no such collider", skein_collider_pose(s.world, s.cloth, &pose));
    OK(s.world, skein_body_surface(s.world, s.cloth, &surface));
    assert_true(surface.grid_rows == 7 && surface.grid_columns == 7 && surface.first_particle == 0 &&
                surface.particle_count == 49);
    OK(s.world, skein_collider_pose(s.world, s.ball, &pose));
    assert_near(pose.position[1], 0.6, 1e-6);
    // the method stays
    skein_handle method = skein_object_at(s.world, SKEIN_METHOD, 0);
    assert_string_equal(skein_object_kind(s.world, method)->name, "xpbd");
    assert_int_equal(skein_remove(s.world, method), SKEIN_ERROR_HANDLE);
    // objects in the order of their making
    assert_int_equal(skein_object_count(s.world, SKEIN_FORCE), 2);
    skein_handle second = skein_object_at(s.world, SKEIN_FORCE, 1);
    assert_memory_equal(&second, &s.drag, sizeof second);
    assert_false(skein_handle_valid(s.world, skein_object_at(s.world, SKEIN_FORCE, 2)));
    skein_world_destroy(s.world);
}

/* ---- Fields ------------------------------------------------------------------------------------- */

static double number_at(const skein_world *world, const char *path) {
    skein_value value;
    OK(world, skein_get_path(world, path, &value));
    assert_int_equal(value.count, 1);
    return value.number[0];
}

static void fields_by_handle_and_path(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    skein_value value;
    OK(s.world, skein_set(s.world, s.ball, "radius", skein_number(0.25)));
    assert_true(number_at(s.world, "colliders.ball.radius") == 0.25);
    assert_true(number_at(s.world, "colliders.0.radius") == 0.25);
    OK(s.world, skein_set_path(s.world, "colliders.ball.motion.spin", skein_number(-2)));
    OK(s.world, skein_get(s.world, s.ball, "motion.spin", &value));
    assert_true(value.number[0] == -2);
    OK(s.world, skein_set_path(s.world, "forces.1.rate", skein_number(0.75)));
    assert_true(number_at(s.world, "forces.1.rate") == 0.75);
    OK(s.world, skein_set_path(s.world, "bodies.sheet.stretch.stiffness", skein_number(4321)));
    assert_true(number_at(s.world, "bodies.0.stretch.stiffness") == 4321);
    OK(s.world, skein_set_path(s.world, "constraints.rod.stiffness", skein_number(5)));
    OK(s.world, skein_set_path(s.world, "method.substeps", skein_number(7)));
    assert_true(number_at(s.world, "method.substeps") == 7);
    // vectors, pairs and texts
    OK(s.world, skein_set_path(s.world, "colliders.ball.centre", skein_vector(1, 2, 3)));
    OK(s.world, skein_get_path(s.world, "colliders.ball.centre", &value));
    assert_true(value.count == 3 && value.number[0] == 1 && value.number[1] == 2 && value.number[2] == 3);
    OK(s.world, skein_get_path(s.world, "bodies.sheet.grid", &value));
    assert_true(value.count == 2 && value.number[0] == 7 && value.number[1] == 7);
    OK(s.world, skein_get_path(s.world, "bodies.0.pins", &value));
    assert_string_equal(value.text, "top corners");
    // a new name is the new path
    OK(s.world, skein_set(s.world, s.ball, "name", skein_text("globe")));
    assert_true(number_at(s.world, "colliders.globe.radius") == 0.25);
    FAILS(s.world, SKEIN_ERROR_NAME, "no ball", skein_set_path(s.world, "colliders.ball.radius", skein_number(1)));
    // numbers count what lives
    OK(s.world, skein_remove(s.world, s.gravity));
    assert_true(number_at(s.world, "forces.0.rate") == 0.75);
    skein_world_destroy(s.world);
}

static void wrong_names_suggest_the_nearest(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    skein_value value;
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'radius'?", skein_set(s.world, s.ball, "raduis", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'stretch.stiffness'?",
          skein_set_path(s.world, "bodies.0.stretch.stifness", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'friction'?", skein_set(s.world, s.ball, "frction", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'sphere'?", skein_collider_add(s.world, "spere", NULL, NULL));
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'cloth'?", skein_body_add(s.world, "clot", NULL, NULL, NULL));
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'xpbd'?", skein_method_set(s.world, "xbpd", NULL));
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'substeps'?",
          skein_method_set(s.world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substep", 3))));
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'gravity'?", skein_force_add(s.world, "gravitty", NULL, NULL));
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'distance'?",
          skein_constraint_add(s.world, "distanse", NULL, 0, NULL, NULL));
    FAILS(s.world, SKEIN_ERROR_NAME, "expected bodies", skein_set_path(s.world, "body.0.density", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_NAME, "expected bodies", skein_set_path(s.world, "", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_NAME, "expected bodies", skein_set_path(s.world, "forces.0", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_NAME, "no 2 among the 2 forces",
          skein_set_path(s.world, "forces.2.rate", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_NAME, "has no field ''", skein_set_path(s.world, "forces.0.", skein_number(1)));
    // far from everything: no suggestion
    assert_int_equal(skein_set(s.world, s.ball, "zzzzzzzzzz", skein_number(1)), SKEIN_ERROR_NAME);
    assert_null(strstr(skein_world_error(s.world)->message, "did you mean"));
    // reading says the same
    FAILS(s.world, SKEIN_ERROR_NAME, "did you mean 'radius'?", skein_get(s.world, s.ball, "raduis", &value));
    FAILS(s.world, SKEIN_ERROR_NAME, "no 9 among the 2 forces", skein_get_path(s.world, "forces.9.rate", &value));
    // nothing was added by all that
    assert_true(skein_object_count(s.world, SKEIN_BODY) == 1 && skein_object_count(s.world, SKEIN_FORCE) == 2);
    assert_true(skein_object_count(s.world, SKEIN_COLLIDER) == 1 && skein_object_count(s.world, SKEIN_CONSTRAINT) == 1);
    steps(s.world, 1, dt);
    skein_world_destroy(s.world);
}

static void values_out_of_range_are_refused(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    FAILS(s.world, SKEIN_ERROR_VALUE, "out of range", skein_set(s.world, s.ball, "radius", skein_number(-1)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "out of range", skein_set(s.world, s.ball, "radius", skein_number(NAN)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "out of range", skein_set(s.world, s.ball, "radius", skein_number(INFINITY)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "from 0 to 1", skein_set(s.world, s.ball, "restitution", skein_number(1.5)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "a number in m", skein_set(s.world, s.ball, "radius", skein_vector(1, 2, 3)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "a number in m", skein_set(s.world, s.ball, "radius", skein_text("large")));
    FAILS(s.world, SKEIN_ERROR_VALUE, "three numbers", skein_set(s.world, s.ball, "centre", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "expected a text", skein_set(s.world, s.ball, "name", skein_number(1)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "whole number", skein_set_path(s.world, "method.substeps", skein_number(2.5)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "out of range", skein_set_path(s.world, "method.substeps", skein_number(0)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "true or false", skein_set(s.world, s.ball, "enabled", skein_number(0.5)));
    FAILS(s.world, SKEIN_ERROR_VALUE, "out of range",
          skein_collider_add(s.world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0)), NULL));
    // what was refused changed nothing; the ends of a range belong to it
    assert_true(number_at(s.world, "colliders.ball.radius") == 0.3);
    OK(s.world, skein_set(s.world, s.ball, "restitution", skein_number(1)));
    OK(s.world, skein_set(s.world, s.ball, "restitution", skein_number(0)));
    OK(s.world, skein_set_path(s.world, "bodies.0.stretch.stiffness", skein_number(INFINITY)));
    // every field's own default is in its range, and every kind has a help
    for (skein_category c = 0; c < SKEIN_CATEGORY_COUNT; c++)
        for (size_t k = 0; skein_kind_at(c, k); k++) {
            const skein_kind *kind = skein_kind_at(c, k);
            skein_error error;
            assert_ptr_equal(skein_kind_find(c, kind->name, &error), kind);
            assert_true(kind->category == c && kind->help[0]);
            for (size_t f = 0; f < kind->field_count; f++) {
                const skein_field *field = &kind->fields[f];
                static const int numbers[] = {1, 1, 2, 3, 1, 2, 3, 1, 0};
                skein_value value = {numbers[field->type],
                                     {field->initial[0], field->initial[1], field->initial[2]},
                                     field->text ? field->text : ""};
                assert_int_equal(skein_field_check(field, &value, &error), SKEIN_OK);
                assert_ptr_equal(skein_field_find(kind, field->name, &error), field);
                assert_true(field->help[0]);
            }
        }
    skein_world_destroy(s.world);
}

/* By word or by place, from 0 to the last. */
static void choices_are_whole_and_within_the_list(void **state) {
    (void)state;
    int found = 0;
    for (skein_category c = 0; c < SKEIN_CATEGORY_COUNT; c++)
        for (size_t k = 0; skein_kind_at(c, k); k++)
            for (size_t f = 0; f < skein_kind_at(c, k)->field_count; f++) {
                const skein_field *field = &skein_kind_at(c, k)->fields[f];
                if (field->type != SKEIN_FIELD_CHOICE) continue;
                double count = 1;
                for (const char *at = field->choices; *at; at++) count += *at == '|';
                skein_error error;
                for (double place = -1; place <= count + 1; place += 0.5) {
                    skein_value value = skein_number(place);
                    bool good = place >= 0 && place < count && place == floor(place);
                    skein_status status = skein_field_check(field, &value, &error);
                    if ((status == SKEIN_OK) != good)
                        fail_msg("%s: place %g of %s", field->name, place, field->choices);
                    if (!good) assert_non_null(strstr(error.message, field->choices));
                }
                skein_value value = skein_text("no such word");
                assert_int_equal(skein_field_check(field, &value, &error), SKEIN_ERROR_VALUE);
                found++;
            }
    assert_true(found > 5);
}

static void what_shaped_a_body_cannot_change(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    static const char *const live[] = {"stretch.stiffness", "stretch.damping", "shear.stiffness", "shear.damping",
                                       "bend.rigidity",     "stretch.tether",  "stretch.limit"};
    for (size_t i = 0; i < COUNT(live); i++) {
        // each of them is felt
        uint64_t before, after;
        OK(s.world, skein_world_reset(s.world));
        steps(s.world, 20, dt);
        before = skein_world_hash(s.world);
        OK(s.world, skein_set(s.world, s.cloth, live[i], skein_number(i == 6 ? 0 : 0.02)));
        OK(s.world, skein_world_reset(s.world));
        steps(s.world, 20, dt);
        after = skein_world_hash(s.world);
        assert_true(before != after);
    }
    static const char *const shaping[] = {"mesh",     "pins",           "grid",        "size",    "position",
                                          "rotation", "scale",          "velocity",    "density", "weld",
                                          "bend.by",  "bend.stiffness", "bend.damping"}; // by angle
    for (size_t i = 0; i < COUNT(shaping); i++) {
        const skein_field *field = skein_field_find(skein_object_kind(s.world, s.cloth), shaping[i], NULL);
        skein_value value;
        OK(s.world, skein_get(s.world, s.cloth, field->name, &value));
        FAILS(s.world, SKEIN_ERROR_VALUE, "shapes what is already built",
              skein_set(s.world, s.cloth, shaping[i], value));
    }
    // its name can
    OK(s.world, skein_set(s.world, s.cloth, "name", skein_text("curtain")));
    assert_true(number_at(s.world, "bodies.curtain.density") == 0.2);
    skein_world_destroy(s.world);
}

/* A live change is as if the body had been built so. */
static void live_fields_are_as_if_built_so(void **state) {
    (void)state;
    skein_world *worlds[2];
    for (int w = 0; w < 2; w++) {
        worlds[w] = new_world("xpbd", 5);
        add_gravity(worlds[w]);
        skein_handle body;
        OK(worlds[w], skein_body_add(worlds[w], "cloth", NULL,
                                     SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5), SKEIN_TEXT("pins", "top corners"),
                                                    SKEIN_REAL("stretch.stiffness", w ? 100 : 2e4),
                                                    SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 20),
                                                    SKEIN_REAL("bend.damping", w ? 0.5 : 0),
                                                    SKEIN_REAL("stretch.limit", w ? 0.02 : 1)),
                                     &body));
        if (w) continue;
        OK(worlds[0], skein_set(worlds[0], body, "stretch.stiffness", skein_number(100)));
        OK(worlds[0], skein_set(worlds[0], body, "bend.damping", skein_number(0.5)));
        OK(worlds[0], skein_set(worlds[0], body, "stretch.limit", skein_number(0.02)));
    }
    for (int w = 0; w < 2; w++) steps(worlds[w], 30, dt);
    assert_true(skein_world_hash(worlds[0]) == skein_world_hash(worlds[1]));
    for (int w = 0; w < 2; w++) skein_world_destroy(worlds[w]);
}

/* ---- Enabled ------------------------------------------------------------------------------------ */

/* What is switched off is as if it were not there, for every kind of rule, and switched on again as if it had been. */
static void disabled_is_as_if_absent(void **state) {
    (void)state;
    enum { KINDS = 9, WITHOUT, DISABLED, WITH, ENABLED_AGAIN, WAYS };
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int kind = 0; kind < KINDS; kind++) {
            uint64_t hash[WAYS] = {0};
            for (int way = WITHOUT; way < WAYS; way++) {
                skein_world *world = new_world(method_names[m], 8);
                // the cloth is there in any case, but for its own turn below
                skein_handle handle = {0, 0, 0}, cloth;
                OK(world,
                   skein_body_add(world, "cloth", NULL,
                                  SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5), SKEIN_VEC3("position", 0, 0.5, 0),
                                                 SKEIN_VEC3("velocity", 1, -3, 0.5),
                                                 SKEIN_REAL("stretch.stiffness", 20), SKEIN_REAL("shear.stiffness", 5),
                                                 SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 1),
                                                 SKEIN_REAL("stretch.limit", 0.02), SKEIN_TEXT("pins", "0")),
                                  &cloth));
                uint64_t seed = 31;
                for (int i = 0; i < 6; i++)
                    add_particle(world, 0.1, random_between(&seed, -0.1, 0.1), random_between(&seed, 0.5, 0.6),
                                 random_between(&seed, -0.1, 0.1));
                if (way != WITHOUT || kind == 8) switch (kind) {
                    case 0: OK(world, skein_force_add(world, "gravity", NULL, &handle)); break;
                    case 1:
                        OK(world,
                           skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 1e-3, 0, 0)), &handle));
                        break;
                    case 2:
                        OK(world, skein_force_add(world, "surface_wind",
                                                  SKEIN_SETTINGS(SKEIN_VEC3("velocity", 0, 1, 3)), &handle));
                        break;
                    case 3:
                        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.4)), &handle));
                        break;
                    case 4:
                        OK(world,
                           skein_force_add(world, "separation",
                                           SKEIN_SETTINGS(SKEIN_REAL("radius", 0.2), SKEIN_REAL("strength", 0.01)),
                                           &handle));
                        break;
                    case 5:
                        OK(world,
                           skein_collider_add(
                               world, "plane",
                               SKEIN_SETTINGS(SKEIN_REAL("offset", 0.45), SKEIN_REAL("restitution", 0.3)), &handle));
                        break;
                    case 6:
                        OK(world, skein_collider_add(world, "sphere",
                                                     SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.2, 0),
                                                                    SKEIN_REAL("radius", 0.25),
                                                                    SKEIN_REAL("restitution", 0.3)),
                                                     &handle));
                        break;
                    case 7:
                        OK(world, skein_constraint_add(world, "distance", (const uint32_t[]){25, 26, 27, 12}, 2,
                                                       SKEIN_SETTINGS(SKEIN_REAL("stiffness", 10)), &handle));
                        break;
                    case 8: handle = cloth; break; // its springs and limits rest, its particles fly on
                    }
                if (way == DISABLED || way == ENABLED_AGAIN || (kind == 8 && way == WITHOUT))
                    OK(world, skein_set(world, handle, "enabled", skein_number(0)));
                if (way == ENABLED_AGAIN) {
                    OK(world, skein_world_explain(world, dt, NULL, NULL)); // a plan without it
                    OK(world, skein_set(world, handle, "enabled", skein_number(1)));
                }
                // pull a spring out, so that it has something to do
                place_particle(world, 26, 0.3, 0.7, 0.2);
                steps(world, 12, dt);
                hash[way] = skein_world_hash(world);
                skein_world_destroy(world);
            }
            assert_true(hash[DISABLED] == hash[WITHOUT]);
            assert_true(hash[ENABLED_AGAIN] == hash[WITH]);
            assert_true(hash[WITH] != hash[WITHOUT]);
        }
}

/* A cloth that is switched off stays where it is. */
static void a_disabled_cloth_stays(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 4);
        add_gravity(world);
        skein_handle cloth;
        OK(world,
           skein_body_add(world, "cloth", NULL,
                          SKEIN_SETTINGS(SKEIN_PAIR("grid", 4, 4), SKEIN_TEXT("pins", "0"), SKEIN_REAL("enabled", 0)),
                          &cloth));
        steps(world, 90, dt);
        for (size_t i = 1; i < 16; i++) assert_true(velocity_of(world, i).y == 0);
        OK(world, skein_set(world, cloth, "enabled", skein_number(1)));
        steps(world, 1, dt);
        for (size_t i = 1; i < 16; i++) assert_true(velocity_of(world, i).y < 0);
        skein_world_destroy(world);
    }
}

/* ---- State -------------------------------------------------------------------------------------- */

static void reset_repeats_a_fresh_run(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        uint64_t first[20];
        scene s = make_scene(NULL);
        OK(s.world, skein_method_set(s.world, method_names[m], SKEIN_SETTINGS(SKEIN_REAL("substeps", 20))));
        throw_particle(s.world, 49, 0, 0, 0); // reset leaves all at rest
        uint64_t start = skein_world_hash(s.world);
        for (int n = 0; n < 20; n++) steps(s.world, 1, dt), first[n] = skein_world_hash(s.world);
        skein_statistics before = statistics_of(s.world);
        assert_true(before.steps == 20 && before.substeps == 400 && before.kinetic_energy > 0);
        assert_near(before.time, 20 * dt, 1e-12);
        OK(s.world, skein_world_reset(s.world));
        skein_statistics after = statistics_of(s.world);
        assert_true(after.steps == 0 && after.substeps == 0 && after.time == 0 && after.kinetic_energy == 0);
        assert_true(skein_world_time(s.world) == 0 && skein_world_hash(s.world) == start);
        for (int n = 0; n < 20; n++) steps(s.world, 1, dt), assert_true(skein_world_hash(s.world) == first[n]);
        // and the same in another world
        scene other = make_scene(NULL);
        OK(other.world, skein_method_set(other.world, method_names[m], SKEIN_SETTINGS(SKEIN_REAL("substeps", 20))));
        throw_particle(other.world, 49, 0, 0, 0);
        for (int n = 0; n < 20; n++) steps(other.world, 1, dt), assert_true(skein_world_hash(other.world) == first[n]);
        skein_world_destroy(other.world);
        skein_world_destroy(s.world);
    }
}

static void views_and_copies_agree(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    steps(s.world, 15, dt);
    size_t count = skein_particle_count(s.world);
    assert_int_equal(count, 51);
    double x[51 * 3], v[51 * 3], part[6];
    OK(s.world, skein_positions_copy(s.world, 0, count, x));
    OK(s.world, skein_velocities_copy(s.world, 0, count, v));
    skein_view xs = skein_position_view(s.world), vs = skein_velocity_view(s.world);
    assert_true(xs.count == count && vs.count == count);
    double energy = 0, momentum = 0;
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < 3; k++) {
            assert_true((double)xs.xyzw[4 * xs.slot_of[i] + k] == x[3 * i + k]);
            assert_true((double)vs.xyzw[4 * vs.slot_of[i] + k] == v[3 * i + k]);
        }
        double w = (double)xs.xyzw[4 * xs.slot_of[i] + 3], mass = (double)vs.xyzw[4 * vs.slot_of[i] + 3];
        assert_true(mass > 0);
        if (i == 0 || i == 6) assert_true(w == 0);
        else assert_near(w * mass, 1, 2 * EPSILON);
        if (w > 0)
            energy += 0.5 * mass * (v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2]);
        if (w > 0) momentum += mass * v[3 * i + 1];
    }
    skein_statistics st = statistics_of(s.world);
    assert_share(st.kinetic_energy, energy, 1e-9);
    assert_share(st.momentum[1], momentum, 1e-9);
    assert_true(st.particles == 51 && st.pinned_particles == 2 && st.nonfinite == 0);
    // pinned particles have no share in energy and momentum, whatever velocity they were given; the hash sees all
    throw_particle(s.world, 0, 100, 100, 100);
    skein_statistics thrown = statistics_of(s.world);
    assert_true(thrown.kinetic_energy == st.kinetic_energy && thrown.momentum[1] == st.momentum[1]);
    assert_true(thrown.state_hash != st.state_hash);
    OK(s.world, skein_positions_copy(s.world, 49, 2, part));
    assert_memory_equal(part, x + 3 * 49, sizeof part);
    OK(s.world, skein_positions_copy(s.world, 51, 0, part)); // nothing, from the very end
    FAILS(s.world, SKEIN_ERROR_VALUE, "the world has 51", skein_positions_copy(s.world, 50, 2, part));
    FAILS(s.world, SKEIN_ERROR_VALUE, "the world has 51", skein_positions_copy(s.world, 52, 0, part));
    FAILS(s.world, SKEIN_ERROR_VALUE, "the world has 51", skein_velocities_copy(s.world, SIZE_MAX, 2, part));
    FAILS(s.world, SKEIN_ERROR_VALUE, "the world has 51", skein_positions_built(s.world, 50, 2, part));
    double built[51 * 3];
    OK(s.world, skein_positions_built(s.world, 0, count, built));
    assert_memory_not_equal(built, x, sizeof built);
    OK(s.world, skein_world_reset(s.world));
    OK(s.world, skein_positions_copy(s.world, 0, count, x));
    assert_memory_equal(built, x, sizeof built);
    skein_world_destroy(s.world);
}

static void positions_can_be_set_and_held(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 4);
        add_gravity(world);
        add_particle(world, 2, 0, 0, 0);
        add_particle(world, 0, 1, 0, 0);
        place_particle(world, 0, 0, 5, 0);
        throw_particle(world, 0, 1, 0, 0);
        steps(world, 9, dt);
        assert_near(position_of(world, 0).x, 0.1, 1e-6);
        // held: it stays where it is, at rest; let go, it falls with its own mass
        OK(world, skein_particle_pin(world, 0, true));
        vec3 there = position_of(world, 0);
        steps(world, 9, dt);
        assert_under(length3(minus(position_of(world, 0), there)), 0);
        assert_under(length3(velocity_of(world, 0)), 0);
        assert_int_equal(statistics_of(world).pinned_particles, 2);
        OK(world, skein_particle_pin(world, 0, false));
        OK(world, skein_particle_pin(world, 1, false)); // built as held: it has no mass to go with
        steps(world, 90, dt);
        assert_share(velocity_of(world, 0).y, -9.81, 1e-4);
        assert_under(length3(minus(position_of(world, 1), (vec3){1, 0, 0})), 0);
        assert_share(statistics_of(world).momentum[1], -2 * 9.81, 1e-4);
        assert_int_equal(statistics_of(world).pinned_particles, 1);
        // a held one can still be placed
        OK(world, skein_particle_pin(world, 0, true));
        place_particle(world, 0, 7, 8, 9);
        steps(world, 1, dt);
        assert_under(length3(minus(position_of(world, 0), (vec3){7, 8, 9})), 0);
        FAILS(world, SKEIN_ERROR_VALUE, "the world has 2", skein_particle_pin(world, 2, true));
        skein_world_destroy(world);
    }
}

static void numbers_that_are_none_are_refused(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    add_particle(world, 1, 0, 0, 0);
    add_particle(world, 1, 1, 2, 3);
    uint64_t before = skein_world_hash(world);
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e30};
    for (size_t i = 0; i < COUNT(bad); i++)
        for (int k = 0; k < 6; k++) {
            double xyz[6] = {9, 9, 9, 9, 9, 9};
            xyz[k] = bad[i];
            FAILS(world, SKEIN_ERROR_VALUE, k < 3 ? "particle 0" : "particle 1", skein_positions_set(world, 0, 2, xyz));
            FAILS(world, SKEIN_ERROR_VALUE, "finite", skein_velocities_set(world, 0, 2, xyz));
            FAILS(world, SKEIN_ERROR_VALUE, "finite",
                  skein_particles_add(world, 2, xyz, NULL, (const double[]){1, 1}, NULL));
            FAILS(world, SKEIN_ERROR_VALUE, "finite",
                  skein_particles_add(world, 2, (const double[6]){0}, xyz, (const double[]){1, 1}, NULL));
            if (k) continue;
            FAILS(world, SKEIN_ERROR_VALUE, "mass",
                  skein_particles_add(world, 1, (const double[3]){0}, NULL, &bad[i], NULL));
        }
    FAILS(world, SKEIN_ERROR_VALUE, "mass",
          skein_particles_add(world, 1, (const double[3]){0}, NULL, (const double[]){-1}, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "mass",
          skein_particles_add(world, 1, (const double[3]){0}, NULL, (const double[]){1e-30}, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "no particle 2",
          skein_constraint_add(world, "distance", (const uint32_t[]){0, 2}, 1, NULL, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "distance 1: particle 1 is named twice",
          skein_constraint_add(world, "distance", (const uint32_t[]){0, 1, 1, 1}, 2, NULL, NULL));
    assert_int_equal(skein_object_count(world, SKEIN_CONSTRAINT), 0);
    // not even in part
    assert_true(skein_particle_count(world) == 2 && skein_world_hash(world) == before);
    skein_world_destroy(world);
}

static void steps_have_a_length(void **state) {
    (void)state;
    static const double bad[] = {0, -dt, NAN, INFINITY, -INFINITY, 1.1e6};
    scene s = make_scene(NULL);
    uint64_t before = skein_world_hash(s.world);
    for (size_t i = 0; i < COUNT(bad); i++) {
        FAILS(s.world, SKEIN_ERROR_VALUE, "expected more than 0, at most 1e6", skein_world_step(s.world, bad[i]));
        FAILS(s.world, SKEIN_ERROR_VALUE, "expected more than 0, at most 1e6",
              skein_world_explain(s.world, bad[i], NULL, NULL));
    }
    static const double no_time[] = {-dt, NAN, INFINITY, 1e300};
    for (size_t i = 0; i < COUNT(no_time); i++)
        FAILS(s.world, SKEIN_ERROR_VALUE, "expected 0 to 1e15", skein_world_time_set(s.world, no_time[i]));
    assert_true(skein_world_hash(s.world) == before && skein_world_time(s.world) == 0);
    // steps of different lengths in turn: the plan follows
    steps(s.world, 1, dt), steps(s.world, 1, 2 * dt), steps(s.world, 1, dt / 2);
    assert_near(skein_world_time(s.world), 3.5 * dt, 1e-12);
    skein_world_destroy(s.world);
    // an empty world can be stepped, measured and reset
    skein_world *empty = new_world("symplectic_euler", 3);
    steps(empty, 2, dt);
    assert_true(statistics_of(empty).steps == 2 && statistics_of(empty).particles == 0);
    OK(empty, skein_world_reset(empty));
    skein_world_destroy(empty);
    skein_world_destroy(NULL);
}

static void blending_lies_between_the_last_two_steps(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    vec3 from = position_of(s.world, 49), to, at;
    OK(s.world, skein_positions_blend(s.world, 0.5, 49, 1, &at.x)); // before any step
    assert_under(length3(minus(at, from)), 0);
    steps(s.world, 5, dt);
    from = position_of(s.world, 49);
    steps(s.world, 1, dt);
    to = position_of(s.world, 49);
    assert_true(length3(minus(from, to)) > 1e-3);
    static const double blends[] = {0, 0.25, 0.5, 1};
    for (size_t i = 0; i < COUNT(blends); i++) {
        OK(s.world, skein_positions_blend(s.world, blends[i], 49, 1, &at.x));
        assert_near(at.y, from.y + blends[i] * (to.y - from.y), 1e-12);
        assert_near(at.x, from.x + blends[i] * (to.x - from.x), 1e-12);
    }
    // what was placed by hand did not travel, and reset leaves nothing to blend
    place_particle(s.world, 49, 3, 3, 3);
    OK(s.world, skein_positions_blend(s.world, 0.5, 49, 1, &at.x));
    assert_under(length3(minus(at, (vec3){3, 3, 3})), 0);
    OK(s.world, skein_world_reset(s.world));
    OK(s.world, skein_positions_blend(s.world, 0, 48, 1, &at.x));
    assert_under(length3(minus(at, position_of(s.world, 48))), 0);
    FAILS(s.world, SKEIN_ERROR_VALUE, "1 particle from 51 on: the world has 51",
          skein_positions_blend(s.world, 0, 51, 1, &at.x));
    // on beyond the two steps, but not without end
    OK(s.world, skein_positions_blend(s.world, 2, 48, 1, &at.x));
    static const double none[] = {NAN, INFINITY, -INFINITY};
    at = (vec3){7, 7, 7};
    for (size_t i = 0; i < COUNT(none); i++)
        FAILS(s.world, SKEIN_ERROR_VALUE, "expected a finite number",
              skein_positions_blend(s.world, none[i], 48, 1, &at.x));
    assert_true(at.x == 7 && at.y == 7 && at.z == 7);
    skein_world_destroy(s.world);
}

/* ---- The pacer ---------------------------------------------------------------------------------- */

static void the_pacer_makes_whole_steps(void **state) {
    (void)state;
    skein_pacer pacer = skein_default_pacer();
    assert_true(pacer.step == SKEIN_DEFAULT_STEP && pacer.step == 1.0 / 90);
    int made = 0;
    for (int frame = 0; frame < 600; frame++) {
        int now = skein_pacer_feed(&pacer, 1.0 / 60);
        assert_true(now == 1 || now == 2);
        assert_true(pacer.remainder >= 0 && pacer.remainder < pacer.step * (1 + 1e-9));
        double blend = skein_pacer_blend(&pacer);
        assert_true(blend >= 0 && blend <= 1);
        assert_near(blend, fmin(pacer.remainder / pacer.step, 1), 1e-12);
        made += now;
    }
    assert_in_range(made, 899, 901);
    assert_true(pacer.dropped == 0);

    // frames of whole steps: so many each, though 1/30 is not three times 1/90 in binary
    pacer = skein_default_pacer();
    for (int frame = 0; frame < 3000; frame++) assert_int_equal(skein_pacer_feed(&pacer, 1.0 / 30), 3);
    pacer.step = 0.1, pacer.remainder = 0;
    for (int frame = 0; frame < 3000; frame++) assert_int_equal(skein_pacer_feed(&pacer, 0.3), 3);

    // uneven frames: no time is lost or made up
    double fed = 0;
    uint64_t seed = 37;
    pacer = skein_default_pacer();
    made = 0;
    for (int frame = 0; frame < 1000; frame++) {
        double seconds = random_between(&seed, 0, 0.05);
        fed += seconds;
        made += skein_pacer_feed(&pacer, seconds);
    }
    assert_near(made * pacer.step + pacer.remainder, fed, 1e-9);

    // nonsense counts as nothing
    pacer = skein_default_pacer();
    static const double nonsense[] = {NAN, -1, -INFINITY, INFINITY, 0};
    for (size_t i = 0; i < COUNT(nonsense); i++) assert_int_equal(skein_pacer_feed(&pacer, nonsense[i]), 0);
    assert_true(pacer.remainder == 0 && pacer.dropped == 0);

    // a long pause: at most so many steps, the rest is dropped and counted, the remainder kept
    pacer = skein_default_pacer();
    assert_int_equal(skein_pacer_feed(&pacer, 1.0 + pacer.step / 4), 8);
    assert_near(pacer.dropped, 1 - 8.0 / 90, 1e-9);
    assert_near(pacer.remainder, pacer.step / 4, 1e-9);
    assert_int_equal(skein_pacer_feed(&pacer, 1.0 / 90), 1);
    pacer.most_steps = 3;
    assert_int_equal(skein_pacer_feed(&pacer, 3.0 / 90), 3);
    assert_int_equal(skein_pacer_feed(&pacer, 4.0 / 90), 3);
    assert_near(pacer.dropped, 1 - 7.0 / 90, 1e-9);
}

/* ---- Methods ------------------------------------------------------------------------------------ */

static void rigid_springs_need_a_position_method(void **state) {
    (void)state;
    scene s = make_scene(NULL);
    OK(s.world, skein_set(s.world, s.spring, "stiffness", skein_number(INFINITY)));
    steps(s.world, 1, dt);
    OK(s.world, skein_method_set(s.world, "symplectic_euler", NULL));
    uint64_t before = skein_world_hash(s.world);
    FAILS(s.world, SKEIN_ERROR_VALUE, "'rod' is rigid", skein_world_step(s.world, dt));
    FAILS(s.world, SKEIN_ERROR_VALUE, "symplectic_euler needs finite stiffness",
          skein_world_explain(s.world, dt, NULL, NULL));
    assert_string_equal(skein_world_error(s.world)->where, "method.type");
    assert_true(skein_world_hash(s.world) == before);
    // switched off, or soft again, it is no obstacle; nor after a change of the method
    OK(s.world, skein_set(s.world, s.spring, "enabled", skein_number(0)));
    steps(s.world, 1, dt);
    OK(s.world, skein_set(s.world, s.spring, "enabled", skein_number(1)));
    OK(s.world, skein_method_set(s.world, "xpbd", NULL));
    steps(s.world, 1, dt);
    OK(s.world, skein_method_set(s.world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 40))));
    OK(s.world, skein_set(s.world, s.spring, "stiffness", skein_number(10)));
    steps(s.world, 1, dt);
    skein_world_destroy(s.world);
}

/* ---- Callbacks and several worlds ----------------------------------------------------------------- */

typedef struct ear {
    int messages;
    char last[256];
} ear;

static void hear(void *user, skein_log_level level, const char *message) {
    ear *e = user;
    assert_int_equal(level, SKEIN_LOG_WARNING);
    e->messages++;
    snprintf(e->last, sizeof e->last, "%s", message);
}

static void run_in_turn(void *user, void (*task)(void *data, int index), void *data, int task_count) {
    *(int *)user += 1;
    for (int i = 0; i < task_count; i++) task(data, i);
}

static void callbacks_are_called_with_their_user(void **state) {
    (void)state;
    ear e = {0, ""};
    int runs = 0;
    skein_world_desc desc = skein_default_world_desc();
    desc.log = hear, desc.log_user = &e;
    desc.run_tasks = run_in_turn, desc.tasks_user = &runs;
    desc.thread_count = 3;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    static const double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5};
    const skein_mesh mesh = {positions, 4, (const uint32_t[]){3}, 1, (const uint32_t[]){0, 1, 2}, 3};
    OK(world, skein_body_add(world, "cloth", &mesh, NULL, NULL));
    assert_int_equal(e.messages, 1);
    assert_non_null(strstr(e.last, "1 vertex is of no face, such as 3"));
    steps(world, 1, dt);
    assert_int_equal(runs, 0); // too small to be worth a thread
    OK(world, skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 70, 70)), NULL));
    steps(world, 1, dt);
    assert_true(runs > 0);
    skein_world_destroy(world);

    // half an allocator is none
    skein_error error;
    desc = skein_default_world_desc();
    desc.release = (void (*)(void *, void *, size_t))abort;
    assert_null(skein_world_create(&desc, &error));
    assert_int_equal(error.status, SKEIN_ERROR_VALUE);
    assert_null(skein_world_create(&desc, NULL));
}

/* Worlds know nothing of each other: stepping them in turn is as stepping each alone. */
static void two_worlds_do_not_touch(void **state) {
    (void)state;
    scene alone = make_scene(NULL);
    steps(alone.world, 20, dt);
    scene a = make_scene(NULL), b = make_scene(NULL);
    OK(b.world, skein_set(b.world, b.gravity, "acceleration", skein_vector(0, 3, 0)));
    for (int n = 0; n < 20; n++) steps(a.world, 1, dt), steps(b.world, 1, dt);
    assert_true(skein_world_hash(a.world) == skein_world_hash(alone.world));
    assert_true(skein_world_hash(b.world) != skein_world_hash(alone.world));
    skein_world_destroy(b.world);
    steps(a.world, 1, dt), steps(alone.world, 1, dt);
    assert_true(skein_world_hash(a.world) == skein_world_hash(alone.world));
    skein_world_destroy(a.world);
    skein_world_destroy(alone.world);
}

/* A second body moves as it would alone, and has its own particles, surface and stiffness. */
static void two_bodies_in_one_world(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        double place[3][3 * 30];
        for (int world_kind = 0; world_kind < 3; world_kind++) { // the first alone, the second alone, both
            skein_world *world = new_world(method_names[m], 20);
            add_gravity(world);
            OK(world, skein_force_add(world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 2, 1, 3)), NULL));
            skein_handle first, second;
            if (world_kind != 1)
                OK(world, skein_body_add(world, "cloth", NULL,
                                         SKEIN_SETTINGS(SKEIN_TEXT("name", "first"), SKEIN_PAIR("grid", 5, 6),
                                                        SKEIN_TEXT("pins", "top corners")),
                                         &first));
            if (world_kind != 0)
                OK(world,
                   skein_body_add(world, "cloth", NULL,
                                  SKEIN_SETTINGS(SKEIN_TEXT("name", "second"), SKEIN_PAIR("grid", 6, 5),
                                                 SKEIN_TEXT("pins", "left edge"), SKEIN_REAL("stretch.stiffness", 100)),
                                  &second));
            if (world_kind == 2) {
                skein_surface surface;
                OK(world, skein_body_surface(world, second, &surface));
                assert_true(surface.first_particle == 30 && surface.particle_count == 30 && surface.vertex_count == 30);
                assert_true(surface.particle_of_vertex[0] == 30 && surface.face_vertices[0] == 0);
                assert_true(surface.grid_rows == 6 && surface.grid_columns == 5);
                assert_true(number_at(world, "bodies.second.stretch.stiffness") == 100);
                assert_true(number_at(world, "bodies.1.stretch.stiffness") == 100);
                assert_true(number_at(world, "bodies.first.stretch.stiffness") == 2e4);
            }
            steps(world, 20, dt);
            if (world_kind < 2) {
                OK(world, skein_positions_copy(world, 0, 30, place[world_kind]));
            } else {
                double both[2 * 3 * 30];
                OK(world, skein_positions_copy(world, 0, 60, both));
                assert_memory_equal(both, place[0], sizeof place[0]);
                assert_memory_equal(both + 90, place[1], sizeof place[1]);
            }
            skein_world_destroy(world);
        }
    }
}

static void values_are_printed_as_scenes_show_them(void **state) {
    (void)state;
    const skein_kind *sphere = skein_kind_find(SKEIN_COLLIDER, "sphere", NULL);
    char text[64];
    skein_value value = skein_vector(1, -2.5, 1e-3);
    skein_value_text(skein_field_find(sphere, "centre", NULL), &value, text, sizeof text);
    assert_string_equal(text, "1 -2.5 0.001");
    value = skein_number(1);
    skein_value_text(skein_field_find(sphere, "enabled", NULL), &value, text, sizeof text);
    assert_string_equal(text, "true");
    value = skein_text("ball");
    assert_int_equal(skein_value_text(skein_field_find(sphere, "name", NULL), &value, text, sizeof text), 4);
    assert_string_equal(text, "ball");
    // as snprintf: the length that it needs, whatever room there is
    value = skein_vector(1, -2.5, 1e-3);
    assert_int_equal(skein_value_text(skein_field_find(sphere, "centre", NULL), &value, text, 4), 12);
    assert_string_equal(text, "1 -");
    assert_string_equal(skein_status_text(SKEIN_ERROR_MEMORY), "out of memory");
    assert_string_equal(skein_category_text(SKEIN_COLLIDER), "collider");
}

/* The version as numbers and as text, in the header, the library and the build. */
static void the_version_is_one(void **state) {
    (void)state;
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", SKEIN_VERSION_MAJOR, SKEIN_VERSION_MINOR, SKEIN_VERSION_PATCH);
    assert_string_equal(text, SKEIN_VERSION);
    assert_string_equal(text, SKEIN_PROJECT_VERSION);
    int version = skein_version();
    assert_int_equal(version, SKEIN_VERSION_NUMBER);
    assert_int_equal(version / 1000000, SKEIN_VERSION_MAJOR);
    assert_int_equal(version / 1000 % 1000, SKEIN_VERSION_MINOR);
    assert_int_equal(version % 1000, SKEIN_VERSION_PATCH);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(handles_go_stale),
        cmocka_unit_test(handles_know_their_world),
        cmocka_unit_test(objects_carry_a_pointer_of_the_users),
        cmocka_unit_test(rules_come_and_go_between_steps),
        cmocka_unit_test(handles_have_a_category),
        cmocka_unit_test(fields_by_handle_and_path),
        cmocka_unit_test(wrong_names_suggest_the_nearest),
        cmocka_unit_test(values_out_of_range_are_refused),
        cmocka_unit_test(choices_are_whole_and_within_the_list),
        cmocka_unit_test(what_shaped_a_body_cannot_change),
        cmocka_unit_test(live_fields_are_as_if_built_so),
        cmocka_unit_test(disabled_is_as_if_absent),
        cmocka_unit_test(a_disabled_cloth_stays),
        cmocka_unit_test(reset_repeats_a_fresh_run),
        cmocka_unit_test(views_and_copies_agree),
        cmocka_unit_test(positions_can_be_set_and_held),
        cmocka_unit_test(numbers_that_are_none_are_refused),
        cmocka_unit_test(steps_have_a_length),
        cmocka_unit_test(blending_lies_between_the_last_two_steps),
        cmocka_unit_test(the_pacer_makes_whole_steps),
        cmocka_unit_test(rigid_springs_need_a_position_method),
        cmocka_unit_test(callbacks_are_called_with_their_user),
        cmocka_unit_test(two_worlds_do_not_touch),
        cmocka_unit_test(two_bodies_in_one_world),
        cmocka_unit_test(values_are_printed_as_scenes_show_them),
        cmocka_unit_test(the_version_is_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
