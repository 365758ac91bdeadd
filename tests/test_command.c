/* Tests of the command's words: arguments, help, what check, explain and list print, progress. */
#include "test_command.h"

#include "io/exporters.h"
#include "io/scene.h"

#include <dirent.h>
#include <jansson.h>

/* ---- Arguments ------------------------------------------------------------------------------------ */

#define RUN_USAGE "usage: skein run SCENE [--out FOLDER] [options] | --resume FOLDER\n"

static void wrong_arguments_are_told(void **state) {
    (void)state;
    static const struct {
        const char *arguments[5], *words;
    } wrong[] = {
        {{"fly"}, "skein: there is no command 'fly'; `skein --help` shows all\n"},
        {{"runn"}, "skein: there is no command 'runn'; did you mean 'run'? `skein --help` shows all\n"},
        {{"help", "chek"}, "skein: there is no command 'chek'; did you mean 'check'? `skein --help` shows all\n"},
        {{"--frames"}, "skein: there is no command '--frames'; `skein --help` shows all\n"},
        {{"run"}, "skein run: which scene? " RUN_USAGE},
        {{"check"}, "skein check: which scene? usage: skein check SCENE... [--set PATH=VALUE]... [--json]\n"},
        {{"explain", "--set", "a=b"},
         "skein explain: which scene? usage: skein explain SCENE [--set PATH=VALUE]... [--device WHERE] [--unfused]\n"},
        {{"run", "a.json", "b.json"}, "skein run: 'b.json' is one argument too many; " RUN_USAGE},
        {{"run", "a.json", "--", "--no-progress"}, "skein run: '--no-progress' is one argument too many; " RUN_USAGE},
        {{"run", "a.json", "--frame", "3"},
         "skein run: there is no option --frame; did you mean --frames? `skein run --help` shows all\n"},
        {{"run", "a.json", "--frame=3"},
         "skein run: there is no option --frame; did you mean --frames? `skein run --help` shows all\n"},
        {{"run", "-x", "a.json"}, "skein run: there is no option -x; `skein run --help` shows all\n"},
        {{"check", "a.json", "--frames", "3"},
         "skein check: there is no option --frames here, only for run, render, compare, fit or record; `skein check --help` shows all\n"},
        {{"run", "a.json", "--frmes", "3"},
         "skein run: there is no option --frmes; did you mean --frames? `skein run --help` shows all\n"},
        {{"check", "a.json", "--device=gpu"},
         "skein check: there is no option --device here, only for run, view, render, explain or bench; "
         "`skein check --help` shows all\n"},
        {{"run", "a.json", "--device", "card"}, "skein run: --device card: expected cpu, gpu or auto\n"},
        {{"bench", "flock", "--least=2000", "--most=1000"},
         "skein bench: --least 2000 --most 1000: the first size is more than the last\n"},
        {{"bench", "swarm"}, "skein bench: there is no benchmark 'swarm': there is flock\n"},
        {{"run", "a.json", "--frames"}, "skein run: --frames takes N\n"},
        {{"run", "a.json", "--out"}, "skein run: --out takes FOLDER\n"},
        {{"run", "a.json", "--quiet=yes"}, "skein run: --quiet takes no value\n"},
        {{"check", "a.json", "--set"}, "skein check: --set takes PATH=VALUE\n"},
        {{"run", "a.json", "--frames", "many"}, "skein run: --frames many: expected a whole number\n"},
        {{"run", "a.json", "--frames", "5x"}, "skein run: --frames 5x: expected a whole number\n"},
        {{"run", "a.json", "--frames="}, "skein run: --frames : expected a whole number\n"},
        {{"run", "a.json", "--frames", "1.5"}, "skein run: --frames 1.5: expected a whole number, not 1.5\n"},
        {{"run", "a.json", "--frames", "-1"}, "skein run: --frames -1: -1 is out of range: expected from 0 to 1e+08\n"},
        {{"run", "a.json", "--fps", "0"}, "skein run: --fps 0: 0 is out of range: expected from 0.001 to 1e+06 1/s\n"},
        {{"run", "a.json", "--fps", "nan"},
         "skein run: --fps nan: nan is out of range: expected from 0.001 to 1e+06 1/s\n"},
        {{"run", "a.json", "--threads", "-1"}, "skein run: --threads -1: -1 is out of range: expected from 0 to 64\n"},
        {{"run", "a.json", "--threads", "65"}, "skein run: --threads 65: 65 is out of range: expected from 0 to 64\n"},
        {{"run", "no/such.json"}, "skein: no/such.json: cannot read: no such file or directory\n"},
        {{"list", "cats", "dogs"},
         "skein list: 'dogs' is one argument too many; "
         "usage: skein list [scenes|scene|bodies|constraints|forces|colliders|motions|methods|exporters|view|KIND] [--json]\n"},
        {{"list", "bodys"},
         "skein list: there is no list or kind 'bodys'; did you mean 'bodies'? "
         "usage: skein list [scenes|scene|bodies|constraints|forces|colliders|motions|methods|exporters|view|KIND] [--json]\n"},
        {{"list", "spere"},
         "skein list: there is no list or kind 'spere'; did you mean 'sphere'? "
         "usage: skein list [scenes|scene|bodies|constraints|forces|colliders|motions|methods|exporters|view|KIND] [--json]\n"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        const char *const *a = wrong[i].arguments;
        assert_says(2, "", wrong[i].words, a[0], a[1], a[2], a[3]);
    }
}

static void help_is_there_when_asked_for(void **state) {
    (void)state;
    static const char *const asking[] = {"--help", "-h", "help"};
    outcome top = SKEIN("--help");
    assert_status(top, 0);
    assert_string_equal(top.err, "");
    for (size_t i = 1; i < COUNT(asking); i++) assert_says(0, top.out, "", asking[i]);
    // without a word it is help, too, but no success
    assert_says(2, "", top.out, NULL);

    static const char *const commands[] = {"run", "render", "check", "compare", "stability", "explain", "list"};
    for (size_t c = 0; c < COUNT(commands); c++) {
        char words[64];
        snprintf(words, sizeof words, "\n  %s ", commands[c]);
        assert_contains(top.out, words);
        outcome o = SKEIN(commands[c], "--help");
        assert_status(o, 0);
        assert_string_equal(o.err, "");
        snprintf(words, sizeof words, "usage: skein %s ", commands[c]);
        assert_int_equal(strncmp(o.out, words, strlen(words)), 0);
        assert_true(longest_line(o.out) <= 120);
        assert_says(0, o.out, "", "help", commands[c]);
        assert_says(0, o.out, "", commands[c], "scenes/flag.json", "-h");
        outcome_free(&o);
    }
    static const char *const options[] = {"--out FOLDER",     "--frames N",    "--fps N", "--threads N",
                                          "--set PATH=VALUE", "--no-progress", "--help"};
    outcome o = SKEIN("run", "--help");
    for (size_t i = 0; i < COUNT(options); i++) {
        char words[64];
        snprintf(words, sizeof words, "\n  %s ", options[i]);
        assert_contains(o.out, words);
    }
    outcome_free(&o);
    assert_says(0, sizeof(skein_real) == 8 ? "skein " SKEIN_VERSION " (double)\n" : "skein " SKEIN_VERSION "\n", "",
                "--version");
    outcome_free(&top);
}

/* ---- check, explain, list ------------------------------------------------------------------------------ */

static void check_counts_what_is_there(void **state) {
    (void)state;
    char words[600];
    const char *s = tiny_scene();
    snprintf(words, sizeof words,
             "%s: good; 34 particles (4 pinned), 160 constraints, 1 force, 1 collider, xpbd; 0 warnings\n", s);
    // 5 x 5: 40 edges, 32 diagonals, 30 lines of three, 16 squares; 3 x 3: 12, 8, 6 and 4; and 12 more by what is set
    assert_says(0, words, "", "check", s, "--set",
                "constraints=[{\"type\":\"distance\",\"particles\":"
                "[0,25,1,26,2,27,3,28,4,29,5,30,6,31,7,32,8,33,9,25,10,26,11,27]}]");
}

static void check_takes_many_scenes(void **state) {
    (void)state;
    // one at fault keeps nobody from the others
    outcome o = SKEIN("check", "scenes/pendulum.json", "tests/bad/scenes/empty.json", tiny_scene());
    assert_status(o, 2);
    assert_contains(o.out, "scenes/pendulum.json: good; ");
    assert_contains(o.out, ": good; 34 particles");
    assert_contains(o.err, "skein: tests/bad/scenes/empty.json: the file is empty");
    outcome_free(&o);
    o = SKEIN("check", "scenes/pendulum.json", tiny_scene());
    assert_status(o, 0);
    outcome_free(&o);
}

/* A scene by its name, a mesh, standard input: every command that takes a scene takes them. */
static void scenes_have_names(void **state) {
    (void)state;
    static const char *const words[][2] = {{"pendulum", "scenes/pendulum.json"},
                                           {"pendulum.json", "scenes/pendulum.json"},
                                           {"meshes/ball.obj", "meshes/ball.obj"}};
    for (size_t i = 0; i < COUNT(words); i++) {
        char good[128];
        snprintf(good, sizeof good, "%s: good; ", words[i][1]);
        outcome o = SKEIN("check", words[i][0]);
        assert_status(o, 0);
        assert_int_equal(strncmp(o.out, good, strlen(good)), 0);
        outcome_free(&o);
        o = SKEIN("explain", words[i][0]);
        assert_status(o, 0);
        assert_contains(o.out, words[i][1]);
        outcome_free(&o);
        o = SKEIN("run", words[i][0], "--frames", "2");
        assert_status(o, 0);
        assert_contains(o.out, "; 2 frames, ");
        outcome_free(&o);
    }
    assert_true(hash_of(SKEIN("run", "pendulum", "--frames", "3")) ==
                hash_of(SKEIN("run", "scenes/pendulum.json", "--frames", "3")));
    assert_says(2, "", "skein: pendulun: there is no such file, and no scene of that name; did you mean 'pendulum'?\n",
                "run", "pendulun");
    assert_says(2, "", "skein: pendulun: there is no such file, and no scene of that name; did you mean 'pendulum'?\n",
                "check", "pendulun");
    assert_says(2, "", "skein: no/pendulum: cannot read: no such file or directory\n", "run", "no/pendulum");
}

/* The last vertex lies 2 m over the others; it falls on a ball below. Tetrahedra are a soft body. */
static void meshes_are_scenes(void **state) {
    (void)state;
    write_text(in_folder("tent.obj"), "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 2 1\nf 1 2 3 4\n");
    write_text(in_folder("one.node"), "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
    write_text(in_folder("one.ele"), "1 4 0\n0 0 1 2 3\n");
    outcome o = SKEIN("run", in_folder("tent.obj"), "--frames", "0", "--out", in_folder("out"), "--set", "output=[]");
    assert_status(o, 0);
    outcome_free(&o);
    o = SKEIN("check", in_folder("one.node"));
    assert_status(o, 0);
    assert_contains(o.out, ": good; 4 particles (0 pinned), ");
    outcome_free(&o);
    o = SKEIN("check", in_folder("tent.obj"), "--set", "bodies.mesh.density=0.1 kg/m2", "--set",
              "colliders.ball.radius=-1");
    assert_status(o, 2);
    assert_contains(o.err, "colliders.1.radius: -1 is out of range");
    outcome_free(&o);
    o = SKEIN("check", in_folder("none.obj"));
    assert_status(o, 2);
    assert_contains(o.err, "none.obj: cannot read: no such file or directory\n");
    outcome_free(&o);
}

static void scenes_come_from_standard_input(void **state) {
    (void)state;
    const char *s = tiny_scene();
    surroundings around = {.in = s};
    outcome o = SKEIN_IN(around, "check", "-");
    assert_status(o, 0);
    assert_contains(o.out, "standard input: good; 34 particles");
    outcome_free(&o);
    assert_true(hash_of(SKEIN_IN(around, "run", "-")) == hash_of(SKEIN("run", s)));
    // one that looks at the scene many times reads it once
    o = SKEIN_IN(around, "compare", "-", "--methods", "xpbd,pbd", "--steps", "4e-3", "--frames", "2");
    assert_status(o, 0);
    assert_contains(o.out, "\npbd ");
    outcome_free(&o);
    write_text(in_folder("broken"), "{");
    around.in = in_folder("broken");
    o = SKEIN_IN(around, "run", "-");
    assert_status(o, 2);
    assert_contains(o.err, "skein: standard input:1:1: ");
    outcome_free(&o);
}

/* Made from the tables, so that nothing can be missing; the shell itself says whether it can be read. */
static void shells_complete_every_option(void **state) {
    (void)state;
    static const char *const shells[] = {"bash", "zsh", "fish"};
    static const char *const options[] = {"most", "frames", "device", "no-progress", "json", "hessian"};
    outcome help = SKEIN("--help");
    for (size_t i = 0; i < COUNT(shells); i++) {
        char path[600], line[700];
        outcome o = SKEIN("completion", shells[i]);
        assert_status(o, 0);
        for (size_t k = 0; k < COUNT(options); k++) assert_contains(o.out, options[k]);
        for (const char *at = help.out; (at = strstr(at, "\n  ")) != NULL; at++) {
            char command[40] = "";
            if (sscanf(at + 3, "%39[a-z]", command) == 1 && strcmp(command, "skein") != 0)
                assert_contains(o.out, command);
        }
        snprintf(path, sizeof path, "%s", in_folder(shells[i]));
        write_text(path, o.out);
        snprintf(line, sizeof line, "if command -v %s >/dev/null; then %s -n '%s'; fi", shells[i], shells[i], path);
        assert_int_equal(system(line), 0);
        outcome_free(&o);
    }
    outcome_free(&help);
    // what bash makes of it
    char line[1500];
    snprintf(line, sizeof line,
             "if command -v bash >/dev/null; then PATH='%.*s':$PATH bash -c '. %s; COMP_WORDS=(skein run --devi); "
             "COMP_CWORD=2; _skein 2>/dev/null; [ \"${COMPREPLY[*]}\" = --device ] || exit 1; "
             "COMP_WORDS=(skein run --device g); COMP_CWORD=3; _skein; [ \"${COMPREPLY[*]}\" = gpu ] || exit 2; "
             "COMP_WORDS=(skein check pendu); COMP_CWORD=2; _skein 2>/dev/null; [ \"${COMPREPLY[0]}\" = pendulum ]'; fi",
             (int)(strrchr(SKEIN_COMMAND, '/') - SKEIN_COMMAND), SKEIN_COMMAND, in_folder("bash"));
    assert_int_equal(system(line), 0);
    assert_says(2, "", "skein completion: 'csh': expected bash, zsh or fish\n", "completion", "csh");
    outcome o = SKEIN("man");
    assert_status(o, 0);
    assert_contains(o.out, ".SH NAME\nskein \\- ");
    assert_contains(o.out, "\\-\\-no\\-progress\n");
    assert_contains(o.out, ".SS completion\n");
    outcome_free(&o);
}

static void tables_are_there_for_programs(void **state) {
    (void)state;
    outcome o = SKEIN("list", "--json");
    assert_status(o, 0);
    json_t *root = json_loads(o.out, 0, NULL);
    assert_non_null(root);
    for (size_t i = 0; skein_kind_at(SKEIN_METHOD, i); i++) {
        const json_t *kind = json_array_get(json_object_get(root, "methods"), i);
        assert_string_equal(text_of(kind, "name"), skein_kind_at(SKEIN_METHOD, i)->name);
        assert_int_equal(json_array_size(json_object_get(kind, "fields")), skein_kind_at(SKEIN_METHOD, i)->field_count);
    }
    json_decref(root);
    outcome_free(&o);
    o = SKEIN("list", "gravity", "--json");
    root = json_loads(o.out, 0, NULL);
    const json_t *field =
        json_array_get(json_object_get(json_array_get(json_object_get(root, "forces"), 0), "fields"), 0);
    assert_string_equal(text_of(field, "name"), "acceleration");
    assert_string_equal(text_of(field, "type"), "vec3");
    assert_string_equal(text_of(field, "unit"), "m/s2");
    assert_true(json_number_value(json_array_get(json_object_get(field, "default"), 1)) == -9.81);
    json_decref(root);
    outcome_free(&o);
    o = SKEIN("check", "pendulum", "tests/bad/scenes/fps_zero.json", "--json");
    assert_status(o, 2);
    root = json_loads(o.out, 0, NULL);
    assert_int_equal(json_array_size(root), 2);
    assert_true(json_is_true(json_object_get(json_array_get(root, 0), "good")));
    assert_true(number_of(json_array_get(root, 0), "particles") >= 2);
    assert_true(json_is_false(json_object_get(json_array_get(root, 1), "good")));
    assert_contains(json_string_value(json_array_get(json_object_get(json_array_get(root, 1), "faults"), 0)),
                    "fps: 0 is out of range");
    json_decref(root);
    outcome_free(&o);
    assert_says(0, "", "", "check", "pendulum", "--quiet");
}

static void explain_shows_every_kind_of_row(void **state) {
    (void)state;
    static const char *const kinds[] = {"combine",    "grid",       "field",     "neighbour", "force",
                                        "project",    "multiplier", "contact F", "contact V", "contact X",
                                        "contact XV", "limit",      "repeat"};
    bool seen[COUNT(kinds)] = {false};
    static const char *const methods[] = {"method={\"type\":\"symplectic_euler\"}",
                                          "method={\"type\":\"xpbd\",\"iterations\":2}"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        outcome o = SKEIN("explain", tiny_scene(), "--set", methods[m], "--set",
                          "forces=[{\"type\":\"gravity\"},{\"type\":\"separation\"}]", "--fps", "60");
        assert_status(o, 2); // --fps is of `run` only
        outcome_free(&o);
        o = SKEIN("explain", tiny_scene(), "--set", methods[m], "--set",
                  "forces=[{\"type\":\"gravity\"},{\"type\":\"separation\"}]", "--set", "fps=30");
        assert_status(o, 0);
        assert_string_equal(o.err, "");
        assert_contains(o.out, m == 0 ? ": symplectic_euler, a step of 0.0166667 s, 2 a frame\n"
                                      : ": xpbd, a step of 0.0166667 s, 2 a frame\n");
        assert_contains(o.out, "= ball, ");
        assert_contains(o.out, " elements, ordered\n");
        assert_true(longest_line(o.out) <= 120);
        for (size_t k = 0; k < COUNT(kinds); k++) {
            char words[32];
            snprintf(words, sizeof words, "\n    %s ", kinds[k]);
            seen[k] |= strstr(o.out, words) != NULL;
            snprintf(words, sizeof words, "\n%s ", kinds[k]);
            seen[k] |= strstr(o.out, words) != NULL;
        }
        outcome_free(&o);
    }
    for (size_t k = 0; k < COUNT(kinds); k++)
        if (!seen[k]) fail_msg("no plan has an op '%s'", kinds[k]);
}

/* The field has a line of its own behind `at`, with its help's first word. */
static void expect_field(const char *at, const skein_field *field) {
    char words[64];
    snprintf(words, sizeof words, "\n    %-18s ", field->name);
    const char *line = strstr(at, words);
    if (!line) fail_msg("no field '%s' in\n%s", field->name, at);
    size_t length = strcspn(line + 1, "\n"), first = strcspn(field->help, " ");
    snprintf(words, sizeof words, " %.*s", (int)first, field->help);
    const char *found = strstr(line + 23, words);
    if (!found || found > line + 1 + length) fail_msg("no help in '%.*s'", (int)length, line + 1);
    if (field->unit[0] && ((found = strstr(line + 23, field->unit)) == NULL || found > line + 1 + length))
        fail_msg("no unit '%s'", field->unit);
}

static void expect_kind(const char *text, const skein_kind *kind) {
    char words[64];
    snprintf(words, sizeof words, "\n  %s: ", kind->name);
    const char *at = strstr(text, words);
    if (!at) fail_msg("no kind '%s'", kind->name);
    const char *end = strstr(at, "\n\n");
    char *block = strndup(at, end ? (size_t)(end - at) : strlen(at));
    for (size_t i = 0; i < kind->field_count; i++) expect_field(block, &kind->fields[i]);
    free(block);
    if (SPARING) return;
    // and alone
    outcome o = SKEIN("list", kind->name);
    assert_status(o, 0);
    assert_contains(o.out, words);
    size_t common_count;
    const skein_field *common = skein_common_fields(kind->category, &common_count);
    for (size_t i = 0; i < common_count; i++)
        if (skein_kind_takes(kind, common[i].name)) expect_field(o.out, &common[i]);
    outcome_free(&o);
}

static void list_shows_every_kind_and_field(void **state) {
    (void)state;
    static const char *const words[] = {"bodies",  "constraints", "forces",    "colliders", "motions",
                                        "methods", "scene",       "exporters", "view"};
    outcome all = SKEIN("list");
    assert_status(all, 0);
    assert_string_equal(all.err, "");
    assert_true(longest_line(all.out) <= 120);
    size_t length = 0;
    for (int c = 0; c < SKEIN_CATEGORY_COUNT; c++) {
        outcome o = SKEIN("list", words[c]);
        assert_status(o, 0);
        assert_contains(all.out, o.out);
        length += strlen(o.out);
        for (size_t i = 0; skein_kind_at((skein_category)c, i); i++)
            expect_kind(o.out, skein_kind_at((skein_category)c, i));
        for (size_t i = 0; c == SKEIN_EXPORTER && io_exporter_at(i); i++) expect_kind(o.out, io_exporter_at(i));
        if (c == SKEIN_SCENE) expect_kind(o.out, io_scene_kind());
        for (size_t i = 0; c == SKEIN_SCENE && io_scene_section_at(i); i++)
            assert_contains(o.out, io_scene_section_at(i)->name);
        size_t common_count;
        const skein_field *common = skein_common_fields((skein_category)c, &common_count);
        for (size_t i = 0; i < common_count; i++) expect_field(o.out, &common[i]);
        outcome_free(&o);
    }
    assert_int_equal(strlen(all.out), length);
    // a build without pictures says so
    assert_true(strstr(all.out, "\n    wireframe  ") ||
                strstr(all.out, "view\n\n  this skein was built without pictures"));
    assert_contains(all.out, "\n    stiffness          10000 N/m        0 to infinite      force a metre of stretch;");
    assert_contains(all.out, "\n    restitution        0                0 to 1             ");
    assert_contains(all.out, "\n    normals            area             area|uniform|angle what ");
    outcome_free(&all);
}

/* A kind's own list has nothing that the kind refuses, and what all have says who does. */
static void list_shows_what_is_taken(void **state) {
    (void)state;
    static const char *const refused[] = {"colliders", "inertia", "jump", "jump_turn", "jump_times"};
    char words[64];
    outcome text = SKEIN("list", "attach"), json = SKEIN("list", "attach", "--json"), turn = SKEIN("list", "turn"),
            all = SKEIN("list", "motions");
    for (size_t i = 0; i < COUNT(refused); i++) {
        snprintf(words, sizeof words, "\n    %s ", refused[i]);
        assert_null(strstr(text.out, words));
        assert_contains(turn.out, words);
        assert_contains(strstr(all.out, words), "(not in attach)");
        snprintf(words, sizeof words, "\"name\": \"%s\"", refused[i]);
        assert_null(strstr(json.out, words));
    }
    assert_contains(text.out, "\n    max_distance ");
    assert_contains(json.out, "\"name\": \"max_distance\"");
    assert_null(strstr(turn.out, "(not in"));
    outcome_free(&text), outcome_free(&json), outcome_free(&turn), outcome_free(&all);
}

/* Each scene of the folder is there, with all of its own words. */
static void list_tells_of_scenes(void **state) {
    (void)state;
    outcome o = SKEIN("list", "scenes"), json = SKEIN("list", "scenes", "--json");
    assert_status(o, 0);
    assert_status(json, 0);
    assert_true(longest_line(o.out) <= 120);
    json_t *root = json_loads(json.out, 0, NULL), *list = json_object_get(root, "scenes"), *one;
    size_t i, files = 0;
    DIR *scenes = opendir(SKEIN_SOURCE_DIR "/scenes");
    assert_non_null(scenes);
    for (struct dirent *entry; (entry = readdir(scenes)) != NULL;) files += strstr(entry->d_name, ".json") != NULL;
    closedir(scenes);
    assert_int_equal(json_array_size(list), files);
    json_array_foreach(list, i, one) {
        char head[80];
        const char *words = json_string_value(json_object_get(one, "description"));
        json_t *file = json_load_file(json_string_value(json_object_get(one, "file")), 0, NULL);
        assert_string_equal(words, json_string_value(json_object_get(file, "description")));
        json_decref(file);
        snprintf(head, sizeof head, "\n  %s ", json_string_value(json_object_get(one, "name")));
        const char *row = strstr(o.out, head);
        assert_non_null(row);
        // word by word, however the lines are broken
        for (row += strlen(head); *words; words += strcspn(words, " "), words += strspn(words, " ")) {
            size_t length = strcspn(words, " ");
            row += strspn(row, " \n");
            assert_int_equal(strncmp(row, words, length), 0);
            row += length;
        }
    }
    json_decref(root);
    outcome_free(&o);
    outcome_free(&json);
}

/* ---- Progress ------------------------------------------------------------------------------------------ */

static int count_words(const char *text, const char *words) {
    int count = 0;
    for (; (text = strstr(text, words)) != NULL; text++) count++;
    return count;
}

static void progress_is_shown(void **state) {
    (void)state;
    const char *s = tiny_scene();
    // in a file: ten lines
    outcome o = SKEIN("run", s, "--frames", "20");
    assert_int_equal(count_words(o.err, "\n"), 10);
    assert_int_equal(strncmp(o.err, "[###...........................] frame 2 of 20, ", 48), 0);
    assert_contains(o.err, "\n[##############################] frame 20 of 20, ");
    outcome_free(&o);
    o = SKEIN("run", s, "--frames", "3");
    assert_int_equal(count_words(o.err, "\n"), 3);
    outcome_free(&o);
    o = SKEIN("run", s, "--frames", "3", "--no-progress");
    assert_string_equal(o.err, "");
    assert_contains(o.out, "3 frames");
    outcome_free(&o);

    // on a terminal: one line, drawn again in place
    int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(terminal >= 0);
    assert_int_equal(grantpt(terminal) || unlockpt(terminal), 0);
    int end = open(ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(end >= 0);
    o = SKEIN_IN((surroundings){.err = end}, "run", s, "--frames", "20");
    assert_status(o, 0);
    char text[8192];
    ssize_t length = read(terminal, text, sizeof text - 1);
    assert_true(length > 0);
    text[length] = 0;
    assert_int_equal(strncmp(text, "\r[#.............................] frame 1 of 20, ", 49), 0);
    assert_int_equal(count_words(text, "\n"), 1);
    assert_contains(text, "\r[##############################] frame 20 of 20, ");
    close(end);
    close(terminal);
    outcome_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(wrong_arguments_are_told),
        TEST(help_is_there_when_asked_for),
        TEST(check_counts_what_is_there),
        TEST(check_takes_many_scenes),
        TEST(scenes_have_names),
        TEST(meshes_are_scenes),
        TEST(scenes_come_from_standard_input),
        TEST(shells_complete_every_option),
        TEST(tables_are_there_for_programs),
        TEST(explain_shows_every_kind_of_row),
        TEST(list_shows_every_kind_and_field),
        TEST(list_shows_what_is_taken),
        TEST(list_tells_of_scenes),
        TEST(progress_is_shown),
    };
    return cmocka_run_group_tests_name("command", tests, NULL, NULL);
}
