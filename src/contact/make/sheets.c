/* Which pieces of a skin are flat sheets, and where their vertices are on their planes. */
#include <math.h>
#include <string.h>

#include "contact/make/spread.h"

/* How many triangles an edge has. */
static int faces_of(const sk_skin *skin, const uint32_t edge[2]) {
    uint32_t a = edge[0], b = edge[1];
    if (skin->leaf_start[a + 1] - skin->leaf_start[a] > skin->leaf_start[b + 1] - skin->leaf_start[b])
        a = edge[1], b = edge[0];
    int count = 0;
    for (uint32_t i = skin->leaf_start[a]; i < skin->leaf_start[a + 1]; i++) {
        const sk_leaf *leaf = &skin->leaf[skin->leaf_of[i]];
        for (uint32_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++) {
            const uint32_t *v = skin->triangle[t];
            count += (v[0] == a || v[1] == a || v[2] == a) && (v[0] == b || v[1] == b || v[2] == b);
        }
    }
    return count;
}

static sk_vec3 unit(double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z), share = length > 0 ? 1 / length : 0;
    return (sk_vec3){(real)(share * x), (real)(share * y), (real)(share * z)};
}

static sk_vec3 normal_of(const making *m, uint32_t piece) {
    const double *sum = m->normal[piece];
    return unit(sum[0], sum[1], sum[2]);
}

bool sk_sheets_find(making *m) {
    const sk_skin *skin = m->skin;
    const real off = (real)1e-2 * skin->longest, thin = (real)1e-3;
    bool any = false;
    memset(m->flat, 1, skin->vertex_count);
    for (size_t t = 0; t < skin->triangle_count; t++) {
        const uint32_t *v = skin->triangle[t];
        sk_vec3 cross = cross_of(skin, v);
        double *sum = m->normal[skin->piece[v[0]]];
        sum[0] += (double)cross.x, sum[1] += (double)cross.y, sum[2] += (double)cross.z;
    }
    for (size_t e = 0; e < skin->edge_count; e++) { // along a border, as a rectangle's rows and columns are
        const uint32_t *edge = skin->edge[e], piece = skin->piece[edge[0]];
        int faces = faces_of(skin, edge);
        m->border[e] = faces < 2;
        if (faces > 2) m->flat[piece] = 0;
        sk_vec3 along = side(skin, edge[0], edge[1]);
        if (faces == 1) m->along[piece] = (sk_vec4){along.x, along.y, along.z, 0};
    }
    for (size_t i = 0; i < skin->leaf_count; i++)
        if (!skin->leaf[i].triangles) m->flat[skin->piece[corner_of(skin, &skin->leaf[i])]] = 0;
    for (size_t v = 0; v < skin->vertex_count; v++) {
        const uint32_t piece = skin->piece[v];
        const sk_vec4 *a = &m->along[piece];
        sk_vec3 n = normal_of(m, piece), r = side(skin, piece, (uint32_t)v),
                along = unit((double)a->x, (double)a->y, (double)a->z);
        if (!(sk_abs(sk_dot(n, r)) <= off)) m->flat[piece] = 0;
        m->spot[v] = (spot){sk_dot(along, r), sk_dot(sk_cross(n, along), r)};
    }
    for (size_t t = 0; t < skin->triangle_count; t++) {
        const uint32_t *v = skin->triangle[t];
        sk_vec3 cross = cross_of(skin, v), a = side(skin, v[0], v[1]), b = side(skin, v[0], v[2]);
        real least = thin * sk_max(sk_dot(a, a), sk_dot(b, b));
        if (!(sk_dot(cross, normal_of(m, skin->piece[v[0]])) > least)) m->flat[skin->piece[v[0]]] = 0;
    }
    for (size_t i = 0; i < skin->leaf_count; i++) any |= m->flat[skin->piece[corner_of(skin, &skin->leaf[i])]];
    return any;
}
