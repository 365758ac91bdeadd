/* What a study is, between its own files only (io/study.h). */
#ifndef SKEIN_IO_STUDY_INSIDE_H
#define SKEIN_IO_STUDY_INSIDE_H

#include "io/scene_settings.h"
#include "io/study.h"

#define COUNT_OF(array_) (sizeof(array_) / sizeof *(array_))

typedef struct study_varied {
    const char *path;
    json_t *values; /* a list; NULL: drawn at random */
    bool is_random, whole, by_ratio;
    double from, to;
} study_varied;

struct io_study {
    json_t *root; /* as it was read */
    const json_t *plot;
    char *name, *scene_text, *text;
    const char *built;
    const skein_kind *const *exporters;
    study_varied varied[IO_STUDY_MOST_VARIED];
    size_t varied_count;
    io_study_wanted wanted[IO_STUDY_MOST_MEASURES];
    size_t wanted_count;
    size_t repeat, rows;
    uint64_t seed;
    bool good; /* false: there was no memory */
};

/* "path=value" as --set takes it; NULL without memory. */
char *study_set_text(const char *path, const json_t *value);
/* Those of a row, ended by NULL; NULL without memory. */
char **study_sets(const io_study *study, size_t row);
void study_free_sets(char **sets);
/* The columns that every table has behind those that are varied and measured, and before them; NULL past the last. */
const char *io_study_column_at(size_t index);
/* JSON with as few digits as give all numbers back. */
char *study_short_json(const json_t *value);

#endif
