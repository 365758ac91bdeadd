/* Moving the camera; see camera.h. */
#include "viewer/camera.h"

#include <string.h>

#include "render/linear.h"

static const double degree = 0.017453292519943295;
/* Half a turn for a drag over the picture's height; what a key does in a second; the steepest view. */
static const double turn_by_drag = 180, turn_by_key = 60, steepest = 0.9994;
/* In flight the mouse turns the head, which wants to be finer; keys move so many radii a second. */
static const double turn_head = 60, radii_a_second = 0.8;
static const double nearest = 1e-3; /* what is cut off, of the distance to the target */

void viewer_camera_place(viewer_camera *camera, const render_camera *home, double radius, double time,
                         const double middle[3]) {
    camera->lens = camera->home = *home;
    memcpy(camera->home_middle, middle, sizeof camera->home_middle);
    camera->home_time = time;
    camera->has_middle = false;
    camera->radius = radius > 0 ? radius : 1;
    camera->placed = true;
    camera->flying = camera->moved = false;
}

/* To the first view, as far along as what it follows. */
static void go_home(viewer_camera *camera) {
    camera->lens = camera->home;
    for (int k = 0; k < 3 && camera->follows && camera->has_middle; k++) {
        double way = camera->middle[k] - camera->home_middle[k];
        camera->lens.eye[k] += way, camera->lens.target[k] += way;
    }
}

void viewer_camera_home(viewer_camera *camera) {
    go_home(camera);
    camera->flying = camera->moved = false;
}

void viewer_camera_orbit(viewer_camera *camera, double degrees, double time) {
    go_home(camera);
    render_camera_turn(&camera->lens, degrees * (time - camera->home_time));
}

static double distance_of(const render_camera *lens) {
    double off[3];
    for (int k = 0; k < 3; k++) off[k] = lens->eye[k] - lens->target[k];
    return sqrt(render_dot(off, off));
}

static void touched(viewer_camera *camera) {
    camera->moved = true;
    camera->lens.near = fmin(nearest * distance_of(&camera->lens), nearest * camera->radius);
}

void viewer_camera_frame(viewer_camera *camera, const render_subject *subject, double aspect) {
    render_camera *lens = &camera->lens;
    double from[3];
    for (int k = 0; k < 3; k++) from[k] = lens->eye[k] - lens->target[k];
    *lens = render_camera_hold(subject, from, lens->fov, 1, aspect);
    camera->flying = camera->has_middle = false;
    touched(camera);
}

void viewer_camera_follow(viewer_camera *camera, const double middle[3]) {
    bool knows = camera->follows && camera->has_middle;
    for (int k = 0; k < 3; k++) {
        double way = knows ? middle[k] - camera->middle[k] : 0;
        camera->lens.eye[k] += way, camera->lens.target[k] += way;
        camera->middle[k] = middle[k];
    }
    camera->has_middle = camera->follows;
}

/* A direction, turned by angles to the right and up (radians); not beyond the steepest. */
static void turn_direction(double v[3], double right_angle, double up_angle) {
    double length = sqrt(render_dot(v, v)), flat = sqrt(v[0] * v[0] + v[2] * v[2]);
    double heading = atan2(v[0], v[2]) - right_angle, rise = atan2(v[1], flat) + up_angle;
    rise = fmin(fmax(rise, -asin(steepest)), asin(steepest));
    v[0] = length * cos(rise) * sin(heading);
    v[1] = length * sin(rise);
    v[2] = length * cos(rise) * cos(heading);
}

void viewer_camera_turn(viewer_camera *camera, double dx, double dy, double height) {
    render_camera *lens = &camera->lens;
    double v[3], scale = (camera->flying ? turn_head : turn_by_drag) * degree / height;
    for (int k = 0; k < 3; k++) v[k] = camera->flying ? lens->target[k] - lens->eye[k] : lens->eye[k] - lens->target[k];
    turn_direction(v, scale * dx, (camera->flying ? -scale : scale) * dy);
    for (int k = 0; k < 3; k++) {
        if (camera->flying) lens->target[k] = lens->eye[k] + v[k];
        else lens->eye[k] = lens->target[k] + v[k];
    }
    const double up[3] = {0, 1, 0};
    memcpy(lens->up, up, sizeof up);
    touched(camera);
}

static void shift(viewer_camera *camera, const double by[3]) {
    for (int k = 0; k < 3; k++) camera->lens.eye[k] += by[k], camera->lens.target[k] += by[k];
    touched(camera);
}

void viewer_camera_pan(viewer_camera *camera, double dx, double dy, double height) {
    double right[3], up[3], back[3], by[3];
    double metres = 2 * distance_of(&camera->lens) * tan(0.5 * camera->lens.fov * degree) / height;
    render_camera_axes(&camera->lens, right, up, back);
    for (int k = 0; k < 3; k++) by[k] = metres * (dy * up[k] - dx * right[k]);
    shift(camera, by);
}

void viewer_camera_zoom(viewer_camera *camera, double clicks) {
    render_camera *lens = &camera->lens;
    if (camera->flying) {
        double right[3], up[3], back[3], by[3];
        render_camera_axes(lens, right, up, back);
        for (int k = 0; k < 3; k++) by[k] = -0.1 * clicks * camera->radius * back[k];
        shift(camera, by);
        return;
    }
    double scale = pow(0.88, fmin(fmax(clicks, -20), 20)), distance = distance_of(lens) * scale;
    if (distance < 1e-4 * camera->radius || distance > 1e4 * camera->radius) return;
    for (int k = 0; k < 3; k++) lens->eye[k] = lens->target[k] + scale * (lens->eye[k] - lens->target[k]);
    touched(camera);
}

void viewer_camera_fly(viewer_camera *camera) {
    camera->flying = !camera->flying;
    if (camera->flying) {
        camera->before = camera->lens;
        touched(camera);
    } else {
        camera->lens = camera->before;
    }
}

bool viewer_camera_move(viewer_camera *camera, double seconds) {
    const bool *down = camera->down;
    double ahead = (double)down[VIEWER_FORWARD] - (double)down[VIEWER_BACK];
    double aside = (double)down[VIEWER_RIGHT] - (double)down[VIEWER_LEFT];
    double turn = (double)down[VIEWER_TURN_RIGHT] - (double)down[VIEWER_TURN_LEFT];
    double rise = (double)down[VIEWER_TURN_UP] - (double)down[VIEWER_TURN_DOWN];
    if (ahead == 0 && aside == 0 && turn == 0 && rise == 0) return false;
    double right[3], up[3], back[3], by[3], way = radii_a_second * camera->radius * seconds;
    render_camera_axes(&camera->lens, right, up, back);
    for (int k = 0; k < 3; k++) by[k] = way * (aside * right[k] - ahead * back[k]);
    shift(camera, by);
    if (turn != 0 || rise != 0) {
        // the head turns in flight; else the camera goes round, so that the scene seems to turn
        double height = (camera->flying ? turn_head : turn_by_drag) / turn_by_key;
        viewer_camera_turn(camera, turn * seconds, (camera->flying ? -rise : rise) * seconds, height);
    }
    return true;
}

void viewer_camera_ray(const viewer_camera *camera, double x, double y, double width, double height,
                       double direction[3]) {
    double right[3], up[3], back[3], tall = tan(0.5 * camera->lens.fov * degree);
    double across = (2 * (x + 0.5) / width - 1) * tall * width / height, above = (1 - 2 * (y + 0.5) / height) * tall;
    render_camera_axes(&camera->lens, right, up, back);
    for (int k = 0; k < 3; k++) direction[k] = across * right[k] + above * up[k] - back[k];
    render_normalise(direction);
}
