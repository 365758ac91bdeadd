/* The window's camera: around a point, or in flight.
 *
 * Starts as the view frames the scene (so that the first picture is that of `skein render`); then mouse and keys move
 * it. Invariant: eye and target differ, and the view is never straight up or down. Called by stage.c. */
#ifndef SKEIN_VIEWER_CAMERA_H
#define SKEIN_VIEWER_CAMERA_H

#include "render/camera.h"

/* What W A S D Q E and the like ask for while they are down. */
typedef enum viewer_motion {
    VIEWER_FORWARD,
    VIEWER_BACK,
    VIEWER_LEFT,
    VIEWER_RIGHT,
    VIEWER_TURN_LEFT,
    VIEWER_TURN_RIGHT,
    VIEWER_MOTION_COUNT
} viewer_motion;

typedef struct viewer_camera {
    render_camera lens; /* what is drawn with */
    double radius;      /* of the scene: what speed is measured by */
    bool placed, flying, moved;
    render_camera before;           /* the flight */
    bool down[VIEWER_MOTION_COUNT]; /* keys */
    bool orbits;                    /* the view turns it by itself, until it is moved */
} viewer_camera;

/* Takes the scene's own camera, and ends a flight. */
void viewer_camera_place(viewer_camera *camera, const render_camera *home, double radius);
/* Pixels of a picture of that height: around the target, or in flight the direction of the eye. */
void viewer_camera_turn(viewer_camera *camera, double dx, double dy, double height);
void viewer_camera_pan(viewer_camera *camera, double dx, double dy, double height);
/* Clicks of a wheel, forward is closer. */
void viewer_camera_zoom(viewer_camera *camera, double clicks);
/* First person, and back to the view before it. */
void viewer_camera_fly(viewer_camera *camera);
/* Lets the keys that are down act for so long; false where none is. */
bool viewer_camera_move(viewer_camera *camera, double seconds);
/* The ray through a pixel, from the upper left corner: from the eye, of length 1. */
void viewer_camera_ray(const viewer_camera *camera, double x, double y, double width, double height,
                       double direction[3]);

#endif
