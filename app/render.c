/* skein render SCENE -o FILE: a film, or one picture. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/compile.h"
#include "app/footage.h"
#include "app/progress.h"
#include "app/verdict.h"
#ifdef SKEIN_RENDER
#include "render/picture.h"

/* What the arguments ask for. */
typedef struct request {
    const char *path;
    film_options options;
    int frame;                /* of a single picture; -1: the last */
    bool single, quiet, calm; /* calm: without progress and notes about the film */
} request;

/* ---- what it shows is judged, too ---- */

static bool measure(const app_scene *loaded, skein_statistics *statistics) {
    if (!skein_world_statistics(loaded->world, statistics)) return true;
    app_print_error(skein_world_error(loaded->world));
    return false;
}

static bool judge(const app_scene *loaded, app_verdict *verdict) {
    skein_statistics end;
    return measure(loaded, &end) && app_verdict_end(verdict, &end);
}

/* ---- a picture ---- */

/* Said before the world takes its first step: whether a file can be put there. */
static bool can_write(const char *path) {
    struct stat info;
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) + (slash == path) : 1;
    char *folder = malloc(length + 1);
    if (!folder) return false;
    snprintf(folder, length + 1, "%.*s", (int)length, slash ? path : ".");
    int fault = stat(folder, &info) ? errno : !S_ISDIR(info.st_mode) ? ENOTDIR : access(folder, W_OK) ? errno : 0;
    if (!fault && !stat(path, &info) && S_ISDIR(info.st_mode)) fault = EISDIR;
    if (fault)
        fprintf(stderr, "skein: %s: cannot write: %s\n", path,
                fault == ENOENT ? "its directory does not exist, create it first" : strerror(fault));
    free(folder);
    return !fault;
}

static int make_picture(app_scene *loaded, const request *r) {
    double dt;
    skein_statistics start;
    int steps = io_scene_steps_per_frame(&loaded->settings, &dt), frames = r->frame;
    if (frames < 0) frames = loaded->settings.frames;
    if (!can_write(r->path) || !measure(loaded, &start)) return EXIT_FAILURE_RUN;
    app_verdict verdict = app_verdict_begin(loaded, &start);
    app_progress p = app_progress_start("frame", frames, r->calm);
    for (int i = 1; i <= frames; i++) {
        if (app_interrupted()) { // another frame than was asked for is of no use
            app_progress_end(&p);
            fprintf(stderr, "skein: %s: interrupted in frame %d: no picture\n", r->path, i);
            return EXIT_SIGNAL + app_interrupted();
        }
        if (!app_step_frame(loaded, i, steps, dt, &p)) return EXIT_FAILURE_RUN;
        app_progress_show(&p, i);
    }
    app_progress_end(&p);
    skein_error error = {SKEIN_OK, "", ""};
    render_picture_options options = {{r->options.size[0], r->options.size[1]}, r->options.samples};
    if (render_picture(loaded->world, r->path, &options, io_scene_view(loaded->scene), &error)) {
        app_print_error(&error);
        return EXIT_FAILURE_RUN;
    }
    if (!r->quiet)
        printf("wrote %s: %d x %d, frame %d, at %.2f s\n", r->path, options.size[0], options.size[1], frames,
               frames / loaded->settings.fps);
    return judge(loaded, &verdict) ? EXIT_OK : EXIT_FAILURE_RUN;
}

/* ---- a film ---- */

static void print_facts(const request *r, const app_footage_facts *facts, double seconds) {
    struct stat info;
    printf("wrote %s: %d picture%s of %d x %d, %.2f s at %g a second", r->path, facts->pictures,
           facts->pictures == 1 ? "" : "s", facts->size[0], facts->size[1], facts->pictures / facts->rate, facts->rate);
    if (!stat(r->path, &info) && S_ISREG(info.st_mode)) printf(", %.0f kB", 1e-3 * (double)info.st_size);
    printf("; in %.1f s\n", seconds);
}

/* Picture k shows the world after k frames, from 0: so the film lasts as long as its frames. */
static int make_film(app_scene *loaded, const request *r) {
    double dt, start = app_seconds();
    skein_statistics first;
    int steps = io_scene_steps_per_frame(&loaded->settings, &dt),
        frames = loaded->settings.frames > 1 ? loaded->settings.frames : 1;
    if (!measure(loaded, &first)) return EXIT_FAILURE_RUN;
    app_verdict verdict = app_verdict_begin(loaded, &first);
    app_footage *footage = app_footage_begin(loaded, r->path, &r->options, frames, r->calm);
    if (!footage) return EXIT_FAILURE_RUN;
    app_progress p = app_progress_start("frame", frames, r->calm);
    bool drawn = true, stepped = true;
    for (int i = 0; i < frames && drawn && stepped; i++) {
        if (i) stepped = app_step_frame(loaded, i, steps, dt, &p);
        if (stepped && (drawn = app_footage_frame(footage))) app_progress_show(&p, i + 1);
        if (app_interrupted()) break;
    }
    app_progress_end(&p);
    app_footage_facts facts;
    if (!drawn) { // and it was told why: what is there already stays
        app_footage_end(footage, NULL);
        return EXIT_FAILURE_RUN;
    }
    int signal_number = app_interrupted();
    if (!app_footage_end(footage, &facts)) return EXIT_FAILURE_RUN;
    if (!r->quiet) print_facts(r, &facts, app_seconds() - start);
    stepped = stepped && judge(loaded, &verdict);
    return !stepped ? EXIT_FAILURE_RUN : signal_number ? EXIT_SIGNAL + signal_number : EXIT_OK;
}

/* ---- the arguments ---- */

/* Numbers of an option, "1920x1080", checked by the field that describes them; false after a printed fault. */
static bool read_numbers(const app_arguments *arguments, const char *name, const skein_field *field, int count,
                         int32_t *out) {
    const char *given = app_value(arguments, name);
    if (!given) return true;
    skein_value value = {count, {0, 0, 0}, NULL};
    skein_error error = {SKEIN_ERROR_VALUE, "", ""};
    const char *at = given;
    bool good = true;
    for (int i = 0; i < count && good; i++) {
        char *end;
        value.number[i] = (double)strtol(at, &end, 10);
        good = end != at && (i + 1 < count ? *end == 'x' || *end == ',' : !*end);
        at = end + 1;
    }
    if (!good) value.count = 4; // what no field takes, so that the field says what it does take
    if (skein_field_check(field, &value, &error)) {
        fprintf(stderr, "skein render: %s %s: %s%s\n", name, given, error.message, count > 1 ? ", as in 1920x1080" : "");
        return false;
    }
    for (int i = 0; i < count; i++) out[i] = (int32_t)value.number[i];
    return true;
}

static bool refuse(const app_arguments *arguments, const char *name, const char *why) {
    if (!app_given(arguments, name)) return true;
    fprintf(stderr, "skein render: %s: %s\n", name, why);
    return false;
}

/* False after a printed fault. */
static bool read_request(const app_arguments *arguments, request *r) {
    const skein_field *frames = skein_field_find(io_scene_kind(), "frames", NULL);
    const skein_kind *kind = film_exporter();
    skein_error error = {SKEIN_OK, "", ""};
    *r = (request){.options = film_default_options(), .frame = -1, .quiet = app_given(arguments, "--quiet")};
    r->calm = r->quiet || app_given(arguments, "--no-progress");
    const char *out = app_given(arguments, "-o") ? "-o" : "--out";
    r->path = app_value(arguments, out);
    if (!r->path) {
        fprintf(stderr, "skein render: where to? -o film.mp4, .webm or .gif; -o picture.png; -o many-%%04d.png\n");
        return false;
    }
    const film_format *format = film_format_of(r->path, &error);
    if (!format) {
        fprintf(stderr, "skein render: %s %s: %s\n", out, error.where, error.message);
        return false;
    }
    r->single = !format->encoders && !film_path_is_numbered(r->path);
    return read_numbers(arguments, "--frame", frames, 1, &r->frame) &&
           read_numbers(arguments, "--size", skein_field_find(kind, "size", NULL), 2, r->options.size) &&
           read_numbers(arguments, "--samples", skein_field_find(kind, "samples", NULL), 1, &r->options.samples) &&
           read_numbers(arguments, "--quality", skein_field_find(kind, "quality", NULL), 1, &r->options.quality) &&
           (r->single || refuse(arguments, "--frame", "is for one picture, -o picture.png; a film takes --frames")) &&
           (format->encoders || refuse(arguments, "--quality", "is for films; a PNG loses nothing"));
}

static int render(app_arguments *arguments) {
    app_override_texts texts;
    app_follow_text follow;
    request asked;
    if (!read_request(arguments, &asked) || !app_override(arguments, texts) || !app_follow(arguments, follow))
        return EXIT_FAULT;
    app_scene loaded = {.quiet = asked.quiet};
    int status = app_load(app_word(arguments), app_values(arguments, "--set"), &loaded);
    if (!status && app_given(arguments, "--compile")) loaded.warnings += app_compile(loaded.world, asked.calm);
    if (!status) status = app_device(&loaded, app_value(arguments, "--device"));
    if (!status) {
        app_catch_interrupts();
        app_advise(&loaded);
        status = asked.single ? make_picture(&loaded, &asked) : make_film(&loaded, &asked);
    }
    app_unload(&loaded);
    return status;
}
#else

static int render(app_arguments *arguments) {
    (void)arguments;
    fprintf(stderr, "skein render: this skein was built without pictures: build it with SKEIN_RENDER=ON\n");
    return EXIT_FAILURE_RUN;
}
#endif

static const app_option options[] = {
    APP_SET_OPTION,
    APP_BOUNDS_OPTIONS,
    {"-o", "FILE", "what to write; its ending says what it becomes", false, APP_TAKES_FILE},
    {"--out", "FILE", "the same", false, APP_TAKES_FILE},
    {"--frames", "N", "frames to show, instead of the scene's", false, APP_TAKES_ANY},
    {"--frame", "N", "the frame of a single picture, instead of the last; 0 is the start", false, APP_TAKES_ANY},
    {"--fps", "N", "frames a second, of the film and of simulated time, instead of the scene's", false, APP_TAKES_ANY},
    {"--size", "WxH", "width and height in pixels; 1280x720 if not given", false, APP_TAKES_ANY},
    {"--samples", "N", "samples a pixel for smooth edges, 4 if not given", false, APP_TAKES_ANY},
    {"--quality", "N", "of a film, 1 (small) to 100 (faithful), 75 if not given", false, APP_TAKES_ANY},
    APP_FOLLOW_OPTION,
    APP_THREADS_OPTION,
    APP_DEVICE_OPTION,
    APP_COMPILE_OPTION,
    APP_NO_PROGRESS_OPTION,
    APP_QUIET_OPTION,
    APP_END_OF_OPTIONS};

const app_command app_render_command = {
    "render",
    "SCENE -o FILE [options]",
    "simulate a scene and show it: a film, or one picture; needs no display and no graphics card\n\n"
    "  skein render scenes/flag.json -o flag.mp4 --frames 240\n"
    "  skein render scenes/flag.json -o flag.webm --size 640x360 --quality 60\n"
    "  skein render scenes/flag.json -o flag.gif --size 480x270 --fps 25 --frames 75\n"
    "  skein render scenes/drape.json -o drape.png --frame 90 --size 1920x1080 --samples 8\n"
    "  skein render scenes/drape.json -o 'drape-%04d.png' --frames 60      (or drape-####.png)\n\n"
    "Picture k of a film shows the world after k frames, from 0 on: 240 frames at 60 a second last 4 s. The\n"
    "camera stands where it sees all that will happen, or goes along with a body. What was under that name is\n"
    "replaced: a PNG when the new one is complete, a film at once. MP4 and WebM grow on the disk second by\n"
    "second, so that even of a process that was killed a film is left that plays; a GIF is there at the end.\n"
    "Interrupted (Ctrl-C), a film ends early, as it should.\n\n"
    "Exit status 0: done; 1: the run failed, or the file could not be written; 2: a fault in the scene or the\n"
    "arguments; 130: interrupted.",
    options,
    "scene",
    false,
    APP_TAKES_SCENE,
    render,
    NULL,
};
