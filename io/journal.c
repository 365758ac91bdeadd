/* Journals: see snapshot.h. An entry is given to the system at once, so that it outlives the program. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/snapshot.h"

static const char magic[8] = {'s', 'k', 'e', 'i', 'n', 'j', 'r', 'n'};
enum { HEAD = 16 };

struct io_journal {
    int fd;
    uint64_t size;
    char *path;
};

typedef struct entry {
    uint64_t sort, size, sum;
} entry;

static uint64_t sum_of(uint64_t sort, const unsigned char *bytes, size_t size) {
    uint64_t sum = 0xcbf29ce484222325u ^ sort;
    for (size_t i = 0; i < size; i += 8) {
        uint64_t word = 0;
        memcpy(&word, bytes + i, size - i < 8 ? size - i : 8);
        sum = (sum ^ word) * 0x100000001b3u;
        sum ^= sum >> 29;
    }
    return sum;
}

static const char *words_of(int fault) {
    return fault == ENOSPC  ? "the disk is full"
           : fault == EFBIG ? "it grew over the limit for a file's size"
                            : strerror(fault);
}

static skein_status write_all(io_journal *journal, const void *bytes, size_t size, skein_error *error) {
    const char *at = bytes;
    while (size) {
        ssize_t done = write(journal->fd, at, size);
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) return io_error_set(error, SKEIN_ERROR_FILE, journal->path, "cannot write: %s", words_of(errno));
        at += done, size -= (size_t)done;
        journal->size += (uint64_t)done;
    }
    return SKEIN_OK;
}

static io_journal *open_journal(const char *path, int flags, skein_error *error) {
    io_journal *journal = calloc(1, sizeof *journal);
    if (journal) journal->path = strdup(path);
    if (!journal || !journal->path) {
        free(journal);
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return NULL;
    }
    journal->fd = open(path, O_WRONLY | O_CLOEXEC | O_NOFOLLOW | flags, 0666);
    if (journal->fd >= 0) return journal;
    io_error_set(error, SKEIN_ERROR_FILE, path, "cannot write: %s", words_of(errno));
    io_journal_end(journal);
    return NULL;
}

io_journal *io_journal_begin(const char *path, skein_error *error) {
    io_journal *journal = open_journal(path, O_CREAT | O_TRUNC, error);
    const uint64_t version = 1;
    if (journal &&
        (write_all(journal, magic, sizeof magic, error) || write_all(journal, &version, sizeof version, error))) {
        io_journal_end(journal);
        return NULL;
    }
    return journal;
}

io_journal *io_journal_go_on(const char *path, uint64_t size, skein_error *error) {
    io_journal *journal = open_journal(path, 0, error);
    if (!journal) return NULL;
    journal->size = size;
    if (!ftruncate(journal->fd, (off_t)size) && lseek(journal->fd, (off_t)size, SEEK_SET) >= 0) return journal;
    io_error_set(error, SKEIN_ERROR_FILE, path, "cannot write: %s", words_of(errno));
    io_journal_end(journal);
    return NULL;
}

skein_status io_journal_add(io_journal *journal, uint64_t sort, const void *bytes, size_t size, skein_error *error) {
    const entry head = {sort, size, sum_of(sort, bytes, size)};
    skein_status status = write_all(journal, &head, sizeof head, error);
    return status ? status : write_all(journal, bytes, size, error);
}

skein_status io_journal_sync(io_journal *journal, skein_error *error) {
    if (!fsync(journal->fd) || errno == EINVAL || errno == ENOTSUP) return SKEIN_OK;
    return io_error_set(error, SKEIN_ERROR_FILE, journal->path, "cannot write: %s", words_of(errno));
}

uint64_t io_journal_size(const io_journal *journal) {
    return journal->size;
}

void io_journal_end(io_journal *journal) {
    if (!journal) return;
    if (journal->fd >= 0) close(journal->fd);
    free(journal->path);
    free(journal);
}

/* ---- reading ---- */

/* Exactly so many bytes; false where they are not there. */
static bool read_all(int fd, void *bytes, size_t size) {
    char *at = bytes;
    while (size) {
        ssize_t got = read(fd, at, size);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got, size -= (size_t)got;
    }
    return true;
}

/* The next entry, if it ends before `limit` and is whole: its bytes into room that grows. */
static bool read_entry(int fd, uint64_t at, uint64_t limit, entry *head, char **bytes, size_t *capacity) {
    return limit - at >= sizeof *head && read_all(fd, head, sizeof *head) && head->size <= limit - at - sizeof *head &&
           io_grow(bytes, capacity, (size_t)head->size + 1, 1) && read_all(fd, *bytes, (size_t)head->size) &&
           sum_of(head->sort, (const unsigned char *)*bytes, (size_t)head->size) == head->sum;
}

skein_status io_journal_read(const char *path, uint64_t size, io_journal_take *take, void *user, uint64_t *end,
                             skein_error *error) {
    struct stat info;
    char head[HEAD], *bytes = NULL;
    uint64_t version = 0, at = HEAD;
    size_t capacity = 0;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0 || fstat(fd, &info) || !S_ISREG(info.st_mode)) {
        skein_status status =
            io_error_set(error, SKEIN_ERROR_FILE, path, "cannot read: %s", fd < 0 ? strerror(errno) : "it is no file");
        if (fd >= 0) close(fd);
        return status;
    }
    uint64_t there = (uint64_t)info.st_size, limit = size < there ? size : there;
    bool good = read_all(fd, head, HEAD) && !memcmp(head, magic, sizeof magic);
    if (good) memcpy(&version, head + sizeof magic, sizeof version);
    if (!good || version != 1) {
        close(fd);
        if (good)
            return io_error_set(error, SKEIN_ERROR_LIMIT, path,
                                "a journal of another version, or of a machine with another order of bytes: take the "
                                "Skein that wrote it");
        return io_error_set(error, SKEIN_ERROR_SYNTAX, path, "it is no journal of a run of Skein's");
    }
    entry next;
    bool more = true;
    while (more && limit > at && read_entry(fd, at, limit, &next, &bytes, &capacity)) {
        at += sizeof next + next.size;
        more = take(user, next.sort, bytes, (size_t)next.size);
    }
    free(bytes);
    close(fd);
    if (end) *end = at;
    if (more && size != UINT64_MAX && at != size)
        return io_error_set(error, SKEIN_ERROR_SYNTAX, path, "the journal is damaged, or was cut off");
    return SKEIN_OK;
}
