/* A body's surface without the faces that are cut (skein/cut.h), for files.
 *
 * Owns: the lists of what is left. Called by whoever writes a body's mesh: the command, the window, the package for
 * JavaScript. Invariant: vertices and particles stay, so that point caches fit the mesh, however it is cut. */
#ifndef SKEIN_IO_UNCUT_H
#define SKEIN_IO_UNCUT_H

#include "io/mesh.h"

/* Points the surface's faces at what is left of them. `room` receives the memory behind that, to be freed (NULL where
 * nothing is cut). False where there is none. */
bool io_surface_uncut(const skein_world *world, skein_handle body, skein_surface *surface, uint32_t **room);
/* Takes the body's cut faces out of a mesh that was read and has the same faces, with all that was said of them. */
void io_mesh_uncut(io_mesh *read, const skein_world *world, skein_handle body);

#endif
