/* Sets of a body's particles that constraints can be made on: its edges, triangles, hinges and tetrahedra. */
#include <stdlib.h>

#include "bodies/body.h"

/* One side of a triangle of the surface. */
typedef struct side {
    uint32_t low, high; /* its ends */
    uint32_t from, to;  /* the same as the triangle goes round */
    uint32_t across;    /* the triangle's third corner */
    uint32_t number;    /* sides of one pair of ends stay in their order */
} side;

typedef struct list {
    uint32_t *out;
    size_t arity, most, count; /* elements */
} list;

static void add(list *l, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const uint32_t particle[4] = {a, b, c, d};
    if (l->count < l->most && l->out)
        for (size_t i = 0; i < l->arity; i++) l->out[l->count * l->arity + i] = particle[i];
    l->count++;
}

static void list_edges(list *l, const sk_body *body) {
    for (size_t b = 0; b < body->batch_count; b++) {
        const sk_batch *batch = body->batch[b];
        if (!batch->measured || batch->arity != 2) continue;
        for (size_t e = 0; e < batch->count; e++) add(l, batch->particle[2 * e], batch->particle[2 * e + 1], 0, 0);
    }
}

/* A body that is made of tetrahedra keeps the volume of each, however soft. */
static void list_tetrahedra(list *l, const sk_body *body) {
    for (size_t b = 0; b < body->batch_count; b++) {
        const sk_batch *batch = body->batch[b];
        const uint32_t *p = batch->particle;
        if (batch->type != &sk_volume) continue;
        for (size_t e = 0; e < batch->count; e++, p += 4) add(l, p[0], p[1], p[2], p[3]);
    }
}

/* Faces are cut into triangles from their first corner; what welding has made flat is left out. */
static size_t visit_triangles(const sk_body *body, void (*visit)(void *, const uint32_t[3]), void *user) {
    size_t count = 0, start = 0;
    for (size_t f = 0; f < body->face_count; start += body->face_sizes[f++])
        for (size_t k = 1; k + 1 < body->face_sizes[f]; k++) {
            uint32_t corner[3];
            for (size_t i = 0; i < 3; i++)
                corner[i] = body->particle_of_vertex[body->face_vertices[start + (i ? k + i - 1 : 0)]];
            if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
            if (visit) visit(user, corner);
            count++;
        }
    return count;
}

static void add_triangle(void *user, const uint32_t corner[3]) {
    add(user, corner[0], corner[1], corner[2], 0);
}

typedef struct sides {
    side *data;
    size_t count;
} sides;

static void add_sides(void *user, const uint32_t corner[3]) {
    sides *all = user;
    for (int i = 0; i < 3; i++) {
        uint32_t from = corner[i], to = corner[(i + 1) % 3];
        all->data[all->count] =
            (side){from < to ? from : to, from < to ? to : from, from, to, corner[(i + 2) % 3], (uint32_t)all->count};
        all->count++;
    }
}

static int compare_sides(const void *p, const void *q) {
    const side *a = p, *b = q;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return (a->number > b->number) - (a->number < b->number);
}

/* Where two triangles and no more share a side. */
static bool list_hinges(list *l, const sk_body *body, sk_allocator *allocator) {
    sides all = {.data = sk_allocate(allocator, 3 * visit_triangles(body, NULL, NULL) * sizeof *all.data)};
    if (!all.data) return false;
    visit_triangles(body, add_sides, &all);
    qsort(all.data, all.count, sizeof *all.data, compare_sides);
    for (size_t i = 0, end; i < all.count; i = end) {
        for (end = i + 1;
             end < all.count && all.data[end].low == all.data[i].low && all.data[end].high == all.data[i].high;)
            end++;
        const side *a = &all.data[i], *b = &all.data[i + 1];
        if (end == i + 2 && a->across != b->across) add(l, a->from, a->to, a->across, b->across);
    }
    sk_release(allocator, all.data);
    return true;
}

skein_status skein_body_elements(skein_world *world, skein_handle handle, skein_elements what, uint32_t *out,
                                 size_t most, size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, count);
    static const size_t arity[] = {[SKEIN_EDGES] = 2, [SKEIN_TRIANGLES] = 3, [SKEIN_HINGES] = 4, [SKEIN_TETRAHEDRA] = 4};
    skein_error *error = sk_world_error(world);
    const sk_object *object = sk_object_find(world, handle, SKEIN_BODY);
    if (!object) return SKEIN_ERROR_HANDLE;
    if (what > SKEIN_TETRAHEDRA) return sk_fail(error, SKEIN_ERROR_VALUE, "", "a body has no elements of that sort");
    list l = {out, arity[what], most, 0};
    bool good = true;
    if (what == SKEIN_EDGES) list_edges(&l, object->as.body);
    else if (what == SKEIN_TRIANGLES) visit_triangles(object->as.body, add_triangle, &l);
    else if (what == SKEIN_TETRAHEDRA) list_tetrahedra(&l, object->as.body);
    else good = list_hinges(&l, object->as.body, &world->allocator);
    *count = l.count;
    return good ? SKEIN_OK : sk_fail_memory(error, "hinges");
}
