/* Space cut among ranks by recursive bisection: each cut parts a box's ranks, and as much work as they are to have, along
 * the axis that its particles are spread over most. */
#ifndef SKEIN_RANKS_CUTS_H
#define SKEIN_RANKS_CUTS_H

#include <stddef.h>

typedef struct ranks_cut {
    double at; /* m: lower ones are on the first side */
    int axis;
    int first_ranks; /* how many ranks the first side has; its cuts follow this one, then the other side's */
} ranks_cut;

/* A particle that stands for some work. */
typedef struct ranks_sample {
    double place[3], work;
} ranks_sample;

/* Makes the `ranks` - 1 cuts; the samples are put in another order. `burden` is each rank's work besides, NULL: none. The same
 * samples make the same cuts, from the same ones before: `cuts` holds those, or zeros. */
void ranks_cut_space(ranks_sample *samples, size_t count, int ranks, const double *burden, ranks_cut *cuts);
/* Whose a place is. */
int ranks_owner(const ranks_cut *cuts, int ranks, const double place[3]);
/* The box of what a rank owns: low <= place < high, infinite where no cut bounds it. */
void ranks_region(const ranks_cut *cuts, int ranks, int rank, double low[3], double high[3]);

#endif
