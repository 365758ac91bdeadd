/* What makes films of one sort; between the files of film/ only.
 *
 * film.c calls all of it on the film's own thread but for `begin`, which comes before. Invariant: after
 * `begin` succeeded, exactly one `end` follows. */
#ifndef SKEIN_FILM_MAKER_H
#define SKEIN_FILM_MAKER_H

#include "film/film.h"

typedef struct film_job {
    const char *path;
    const film_format *format;
    const char *encoder;  /* libavcodec's name; NULL where the format needs none */
    film_options options; /* with a size that the format can have */
    double rate;          /* pictures a second that are really kept */
} film_job;

typedef struct film_maker {
    /* The maker's own state, or NULL after an error. */
    void *(*begin)(const film_job *job, skein_error *error);
    skein_status (*add)(void *state, const render_image *image, skein_error *error);
    /* Completes the file, or with `complete` false removes it; frees the state. */
    skein_status (*end)(void *state, bool complete, skein_error *error);
} film_maker;

extern const film_maker film_series;

/* What the module "film" brings (libav.c and what it calls), and libav with it. */
typedef struct film_libav {
    const film_maker *video, *gif;
    bool (*has_encoder)(const char *name); /* by libavcodec's name */
} film_libav;

extern const film_maker film_video, film_gif; /* within the module */

/* The module, loaded when it is first asked for; NULL after an error. */
const film_libav *film_find_libav(skein_error *error);

/* The first encoder of the format that `is_here`; NULL after an error that names what is missing and what
 * can be written all the same, for the film at `path`. */
const char *film_choose_encoder(const film_format *format, const char *path, bool (*is_here)(const char *encoder),
                                skein_error *error);
/* "out.mp4, .webm and numbered .png", say: what can be written where `is_here` holds. */
void film_list_formats(bool (*is_here)(const char *encoder), char *text, size_t size);
/* Whether libavcodec has the encoder; false where there is no libav. */
bool film_encoder_is_here(const char *name);

#endif
