/* The ranks of an MPI job, where mpirun or srun has started several of this command: who they are, and runs of flocks
 * that they share (ranks/shared.h). */
#ifndef SKEIN_APP_RANKS_H
#define SKEIN_APP_RANKS_H

#include "app/command.h"
#include "ranks/shared.h"

/* Whether this process is a rank of a job of several, as mpirun and srun tell it in its environment. */
bool app_is_rank(void);
/* Joins the job. NULL after a printed fault; what to do without MPI is said in `instead`. */
const ranks_content *app_ranks_join(const char *command, const char *instead, int *rank, int *count, int *here);

/* A scene's run that all ranks share; all zero where there are none. */
typedef struct app_shared {
    const ranks_content *ranks;
    int rank, count;
    char threads[32]; /* a value of --set: what each rank's share of the machine is */
    const char *word; /* what scene */
    const char *const *sets;
    shared_run *run;
    char parts[1100];       /* where ranks write their own; "": nowhere yet */
    shared_figures figures; /* at the end */
} app_shared;

/* Joins the job, if this process is of one. To be called before the scene is loaded. Returns an exit status. */
int app_shared_join(app_shared *shared, app_arguments *arguments);
/* The rest of a run of any rank but the first. Returns its exit status. */
int app_shared_serve(app_shared *shared, const char *word, const char *const *sets);
/* Has the loaded scene stepped by all ranks. Returns an exit status. */
int app_shared_lead(app_shared *shared, app_scene *loaded, const char *word, const char *const *sets);
/* Each rank writes what is its own, as frame `frame`, into out/parts, or where the run went on from a later one into
 * out/parts-from-FRAME. False after a printed fault. */
bool app_shared_record(app_shared *shared, const char *out, int frame, double time);
/* Fills in the figures. */
void app_shared_measure(app_shared *shared);
/* Lets the others go, at the end of the first rank's run. To be called once the scene is unloaded. */
void app_shared_leave(app_shared *shared);

#endif
