/* The knife: a stroke of the pointer cuts the cloths whose picture it crosses.
 *
 *     two places of the pointer --> a blade, the triangle from the eye through both --> skein_cut() of every body
 *
 * What is cut is no change of the scene: going back in time and to the start make it whole, recordings hold it. Where two
 * worlds are compared both are cut by the one blade, as both are seen with one camera. Called by handles.c. */
#ifndef SKEIN_VIEWER_KNIFE_H
#define SKEIN_VIEWER_KNIFE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct viewer_stage viewer_stage;

typedef struct viewer_knife {
    bool cuts;      /* a stroke is under way */
    size_t side;    /* that it began on */
    double last[2]; /* where it was, pixels */
    size_t faces;   /* that it has taken from the first world */
} viewer_knife;

void viewer_knife_begin(viewer_stage *stage);
void viewer_knife_go_on(viewer_stage *stage);
void viewer_knife_end(viewer_stage *stage);

#endif
