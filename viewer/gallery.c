/* The gallery: all scenes of a folder, each with a picture of itself in the midst of what it shows.
 *
 * Titles are read at once; pictures are made one by one whenever the painter has nothing else to do, on its thread,
 * from a world of their own that is stepped for a fraction of a second. Called by stage.c. */
#include "viewer/gallery.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <epoxy/gl.h>

#include "io/places.h"

/* A picture shows the scene after so much of its frames, or what can be reached in so many seconds. */
static const double shown_part = 0.3, longest_run = 0.5;

struct viewer_gallery {
    render_target target; /* the painter's */
    size_t next;          /* card whose picture is due */
    viewer_card *card;    /* whose picture is being made */
    char fault[240];
};

/* ---- The folder ---- */

static int by_path(const void *a, const void *b) {
    return strcmp(((const viewer_card *)a)->path, ((const viewer_card *)b)->path);
}

/* The folder that was named, or else the first that holds Skein's scenes. */
static DIR *open_folder(const char *named, char path[IO_PLACE_SIZE]) {
    if (named) snprintf(path, IO_PLACE_SIZE, "%s", named);
    else if (!io_scenes_folder(0, path)) return NULL;
    return opendir(path);
}

static void keep_fault(void *user, const skein_error *error) {
    char *fault = user;
    if (!fault[0]) snprintf(fault, 240, "%.60s: %.170s", error->where, error->message);
}

/* What the scene's file says of itself. */
static void read_card(viewer_stage *stage, viewer_card *card) {
    char fault[240] = "";
    io_faults faults = {keep_fault, fault, 0, NULL};
    io_scene *scene = io_scene_read(card->path, NULL, stage->options->exporters, &faults);
    const char *slash = strrchr(card->path, '/');
    snprintf(card->title, sizeof card->title, "%.63s", slash ? slash + 1 : card->path);
    if (scene) {
        const io_scene_settings *settings = io_scene_get(scene);
        if (settings->name[0]) snprintf(card->title, sizeof card->title, "%s", settings->name);
        snprintf(card->about, sizeof card->about, "%s", settings->description);
    }
    if (!scene || faults.count) {
        card->broken = true;
        snprintf(card->about, sizeof card->about, "%s", fault);
    }
    io_scene_free(scene);
}

static viewer_card *list_folder(viewer_stage *stage, size_t *count) {
    char path[IO_PLACE_SIZE];
    viewer_card *cards = NULL;
    DIR *folder = open_folder(stage->options->scenes, path);
    *count = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        size_t length = strlen(entry->d_name);
        if (length < 6 || length > 200 || strcmp(entry->d_name + length - 5, ".json")) continue;
        viewer_card *grown = realloc(cards, (*count + 1) * sizeof *cards);
        if (!grown) break;
        cards = grown;
        memset(&cards[*count], 0, sizeof *cards);
        snprintf(cards[(*count)++].path, VIEWER_TEXT, "%.800s/%.200s", path, entry->d_name);
    }
    if (folder) closedir(folder);
    if (*count) qsort(cards, *count, sizeof *cards, by_path);
    return cards;
}

static void paint_open(void *user) {
    viewer_stage *stage = user;
    struct viewer_gallery *gallery = stage->gallery;
    skein_error error = {SKEIN_OK, "", ""};
    if (render_target_create(&gallery->target, VIEWER_CARD_WIDTH, VIEWER_CARD_HEIGHT, 4, &error))
        gallery->next = SIZE_MAX; // no pictures
}

bool viewer_gallery_open(viewer_stage *stage) {
    struct viewer_gallery *gallery = calloc(1, sizeof *gallery);
    if (!gallery) return false;
    stage->gallery = gallery;
    size_t count;
    viewer_card *cards = list_folder(stage, &count);
    for (size_t c = 0; c < count; c++) read_card(stage, &cards[c]);
    viewer_painter_do(&stage->painter, paint_open, stage);
    pthread_mutex_lock(&stage->exchange->lock);
    stage->exchange->shown.cards = cards;
    stage->exchange->shown.card_count = count;
    pthread_mutex_unlock(&stage->exchange->lock);
    viewer_event(stage->events, "gallery %zu scenes", count);
    return true;
}

static void paint_close(void *user) {
    viewer_stage *stage = user;
    render_target_destroy(&stage->gallery->target);
    for (size_t c = 0; c < stage->exchange->shown.card_count; c++)
        glDeleteTextures(1, &stage->exchange->shown.cards[c].texture);
}

void viewer_gallery_close(viewer_stage *stage) {
    if (!stage->gallery) return;
    viewer_painter_do(&stage->painter, paint_close, stage);
    free(stage->gallery);
    stage->gallery = NULL;
}

/* ---- Pictures ---- */

static void gallery_hears(void *user, skein_log_level level, const char *text) {
    struct viewer_gallery *gallery = user;
    if (level == SKEIN_LOG_WARNING && !gallery->fault[0]) snprintf(gallery->fault, sizeof gallery->fault, "%s", text);
}

static void run_a_while(viewer_player *player) {
    double start = viewer_seconds(), frames = fmin(fmax(shown_part * player->settings.frames, 1), 150);
    bool new_frame, good = true;
    while (good && (double)player->frame < frames && viewer_seconds() - start < longest_run)
        good = viewer_player_step(player, &new_frame);
}

/* The scene's picture as a texture that holds what a screen shows; 0 after a fault. */
static unsigned draw_card(viewer_stage *stage, viewer_player *player) {
    struct viewer_gallery *gallery = stage->gallery;
    render_image image = {0};
    skein_error error = {SKEIN_OK, "", ""};
    render_world_frame *frame = render_world_frame_create(&error);
    skein_status status = frame ? render_world_frame_update(frame, player->world, &player->view, &error) : error.status;
    if (!status) {
        const double aspect = (double)VIEWER_CARD_WIDTH / VIEWER_CARD_HEIGHT;
        render_world_frame_settle(frame);
        render_camera camera = render_world_frame_camera(frame, aspect);
        render_draw_in_parts(stage->draw, 0);
        status = render_draw_frame(stage->draw, render_world_frame_get(frame), &camera, gallery->target.framebuffer,
                                   VIEWER_CARD_WIDTH, VIEWER_CARD_HEIGHT, &error);
    }
    if (!status) status = render_target_read(&gallery->target, &image, &error);
    unsigned texture = 0;
    if (!status) {
        glCreateTextures(GL_TEXTURE_2D, 1, &texture);
        glTextureStorage2D(texture, 1, GL_RGBA8, VIEWER_CARD_WIDTH, VIEWER_CARD_HEIGHT);
        glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glTextureSubImage2D(texture, 0, 0, 0, VIEWER_CARD_WIDTH, VIEWER_CARD_HEIGHT, GL_RGB, GL_UNSIGNED_BYTE,
                            image.pixels);
        glFinish();
    }
    render_image_release(&image);
    render_world_frame_destroy(frame);
    return texture;
}

/* Makes the picture of a card, on the painter's thread. */
static void paint_card(void *user) {
    viewer_stage *stage = user;
    struct viewer_gallery *gallery = stage->gallery;
    viewer_card *card = gallery->card;
    viewer_player player = {0};
    viewer_reading reading = {stage->options->exporters, stage->options->threads, NULL, stage->options->allowed,
                              VIEWER_ON_PROCESSOR};
    unsigned texture = 0;
    gallery->fault[0] = 0;
    if (viewer_player_open(&player, card->path, NULL, &reading, (viewer_reporter){gallery_hears, gallery})) {
        run_a_while(&player);
        texture = draw_card(stage, &player);
    }
    viewer_player_close(&player);
    pthread_mutex_lock(&stage->exchange->lock);
    card->texture = texture;
    card->broken = !texture;
    if (!texture) memcpy(card->about, gallery->fault, sizeof card->about);
    pthread_mutex_unlock(&stage->exchange->lock);
    viewer_event(stage->events, "card %zu %s %s", gallery->next - 1, texture ? "drawn" : "broken", card->title);
    if (stage->exchange->wake) stage->exchange->wake();
}

void viewer_gallery_work(viewer_stage *stage) {
    struct viewer_gallery *gallery = stage->gallery;
    viewer_shown *shown = &stage->exchange->shown;
    while (gallery && gallery->next < shown->card_count && shown->cards[gallery->next].broken) gallery->next++;
    if (!gallery || gallery->next >= shown->card_count) return;
    gallery->card = &shown->cards[gallery->next++]; // cards stay where they are
    viewer_painter_begin(&stage->painter, paint_card, stage);
}
