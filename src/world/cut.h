/* What is cut of a body: which of its faces were taken away (world/cut.c), and which elements and tethers that severs
 * (world/severed.c). It is made when a body is first cut. */
#ifndef SK_WORLD_CUT_H
#define SK_WORLD_CUT_H

#include "base/bytes.h"
#include "constraints/severed.h"
#include "world/world.h"

/* A particle beside another along an edge. */
typedef struct sk_side {
    uint32_t particle;
    bool left; /* a face that has the edge is not cut */
} sk_side;

struct sk_cut {
    const sk_body *body;
    uint8_t *face; /* of each face, whether it is cut */
    size_t count;  /* of faces that are */
    uint64_t changes;
    uint32_t (*triangle)[3]; /* the body's triangles as they were built: of cut faces the world has one corner thrice */
    /* the surface, by the body's particles, numbered from its first one on */
    size_t *first;      /* of each face its first corner; faces + 1 */
    uint32_t *corner;   /* of all faces */
    size_t *start;      /* of each particle its first face in `around`; particles + 1 */
    uint32_t *around;   /* faces that have it */
    size_t *first_side; /* of each particle its first neighbour along an edge of a face; particles + 1 */
    sk_side *side;      /* of all particles */
    uint32_t *to_cut;   /* so many edges lead from a particle to the nearest corner of a face that is cut */
    /* for searches over particles */
    uint32_t *queue, *mark, now; /* those that were reached have mark `now` */
};

static inline bool sk_is_cut(const sk_body *body, size_t face) {
    return body->cut && body->cut->face[face];
}
void sk_cut_release(sk_cut *cut, sk_allocator *allocator);
/* Takes away (1) or puts back (0) the body's faces as `face` says, or all of them back where it is NULL. False when there
 * is no memory: nothing has changed then. */
bool sk_cut_set(skein_world *world, sk_body *body, const uint8_t *face);
/* Makes what is needed to cut a body, all of it whole, where that was not done yet. False when there is no memory. */
bool sk_cut_begin(skein_world *world, sk_body *body);
/* The triangles that a body was built with. */
const uint32_t (*sk_built_triangles(const skein_world *world, const sk_body *body))[3];
/* Which faces are cut, as bytes. */
void sk_put_cut(sk_byte_writer *w, const sk_body *body);
/* Reads that for a body, and where `apply` is set cuts it so. False where the bytes do not fit the body, with *memory set
 * where there is none. */
bool sk_take_cut(sk_byte_reader *r, skein_world *world, sk_object *object, bool apply, bool *memory);

/* ---- what is severed (severed.c) ---- */

/* Whether an element of one of the body's batches is: some pair of its particles has no face in common any more, or no
 * way along edges as short as it was, or one face had three of its particles and is gone. What has coarse grids loses
 * them, for these would carry movement over a cut. */
bool sk_cut_severs(const void *cut, const sk_batch *batch, const uint32_t *particle);
/* Finds out what sk_cut_severs() is to know of a batch of the body before it is asked for its elements. */
void sk_cut_look_at(sk_cut *cut, sk_batch *batch);
/* What a change of faces changes for searches. */
void sk_cut_find_sides(sk_cut *cut);
/* Finds the lengths of the body's tethers anew. False when there is no memory. */
bool sk_cut_tethers(skein_world *world, sk_body *body);

/* ---- what gives way by itself (tear.c) ---- */

/* Whether a body of the world may tear. */
bool sk_world_tears(const skein_world *world);
/* After a step: takes away the faces along edges that are stretched beyond their body's bound. */
skein_status sk_world_tear(skein_world *world, skein_error *error);

#endif
