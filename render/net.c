/* Surface nets: cells with a change of sign get a vertex, and edges with one get two triangles. */
#include "render/net.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t NO_VERTEX = UINT32_MAX;

static bool grow(void *array, size_t *room, size_t count, size_t size) {
    void **pointer = array;
    if (count <= *room) return true;
    size_t more = 2 * count + 64;
    void *grown = realloc(*pointer, more * size);
    if (!grown) return false;
    *pointer = grown, *room = more;
    return true;
}

void render_net_release(render_net *net) {
    free(net->positions);
    free(net->triangles);
    free(net->vertex_of);
    memset(net, 0, sizeof *net);
}

/* The place of a cell's corner in the values; bits of `corner` are x, y and z. */
static size_t corner_at(const render_net_grid *g, const size_t cell[3], int corner) {
    size_t x = cell[0] + (size_t)(corner & 1), y = cell[1] + (size_t)(corner >> 1 & 1),
           z = cell[2] + (size_t)(corner >> 2);
    return (z * (g->cells[1] + 1) + y) * (g->cells[0] + 1) + x;
}

static bool is_inside(float value) {
    return value < 0;
}

/* The mean of where the surface cuts the cell's edges; false where it passes by. */
static bool place_vertex(const render_net_grid *g, const size_t cell[3], double place[3]) {
    float value[8];
    int inside = 0, cuts = 0;
    double sum[3] = {0, 0, 0};
    for (int c = 0; c < 8; c++) inside += is_inside(value[c] = g->values[corner_at(g, cell, c)]);
    if (inside == 0 || inside == 8) return false;
    for (int c = 0; c < 8; c++)
        for (int axis = 0; axis < 3; axis++) {
            int other = c | 1 << axis;
            if (other == c || is_inside(value[c]) == is_inside(value[other])) continue;
            double share = (double)value[c] / ((double)value[c] - (double)value[other]);
            if (!(share >= 0 && share <= 1)) share = 0.5; // a value that is no number, or far off
            for (int k = 0; k < 3; k++) sum[k] += (c >> k & 1) + (k == axis ? share : 0);
            cuts++;
        }
    for (int k = 0; k < 3; k++) place[k] = g->least[k] + g->cell * ((double)cell[k] + sum[k] / cuts);
    return true;
}

static bool add_triangle(render_net *net, uint32_t a, uint32_t b, uint32_t c) {
    if (!grow(&net->triangles, &net->triangle_room, 3 * (net->triangle_count + 1), sizeof *net->triangles))
        return false;
    uint32_t *t = &net->triangles[3 * net->triangle_count++];
    t[0] = a, t[1] = b, t[2] = c;
    return true;
}

/* Where the first cell of the two layers that stay is: odd and even layers take turns. */
static uint32_t *vertex_of(const render_net *net, const render_net_grid *g, size_t x, size_t y, size_t z) {
    return &net->vertex_of[((z & 1) * g->cells[1] + y) * g->cells[0] + x];
}

/* The four cells around the edge that leaves a cell's first corner along an axis make a quad where it is cut. */
static bool add_quad(render_net *net, const render_net_grid *g, const size_t cell[3], int axis) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (!cell[u] || !cell[v]) return true;
    bool inside = is_inside(g->values[corner_at(g, cell, 0)]);
    if (inside == is_inside(g->values[corner_at(g, cell, 1 << axis)])) return true;
    uint32_t quad[4];
    for (int i = 0; i < 4; i++) {
        size_t at[3] = {cell[0], cell[1], cell[2]};
        at[u] -= i == 1 || i == 2, at[v] -= i >= 2;
        quad[i] = *vertex_of(net, g, at[0], at[1], at[2]);
        if (quad[i] == NO_VERTEX) return true; // cannot be: such an edge cuts all four
    }
    if (!inside)
        for (int i = 0; i < 2; i++) {
            uint32_t kept = quad[i];
            quad[i] = quad[3 - i], quad[3 - i] = kept;
        }
    return add_triangle(net, quad[0], quad[1], quad[2]) && add_triangle(net, quad[0], quad[2], quad[3]);
}

static bool add_cell(render_net *net, const render_net_grid *g, const size_t cell[3]) {
    double place[3];
    uint32_t *vertex = vertex_of(net, g, cell[0], cell[1], cell[2]);
    *vertex = NO_VERTEX;
    if (!place_vertex(g, cell, place)) return true;
    if (!grow(&net->positions, &net->vertex_room, 3 * (net->vertex_count + 1), sizeof *net->positions)) return false;
    memcpy(&net->positions[3 * net->vertex_count], place, sizeof place);
    *vertex = (uint32_t)net->vertex_count++;
    for (int axis = 0; axis < 3; axis++)
        if (!add_quad(net, g, cell, axis)) return false;
    return true;
}

bool render_net_make(render_net *net, const render_net_grid *g) {
    net->vertex_count = net->triangle_count = 0;
    if (!grow(&net->vertex_of, &net->layer_room, 2 * g->cells[0] * g->cells[1], sizeof *net->vertex_of)) return false;
    size_t cell[3];
    for (cell[2] = 0; cell[2] < g->cells[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < g->cells[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < g->cells[0]; cell[0]++)
                if (!add_cell(net, g, cell)) return false;
    return true;
}
