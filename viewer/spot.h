/* The spot of an object: the fields by which it is moved, turned and sized, whatever kind it is of.
 *
 *     fields of the table --viewer_spot_find--> spot --viewer_spot_gizmo--> a gizmo
 *     what the gizmo did --viewer_spot_apply--> fields with new values (at most two)
 *
 * A spot is a point (`position`, `centre`), two ends (`from`, `to`) or a plane (`normal`, `offset`); it may have a
 * `rotation`, a size along its own axes (`size`, `spread`) and one number of size (`radius`, `scale`). No kind is named.
 * Called by handles.c. */
#ifndef SKEIN_VIEWER_SPOT_H
#define SKEIN_VIEWER_SPOT_H

#include "skein/skein.h"
#include "viewer/gizmo.h"

typedef struct viewer_spot {
    const skein_field *point, *from, *to, *normal, *offset, *turn, *size,
        *uniform;                                                        /* of the tables; NULL: there is none */
    double at[3], ends[2][3], up[3], off, degrees[3], extent[3], factor; /* their values; up is a unit vector */
    bool flat;                                                           /* its size is along x and z */
    bool live[3]; /* whether what moves, turns or sizes it (a viewer_tool less 1) is set in place */
} viewer_spot;

typedef struct viewer_spot_change {
    const skein_field *field;
    skein_value value;
} viewer_spot_change;

/* False where the object has no spot. */
bool viewer_spot_find(viewer_spot *spot, const skein_world *world, skein_category category, size_t index);
bool viewer_spot_can(const viewer_spot *spot, viewer_tool tool);
/* Its middle; a plane's is near `target`. */
void viewer_spot_middle(const viewer_spot *spot, const double target[3], double middle[3]);
/* Rows are its own axes. */
void viewer_spot_axes(const viewer_spot *spot, double axes[3][3]);
/* A gizmo for it: all but its `hot` and its `scale`. */
void viewer_spot_gizmo(const viewer_spot *spot, viewer_tool tool, const double target[3], viewer_gizmo *gizmo);
/* The fields that differ once the gizmo's part has done this (viewer_gizmo_follow), rounded to what a pixel of so many
 * metres shows; returns how many. */
size_t viewer_spot_apply(const viewer_spot *spot, const viewer_gizmo *gizmo, int part, const double by[3], double pixel,
                         viewer_spot_change changes[2]);
/* Where a point that belongs to it comes to. */
void viewer_spot_carry(const viewer_spot *spot, const viewer_gizmo *gizmo, int part, const double by[3],
                       double place[3]);

#endif
