/* Where steps are computed: the option --device of the subcommands that step. */
#include <stdio.h>
#include <string.h>

#include "app/command.h"

static void say(const app_scene *loaded, const char *format, const char *what) {
    if (loaded->quiet) return;
    fputs("skein: ", stderr);
    fprintf(stderr, format, what);
    fputc('\n', stderr);
}

/* Goes to the card and makes a plan there; says in `reason` why not. */
static bool try_card(app_scene *loaded, skein_error *reason) {
    skein_world *world = loaded->world;
    double dt;
    io_scene_steps_per_frame(&loaded->settings, &dt);
    if (!skein_world_device_set(world, SKEIN_DEVICE_GPU) && !skein_world_explain(world, dt, NULL, NULL)) return true;
    *reason = *skein_world_error(world);
    skein_world_device_set(world, SKEIN_DEVICE_CPU);
    return false;
}

int app_device(app_scene *loaded, const char *word) {
    skein_error reason;
    if (!word || !strcmp(word, "cpu")) return EXIT_OK;
    bool automatic = !strcmp(word, "auto");
    if (!try_card(loaded, &reason)) {
        if (!automatic) {
            app_print_error(&reason);
            return EXIT_FAILURE_RUN;
        }
        say(loaded, "running on the processor: %s", reason.message);
        return EXIT_OK;
    }
    skein_device_info info = skein_world_device(loaded->world);
    if (info.software && automatic) {
        say(loaded, "running on the processor: there is no graphics card, only %s", info.name);
        skein_world_device_set(loaded->world, SKEIN_DEVICE_CPU);
    } else if (info.software) {
        say(loaded, "warning: there is no graphics card; the processor plays one, slowly: %s", info.name);
    } else {
        say(loaded, "running on %s", info.name);
    }
    return EXIT_OK;
}
