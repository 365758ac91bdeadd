/* A run of one flock, shared by the ranks of a job: each steps the birds in its part of space, in a world of its own that has
 * room for them and for those of others within reach (skein/share.h).
 *
 * Rank 0 leads: it has the whole run's world, too, whose runner this is, so that whoever writes, measures or goes on from
 * a snapshot does so there, as on one machine. The others serve: they do what the leader calls. */
#ifndef SKEIN_RANKS_SHARED_H
#define SKEIN_RANKS_SHARED_H

#include <skein/share.h>

#include "ranks/ranks.h"

typedef struct shared_run shared_run;

/* Where parts come from. */
typedef struct shared_source {
    void *user;
    /* A world like the whole run's, but with so many birds, wherever they are; NULL after a printed fault. */
    skein_world *(*make)(void *user, size_t birds);
    void (*unmake)(void *user, skein_world *world);
} shared_source;

/* What sharing has cost so far, of all ranks. */
typedef struct shared_figures {
    int ranks;
    double imbalance;       /* of the seconds that ranks worked since the cuts were made: most by mean, less 1 */
    double exchange_share;  /* of the seconds of all steps, those that ranks exchanged birds, or waited for each other */
    double bytes_per_step;  /* that were sent, by all ranks */
    size_t cuts;            /* how often space was cut */
    size_t moved;           /* birds that went to another rank */
    size_t most_birds, most_seen; /* of a rank: its own, and others' that it sees */
} shared_figures;

/* `total` birds are in the whole run. NULL where there is no memory. */
shared_run *shared_begin(const ranks_content *ranks, int rank, int count, size_t total, shared_source source);
/* Rank 0: has the whole run's world stepped by all. Says first what of it cannot be shared. */
skein_status shared_lead(shared_run *run, skein_world *whole, double dt, skein_error *error);
/* Rank 0: all ranks tell. */
void shared_measure(shared_run *run, shared_figures *figures);
/* Rank 0: the others may go. */
void shared_dismiss(shared_run *run);
/* The other ranks: until they may. */
void shared_serve(shared_run *run);
void shared_end(shared_run *run);

#endif
