/* How many threads a step takes: as many as have proved faster, up to those that there are.
 *
 * Whether threads pay depends on the work, and on who else wants the processors: two threads beside a busy process
 * wait for each other, and a step took 4.6 times as long as by one. Nobody knows beforehand, but every step can be
 * timed, and its bits do not depend on its threads. So a world begins with one, tries twice as many now and then, and
 * keeps what was faster; what has just failed is tried less and less often. The time lost to trying is a few per
 * cent even where every trial takes five times as long. */
#ifndef SK_BASE_PACE_H
#define SK_BASE_PACE_H

#include <stdbool.h>

enum { SK_PACE_LEVELS = 7 }; /* 1, 2, 4 ... 64 threads */

typedef struct sk_pace {
    int levels, level, most;     /* how many there are, the present one, and the threads of the highest */
    int trying, left;            /* a level that is being tried, and for how many steps still */
    int wait, pause;             /* steps until the next trial, and after a trial that failed */
    int stayed;                  /* steps on the present level */
    bool up;                     /* where the next trial goes */
    double mean[SK_PACE_LEVELS]; /* of a step, s, the newest counting most; 0: not known. Not the median: what threads
                                    that lose their processor cost is in few steps */
} sk_pace;

/* `always`: all threads in every step, for tests and measurements. */
void sk_pace_start(sk_pace *pace, int most, bool always);
/* The threads for the next step. */
int sk_pace_threads(const sk_pace *pace);
/* What that step took. */
void sk_pace_note(sk_pace *pace, double seconds);

#endif
