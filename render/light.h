/* The sun's shadow map, and the map of how much sky the ground sees.
 *
 *          sun \ \ \                     two maps, made anew every frame:
 *               \ o \  things            sun:   depth of the things, seen from the sun
 *      __________\_\_\______ ground      below: their undersides, seen from the ground, which
 *                 ^ ^ ^                         under.frag.glsl turns into light on the ground
 *
 * Called by draw.c, which draws the things into both. Textures stay bound for all that is lit:
 * unit 0 the sun's map with comparison, 1 the same as plain depth, 2 the light on the ground. */
#ifndef SKEIN_RENDER_LIGHT_H
#define SKEIN_RENDER_LIGHT_H

#include "render/frame.h"
#include "render/scene_block.h"
#include "skein/skein.h"

typedef struct render_light {
    unsigned sun_framebuffer, sun_depth, compare_sampler;
    unsigned below_framebuffer, below_depth;
    unsigned under_framebuffer, under_light, under_program;
    unsigned no_arrays;
    double under_side, under_height; /* metres that the map covers, set by render_light_aim() */
    bool has_sun, has_under;
} render_light;

/* Start from {0}; the OpenGL context must be current. Destroy it even when this failed. */
skein_status render_light_create(render_light *light, skein_error *error);
void render_light_destroy(render_light *light);

/* Fits both maps to what casts shadows. Fills to_sun, sun_map and under_map of the block, and the
 * matrices of both passes (columns; depth 0 to 1). `ground` is NULL where there is no ground. */
void render_light_aim(render_light *light, const double sun[3], double spread, const render_bounds *casters,
                      const double *ground, render_scene_block *block, double sun_clip[16], double below_clip[16]);

/* Between begin and end draw.c draws all casters; false where there is nothing to draw for. */
bool render_light_begin_sun(const render_light *light);
bool render_light_begin_below(const render_light *light);
void render_light_end_below(const render_light *light);
/* Binds the three textures. */
void render_light_bind(const render_light *light);

#endif
