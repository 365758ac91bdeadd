/* One picture of a world; see picture.h. */
#include "render/picture.h"

#include "render/context.h"
#include "render/draw.h"
#include "render/fail.h"
#include "render/target.h"
#include "render/world_frame.h"

#include <stddef.h>

/* ---- The exporter --------------------------------------------------------------------------- */

static const skein_field png_fields[] = {
    {.name = "size",
     .type = SKEIN_FIELD_INT2,
     .offset = offsetof(render_picture_options, size),
     .unit = "pixels",
     .initial = {1280, 720},
     .least = 1,
     .most = 16384,
     .help = "width and height of the picture"},
    {.name = "samples",
     .type = SKEIN_FIELD_INT,
     .offset = offsetof(render_picture_options, samples),
     .unit = "",
     .initial = {4},
     .least = 1,
     .most = 64,
     .help = "samples a pixel for smooth edges, or the most the driver has"},
};

static const skein_kind png = {
    .name = "png",
    .help = "a picture of the last frame, drawn with OpenGL 4.5; needs no display",
    .category = SKEIN_EXPORTER,
    .fields = png_fields,
    .field_count = sizeof png_fields / sizeof *png_fields,
    .params_size = sizeof(render_picture_options),
};

const skein_kind *render_exporter_at(size_t index) {
    return index == 0 ? &png : NULL;
}

render_picture_options render_default_picture_options(void) {
    return (render_picture_options){
        .size = {(int32_t)png_fields[0].initial[0], (int32_t)png_fields[0].initial[1]},
        .samples = (int32_t)png_fields[1].initial[0],
    };
}

/* ---- The picture ---------------------------------------------------------------------------- */

/* Draws into an image, with a context that is current. */
static skein_status draw_image(skein_world *world, const render_picture_options *options, const render_view *view,
                               render_image *image, skein_error *error) {
    int width = options->size[0], height = options->size[1];
    render_target target = {0};
    skein_status status = render_target_create(&target, width, height, options->samples, error);
    if (status != SKEIN_OK) return status;

    render_draw *draw = render_draw_create(error);
    render_world_frame *frame = draw ? render_world_frame_create(error) : NULL;
    status = frame ? render_world_frame_update(frame, world, view, error) : SKEIN_ERROR_VALUE;
    if (status == SKEIN_OK) {
        render_world_frame_settle(frame);
        render_camera camera = render_world_frame_camera(frame, (double)width / height);
        status =
            render_draw_frame(draw, render_world_frame_get(frame), &camera, target.framebuffer, width, height, error);
    }
    if (status == SKEIN_OK) status = render_target_read(&target, image, error);
    render_world_frame_destroy(frame);
    render_draw_destroy(draw);
    render_target_destroy(&target);
    return status;
}

skein_status render_picture(skein_world *world, const char *path, const render_picture_options *options,
                            const render_view *view, skein_error *error) {
    render_picture_options standard = render_default_picture_options();
    render_image image = {0};
    render_context *context = render_context_create(error);
    if (!context) return SKEIN_ERROR_VALUE;

    skein_status status = draw_image(world, options ? options : &standard, view, &image, error);
    const render_messages *messages = render_context_messages(context);
    if (status == SKEIN_OK && messages->errors > 0) {
        status = render_fail(error, SKEIN_ERROR_VALUE, render_context_name(context), "the OpenGL driver says: %s",
                             messages->last);
    }
    render_context_destroy(context);
    if (status == SKEIN_OK) status = render_image_write_png(&image, path, error);
    render_image_release(&image);
    return status;
}
