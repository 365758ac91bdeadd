/* What is read out of a world for one picture: where everything is, and the numbers that colours and lines tell.
 *
 * Called by world_frame.c. Reads only what the view asks for; its arrays grow and stay. */
#ifndef SKEIN_RENDER_WORLD_STATE_H
#define SKEIN_RENDER_WORLD_STATE_H

#include "render/colours.h"
#include "render/view.h"

/* How a particle is shown: by itself, as part of a surface, or not at all. */
enum { RENDER_LOOSE, RENDER_IN_SURFACE, RENDER_HIDDEN };

typedef struct render_world_state {
    size_t particle_count, spring_count, contact_count;
    double *positions;
    double *velocities;      /* only where colours or lines tell them */
    skein_spring *springs;   /* only where they are drawn or colours tell strain */
    skein_contact *contacts; /* only where they are drawn */
    float *values;           /* by particle, 0 to 1: its place in the map; where colours tell speed or strain */
    render_colour_map map;
    double range;         /* the speed or strain that the end of the map stands for; 0: none */
    double spring_range;  /* and for springs */
    unsigned char *shown; /* by particle: how; for the one who reads to fill in */
    uint32_t *body;       /* by particle: the place of its body, UINT32_MAX for none; likewise */
    float *weights;       /* by particle: springs that count in its strain */
    size_t particle_room, spring_room, contact_room;
} render_world_state;

/* Start from {0}. Positions are those between the last two steps where `blend` is under 1 (0: before the last step). */
skein_status render_world_state_read(render_world_state *state, skein_world *world, const render_view *view,
                                     double blend, skein_error *error);
void render_world_state_release(render_world_state *state);

/* The colour (sRGB) of a strain, or of a particle by the state's values. */
void render_strain_colour(const render_world_state *state, double strain, float colour[3]);
void render_particle_colour(const render_world_state *state, size_t particle, float colour[3]);

#endif
