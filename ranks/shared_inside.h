/* What the files of a shared run share: shared.c (the leader, and what it calls for), part.c (a rank's own birds, and
 * those that come and go) and border.c (others' birds within reach). */
#ifndef SKEIN_RANKS_SHARED_INSIDE_H
#define SKEIN_RANKS_SHARED_INSIDE_H

#include <stdint.h>

#include "ranks/cuts.h"
#include "ranks/shared.h"

/* A bird on its way to another rank: all that it is. */
typedef struct shared_bird {
    uint32_t number; /* in the whole run */
    skein_real position[4], velocity[4];
} shared_bird;

/* One that another rank looks at. */
typedef struct shared_seen {
    uint32_t number;
    skein_real position[3], velocity[3];
} shared_seen;

/* Bytes that grow: what is sent to one rank, or has come. */
typedef struct shared_bytes {
    unsigned char *data;
    size_t size, capacity;
} shared_bytes;

/* Where a rank's own birds are that are somewhere; `any` is 0 where there are none. */
typedef struct shared_box {
    skein_real low[3], high[3];
    int any;
} shared_box;

/* What a rank tells with each call. */
typedef struct shared_tale {
    double work;            /* seconds, since space was cut, without exchanges */
    double all_work, exchange; /* since the run began */
    double bytes;
    size_t moved, own, seen;
    int overflow; /* more came than it has room for */
    int unsure;   /* whether that may happen in the next step */
} shared_tale;

struct shared_run {
    const ranks_content *ranks;
    int rank, count;
    size_t total; /* birds of the whole run */
    shared_source source;
    skein_world *world; /* of this rank's part; NULL: none yet */
    size_t room;        /* birds that it has room for */
    uint32_t *number;   /* room */
    size_t own, seen;
    ranks_cut *cuts;    /* count - 1 */
    shared_bytes *out;  /* to each rank */
    shared_bytes in;
    shared_box *boxes;  /* of all ranks */
    size_t *sizes;      /* count x count */
    shared_tale tale, *tales; /* own, and of all ranks */
    size_t since_cut;   /* steps */
    size_t cut_count, steps;
    shared_bytes before; /* own birds as a step began, while it may turn out that the room is too small */
    bool keeps, dismissed;
    bool guessed; /* space is cut without knowing what birds cost */
    char name_text[64];
};

/* Ends the job: there is nothing to go on with. */
_Noreturn void shared_give_up(const shared_run *run, const char *what);
/* More bytes, to be filled in. */
void *shared_grow(const shared_run *run, shared_bytes *bytes, size_t size);
/* Sends each rank its bytes, and takes what comes from the others, in their order, into `in`. */
void shared_trade(shared_run *run);

/* ---- part.c ---- */
/* Makes room for so many birds; those that are there stay. */
void shared_make_room(shared_run *run, size_t birds);
skein_state shared_state(shared_run *run);
/* Adds birds of its own; there is room. */
void shared_add(shared_run *run, const shared_bird *birds, size_t count);
/* Copies its own birds. */
void shared_copy_own(shared_run *run, shared_bytes *to);
/* Birds that have crossed a cut go to the rank beyond. */
void shared_migrate(shared_run *run);
/* Cuts space by where birds are and what they cost their ranks. */
void shared_balance(shared_run *run);

/* ---- border.c: what the part's world asks for ---- */
bool shared_measure_all(void *user, const skein_state *state, skein_border *border);
bool shared_exchange(void *user, const skein_cells *cells, const skein_state *state);

double shared_seconds(void);

#endif
