/* Counting a mesh's faults, and warning of them with the first example of each. */
#include "bodies/faults.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"

static void warn_about_faces(skein_world *world, const char *label, const sk_sheet *sheet, const sk_springs *springs) {
    size_t crowded = 0;
    const sk_edge *example = NULL;
    for (size_t e = 0; e < springs->edge_count; e++) {
        if (springs->edges[e].face_count < 3) continue;
        if (!crowded++) example = &springs->edges[e];
    }
    if (crowded)
        sk_world_log(world, SKEIN_LOG_WARNING,
                     "%s: %zu edge%s with three faces or more, such as %u-%u; they get no bending", label, crowded,
                     crowded == 1 ? "" : "s", example->a, example->b);
    if (sheet->flat_faces)
        sk_world_log(world, SKEIN_LOG_WARNING, "%s: %zu face%s without an area, such as face %u; they add no mass",
                     label, sheet->flat_faces, sheet->flat_faces == 1 ? "" : "s", sheet->first_flat_face);
    size_t unused = 0, first = 0;
    for (size_t i = 0; i < sheet->particle_count; i++)
        if (!(sheet->particle_area[i] > 0) && !unused++) first = i;
    if (unused)
        sk_world_log(world, SKEIN_LOG_WARNING,
                     "%s: %zu vert%s of no face, such as %zu; without a mass they stay where they are", label, unused,
                     unused == 1 ? "ex is" : "ices are", first);
}

/* Counts the parts that no edge joins (unused vertices are not parts). */
static bool warn_about_parts(skein_world *world, const char *label, const sk_sheet *sheet, const sk_springs *springs) {
    uint32_t *parent = sk_allocate(&world->allocator, sheet->particle_count * sizeof *parent);
    if (!parent) return false;
    for (size_t i = 0; i < sheet->particle_count; i++) parent[i] = (uint32_t)i;
    for (size_t e = 0; e < springs->edge_count; e++) sk_union_join(parent, springs->edges[e].a, springs->edges[e].b);
    size_t parts = 0, second = 0;
    for (size_t i = 0; i < sheet->particle_count; i++)
        if (parent[i] == i && sheet->particle_area[i] > 0 && ++parts == 2) second = i;
    if (parts > 1)
        sk_world_log(world, SKEIN_LOG_WARNING, "%s: %zu parts that do not touch; a second one has vertex %zu", label,
                     parts, second);
    sk_release(&world->allocator, parent);
    return true;
}

/* A border vertex with its place beside it, so that sorting needs nothing else. */
typedef struct border_vertex {
    double place[3];
    uint32_t index;
} border_vertex;

static int compare_places(const void *p, const void *q) {
    const border_vertex *a = p, *b = q;
    for (int k = 0; k < 3; k++)
        if (a->place[k] != b->place[k]) return a->place[k] < b->place[k] ? -1 : 1;
    return 0;
}

/* Border vertices in the very same place: a seam that was probably meant to hold. */
static bool warn_about_seams(skein_world *world, const char *label, const sk_sheet *sheet, const sk_springs *springs) {
    border_vertex *border = sk_allocate(&world->allocator, 2 * springs->edge_count * sizeof *border);
    bool *taken = sk_allocate(&world->allocator, sheet->particle_count * sizeof *taken);
    size_t count = 0, same = 0, first = 0;
    bool good = border && taken;
    for (size_t e = 0; e < springs->edge_count && good; e++) {
        if (springs->edges[e].face_count != 1) continue;
        for (int k = 0; k < 2; k++) {
            uint32_t i = k ? springs->edges[e].b : springs->edges[e].a;
            const double *p = sheet->position[i];
            if (!taken[i]) border[count++] = (border_vertex){{p[0], p[1], p[2]}, i};
            taken[i] = true;
        }
    }
    if (count) qsort(border, count, sizeof *border, compare_places);
    for (size_t i = 1; i < count; i++)
        if (!compare_places(&border[i - 1], &border[i]) && !same++) first = i;
    if (same)
        sk_world_log(
            world, SKEIN_LOG_WARNING,
            "%s: %zu border vertices lie on another one, such as %u on %u; weld (a distance, such as 1e-6) joins them",
            label, same, border[first].index, border[first - 1].index);
    sk_release(&world->allocator, border);
    sk_release(&world->allocator, taken);
    return good;
}

static double length_of(const sk_sheet *sheet, const sk_edge *edge) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        const double way = sheet->position[edge->b][k] - sheet->position[edge->a][k];
        square += way * way;
    }
    return sqrt(square);
}

/* Edges that are far shorter than others, as scanned meshes have them: next to no mass is at their ends, and what a sweep leaves of
 * the long ones beside them stretches them manyfold. */
static void warn_about_short_edges(skein_world *world, const char *label, const sk_sheet *sheet,
                                   const sk_springs *springs) {
    const double share = 0.1; // of the mean
    double mean = 0, least = HUGE_VAL;
    size_t count = 0;
    const sk_edge *example = NULL;
    for (size_t e = 0; e < springs->edge_count; e++)
        mean += length_of(sheet, &springs->edges[e]) / (double)springs->edge_count;
    for (size_t e = 0; e < springs->edge_count; e++) {
        const double length = length_of(sheet, &springs->edges[e]);
        if (!(length < share * mean)) continue;
        count++;
        if (length < least) least = length, example = &springs->edges[e];
    }
    if (count)
        sk_world_log(
            world, SKEIN_LOG_WARNING,
            "%s: %zu edge%s shorter than a tenth of the mean, which is %.2g m, such as %u-%u with %.2g m; such are stretched "
            "most: weld (a distance, such as %.1g) joins what is nearer",
            label, count, count == 1 ? " is" : "s are", mean, example->a, example->b, least, share * mean);
}

skein_status sk_report_faults(skein_world *world, const char *label, const sk_sheet *sheet, const sk_springs *springs,
                              skein_error *error) {
    if (!world->desc.log || sheet->grid_rows) return SKEIN_OK;
    warn_about_faces(world, label, sheet, springs);
    warn_about_short_edges(world, label, sheet, springs);
    if (!warn_about_parts(world, label, sheet, springs) || !warn_about_seams(world, label, sheet, springs))
        return sk_fail_memory(error, "checking the mesh");
    return SKEIN_OK;
}
