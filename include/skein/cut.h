/* Cutting cloth: faces of a body's surface are taken away, and with them all that held across them. Vertices are not
 * doubled, so that a cut is as wide as the faces that the blade meets.
 *
 *     const double blade[3][3] = {{-2, 1, -1}, {2, 1, -1}, {0, 1, 3}}; // a level triangle, through the middle
 *     skein_cut(world, cloth, blade, &count);
 *
 * What is cut exerts no force any more, is met by no contact and no wind, and its springs count in no statistics; its
 * mass stays with its corners. Long distances (tethers, spans) hold on where there is as short a way along what is left;
 * coarse grids let go of a cloth that is cut. Snapshots and recordings hold cuts; skein_world_reset() makes bodies whole
 * again. The same faces taken away give the same bits, in whatever order and with however many calls. */
#ifndef SKEIN_CUT_H
#define SKEIN_CUT_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

/* Takes away the faces that a blade, a triangle with these corners (m), meets where the body is now. `count` (or NULL)
 * receives how many there were that were not cut before. Fails with SKEIN_ERROR_HANDLE; with SKEIN_ERROR_VALUE for
 * a body that is no sheet (only cloth is), or a blade whose numbers are not finite, under 1e15; with SKEIN_ERROR_MEMORY.
 * Nothing is cut then. */
skein_status skein_cut(skein_world *world, skein_handle body, const double (*blade)[3], size_t *count);
/* Takes away faces by their numbers in the body's surface (skein_body_surface()). Those that are cut already stay so.
 * Fails as skein_cut() does; with SKEIN_ERROR_VALUE for a number that no face has. Nothing is cut then. */
skein_status skein_cut_faces(skein_world *world, skein_handle body, const uint32_t *faces, size_t count);
/* Puts all faces of a body back, with all that held across them. Fails with SKEIN_ERROR_HANDLE and SKEIN_ERROR_MEMORY. */
skein_status skein_cut_mend(skein_world *world, skein_handle body);

/* What is cut of a body. */
typedef struct skein_cuts {
    const uint8_t *face; /* of each face of its surface, whether it is cut; NULL where none ever was. Lives until the
                            body is removed */
    size_t count;        /* of faces that are */
    uint64_t changes;    /* grows whenever they change */
} skein_cuts;
skein_status skein_body_cuts(const skein_world *world, skein_handle body, skein_cuts *cuts);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
