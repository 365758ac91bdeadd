/* Constraints of a picture: lines through their particles, and their gradients as arrows.
 *
 * Called by world_frame.c, after particles have their size. */
#ifndef SKEIN_RENDER_WORLD_CONSTRAINTS_H
#define SKEIN_RENDER_WORLD_CONSTRAINTS_H

#include "render/world_lines.h"

/* A constraint that is pointed at: it is drawn whatever the view shows, with its gradient. */
typedef struct render_chosen {
    bool any;
    skein_handle object;
    size_t index; /* as skein_constraint_evaluate() takes it */
} render_chosen;

/* Adds what the view shows of a world's constraints, in a picture of that radius; arrows begin `off` metres away from
 * their particles, so that balls do not hide them. Fails where values cannot be had. */
skein_status render_take_constraints(render_world_lines *lines, const render_world_state *state, skein_world *world,
                                     const render_view *view, const render_chosen *chosen, double radius, double off,
                                     skein_error *error);

#endif
