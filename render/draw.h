/* Drawing a frame with OpenGL 4.5, into whatever framebuffer is given: offscreen or a window's.
 *
 *     frame --bring--> meshes, instances --sun, below--> light maps --camera--> picture
 *
 * Called by picture.c, by films and by the window. Needs a current context; makes its resources once
 * and uses them again for every frame. It sets all OpenGL state that it relies on, and gives the
 * clip control back as OpenGL has it at first. */
#ifndef SKEIN_RENDER_DRAW_H
#define SKEIN_RENDER_DRAW_H

#include "render/camera.h"
#include "render/frame.h"
#include "skein/skein.h"

typedef struct render_draw render_draw;

/* NULL on failure: `error` holds the reason, such as a shader that the driver refuses. */
render_draw *render_draw_create(skein_error *error);
void render_draw_destroy(render_draw *draw); /* NULL is allowed; the context must be current */

/* Draws so many triangles at a time, and waits until they are there (0, as at first: all at once). A driver takes what
 * several contexts ask for one after the other: in between, another one gets its turn. */
void render_draw_in_parts(render_draw *draw, size_t triangles);

/* Pictures that will be enlarged or made smaller: lines are so many times as wide (1, as at first). */
void render_draw_line_scale(render_draw *draw, double scale);

/* Draws a frame into a framebuffer that has sRGB colour and float depth (see target.h). */
skein_status render_draw_frame(render_draw *draw, const render_frame *frame, const render_camera *camera,
                               unsigned framebuffer, int width, int height, skein_error *error);

#endif
