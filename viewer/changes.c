/* The list of changes; see changes.h. */
#include "viewer/changes.h"

#include <stdlib.h>
#include <string.h>

static void free_change(viewer_change *change) {
    free(change->set);
    free(change->text_before);
    free(change->text_after);
    memset(change, 0, sizeof *change);
}

void viewer_changes_free(viewer_changes *changes) {
    for (size_t i = 0; i < changes->count; i++) free_change(&changes->data[i]);
    free(changes->data);
    memset(changes, 0, sizeof *changes);
}

/* A value with its text in `text`; false when there is no memory. */
static bool copy_value(viewer_value *to, char **text, const viewer_value *from) {
    *to = *from;
    *text = from->value.text ? strdup(from->value.text) : NULL;
    to->value.text = *text;
    return *text || !from->value.text;
}

static bool fill(viewer_change *change, const char *set, const viewer_value *before, const viewer_value *after) {
    memset(change, 0, sizeof *change);
    change->set = strdup(set);
    bool good = change->set != NULL;
    if (good && before && after)
        good = copy_value(&change->before, &change->text_before, before) &&
               copy_value(&change->after, &change->text_after, after);
    if (!good) free_change(change);
    return good;
}

static bool append(viewer_changes *changes, const viewer_change *change) {
    if (changes->count == changes->room) {
        size_t room = changes->room ? 2 * changes->room : 16;
        viewer_change *grown = realloc(changes->data, room * sizeof *grown);
        if (!grown) return false;
        changes->data = grown;
        changes->room = room;
    }
    changes->data[changes->count++] = *change;
    changes->done = changes->count;
    return true;
}

/* Whether both set the same field of the same object. */
static bool same_place(const viewer_change *a, const viewer_change *b) {
    size_t length = strcspn(a->set, "=") + 1;
    bool live = a->before.field && b->before.field;
    return live && a->before.field == b->before.field && !strncmp(a->set, b->set, length);
}

bool viewer_changes_add(viewer_changes *changes, const char *set, const viewer_value *before,
                        const viewer_value *after) {
    viewer_change change;
    if (!fill(&change, set, before, after)) return false;
    viewer_change *last = changes->done > changes->given ? &changes->data[changes->done - 1] : NULL;
    if (last && !last->whole && same_place(last, &change)) {
        char *text = last->text_before;
        viewer_value first = last->before;
        last->text_before = NULL;
        free_change(last);
        free(change.text_before);
        *last = change;
        last->before = first, last->text_before = text;
    } else {
        while (changes->count > changes->done) free_change(&changes->data[--changes->count]);
        if (!append(changes, &change)) {
            free_change(&change);
            return false;
        }
    }
    while (changes->count > changes->done) free_change(&changes->data[--changes->count]);
    return true;
}

void viewer_changes_close(viewer_changes *changes) {
    if (changes->done > changes->given) changes->data[changes->done - 1].whole = true;
}

void viewer_changes_drop(viewer_changes *changes, const char *set) {
    for (size_t i = changes->done; i-- > changes->given;) {
        if (strcmp(changes->data[i].set, set) != 0) continue;
        free_change(&changes->data[i]);
        changes->count--, changes->done--;
        memmove(&changes->data[i], &changes->data[i + 1], (changes->count - i) * sizeof *changes->data);
        return;
    }
}

size_t viewer_changes_back(const viewer_changes *changes, size_t end) {
    if (end > changes->given) end--;
    while (end > changes->given && changes->data[end].joined) end--;
    return end;
}

size_t viewer_changes_on(const viewer_changes *changes, size_t from) {
    if (from < changes->count) from++;
    while (from < changes->count && changes->data[from].joined) from++;
    return from;
}

const char **viewer_changes_sets(const viewer_changes *changes) {
    const char **sets = malloc((changes->done + 1) * sizeof *sets);
    for (size_t i = 0; sets && i < changes->done; i++) sets[i] = changes->data[i].set;
    if (sets) sets[changes->done] = NULL;
    return sets;
}

bool viewer_changes_copy(viewer_changes *to, const viewer_changes *from) {
    *to = (viewer_changes){NULL, 0, 0, 0, 0};
    for (size_t i = 0; i < from->count; i++) {
        const viewer_change *source = &from->data[i];
        viewer_change change;
        bool live = source->before.field != NULL;
        if (!fill(&change, source->set, live ? &source->before : NULL, live ? &source->after : NULL)) break;
        change.joined = source->joined, change.shared = source->shared, change.whole = source->whole;
        if (!append(to, &change)) {
            free_change(&change);
            break;
        }
    }
    bool good = to->count == from->count;
    if (!good) viewer_changes_free(to);
    else to->given = from->given, to->done = from->done;
    return good;
}
