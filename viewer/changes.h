/* What was changed in the window since a scene was opened: in order, to be undone, done again and saved.
 *
 *     given by --set | done by hand ......... | undone, may be done again
 *     0            given                    done                       count
 *
 * Each is a "path=value" of the scene reader, so that the file with all that is done on top is the scene as tuned. A
 * change of a living object knows both values, and is undone in place; any other by building the scene anew. Invariant:
 * given <= done <= count. */
#ifndef SKEIN_VIEWER_CHANGES_H
#define SKEIN_VIEWER_CHANGES_H

#include "skein/skein.h"

/* A field of an object: where it is, and a value of its type; a text is the holder's. */
typedef struct viewer_value {
    skein_category category;
    size_t index;
    const skein_field *field; /* of the tables, which last; NULL: nothing that can be set in place */
    skein_value value;
} viewer_value;

typedef struct viewer_change {
    char *set;                      /* "path=value" */
    viewer_value before, after;     /* `field` NULL: the scene has to be built anew */
    char *text_before, *text_after; /* of texts */
    bool joined;                    /* done and undone together with the one before it */
    bool shared;                    /* done in place in both of two worlds */
    bool whole;                     /* no later one of the same field joins it */
} viewer_change;

typedef struct viewer_changes {
    viewer_change *data;
    size_t given, done, count, room;
} viewer_changes;

/* Adds one, and forgets those that were undone. One right after another of the same field joins it (a slider that is
 * dragged is one change). `before` and `after` are copied; NULL where the scene has to be built anew. False when there
 * is no memory, and then nothing has changed. */
bool viewer_changes_add(viewer_changes *changes, const char *set, const viewer_value *before, const viewer_value *after);
/* The last one is whole: what is changed next is another change. */
void viewer_changes_close(viewer_changes *changes);
/* Takes one out, whatever came after it; `set` as it was added. Nothing where it is not there. */
void viewer_changes_drop(viewer_changes *changes, const char *set);
/* The first of those that are undone together with the one before `end`; and the end of those done again with `from`. */
size_t viewer_changes_back(const viewer_changes *changes, size_t end);
size_t viewer_changes_on(const viewer_changes *changes, size_t from);
/* The sets of all that is done, NULL-terminated, pointing into `changes`; free the list. NULL when there is no memory. */
const char **viewer_changes_sets(const viewer_changes *changes);
bool viewer_changes_copy(viewer_changes *to, const viewer_changes *from);
void viewer_changes_free(viewer_changes *changes);

#endif
