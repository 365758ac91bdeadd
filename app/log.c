/* run.csv written as a run goes on: its head, a line a step, and a file that is whole or not there (io/commit.h). */
#include "app/log.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/command.h"
#include "io/file.h"

struct app_log {
    io_output *output;
    char line[1024];
};

/* The columns that are plain numbers: their names, with units, and where in the statistics they are. */
#define COLUMN(name, member) \
    { name, offsetof(skein_statistics, member) }
static const struct {
    const char *name;
    size_t offset;
} columns[] = {
    COLUMN("time (s)", time),
    COLUMN("kinetic (J)", kinetic_energy),
    COLUMN("potential (J)", potential_energy),
    COLUMN("elastic (J)", elastic_energy),
    COLUMN("dissipated (J)", dissipated_energy),
    COLUMN("momentum x (kg m/s)", momentum[0]),
    COLUMN("momentum y (kg m/s)", momentum[1]),
    COLUMN("momentum z (kg m/s)", momentum[2]),
    COLUMN("angular momentum x (kg m2/s)", angular_momentum[0]),
    COLUMN("angular momentum y (kg m2/s)", angular_momentum[1]),
    COLUMN("angular momentum z (kg m2/s)", angular_momentum[2]),
    COLUMN("largest stretch", max_stretch),
    COLUMN("penetration (m)", max_penetration),
    COLUMN("residual", residual),
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

app_log *app_log_begin(const char *path) {
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    app_log *log = calloc(1, sizeof *log);
    if (log) log->output = io_output_open(path, &error);
    if (!log || !log->output) {
        app_print_error(&error);
        free(log);
        return NULL;
    }
    io_output_printf(log->output, "step");
    for (size_t i = 0; i < COLUMN_COUNT; i++) io_output_printf(log->output, ",%s", columns[i].name);
    io_output_printf(log->output, ",contacts,Newton iterations,CG iterations,unsolved\n");
    return log;
}

void app_log_line(app_log *log, const skein_statistics *statistics) {
    size_t size = sizeof log->line;
    size_t at = (size_t)snprintf(log->line, size, "%" PRIu64, statistics->steps);
    for (size_t i = 0; i < COLUMN_COUNT; i++)
        at += (size_t)snprintf(log->line + at, size - at, ",%.9g",
                               *(const double *)(const void *)((const char *)statistics + columns[i].offset));
    snprintf(log->line + at, size - at, ",%zu,%zu,%zu,%zu\n", statistics->contacts, statistics->newton_iterations,
             statistics->cg_iterations, statistics->unsolved);
    app_log_text(log, log->line);
}

const char *app_log_last(const app_log *log) {
    return log->line;
}

void app_log_text(app_log *log, const char *line) {
    io_output_write(log->output, line, strlen(line));
}

bool app_log_finish(app_log *log) {
    if (!log) return true;
    skein_error error;
    bool good = !io_output_commit(log->output, &error);
    if (!good) app_print_error(&error);
    free(log);
    return good;
}
