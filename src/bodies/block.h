/* A block of n x m x l particles, the last index fastest: what lattices and ropes are made of.
 *
 * The builder that owns it fills in the first four members, calls sk_block_begin, sets the particles' positions, and
 * calls the other functions in this order. All of it is scratch except the surface, which goes to the body. */
#ifndef SK_BODIES_BLOCK_H
#define SK_BODIES_BLOCK_H

#include "world/world.h"

typedef struct sk_block {
    skein_world *world;
    sk_body *body;
    skein_error *error;
    uint32_t size[3]; /* particles along each axis; 1 or more */
    size_t count;
    double (*position)[3];
    bool *pinned;
} sk_block;

/* Springs from every particle to the one `step` away, where there is one. The first step that is not 0 is positive. */
typedef struct sk_block_springs {
    int32_t step[3];
    double rest, scale; /* of each */
} sk_block_springs;

skein_status sk_block_begin(sk_block *block);
void sk_block_release(sk_block *block);
/* Adds the particles: `mass` is of all, shared out equally. Those that `pins` names (in words of the builder's own,
 * besides numbers and shapes) are pinned; the others begin with the velocity. */
skein_status sk_block_add_particles(sk_block *block, double mass, const double velocity[3], const char *pins,
                                    skein_status (*choose_words)(void *block, const char *words));
/* Adds one batch of springs, direction by direction; steps that lead nowhere in this block add none. */
skein_status sk_block_add_springs(sk_block *block, const char *label, sk_material material, bool measured,
                                  const sk_block_springs *springs, size_t count);
/* Lays the particles in strips: rows along the first index, or all in one row where the others are few. */
skein_status sk_block_add_strips(sk_block *block);
/* The outer faces as quads that look outward, for drawing, export and forces on areas. */
skein_status sk_block_add_surface(sk_block *block);

/* The words of each kind of block: they mark in `pinned`, and need size, count and error besides. */
skein_status sk_lattice_choose_words(void *block, const char *words);
skein_status sk_rope_choose_words(void *block, const char *words);

#endif
