/* How many threads a step takes: the number that has proved fastest, up to those available.
 *
 * Whether threads pay depends on the work, and on other processes: two threads beside a busy process wait for each
 * other, and a step took 4.6 times as long as with one. That cannot be known beforehand, but every step can be timed,
 * and its bits do not depend on its threads. So a world begins with one, tries twice as many now and then, and keeps
 * the faster number; a trial that failed is repeated less and less often. The time lost to trials is a few per cent
 * even if every one takes five times as long.
 *
 * What a step has to do changes, too: cloth that falls into a heap has ten times as much in a second. So the steps of a
 * trial are held against those before it and those after it, not against a mean of all earlier ones; and when steps
 * take twice as long as when it was last decided, or half, it is tried again soon. A heap that lies still searches in every
 * fourth step, which takes half as much more: so there are as many steps in a trial, before it and after it. */
#ifndef SK_BASE_PACE_H
#define SK_BASE_PACE_H

#include <stdbool.h>

enum {
    SK_PACE_LEVELS = 7, /* 1, 2, 4 ... 64 threads */
    SK_PACE_TRIAL = 4   /* steps of a trial */
};

typedef struct sk_pace {
    int levels, level, most;      /* the number of levels, the present one, and the threads of the highest */
    int trying, left;             /* the level that is being tried, and for how many more steps */
    bool judging;                 /* the steps after a trial are under way */
    int tried;                    /* steps of the trial */
    double before, trial;         /* s: a step before it, in the mean, and all of its steps */
    double recent[SK_PACE_TRIAL]; /* s: the last steps on the present level, since the last trial ended; */
    int known;                    /* and how many there were */
    double last, judged;          /* s: the last step; and one when it was last decided, 0: never */
    int wait, pause;              /* steps until the next trial, and after a trial that failed */
    int stayed, since;            /* steps on the present level, and since it was last decided */
    bool up;                      /* the next trial is with more threads */
    double mean[SK_PACE_LEVELS];  /* a step's time, s, the newest weighing most; 0: not known. Not the median: threads
                                    that lose their processor cost time in few steps */
} sk_pace;

/* `always`: all threads in every step, for tests and measurements. */
void sk_pace_start(sk_pace *pace, int most, bool always);
/* The threads for the next step. */
int sk_pace_threads(const sk_pace *pace);
/* Notes the time that that step took. */
void sk_pace_note(sk_pace *pace, double seconds);

#endif
