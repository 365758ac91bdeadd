/* skein study: the rows of a study dealt out to processes, and what comes of them.
 *
 *   study.c        the command: arguments, summary
 *   study_jobs.c   rows run by processes of this machine
 *   study_ranks.c  rows run by the ranks of an MPI job
 *   study_plot.c   the plot, by gnuplot
 *
 * One process deals out rows and keeps their results; those that run them know nothing of the folder. */
#ifndef SKEIN_APP_STUDY_H
#define SKEIN_APP_STUDY_H

#include "app/command.h"
#include "app/progress.h"
#include "io/study.h"

typedef struct study_work {
    io_study *study;
    io_study_folder *folder; /* NULL where another process has it */
    int threads;             /* a row's */
    size_t next;             /* the first row that may still be dealt out */
    int taken;               /* results that came */
    double seconds;          /* that rows took, together */
    double written;          /* when the tables were written last, of app_seconds() */
    bool whole, failed; /* whole: not a part, so that tables are written on the way; failed: it has been said why */
    app_progress progress;
} study_work;

/* The next row to be run; SIZE_MAX where there is none left, after an interrupt too. */
size_t study_deal(study_work *work);
/* Keeps a row's result (of study_run(), or NULL), and shows how far it is. Takes the reference. False where whoever ran it
 * was told to stop. */
bool study_take(study_work *work, json_t *result);
/* Runs a row; `meanwhile` (or NULL) is called once a frame. */
json_t *study_run(const study_work *work, size_t row, void (*meanwhile)(void *user), void *user);

/* Runs all rows in `jobs` processes. A row whose process dies is noted as crashed. */
void study_run_jobs(study_work *work, size_t jobs);

/* Joins the job. Returns the rank, or -1 after a printed fault; `count` receives how many there are. */
int study_ranks_begin(int *count);
/* Rank 0 deals out and runs rows, the others only run them. */
void study_run_ranks(study_work *work);
void study_ranks_end(void);

/* Writes FOLDER/plot.gnuplot and draws plot.png and plot.svg with it, where there is something to be drawn; `drawn` says
 * whether they are there. False after a printed fault; where gnuplot is missing, that is only said. */
bool study_plot(const io_study *study, const io_study_folder *folder, const char *path, bool *drawn);

#endif
