/* Tests of the scene reader: every broken scene is refused with its own words, and good ones become the
 * worlds that they describe. The broken ones go through the command, as users send them. */
#include "test_command.h"

#include <math.h>

#include "io/exporters.h"
#include "io/normals.h"
#include "io/scene.h"

/* ---- Broken scenes ------------------------------------------------------------------------------- */

/* What is said of tests/bad/scenes/NAME.json, behind its path. */
static const struct {
    const char *name, *words;
} broken[] = {
    {"bodies_as_object", ": bodies: expected a list, [ { \"type\": ... }, ... ], not an object"},
    {"bodies_empty", ": bodies: the scene has no particles: add a body"},
    {"bodies_null", ": bodies: expected a list, [ { \"type\": ... }, ... ], not null"},
    {"body_as_text", ": bodies.0: expected an object, { \"type\": ... }, not the text 'cloth'"},
    {"bool_as_number", ": bodies.0.visible: expected true or false, not the number 1"},
    {"bool_as_text", ": bodies.0.enabled: expected true or false, not the text 'yes'"},
    {"byte_not_utf8", ":1:14: unable to decode byte 0xe9 near '\"caf'"},
    {"choice_as_number", ": output.0.normals: expected a word of area|uniform|angle, not the number 1"},
    {"choice_misspelt", ": output.0.normals: 'aera' is none of area|uniform|angle"},
    {"collider_null", ": colliders.1: expected an object, { \"type\": ... }, not null"},
    {"comma_at_the_end", ":1:52: unexpected token near ']'"},
    {"comment", ":1:1: invalid token near '/'"},
    {"constraint_negative", ": constraints.0.particles.1: expected the number of a particle, not the number -1"},
    {"constraint_of_one_and_three",
     ": constraints.0.particles.0: expected the numbers of 2 particles, not a list of 1"},
    {"constraint_of_three_particles",
     ": constraints.0.particles: expected the numbers of 2 particles for each constraint, [[0, 1], [1, 2]], say; "
     "not a list of 3"},
    {"constraint_out_of_range", ": constraints.0.particles: distance 1: there is no particle 9 (the world has 9)"},
    {"constraint_particle_too_large",
     ": constraints.0.particles.1: expected the number of a particle, not the number 4294967296"},
    {"constraint_without_particles",
     ": constraints.0.particles: expected the numbers of 2 particles for each constraint, [[0, 1], [1, 2]], say; "
     "it is missing"},
    {"control_character", ":2:12: control character 0x9 near '\"a'"},
    {"cut_off", ":3:48: '}' expected near end of file"},
    {"cut_off_in_text", ":1:17: premature end of input near '\"a flag'"},
    {"empty", ": the file is empty: expected a scene, { \"bodies\": [...], ... }"},
    {"field_in_a_group_and_with_a_dot",
     ": bodies.0.stretch.limit: is there twice, once in a group and once with a dot"},
    {"field_misspelt", ": frame: scene has no field 'frame'; did you mean 'frames'?"},
    {"field_of_body_misspelt", ": bodies.0.densty: cloth has no field 'densty'; did you mean 'density'?"},
    {"field_of_exporter_misspelt", ": output.0.evry: pc2 has no field 'evry'; did you mean 'every'?"},
    {"field_of_group_misspelt",
     ": bodies.0.stretch.stifness: cloth has no field 'stretch.stifness'; did you mean 'stretch.stiffness'?"},
    {"field_unknown", ": zzzzzzzzzzzzzzzzzzzz: scene has no field 'zzzzzzzzzzzzzzzzzzzz'"},
    {"field_with_line_break", ": fra?mes: scene has no field 'fra?mes'; did you mean 'frames'?"},
    {"forces_as_object", ": forces: expected a list, [ { \"type\": ... }, ... ], not an object"},
    {"fps_zero", ": fps: 0 is out of range: expected from 0.001 to 1e+06 1/s"},
    {"frames_negative", ": frames: -1 is out of range: expected from 0 to 1e+08"},
    {"grid_of_one_row", ": bodies.0.grid: a grid of 1 x 9 particles: expected 2 or more each way"},
    {"grid_one_by_one", ": bodies.0.grid: a grid of 1 x 1 particles: expected 2 or more each way"},
    {"group_as_number", ": bodies.0.stretch: expected an object with fields such as 'stiffness', not the number 10000"},
    {"group_misspelt", ": bodies.0.strech: cloth has no field 'strech'; did you mean 'stretch'?"},
    {"infinite_misspelt",
     ": bodies.0.stretch.stiffness: expected a number in N/m or \"infinite\", not the text 'infinit'"},
    {"int2_as_number", ": bodies.0.grid: expected two whole numbers, not the number 9"},
    {"int2_negative", ": bodies.0.grid: -3 is out of range: expected from 0 to 65536"},
    {"int2_of_three", ": bodies.0.grid: expected two whole numbers, not a list of 3"},
    {"int2_with_fraction", ": bodies.0.grid: expected two whole numbers, not 3.5"},
    {"int_as_list", ": frames: expected a whole number, not a list of 1"},
    {"int_as_text", ": frames: expected a whole number, not the text '5'"},
    {"int_too_large", ": frames: 1e+12 is out of range: expected from 0 to 1e+08"},
    {"int_with_fraction", ": frames: expected a whole number, not 2.5"},
    {"key_twice", ":3:10: duplicate object key near '\"frames\"'"},
    {"kind_as_number", ": bodies.0.type: expected the name of a body, not the number 3; `skein list` shows them"},
    {"kind_missing", ": bodies.0.type: expected the name of a body: it is missing; `skein list` shows them"},
    {"kind_of_body_misspelt", ": bodies.0.type: there is no body 'clothe'; did you mean 'cloth'?"},
    {"kind_of_body_unknown", ": bodies.0.type: there is no body 'jelly'"},
    {"kind_of_collider_misspelt", ": colliders.0.type: there is no collider 'spere'; did you mean 'sphere'?"},
    {"kind_of_constraint_misspelt",
     ": constraints.0.type: there is no constraint 'distanse'; did you mean 'distance'?"},
    {"kind_of_exporter_misspelt", ": output.1: there is no exporter 'pcc2'; did you mean 'pc2'?"},
    {"kind_of_force_misspelt", ": forces.0.type: there is no force 'gravty'; did you mean 'gravity'?"},
    {"kind_of_method_misspelt", ": method.type: there is no method 'xpdb'; did you mean 'xpbd'?"},
    {"list_at_the_top", ": expected an object: { \"bodies\": [...], ... }, not a list of 1"},
    {"mesh_and_grid", ": bodies.0.grid: a cloth has a grid or a mesh, not both"},
    {"mesh_as_null",
     ": bodies.0.mesh: expected a text, a list of numbers and words, {\"box\": [...]} or {\"sphere\": [...]}, not "
     "null"},
    {"mesh_broken",
     ": bodies.0.mesh: tests/bad/scenes/../meshes/index_out_of_range.obj:6: vertex 5 in a face, but the file has 4 "
     "vertices"},
    {"mesh_is_a_directory",
     ": bodies.0.mesh: tests/bad/scenes/../meshes: not a mesh file by its ending: expected .obj or .off"},
    {"mesh_missing", ": bodies.0.mesh: tests/bad/scenes/no/such.obj: cannot read: no such file or directory"},
    {"method_as_text", ": method: expected an object, { \"type\": ... }, not the text 'xpbd'"},
    {"neither_mesh_nor_grid", ": bodies.0.mesh: a cloth needs a mesh or a grid"},
    {"nested_too_deep", ":1:2060: maximum parsing depth reached near '['"},
    {"no_bodies", ": bodies: the scene has no particles: add a body"},
    {"nul_character", ":2:20: \\u0000 is not allowed in a text"},
    {"number_1e400", ":2:65: real number overflow near '1e400'"},
    {"number_at_the_top", ": expected an object: { \"bodies\": [...], ... }, not the number 5"},
    {"number_infinity", ":2:68: invalid token near 'Infinity'"},
    {"number_nan", ":2:12: invalid token near 'NaN'"},
    {"number_of_forty_digits", ":2:52: too big integer"},
    {"only_blanks", ": the file is empty: expected a scene, { \"bodies\": [...], ... }"},
    {"output_as_number", ": output.0: expected the name of an exporter, such as \"obj\", not the number 1"},
    {"output_as_text", ": output: expected a list of exporters, such as [\"obj\", \"pc2\"], not the text 'obj'"},
    {"output_twice", ": output.1: a second pc2 would write the same files"},
    {"output_without_type", ": output.0.type: expected the name of an exporter, such as \"obj\": it is missing"},
    {"pins_as_bool",
     ": bodies.0.pins: expected a text, a list of numbers and words, {\"box\": [...]} or {\"sphere\": [...]}, not "
     "true"},
    {"pins_in_a_box_of_five", ": bodies.0.pins: 'box 5 5 5 6 6': expected box and 6 numbers: two corners"},
    {"pins_in_an_empty_box", ": bodies.0.pins: 'box 5 5 5 6 6 6': no particle is in there"},
    {"pins_misspelt",
     ": bodies.0.pins: 'top corner' names no part of a cloth; did you mean 'top corners'?; expected numbers, "
     "\"corners\", \"top corners\", \"top edge\" (bottom, left, right), \"border\", \"all\", \"box x y z x y z\" "
     "or \"sphere x y z radius\""},
    {"pins_of_unknown_shape",
     ": bodies.0.pins: expected a text, a list of numbers and words, {\"box\": [...]} or {\"sphere\": [...]}, not "
     "an object"},
    {"pins_on_a_closed_mesh",
     ": bodies.0.pins: 'corners': the mesh is closed, it has no border; name particles by number, box or sphere"},
    {"pins_out_of_range", ": bodies.0.pins: vertex 9 is out of range: the mesh has 9, 0 to 8"},
    {"pins_with_fraction", ": bodies.0.pins: '0.5': expected whole numbers"},
    {"pins_with_null", ": bodies.0.pins.1: expected a number or a text, not null"},
    {"plane_normal_zero", ": colliders.0.normal: a plane's normal cannot be zero"},
    {"real2_as_text", ": bodies.0.size: expected two numbers in m, not the text '1 1'"},
    {"real2_of_three", ": bodies.0.size: expected two numbers in m, not a list of 3"},
    {"real_as_bool", ": bodies.0.density: expected a number in kg/m2, not true"},
    {"real_as_list", ": bodies.0.density: expected a number in kg/m2, not a list of 1"},
    {"real_as_text", ": bodies.0.density: expected a number in kg/m2, not the text 'light'"},
    {"real_infinite", ": bodies.0.density: expected a number in kg/m2, not the text 'infinite'"},
    {"real_null", ": bodies.0.density: expected a number in kg/m2, not null"},
    {"real_out_of_range", ": bodies.0.density: 0 is out of range: expected from 1e-09 to 1e+09 kg/m2"},
    {"rigid_under_symplectic_euler",
     ": method.type: symplectic_euler needs finite stiffness, but 'shear' is rigid: give it a stiffness or use "
     "xpbd"},
    {"section_misspelt", ": bodys: scene has no field 'bodys'; did you mean 'bodies'?"},
    {"single_quotes", ":1:3: string or '}' expected near '''"},
    {"sphere_radius_negative", ": colliders.0.radius: -0.5 is out of range: expected 1e-09 or more m"},
    {"steps_of_a_nanosecond", ": step: a frame of 0.0166667 s is more than 1000000 steps of 1e-09 s"},
    {"substeps_with_fraction", ": method.substeps: expected a whole number, not 2.5"},
    {"substeps_zero", ": method.substeps: 0 is out of range: expected from 1 to 100000"},
    {"text_as_list", ": bodies.0.name: expected a text, not a list of 2"},
    {"text_as_number", ": name: expected a text, not the number 5"},
    {"text_behind_the_end", ":5:1: end of file expected near '}'"},
    {"text_null", ": description: expected a text, not null"},
    {"threads_65", ": threads: 65 is out of range: expected from 1 to 64"},
    {"utf16", ": the file is UTF-16: expected UTF-8"},
    {"vec3_as_number", ": bodies.0.position: expected three numbers in m, not the number 1"},
    {"vec3_as_object", ": bodies.0.position: expected three numbers in m, not an object"},
    {"vec3_of_four", ": bodies.0.position: expected three numbers in m, not a list of 4"},
    {"vec3_of_two", ": bodies.0.position: expected three numbers in m, not a list of 2"},
    {"vec3_out_of_range", ": bodies.0.position: 1e+20 is out of range: expected between -1e15 and 1e15 m"},
    {"vec3_with_null", ": bodies.0.position.2: expected a number, not null"},
    {"vec3_with_text", ": bodies.0.position.1: expected a number, not the text '1'"},
    {"version_0", ": skein: 0 is out of range: expected from 1 to 1"},
    {"version_2", ": skein: the scene is of version 2; this skein reads version 1"},
    {"version_as_text", ": skein: expected a whole number, not the text '1'"},
};

static bool is_in_table(const char *file) {
    for (size_t i = 0; i < COUNT(broken); i++) {
        size_t length = strlen(broken[i].name);
        if (!strncmp(file, broken[i].name, length) && !strcmp(file + length, ".json")) return true;
    }
    return false;
}

static void every_broken_scene_is_in_the_table(void **state) {
    (void)state;
    DIR *scenes = opendir("tests/bad/scenes");
    assert_non_null(scenes);
    size_t count = 0;
    for (struct dirent *entry; (entry = readdir(scenes)) != NULL;) {
        if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..")) continue;
        if (!is_in_table(entry->d_name)) fail_msg("tests/bad/scenes/%s is not in the table", entry->d_name);
        count++;
    }
    closedir(scenes);
    assert_int_equal(count, COUNT(broken));
}

/* One message, on one line, with file and place; exit status 2; the folder for the files is not even made. */
static void broken_scenes_are_refused(void **state) {
    (void)state;
    char path[256], words[1024];
    for (size_t i = 0; i < COUNT(broken); i++) {
        snprintf(path, sizeof path, "tests/bad/scenes/%s.json", broken[i].name);
        snprintf(words, sizeof words, "skein: %s%s\n", path, broken[i].words);
        assert_says(2, "", words, "run", path, "--out", in_folder("out"));
        assert_false(exists(in_folder("out")));
    }
}

static void check_and_explain_refuse_with_the_same_words(void **state) {
    (void)state;
    static const char *const names[] = {"empty", "version_2", "mesh_missing", "rigid_under_symplectic_euler", "output_twice"};
    for (size_t i = 0; i < COUNT(names); i++) {
        char path[256];
        snprintf(path, sizeof path, "tests/bad/scenes/%s.json", names[i]);
        outcome run = SKEIN("run", path);
        assert_says(2, "", run.err, "check", path);
        assert_says(2, "", run.err, "explain", path);
        outcome_free(&run);
    }
}

static void a_refusal_leaves_the_folder_as_it_was(void **state) {
    (void)state;
    assert_int_equal(mkdir(in_folder("out"), 0777), 0);
    write_text(in_folder("out/cloth.obj"), "old");
    for (size_t i = 0; i < COUNT(broken); i += 10) {
        char path[256];
        snprintf(path, sizeof path, "tests/bad/scenes/%s.json", broken[i].name);
        outcome o = SKEIN("run", path, "--out", in_folder("out"));
        assert_status(o, 2);
        outcome_free(&o);
    }
    assert_int_equal(count_entries(in_folder("out")), 1);
    char *text = read_text(in_folder("out/cloth.obj"));
    assert_string_equal(text, "old");
    free(text);
}

/* Faults of the top, of values, of meshes and of rules: one run names them all, and counts them. */
static void all_faults_are_named_in_one_run(void **state) {
    (void)state;
    char *path = in_folder("faults.json"), words[2048];
    write_text(path, "{ \"frames\": -1, \"fsp\": 60, \"method\": { \"type\": \"rk4\" },\n"
                     "  \"bodies\": [ { \"type\": \"cloth\", \"grid\": [3, 3], \"size\": [1], \"density\": \"x\" },\n"
                     "    { \"type\": \"cloth\", \"grid\": [3, 3], \"pins\": \"botom edge\" }, { \"type\": \"cloth\", \"mesh\": \"no.obj\" } ],\n"
                     "  \"constraints\": [ { \"type\": \"distance\", \"particles\": [0, 1] }, { \"type\": \"distance\", \"particles\": [0] } ],\n"
                     "  \"forces\": [ { \"type\": \"wind\", \"force\": [1, 2] }, 5 ],\n"
                     "  \"colliders\": [ { \"type\": \"plane\", \"normal\": [0, 0, 0] } ], \"output\": [ \"gif\", { \"type\": \"pc2\", \"every\": 0 } ] }");
    outcome o = SKEIN("run", path, "--set", "bodies.9.density=1", "--set", "forces.0.enabled=maybe", "--out", in_folder("out"));
    assert_status(o, 2);
    static const char *const lines[] = {
        "--set bodies.9.density=1: there is no '9' in bodies: it has 3, counted from 0",
        "%s: frames: -1 is out of range",
        "%s: fsp: scene has no field 'fsp'; did you mean 'fps'?",
        "%s: output.0: there is no exporter 'gif'",
        "%s: output.1.every: 0 is out of range",
        "%s: method.type: there is no method 'rk4'",
        "%s: bodies.0.size: expected two numbers in m, not a list of 1",
        "%s: bodies.0.density: expected a number in kg/m2, not the text 'x'",
        "%s: bodies.1.pins: 'botom edge' names no part of a cloth; did you mean 'bottom edge'?",
        "%s: bodies.2.mesh: ",
        "%s: constraints.1.particles: expected the numbers of 2 particles",
        "%s: forces.0.force: expected three numbers in N, not a list of 2",
        "%s: forces.0.enabled: expected true or false, not the text 'maybe'",
        "%s: forces.1: expected an object",
        "%s: colliders.0.normal: a plane's normal cannot be zero",
        "%s: 15 faults",
    };
    // one line each, in this order
    const char *at = o.err;
    for (size_t i = 0; i < COUNT(lines); i++) {
        int length = snprintf(words, sizeof words, "skein: ");
        snprintf(words + length, sizeof words - (size_t)length, lines[i], path);
        if (strncmp(at, words, strlen(words))) fail_msg("expected '%s', found '%s'", words, at);
        at = strchr(at, '\n') + 1;
    }
    assert_string_equal(at, "");
    assert_false(exists(in_folder("out")));
    outcome_free(&o);
}

static void what_is_no_file_is_refused(void **state) {
    (void)state;
    char words[1024], *path = in_folder("folder.json");
    assert_int_equal(mkdir(path, 0777), 0);
    snprintf(words, sizeof words, "skein: %s: cannot read: it is a directory, expected a file\n", path);
    assert_says(2, "", words, "run", path);
    path = in_folder("nothing.json");
    snprintf(words, sizeof words, "skein: %s: cannot read: no such file or directory\n", path);
    assert_says(2, "", words, "check", path);
    assert_says(2, "", "skein: /dev/null: cannot read: it is a device, expected a file\n", "check", "/dev/null");

    // a directory with a mesh's name
    char *scene = in_folder("scene.json");
    assert_int_equal(mkdir(in_folder("mesh.obj"), 0777), 0);
    write_text(scene, "{ \"bodies\": [ { \"type\": \"cloth\", \"mesh\": \"mesh.obj\" } ] }");
    snprintf(words, sizeof words, "skein: %s: bodies.0.mesh: %s: cannot read: it is a directory, expected a file\n", scene,
             in_folder("mesh.obj"));
    assert_says(2, "", words, "check", scene);

    // the superuser may read everything
    chmod(scene, 0);
    if (geteuid() == 0) return;
    snprintf(words, sizeof words, "skein: %s: cannot read: no permission\n", scene);
    assert_says(2, "", words, "check", scene);
}

/* ---- Good scenes, read in this process ------------------------------------------------------------- */

static void print_fault(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

static const skein_kind *exporters[3];

static io_scene *read_scene(const char *text, const char *const *sets) {
    io_faults faults = {print_fault, NULL, 0};
    exporters[0] = io_exporter_at(0), exporters[1] = io_exporter_at(1);
    io_scene *scene = io_scene_read_text(text, strlen(text), "tests/corpus/scene/memory.json", sets, exporters, &faults);
    assert_non_null(scene);
    assert_int_equal(faults.count, 0);
    return scene;
}

static skein_world *build_scene(const char *text, const char *const *sets) {
    io_faults faults = {print_fault, NULL, 0};
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
    assert_int_equal(s->threads, 1);
    assert_string_equal(s->name, "");
    assert_true(s->fps == 60 && s->step == 1.0 / 60);
    double dt;
    assert_int_equal(io_scene_steps_per_frame(s, &dt), 1);
    assert_true(dt == 1.0 / 60);
    io_export exports[4];
    assert_int_equal(io_scene_exports(scene, exports, 4), 2);
    assert_ptr_equal(exports[0].kind, io_exporter_at(0));
    assert_int_equal(((const io_obj_params *)exports[0].params)->normals, IO_NORMALS_AREA);
    assert_int_equal(((const io_pc2_params *)exports[1].params)->every, 1);
    io_scene_free(scene);

    // behind a mark, in any order, with a step that does not divide the frame
    scene = read_scene("\xef\xbb\xbf{ \"output\": [ { \"normals\": \"angle\", \"type\": \"obj\" } ], \"threads\": 2, \"frames\": 7e0,\n"
                       "  \"fps\": 24, \"step\": 0.01, \"name\": \"caf\u00e9\", \"description\": \"\", \"skein\": 1 }", NULL);
    s = io_scene_get(scene);
    assert_string_equal(s->name, "caf\u00e9");
    assert_int_equal(s->frames, 7);
    assert_int_equal(s->threads, 2);
    assert_int_equal(io_scene_steps_per_frame(s, &dt), 5);
    assert_true(fabs(dt * 5 * 24 - 1) < 1e-15);
    assert_int_equal(io_scene_exports(scene, exports, 4), 1);
    assert_int_equal(((const io_obj_params *)exports[0].params)->normals, IO_NORMALS_ANGLE);
    io_scene_free(scene);

    scene = read_scene("{ \"output\": [] }", NULL);
    assert_int_equal(io_scene_exports(scene, exports, 4), 0);
    io_scene_free(scene);
}

static void every_type_of_field_arrives(void **state) {
    (void)state;
    skein_world *world = build_scene(
        "{ \"method\": { \"type\": \"symplectic_euler\", \"substeps\": 7 },\n"
        "  \"bodies\": [ { \"type\": \"cloth\", \"name\": \"sheet\", \"grid\": [3, 5], \"size\": [2, 1.5], \"position\": [1, 2, 3],\n"
        "    \"visible\": false, \"stretch\": { \"stiffness\": 3e3, \"limit\": \"infinite\" }, \"bend.stiffness\": 5, \"pins\": [-1, 0] } ],\n"
        "  \"forces\": [ { \"type\": \"gravity\", \"acceleration\": [0, -1.5, 0], \"name\": \"weak\" } ],\n"
        "  \"colliders\": [ { \"type\": \"sphere\", \"radius\": 0.25, \"motion\": { \"spin\": 4 } } ] }", NULL);
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
    assert_int_equal(s.held_particles, 2);
    skein_world_destroy(world);
}

/* What is pinned can be said in several ways. */
static void pins_have_short_forms(void **state) {
    (void)state;
    static const struct {
        const char *pins;
        size_t held;
    } forms[] = {
        {"\"top corners\"", 2},
        {"\"top edge, bottom corners\"", 5},
        {"[0, 1, 2]", 3},
        {"4", 1},
        {"[ \"corners\", 4 ]", 5},
        {"[ 4, \"corners\", 5 ]", 6},
        {"{ \"box\": [-0.5, -0.1, -0.5, 0.5, 0.1, -0.5] }", 3},
        {"{ \"sphere\": [0, 0, 0, 0.51] }", 5},
        {"[ 0, { \"sphere\": [0, 0, 0, 0.1] }, 8, \"bottom edge\" ]", 5},
        {"[ { \"box\": [0.5, 0, 0.5, 0.5, 0, 0.5] }, { \"sphere\": [0.1, 0, 0, 0.11] } ]", 2},
        {"\"\"", 0},
        {"[]", 0},
    };
    for (size_t i = 0; i < COUNT(forms); i++) {
        char text[256];
        snprintf(text, sizeof text, "{ \"bodies\": [ { \"type\": \"cloth\", \"grid\": [3, 3], \"pins\": %s } ] }", forms[i].pins);
        skein_world *world = build_scene(text, NULL);
        if (statistics_of(world).held_particles != forms[i].held) fail_msg("%s holds %zu", forms[i].pins, statistics_of(world).held_particles);
        skein_world_destroy(world);
    }
}

static void meshes_are_found_beside_the_scene(void **state) {
    (void)state;
    skein_world *world = build_scene("{ \"bodies\": [ { \"type\": \"cloth\", \"mesh\": \"tetrahedron.obj\", \"scale\": 2 } ] }", NULL);
    skein_statistics s = statistics_of(world);
    assert_int_equal(s.particles, 4);
    double tip[3];
    assert_int_equal(skein_positions_copy(world, 3, 1, tip), SKEIN_OK);
    assert_true(tip[2] == 2);
    skein_world_destroy(world);
}

static void sets_change_the_scene(void **state) {
    (void)state;
    static const char scene[] = "{ \"bodies\": [ { \"type\": \"cloth\", \"grid\": [3, 3] }, { \"type\": \"cloth\", \"name\": \"b\", \"grid\": [3, 3] } ],\n"
                                "  \"colliders\": [ { \"type\": \"sphere\", \"name\": \"ball\" }, { \"type\": \"plane\" } ] }";
    static const char *const sets[] = {"bodies.0.stretch.stiffness=7", "bodies.b.stretch.stiffness=8",       "bodies.b.pins=top edge",
                                       "colliders.ball.centre=[1,2,3]", "colliders.1={\"type\": \"sphere\"}", "method.type=symplectic_euler",
                                       "method.substeps=3",             "bodies.b.stretch.stiffness=9",       "forces=[{\"type\": \"gravity\"}]",
                                       "bodies.0.name=a=b",             "frames=0",                           NULL};
    skein_world *world = build_scene(scene, sets);
    assert_true(number_at(world, "bodies.0.stretch.stiffness") == 7);
    assert_true(number_at(world, "bodies.1.stretch.stiffness") == 9);
    assert_true(number_at(world, "bodies.a=b.enabled") == 1);
    assert_true(number_at(world, "method.substeps") == 3);
    assert_true(number_at(world, "colliders.1.radius") == 0.5);
    assert_int_equal(statistics_of(world).held_particles, 3);
    assert_int_equal(skein_object_count(world, SKEIN_FORCE), 1);
    skein_value value;
    assert_int_equal(skein_get_path(world, "colliders.ball.centre", &value), SKEIN_OK);
    assert_true(value.number[0] == 1 && value.number[1] == 2 && value.number[2] == 3);
    assert_string_equal(skein_object_kind(world, skein_object_at(world, SKEIN_METHOD, 0))->name, "symplectic_euler");
    skein_world_destroy(world);
}

/* Each --set with its fault, on tests/corpus/scene/everything.json. */
static void faults_of_sets_are_named(void **state) {
    (void)state;
    static const char scene[] = "tests/corpus/scene/everything.json";
    static const struct {
        const char *set, *words;
    } faults[] = {
        {"frames", "--set frames: expected path=value, such as bodies.0.stretch.stiffness=2e4"},
        {"=5", "--set =5: expected path=value, such as bodies.0.stretch.stiffness=2e4"},
        {"bodies.2.density=1", "--set bodies.2.density=1: there is no '2' in bodies: it has 2, counted from 0"},
        {"bodies.-1.density=1", "--set bodies.-1.density=1: there is no '-1' in bodies: it has 2, counted from 0"},
        {"bodies.cloth.density=1", "--set bodies.cloth.density=1: there is no 'cloth' in bodies: it has 2, counted from 0"},
        {"bodies.7={}", "--set bodies.7={}: there is no '7' in bodies: it has 2, counted from 0"},
        {"bodies..density=1", "--set bodies..density=1: a name is missing in the path"},
        {"method..type=xpbd", "--set method..type=xpbd: a name is missing in the path"},
        {"method.=1", "--set method.=1: a name is missing in the path"},
        {"bodies.0.pins.left=1", "--set bodies.0.pins.left=1: bodies.0.pins is the text 'top corners': it has no 'left'"},
        {"output.0.every=3", "--set output.0.every=3: output.0 is the text 'obj': it has no 'every'"},
        {"constraints.rod.particles.x.y=1", "--set constraints.rod.particles.x.y=1: there is no 'x' in constraints.rod.particles: it has 2, counted from 0"},
        {"fame=1", "%s: fame: scene has no field 'fame'; did you mean 'name'?"},
        {"metod.substeps=5", "%s: metod: scene has no field 'metod'; did you mean 'method'?"},
        {"bodies.sheet.stretch.stifness=5", "%s: bodies.0.stretch.stifness: cloth has no field 'stretch.stifness'; did you mean 'stretch.stiffness'?"},
        {"bodies.sheet.strech.stiffness=5", "%s: bodies.0.strech: cloth has no field 'strech'; did you mean 'stretch'?"},
        {"bodies.sheet.density=heavy", "%s: bodies.0.density: expected a number in kg/m2, not the text 'heavy'"},
        {"bodies.sheet.density=1e400", "%s: bodies.0.density: expected a number in kg/m2, not the text '1e400'"},
        {"bodies.sheet.density=", "%s: bodies.0.density: expected a number in kg/m2, not the text ''"},
        {"bodies.sheet.grid=[3,3", "%s: bodies.0.grid: expected two whole numbers, not the text '[3,3'"},
        {"method=xpbd", "%s: method: expected an object, { \"type\": ... }, not the text 'xpbd'"},
        {"skein=2", "%s: skein: the scene is of version 2; this skein reads version 1"},
        {"step=1e-9", "%s: step: a frame of 0.1 s is more than 1000000 steps of 1e-09 s"},
    };
    for (size_t i = 0; i < COUNT(faults); i++) {
        char words[512], line[600];
        snprintf(words, sizeof words, faults[i].words, scene);
        snprintf(line, sizeof line, "skein: %s\n", words);
        assert_says(2, "", line, "check", scene, "--set", faults[i].set);
    }
    // a list that the scene does not have is empty
    assert_says(2, "", "skein: --set forces.wind.force=[1,0,0]: there is no 'wind' in forces, which is empty\n", "check",
                "tests/corpus/scene/smallest.json", "--set", "forces.wind.force=[1,0,0]");
}

/* ---- Constraints between particles that bodies made -------------------------------------------------- */

/* Three patches of cloth, each of 4 particles, threaded on a rope: 0-3 are held, 4-7 and 8-11 hang by it. */
#define PATCH(name_, y_, pins_)                                                                                                \
    "{ \"type\": \"cloth\", \"name\": \"" name_ "\", \"grid\": [2, 2], \"size\": [0.1, 0.1], \"position\": [0, " y_ ", 0], \"pins\": \"" pins_ "\" }"
static const char rope[] = "{ \"method\": { \"type\": \"xpbd\", \"substeps\": 20 }, \"bodies\": [ " PATCH("hook", "2", "all") ", " PATCH(
    "bead", "1.5", "") ", " PATCH("bob", "1", "") " ],\n"
                                                  "  \"constraints\": [ { \"type\": \"distance\", \"name\": \"rope\", \"stiffness\": \"infinite\",\n"
                                                  "    \"particles\": [[0, 4], [1, 5], [2, 6], [3, 7], [4, 8], [5, 9], [6, 10], [7, 11]] } ],\n"
                                                  "  \"forces\": [ { \"type\": \"gravity\" }, { \"type\": \"drag\", \"rate\": 2 } ] }";

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
        TEST(every_broken_scene_is_in_the_table),
        TEST(broken_scenes_are_refused),
        TEST(check_and_explain_refuse_with_the_same_words),
        TEST(a_refusal_leaves_the_folder_as_it_was),
        TEST(all_faults_are_named_in_one_run),
        TEST(what_is_no_file_is_refused),
        TEST(the_top_has_defaults_and_values),
        TEST(every_type_of_field_arrives),
        TEST(pins_have_short_forms),
        TEST(meshes_are_found_beside_the_scene),
        TEST(sets_change_the_scene),
        TEST(faults_of_sets_are_named),
        TEST(constraints_tie_bodies_together),
    };
    return cmocka_run_group_tests_name("scene", tests, NULL, NULL);
}
