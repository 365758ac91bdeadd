/* A triangle mesh of where a field of numbers is 0: a net with a vertex in each cell that the surface passes
 * (Gibson 1998, "surface nets").
 *
 * Called by world_implicit.c. Its arrays grow and stay. */
#ifndef SKEIN_RENDER_NET_H
#define SKEIN_RENDER_NET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Start from {0}. */
typedef struct render_net {
    double *positions; /* vertex_count x 3 */
    size_t vertex_count, vertex_room;
    uint32_t *triangles; /* triangle_count x 3; their fronts are where the field is over 0 */
    size_t triangle_count, triangle_room;
    uint32_t *vertex_of; /* of the cells of two layers */
    size_t layer_room;
} render_net;

/* Values at the corners of cells: x runs fastest, and there is one more along each axis than cells. */
typedef struct render_net_grid {
    double least[3], cell; /* where it begins; the side of its cells, m */
    size_t cells[3];
    const float *values;
} render_net_grid;

/* False where there is no memory. NaN counts as over 0. */
bool render_net_make(render_net *net, const render_net_grid *grid);
void render_net_release(render_net *net);

#endif
