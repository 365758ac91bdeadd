/* Boxes of leaves' features in cells (features.c). Any number goes to its cell by one function that never falls, so
 * that boxes that meet do so in cells, too: no rounding has to be looked after. */
#include "contact/search/search.h"

typedef int32_t cells_quad __attribute__((vector_size(16)));

/* So small that a box is hardly wider by them, and so large that a leaf whose corners go on for many edges' lengths is
 * not too wide. */
real sk_cells_a_metre(const sk_touch *touch) {
    const real an_edge = 256;
    real width = touch->skin.spacing + touch->thickness;
    return width > 0 ? an_edge / width : 0; // 0: all that are looked at meet
}

/* (Towards 0: the cell there is twice as wide.) */
static inline cells_quad cells_of(sk_quad x, real a_metre) {
    return __builtin_convertvector(x * (sk_quad){a_metre, a_metre, a_metre, 0}, cells_quad);
}

/* What is too wide for differences to be right, or so far away that cells have no number. */
static bool is_wide(const sk_box *box, real a_metre) {
    const real farthest = (real)5e8;
    for (int k = 0; k < 3; k++) {
        real low = a_metre * sk_min(box->low[0][k], box->low[1][k]),
             high = a_metre * sk_max(box->high[0][k], box->high[1][k]);
        if (!(low >= -farthest && high <= farthest)) return true;
        if ((int32_t)high - (int32_t)low > SK_WIDEST_LEAF) return true;
    }
    return false;
}

/* Puts a box into a place of rows that have so many numbers. */
static inline void put(const sk_touch *touch, const sk_box *box, int16_t *number, int length) {
    const int rows = touch->still ? SK_CELL_ROWS / 2 : SK_CELL_ROWS; // of boxes that stand, one end is asked
    for (int row = 0; row < rows;) {
        int end = row / (SK_CELL_ROWS / 2);
        cells_quad c = cells_of(row % (SK_CELL_ROWS / 2) ? box->high[end] : box->low[end], touch->cells);
        for (int k = 0; k < 3; k++, row++) number[SK_CELL_ROW(row, length)] = (int16_t)(uint16_t)(uint32_t)c[k];
    }
}

void sk_touch_leaf_cells(sk_touch *touch, size_t i) {
    const sk_leaf *leaf = &touch->skin.leaf[i];
    int16_t *edges = touch->edge_cells[i].number, *corners = touch->corner_cells[i].number;
    edges[SK_EDGES_WIDE] = corners[SK_CORNERS_WIDE] = is_wide(&touch->leaf_box[i], touch->cells);
    if (edges[SK_EDGES_WIDE]) return;
    for (size_t k = 0; k < leaf->edges; k++)
        put(touch, &touch->edge_box[leaf->first_edge + k], edges + k, SK_LEAF_EDGES);
    for (size_t k = 0; k < leaf->vertices; k++)
        put(touch, &touch->vertex_box[leaf->first_vertex + k], corners + k, SK_LEAF_CORNERS);
    for (size_t k = 0; k < leaf->triangles; k++)
        put(touch, &touch->triangle_box[leaf->first_triangle + k], corners + SK_LEAF_VERTICES + k, SK_LEAF_CORNERS);
}
