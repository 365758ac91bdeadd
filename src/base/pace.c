/* Trials with more and fewer threads, and the measured times that decide between them. */
#include "base/pace.h"

#include <string.h>

#ifdef SK_ONE_THREAD // there is nothing to try
void sk_pace_start(sk_pace *pace, int most, bool always) {
    (void)most, (void)always;
    memset(pace, 0, sizeof *pace);
}

int sk_pace_threads(const sk_pace *pace) {
    (void)pace;
    return 1;
}

void sk_pace_note(sk_pace *pace, double seconds) {
    (void)pace, (void)seconds;
}
#else
enum {
    FIRST_TRIAL = 4,   /* steps on a level before others are tried */
    LEAST_PAUSE = 32,  /* steps between trials, doubled after each trial that failed or did not last, */
    MOST_PAUSE = 1024, /* up to this */
    SOON = 4           /* so much sooner where the work has changed */
};
static const double least_gain = 0.9, /* the share of the time that more threads may take at most */
    least_work = 2e-4,                /* s: a shorter step is over before a thread has woken */
    hopeless = 1.5,                   /* a trial that takes this many times as long ends at once */
    another = 2,                      /* a step that takes this many times as long, or as short, has other work to do */
    newest = 0.2;                     /* share of the newest time in the mean */

void sk_pace_start(sk_pace *pace, int most, bool always) {
    memset(pace, 0, sizeof *pace);
    pace->most = most;
    for (pace->levels = 1; pace->levels < SK_PACE_LEVELS && 1 << (pace->levels - 1) < most;) pace->levels++;
    if (always) pace->level = pace->levels - 1, pace->levels = 0;
    pace->wait = FIRST_TRIAL;
    pace->pause = LEAST_PAUSE;
    pace->up = true;
}

int sk_pace_threads(const sk_pace *pace) {
    int threads = 1 << (pace->left ? pace->trying : pace->level);
    return threads < pace->most ? threads : pace->most;
}

/* Updates a level's mean time. A mean of three times the new time is replaced: the first step has more to do. */
static void keep(sk_pace *pace, int level, double seconds) {
    double *mean = &pace->mean[level];
    *mean = *mean > 0 && *mean < 3 * seconds ? *mean + newest * (seconds - *mean) : seconds;
}

static void pause_longer(sk_pace *pace) {
    pace->wait = pace->pause;
    if (pace->pause < MOST_PAUSE) pace->pause *= 2;
}

static void settle(sk_pace *pace, int level) {
    pace->level = level;
    pace->stayed = pace->known = 0;
}

/* What the last steps took, in the mean. */
static double mean_of_recent(const sk_pace *pace) {
    const int count = pace->known < SK_PACE_TRIAL ? pace->known : SK_PACE_TRIAL;
    double sum = 0;
    for (int i = 0; i < count; i++) sum += pace->recent[i];
    return sum / count;
}

/* Tries a neighbour of the present level, upwards and downwards in turn. */
static void begin_trial(sk_pace *pace) {
    int next = pace->level + (pace->up ? 1 : -1);
    pace->up = !pace->up;
    if (next < 0 || next >= pace->levels) next = 2 * pace->level - next;
    if (next < 0 || next >= pace->levels) return;
    if (next > pace->level && pace->mean[pace->level] < least_work) return;
    pace->trying = next;
    pace->left = SK_PACE_TRIAL;
    pace->tried = 0;
    pace->trial = 0;
    pace->before = mean_of_recent(pace);
}

/* Holds the trial against what a step with the old number took halfway through it. */
static void end_trial(sk_pace *pace) {
    double now = (pace->before + mean_of_recent(pace)) / 2, then = pace->trial / pace->tried;
    bool more = pace->trying > pace->level, better = more ? then < least_gain * now : least_gain * then < now;
    pace->judging = false;
    pace->since = 0;
    pace->judged = better ? then : now;
    pace->mean[pace->level] = now;
    pace->mean[pace->trying] = then;
    if (!better) {
        pause_longer(pace);
        return;
    }
    settle(pace, pace->trying);
    pace->up = more;
    pace->wait = FIRST_TRIAL;
}

/* A step of a trial. */
static void note_trial(sk_pace *pace, double seconds) {
    pace->trial += seconds;
    pace->tried++;
    pace->left--;
    if (seconds > hopeless * pace->before) pace->left = 0;
    pace->judging = !pace->left;
    if (pace->judging) pace->known = 0;
}

/* Whether steps have other work to do than when it was last decided: two in a row, for one may have been held up. */
static bool has_changed(const sk_pace *pace, double seconds) {
    double least = seconds < pace->last ? seconds : pace->last, most = seconds < pace->last ? pace->last : seconds;
    return pace->judged > 0 && pace->since >= pace->pause / SOON &&
           (least > another * pace->judged || another * most < pace->judged);
}

void sk_pace_note(sk_pace *pace, double seconds) {
    if (pace->levels < 2) return;
    if (pace->left) {
        note_trial(pace, seconds);
        return;
    }
    pace->recent[pace->known++ % SK_PACE_TRIAL] = seconds;
    if (pace->judging) {
        if (pace->known == SK_PACE_TRIAL) end_trial(pace);
        pace->last = seconds;
        return;
    }
    keep(pace, pace->level, seconds);
    pace->since++;
    if (++pace->stayed == 2 * pace->pause) pace->pause = LEAST_PAUSE; // this level has lasted
    int fewer = pace->level - 1;
    bool slower = fewer >= 0 && pace->mean[fewer] > 0 && pace->mean[pace->level] > pace->mean[fewer];
    if (slower) { // there is more to do, or other processes now use the processors
        pace->mean[fewer] = 0;
        pace->up = false;
    }
    if (slower || has_changed(pace, seconds) || --pace->wait <= 0) {
        pace->wait = LEAST_PAUSE;
        begin_trial(pace);
    }
    pace->last = seconds;
}
#endif
