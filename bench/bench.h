/* What the benchmark's files share: jobs to time, rows to report, and the list of cases.
 *
 *   bench.c        the program: options, timing
 *   report.c       the table, the comma separated values, and the kept file
 *   worlds.c       worlds to measure, and ops of their plans run alone
 *   meshes.c       meshes made in code
 *   plain.c        the student's loops
 *   plain_flock.c  the student's flock
 *   texts.c        formulas to measure, as texts
 *   elements.c     100,000 elements that they are measured on, and tapes
 *   by_hand*.c     values, gradients, projections and second derivatives by hand
 *   emitted_wide.c the emitter's C on the same elements (emit.c writes it while building)
 *   dual.cpp       dual numbers; adolc.cpp ADOL-C, only there if that is
 *   bullet.cpp     Bullet's soft body; only there if Bullet is
 *   case_*.c       the cases
 *
 * Everything that is compared is timed in one process, in turns; see bench_measure. */
#ifndef SKEIN_BENCH_BENCH_H
#define SKEIN_BENCH_BENCH_H

#include <skein/skein.h>

/* ---- timing (bench.c) ---- */

/* A call to time. `calls` makes a block: 0, as many as fit. */
typedef struct bench_job {
    void (*run)(void *data);
    void *data;
    void (*prepare)(void *data); /* before each block, not timed; may be NULL */
    size_t calls;
} bench_job;

enum { BENCH_MOST_JOBS = 8 };

/* Times jobs in turns, five blocks each, so that whatever else the machine does meets all of them alike.
 * A block runs for at least `seconds`, or for the job's own number of calls. `median[i]` receives the median of job
 * i's blocks, in seconds a call. */
void bench_measure(const bench_job *jobs, size_t count, double seconds, double *median);

/* Zeroed memory, or the end of the program. */
void *bench_allocate(size_t count, size_t size);

/* Whether to run small and short: only to see that every case works. */
extern bool bench_quick;

/* Says why the program has to fail, at once or at its end. */
void bench_stop(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));
void bench_fault(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* ---- reporting (report.c) ---- */

/* How far the edges of a body are from their rest lengths, 0.01 is one per cent. */
typedef struct bench_stretch {
    double mean, p99, most;
} bench_stretch;

/* A row of the table: what was measured, against what, and the bar that it should pass. */
typedef struct bench_result {
    const char *name, *size;
    double ours;
    const char *unit;
    const char *other;                            /* what it is compared with; NULL: nothing */
    double theirs;                                /* in the same unit */
    double faster;                                /* the bar: theirs / ours is at least this; 0: no such bar */
    double as_long;                               /* the bar: ours / theirs is at most this */
    double under;                                 /* the bar: ours is under this */
    double firm;                                  /* the bar: 99 of 100 edges are stretched by no more than this */
    const bench_stretch *stretch, *other_stretch; /* NULL: not measured */
    const char *note;                             /* settings, or NULL */
} bench_result;

/* Opens the table. `csv`: comma separated values instead. `folder`: also kept in a file there, named after the
 * processor; NULL: not. `isa` is the instruction set that Skein has chosen. */
void bench_report_open(bool csv, const char *folder, const char *isa);
void bench_report(const bench_result *result);
/* A line for people, not kept. */
void bench_say(const char *format, ...) __attribute__((format(printf, 1, 2)));
void bench_report_close(void);

/* ---- the cases ---- */

typedef struct bench_case {
    const char *name, *help;
    void (*run)(void);
} bench_case;

extern const bench_case bench_force, bench_sweep, bench_shapes, bench_substep, bench_threads, bench_w1, bench_default,
    bench_w2, bench_w3, bench_scale, bench_irregular, bench_rope, bench_settled, bench_memory, bench_formula,
    bench_kinds, bench_dual, bench_second, bench_text_to_tape, bench_flock, bench_changes, bench_widths, bench_contact,
    bench_broad, bench_field, bench_clips;

#endif
