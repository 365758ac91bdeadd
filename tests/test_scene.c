/* Tests of the scene reader with good scenes, read in this process: they become the worlds that they
 * describe. */
#include "test_command.h"

#include <math.h>

#include "io/exporters.h"
#include "io/scene.h"

/* ---- Good scenes, read in this process ------------------------------------------------------------- */

static void print_fault(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

static const skein_kind *exporters[3];

/* Reads JSON that has ' in the place of ". */
static io_scene *read_scene(const char *text, const char *const *sets) {
    io_faults faults = {print_fault, NULL, 0, NULL};
    exporters[0] = io_exporter_at(0), exporters[1] = io_exporter_at(1);
    char *copy = strdup(text);
    for (char *at = copy; (at = strchr(at, '\'')) != NULL;) *at = '"';
    io_scene *scene =
        io_scene_read_text(copy, strlen(copy), "tests/corpus/scene/memory.json", sets, exporters, &faults);
    free(copy);
    assert_non_null(scene);
    assert_int_equal(faults.count, 0);
    return scene;
}

static skein_world *build_scene(const char *text, const char *const *sets) {
    io_faults faults = {print_fault, NULL, 0, NULL};
    io_scene *scene = read_scene(text, sets);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    assert_non_null(world);
    assert_int_equal(faults.count, 0);
    io_scene_free(scene); // the world stands on its own
    return world;
}

static skein_statistics statistics_of(skein_world *world) {
    skein_statistics s;
    assert_int_equal(skein_world_statistics(world, &s), SKEIN_OK);
    return s;
}

static double number_at(const skein_world *world, const char *path) {
    skein_value value;
    assert_int_equal(skein_get_path(world, path, &value), SKEIN_OK);
    assert_int_equal(value.count, 1);
    return value.number[0];
}

static void the_top_has_defaults_and_values(void **state) {
    (void)state;
    io_scene *scene = read_scene("{}", NULL);
    const io_scene_settings *s = io_scene_get(scene);
    assert_int_equal(s->version, 1);
    assert_int_equal(s->frames, 240);
    assert_int_equal(s->threads, 0);
    assert_string_equal(s->name, "");
    assert_true(s->fps == 60 && s->step == 1.0 / 60);
    double dt;
    assert_int_equal(io_scene_steps_per_frame(s, &dt), 1);
    assert_true(dt == 1.0 / 60);
    io_export exports[4];
    assert_int_equal(io_scene_exports(scene, exports, 4), 2);
    assert_ptr_equal(exports[0].kind, io_exporter_at(0));
    assert_int_equal(((const io_clip_params *)exports[0].params)->normals, SKEIN_NORMALS_AREA);
    assert_int_equal(((const io_clip_params *)exports[1].params)->every, 1);
    io_scene_free(scene);

    // behind a mark, in any order, with a step that does not divide the frame
    scene =
        read_scene("\xef\xbb\xbf{ 'output': [ { 'normals': 'angle', 'type': 'obj' } ], 'threads': 2, 'frames': 7e0,\n"
                   "  'fps': 24, 'step': 0.01, 'name': 'caf\u00e9', 'description': '', 'skein': 1 }",
                   NULL);
    s = io_scene_get(scene);
    assert_string_equal(s->name, "caf\u00e9");
    assert_int_equal(s->frames, 7);
    assert_int_equal(s->threads, 2);
    assert_int_equal(io_scene_steps_per_frame(s, &dt), 5);
    assert_true(fabs(dt * 5 * 24 - 1) < 1e-15);
    assert_int_equal(io_scene_exports(scene, exports, 4), 1);
    assert_int_equal(((const io_clip_params *)exports[0].params)->normals, SKEIN_NORMALS_ANGLE);
    io_scene_free(scene);

    scene = read_scene("{ 'output': [] }", NULL);
    assert_int_equal(io_scene_exports(scene, exports, 4), 0);
    io_scene_free(scene);
}

static void every_type_of_field_arrives(void **state) {
    (void)state;
    skein_world *world = build_scene(
        "{ 'method': { 'type': 'symplectic_euler', 'substeps': 7 },\n"
        "  'bodies': [ { 'type': 'cloth', 'name': 'sheet', 'grid': [3, 5], 'size': [2, 1.5], 'position': [1, 2, 3],\n"
        "    'visible': false, 'stretch': { 'stiffness': 3e3, 'limit': 'infinite' }, 'bend.by': 'springs', 'bend.stiffness': 5,\n"
        "    'pins': [-1, 0] } ],\n"
        "  'forces': [ { 'type': 'gravity', 'acceleration': [0, -1.5, 0], 'name': 'weak' } ],\n"
        "  'colliders': [ { 'type': 'sphere', 'radius': 0.25, 'motion': { 'spin': 4 } } ] }",
        NULL);
    skein_value value;
    assert_true(number_at(world, "method.substeps") == 7);
    assert_true(number_at(world, "bodies.sheet.visible") == 0);
    assert_true(number_at(world, "bodies.0.enabled") == 1);
    assert_true(number_at(world, "bodies.0.stretch.stiffness") == 3e3);
    assert_true(isinf(number_at(world, "bodies.0.stretch.limit")));
    assert_true(number_at(world, "bodies.0.bend.stiffness") == 5);
    assert_true(number_at(world, "colliders.0.motion.spin") == 4);
    assert_true(number_at(world, "colliders.0.radius") == 0.25);
    assert_int_equal(skein_get_path(world, "forces.weak.acceleration", &value), SKEIN_OK);
    assert_true(value.count == 3 && value.number[0] == 0 && value.number[1] == -1.5 && value.number[2] == 0);
    double corner[3];
    assert_int_equal(skein_positions_copy(world, 0, 1, corner), SKEIN_OK);
    assert_true(corner[0] == 0 && corner[1] == 2 && corner[2] == 2.25);
    skein_statistics s = statistics_of(world);
    assert_int_equal(s.particles, 15);
    assert_int_equal(s.pinned_particles, 2);
    skein_world_destroy(world);
}

/* What is pinned can be said in several ways. */
static void pins_have_short_forms(void **state) {
    (void)state;
    static const struct {
        const char *pins;
        size_t held;
    } forms[] = {
        {"'top corners'", 2},
        {"'top edge, bottom corners'", 5},
        {"[0, 1, 2]", 3},
        {"4", 1},
        {"[ 'corners', 4 ]", 5},
        {"[ 4, 'corners', 5 ]", 6},
        {"{ 'box': [-0.5, -0.1, -0.5, 0.5, 0.1, -0.5] }", 3},
        {"{ 'sphere': [0, 0, 0, 0.51] }", 5},
        {"[ 0, { 'sphere': [0, 0, 0, 0.1] }, 8, 'bottom edge' ]", 5},
        {"[ { 'box': [0.5, 0, 0.5, 0.5, 0, 0.5] }, { 'sphere': [0.1, 0, 0, 0.11] } ]", 2},
        {"''", 0},
        {"[]", 0},
    };
    for (size_t i = 0; i < COUNT(forms); i++) {
        char text[256];
        snprintf(text, sizeof text, "{ 'bodies': [ { 'type': 'cloth', 'grid': [3, 3], 'pins': %s } ] }", forms[i].pins);
        skein_world *world = build_scene(text, NULL);
        if (statistics_of(world).pinned_particles != forms[i].held)
            fail_msg("%s holds %zu", forms[i].pins, statistics_of(world).pinned_particles);
        skein_world_destroy(world);
    }
}

static void meshes_are_found_beside_the_scene(void **state) {
    (void)state;
    skein_world *world =
        build_scene("{ 'bodies': [ { 'type': 'cloth', 'mesh': 'tetrahedron.obj', 'scale': 2 } ] }", NULL);
    skein_statistics s = statistics_of(world);
    assert_int_equal(s.particles, 4);
    double tip[3];
    assert_int_equal(skein_positions_copy(world, 3, 1, tip), SKEIN_OK);
    assert_true(tip[2] == 2);
    skein_world_destroy(world);
}

static void sets_change_the_scene(void **state) {
    (void)state;
    static const char scene[] =
        "{ 'bodies': [ { 'type': 'cloth', 'grid': [3, 3] }, { 'type': 'cloth', 'name': 'b', 'grid': [3, 3] } ],\n"
        "  'colliders': [ { 'type': 'sphere', 'name': 'ball' }, { 'type': 'plane' } ] }";
    static const char *const sets[] = {"bodies.0.stretch.stiffness=7",
                                       "bodies.b.stretch.stiffness=8",
                                       "bodies.b.pins=top edge",
                                       "colliders.ball.centre=[1,2,3]",
                                       "colliders.1={\"type\": \"sphere\"}",
                                       "method.type=symplectic_euler",
                                       "method.substeps=3",
                                       "bodies.b.stretch.stiffness=9",
                                       "forces=[{\"type\": \"gravity\"}]",
                                       "bodies.0.name=a=b",
                                       "frames=0",
                                       NULL};
    skein_world *world = build_scene(scene, sets);
    assert_true(number_at(world, "bodies.0.stretch.stiffness") == 7);
    assert_true(number_at(world, "bodies.1.stretch.stiffness") == 9);
    assert_true(number_at(world, "bodies.a=b.enabled") == 1);
    assert_true(number_at(world, "method.substeps") == 3);
    assert_true(number_at(world, "colliders.1.radius") == 0.5);
    assert_int_equal(statistics_of(world).pinned_particles, 3);
    assert_int_equal(skein_object_count(world, SKEIN_FORCE), 1);
    skein_value value;
    assert_int_equal(skein_get_path(world, "colliders.ball.centre", &value), SKEIN_OK);
    assert_true(value.number[0] == 1 && value.number[1] == 2 && value.number[2] == 3);
    assert_string_equal(skein_object_kind(world, skein_object_at(world, SKEIN_METHOD, 0))->name, "symplectic_euler");
    skein_world_destroy(world);
}

/* Groups are a text or a list of names, where rules have either, too; and can be set from outside. */
static void groups_are_texts_or_lists(void **state) {
    (void)state;
    static const char scene[] =
        "{ 'bodies': [ { 'type': 'cloth', 'name': 'a', 'grid': [3, 3], 'groups': ['clothes', 'soft'] },\n"
        "  { 'type': 'cloth', 'name': 'b', 'grid': [3, 3], 'groups': 'soft', 'pins': 'all' } ],\n"
        "  'forces': [ { 'type': 'gravity', 'on': ['clothes', 'loose'] }, { 'type': 'contact', 'ignore': 'soft:clothes' } ],\n"
        "  'motions': [ { 'type': 'translate', 'on': ['loose', 'clothes'] } ] }";
    skein_world *world = build_scene(scene, (const char *const[]){"bodies.b.groups=[\"loose\"]", NULL});
    skein_value value;
    assert_int_equal(skein_get_path(world, "bodies.a.groups", &value), SKEIN_OK);
    assert_string_equal(value.text, "clothes, soft");
    assert_int_equal(skein_get_path(world, "bodies.b.groups", &value), SKEIN_OK);
    assert_string_equal(value.text, "loose");
    assert_int_equal(skein_get_path(world, "motions.0.on", &value), SKEIN_OK);
    assert_string_equal(value.text, "loose, clothes");
    assert_int_equal(skein_world_step(world, 0.01), SKEIN_OK);
    skein_world_destroy(world);
}

static void collect_log(void *user, skein_log_level level, const char *message) {
    (void)level;
    char *all = user;
    strcat(strcat(all, message), "\n");
}

/* Another kind of method keeps what it knows, drops what it does not, and says so. */
static void a_method_changes_its_type_alone(void **state) {
    (void)state;
    static const char scene[] = "{ 'method': { 'type': 'xpbd', 'substeps': 7, 'iterations': 3 },\n"
                                "  'bodies': [ { 'type': 'cloth', 'grid': [3, 3] } ] }";
    for (size_t i = 0; skein_kind_at(SKEIN_METHOD, i); i++) {
        const char *name = skein_kind_at(SKEIN_METHOD, i)->name;
        bool knows = skein_field_find(skein_kind_at(SKEIN_METHOD, i), "iterations", NULL) != NULL;
        char set[64], log[256] = "", note[128] = "";
        snprintf(set, sizeof set, "method.type=%s", name);
        const char *const sets[] = {set, NULL};
        io_faults faults = {print_fault, NULL, 0, NULL};
        io_scene *read = read_scene(scene, sets);
        skein_world_desc desc = skein_default_world_desc();
        desc.log = collect_log, desc.log_user = log;
        skein_world *world = io_scene_build(read, &desc, &faults);
        io_scene_free(read);
        assert_non_null(world);
        assert_string_equal(skein_object_kind(world, skein_object_at(world, SKEIN_METHOD, 0))->name, name);
        assert_true(number_at(world, "method.substeps") == 7);
        if (knows) assert_true(number_at(world, "method.iterations") == 3);
        else snprintf(note, sizeof note, "method.iterations is left out: %s has no such field\n", name);
        assert_string_equal(log, note);
        skein_world_destroy(world);
    }
    // what is asked for after the change is meant for the new type: a fault if it does not know it
    const char *const sets[] = {"method.type=leapfrog", "method.iterations=3", NULL};
    io_faults quiet = {NULL, NULL, 0, NULL};
    io_scene *read = read_scene(scene, sets);
    assert_null(io_scene_build(read, NULL, &quiet));
    assert_int_equal(quiet.count, 1);
    io_scene_free(read);
}

/* Numbers as `skein list` prints them: with blanks or commas, in brackets or none, with their unit or none. */
static void sets_take_numbers_as_they_are_listed(void **state) {
    (void)state;
    static const char scene[] = "{ 'bodies': [ { 'type': 'cloth', 'name': 'sheet', 'grid': [3, 3] } ],\n"
                                "  'forces': [ { 'type': 'gravity' } ] }";
    static const struct {
        const char *set, *path;
        skein_value value;
    } cases[] = {
        {"forces.0.acceleration=1 -2.5 3", "forces.0.acceleration", {3, {1, -2.5, 3}, NULL}},
        {"forces.0.acceleration=0 -9.81 0 m/s2", "forces.0.acceleration", {3, {0, -9.81, 0}, NULL}},
        {"forces.0.acceleration=(1, 2, 3)", "forces.0.acceleration", {3, {1, 2, 3}, NULL}},
        {"forces.0.acceleration=[1e0, 2, 3]", "forces.0.acceleration", {3, {1, 2, 3}, NULL}},
        {"bodies.sheet.size=2 0.5", "bodies.0.size", {2, {2, 0.5}, NULL}},
        {"bodies.0.size=2, 0.5 m", "bodies.0.size", {2, {2, 0.5}, NULL}},
        {"bodies.0.grid=4 6", "bodies.0.grid", {2, {4, 6}, NULL}},
        {"bodies.0.density=0.3 kg/m2", "bodies.0.density", {1, {0.3}, NULL}},
        {"bodies.0.stretch.stiffness=2e4 N/m", "bodies.0.stretch.stiffness", {1, {2e4}, NULL}},
        {"bodies.0.stretch.limit=infinite", "bodies.0.stretch.limit", {1, {INFINITY}, NULL}},
        {"bodies.0.stretch.stiffness=infinite N/m", "bodies.0.stretch.stiffness", {1, {INFINITY}, NULL}},
        {"method.substeps=20", "method.substeps", {1, {20}, NULL}}, // the world's own method, as the scene has none
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *const sets[] = {cases[i].set, NULL};
        skein_world *world = build_scene(scene, sets);
        skein_value value;
        assert_int_equal(skein_get_path(world, cases[i].path, &value), SKEIN_OK);
        assert_int_equal(value.count, cases[i].value.count);
        for (int k = 0; k < value.count; k++) assert_true(value.number[k] == cases[i].value.number[k]);
        skein_world_destroy(world);
    }
    // every field of numbers takes its own default as it is printed
    const skein_kind *kind = skein_kind_find(SKEIN_BODY, "cloth", NULL);
    for (size_t f = 0; f < kind->field_count; f++) {
        const skein_field *field = &kind->fields[f];
        if (field->type == SKEIN_FIELD_TEXT || !strcmp(field->name, "grid")) continue;
        char set[200], text[100];
        skein_world *world = build_scene(scene, NULL);
        skein_value value;
        skein_get(world, skein_object_at(world, SKEIN_BODY, 0), field->name, &value);
        skein_value_text(field, &value, text, sizeof text);
        skein_world_destroy(world);
        snprintf(set, sizeof set, "bodies.0.%s=%s%s%s", field->name, text[0] == 'i' ? "infinite" : text,
                 field->unit[0] ? " " : "", field->unit);
        const char *const sets[] = {set, NULL};
        skein_world_destroy(build_scene(scene, sets));
    }
    // what is no number stays a text, and so does a unit of something else
    static const char *const bad[] = {"bodies.0.size=2 0.5 kg", "bodies.0.size=2",      "bodies.0.size=2 3 4",
                                      "bodies.0.size=(2 3",     "bodies.0.density=1 2", "forces.0.acceleration=1 2"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const char *const sets[] = {bad[i], NULL};
        io_faults quiet = {NULL, NULL, 0, NULL};
        io_scene *read = read_scene(scene, sets);
        assert_null(io_scene_build(read, NULL, &quiet));
        assert_int_equal(quiet.count, 1);
        io_scene_free(read);
    }
}

/* ---- Constraints between particles that bodies made -------------------------------------------------- */

/* Three patches of cloth, each of 4 particles, threaded on a rope: 0-3 are held, 4-7 and 8-11 hang by it. */
#define PATCH(name_, y_, pins_)                                                                                    \
    "    { 'type': 'cloth', 'name': '" name_ "', 'grid': [2, 2], 'size': [0.1, 0.1], 'position': [0, " y_ ", 0], " \
    "'pins': '" pins_ "' }"
#define PATCHES PATCH("hook", "2", "all") ",\n" PATCH("bead", "1.5", "") ",\n" PATCH("bob", "1", "")
static const char rope[] = "{ 'method': { 'type': 'xpbd', 'substeps': 20 },\n"
                           "  'bodies': [\n" PATCHES " ],\n"
                           "  'constraints': [ { 'type': 'distance', 'name': 'rope', 'stiffness': 'infinite',\n"
                           "    'particles': [[0, 4], [1, 5], [2, 6], [3, 7], [4, 8], [5, 9], [6, 10], [7, 11]] } ],\n"
                           "  'forces': [ { 'type': 'gravity' }, { 'type': 'drag', 'rate': 2 } ] }";

/* How low the bob's first particle hangs after two seconds. */
static double bob_height(const char *const *sets, uint64_t *hash) {
    skein_world *world = build_scene(rope, sets);
    assert_int_equal(statistics_of(world).particles, 12);
    for (int i = 0; i < 180; i++) assert_int_equal(skein_world_step(world, SKEIN_DEFAULT_STEP), SKEIN_OK);
    double p[3];
    assert_int_equal(skein_positions_copy(world, 8, 1, p), SKEIN_OK);
    *hash = skein_world_hash(world);
    skein_world_destroy(world);
    return p[1];
}

static void constraints_tie_bodies_together(void **state) {
    (void)state;
    uint64_t tied, again, flat, loose, soft;
    double height = bob_height(NULL, &tied);
    assert_true(fabs(height - 1) < 0.005);
    // a flat list is the same; so is a second run
    bob_height(NULL, &again);
    bob_height((const char *const[]){"constraints.rope.particles=[0,4,1,5,2,6,3,7,4,8,5,9,6,10,7,11]", NULL}, &flat);
    assert_true(tied == again && tied == flat);
    // a soft rope gives way, a resting one lets go
    height = bob_height((const char *const[]){"constraints.rope.stiffness=1", NULL}, &soft);
    assert_true(height < 0.99 && height > 0.5);
    height = bob_height((const char *const[]){"constraints.0.enabled=false", NULL}, &loose);
    assert_true(height < -5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(the_top_has_defaults_and_values),
        TEST(every_type_of_field_arrives),
        TEST(pins_have_short_forms),
        TEST(meshes_are_found_beside_the_scene),
        TEST(sets_change_the_scene),
        TEST(constraints_tie_bodies_together),
        TEST(groups_are_texts_or_lists),
        TEST(a_method_changes_its_type_alone),
        TEST(sets_take_numbers_as_they_are_listed),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, NULL);
}
