/* Detail and slowness; see pace.h. */
#include "viewer/pace.h"

#include <stdio.h>

/* A moving picture may take so long; and a finer one is tried when it is sure to take no more than so long (ms). In
 * between nothing changes. */
static const double most_ms = 50, easy_ms = 38;
/* Under this share of real time a world is slow, and with fewer pictures a second drawing is. */
static const double slow_speed = 0.9, slow_rate = 12;

/* One sample a pixel takes half of what four take; the rest goes with the pixels. */
static const viewer_detail details[VIEWER_DETAILS] = {
    {1, true}, {1, false}, {0.75, false}, {0.5, false}, {0.375, false}};

/* ---- Detail ---- */

viewer_detail viewer_detail_at(int level) {
    return details[level < 0 ? 0 : level < VIEWER_DETAILS ? level : VIEWER_DETAILS - 1];
}

/* What a picture's pixels cost, by level: no more than that goes with them. */
static double cost(int level) {
    double pixels = details[level].scale * details[level].scale;
    return details[level].sampled ? 2.2 * pixels : pixels;
}

int viewer_detail_next(int level, double ms) {
    int next = level;
    // coarser, until it would fit if all of it went with the pixels: what does not shows in the next picture
    while (next + 1 < VIEWER_DETAILS && ms * cost(next) / cost(level) > most_ms) next++;
    bool finer = level > 0 && ms * cost(level - 1) / cost(level) < easy_ms;
    return finer ? level - 1 : next;
}

/* ---- What is slow ---- */

viewer_slowness viewer_pace_judge(const viewer_pace *pace) {
    bool behind = pace->simulated < slow_speed * pace->real;
    // a second of simulated time takes the steps so long, if nobody takes the processor from them
    if (behind && pace->worked >= slow_speed * pace->simulated) return VIEWER_SLOW_STEPS;
    if (behind) return VIEWER_SLOW_ELSEWHERE;
    return (double)pace->pictures < slow_rate * pace->real ? VIEWER_SLOW_DRAWING : VIEWER_IN_TIME;
}

const char *viewer_slowness_word(viewer_slowness slowness) {
    switch (slowness) {
    case VIEWER_IN_TIME: return "";
    case VIEWER_SLOW_STEPS: return "steps";
    case VIEWER_SLOW_DRAWING: return "drawing";
    case VIEWER_SLOW_ELSEWHERE: return "a busy processor";
    }
    return "";
}

void viewer_slowness_text(viewer_slowness slowness, const viewer_pace *pace, char *text, size_t size) {
    double speed = pace->real > 0 ? 100 * pace->simulated / pace->real : 0;
    double step_ms = pace->steps ? 1e3 * pace->worked / (double)pace->steps : 0;
    double there_are = pace->steps ? 1e3 * pace->simulated / (double)pace->steps : 0;
    double draw_ms = pace->pictures ? 1e3 * pace->drawn / (double)pace->pictures : 0;
    double rate = pace->real > 0 ? (double)pace->pictures / pace->real : 0;
    text[0] = 0;
    // the first picture takes its time: there are no numbers to tell yet
    if (slowness != VIEWER_SLOW_STEPS && !pace->pictures) return;
    if (slowness == VIEWER_SLOW_STEPS)
        snprintf(
            text, size,
            "the steps are slow: it goes at %.0f %% of real time; a step takes %.3g ms and may take %.3g. A coarser "
            "body or fewer substeps help",
            speed, step_ms, there_are);
    else if (slowness == VIEWER_SLOW_DRAWING)
        snprintf(text, size,
                 "the drawing is slow: %.0f pictures a second, %.0f ms each; the steps keep up. A smaller window, or a "
                 "graphics card, helps",
                 rate, draw_ms);
    else if (slowness == VIEWER_SLOW_ELSEWHERE)
        snprintf(text, size,
                 "the processor is busy: it goes at %.0f %% of real time, though a step takes %.3g ms of %.3g; drawing "
                 "(%.0f pictures a second, %.0f ms each) or other programs have it. A smaller window helps",
                 speed, step_ms, there_are, rate, draw_ms);
}
