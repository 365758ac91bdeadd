/* skein explain SCENE: the plan, row by row. */
#include <stdio.h>

#include "app/command.h"

static void print_line(void *user, const char *line) {
    (void)user;
    puts(line);
}

static int print_plan(const app_scene *loaded, bool fuse) {
    double dt;
    skein_device_info info = skein_world_device(loaded->world);
    int steps = io_scene_steps_per_frame(&loaded->settings, &dt);
    printf("# %s: %s, a step of %g s, %d a frame\n", loaded->path, app_method(loaded), dt, steps);
    if (info.device != SKEIN_DEVICE_CPU) printf("# on %s: %zu passes\n", info.name, info.pass_count);
    skein_world_fuse(loaded->world, fuse);
    if (!skein_world_explain(loaded->world, dt, print_line, NULL)) return EXIT_OK;
    app_print_error(skein_world_error(loaded->world));
    return EXIT_FAILURE_RUN;
}

static int explain(app_arguments *arguments) {
    app_scene loaded = {.quiet = false};
    int status = app_load(app_word(arguments), app_values(arguments, "--set"), &loaded);
    if (!status) status = app_device(&loaded, app_value(arguments, "--device"));
    if (!status) status = print_plan(&loaded, !app_given(arguments, "--unfused"));
    app_unload(&loaded);
    return status;
}

static const app_option options[] = {
    APP_SET_OPTION,
    APP_DEVICE_OPTION,
    {"--unfused", NULL, "the ops as the method writes them, before several are made one (on the processor only)", false,
     APP_TAKES_ANY},
    APP_END_OF_OPTIONS,
};

const app_command app_explain_command = {
    "explain",
    "SCENE [--set PATH=VALUE]... [--device WHERE] [--unfused]",
    "print the plan of a scene: what one step does, row by row\n\n"
    "An op names its kind, the vector it writes, what it reads, how many elements it runs over, and whether\n"
    "their order is part of the answer. Vectors: X positions, V velocities, F forces, X0 and V0 the state\n"
    "at the start of a substep, P the positions at the start of the step; w is the inverse mass.\n\n"
    "On a graphics card the ops are the same; those that look at nothing but their own particle run together, a pass\n"
    "each, with their vectors in registers.\n\n"
    "  skein explain scenes/flag.json --set method.type=symplectic_euler",
    options,
    "scene",
    false,
    APP_TAKES_SCENE,
    explain,
    NULL,
};
