/* What the files of a shared run share: shared.c (the leader, and what it calls for), part.c (a rank's own birds, and
 * those that come and go) and border.c (others' birds within reach). */
#ifndef SKEIN_RANKS_SHARED_INSIDE_H
#define SKEIN_RANKS_SHARED_INSIDE_H

#include <stdint.h>
#include <stdio.h>

#include "ranks/cuts.h"
#include "ranks/shared.h"

enum { SHARED_MOST_BODIES = 65535 };

/* A bird, or a whole body's particle, on its way to another rank: all that it is. */
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

/* Where a rank's own particles of a body are that are somewhere; `any` is 0 where there are none. */
typedef struct shared_box {
    skein_real low[3], high[3];
    int any;
} shared_box;

typedef struct shared_cells {
    int32_t low[3], high[3]; /* of a box of cells */
} shared_cells;

/* A body of the run, and what of it this rank has. */
typedef struct shared_body {
    skein_share_body of; /* the whole run's, as the leader knows it */
    int rank;            /* where it lives, if it is whole */
    size_t first, room;  /* in this rank's world */
    size_t own, seen; /* of a loose one: so many of its own, and up to `seen` others'. A whole one has all, or none */
    size_t most;      /* that were there in the last step: `seen`, of the rule that saw the most */
    bool full;        /* more came than it has room for */
} shared_body;

/* What a rank tells with each call. */
typedef struct shared_tale {
    double work;               /* seconds, since space was cut, without exchanges */
    double all_work, exchange; /* since the run began */
    double bytes;
    size_t moved, own, seen;
    size_t memory; /* bytes that its process has had at once, at most */
    int overflow;  /* more came than it has room for */
    int unsure;    /* whether that may happen in the next step */
} shared_tale;

struct shared_run {
    const ranks_content *ranks;
    int rank, count;
    shared_source source;
    shared_body *bodies;
    size_t body_count;
    skein_world *world; /* of this rank's part; NULL: none yet */
    size_t particles;   /* of that world */
    uint32_t *number;   /* of each, in the whole run */
    uint16_t *body_of;  /* of each: which body */
    ranks_cut *cuts;    /* count - 1 */
    double *burden;     /* of each rank: the work of whole bodies there, in birds */
    shared_bytes *out;  /* to each rank */
    shared_bytes in;
    shared_box *boxes;        /* (count + 1) x body_count: of all ranks, and its own */
    shared_cells *wanted;     /* body_count */
    size_t *sizes;            /* count x count */
    shared_tale tale, *tales; /* own, and of all ranks */
    size_t since_cut;         /* steps */
    double start;             /* seconds that spreading took */
    size_t cut_count, steps;
    shared_bytes before; /* own birds as a step began, while it may turn out that the room is too small */
    bool keeps, kept;    /* it is, and already was when all were spread */
    bool unclean;        /* who is its own has changed: there may be somebody left where there is room */
    bool dismissed;
    bool guessed; /* space is cut without knowing what birds cost */
    struct {
        char folder[4096];
        FILE *data, *index; /* NULL: nothing is recorded; the index is the leader's */
    } parts;
    char name_text[64];
};

/* Ends the job: there is nothing to go on with. */
_Noreturn void shared_give_up(const shared_run *run, const char *what);
/* More bytes, to be filled in. */
void *shared_grow(const shared_run *run, shared_bytes *bytes, size_t size);
/* Sends each rank its bytes, and takes what comes from the others, in their order, into `in`. */
void shared_trade(shared_run *run);

/* ---- part.c ---- */
/* Makes room in each body for so many birds; those that are there stay. */
void shared_make_room(shared_run *run, const size_t *birds);
/* Which body of the whole run a particle of it is in. */
size_t shared_body_with(const shared_run *run, uint32_t number);
/* Whether a particle of this rank's world is its own. */
static inline bool shared_is_own(const shared_run *run, uint32_t particle) {
    const shared_body *body = &run->bodies[run->body_of[particle]];
    return particle - body->first < body->own;
}
/* Whether a body lives elsewhere, and this rank's world has a shadow of it. */
static inline bool shared_is_shadow(const shared_body *body) {
    return !body->of.loose && body->of.shown && body->of.enabled && !body->own;
}
/* Of all loose bodies: its own birds, and others' that it sees. */
size_t shared_own(const shared_run *run);
size_t shared_others(const shared_run *run);
/* Nobody is its own, but whole bodies that live here: where they were is said next. */
void shared_forget_birds(shared_run *run);
/* Whether there are bodies whose birds may lie on any rank. */
bool shared_has_loose(const shared_run *run);
skein_state shared_state(shared_run *run);
/* Adds birds of its own; there is room. Of a whole body: where its particles are. */
void shared_add(shared_run *run, const shared_bird *birds, size_t count);
/* Copies its own birds. */
void shared_copy_own(shared_run *run, shared_bytes *to);
/* Birds that have crossed a cut go to the rank beyond. */
void shared_migrate(shared_run *run);
/* Cuts space by where birds are and what they cost their ranks. */
void shared_balance(shared_run *run);

/* ---- border.c: what the part's world asks for ---- */
/* Nobody is where there is room for others: so it is before a step, and what comes from others is put there in its course. */
void shared_clear_room(shared_run *run);
bool shared_measure_all(void *user, const skein_share_look *look, const skein_state *state, skein_border *border);
bool shared_send(void *user, const skein_share_look *look, const skein_cells *cells, const skein_state *state);
bool shared_receive(void *user, const skein_share_look *look, const skein_cells *cells, const skein_state *state);

/* ---- record.c: all ranks call these at once ---- */
/* The leader names the folder. */
void shared_record_open(shared_run *run, const char *folder);
void shared_record_frame(shared_run *run, double time);
void shared_record_close(shared_run *run);

double shared_seconds(void);

#endif
