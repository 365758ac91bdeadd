/* What stays of a body while it moves; see body_mesh.h. */
#include "render/body_mesh.h"

#include "render/linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* While a mesh is made. */
typedef struct maker {
    render_body_mesh *mesh;
    const skein_surface *surface;
    const double *positions;
    float *corner_uv;    /* face_vertex_count x 2 */
    uint32_t *side;      /* of each corner: a corner at the same particle, on the same side of all creases */
    uint32_t *vertex_of; /* of each corner */
    bool round;          /* without creases */
} maker;

/* From a corner of a face to the next one. */
typedef struct way {
    uint32_t least, most;       /* the particles at its ends */
    uint32_t at_least, at_most; /* and the corners */
    uint32_t face, corner;      /* of the first */
} way;

/* Where the normals of two faces differ by more, in the body's first shape, there is a crease between them; else they
 * are parts of one smooth surface. */
static const double crease_cosine = 0.342; // of 70 degrees

static const double *place(const maker *m, uint32_t vertex) {
    return &m->positions[3 * (size_t)m->surface->particle_of_vertex[vertex]];
}

/* ---- Texture coordinates, corner by corner ---------------------------------------------------- */

/* How long a line of a grid is, over `count` vertices that are `step` apart. */
static double line_length(const maker *m, size_t count, size_t step) {
    double sum = 0;
    for (size_t i = 1; i < count; i++) {
        const double *p = place(m, (uint32_t)((i - 1) * step)), *q = place(m, (uint32_t)(i * step));
        sum += sqrt((q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]) + (q[2] - p[2]) * (q[2] - p[2]));
    }
    return isfinite(sum) && sum > 0 ? sum : 1;
}

static void uv_of_grid(maker *m, size_t rows, size_t columns) {
    const skein_surface *s = m->surface;
    for (size_t c = 0; c < s->face_vertex_count; c++) {
        size_t v = s->face_vertices[c];
        m->corner_uv[2 * c] = (float)(v / columns) / (float)(rows - 1);
        m->corner_uv[2 * c + 1] = (float)(v % columns) / (float)(columns - 1);
    }
    m->mesh->grid = true;
    m->mesh->sides[0] = line_length(m, rows, columns);
    m->mesh->sides[1] = line_length(m, columns, 1);
}

/* A face's normal, of any length (Newell's sum: it needs no flat face). */
static void face_normal(const maker *m, const uint32_t *corner, size_t size, double normal[3]) {
    memset(normal, 0, 3 * sizeof *normal);
    for (size_t k = 0; k < size; k++) {
        const double *p = place(m, corner[k]), *q = place(m, corner[(k + 1) % size]);
        for (int i = 0; i < 3; i++) {
            int a = (i + 1) % 3, b = (i + 2) % 3;
            normal[i] += (p[a] - q[a]) * (p[b] + q[b]);
        }
    }
}

/* Each face on to that side of the body's box that it faces most; the box's longest side is 1. */
static void uv_of_box(maker *m) {
    const skein_surface *s = m->surface;
    double least[3] = {INFINITY, INFINITY, INFINITY}, size = 0;
    for (int k = 0; k < 3; k++) {
        double most = -INFINITY;
        for (size_t v = 0; v < s->vertex_count; v++) {
            least[k] = fmin(least[k], place(m, (uint32_t)v)[k]);
            most = fmax(most, place(m, (uint32_t)v)[k]);
        }
        size = fmax(size, most - least[k]);
    }
    if (!(size > 0) || !isfinite(size)) size = 1;
    const uint32_t *corner = s->face_vertices;
    for (size_t f = 0, c = 0; f < s->face_count; corner += s->face_sizes[f++]) {
        double n[3];
        face_normal(m, corner, s->face_sizes[f], n);
        int side = fabs(n[0]) > fabs(n[1]) ? 0 : 1;
        if (fabs(n[2]) >= fabs(n[side])) side = 2;
        int across = side == 0 ? 2 : 0, up = side == 1 ? 2 : 1;
        // seen from outside, with the top of an image at the top
        bool turned = side == 0 ? n[0] > 0 : side == 2 && n[2] < 0;
        for (size_t k = 0; k < s->face_sizes[f]; k++, c++) {
            const double *p = place(m, corner[k]);
            double u = (p[across] - least[across]) / size, v = (p[up] - least[up]) / size;
            m->corner_uv[2 * c] = (float)(turned ? 1 - u : u);
            m->corner_uv[2 * c + 1] = (float)(side == 1 ? 1 - v : v);
        }
    }
    m->mesh->sides[0] = m->mesh->sides[1] = size;
}

static bool make_corner_uv(maker *m) {
    const skein_surface *s = m->surface;
    size_t rows = s->grid_rows, columns = s->grid_columns;
    m->corner_uv = malloc(s->face_vertex_count * 2 * sizeof *m->corner_uv + 1);
    if (!m->corner_uv) return false;
    m->mesh->sides[0] = m->mesh->sides[1] = 1;
    if (s->corner_uv) memcpy(m->corner_uv, s->corner_uv, s->face_vertex_count * 2 * sizeof *m->corner_uv);
    else if (rows >= 2 && columns >= 2 && rows * columns == s->vertex_count) uv_of_grid(m, rows, columns);
    else uv_of_box(m);
    return true;
}

/* ---- Edges and creases ------------------------------------------------------------------------ */

static int compare_ways(const void *a, const void *b) {
    const way *p = a, *q = b;
    if (p->least != q->least) return p->least < q->least ? -1 : 1;
    if (p->most != q->most) return p->most < q->most ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

/* All faces' sides, those between the same particles after each other; and each face's normal. */
static void list_ways(const maker *m, way *ways, double (*normals)[3]) {
    const skein_surface *s = m->surface;
    uint32_t first = 0;
    for (uint32_t f = 0; f < s->face_count; first += s->face_sizes[f++]) {
        face_normal(m, s->face_vertices + first, s->face_sizes[f], normals[f]);
        for (uint32_t k = 0; k < s->face_sizes[f]; k++) {
            uint32_t c = first + k, d = first + (k + 1) % s->face_sizes[f];
            uint32_t p = s->particle_of_vertex[s->face_vertices[c]], q = s->particle_of_vertex[s->face_vertices[d]];
            ways[c] = p < q ? (way){p, q, c, d, f, c} : (way){q, p, d, c, f, c};
        }
    }
    qsort(ways, s->face_vertex_count, sizeof *ways, compare_ways);
}

/* The corner that stands for all on the same side. */
static uint32_t root_of(uint32_t *side, uint32_t corner) {
    while (side[corner] != corner) corner = side[corner] = side[side[corner]];
    return corner;
}

static void join(uint32_t *side, uint32_t a, uint32_t b) {
    a = root_of(side, a), b = root_of(side, b);
    if (a < b) side[b] = a;
    else side[a] = b;
}

/* Faces of no area, which have no normal, are part of whatever they touch. */
static bool is_smooth(const double a[3], const double b[3]) {
    return !(render_dot(a, b) < crease_cosine * sqrt(render_dot(a, a) * render_dot(b, b)));
}

static bool make_edges(maker *m) {
    size_t corners = m->surface->face_vertex_count, kept = 0;
    way *ways = malloc(corners * sizeof *ways + 1);
    double(*normals)[3] = malloc(m->surface->face_count * sizeof *normals + 1);
    m->side = malloc(corners * sizeof *m->side + 1);
    uint32_t *edges = m->mesh->all_edges = malloc(corners * 2 * sizeof *edges + 1);
    m->mesh->edges = malloc(corners * 2 * sizeof *m->mesh->edges + 1);
    m->mesh->edge_of_side = malloc(corners * sizeof *m->mesh->edge_of_side + 1);
    bool good = ways && normals && m->side && edges && m->mesh->edges && m->mesh->edge_of_side;
    if (good) list_ways(m, ways, normals);
    for (size_t c = 0; c < corners && good; c++) m->side[c] = (uint32_t)c;
    for (size_t i = 0; i < corners && good; i++) {
        const way *now = &ways[i], *before = &ways[i ? i - 1 : 0];
        if (!i || now->least != before->least || now->most != before->most) {
            edges[2 * kept] = now->least, edges[2 * kept++ + 1] = now->most;
        } else if (m->round || is_smooth(normals[now->face], normals[before->face])) {
            join(m->side, now->at_least, before->at_least);
            join(m->side, now->at_most, before->at_most);
        }
        m->mesh->edge_of_side[now->corner] = (uint32_t)(kept - 1);
    }
    for (size_t c = 0; c < corners && good; c++) m->side[c] = root_of(m->side, (uint32_t)c);
    free(ways);
    free(normals);
    m->mesh->all_edge_count = kept;
    return good;
}

/* ---- Vertices --------------------------------------------------------------------------------- */

/* A vertex for each particle with a uv and a side of its creases that a corner has. */
static bool make_vertices(maker *m) {
    render_body_mesh *mesh = m->mesh;
    size_t corners = m->surface->face_vertex_count, particles = m->surface->particle_count;
    uint32_t first = m->surface->first_particle;
    uint32_t *newest = malloc(particles * sizeof *newest + 1), *older = malloc(corners * sizeof *older + 1);
    uint32_t *side = malloc(corners * sizeof *side + 1); // of each vertex
    m->vertex_of = malloc(corners * sizeof *m->vertex_of + 1);
    mesh->particles = malloc(corners * sizeof *mesh->particles + 1);
    mesh->weld = malloc(corners * sizeof *mesh->weld + 1);
    mesh->uv = malloc(corners * 2 * sizeof *mesh->uv + 1);
    bool good = newest && older && side && m->vertex_of && mesh->particles && mesh->weld && mesh->uv;
    if (good) memset(newest, 0xff, particles * sizeof *newest);
    for (size_t c = 0; c < corners && good; c++) {
        uint32_t particle = m->surface->particle_of_vertex[m->surface->face_vertices[c]];
        uint32_t *head = &newest[particle - first], v = *head, weld = (uint32_t)mesh->vertex_count;
        for (; v != UINT32_MAX; v = older[v]) {
            if (side[v] != m->side[c]) continue;
            weld = mesh->weld[v];
            if (!memcmp(&mesh->uv[2 * v], &m->corner_uv[2 * c], 2 * sizeof *mesh->uv)) break;
        }
        if (v == UINT32_MAX) {
            v = (uint32_t)mesh->vertex_count++;
            mesh->particles[v] = particle;
            mesh->weld[v] = weld;
            memcpy(&mesh->uv[2 * v], &m->corner_uv[2 * c], 2 * sizeof *mesh->uv);
            side[v] = m->side[c];
            older[v] = *head;
            *head = v;
        }
        m->vertex_of[c] = v;
    }
    free(newest);
    free(older);
    free(side);
    return good;
}

/* Every polygon as a fan about its first corner. */
static bool make_triangles(maker *m) {
    const skein_surface *s = m->surface;
    size_t numbers = 3 * (s->face_vertex_count - 2 * s->face_count);
    m->mesh->triangles = malloc(numbers * sizeof(uint32_t) + 1);
    m->mesh->all_triangles = malloc(numbers * sizeof(uint32_t) + 1);
    if (!m->mesh->triangles || !m->mesh->all_triangles) return false;
    const uint32_t *corner = m->vertex_of;
    uint32_t *out = m->mesh->all_triangles;
    for (size_t f = 0; f < s->face_count; f++) {
        for (uint32_t k = 2; k < s->face_sizes[f]; k++) {
            *out++ = corner[0], *out++ = corner[k - 1], *out++ = corner[k];
        }
        corner += s->face_sizes[f];
    }
    return true;
}

/* ---- All of it -------------------------------------------------------------------------------- */

/* FNV-1a, by words. */
static uint64_t hash(uint64_t so_far, const void *data, size_t words) {
    const uint32_t *word = data;
    for (size_t i = 0; i < words; i++) so_far = (so_far ^ word[i]) * 0x100000001b3u;
    return so_far;
}

bool render_body_mesh_make(render_body_mesh *mesh, const skein_surface *surface, const double *positions, bool round) {
    maker m = {mesh, surface, positions, NULL, NULL, NULL, round};
    bool good = make_corner_uv(&m) && make_edges(&m) && make_vertices(&m) && make_triangles(&m) &&
                render_body_mesh_leave_out(mesh, surface, NULL);
    free(m.corner_uv);
    free(m.side);
    free(m.vertex_of);
    if (!good) {
        render_body_mesh_release(mesh);
        return false;
    }
    return true;
}

bool render_body_mesh_leave_out(render_body_mesh *mesh, const skein_surface *surface, const uint8_t *cut) {
    uint8_t *stays = calloc(mesh->all_edge_count + 1, sizeof *stays);
    if (!stays) return false;
    const uint32_t *triangle = mesh->all_triangles, *edge = mesh->edge_of_side;
    uint32_t *out = mesh->triangles;
    for (size_t f = 0; f < surface->face_count; f++) {
        size_t size = surface->face_sizes[f], numbers = 3 * (size - 2);
        if (!cut || !cut[f]) {
            memcpy(out, triangle, numbers * sizeof *out);
            out += numbers;
            for (size_t k = 0; k < size; k++) stays[edge[k]] = true;
        }
        triangle += numbers, edge += size;
    }
    mesh->triangle_count = (size_t)(out - mesh->triangles) / 3;
    mesh->edge_count = 0;
    for (size_t i = 0; i < mesh->all_edge_count; i++)
        if (stays[i]) memcpy(&mesh->edges[2 * mesh->edge_count++], &mesh->all_edges[2 * i], 2 * sizeof *mesh->edges);
    free(stays);
    mesh->shape = hash(0xcbf29ce484222325u, mesh->triangles, 3 * mesh->triangle_count);
    mesh->shape = hash(mesh->shape, mesh->weld, mesh->vertex_count);
    mesh->shape = hash(mesh->shape, mesh->uv, 2 * mesh->vertex_count) | 1;
    return true;
}

void render_body_mesh_release(render_body_mesh *mesh) {
    free(mesh->particles);
    free(mesh->weld);
    free(mesh->triangles);
    free(mesh->edges);
    free(mesh->all_triangles);
    free(mesh->all_edges);
    free(mesh->edge_of_side);
    free(mesh->uv);
    memset(mesh, 0, sizeof *mesh);
}
