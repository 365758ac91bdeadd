/* From JSON to settings: an object's members become a list of skein_setting, checked against a kind's
 * fields. Between the files of the scene reader only. */
#ifndef SKEIN_IO_SCENE_SETTINGS_H
#define SKEIN_IO_SCENE_SETTINGS_H

#include <jansson.h>

#include "io/scene.h"

typedef struct io_settings {
    skein_setting *data; /* ends with a NULL name */
    size_t count, capacity;
    char **texts; /* that the settings point to */
    size_t text_count, text_capacity;
} io_settings;

/* Where in the scene a value stands, and whom to tell about faults. */
typedef struct io_place {
    const char *file, *path; /* path: "bodies.0", or "" for the top */
    io_faults *faults;
} io_place;

/* Names a fault of the member `member` of the place ("" is the place itself). */
void io_fault(io_place place, const char *member, skein_status status, const char *format, ...) IO_PRINTF(4, 5);

/* The same where the words are lines: they show the place in a text. */
void io_fault_shown(io_place place, const char *member, skein_status status, const char *words);

/* A value in words: "the number 5", "a list of 4"; "nothing" for NULL, which a member is that is not there. Returns
 * `out`. */
#define IO_JSON_WORDS_SIZE 72
const char *io_json_words(const json_t *json, char out[IO_JSON_WORDS_SIZE]);
/* The end of "expected ...": ", not the number 5", or ": it is missing" for NULL. Returns `out`. */
const char *io_json_instead(const json_t *json, char out[IO_JSON_WORDS_SIZE]);

/* Reads the members of `object`, but for those named in `skip` (NULL-terminated). Faults are reported;
 * false when there was one. */
bool io_settings_read(io_settings *settings, io_place place, const json_t *object, const skein_kind *kind,
                      const char *const *skip);
/* The same of one value that stands elsewhere, by its field's whole name; NULL is none. */
bool io_settings_read_one(io_settings *settings, io_place place, const char *name, const json_t *json,
                          const skein_kind *kind);
/* The text of a setting, or NULL. */
const char *io_settings_text(const io_settings *settings, const char *name);
void io_settings_free(io_settings *settings);

/* A setting's value from JSON, for any field that takes texts: a list or a shape as one text. NULL if it is
 * neither; free it. */
char *io_json_join(const json_t *json);
/* A list of lists of numbers: rows, parted by commas. */
char *io_json_join_rows(const json_t *json);

/* How many numbers a field takes; 0 for texts and words. */
int io_field_numbers(const skein_field *field);

/* Sets "path=value" in a document; names stand for places in lists. `kinds` as for io_scene_read(). What the reader
 * should know goes to the list `notes` as texts. */
bool io_scene_override(json_t *root, const char *set, const skein_kind *const *kinds, io_faults *faults, json_t *notes);

/* A scene about a mesh: it falls on a ball. As io_scene_read(). */
io_scene *io_scene_of_mesh(const char *path, const char *const *sets, const skein_kind *const *exporters,
                           io_faults *faults);

/* The path of a file that the scene names: relative to the scene's folder. NULL when there is no memory; free it. */
char *io_path_beside(const char *scene, const char *file);

/* Where a scene lies. */
const char *io_scene_path(const io_scene *scene);

/* Builds a world from a whole document; NULL if there was any fault. */
skein_world *io_world_from_document(const json_t *root, const char *file, double dt, const skein_world_desc *desc,
                                    io_faults *faults);

#endif
