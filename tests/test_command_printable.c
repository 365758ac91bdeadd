/* Nothing that a scene says steers a terminal: control characters, those of UTF-8 too, never reach what is printed, and
 * other letters are printed as they are. */
#include "test_command.h"

#include "io/printable.h"

static void letters_stay_and_controls_do_not(void **state) {
    (void)state;
    static const char *const texts[][2] = {
        {"plain ~", "plain ~"},
        {"T\xc3\xbc"
         "ch \xe5\xb8\x83 \xf0\x9f\x90\xa6",
         "T\xc3\xbc"
         "ch \xe5\xb8\x83 \xf0\x9f\x90\xa6"},
        {"a\x1b[31mb\x7f", "a?[31mb?"},
        {"a\nb\tc\rd", "a?b?c?d"},
        {"\xc2\x9b"
         "31m\xc2\x80\xc2\x9f\xc2\xa0",
         "?31m??\xc2\xa0"},                          // the controls of Latin-1; the space after them is none
        {"\x9b\xff\xc3", "???"},                     // bytes that are no UTF-8, and half a letter
        {"\xc0\x9b\xe0\x82\x9b", "?????"},           // the same control, spelt too long
        {"\xed\xa0\x80\xf4\x90\x80\x80", "???????"}, // no letters: a surrogate, and beyond the last one
        {"\xe2\x80\xae"
         "x\xe2\x81\xa6y\xe2\x80\xa8z",
         "?x?y?z"}, // turned round, and a line's end
    };
    for (size_t i = 0; i < COUNT(texts); i++) {
        char text[64];
        snprintf(text, sizeof text, "%s", texts[i][0]);
        io_printable(text, false);
        assert_string_equal(text, texts[i][1]);
    }
    char lines[] = "a\n\tb\r";
    io_printable(lines, true);
    assert_string_equal(lines, "a\n\tb?");
}

/* Every line's every letter may be printed. */
static void assert_harmless(const char *text) {
    for (size_t left = strlen(text); left > 0;) {
        bool fine;
        size_t length = io_printable_letter(text, left, &fine);
        if (!fine) fail_msg("this steers a terminal: %.60s", text);
        text += length;
        left -= length;
    }
}

static void no_label_steers_the_terminal(void **state) {
    (void)state;
    // an escape, a new line with a lie, a control of UTF-8, and letters that stay
    static const char label[] = "b\\u001b[31m\\nskein: all is well\\u009b5mT\\u00fcch\\u5e03\\u202e";
    char scene[2000];
    snprintf(
        scene, sizeof scene,
        "{ 'name': '%s', 'frames': 1,\n"
        "  'bodies': [ { 'type': 'flock', 'name': '%s', 'count': 20 }, { 'type': 'cloth', 'name': '%s', 'grid': [3, 3] } ],\n"
        "  'forces': [ { 'type': 'flocking', 'name': '%s' }, { 'type': 'gravity', 'name': '%s' } ],\n"
        "  'colliders': [ { 'type': 'plane', 'name': '%s' } ], 'output': ['obj', 'pc2', 'hdf5'] }\n",
        label, label, label, label, label, label);
    char *path = in_folder("labels.json");
    write_scene(path, scene);
    const char *const runs[][8] = {
        {"run", path, "--out", in_folder("out")},
        {"explain", path},
        {"check", path},
        {"explain", path, "--device", "gpu"},
        {"run", path, "--set", "forces.0.on=c\x1b[2J"},
        {"run", path, "--set", "bodies.1.mesh=\xc2\x9b.obj"},
        {"run", path, "--set", "method.type=explicit_euler", "--set", "bodies.1.stretch.stiffness=1e30"},
        {"run", "no\x1b[2J\xc2\x9b.json"},
        {"run", path, "--no\x1b[2J"},
        {"no\x1b[2J"},
        {"run", path, "--out", in_folder("o\x1b]0;mine\x07")},
    };
    bool readable[COUNT(runs)];
    for (size_t i = 0; i < COUNT(runs); i++) {
        pid_t child = start_skein((surroundings){0}, runs[i]);
        outcome o = finish_skein(child);
        assert_harmless(o.out);
        assert_harmless(o.err);
        assert_null(strstr(o.out, "\nskein: all"));
        assert_null(strstr(o.err, "\nskein: all"));
        readable[i] = strstr(o.out, "T\xc3\xbc"
                                    "ch\xe5\xb8\x83") ||
                      strstr(o.err, "T\xc3\xbc"
                                    "ch\xe5\xb8\x83");
        outcome_free(&o);
    }
    assert_true(readable[0] && readable[1]);
}

/* A message that is cut may be cut within a letter: what is left of that is none. */
static void a_text_that_is_cut_stays_text(void **state) {
    (void)state;
    char *text = calloc(1, 30000), *scene = malloc(60000);
    for (int i = 0; i < 6000; i++) strcat(text + 3 * i, "\xe5\xb8\x83");
    snprintf(scene, 60000, "{ 'bodies': [ { 'type': 'cloth', 'grid': [3, 3], 'pins': '%s' } ] }", text);
    write_scene(in_folder("long.json"), scene);
    outcome o = SKEIN("check", in_folder("long.json"));
    assert_status(o, 2);
    assert_harmless(o.err);
    assert_contains(o.err, "\xe5\xb8\x83\xe5\xb8\x83");
    outcome_free(&o);
    free(text);
    free(scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(letters_stay_and_controls_do_not),
        TEST(no_label_steers_the_terminal),
        TEST(a_text_that_is_cut_stays_text),
    };
    return cmocka_run_group_tests_name("printable", tests, NULL, NULL);
}
