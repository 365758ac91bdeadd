/* Finding seats on colliders' meshes, and following them. */
#include "colliders/seat.h"

#include <math.h>

#include "colliders/trimesh.h"

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void minus3(const double a[3], const double b[3], double d[3]) {
    for (int k = 0; k < 3; k++) d[k] = a[k] - b[k];
}

/* ---- triangles, in the mesh's own frame ---- */

typedef double corners[3][3];

static void read_place(const sk_vec3 *place, double at[3]) {
    at[0] = (double)place->x, at[1] = (double)place->y, at[2] = (double)place->z;
}

static void corners_as_made(const sk_trimesh *m, uint32_t t, corners c) {
    const sk_vec3 *place = m->made ? m->made : m->place;
    for (int i = 0; i < 3; i++) read_place(&place[m->corner[t][i]], c[i]);
}

static void corners_at(const sk_trimesh *m, uint32_t t, double time, corners c) {
    double part = m->moves ? (time - m->start) / m->dt : 1;
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    for (int i = 0; i < 3; i++) {
        uint32_t v = m->corner[t][i];
        read_place(m->moves ? &m->to[v] : &m->place[v], c[i]);
        if (!m->moves) continue;
        double from[3];
        read_place(&m->from[v], from);
        for (int k = 0; k < 3; k++) c[i][k] = from[k] + part * (c[i][k] - from[k]);
    }
}

/* The weights of b and c at the point of a triangle that is nearest to p (Ericson 2005, 5.1.5). */
static void find_weights(const corners c, const double p[3], double weight[2]) {
    double ab[3], ac[3], ap[3];
    minus3(c[1], c[0], ab), minus3(c[2], c[0], ac), minus3(p, c[0], ap);
    double d1 = dot3(ab, ap), d2 = dot3(ac, ap), bb = dot3(ab, ab), bc = dot3(ab, ac), cc = dot3(ac, ac);
    double d3 = d1 - bb, d4 = d2 - bc, d5 = d1 - bc, d6 = d2 - cc;
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    weight[0] = weight[1] = 0;
    if (d1 <= 0 && d2 <= 0) return;
    if (d3 >= 0 && d4 <= d3) weight[0] = 1;
    else if (d6 >= 0 && d5 <= d6) weight[1] = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0) weight[0] = d1 / (d1 - d3);
    else if (vb <= 0 && d2 >= 0 && d6 <= 0) weight[1] = d2 / (d2 - d6);
    else if (va <= 0 && d4 >= d3 && d5 >= d6)
        weight[1] = (d4 - d3) / ((d4 - d3) + (d5 - d6)), weight[0] = 1 - weight[1];
    else weight[0] = vb / (va + vb + vc), weight[1] = vc / (va + vb + vc);
}

static void point_of(const corners c, const double weight[2], double p[3]) {
    for (int k = 0; k < 3; k++) p[k] = c[0][k] + weight[0] * (c[1][k] - c[0][k]) + weight[1] * (c[2][k] - c[0][k]);
}

/* A triangle's unit directions: along a b, across that in its plane, its normal. Zeros where it has no area any more. */
static void find_frame(const corners c, double frame[3][3]) {
    double ab[3], ac[3];
    minus3(c[1], c[0], ab), minus3(c[2], c[0], ac);
    double *u = frame[0], *v = frame[1], *n = frame[2];
    for (int k = 0; k < 3; k++) n[k] = ab[(k + 1) % 3] * ac[(k + 2) % 3] - ab[(k + 2) % 3] * ac[(k + 1) % 3];
    double side = sqrt(dot3(ab, ab)), area = sqrt(dot3(n, n));
    for (int k = 0; k < 3; k++) u[k] = side > 0 ? ab[k] / side : 0, n[k] = area > 0 ? n[k] / area : 0;
    for (int k = 0; k < 3; k++) v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
}

/* ---- the nearest one ---- */

static double square_to_box(const sk_tree_node *node, const double p[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double out = fmax(fmax((double)node->low[k] - p[k], p[k] - (double)node->high[k]), 0);
        sum += out * out;
    }
    return sum;
}

static void look_at(const sk_trimesh *m, uint32_t t, const double p[3], double *best, sk_seat *seat) {
    corners c;
    double weight[2], q[3], way[3];
    corners_as_made(m, t, c);
    find_weights((const double(*)[3])c, p, weight);
    point_of((const double(*)[3])c, weight, q);
    minus3(p, q, way);
    double square = dot3(way, way);
    if (!(square < *best) && !(square == *best && t < seat->triangle)) return;
    *best = square;
    *seat = (sk_seat){.triangle = t, .weight = {weight[0], weight[1]}};
}

/* By the tree where the mesh is as it was made, else by all its triangles. */
void sk_trimesh_find_seat(const sk_trimesh *m, const double p[3], sk_seat *seat) {
    uint32_t stack[64], depth = 0;
    double best = INFINITY;
    *seat = (sk_seat){.triangle = 0};
    for (uint32_t t = 0; m->made && t < m->triangle_count; t++) look_at(m, t, p, &best, seat);
    if (!m->made) stack[depth++] = 0;
    while (depth) {
        uint32_t n = stack[--depth];
        const sk_tree_node *node = &m->node[n];
        if (square_to_box(node, p) * 0.999 - (double)m->slack > best) continue;
        for (uint32_t t = node->first; t < node->first + node->count; t++) look_at(m, t, p, &best, seat);
        if (node->count) continue;
        bool left_first = square_to_box(&m->node[n + 1], p) <= square_to_box(&m->node[node->first], p);
        stack[depth++] = left_first ? node->first : n + 1;
        stack[depth++] = left_first ? n + 1 : node->first;
    }
}

/* ---- of colliders ---- */

void sk_collider_find_seat(const sk_collider *collider, double time, const double p[3], double offset, sk_seat *seat) {
    const sk_trimesh *m = collider->type->surface(collider->params);
    double scale = collider->type->scale(collider->params), own[3], q[3], way[3], frame[3][3];
    sk_pose pose = sk_collider_pose_unled(collider, time);
    const double place[3] = {(double)pose.position.x, (double)pose.position.y, (double)pose.position.z};
    for (int k = 0; k < 3; k++) {
        own[k] = 0;
        for (int i = 0; i < 3; i++) own[k] += (double)pose.rotation[3 * i + k] * (p[i] - place[i]) / scale;
    }
    corners c;
    sk_trimesh_find_seat(m, own, seat);
    corners_as_made(m, seat->triangle, c);
    point_of((const double(*)[3])c, seat->weight, q);
    find_frame((const double(*)[3])c, frame);
    minus3(own, q, way);
    for (int k = 0; k < 3; k++) seat->off[k] = offset < SK_UNBOUNDED ? 0 : scale * dot3(frame[k], way);
    if (offset < SK_UNBOUNDED) seat->off[2] = offset;
}

void sk_collider_seat_place(const sk_collider *collider, const sk_seat *seat, double time, double p[3]) {
    const sk_trimesh *m = collider->type->surface(collider->params);
    double scale = collider->type->scale(collider->params), q[3], frame[3][3];
    sk_pose pose = sk_collider_pose_at(collider, time);
    corners c;
    corners_at(m, seat->triangle, time, c);
    point_of((const double(*)[3])c, seat->weight, q);
    find_frame((const double(*)[3])c, frame);
    for (int k = 0; k < 3; k++)
        q[k] = scale * q[k] + seat->off[0] * frame[0][k] + seat->off[1] * frame[1][k] + seat->off[2] * frame[2][k];
    const double place[3] = {(double)pose.position.x, (double)pose.position.y, (double)pose.position.z};
    for (int k = 0; k < 3; k++) {
        const real *row = &pose.rotation[3 * k];
        p[k] = place[k] + (double)row[0] * q[0] + (double)row[1] * q[1] + (double)row[2] * q[2];
    }
}
