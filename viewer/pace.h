/* How fast things go, and what follows from it: how finely pictures are drawn while things move, and which of both is
 * slow, steps or drawing. Numbers in, decisions out: it looks at no clock. Called by stage.c and stage_picture.c. */
#ifndef SKEIN_VIEWER_PACE_H
#define SKEIN_VIEWER_PACE_H

#include <stdbool.h>
#include <stddef.h>

/* ---- detail ---- */

/* 0 is a whole picture with all its samples; each further one costs less. */
enum { VIEWER_DETAILS = 5 };

typedef struct viewer_detail {
    double scale; /* of width and height */
    bool sampled; /* several samples a pixel */
} viewer_detail;

/* Of a level from 0 to VIEWER_DETAILS - 1. */
viewer_detail viewer_detail_at(int level);
/* The level for the next picture of something that moves, after one of `level` that took so long: the finest that is
 * sure to be drawn often enough. Once a level holds, it stays. */
int viewer_detail_next(int level, double milliseconds);

/* ---- what is slow ---- */

/* What happened in a while. */
typedef struct viewer_pace {
    double real, simulated; /* s */
    double worked;          /* s of processor time that the steps took, on the stage's thread */
    double drawn;           /* s that pictures took */
    size_t steps, pictures;
} viewer_pace;

typedef enum viewer_slowness {
    VIEWER_IN_TIME,
    VIEWER_SLOW_STEPS,    /* they take more time than there is */
    VIEWER_SLOW_DRAWING,  /* there are few pictures a second; steps keep up */
    VIEWER_SLOW_ELSEWHERE /* steps would keep up, but do not get the processor: drawing or other programs have it */
} viewer_slowness;

viewer_slowness viewer_pace_judge(const viewer_pace *pace);
/* "steps", "drawing": for a status line; "" for one that is in time. */
const char *viewer_slowness_word(viewer_slowness slowness);
/* A sentence of what is slow, by how much, and what helps. */
void viewer_slowness_text(viewer_slowness slowness, const viewer_pace *pace, char *text, size_t size);

#endif
