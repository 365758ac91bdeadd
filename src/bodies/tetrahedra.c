/* Soft bodies from a mesh of tetrahedra: a particle a point, springs along edges, and a volume that each keeps.
 *
 *   mesh (placed) --> volumes, masses --> edges --> particles, batches, the outer faces
 *
 * Stiffness is the material's, in Pa. An edge stands for a sixth of each tetrahedron around it; together they have
 * E = `stiffness` where edges point all ways alike (a network of springs has a Poisson's ratio of 1/4), which takes
 * k = 6 E V/L^2: stretched by e to all sides it holds 3 E V e^2. The volumes add a bulk modulus of their own. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bodies/body.h"
#include "bodies/order.h"
#include "bodies/sheet.h"
#include "particles/selection.h"

typedef struct tetrahedra_params {
    char *mesh;
    double position[3], rotation[3], scale, velocity[3], density;
    char *pins;
    sk_material edges, volume;
    double limit;
    int32_t look;
} tetrahedra_params;

static const skein_field fields[] = {
    SK_TEXT(tetrahedra_params, mesh, "mesh", "",
            "file of a mesh, .node with .ele beside it (in scenes; a program passes the mesh itself)"),
    SK_VEC3(tetrahedra_params, position, "position", "m", 0, 0, 0, "where the mesh's origin is put"),
    SK_VEC3(tetrahedra_params, rotation, "rotation", "deg", 0, 0, 0,
            "turned about x, then y, then z, before it is put there"),
    SK_REAL(tetrahedra_params, scale, "scale", "", 1, 1e-9, 1e9, "factor on the mesh's coordinates"),
    SK_VEC3(tetrahedra_params, velocity, "velocity", "m/s", 0, 0, 0, "at the start"),
    SK_REAL(tetrahedra_params, density, "density", "kg/m3", 1000, 1e-9, 1e9,
            "mass of a cubic metre, shared out to the corners"),
    SK_TEXT(tetrahedra_params, pins, "pins", "",
            "pinned particles: \"all\", numbers, \"box x y z x y z\", \"sphere x y z r\""),
    SK_REAL(tetrahedra_params, edges.stiffness, "stiffness", "Pa", 2e4, 0, SK_UNBOUNDED,
            "Young's modulus of the springs along the edges (1e4 is a jelly, 1e6 a rubber)"),
    SK_REAL(tetrahedra_params, edges.damping, "damping", "Pa s", 0, 0, SK_FAR, "of the same"),
    SK_REAL(tetrahedra_params, volume.stiffness, "volume.stiffness", "Pa", 1e5, 0, SK_UNBOUNDED,
            "bulk modulus: against a change of each tetrahedron's volume, besides the springs' own"),
    SK_REAL(tetrahedra_params, volume.damping, "volume.damping", "Pa s", 0, 0, SK_FAR, "of the same"),
    SK_REAL(tetrahedra_params, limit, "limit", "", SK_UNBOUNDED, 0, SK_UNBOUNDED,
            "strain limit: no edge gets longer than rest times 1 + this; \"infinite\" is none"),
    SK_LOOK(tetrahedra_params, look, SKEIN_LOOK_JELLY),
};

/* The body's batches, in the order of sweeps: what is swept last is kept best. */
enum { VOLUME, EDGES };

typedef struct edge {
    uint32_t a, b; /* a < b */
    double share;  /* of the volume, m3 */
} edge;

typedef struct face {
    uint32_t corner[3]; /* as they look outward */
    uint32_t key[3];    /* the same, sorted */
} face;

/* What one build needs; all of it scratch. */
typedef struct builder {
    skein_world *world;
    sk_body *body;
    const tetrahedra_params *params;
    skein_error *error;
    size_t point_count, count; /* `count` tetrahedra */
    double (*position)[3];
    uint32_t (*corner)[4]; /* so turned that volumes are positive */
    double *volume, *mass;
    bool *pinned;
    edge *edges;
    size_t edge_count;
    face *faces; /* the outer ones, once they are found */
    size_t face_count;
} builder;

/* ---- the mesh ---- */

static skein_status check_mesh(builder *b, const skein_mesh *mesh) {
    if (!mesh) return sk_fail(b->error, SKEIN_ERROR_VALUE, "mesh", "a body of tetrahedra needs a mesh of them");
    if (!mesh->vertex_count || !mesh->face_count)
        return sk_fail(b->error, SKEIN_ERROR_MESH, "mesh", "a mesh of %zu points and %zu tetrahedra: expected some",
                       mesh->vertex_count, mesh->face_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        if (!(fabs(mesh->positions[i]) <= 1e12))
            return sk_fail(b->error, SKEIN_ERROR_MESH, "mesh", "point %zu: coordinates must be finite, under 1e12",
                           i / 3);
    for (size_t t = 0; t < mesh->face_count; t++)
        if (mesh->face_sizes[t] != 4)
            return sk_fail(
                b->error, SKEIN_ERROR_MESH, "mesh",
                "%zu has %u corners, and a tetrahedron 4: a mesh of faces is no body of tetrahedra; those come "
                "from .node and .ele",
                t, mesh->face_sizes[t]);
    if (mesh->face_vertex_count != 4 * mesh->face_count)
        return sk_fail(b->error, SKEIN_ERROR_MESH, "mesh", "%zu corners for %zu tetrahedra", mesh->face_vertex_count,
                       mesh->face_count);
    for (size_t i = 0; i < mesh->face_vertex_count; i++)
        if (mesh->face_vertices[i] >= mesh->vertex_count)
            return sk_fail(b->error, SKEIN_ERROR_MESH, "mesh", "tetrahedron %zu names point %u, but there are only %zu",
                           i / 4, mesh->face_vertices[i], mesh->vertex_count);
    return SKEIN_OK;
}

static double signed_volume(const builder *b, const uint32_t *c) {
    const double *p = b->position[c[0]];
    double d[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) d[i][k] = b->position[c[i + 1]][k] - p[k];
    return ((d[0][1] * d[1][2] - d[0][2] * d[1][1]) * d[2][0] + (d[0][2] * d[1][0] - d[0][0] * d[1][2]) * d[2][1] +
            (d[0][0] * d[1][1] - d[0][1] * d[1][0]) * d[2][2]) /
           6;
}

static double length_of(const builder *b, uint32_t p, uint32_t q) {
    const double *x = b->position[p], *y = b->position[q];
    double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* The pairs of corners that are edges. */
static const int edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* Volumes, all positive, and the masses that they give the points. */
static skein_status weigh(builder *b) {
    for (size_t t = 0; t < b->count; t++) {
        uint32_t *c = b->corner[t];
        double volume = signed_volume(b, c), longest = 0;
        for (int e = 0; e < 6; e++) longest = fmax(longest, length_of(b, c[edge_ends[e][0]], c[edge_ends[e][1]]));
        // a needle or a flake this thin is rounding, in float
        if (!(fabs(volume) > 1e-6 * longest * longest * longest))
            return sk_fail(b->error, SKEIN_ERROR_MESH, "mesh",
                           "tetrahedron %zu, of the points %u %u %u %u, is flat: its volume is %g m3", t, c[0], c[1],
                           c[2], c[3], volume);
        if (volume < 0) {
            uint32_t swapped = c[2];
            c[2] = c[3], c[3] = swapped;
        }
        b->volume[t] = fabs(volume);
        for (int k = 0; k < 4; k++) b->mass[c[k]] += b->params->density * b->volume[t] / 4;
    }
    size_t lost = 0;
    for (size_t i = 0; i < b->point_count; i++) lost += !(b->mass[i] > 0);
    if (lost)
        sk_world_log(b->world, SKEIN_LOG_WARNING, "%s: %zu %s in no tetrahedron, and pinned", b->body->label, lost,
                     lost == 1 ? "point is" : "points are");
    return SKEIN_OK;
}

static skein_status take_mesh(builder *b, const skein_mesh *mesh) {
    sk_allocator *allocator = &b->world->allocator;
    skein_status status = check_mesh(b, mesh);
    if (status) return status;
    b->point_count = mesh->vertex_count;
    b->count = mesh->face_count;
    b->position = sk_allocate(allocator, b->point_count * sizeof *b->position);
    b->corner = sk_allocate(allocator, b->count * sizeof *b->corner);
    b->volume = sk_allocate(allocator, b->count * sizeof *b->volume);
    b->mass = sk_allocate(allocator, b->point_count * sizeof *b->mass);
    if (!b->position || !b->corner || !b->volume || !b->mass) return sk_fail_memory(b->error, "tetrahedra");
    memcpy(b->position, mesh->positions, b->point_count * sizeof *b->position);
    memcpy(b->corner, mesh->face_vertices, b->count * sizeof *b->corner);
    sk_points_transform(b->position, b->point_count, b->params->scale, b->params->rotation, b->params->position);
    return weigh(b);
}

/* ---- particles ---- */

static skein_status choose_words(void *data, const char *words) {
    builder *b = data;
    if (strcmp(words, "all") != 0)
        return sk_fail(b->error, SKEIN_ERROR_NAME, "pins",
                       "'%s' names no part of a body of tetrahedra; expected \"all\", numbers, \"box x y z x y z\" or "
                       "\"sphere x y z radius\"",
                       words);
    for (size_t i = 0; i < b->point_count; i++) b->pinned[i] = true;
    return SKEIN_OK;
}

static skein_status add_particles(builder *b) {
    sk_allocator *allocator = &b->world->allocator;
    b->pinned = sk_allocate(allocator, b->point_count * sizeof *b->pinned);
    double(*velocity)[3] = sk_allocate(allocator, b->point_count * sizeof *velocity);
    skein_status status = b->pinned && velocity ? SKEIN_OK : sk_fail_memory(b->error, "particles");
    sk_selectable points = {allocator, b->position, b->point_count, NULL, b->point_count,
                            "point",   "the mesh",  choose_words,   b};
    if (!status) status = sk_selection_apply(b->params->pins, &points, "pins", b->pinned, b->error);
    for (size_t i = 0; i < b->point_count && !status; i++)
        if (b->mass[i] > 0 && !b->pinned[i]) memcpy(velocity[i], b->params->velocity, sizeof velocity[i]);
    if (!status)
        status = sk_world_add_particles(b->world, b->point_count, (const double *)b->position, (const double *)velocity,
                                        b->mass, b->error);
    for (size_t i = 0; i < b->point_count && !status; i++)
        if (b->pinned[i]) sk_particle_pin(&b->world->particles, b->body->first_particle + i, true);
    sk_release(allocator, velocity);
    return status;
}

/* ---- rules ---- */

static int compare_edges(const void *p, const void *q) {
    const edge *x = p, *y = q;
    if (x->a != y->a) return x->a < y->a ? -1 : 1;
    if (x->b != y->b) return x->b < y->b ? -1 : 1;
    return (x->share > y->share) - (x->share < y->share); // equal ones add up in the same order on every machine
}

/* Each edge once, with its share of the volume. */
static skein_status find_edges(builder *b) {
    b->edges = sk_allocate(&b->world->allocator, 6 * b->count * sizeof *b->edges);
    if (!b->edges) return sk_fail_memory(b->error, "edges");
    for (size_t t = 0; t < b->count; t++)
        for (int e = 0; e < 6; e++) {
            uint32_t p = b->corner[t][edge_ends[e][0]], q = b->corner[t][edge_ends[e][1]];
            b->edges[6 * t + (size_t)e] = (edge){p < q ? p : q, p < q ? q : p, b->volume[t] / 6};
        }
    qsort(b->edges, 6 * b->count, sizeof *b->edges, compare_edges);
    for (size_t i = 0; i < 6 * b->count; i++) {
        edge *last = b->edge_count ? &b->edges[b->edge_count - 1] : NULL;
        if (last && last->a == b->edges[i].a && last->b == b->edges[i].b) last->share += b->edges[i].share;
        else b->edges[b->edge_count++] = b->edges[i];
    }
    return SKEIN_OK;
}

/* A batch of `count` elements of so many particles, scattered (order.h); element i is `of(b, i, ...)`. */
static skein_status add_batch(builder *b, const sk_constraint_type *type, const char *label, sk_material material,
                              size_t count,
                              void (*of)(const builder *b, size_t i, uint32_t *particles, real *rest, real *scale)) {
    sk_allocator *allocator = &b->world->allocator;
    size_t arity = (size_t)type->arity;
    uint32_t *particles = sk_allocate(allocator, arity * count * sizeof *particles);
    real *rest = sk_allocate(allocator, count * sizeof *rest), *scale = sk_allocate(allocator, count * sizeof *scale);
    uint32_t *numbers = sk_allocate(allocator, count * sizeof *numbers);
    skein_status status = particles && rest && scale && numbers ? SKEIN_OK : sk_fail_memory(b->error, label);
    if (!status) sk_order_scatter(numbers, count);
    for (size_t i = 0; i < count && !status; i++) {
        of(b, numbers[i], particles + arity * i, &rest[i], &scale[i]);
        for (size_t k = 0; k < arity; k++) particles[arity * i + k] += b->body->first_particle;
    }
    if (!status)
        status = sk_world_add_body_batch(b->world, b->body, type, label, material, type == &sk_distance, count,
                                         particles, rest, scale, b->error);
    sk_release(allocator, particles);
    sk_release(allocator, rest);
    sk_release(allocator, scale);
    sk_release(allocator, numbers);
    return status;
}

static void make_edge(const builder *b, size_t i, uint32_t *particles, real *rest, real *scale) {
    const edge *e = &b->edges[i];
    double length = length_of(b, e->a, e->b);
    particles[0] = e->a, particles[1] = e->b;
    *rest = (real)length;
    *scale = (real)(6 * e->share / (length * length));
}

static void make_volume(const builder *b, size_t i, uint32_t *particles, real *rest, real *scale) {
    memcpy(particles, b->corner[i], sizeof b->corner[i]);
    *rest = (real)b->volume[i];
    *scale = (real)(1 / b->volume[i]);
}

/* ---- the surface ---- */

static int compare_faces(const void *p, const void *q) {
    const face *x = p, *y = q;
    for (int k = 0; k < 3; k++)
        if (x->key[k] != y->key[k]) return x->key[k] < y->key[k] ? -1 : 1;
    return 0;
}

/* The faces that one tetrahedron alone has. */
static skein_status find_faces(builder *b) {
    static const int sides[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    b->faces = sk_allocate(&b->world->allocator, 4 * b->count * sizeof *b->faces);
    if (!b->faces) return sk_fail_memory(b->error, "faces");
    for (size_t i = 0; i < 4 * b->count; i++) {
        face *f = &b->faces[i];
        for (int k = 0; k < 3; k++) f->corner[k] = f->key[k] = b->corner[i / 4][sides[i % 4][k]];
        for (int pass = 0; pass < 2; pass++)
            for (int k = 0; k < 2; k++)
                if (f->key[k] > f->key[k + 1]) {
                    uint32_t larger = f->key[k];
                    f->key[k] = f->key[k + 1], f->key[k + 1] = larger;
                }
    }
    qsort(b->faces, 4 * b->count, sizeof *b->faces, compare_faces);
    for (size_t i = 0, next; i < 4 * b->count; i = next) {
        next = i + 1;
        while (next < 4 * b->count && !compare_faces(&b->faces[i], &b->faces[next])) next++;
        if (next - i > 2)
            return sk_fail(b->error, SKEIN_ERROR_MESH, "mesh", "%zu tetrahedra share the face %u %u %u: at most two can",
                           next - i, b->faces[i].key[0], b->faces[i].key[1], b->faces[i].key[2]);
        if (next - i == 1) b->faces[b->face_count++] = b->faces[i];
    }
    return SKEIN_OK;
}

/* The outer faces and the points on them go to the body, for drawing and export; triangles for forces on areas. */
static skein_status add_surface(builder *b) {
    sk_allocator *allocator = &b->world->allocator;
    sk_body *body = b->body;
    size_t corners = 3 * b->face_count;
    uint32_t *vertex = sk_allocate(allocator, b->point_count * sizeof *vertex);
    uint32_t(*triangles)[3] = sk_allocate(allocator, b->face_count * sizeof *triangles);
    body->face_sizes = sk_allocate(allocator, b->face_count * sizeof *body->face_sizes);
    body->face_vertices = sk_allocate(allocator, corners * sizeof *body->face_vertices);
    body->particle_of_vertex = sk_allocate(allocator, b->point_count * sizeof *body->particle_of_vertex);
    skein_status status = SKEIN_OK;
    if (vertex && triangles && body->face_sizes && body->face_vertices && body->particle_of_vertex) {
        memset(vertex, 0xff, b->point_count * sizeof *vertex);
        for (size_t i = 0; i < corners; i++) vertex[b->faces[i / 3].corner[i % 3]] = 0;
        for (size_t p = 0; p < b->point_count; p++) {
            if (vertex[p]) continue;
            vertex[p] = (uint32_t)body->vertex_count;
            body->particle_of_vertex[body->vertex_count++] = body->first_particle + (uint32_t)p;
        }
        for (size_t i = 0; i < corners; i++) {
            body->face_sizes[i / 3] = 3;
            body->face_vertices[i] = vertex[b->faces[i / 3].corner[i % 3]];
            triangles[i / 3][i % 3] = body->first_particle + b->faces[i / 3].corner[i % 3];
        }
        body->face_count = b->face_count;
        body->face_vertex_count = corners;
        status = sk_world_add_triangles(b->world, b->face_count, (const uint32_t(*)[3])triangles, b->error);
    } else {
        status = sk_fail_memory(b->error, "faces");
    }
    sk_release(allocator, vertex);
    sk_release(allocator, triangles);
    return status;
}

/* ---- the type ---- */

static bool live(const void *params, const char *field) {
    (void)params;
    static const char *const names[] = {"stiffness", "damping", "volume.stiffness", "volume.damping", "limit", "look"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(field, names[i])) return true;
    return false;
}

static void change(sk_body *body, const void *data) {
    const tetrahedra_params *params = data;
    *body->material[VOLUME] = params->volume;
    *body->material[EDGES] = params->edges;
    body->strain_bound = params->limit;
}

static skein_status build(skein_world *world, sk_body *body, const void *params, const skein_mesh *mesh,
                          skein_error *error) {
    builder b = {.world = world, .body = body, .params = params, .error = error};
    skein_status status = take_mesh(&b, mesh);
    if (!status) status = find_edges(&b);
    if (!status) status = find_faces(&b);
    if (!status) status = add_particles(&b);
    if (!status) status = add_batch(&b, &sk_volume, "volume", b.params->volume, b.count, make_volume);
    if (!status) status = add_batch(&b, &sk_distance, "edges", b.params->edges, b.edge_count, make_edge);
    if (!status) {
        sk_world_add_strain_limit(body);
        status = add_surface(&b);
    }
    if (!status) change(body, params);
    void *scratch[] = {b.position, b.corner, b.volume, b.mass, b.pinned, b.edges, b.faces};
    for (size_t i = 0; i < sizeof scratch / sizeof *scratch; i++) sk_release(&world->allocator, scratch[i]);
    return status;
}

const sk_body_type sk_tetrahedra = {
    .kind = {"tetrahedra", "a soft body from a mesh of tetrahedra: springs along the edges, and volumes that are kept",
             SKEIN_BODY, fields, sizeof fields / sizeof *fields, sizeof(tetrahedra_params)},
    .build = build,
    .live = live,
    .change = change,
};
