/* Recursive bisection of samples. */
#include "ranks/cuts.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

static int compare(const ranks_sample *a, const ranks_sample *b, int axis) {
    return (a->place[axis] > b->place[axis]) - (a->place[axis] < b->place[axis]);
}

static int compare_x(const void *a, const void *b) {
    return compare(a, b, 0);
}

static int compare_y(const void *a, const void *b) {
    return compare(a, b, 1);
}

static int compare_z(const void *a, const void *b) {
    return compare(a, b, 2);
}

/* The one that the last cut was across stays while it is nearly the longest, so that few have to move. */
static int longest_axis(const ranks_sample *samples, size_t count, int last) {
    double most = -1;
    int axis = 0;
    for (int k = 0; k < 3; k++) {
        double low = count ? samples[0].place[k] : 0, high = low;
        for (size_t i = 1; i < count; i++) {
            if (samples[i].place[k] < low) low = samples[i].place[k];
            if (samples[i].place[k] > high) high = samples[i].place[k];
        }
        double length = (high - low) * (k == last ? 1.5 : 1);
        if (length > most) most = length, axis = k;
    }
    return axis;
}

/* The work that `ranks` are to have of `all`, beside the burdens that they have: as even as can be. A rank with a larger
 * burden than its share gets none, and the others share the rest. */
static double part_of(double all, int first, int ranks, const double *burden) {
    bool full[ranks];
    int open = 0;
    for (int r = 0; r < ranks; r++) full[r] = false;
    for (bool again = true; again;) {
        double work = all;
        open = 0, again = false;
        for (int r = 0; r < ranks; r++)
            if (!full[r]) work += burden ? burden[r] : 0, open++;
        for (int r = 0; r < ranks && burden; r++)
            if (!full[r] && open > 1 && burden[r] > work / open) full[r] = again = true;
    }
    double work = all, part = 0;
    for (int r = 0; r < ranks; r++)
        if (!full[r] && burden) work += burden[r];
    for (int r = 0; r < first; r++)
        if (!full[r]) part += work / open - (burden ? burden[r] : 0);
    return part;
}

void ranks_cut_space(ranks_sample *samples, size_t count, int ranks, const double *burden, ranks_cut *cuts) {
    static int (*const comparisons[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
    if (ranks < 2) return;
    int first = ranks / 2, axis = longest_axis(samples, count, cuts->first_ranks ? cuts->axis : -1);
    double all = 0, sum = 0;
    for (size_t i = 0; i < count; i++) all += samples[i].work;
    if (count) qsort(samples, count, sizeof *samples, comparisons[axis]);
    size_t part = 0;
    double wanted = part_of(all, first, ranks, burden);
    while (part < count && sum + samples[part].work / 2 < wanted) sum += samples[part++].work;
    *cuts = (ranks_cut){part < count ? samples[part].place[axis]
                        : count      ? samples[count - 1].place[axis]
                                     : 0,
                        axis, first};
    ranks_cut_space(samples, part, first, burden, cuts + 1);
    ranks_cut_space(samples + part, count - part, ranks - first, burden ? burden + first : NULL, cuts + first);
}

int ranks_owner(const ranks_cut *cuts, int ranks, const double place[3]) {
    int rank = 0;
    while (ranks > 1) {
        int first = cuts->first_ranks;
        if (place[cuts->axis] < cuts->at) {
            cuts++;
            ranks = first;
        } else {
            cuts += first;
            rank += first;
            ranks -= first;
        }
    }
    return rank;
}

void ranks_region(const ranks_cut *cuts, int ranks, int rank, double low[3], double high[3]) {
    for (int k = 0; k < 3; k++) low[k] = -INFINITY, high[k] = INFINITY;
    while (ranks > 1) {
        int first = cuts->first_ranks, axis = cuts->axis;
        if (rank < first) {
            high[axis] = fmin(high[axis], cuts->at);
            cuts++;
            ranks = first;
        } else {
            low[axis] = fmax(low[axis], cuts->at);
            cuts += first;
            rank -= first;
            ranks -= first;
        }
    }
}
