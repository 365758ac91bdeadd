/* The panels: what the window shows over the picture, and what it asks the stage for when one touches them.
 *
 * Called by window.c between widgets_begin() and widgets_end(), under the exchange's lock: they only read `shown`. */
#ifndef SKEIN_VIEWER_PANELS_H
#define SKEIN_VIEWER_PANELS_H

#include "viewer/exchange.h"
#include "viewer/widgets.h"

enum { VIEWER_PLACES = 1000 };

/* Where controls are, for those who follow the events. */
typedef struct viewer_place {
    char name[100];
    double at[4];
} viewer_place;

typedef struct viewer_panels {
    viewer_exchange *exchange;
    viewer_place places[VIEWER_PLACES];
    size_t place_count;
    viewer_request asked; /* the last value that was asked for: shown until the stage, in its own time, has it */
    double asked_at;
    char compare[VIEWER_TEXT], search[64], file[VIEWER_TEXT];
    char lesson_text[VIEWER_TEXT], lesson_seen[VIEWER_TEXT]; /* as it is typed; and as the stage last had it */
    size_t lesson_step;                                      /* the operation that one has come to */
} viewer_panels;

void viewer_panels_show(viewer_panels *panels, int width, int height);
/* The height of what is docked below: the plots and the log; and with the lesson, too: the picture lies above it. */
int viewer_dock_height(const viewer_shown *shown, int height);
int viewer_docked_height(const viewer_shown *shown, int height);
/* The width of the panel at the side: the picture lies beside it. */
int viewer_side_panel_width(int width);

/* ---- between the panels' files ---- */

/* The seconds after which a value that was asked for, and refused or lost, is not shown any more. */
extern const double viewer_asked_for_long;

/* Tells the events where the last control is, if that is new; the same of any box (x, y, width, height). */
void viewer_place_control(viewer_panels *panels, const char *name);
void viewer_place_box(viewer_panels *panels, const char *name, const double box[4]);
/* panels_fields.c: the objects of a side, with a control for each field; one field of them. */
void viewer_show_objects(viewer_panels *panels, int side);
void viewer_show_entry(viewer_panels *panels, const viewer_object *object, const viewer_entry *entry, int side);
/* panels_search.c: where fields are searched for, those that are found. False where nothing is searched for. */
bool viewer_show_search(viewer_panels *panels, int side);
/* panels_lesson.c: docked above whatever else is, which leaves `height`; its own height there, 0 while it is closed */
void viewer_show_lesson(viewer_panels *panels, double left, double width, double height);
double viewer_lesson_height(const viewer_shown *shown, double height);
/* panels_advice.c */
void viewer_show_advice(viewer_panels *panels);
void viewer_show_offer(viewer_panels *panels, const char *place); /* in that panel */
void viewer_show_recent(viewer_panels *panels);
/* panels_handles.c: over the picture, which begins `left`; and the brush in the panel */
void viewer_show_handles(viewer_panels *panels, double left, double width, double height);
void viewer_show_brush(viewer_panels *panels);
/* panels_plots.c */
void viewer_show_plots(viewer_panels *panels, const double at[4]); /* x, y, width, height */

#endif
