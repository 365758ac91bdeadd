/* What goes to files, and the file that is watched. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "io/mesh.h"
#include "io/uncut.h"
#include "viewer/stage.h"

void viewer_free_name(const char *stem, const char *ending, char *path, size_t size) {
    struct stat info;
    for (int number = 1; number < 10000; number++) {
        snprintf(path, size, "%.40s-%03d%s", stem, number, ending);
        if (stat(path, &info)) return;
    }
}

/* Letters and digits. */
const char *viewer_stem_of(const viewer_stage *stage, char stem[48]) {
    const char *name = stage->sides[0].settings.name;
    size_t length = 0;
    for (; name[length] && length < 40; length++)
        stem[length] =
            (char)(strchr("/\\ \t:*?\"<>|", name[length]) || (unsigned char)name[length] < 0x20 ? '_' : name[length]);
    stem[length] = 0;
    if (!length || stem[0] == '.') snprintf(stem, 48, "skein");
    char *dot = strrchr(stem, '.');
    if (dot && io_path_is_mesh(stem)) *dot = 0;
    return stem;
}

void viewer_save_picture(viewer_stage *stage) {
    render_image image = {0};
    skein_error error = {SKEIN_OK, "", ""};
    char path[64], stem[48];
    viewer_free_name(viewer_stem_of(stage, stem), ".png", path, sizeof path);
    if (viewer_picture_read(stage, &image)) {
        if (render_image_write_png(&image, path, &error))
            viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", error.where, error.message);
        else viewer_note(stage, "saved %s", path);
    }
    render_image_release(&image);
}

/* ---- Meshes ---- */

static void save_body(viewer_stage *stage, size_t body, const char *stem) {
    skein_world *world = stage->sides[0].world;
    skein_surface s;
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    if (skein_body_surface(world, skein_object_at(world, SKEIN_BODY, body), &s) || !s.face_count) return;
    double *positions = malloc(3 * s.vertex_count * sizeof *positions);
    uint32_t *room = NULL;
    bool good = positions && io_surface_uncut(world, skein_object_at(world, SKEIN_BODY, body), &s, &room);
    for (size_t v = 0; v < s.vertex_count && good; v++)
        good = !skein_positions_copy(world, s.particle_of_vertex[v], 1, positions + 3 * v);
    skein_mesh mesh = {positions, s.vertex_count, s.face_sizes, s.face_count, s.face_vertices, s.face_vertex_count};
    char path[64];
    viewer_free_name(stem, ".obj", path, sizeof path);
    if (good) good = !io_obj_write(path, &mesh, SKEIN_NORMALS_ANGLE, &error);
    if (good) viewer_note(stage, "saved %s: %zu vertices, %zu faces", path, s.vertex_count, s.face_count);
    else viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", path, error.message);
    free(positions);
    free(room);
}

void viewer_save_mesh(viewer_stage *stage) {
    char stem[48];
    size_t count = skein_object_count(stage->sides[0].world, SKEIN_BODY), faces = 0;
    viewer_stem_of(stage, stem);
    for (size_t b = 0; b < count; b++) {
        skein_surface s;
        if (!skein_body_surface(stage->sides[0].world, skein_object_at(stage->sides[0].world, SKEIN_BODY, b), &s))
            faces += s.face_count;
        save_body(stage, b, stem);
    }
    if (!faces) viewer_note(stage, "there is no mesh to save: no body has faces");
}

/* ---- The scene ---- */

/* As tuned: it opens to what this one would be if it were put back to its start. */
/* Each of the worlds that are shown. */
void viewer_save_scene(viewer_stage *stage) {
    viewer_reading reading = viewer_stage_reading(stage);
    skein_error error = {SKEIN_OK, "", ""};
    char path[64], stem[48];
    for (size_t s = stage->side_count; s-- > 0;) {
        viewer_stem_of(stage, stem);
        if (s) snprintf(stem + (strlen(stem) < 30 ? strlen(stem) : 30), 8, "-other");
        viewer_free_name(stem, ".json", path, sizeof path);
        if (viewer_player_write(&stage->sides[s], path, &reading, &error)) {
            viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", path, error.message);
            continue;
        }
        viewer_note(stage, "saved %s: the scene as tuned", path);
        if (s == 0 && !viewer_recent_add(&stage->recent, path, &error))
            viewer_say(stage, SKEIN_LOG_INFO, "%s: %s", error.where, error.message);
    }
}

/* ---- Films ---- */

static void begin_film(viewer_stage *stage) {
    static const char *const endings[] = {".mp4", ".webm", ".gif"};
    char stem[48];
    skein_error error = {SKEIN_OK, "", ""};
    film_options options = film_default_options();
    // the first format that there is an encoder for
    const film_format *format = NULL;
    for (int e = 0; e < 3 && !format; e++) {
        viewer_free_name(viewer_stem_of(stage, stem), endings[e], stage->film_path, sizeof stage->film_path);
        format = film_format_of(stage->film_path, NULL);
        if (format && !film_format_is_here(format)) format = NULL;
    }
    options.size[0] = stage->width, options.size[1] = stage->height;
    if (format) film_fit_size(format, options.size);
    stage->film = format ? film_create(stage->film_path, &options, stage->sides[0].settings.fps, &error) : NULL;
    stage->film_frames = 0;
    if (!stage->film) {
        viewer_say(stage, SKEIN_LOG_WARNING, "no film: %s",
                   error.message[0] ? error.message : "this skein was built without libav: tools/setup installs it");
        return;
    }
    viewer_note(stage, "records %s; V ends it", stage->film_path);
    viewer_film_frame(stage);
}

void viewer_film_toggle(viewer_stage *stage) {
    skein_error error = {SKEIN_OK, "", ""};
    stage->dirty = true;
    if (!stage->film) {
        begin_film(stage);
        return;
    }
    film *ended = stage->film;
    stage->film = NULL;
    if (film_finish(ended, &error)) viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", stage->film_path, error.message);
    else viewer_note(stage, "saved %s: %d pictures", stage->film_path, (int)stage->film_frames);
}

/* An image cut to even sides, as films want them. */
static void make_even(render_image *image) {
    int width = image->width & ~1, height = image->height & ~1;
    for (int y = 0; y < height && width != image->width; y++)
        memmove(image->pixels + 3 * (size_t)y * (size_t)width, image->pixels + 3 * (size_t)y * (size_t)image->width,
                3 * (size_t)width);
    image->width = width, image->height = height;
}

void viewer_film_frame(viewer_stage *stage) {
    render_image image = {0};
    skein_error error = {SKEIN_OK, "", ""};
    stage->dirty = true; // the picture is to be of this very frame
    bool good = viewer_picture_read(stage, &image);
    if (good) {
        make_even(&image);
        good = !film_add(stage->film, &image, &error);
    }
    render_image_release(&image);
    stage->film_frames++;
    if (good) return;
    if (error.status) viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", stage->film_path, error.message);
    viewer_film_toggle(stage);
}

/* ---- The scene's file ---- */

void viewer_watch(viewer_stage *stage, bool only_note) {
    struct stat info;
    const char *path = stage->side_count ? stage->sides[0].path : stage->wanted;
    if (!path[0] || stat(path, &info)) return; // away for a moment: editors do that
    bool same = stage->stamp.seconds == info.st_mtim.tv_sec && stage->stamp.nanoseconds == info.st_mtim.tv_nsec &&
                stage->stamp.size == info.st_size;
    stage->stamp.seconds = info.st_mtim.tv_sec;
    stage->stamp.nanoseconds = info.st_mtim.tv_nsec;
    stage->stamp.size = info.st_size;
    if (same || only_note) return;
    if (stage->side_count) viewer_stage_reload(stage);
    else viewer_stage_open(stage, path, stage->options->sets);
}
