/* The stage's pictures: one world, or two beside each other, drawn into buffers that the window shows.
 *
 *     players --> targets (several samples a pixel) --> one of four pictures --> window
 *
 * Four pictures go round: the one that the window has, the one that it may take next, the stage's newest, and the one
 * that is being drawn. */
#include <string.h>

#include <epoxy/gl.h>

#include "viewer/stage.h"

/* A picture that takes so long is drawn in parts: of so many triangles, some milliseconds' worth without a card. */
static const double long_ms = 25;
enum { part_of_picture = 4096 };

int viewer_side_width(const viewer_stage *stage, size_t side, int *x) {
    size_t count = stage->side_count ? stage->side_count : 1;
    int left = (int)((size_t)stage->width * side / count), right = (int)((size_t)stage->width * (side + 1) / count);
    *x = left;
    return right - left;
}

bool viewer_pictures_open(viewer_stage *stage, skein_error *error) {
    render_messages_attach(&stage->messages);
    stage->draw = render_draw_create(error);
    if (!stage->draw) return false;
    glCreateFramebuffers(1, &stage->framebuffer);
    stage->newest = -1;
    return true;
}

static void drop_pictures(viewer_stage *stage) {
    for (size_t s = 0; s < VIEWER_SIDES; s++) render_target_destroy(&stage->target[s]);
    glDeleteRenderbuffers(VIEWER_PICTURES, stage->pictures);
    memset(stage->pictures, 0, sizeof stage->pictures);
    stage->newest = -1;
}

void viewer_pictures_close(viewer_stage *stage) {
    drop_pictures(stage);
    glDeleteFramebuffers(1, &stage->framebuffer);
    render_draw_destroy(stage->draw);
}

bool viewer_pictures_size(viewer_stage *stage, int width, int height) {
    bool same = stage->width == width && stage->height == height && stage->newest >= -1 && stage->pictures[0];
    for (size_t s = 0; s < stage->side_count && same; s++) {
        int left;
        same = stage->target[s].width == viewer_side_width(stage, s, &left);
    }
    if (same && (stage->side_count || !stage->target[0].framebuffer)) return true;
    viewer_exchange *exchange = stage->exchange;
    // the window lets go of the old ones first
    pthread_mutex_lock(&exchange->lock);
    exchange->shown.newest = -1;
    exchange->shown.generation = ++stage->generation;
    pthread_mutex_unlock(&exchange->lock);
    drop_pictures(stage);
    stage->width = width, stage->height = height;
    skein_error error = {SKEIN_OK, "", ""};
    for (size_t s = 0; s < stage->side_count; s++) {
        int left, wide = viewer_side_width(stage, s, &left);
        if (render_target_create(&stage->target[s], wide, height, stage->options->samples, &error)) {
            viewer_say(stage, SKEIN_LOG_WARNING, "%s", error.message);
            return false;
        }
    }
    glCreateRenderbuffers(VIEWER_PICTURES, stage->pictures);
    for (int p = 0; p < VIEWER_PICTURES; p++)
        glNamedRenderbufferStorage(stage->pictures[p], GL_SRGB8_ALPHA8, width, height);
    glFinish();
    return true;
}

static bool draw_side(viewer_stage *stage, size_t side) {
    viewer_player *player = &stage->sides[side];
    skein_error error = {SKEIN_OK, "", ""};
    const render_target *target = &stage->target[side];
    bool between = !stage->paused && !viewer_stage_by_key(stage) && !stage->film;
    render_world_frame_blend(player->picture, between ? skein_pacer_blend(&stage->pacer) : 1);
    skein_status status = render_world_frame_update(player->picture, player->world, &player->view, &error);
    if (!status && side == 0 && (!stage->camera.placed || (player->view.camera.orbit != 0 && !stage->camera.moved))) {
        render_camera home = render_world_frame_camera(player->picture, (double)target->width / target->height);
        render_bounds bounds = render_frame_bounds(render_world_frame_get(player->picture));
        viewer_camera_place(&stage->camera, &home, render_bounds_radius(&bounds));
    }
    if (!status)
        status = render_draw_frame(stage->draw, render_world_frame_get(player->picture), &stage->camera.lens,
                                   target->framebuffer, target->width, target->height, &error);
    if (status) viewer_say(stage, SKEIN_LOG_WARNING, "%s", error.message);
    return !status;
}

/* A place that the window neither has nor may take, and that is not the newest. */
static int free_place(viewer_stage *stage) {
    pthread_mutex_lock(&stage->exchange->lock);
    int in_use = stage->exchange->shown.in_use, offered = stage->exchange->shown.newest;
    pthread_mutex_unlock(&stage->exchange->lock);
    int place = 0;
    while (place == in_use || place == offered || place == stage->newest) place++;
    return place;
}

bool viewer_draw(viewer_stage *stage) {
    if (!viewer_pictures_size(stage, stage->wide > 0 ? stage->wide : 1, stage->tall > 0 ? stage->tall : 1))
        return false;
    double start = viewer_seconds();
    // where that takes long, the window's panels are drawn in between
    render_draw_in_parts(stage->draw, stage->in_parts ? part_of_picture : 0);
    for (size_t s = 0; s < stage->side_count; s++)
        if (!draw_side(stage, s)) return false;
    int place = free_place(stage), height = stage->height;
    static const float dark[4] = {0.02f, 0.022f, 0.026f, 1};
    glNamedFramebufferRenderbuffer(stage->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, stage->pictures[place]);
    glEnable(GL_FRAMEBUFFER_SRGB);
    if (!stage->side_count) glClearNamedFramebufferfv(stage->framebuffer, GL_COLOR, 0, dark);
    for (size_t s = 0; s < stage->side_count; s++) {
        // samples are averaged at the target's own size; then the result goes to its place
        const render_target *target = &stage->target[s];
        int left, width = viewer_side_width(stage, s, &left);
        glBlitNamedFramebuffer(target->framebuffer, target->plain_framebuffer, 0, 0, width, height, 0, 0, width, height,
                               GL_COLOR_BUFFER_BIT, GL_NEAREST);
        glBlitNamedFramebuffer(target->plain_framebuffer, stage->framebuffer, 0, 0, width, height, left, 0,
                               left + width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    glFinish(); // the other context sees what is finished
    stage->draw_ms = 1e3 * (viewer_seconds() - start);
    stage->in_parts = stage->draw_ms > long_ms;
    stage->newest = place;
    return true;
}

bool viewer_picture_read(viewer_stage *stage, render_image *image) {
    skein_error error = {SKEIN_OK, "", ""};
    if ((stage->newest < 0 || stage->dirty) && !viewer_draw(stage)) return false;
    if (render_image_resize(image, stage->width, stage->height, &error)) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s", error.message);
        return false;
    }
    // one row after the other: OpenGL's begin at the bottom
    glNamedFramebufferRenderbuffer(stage->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                   stage->pictures[stage->newest]);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, stage->framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < stage->height; y++)
        glReadPixels(0, stage->height - 1 - y, stage->width, 1, GL_RGB, GL_UNSIGNED_BYTE,
                     image->pixels + 3 * (size_t)y * (size_t)stage->width);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    return true;
}
