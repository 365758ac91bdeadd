/* skein check SCENE: read, validate, warn. */
#include <stdio.h>

#include "app/command.h"

static int check(int argc, char **argv) {
    app_option options[] = {{"--set", "PATH=VALUE", "change a value first, as for `skein run`; may be repeated", true, NULL, 0}};
    const char *words[1];
    size_t word_count;
    int status = app_parse(&app_check_command, argc, argv, options, 1, words, 1, &word_count);
    if (status < 0 && !word_count) {
        fprintf(stderr, "skein check: which scene? usage: skein check %s\n", app_check_command.usage);
        status = EXIT_FAULT;
    }
    if (status < 0) {
        app_scene loaded;
        status = app_load(words[0], options[0].values, 1, &loaded);
        skein_statistics s;
        if (!status && skein_world_statistics(loaded.world, &s) == SKEIN_OK) {
            printf("%s: good; %zu particles (%zu held), %zu constraints, %zu forces, %zu colliders, %s; %zu warning%s\n", words[0],
                   s.particles, s.held_particles, s.constraints, skein_object_count(loaded.world, SKEIN_FORCE),
                   skein_object_count(loaded.world, SKEIN_COLLIDER),
                   skein_object_kind(loaded.world, skein_object_at(loaded.world, SKEIN_METHOD, 0))->name, loaded.warnings,
                   loaded.warnings == 1 ? "" : "s");
            double dt;
            io_scene_steps_per_frame(&loaded.settings, &dt);
            // a method may not take these rules: the plan knows
            if (skein_world_explain(loaded.world, dt, NULL, NULL)) {
                app_print_error(skein_world_error(loaded.world));
                status = EXIT_FAULT;
            }
        }
        app_unload(&loaded);
    }
    app_options_free(options, 1);
    return status;
}

const app_command app_check_command = {
    "check", "SCENE [--set PATH=VALUE]...",
    "read and validate a scene; every fault is named, exit status 2 if there is one\n\n"
    "Faults name the file, the line or the path in the scene, what was found and what was expected.\n"
    "Warnings (a mesh with holes in its seams, vertices of no face) do not fail the check.",
    check,
};
