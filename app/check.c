/* skein check SCENE...: read, validate, warn. */
#include <jansson.h>
#include <stdio.h>

#include "app/command.h"

static int print_summary(const app_scene *loaded) {
    skein_statistics s;
    if (skein_world_statistics(loaded->world, &s)) {
        app_print_error(skein_world_error(loaded->world));
        return EXIT_FAILURE_RUN;
    }
    size_t forces = skein_object_count(loaded->world, SKEIN_FORCE),
           colliders = skein_object_count(loaded->world, SKEIN_COLLIDER);
    printf("%s: good; %zu particles (%zu pinned), %zu constraints, %zu force%s, %zu collider%s, %s; %zu warning%s\n",
           loaded->path, s.particles, s.pinned_particles, s.constraints, forces, forces == 1 ? "" : "s", colliders,
           colliders == 1 ? "" : "s", app_method(loaded), loaded->warnings, loaded->warnings == 1 ? "" : "s");
    return EXIT_OK;
}

/* The same for programs. */
static json_t *describe(const app_scene *loaded, int status, json_t *faults, json_t *warnings) {
    json_t *json = json_object();
    skein_statistics s;
    json_object_set_new(json, "scene", json_string(loaded->path));
    json_object_set_new(json, "good", json_boolean(!status));
    json_object_set(json, "faults", faults);
    json_object_set(json, "warnings", warnings);
    if (status || skein_world_statistics(loaded->world, &s)) return json;
    const struct {
        const char *key;
        size_t count;
    } counts[] = {{"particles", s.particles},
                  {"pinned_particles", s.pinned_particles},
                  {"constraints", s.constraints},
                  {"forces", skein_object_count(loaded->world, SKEIN_FORCE)},
                  {"colliders", skein_object_count(loaded->world, SKEIN_COLLIDER)}};
    json_object_set_new(json, "method", json_string(app_method(loaded)));
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        json_object_set_new(json, counts[i].key, json_integer((json_int_t)counts[i].count));
    return json;
}

/* With a list, the scene is described in it, and not printed. */
static int check_scene(const char *path, const char *const *sets, bool quiet, json_t *list) {
    app_scene loaded = {.quiet = quiet, .fault_list = json_array(), .warning_list = json_array()};
    int status = app_load(path, sets, &loaded);
    if (!status) app_advise(&loaded);
    if (list) json_array_append_new(list, describe(&loaded, status, loaded.fault_list, loaded.warning_list));
    else if (!status && !quiet) status = print_summary(&loaded);
    app_unload(&loaded);
    json_decref(loaded.fault_list);
    json_decref(loaded.warning_list);
    return status;
}

/* The worst of the scenes' statuses; one at fault does not keep the others from being looked at. */
static int check(app_arguments *arguments) {
    int status = EXIT_OK;
    json_t *list = app_given(arguments, "--json") ? json_array() : NULL;
    for (size_t i = 0; i < arguments->words.count; i++) {
        int one = check_scene(arguments->words.values[i], app_values(arguments, "--set"),
                              list || app_given(arguments, "--quiet"), list);
        if (one > status) status = one;
    }
    if (list && !json_dumpf(list, stdout, JSON_INDENT(2))) printf("\n");
    json_decref(list);
    return status;
}

static const app_option options[] = {
    APP_SET_OPTION,
    APP_BOUNDS_OPTIONS,
    {"--json", NULL, "print a list of scenes as JSON, each with its faults, warnings and counts", false, APP_TAKES_ANY},
    APP_QUIET_OPTION,
    APP_END_OF_OPTIONS};

const app_command app_check_command = {
    "check",
    "SCENE... [--set PATH=VALUE]... [--json]",
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
