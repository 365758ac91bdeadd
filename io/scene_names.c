/* Names of bodies, groups and colliders in a scene; see scene_names.h. */
#include "io/scene_names.h"

#include <stdio.h>
#include <string.h>

enum { MOST_NAMES = 64, NAME_SIZE = 128 };

/* Those that there are, for the nearest one to be found among: the first of them, of many. */
typedef struct names {
    char data[MOST_NAMES][NAME_SIZE];
    size_t count;
} names;

/* A name within a text, without the blanks around it. */
typedef struct word {
    const char *at;
    size_t length;
} word;

/* The next of a list, between any of these characters; its length is 0 at the end. */
static word next_of(const char **list, const char *between) {
    const char *at = *list;
    while (*at && (*at == ' ' || strchr(between, *at))) at++;
    word found = {at, strcspn(at, between)};
    *list = at + found.length;
    while (found.length && at[found.length - 1] == ' ') found.length--;
    return found;
}

static bool is(word w, const char *name) {
    return w.length == strlen(name) && !memcmp(w.at, name, w.length);
}

static void add(names *all, word w) {
    if (!w.length || w.length >= NAME_SIZE || all->count == MOST_NAMES) return;
    snprintf(all->data[all->count++], NAME_SIZE, "%.*s", (int)w.length, w.at);
}

static const char *text_of(const skein_world *world, skein_handle object, const char *field) {
    skein_value value;
    return skein_get(world, object, field, &value) == SKEIN_OK && value.text ? value.text : "";
}

/* Whether an object of the category has the name, or is in a group of it, if it can be in one; and what others are called. */
static bool is_known(const skein_world *world, skein_category category, word w, names *all) {
    all->count = 0;
    for (size_t i = 0; i < skein_object_count(world, category); i++) {
        skein_handle object = skein_object_at(world, category, i);
        const char *name = text_of(world, object, "name");
        if (name[0] && is(w, name)) return true;
        add(all, (word){name, strlen(name)});
        const char *groups = category == SKEIN_BODY ? text_of(world, object, "groups") : "";
        if (groups[0] && is(w, groups)) return true; // a group's name may have commas, where it is the only one
        for (word group; (group = next_of(&groups, ",")).length; add(all, group))
            if (group.length == w.length && !memcmp(group.at, w.at, w.length)) return true;
    }
    return false;
}

static void check_name(io_place place, const skein_world *world, const char *field, skein_category category, word w) {
    names all, bodies;
    char name[NAME_SIZE], hint[IO_HINT_SIZE];
    const char *candidates[MOST_NAMES];
    if (is_known(world, category, w, &all)) return;
    snprintf(name, sizeof name, "%.*s", (int)(w.length < NAME_SIZE ? w.length : NAME_SIZE - 1), w.at);
    for (size_t i = 0; i < all.count; i++) candidates[i] = all.data[i];
    const char *hinted = io_hint(name, candidates, all.count, hint);
    if (category == SKEIN_BODY)
        io_fault(place, field, SKEIN_ERROR_NAME, "there is no body or group of the name '%s'%s", name, hinted);
    else
        io_fault(place, field, SKEIN_ERROR_NAME, "there is no collider of the name '%s'%s", name,
                 is_known(world, SKEIN_BODY, w, &bodies) ? ": it is that of a body or a group of bodies" : hinted);
}

static void check_list(io_place place, const skein_world *world, const io_settings *settings, const char *field,
                       skein_category category, const char *between) {
    const char *list = io_settings_text(settings, field);
    names all;
    if (!list || !list[0]) return;
    if (category == SKEIN_BODY && is_known(world, category, (word){list, strlen(list)}, &all))
        return; // a name may have commas
    for (word w; (w = next_of(&list, between)).length;) check_name(place, world, field, category, w);
}

void io_names_check(io_place place, const skein_world *world, const skein_kind *kind, const io_settings *settings,
                    io_names_whole whole) {
    static const struct {
        const char *field;
        skein_category of, names;
        const char *between;
        bool own; /* of some kinds, and not of all in the category */
    } lists[] = {
        {"on", SKEIN_FORCE, SKEIN_BODY, ",", false},     {"neighbours", SKEIN_FORCE, SKEIN_BODY, ",", true},
        {"ignore", SKEIN_FORCE, SKEIN_BODY, ",:", true}, {"on", SKEIN_COLLIDER, SKEIN_BODY, ",", false},
        {"on", SKEIN_MOTION, SKEIN_BODY, ",", false},    {"colliders", SKEIN_MOTION, SKEIN_COLLIDER, ",", false},
        {"to", SKEIN_MOTION, SKEIN_COLLIDER, "", true},
    };
    skein_error ignored;
    // what a program's own kinds have fields of these names for is theirs to say
    bool ours = skein_kind_find(kind->category, kind->name, &ignored) == kind;
    // a point cache has looked for its one body itself
    bool given = skein_field_find(kind, "file", NULL) != NULL;
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        bool bodies = lists[i].names == SKEIN_BODY;
        if (lists[i].of != kind->category || (lists[i].own && !ours)) continue;
        if (bodies ? whole.bodies && !given : whole.colliders)
            check_list(place, world, settings, lists[i].field, lists[i].names, lists[i].between);
    }
}
