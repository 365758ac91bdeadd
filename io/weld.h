/* Vertices at exactly the same place become one: for formats that tell triangles by places (STL), or part vertices at
 * seams (glTF). */
#ifndef SKEIN_IO_WELD_H
#define SKEIN_IO_WELD_H

#include "io/mesh.h"

typedef struct io_weld {
    uint32_t *slots; /* a power of two of them; a vertex of the mesh + 1, or 0 */
    size_t slot_count;
} io_weld;

/* The vertex of the mesh at that place, added where there is none. False: no memory, or more vertices than a mesh has. */
bool io_weld_vertex(io_weld *weld, io_mesh *mesh, const double position[3], uint32_t *vertex);
void io_weld_free(io_weld *weld);

#endif
