/* Finding hinges: edges between two faces, and the cuts through faces of more than three corners. */
#include "bodies/hinges.h"

#include <math.h>

#include "base/status.h"
#include "bodies/body.h"
#include "bodies/order.h"

typedef struct hinge_list {
    sk_allocator *allocator;
    uint32_t (*data)[4];
    size_t count, capacity;
} hinge_list;

static bool add(hinge_list *list, uint32_t p0, uint32_t p1, uint32_t p2, uint32_t p3) {
    if (p2 == p3 || p0 == p1 || p2 == p0 || p2 == p1 || p3 == p0 || p3 == p1) return true; // welded shut
    if (!SK_RESERVE(list->allocator, list, list->count + 1)) return false;
    uint32_t *hinge = list->data[list->count++];
    hinge[0] = p0, hinge[1] = p1, hinge[2] = p2, hinge[3] = p3;
    return true;
}

static size_t size_of(const sk_sheet *sheet, size_t face) {
    return sheet->face_start[face + 1] - sheet->face_start[face];
}

/* The corner across from the edge that begins at place `k` of a face, in the triangle that has the edge. */
static uint32_t corner_across(const sk_sheet *sheet, size_t face, size_t k) {
    const uint32_t *corner = sheet->corners + sheet->face_start[face];
    size_t size = size_of(sheet, face);
    return k == 0 ? corner[2] : k + 1 < size ? corner[0] : corner[size - 2];
}

static bool add_edges(hinge_list *list, const sk_sheet *sheet, const sk_springs *springs) {
    bool good = true;
    for (size_t i = 0; i < springs->edge_count && good; i++) {
        const sk_edge *edge = &springs->edges[i];
        if (edge->face_count != 2) continue;
        uint32_t across[2], first = 0, second = 0;
        for (int side = 0; side < 2; side++) {
            size_t face = edge->face[side], k = edge->corner[side] - sheet->face_start[face];
            const uint32_t *corner = sheet->corners + sheet->face_start[face];
            if (side == 0) first = corner[k], second = corner[(k + 1) % size_of(sheet, face)];
            across[side] = corner_across(sheet, face, k);
        }
        good = add(list, first, second, across[0], across[1]);
    }
    return good;
}

/* The cuts of faces into triangles. */
static bool add_cuts(hinge_list *list, const sk_sheet *sheet) {
    bool good = true;
    for (size_t f = 0; f < sheet->face_count; f++) {
        const uint32_t *corner = sheet->corners + sheet->face_start[f];
        for (size_t k = 2; k + 1 < size_of(sheet, f) && good; k++)
            good = add(list, corner[0], corner[k], corner[k + 1], corner[k - 1]);
    }
    return good;
}

static double area_of(const double a[3], const double b[3], const double c[3]) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* A sheet that is folded along edges of length l, between triangles of areas A and B, has the energy B kappa^2/2 a
 * square metre if each edge has l^2/(A + B) of its rigidity. (With the 3 l^2/(A + B) that is often given, each edge
 * standing for a third of its triangles, it would be three times as stiff.) */
static double scale_of(const double x[4][3]) {
    double square = 0, area = area_of(x[0], x[1], x[2]) + area_of(x[0], x[1], x[3]);
    for (int k = 0; k < 3; k++) square += (x[1][k] - x[0][k]) * (x[1][k] - x[0][k]);
    return area > 0 ? square / area : 0;
}

skein_status sk_hinges_find(sk_hinges *hinges, const sk_sheet *sheet, const sk_springs *springs,
                            const sk_constraint_type *type, const uint32_t *rank, skein_error *error) {
    sk_allocator *allocator = sheet->allocator;
    hinge_list list = {.allocator = allocator};
    bool good = add_edges(&list, sheet, springs) && add_cuts(&list, sheet) &&
                sk_order_hinges(allocator, &list.data, list.count, rank);
    *hinges = (sk_hinges){.allocator = allocator, .count = list.count, .corner = list.data};
    size_t rests = (size_t)type->rest_count;
    if (good) {
        hinges->rest = sk_allocate(allocator, list.count * rests * sizeof *hinges->rest);
        if (type == &sk_dihedral) hinges->scale = sk_allocate(allocator, list.count * sizeof *hinges->scale);
        good = hinges->rest && (hinges->scale || type != &sk_dihedral);
    }
    for (size_t i = 0; i < list.count && good; i++) {
        double x[4][3], rest[8];
        for (int p = 0; p < 4; p++)
            for (int k = 0; k < 3; k++) x[p][k] = sheet->position[list.data[i][p]][k];
        type->rest(NULL, (const double(*)[3])x, rest);
        for (size_t r = 0; r < rests; r++) hinges->rest[r * list.count + i] = (real)rest[r];
        if (hinges->scale) hinges->scale[i] = (real)scale_of((const double(*)[3])x);
    }
    if (good) return SKEIN_OK;
    sk_hinges_release(hinges);
    return sk_fail_memory(error, "hinges");
}

void sk_hinges_release(sk_hinges *hinges) {
    if (!hinges->allocator) return;
    sk_release(hinges->allocator, hinges->corner);
    sk_release(hinges->allocator, hinges->rest);
    sk_release(hinges->allocator, hinges->scale);
    *hinges = (sk_hinges){.count = 0};
}
