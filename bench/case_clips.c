/* Clips: how long each format takes to write 120 frames of a cloth of 100 x 100, beside the same numbers written plain. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/bench.h"
#include "io/clip.h"
#include "io/recording.h"

enum { FRAMES = 120, SIDE = 100 };

typedef struct film {
    int side, frames;
    size_t vertices, faces;
    double *positions; /* frames x vertices x 3 */
    uint32_t *sizes, *corners;
} film;

typedef struct writing {
    const film *film;
    const io_clip_format *format; /* one of these two, or none: plain */
    const io_recording_format *recording;
    char path[80];
} writing;

/* A sheet that waves, as smooth and as irregular in its last bits as a simulated one. */
static film make_film(int side, int frames) {
    film f = {side, frames, (size_t)side * (size_t)side, (size_t)(side - 1) * (size_t)(side - 1), NULL, NULL, NULL};
    f.positions = bench_allocate((size_t)frames * f.vertices * 3, sizeof *f.positions);
    f.sizes = bench_allocate(f.faces, sizeof *f.sizes);
    f.corners = bench_allocate(4 * f.faces, sizeof *f.corners);
    skein_world *world = skein_world_create(NULL, NULL);
    const skein_setting cloth[] = {SKEIN_PAIR("grid", side, side), SKEIN_TEXT("pins", "top corners"), SKEIN_END};
    if (!world || skein_body_add(world, "cloth", NULL, cloth, NULL) || skein_force_add(world, "gravity", NULL, NULL))
        bench_stop("cannot make the cloth of the clips");
    for (int frame = 0; frame < frames; frame++) {
        if (skein_world_step(world, 1.0 / 60) ||
            skein_positions_copy(world, 0, f.vertices, f.positions + 3 * f.vertices * (size_t)frame))
            bench_stop("cannot step the cloth of the clips");
    }
    skein_world_destroy(world);
    uint32_t *at = f.corners;
    for (uint32_t r = 0, n = (uint32_t)side; r + 1 < n; r++)
        for (uint32_t c = 0; c + 1 < n; c++) {
            uint32_t a = r * n + c;
            *at++ = a, *at++ = a + n, *at++ = a + n + 1, *at++ = a + 1;
        }
    for (size_t i = 0; i < f.faces; i++) f.sizes[i] = 4;
    return f;
}

static void write_plain(const writing *w) {
    FILE *file = fopen(w->path, "wb");
    float *sample = bench_allocate(3 * w->film->vertices, sizeof *sample);
    bool good = file != NULL;
    for (int frame = 0; good && frame < w->film->frames; frame++) {
        const double *from = w->film->positions + 3 * w->film->vertices * (size_t)frame;
        for (size_t i = 0; i < 3 * w->film->vertices; i++) sample[i] = (float)from[i];
        good = fwrite(sample, sizeof *sample, 3 * w->film->vertices, file) == 3 * w->film->vertices;
    }
    free(sample);
    if (!file || fclose(file) || !good) bench_stop("cannot write %s", w->path);
}

static void write_clip(void *data) {
    const writing *w = data;
    const film *f = w->film;
    static const io_clip_params params = {.every = 1, .scale = 1};
    skein_error error = {SKEIN_OK, "", ""};
    skein_status status = SKEIN_OK;
    if (!w->format && !w->recording) {
        write_plain(w);
        return;
    }
    io_clip clip = {.name = "cloth", .fps = 60, .samples = (uint32_t)f->frames, .read_path = "", .params = &params};
    clip.mesh = (skein_mesh){f->positions, f->vertices, f->sizes, f->faces, f->corners, 4 * f->faces};
    const io_recorded recorded = {
        .particles = f->vertices, .cell_sizes = f->sizes, .cells = f->corners, .cell_count = f->faces, .body = "cloth"};
    void *file = w->recording        ? w->recording->create(w->path, &recorded, &error)
                 : w->format->create ? w->format->create(&clip, w->path, &error)
                                     : NULL;
    for (int frame = 0; frame < f->frames && !status; frame++) {
        const double *at = f->positions + 3 * f->vertices * (size_t)frame;
        clip.mesh.positions = at;
        if (w->recording) status = file ? w->recording->add(file, frame / 60.0, at, at, &error) : SKEIN_ERROR_FILE;
        else if (file) status = w->format->add(file, at, &error);
        else status = w->format->write ? w->format->write(&clip, w->path, &error) : SKEIN_ERROR_FILE;
    }
    if (file && !status) status = w->recording ? w->recording->commit(file, &error) : w->format->commit(file, &error);
    if (status) bench_stop("%s: %s", error.where, error.message);
}

static void run_clips(void) {
    static const char *const names[] = {"pc2", "mdd", "glb", "ply", "stl", "hdf5", "obj", "usda"};
    enum { BINARY = 6, FORMATS = sizeof names / sizeof *names };
    film f = bench_quick ? make_film(12, 10) : make_film(SIDE, FRAMES);
    char folder[] = "/tmp/skein-bench-XXXXXX", size[60];
    if (!mkdtemp(folder)) bench_stop("cannot make a folder in /tmp");
    snprintf(size, sizeof size, "%d frames of %d x %d", f.frames, f.side, f.side);
    for (int i = 0; i < FORMATS; i++) {
        writing ours = {&f, io_clip_format_named(names[i]), io_recording_named(names[i]), ""},
                plain = {&f, NULL, NULL, ""};
        if (!ours.format && !ours.recording) continue; // built without
        snprintf(ours.path, sizeof ours.path, "%s/clip.%s", folder, strcmp(names[i], "hdf5") ? names[i] : "h5");
        snprintf(plain.path, sizeof plain.path, "%s/plain", folder);
        bench_job jobs[] = {{.run = write_clip, .data = &ours, .calls = 1},
                            {.run = write_clip, .data = &plain, .calls = 1}};
        double seconds[2];
        bench_measure(jobs, 2, 0, seconds);
        char name[40];
        snprintf(name, sizeof name, "clip, %s", names[i]);
        bench_report(&(bench_result){.name = name,
                                     .size = size,
                                     .ours = 1e3 * seconds[0],
                                     .unit = "ms",
                                     .other = "the numbers alone",
                                     .theirs = 1e3 * seconds[1],
                                     .under = i < BINARY ? 2000 : 0,
                                     .note = ours.format && !ours.format->create ? "a file each frame" : "one file"});
        unlink(ours.path), unlink(plain.path);
        char second[100];
        snprintf(second, sizeof second, "%s/clip.xdmf", folder);
        unlink(second);
    }
    if (rmdir(folder)) bench_fault("%s: something was left there", folder);
    free(f.positions), free(f.sizes), free(f.corners);
}

const bench_case bench_clips = {"clips", "120 frames of a cloth of 100 x 100, written in each format", run_clips};
