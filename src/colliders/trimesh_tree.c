/* The tree of boxes over a mesh's triangles, and what walks it for one point: winding numbers, and crossings of a way.
 *
 * Halves by the middles of triangles along the longest axis, down to a few: balanced, so that a stack of 64 is enough for
 * any mesh. Nodes come in depth first, so that children come after their parents, and a fit goes through them backwards. */
#include <math.h>
#include <string.h>

#include "base/elementary.h"
#include "colliders/trimesh.h"

enum { LEAF = 4, STACK = 64 };

/* ---- making ---- */

typedef struct planter {
    sk_trimesh *m;
    uint32_t *order;   /* of triangles */
    real (*middle)[3]; /* of triangles, times 3 */
} planter;

static bool before(const planter *p, uint32_t a, uint32_t b, int axis) {
    real x = p->middle[a][axis], y = p->middle[b][axis];
    return x < y || (x == y && a < b);
}

/* Reorders [first, end) so that `middle` is where it would be, were they sorted. */
static void halve(const planter *p, size_t first, size_t end, size_t middle, int axis) {
    uint32_t *order = p->order;
    while (end - first > 1) {
        uint32_t pivot = order[first + (end - first - 1) / 2]; // never the last, so that both parts are smaller
        size_t i = first, j = end - 1;
        for (;;) {
            while (before(p, order[i], pivot, axis)) i++;
            while (before(p, pivot, order[j], axis)) j--;
            if (i >= j) break;
            uint32_t kept = order[i];
            order[i++] = order[j], order[j--] = kept;
        }
        // [first, i) are at most the pivot, [j + 1, end) at least it
        if (middle <= j) end = j + 1;
        else first = j + 1;
        if (end - first == 1) return;
    }
}

static void plant(planter *p, size_t first, size_t end) {
    size_t at = p->m->node_count++;
    sk_tree_node *node = &p->m->node[at];
    if (end - first <= LEAF) {
        node->first = (uint32_t)first, node->count = (uint32_t)(end - first);
        return;
    }
    real low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = high[k] = p->middle[p->order[first]][k];
        for (size_t i = first; i < end; i++) {
            real x = p->middle[p->order[i]][k];
            low[k] = x < low[k] ? x : low[k], high[k] = x > high[k] ? x : high[k];
        }
    }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    size_t middle = first + (end - first) / 2;
    halve(p, first, end, middle, axis);
    plant(p, first, middle);
    p->m->node[at].first = (uint32_t)p->m->node_count;
    plant(p, middle, end);
}

bool sk_trimesh_plant(sk_trimesh *m) {
    size_t count = m->triangle_count;
    planter p = {m, sk_allocate(m->allocator, count * sizeof *p.order),
                 sk_allocate(m->allocator, count * sizeof *p.middle)};
    m->node = sk_allocate(m->allocator, 2 * count * sizeof *m->node);
    uint32_t(*sorted)[3] = sk_allocate(m->allocator, count * sizeof *sorted);
    bool good = p.order && p.middle && m->node && sorted;
    for (size_t t = 0; good && t < count; t++) {
        const sk_vec3 a = m->place[m->corner[t][0]], b = m->place[m->corner[t][1]], c = m->place[m->corner[t][2]];
        p.order[t] = (uint32_t)t;
        p.middle[t][0] = a.x + b.x + c.x, p.middle[t][1] = a.y + b.y + c.y, p.middle[t][2] = a.z + b.z + c.z;
    }
    if (good) {
        plant(&p, 0, count);
        for (size_t t = 0; t < count; t++) memcpy(sorted[t], m->corner[p.order[t]], sizeof *sorted);
        memcpy(m->corner, sorted, count * sizeof *sorted);
    }
    sk_release(m->allocator, p.order);
    sk_release(m->allocator, p.middle);
    sk_release(m->allocator, sorted);
    return good;
}

/* ---- fitting ---- */

static void widen(sk_tree_node *node, const real low[3], const real high[3]) {
    for (int k = 0; k < 3; k++) {
        node->low[k] = low[k] < node->low[k] ? low[k] : node->low[k];
        node->high[k] = high[k] > node->high[k] ? high[k] : node->high[k];
    }
}

/* Areas and middles of the triangles under it, and how far from there they reach. */
static void sum_dipole(const sk_trimesh *m, const sk_tree_node *node, sk_dipole *d) {
    double weight = 0, reach = 0;
    memset(d, 0, sizeof *d);
    bool leaf = node->count > 0;
    for (uint32_t i = 0; i < (leaf ? node->count : 2); i++) {
        double middle[3], area[3], size;
        if (leaf) {
            const uint32_t *corner = m->corner[node->first + i];
            sk_vec3 a = m->place[corner[0]], b = m->place[corner[1]], c = m->place[corner[2]];
            double ab[3] = {(double)(b.x - a.x), (double)(b.y - a.y), (double)(b.z - a.z)};
            double ac[3] = {(double)(c.x - a.x), (double)(c.y - a.y), (double)(c.z - a.z)};
            area[0] = (ab[1] * ac[2] - ab[2] * ac[1]) / 2, area[1] = (ab[2] * ac[0] - ab[0] * ac[2]) / 2,
            area[2] = (ab[0] * ac[1] - ab[1] * ac[0]) / 2;
            middle[0] = (double)(a.x + b.x + c.x) / 3, middle[1] = (double)(a.y + b.y + c.y) / 3,
            middle[2] = (double)(a.z + b.z + c.z) / 3;
        } else {
            const sk_dipole *child = &m->dipole[i ? node->first : (uint32_t)(node - m->node) + 1];
            memcpy(middle, child->middle, sizeof middle), memcpy(area, child->area, sizeof area);
        }
        size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        weight += size;
        for (int k = 0; k < 3; k++) d->middle[k] += size * middle[k], d->area[k] += area[k];
    }
    for (int k = 0; k < 3; k++) {
        d->middle[k] = weight > 0 ? d->middle[k] / weight : 0.5 * ((double)node->low[k] + (double)node->high[k]);
        double far = fmax((double)node->high[k] - d->middle[k], d->middle[k] - (double)node->low[k]);
        reach += far * far;
    }
    d->square = reach;
}

void sk_trimesh_fit(sk_trimesh *m) {
    for (size_t n = m->node_count; n-- > 0;) {
        sk_tree_node *node = &m->node[n];
        for (int k = 0; k < 3; k++) node->low[k] = SK_REAL_MAX, node->high[k] = -SK_REAL_MAX;
        for (uint32_t i = 0; i < 3 * node->count; i++) {
            sk_vec3 p = m->place[m->corner[node->first + i / 3][i % 3]];
            const real at[3] = {p.x, p.y, p.z};
            widen(node, at, at);
        }
        for (uint32_t i = 0; i < 2 && !node->count; i++) {
            const sk_tree_node *child = &m->node[i ? node->first : n + 1];
            widen(node, child->low, child->high);
        }
        sum_dipole(m, node, &m->dipole[n]);
    }
}

/* ---- sides ---- */

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The solid angle under which p sees a triangle, over 2 (van Oosterom and Strackee 1983). */
static double half_angle(const sk_trimesh *m, uint32_t t, const double p[3]) {
    double v[3][3], l[3];
    for (int i = 0; i < 3; i++) {
        sk_vec3 c = m->place[m->corner[t][i]];
        v[i][0] = (double)c.x - p[0], v[i][1] = (double)c.y - p[1], v[i][2] = (double)c.z - p[2];
        l[i] = sqrt(dot3(v[i], v[i]));
    }
    double triple = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
                    v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                    v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
    double across = l[0] * l[1] * l[2] + dot3(v[0], v[1]) * l[2] + dot3(v[1], v[2]) * l[0] + dot3(v[2], v[0]) * l[1];
    return triple == 0 ? 0 : sk_atan2(triple, across);
}

double sk_trimesh_winding(const sk_trimesh *m, const double p[3]) {
    static const double two_pi = 6.283185307179586, far = 4; // a dipole does from twice its extent on
    uint32_t stack[STACK], depth = 0;
    double sum = 0;
    stack[depth++] = 0;
    while (depth) {
        uint32_t n = stack[--depth];
        const sk_tree_node *node = &m->node[n];
        const sk_dipole *d = &m->dipole[n];
        double to[3] = {d->middle[0] - p[0], d->middle[1] - p[1], d->middle[2] - p[2]}, square = dot3(to, to);
        if (square > far * d->square) {
            sum += dot3(d->area, to) / (2 * square * sqrt(square));
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++) sum += half_angle(m, node->first + i, p);
        if (!node->count) stack[depth++] = node->first, stack[depth++] = n + 1;
    }
    return sum / two_pi;
}

/* ---- crossings ---- */

/* Whether the way from a along w, up to `most` of it, comes through a box, a little widened. */
static bool comes_through(const sk_tree_node *node, const double a[3], const double w[3], double most) {
    double enter = 0, leave = most;
    for (int k = 0; k < 3; k++) {
        double slack = (sizeof(real) == 4 ? 1e-6 : 1e-14) * (fabs((double)node->low[k]) + fabs((double)node->high[k]));
        double low = (double)node->low[k] - slack - a[k], high = (double)node->high[k] + slack - a[k];
        if (w[k] == 0) {
            if (low > 0 || high < 0) return false;
            continue;
        }
        double s = low / w[k], t = high / w[k];
        enter = fmax(enter, fmin(s, t)), leave = fmin(leave, fmax(s, t));
    }
    return enter <= leave;
}

/* Moeller and Trumbore 1997, edges and corners belonging to all of theirs, so that nothing slips between triangles. */
static double cross_triangle(const sk_trimesh *m, uint32_t t, const double a[3], const double w[3]) {
    const double edge = 1e-6;
    const sk_facet *f = &m->facet[t];
    double ab[3], ac[3], from[3];
    for (int k = 0; k < 3; k++) ab[k] = (double)f->ab[k], ac[k] = (double)f->ac[k], from[k] = a[k] - (double)f->a[k];
    double p[3] = {w[1] * ac[2] - w[2] * ac[1], w[2] * ac[0] - w[0] * ac[2], w[0] * ac[1] - w[1] * ac[0]};
    double det = dot3(ab, p);
    if (det == 0) return 2;
    double u = dot3(from, p) / det;
    if (!(u >= -edge && u <= 1 + edge)) return 2;
    double q[3] = {from[1] * ab[2] - from[2] * ab[1], from[2] * ab[0] - from[0] * ab[2],
                   from[0] * ab[1] - from[1] * ab[0]};
    double v = dot3(w, q) / det, part = dot3(ac, q) / det;
    return v >= -edge && u + v <= 1 + edge && part >= 0 && part <= 1 ? part : 2;
}

double sk_trimesh_cross(const sk_trimesh *m, const double a[3], const double b[3], double normal[3]) {
    uint32_t stack[STACK], depth = 0, met = 0;
    double w[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, first = 2;
    stack[depth++] = 0;
    while (depth) {
        uint32_t n = stack[--depth];
        const sk_tree_node *node = &m->node[n];
        if (!comes_through(node, a, w, first < 1 ? first : 1)) continue;
        for (uint32_t i = 0; i < node->count; i++) {
            double part = cross_triangle(m, node->first + i, a, w);
            if (part < first || (part == first && part <= 1 && node->first + i < met))
                first = part, met = node->first + i;
        }
        if (!node->count) stack[depth++] = node->first, stack[depth++] = n + 1;
    }
    if (first > 1) return 2;
    sk_vec3 face = m->normal[met];
    const double n[3] = {(double)face.x, (double)face.y, (double)face.z};
    double side = dot3(n, w) > 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) normal[k] = side * n[k];
    return first;
}
