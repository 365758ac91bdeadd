/* A point cache: pins follow given places, sample by sample, interpolated linearly. */
#include <math.h>

#include "motions/motion.h"

typedef struct cache_params {
    char *file;
    double fps;
    bool repeat;
} cache_params;

static const skein_field fields[] = {
    SK_TEXT(cache_params, file, "file", "",
            "a PC2 point cache with as many points as the body has vertices, particles or pins (in scenes; a program "
            "passes the places itself)"),
    SK_REAL(cache_params, fps, "fps", "1/s", 60, 1e-3, 1e6, "frames a second in the file (a program says its interval)"),
    SK_BOOL(cache_params, repeat, "repeat", 0, "true: from the last sample it goes on with the first, again and again"),
};

static void move(const sk_motion *motion, size_t i, double time, double place[3]) {
    const cache_params *params = motion->params;
    const sk_track *track = &motion->track;
    double last = (double)(track->sample_count - 1), at = time / track->interval;
    if (params->repeat && last > 0) at = fmod(at, last);
    if (at > last) at = last;
    double low = floor(at), s = at - low;
    const double(*a)[3] = (const double(*)[3])track->places + (size_t)low * track->particle_count + motion->column[i];
    const double(*b)[3] = s > 0 ? a + track->particle_count : a;
    for (int k = 0; k < 3; k++) place[k] = a[0][k] + s * (b[0][k] - a[0][k]);
}

const sk_motion_type sk_cache = {
    .kind = {"cache", "leads pins along the places of a point cache", SKEIN_MOTION, fields,
             sizeof fields / sizeof *fields, sizeof(cache_params)},
    .given = "file",
    .move = move,
};
