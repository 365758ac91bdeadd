/* Ranks: the processes of one job that mpirun or srun has started, and messages between them.
 *
 * Owns: what the command needs of MPI, as a module (io/module.h) that is loaded where such a job is found, so that neither
 * the library nor the command links MPI. Called by app/study_ranks.c, from one thread. */
#ifndef SKEIN_RANKS_RANKS_H
#define SKEIN_RANKS_RANKS_H

#include <stdbool.h>
#include <stddef.h>

typedef struct ranks_content {
    /* Joins the job: who this is, of how many. False where it cannot. */
    bool (*begin)(int *rank, int *count);
    /* Sends bytes, of any number, to another rank. They arrive in order. */
    void (*send)(int to, const void *bytes, size_t size);
    /* Whether something has come: from whom, and how many bytes. With `wait` it waits for that. */
    bool (*has_come)(bool wait, int *from, size_t *size);
    /* Takes it. */
    void (*receive)(int from, void *bytes, size_t size);
    /* Leaves the job, once all ranks do. */
    void (*end)(void);
} ranks_content;

#endif
