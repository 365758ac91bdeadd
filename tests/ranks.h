/* Finding the ranks of an MPI job among all processes, for tests that kill one. */
#ifndef SKEIN_TEST_RANKS_H
#define SKEIN_TEST_RANKS_H

#include "test_command.h"

/* Which process is rank `rank` of the job whose command line has this word: it has that rank in its environment; 0: none. */
static inline pid_t find_rank(const char *word, const char *rank) {
    DIR *processes = opendir("/proc");
    pid_t found = 0;
    for (struct dirent *entry; processes && (entry = readdir(processes)) != NULL && !found;) {
        char path[300], text[1 << 16], wanted[64];
        pid_t id = (pid_t)strtol(entry->d_name, NULL, 10);
        if (id <= 0) continue;
        snprintf(path, sizeof path, "/proc/%d/cmdline", (int)id);
        FILE *file = fopen(path, "rb");
        size_t size = file ? fread(text, 1, sizeof text - 1, file) : 0;
        if (file) fclose(file);
        bool ours = size && memmem(text, size, word, strlen(word)) && !memmem(text, size, "--oversubscribe", 15);
        if (!ours) continue;
        snprintf(path, sizeof path, "/proc/%d/environ", (int)id);
        file = fopen(path, "rb");
        size = file ? fread(text, 1, sizeof text - 1, file) : 0;
        if (file) fclose(file);
        snprintf(wanted, sizeof wanted, "OMPI_COMM_WORLD_RANK=%s", rank);
        if (size && memmem(text, size, wanted, strlen(wanted) + 1)) found = id;
    }
    if (processes) closedir(processes);
    return found;
}

#endif
