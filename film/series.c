/* A film as numbered PNGs: name-%04d.png or name-####.png. Each appears when it is complete. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "film/maker.h"
#include "render/fail.h"

typedef struct series {
    char *path;
    size_t begin, end; /* of the number's place in the path */
    int digits, next;
} series;

/* Finds the number's place: two '#' or more, or '%', digits and 'd'. The user's text is never a format of
 * printf's. How many there are; the last one counts. */
static int find_number(const char *path, series *s) {
    int found = 0;
    for (size_t i = 0; path[i]; i++) {
        size_t hashes = strspn(path + i, "#"), digits = path[i] == '%' ? strspn(path + i + 1, "0123456789") : 0;
        bool percent = path[i] == '%' && path[i + 1 + digits] == 'd' && digits <= 2;
        if (hashes < 2 && !percent) continue;
        s->begin = i;
        s->end = i + (percent ? digits + 2 : hashes);
        s->digits = percent ? atoi(path + i + 1) : (int)hashes;
        found++;
        i = s->end - 1;
    }
    return found;
}

bool film_path_is_numbered(const char *path) {
    series s = {0};
    return find_number(path, &s) > 0;
}

static void *begin(const film_job *job, skein_error *error) {
    series *s = calloc(1, sizeof *s);
    if (!s || !(s->path = strdup(job->path))) {
        free(s);
        render_fail_memory(error, "a file name");
        return NULL;
    }
    int places = find_number(job->path, s);
    if (places == 1 && s->digits <= 20) return s;
    render_fail(error, SKEIN_ERROR_VALUE, job->path, "a name with one place for a number is needed, not %s%s",
                places > 1 ? "several"
                : places   ? "one for so many digits"
                           : "none",
                ": name-%04d.png or name-####.png");
    free(s->path);
    free(s);
    return NULL;
}

static skein_status add(void *state, const render_image *image, skein_error *error) {
    series *s = state;
    size_t room = strlen(s->path) + 40;
    char *name = malloc(room);
    if (!name) return render_fail_memory(error, "a file name");
    snprintf(name, room, "%.*s%0*d%s", (int)s->begin, s->path, s->digits, s->next++, s->path + s->end);
    skein_status status = render_image_write_png(image, name, error);
    free(name);
    return status;
}

/* Pictures that are complete stay in any case. */
static skein_status end(void *state, bool complete, skein_error *error) {
    series *s = state;
    (void)complete, (void)error;
    free(s->path);
    free(s);
    return SKEIN_OK;
}

const film_maker film_series = {begin, add, end};
