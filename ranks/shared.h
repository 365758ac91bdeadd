/* A run shared by the ranks of a job: each steps the birds in its part of space, in a world of its own that has room for them
 * and for those of others within reach (skein/share.h), and whole bodies that are no flocks, which are dealt by what they
 * cost.
 *
 * Rank 0 leads: it has the whole run's world, too, whose runner this is, so that whoever writes, measures or goes on from
 * a snapshot does so there, as on one machine. The others serve: they do what the leader calls. */
#ifndef SKEIN_RANKS_SHARED_H
#define SKEIN_RANKS_SHARED_H

#include <skein/share.h>

#include "ranks/ranks.h"

typedef struct shared_run shared_run;

/* What a part has of a body. */
typedef struct shared_wanted {
    bool loose;
    size_t birds; /* of a loose one: so many, wherever they are */
    bool here;    /* of a whole one; else it is not enabled there, */
    bool shadow;  /* or a shadow */
} shared_wanted;

/* Where parts come from. */
typedef struct shared_source {
    void *user;
    /* A world like the whole run's, with these bodies; NULL after a printed fault. */
    skein_world *(*make)(void *user, const shared_wanted *bodies, size_t count);
    void (*unmake)(void *user, skein_world *world);
} shared_source;

/* What sharing has cost so far, of all ranks. */
typedef struct shared_figures {
    int ranks;
    double imbalance;      /* of the seconds that ranks worked since the cuts were made: most by mean, less 1 */
    double exchange_share; /* of the seconds of all steps, those that ranks exchanged birds, or waited for each other */
    double bytes_per_step; /* that were sent, by all ranks */
    double start_seconds;  /* to make parts and send all to them, before the first step: in no other figure */
    size_t cuts;           /* how often space was cut */
    size_t moved;          /* birds that went to another rank */
    size_t most_birds, most_seen; /* of a rank: its own, and others' that it sees */
    size_t most_memory;  /* bytes that a rank but the first, which has the whole run once more, has had at once */
    size_t whole_bodies; /* that live on one rank each */
} shared_figures;

/* NULL where there is no memory. */
shared_run *shared_begin(const ranks_content *ranks, int rank, int count, shared_source source);
/* Rank 0: has the whole run's world stepped by all. Says first what of it cannot be shared. */
skein_status shared_lead(shared_run *run, skein_world *whole, double dt, skein_error *error);
/* Rank 0: has each rank write what is its own into a file in this folder, which is there, and an index beside it, FOLDER.xdmf;
 * from the first step on, a frame with each call. What cannot be written ends the job with words. */
void shared_record(shared_run *run, const char *folder, double time);
/* Rank 0: all ranks tell. */
void shared_measure(shared_run *run, shared_figures *figures);
/* Rank 0: the others may go. */
void shared_dismiss(shared_run *run);
/* The other ranks: until they may. */
void shared_serve(shared_run *run);
void shared_end(shared_run *run);

#endif
