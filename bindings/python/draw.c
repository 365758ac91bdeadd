/* Pictures for Python, in a library of its own: it is loaded when the first picture is asked for, since it wants OpenGL
 * (libepoxy), which the rest of the package does without. skein/_pictures.py is the only caller.
 *
 *     world, view --py_draw--> width x height x 3 bytes
 *
 * It knows worlds by the public header alone, whose calls are those of the package's libskein.so. py_draw() makes a
 * context of its own and leaves nothing behind, so any thread may ask for pictures. A film's pictures are a studio's,
 * whose context is current on the thread that made it, where all its calls belong. */
#include <string.h>

#include "render/context.h"
#include "render/draw.h"
#include "render/fail.h"
#include "render/studio.h"
#include "render/target.h"
#include "render/view.h"
#include "render/world_frame.h"

#define EXPORT __attribute__((visibility("default")))

EXPORT skein_status py_draw(skein_world *world, const void *view, const int32_t size[2], int samples, uint8_t *pixels,
                            skein_error *error);

/* Draws into an image, in a context that is current. */
static skein_status draw_image(skein_world *world, const render_view *view, const int32_t size[2], int samples,
                               render_image *image, skein_error *error) {
    render_target target = {0};
    skein_status status = render_target_create(&target, size[0], size[1], samples, error);
    if (status) return status;
    render_draw *draw = render_draw_create(error);
    render_world_frame *frame = draw ? render_world_frame_create(error) : NULL;
    status = frame ? render_world_frame_update(frame, world, view, error) : SKEIN_ERROR_VALUE;
    if (!status) {
        render_world_frame_settle(frame);
        render_camera camera = render_world_frame_camera(frame, (double)size[0] / size[1]);
        status = render_draw_frame(draw, render_world_frame_get(frame), &camera, target.framebuffer, size[0], size[1],
                                   error);
    }
    if (!status) status = render_target_read(&target, image, error);
    render_world_frame_destroy(frame);
    render_draw_destroy(draw);
    render_target_destroy(&target);
    return status;
}

/* Draws a world as it stands. `view` is a render_view or NULL (the usual one); `pixels` has room for three bytes a pixel,
 * rows from the top, sRGB. */
skein_status py_draw(skein_world *world, const void *view, const int32_t size[2], int samples, uint8_t *pixels,
                     skein_error *error) {
    render_image image = {0};
    render_context *context = render_context_create(error);
    if (!context) return SKEIN_ERROR_VALUE;
    skein_status status = draw_image(world, view, size, samples, &image, error);
    const render_messages *messages = render_context_messages(context);
    if (!status && messages->errors > 0)
        status = render_fail(error, SKEIN_ERROR_VALUE, render_context_name(context), "the OpenGL driver says: %s",
                             messages->last);
    if (!status) memcpy(pixels, image.pixels, 3 * (size_t)size[0] * (size_t)size[1]);
    render_context_destroy(context);
    render_image_release(&image);
    return status;
}

/* ---- films ---- */

EXPORT render_studio *py_studio_create(const int32_t size[2], int samples, const void *view, skein_error *error);
EXPORT skein_status py_studio_draw(render_studio *studio, skein_world *world, uint8_t *pixels, size_t pixel_count,
                                   skein_error *error);
EXPORT void py_studio_destroy(render_studio *studio);

/* What makes many pictures, with a camera that stays where it is at the first. The view outlives it. */
render_studio *py_studio_create(const int32_t size[2], int samples, const void *view, skein_error *error) {
    return render_studio_create(size, samples, view, error);
}

/* The next picture, as py_draw() has it. */
skein_status py_studio_draw(render_studio *studio, skein_world *world, uint8_t *pixels, size_t pixel_count,
                            skein_error *error) {
    render_image image = {0};
    skein_status status = render_studio_shoot(studio, world, error);
    if (!status) status = render_studio_develop(studio, &image, error);
    if (!status) memcpy(pixels, image.pixels, 3 * pixel_count);
    render_image_release(&image);
    return status;
}

void py_studio_destroy(render_studio *studio) {
    render_studio_destroy(studio);
}
