/* Every scene that comes with Skein under every method, through the command: it runs to a state that can be, or is
 * refused or fails with words that say what to do. None ends silently with edges of more than twice their length. */
#include "test_command.h"

#include "io/scene.h"

static bool says_what_helps(const char *err) {
    static const char *const remedies[] = {"set method.substeps to ", "take another method",
                                           "give it a stiffness or use"};
    for (size_t i = 0; i < COUNT(remedies); i++)
        if (strstr(err, remedies[i])) return true;
    return false;
}

/* Whether its substeps are too long for it, as the run says when it begins: it will blow up, and what has takes up to a second a frame where
 * surfaces meet. */
static bool is_too_coarse(const char *scene, const char *set) {
    outcome o = SKEIN("run", scene, "--json", "--no-progress", "--frames", "0", "--set", set);
    const bool coarse = strstr(o.err, " is stable with substeps of ") != NULL;
    outcome_free(&o);
    return coarse;
}

static void judge(const char *scene, const char *method) {
    char set[64];
    // a solve takes a hundred times as long as any other step, and has no limit
    bool solves = !strcmp(method, "backward_euler");
    snprintf(set, sizeof set, "method.type=%s", method);
    const char *frames = solves ? "1" : is_too_coarse(scene, set) ? "6" : "30";
    outcome o = SKEIN("run", scene, "--json", "--no-progress", "--frames", frames, "--set", set);
    if (o.status == 0) {
        json_t *report = json_loads(o.out, 0, NULL);
        assert_non_null(report);
        if (!(number_of(report, "max_stretch") <= 1)) fail_msg("%s under %s: %s", scene, method, o.out);
        json_decref(report);
    } else if ((o.status != 1 && o.status != 2) || !says_what_helps(o.err)) {
        fail_msg("%s under %s: status %d: %s", scene, method, o.status, o.err);
    }
    outcome_free(&o);
}

static void every_scene_under_every_method(void **state) {
    (void)state;
    enum { MOST = 256 };
    static char names[MOST][IO_SCENE_NAME_SIZE];
    size_t count = io_scene_names(names, MOST), ran = 0;
    for (size_t s = 0; s < count; s++) {
        if (!strcmp(names[s], "elephant") || !strcmp(names[s], "statue")) continue; // meshes have to be fetched
        for (size_t m = 0; skein_kind_at(SKEIN_METHOD, m); m++, ran++)
            judge(names[s], skein_kind_at(SKEIN_METHOD, m)->name);
    }
    printf("%zu runs of %zu scenes\n", ran, count);
    assert_true(ran > 200);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_scene_under_every_method, make_folder, remove_folder),
    };
    return cmocka_run_group_tests_name("every method", tests, NULL, NULL);
}
