/* One picture after the other; see studio.h. */
#include "render/studio.h"

#include "render/context.h"
#include "render/draw.h"
#include "render/fail.h"
#include "render/target.h"
#include "render/world_frame.h"

#include <epoxy/gl.h>
#include <stdlib.h>

struct render_studio {
    render_context *context;
    render_draw *draw;
    render_target target;
    render_world_frame *frame;
    const render_view *view;
    render_camera camera;
    bool aimed;
    double shot;      /* the last picture, in seconds of the world */
    double middle[3]; /* of the body that the camera goes along with, then */
};

render_studio *render_studio_create(const int32_t size[2], int samples, const render_view *view, skein_error *error) {
    render_studio *studio = calloc(1, sizeof *studio);
    if (!studio) {
        render_fail_memory(error, "the pictures");
        return NULL;
    }
    studio->view = view;
    studio->context = render_context_create(error);
    bool good = studio->context &&
                render_target_create(&studio->target, size[0], size[1], samples, error) == SKEIN_OK &&
                (studio->draw = render_draw_create(error)) != NULL &&
                (studio->frame = render_world_frame_create(error)) != NULL;
    if (good) return studio;
    render_studio_destroy(studio);
    return NULL;
}

void render_studio_destroy(render_studio *studio) {
    if (!studio) return;
    render_world_frame_destroy(studio->frame);
    if (studio->context) {
        render_draw_destroy(studio->draw);
        render_target_destroy(&studio->target);
    }
    render_context_destroy(studio->context);
    free(studio);
}

void render_studio_hold(render_studio *studio, const render_subject *subject) {
    render_world_frame_hold(studio->frame, subject);
}

/* The camera moves as the body does that it follows. */
static void go_along(render_studio *studio) {
    double middle[3];
    if (!render_world_frame_followed(studio->frame, middle)) return;
    for (int k = 0; k < 3; k++) {
        double way = studio->aimed ? middle[k] - studio->middle[k] : 0;
        studio->camera.eye[k] += way, studio->camera.target[k] += way;
        studio->middle[k] = middle[k];
    }
}

skein_status render_studio_shoot(render_studio *studio, skein_world *world, skein_error *error) {
    int width = studio->target.width, height = studio->target.height;
    skein_status status = render_world_frame_update(studio->frame, world, studio->view, error);
    if (status != SKEIN_OK) return status;
    // aimed once: what holds the moment alone would jump as the bodies move
    double now = skein_world_time(world), orbit = studio->view ? studio->view->camera.orbit : 0;
    if (!studio->aimed) studio->camera = render_world_frame_camera(studio->frame, (double)width / height);
    else if (orbit != 0) render_camera_turn(&studio->camera, orbit * (now - studio->shot));
    go_along(studio);
    studio->aimed = true;
    studio->shot = now;
    status = render_draw_frame(studio->draw, render_world_frame_get(studio->frame), &studio->camera,
                               studio->target.framebuffer, width, height, error);
    glFlush();
    return status;
}

skein_status render_studio_develop(render_studio *studio, render_image *image, skein_error *error) {
    skein_status status = render_target_read(&studio->target, image, error);
    const render_messages *messages = render_context_messages(studio->context);
    if (status != SKEIN_OK || messages->errors == 0) return status;
    return render_fail(error, SKEIN_ERROR_VALUE, render_context_name(studio->context), "the OpenGL driver says: %s",
                       messages->last);
}

int render_studio_samples(const render_studio *studio) {
    return studio->target.samples;
}
