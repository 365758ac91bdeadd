/* The plot of a study: a script for gnuplot with its data inside, a panel for each measure. Two lists of numbers make a
 * map, one makes lines (one for each word of a list of words), random numbers make points. Rows that differ in nothing
 * that is on the axes are averaged. */
#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/study.h"
#include "io/file.h"

extern char **environ;

enum { MOST_PANELS = 9, MOST_TICS = 9, MOST_LINES = 12, NONE = -1 }; // lines beyond that are left to the table

/* Colours that are told apart, also by those who see fewer; as in the plots of skein compare. */
static const char *const colours[MOST_LINES] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
                                                "#000000", "#8c564b", "#7f7f7f", "#17becf", "#bcbd22", "#9467bd"};

typedef struct plot {
    const io_study *study;
    const io_study_folder *folder;
    io_output *o;
    int x, y, by; /* varied fields; NONE */
    bool is_map;  /* x and y are lists of numbers */
    size_t shown[MOST_PANELS], shown_count;
    bool has_line[MOST_PANELS][MOST_LINES]; /* there is a number in it */
} plot;

/* ---- what is drawn ---- */

static size_t list_size(const plot *p, int v) {
    size_t count = 0;
    return v == NONE || io_study_is_random(p->study, (size_t)v, &count) ? 1 : count;
}

/* The k-th value of a list: of the row that has it, with all other fields at their first. New reference. */
static json_t *list_value(const plot *p, int v, size_t k) {
    size_t stride = io_study_rows(p->study);
    for (int i = 0; i <= v; i++) stride /= list_size(p, i);
    return io_study_value(p->study, stride * k, (size_t)v);
}

/* Whether a field is drawn at random, or lists several numbers. */
static bool is_random(const plot *p, int v) {
    size_t count;
    return io_study_is_random(p->study, (size_t)v, &count);
}

static bool has_words(const plot *p, int v) {
    bool words = false;
    for (size_t k = 0; k < list_size(p, v) && !is_random(p, v); k++) {
        json_t *value = list_value(p, v, k);
        words |= !json_is_number(value);
        json_decref(value);
    }
    return words;
}

/* The first field that is none of the two others: of lists (with numbers, or words), or random. */
static int first_field(const plot *p, bool random, bool words, int but) {
    for (int v = 0; io_study_varied(p->study, (size_t)v); v++)
        if (v != but && is_random(p, v) == random && (random || (list_size(p, v) > 1 && has_words(p, v) == words)))
            return v;
    return NONE;
}

static int named_field(const plot *p, const char *member) {
    const char *name = json_string_value(json_object_get(io_study_plot(p->study), member));
    for (int v = 0; name && io_study_varied(p->study, (size_t)v); v++)
        if (!strcmp(name, io_study_varied(p->study, (size_t)v))) return v;
    return NONE;
}

static double measured(const plot *p, size_t row, size_t m) {
    const json_t *x = json_array_get(json_object_get(io_study_folder_row(p->folder, row), "measures"), m);
    return json_is_number(x) ? json_number_value(x) : (double)NAN;
}

static bool has_numbers(const plot *p, size_t m) {
    for (size_t row = 0; row < io_study_rows(p->study); row++)
        if (!isnan(measured(p, row, m))) return true;
    return false;
}

/* Chooses axes and panels; false where there is nothing to draw. */
static bool choose(plot *p) {
    const json_t *show = json_object_get(io_study_plot(p->study), "show");
    p->x = named_field(p, "x"), p->y = named_field(p, "y"), p->by = NONE;
    if (p->x == NONE) p->x = first_field(p, false, false, p->y);
    if (p->x == NONE) p->x = first_field(p, true, false, p->y);
    if (p->x == NONE) p->x = first_field(p, false, true, p->y);
    if (p->x == NONE) return false;
    if (p->y == NONE) p->y = first_field(p, is_random(p, p->x), false, p->x);
    p->is_map = p->y != NONE && !is_random(p, p->x) && !is_random(p, p->y);
    if (p->y == NONE && !is_random(p, p->x)) p->by = first_field(p, false, true, p->x);
    for (size_t m = 0; io_study_measure(p->study, m) && p->shown_count < MOST_PANELS; m++) {
        bool wanted = !json_array_size(show);
        for (size_t i = 0; i < json_array_size(show); i++)
            wanted |= !strcmp(json_string_value(json_array_get(show, i)), io_study_measure(p->study, m));
        if (wanted && has_numbers(p, m)) p->shown[p->shown_count++] = m;
    }
    return p->shown_count > 0;
}

/* ---- words ---- */

/* A text that stays inside its quotes. */
static void plain(const char *text, char out[160]) {
    size_t n = 0;
    for (; text && *text && n < 150; text++)
        if (!strchr("\"\\`'", *text) && (unsigned char)*text >= ' ') out[n++] = *text;
    out[n] = 0;
}

static void label_of(const plot *p, const char *column, const char *unit, char out[160]) {
    const char *given = json_string_value(json_object_get(json_object_get(io_study_plot(p->study), "labels"), column));
    char text[300];
    snprintf(text, sizeof text, "%s%s%s%s", given ? given : column, !given && unit[0] ? " (" : "", given ? "" : unit,
             !given && unit[0] ? ")" : "");
    plain(text, out);
}

/* Places of a list along an axis, few enough to be read. */
static void put_tics(const plot *p, const char *axis, int v) {
    size_t count = list_size(p, v), every = (count + MOST_TICS - 1) / MOST_TICS;
    io_output_printf(p->o, "set %stics (", axis);
    for (size_t k = 0; k < count; k += every) {
        json_t *value = list_value(p, v, k);
        char text[160], number[32];
        if (json_is_number(value)) snprintf(number, sizeof number, "%.4g", json_number_value(value));
        char *json = json_is_number(value) || json_is_string(value) ? NULL : json_dumps(value, JSON_ENCODE_ANY);
        plain(json_is_number(value) ? number : json_is_string(value) ? json_string_value(value) : json, text);
        io_output_printf(p->o, "%s'%s' %zu", k ? ", " : "", text, k);
        free(json);
        json_decref(value);
    }
    io_output_printf(p->o, ")\n");
}

/* ---- data ---- */

/* The place of a row's value in a field's list. */
static size_t place_in(const plot *p, int v, size_t row) {
    if (v == NONE || is_random(p, v)) return 0;
    size_t stride = io_study_rows(p->study);
    for (int i = 0; i <= v; i++) stride /= list_size(p, i);
    return row / stride % list_size(p, v);
}

static double number_at(const plot *p, int v, size_t row) {
    json_t *value = io_study_value(p->study, row, (size_t)v);
    double x = json_number_value(value);
    json_decref(value);
    return x;
}

typedef struct cell {
    double sum, least, most;
    size_t count;
} cell;

/* Means over all rows of a point on the axes: x, y (or the line), the mean, the least, the most. False without memory. */
static bool put_means(plot *p, size_t panel) {
    int other = p->is_map ? p->y : p->by;
    size_t columns = list_size(p, p->x), lines = list_size(p, other);
    bool numbers = !p->is_map && !has_words(p, p->x);
    cell *cells = calloc(columns * lines, sizeof *cells);
    if (!cells) return false;
    for (size_t row = 0; row < io_study_rows(p->study); row++) {
        double m = measured(p, row, p->shown[panel]);
        cell *c = &cells[place_in(p, other, row) * columns + place_in(p, p->x, row)];
        if (isnan(m)) continue;
        c->least = c->count ? fmin(c->least, m) : m;
        c->most = c->count ? fmax(c->most, m) : m;
        c->sum += m;
        c->count++;
    }
    for (size_t l = 0; l < lines; l++) {
        for (size_t k = 0; k < columns; k++) {
            const cell *c = &cells[l * columns + k];
            if (c->count && l < MOST_LINES) p->has_line[panel][l] = true;
            json_t *value = numbers ? list_value(p, p->x, k) : NULL;
            double mean = c->count ? c->sum / (double)c->count : (double)NAN;
            io_output_printf(p->o, "%.9g %zu %.9g %.9g %.9g\n", numbers ? json_number_value(value) : (double)k, l, mean,
                             c->count ? c->least : mean, c->count ? c->most : mean);
            json_decref(value);
        }
        io_output_printf(p->o, "\n%s", p->is_map ? "" : "\n");
    }
    free(cells);
    return true;
}

static void put_points(const plot *p, size_t panel) {
    for (size_t row = 0; row < io_study_rows(p->study); row++)
        io_output_printf(p->o, "%.9g %.9g %.9g\n", number_at(p, p->x, row), p->y == NONE ? 0 : number_at(p, p->y, row),
                         measured(p, row, p->shown[panel]));
}

/* ---- panels ---- */

/* Whether a list goes up by ratios, and would crowd at one end of a linear axis. */
static bool is_wide(const plot *p, int v) {
    size_t count = list_size(p, v);
    json_t *first = list_value(p, v, 0), *last = list_value(p, v, count - 1);
    double a = json_number_value(first), b = json_number_value(last);
    json_decref(first), json_decref(last);
    return count > 2 && a > 0 && b > 0 && (b / a >= 100 || a / b >= 100);
}

static void put_map(const plot *p, size_t panel) {
    put_tics(p, "x", p->x);
    put_tics(p, "y", p->y);
    io_output_printf(p->o,
                     "set xrange [-0.5:%g]; set yrange [-0.5:%g]; unset key; unset grid\n"
                     "plot $panel%zu using 1:2:3 with image\n",
                     (double)list_size(p, p->x) - 0.5, (double)list_size(p, p->y) - 0.5, panel);
}

static void put_lines(const plot *p, size_t panel) {
    size_t lines = list_size(p, p->by);
    bool words = has_words(p, p->x);
    if (words) put_tics(p, "x", p->x);
    if (words) io_output_printf(p->o, "set xrange [-0.5:%g]\n", (double)list_size(p, p->x) - 0.5);
    else if (is_wide(p, p->x)) io_output_printf(p->o, "set logscale x\n");
    io_output_printf(p->o, "%s; plot \\\n", lines > 1 ? "set key top left noenhanced samplen 1.5" : "unset key");
    size_t drawn = 0;
    for (size_t l = 0; l < lines && l < MOST_LINES; l++) {
        char text[160] = "";
        if (!p->has_line[panel][l]) continue;
        if (drawn++) io_output_printf(p->o, ", \\\n");
        json_t *value = lines > 1 ? list_value(p, p->by, l) : NULL;
        plain(json_string_value(value), text);
        io_output_printf(p->o,
                         "  $panel%zu index %zu using 1:3:4:5 with yerrorbars pt 0 lc rgb '%s' notitle, \\\n"
                         "  $panel%zu index %zu using 1:3 with %s pt 7 ps 0.8 lw 1.5 lc rgb '%s' title '%s'",
                         panel, l, colours[l], panel, l, words ? "points" : "linespoints", colours[l], text);
        json_decref(value);
    }
    io_output_printf(p->o, "%s\n", drawn ? "" : "  1/0 notitle");
}

static void put_panel(const plot *p, size_t panel) {
    char x[160], y[160], m[160];
    size_t shown = p->shown[panel];
    label_of(p, io_study_varied(p->study, (size_t)p->x), "", x);
    label_of(p, io_study_measure(p->study, shown), io_study_measure_unit(p->study, shown), m);
    // a map keeps cells that nothing is known of, and shows them white: without them gnuplot would take it for a smaller one
    const char *missing = p->is_map ? "" : "set datafile missing 'nan'; ";
    io_output_printf(p->o, "reset; set xlabel '%s' noenhanced; %sset grid lc rgb '#dddddd'\n", x, missing);
    io_output_printf(p->o,
                     "set palette defined (0 '#30123b', 0.25 '#3a539b', 0.5 '#21908d', 0.75 '#5dc863', 1 '#fde725')\n");
    if (p->y != NONE) {
        label_of(p, io_study_varied(p->study, (size_t)p->y), "", y);
        io_output_printf(p->o, "set ylabel '%s' noenhanced; set title '%s' noenhanced\n", y, m);
    } else io_output_printf(p->o, "set ylabel '%s' noenhanced\n", m);
    if (p->is_map) put_map(p, panel);
    else if (!is_random(p, p->x)) put_lines(p, panel);
    else if (p->y != NONE)
        io_output_printf(p->o, "unset key; plot $panel%zu using 1:2:3 with points pt 7 ps 0.9 palette\n", panel);
    else
        io_output_printf(p->o, "unset key; plot $panel%zu using 1:3 with points pt 7 ps 0.7 lc rgb '#0072b2'\n", panel);
}

static bool put_script(plot *p) {
    char title[160];
    const char *given = json_string_value(json_object_get(io_study_plot(p->study), "title"));
    size_t columns = 1, count = p->shown_count;
    while (columns * columns < count) columns++;
    size_t rows = (count + columns - 1) / columns;
    plain(given ? given : io_study_name(p->study), title);
    for (size_t panel = 0; panel < count; panel++) {
        io_output_printf(p->o, "$panel%zu << END\n", panel);
        if (is_random(p, p->x) || (p->y != NONE && !p->is_map)) put_points(p, panel);
        else if (!put_means(p, panel)) return false;
        io_output_printf(p->o, "END\n");
    }
    for (int svg = 0; svg < 2; svg++) {
        io_output_printf(p->o, "reset; set terminal %s size %zu,%zu %snoenhanced; set output 'plot.%s'\n",
                         svg ? "svg" : "pngcairo", 640 * columns, 480 * rows + 40, svg ? "dynamic " : "font ',11' ",
                         svg ? "svg" : "png");
        io_output_printf(p->o, "set multiplot layout %zu,%zu title '%s' noenhanced\n", rows, columns, title);
        for (size_t panel = 0; panel < count; panel++) put_panel(p, panel);
        io_output_printf(p->o, "unset multiplot; unset output\n");
    }
    return true;
}

/* ---- drawing ---- */

/* It runs in the folder, so that names need no quotes. */
static bool draw(const char *folder, bool *drawn) {
    char *arguments[] = {"sh", "-c", "cd -- \"$1\" && exec gnuplot plot.gnuplot", "sh", (char *)(uintptr_t)folder,
                         NULL};
    pid_t child;
    int status = 0, failure = posix_spawnp(&child, "sh", NULL, NULL, arguments, environ);
    if (!failure)
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    *drawn = !failure && WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (*drawn) return true;
    if (failure || (WIFEXITED(status) && WEXITSTATUS(status) == 127)) {
        fprintf(stderr,
                "skein study: gnuplot is missing (Debian: gnuplot-nox), so there is no plot; %s/plot.gnuplot draws it\n",
                folder);
        return true;
    }
    fprintf(stderr, "skein study: gnuplot could not draw %s/plot.gnuplot\n", folder);
    return false;
}

bool study_plot(const io_study *study, const io_study_folder *folder, const char *path, bool *drawn) {
    plot p = {.study = study, .folder = folder};
    char name[IO_PLACE_SIZE];
    skein_error error = {SKEIN_OK, "", ""};
    *drawn = false;
    if (!choose(&p)) return true;
    snprintf(name, sizeof name, "%s/plot.gnuplot", path);
    p.o = io_output_open(name, &error);
    if (p.o && !put_script(&p)) io_output_fail_memory(p.o);
    if (p.o && !io_output_commit(p.o, &error)) return draw(path, drawn);
    app_print_error(&error);
    return false;
}
