/* Colours that stand for numbers.
 *
 * Two maps, both even to the eye and safe for the colour blind: one from little to much (viridis, by van der Walt and
 * Smith), one from less over nothing to more (blue, pale, red; after Moreland). */
#ifndef SKEIN_RENDER_COLOURS_H
#define SKEIN_RENDER_COLOURS_H

typedef enum render_colour_map {
    RENDER_LITTLE_TO_MUCH,
    RENDER_LESS_TO_MORE,
    RENDER_COLOUR_MAP_COUNT
} render_colour_map;

/* The colour (sRGB) at `place` of a map, 0 to 1; what is beyond or not a number counts as the nearest end or 0. */
void render_map_colour(render_colour_map map, double place, float colour[3]);

/* Light, as sRGB defines it, of a colour that a screen shows; times `strength`. */
void render_to_light(const float colour[3], float strength, float out[3]);

#endif
