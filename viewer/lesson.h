/* The lesson: one constraint of the first world, looked into. What it was before and after the last step and what it is
 * now, its formula operation by operation, and a new text for it.
 *
 *     lesson.c (the stage's thread) --viewer_lesson--> exchange --> panels_lesson.c (the window's)
 *
 * Constraints are gone through object by object: those of the world first, then those that bodies have. Looks only while
 * the lesson is open; a copy of it goes to the window with everything else that is shown. */
#ifndef SKEIN_VIEWER_LESSON_H
#define SKEIN_VIEWER_LESSON_H

#include <stdio.h>

#include "render/world_constraints.h"

enum { VIEWER_LESSON_PARTICLES = 8, VIEWER_LESSON_TEXT = 1024 };

/* What a constraint was at some time. */
typedef struct viewer_look {
    bool taken;
    double time, value; /* s; C, or an energy */
    double gradient[VIEWER_LESSON_PARTICLES][3], place[VIEWER_LESSON_PARTICLES][3];
} viewer_look;

typedef struct viewer_lesson {
    bool any;                   /* there is a constraint */
    size_t object, index;       /* the object that is asked for, and the constraint of it */
    size_t object_count, count; /* how many there are of both */
    skein_category category;    /* of the object, and its place there */
    size_t place;
    skein_handle handle;
    char name[96], label[64], text[VIEWER_LESSON_TEXT];
    char fault[400];                          /* of the last text, which was not taken; "" */
    const skein_field *field;                 /* that the text is of; NULL: it cannot be changed here */
    bool is_energy, one_sided, guarded, many; /* many: of more particles than are shown */
    size_t particle_count;                    /* that are shown */
    uint32_t particle[VIEWER_LESSON_PARTICLES];
    viewer_look before, after, now; /* the last step; and at this moment */
    /* its formula: `derivatives` has 3 particle_count numbers an operation */
    skein_operation *operations;
    double *derivatives;
    size_t operation_count, operation_room, derivative_room;
    bool too_long; /* more operations than are shown */
    /* where its text is to stand: shares of the first world's picture, from its left and its top */
    double x, y;
    bool in_view;
} viewer_lesson;

/* ---- lesson_copy.c: its memory ---- */

void viewer_lesson_release(viewer_lesson *lesson);
/* Room for so many operations, and numbers of their derivatives; what was there stays. False when there is no memory. */
bool viewer_lesson_reserve(viewer_lesson *lesson, size_t operations, size_t derivatives);
/* A copy, into what `to` has room for. False when there is no memory. */
bool viewer_lesson_copy(viewer_lesson *to, const viewer_lesson *from);

/* ---- with the stage ---- */

typedef struct viewer_stage viewer_stage;
typedef struct viewer_request viewer_request;

/* Another scene is open: the lesson begins with its first constraint. */
void viewer_lesson_begin(viewer_stage *stage);
/* Around each step of the first world. */
void viewer_lesson_before(viewer_stage *stage);
void viewer_lesson_after(viewer_stage *stage);
/* Before a picture and what the panels show: looks at what there is now. */
void viewer_lesson_refresh(viewer_stage *stage);
/* What a picture is to point at. */
render_chosen viewer_lesson_chosen(const viewer_stage *stage);
/* Answers VIEWER_LESSON and VIEWER_FORMULA. */
void viewer_lesson_choose(viewer_stage *stage, const viewer_request *request);
void viewer_lesson_write(viewer_stage *stage, const char *text);

/* lesson_solve.c: one solve, and the constraints' values and derivatives before and after it, to the note and the log. */
void viewer_stage_solve(viewer_stage *stage);

/* ---- for both ---- */

/* An operation as a reader writes it, "length = sqrt(x7)"; leaves by their names, others by x and their number among
 * those that compute. */
void viewer_operation_text(const viewer_lesson *lesson, size_t operation, char *text, size_t size);
/* The number of an operation among those that compute, from 1; 0 for a leaf. And the operation of a number. */
size_t viewer_operation_number(const viewer_lesson *lesson, size_t operation);
size_t viewer_operation_at(const viewer_lesson *lesson, size_t number);
size_t viewer_operation_last(const viewer_lesson *lesson); /* the number of the last */

#endif
