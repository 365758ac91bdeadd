/* What the shaders know of a frame, as it lies in the uniform buffer.
 *
 * Filled by draw.c and light.c; mirrored by scene_block and pass_block in shaders/common.glsl (std140:
 * everything here is a multiple of 16 bytes). Colours are linear. */
#ifndef SKEIN_RENDER_SCENE_BLOCK_H
#define SKEIN_RENDER_SCENE_BLOCK_H

#include <stdint.h>

enum { RENDER_BALL_COUNT = 8 };

typedef struct render_scene_block {
    float to_sun[16];
    float eye[4];
    float view_right[4], view_up[4], view_forward[4];
    float sun[4];
    float sun_light[4];
    float zenith[4], horizon[4], ground[4];
    float sun_map[4];
    float under_map[4];
    float middle[4];
    float balls[RENDER_BALL_COUNT][4];
    int32_t counts[4];
    int32_t modes[4];
} render_scene_block;

/* One matrix for each way a frame is gone through. */
typedef enum render_pass { RENDER_PASS_CAMERA, RENDER_PASS_SUN, RENDER_PASS_BELOW, RENDER_PASS_COUNT } render_pass;

/* Uniform buffer ranges start at multiples of 256 bytes, which every driver allows. */
enum { RENDER_PASS_STRIDE = 256, RENDER_SCENE_OFFSET = RENDER_PASS_COUNT * RENDER_PASS_STRIDE };

#endif
