/* What is drawn about a flock besides its birds: predators with their reach, and of one chosen bird the zones of the
 * rules that steer it, and the neighbours that count.
 *
 * Called by world_frame.c. Kinds are known by their fields: a predator has a line, a position and a radius; a rule of
 * flocking has separation, alignment and cohesion. */
#ifndef SKEIN_RENDER_WORLD_FLOCK_H
#define SKEIN_RENDER_WORLD_FLOCK_H

#include "render/world_birds.h"
#include "render/world_lines.h"

/* The outer radii (m) of a rule's zones: separation, alignment, cohesion. False where the force has no such zones, or is
 * off. */
bool render_flock_zones(const skein_world *world, skein_handle force, double radii[3]);

/* Three circles around the chosen particle for each rule, and a line to each neighbour in the zone's colour: red for
 * separation, green for alignment, blue for cohesion. Who is seen, and the nearest few, are as the rule has them. */
void render_add_zones(render_world_lines *lines, skein_world *world, const render_world_state *state, uint32_t chosen);

/* Each predator that is on: a dark bird, larger than others, where it is; and circles as far as it is feared. One that
 * is a line of sight is shown where the line passes the first flock. False where there is no memory. */
bool render_add_predators(render_world_birds *birds, render_world_lines *lines, skein_world *world,
                          const render_world_state *state);
/* Whether one of them is a particle, whose place has to be known. */
bool render_has_flying_predator(const skein_world *world);

#endif
