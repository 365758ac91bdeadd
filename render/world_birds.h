/* The birds of a picture: bodies that are flocks.
 *
 * Called by world_frame.c. Where the world's steps are computed in the OpenGL context that draws, birds are drawn from
 * its buffers, and their numbers stay on the card. */
#ifndef SKEIN_RENDER_WORLD_BIRDS_H
#define SKEIN_RENDER_WORLD_BIRDS_H

#include "render/frame.h"
#include "render/world_state.h"

/* Start from {0}. */
typedef struct render_world_birds {
    render_birds *birds;
    size_t *body; /* by flock: the place of its body; SIZE_MAX for a predator */
    size_t count, room;
    float *numbers; /* positions, then velocities, of all that are not on the card; 4 floats each */
    size_t number_room, number_count;
} render_world_birds;

/* Whether a body is drawn as birds under a view; NULL: under any that shows birds. */
bool render_are_birds(const skein_world *world, skein_handle body, const render_view *view);
/* Adds a flock; `index` is the body's place. False where there is no memory. */
bool render_add_birds(render_world_birds *all, const skein_world *world, const render_world_state *state,
                      const skein_surface *surface, size_t index);
/* Adds a predator: one dark bird, larger than the others. The camera makes no room for it. False where there is no
 * memory. */
bool render_add_predator_bird(render_world_birds *all, const double at[3], const double velocity[3]);
/* All that were added go into the frame, coloured up to this range of speeds if that is what tells; and then get a size that suits a scene of this radius. */
void render_world_birds_show(render_world_birds *all, const render_view *view, double range, render_frame *frame);
void render_world_birds_size(render_world_birds *all, const render_view *view, double radius);
void render_world_birds_clear(render_world_birds *all);
void render_world_birds_release(render_world_birds *all);

#endif
