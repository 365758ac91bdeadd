/* skein explain SCENE: the plan, row by row. */
#include <stdio.h>

#include "app/command.h"

static void print_line(void *user, const char *line) {
    (void)user;
    puts(line);
}

static int print_plan(const app_scene *loaded) {
    double dt;
    int steps = io_scene_steps_per_frame(&loaded->settings, &dt);
    printf("# %s: %s, a step of %g s, %d a frame\n", loaded->path, app_method(loaded), dt, steps);
    if (!skein_world_explain(loaded->world, dt, print_line, NULL)) return EXIT_OK;
    app_print_error(skein_world_error(loaded->world));
    return EXIT_FAILURE_RUN;
}

static int explain(int argc, char **argv) {
    app_option options[] = {{"--set", "PATH=VALUE", "change a value first, as for `skein run`; may be repeated", true, NULL, 0}};
    const char *path;
    int status = app_parse(&app_explain_command, argc, argv, options, 1, "scene", &path);
    if (status < 0) {
        app_scene loaded;
        status = app_load(path, options[0].values, &loaded);
        if (!status) status = print_plan(&loaded);
        app_unload(&loaded);
    }
    app_options_free(options, 1);
    return status;
}

const app_command app_explain_command = {
    "explain", "SCENE [--set PATH=VALUE]...",
    "print the plan of a scene: what one step does, row by row\n\n"
    "A row names its kind, the vector it writes, what it reads, how many elements it runs over, and whether\n"
    "their order is part of the answer. Vectors: X positions, V velocities, F forces, X0 and V0 the state\n"
    "at the start of a substep, P the positions at the start of the step; w is the inverse mass.\n\n"
    "  skein explain scenes/flag.json --set method.type=symplectic_euler",
    explain,
};
