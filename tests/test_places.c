/* Where scenes and modules are looked for. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "helpers.h"
#include "io/places.h"

static char home[IO_PLACE_SIZE], folder[] = "/tmp/skein-places-XXXXXX";

/* A folder of our own, and in it. */
static int enter(void **state) {
    (void)state;
    unsetenv("SKEIN_SCENES");
    unsetenv("SKEIN_MODULES");
    strcpy(folder + strlen(folder) - 6, "XXXXXX");
    return !getcwd(home, sizeof home) || !mkdtemp(folder) || chdir(folder);
}

static int leave(void **state) {
    (void)state;
    remove("scenes/one.json");
    rmdir("scenes");
    return chdir(home) || rmdir(folder);
}

static void write_file(const char *path) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fclose(file);
}

/* Whether one of the folders is `wanted`; how many there are in `count`. */
static bool among_scenes(const char *wanted, size_t *count) {
    char path[IO_PLACE_SIZE];
    bool found = false;
    for (*count = 0; io_scenes_folder(*count, path); ++*count) found |= !strcmp(path, wanted);
    return found;
}

static void scenes_of_the_current_folder_come_first(void **state) {
    char path[IO_PLACE_SIZE];
    size_t count, before;
    (void)state;
    assert_false(among_scenes("scenes", &before));
    assert_int_equal(mkdir("scenes", 0777), 0);
    assert_false(among_scenes("scenes", &count)); // nothing in it is a scene
    assert_int_equal(count, before);
    write_file("scenes/one.json");
    assert_true(among_scenes("scenes", &count));
    assert_int_equal(count, before + 1);
    assert_true(io_scenes_folder(0, path));
    assert_string_equal(path, "scenes");
}

static void a_variable_overrides_all_folders(void **state) {
    char path[IO_PLACE_SIZE];
    size_t count;
    (void)state;
    assert_int_equal(mkdir("scenes", 0777), 0);
    write_file("scenes/one.json");
    setenv("SKEIN_SCENES", "/nowhere/mine", 1);
    assert_true(among_scenes("/nowhere/mine", &count));
    assert_int_equal(count, 1);
    setenv("SKEIN_SCENES", "", 1); // as if it were not set
    assert_true(among_scenes("scenes", &count));
    setenv("SKEIN_MODULES", "/nowhere/modules", 1);
    assert_true(io_modules_folder(0, path));
    assert_string_equal(path, "/nowhere/modules");
    assert_false(io_modules_folder(1, path));
}

static void a_folder_is_told_once(void **state) {
    char here[IO_PLACE_SIZE], build[IO_PLACE_SIZE], path[IO_PLACE_SIZE];
    size_t count;
    (void)state;
    assert_true(io_modules_folder(0, build)); // the program's own folder
    assert_int_equal(chdir(build), 0);
    assert_non_null(getcwd(here, sizeof here));
    assert_string_equal(here, build);
    unlink("scenes"); // of a run that was killed
    assert_int_equal(symlink(SKEIN_SOURCE_DIR "/scenes", "scenes"), 0);
    bool beside = among_scenes("scenes", &count);
    bool twice = false;
    for (size_t i = 1; i < count; i++) twice |= io_scenes_folder(i, path) && !strcmp(path, SKEIN_SOURCE_DIR "/scenes");
    unlink("scenes");
    assert_int_equal(chdir(folder), 0);
    assert_true(beside);
    assert_false(twice);
}

static void scenes_beside_the_program_are_found(void **state) {
    char build[IO_PLACE_SIZE], link[IO_PLACE_SIZE + 16], real[IO_PLACE_SIZE];
    size_t count;
    (void)state;
    assert_true(io_modules_folder(0, build));
    snprintf(link, sizeof link, "%s/scenes", build);
    unlink(link); // of a run that was killed
    assert_int_equal(symlink(SKEIN_SOURCE_DIR "/scenes", link), 0);
    assert_non_null(realpath(link, real));
    bool found = among_scenes(real, &count);
    unlink(link);
    assert_true(found);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(scenes_of_the_current_folder_come_first, enter, leave),
        cmocka_unit_test_setup_teardown(a_variable_overrides_all_folders, enter, leave),
        cmocka_unit_test_setup_teardown(a_folder_is_told_once, enter, leave),
        cmocka_unit_test_setup_teardown(scenes_beside_the_program_are_found, enter, leave),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
