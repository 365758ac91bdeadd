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
    VIEWER_TURN_UP,
    VIEWER_TURN_DOWN,
    VIEWER_MOTION_COUNT
} viewer_motion;

typedef struct viewer_camera {
    render_camera lens; /* what is drawn with */
    double radius;      /* of the scene: what speed is measured by */
    bool placed, flying, moved;
    render_camera before;           /* the flight */
    bool down[VIEWER_MOTION_COUNT]; /* keys */
    render_camera home;             /* the first view */
    double home_time;               /* of the world, in seconds */
    bool follows, has_middle;       /* it goes along with a body, or with all; and knows where their middle was */
    double middle[3], home_middle[3];
} viewer_camera;

/* Takes the scene's own camera, at a time of the world, with what it would follow where it is then; ends a flight. */
void viewer_camera_place(viewer_camera *camera, const render_camera *home, double radius, double time,
                         const double middle[3]);
/* The first view again; of what has moved since, where it follows that. */
void viewer_camera_home(viewer_camera *camera);
/* The first view, gone round by so many degrees a second since then. */
void viewer_camera_orbit(viewer_camera *camera, double degrees, double time);
/* All of the subject in the picture, from the side that the camera is on. */
void viewer_camera_frame(viewer_camera *camera, const render_subject *subject, double aspect);
/* Where it follows: goes along by what the middle has moved since the last call. */
void viewer_camera_follow(viewer_camera *camera, const double middle[3]);
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
