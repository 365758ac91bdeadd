/* The skin: vertices, edges and triangles of all that a rule acts on, dealt to leaves. Two triangles that have an edge in common
 * are one leaf, as those of a grid's cell are (leaves.c); each vertex and each edge belongs to the first leaf that has it, and
 * they are numbered in the order of the leaves. */
#include <string.h>

#include "base/union_find.h"
#include "contact/touch.h"

#define NOBODY UINT32_MAX

/* What is needed while a skin is made. */
typedef struct making {
    sk_skin *skin;
    const sk_particles *particles;
    uint32_t *vertex_of; /* of the user's particles */
    uint8_t *here;       /* of triangles: they take part */
    uint32_t *partner;   /* with whom each is a leaf, */
    uint32_t *order;     /* and which comes when */
    uint32_t *table;     /* of edges, by their ends: open addressing */
    size_t mask;
} making;

static uint32_t vertex_of(making *m, uint32_t particle) {
    sk_skin *skin = m->skin;
    if (m->vertex_of[particle] != NOBODY) return m->vertex_of[particle];
    uint32_t v = (uint32_t)skin->vertex_count++;
    sk_vec3 built = m->particles->built[particle];
    skin->particle[v] = particle;
    skin->built[v] = (sk_vec4){built.x, built.y, built.z, 0};
    return m->vertex_of[particle] = v;
}

/* Adds an edge, unless it is there. */
static void add_edge(making *m, uint32_t a, uint32_t b) {
    sk_skin *skin = m->skin;
    if (a > b) {
        uint32_t other = a;
        a = b, b = other;
    }
    size_t at = sk_edge_place(a, b, m->mask);
    for (; m->table[at] != NOBODY; at = (at + 1) & m->mask) {
        const uint32_t *edge = skin->edge[m->table[at]];
        if (edge[0] == a && edge[1] == b) return;
    }
    m->table[at] = (uint32_t)skin->edge_count;
    skin->edge[skin->edge_count][0] = a, skin->edge[skin->edge_count++][1] = b;
}

static void open_leaf(sk_skin *skin) {
    skin->leaf[skin->leaf_count++] = (sk_leaf){.first_vertex = (uint32_t)skin->vertex_count,
                                               .first_edge = (uint32_t)skin->edge_count,
                                               .first_triangle = (uint32_t)skin->triangle_count};
}

static void close_leaf(sk_skin *skin) {
    sk_leaf *leaf = &skin->leaf[skin->leaf_count - 1];
    leaf->vertices = (uint8_t)(skin->vertex_count - leaf->first_vertex);
    leaf->edges = (uint8_t)(skin->edge_count - leaf->first_edge);
    leaf->triangles = (uint8_t)(skin->triangle_count - leaf->first_triangle);
}

static void add_triangle(making *m, const uint32_t corner[3]) {
    sk_skin *skin = m->skin;
    uint32_t v[3];
    for (int k = 0; k < 3; k++) v[k] = vertex_of(m, corner[k]);
    for (int k = 0; k < 3; k++) add_edge(m, v[k], v[(k + 1) % 3]);
    memcpy(skin->triangle[skin->triangle_count++], v, sizeof v);
}

static bool takes_part(const making *m, const sk_only *only, uint32_t particle) {
    return sk_particle_is_here(m->particles, particle) && sk_only_has(only, particle);
}

static bool add_all(making *m, sk_allocator *allocator, const sk_only *only, const sk_meeting_parts *parts) {
    sk_skin *skin = m->skin;
    for (size_t t = 0; t < parts->triangle_count; t++) {
        const uint32_t *corner = parts->triangle[t];
        m->here[t] = takes_part(m, only, corner[0]) && corner[0] != corner[1] && corner[1] != corner[2] &&
                     corner[2] != corner[0];
    }
    if (!sk_leaves_deal(m->partner, m->order, allocator, m->particles, parts, m->here)) return false;
    for (size_t i = 0; i < parts->triangle_count; i++) {
        const uint32_t t = m->order[i], partner = m->partner[t];
        if (!m->here[t]) continue; // or it is in an earlier leaf
        m->here[t] = false;
        if (partner != NOBODY) m->here[partner] = false;
        open_leaf(skin);
        add_triangle(m, parts->triangle[t]);
        if (partner != NOBODY) add_triangle(m, parts->triangle[partner]);
        close_leaf(skin);
    }
    for (size_t e = 0; e < parts->edge_count; e++) {
        const uint32_t *end = parts->edge[e];
        if (!takes_part(m, only, end[0]) || end[0] == end[1]) continue;
        open_leaf(skin);
        uint32_t a = vertex_of(m, end[0]), b = vertex_of(m, end[1]);
        add_edge(m, a, b);
        close_leaf(skin);
    }
    return true;
}

static void find_pieces(sk_skin *skin) {
    for (uint32_t v = 0; v < skin->vertex_count; v++) skin->piece[v] = v;
    for (size_t e = 0; e < skin->edge_count; e++) sk_union_join(skin->piece, skin->edge[e][0], skin->edge[e][1]);
    for (uint32_t v = 0; v < skin->vertex_count; v++) skin->piece[v] = sk_union_root(skin->piece, v);
}

/* Lists v's leaf, once: leaves come one after the other. */
static void list_leaf(sk_skin *skin, uint32_t *last, uint32_t v, size_t leaf, bool fill) {
    if (last[v] == leaf) return;
    last[v] = (uint32_t)leaf;
    if (fill) skin->leaf_of[skin->leaf_start[v]++] = (uint32_t)leaf;
    else skin->leaf_start[v + 1]++;
}

/* The leaves that have each vertex. */
static bool list_leaves(sk_skin *skin, sk_allocator *allocator) {
    size_t vertices = skin->vertex_count;
    uint32_t *last = sk_allocate(allocator, (vertices + 1) * sizeof *last);
    bool good = last && (skin->leaf_start = sk_allocate(allocator, (vertices + 2) * sizeof *skin->leaf_start));
    for (int fill = 0; fill < 2 && good; fill++) {
        memset(last, 0xff, vertices * sizeof *last);
        for (size_t i = 0; i < skin->leaf_count; i++) {
            const sk_leaf *leaf = &skin->leaf[i];
            for (size_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++)
                for (int c = 0; c < 3; c++) list_leaf(skin, last, skin->triangle[t][c], i, fill);
            for (size_t e = leaf->first_edge; e < leaf->first_edge + leaf->edges; e++)
                for (int c = 0; c < 2; c++) list_leaf(skin, last, skin->edge[e][c], i, fill);
        }
        if (fill) break;
        for (size_t v = 0; v < vertices; v++) skin->leaf_start[v + 1] += skin->leaf_start[v];
        good =
            (skin->leaf_of = sk_allocate(allocator, (skin->leaf_start[vertices] + 1) * sizeof *skin->leaf_of)) != NULL;
    }
    for (size_t v = vertices; good && v > 0; v--) skin->leaf_start[v] = skin->leaf_start[v - 1]; // they were moved on
    if (good) skin->leaf_start[0] = 0;
    sk_release(allocator, last);
    return good;
}

/* About seven tenths of a cell's side: of a mean over sides and diagonals, six. */
static void measure_spacing(sk_skin *skin) {
    double sum = 0;
    for (size_t e = 0; e < skin->edge_count; e++) {
        real length = sk_length(sk_sub(sk_xyz(skin->built[skin->edge[e][0]]), sk_xyz(skin->built[skin->edge[e][1]])));
        sum += (double)length;
        skin->longest = sk_max(skin->longest, length);
    }
    skin->spacing = skin->edge_count ? (real)(0.6 * sum / (double)skin->edge_count) : 0;
}

/* What bodies have of their own. Vertices of one body mostly follow each other. */
static void take_own(sk_skin *skin, const sk_meeting_parts *parts) {
    size_t body = 0;
    skin->all_own = true;
    for (size_t v = 0; v < skin->vertex_count; v++) {
        const uint32_t particle = skin->particle[v];
        for (size_t tried = 0; tried < parts->body_count; tried++, body++) {
            if (body >= parts->body_count) body = 0;
            if (particle >= parts->body[body].first && particle < parts->body[body].end) break;
        }
        if (body >= parts->body_count) body = 0;
        bool any = parts->body_count && particle >= parts->body[body].first && particle < parts->body[body].end;
        skin->thickness[v] = any ? (real)parts->body[body].thickness : 0;
        skin->friction[v] = any ? (real)parts->body[body].friction : 0;
        skin->thickest = sk_max(skin->thickest, skin->thickness[v]);
        skin->all_own &= skin->thickness[v] > 0;
    }
}

bool sk_skin_make(sk_skin *skin, sk_allocator *allocator, const sk_particles *particles, const sk_only *only,
                  const sk_meeting_parts *parts) {
    sk_skin_release(skin, allocator);
    size_t triangles = parts->triangle_count, edges = 3 * triangles + parts->edge_count, size = 16;
    while (size < 2 * edges) size *= 2;
    making m = {.skin = skin, .particles = particles, .mask = size - 1};
    skin->particle = sk_allocate(allocator, (particles->count + 1) * sizeof *skin->particle);
    skin->piece = sk_allocate(allocator, (particles->count + 1) * sizeof *skin->piece);
    skin->built = sk_allocate(allocator, (particles->count + 1) * sizeof *skin->built);
    skin->thickness = sk_allocate(allocator, (particles->count + 1) * sizeof *skin->thickness);
    skin->friction = sk_allocate(allocator, (particles->count + 1) * sizeof *skin->friction);
    skin->edge = sk_allocate(allocator, (edges + 1) * sizeof *skin->edge);
    skin->triangle = sk_allocate(allocator, (triangles + 1) * sizeof *skin->triangle);
    skin->leaf = sk_allocate(allocator, (triangles + parts->edge_count + 1) * sizeof *skin->leaf);
    m.vertex_of = sk_allocate(allocator, (particles->count + 1) * sizeof *m.vertex_of);
    m.table = sk_allocate(allocator, size * sizeof *m.table);
    m.here = sk_allocate(allocator, triangles + 1);
    m.partner = sk_allocate(allocator, (triangles + 1) * sizeof *m.partner);
    m.order = sk_allocate(allocator, (triangles + 1) * sizeof *m.order);
    bool good = skin->particle && skin->piece && skin->built && skin->edge && skin->triangle && skin->leaf &&
                skin->thickness && skin->friction && m.vertex_of && m.table && m.here && m.partner && m.order;
    if (good) {
        memset(m.vertex_of, 0xff, particles->count * sizeof *m.vertex_of);
        memset(m.table, 0xff, size * sizeof *m.table);
        good = add_all(&m, allocator, only, parts);
    }
    if (good) {
        find_pieces(skin);
        measure_spacing(skin);
        take_own(skin, parts);
        good = list_leaves(skin, allocator) && sk_solids_make(skin, allocator, particles, m.vertex_of, parts);
    }
    sk_release(allocator, m.vertex_of);
    sk_release(allocator, m.table);
    sk_release(allocator, m.here);
    sk_release(allocator, m.partner);
    sk_release(allocator, m.order);
    if (!good) sk_skin_release(skin, allocator);
    return good;
}

void sk_skin_release(sk_skin *skin, sk_allocator *allocator) {
    sk_release(allocator, skin->particle);
    sk_release(allocator, skin->piece);
    sk_release(allocator, skin->built);
    sk_release(allocator, skin->thickness);
    sk_release(allocator, skin->friction);
    sk_release(allocator, skin->edge);
    sk_release(allocator, skin->triangle);
    sk_release(allocator, skin->leaf);
    sk_release(allocator, skin->leaf_start);
    sk_release(allocator, skin->leaf_of);
    sk_release(allocator, skin->closed);
    sk_release(allocator, skin->inner);
    *skin = (sk_skin){.vertex_count = 0};
}
