/* Scenes: a JSON file (SI units) becomes a world.
 *
 *   file --io_scene_read--> description (JSON, with --set applied) --io_scene_build--> world
 *
 * Owns: the scene's document and the meshes that it names. Called by the command. Every fault is named
 * with its place, the path in the scene ("bodies.0.stretch.stiffness") or the line and column, what was
 * found and what was expected; reading goes on after a fault, so that one look shows them all. */
#ifndef SKEIN_IO_SCENE_H
#define SKEIN_IO_SCENE_H

#include "io/file.h"
#include "io/places.h"

typedef struct io_scene io_scene;

/* What makes time go on in a window. */
typedef enum io_advance { IO_BY_TIME, IO_BY_KEY } io_advance;

/* What a scene says besides its objects. Its table is the kind "scene". */
typedef struct io_scene_settings {
    int32_t version;
    char *name, *description;
    int32_t frames, threads;
    double fps, step;
    double most_stretch; /* as a share; INFINITY: any */
    double budget_ms;    /* a frame; 0: none (io/budget.h) */
    int32_t advance;     /* an io_advance */
} io_scene_settings;

/* The kind "scene": its fields and their defaults. */
const skein_kind *io_scene_kind(void);

/* What else stands at the top of a scene: "method" and the lists of objects; `index` from 0, NULL past the end. */
typedef struct io_scene_section {
    const char *name;
    skein_category category;
    const char *help;
} io_scene_section;
const io_scene_section *io_scene_section_at(size_t index);

typedef struct io_reach io_reach;

/* Where faults go, one a call; `error` holds place and words, each on one line. */
typedef struct io_faults {
    void (*report)(void *user, const skein_error *error);
    void *user;
    size_t count;          /* so far */
    const io_reach *reach; /* which files may be read (io/reach.h); NULL: all */
} io_faults;

/* ---- where scenes come from (io/scene_source.c) ---- */

/* The file that a word means: a file's own path, or where there is none the scene of that name, "birds", among those
 * that come with Skein. False, with the word itself as the path, where it means neither. */
bool io_scene_find(const char *word, char path[IO_PLACE_SIZE]);
/* Reports that it means neither, with the name that may have been meant. */
void io_scene_not_found(const char *word, io_faults *faults);
/* The names of the scenes that come with Skein, in the alphabet's order, each once. Returns how many, up to `most`. */
enum { IO_SCENE_NAME_SIZE = 64 };
size_t io_scene_names(char (*names)[IO_SCENE_NAME_SIZE], size_t most);
/* Reads all of standard input; what messages call it is IO_STDIN_NAME. */
#define IO_STDIN_NAME "standard input"
skein_status io_stdin_read(size_t most, io_bytes *out, skein_error *error);

/* ---- reading ---- */

/* The largest scene file. */
enum { IO_MOST_SCENE_BYTES = 64 << 20 };

/* Reads a scene, or a mesh as one, and applies `sets`, each "path=value" (NULL-terminated list, or NULL). In a list the place after the last
 * makes one more, "forces.2={ "type": "drag" }", and null takes one away, "forces.0=null", or a member of an object. `exporters` are the
 * kinds that its "output" may name and, if there is one, the kind of its "view", NULL-terminated. NULL where there is
 * no document to go on with; after any other fault the scene can still be built, to name the faults that only building
 * finds. */
io_scene *io_scene_read(const char *path, const char *const *sets, const skein_kind *const *exporters,
                        io_faults *faults);
/* The same from memory; `path` serves messages and finds meshes. */
io_scene *io_scene_read_text(const char *text, size_t size, const char *path, const char *const *sets,
                             const skein_kind *const *exporters, io_faults *faults);
void io_scene_free(io_scene *scene); /* NULL is allowed */

const io_scene_settings *io_scene_get(const io_scene *scene);
/* Where the mesh of a body lies, by its place in the scene, to be freed; NULL if it has none. */
char *io_scene_mesh_path(const io_scene *scene, size_t body);

/* The whole document, with the changes that were asked for (a json_t of jansson); freed with the scene. */
struct json_t *io_scene_document(const io_scene *scene);

/* Checks everything, the method's demands too, and builds the world. NULL if there was any fault, here or
 * in reading. `desc` as for skein_world_create. */
skein_world *io_scene_build(const io_scene *scene, const skein_world_desc *desc, io_faults *faults);
/* What a budget of the method came to: chosen when the scene is first built, and in the document from then on as a
 * number of substeps. Freed with the scene; its `ms` is 0 where there is no budget. */
const struct io_budget *io_scene_budget(const io_scene *scene);

/* The exporters that the scene asks for, in its order, at most one of each kind (one of each there is if it
 * asks for none). Fills up to `most`; the parameter structs are freed with the scene. */
typedef struct io_export {
    const skein_kind *kind;
    const void *params;
    bool asked; /* for by the scene; else it has no "output" */
} io_export;
size_t io_scene_exports(const io_scene *scene, io_export *exports, size_t most);
/* Sets the field `name` of all exporters that have it, and counts them. Fails, with the field's words, where the value
 * is none for it. */
skein_status io_scene_exports_set(io_scene *scene, const char *name, const skein_value *value, size_t *count,
                                  skein_error *error);

/* The parameters of the view's kind, freed with the scene; NULL if that kind was not given in reading. A text
 * whose unit is "path" is relative to the scene's folder in the file, and made to fit in here. */
const void *io_scene_view(const io_scene *scene);

/* How many whole steps of which length make one frame: the scene's step, made to fit. */
int io_scene_steps_per_frame(const io_scene_settings *settings, double *dt);

/* The scene as it was read, with what was set in it: JSON, with a newline at its end. NULL when there is no memory; free
 * it. */
char *io_scene_text(const io_scene *scene);
/* The same with the paths of its files from the root on, for wherever it is kept. */
char *io_scene_text_anywhere(const io_scene *scene);
/* The note of a recording (skein/record.h) as JSON: the scene, where it was read from, and the words of the command that
 * ran it. NULL when there is no memory; free it. */
char *io_scene_note(const io_scene *scene, const char *path, char *const *words, int count);
/* Shows the files that a document names by whole paths, as that text does, until `take` returns false, which is handed on. */
bool io_scene_each_file(const struct json_t *document, bool (*take)(void *user, const char *path), void *user);
/* A hash of all in the document that may act on the state: not of its view, its outputs, its name and its threads; of
 * files what is in them. (Numbers count as they are written: 1 is not 1.0.) */
uint64_t io_scene_hash(const io_scene *scene);
/* Writes that to a file, from which the same scene can be read: where it lies in another folder than the scene, the
 * paths of files in it become absolute. */
skein_status io_scene_write(const io_scene *scene, const char *path, skein_error *error);
/* An object of a list ("bodies", 1) as JSON, for a set "bodies.2=..." that puts it into a scene. NULL where there is none,
 * or no memory; free it. */
char *io_scene_object_text(const io_scene *scene, const char *list, size_t index);
/* The same moved aside, in metres, and under a name of its own, where it has a name. */
char *io_scene_object_beside(const io_scene *scene, const char *list, size_t index, const double by[3]);
/* The same with the members of a JSON object set, and without those that are null there; and without any that the kind,
 * which `members` may name anew by "type", does not know. */
char *io_scene_object_with(const io_scene *scene, const char *list, size_t index, const char *members);
/* A field's value as it stands in a scene and after the equals sign of a set: JSON, to all digits. NULL when there is no
 * memory; free it. */
char *io_value_json(const skein_field *field, const skein_value *value);

/* "; did you mean 'x'?" for the nearest of `count` names, or "". Returns `hint`. */
#define IO_HINT_SIZE 96
const char *io_hint(const char *name, const char *const *names, size_t count, char hint[IO_HINT_SIZE]);

#endif
