/* A solid whose surface is a mesh, by distances that were sampled from it: many cheap questions, none of which looks at a triangle.
 *
 *     o---o---o---o      When the collider is added, the mesh is asked at the corners of cubes over its box and two cells beyond:
 *     |   | . |   |      the distance d_i, negative inside, and its unit normal g_i. At p, with the trilinear weights w_i of
 *     o---o---o---o      the eight corners x_i around it,
 *
 *         d(p) = sum w_i (d_i + g_i.(p - x_i)/2),    n(p) = sum w_i g_i, made a unit
 *
 * Between the corners the mean of the d_i is too large by half of what second derivatives make of p - x_i, and the mean of the planes
 * d_i + g_i.(p - x_i) too small by as much: the middle of both is exact where d is a quadratic, so that it errs by the cube of
 * the cell where the surface is smooth; and the normal is continuous. Next to edges, and where two sides are as near, it errs
 * by a part of a cell. Outside of the cubes the nearest point of theirs says which point of the surface is near.
 *
 * All is in the mesh's own frame, so that the solid moves, turns and is scaled as a mesh is. */
#include "base/kernels.h"
#include "base/status.h"
#include "colliders/mesh.h"

typedef struct field_params {
    sk_mesh_params mesh; /* first: see colliders/mesh.h */
    double cell;         /* m; 0: one is chosen */
    sk_vec4 *node;       /* normal and distance, along x first */
    int nodes[3];
    real low[3], side; /* of the first corner, and of a cell, in the mesh's own units */
} field_params;

#define SK_UNIT field
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

typedef real field_quad __attribute__((vector_size(4 * sizeof(real))));

/* How far along an axis, in cells, within the cubes; what is no number is at the beginning. */
SK_INLINE sk_wide field_within(sk_wide at, int nodes) {
    sk_wide last = sk_splat((real)(nodes - 1));
    at = sk_keep(sk_positive(at), at);
    return sk_select(sk_more(at, last), last, at);
}

/* Sum and lean of one point: `first` is the corner before it, `part` how far it is on from there, in cells. */
SK_INLINE void field_mix(const field_params *f, const int first[3], const real part[3], field_quad *sum,
                         field_quad *lean) {
    const size_t row = (size_t)f->nodes[0], layer = row * (size_t)f->nodes[1];
    const sk_vec4 *base = f->node + (size_t)first[2] * layer + (size_t)first[1] * row + (size_t)first[0];
    *sum = *lean = (field_quad){0};
    for (int c = 0; c < 8; c++) {
        const int x = c & 1, y = c >> 1 & 1, z = c >> 2;
        field_quad here, way = {part[0] - (real)x, part[1] - (real)y, part[2] - (real)z, 0};
        real weight = (x ? part[0] : 1 - part[0]) * (y ? part[1] : 1 - part[1]) * (z ? part[2] : 1 - part[2]);
        memcpy(&here, base + (size_t)z * layer + (size_t)y * row + (size_t)x, sizeof here);
        *sum += weight * here;
        *lean += (weight * way) * here;
    }
}

void SK_KERNEL(probe)(const void *data, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) {
    const field_params *f = data;
    const real *r = pose->rotation, scale = (real)f->mesh.scale, per = (real)(1 / f->mesh.scale),
               per_side = 1 / f->side;
    sk_wide3 d = {p->x - pose->position.x, p->y - pose->position.y, p->z - pose->position.z};
    sk_wide3 at = {(per * (r[0] * d.x + r[3] * d.y + r[6] * d.z) - f->low[0]) * per_side,
                   (per * (r[1] * d.x + r[4] * d.y + r[7] * d.z) - f->low[1]) * per_side,
                   (per * (r[2] * d.x + r[5] * d.y + r[8] * d.z) - f->low[2]) * per_side};
    sk_wide3 in = {field_within(at.x, f->nodes[0]), field_within(at.y, f->nodes[1]), field_within(at.z, f->nodes[2])};
    sk_wide3 n = {{0}, {0}, {0}};
    sk_wide distance = {0};
    for (int l = 0; l < SK_PART; l++) {
        const real where[3] = {in.x[l], in.y[l], in.z[l]};
        int first[3];
        real part[3];
        for (int k = 0; k < 3; k++) {
            first[k] = (int)where[k];
            if (first[k] > f->nodes[k] - 2) first[k] = f->nodes[k] - 2;
            part[k] = where[k] - (real)first[k];
        }
        field_quad sum, lean;
        field_mix(f, first, part, &sum, &lean);
        n.x[l] = sum[0], n.y[l] = sum[1], n.z[l] = sum[2];
        distance[l] = sum[3] + (real)0.5 * f->side * (lean[0] + lean[1] + lean[2]);
    }
    // in the middle between two sides there is no normal: up is the way out
    sk_wide square = sk_dot_wide(n, n), one = sk_splat(1);
    sk_mask leans = sk_more(square, sk_splat((real)1e-12));
    sk_wide inverse = 1 / sk_wide_sqrt(sk_select(leans, square, one));
    n = (sk_wide3){sk_keep(leans, n.x * inverse), sk_select(leans, n.y * inverse, one), sk_keep(leans, n.z * inverse)};
    // beyond the cubes: from the point of the surface that is near where they end
    sk_wide3 beyond = {f->side * (at.x - in.x), f->side * (at.y - in.y), f->side * (at.z - in.z)};
    sk_mask out = sk_positive(sk_dot_wide(beyond, beyond));
    if (sk_any(out)) {
        sk_wide3 way = {beyond.x + distance * n.x, beyond.y + distance * n.y, beyond.z + distance * n.z};
        sk_wide length = sk_wide_sqrt(sk_dot_wide(way, way));
        out &= sk_positive(length);
        sk_wide by = 1 / sk_select(out, length, one);
        distance = sk_select(out, length, distance);
        n = (sk_wide3){sk_select(out, way.x * by, n.x), sk_select(out, way.y * by, n.y),
                       sk_select(out, way.z * by, n.z)};
    }
    contact->distance = scale * distance;
    contact->normal = (sk_wide3){r[0] * n.x + r[1] * n.y + r[2] * n.z, r[3] * n.x + r[4] * n.y + r[5] * n.z,
                                 r[6] * n.x + r[7] * n.y + r[8] * n.z};
    contact->speed = sk_splat(0);
}

#else

#include <math.h>
#include <stdio.h>

/* Cells along the longest side where none are asked for; corners at most, 16 bytes each in float; and cells beyond the mesh's box. */
enum { CELLS = 32, MOST_NODES = 1 << 23, BEYOND = 2 };

static sk_probe *const probes[] = SK_EACH_ISA(probe);

static const skein_field fields[] = {
    SK_MESH_FIELDS(sk_mesh_params),
    SK_REAL(field_params, cell, "cell", "m", 0, 0, SK_FAR,
            "side of the cubes that distances are sampled in; 0: a 32nd of the mesh's longest side"),
};

static size_t node_count(const field_params *f) {
    return (size_t)f->nodes[0] * (size_t)f->nodes[1] * (size_t)f->nodes[2];
}

/* Where the cubes are. */
static skein_status lay_out(field_params *f, skein_error *error) {
    const sk_tree_node *box = &f->mesh.made->node[0];
    double extent[3], longest = 0, count = 1;
    for (int k = 0; k < 3; k++)
        extent[k] = (double)box->high[k] - (double)box->low[k], longest = fmax(longest, extent[k]);
    double side = f->cell > 0 ? f->cell / f->mesh.scale : longest / CELLS, along[3];
    for (int k = 0; k < 3; k++) along[k] = ceil(extent[k] / side) + 2 * BEYOND + 1, count *= along[k];
    if (!(count <= MOST_NODES))
        return sk_fail(error, SKEIN_ERROR_LIMIT, "cell",
                       "cells of %g m are %.3g distances for a mesh of %g m: at most %d", f->cell, count,
                       longest * f->mesh.scale, MOST_NODES);
    f->side = (real)side;
    for (int k = 0; k < 3; k++) {
        f->nodes[k] = (int)along[k];
        f->low[k] = (real)(0.5 * ((double)box->low[k] + (double)box->high[k]) - 0.5 * (along[k] - 1) * side);
    }
    return SKEIN_OK;
}

/* Asks the mesh, row by row, no farther than what is nearest to the row before lets it be. Whether any corner is inside. */
static bool sample(field_params *f) {
    sk_mesh_params own = f->mesh;
    const sk_pose still = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const size_t row = (size_t)f->nodes[0], layer = row * (size_t)f->nodes[1], count = node_count(f);
    bool any_inside = false;
    own.scale = 1;
    for (size_t first = 0; first < count; first += row) {
        const size_t above = first % layer ? row : layer;
        const sk_vec4 *before = first ? &f->node[first - above] : NULL;
        const real y = f->low[1] + (real)(first / row % (size_t)f->nodes[1]) * f->side;
        const real z = f->low[2] + (real)(first / layer) * f->side;
        for (size_t i = 0; i < row; i += SK_PART) {
            sk_wide3 p = {{0}, {0}, {0}};
            sk_wide reach = {0};
            sk_contact contact;
            for (size_t l = 0; l < SK_PART; l++) {
                const size_t at = i + l < row ? i + l : row - 1;
                p.x[l] = f->low[0] + (real)at * f->side, p.y[l] = y, p.z[l] = z;
                reach[l] = before ? (real)1.01 * (sk_abs(before[at].w) + (real)1.01 * f->side) : (real)1e14;
            }
            sk_solid_mesh.near[0](&own, &still, &p, &reach, &contact);
            for (size_t l = 0; l < SK_PART && i + l < row; l++) {
                f->node[first + i + l] =
                    (sk_vec4){contact.normal.x[l], contact.normal.y[l], contact.normal.z[l], contact.distance[l]};
                any_inside |= contact.distance[l] < 0;
            }
        }
    }
    return any_inside;
}

/* Faces that have less than a cell of solid behind their middles, as the field sees it: what is so thin it may miss. */
static size_t count_thin(const field_params *f) {
    const sk_trimesh *m = f->mesh.made;
    field_params own = *f;
    const sk_pose still = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    size_t thin = 0;
    own.mesh.scale = 1;
    for (size_t t = 0; t < m->triangle_count; t += SK_PART) {
        sk_wide3 p = {{0}, {0}, {0}};
        sk_contact contact;
        for (size_t l = 0; l < SK_PART; l++) {
            const size_t at = t + l < m->triangle_count ? t + l : t;
            const sk_facet *c = &m->facet[at];
            const sk_vec3 n = m->normal[at];
            p.x[l] = c->a[0] + (c->ab[0] + c->ac[0]) / 3 - f->side * n.x;
            p.y[l] = c->a[1] + (c->ab[1] + c->ac[1]) / 3 - f->side * n.y;
            p.z[l] = c->a[2] + (c->ab[2] + c->ac[2]) / 3 - f->side * n.z;
        }
        probes[0](&own, &still, &p, &contact);
        for (size_t l = 0; l < SK_PART && t + l < m->triangle_count; l++) thin += contact.distance[l] > 0;
    }
    return thin;
}

static void unmake(void *data, sk_allocator *allocator) {
    sk_release(allocator, ((field_params *)data)->node);
    sk_mesh_unmake(data, allocator);
}

static skein_status take(void *data, const skein_mesh *mesh, sk_allocator *allocator, sk_faults_text *faults,
                         skein_error *error) {
    field_params *f = data;
    skein_status status = sk_mesh_take(data, mesh, allocator, faults, error);
    if (!status) status = lay_out(f, error);
    if (status) return status;
    f->mesh.made->sheet = f->mesh.made->openness > 0.3; // its cells know no sheets: a crate without its lid is solid
    if (!(f->node = sk_allocate(allocator, node_count(f) * sizeof *f->node)))
        return sk_fail_memory(error, "the distances");
    if (!sample(f))
        return sk_fail(
            error, SKEIN_ERROR_MESH, "mesh",
            "no corner of its cells of %g m is inside the mesh: take smaller cells, or type mesh, which takes sheets, too",
            (double)f->side * f->mesh.scale);
    size_t thin = count_thin(f), at = strlen(faults->text);
    if (thin)
        snprintf(
            faults->text + at, sizeof faults->text - at,
            "%sthe field may miss what is thinner than a cell, %.2g m: so little is behind %zu of the mesh's %zu triangles",
            at ? "; " : "", (double)f->side * f->mesh.scale, thin, f->mesh.made->triangle_count);
    return SKEIN_OK;
}

static bool is_shaped_by(const char *field) {
    return !strcmp(field, "mesh") || !strcmp(field, "cell");
}

static const sk_making making = {.make = sk_mesh_make, .unmake = unmake};
const sk_collider_type sk_sampled_field = {
    .kind =
        {"field",
         "what a mesh encloses, by distances sampled from it once: cheap to ask, and round at edges by a part of a cell",
         SKEIN_COLLIDER, fields, sizeof fields / sizeof *fields, sizeof(field_params)},
    .place = sk_mesh_place,
    .turn = sk_mesh_turn,
    .probe = SK_EACH_ISA(probe),
    .passing = SK_ANY_SHAPE,
    .making = &making,
    .take = take,
    .is_shaped_by = is_shaped_by,
    .surface = sk_mesh_surface,
    .scale = sk_mesh_scale,
};
#endif
