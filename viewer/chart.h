/* What a chart's axis spans. Called by widgets.cpp, which draws it. */
#ifndef SKEIN_VIEWER_CHART_H
#define SKEIN_VIEWER_CHART_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All finite values of `count` from `first` on in rings of `room`; entries of `series` may be NULL. Where two things are
 * compared, those of the calmer one with as much again and ten times that: what blows up leaves the picture at its edge,
 * and what it is compared with stays to be seen; so does what one alone was before it blew up. Never empty, always finite. */
void viewer_chart_range(const float *const *series, int series_count, size_t first, size_t count, size_t room,
                        bool compared, float *least, float *most);

#ifdef __cplusplus
}
#endif
#endif
