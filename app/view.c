/* skein view [SCENE|MESH]: the window. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/compile.h"
#ifdef SKEIN_VIEWER
#include "viewer/viewer.h"

enum {
    SET,
    SIZE,
    PAUSED,
    NO_PANELS,
    UNFOCUSED,
    COMPARE,
    SCENES,
    SCALE,
    SAMPLES,
    THREADS,
    COMPILE,
    EVENTS,
    OPTION_COUNT
};

static const char *last_of(const app_option *option) {
    return option->count ? option->values[option->count - 1] : NULL;
}

/* "640x360"; false after a printed fault. */
static bool read_size(const app_option *option, int32_t size[2]) {
    const char *given = last_of(option);
    int used = 0;
    if (!given) return true;
    bool good = sscanf(given, "%dx%d%n", &size[0], &size[1], &used) == 2 && !given[used];
    if (good && size[0] >= 64 && size[1] >= 64 && size[0] <= 16384 && size[1] <= 16384) return true;
    fprintf(stderr, "skein view: %s %s: expected two whole numbers from 64 to 16384, as in 1280x720\n", option->name,
            given);
    return false;
}

static bool read_number(const app_option *option, double least, double most, bool whole, double *number) {
    const char *given = last_of(option);
    char *end;
    if (!given) return true;
    *number = strtod(given, &end);
    if (end != given && !*end && *number >= least && *number <= most && (!whole || *number == (double)(int)*number))
        return true;
    fprintf(stderr, "skein view: %s %s: expected %s number from %g to %g\n", option->name, given,
            whole ? "a whole" : "a", least, most);
    return false;
}

static bool read_unfocused(const app_option *option, viewer_unfocused *unfocused) {
    static const char *const words[] = {"scene", "pause", "play"};
    const char *given = last_of(option);
    for (int i = 0; given && i < 3; i++)
        if (!strcmp(given, words[i])) {
            *unfocused = (viewer_unfocused)i;
            return true;
        }
    if (given) fprintf(stderr, "skein view: %s %s: expected scene, pause or play\n", option->name, given);
    return !given;
}

static void prepare(skein_world *world) {
    app_compile(world, false);
}

/* False after a printed fault. */
static bool read_options(const app_option *options, viewer_options *o) {
    double samples = o->samples, threads = 0;
    o->sets = options[SET].values;
    o->exporters = app_exporters();
    o->paused = options[PAUSED].count > 0;
    o->panels = !options[NO_PANELS].count;
    o->compare = last_of(&options[COMPARE]);
    o->events = last_of(&options[EVENTS]);
    if (options[COMPILE].count) o->prepare = prepare;
    if (options[SCENES].count) o->scenes = last_of(&options[SCENES]);
    bool good = read_size(&options[SIZE], o->size) && read_unfocused(&options[UNFOCUSED], &o->unfocused) &&
                read_number(&options[SCALE], 0.5, 8, false, &o->scale) &&
                read_number(&options[SAMPLES], 1, 64, true, &samples) &&
                read_number(&options[THREADS], 1, 64, true, &threads);
    o->samples = (int32_t)samples;
    o->threads = (int32_t)threads;
    return good;
}

static void print_keys(void) {
    char line[200];
    printf("\nKeys (F1 shows them in the window)\n");
    for (size_t k = 0; viewer_key_line(k, line, sizeof line); k++) printf("  %s\n", line);
}

static int view(int argc, char **argv) {
    app_option options[OPTION_COUNT] = {
        [SET] = {"--set", "PATH=VALUE", "change a value of the scene first; may be repeated", true, NULL, 0},
        [SIZE] = {"--size", "WxH", "of the window in pixels, 1280x720 if not given", false, NULL, 0},
        [PAUSED] = {"--paused", NULL, "begin paused", false, NULL, 0},
        [NO_PANELS] = {"--no-panels", NULL, "begin without the panel at the side; Tab shows it", false, NULL, 0},
        [UNFOCUSED] = {"--unfocused", "WORD",
                       "when another window is typed into: pause, play, or scene (pauses flocks)", false, NULL, 0},
        [COMPARE] = {"--compare", "PATH=VALUE", "the same scene beside it with another value, in step", false, NULL, 0},
        [SCENES] = {"--scenes", "FOLDER", "of the gallery, those that came with skein if not given", false, NULL, 0},
        [SCALE] = {"--scale", "N", "of letters and controls, instead of the screen's", false, NULL, 0},
        [SAMPLES] = {"--samples", "N", "samples a pixel for smooth edges, 4 if not given", false, NULL, 0},
        [THREADS] = {"--threads", "N", "threads to simulate on, 1 to 64; the result is the same", false, NULL, 0},
        [COMPILE] = app_compile_option,
        [EVENTS] = {"--events", "FILE", "write what happens, a line each, - for the terminal", false, NULL, 0},
    };
    const char *path;
    viewer_options asked = viewer_default_options();
    skein_error error = {SKEIN_OK, "", ""};
    int status = app_parse(&app_view_command, argc, argv, options, OPTION_COUNT, NULL, &path);
    if (status == EXIT_OK) print_keys();
    if (status < 0 && !read_options(options, &asked)) status = EXIT_FAULT;
    if (status < 0 && path && access(path, R_OK)) {
        fprintf(stderr, "skein view: %s: cannot read: %s\n", path, strerror(errno));
        status = EXIT_FAULT;
    }
    if (status < 0) {
        asked.path = path;
        status = viewer_run(&asked, &error) ? EXIT_FAILURE_RUN : EXIT_OK;
        if (status) app_print_error(&error);
    }
    app_options_free(options, OPTION_COUNT);
    return status;
}
#else

static int view(int argc, char **argv) {
    const char *word;
    for (int a = 0; a < argc; a++)
        if (!strcmp(argv[a], "--help") || !strcmp(argv[a], "-h"))
            return app_parse(&app_view_command, 1, &argv[a], NULL, 0, NULL, &word);
    fprintf(stderr,
            "skein view: this skein was built without a window: `tools/setup build` installs what is missing "
            "(libglfw3-dev, libimgui-dev, g++); then build it again. `skein render` makes pictures and films\n");
    return EXIT_FAILURE_RUN;
}
#endif

const app_command app_view_command = {
    "view",
    "[SCENE|MESH] [options]",
    "open a window: play a scene, look around, pull, change, measure\n\n"
    "  skein view scenes/flag.json\n"
    "  skein view                                  a gallery of all scenes, with pictures\n"
    "  skein view shirt.obj --paused               any mesh as a cloth; or drop one on the window\n"
    "  skein view scenes/drape.json --compare method.type=pbd\n\n"
    "Drag a particle to pull it, click one to pin or free it. Drag beside it to look around; Shift, or the middle\n"
    "button, moves the view, the wheel comes closer. The panel has a control for every field there is; Ctrl and a\n"
    "click on a slider takes any number. The scene's file is read again whenever an editor has changed it.\n\n"
    "Exit status 0: closed; 1: no window could be opened; 2: a fault in the arguments.",
    view,
};
