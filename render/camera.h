/* The camera: where a picture is taken from.
 *
 * Filled by render_camera_framing() for a scene, or moved about by a window; read by draw.c.
 * Depth runs backwards (1 at `near`, 0 infinitely far away), which keeps float depth exact far out:
 * so there is no far end to choose. */
#ifndef SKEIN_RENDER_CAMERA_H
#define SKEIN_RENDER_CAMERA_H

#include "render/frame.h"
#include "render/subject.h"
#include "render/view.h"

typedef struct render_camera {
    double eye[3], target[3]; /* metres; the two differ */
    double up[3];             /* leans towards it */
    double fov;               /* vertical angle of the picture, degrees */
    double near;              /* metres; what is closer is cut off */
} render_camera;

/* A camera that holds the whole box in the picture: from the front right, slightly above, so that
 * the horizon shows. `aspect` is width / height. An empty box counts as a unit box at the origin. */
render_camera render_camera_framing(const render_bounds *bounds, double aspect);
/* A camera that looks at the subject from that direction (of any length): all of its bodies are in the picture, and
 * large; of what stands around as much as leaves them so. */
render_camera render_camera_hold(const render_subject *subject, const double from[3], double fov, double zoom,
                                 double aspect);
/* The camera that a view asks for, `seconds` into the scene: at its own place, or one that holds the subject. */
render_camera render_camera_of_view(const render_view_camera *view, const render_subject *subject, double seconds,
                                    double aspect);
/* Goes round what it looks at, to the right of it. */
void render_camera_turn(render_camera *camera, double degrees);
/* The parts of the picture's width and height that a hull takes up. */
void render_camera_share(const render_camera *camera, const render_hull *hull, double aspect, double shares[2]);

/* Three unit axes of the picture: to the right, up, and back towards the viewer. */
void render_camera_axes(const render_camera *camera, double right[3], double up[3], double back[3]);
/* World to camera: x right, y up, the viewer looks along -z. By columns. */
void render_camera_view(const render_camera *camera, double matrix[16]);
/* Camera to clip space, for glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE) and GL_GREATER. */
void render_camera_projection(const render_camera *camera, double aspect, double matrix[16]);

#endif
