/* The range of an axis; see chart.h. */
#include "viewer/chart.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* What is farther from the calm half of the values than this many times its reach has blown up. */
static const float blown_up = 1000;

static int by_size(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* A curve that grows without bound leaves the axis to what was before: the middle half of all values says what is calm. */
static void leave_to_the_calm(const float *const *series, int series_count, size_t count, size_t room, size_t first,
                              float *least, float *most) {
    float *all = malloc(((size_t)series_count * count + 1) * sizeof *all);
    size_t known = 0;
    for (int s = 0; s < series_count && all; s++)
        for (size_t i = 0; series[s] && i < count; i++)
            if (isfinite(series[s][(first + i) % room])) all[known++] = series[s][(first + i) % room];
    if (known >= 4) {
        qsort(all, known, sizeof *all, by_size);
        float low = all[known / 4], high = all[known - 1 - known / 4], reach = high - low;
        reach = fmaxf(reach, 0.1f * fmaxf(fabsf(low), fabsf(high)));
        if (reach > 0 && *most > high + blown_up * reach) *most = high + 10 * reach;
        if (reach > 0 && *least < low - blown_up * reach) *least = low - 10 * reach;
    }
    free(all);
}

void viewer_chart_range(const float *const *series, int series_count, size_t first, size_t count, size_t room,
                        bool compared, float *least, float *most) {
    float all_least = FLT_MAX, all_most = -FLT_MAX, calm = FLT_MAX, low = 0, high = 0;
    for (int s = 0; s < series_count; s++) {
        float from = FLT_MAX, to = -FLT_MAX;
        for (size_t i = 0; series[s] && i < count; i++) {
            float value = series[s][(first + i) % room];
            if (!isfinite(value)) continue;
            from = fminf(from, value), to = fmaxf(to, value);
        }
        if (from > to) continue;
        all_least = fminf(all_least, from), all_most = fmaxf(all_most, to);
        float reach = fmaxf(to - from, 0.1f * fmaxf(fabsf(from), fabsf(to)));
        if (reach < calm) calm = reach, low = from, high = to;
    }
    *least = all_least <= all_most ? all_least : 0, *most = all_least <= all_most ? all_most : 0;
    if (compared && calm > 0 && calm < FLT_MAX) {
        *most = fminf(*most, high + 10 * calm);
        *least = fmaxf(*least, low - 10 * calm);
    }
    leave_to_the_calm(series, series_count, count, room, first, least, most);
    if (*most - *least < 1e-6f) *least -= 0.5f, *most += 0.5f;
    // of huge numbers half a unit is nothing: an axis is never empty
    if (!(*most > *least)) {
        float wide = 0.5f * fabsf(*most);
        *least -= wide, *most += wide;
    }
}
