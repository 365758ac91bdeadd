/* Rows run by child processes: each is given a row's number through a socket and answers with the result, as JSON. A row
 * that takes its process with it costs that row alone, and a child does not outlive its parent. */
#define _GNU_SOURCE // prctl, SOCK_CLOEXEC
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "app/study.h"

typedef struct job {
    pid_t process; /* 0: none */
    int socket;
    size_t row; /* that it runs, SIZE_MAX: none */
} job;

/* ---- what goes through a socket: a size and bytes ---- */

static bool read_all(int fd, void *bytes, size_t size) {
    for (char *at = bytes; size;) {
        ssize_t got = read(fd, at, size);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got, size -= (size_t)got;
    }
    return true;
}

static bool write_all(int fd, const void *bytes, size_t size) {
    for (const char *at = bytes; size;) {
        ssize_t done = send(fd, at, size, MSG_NOSIGNAL);
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) return false;
        at += done, size -= (size_t)done;
    }
    return true;
}

/* ---- the child ---- */

static void work_in_child(const study_work *work, int socket) {
    size_t row;
    while (read_all(socket, &row, sizeof row)) {
        json_t *result = study_run(work, row, NULL, NULL);
        char *text = result ? json_dumps(result, JSON_COMPACT | JSON_REAL_PRECISION(17)) : NULL;
        size_t size = text ? strlen(text) : 0;
        if (!text || !write_all(socket, &size, sizeof size) || !write_all(socket, text, size)) break;
        free(text);
        json_decref(result);
    }
    _exit(0);
}

static bool start(const study_work *work, job *all, size_t count, size_t place) {
    int ends[2];
    pid_t parent = getpid();
    fflush(stdout);
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends)) return false;
    pid_t child = fork();
    if (!child) {
#ifdef __linux__
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(0);
#endif
        close(io_study_folder_lock(work->folder)); // else it would be held as long as this lives
        for (size_t i = 0; i < count; i++)
            if (all[i].process) close(all[i].socket);
        close(ends[0]);
        work_in_child(work, ends[1]);
    }
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        return false;
    }
    all[place] = (job){child, ends[0], SIZE_MAX};
    return true;
}

/* ---- the parent ---- */

/* Waits for a child that has gone, and says how. */
static void bury(job *j, char said[120]) {
    int status = 0;
    while (waitpid(j->process, &status, 0) < 0 && errno == EINTR) continue;
    if (WIFSIGNALED(status))
        snprintf(said, 120, "its process was ended by signal %d (%s)", WTERMSIG(status), strsignal(WTERMSIG(status)));
    else snprintf(said, 120, "its process ended with status %d", WEXITSTATUS(status));
    close(j->socket);
    j->process = 0;
}

/* Gives a child the next row; without one it is told to go. */
static void give_row(study_work *work, job *j) {
    char said[120];
    j->row = study_deal(work);
    if (j->row != SIZE_MAX && write_all(j->socket, &j->row, sizeof j->row)) return;
    if (j->row != SIZE_MAX) return; // it is gone: reading will tell
    shutdown(j->socket, SHUT_WR);
    bury(j, said);
}

/* Takes what a child says; where it is gone, its row has crashed, and another takes its place. */
static void hear(study_work *work, job *all, size_t count, size_t place) {
    job *j = &all[place];
    size_t size;
    char said[120], *text = NULL;
    json_t *result = NULL;
    if (read_all(j->socket, &size, sizeof size) && size < ((size_t)1 << 30) && (text = malloc(size + 1)) != NULL &&
        read_all(j->socket, text, size))
        result = json_loadb(text, size, 0, NULL);
    free(text);
    if (result) {
        study_take(work, result);
        give_row(work, j);
        return;
    }
    size_t row = j->row;
    kill(j->process, SIGKILL);
    bury(j, said);
    if (app_interrupted()) return; // it heard of that, too
    study_take(work, io_study_crashed(work->study, row, said));
    if (start(work, all, count, place)) give_row(work, &all[place]);
}

static size_t list_open(const job *all, size_t count, struct pollfd *polled, size_t *places) {
    size_t open = 0;
    for (size_t i = 0; i < count; i++)
        if (all[i].process) {
            polled[open] = (struct pollfd){.fd = all[i].socket, .events = POLLIN};
            places[open++] = i;
        }
    return open;
}

void study_run_jobs(study_work *work, size_t jobs) {
    job *all = calloc(jobs, sizeof *all);
    struct pollfd *polled = calloc(jobs, sizeof *polled);
    size_t *places = calloc(jobs, sizeof *places), started = 0, open;
    while (all && polled && places && started < jobs && start(work, all, jobs, started)) started++;
    if (!started) {
        fprintf(stderr, "skein study: no process could be started: %s\n", strerror(errno));
        work->failed = true;
    }
    for (size_t i = 0; i < started; i++) give_row(work, &all[i]);
    while (started && !app_interrupted() && !work->failed && (open = list_open(all, jobs, polled, places)) > 0) {
        if (poll(polled, (nfds_t)open, 500) < 0) continue;
        for (size_t i = 0; i < open; i++)
            if (polled[i].revents) hear(work, all, jobs, places[i]);
    }
    for (size_t i = 0; i < started; i++) {
        char said[120];
        if (!all[i].process) continue;
        kill(all[i].process, SIGKILL);
        bury(&all[i], said);
    }
    free(all);
    free(polled);
    free(places);
}
