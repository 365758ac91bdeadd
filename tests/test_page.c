/* What JavaScript calls (bindings/js/exports.c), compiled for this machine and linked with nothing but what skein.wasm is made
 * of: a source that is missing there, or a scene that goes another way than the command's, shows in every build. What of it is
 * JavaScript's is tried by tools/npm. */
#define _GNU_SOURCE
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct js_scene js_scene;
js_scene *js_new(void);
void *js_take(size_t size);
void js_give(void *memory);
bool js_file_add(js_scene *js, const char *path, char *bytes, size_t size);
bool js_open(js_scene *js, const char *text, size_t size, const char *path, const char *const *sets, int threads);
char *js_faults(js_scene *js);
bool js_step(js_scene *js, int steps);
uint64_t js_hash(const js_scene *js);
void js_close(js_scene *js);

enum { FRAMES = 5 };

static char *contents(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = js_take(*size);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static uint64_t of_the_command(const char *path) {
    char *line = NULL;
    assert_true(asprintf(&line, SKEIN_COMMAND " run %s --frames %d 2>&1", path, FRAMES) > 0);
    FILE *said = popen(line, "r");
    assert_non_null(said);
    char words[4096] = "";
    words[fread(words, 1, sizeof words - 1, said)] = 0;
    assert_int_equal(pclose(said), 0);
    free(line);
    const char *at = strstr(words, "state hash ");
    assert_non_null(at);
    return strtoull(at + strlen("state hash "), NULL, 16);
}

static void check(const char *path, bool is_mesh) {
    js_scene *js = js_new();
    assert_non_null(js);
    size_t size;
    char *bytes = contents(path, &size);
    if (is_mesh) assert_true(js_file_add(js, path, bytes, size));
    if (!js_open(js, is_mesh ? NULL : bytes, is_mesh ? 0 : size, path, NULL, 2))
        fail_msg("%s: %s", path, js_faults(js));
    if (!is_mesh) js_give(bytes);
    assert_true(js_step(js, FRAMES));
    assert_true(js_hash(js) == of_the_command(path));
    js_close(js);
}

static void scenes_go_as_in_the_command(void **state) {
    (void)state;
    check("scenes/hanging.json", false);
    check("scenes/tear.json", false);
    check("scenes/birds.json", false);
    check("meshes/lace.obj", true);
}

static void a_group_where_one_body_is_meant_is_said_to_be_one(void **state) {
    (void)state;
    static const char text[] = "{\"bodies\": [{\"type\": \"cloth\", \"grid\": [3, 3], \"groups\": \"soft\"}],"
                               " \"view\": {\"camera\": {\"follow\": \"soft\"}}}";
    js_scene *js = js_new();
    assert_non_null(js);
    assert_false(js_open(js, text, sizeof text - 1, "groups.json", NULL, 1));
    char *faults = js_faults(js);
    if (!strstr(faults, "it is the name of a group")) fail_msg("%s", faults);
    js_give(faults);
    js_close(js);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_go_as_in_the_command),
        cmocka_unit_test(a_group_where_one_body_is_meant_is_said_to_be_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
