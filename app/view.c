/* skein view [SCENE|MESH]: the window. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/compile.h"
#ifdef SKEIN_VIEWER
#include "viewer/viewer.h"

/* "640x360"; false after a printed fault. */
static bool read_size(const char *given, int32_t size[2]) {
    int used = 0;
    if (!given) return true;
    bool good = sscanf(given, "%dx%d%n", &size[0], &size[1], &used) == 2 && !given[used];
    if (good && size[0] >= 64 && size[1] >= 64 && size[0] <= 16384 && size[1] <= 16384) return true;
    fprintf(stderr, "skein view: --size %s: expected two whole numbers from 64 to 16384, as in 1280x720\n", given);
    return false;
}

static bool read_number(const app_arguments *arguments, const char *name, double least, double most, bool whole,
                        double *number) {
    const char *given = app_value(arguments, name);
    char *end;
    if (!given) return true;
    *number = strtod(given, &end);
    if (end != given && !*end && *number >= least && *number <= most && (!whole || *number == (double)(int)*number))
        return true;
    fprintf(stderr, "skein view: %s %s: expected %s number from %g to %g\n", name, given, whole ? "a whole" : "a",
            least, most);
    return false;
}

/* The word is one of these: the option's table says so. */
static viewer_unfocused read_unfocused(const char *given) {
    static const char *const words[] = {"scene", "pause", "play"};
    int place = 0;
    while (given && place < 2 && strcmp(given, words[place])) place++;
    return (viewer_unfocused)place;
}

static viewer_device read_device(const char *given) {
    return !strcmp(given, "gpu")    ? VIEWER_ON_CARD
           : !strcmp(given, "auto") ? VIEWER_ON_CARD_IF_ANY
                                    : VIEWER_ON_PROCESSOR;
}

static void prepare(skein_world *world) {
    app_compile(world, false);
}

/* False after a printed fault. */
static bool read_options(const app_arguments *arguments, viewer_options *o) {
    double samples = o->samples, threads = 0;
    o->sets = app_values(arguments, "--set");
    o->allowed = app_values(arguments, "--allow-path");
    o->exporters = app_exporters();
    o->paused = app_given(arguments, "--paused");
    o->panels = !app_given(arguments, "--no-panels");
    o->compare = app_value(arguments, "--compare");
    o->record = app_value(arguments, "--record");
    o->events = app_value(arguments, "--events");
    const char *theme = app_value(arguments, "--theme");
    o->theme = !theme ? viewer_theme_kept() : strcmp(theme, "light") ? VIEWER_DARK : VIEWER_LIGHT;
    if (app_given(arguments, "--compile")) o->prepare = prepare;
    if (app_given(arguments, "--scenes")) o->scenes = app_value(arguments, "--scenes");
    if (app_given(arguments, "--device")) o->device = read_device(app_value(arguments, "--device"));
    if (app_given(arguments, "--unfocused")) o->unfocused = read_unfocused(app_value(arguments, "--unfocused"));
    bool good = read_size(app_value(arguments, "--size"), o->size) &&
                read_number(arguments, "--scale", 0.5, 8, false, &o->scale) &&
                read_number(arguments, "--samples", 1, 64, true, &samples) &&
                read_number(arguments, "--threads", 1, 64, true, &threads);
    o->samples = (int32_t)samples;
    o->threads = (int32_t)threads;
    return good;
}

static void print_keys(void) {
    char line[200];
    printf("\nKeys (F1 shows them in the window)\n");
    for (size_t k = 0; viewer_key_line(k, line, sizeof line); k++) printf("  %s\n", line);
}

static int view(app_arguments *arguments) {
    static char path[IO_PLACE_SIZE];
    app_follow_text follow;
    const char *word = app_word(arguments);
    viewer_options asked = viewer_default_options();
    skein_error error = {SKEIN_OK, "", ""};
    if (!app_follow(arguments, follow) || !read_options(arguments, &asked)) return EXIT_FAULT;
    if (word && !strcmp(word, "-")) {
        fprintf(stderr, "skein view: -: a window reads its scene again when it changes, and so needs a file\n");
        return EXIT_FAULT;
    }
    if (word && !io_scene_find(word, path)) {
        app_not_found(word);
        return EXIT_FAULT;
    }
    if (word && access(path, R_OK)) {
        fprintf(stderr, "skein view: %s: cannot read: %s\n", path, strerror(errno));
        return EXIT_FAULT;
    }
    asked.path = word ? path : NULL;
    if (!viewer_run(&asked, &error)) return EXIT_OK;
    app_print_error(&error);
    return EXIT_FAILURE_RUN;
}
#else

static int view(app_arguments *arguments) {
    (void)arguments;
    fprintf(stderr, "skein view: this skein was built without a window: `tools/setup build` installs what is missing "
                    "(libglfw3-dev, libimgui-dev, g++); then build it again. `skein render` makes pictures and films\n");
    return EXIT_FAILURE_RUN;
}

static void print_keys(void) {}
#endif

static const app_option options[] = {
    APP_SET_OPTION,
    {"--size", "WxH", "of the window in pixels, 1280x720 if not given", false, APP_TAKES_ANY},
    {"--paused", NULL, "begin paused", false, APP_TAKES_ANY},
    {"--no-panels", NULL, "begin without the panel at the side; Tab shows it", false, APP_TAKES_ANY},
    {"--unfocused", "scene|pause|play", "when another window is typed into; scene pauses flocks", false, APP_TAKES_ANY},
    {"--compare", "PATH=VALUE", "the same scene beside it with another value, in step", false, APP_TAKES_ANY},
    {"--scenes", "FOLDER", "of the gallery, those that came with skein if not given", false, APP_TAKES_FOLDER},
    {"--theme", "dark|light", "of the window, instead of the one that was chosen last; F7 changes it", false,
     APP_TAKES_ANY},
    {"--scale", "N", "of letters and controls, instead of the screen's", false, APP_TAKES_ANY},
    {"--samples", "N", "samples a pixel for smooth edges, 4 if not given", false, APP_TAKES_ANY},
    APP_FOLLOW_OPTION,
    APP_THREADS_OPTION,
    APP_DEVICE_OPTION,
    APP_COMPILE_OPTION,
    {"--record", "FILE", "record all that is done, for `skein verify`; J ends it", false, APP_TAKES_FILE},
    {"--events", "FILE", "write what happens, a line each, - for the terminal", false, APP_TAKES_FILE},
    APP_END_OF_OPTIONS};

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
    options,
    NULL,
    false,
    APP_TAKES_SCENE,
    view,
    print_keys,
};
