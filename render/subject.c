/* The shape that a camera has to hold; see subject.h. */
#include "render/subject.h"

#include <math.h>
#include <string.h>

#include "render/linear.h"

/* Of larger meshes so many points are looked at, spread over all of them. */
enum { MOST_POINTS = 8192, RIM_POINTS = 24 };

/* ---- Hulls ---------------------------------------------------------------------------------- */

/* The directions lie as evenly as the leaves around a stem (Fibonacci's lattice); the first six are the axes. */
render_hull render_hull_nothing(void) {
    static const double golden = 2.399963229728653;
    render_hull hull;
    memset(&hull, 0, sizeof hull);
    for (int i = 0; i < RENDER_HULL_DIRECTIONS; i++) {
        double *d = hull.direction[i];
        double y = 1 - 2 * (i - 5.5) / (RENDER_HULL_DIRECTIONS - 6), flat = sqrt(fmax(0, 1 - y * y));
        if (i < 6) d[i / 2] = i % 2 ? -1 : 1;
        else d[0] = flat * cos(golden * i), d[1] = y, d[2] = flat * sin(golden * i);
        hull.reach[i] = -INFINITY;
    }
    return hull;
}

bool render_hull_empty(const render_hull *hull) {
    return !(hull->reach[0] > -INFINITY);
}

void render_hull_add(render_hull *hull, const double point[3], double radius) {
    if (!isfinite(point[0]) || !isfinite(point[1]) || !isfinite(point[2]) || !isfinite(radius)) return;
    for (int i = 0; i < RENDER_HULL_DIRECTIONS; i++) {
        double reach = render_dot(point, hull->direction[i]) + radius;
        if (reach <= hull->reach[i]) continue;
        hull->reach[i] = reach;
        for (int k = 0; k < 3; k++) hull->point[i][k] = point[k] + radius * hull->direction[i][k];
    }
}

void render_hull_join(render_hull *hull, const render_hull *other) {
    for (int i = 0; i < RENDER_HULL_DIRECTIONS; i++) {
        if (other->reach[i] <= hull->reach[i]) continue;
        hull->reach[i] = other->reach[i];
        memcpy(hull->point[i], other->point[i], sizeof hull->point[i]);
    }
}

render_bounds render_hull_bounds(const render_hull *hull) {
    render_bounds bounds = render_bounds_nothing();
    for (int k = 0; k < 3 && !render_hull_empty(hull); k++)
        bounds.most[k] = hull->reach[2 * k], bounds.least[k] = -hull->reach[2 * k + 1];
    return bounds;
}

render_hull render_hull_between(const render_hull *a, const render_hull *b, double t) {
    render_hull hull = *a;
    for (int i = 0; i < RENDER_HULL_DIRECTIONS && !render_hull_empty(a); i++) {
        for (int k = 0; k < 3; k++) hull.point[i][k] += t * (b->point[i][k] - a->point[i][k]);
        hull.reach[i] += t * (b->reach[i] - a->reach[i]);
    }
    return hull;
}

/* ---- Bodies --------------------------------------------------------------------------------- */

/* So many points are passed over for each that is looked at: an odd number, so that rows of a grid are met in
 * different columns. */
static size_t stride_of(size_t count) {
    size_t stride = count / MOST_POINTS + 1;
    return stride | 1;
}

static void add_surface(render_hull *hull, const render_surface *surface) {
    size_t stride = stride_of(surface->vertex_count);
    for (size_t v = 0; v < surface->vertex_count; v += stride) render_hull_add(hull, &surface->positions[3 * v], 0);
    if (surface->vertex_count) render_hull_add(hull, &surface->positions[3 * (surface->vertex_count - 1)], 0);
}

static void add_points(render_hull *hull, const render_points *points) {
    size_t stride = stride_of(points->count);
    for (size_t p = 0; p < points->count; p += stride) render_hull_add(hull, &points->positions[3 * p], points->radius);
}

/* A cloth that was laid out and not let go yet: its height is less than this part of its width. */
static const double sheet_height = 0.03;

static void keep_sheet(render_subject *subject, const double sheet[3]) {
    if (subject->has_sheet && subject->sheet[1] >= sheet[1]) return;
    subject->has_sheet = true;
    memcpy(subject->sheet, sheet, sizeof subject->sheet);
}

static void find_sheet(render_subject *subject, const render_surface *surface) {
    render_bounds box = render_bounds_nothing();
    double middle[3];
    for (size_t v = 0; v < surface->vertex_count; v++) render_bounds_add(&box, &surface->positions[3 * v], 0);
    if (render_bounds_empty(&box)) return;
    double wide = fmax(box.most[0] - box.least[0], box.most[2] - box.least[2]);
    render_bounds_centre(&box, middle);
    if (box.most[1] - box.least[1] < sheet_height * wide) keep_sheet(subject, middle);
}

/* The middles of its box's edges: a flock has no corners. */
static void add_birds(render_hull *hull, const render_birds *birds) {
    for (int edge = 0; edge < 12 && birds->count; edge++) {
        int along = edge / 4;
        double p[3];
        for (int k = 0; k < 3; k++) {
            int upper = k == (along + 1) % 3 ? edge & 1 : edge >> 1 & 1;
            const double least = birds->core_least[k], most = birds->core_most[k];
            p[k] = k == along ? 0.5 * (least + most) : upper ? most : least;
        }
        render_hull_add(hull, p, 0.5 * birds->span);
    }
}

/* ---- Colliders, and rods -------------------------------------------------------------------- */

static void add_solid(render_hull *hull, const render_solid *solid) {
    for (int corner = 0; corner < 8; corner++) {
        double point[3];
        for (int r = 0; r < 3; r++) {
            point[r] = solid->centre[r];
            for (int c = 0; c < 3; c++)
                point[r] += solid->rotation[3 * r + c] * (corner >> c & 1 ? solid->extent[c] : -solid->extent[c]);
        }
        render_hull_add(hull, point, solid->radius);
    }
}

static void add_bowl(render_hull *hull, const render_bowl *bowl) {
    double wide = render_bowl_width * bowl->radius, point[3];
    for (int i = 0; i < RIM_POINTS; i++) {
        double angle = 6.283185307179586 * i / RIM_POINTS;
        point[0] = bowl->centre[0] + wide * cos(angle), point[2] = bowl->centre[2] + wide * sin(angle);
        point[1] = bowl->centre[1] - bowl->radius * (1 - render_bowl_height);
        render_hull_add(hull, point, 0);
    }
    point[0] = bowl->centre[0], point[1] = bowl->centre[1] - bowl->radius, point[2] = bowl->centre[2];
    render_hull_add(hull, point, 0);
}

/* ---- Both ----------------------------------------------------------------------------------- */

render_subject render_subject_nothing(void) {
    return (render_subject){.bodies = render_hull_nothing(), .all = render_hull_nothing()};
}

render_subject render_subject_of(const render_frame *frame) {
    render_subject subject = render_subject_nothing();
    for (size_t i = 0; i < frame->bird_count; i++) add_birds(&subject.bodies, &frame->birds[i]);
    for (size_t i = 0; i < frame->surface_count; i++) {
        if (frame->surfaces[i].scenery) continue;
        add_surface(&subject.bodies, &frame->surfaces[i]);
        find_sheet(&subject, &frame->surfaces[i]);
    }
    for (size_t i = 0; i < frame->rod_count; i++) add_solid(&subject.bodies, &frame->rods[i]);
    for (size_t i = 0; i < frame->points_count; i++) add_points(&subject.bodies, &frame->points[i]);

    subject.all = subject.bodies;
    for (size_t i = 0; i < frame->sphere_count; i++)
        render_hull_add(&subject.all, frame->spheres[i].centre, frame->spheres[i].radius);
    for (size_t i = 0; i < frame->solid_count; i++) add_solid(&subject.all, &frame->solids[i]);
    for (size_t i = 0; i < frame->bowl_count; i++) add_bowl(&subject.all, &frame->bowls[i]);
    if (!render_hull_empty(&subject.bodies)) return subject;

    // bodies that are shown by their lines alone; or nothing but colliders
    for (size_t i = 0; i < frame->lines_count; i++)
        for (size_t p = 0; p < 2 * frame->lines[i].count && !frame->lines[i].aside; p++)
            render_hull_add(&subject.bodies, &frame->lines[i].positions[3 * p], 0);
    render_hull_join(&subject.all, &subject.bodies);
    if (render_hull_empty(&subject.bodies)) subject.bodies = subject.all;
    return subject;
}

void render_subject_join(render_subject *subject, const render_subject *other) {
    render_hull_join(&subject->bodies, &other->bodies);
    render_hull_join(&subject->all, &other->all);
    if (other->has_sheet) keep_sheet(subject, other->sheet);
}
