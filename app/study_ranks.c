/* Rows run by the ranks of an MPI job. Rank 0 keeps the folder and runs rows like the others: between the frames of its
 * own row it hears who wants another, so that nobody waits longer than a frame. Messages are a row's number one way, and
 * a result as JSON the other way; an empty one asks for the first row. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/ranks.h"
#include "app/study.h"

static const ranks_content *ranks;
static int own_rank, rank_count;

int study_ranks_begin(int *count) {
    int here;
    ranks = app_ranks_join("skein study", "take --jobs or --part", &own_rank, &rank_count, &here);
    *count = rank_count;
    return ranks ? own_rank : -1;
}

void study_ranks_end(void) {
    if (ranks) ranks->end();
}

/* ---- rank 0 ---- */

typedef struct dealer {
    study_work *work;
    int waiting; /* ranks that have not yet been told to go */
} dealer;

/* Hears one rank: keeps its result, and tells it the next row, or that there is none. */
static void serve_one(dealer *d, int from, size_t size) {
    char *text = malloc(size + 1);
    if (!text) {
        fprintf(stderr, "skein study: out of memory\n");
        exit(EXIT_FAILURE_RUN); // MPI ends the others
    }
    ranks->receive(from, text, size);
    bool goes_on = !size || study_take(d->work, json_loadb(text, size, 0, NULL));
    free(text);
    unsigned long long row = goes_on ? study_deal(d->work) : SIZE_MAX;
    if (row == SIZE_MAX) row = ~0ull, d->waiting--;
    ranks->send(from, &row, sizeof row);
}

static void serve(void *user) {
    dealer *d = user;
    int from;
    size_t size;
    while (d->waiting && ranks->has_come(false, &from, &size)) serve_one(d, from, size);
}

static void deal(study_work *work) {
    dealer d = {work, rank_count - 1};
    for (size_t row; (row = study_deal(work)) != SIZE_MAX;) study_take(work, study_run(work, row, serve, &d));
    while (d.waiting) {
        int from;
        size_t size;
        if (ranks->has_come(true, &from, &size)) serve_one(&d, from, size);
    }
}

/* ---- the others ---- */

static void run_for_dealer(const study_work *work) {
    char *text = NULL;
    for (;;) {
        unsigned long long row;
        int from;
        size_t size;
        ranks->send(0, text ? text : "", text ? strlen(text) : 0);
        free(text);
        ranks->has_come(true, &from, &size);
        ranks->receive(from, &row, sizeof row);
        if (row == ~0ull) return;
        json_t *result = study_run(work, (size_t)row, NULL, NULL);
        text = result ? json_dumps(result, JSON_COMPACT | JSON_REAL_PRECISION(17)) : NULL;
        json_decref(result);
    }
}

void study_run_ranks(study_work *work) {
    if (own_rank) run_for_dealer(work);
    else deal(work);
}
