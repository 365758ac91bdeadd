/* What can be written, by a file's ending; see film.h. A new format is one row here. */
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "film/maker.h"
#include "io/module.h"
#include "render/fail.h"

#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

static const char *const h264[] = {"libx264", "libopenh264", NULL};
static const char *const vp9_or_av1[] = {"libvpx-vp9", "libsvtav1", "libaom-av1", NULL};
static const char *const gif[] = {"gif", NULL};

/* A GIF counts hundredths of a second, and viewers slow down what is faster than 50. */
static const film_format formats[] = {
    {".mp4", "H.264 in MP4", h264, true, 240},
    {".webm", "VP9 or AV1 in WebM", vp9_or_av1, true, 240},
    {".gif", "GIF", gif, false, 50},
    {".png", "PNG", NULL, false, 1e6},
};

const film_format *film_format_at(size_t index) {
    return index < COUNT(formats) ? &formats[index] : NULL;
}

/* ---- what there is ---- */

const film_libav *film_find_libav(skein_error *error) {
#ifdef SKEIN_FILM
    return io_module_load("film", error);
#else
    render_fail(error, SKEIN_ERROR_NAME, "",
                "this skein was built without libavcodec ('tools/setup build' installs it; then build again)");
    return NULL;
#endif
}

bool film_encoder_is_here(const char *name) {
    const film_libav *libav = film_find_libav(NULL);
    return libav && libav->has_encoder(name);
}

static const char *find_encoder(const film_format *format, bool (*is_here)(const char *encoder)) {
    for (const char *const *name = format->encoders; *name; name++)
        if (is_here(*name)) return *name;
    return NULL;
}

void film_list_formats(bool (*is_here)(const char *encoder), char *text, size_t size) {
    size_t length = 0;
    for (size_t i = 0; i < COUNT(formats); i++) {
        if (formats[i].encoders && !find_encoder(&formats[i], is_here)) continue;
        int added = snprintf(text + length, size - length, "%s%s", length ? ", " : "", formats[i].ending);
        length += (size_t)added < size - length ? (size_t)added : 0;
    }
}

bool film_format_is_here(const film_format *format) {
    return !format->encoders || find_encoder(format, film_encoder_is_here);
}

const char *film_choose_encoder(const film_format *format, const char *path, bool (*is_here)(const char *encoder),
                                skein_error *error) {
    const char *name = find_encoder(format, is_here);
    if (name) return name;
    char missing[128] = "", here[128];
    skein_error absent = {SKEIN_OK, "", ""};
    for (const char *const *one = format->encoders; *one; one++) {
        size_t length = strlen(missing);
        snprintf(missing + length, sizeof missing - length, "%s%s", length ? " or " : "", *one);
    }
    film_list_formats(is_here, here, sizeof here);
    if (film_find_libav(&absent))
        render_fail(error, SKEIN_ERROR_NAME, path,
                    "%s needs an encoder that this libavcodec has not: %s; can be written here: %s (numbered: "
                    "name-%%04d.png)",
                    format->help, missing, here);
    else
        render_fail(error, SKEIN_ERROR_NAME, path,
                    "%s needs %s, but %s%s%.350s; can be written: %s (numbered: name-%%04d.png)", format->help, missing,
                    absent.where, absent.where[0] ? ": " : "", absent.message, here);
    return NULL;
}

/* ---- by the ending ---- */

const film_format *film_format_of(const char *path, skein_error *error) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    char here[128];
    for (size_t i = 0; dot && dot > name && i < COUNT(formats); i++)
        if (!strcasecmp(dot, formats[i].ending)) return &formats[i];
    film_list_formats(film_encoder_is_here, here, sizeof here);
    if (dot && dot[1])
        render_fail(error, SKEIN_ERROR_NAME, path, "unknown ending '%.32s'; can be written here: %s", dot, here);
    else render_fail(error, SKEIN_ERROR_NAME, path, "a name with an ending is needed; can be written here: %s", here);
    return NULL;
}

void film_fit_size(const film_format *format, int32_t size[2]) {
    for (int k = 0; k < 2 && format->even; k++) size[k] = size[k] > 2 ? size[k] & ~1 : 2;
}

int film_every(const film_format *format, double rate) {
    int every = 1;
    while (rate / every > format->most_rate * (1 + 1e-9)) every++;
    return every;
}

/* ---- the exporter ---- */

static const skein_field fields[] = {
    {.name = "format",
     .type = SKEIN_FIELD_CHOICE,
     .offset = offsetof(film_options, format),
     .unit = "",
     .initial = {0},
     .least = 0,
     .most = 2,
     .choices = "mp4|webm|gif",
     .help = "H.264 in MP4, VP9 or AV1 in WebM, or GIF"},
    {.name = "size",
     .type = SKEIN_FIELD_INT2,
     .offset = offsetof(film_options, size),
     .unit = "pixels",
     .initial = {1280, 720},
     .least = 1,
     .most = 16384,
     .help = "width and height"},
    {.name = "samples",
     .type = SKEIN_FIELD_INT,
     .offset = offsetof(film_options, samples),
     .unit = "",
     .initial = {4},
     .least = 1,
     .most = 64,
     .help = "samples a pixel for smooth edges, or the most the driver has"},
    {.name = "quality",
     .type = SKEIN_FIELD_INT,
     .offset = offsetof(film_options, quality),
     .unit = "",
     .initial = {75},
     .least = 1,
     .most = 100,
     .help = "1 is a small file, 100 a faithful one; of a GIF, its colours"},
};

const skein_kind *film_exporter(void) {
    static const skein_kind kind = {
        .name = "film",
        .help = "a film of the whole run; only where a scene asks for it, as drawing takes longer than simulating",
        .category = SKEIN_EXPORTER,
        .fields = fields,
        .field_count = COUNT(fields),
        .params_size = sizeof(film_options),
    };
    return &kind;
}

film_options film_default_options(void) {
    return (film_options){.size = {(int32_t)fields[1].initial[0], (int32_t)fields[1].initial[1]},
                          .samples = (int32_t)fields[2].initial[0],
                          .quality = (int32_t)fields[3].initial[0]};
}
