/* The camera; see camera.h. */
#include "render/camera.h"

#include "render/linear.h"

#include <math.h>
#include <string.h>

static const double degree = 0.017453292519943295;

/* The part of the picture's width and height that what is held fills at most; and how far its middle stands below
 * the picture's, in half heights: enough that a level sheet on top is not seen edge on. */
static const double house_fill = 0.79, house_drop = 0.07;
/* The bodies fill so much of the picture's width and height, or, where they are long and thin, of one of them: what
 * stands around them is cut off where they would not. */
static const double wanted_share = 0.31, wanted_length = 0.68;
/* A level sheet is seen from so many degrees above at least. */
static const double seen_sheet = 7;
enum { SEARCH_STEPS = 20, TURNS = 12, SHEET_STEPS = 6 };

/* A hull along the picture's axes: right, up and back, from its own middle. */
typedef struct seen_hull {
    double x[RENDER_HULL_DIRECTIONS], y[RENDER_HULL_DIRECTIONS], z[RENDER_HULL_DIRECTIONS];
} seen_hull;

static double turn_hull(const render_hull *hull, double axes[3][3], const double middle[3], seen_hull *seen) {
    double nearest = -INFINITY;
    for (int i = 0; i < RENDER_HULL_DIRECTIONS; i++) {
        double off[3];
        for (int k = 0; k < 3; k++) off[k] = hull->point[i][k] - middle[k];
        seen->x[i] = render_dot(off, axes[0]), seen->y[i] = render_dot(off, axes[1]);
        seen->z[i] = render_dot(off, axes[2]);
        nearest = fmax(nearest, seen->z[i]);
    }
    return nearest;
}

/* Along one axis of the picture: the points fit between two lines of slope `tangent`, one through each of these places
 * on the axis. */
static void fit(const double *x, const double *z, double tangent, double *high, double *low) {
    *high = -INFINITY, *low = INFINITY;
    for (int i = 0; i < RENDER_HULL_DIRECTIONS; i++) {
        *high = fmax(*high, x[i] + tangent * z[i]);
        *low = fmin(*low, x[i] - tangent * z[i]);
    }
}

/* The part of the picture's height (tangent: half of it, at distance 1) or width between the outermost points. */
static double share(const double *x, const double *z, double tangent, double shift, double distance) {
    double high = -INFINITY, low = INFINITY;
    for (int i = 0; i < RENDER_HULL_DIRECTIONS; i++) {
        double seen = (x[i] - shift) / fmax(distance - z[i], 1e-9 * distance);
        high = fmax(high, seen), low = fmin(low, seen);
    }
    return 0.5 * (high - low) / tangent;
}

/* The camera that holds a hull and looks along -axes[2]. */
static render_camera hold(const render_hull *hull, double axes[3][3], double fov, double zoom, double aspect) {
    render_camera camera = {.fov = fov};
    render_bounds box = render_hull_bounds(hull);
    double radius = render_bounds_radius(&box), centre[3], x_high, x_low, y_high, y_low;
    seen_hull seen;
    render_bounds_centre(&box, centre);
    double nearest = turn_hull(hull, axes, centre, &seen);
    // the least distance that serves both width and height; the eye in the middle of what is left
    double ty = tan(0.5 * fov * degree) * house_fill * zoom, tx = ty * aspect;
    fit(seen.x, seen.z, tx, &x_high, &x_low);
    fit(seen.y, seen.z, ty, &y_high, &y_low);
    double distance = fmax((x_high - x_low) / (2 * tx), (y_high - y_low) / (2 * ty));
    distance = fmax(distance, nearest + 0.5 * radius / zoom);
    double shift_x = 0.5 * (x_high + x_low), shift_y = 0.5 * (y_high + y_low) + distance * ty * house_drop;
    for (int k = 0; k < 3; k++) {
        camera.target[k] = centre[k] + shift_x * axes[0][k] + shift_y * axes[1][k];
        camera.eye[k] = camera.target[k] + distance * axes[2][k];
    }
    camera.near = 1e-3 * distance;
    // straight from above or below, up is what the picture's is
    if (fabs(axes[2][1]) < 0.999) camera.up[1] = 1;
    else memcpy(camera.up, axes[1], sizeof camera.up);
    return camera;
}

void render_camera_share(const render_camera *camera, const render_hull *hull, double aspect, double shares[2]) {
    double axes[3][3], off[3], tall = tan(0.5 * camera->fov * degree);
    seen_hull seen;
    render_camera_axes(camera, axes[0], axes[1], axes[2]);
    turn_hull(hull, axes, camera->target, &seen);
    for (int k = 0; k < 3; k++) off[k] = camera->eye[k] - camera->target[k];
    double distance = sqrt(render_dot(off, off));
    shares[0] = share(seen.x, seen.z, tall * aspect, 0, distance);
    shares[1] = share(seen.y, seen.z, tall, 0, distance);
}

static bool is_large(const render_camera *camera, const render_subject *subject, double aspect) {
    double shares[2];
    render_camera_share(camera, &subject->bodies, aspect, shares);
    return fmin(shares[0], shares[1]) >= wanted_share || fmax(shares[0], shares[1]) >= wanted_length;
}

render_camera render_camera_hold(const render_subject *subject, const double from[3], double fov, double zoom,
                                 double aspect) {
    render_subject held = *subject;
    render_bounds box = render_hull_bounds(&held.bodies);
    double axes[3][3], centre[3];
    // a point, or nothing, still needs room around it
    render_bounds_centre(&box, centre);
    if (render_bounds_radius(&box) < 1e-9) {
        render_hull_add(&held.bodies, centre, 0.5);
        render_hull_join(&held.all, &held.bodies);
    }
    memcpy(axes[2], from, sizeof axes[2]);
    render_normalise(axes[2]);
    render_basis(axes[2], axes[0], axes[1]);

    render_camera camera = hold(&held.all, axes, fov, 1, aspect);
    render_hull hull = held.all;
    if (!is_large(&camera, &held, aspect)) {
        // as much of what stands around as leaves the bodies large
        double least = 0, most = 1;
        for (int i = 0; i < SEARCH_STEPS; i++) {
            double middle = 0.5 * (least + most);
            hull = render_hull_between(&held.bodies, &held.all, middle);
            camera = hold(&hull, axes, fov, 1, aspect);
            *(is_large(&camera, &held, aspect) ? &least : &most) = middle;
        }
        hull = render_hull_between(&held.bodies, &held.all, least);
    }
    return hold(&hull, axes, fov, zoom, aspect);
}

/* The same from all sides: a camera that goes round holds it all the way. */
static void revolve(render_hull *hull) {
    render_bounds box = render_hull_bounds(hull);
    double centre[3];
    render_bounds_centre(&box, centre);
    const render_hull once = *hull;
    for (int t = 1; t < TURNS; t++) {
        double c = cos(360 * degree * t / TURNS), s = sin(360 * degree * t / TURNS);
        for (int i = 0; i < RENDER_HULL_DIRECTIONS; i++) {
            double x = once.point[i][0] - centre[0], z = once.point[i][2] - centre[2];
            const double turned[3] = {centre[0] + c * x + s * z, once.point[i][1], centre[2] + c * z - s * x};
            render_hull_add(hull, turned, 0);
        }
    }
}

static render_camera hold_from(const render_view_camera *view, const render_subject *subject, double azimuth,
                               double elevation, double aspect) {
    double side = azimuth * degree, rise = elevation * degree;
    const double back[3] = {sin(side) * cos(rise), sin(rise), cos(side) * cos(rise)};
    return render_camera_hold(subject, back, view->fov, view->zoom, aspect);
}

/* How far above a level sheet the eye stands, as its middle sees it: degrees. */
static double height_over(const render_camera *camera, const double sheet[3]) {
    double off[3];
    for (int k = 0; k < 3; k++) off[k] = camera->eye[k] - sheet[k];
    return atan2(off[1], hypot(off[0], off[2])) / degree;
}

/* The camera that holds the subject, from a side and a height in degrees. A level sheet above the picture's middle
 * would be seen on its edge: the eye goes up until it is seen, unless the view asks for a height of its own. */
static render_camera frame_subject(const render_view_camera *view, const render_subject *subject, double azimuth,
                                   double aspect) {
    render_subject round = *subject;
    if (view->orbit != 0 && !render_hull_empty(&subject->all)) {
        revolve(&round.bodies);
        revolve(&round.all);
    }
    double elevation = view->elevation;
    render_camera camera = hold_from(view, &round, azimuth, elevation, aspect);
    bool free = elevation == render_view_default().camera.elevation;
    for (int i = 0; i < SHEET_STEPS && free && round.has_sheet; i++) {
        double lack = seen_sheet - height_over(&camera, round.sheet);
        if (lack <= 0) break;
        elevation = fmin(elevation + lack, 89);
        camera = hold_from(view, &round, azimuth, elevation, aspect);
    }
    return camera;
}

render_camera render_camera_framing(const render_bounds *bounds, double aspect) {
    render_view view = render_view_default();
    render_subject subject = render_subject_nothing();
    for (int i = 0; i < 8 && !render_bounds_empty(bounds); i++) {
        const double *ends[2] = {bounds->least, bounds->most};
        const double corner[3] = {ends[i & 1][0], ends[i >> 1 & 1][1], ends[i >> 2][2]};
        render_hull_add(&subject.bodies, corner, 0);
    }
    subject.all = subject.bodies;
    return frame_subject(&view.camera, &subject, view.camera.azimuth, aspect);
}

void render_camera_turn(render_camera *camera, double degrees) {
    double c = cos(degrees * degree), s = sin(degrees * degree);
    double x = camera->eye[0] - camera->target[0], z = camera->eye[2] - camera->target[2];
    double up_x = camera->up[0], up_z = camera->up[2];
    camera->eye[0] = camera->target[0] + c * x + s * z, camera->eye[2] = camera->target[2] + c * z - s * x;
    camera->up[0] = c * up_x + s * up_z, camera->up[2] = c * up_z - s * up_x;
}

/* At the view's own place. */
static render_camera place_camera(const render_view_camera *view) {
    render_camera camera = {.fov = view->fov};
    double off[3];
    for (int k = 0; k < 3; k++) off[k] = view->from[k] - view->at[k];
    double distance = sqrt(render_dot(off, off));
    memcpy(camera.target, view->at, sizeof camera.target);
    memcpy(camera.eye, view->from, sizeof camera.eye);
    // straight from above or below, -z is up in the picture
    bool steep = fabs(off[1]) > 0.9999 * distance;
    camera.up[steep ? 2 : 1] = steep ? -1 : 1;
    camera.near = 1e-3 * distance;
    return camera;
}

render_camera render_camera_of_view(const render_view_camera *view, const render_subject *subject, double seconds,
                                    double aspect) {
    double turn = view->orbit * seconds;
    if (!memcmp(view->from, view->at, sizeof view->from))
        return frame_subject(view, subject, view->azimuth + turn, aspect);
    render_camera camera = place_camera(view);
    if (camera.up[1] != 0) render_camera_turn(&camera, turn);
    return camera;
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
