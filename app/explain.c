/* skein explain SCENE: the plan, row by row. */
#include <stdio.h>

#include "app/command.h"

static void print_line(void *user, const char *line) {
    (void)user;
    puts(line);
}

static int print_plan(const app_scene *loaded) {
    double dt;
    skein_device_info info = skein_world_device(loaded->world);
    int steps = io_scene_steps_per_frame(&loaded->settings, &dt);
    printf("# %s: %s, a step of %g s, %d a frame\n", loaded->path, app_method(loaded), dt, steps);
    if (info.device != SKEIN_DEVICE_CPU) printf("# on %s: %zu passes\n", info.name, info.pass_count);
    if (!skein_world_explain(loaded->world, dt, print_line, NULL)) return EXIT_OK;
    app_print_error(skein_world_error(loaded->world));
    return EXIT_FAILURE_RUN;
}

static int explain(int argc, char **argv) {
    app_option options[] = {
        {"--set", "PATH=VALUE", "change a value first, as for `skein run`; may be repeated", true, NULL, 0},
        app_device_option,
    };
    enum { COUNT = sizeof options / sizeof *options };
    const char *path;
    int status = app_parse(&app_explain_command, argc, argv, options, COUNT, "scene", &path);
    if (status < 0) {
        app_scene loaded;
        status = app_load(path, options[0].values, &loaded);
        if (!status) status = app_device(&loaded, app_value(options, COUNT, "--device"));
        if (!status) status = print_plan(&loaded);
        app_unload(&loaded);
    }
    app_options_free(options, COUNT);
    return status;
}

const app_command app_explain_command = {
    "explain",
    "SCENE [--set PATH=VALUE]... [--device WHERE]",
    "print the plan of a scene: what one step does, row by row\n\n"
    "A row names its kind, the vector it writes, what it reads, how many elements it runs over, and whether\n"
    "their order is part of the answer. Vectors: X positions, V velocities, F forces, X0 and V0 the state\n"
    "at the start of a substep, P the positions at the start of the step; w is the inverse mass.\n\n"
    "On a graphics card the rows are the same; those that look at nothing but their own particle run together, a pass\n"
    "each, with their vectors in registers.\n\n"
    "  skein explain scenes/flag.json --set method.type=symplectic_euler",
    explain,
};
