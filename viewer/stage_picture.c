/* The stage's pictures: one world, or two beside each other, drawn into buffers that the window shows.
 *
 *     worlds --viewer_take_frames--> frames --painter--> targets (several samples a pixel) --> one of four pictures
 *
 * Four pictures go round: the one that the window has, the one that it may take next, the newest, and the one that is
 * being drawn. While things move and pictures take long, they are drawn smaller and enlarged (pace.h). Functions that
 * begin with paint run on the painter's thread. */
#include <math.h>
#include <string.h>

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "render/fail.h"
#include "viewer/stage.h"

/* A picture that takes so long is drawn in parts: of so many triangles, some milliseconds' worth without a card. */
static const double long_ms = 25;
enum { part_of_picture = 4096 };

/* The part of a width that a side has. */
static int part_of_width(int width, size_t count, size_t side, int *x) {
    int left = (int)((size_t)width * side / count), right = (int)((size_t)width * (side + 1) / count);
    *x = left;
    return right - left;
}

int viewer_side_width(const viewer_stage *stage, size_t side, int *x) {
    return part_of_width(stage->width, stage->side_count ? stage->side_count : 1, side, x);
}

double viewer_aspect(const viewer_stage *stage) {
    int left, width = viewer_side_width(stage, 0, &left);
    return (double)width / (stage->height > 0 ? stage->height : 1);
}

/* ---- Opening and closing ---- */

static void paint_open(void *user) {
    viewer_stage *stage = user;
    glfwMakeContextCurrent(stage->context);
    render_messages_attach(&stage->messages);
    stage->draw = render_draw_create(&stage->picture.error);
    if (!stage->draw) return;
    glCreateFramebuffers(1, &stage->framebuffer);
    stage->newest = -1;
}

bool viewer_pictures_open(viewer_stage *stage, skein_error *error) {
    if (!viewer_painter_start(&stage->painter, stage->exchange)) {
        render_fail(error, SKEIN_ERROR_MEMORY, "window", "no thread can be started");
        return false;
    }
    viewer_painter_do(&stage->painter, paint_open, stage);
    if (stage->picture.error.status) *error = stage->picture.error;
    return stage->draw != NULL;
}

static void drop_pictures(viewer_stage *stage) {
    for (size_t s = 0; s < VIEWER_SIDES; s++) {
        render_target_destroy(&stage->target[s]);
        render_target_destroy(&stage->coarse[s]);
    }
    stage->coarse_level = 0;
    glDeleteRenderbuffers(VIEWER_PICTURES, stage->pictures);
    memset(stage->pictures, 0, sizeof stage->pictures);
    stage->newest = -1;
}

static void paint_close(void *user) {
    viewer_stage *stage = user;
    drop_pictures(stage);
    glDeleteFramebuffers(1, &stage->framebuffer);
    render_draw_destroy(stage->draw);
    stage->draw = NULL;
    glfwMakeContextCurrent(NULL);
}

void viewer_pictures_close(viewer_stage *stage) {
    if (!stage->painter.exchange) return; // it never began
    viewer_painter_do(&stage->painter, paint_close, stage);
    viewer_painter_stop(&stage->painter);
    for (size_t s = 0; s < VIEWER_SIDES; s++) render_world_frame_destroy(stage->frames[s]);
}

/* ---- Painting ---- */

/* Makes the pictures and their targets as large as is asked. */
static skein_status paint_size(viewer_stage *stage) {
    viewer_picture *picture = &stage->picture;
    int width = picture->width, height = picture->height;
    bool same = stage->drawn_width == width && stage->drawn_height == height && stage->pictures[0];
    for (size_t s = 0; s < picture->side_count && same; s++) {
        int left;
        same = stage->target[s].width == part_of_width(width, picture->side_count, s, &left);
    }
    if (same && (picture->side_count || !stage->target[0].framebuffer)) return SKEIN_OK;
    viewer_exchange *exchange = stage->exchange;
    // the window lets go of the old ones first
    pthread_mutex_lock(&exchange->lock);
    exchange->shown.newest = -1;
    exchange->shown.generation = ++stage->generation;
    pthread_mutex_unlock(&exchange->lock);
    drop_pictures(stage);
    stage->drawn_width = width, stage->drawn_height = height;
    for (size_t s = 0; s < picture->side_count; s++) {
        int left, wide = part_of_width(width, picture->side_count, s, &left);
        skein_status status =
            render_target_create(&stage->target[s], wide, height, stage->options->samples, &picture->error);
        if (status) return status;
    }
    glCreateRenderbuffers(VIEWER_PICTURES, stage->pictures);
    for (int p = 0; p < VIEWER_PICTURES; p++)
        glNamedRenderbufferStorage(stage->pictures[p], GL_SRGB8_ALPHA8, width, height);
    glFinish();
    return SKEIN_OK;
}

/* The target that a side is drawn to; NULL after a fault. */
static const render_target *paint_target(viewer_stage *stage, size_t side) {
    viewer_picture *picture = &stage->picture;
    if (picture->level == 0) return &stage->target[side];
    viewer_detail detail = viewer_detail_at(picture->level);
    for (size_t s = 0; s < VIEWER_SIDES && stage->coarse_level != picture->level; s++)
        render_target_destroy(&stage->coarse[s]);
    stage->coarse_level = picture->level;
    render_target *target = &stage->coarse[side];
    if (target->framebuffer) return target;
    int width = (int)fmax(detail.scale * stage->target[side].width, 1),
        height = (int)fmax(detail.scale * stage->target[side].height, 1);
    return render_target_create(target, width, height, detail.sampled ? stage->options->samples : 1, &picture->error)
               ? NULL
               : target;
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

/* The sides' targets into one picture: samples are averaged at a target's own size; then the result goes to its
 * place. */
static void paint_together(const viewer_stage *stage, int place) {
    static const float dark[4] = {0.02f, 0.022f, 0.026f, 1};
    const viewer_picture *picture = &stage->picture;
    int height = picture->height;
    glNamedFramebufferRenderbuffer(stage->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, stage->pictures[place]);
    glEnable(GL_FRAMEBUFFER_SRGB);
    if (!picture->side_count) glClearNamedFramebufferfv(stage->framebuffer, GL_COLOR, 0, dark);
    for (size_t s = 0; s < picture->side_count; s++) {
        const render_target *target = picture->level ? &stage->coarse[s] : &stage->target[s];
        unsigned from = target->framebuffer;
        int left, width = part_of_width(picture->width, picture->side_count, s, &left);
        bool same = target->width == width && target->height == height;
        glEnable(GL_FRAMEBUFFER_SRGB);
        if (target->samples > 1) {
            glBlitNamedFramebuffer(target->framebuffer, target->plain_framebuffer, 0, 0, target->width, target->height,
                                   0, 0, target->width, target->height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
            from = target->plain_framebuffer;
        }
        glDisable(GL_FRAMEBUFFER_SRGB); // what follows are bytes
        glBlitNamedFramebuffer(from, stage->framebuffer, 0, 0, target->width, target->height, left, 0, left + width,
                               height, GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
    }
    glFinish(); // the other context sees what is finished
}

/* Offers the newest picture to the window. */
static void paint_offer(viewer_stage *stage, int place) {
    viewer_exchange *exchange = stage->exchange;
    stage->newest = place;
    pthread_mutex_lock(&exchange->lock);
    viewer_shown *shown = &exchange->shown;
    memcpy(shown->pictures, stage->pictures, sizeof shown->pictures);
    shown->width = stage->drawn_width, shown->height = stage->drawn_height;
    shown->generation = stage->generation;
    shown->newest = place;
    pthread_mutex_unlock(&exchange->lock);
    if (exchange->wake) exchange->wake();
}

static void paint(void *user) {
    viewer_stage *stage = user;
    viewer_picture *picture = &stage->picture;
    double start = viewer_seconds();
    skein_status status = paint_size(stage);
    // where that takes long, the window's panels are drawn in between
    render_draw_in_parts(stage->draw, stage->in_parts ? part_of_picture : 0);
    render_draw_line_scale(stage->draw, viewer_detail_at(picture->level).scale);
    for (size_t s = 0; s < picture->side_count && !status; s++) {
        const render_target *target = paint_target(stage, s);
        if (target)
            status = render_draw_frame(stage->draw, render_world_frame_get(stage->frames[s]), &picture->lens,
                                       target->framebuffer, target->width, target->height, &picture->error);
        else status = picture->error.status;
    }
    picture->ready = true;
    if (status) return;
    int place = free_place(stage);
    paint_together(stage, place);
    picture->ms = 1e3 * (viewer_seconds() - start);
    stage->in_parts = picture->ms > long_ms;
    paint_offer(stage, place);
}

/* ---- What is to be painted ---- */

/* The frame of a side's world: a new one for a new world. */
static render_world_frame *frame_of(viewer_stage *stage, size_t side, skein_error *error) {
    const viewer_player *player = &stage->sides[side];
    if (stage->frames[side] && stage->framed[side] == player->opened) return stage->frames[side];
    render_world_frame_destroy(stage->frames[side]);
    stage->framed[side] = player->opened;
    return stage->frames[side] = render_world_frame_create(error);
}

static skein_status take_frame(viewer_stage *stage, size_t side, skein_error *error) {
    viewer_player *player = &stage->sides[side];
    render_world_frame *frame = frame_of(stage, side, error);
    if (!frame) return SKEIN_ERROR_MEMORY;
    bool between = !stage->paused && !viewer_stage_by_key(stage) && !stage->film && !stage->due;
    render_world_frame_blend(frame, between ? skein_pacer_blend(&stage->pacer) : 1);
    const render_chosen chosen = viewer_lesson_chosen(stage), nothing = {.any = false};
    render_world_frame_choose(frame, side ? &nothing : &chosen);
    render_world_frame_choose_bird(frame, side == 0 && stage->ride.chosen ? stage->ride.bird : UINT32_MAX);
    skein_status status = render_world_frame_update(frame, player->world, &player->view, error);
    if (status || side) return status;
    double now = skein_world_time(player->world), middle[3];
    viewer_camera *camera = &stage->camera;
    if (!camera->placed) {
        render_camera home = render_world_frame_camera(frame, viewer_aspect(stage));
        render_bounds bounds = render_frame_bounds(render_world_frame_get(frame));
        render_world_frame_middle(frame, middle);
        viewer_camera_place(camera, &home, render_bounds_radius(&bounds), now, middle);
    } else if (player->view.camera.orbit != 0 && !camera->moved) {
        viewer_camera_orbit(camera, player->view.camera.orbit, now);
    }
    double blend = between ? skein_pacer_blend(&stage->pacer) : 1;
    viewer_ride_move(&stage->ride, player->world, camera, blend, render_world_frame_span(frame));
    if (camera->follows && render_world_frame_middle(frame, middle)) viewer_camera_follow(camera, middle);
    return SKEIN_OK;
}

bool viewer_take_frames(viewer_stage *stage) {
    skein_error error = {SKEIN_OK, "", ""};
    viewer_painter_wait(&stage->painter);
    viewer_end_picture(stage);
    stage->width = stage->wide > 0 ? stage->wide : 1, stage->height = stage->tall > 0 ? stage->tall : 1;
    for (size_t s = 0; s < stage->side_count; s++) {
        if (!take_frame(stage, s, &error)) continue;
        viewer_say(stage, SKEIN_LOG_WARNING, "%s", error.message);
        return false;
    }
    return true;
}

bool viewer_begin_picture(viewer_stage *stage, bool sharp) {
    stage->begun = viewer_seconds();
    stage->dirty = false;
    if (!viewer_take_frames(stage)) return false;
    stage->picture = (viewer_picture){.side_count = stage->side_count,
                                      .lens = stage->camera.lens,
                                      .width = stage->width,
                                      .height = stage->height,
                                      .level = sharp ? 0 : stage->level};
    stage->sharp = stage->picture.level == 0;
    bool on_card = false;
    double start = viewer_seconds();
    for (size_t s = 0; s < stage->side_count; s++) {
        on_card |= viewer_player_on_card(&stage->sides[s]);
        if (on_card) skein_world_wait(stage->sides[s].world); // the other context sees what is finished
    }
    if (on_card) stage->pace.worked += viewer_seconds() - start;
    viewer_painter_begin(&stage->painter, paint, stage);
    // it draws from the buffers that the next step writes
    if (on_card) viewer_painter_wait(&stage->painter);
    return true;
}

void viewer_end_picture(viewer_stage *stage) {
    viewer_picture *picture = &stage->picture;
    if (!picture->ready) return;
    picture->ready = false;
    if (picture->error.status) viewer_say(stage, SKEIN_LOG_WARNING, "%s", picture->error.message);
    else stage->draw_ms = picture->ms;
    if (picture->error.status) return;
    // while the first one is drawn the driver makes its shaders, which says nothing about the others
    if (!stage->has_drawn) {
        stage->has_drawn = true, stage->draw_ms = 0;
        return;
    }
    // what took long because it was to have all detail says nothing about a moving one
    if (picture->level == stage->level) stage->level = viewer_detail_next(stage->level, picture->ms);
    stage->pace.pictures++;
    stage->pace.drawn += 1e-3 * picture->ms;
}

/* ---- Reading one ---- */

/* Into the image: one row after the other, as OpenGL's begin at the bottom. */
typedef struct picture_reader {
    viewer_stage *stage;
    render_image *image;
} picture_reader;

static void paint_read(void *user) {
    const picture_reader *reader = user;
    const viewer_stage *stage = reader->stage;
    render_image *image = reader->image;
    glNamedFramebufferRenderbuffer(stage->framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
                                   stage->pictures[stage->newest]);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, stage->framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < image->height; y++)
        glReadPixels(0, image->height - 1 - y, image->width, 1, GL_RGB, GL_UNSIGNED_BYTE,
                     image->pixels + 3 * (size_t)y * (size_t)image->width);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
}

bool viewer_picture_read(viewer_stage *stage, render_image *image) {
    skein_error error = {SKEIN_OK, "", ""};
    viewer_painter_wait(&stage->painter);
    if (stage->newest < 0 || stage->dirty || !stage->sharp) {
        if (!viewer_begin_picture(stage, true)) return false;
        viewer_painter_wait(&stage->painter);
    }
    viewer_end_picture(stage);
    if (stage->newest < 0) return false;
    if (render_image_resize(image, stage->drawn_width, stage->drawn_height, &error)) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s", error.message);
        return false;
    }
    picture_reader reader = {stage, image};
    viewer_painter_do(&stage->painter, paint_read, &reader);
    return true;
}
