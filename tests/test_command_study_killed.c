/* A study of 200 rows that is killed ten times, at ten moments, ends with the tables of one that was never broken off, byte
 * for byte: by one process, by three parts of a batch system that run at once, and by two ranks of an MPI job. */
#include "test_command.h"

#include "io/snapshot.h"
#include "ranks.h"

enum { ROWS = 200, KILLS = 10, PARTS = 3 };

/* Ropes that swing: a row takes some tens of milliseconds, so that ten kills find it at work. */
static const char *ropes(void) {
    static char path[512];
    if (path[0]) return path;
    snprintf(path, sizeof path, "%s/ropes.json", folder);
    write_scene(
        path,
        "{'study': 1, 'scene': {'frames': 1200, 'bodies': [{'type': 'rope', 'name': 'line', 'count': 40, 'pins': 'first'}], "
        "'forces': [{'type': 'gravity'}]}, 'vary': {'bodies.line.stretch.stiffness': {'from': 50, 'to': 5000, 'count': 20, "
        "'scale': 'log'}, 'bodies.line.density': {'from': 0.1, 'to': 1, 'count': 10}}, 'measure': ['lowest', 'max_stretch', "
        "{'measure': 'kinetic_energy', 'over': 'most'}]}");
    return path;
}

static void check_same_file(const char *one, const char *other, const char *name) {
    char a[700], b[700];
    snprintf(a, sizeof a, "%s/%s", one, name), snprintf(b, sizeof b, "%s/%s", other, name);
    io_bytes x, y;
    skein_error error;
    if (io_file_read(a, 1 << 28, &x, &error) || io_file_read(b, 1 << 28, &y, &error))
        fail_msg("%s: %s", error.where, error.message);
    assert_true(x.size > 1000);
    if (x.size != y.size || memcmp(x.data, y.data, x.size) != 0) fail_msg("%s differs from %s", b, a);
    io_bytes_free(&x), io_bytes_free(&y);
}

/* The study without a break. */
static const char *whole(void) {
    static char path[512];
    if (path[0]) return path;
    snprintf(path, sizeof path, "%s/whole", folder);
    outcome o = SKEIN("study", ropes(), "--out", path, "--jobs", "1", "--no-progress");
    assert_status(o, 0);
    assert_contains(o.out, "200 of 200 rows are there: ");
    outcome_free(&o);
    return path;
}

static bool note_row(void *user, uint64_t sort, const void *bytes, size_t size) {
    bool *there = user;
    (void)sort;
    json_t *row = json_loadb(bytes, size, 0, NULL);
    size_t number = (size_t)json_integer_value(json_object_get(row, "row"));
    assert_true(row && number < ROWS);
    assert_false(there[number]); // what is there is not run again
    there[number] = true;
    json_decref(row);
    return true;
}

/* How many rows are there, in all journals. */
static int count_rows(const char *out) {
    bool there[ROWS] = {false};
    int count = 0;
    DIR *entries = opendir(out);
    for (struct dirent *entry; entries && (entry = readdir(entries)) != NULL;) {
        char path[900];
        struct stat info;
        skein_error error;
        if (strncmp(entry->d_name, "rows.", 5) != 0) continue;
        snprintf(path, sizeof path, "%s/%s", out, entry->d_name);
        if (stat(path, &info) || info.st_size < 16) continue; // it has been killed as it began
        if (io_journal_read(path, UINT64_MAX, note_row, there, NULL, &error)) fail_msg("%s: %s", path, error.message);
    }
    if (entries) closedir(entries);
    for (int row = 0; row < ROWS; row++) count += there[row];
    return count;
}

static void nap(long nanoseconds) {
    nanosleep(&(struct timespec){nanoseconds / 1000000000, nanoseconds % 1000000000}, NULL);
}

/* Waits for the moment of a kill: so many rows, one more each time at least, and then a part of a row. Returns how many there
 * are; more than ROWS where the process is through, or gone. */
static int wait_for(const char *out, int before, int turn, pid_t process) {
    int wanted = ROWS / (KILLS + 2) * (turn + 1), there;
    if (wanted <= before) wanted = before + 1;
    for (int tries = 0; (there = count_rows(out)) < wanted; tries++) {
        siginfo_t info = {.si_pid = 0};
        assert_true(tries < 200000);
        if (!waitid(P_PID, (id_t)process, &info, WEXITED | WNOHANG | WNOWAIT) && info.si_pid) return ROWS + 1;
        nap(300000);
    }
    nap(700000L * turn);
    return there;
}

/* A process of the command, whose words go nowhere: killed ones may leave theirs half said. */
static pid_t start(const char *const *arguments) {
    int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    pid_t child = start_skein((surroundings){.out = nowhere, .err = nowhere}, arguments);
    close(nowhere);
    return child;
}

static int end(pid_t process) {
    int status;
    while (waitpid(process, &status, 0) < 0) assert_int_equal(errno, EINTR);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

static void check_tables(const char *out) {
    assert_int_equal(count_rows(out), ROWS);
    check_same_file(whole(), out, "table.csv");
    check_same_file(whole(), out, "table.h5");
}

/* Breaks a study off ten times; false where it was through before its time, since this process had to wait for a processor. */
typedef bool break_off(const char *out);

static void check_broken(const char *name, break_off *broken) {
    char out[512];
    int tries = 0;
    do snprintf(out, sizeof out, "%s/%s%d", folder, name, tries);
    while (!broken(out) && ++tries < 5);
    assert_true(tries < 5);
    check_tables(out);
}

static bool break_process(const char *out) {
    const char *const arguments[] = {"study", ropes(), "--out", out, "--jobs", "1", "--quiet", NULL};
    for (int turn = 0, there = 0; turn < KILLS; turn++) {
        pid_t process = start(arguments);
        there = wait_for(out, there, turn, process);
        kill(process, SIGKILL);
        int status = end(process);
        if (status == 0) return false;
        assert_int_equal(status, -SIGKILL);
        if (there >= ROWS) return false;
    }
    assert_int_equal(end(start(arguments)), 0);
    return true;
}

static void one_process(void **state) {
    (void)state;
    check_broken("one", break_process);
}

static pid_t start_part(const char *out, int part) {
    char text[20];
    snprintf(text, sizeof text, "%d/%d", part + 1, PARTS);
    return start((const char *const[]){"study", ropes(), "--out", out, "--part", text, "--jobs", "1", "--quiet", NULL});
}

/* All parts at once, as an array of jobs has them: each is killed some times, and begun again. The one that ends last, which
 * began long before the others were through, writes the tables. */
static bool break_parts(const char *out) {
    char table[600];
    snprintf(table, sizeof table, "%s/table.csv", out);
    pid_t process[PARTS];
    bool in_time = true;
    for (int p = 0; p < PARTS; p++) process[p] = start_part(out, p);
    for (int turn = 0, there = 0; turn < KILLS; turn++) {
        int part = turn % PARTS;
        there = wait_for(out, there, turn, process[part]);
        kill(process[part], SIGKILL);
        in_time &= end(process[part]) == -SIGKILL && there < ROWS && !exists(table);
        process[part] = start_part(out, part);
    }
    for (int p = 0; p < PARTS; p++) assert_int_equal(end(process[p]), 0);
    return in_time;
}

static void parts_at_once(void **state) {
    (void)state;
    check_broken("parts", break_parts);
}

#ifdef SKEIN_MPIRUN
static pid_t start_ranks(const char *out) {
    pid_t child = fork();
    assert_true(child >= 0);
    if (child) return child;
    int said = open(in_folder("said"), O_RDWR | O_CREAT | O_TRUNC, 0666);
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1), setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    dup2(said, 1), dup2(said, 2);
    alarm(SKEIN_COMMAND_SECONDS);
    execl(SKEIN_MPIRUN, SKEIN_MPIRUN, "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", "2", SKEIN_COMMAND,
          "study", ropes(), "--out", out, "--quiet", (char *)NULL);
    _exit(127);
}

/* Ranks that lost their mpirun go, too, but not at once. */
static void wait_for_ranks_to_go(void) {
    for (int tries = 0; find_rank(ropes(), "0") || find_rank(ropes(), "1"); tries++) {
        assert_true(tries < 2000);
        nap(10000000);
    }
}

/* Lets a rank whose fellow was killed go on for some rows. It would do so for a second, until mpirun ends it, and on an idle
 * machine be through with all of them. */
static void let_go_on(const char *out, int rows, pid_t rank) {
    for (int tries = 0; tries < 2000 && count_rows(out) < rows && !kill(rank, 0); tries++) nap(1000000);
}

/* The first rank, which has the folder, and the other take turns; at last it is mpirun itself, without which ranks go on until
 * they notice. Whoever is left after a kill goes on for a while the first times; later on it is killed a little after the first, as
 * a batch system does. */
static bool break_ranks(const char *out) {
    for (int turn = 0, there = 0; turn < KILLS; turn++) {
        there = count_rows(out);
        pid_t job = start_ranks(out), victim = 0;
        there = wait_for(out, there, turn, job);
        for (int tries = 0; there < ROWS && victim <= 0 && tries < 2000; tries++, nap(1000000))
            victim = turn == KILLS - 1 ? job : find_rank(ropes(), turn % 2 ? "1" : "0");
        if (victim > 0) kill(victim, SIGKILL);
        if (victim > 0 && victim != job) {
            pid_t left = find_rank(ropes(), turn % 2 ? "0" : "1");
            if (turn < 2 && left > 0) let_go_on(out, there + ROWS / KILLS, left);
            else nap(5000000);
            left = find_rank(ropes(), turn % 2 ? "0" : "1");
            if (left > 0) kill(left, SIGKILL);
        }
        int status = end(job);
        wait_for_ranks_to_go();
        if (status == 0) return false;
        if (victim <= 0) fail_msg("turn %d, %d rows, status %d: %s", turn, there, status, read_text(in_folder("said")));
    }
    if (end(start_ranks(out))) fail_msg("%s", read_text(in_folder("said")));
    return true;
}

static void ranks(void **state) {
    (void)state;
    check_broken("ranks", break_ranks);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_process),
        cmocka_unit_test(parts_at_once),
#ifdef SKEIN_MPIRUN
        cmocka_unit_test(ranks),
#endif
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
