/* Making things: bodies and grounds from a palette, copies, other kinds, meshes of grids. Each is a change of the scene
 * (changes.h), so that it can be undone, done again and saved. Called by stage_answer.c; the palette itself by the panels.
 */
#ifndef SKEIN_VIEWER_MAKE_H
#define SKEIN_VIEWER_MAKE_H

#include "viewer/stage.h"

/* What the palette has. */
typedef struct viewer_piece {
    const char *title, *help;
    skein_category category;
    bool ground;      /* takes the place of the first collider */
    bool file;        /* is made of a file, a mesh */
    const char *json; /* ' stands for ", and $ with a letter for a number: see make.c */
} viewer_piece;

/* `index` from 0; NULL past the end. */
const viewer_piece *viewer_piece_at(size_t index);

void viewer_make(viewer_stage *stage, const viewer_request *request);      /* code: the piece; text: the file, if any */
void viewer_duplicate(viewer_stage *stage, const viewer_request *request); /* category, index */
/* category, index; text: the kind. What both kinds have stays. */
void viewer_other_kind(viewer_stage *stage, const viewer_request *request);
/* index: of a body; its mesh as it is built goes to a file, and the body is made of that. */
void viewer_to_mesh(viewer_stage *stage, const viewer_request *request);

#endif
