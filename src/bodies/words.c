/* The words that bodies' pins are named by, for bodies that stand: each kind has its own, which its builder knows, too. */
#include <string.h>

#include "bodies/block.h"
#include "bodies/body.h"
#include "bodies/sheet_selection.h"
#include "world/choose.h"

static const sk_object *object_of(const skein_world *world, const sk_body *body) {
    for (size_t i = 0; i < world->objects.count; i++)
        if (world->objects.data[i]->category == SKEIN_BODY && world->objects.data[i]->as.body == body)
            return world->objects.data[i];
    return NULL;
}

/* ---- sheets ---- */

/* The faces of particles, without corners that welding made one. */
static void fill_faces(sk_sheet *sheet) {
    size_t filled = 0, from = 0;
    for (size_t f = 0; f < sheet->face_count; from += sheet->face_sizes[f], f++) {
        uint32_t *face = sheet->corners + filled;
        size_t size = 0;
        sheet->face_start[f] = filled;
        for (uint32_t k = 0; k < sheet->face_sizes[f]; k++) {
            uint32_t p = sheet->particle_of_vertex[sheet->face_vertices[from + k]];
            if (!size || face[size - 1] != p) face[size++] = p;
        }
        while (size > 1 && face[0] == face[size - 1]) size--;
        filled += size < 3 ? 0 : size;
    }
    sheet->face_start[sheet->face_count] = filled;
}

/* The sheet as its builder had it, as far as words need it. */
static skein_status choose_of_sheet(skein_world *world, const sk_body *body, double (*position)[3], const char *words,
                                    bool *chosen, skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    sk_sheet sheet = {.allocator = allocator,
                      .vertex_count = body->vertex_count,
                      .face_count = body->face_count,
                      .corner_count = body->face_vertex_count,
                      .face_sizes = body->face_sizes,
                      .face_vertices = body->face_vertices,
                      .particle_count = body->particle_count,
                      .position = position,
                      .grid_rows = body->grid_rows,
                      .grid_columns = body->grid_columns};
    sk_springs springs = {.allocator = NULL};
    sheet.particle_of_vertex = sk_allocate(allocator, (body->vertex_count + 1) * sizeof *sheet.particle_of_vertex);
    sheet.face_start = sk_allocate(allocator, (body->face_count + 1) * sizeof *sheet.face_start);
    sheet.corners = sk_allocate(allocator, (body->face_vertex_count + 1) * sizeof *sheet.corners);
    sheet.face_area =
        sk_allocate(allocator, (body->face_count + 1) * sizeof *sheet.face_area); // springs' scales: not asked for
    bool good = sheet.particle_of_vertex && sheet.face_start && sheet.corners && sheet.face_area;
    for (size_t v = 0; v < body->vertex_count && good; v++)
        sheet.particle_of_vertex[v] = body->particle_of_vertex[v] - body->first_particle;
    if (good) fill_faces(&sheet);
    skein_status status = good ? SKEIN_OK : sk_fail_memory(error, "pins");
    if (!status && !sheet.grid_rows) status = sk_springs_find(&springs, &sheet, error);
    if (!status) status = sk_sheet_choose_words(words, &sheet, &springs, "pins", chosen, error);
    sk_springs_release(&springs);
    sk_release(allocator, sheet.particle_of_vertex);
    sk_release(allocator, sheet.face_start);
    sk_release(allocator, sheet.corners);
    sk_release(allocator, sheet.face_area);
    return status;
}

/* ---- all kinds ---- */

skein_status sk_body_choose_words(skein_world *world, const sk_body *body, double (*position)[3], const char *words,
                                  bool *chosen, skein_error *error) {
    const sk_object *object = object_of(world, body);
    const char *kind = object ? object->kind->name : "";
    if (object && object->body_type->is_sheet) return choose_of_sheet(world, body, position, words, chosen, error);
    sk_block block = {
        .world = world, .error = error, .count = body->particle_count, .position = position, .pinned = chosen};
    if (!strcmp(kind, "rope")) return sk_rope_choose_words(&block, words);
    if (!strcmp(kind, "lattice")) {
        skein_value grid = sk_field_load(skein_field_find(object->kind, "grid", NULL), object->params);
        for (int k = 0; k < 3; k++) block.size[k] = (uint32_t)grid.number[k];
        return sk_lattice_choose_words(&block, words);
    }
    if (strcmp(words, "all") != 0)
        return sk_fail(
            error, SKEIN_ERROR_NAME, "pins",
            "'%s' names no part of a %s; expected numbers, \"all\", \"box x y z x y z\" or \"sphere x y z radius\"",
            words, kind);
    memset(chosen, 1, body->particle_count * sizeof *chosen);
    return SKEIN_OK;
}
