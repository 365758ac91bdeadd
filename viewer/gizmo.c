/* Drawing, picking and following; see gizmo.h. */
#include "viewer/gizmo.h"

#include <math.h>
#include <string.h>

#include "render/linear.h"

static const double degree = 0.017453292519943295;
/* Pixels at scale 1: an arrow's length; how near the pointer has to be; the head, the box at an axis' end. */
static const double arm = 92, near_enough = 9, head_long = 15, head_wide = 6, box_half = 6;
/* Shares of an arm: where arrows begin, and where the squares between two of them lie. */
static const double gap = 0.14, square_from = 0.24, square_to = 0.48;
/* An axis that is looked along is not drawn, nor a square that is seen from its edge. */
static const double end_on = 0.985, edge_on = 0.12;
enum { RING = 72 };

const char *viewer_gizmo_part(int part) {
    static const char *const words[GIZMO_PARTS] = {"x", "y", "z", "yz", "xz", "xy", "all"};
    return part >= 0 && part < GIZMO_PARTS ? words[part] : "nothing";
}

/* ---- Sight ---- */

static double slope_of(const viewer_sight *sight) {
    return tan(0.5 * sight->lens.fov * degree);
}

static double depth_of(const viewer_sight *sight, const double place[3]) {
    double right[3], up[3], back[3], off[3];
    render_camera_axes(&sight->lens, right, up, back);
    for (int k = 0; k < 3; k++) off[k] = place[k] - sight->lens.eye[k];
    return -render_dot(off, back);
}

bool viewer_sight_project(const viewer_sight *sight, const double place[3], double at[2]) {
    double right[3], up[3], back[3], off[3];
    render_camera_axes(&sight->lens, right, up, back);
    for (int k = 0; k < 3; k++) off[k] = place[k] - sight->lens.eye[k];
    double depth = -render_dot(off, back), tall = slope_of(sight);
    if (!(depth > sight->lens.near)) return false;
    double pixels = 0.5 * sight->height / (tall * depth);
    at[0] = sight->left + 0.5 * sight->width + pixels * render_dot(off, right);
    at[1] = 0.5 * sight->height - pixels * render_dot(off, up);
    return true;
}

void viewer_sight_ray(const viewer_sight *sight, double x, double y, double direction[3]) {
    double right[3], up[3], back[3], tall = slope_of(sight), half = 0.5 * sight->height;
    double across = tall * (x - sight->left - 0.5 * sight->width) / half, above = tall * (half - y) / half;
    render_camera_axes(&sight->lens, right, up, back);
    for (int k = 0; k < 3; k++) direction[k] = across * right[k] + above * up[k] - back[k];
    render_normalise(direction);
}

double viewer_sight_metres(const viewer_sight *sight, const double place[3]) {
    return 2 * slope_of(sight) * fmax(depth_of(sight, place), sight->lens.near) / fmax(sight->height, 1);
}

double viewer_sight_radius(const viewer_sight *sight, const double middle[3], double radius) {
    double off[3];
    for (int k = 0; k < 3; k++) off[k] = middle[k] - sight->lens.eye[k];
    double square = render_dot(off, off) - radius * radius; // to where the line of sight touches it
    return square > 0 ? 0.5 * sight->height / slope_of(sight) * radius / sqrt(square) : 0;
}

/* ---- Strokes ---- */

static viewer_stroke *next_stroke(viewer_strokes *strokes, viewer_stroke like) {
    if (strokes->count == VIEWER_STROKES) return NULL;
    viewer_stroke *stroke = &strokes->data[strokes->count++];
    *stroke = like;
    return stroke;
}

void viewer_stroke_line(viewer_strokes *strokes, const double from[2], const double to[2], viewer_stroke like) {
    viewer_stroke *stroke = next_stroke(strokes, like);
    if (!stroke) return;
    stroke->shape = STROKE_LINE;
    for (int k = 0; k < 2; k++) stroke->at[0][k] = (float)from[k], stroke->at[1][k] = (float)to[k];
}

void viewer_stroke_circle(viewer_strokes *strokes, const double middle[2], double radius, viewer_stroke like) {
    viewer_stroke *stroke = next_stroke(strokes, like);
    if (!stroke) return;
    stroke->shape = STROKE_CIRCLE;
    for (int k = 0; k < 2; k++) stroke->at[0][k] = (float)middle[k];
    stroke->at[1][0] = (float)radius;
}

/* Filled, with three corners or four. */
static void fill(viewer_strokes *strokes, const double (*corners)[2], int count, viewer_stroke like) {
    viewer_stroke *stroke = next_stroke(strokes, like);
    if (!stroke) return;
    stroke->shape = count == 3 ? STROKE_TRIANGLE : STROKE_SQUARE;
    for (int c = 0; c < 4; c++)
        for (int k = 0; k < 2; k++) stroke->at[c][k] = (float)corners[c < count ? c : count - 1][k];
}

void viewer_stroke_edge(viewer_strokes *strokes, const viewer_sight *sight, const double from[3], const double to[3],
                        viewer_stroke like) {
    double a[2], b[2];
    if (viewer_sight_project(sight, from, a) && viewer_sight_project(sight, to, b))
        viewer_stroke_line(strokes, a, b, like);
}

/* ---- The gizmo on the picture ---- */

/* How long an arm is, in metres. */
static double reach_of(const viewer_gizmo *gizmo, const viewer_sight *sight) {
    return arm * gizmo->scale * viewer_sight_metres(sight, gizmo->origin);
}

/* The way from the origin to the eye, of length 1. */
static void towards_eye(const viewer_gizmo *gizmo, const viewer_sight *sight, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = sight->lens.eye[k] - gizmo->origin[k];
    render_normalise(out);
}

static void along(const viewer_gizmo *gizmo, int axis, double metres, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = gizmo->origin[k] + metres * gizmo->axes[axis][k];
}

static viewer_stroke paint_of(const viewer_gizmo *gizmo, int part, double width, double opacity) {
    viewer_paint own = part == GIZMO_ALL ? VIEWER_PAINT_ALL : (viewer_paint)(VIEWER_PAINT_X + part % 3);
    return (viewer_stroke){.width = (float)(width * gizmo->scale),
                           .opacity = (float)opacity,
                           .paint = part == gizmo->hot ? VIEWER_PAINT_HOT : own,
                           .part = part};
}

/* An arm with a head or a box at its end. */
static void draw_arm(const viewer_gizmo *gizmo, const viewer_sight *sight, int axis, viewer_strokes *strokes) {
    double eye[3], from[3], to[3], a[2], b[2], reach = reach_of(gizmo, sight);
    towards_eye(gizmo, sight, eye);
    if (fabs(render_dot(eye, gizmo->axes[axis])) > end_on) return;
    along(gizmo, axis, gap * reach, from);
    along(gizmo, axis, reach, to);
    if (!viewer_sight_project(sight, from, a) || !viewer_sight_project(sight, to, b)) return;
    double way[2] = {b[0] - a[0], b[1] - a[1]}, length = hypot(way[0], way[1]);
    if (!(length > 1)) return;
    for (int k = 0; k < 2; k++) way[k] /= length;
    viewer_stroke_line(strokes, a, b, paint_of(gizmo, axis, 3, 1));
    double s = gizmo->scale, wide = (gizmo->tool == VIEWER_SIZES ? box_half : head_wide) * s, ahead = head_long * s;
    const double left[2] = {b[0] - wide * way[1], b[1] + wide * way[0]},
                 right[2] = {b[0] + wide * way[1], b[1] - wide * way[0]};
    if (gizmo->tool == VIEWER_SIZES) {
        ahead = 2 * wide;
        const double l[2] = {left[0] + ahead * way[0], left[1] + ahead * way[1]},
                     r[2] = {right[0] + ahead * way[0], right[1] + ahead * way[1]};
        const double box[4][2] = {{left[0], left[1]}, {l[0], l[1]}, {r[0], r[1]}, {right[0], right[1]}};
        fill(strokes, box, 4, paint_of(gizmo, axis, 0, 1));
    } else {
        const double head[3][2] = {
            {left[0], left[1]}, {b[0] + ahead * way[0], b[1] + ahead * way[1]}, {right[0], right[1]}};
        fill(strokes, head, 3, paint_of(gizmo, axis, 0, 1));
    }
}

/* The square between two arms, across the third. */
static void draw_square(const viewer_gizmo *gizmo, const viewer_sight *sight, int across, viewer_strokes *strokes) {
    static const double corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    double eye[3], at[4][2], reach = reach_of(gizmo, sight);
    towards_eye(gizmo, sight, eye);
    if (fabs(render_dot(eye, gizmo->axes[across])) < edge_on) return;
    const double *u = gizmo->axes[(across + 1) % 3], *v = gizmo->axes[(across + 2) % 3];
    int part = GIZMO_PLANE + across;
    for (int c = 0; c < 4; c++) {
        double place[3], a = square_from + corners[c][0] * (square_to - square_from),
                         b = square_from + corners[c][1] * (square_to - square_from);
        for (int k = 0; k < 3; k++) place[k] = gizmo->origin[k] + reach * (a * u[k] + b * v[k]);
        if (!viewer_sight_project(sight, place, at[c])) return;
    }
    double opacity = part == gizmo->hot ? 0.75 : 0.4;
    fill(strokes, (const double(*)[2])at, 4, paint_of(gizmo, part, 0, opacity));
    for (int c = 0; c < 4; c++) viewer_stroke_line(strokes, at[c], at[(c + 1) % 4], paint_of(gizmo, part, 1.2, 1));
}

/* A point of the ring about an axis. */
static void ring_point(const viewer_gizmo *gizmo, int axis, double reach, double angle, double out[3]) {
    const double *u = gizmo->axes[(axis + 1) % 3], *v = gizmo->axes[(axis + 2) % 3];
    for (int k = 0; k < 3; k++) out[k] = gizmo->origin[k] + reach * (cos(angle) * u[k] + sin(angle) * v[k]);
}

/* The half of a ring that lies in front is taken hold of; the other is there to be seen as a ring. */
static void draw_ring(const viewer_gizmo *gizmo, const viewer_sight *sight, int axis, viewer_strokes *strokes) {
    double eye[3], reach = reach_of(gizmo, sight);
    towards_eye(gizmo, sight, eye);
    for (int i = 0; i < RING; i++) {
        double from[3], to[3], off[3], angle = 6.283185307179586 / RING;
        ring_point(gizmo, axis, reach, angle * i, from);
        ring_point(gizmo, axis, reach, angle * (i + 1), to);
        for (int k = 0; k < 3; k++) off[k] = 0.5 * (from[k] + to[k]) - gizmo->origin[k];
        bool front = render_dot(off, eye) > -0.04 * reach;
        viewer_stroke like = paint_of(gizmo, axis, front ? 3 : 1.5, front ? 1 : 0.3);
        if (!front) like.part = GIZMO_NOTHING;
        viewer_stroke_edge(strokes, sight, from, to, like);
    }
}

/* The middle: a ball to move by, or a box. */
static void draw_middle(const viewer_gizmo *gizmo, const viewer_sight *sight, viewer_strokes *strokes) {
    double at[2], half = box_half * gizmo->scale;
    if (!viewer_sight_project(sight, gizmo->origin, at)) return;
    if (gizmo->tool == VIEWER_MOVES) {
        viewer_stroke_circle(strokes, at, half, paint_of(gizmo, GIZMO_ALL, 0, 0.95));
        return;
    }
    half *= 1.3;
    const double c[4][2] = {{at[0] - half, at[1] - half},
                            {at[0] + half, at[1] - half},
                            {at[0] + half, at[1] + half},
                            {at[0] - half, at[1] + half}};
    fill(strokes, c, 4, paint_of(gizmo, GIZMO_ALL, 0, 0.95));
}

void viewer_gizmo_draw(const viewer_gizmo *gizmo, const viewer_sight *sight, viewer_strokes *strokes) {
    for (int a = 0; a < 3; a++)
        if (gizmo->has[GIZMO_PLANE + a]) draw_square(gizmo, sight, a, strokes);
    for (int a = 0; a < 3; a++) {
        if (!gizmo->has[a]) continue;
        if (gizmo->tool == VIEWER_TURNS) draw_ring(gizmo, sight, a, strokes);
        else draw_arm(gizmo, sight, a, strokes);
    }
    if (gizmo->has[GIZMO_ALL]) draw_middle(gizmo, sight, strokes);
}

/* ---- Picking ---- */

static double to_segment(const float a[2], const float b[2], double x, double y) {
    double u[2] = {(double)b[0] - (double)a[0], (double)b[1] - (double)a[1]},
           v[2] = {x - (double)a[0], y - (double)a[1]}, square = u[0] * u[0] + u[1] * u[1];
    double t = square > 0 ? fmin(fmax((u[0] * v[0] + u[1] * v[1]) / square, 0), 1) : 0;
    return hypot(v[0] - t * u[0], v[1] - t * u[1]);
}

/* Inside of a triangle or a square. */
static bool is_inside(const viewer_stroke *s, int corners, double x, double y) {
    int left = 0, right = 0;
    for (int i = 0; i < corners; i++) {
        const float *a = s->at[i], *b = s->at[(i + 1) % corners];
        double side =
            ((double)b[0] - (double)a[0]) * (y - (double)a[1]) - ((double)b[1] - (double)a[1]) * (x - (double)a[0]);
        left += side >= 0, right += side <= 0;
    }
    return left == corners || right == corners;
}

/* Pixels from a stroke; 0 on it. */
static double distance_to(const viewer_stroke *s, double x, double y) {
    if (s->shape == STROKE_CIRCLE)
        return fmax(hypot(x - (double)s->at[0][0], y - (double)s->at[0][1]) - (double)s->at[1][0], 0);
    if (s->shape == STROKE_LINE) return to_segment(s->at[0], s->at[1], x, y);
    int corners = s->shape == STROKE_TRIANGLE ? 3 : 4;
    double least = is_inside(s, corners, x, y) ? 0 : INFINITY;
    for (int i = 0; i < corners; i++) least = fmin(least, to_segment(s->at[i], s->at[(i + 1) % corners], x, y));
    return least;
}

int viewer_gizmo_pick(const viewer_gizmo *gizmo, const viewer_sight *sight, double x, double y) {
    viewer_strokes strokes;
    strokes.count = 0;
    viewer_gizmo_draw(gizmo, sight, &strokes);
    double least = near_enough * gizmo->scale;
    int part = GIZMO_NOTHING;
    // of two that are as near the later, which is drawn over the other
    for (size_t i = 0; i < strokes.count; i++) {
        if (strokes.data[i].part == GIZMO_NOTHING) continue;
        double distance = distance_to(&strokes.data[i], x, y);
        if (distance <= least) least = distance, part = strokes.data[i].part;
    }
    return part;
}

bool viewer_gizmo_place(const viewer_gizmo *gizmo, const viewer_sight *sight, int part, double at[2]) {
    double place[3], reach = reach_of(gizmo, sight), eye[3];
    if (part < 0 || part >= GIZMO_PARTS || !gizmo->has[part]) return false;
    memcpy(place, gizmo->origin, sizeof place);
    int axis = part % 3;
    if (part >= GIZMO_PLANE && part < GIZMO_ALL)
        for (int k = 0; k < 3; k++)
            place[k] += 0.5 * (square_from + square_to) * reach *
                        (gizmo->axes[(axis + 1) % 3][k] + gizmo->axes[(axis + 2) % 3][k]);
    else if (part < GIZMO_PLANE && gizmo->tool != VIEWER_TURNS) along(gizmo, axis, 0.97 * reach, place);
    else if (part < GIZMO_PLANE) {
        // of the half in front, a place that lies on no other ring
        towards_eye(gizmo, sight, eye);
        double best = -2;
        for (int i = 0; i < 8; i++) {
            double point[3], off[3], angle = 0.7853981633974483 * (i + 0.5);
            ring_point(gizmo, axis, reach, angle, point);
            for (int k = 0; k < 3; k++) off[k] = (point[k] - gizmo->origin[k]) / reach;
            if (render_dot(off, eye) > best) best = render_dot(off, eye), memcpy(place, point, sizeof place);
        }
    }
    bool seen = viewer_sight_project(sight, place, at) && at[0] >= sight->left && at[0] < sight->left + sight->width &&
                at[1] >= 0 && at[1] < sight->height;
    return seen && viewer_gizmo_pick(gizmo, sight, at[0], at[1]) == part;
}

/* ---- Following the pointer ---- */

/* How far along an axis the ray passes it nearest. */
static bool along_axis(const viewer_gizmo *gizmo, const viewer_sight *sight, int axis, const double at[2],
                       double *metres) {
    double ray[3], off[3];
    const double *a = gizmo->axes[axis];
    viewer_sight_ray(sight, at[0], at[1], ray);
    for (int k = 0; k < 3; k++) off[k] = gizmo->origin[k] - sight->lens.eye[k];
    double across = render_dot(a, ray), rest = 1 - across * across;
    if (rest < 1e-3) return false;
    *metres = (across * render_dot(ray, off) - render_dot(a, off)) / rest;
    // what lies behind the eye is no place to go to
    return render_dot(ray, off) + *metres * across > 0 &&
           fabs(*metres) < 1e3 * viewer_sight_metres(sight, gizmo->origin) * sight->height;
}

/* Where the ray meets the plane through the origin. */
static bool in_plane(const viewer_gizmo *gizmo, const viewer_sight *sight, const double normal[3], const double at[2],
                     double place[3]) {
    double ray[3], off[3];
    viewer_sight_ray(sight, at[0], at[1], ray);
    for (int k = 0; k < 3; k++) off[k] = gizmo->origin[k] - sight->lens.eye[k];
    double facing = render_dot(ray, normal), t = render_dot(off, normal) / facing;
    if (!(fabs(facing) > 1e-3) || !(t > 0) || t > 1e3 * sqrt(render_dot(off, off))) return false;
    for (int k = 0; k < 3; k++) place[k] = sight->lens.eye[k] + t * ray[k];
    return true;
}

/* By which angle the pointer has gone round an axis: on the ring's plane, or where that is seen from its edge along the
 * ring's line on the picture. */
static bool turned(const viewer_gizmo *gizmo, const viewer_sight *sight, int axis, const double from[2],
                   const double to[2], double *degrees) {
    const double *a = gizmo->axes[axis];
    double eye[3], p[3], q[3], cross[3];
    towards_eye(gizmo, sight, eye);
    if (fabs(render_dot(eye, a)) > 0.25) {
        if (!in_plane(gizmo, sight, a, from, p) || !in_plane(gizmo, sight, a, to, q)) return false;
        for (int k = 0; k < 3; k++) p[k] -= gizmo->origin[k], q[k] -= gizmo->origin[k];
        render_cross(p, q, cross);
        *degrees = atan2(render_dot(cross, a), render_dot(p, q)) / degree;
        return true;
    }
    // the front of the ring moves along a x eye
    double ahead[3], side[3], middle[2], there[2], reach = reach_of(gizmo, sight);
    render_cross(a, eye, side);
    render_normalise(side);
    for (int k = 0; k < 3; k++) ahead[k] = gizmo->origin[k] + reach * side[k];
    if (!viewer_sight_project(sight, gizmo->origin, middle) || !viewer_sight_project(sight, ahead, there)) return false;
    double way[2] = {there[0] - middle[0], there[1] - middle[1]}, length = way[0] * way[0] + way[1] * way[1];
    if (!(length > 1)) return false;
    *degrees = ((to[0] - from[0]) * way[0] + (to[1] - from[1]) * way[1]) / length / degree;
    return true;
}

static bool moved(const viewer_gizmo *gizmo, const viewer_sight *sight, int part, const double from[2],
                  const double to[2], double by[3]) {
    double a, b, p[3], q[3], right[3], up[3], back[3];
    if (part < GIZMO_PLANE) {
        if (!along_axis(gizmo, sight, part, from, &a) || !along_axis(gizmo, sight, part, to, &b)) return false;
        for (int k = 0; k < 3; k++) by[k] = (b - a) * gizmo->axes[part][k];
        return true;
    }
    render_camera_axes(&sight->lens, right, up, back);
    const double *normal = part == GIZMO_ALL ? back : gizmo->axes[part - GIZMO_PLANE];
    if (!in_plane(gizmo, sight, normal, from, p) || !in_plane(gizmo, sight, normal, to, q)) return false;
    for (int k = 0; k < 3; k++) by[k] = q[k] - p[k];
    return true;
}

static bool sized(const viewer_gizmo *gizmo, const viewer_sight *sight, int part, const double from[2],
                  const double to[2], double by[3]) {
    static const double least = 0.02, most = 50;
    double a, b, times = exp((to[0] - from[0] - to[1] + from[1]) / (160 * gizmo->scale));
    for (int k = 0; k < 3; k++) by[k] = 1;
    if (part < GIZMO_PLANE) {
        if (!along_axis(gizmo, sight, part, from, &a) || !along_axis(gizmo, sight, part, to, &b) || !(fabs(a) > 0))
            return false;
        times = b / a;
    }
    times = fmin(fmax(times, least), most);
    for (int k = 0; k < 3; k++)
        if (part == GIZMO_ALL || part == k) by[k] = times;
    return true;
}

bool viewer_gizmo_follow(const viewer_gizmo *gizmo, const viewer_sight *sight, int part, const double from[2],
                         const double to[2], double by[3]) {
    by[0] = by[1] = by[2] = 0;
    if (part < 0 || part >= GIZMO_PARTS) return false;
    if (gizmo->tool == VIEWER_TURNS) return turned(gizmo, sight, part % 3, from, to, &by[0]);
    if (gizmo->tool == VIEWER_SIZES) return sized(gizmo, sight, part, from, to, by);
    return moved(gizmo, sight, part, from, to, by);
}
