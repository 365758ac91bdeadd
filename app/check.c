/* skein check SCENE...: read, validate, warn. */
#include <stdio.h>

#include "app/stability.h"

static int print_summary(const app_scene *loaded) {
    skein_statistics s;
    if (skein_world_statistics(loaded->world, &s)) {
        app_print_error(skein_world_error(loaded->world));
        return EXIT_FAILURE_RUN;
    }
    size_t forces = skein_object_count(loaded->world, SKEIN_FORCE),
           colliders = skein_object_count(loaded->world, SKEIN_COLLIDER);
    printf("%s: good; %zu particles (%zu held), %zu constraints, %zu force%s, %zu collider%s, %s; %zu warning%s\n",
           loaded->path, s.particles, s.held_particles, s.constraints, forces, forces == 1 ? "" : "s", colliders,
           colliders == 1 ? "" : "s", app_method(loaded), loaded->warnings, loaded->warnings == 1 ? "" : "s");
    return EXIT_OK;
}

static int check_scene(const char *path, const char *const *sets) {
    app_scene loaded;
    int status = app_load(path, sets, &loaded);
    if (!status && !app_warn_of_instability(&loaded)) status = EXIT_FAILURE_RUN;
    if (!status) app_warn_of_rounding(&loaded);
    if (!status) status = print_summary(&loaded);
    app_unload(&loaded);
    return status;
}

/* The worst of the scenes' statuses; one at fault does not keep the others from being looked at. */
static int check(app_arguments *arguments) {
    int status = EXIT_OK;
    for (size_t i = 0; i < arguments->words.count; i++) {
        int one = check_scene(arguments->words.values[i], app_values(arguments, "--set"));
        if (one > status) status = one;
    }
    return status;
}

static const app_option options[] = {APP_SET_OPTION, APP_END_OF_OPTIONS};

const app_command app_check_command = {
    "check",
    "SCENE... [--set PATH=VALUE]...",
    "read and validate scenes; every fault is named, exit status 2 if there is one\n\n"
    "Faults name the file, the line or the path in the scene, what was found and what was expected.\n"
    "Warnings (a mesh with holes in its seams, a step that is too long for the method, or\n"
    "so short that positions round it away) do not fail the check.",
    options,
    "scene",
    true,
    APP_TAKES_SCENE,
    check,
    NULL,
};
