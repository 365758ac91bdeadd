/* How many edges go through triangles now: what contact is there to prevent, and what a bad start has. */
#include <math.h>
#include <string.h>

#include "contact/touch.h"

typedef struct tally {
    sk_touch *touch;
    size_t count;
} tally;

/* Six times the volume of a tetrahedron, in double: places are differences of reals, so its sign is right but for what
 * is all but flat. */
static double volume(const sk_vec4 *a, const sk_vec4 *b, const sk_vec4 *c, const sk_vec4 *d) {
    double u[3] = {(double)b->x - (double)a->x, (double)b->y - (double)a->y, (double)b->z - (double)a->z};
    double v[3] = {(double)c->x - (double)a->x, (double)c->y - (double)a->y, (double)c->z - (double)a->z};
    double w[3] = {(double)d->x - (double)a->x, (double)d->y - (double)a->y, (double)d->z - (double)a->z};
    return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2];
}

/* What is no more than this may be 0: places are no better known than reals are, and a flat sheet's own edges lie in the
 * planes of its triangles. */
static double flat(const sk_vec4 *a, const sk_vec4 *b, const sk_vec4 *c) {
    const double share = sizeof(real) == 8 ? 1e-15 : 2.5e-7;
    double u[3] = {(double)b->x - (double)a->x, (double)b->y - (double)a->y, (double)b->z - (double)a->z};
    double v[3] = {(double)c->x - (double)a->x, (double)c->y - (double)a->y, (double)c->z - (double)a->z};
    double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    double far = fabs((double)a->x) + fabs((double)a->y) + fabs((double)a->z);
    return share * far * sqrt(x * x + y * y + z * z);
}

static bool crosses(const sk_vec4 *x, const uint32_t edge[2], const uint32_t t[3]) {
    for (int i = 0; i < 3; i++)
        if (edge[0] == t[i] || edge[1] == t[i]) return false;
    const sk_vec4 *p = &x[edge[0]], *q = &x[edge[1]], *a = &x[t[0]], *b = &x[t[1]], *c = &x[t[2]];
    double one = volume(a, b, c, p), two = volume(a, b, c, q), least = flat(a, b, c);
    if (!((one > least && two < -least) || (one < -least && two > least))) return false;
    double ab = volume(p, q, a, b), bc = volume(p, q, b, c), ca = volume(p, q, c, a);
    return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

static void count_of(tally *counting, size_t a, size_t b) {
    const sk_skin *skin = &counting->touch->skin;
    const sk_leaf *edges = &skin->leaf[a], *triangles = &skin->leaf[b];
    for (uint32_t e = 0; e < edges->edges; e++)
        for (uint32_t t = 0; t < triangles->triangles; t++)
            counting->count += crosses(counting->touch->p, skin->edge[edges->first_edge + e],
                                       skin->triangle[triangles->first_triangle + t]);
}

void sk_touch_put_boxes(sk_touch *touch, const sk_vec4 *x, const uint32_t *slot_of, real part) {
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        sk_vec4 p = touch->p[v] = x[slot_of[touch->skin.particle[v]]];
        sk_quad at = {p.x, p.y, p.z, part};
        touch->corner_box[v] = (sk_box){{at, at}, {at, at}};
    }
    memset(touch->anew, 1, touch->skin.leaf_count);
    touch->everybody = true;
    for (size_t i = 0; i < touch->skin.leaf_count; i++) {
        sk_touch_leaf_box(touch, i), sk_touch_feature_boxes(touch, i);
        touch->hot_box[i] = touch->leaf_box[i];
    }
    touch->boxed = touch->loaded = false;
    touch->refit = true;
}

bool sk_touch_crossings(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                        size_t *count) {
    sk_touch *touch = force->state;
    *count = 0;
    if (!touch || !touch->skin.leaf_count) return true;
    tally counting = {touch, 0};
    sk_touch_put_boxes(touch, x, slot_of, 0);
    bool too_many;
    touch->tasks = NULL;
    if (!sk_touch_partners(touch, allocator, SIZE_MAX / 2, true, &too_many)) return false;
    for (size_t i = 0; i < touch->partner.count; i++) {
        size_t a = touch->first.data[i], b = touch->partner.data[i];
        count_of(&counting, a, b);
        if (a != b) count_of(&counting, b, a);
    }
    *count = counting.count;
    return true;
}
