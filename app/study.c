/* skein study: its arguments become rows to be run, and rows become tables and a plot. */
#include "app/study.h"
#include "app/ranks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_JOBS = 1024, SECONDS_BETWEEN_TABLES = 20 };

/* ---- rows, dealt out and kept ---- */

size_t study_deal(study_work *work) {
    if (app_interrupted() || work->failed) return SIZE_MAX;
    size_t row = io_study_folder_next(work->folder, work->next);
    work->next = row == SIZE_MAX ? row : row + 1;
    return row;
}

static bool write_tables(study_work *work) {
    skein_error error = {SKEIN_OK, "", ""};
    work->written = app_seconds();
    if (!io_study_folder_tables(work->folder, &error)) return true;
    app_print_error(&error);
    return false;
}

bool study_take(study_work *work, json_t *result) {
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    const char *outcome = json_string_value(json_object_get(result, "outcome"));
    if (outcome && !strcmp(outcome, "stopped")) {
        json_decref(result);
        return false;
    }
    if (!outcome || io_study_folder_add(work->folder, result, &error)) {
        app_progress_end(&work->progress);
        if (!work->failed) app_print_error(&error);
        work->failed = true;
        json_decref(result);
        return true;
    }
    work->seconds += json_number_value(json_object_get(result, "seconds"));
    app_progress_show(&work->progress, ++work->taken);
    json_decref(result);
    if (work->whole && app_seconds() - work->written > SECONDS_BETWEEN_TABLES && !write_tables(work))
        work->failed = true;
    return true;
}

typedef struct meanwhile_call {
    void (*call)(void *user);
    void *user;
} meanwhile_call;

static bool go_on(void *user) {
    const meanwhile_call *meanwhile = user;
    if (meanwhile->call) meanwhile->call(meanwhile->user);
    return !app_interrupted();
}

json_t *study_run(const study_work *work, size_t row, void (*meanwhile)(void *user), void *user) {
    meanwhile_call call = {meanwhile, user};
    return io_study_run(work->study, row, work->threads, go_on, &call);
}

/* ---- the end ---- */

/* How many rows came out so; `said` receives the words of the first of them. */
static size_t count_outcome(const study_work *work, const char *outcome, const char **said, size_t *first) {
    size_t count = 0;
    for (size_t row = 0; row < io_study_rows(work->study); row++) {
        const json_t *result = io_study_folder_row(work->folder, row);
        const char *word = json_string_value(json_object_get(result, "outcome"));
        if (!word || strcmp(word, outcome) != 0) continue;
        if (!count++) {
            *said = json_string_value(json_object_get(result, "said"));
            *first = row;
        }
    }
    return count;
}

/* Says what came of the rows; false where some could not be run. */
static bool sum_up(const study_work *work, bool quiet) {
    static const char *const outcomes[] = {"good", "blew up", "beyond bounds", "refused", "failed", "crashed"};
    size_t rows = io_study_rows(work->study), bad = 0;
    char line[300];
    int length = 0;
    line[0] = 0;
    for (size_t o = 0; o < sizeof outcomes / sizeof *outcomes; o++) {
        const char *said = "";
        size_t first = 0, count = count_outcome(work, outcomes[o], &said, &first);
        if (!count) continue;
        length +=
            snprintf(line + length, sizeof line - (size_t)length, "%s%zu %s", length ? ", " : "", count, outcomes[o]);
        if (o < 3) continue;
        bad += count;
        fprintf(stderr, "skein study: %zu row%s %s, the first of them row %zu: %s\n", count, count == 1 ? "" : "s",
                outcomes[o], first, said);
    }
    if (!quiet)
        printf("%zu of %zu rows are there: %s\n", io_study_folder_done(work->folder), rows, length ? line : "none");
    return !bad;
}

static int conclude(study_work *work, const char *folder, bool quiet) {
    // other parts have gone on since this one began: of those that end at once the last sees the rows of all
    skein_error error = {SKEIN_OK, "", ""};
    bool seen = work->whole || !io_study_folder_look(work->folder, &error);
    if (!seen) app_print_error(&error);
    size_t rows = io_study_rows(work->study), done = io_study_folder_done(work->folder);
    int signal_number = app_interrupted();
    bool drawn = false, tables = work->whole || done == rows;
    bool good = seen && !work->failed && (!tables || write_tables(work));
    if (good && tables && done) good = study_plot(work->study, work->folder, folder, &drawn);
    bool ran = sum_up(work, quiet);
    if (!quiet && good && tables)
        printf("wrote table.csv, table.h5%s and timings.csv into %s\n",
               drawn ? ", plot.gnuplot, plot.png, plot.svg" : "", folder);
    else if (!quiet && good) printf("the other parts are still to come: the last one writes the tables\n");
    if (signal_number && !quiet) printf("interrupted: the same command goes on from here\n");
    return signal_number ? EXIT_SIGNAL + signal_number : good && ran ? EXIT_OK : EXIT_FAILURE_RUN;
}

/* ---- the arguments ---- */

static size_t processors(void) {
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : (size_t)count;
}

/* A whole number of an option, `otherwise` where it is not given, 0 after a printed fault. */
static size_t number_of(const app_arguments *arguments, const char *name, size_t most, size_t otherwise) {
    const char *given = app_value(arguments, name);
    char *end;
    if (!given) return otherwise;
    long number = strtol(given, &end, 10);
    if (end != given && !*end && number >= 1 && number <= (long)most) return (size_t)number;
    fprintf(stderr, "skein study: %s %s: expected a whole number, 1 to %zu\n", name, given, most);
    return 0;
}

/* "3/40"; false after a printed fault. */
static bool part_of(const app_arguments *arguments, size_t *part, size_t *parts) {
    const char *given = app_value(arguments, "--part");
    char *slash, *end;
    *part = *parts = 1;
    if (!given) return true;
    long k = strtol(given, &slash, 10), n = *slash == '/' ? strtol(slash + 1, &end, 10) : 0;
    if (slash != given && *slash == '/' && end != slash + 1 && !*end && k >= 1 && k <= n && n <= 1000000) {
        *part = (size_t)k, *parts = (size_t)n;
        return true;
    }
    fprintf(stderr, "skein study: --part %s: expected the part and how many there are, 1/40 to 40/40 say\n", given);
    return false;
}

static void report_nothing(void *user, const skein_error *error) {
    (void)user, (void)error;
}

/* A file, or a study of that name among those that come with Skein, beside its scenes. */
static void find_study(const char *word, char path[IO_PLACE_SIZE]) {
    char folder[IO_PLACE_SIZE];
    bool known = strchr(word, '/') || strchr(word, '.') || !access(word, R_OK);
    for (size_t i = 0; !known && io_scenes_folder(i, folder); i++) {
        int length = snprintf(path, IO_PLACE_SIZE, "%s/studies/%s.json", folder, word);
        if (length < IO_PLACE_SIZE && !access(path, R_OK)) return;
    }
    snprintf(path, IO_PLACE_SIZE, "%s", word);
}

static io_study *read_study(const char *word, bool silent) {
    static char built[96]; // of this program, always the same
    char path[IO_PLACE_SIZE];
    find_study(word, path);
    io_reach reach;
    io_faults faults = {silent ? report_nothing : app_report_fault, NULL, 0, app_reach(NULL, &reach)};
    io_study *study = io_study_read(path, app_exporters(), &faults);
    if (!study && faults.count > 1 && !silent) fprintf(stderr, "skein: %s: %zu faults\n", path, faults.count);
    snprintf(built, sizeof built, "%s (%s)", SKEIN_VERSION, app_commit);
    if (study) io_study_built(study, built);
    return study;
}

static int list_rows(const io_study *study) {
    for (size_t row = 0; row < io_study_rows(study); row++) {
        char *command = io_study_command(study, row);
        if (!command) return EXIT_FAILURE_RUN;
        printf("%s\n", command);
        free(command);
    }
    return EXIT_OK;
}

typedef struct wishes {
    const char *folder;
    size_t part, parts, jobs, threads;
    bool quiet, calm;
} wishes;

static int run_study(io_study *study, const wishes *w, int rank) {
    skein_error error = {SKEIN_OK, "", ""};
    char own[300];
    snprintf(own, sizeof own, "%.250s", io_study_name(study));
    const char *path = w->folder ? w->folder : own;
    study_work work = {.study = study, .threads = (int)w->threads, .whole = w->parts == 1, .written = app_seconds()};
    app_catch_interrupts();
    if (rank <= 0) work.folder = io_study_folder_open(study, path, w->part, w->parts, &error);
    if (rank <= 0 && !work.folder) {
        app_print_error(&error);
        if (rank == 0) exit(EXIT_FAULT); // MPI ends the others
        return EXIT_FAULT;
    }
    size_t missing = rank <= 0 ? io_study_folder_missing(work.folder) : 0;
    if (rank <= 0 && !w->calm && io_study_folder_done(work.folder))
        fprintf(stderr, "%zu of %zu rows are there, %zu are to be run\n", io_study_folder_done(work.folder),
                io_study_rows(study), missing);
    work.progress = app_progress_start("row", (int)missing, w->calm || rank > 0);
    if (rank >= 0) study_run_ranks(&work);
    else if (missing) study_run_jobs(&work, w->jobs < missing ? w->jobs : missing);
    app_progress_end(&work.progress);
    int status = rank > 0 ? EXIT_OK : conclude(&work, path, w->quiet);
    io_study_folder_close(work.folder);
    return status;
}

static int study(app_arguments *arguments) {
    bool quiet = app_given(arguments, "--quiet"), many = app_is_rank();
    wishes w = {.folder = app_value(arguments, "--out"),
                .quiet = quiet,
                .calm = quiet || app_given(arguments, "--no-progress"),
                .jobs = number_of(arguments, "--jobs", MOST_JOBS, processors()),
                .threads = number_of(arguments, "--threads", 64, 1)};
    if (!w.jobs || !w.threads || !part_of(arguments, &w.part, &w.parts)) return EXIT_FAULT;
    if (many && app_given(arguments, "--jobs")) {
        fprintf(stderr, "skein study: --jobs: the processes of an MPI job are as many as it was started with\n");
        return EXIT_FAULT;
    }
    int count, rank = many ? study_ranks_begin(&count) : -1;
    if (many && rank < 0) return EXIT_FAILURE_RUN;
    io_study *read = read_study(app_word(arguments), rank > 0);
    int status = !read                            ? EXIT_FAULT
                 : app_given(arguments, "--list") ? (rank <= 0 ? list_rows(read) : EXIT_OK)
                                                  : run_study(read, &w, rank);
    io_study_free(read);
    if (many) study_ranks_end();
    return status;
}

static void print_measures(void) {
    const char *unit, *help, *name;
    printf("\nMeasures\n");
    for (size_t i = 0; (name = io_study_quantity_at(i, &unit, &help)) != NULL; i++) {
        char left[64];
        snprintf(left, sizeof left, "%s%s%s%s", name, unit[0] ? " (" : "", unit, unit[0] ? ")" : "");
        printf("  %-29s %s\n", left, help);
    }
}

static const app_option options[] = {
    {"--out", "FOLDER", "where tables and rows go; else a folder of the study's name, here", false, APP_TAKES_FOLDER},
    APP_ALLOW_OPTION,
    {"--jobs", "N", "processes that run rows; one a processor if not given", false, APP_TAKES_ANY},
    {"--threads", "N", "threads of each row, 1 to 64; the result is the same", false, APP_TAKES_ANY},
    {"--part", "K/N", "run the K-th of N parts of the rows, 3/40: for jobs of a batch system", false, APP_TAKES_ANY},
    {"--list", NULL, "print the command of each row, and run nothing", false, APP_TAKES_ANY},
    APP_NO_PROGRESS_OPTION,
    APP_QUIET_OPTION,
    APP_END_OF_OPTIONS};

const app_command app_study_command = {
    "study",
    "STUDY.json [--out FOLDER] [--jobs N | --part K/N] [options]",
    "run a scene many times with fields varied, and write one table of what was measured\n\n"
    "  skein study scenes/studies/flock_phases.json --out out/phases\n"
    "  mpirun -n 8 skein study scenes/studies/flock_phases.json --out out/phases\n"
    "  skein study scenes/studies/flock_phases.json --out out/phases --part 3/40\n\n"
    "A study names a scene, fields to vary (lists, ranges, or at random from a seed) and measures to keep:\n\n"
    "  { \"study\": 1, \"scene\": \"rope\", \"vary\": { \"bodies.0.stretch.stiffness\": { \"from\": 100, \"to\": 1e4,\n"
    "    \"count\": 20, \"scale\": \"log\" } }, \"measure\": [\"max_stretch\", \"lowest\"] }\n\n"
    "table.csv and table.h5 have a row for each run, with the command that does it again and its state hash; plot.png and\n"
    "plot.svg show it. Killed or interrupted, the same command goes on with the rows that are missing, and the tables come\n"
    "out as if it had never been (docs/studies.md).\n\n"
    "Exit status 0: all rows are there, or all of this part (one that blew up is a result like others); 1: some could not\n"
    "be run, or a file could not be written; 2: a fault in the study or the arguments; 130: interrupted.",
    options,
    "study",
    false,
    APP_TAKES_FILE,
    study,
    print_measures,
};
