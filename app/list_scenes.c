/* skein list scenes: the scenes that come with the program, and what each shows, in the words of its own file. */
#include <stdio.h>
#include <string.h>

#include "app/list.h"

/* Calls back with each scene that there is, in the alphabet's order; false after one whose file has a fault, which is
 * printed. */
static bool each_scene(void (*take)(void *user, const char *name, const char *path, const io_scene_settings *s),
                       void *user) {
    enum { MOST = 1024 };
    static char names[MOST][IO_SCENE_NAME_SIZE];
    size_t count = io_scene_names(names, MOST);
    bool good = true;
    for (size_t i = 0; i < count; i++) {
        char path[IO_PLACE_SIZE];
        io_faults faults = {app_report_fault, NULL, 0, NULL};
        if (!io_scene_find(names[i], path)) continue;
        io_scene *scene = io_scene_read(path, NULL, app_exporters(), &faults);
        if (scene) take(user, names[i], path, io_scene_get(scene));
        else good = false;
        io_scene_free(scene);
    }
    return good;
}

static void print_scene(void *user, const char *name, const char *path, const io_scene_settings *s) {
    (void)user;
    (void)path;
    app_print_row(name, s->description[0] ? s->description : s->name);
}

static void append_scene(void *user, const char *name, const char *path, const io_scene_settings *s) {
    json_t *one = json_object();
    json_object_set_new(one, "name", json_string(name));
    json_object_set_new(one, "title", json_string(s->name));
    json_object_set_new(one, "description", json_string(s->description));
    json_object_set_new(one, "frames", json_integer(s->frames));
    json_object_set_new(one, "file", json_string(path));
    json_array_append_new(user, one);
}

int app_list_scenes(bool as_json) {
    if (!as_json) {
        printf("scenes, by name: skein view NAME, skein render NAME -o FILE\n\n");
        return each_scene(print_scene, NULL) ? EXIT_OK : EXIT_FAULT;
    }
    json_t *root = json_object(), *all = json_array();
    bool good = each_scene(append_scene, all);
    json_object_set_new(root, "scenes", all);
    good = !json_dumpf(root, stdout, JSON_INDENT(2)) && good;
    printf("\n");
    json_decref(root);
    return good ? EXIT_OK : EXIT_FAULT;
}
