/* skein run on the ranks of an MPI job: the hash of one process, whatever the ranks and threads; balanced anew on the way;
 * broken off, and gone on with by another number of ranks; and what cannot be shared is said. */
#include "ranks.h"
#include "test_command.h"

#include <math.h>

#ifdef SKEIN_MPIRUN

static int frames = 160;

/* mpirun's words, and the command's: in `said`. Returns the exit status. */
static int run_ranks(int ranks, const char *arguments, char **said) {
    char command[2400];
    snprintf(
        command, sizeof command,
        "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 timeout 1500 %s --oversubscribe --mca mpi_yield_when_idle 1 -n %d %s run %s >%s 2>&1",
        SKEIN_MPIRUN, ranks, SKEIN_COMMAND, arguments, in_folder("said"));
    int status = system(command);
    *said = read_text(in_folder("said"));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The report of a run. */
static json_t *report_of(const char *out) {
    char path[700];
    snprintf(path, sizeof path, "%s/report.json", out);
    json_t *report = json_load_file(path, 0, NULL);
    if (!report) fail_msg("%s is not there", path);
    return report;
}

static void check_same_hash(const char *a, const char *b) {
    json_t *one = report_of(a), *other = report_of(b);
    assert_string_equal(json_string_value(json_object_get(one, "state_hash")),
                        json_string_value(json_object_get(other, "state_hash")));
    json_decref(one), json_decref(other);
}

/* A flock that is drawn together and apart, flies round and through cuts, and hits a floor. */
static const char *flock(void) {
    static char path[512];
    char text[1200];
    snprintf(path, sizeof path, "%s/flock.json", folder);
    snprintf(
        text, sizeof text,
        "{'frames': %d, 'fps': 60, 'method': {'type': 'symplectic_euler', 'substeps': 1}, 'bodies': [{'type': "
        "'flock', 'count': 700, 'spread': [60, 14, 40], 'speed': 3, 'swirl': 6}], 'forces': [{'type': "
        "'flocking', 'separation': 2, 'alignment': 1.5, 'cohesion': 2}, {'type': 'attraction', 'strength': 4}, "
        "{'type': 'speed_limit', 'limit': 9}], 'colliders': [{'type': 'plane', 'offset': -6, 'motion.velocity': [0, 0.3, 0], "
        "'restitution': 0.8}], 'output': []}",
        frames);
    write_scene(path, text);
    return path;
}

/* By one process. */
static const char *whole(void) {
    static char path[512];
    if (path[0]) return path;
    snprintf(path, sizeof path, "%s/whole", folder);
    outcome o = SKEIN("run", flock(), "--out", path, "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    return path;
}

static void any_ranks_have_the_hash_of_one_process(void **state) {
    (void)state;
    static const int counts[] = {2, 3, 4, 8};
    for (size_t i = 0; i < COUNT(counts); i++) {
        char arguments[1200], out[512], *said;
        snprintf(out, sizeof out, "%s/ranks%d", folder, counts[i]);
        snprintf(arguments, sizeof arguments, "%s --out %s --no-progress --threads %d", flock(), out, i == 1 ? 3 : 1);
        if (run_ranks(counts[i], arguments, &said)) fail_msg("%s", said);
        check_same_hash(whole(), out);
        json_t *report = report_of(out), *ranks = json_object_get(report, "ranks");
        assert_int_equal(json_integer_value(json_object_get(ranks, "count")), counts[i]);
        assert_true(json_integer_value(json_object_get(ranks, "cuts")) >= 2); // where costs were known, at the latest
        assert_true(json_integer_value(json_object_get(ranks, "moved")) > 20);
        assert_true(json_integer_value(json_object_get(ranks, "most_own")) < 700);
        assert_true(json_integer_value(json_object_get(ranks, "most_memory")) > 1000000);
        assert_true(json_real_value(json_object_get(ranks, "bytes_per_step")) > 0);
        json_decref(report);
        assert_contains(said, "ranks: ");
        assert_null(strstr(strstr(said, "state hash ") + 1, "state hash ")); // one rank speaks
        free(said);
    }
}

static void one_rank_is_one_process(void **state) {
    (void)state;
    char arguments[1200], *said;
    snprintf(arguments, sizeof arguments, "%s --out %s/one --no-progress", flock(), folder);
    if (run_ranks(1, arguments, &said)) fail_msg("%s", said);
    check_same_hash(whole(), in_folder("one"));
    free(said);
}

/* Other rules: a view, the nearest few, forces between neighbours, and methods that look several times a step. */
static void rules_and_methods_have_it_too(void **state) {
    (void)state;
    static const char *const methods[] = {"{'type': 'rk4', 'substeps': 2}", "{'type': 'xpbd', 'substeps': 3}"};
    char text[2000], scene[512], arguments[1200], *said;
    snprintf(scene, sizeof scene, "%s/rules.json", folder);
    for (size_t i = 0; i < COUNT(methods); i++) {
        snprintf(
            text, sizeof text,
            "{'frames': 40, 'method': %s, 'bodies': [{'type': 'flock', 'side': 20, 'spread': [12, 6, 9], 'mass': 0.2}], "
            "'forces': [{'type': 'flocking', 'separation': 0.6, 'alignment': 0.5, 'cohesion': 0.9, 'view': 270, "
            "'nearest': 7}, {'type': 'separation', 'radius': 0.4, 'strength': 3}, {'type': 'turn_limit'}, {'type': "
            "'gravity'}, {'type': 'drag'}], 'colliders': [{'type': 'sphere', 'radius': 2}], 'output': ['obj']}",
            methods[i]);
        write_scene(scene, text);
        outcome o = SKEIN("run", scene, "--out", in_folder("rules"), "--quiet");
        assert_status(o, 0);
        outcome_free(&o);
        snprintf(arguments, sizeof arguments, "%s --out %s --quiet", scene, in_folder("rules_by_ranks"));
        if (run_ranks(3, arguments, &said)) fail_msg("%s", said);
        free(said);
        check_same_hash(in_folder("rules"), in_folder("rules_by_ranks"));
        char *a = read_text(in_folder("rules/flock.obj")), *b = read_text(in_folder("rules_by_ranks/flock.obj"));
        assert_string_equal(a, b);
        free(a), free(b);
    }
}

/* Runs a scene by one process and by ranks; with so many bodies that live on one rank each. */
static void check_bodies(const char *name, const char *text, int whole_bodies) {
    static const int counts[] = {2, 3, 4, 8};
    char scene[512], one[512], arguments[1400], *said;
    snprintf(scene, sizeof scene, "%s/%s.json", folder, name);
    snprintf(one, sizeof one, "%s/%s", folder, name);
    write_scene(scene, text);
    outcome o = SKEIN("run", scene, "--out", one, "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    for (size_t i = 0; i < COUNT(counts); i++) {
        if (frames <= 500 && i == 2) continue; // on 8 ranks far more of others come at once than anybody has of its own
        char out[540];
        snprintf(out, sizeof out, "%s_by_%d", one, counts[i]);
        snprintf(arguments, sizeof arguments, "%s --out %s --no-progress --threads %d", scene, out, i == 1 ? 2 : 1);
        if (run_ranks(counts[i], arguments, &said)) fail_msg("%s", said);
        free(said);
        check_same_hash(one, out);
        json_t *report = report_of(out), *ranks = json_object_get(report, "ranks");
        assert_int_equal(json_integer_value(json_object_get(ranks, "whole_bodies")), whole_bodies);
        json_decref(report);
    }
}

#define CLOTHS \
    "{'type': 'cloth', 'name': 'net', 'grid': [14, 17], 'size': [12, 12], 'position': [0, 1, 0], 'pins': 'corners'}, "

static void bodies_that_meet_nobody_are_dealt_to_ranks(void **state) {
    (void)state;
    check_bodies(
        "dealt",
        "{'frames': 30, 'method': {'type': 'xpbd', 'substeps': 4}, 'bodies': [" CLOTHS
        "{'type': 'cloth', 'name': 'sail', 'grid': [9, 21], 'position': [3, 2, 0], 'rotation': [20, 10, 0], 'pins': 'top "
        "edge'}, {'type': 'rope', 'pins': 'first'}, {'type': 'cloth', 'grid': [8, 9], 'position': [9, 2, 0], "
        "'stretch.limit': 0.05, 'stretch.tether': 0.02, 'pins': 'corners'}], 'motions': [{'type': 'turn', 'on': 'sail', "
        "'axis': [0, 1, 0], 'speed': 1, 'centre': [3, 2, 0]}], 'forces': [{'type': 'gravity'}, {'type': 'surface_wind', 'velocity': [3, 0, "
        "1]}], 'colliders': [{'type': 'plane', 'offset': -0.2}], 'output': []}",
        4);
}

/* All look at each other: birds of two flocks, and a net and a rope that live on one rank each. */
static void flocks_and_bodies_meet_across_ranks(void **state) {
    (void)state;
    check_bodies(
        "meet",
        "{'frames': 20, 'method': {'type': 'xpbd', 'substeps': 4}, 'bodies': [" CLOTHS
        "{'type': 'flock', 'name': 'a', 'count': 260, 'spread': [14, 6, 14], 'speed': 3, 'swirl': 6}, {'type': 'rope', "
        "'name': 'line', 'from': [-6, 2, 0], 'to': [6, 2, 0], 'pins': 'first'}, {'type': 'flock', 'name': 'b', 'count': "
        "150, 'spread': [10, 8, 12], 'speed': 5, 'swirl': -4}], 'forces': [{'type': 'flocking', 'on': 'a', "
        "'separation': 2, 'alignment': 1.5, 'cohesion': 2}, {'type': 'flocking', 'on': 'b', 'neighbours': 'a', "
        "'separation': 2, 'alignment': 1, 'cohesion': 2}, {'type': 'flocking', 'on': 'a', 'neighbours': 'net', "
        "'separation': 2, 'alignment': 0, 'cohesion': 0, 'strength': 3}, {'type': 'flocking', 'on': 'net', "
        "'neighbours': 'b', 'separation': 2, 'alignment': 1, 'cohesion': 0}, {'type': 'separation', 'radius': 1.5, "
        "'strength': 0.02}, {'type': 'attraction', 'on': 'a', 'strength': 4}, {'type': 'attraction', 'on': 'b', 'strength': 4}, {'type': 'gravity', 'on': 'net, "
        "line'}], 'output': []}",
        2);
}

/* A flock looks at itself, and then at a cloth that lives elsewhere: what comes for the first look must leave the cloth's places, which the
 * world has in blocks then, alone. */
static void one_look_after_another_has_it_too(void **state) {
    (void)state;
    static const char *const methods[] = {"method.substeps=3", "method={\"type\":\"symplectic_euler\",\"substeps\":30}"};
    for (size_t i = 0; i < COUNT(methods); i++) {
        char arguments[1200], *said;
        outcome o = SKEIN("run", "scenes/gulls.json", "--frames", "3", "--set", "output=[]", "--set", methods[i],
                          "--out", in_folder("looks"), "--quiet");
        assert_status(o, 0);
        outcome_free(&o);
        snprintf(arguments, sizeof arguments,
                 "scenes/gulls.json --frames 3 --set 'output=[]' --set '%s' --threads 1 --quiet --out %s", methods[i],
                 in_folder("looks_by_ranks"));
        for (int ranks = 2; ranks <= 3; ranks++) {
            if (run_ranks(ranks, arguments, &said)) fail_msg("%s", said);
            free(said);
            check_same_hash(in_folder("looks"), in_folder("looks_by_ranks"));
        }
    }
}

static void what_cannot_be_shared_is_said(void **state) {
    (void)state;
    char *said;
    assert_int_equal(run_ranks(2, "scenes/heap.json --frames 2", &said), 2);
    assert_contains(said, "cannot share a run with contact: ");
    free(said);
    assert_int_equal(run_ranks(2, "scenes/drape.json --frames 2 --set method.type=backward_euler", &said), 2);
    assert_contains(said, "cannot share a run with a method that solves for all particles at once (backward Euler): ");
    assert_contains(said, "a method that solves nothing");
    free(said);
    assert_int_equal(run_ranks(2, "scenes/birds.json --frames 2 --set method.budget_ms=5", &said), 2);
    assert_contains(said, "say how many");
    free(said);
    assert_int_equal(run_ranks(2, "scenes/birds.json --frames 2 --device gpu", &said), 2);
    assert_contains(said, "ranks of an MPI job step on processors");
    free(said);
}

/* The bytes of a file. */
static unsigned char *bytes_of(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file) fail_msg("%s is not there", path);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*size + 1);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

/* Reads `count` items of an XDMF's data item, as its attributes say. */
static void read_item(const char *folder_of_index, const char *item, size_t size, size_t count, void *out) {
    char name[200], path[900];
    size_t at = 0, all;
    assert_int_equal(sscanf(strstr(item, "Seek="), "Seek=\"%zu\"", &at), 1);
    assert_int_equal(sscanf(strchr(item, '>') + 1, "%199[^<]", name), 1);
    snprintf(path, sizeof path, "%s/%s", folder_of_index, name);
    unsigned char *bytes = bytes_of(path, &all);
    assert_true(at + size * count <= all);
    memcpy(out, bytes + at, size * count);
    free(bytes);
}

/* Each rank's file and the index have, frame by frame, what the run has: the last one is that of the mesh that is written. */
static void ranks_write_their_own(void **state) {
    (void)state;
    char arguments[1400], *said;
    snprintf(arguments, sizeof arguments, "%s --frames 20 --set 'output=[\"obj\"]' --out %s --parts --no-progress",
             flock(), in_folder("own"));
    if (run_ranks(3, arguments, &said)) fail_msg("%s", said);
    free(said);
    char own_folder[512];
    snprintf(own_folder, sizeof own_folder, "%s/own", folder);
    char *index = read_text(in_folder("own/parts.xdmf")), *mesh = read_text(in_folder("own/flock.obj"));
    static double place[700][3], as_written[700][3];
    int frames_there = 0, written = 0, seen = 0;
    for (char *at = index; (at = strstr(at, "<Time ")) != NULL; at++) frames_there++;
    assert_int_equal(frames_there, 20);
    assert_contains(index, "</Xdmf>");
    for (char *line = mesh; line && written < 700; line = strchr(line, '\n'), line = line ? line + 1 : NULL)
        if (sscanf(line, "v %lf %lf %lf", &as_written[written][0], &as_written[written][1], &as_written[written][2]) ==
            3)
            written++;
    assert_int_equal(written, 700);
    char *last = index;
    for (char *at = index; (at = strstr(at, "<Time ")) != NULL; at++) last = at;
    for (char *grid = last; (grid = strstr(grid, "NumberOfElements=")) != NULL; grid++) {
        size_t n = 0;
        assert_int_equal(sscanf(grid, "NumberOfElements=\"%zu\"", &n), 1);
        char *xyz = strstr(grid, "<DataItem"), *number = strstr(xyz + 1, "<DataItem");
        skein_real(*p)[3] = calloc(n, sizeof *p);
        uint32_t *numbers = calloc(n, sizeof *numbers);
        read_item(own_folder, xyz, sizeof **p, 3 * n, p);
        read_item(own_folder, number, sizeof *numbers, n, numbers);
        for (size_t i = 0; i < n; i++, seen++) {
            assert_true(numbers[i] < 700);
            for (int k = 0; k < 3; k++) place[numbers[i]][k] = (double)p[i][k];
        }
        free(p), free(numbers);
    }
    assert_int_equal(seen, 700);
    for (int i = 0; i < 700; i++)
        for (int k = 0; k < 3; k++) assert_true(fabs(place[i][k] - as_written[i][k]) < 1e-4);
    free(index), free(mesh);
    outcome o = SKEIN("run", flock(), "--out", in_folder("alone"), "--parts");
    assert_status(o, 2);
    assert_contains(o.err, "the ranks of an MPI job write them");
    outcome_free(&o);
}

static void a_rank_that_dies_ends_the_run_and_another_number_goes_on(void **state) {
    (void)state;
    char arguments[1200], *said, scene[512];
    snprintf(scene, sizeof scene, "%s/killed.json", folder);
    char *text = read_text(flock());
    write_text(scene, text);
    free(text);
    snprintf(arguments, sizeof arguments, "%s --out %s --no-progress --snapshots 20", scene, in_folder("killed"));
    pid_t job = fork();
    assert_true(job >= 0);
    if (job == 0) _exit(run_ranks(3, arguments, &said) == 0 ? 0 : 9);
    pid_t victim = 0;
    struct timespec pause = {0, 20000000};
    for (int tries = 0; tries < 10000; tries++) {
        if (exists(in_folder("killed/resume")) && count_entries(in_folder("killed/resume")) > 2 &&
            (victim = find_rank(scene, "1")) > 0)
            break;
        nanosleep(&pause, NULL);
    }
    assert_true(victim > 0);
    assert_int_equal(kill(victim, SIGKILL), 0);
    int status;
    assert_int_equal(waitpid(job, &status, 0), job);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 9);
    said = read_text(in_folder("said"));
    assert_contains(said, "signal 9");
    free(said);
    assert_false(exists(in_folder("killed/report.json")));
    snprintf(arguments, sizeof arguments, "--resume %s --no-progress", in_folder("killed"));
    if (run_ranks(2, arguments, &said)) fail_msg("%s", said);
    free(said);
    check_same_hash(whole(), in_folder("killed"));
}

/* All that come along: each has one hash, or is refused, as these are. */
static void every_scene_has_one_hash_or_is_refused(void **state) {
    (void)state;
    static const char *const refused[] = {"cantilever", "funnel", "heap",   "layers", "reef",
                                          "ribbons",    "statue", "tables", "tear",   "twist"};
    DIR *scenes = opendir("scenes");
    int shared = 0;
    size_t said_no = 0, missing = 0; // the latter where no mesh was fetched: `make demo` does so
    assert_non_null(scenes);
    for (struct dirent *entry; (entry = readdir(scenes)) != NULL;) {
        char name[200], arguments[1200], path[400], *said;
        size_t length = strlen(entry->d_name);
        if (length < 6 || length > 100 || strcmp(entry->d_name + length - 5, ".json") != 0) continue;
        snprintf(name, sizeof name, "%.*s", (int)length - 5, entry->d_name),
            snprintf(path, sizeof path, "scenes/%s", entry->d_name);
        outcome o = SKEIN("run", path, "--frames", "3", "--set", "output=[]", "--out", in_folder("scene"), "--quiet");
        bool there = o.status == 0;
        if (!there && !strstr(o.err, "tools/fetch-mesh"))
            fail_msg("%s: %s", name, o.err); // it needs a mesh that does not come along
        outcome_free(&o);
        missing += !there;
        if (!there) continue;
        snprintf(arguments, sizeof arguments, "%s --frames 3 --set 'output=[]' --threads 1 --quiet --out %s", path,
                 in_folder("by_ranks"));
        int status = run_ranks(3, arguments, &said);
        bool no = false;
        for (size_t i = 0; i < COUNT(refused); i++) no |= !strcmp(name, refused[i]);
        if (status != (no ? 2 : 0)) fail_msg("%s: exit status %d: %s", name, status, said);
        if (no) assert_contains(said, "cannot share a run with ");
        else check_same_hash(in_folder("scene"), in_folder("by_ranks"));
        said_no += no, shared += !no;
        free(said);
    }
    closedir(scenes);
    assert_true(said_no + missing >= COUNT(refused) && said_no <= COUNT(refused));
    assert_true(shared >= 25);
}

/* What a rank has in memory follows its own birds, not all of them: over eight it is far less than over two. */
static void memory_follows_own_birds(void **state) {
    (void)state;
    static const int counts[] = {2, 8};
    json_int_t took[2];
    for (int i = 0; i < 2; i++) {
        char arguments[1200], *said;
        snprintf(arguments, sizeof arguments,
                 "scenes/birds.json --set bodies.0.side=0 --set bodies.0.count=400000 --set 'output=[]' "
                 "--set 'bodies.0.spread=[80,80,1600]' --frames 2 --threads 1 --quiet --out %s",
                 in_folder("memory"));
        if (run_ranks(counts[i], arguments, &said)) fail_msg("%s", said);
        free(said);
        json_t *report = report_of(in_folder("memory"));
        took[i] = json_integer_value(json_object_get(json_object_get(report, "ranks"), "most_memory"));
        json_decref(report);
    }
    print_message("%lld and %lld bytes a rank\n", (long long)took[0], (long long)took[1]);
    assert_true(took[1] < took[0] / 2);
}

/* FRAMES: of the flock, where a thousand steps are wanted; or "scenes": all that come along. */
int main(int argc, char **argv) {
    const struct CMUnitTest of_scenes[] = {cmocka_unit_test(every_scene_has_one_hash_or_is_refused)};
    if (argc > 1 && !strcmp(argv[1], "scenes")) return cmocka_run_group_tests(of_scenes, make_folder, remove_folder);
    if (argc > 1) frames = (int)strtol(argv[1], NULL, 10);
    if (getenv("SKEIN_TEST_ONLY")) cmocka_set_test_filter(getenv("SKEIN_TEST_ONLY"));
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_ranks_have_the_hash_of_one_process),
        cmocka_unit_test(one_rank_is_one_process),
        cmocka_unit_test(rules_and_methods_have_it_too),
        cmocka_unit_test(bodies_that_meet_nobody_are_dealt_to_ranks),
        cmocka_unit_test(flocks_and_bodies_meet_across_ranks),
        cmocka_unit_test(one_look_after_another_has_it_too),
        cmocka_unit_test(ranks_write_their_own),
        cmocka_unit_test(memory_follows_own_birds),
        cmocka_unit_test(what_cannot_be_shared_is_said),
        cmocka_unit_test(a_rank_that_dies_ends_the_run_and_another_number_goes_on),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

#else

static void there_is_no_mpi(void **state) {
    (void)state;
    skip();
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(there_is_no_mpi)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
#endif
