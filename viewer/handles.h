/* Handles in the picture: what is chosen is moved, turned and sized by the pointer, and pins are painted.
 *
 *     key, button of the panel --choose--> tool and object --press, drag, release--> a change that is kept (stage_change.c)
 *
 * While it is dragged a rule follows at once; a body that has to be built anew is put back to its start, where it follows
 * as it will be built, and is built once it is let go. Nothing else changes, and all of it is one change to undo. Called
 * by the stage's files, on the stage's thread. */
#ifndef SKEIN_VIEWER_HANDLES_H
#define SKEIN_VIEWER_HANDLES_H

#include "viewer/brush.h"
#include "viewer/knife.h"
#include "viewer/spot.h"

typedef struct viewer_stage viewer_stage;
typedef struct viewer_request viewer_request;

/* A field's value on a side, before a hand was on it. */
typedef struct viewer_handles_before {
    size_t side;
    const skein_field *field;
    skein_value value;
} viewer_handles_before;

typedef struct viewer_handles {
    viewer_tool tool;
    bool chosen; /* an object is */
    skein_category category;
    size_t index;
    int hot;         /* the part under the pointer */
    size_t hot_side; /* the side that it is on */
    /* while a part is held */
    bool holds, moved, steps; /* steps: by whole ones, as Ctrl asks */
    size_t side;
    int part;
    double from[2], by[3];
    viewer_gizmo gizmo; /* as it was taken hold of */
    viewer_spot spot;
    viewer_handles_before before[4]; /* of a rule that follows */
    size_t before_count;
    double *places; /* of the body's particles, then; 3 each */
    size_t first, count;
    char words[96]; /* what it does */
    viewer_brush brush;
    viewer_knife knife;
} viewer_handles;

/* The handles of a tool, on what is under the pointer or what was chosen before; again the same tool puts them away. */
void viewer_handles_key(viewer_stage *stage, viewer_tool tool);
/* The same on an object: category and index; code: the tool. */
void viewer_handles_request(viewer_stage *stage, const viewer_request *request);
void viewer_handles_next(viewer_stage *stage); /* another object */
/* Ends what is done without doing it, or else puts the handles away. False where there are none. */
bool viewer_handles_escape(viewer_stage *stage);
/* What there was has gone: a scene was opened or built anew. */
void viewer_handles_anew(viewer_stage *stage, bool another_scene);
void viewer_handles_release_memory(viewer_handles *handles);

/* The pointer. Pressed: true where it is the handles'. */
bool viewer_handles_press(viewer_stage *stage, const viewer_request *request);
void viewer_handles_drag(viewer_stage *stage);
void viewer_handles_let_go(viewer_stage *stage);
void viewer_handles_hover(viewer_stage *stage, bool over_picture);
bool viewer_handles_scroll(viewer_stage *stage, double clicks);
/* Whether the pointer is theirs at the moment; and whether time has to wait for it. */
bool viewer_handles_busy(const viewer_stage *stage);
bool viewer_handles_wait(const viewer_stage *stage);

/* What is to be seen of them on a side. */
void viewer_handles_draw(const viewer_stage *stage, size_t side, viewer_strokes *strokes);
/* Where the parts are, for those who follow the events: the part's name and its place; false past the last. */
bool viewer_handles_part(const viewer_stage *stage, size_t side, int part, char name[64], double at[2]);

#endif
