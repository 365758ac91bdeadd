/* skein study as its users run it: by several processes, killed and taken up again, in parts, on ranks. Its tables are
 * read by the HDF5 library, which had no part in writing them. */
#include "test_command.h"

#include <math.h>
#include <sys/wait.h>
#ifdef SKEIN_HDF5
#include <hdf5.h>
#endif

enum { ROWS = 24 };

/* Cloths that swing, some of them blow up. A row takes some hundredths of a second. */
static const char *swings(void) {
    static char path[512];
    snprintf(path, sizeof path, "%s/swings.json", folder);
    write_scene(
        path,
        "{'study': 1, 'scene': {'frames': 40, 'bodies': [{'type': 'cloth', 'name': 'sheet', 'grid': [12, 12], 'pins': "
        "'left edge', 'stretch': {'stiffness': 1000}}], 'forces': [{'type': 'gravity'}], "
        "'output': ['obj']}, 'vary': {'bodies.sheet.density': {'from': 0.1, 'to': 0.6, 'count': 6}, "
        "'method.type': ['xpbd', 'rk4'], 'bodies.sheet.position': [[0, 0, 0], [0, 1, 0]]}, 'measure': ['lowest', "
        "{'measure': 'kinetic_energy', 'over': 'most'}, 'max_stretch'], 'plot': {'show': ['lowest']}}");
    return path;
}

static void check_same_file(const char *one, const char *other, const char *name) {
    char a[700], b[700];
    snprintf(a, sizeof a, "%s/%s", one, name), snprintf(b, sizeof b, "%s/%s", other, name);
    io_bytes x, y;
    skein_error error;
    if (io_file_read(a, 1 << 28, &x, &error) || io_file_read(b, 1 << 28, &y, &error))
        fail_msg("%s: %s", error.where, error.message);
    if (x.size != y.size || memcmp(x.data, y.data, x.size) != 0)
        fail_msg("%s differs from %s:\n%s\n%s", b, a, y.data, x.data);
    io_bytes_free(&x), io_bytes_free(&y);
}

static void check_same_tables(const char *one, const char *other) {
    check_same_file(one, other, "table.csv");
    check_same_file(one, other, "table.h5");
}

/* The study by one process, without a break; all others are to come out so. */
static const char *whole(void) {
    static char path[512];
    if (path[0]) return path;
    snprintf(path, sizeof path, "%s/whole", folder);
    outcome o = SKEIN("study", swings(), "--out", path, "--jobs", "1");
    assert_status(o, 0);
    assert_contains(o.out, "24 of 24 rows are there: ");
    assert_contains(o.out, "wrote table.csv, table.h5");
    assert_contains(o.err, "row 24 of 24");
    outcome_free(&o);
    return path;
}

/* The cell of a line and a column, both from 0; cells with commas stand in quotes. */
static void cell(const char *csv, int line, const char *column, char out[700]) {
    int place = -1;
    for (int l = 0; *csv; l++) {
        for (int c = 0;; c++) {
            size_t n = 0;
            bool quoted = *csv == '"';
            for (csv += quoted; *csv && (quoted ? *csv != '"' || csv[1] == '"' : !strchr(",\n", *csv)); csv++) {
                if (quoted && *csv == '"') csv++;
                if (n + 1 < 700) out[n++] = *csv;
            }
            out[n] = 0;
            csv += quoted;
            if (l == 0 && !strcmp(out, column)) place = c;
            if (l == line + 1 && c == place) return;
            if (*csv++ != ',') break;
        }
    }
    fail_msg("there is no cell %d of %s", line, column);
}

/* Its command, in its folder, ends with its hash; its scene is there, and its measures are the report's. */
static void a_row_is_done_again_by_its_command(void **state) {
    (void)state;
    char path[700], command[1500], hash[700], out[700], lowest[700], outcome_of[700], density[700];
    snprintf(path, sizeof path, "%s/table.csv", whole());
    char *csv = read_text(path);
    int blown = 0, good = 0;
    for (int row = 0; row < ROWS; row++) {
        cell(csv, row, "outcome", outcome_of), cell(csv, row, "lowest", lowest), cell(csv, row, "state_hash", hash);
        cell(csv, row, "command", out), cell(csv, row, "bodies.sheet.density", density);
        assert_true(fabs(strtod(density, NULL) - 0.1 * (1 + row / 4)) < 1e-15);
        bool is_good = !strcmp(outcome_of, "good");
        assert_true(is_good || !strcmp(outcome_of, "blew up") || !strcmp(outcome_of, "beyond bounds"));
        blown += !is_good, good += is_good;
        if (strcmp(outcome_of, "blew up") == 0) assert_string_equal(lowest, "nan");
        if (row % 5 != 3 || !is_good) continue;
        assert_int_equal(strncmp(out, "skein run scene.json --set ", 27), 0);
        snprintf(command, sizeof command, "cd %s && %s%s --json --quiet >../again.json", whole(), SKEIN_COMMAND,
                 out + 5);
        assert_int_equal(system(command), 0);
        json_t *report = read_report(in_folder("again.json"));
        assert_string_equal(text_of(report, "state_hash"), hash);
        cell(csv, row, "max_stretch", out);
        assert_true(fabs(number_of(report, "max_stretch") - strtod(out, NULL)) < 1e-8);
        json_decref(report);
    }
    assert_true(good >= 12 && blown > 0); // there are both
    free(csv);
    assert_false(exists(in_folder("whole/sheet.obj"))); // a study writes no files of its runs
}

/* Two lines of a list of words, with numbers in them. */
static void a_plot_shows_the_rows(void **state) {
    (void)state;
    char path[700];
    snprintf(path, sizeof path, "%s/plot.gnuplot", whole());
    char *script = read_text(path);
    assert_contains(script, "set xlabel 'bodies.sheet.density'");
    assert_contains(script, "title 'xpbd'");
    assert_true(strstr(script, "kinetic_energy") == NULL);
    free(script);
    snprintf(path, sizeof path, "%s/plot.svg", whole());
    if (system("gnuplot --version >/dev/null 2>&1") != 0) return;
    char *svg = read_text(path);
    assert_contains(svg, "lowest (m)");
    free(svg);
}

/* Cells of a map that have no row that ran stay empty, and all others where they are: gnuplot complains of a grid that is too small
 * where it is not given the empty ones. */
static void a_map_keeps_the_cells_of_rows_that_failed(void **state) {
    (void)state;
    char path[700];
    write_scene(in_folder("map.json"),
                "{'study': 1, 'scene': {'frames': 2, 'bodies': [{'type': 'rope', 'count': 5}]}, 'vary': "
                "{'bodies.0.stretch.stiffness': [100, 1000, -5], 'method.substeps': [5, 0]}, 'measure': ['lowest']}");
    outcome o = SKEIN("study", in_folder("map.json"), "--out", in_folder("map"), "--quiet");
    assert_status(o, 1);
    assert_contains(o.err, "4 rows refused");
    assert_null(strstr(o.err, "warning"));
    outcome_free(&o);
    snprintf(path, sizeof path, "%s/plot.gnuplot", in_folder("map"));
    char *script = read_text(path);
    assert_contains(script, "with image");
    assert_contains(script, "2 1 nan");
    assert_null(strstr(script, "missing"));
    free(script);
}

static void several_processes_make_the_same_table(void **state) {
    (void)state;
    char out[512];
    snprintf(out, sizeof out, "%s", in_folder("three"));
    outcome o = SKEIN("study", swings(), "--out", out, "--jobs", "3", "--threads", "2", "--no-progress");
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    outcome_free(&o);
    check_same_tables(whole(), out);
    o = SKEIN("study", swings(), "--out", out, "--quiet"); // nothing is left to do
    assert_status(o, 0);
    outcome_free(&o);
    check_same_tables(whole(), out);
}

static void nap(double seconds) {
    struct timespec t = {(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))};
    nanosleep(&t, NULL);
}

static long rows_size(const char *out) {
    char path[700];
    struct stat info;
    snprintf(path, sizeof path, "%s/rows.journal", out);
    return stat(path, &info) ? 0 : (long)info.st_size;
}

static bool has_ended(pid_t child) {
    siginfo_t info = {.si_pid = 0};
    return !waitid(P_PID, (id_t)child, &info, WEXITED | WNOHANG | WNOWAIT) && info.si_pid == child;
}

/* Waits until a row more is there, so that a slow machine is not in the way, or the study has ended. */
static void wait_for_rows(const char *out, long than, pid_t child) {
    for (int i = 0; i < 100000 && rows_size(out) <= than + 20 && !has_ended(child); i++) nap(0.002);
    assert_true(rows_size(out) > than || has_ended(child));
}

/* Ten kills, each after another row or two; the last run ends what is left. */
static void killed_studies_go_on(void **state) {
    (void)state;
    char out[512];
    snprintf(out, sizeof out, "%s", in_folder("broken"));
    for (int kills = 0; kills < 10; kills++) {
        long before = rows_size(out);
        pid_t child = start_skein(
            (surroundings){0}, (const char *const[]){"study", swings(), "--out", out, "--jobs", "2", "--quiet", NULL});
        if (kills % 3 != 2) wait_for_rows(out, before, child); // else at once
        nap(0.003 * kills);
        kill(child, SIGKILL);
        outcome o = finish_skein(child);
        if (o.status == 0) kills = 10;                                         // it was through
        else if (o.status == 2 && strstr(o.err, "another process")) nap(0.05); // a row of the last one is still going
        else assert_int_equal(o.status, -SIGKILL);
        outcome_free(&o);
    }
    outcome o = SKEIN("study", swings(), "--out", out, "--jobs", "2", "--no-progress");
    for (int i = 0; o.status == 2 && strstr(o.err, "another process") && i < 1000; i++) { // a child that is still going
        outcome_free(&o);
        nap(0.01);
        o = SKEIN("study", swings(), "--out", out, "--jobs", "2", "--no-progress");
    }
    assert_status(o, 0);
    outcome_free(&o);
    check_same_tables(whole(), out);
}

/* Ctrl-C: what is there is in the table, and the same command goes on. */
static void interrupted_studies_keep_their_rows(void **state) {
    (void)state;
    char out[512], path[700], row[700];
    snprintf(out, sizeof out, "%s", in_folder("stopped"));
    pid_t child = start_skein((surroundings){0}, (const char *const[]){"study", swings(), "--out", out, "--jobs", "1",
                                                                       "--no-progress", NULL});
    wait_for_rows(out, 20, child);
    kill(child, SIGINT);
    outcome o = finish_skein(child);
    if (o.status != 0) { // not through yet
        assert_status(o, 130);
        assert_contains(o.out, "interrupted: the same command goes on");
        snprintf(path, sizeof path, "%s/table.csv", out);
        char *csv = read_text(path);
        cell(csv, 0, "row", row);
        assert_string_equal(row, "0");
        free(csv);
    }
    outcome_free(&o);
    o = SKEIN("study", swings(), "--out", out, "--no-progress");
    assert_status(o, 0);
    outcome_free(&o);
    check_same_tables(whole(), out);
}

static void parts_of_a_batch_system_make_the_table(void **state) {
    (void)state;
    char out[512], table[600];
    snprintf(out, sizeof out, "%s", in_folder("parts")), snprintf(table, sizeof table, "%s/table.csv", out);
    static const char *const parts[] = {"3/4", "1/4", "4/4", "2/4"};
    for (size_t p = 0; p < 4; p++) {
        assert_false(exists(table));
        outcome o = SKEIN("study", swings(), "--out", out, "--part", parts[p], "--jobs", "1", "--no-progress");
        assert_status(o, 0);
        assert_contains(o.out, p < 3 ? "the last one writes the tables" : "wrote table.csv");
        outcome_free(&o);
    }
    check_same_tables(whole(), out);
}

/* A process that dies costs its row, which says so, and the next call runs it again. */
static void a_crash_costs_one_row(void **state) {
    (void)state;
#ifdef __linux__
    char out[512], path[700], list[200], text[100] = "";
    snprintf(out, sizeof out, "%s", in_folder("crashed")), snprintf(path, sizeof path, "%s/table.csv", out);
    pid_t child = start_skein((surroundings){0}, (const char *const[]){"study", swings(), "--out", out, "--jobs", "1",
                                                                       "--no-progress", NULL});
    wait_for_rows(out, 20, child);
    snprintf(list, sizeof list, "/proc/%d/task/%d/children", (int)child, (int)child);
    FILE *children = fopen(list, "r");
    bool there = children && fgets(text, sizeof text, children) != NULL;
    if (children) fclose(children);
    if (there) kill((pid_t)strtol(text, NULL, 10), SIGKILL);
    outcome o = finish_skein(child);
    if (there && o.status) {
        assert_status(o, 1);
        assert_contains(o.err, "1 row crashed, the first of them row ");
        assert_contains(o.err, "ended by signal 9");
        assert_contains(o.out, "23 of 24 rows are there: ");
        char *csv = read_text(path);
        assert_contains(csv, ",crashed,");
        free(csv);
    }
    outcome_free(&o);
    o = SKEIN("study", swings(), "--out", out, "--no-progress");
    assert_status(o, 0);
    outcome_free(&o);
    check_same_tables(whole(), out);
#endif
}

static void ranks_make_the_same_table(void **state) {
    (void)state;
#ifdef SKEIN_MPIRUN
    char command[2000], out[512];
    snprintf(out, sizeof out, "%s", in_folder("ranks"));
    for (int ranks = 2; ranks <= 4; ranks += 2) { // the second time there is nothing left to do
        snprintf(command, sizeof command,
                 "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 "
                 "timeout 200 %s -n %d %s study %s --out %s --no-progress >%s 2>&1",
                 SKEIN_MPIRUN, ranks, SKEIN_COMMAND, swings(), out, in_folder("said"));
        if (system(command) != 0) fail_msg("%s", read_text(in_folder("said")));
        check_same_tables(whole(), out);
    }
    char *said = read_text(in_folder("said"));
    char *first = strstr(said, "24 of 24 rows");
    assert_non_null(first);
    assert_null(strstr(first + 1, "24 of 24 rows are there:")); // one rank speaks
    free(said);
#endif
}

#ifdef SKEIN_HDF5
static void the_hdf5_table_is_the_csv_table(void **state) {
    (void)state;
    char path[700], text[700], *csv;
    snprintf(path, sizeof path, "%s/table.csv", whole());
    csv = read_text(path);
    snprintf(path, sizeof path, "%s/table.h5", whole());
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    H5G_info_t info;
    assert_true(H5Gget_info(file, &info) >= 0 && info.nlinks == 3 + 3 + 11); // more than the 15 of a recording
    static const char *const numbers[] = {"row",  "bodies.sheet.density", "lowest", "kinetic_energy_most", "time",
                                          "steps"};
    for (size_t i = 0; i < COUNT(numbers); i++) {
        double got[ROWS];
        hid_t set = H5Dopen2(file, numbers[i], H5P_DEFAULT);
        assert_true(set >= 0 && H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, got) >= 0);
        H5Dclose(set);
        for (int row = 0; row < ROWS; row++) {
            cell(csv, row, numbers[i], text);
            double ought = strtod(text, NULL);
            assert_true(got[row] == ought || (isnan(got[row]) && isnan(ought)));
        }
    }
    static const char *const words[] = {"method.type", "bodies.sheet.position", "command", "state_hash", "outcome"};
    for (size_t i = 0; i < COUNT(words); i++) {
        hid_t set = H5Dopen2(file, words[i], H5P_DEFAULT), type = H5Dget_type(set);
        size_t size = H5Tget_size(type);
        char *got = calloc(ROWS, size);
        assert_true(set >= 0 && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, got) >= 0);
        for (int row = 0; row < ROWS; row++) {
            cell(csv, row, words[i], text);
            assert_string_equal(got + (size_t)row * size, text);
        }
        free(got);
        H5Tclose(type), H5Dclose(set);
    }
    H5Fclose(file);
    free(csv);
}
#endif

/* A scene's files may lie elsewhere than the table: its commands say that they may be read. */
static void a_mesh_is_found_again(void **state) {
    (void)state;
    char command[1800], text[700], table[700];
    assert_int_equal(mkdir(in_folder("elsewhere"), 0777), 0);
    snprintf(command, sizeof command, "cp %s/meshes/ball.obj %s", SKEIN_SOURCE_DIR, in_folder("elsewhere"));
    assert_int_equal(system(command), 0);
    write_scene(in_folder("elsewhere/c.json"),
                "{'frames': 3, 'bodies': [{'type': 'cloth', 'mesh': 'ball.obj'}], 'forces': [{'type': 'gravity'}]}");
    write_scene(
        in_folder("mesh.json"),
        "{'study': 1, 'scene': 'elsewhere/c.json', 'vary': {'bodies.0.density': [0.1, 0.2]}, 'measure': ['lowest']}");
    snprintf(table, sizeof table, "%s/table.csv", in_folder("mesh"));
    outcome o = SKEIN("study", in_folder("mesh.json"), "--out", in_folder("mesh"), "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    char *csv = read_text(table);
    cell(csv, 1, "command", text);
    assert_contains(text, "elsewhere/ball.obj");
    snprintf(command, sizeof command, "cd %s && %s%s --json --quiet >../mesh_again.json", in_folder("mesh"),
             SKEIN_COMMAND, text + 5);
    assert_int_equal(system(command), 0);
    json_t *report = read_report(in_folder("mesh_again.json"));
    cell(csv, 1, "state_hash", text);
    assert_string_equal(text_of(report, "state_hash"), text);
    json_decref(report);
    free(csv);
}

/* Those that come along can be run, by their names. */
static void studies_that_come_along_are_sound(void **state) {
    (void)state;
    DIR *studies = opendir("scenes/studies");
    int count = 0;
    assert_non_null(studies);
    for (struct dirent *entry; (entry = readdir(studies)) != NULL;) {
        char name[300];
        if (entry->d_name[0] == '.') continue;
        snprintf(name, sizeof name, "%.*s", (int)strcspn(entry->d_name, "."), entry->d_name);
        outcome o = SKEIN("study", name, "--list");
        assert_status(o, 0);
        assert_contains(o.out, "skein run scene.json --set ");
        outcome_free(&o);
        count++;
    }
    closedir(studies);
    assert_true(count >= 2);
}

static void arguments_are_checked(void **state) {
    (void)state;
    static const struct {
        const char *option, *value, *words;
    } all[] = {
        {"--part", "0/4", "--part 0/4: expected the part and how many there are"},
        {"--part", "5/4", "--part 5/4: expected"},
        {"--part", "3", "--part 3: expected"},
        {"--jobs", "0", "--jobs 0: expected a whole number, 1 to 1024"},
        {"--threads", "x", "--threads x: expected a whole number, 1 to 64"},
    };
    for (size_t i = 0; i < COUNT(all); i++) {
        outcome o = SKEIN("study", swings(), all[i].option, all[i].value);
        assert_status(o, 2);
        assert_contains(o.err, all[i].words);
        outcome_free(&o);
    }
    outcome o = SKEIN("study", in_folder("none.json"));
    assert_status(o, 2);
    assert_contains(o.err, "none.json: cannot read");
    outcome_free(&o);
    write_scene(in_folder("bad.json"), "{'study': 1, 'vary': {'a': 1}, 'measure': ['none']}");
    o = SKEIN("study", in_folder("bad.json"));
    assert_status(o, 2);
    assert_contains(o.err, "bad.json: vary.a: expected a list");
    assert_contains(o.err, "bad.json: 2 faults");
    outcome_free(&o);
    o = SKEIN("study", swings(), "--list");
    assert_status(o, 0);
    assert_int_equal(longest_line(o.out) > 60, 1);
    int lines = 0;
    for (const char *at = o.out; *at; at++) lines += *at == '\n';
    assert_int_equal(lines, ROWS);
    outcome_free(&o);
    o = SKEIN("study", "--help");
    assert_status(o, 0);
    assert_contains(o.out, "polarization");
    outcome_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_row_is_done_again_by_its_command),
        cmocka_unit_test(a_plot_shows_the_rows),
        cmocka_unit_test(a_map_keeps_the_cells_of_rows_that_failed),
        cmocka_unit_test(several_processes_make_the_same_table),
        cmocka_unit_test(killed_studies_go_on),
        cmocka_unit_test(interrupted_studies_keep_their_rows),
        cmocka_unit_test(parts_of_a_batch_system_make_the_table),
        cmocka_unit_test(a_crash_costs_one_row),
        cmocka_unit_test(ranks_make_the_same_table),
#ifdef SKEIN_HDF5
        cmocka_unit_test(the_hdf5_table_is_the_csv_table),
#endif
        cmocka_unit_test(a_mesh_is_found_again),
        cmocka_unit_test(studies_that_come_along_are_sound),
        cmocka_unit_test(arguments_are_checked),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
