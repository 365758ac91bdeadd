/* The camera; see camera.h. */
#include "render/camera.h"

#include "render/linear.h"

#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295;

/* The part of the picture's width and height that the box fills at most; and how far its middle stands below
 * the picture's, in half heights: enough that a level sheet on top is not seen edge on. */
static const double house_fill = 0.77, house_drop = 0.11;

/* Along one axis of the picture: the least distance at which the corners fit between two lines of
 * slope `tangent`, and, for a given distance, where the eye stands. Corners are (x, z) pairs. */
static void fit(const double x[8], const double z[8], double tangent, double *high, double *low) {
    *high = -INFINITY, *low = INFINITY;
    for (int i = 0; i < 8; i++) {
        *high = fmax(*high, x[i] + tangent * z[i]);
        *low = fmin(*low, x[i] - tangent * z[i]);
    }
}

/* The camera that holds the box, from a side and a height in degrees. */
static render_camera frame_box(const render_view_camera *view, const render_bounds *bounds, double azimuth,
                               double aspect) {
    render_bounds box = *bounds;
    render_camera camera = {.up = {0, 1, 0}, .fov = view->fov};
    double radius = render_bounds_radius(&box), centre[3], right[3], up[3], back[3];

    // a point, or nothing, still needs room around it
    render_bounds_centre(&box, centre);
    if (radius < 1e-9) render_bounds_add(&box, centre, 0.5);
    radius = render_bounds_radius(&box);

    double side = azimuth * degree, rise = view->elevation * degree;
    back[0] = sin(side) * cos(rise), back[1] = sin(rise), back[2] = cos(side) * cos(rise);
    render_basis(back, right, up);

    // the corners of the box along the picture's axes
    double x[8], y[8], z[8], nearest = -INFINITY;
    for (int i = 0; i < 8; i++) {
        double corner[3];
        for (int k = 0; k < 3; k++) corner[k] = ((i >> k & 1) ? box.most[k] : box.least[k]) - centre[k];
        x[i] = render_dot(corner, right), y[i] = render_dot(corner, up), z[i] = render_dot(corner, back);
        nearest = fmax(nearest, z[i]);
    }

    // the least distance that serves both width and height; the eye in the middle of what is left
    double ty = tan(0.5 * view->fov * degree) * house_fill * view->zoom, tx = ty * aspect, x_high, x_low, y_high, y_low;
    fit(x, z, tx, &x_high, &x_low);
    fit(y, z, ty, &y_high, &y_low);
    double distance = fmax((x_high - x_low) / (2 * tx), (y_high - y_low) / (2 * ty));
    distance = fmax(distance, nearest + 0.5 * radius / view->zoom);
    double shift_x = 0.5 * (x_high + x_low), shift_y = 0.5 * (y_high + y_low) + distance * ty * house_drop;
    for (int k = 0; k < 3; k++) {
        camera.target[k] = centre[k] + shift_x * right[k] + shift_y * up[k];
        camera.eye[k] = camera.target[k] + distance * back[k];
    }
    camera.near = fmax(0.1 * (distance - nearest), 1e-6 * radius);
    return camera;
}

render_camera render_camera_framing(const render_bounds *bounds, double aspect) {
    render_view view = render_view_default();
    return frame_box(&view.camera, bounds, view.camera.azimuth, aspect);
}

/* At the view's own place, turned about what it looks at. */
static render_camera place_camera(const render_view_camera *view, double angle) {
    render_camera camera = {.fov = view->fov};
    double off[3];
    for (int k = 0; k < 3; k++) off[k] = view->from[k] - view->at[k];
    double distance = sqrt(render_dot(off, off)), c = cos(angle), s = sin(angle);
    const double turned[3] = {c * off[0] + s * off[2], off[1], c * off[2] - s * off[0]};
    for (int k = 0; k < 3; k++) camera.target[k] = view->at[k], camera.eye[k] = view->at[k] + turned[k];
    // straight from above or below, -z is up in the picture
    bool steep = fabs(off[1]) > 0.9999 * distance;
    camera.up[steep ? 2 : 1] = steep ? -1 : 1;
    camera.near = 1e-3 * distance;
    return camera;
}

render_camera render_camera_of_view(const render_view_camera *view, const render_bounds *bounds, double seconds,
                                    double aspect) {
    double turn = view->orbit * seconds;
    bool placed = memcmp(view->from, view->at, sizeof view->from) != 0;
    return placed ? place_camera(view, turn * degree) : frame_box(view, bounds, view->azimuth + turn, aspect);
}

void render_camera_axes(const render_camera *camera, double right[3], double up[3], double back[3]) {
    for (int k = 0; k < 3; k++) back[k] = camera->eye[k] - camera->target[k];
    render_normalise(back);
    render_cross(camera->up, back, right);
    render_normalise(right);
    render_cross(back, right, up);
}

void render_camera_view(const render_camera *camera, double matrix[16]) {
    double right[3], up[3], back[3];
    render_camera_axes(camera, right, up, back);
    render_look_along(right, up, back, camera->eye, matrix);
}

void render_camera_projection(const render_camera *camera, double aspect, double matrix[16]) {
    double scale = 1.0 / tan(0.5 * camera->fov * degree);
    memset(matrix, 0, 16 * sizeof *matrix);
    matrix[0] = scale / aspect;
    matrix[5] = scale;
    matrix[11] = -1;           // w is the distance
    matrix[14] = camera->near; // z / w = near / distance
}
