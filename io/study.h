/* Studies: a scene run many times with fields varied, and a table of what was measured (docs/studies.md).
 *
 *   STUDY.json --io_study_read--> io_study --io_study_run--> a row's result, one a run --io_study_folder--> rows.journal
 *                                                                                      --> table.csv, table.h5
 *
 * Owns: which rows a study has, what one measures, and the folder that keeps them. Which process runs which row is the
 * caller's: the command's (app/study.c) or Python's. Invariants: a row depends on the study and its number alone, never
 * on who ran it or on what ran before; the tables depend on the rows alone, so that a study that was killed and taken up
 * again ends with the bytes of one that was not. */
#ifndef SKEIN_IO_STUDY_H
#define SKEIN_IO_STUDY_H

#include <jansson.h>

#include "io/scene.h"

typedef struct io_study io_study;

enum { IO_STUDY_MOST_VARIED = 32, IO_STUDY_MOST_MEASURES = 64, IO_STUDY_MOST_ROWS = 10000000 };

/* Reads a study and its scene, builds its first row to find faults, and reports all of them. `exporters` as for
 * io_scene_read(). NULL after a fault. */
io_study *io_study_read(const char *path, const skein_kind *const *exporters, io_faults *faults);
/* The same from memory; `path` serves messages and finds the scene. */
io_study *io_study_read_text(const char *text, size_t size, const char *path, const skein_kind *const *exporters,
                             io_faults *faults);
void io_study_free(io_study *study); /* NULL is allowed */

/* ---- what it consists of ---- */

size_t io_study_rows(const io_study *study);
const char *io_study_name(const io_study *study); /* never NULL */
/* The path that field `v` is varied under, NULL past the last. */
const char *io_study_varied(const io_study *study, size_t v);
/* Whether it is drawn at random; else its values are listed, and `count` receives how many there are. */
bool io_study_is_random(const io_study *study, size_t v, size_t *count);
/* The column that measure `m` goes to, NULL past the last. */
const char *io_study_measure(const io_study *study, size_t m);
/* Its unit, or "". */
const char *io_study_measure_unit(const io_study *study, size_t m);
/* The value of field `v` in a row: a new reference, NULL without memory. */
json_t *io_study_value(const io_study *study, size_t row, size_t v);
/* The command that does a row again, in the study's folder; to be freed. NULL without memory. */
char *io_study_command(const io_study *study, size_t row);
/* What it says of its plot, or NULL; its members are checked. */
const json_t *io_study_plot(const io_study *study);

/* ---- a row ---- */

/* Runs a row: on `threads` threads, which changes no bit. `go_on` (or NULL) is asked once a frame, and ends the run by
 * false. Returns an object: row, outcome ("good"; "blew up" or "beyond bounds" as skein run would say; "refused", of
 * which "said" has the words; "stopped", by go_on), said, frames, steps, time, measures (a list, null where there is no
 * number), state_hash, scene_hash, skein, precision, seconds. NULL without memory. May be called from any thread. */
json_t *io_study_run(const io_study *study, size_t row, int threads, bool (*go_on)(void *user), void *user);
/* The row of a run that did not live to tell. */
json_t *io_study_crashed(const io_study *study, size_t row, const char *said);

/* What stands in the column "skein" of every row: the version, and behind it what the caller knows of its build. To be
 * called before rows are run; the text has to live as long. */
void io_study_built(io_study *study, const char *version);

/* ---- the folder ---- */

typedef struct io_study_folder io_study_folder;

/* Opens a folder for one writer, making it if need be: the rows that are in it count as done. `part` of `parts` (1 of 1:
 * all) names the rows that this writer is to add, every parts-th from the part-th on. Fails where the folder has rows of
 * another study, or another process writes the same part. */
io_study_folder *io_study_folder_open(const io_study *study, const char *path, size_t part, size_t parts,
                                      skein_error *error);
void io_study_folder_close(io_study_folder *folder); /* NULL is allowed */
/* Reads what other parts have written meanwhile. */
skein_status io_study_folder_look(io_study_folder *folder, skein_error *error);
/* Whether a row is there, and need not be run again. */
bool io_study_folder_has(const io_study_folder *folder, size_t row);
/* Of the rows of this part, those that are to be run. */
size_t io_study_folder_missing(const io_study_folder *folder);
/* The first row of the part from `row` on that is to be run; SIZE_MAX where there is none. */
size_t io_study_folder_next(const io_study_folder *folder, size_t row);
/* All rows of the study that are there. */
size_t io_study_folder_done(const io_study_folder *folder);
/* Keeps a row, which outlives the process from then on. Takes no reference. */
skein_status io_study_folder_add(io_study_folder *folder, const json_t *result, skein_error *error);
/* The result of a row, or NULL. */
const json_t *io_study_folder_row(const io_study_folder *folder, size_t row);
/* Writes table.csv, table.h5 and timings.csv of the rows that are there. */
skein_status io_study_folder_tables(const io_study_folder *folder, skein_error *error);
/* The descriptor that holds the part for this process: children close it. */
int io_study_folder_lock(const io_study_folder *folder);

/* ---- between its files ---- */

/* One thing to be measured (io/study_measure.c). */
typedef enum io_study_over { IO_STUDY_END, IO_STUDY_MEAN, IO_STUDY_LEAST, IO_STUDY_MOST } io_study_over;
typedef struct io_study_quantity io_study_quantity;
typedef struct io_study_wanted {
    const io_study_quantity *what;
    char *name, *body; /* body: NULL, all or the first that will do */
    io_study_over over;
    double from; /* s: what was before does not count */
    int every;   /* frames */
} io_study_wanted;
typedef struct io_study_note {
    double sum, least, most, last;
    size_t count;
} io_study_note;

const io_study_quantity *io_study_quantity_find(const char *name, char hint[IO_HINT_SIZE]);
const char *io_study_quantity_unit(const io_study_quantity *what);
/* Whether it is of a body, and not of the whole world. */
bool io_study_quantity_of_body(const io_study_quantity *what);
/* The names of all, by their place; NULL past the last. */
const char *io_study_quantity_at(size_t index, const char **unit, const char **help);
/* Notes what is wanted at a frame, which is the last one or not. Fails with the world's words, or where there is no such
 * body. */
skein_status io_study_measure_now(skein_world *world, const io_study_wanted *wanted, io_study_note *notes, size_t count,
                                  int frame, bool last, skein_error *error);
double io_study_measured(const io_study_wanted *wanted, const io_study_note *note);

/* A number with as few digits as give it back; "nan" and "inf" as such. Returns `text`. */
const char *io_study_number(double x, char text[32]);
/* The study as its folder keeps it, and the scene beside it; both end with a newline. */
const char *io_study_text(const io_study *study);
const char *io_study_scene_text(const io_study *study);
/* Rows to files (io/study_table.c); `rows` has a result or NULL for each. */
skein_status io_study_write_tables(const io_study *study, json_t *const *rows, const char *folder, skein_error *error);

#endif
