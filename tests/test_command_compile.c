/* Tests of `skein run --compile`: a C compiler where there is one, the cache, and what happens where something is wrong
 * with either. Runs end with the same state, whatever runs their formulas. */
#include "test_command.h"

static const char rope[] =
    "{ 'frames': 3, 'output': [],\n"
    "  'bodies': [ { 'type': 'rope', 'name': 'rope', 'count': 40, 'pins': 'first' } ],\n"
    "  'forces': [ { 'type': 'gravity' } ],\n"
    "  'constraints': [ { 'type': 'formula', 'particles': { 'body': 'rope', 'over': 'edges' },\n"
    "    'constraint': 'length(p0 - p1) - L * (1 + 0.2 * sin(t))', 'parameters': { 'L': 0.0417 }, 'stiffness': 900 } ],\n"
    "  'most_stretch': 10 }\n";

static const char other[] = "constraints.0.constraint=length(p0 - p1) - 0.6 * L";

/* A scene, and an empty cache that has a blank in its path. */
static const char *scene, *cache;
static void begin(void) {
    scene = in_folder("rope.json"), cache = in_folder("a cache/of formulas");
    write_scene(scene, rope);
    setenv("SKEIN_CACHE", cache, 1);
    unsetenv("CC");
}

/* A compiler that takes less time: what it makes of a formula is as right. */
static void hasten(void) {
    char *hasty = in_folder("hasty");
    write_text(hasty, "#!/bin/sh\nexec cc \"$@\" -O1\n");
    assert_int_equal(chmod(hasty, 0700), 0);
    setenv("CC", hasty, 1);
}

/* The one file in the cache. */
static char *cached(void) {
    DIR *open_folder = opendir(cache);
    assert_non_null(open_folder);
    char *path = in_folder("nothing");
    for (struct dirent *entry; (entry = readdir(open_folder)) != NULL;)
        if (entry->d_name[0] != '.') snprintf(path, 512, "%s/%s", cache, entry->d_name);
    closedir(open_folder);
    return path;
}

/* Runs the scene with --compile; it must say that, and end with the state. */
static void check(uint64_t hash, const char *words) {
    outcome o = SKEIN("run", scene, "--compile");
    assert_contains(o.err, words);
    assert_true(hash_of(o) == hash);
}

static void compiled_once_and_kept(void **state) {
    (void)state;
    begin();
    uint64_t hash = hash_of(SKEIN("run", scene));
    check(hash, "skein: compiled formulas: 1 by cc in ");
    assert_int_equal(count_entries(cache), 1);
    setenv("CC", "/bin/false", 1); // nobody asks it
    check(hash, "skein: compiled formulas: 1 from ");
    outcome o = SKEIN("run", scene, "--compile", "--no-progress");
    assert_string_equal(o.err, "");
    assert_true(hash_of(o) == hash);
    // another number is not another formula, another text is
    o = SKEIN("run", scene, "--compile", "--set", "constraints.0.parameters.L=0.05");
    assert_contains(o.err, "1 from ");
    assert_true(hash_of(o) != hash);
    o = SKEIN("run", scene, "--compile", "--set", other);
    assert_contains(o.err, "warning: --compile: a formula stays on its tape: /bin/false failed (status 1)");
    assert_true(hash_of(o) != hash);
}

/* What lies in the cache is only loaded if it is whole, the right one, and nobody else's. */
static void bad_files_are_made_anew(void **state) {
    (void)state;
    begin();
    uint64_t hash = hash_of(SKEIN("run", scene));
    hasten();
    outcome o = SKEIN("run", scene, "--compile", "--set", other);
    assert_status(o, 0);
    outcome_free(&o);
    char *wrong = in_folder("wrong.so");
    assert_int_equal(rename(cached(), wrong), 0);
    check(hash, "1 by ");
    char *path = cached(), bytes[4096];
    assert_true(exists(path));
    setenv("CC", "/bin/false", 1);
    const char *const refused = "a formula stays on its tape";

    struct stat whole;
    assert_int_equal(stat(path, &whole), 0);
    assert_int_equal(chmod(path, 0722), 0); // others may write it
    check(hash, refused);
    assert_int_equal(chmod(path, 0700), 0);
    check(hash, "1 from ");
    if (geteuid() == 0) { // another user's
        assert_int_equal(chown(path, 12345, (gid_t)-1), 0);
        check(hash, refused);
        assert_int_equal(chown(path, 0, (gid_t)-1), 0);
        check(hash, "1 from ");
    }
    assert_int_equal(chmod(cache, 0777), 0); // others may put files there
    check(hash, "warning: --compile: nothing is kept for the next time: others than you can write in ");
    assert_int_equal(chmod(cache, 0700), 0);

    int file = open(path, O_RDWR); // one byte of it is another
    assert_int_equal(pread(file, bytes, 1, whole.st_size / 2), 1);
    bytes[0] ^= 1;
    assert_int_equal(pwrite(file, bytes, 1, whole.st_size / 2), 1);
    check(hash, refused);
    assert_int_equal(ftruncate(file, whole.st_size / 2), 0); // half of it is missing
    check(hash, refused);
    assert_int_equal(ftruncate(file, 0), 0);
    check(hash, refused);
    close(file);
    assert_int_equal(unlink(path), 0); // a link, and another formula under its name
    assert_int_equal(symlink(wrong, path), 0);
    check(hash, refused);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rename(wrong, path), 0);
    check(hash, refused);
    hasten();
    check(hash, "1 by ");
    setenv("CC", "/bin/false", 1);
    check(hash, "1 from ");
    assert_int_equal(count_entries(cache), 1);
}

/* Nor if others could put it there. */
static void what_others_can_put_in_its_place_is_not_loaded(void **state) {
    (void)state;
    begin();
    uint64_t hash = hash_of(SKEIN("run", scene));
    hasten();
    check(hash, "1 by ");
    setenv("CC", "/bin/false", 1);
    char *path = cached(), *right = in_folder("right.so"), *above = in_folder("a cache");
    check(hash, "1 from ");
    assert_int_equal(rename(path, right), 0); // a link, to what is whole, right and one's own
    assert_int_equal(symlink(right, path), 0);
    check(hash, "a formula stays on its tape");
    assert_int_equal(unlink(path) || rename(right, path), 0);
    check(hash, "1 from ");
    assert_int_equal(chmod(above, 0777), 0); // others may rename the cache, and put theirs in its place
    check(hash, "warning: --compile: nothing is kept for the next time: others than you can write in ");
    assert_int_equal(chmod(above, 01777), 0); // as in /tmp: nobody can rename what is another's
    check(hash, "1 from ");
}

static void without_a_compiler_tapes_run(void **state) {
    (void)state;
    begin();
    uint64_t hash = hash_of(SKEIN("run", scene));
    setenv("CC", "/nowhere/cc -m64", 1);
    check(hash,
          "skein: warning: --compile: there is no C compiler ($CC, cc, gcc, clang): formulas run on their tapes\n");
    char *liar = in_folder("a liar");
    write_text(liar, "#!/bin/sh\nwhile [ $# -gt 1 ]; do [ \"$1\" != -o ] || echo nothing > \"$2\"; shift; done\n");
    assert_int_equal(chmod(liar, 0700), 0);
    setenv("CC", liar, 1);
    check(hash, "stays on its tape: "); // what it made is no code
    char *loud = in_folder("loud");
    write_text(loud, "#!/bin/sh\necho formula.c:1: I do not like it >&2\nexit 3\n");
    assert_int_equal(chmod(loud, 0700), 0);
    setenv("CC", loud, 1);
    check(hash, "failed (status 3)\n    formula.c:1: I do not like it\n");
    hasten();
    setenv("SKEIN_CACHE", in_folder("rope.json/cache"), 1); // under a file there is no folder
    outcome o = SKEIN("run", scene, "--compile");
    assert_contains(o.err, "warning: --compile: nothing is kept for the next time: ");
    assert_contains(o.err, "skein: compiled formulas: 1 by ");
    assert_true(hash_of(o) == hash);
    // no temporary file is left
    setenv("TMPDIR", folder, 1);
    int entries = count_entries(folder);
    setenv("CC", "/bin/false", 1);
    check(hash, "stays on its tape");
    assert_int_equal(count_entries(folder), entries);
    unsetenv("TMPDIR");
    o = SKEIN("run", tiny_scene(), "--compile");
    assert_contains(o.err, "skein: --compile: no constraint of the scene is a formula\n");
    assert_status(o, 0);
    outcome_free(&o);
}

/* Ctrl-C goes to both: the compiler ends, then the folder is gone, and then the command ends. */
static void an_interrupted_compiler_leaves_nothing(void **state) {
    (void)state;
    begin();
    char *slow = in_folder("slow"), *number = in_folder("number"), text[1100];
    mkdir(in_folder("temporary"), 0700);
    setenv("TMPDIR", in_folder("temporary"), 1);
    snprintf(text, sizeof text, "#!/bin/sh\necho $$ > %s.new && mv %s.new %s\nexec sleep 100\n", number, number, number);
    write_text(slow, text);
    assert_int_equal(chmod(slow, 0700), 0);
    setenv("CC", slow, 1);
    const char *const arguments[] = {"run", scene, "--compile", NULL};
    pid_t skein = start_skein((surroundings){0}, arguments);
    const struct timespec pause = {0, 10000000};
    for (int i = 0; i < 3000 && !exists(number); i++) nanosleep(&pause, NULL);
    char *words = read_text(number);
    int compiler = atoi(words);
    free(words);
    assert_true(compiler > 1);
    assert_int_equal(count_entries(in_folder("temporary")), 1);
    assert_int_equal(kill(skein, SIGINT), 0);
    assert_int_equal(kill(compiler, SIGINT), 0);
    outcome o = finish_skein(skein);
    assert_true(o.status == -SIGINT || o.status == 128 + SIGINT);
    assert_int_equal(count_entries(in_folder("temporary")), 0);
    outcome_free(&o);
    unsetenv("TMPDIR");
    unsetenv("CC");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(compiled_once_and_kept, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(bad_files_are_made_anew, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_others_can_put_in_its_place_is_not_loaded, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(without_a_compiler_tapes_run, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(an_interrupted_compiler_leaves_nothing, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
