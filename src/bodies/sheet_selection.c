/* Words that name parts of a sheet: by row and column on a grid, by its border and corners on a mesh. */
#include "bodies/sheet_selection.h"

#include <math.h>
#include <string.h>

#include "base/status.h"
#include "particles/selection.h"

typedef struct selector {
    const sk_sheet *sheet;
    const sk_springs *springs;
    const char *where;
    bool *chosen;
    bool *mark; /* scratch, a particle each: border, then corners */
    skein_error *error;
} selector;

enum { SIDE_NONE, SIDE_TOP, SIDE_BOTTOM, SIDE_LEFT, SIDE_RIGHT };
static const char *const side_words[] = {"", "top", "bottom", "left", "right"};

/* Whether a grid's vertex is on a side (any side for SIDE_NONE). */
static bool on_grid_side(const sk_sheet *sheet, size_t vertex, int side) {
    size_t row = vertex / sheet->grid_columns, column = vertex % sheet->grid_columns;
    bool at[] = {false, row == 0, row + 1 == sheet->grid_rows, column == 0, column + 1 == sheet->grid_columns};
    return side == SIDE_NONE ? at[1] || at[2] || at[3] || at[4] : at[side];
}

static void choose_of_grid(selector *s, int side, bool corners) {
    for (size_t v = 0; v < s->sheet->vertex_count; v++) {
        bool row_end = on_grid_side(s->sheet, v, SIDE_TOP) || on_grid_side(s->sheet, v, SIDE_BOTTOM);
        bool column_end = on_grid_side(s->sheet, v, SIDE_LEFT) || on_grid_side(s->sheet, v, SIDE_RIGHT);
        if (on_grid_side(s->sheet, v, side) && (!corners || (row_end && column_end)))
            s->chosen[s->sheet->particle_of_vertex[v]] = true;
    }
}

/* Marks the border: ends of edges with one face. Returns how many. */
static size_t mark_border(const selector *s) {
    size_t count = 0;
    memset(s->mark, 0, s->sheet->particle_count * sizeof *s->mark);
    for (size_t e = 0; e < s->springs->edge_count; e++) {
        const sk_edge *edge = &s->springs->edges[e];
        if (edge->face_count != 1) continue;
        count += (size_t)!s->mark[edge->a] + (size_t)!s->mark[edge->b];
        s->mark[edge->a] = s->mark[edge->b] = true;
    }
    return count;
}

/* Leaves only those marks where the border turns: the two border edges there are not nearly in line. */
static skein_status keep_corners(selector *s) {
    size_t count = s->sheet->particle_count;
    uint32_t *beside = sk_allocate(s->sheet->allocator, 2 * count * sizeof *beside);
    if (!beside) return sk_fail_memory(s->error, "corners");
    memset(beside, 0xff, 2 * count * sizeof *beside);
    for (size_t e = 0; e < s->springs->edge_count; e++) {
        const sk_edge *edge = &s->springs->edges[e];
        if (edge->face_count != 1) continue;
        beside[2 * edge->a + (beside[2 * edge->a] != UINT32_MAX)] = edge->b;
        beside[2 * edge->b + (beside[2 * edge->b] != UINT32_MAX)] = edge->a;
    }
    for (size_t i = 0; i < count; i++) {
        if (!s->mark[i] || beside[2 * i + 1] == UINT32_MAX) continue;
        const double *o = s->sheet->position[i], *a = s->sheet->position[beside[2 * i]],
                     *b = s->sheet->position[beside[2 * i + 1]];
        double u[3] = {a[0] - o[0], a[1] - o[1], a[2] - o[2]}, w[3] = {b[0] - o[0], b[1] - o[1], b[2] - o[2]};
        double cosine = (u[0] * w[0] + u[1] * w[1] + u[2] * w[2]) /
                        sqrt((u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
        s->mark[i] = cosine > -0.7071067811865476;
    }
    sk_release(s->sheet->allocator, beside);
    return SKEIN_OK;
}

/* Chooses the marked particles on a side of the mesh, by height or x, within 1 % of its size. */
static skein_status choose_marked(selector *s, int side, const char *words) {
    int axis = side == SIDE_TOP || side == SIDE_BOTTOM ? 1 : 0;
    double sign = side == SIDE_TOP || side == SIDE_RIGHT ? 1 : -1;
    double most = -1e300, least = 1e300;
    for (size_t i = 0; i < s->sheet->particle_count; i++) {
        if (!s->mark[i]) continue;
        double x = sign * s->sheet->position[i][axis];
        if (x > most) most = x;
        if (x < least) least = x;
    }
    if (side != SIDE_NONE && !(most - least > 0))
        return sk_fail(s->error, SKEIN_ERROR_MESH, s->where,
                       "'%s': the mesh lies flat, its border has no %s; turn it first or name particles by number",
                       words, side_words[side]);
    for (size_t i = 0; i < s->sheet->particle_count; i++)
        if (s->mark[i] && (side == SIDE_NONE || sign * s->sheet->position[i][axis] >= most - 0.01 * (most - least)))
            s->chosen[i] = true;
    return SKEIN_OK;
}

static skein_status choose_of_mesh(selector *s, int side, bool corners, const char *words) {
    if (!mark_border(s))
        return sk_fail(s->error, SKEIN_ERROR_MESH, s->where,
                       "'%s': the mesh is closed, it has no border; name particles by number, box or sphere", words);
    if (corners) {
        skein_status status = keep_corners(s);
        if (status) return status;
        bool any = false;
        for (size_t i = 0; i < s->sheet->particle_count; i++) any |= s->mark[i];
        if (!any)
            return sk_fail(s->error, SKEIN_ERROR_MESH, s->where,
                           "'%s': the mesh's border is round, it turns nowhere by more than 45 degrees", words);
    }
    return choose_marked(s, side, words);
}

static skein_status choose_words(void *data, const char *words) {
    selector *s = data;
    static const char *const forms[] = {"all",          "border",        "corners",  "top corners", "bottom corners",
                                        "left corners", "right corners", "top edge", "bottom edge", "left edge",
                                        "right edge"};
    static const int sides[] = {0,          0,        0,           SIDE_TOP,  SIDE_BOTTOM, SIDE_LEFT,
                                SIDE_RIGHT, SIDE_TOP, SIDE_BOTTOM, SIDE_LEFT, SIDE_RIGHT};
    enum { FORMS = sizeof forms / sizeof *forms };
    for (int f = 0; f < FORMS; f++) {
        if (strcmp(words, forms[f]) != 0) continue;
        if (f == 0) {
            memset(s->chosen, 1, s->sheet->particle_count * sizeof *s->chosen);
            return SKEIN_OK;
        }
        bool corners = f >= 2 && f <= 6;
        if (!s->sheet->grid_rows) return choose_of_mesh(s, sides[f], corners, words);
        choose_of_grid(s, sides[f], corners);
        return SKEIN_OK;
    }
    const char *nearest = sk_nearest_name(words, forms, FORMS);
    return sk_fail(
        s->error, SKEIN_ERROR_NAME, s->where,
        "'%s' names no part of a cloth%s%s%s; expected numbers, \"corners\", \"top corners\", \"top edge\" (bottom, left, "
        "right), \"border\", \"all\", \"box x y z x y z\" or \"sphere x y z radius\"",
        words, nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

skein_status sk_sheet_select(const char *text, const sk_sheet *sheet, const sk_springs *springs, const char *where,
                             bool *chosen, skein_error *error) {
    selector s = {sheet, springs, where, chosen, NULL, error};
    s.mark = sk_allocate(sheet->allocator, sheet->particle_count * sizeof *s.mark);
    if (!s.mark) return sk_fail_memory(error, where);
    sk_selectable things = {sheet->allocator,
                            sheet->position,
                            sheet->particle_count,
                            sheet->particle_of_vertex,
                            sheet->vertex_count,
                            "vertex",
                            "the mesh",
                            choose_words,
                            &s};
    skein_status status = sk_selection_apply(text, &things, where, chosen, error);
    sk_release(sheet->allocator, s.mark);
    return status;
}

skein_status sk_sheet_choose_words(const char *words, const sk_sheet *sheet, const sk_springs *springs,
                                   const char *where, bool *chosen, skein_error *error) {
    selector s = {sheet, springs, where, chosen, NULL, error};
    s.mark = sk_allocate(sheet->allocator, sheet->particle_count * sizeof *s.mark);
    skein_status status = s.mark ? choose_words(&s, words) : sk_fail_memory(error, where);
    sk_release(sheet->allocator, s.mark);
    return status;
}
