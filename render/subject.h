/* What a picture is of: the shape that a camera has to hold.
 *
 *     frame --> bodies, all --> camera.c
 *
 * A hull keeps, along each of many directions, the farthest point that it was given. So it is as small for a million
 * points as for eight, two of them can be put together, and how far it reaches along any direction is known to a few
 * per cent: closer than a box along the axes, which has corners where nothing is. Called by world_frame.c, and by
 * films, whose camera has to hold all that will happen. */
#ifndef SKEIN_RENDER_SUBJECT_H
#define SKEIN_RENDER_SUBJECT_H

#include "render/frame.h"

enum { RENDER_HULL_DIRECTIONS = 96 };

typedef struct render_hull {
    double direction[RENDER_HULL_DIRECTIONS][3]; /* of length 1 */
    double point[RENDER_HULL_DIRECTIONS][3];     /* the farthest along it, metres */
    double reach[RENDER_HULL_DIRECTIONS];        /* and how far that is; -INFINITY: there is no point yet */
} render_hull;

typedef struct render_subject {
    render_hull bodies; /* what the picture is about */
    render_hull all;    /* with the colliders that stand around; planes and terrain do not count */
    bool has_sheet;     /* among the bodies is a level sheet, which is seen from above or not at all */
    double sheet[3];    /* the middle of the highest of them */
} render_subject;

render_hull render_hull_nothing(void);
bool render_hull_empty(const render_hull *hull);
/* A ball; one that is not finite does not count. */
void render_hull_add(render_hull *hull, const double point[3], double radius);
void render_hull_join(render_hull *hull, const render_hull *other);
/* The box around it, along the axes. */
render_bounds render_hull_bounds(const render_hull *hull);
/* Between two hulls: a at 0, b at 1. b must hold a. */
render_hull render_hull_between(const render_hull *a, const render_hull *b, double t);

render_subject render_subject_nothing(void);
/* Of a flock what keeps together: a few that strayed do not count. Where there are no bodies, what there is. */
render_subject render_subject_of(const render_frame *frame);
void render_subject_join(render_subject *subject, const render_subject *other);

#endif
