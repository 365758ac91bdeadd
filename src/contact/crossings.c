/* Which edges go through triangles now: what contact is there to prevent, and what a bad start has. */
#include <math.h>
#include <string.h>

#include "contact/search/search.h"

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

static bool have_corner(const uint32_t edge[2], const uint32_t t[3]) {
    return (edge[0] == t[0]) | (edge[0] == t[1]) | (edge[0] == t[2]) | (edge[1] == t[0]) | (edge[1] == t[1]) |
           (edge[1] == t[2]);
}

static sk_vec4 moved(sk_vec4 x, sk_vec3 by) {
    return (sk_vec4){x.x + by.x, x.y + by.y, x.z + by.z, x.w};
}

static bool crosses(const sk_touch *touch, const uint32_t edge[2], const uint32_t t[3], bool aside) {
    const sk_vec4 *x = touch->p, *a = &x[t[0]], *b = &x[t[1]], *c = &x[t[2]];
    const sk_vec3 by = aside ? sk_touch_aside(touch, edge[0], t[0]) : (sk_vec3){0, 0, 0};
    const sk_vec4 first = moved(x[edge[0]], by), second = moved(x[edge[1]], by), *p = &first, *q = &second;
    double one = volume(a, b, c, p), two = volume(a, b, c, q);
    if (!((one > 0 && two < 0) || (one < 0 && two > 0))) return false; // most
    double least = flat(a, b, c);
    if (!((one > least && two < -least) || (one < -least && two > least))) return false;
    double ab = volume(p, q, a, b), bc = volume(p, q, b, c), ca = volume(p, q, c, a);
    return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

/* Of leaf a's edges and leaf b's triangles. */
static bool list_of(sk_touch *touch, sk_allocator *allocator, sk_crossing_list *list, size_t a, size_t b, bool aside) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *edges = &skin->leaf[a], *triangles = &skin->leaf[b];
    sk_touch_need_features(touch, a), sk_touch_need_features(touch, b);
    for (uint32_t e = edges->first_edge; e < edges->first_edge + edges->edges; e++)
        for (uint32_t t = triangles->first_triangle; t < triangles->first_triangle + triangles->triangles; t++) {
            if (have_corner(skin->edge[e], skin->triangle[t])) continue; // as around a leaf most have
            if (!sk_boxes_meet(&touch->edge_box[e], &touch->triangle_box[t])) continue;
            // (what is in the other by less than it is taken to be aside would be held there)
            if (!crosses(touch, skin->edge[e], skin->triangle[t], false) &&
                !(aside && crosses(touch, skin->edge[e], skin->triangle[t], true)))
                continue;
            if (!SK_RESERVE(allocator, list, list->count + 1)) return false;
            list->data[list->count++] = (sk_crossing){e, t};
        }
    return true;
}

void sk_touch_put_boxes(sk_touch *touch, real part) {
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        sk_vec4 p = touch->p[v];
        sk_quad at = {p.x, p.y, p.z, part};
        touch->corner_box[v] = (sk_box){{at, at}, {at, at}};
    }
    memset(touch->anew, 1, touch->skin.leaf_count);
    touch->everybody = true;
    for (size_t i = 0; i < touch->skin.leaf_count; i++) {
        sk_touch_leaf_box(touch, i, touch->loaded ? touch->torn[i] : sk_leaf_is_torn(touch, i, touch->p));
        touch->hot_box[i] = touch->leaf_box[i];
    }
    touch->boxed = false;
    touch->refit = true;
}

void sk_touch_load_from(sk_touch *touch, const sk_vec4 *x, const uint32_t *slot_of) {
    for (size_t v = 0; v < touch->skin.vertex_count; v++) touch->p[v] = x[slot_of[touch->skin.particle[v]]];
    touch->loaded = false; // not by a step
    touch->tasks = NULL;
}

bool sk_touch_list_crossings(sk_touch *touch, sk_allocator *allocator, const uint8_t *of, sk_crossing_list *list,
                             bool aside) {
    list->count = 0;
    sk_touch_put_boxes(touch, 0);
    if (of) {
        const sk_skin *skin = &touch->skin;
        touch->everybody = false;
        memset(touch->anew, 0, skin->leaf_count);
        for (size_t v = 0; v < skin->vertex_count; v++)
            for (uint32_t k = skin->leaf_start[v]; of[v] && k < skin->leaf_start[v + 1]; k++)
                touch->anew[skin->leaf_of[k]] = 1;
    }
    bool too_many, good = sk_touch_partners(touch, allocator, SIZE_MAX / 2, true, &too_many);
    for (size_t i = 0; i < touch->partner.count && good; i++) {
        size_t a = touch->first.data[i], b = touch->partner.data[i];
        good = list_of(touch, allocator, list, a, b, aside) && (a == b || list_of(touch, allocator, list, b, a, aside));
    }
    return good;
}

bool sk_touch_crossings(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                        size_t *count) {
    sk_touch *touch = force->state;
    *count = 0;
    if (!touch || !touch->skin.leaf_count) return true;
    sk_touch_load_from(touch, x, slot_of);
    bool good = sk_touch_list_crossings(touch, allocator, NULL, &touch->tangle.crossing, false);
    *count = touch->tangle.crossing.count;
    return good;
}
