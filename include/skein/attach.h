/* Tying particles to other bodies: which particles of a body a text names, and the triangles that are nearest to them.
 *
 *     skein_body_select(world, flag, "box -1 0 0  0 1 0.1", chosen, 100, &count);
 *     skein_attachments_find(world, chosen, count, jelly, corners);
 *     skein_constraint_add(world, "attachment", corners, count, settings, NULL);
 *
 * (To the triangles of a mesh collider leads a motion, "attach".) */
#ifndef SKEIN_ATTACH_H
#define SKEIN_ATTACH_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

/* Copies up to `most` of the particles of a body that a text names, as its pins are named: "top edge", numbers (of vertices), "box x y z x y z",
 * "sphere x y z radius", by where they were built. `count` receives how many there are; `out` may be NULL where `most` is 0. Fails with SKEIN_ERROR_NAME, SKEIN_ERROR_VALUE and SKEIN_ERROR_MEMORY. */
skein_status skein_body_select(skein_world *world, skein_handle body, const char *text, uint32_t *out, size_t most,
                               size_t *count);
/* Of each of `count` particles the triangle of the body `to` that is nearest now: `out`, count x 4, has the particle and the three
 * corners, as constraints of the kind "attachment" take them. Fails with SKEIN_ERROR_VALUE where that body has no triangles, and
 * for particles of its own; with SKEIN_ERROR_MEMORY. */
skein_status skein_attachments_find(skein_world *world, const uint32_t *particles, size_t count, skein_handle to,
                                    uint32_t *out);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
