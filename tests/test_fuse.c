/* Fusing looks at ops and at nothing else, and changes no bit: each scene steps the same with and without. */
#include <dirent.h>

#include "helpers.h"
#include "io/scene.h"
#include "plan/fuse.h"
#include "world/world.h"

/* ---- ops by hand ---- */

enum { SLOTS = 64 };
static const double h = 0.01;

static sk_op combine(sk_op_kind kind, sk_vector dst, double a, sk_vector p, double b, sk_vector q) {
    return (sk_op){.kind = kind,
                   .order = SK_FREE,
                   .kernel = sk_op_types[kind].kernels->version[0],
                   .dst = dst,
                   .source = {p, q, SK_NONE},
                   .coefficient = {a, b, 0},
                   .dt = h,
                   .end = SLOTS};
}

static const sk_uniform_force falling = {.acceleration = {0, -9.81, 0}, .label = "gravity"};

/* A whole substep: a pull or a kick, the saves, the drift, something that moves X, and what V learns of it. */
typedef struct substep {
    sk_op ops[8];
    size_t count;
} substep;

static substep usual(bool pulls, sk_vector looks) {
    sk_op pull = combine(SK_OP_PULL, SK_V, 0, SK_V, 0, SK_NONE);
    pull.rule = &falling;
    sk_op project = {
        .kind = SK_OP_PROJECT, .order = SK_ORDERED, .dst = SK_X, .source = {SK_X, looks}, .dt = h, .end = 3};
    substep s = {{{.kind = SK_OP_REPEAT, .end = 10, .dt = h},
                  pulls ? pull : combine(SK_OP_KICK, SK_V, h, SK_V, 0, SK_F),
                  combine(SK_OP_SUM, SK_X0, 1, SK_X, 0, SK_NONE),
                  combine(SK_OP_SUM, SK_V0, 1, SK_V, 0, SK_NONE),
                  combine(SK_OP_SUM, SK_X, 1, SK_X, h, SK_V),
                  project,
                  combine(SK_OP_CORRECTION, SK_V, 1 / h, SK_X, h, SK_X0)},
                 7};
    s.ops[0].length = s.count - 1;
    return s;
}

/* The plan's ops after fusing, a word each. */
static const char *fused(const substep *s) {
    static const char *const words[SK_OP_KIND_COUNT] = {
        [SK_OP_PULL] = "pull ",
        [SK_OP_KICK] = "kick ",
        [SK_OP_SUM] = "sum ",
        [SK_OP_PREDICT_UNIFORM] = "fall ",
        [SK_OP_CORRECT_AND_PREDICT] = "fall_on ",
        [SK_OP_PREDICT] = "predict ",
        [SK_OP_CORRECTION] = "correct ",
        [SK_OP_PROJECT] = "project ",
        [SK_OP_PART] = "part ",
    };
    static char text[256];
    skein_world *world = new_world("xpbd", 1); // its allocator
    sk_plan plan = {.data = NULL};
    for (size_t r = 0; r < s->count; r++) assert_true(sk_plan_add(&plan, &world->allocator, s->ops[r]));
    assert_true(sk_plan_fuse(&plan, &world->allocator, 0));
    text[0] = 0;
    for (size_t r = 0; r < plan.count; r++) {
        const sk_op *op = &plan.data[r];
        char word[32];
        if (op->kind == SK_OP_REPEAT) snprintf(word, sizeof word, "repeat%zu ", op->length);
        else snprintf(word, sizeof word, "%s", words[op->kind]);
        // its kernel is that of its kind
        const sk_kernels *kernels = sk_op_type_of(op)->kernels;
        if (kernels) assert_true((op->inner ? op->inner : op->kernel) == kernels->version[0]);
        strcat(text, word);
    }
    sk_release(&world->allocator, plan.data);
    skein_world_destroy(world);
    return text;
}

static void rows_that_say_one_thing_become_one(void **state) {
    (void)state;
    substep s = usual(true, SK_NONE);
    assert_string_equal(fused(&s), "fall repeat2 project fall_on ");
    s = usual(false, SK_NONE);
    assert_string_equal(fused(&s), "repeat3 predict project correct "); // F is another one in each substep
    // whoever else looks at the start of the substep keeps it
    s = usual(true, SK_X0);
    assert_string_equal(fused(&s), "repeat3 fall project correct ");
    s = usual(true, SK_V0);
    assert_string_equal(fused(&s), "repeat3 fall project correct ");
}

static void what_is_no_prediction_stays(void **state) {
    (void)state;
    static const char same[] = "repeat6 pull sum sum sum project correct ";
    substep s = usual(true, SK_NONE);
    s.ops[4].coefficient[1] = 2 * h; // it drifts for longer
    assert_string_equal(fused(&s), same);
    s = usual(true, SK_NONE);
    s.ops[2].source[0] = SK_V; // saves something else
    assert_string_equal(fused(&s), same);
    s = usual(true, SK_NONE);
    s.ops[1].inner = s.ops[1].kernel, s.ops[1].end_slot = 30; // pulls a part only
    s.ops[1].kernel = sk_run_partly;
    assert_true(strstr(fused(&s), "fall") == NULL);
    s = usual(false, SK_NONE);
    s.ops[1].coefficient[0] = h / 2; // kicks by half
    assert_true(strstr(fused(&s), "predict") == NULL);
    s = usual(true, SK_NONE);
    s.ops[6].coefficient[1] = 0; // learns from where X stood
    assert_string_equal(fused(&s), "repeat3 fall project correct ");
    s = usual(true, SK_NONE);
    s.ops[0].kind = SK_OP_PART; // what a solve has run is not looked at
    assert_true(strstr(fused(&s), "fall") == NULL);
}

/* ---- scenes ---- */

static size_t op_count;

static void count_row(void *user, const char *line) {
    (void)user, (void)line;
    op_count++;
}

static void report(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

/* The hash after some steps, and the ops of the plan. */
static uint64_t hash_of(const char *path, const char *method, bool fuse, size_t *rows) {
    static const skein_kind *const none[] = {NULL};
    io_faults faults = {report, NULL, 0, NULL};
    io_scene *scene = io_scene_read(path, NULL, none, &faults);
    assert_non_null(scene);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    assert_true(world && !faults.count);
    if (method) OK(world, skein_method_set(world, method, NULL));
    skein_world_fuse(world, fuse);
    double dt;
    io_scene_steps_per_frame(io_scene_get(scene), &dt);
    op_count = 0;
    OK(world, skein_world_explain(world, dt, count_row, NULL));
    *rows = op_count;
    steps(world, 12, dt);
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    io_scene_free(scene);
    return hash;
}

static void every_scene_has_the_same_bits_with_and_without(void **state) {
    (void)state;
    static const char *const methods[] = {NULL, "pbd"};
    size_t fewer = 0, scenes = 0;
    DIR *folder = opendir("scenes");
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (!strstr(entry->d_name, ".json") || strstr(entry->d_name, "elephant") || strstr(entry->d_name, "statue"))
            continue; // meshes are fetched
        char path[300];
        snprintf(path, sizeof path, "scenes/%s", entry->d_name);
        for (size_t m = 0; m < COUNT(methods); m++) {
            size_t with, without;
            uint64_t one = hash_of(path, methods[m], true, &with), other = hash_of(path, methods[m], false, &without);
            if (one != other) print_message("%s, %s\n", path, methods[m] ? methods[m] : "its own method");
            assert_true(one == other);
            assert_true(with <= without);
            fewer += with < without;
            scenes++;
        }
    }
    closedir(folder);
    assert_true(scenes > 40 && fewer > scenes / 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_that_say_one_thing_become_one),
        cmocka_unit_test(what_is_no_prediction_stays),
        cmocka_unit_test(every_scene_has_the_same_bits_with_and_without),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
