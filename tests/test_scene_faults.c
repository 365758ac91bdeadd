/* Tests of the scene reader with broken scenes: each is refused with its own words. They go through the
 * command, as users send them. */
#include "test_command.h"

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
    {"constraint_of_one_and_three", ": constraints.0.particles.0: expected the numbers of 2 particles, not a list of 1"},
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
    {"field_in_a_group_and_with_a_dot", ": bodies.0.stretch.limit: is there twice, once in a group and once with a dot"},
    {"field_misspelt", ": frame: scene has no field 'frame'; did you mean 'frames'?"},
    {"field_of_body_misspelt", ": bodies.0.densty: cloth has no field 'densty'; did you mean 'density'?"},
    {"field_of_exporter_misspelt", ": output.0.evry: pc2 has no field 'evry'; did you mean 'every'?"},
    {"field_of_group_misspelt",
     ": bodies.0.stretch.stifness: cloth has no field 'stretch.stifness'; did you mean 'stretch.stiffness'?"},
    {"field_unknown", ": zzzzzzzzzzzzzzzzzzzz: scene has no field 'zzzzzzzzzzzzzzzzzzzz'; `skein list scene` shows all"},
    {"field_with_line_break", ": fra?mes: scene has no field 'fra?mes'; did you mean 'frames'?"},
    {"force_field_number",
     ": forces.0.force: column 1: the result is a number; expected a vector: vec3(x, y, z)\n    length(p)\n    ^^^^^^^^^"},
    {"forces_as_object", ": forces: expected a list, [ { \"type\": ... }, ... ], not an object"},
    {"formula_bracket_missing",
     ": colliders.0.surface: column 9: expected ',' or ')', not the end\n    length(p\n            ^"},
    {"formula_control_characters",
     ": colliders.0.surface: column 7: a byte that is no printable ASCII (0x1b)\n    p.y - ?[31m\n          ^"},
    {"formula_misspelt",
     ": colliders.0.surface: line 2, column 1: there is no name 'lenght'; did you mean 'length'?\n    lenght(q) - R\n    ^^^^^^"},
    {"formula_parameter_as_text", ": colliders.0.parameters.R: expected a number, not the text '1'"},
    {"formula_parameter_in_groups", ": colliders.0.parameters.R: expected a number, not an object"},
    {"formula_parameter_of_the_language",
     ": colliders.0.parameters.sin: 'sin' cannot be a parameter: it has a meaning in formulas already"},
    {"formula_parameter_twice", ": colliders.0.parameters.R: is there twice, once in a group and once with a dot"},
    {"formula_parameter_unused", ": colliders.0.parameters.R: 'R' is in no formula of this object"},
    {"formula_parameters_as_number",
     ": colliders.0.parameters: expected an object of numbers, { \"R\": 0.5 }, say, not the number 5"},
    {"formula_parameters_misspelt",
     ": colliders.0.paramters: formula has no field 'paramters'; did you mean 'parameters'?"},
    {"formula_parameters_of_a_sphere",
     ": colliders.0.parameters: sphere has no field 'parameters'; `skein list sphere` shows all"},
    {"formula_same_everywhere",
     ": colliders.0.surface: a surface is a formula of p, and this one is the same everywhere"},
    {"formula_vector_for_surface",
     ": colliders.0.surface: column 1: the result is a vector; expected a number, such as its length(v) or a component v.x\n    p*2\n    ^^^"},
    {"formula_with_rest",
     ": colliders.0.surface: there is no rest(...) here: only what is made of particles has a rest pose"},
    {"fps_zero", ": fps: 0 is out of range: expected from 0.001 to 1e+06 1/s"},
    {"frames_negative", ": frames: -1 is out of range: expected from 0 to 1e+08"},
    {"grid_of_one_row", ": bodies.0.grid: a grid of 1 x 9 particles: expected 2 or more each way"},
    {"grid_one_by_one", ": bodies.0.grid: a grid of 1 x 1 particles: expected 2 or more each way"},
    {"group_as_number", ": bodies.0.stretch: expected an object with fields such as 'stiffness', not the number 10000"},
    {"group_misspelt", ": bodies.0.strech: cloth has no field 'strech'; did you mean 'stretch'?"},
    {"image_missing", ": view.image: tests/bad/scenes/none.png: cannot read: no such file or directory"},
    {"infinite_misspelt",
     ": bodies.0.stretch.stiffness: expected a number in N/m or \"infinite\", not the text 'infinit'"},
    {"groups_with_a_number", ": bodies.0.groups.1: expected a name, not the number 2"},
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
    {"kind_of_constraint_misspelt", ": constraints.0.type: there is no constraint 'distanse'; did you mean 'distance'?"},
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
     ": bodies.0.mesh: tests/bad/scenes/../meshes: not a mesh file by its ending: expected .obj, .off, .ply, .stl, .glb, .gltf "
     "or .node"},
    {"iterations_of_backward_euler",
     ": method.iterations: backward_euler has no field 'iterations'; did you mean 'cg_iterations'?"},
    {"mesh_missing", ": bodies.0.mesh: tests/bad/scenes/no/such.obj: cannot read: no such file or directory"},
    {"mesh_not_fetched",
     ": bodies.0.mesh: tests/bad/scenes/../meshes/fetched/none.off: cannot read: no such file or directory; `make demo` "
     "or `tools/fetch-mesh` in Skein's source fetches it"},
    {"method_as_text", ": method: expected an object, { \"type\": ... }, not the text 'xpbd'"},
    {"motion_of_unknown_pins",
     ": motions.1.pins: 'the left': expected numbers, \"box x y z x y z\" or \"sphere x y z radius\"; words are about "
     "one body: say which it is \"on\"; without \"pins\" it leads all that are pinned"},
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
    {"particles_as_empty_object",
     ": constraints.0.particles.body: expected the name or number of a body: it is missing"},
    {"particles_misspelt", ": constraints.0.particles.ovr: there is no 'ovr' here; did you mean 'over'?"},
    {"particles_of_a_body_misspelt", ": constraints.0.particles.body: there is no body 'clot'; did you mean 'cloth'?"},
    {"particles_of_a_group",
     ": constraints.0.particles.to: there is no body 'all of it'; it is the name of a group, and one body is meant"},
    {"particles_of_a_stranger", ": constraints.0.particles.body: there is no body 'xyz': the scene has 'cloth', 'flag'"},
    {"particles_of_body_9", ": constraints.0.particles.body: there is no body 9: the scene has 2, counted from 0"},
    {"particles_of_nobody", ": constraints.0.particles.body: expected the name or number of a body, not null"},
    {"particles_with_null_over",
     ": constraints.0.particles.over: expected \"edges\" (of 2 particles), \"triangles\" (3), \"hinges\" or \"tetrahedra\" (4) for a "
     "constraint on 2 particles, not null"},
    {"particles_without_body", ": constraints.0.particles.body: expected the name or number of a body: it is missing"},
    {"particles_without_over",
     ": constraints.0.particles.over: expected \"edges\" (of 2 particles), \"triangles\" (3), \"hinges\" or \"tetrahedra\" (4) for a "
     "constraint on 2 particles: it is missing"},
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
    {"potential_of_velocity",
     ": forces.0.energy: column 5: 'v' is a velocity, and those are for force fields: a constraint, an energy or a surface depends on positions and t\n    dot(v, v)\n        ^"},
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
    {"threads_65", ": threads: 65 is out of range: expected from 0 to 64"},
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

/* One message, on one line (and the place in a formula on two more), with file and place; exit status 2; the folder for
 * the files is not even made. */
static void broken_scenes_are_refused(void **state) {
    (void)state;
    static char paths[COUNT(broken)][128], words[COUNT(broken) * 512];
    const char *arguments[COUNT(broken) + 2] = {"check"};
    char *end = words;
    for (size_t i = 0; i < COUNT(broken); i++) {
        snprintf(paths[i], sizeof paths[i], "tests/bad/scenes/%s.json", broken[i].name);
        arguments[i + 1] = paths[i];
        end += snprintf(end, 512, "skein: %s%s\n", paths[i], broken[i].words);
    }
    outcome o = finish_skein(start_skein((surroundings){0}, arguments));
    assert_status(o, 2);
    assert_string_equal(o.out, "");
    assert_string_equal(o.err, words);
    outcome_free(&o);
    // as users come upon them
    for (size_t i = 0; i < COUNT(broken); i += 10) {
        char one[512];
        snprintf(one, sizeof one, "skein: %s%s\n", paths[i], broken[i].words);
        assert_says(2, "", one, "run", paths[i], "--out", in_folder("out"));
        assert_false(exists(in_folder("out")));
    }
}

static void check_and_explain_refuse_with_the_same_words(void **state) {
    (void)state;
    static const char *const names[] = {"empty", "version_2", "mesh_missing", "rigid_under_symplectic_euler",
                                        "output_twice"};
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
    write_scene(path, "{ 'frames': -1, 'fsp': 60, 'method': { 'type': 'rk5' },\n"
                      "  'bodies': [ { 'type': 'cloth', 'grid': [3, 3], 'size': [1], 'density': 'x' },\n"
                      "    { 'type': 'cloth', 'grid': [3, 3], 'pins': 'botom edge' },\n"
                      "    { 'type': 'cloth', 'mesh': 'no.obj' } ],\n"
                      "  'constraints': [ { 'type': 'distance', 'particles': [0, 1] },\n"
                      "    { 'type': 'distance', 'particles': [0] } ],\n"
                      "  'forces': [ { 'type': 'wind', 'force': [1, 2] }, 5 ],\n"
                      "  'colliders': [ { 'type': 'plane', 'normal': [0, 0, 0] } ],\n"
                      "  'output': [ 'gif', { 'type': 'pc2', 'every': 0 } ] }");
    outcome o =
        SKEIN("run", path, "--set", "bodies.9.density=1", "--set", "forces.0.enabled=maybe", "--out", in_folder("out"));
    assert_status(o, 2);
    static const char *const lines[] = {
        "--set bodies.9.density=1: there is no '9' in bodies: it has 3, counted from 0",
        "%s: frames: -1 is out of range",
        "%s: fsp: scene has no field 'fsp'; did you mean 'fps'?",
        "%s: output.0: there is no exporter 'gif'",
        "%s: output.1.every: 0 is out of range",
        "%s: method.type: there is no method 'rk5'",
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

/* Names of nobody in lists, each with its place, beside faults of other kinds; and no word of what is called so, or may be. */
static void all_unknown_names_are_named_in_one_run(void **state) {
    (void)state;
    char *path = in_folder("names.json"), words[4096];
    write_scene(
        path,
        "{ 'bodies': [ { 'type': 'cloth', 'name': 'cape', 'grid': [3, 3], 'pins': 'top edge', 'groups': 'clothes, worn' },\n"
        "    { 'type': 'flock', 'name': 'a, b', 'count': 2 } ],\n"
        "  'forces': [ { 'type': 'gravity', 'on': 'cap, worn, nobody' },\n"
        "    { 'type': 'contact', 'ignore': 'cape:shirt, trousers : clothes' },\n"
        "    { 'type': 'gravity', 'on': 'worm', 'enabled': false }, { 'type': 'gravity', 'on': 'a, b' },\n"
        "    { 'type': 'flocking', 'on': 'a, b', 'neighbours': 'a, cape' } ],\n"
        "  'colliders': [ { 'type': 'sphere', 'name': 'ball', 'on': 'clotehs' }, { 'type': 'mesh', 'mesh': 'no.obj' } ],\n"
        "  'motions': [ { 'type': 'turn', 'on': 'worn, x' }, { 'type': 'turn', 'colliders': 'ball, bat' } ] }");
    snprintf(words, sizeof words,
             "skein: %s: forces.0.on: there is no body or group of the name 'cap'; did you mean 'cape'?\n"
             "skein: %s: forces.0.on: there is no body or group of the name 'nobody'\n"
             "skein: %s: forces.1.ignore: there is no body or group of the name 'shirt'\n"
             "skein: %s: forces.1.ignore: there is no body or group of the name 'trousers'\n"
             "skein: %s: forces.2.on: there is no body or group of the name 'worm'; did you mean 'worn'?\n"
             "skein: %s: forces.4.neighbours: there is no body or group of the name 'a'\n"
             "skein: %s: colliders.0.on: there is no body or group of the name 'clotehs'; did you mean 'clothes'?\n"
             "skein: %s: colliders.1.mesh: %s: cannot read: no such file or directory\n"
             "skein: %s: motions.0.on: there is no body or group of the name 'x'\n"
             "skein: %s: 9 faults\n", // 'bat' may be the name of what could not be read
             path, path, path, path, path, path, path, path, in_folder("no.obj"), path, path);
    assert_says(2, "", words, "check", path);
    // with all colliders there
    write_scene(
        path,
        "{ 'bodies': [ { 'type': 'cloth', 'name': 'cape', 'grid': [3, 3], 'pins': 'top edge' } ],\n"
        "  'colliders': [ { 'type': 'sphere', 'name': 'ball' } ],\n"
        "  'motions': [ { 'type': 'turn', 'colliders': 'ball, bat, cape' }, { 'type': 'attach', 'to': 'bal' } ] }");
    snprintf(
        words, sizeof words,
        "skein: %s: motions.0.colliders: there is no collider of the name 'bat'\n"
        "skein: %s: motions.0.colliders: there is no collider of the name 'cape': it is that of a body or a group of bodies\n"
        "skein: %s: motions.1.to: there is no collider of the name 'bal'; did you mean 'ball'?\n"
        "skein: %s: 3 faults\n",
        path, path, path, path);
    assert_says(2, "", words, "check", path);
    // where a body has a fault, names may be its
    write_scene(path, "{ 'bodies': [ { 'type': 'cloth', 'name': 'cape', 'grid': [3, 3, 3] } ],\n"
                      "  'forces': [ { 'type': 'gravity', 'on': 'cape, nobody' } ] }");
    snprintf(words, sizeof words, "skein: %s: bodies.0.grid: expected two whole numbers, not a list of 3\n", path);
    assert_says(2, "", words, "check", path);
}

/* Texts and lists that could only be slips: each with its place, and what it ought to be. */
static void slips_in_texts_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *rules, *words;
    } slips[] = {
        {"'forces': [ { 'type': 'contact', 'ignore': 'a:' } ]",
         "forces.0.ignore: 'a:': a name is missing behind the colon: expected two, \"cape:shirt\", or one without a colon for what does not "
         "meet itself"},
        {"'forces': [ { 'type': 'gravity', 'on': [''] } ]", "forces.0.on.0: expected a name, not the text ''"},
        {"'forces': [ { 'type': 'gravity', 'on': ['a', ' '] } ]", "forces.0.on.1: expected a name, not the text ' '"},
        {"'forces': [ { 'type': 'gravity', 'on': ['a,a'] } ]",
         "forces.0.on.0: expected a name, not the text 'a,a': in a list each name is a text of its own, without commas"},
        {"'colliders': [ { 'type': 'plane', 'on': [2] } ]", "colliders.0.on.0: expected a name, not the number 2"},
        {"'motions': [ { 'type': 'turn', 'colliders': [''] } ]",
         "motions.0.colliders.0: expected a name, not the text ''"},
        {"'motions': [ { 'type': 'turn', 'jump_times': [4, 1.5] } ]",
         "motions.0.jump_times: '4 1.5': 1.5 s comes after 4 s: expected times that rise, such as \"1.5 4\""},
        {"'motions': [ { 'type': 'turn' }, { 'type': 'turn', 'name': 'm', 'map': '1 none.txt' } ]",
         "motions.1.map: number 2, 'none.txt': expected numbers, 0 or more, one for each particle"},
        {"'motions': [ { 'type': 'turn', 'map': [1, 0.5] } ]",
         "motions.0.map: 2 numbers, and it leads 9 particles, or could: expected one for each"},
    };
    char *path = in_folder("slip.json"), words[1024];
    for (size_t i = 0; i < COUNT(slips); i++) {
        snprintf(words, sizeof words,
                 "{ 'bodies': [ { 'type': 'cloth', 'name': 'a', 'grid': [3, 3], 'pins': 'top edge' } ], %s }",
                 slips[i].rules);
        write_scene(path, words);
        snprintf(words, sizeof words, "skein: %s: %s\n", path, slips[i].words);
        assert_says(2, "", words, "check", path);
    }
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
    write_scene(scene, "{ 'bodies': [ { 'type': 'cloth', 'mesh': 'mesh.obj' } ] }");
    snprintf(words, sizeof words, "skein: %s: bodies.0.mesh: %s: cannot read: it is a directory, expected a file\n",
             scene, in_folder("mesh.obj"));
    assert_says(2, "", words, "check", scene);
}

static void a_scene_that_may_not_be_read_is_told(void **state) {
    (void)state;
    if (geteuid() == 0) skip(); // the superuser may read everything
    char words[600], *scene = in_folder("scene.json");
    write_scene(scene, "{ 'bodies': [ { 'type': 'rope' } ] }");
    assert_int_equal(chmod(scene, 0), 0);
    snprintf(words, sizeof words, "skein: %s: cannot read: no permission\n", scene);
    assert_says(2, "", words, "check", scene);
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
        {"bodies.cloth.density=1",
         "--set bodies.cloth.density=1: there is no 'cloth' in bodies: it has 2, counted from 0"},
        {"bodies.7={}", "--set bodies.7={}: there is no '7' in bodies: it has 2, counted from 0"},
        {"bodies..density=1", "--set bodies..density=1: a name is missing in the path"},
        {"method..type=xpbd", "--set method..type=xpbd: a name is missing in the path"},
        {"method.=1", "--set method.=1: a name is missing in the path"},
        {"bodies.0.pins.left=1",
         "--set bodies.0.pins.left=1: bodies.0.pins is the text 'top corners': it has no 'left'"},
        {"output.0.every=3", "--set output.0.every=3: output.0 is the text 'obj': it has no 'every'"},
        {"constraints.rod.particles.x.y=1",
         "--set constraints.rod.particles.x.y=1: there is no 'x' in constraints.rod.particles: "
         "it has 2, counted from 0"},
        {"fame=1", "%s: fame: scene has no field 'fame'; did you mean 'name'?"},
        {"metod.substeps=5", "%s: metod: scene has no field 'metod'; did you mean 'method'?"},
        {"bodies.sheet.stretch.stifness=5",
         "%s: bodies.0.stretch.stifness: cloth has no field 'stretch.stifness'; did you mean 'stretch.stiffness'?"},
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
    assert_says(2, "", "skein: --set forces.wind.force=[1,0,0]: there is no 'wind' in forces, which is empty\n",
                "check", "tests/corpus/scene/smallest.json", "--set", "forces.wind.force=[1,0,0]");
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(every_broken_scene_is_in_the_table),
        TEST(broken_scenes_are_refused),
        TEST(check_and_explain_refuse_with_the_same_words),
        TEST(a_refusal_leaves_the_folder_as_it_was),
        TEST(all_faults_are_named_in_one_run),
        TEST(all_unknown_names_are_named_in_one_run),
        TEST(slips_in_texts_are_refused),
        TEST(what_is_no_file_is_refused),
        TEST(a_scene_that_may_not_be_read_is_told),
        TEST(faults_of_sets_are_named),
    };
    return cmocka_run_group_tests_name("scene faults", tests, NULL, NULL);
}
