/* The plot of a comparison: a script for gnuplot with its data, written beside the tables. */
#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/compare.h"
#include "io/file.h"

extern char **environ;

/* Twelve colours that are told apart, also by those who see fewer. */
static const char *const colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
                                      "#000000", "#8c564b", "#7f7f7f", "#17becf", "#bcbd22", "#9467bd"};
enum { COLOUR_COUNT = sizeof colours / sizeof *colours };

/* The place of a run's method among the methods, in the order of their first runs. */
static size_t method_place(const compare_run *runs, size_t run) {
    size_t place = 0;
    for (size_t i = 0; i < run && strcmp(runs[i].method, runs[run].method); i++) {
        bool first = true;
        for (size_t k = 0; k < i; k++) first &= strcmp(runs[k].method, runs[i].method) != 0;
        place += first;
    }
    return place;
}

static bool is_first_of_method(const compare_run *runs, size_t run) {
    for (size_t i = 0; i < run; i++)
        if (!strcmp(runs[i].method, runs[run].method)) return false;
    return true;
}

/* What those runs keep to that did not blow up, so that the others leave the picture instead of filling it. */
static void set_range(io_output *o, const compare_run *runs, size_t count, bool energy) {
    double low = INFINITY, high = -INFINITY;
    for (size_t r = 0; r < count; r++)
        for (size_t i = 0; i < runs[r].sample_count && runs[r].outcome == COMPARE_GOOD; i++) {
            double y = energy ? runs[r].samples[i].energy : 100 * runs[r].samples[i].stretch;
            low = fmin(low, y), high = fmax(high, y);
        }
    double margin = fmax(0.05 * (high - low), 1e-9 * fabs(high) + 1e-12);
    if (low <= high) io_output_printf(o, "set yrange [%.9g:%.9g]\n", low - margin, high + margin);
    else io_output_printf(o, "set yrange [*:*]\n");
}

/* A panel over time: a line a run, in the colour of its method; steps are told apart by dashes. */
static void plot_times(io_output *o, const compare_run *runs, size_t count, const char *title, const char *y) {
    io_output_printf(o, "set title '%s'; set xlabel 'time (s)'; plot \\\n", title);
    for (size_t r = 0; r < count; r++)
        io_output_printf(
            o,
            "  'series.csv' every ::1 using ($1==%zu ? $4 : 1/0):(%s) with lines lw 1.5 lc rgb '%s' dt %zu notitle%s\n",
            r, y, colours[method_place(runs, r) % COLOUR_COUNT], 1 + r % 4, r + 1 < count ? ", \\" : "");
}

/* A panel of the table: points of a method are joined. */
static void plot_table(io_output *o, const compare_run *runs, size_t count, const char *title, const char *x,
                       const char *y, int x_column, int y_column) {
    io_output_printf(o, "set title '%s'; set logscale xy; set yrange [*:*]; set xlabel '%s'; set ylabel '%s'; plot \\\n",
                     title, x, y);
    size_t left = 0;
    for (size_t r = 0; r < count; r++) left += is_first_of_method(runs, r);
    for (size_t r = 0; r < count; r++)
        if (is_first_of_method(runs, r))
            io_output_printf(o,
                             "  'compare.csv' every ::1 using (strcol(1) eq '%s' && strcol(3) eq 'good' ? $%d : 1/0):%d "
                             "with linespoints pt 7 ps 0.8 lw 1.5 lc rgb '%s' title '%s'%s\n",
                             runs[r].method, x_column, y_column, colours[method_place(runs, r) % COLOUR_COUNT],
                             runs[r].method, --left ? ", \\" : "");
}

static void write_panels(io_output *o, const char *title, const compare_run *runs, size_t count) {
    io_output_printf(o, "set multiplot layout 2,3 title \"%s\" noenhanced\n", title);
    io_output_printf(o, "set key autotitle noenhanced; unset key\nset ylabel 'J'\n");
    set_range(o, runs, count, true);
    plot_times(o, runs, count, "energy", "$5");
    io_output_printf(o, "set ylabel '%%'\n");
    set_range(o, runs, count, false);
    plot_times(o, runs, count, "largest stretch", "100*$6");
    io_output_printf(o, "set yrange [*:*]; set ylabel 'm'; set logscale y; set format y '%%.0e'\n");
    plot_times(o, runs, count, "distance to the reference", "$7 > 0 ? $7 : 1/0");
    io_output_printf(o, "set format xy '%%.0e'\n");
    plot_table(o, runs, count, "error by step", "step (s)", "m", 2, 5);
    io_output_printf(o, "set key top left noenhanced samplen 1.5; set format y '%%g'\n");
    plot_table(o, runs, count, "time a step", "step (s)", "ms", 2, 8);
    io_output_printf(o, "unset key; set format y '%%.0e'\n");
    plot_table(o, runs, count, "error by cost", "computing (s) a second of the scene", "m", 9, 5);
    io_output_printf(o, "unset multiplot; reset\n");
}

/* A title that stays inside its quotes. */
static void plain_title(const char *title, char out[128]) {
    size_t n = 0;
    for (; *title && n < 120; title++)
        if (!strchr("\"\\`'", *title) && (unsigned char)*title >= ' ') out[n++] = *title;
    out[n] = 0;
}

static bool write_script(const char *folder, const char *title, const compare_run *runs, size_t count) {
    char path[1200], plain[128];
    skein_error error;
    snprintf(path, sizeof path, "%s/compare.gnuplot", folder);
    plain_title(title, plain);
    io_output *o = io_output_open(path, &error);
    if (o) {
        io_output_printf(o, "set datafile separator ','\nset datafile missing 'nan'\n");
        io_output_printf(o, "set terminal pngcairo size 1500,900 font ',10' noenhanced\nset output 'compare.png'\n");
        write_panels(o, plain, runs, count);
        io_output_printf(o, "set datafile separator ','\nset datafile missing 'nan'\n");
        io_output_printf(o, "set terminal svg size 1500,900 dynamic noenhanced\nset output 'compare.svg'\n");
        write_panels(o, plain, runs, count);
        if (!io_output_commit(o, &error)) return true;
    }
    app_print_error(&error);
    return false;
}

bool compare_plot(const char *folder, const char *title, const compare_run *runs, size_t count) {
    if (!write_script(folder, title, runs, count)) return false;
    // it runs in the folder, so that names need no quotes
    char *arguments[] = {"sh", "-c", "cd \"$1\" && exec gnuplot compare.gnuplot", "sh", (char *)(uintptr_t)folder,
                         NULL};
    pid_t child;
    int status = 0, failure = posix_spawnp(&child, "sh", NULL, NULL, arguments, environ);
    if (!failure)
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    if (!failure && WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
    if (failure || (WIFEXITED(status) && WEXITSTATUS(status) == 127)) {
        fprintf(
            stderr,
            "skein compare: gnuplot is missing (Debian: gnuplot-nox), so there is no plot; %s/compare.gnuplot draws it\n",
            folder);
        return true;
    }
    fprintf(stderr, "skein compare: gnuplot could not draw %s/compare.gnuplot\n", folder);
    return false;
}
