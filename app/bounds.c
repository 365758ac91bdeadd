/* See bounds.h. Memory is bounded by the system, so that an allocation fails as on a machine that has no more, and is told in
 * the same way. When the time is up, a run ends as if somebody had pressed Ctrl-C: what it has is written. */
#include "app/bounds.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include "app/progress.h"

static const char *memory; // as it was given; NULL: no bound
static char time_words[200];

enum { GRACE = 5 }; // seconds in which a run that was interrupted comes to an end

/* What interrupts nobody, or is not heard, ends here. */
static void on_time(int number) {
    static volatile sig_atomic_t told;
    if (!told && app_interrupt(number)) {
        told = 1;
        return;
    }
    (void)!write(STDERR_FILENO, time_words, strlen(time_words));
    _exit(EXIT_FAILURE_RUN);
}

static bool set_time(const app_arguments *arguments, const char *given) {
    char *end;
    double seconds = strtod(given, &end);
    if (end == given || *end || !(seconds >= 0.01) || !(seconds <= 1e7)) {
        fprintf(stderr, "skein %s: --max-time %s: expected seconds, 0.01 to 1e7\n", arguments->command->name, given);
        return false;
    }
    snprintf(time_words, sizeof time_words, "skein %s: --max-time %.40s: the time is up, and nothing was finished\n",
             arguments->command->name, given);
    struct timeval once = {(time_t)seconds, (suseconds_t)(1e6 * (seconds - (double)(time_t)seconds))};
    struct sigaction action = {.sa_handler = on_time, .sa_flags = SA_RESTART};
    struct itimerval timer = {{GRACE, 0}, once};
    return !sigaction(SIGALRM, &action, NULL) && !setitimer(ITIMER_REAL, &timer, NULL);
}

/* "500M", "2G", or bytes. */
static bool set_memory(const app_arguments *arguments, const char *given) {
    char *end;
    double size = strtod(given, &end);
    static const char units[] = "KMGT";
    const char *unit = end > given && *end ? strchr(units, *end) : NULL;
    for (const char *u = units; unit && u <= unit; u++) size *= 1024;
    end += unit != NULL;
    if (end == given || *end || !(size >= 1 << 20) || !(size <= 1e15)) {
        fprintf(stderr, "skein %s: --max-memory %s: expected a size from 1M, 500M or 2G\n", arguments->command->name,
                given);
        return false;
    }
    memory = given;
    struct rlimit limit;
    if (getrlimit(RLIMIT_DATA, &limit)) return true;
    if (limit.rlim_max == RLIM_INFINITY || (double)limit.rlim_max > size) limit.rlim_cur = (rlim_t)size;
    return !setrlimit(RLIMIT_DATA, &limit);
}

bool app_bounds_set(const app_arguments *arguments) {
    const char *most_time = app_value(arguments, "--max-time"), *most_memory = app_value(arguments, "--max-memory");
    return (!most_memory || set_memory(arguments, most_memory)) && (!most_time || set_time(arguments, most_time));
}

int app_bounds_end(const app_arguments *arguments, int status) {
    if (status != EXIT_SIGNAL + SIGALRM) return status;
    fprintf(stderr, "skein %s: --max-time %s: the time is up: the frames until then are what there is\n",
            arguments->command->name, app_value(arguments, "--max-time"));
    return EXIT_FAILURE_RUN;
}

void app_bounds_explain(skein_status status) {
    if (status == SKEIN_ERROR_MEMORY && memory)
        fprintf(stderr, "skein: --max-memory %s is all that it may have: allow more, or make the scene smaller\n",
                memory);
}
