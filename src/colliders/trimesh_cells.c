/* Cells over the box of a closed mesh: most points in it are far from all triangles, and a look at their cell says on which side.
 *
 *     . . . x x .      x  a triangle comes near: ask the triangles
 *     . x x # x x      #  inside, .  outside: found once for all cells that lie together, by the winding number of one
 *     . x # # # x */
#include <math.h>
#include <string.h>

#include "colliders/trimesh.h"

enum { LEAST_CELLS = 4, MOST_CELLS = 48, CELLS_A_TRIANGLE = 64 }; /* along the longest axis; and of all of them */
enum { UNKNOWN, OUTSIDE, INSIDE, NEAR };

/* Cells along the longest axis: a few triangles are asked sooner than many cells are made. */
static int cells_for(size_t triangles) {
    int along = LEAST_CELLS;
    while (along < MOST_CELLS && (size_t)(along * along) * (size_t)along < CELLS_A_TRIANGLE * triangles) along++;
    return along;
}

static size_t place_of(const sk_trimesh *m, const int at[3]) {
    return ((size_t)at[2] * (size_t)m->cells[1] + (size_t)at[1]) * (size_t)m->cells[0] + (size_t)at[0];
}

static int cell_along(const sk_trimesh *m, int axis, real x) {
    real at = (x - m->cell_low[axis]) * m->per_cell[axis];
    int last = m->cells[axis] - 1;
    return !(at > 0) ? 0 : at < (real)last ? (int)at : last;
}

static void mark_near(sk_trimesh *m, size_t t, real slack) {
    int low[3], high[3], at[3];
    for (int k = 0; k < 3; k++) {
        real least = SK_REAL_MAX, most = -SK_REAL_MAX;
        for (int c = 0; c < 3; c++) {
            real x = (&m->place[m->corner[t][c]].x)[k];
            least = x < least ? x : least, most = x > most ? x : most;
        }
        low[k] = cell_along(m, k, least - slack), high[k] = cell_along(m, k, most + slack);
    }
    for (at[2] = low[2]; at[2] <= high[2]; at[2]++)
        for (at[1] = low[1]; at[1] <= high[1]; at[1]++)
            for (at[0] = low[0]; at[0] <= high[0]; at[0]++) {
                // off its plane by more than half a cell's diagonal it does not come near
                real off = 0;
                for (int k = 0; k < 3; k++)
                    off += (&m->normal[t].x)[k] *
                           (m->cell_low[k] + ((real)at[k] + (real)0.5) / m->per_cell[k] - m->facet[t].a[k]);
                if (fabs((double)off) <= 0.5 * (double)m->cell_span + (double)slack) m->cell[place_of(m, at)] = NEAR;
            }
}

/* Gives all cells that hang together with one what that one is. */
static void fill(sk_trimesh *m, uint32_t *stack, const int first[3]) {
    double middle[3];
    for (int k = 0; k < 3; k++) middle[k] = (double)m->cell_low[k] + (first[k] + 0.5) / (double)m->per_cell[k];
    uint8_t what = sk_trimesh_winding(m, middle) > 0.5 ? INSIDE : OUTSIDE;
    size_t depth = 0, step[3] = {1, (size_t)m->cells[0], (size_t)m->cells[0] * (size_t)m->cells[1]};
    m->cell[place_of(m, first)] = what;
    stack[depth++] = (uint32_t)place_of(m, first);
    while (depth) {
        size_t at = stack[--depth];
        for (int k = 0; k < 3; k++) {
            size_t along = at / step[k] % (size_t)m->cells[k];
            for (int way = 0; way < 2; way++) {
                if (way ? along + 1 == (size_t)m->cells[k] : along == 0) continue;
                size_t next = way ? at + step[k] : at - step[k];
                if (m->cell[next] != UNKNOWN) continue;
                m->cell[next] = what;
                stack[depth++] = (uint32_t)next;
            }
        }
    }
}

bool sk_trimesh_divide(sk_trimesh *m) {
    const sk_tree_node *box = &m->node[0];
    real size = 0, far = 0;
    size_t count = 1;
    for (int k = 0; k < 3; k++) {
        size = (real)fmax((double)size, (double)(box->high[k] - box->low[k]));
        far = (real)fmax((double)far, fmax(fabs((double)box->low[k]), fabs((double)box->high[k])));
    }
    if (!(size > 0)) return true;
    const int most = cells_for(m->triangle_count);
    for (int k = 0; k < 3; k++) {
        real along = box->high[k] - box->low[k];
        m->cells[k] = 1 + (int)((real)(most - 1) * (along / size));
        m->cell_low[k] = box->low[k], m->per_cell[k] = along > 0 ? (real)m->cells[k] / along : 0;
        if (!(along > 0) || !(m->per_cell[k] <= SK_REAL_MAX)) return true; // flat: there is no inside
        count *= (size_t)m->cells[k];
    }
    double span = 0;
    for (int k = 0; k < 3; k++) span += 1 / ((double)m->per_cell[k] * (double)m->per_cell[k]);
    m->cell_span = (real)sqrt(span);
    m->cell = sk_allocate(m->allocator, count);
    uint32_t *stack = sk_allocate(m->allocator, count * sizeof *stack);
    bool good = m->cell && stack;
    real slack = (sizeof(real) == 4 ? (real)1e-5 : (real)1e-13) * (size + far);
    for (size_t t = 0; good && t < m->triangle_count; t++) mark_near(m, t, slack);
    int at[3];
    for (at[2] = 0; good && at[2] < m->cells[2]; at[2]++)
        for (at[1] = 0; at[1] < m->cells[1]; at[1]++)
            for (at[0] = 0; at[0] < m->cells[0]; at[0]++)
                if (m->cell[place_of(m, at)] == UNKNOWN) fill(m, stack, at);
    sk_release(m->allocator, stack);
    return good;
}

sk_trimesh_side sk_trimesh_side_of(const sk_trimesh *m, const real p[3], real within) {
    if (m->cell) {
        const int at[3] = {cell_along(m, 0, p[0]), cell_along(m, 1, p[1]), cell_along(m, 2, p[2])};
        uint8_t what = m->cell[place_of(m, at)];
        if (what != NEAR) return what == OUTSIDE ? SK_OUTSIDE : SK_INSIDE;
        if (within < m->cell_span) return SK_UNDECIDED;
    }
    if (m->sheet) return SK_OUTSIDE;
    double winding = sk_trimesh_winding(m, (const double[3]){(double)p[0], (double)p[1], (double)p[2]});
    return winding > 0.5 ? SK_INSIDE : SK_OUTSIDE;
}
