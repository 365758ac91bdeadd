/* Films: pictures in, a file that plays out.
 *
 *     picture --film_add--> queue --thread--> maker (video.c, gif.c, series.c) --> file
 *
 * Called by the command. A film is made on a thread of its own, so that drawing goes on meanwhile. The
 * file's ending says what it becomes. Invariant: the pictures of a film have one size and come in order;
 * MP4 and WebM grow on the disk as they come, so that what a killed process leaves can be played. */
#ifndef SKEIN_FILM_FILM_H
#define SKEIN_FILM_FILM_H

#include "render/image.h"
#include "skein/skein.h"

/* What a file's ending stands for. */
typedef struct film_format {
    const char *ending;          /* ".mp4" */
    const char *help;            /* "H.264 in MP4" */
    const char *const *encoders; /* libavcodec's names, the best first, NULL-terminated; NULL: needs none */
    bool even;                   /* both sides of a picture must be even */
    double most_rate;            /* pictures a second; more are thinned out */
} film_format;

/* All formats, `index` from 0; NULL past the end. */
const film_format *film_format_at(size_t index);
/* The format of a path; NULL if its ending is unknown: `error` names those that can be written here. */
const film_format *film_format_of(const char *path, skein_error *error);
/* Whether there is an encoder for it here. */
bool film_format_is_here(const film_format *format);
/* Whether the path has a number's place, "name-%04d.png" or "name-####.png". */
bool film_path_is_numbered(const char *path);

/* The fields of the exporter "film", and what a film is asked for. */
typedef struct film_options {
    int32_t format;  /* index of a format: what the exporter writes; film_create goes by the path */
    int32_t size[2]; /* width and height, pixels */
    int32_t samples; /* a pixel, for whoever draws */
    int32_t quality; /* 1 to 100 */
} film_options;

const skein_kind *film_exporter(void);
film_options film_default_options(void);

/* The nearest size that the format can have, none greater. */
void film_fit_size(const film_format *format, int32_t size[2]);
/* One picture in so many is kept, for the format's sake; the film plays at `rate` / this. */
int film_every(const film_format *format, double rate);

typedef struct film film;

/* Begins a film; what `path` held before is gone once this succeeds. `rate`: pictures a second, as they
 * will be added. NULL on failure: a missing encoder, a folder that cannot be written. */
film *film_create(const char *path, const film_options *options, double rate, skein_error *error);
/* Adds the next picture; the image is left with other pixels, of the same size or none. Waits where the
 * film is some pictures behind. A failure may belong to an earlier picture, and stays. */
skein_status film_add(film *f, render_image *image, skein_error *error);
/* Waits for the end of the film, completes the file and frees the film in any case. */
skein_status film_finish(film *f, skein_error *error);
/* Ends without completing, and removes the file. NULL is allowed. */
void film_abandon(film *f);

#endif
