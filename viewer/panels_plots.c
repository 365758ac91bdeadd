/* The plots: energies, stretch, contacts and milliseconds, of both sides over each other. */
#include <math.h>
#include <string.h>

#include "viewer/panels.h"

/* At scale 1: charts share what room there is, but get no narrower than this; then they can be scrolled. */
static const double least_chart = 120, most_chart = 280, passes_width = 190, gap = 8;
static const double energy_share = 1.5; /* the chart with four names, measured by the others */

static double chart_width(const viewer_shown *shown) {
    const viewer_side *side = &shown->sides[0];
    double scale = widgets_scale(), charts = 3 + energy_share + (side->flock ? (shown->side_count > 1 ? 2 : 1) : 0);
    double room = widgets_room() - (side->pass_count ? (passes_width + gap) * scale : 0);
    return fmin(fmax(room / charts - gap * scale, least_chart * scale), most_chart * scale);
}

static void plot(const viewer_shown *shown, double width, const char *title, const viewer_quantity *quantities,
                 const char *const *names, int count) {
    const float *series[8];
    const char *words[8];
    size_t first = 0, length = VIEWER_SAMPLES;
    int lines = 0;
    for (size_t s = 0; s < shown->side_count; s++) {
        const viewer_plots *plots = &shown->sides[s].plots;
        if (plots->count < length) length = plots->count;
        first = (plots->next + VIEWER_SAMPLES - length) % VIEWER_SAMPLES;
    }
    for (int q = 0; q < count; q++)
        for (size_t s = 0; s < shown->side_count && lines < 8; s++) {
            series[lines] = shown->sides[s].plots.value[quantities[q]];
            words[lines++] = shown->side_count > 1 ? (s ? shown->sides[1].name : shown->sides[0].name) : names[q];
        }
    widgets_chart chart = {
        title, series, words, lines, shown->sides[0].plots.time, first, length, VIEWER_SAMPLES, shown->side_count > 1};
    widgets_chart_show(&chart, width, widgets_height());
    widgets_same_line();
}

static void show_energies(const viewer_shown *shown, double width) {
    static const viewer_quantity all[] = {VIEWER_KINETIC, VIEWER_POTENTIAL, VIEWER_ELASTIC, VIEWER_TOTAL},
                                 total[] = {VIEWER_TOTAL};
    static const char *const names[] = {"kinetic", "potential", "elastic", "total"};
    if (shown->side_count > 1) plot(shown, energy_share * width, "energy (J)", total, names, 1);
    else plot(shown, energy_share * width, "energy (J)", all, names, 4);
}

/* How birds fly together, by definition from 0 to 1 (docs/methods.md). */
static void show_order(const viewer_shown *shown, double width) {
    static const viewer_quantity both[] = {VIEWER_POLARIZATION, VIEWER_MILLING};
    static const char *const names[] = {"polarization", "milling"};
    for (int q = 0; q < 2 && shown->side_count > 1; q++) plot(shown, width, names[q], &both[q], names, 1);
    if (shown->side_count < 2) plot(shown, width, "order of the flock", both, names, 2);
}

/* What the passes of the plan took, below each other. */
static void show_passes(const viewer_side *side) {
    if (!side->pass_count || !widgets_list("passes", passes_width * widgets_scale(), widgets_height())) return;
    widgets_heading("ms a frame, by pass");
    for (size_t p = 0; p < side->pass_count; p++) {
        char line[120];
        snprintf(line, sizeof line, "%.3f  %s", side->passes[p].milliseconds, side->passes[p].label);
        widgets_text(line);
    }
    widgets_list_end();
}

void viewer_show_plots(viewer_panels *panels, const double at[4]) {
    static const viewer_quantity stretch[] = {VIEWER_STRETCH}, contacts[] = {VIEWER_CONTACTS},
                                 times[] = {VIEWER_STEP_MS, VIEWER_DRAW_MS};
    static const char *const none[] = {""}, *const passes[] = {"step", "draw"};
    const viewer_shown *shown = &panels->exchange->shown;
    bool open = true;
    if (widgets_panel("Plots", WIDGETS_DOCKED, at[0], at[1], at[2], at[3], &open)) {
        double width = chart_width(shown);
        if (shown->sides[0].flock) show_order(shown, width);
        show_energies(shown, width);
        plot(shown, width, "stretch, largest (%)", stretch, none, 1);
        plot(shown, width, "contacts", contacts, none, 1);
        plot(shown, width, "time a frame (ms)", times, passes, shown->side_count > 1 ? 1 : 2);
        show_passes(&shown->sides[0]);
    }
    widgets_panel_end();
    if (open) return;
    viewer_request request = {.kind = VIEWER_PANEL, .code = VIEWER_PANEL_PLOTS, .down = false};
    viewer_ask(panels->exchange, &request);
}
