/* Ranks by MPI (OpenMPI, or any other that this was built with). */
#include <mpi.h>

#include "io/module.h"
#include "ranks/ranks.h"

enum { TAG = 21 };

static bool begin(int *rank, int *count) {
    int there = 0;
    if (MPI_Initialized(&there) || (!there && MPI_Init(NULL, NULL))) return false;
    return !MPI_Comm_rank(MPI_COMM_WORLD, rank) && !MPI_Comm_size(MPI_COMM_WORLD, count);
}

/* MPI's own handler ends the job where a message cannot be sent: there is nothing to go on with. */
static void send(int to, const void *bytes, size_t size) {
    MPI_Send(bytes, (int)size, MPI_BYTE, to, TAG, MPI_COMM_WORLD);
}

static bool has_come(bool wait, int *from, size_t *size) {
    MPI_Status status;
    int come = 1, bytes = 0;
    if (wait) MPI_Probe(MPI_ANY_SOURCE, TAG, MPI_COMM_WORLD, &status);
    else MPI_Iprobe(MPI_ANY_SOURCE, TAG, MPI_COMM_WORLD, &come, &status);
    if (!come) return false;
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    *from = status.MPI_SOURCE;
    *size = (size_t)bytes;
    return true;
}

static void receive(int from, void *bytes, size_t size) {
    MPI_Recv(bytes, (int)size, MPI_BYTE, from, TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

static void end(void) {
    MPI_Finalize();
}

static const ranks_content content = {begin, send, has_come, receive, end};
IO_MODULE(&content);
