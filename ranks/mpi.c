/* Ranks by MPI (OpenMPI, or any other that this was built with). */
#include <limits.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

#include "io/module.h"
#include "ranks/ranks.h"

enum { TAG = 21 };

static bool begin(int *rank, int *count, int *here) {
    int there = 0;
    MPI_Comm machine;
    if (MPI_Initialized(&there) || (!there && MPI_Init(NULL, NULL))) return false;
    if (MPI_Comm_rank(MPI_COMM_WORLD, rank) || MPI_Comm_size(MPI_COMM_WORLD, count)) return false;
    if (MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, *rank, MPI_INFO_NULL, &machine)) return false;
    return !MPI_Comm_size(machine, here) && !MPI_Comm_free(&machine);
}

static void abandon(int status) {
    MPI_Abort(MPI_COMM_WORLD, status);
}

/* MPI counts by int. */
static int count_of(size_t size) {
    if (size <= INT_MAX) return (int)size;
    fprintf(stderr, "skein: a message of %zu bytes between two ranks: at most %d; take more ranks\n", size, INT_MAX);
    abandon(1);
    exit(1);
}

/* MPI's own handler ends the job where a message cannot be sent: there is nothing to go on with. */
static void send(int to, const void *bytes, size_t size) {
    MPI_Send(bytes, count_of(size), MPI_BYTE, to, TAG, MPI_COMM_WORLD);
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
    MPI_Recv(bytes, count_of(size), MPI_BYTE, from, TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

static void gather(const void *own, size_t size, void *all) {
    MPI_Allgather(own, count_of(size), MPI_BYTE, all, count_of(size), MPI_BYTE, MPI_COMM_WORLD);
}

static struct {
    MPI_Request *data;
    size_t count, capacity;
} under_way; // of this process, which has one job

static void send_begin(int to, const void *bytes, size_t size) {
    if (under_way.count == under_way.capacity) {
        size_t capacity = 2 * under_way.capacity + 16;
        MPI_Request *grown = realloc(under_way.data, capacity * sizeof *grown);
        if (!grown) {
            fprintf(stderr, "skein: out of memory\n");
            abandon(1);
            exit(1);
        }
        under_way.data = grown, under_way.capacity = capacity;
    }
    MPI_Isend(bytes, count_of(size), MPI_BYTE, to, TAG, MPI_COMM_WORLD, &under_way.data[under_way.count++]);
}

static void send_end(void) {
    MPI_Waitall((int)under_way.count, under_way.data, MPI_STATUSES_IGNORE);
    under_way.count = 0;
}

static size_t size_from(int from) {
    MPI_Status status;
    int bytes = 0;
    MPI_Probe(from, TAG, MPI_COMM_WORLD, &status);
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    return (size_t)bytes;
}

static void end(void) {
    free(under_way.data);
    MPI_Finalize();
}

static const ranks_content content = {begin,      send,     has_come,  receive, gather,
                                      send_begin, send_end, size_from, end,     abandon};
IO_MODULE(&content);
