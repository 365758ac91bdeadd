/* A search over all fields: words that are typed leave only the fields that have them all, in the field's name or in what
 * its object is called, over all objects. "stiff" shows each stiffness, "cloth 1 damping" those of one body. */
#include <ctype.h>
#include <string.h>

#include "viewer/panels.h"

/* Whether the text has the word somewhere, in whatever case. */
static bool has_word(const char *text, const char *word, size_t length) {
    for (; *text; text++) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)text[i]) == tolower((unsigned char)word[i])) i++;
        if (i == length) return true;
    }
    return false;
}

/* Whether each word that is searched for is in one of both texts. */
static bool has_all(const char *search, const char *field, const char *object) {
    for (const char *word = search + strspn(search, " "); *word;) {
        size_t length = strcspn(word, " ");
        if (!has_word(field, word, length) && !has_word(object, word, length)) return false;
        word += length;
        word += strspn(word, " ");
    }
    return true;
}

/* The fields of one object that are found, under its name; returns how many. */
static size_t show_found(viewer_panels *panels, const viewer_object *object, int side) {
    const viewer_side *shown = &panels->exchange->shown.sides[side];
    char words[300], title[200];
    size_t found = 0;
    snprintf(title, sizeof title, "%s %zu: %s", skein_category_text(object->category), object->index, object->name);
    snprintf(words, sizeof words, "%s %s", title, object->kind->name);
    widgets_push((const char *)shown + object->first);
    for (size_t e = 0; e < object->count; e++) {
        const viewer_entry *entry = &shown->entries[object->first + e];
        if (!has_all(panels->search, entry->field->name, words)) continue;
        if (!found++) widgets_wrapped(title, false);
        viewer_show_entry(panels, object, entry, side);
    }
    widgets_pop();
    return found;
}

bool viewer_show_search(viewer_panels *panels, int side) {
    const viewer_side *shown = &panels->exchange->shown.sides[side];
    double box[4];
    size_t found = 0;
    if (side == 0) {
        if (widgets_input("search", panels->search, sizeof panels->search))
            viewer_event(panels->exchange->events, "searched %s", panels->search);
        if (widgets_begun()) viewer_event(panels->exchange->events, "takes search");
        if (widgets_last_visible()) {
            widgets_last_frame(box);
            viewer_place_box(panels, "search", box);
        }
        widgets_help("part of a field's name, or of an object's: only what has all of the words is shown");
    }
    if (!panels->search[strspn(panels->search, " ")]) return false;
    for (size_t o = 0; o < shown->object_count; o++) found += show_found(panels, &shown->objects[o], side);
    if (!found) widgets_wrapped("no field has these words", true);
    return true;
}
