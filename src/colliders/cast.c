/* Rays against colliders of any shape, through their probes alone.
 *
 *     distance d > 0:  the ray may go on by d, or, if the surface leans against it, as far as to the tangent plane;
 *                      sixteen points of that way are probed at once
 *     d < 0 after > 0: the wall lies between those two points, and is found there by false position
 *
 * Called by world/query.c, and by sweeps (start.h). A convex solid lies behind the tangent plane at its nearest point, so that going there skips
 * nothing; in a hollow such a step may end inside, which is as good as in front. A formula's distance is only a guess
 * far from its surface: the points on the way see what a step would skip. */
#include <math.h>

#include "colliders/collider.h"

enum { MOST_STEPS = 400, MOST_HALVINGS = 80 };
/* A step is at most so many distances long, and at least such a part of the way so far. */
static const double longest = 4, shortest = 1e-7;

typedef struct caster {
    const sk_collider *collider;
    sk_pose pose;
    const double *origin, *along;
    double normal[3]; /* at the last point that was probed */
} caster;

/* The signed distances at t + step/16, t + 2 step/16, ... t + step. */
static void probe_way(caster *c, double t, double step, double distance[SK_LANES]) {
    real p[3][SK_LANES];
    for (int i = 0; i < SK_LANES; i++) {
        double at = t + step * (i + 1) / SK_LANES;
        for (int k = 0; k < 3; k++) p[k][i] = (real)(c->origin[k] + at * c->along[k]);
    }
    sk_sixteen_contacts contact;
    sk_probe_sixteen_of[0](c->collider, &c->pose, p, SK_REAL_MAX, &contact);
    for (int i = 0; i < SK_LANES; i++) distance[i] = (double)contact.distance[i];
    for (int k = 0; k < 3; k++) c->normal[k] = (double)contact.normal[k][SK_LANES - 1];
}

static double probe_at(caster *c, double t) {
    double distance[SK_LANES];
    probe_way(c, t, 0, distance);
    return distance[0];
}

/* Between a point outside, at a, and one inside, at b. */
static double close_in(caster *c, double a, double at_a, double b, double at_b, double tolerance) {
    double t = b;
    for (int i = 0; i < MOST_HALVINGS && b - a > tolerance; i++) {
        // by turns where the line through both says, and the middle
        t = i % 2 ? 0.5 * (a + b) : a + (b - a) * at_a / (at_a - at_b);
        double d = probe_at(c, t);
        if (d > 0) a = t, at_a = d;
        else b = t, at_b = d;
        if (fabs(d) <= tolerance) break;
    }
    return t;
}

/* `inside`: how far inside the origin may be and still count as outside. */
static double cast(caster *c, double most, double inside, double normal[3]) {
    const double *origin = c->origin, *along = c->along;
    double size = fabs(origin[0]) + fabs(origin[1]) + fabs(origin[2]), t = 0, d = probe_at(c, 0);
    bool outside = d > -inside;
    for (int turn = 0; turn < MOST_STEPS && t <= most; turn++) {
        double tolerance = (sizeof(real) == 4 ? 2e-6 : 1e-12) * (size + t + 0.01), lean = 0, on_way[SK_LANES];
        for (int k = 0; k < 3; k++) lean -= c->normal[k] * along[k];
        if (outside && d <= tolerance && lean > 0) {
            for (int k = 0; k < 3; k++) normal[k] = c->normal[k];
            return t;
        }
        double step = fabs(d);
        // (of what is not convex, another part of it may be in front of that plane, or as near)
        if (d > 0 && lean > 0 && c->collider->type->passing != SK_ANY_SHAPE)
            step = lean * longest > 1 ? d / lean : longest * d;
        step = fmin(fmax(step, fmax(shortest * (size + t), tolerance)), size + t + 1);
        probe_way(c, t, step, on_way);
        double from = t, at_from = d;
        for (int i = 0; i < SK_LANES; i++) {
            t = from + step * (i + 1) / SK_LANES;
            double before = i ? on_way[i - 1] : at_from;
            d = on_way[i];
            if (outside && before > 0 && d < 0) {
                t = close_in(c, t - step / SK_LANES, before, t, d, tolerance);
                d = probe_at(c, t);
                break;
            }
            outside |= d > tolerance;
        }
    }
    return INFINITY;
}

double sk_collider_cast(const sk_collider *collider, double time, const double origin[3], const double along[3],
                        double most, double normal[3]) {
    caster c = {collider, sk_collider_pose_at(collider, time), origin, along, {0, 0, 0}};
    return cast(&c, most, 0, normal);
}

double sk_collider_cross(const sk_collider *collider, const sk_pose *pose, const double a[3], const double b[3],
                         double normal[3]) {
    if (collider->type->cross) return collider->type->cross(collider->params, pose, a, b, normal);
    double along[3], length = 0, size = 0.1;
    for (int k = 0; k < 3; k++) along[k] = b[k] - a[k], length += along[k] * along[k], size += fabs(a[k]);
    length = sqrt(length);
    if (!(length > 0)) return 2;
    for (int k = 0; k < 3; k++) along[k] /= length;
    caster c = {collider, *pose, a, along, {0, 0, 0}};
    double at = cast(&c, length, (sizeof(real) == 4 ? 4e-6 : 4e-12) * size, normal);
    return at <= length ? at / length : 2;
}
