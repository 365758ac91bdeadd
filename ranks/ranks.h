/* Ranks: the processes of one job that mpirun or srun has started, and messages between them.
 *
 * Owns: what the command needs of MPI, as a module (io/module.h) that is loaded where such a job is found, so that neither
 * the library nor the command links MPI. Called by app/study_ranks.c and ranks/, from one thread. Messages of a study
 * and of a shared run are never under way at once. */
#ifndef SKEIN_RANKS_RANKS_H
#define SKEIN_RANKS_RANKS_H

#include <stdbool.h>
#include <stddef.h>

typedef struct ranks_content {
    /* Joins the job: who this is, of how many, and how many of them are on this machine. False where it cannot. */
    bool (*begin)(int *rank, int *count, int *here);
    /* Sends bytes, of any number, to another rank. They arrive in order. */
    void (*send)(int to, const void *bytes, size_t size);
    /* Whether something has come: from whom, and how many bytes. With `wait` it waits for that. */
    bool (*has_come)(bool wait, int *from, size_t *size);
    /* Takes it. */
    void (*receive)(int from, void *bytes, size_t size);
    /* So many bytes of each rank to all, in the order of ranks; all ranks call it. */
    void (*gather)(const void *own, size_t size, void *all);
    /* Begins to send bytes, at most SIZE_MAX / 4 at once, that stay as they are until all that began is sent. */
    void (*send_begin)(int to, const void *bytes, size_t size);
    void (*send_end)(void);
    /* How many bytes a rank has begun to send here; it waits for that. `receive` takes them. */
    size_t (*size_from)(int from);
    /* Leaves the job, once all ranks do. */
    void (*end)(void);
    /* Ends the job, with all its ranks. */
    void (*abandon)(int status);
} ranks_content;

#endif
