/* Colours that stand for numbers; see colours.h. */
#include "render/colours.h"

#include <math.h>

enum { STOPS = 9 };

static const unsigned char stops[RENDER_COLOUR_MAP_COUNT][STOPS][3] = {
    {{68, 1, 84},
     {71, 44, 122},
     {59, 81, 139},
     {44, 113, 142},
     {33, 144, 141},
     {39, 173, 129},
     {92, 200, 99},
     {170, 220, 50},
     {253, 231, 37}},
    {{59, 76, 192},
     {98, 130, 234},
     {141, 176, 254},
     {184, 208, 249},
     {221, 221, 221},
     {245, 196, 173},
     {244, 154, 123},
     {222, 96, 77},
     {180, 4, 38}},
};

void render_map_colour(render_colour_map map, double place, float colour[3]) {
    double at = (place > 0 ? fmin(place, 1) : 0) * (STOPS - 1);
    int stop = (int)fmin(at, STOPS - 2);
    for (int k = 0; k < 3; k++) {
        const unsigned char low = stops[map][stop][k], high = stops[map][stop + 1][k];
        colour[k] = (float)((low + (at - stop) * (high - low)) / 255);
    }
}

void render_to_light(const float colour[3], float strength, float out[3]) {
    for (int i = 0; i < 3; i++) {
        float c = colour[i];
        out[i] = strength * (c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f));
    }
}
