/* What the operating system may refuse, made to be refused: a library that test_command_failures puts before a
 * skein's own (LD_PRELOAD).
 *
 * It counts the calls that skein itself makes (its film module, too; not those of drivers and encoders, nor of
 * compilers that skein starts): files opened to be written, read and written, brought to the disk, cut, closed,
 * renamed, folders made, threads started. Each is noted as a line "NUMBER KIND WHAT" in the file $SKEIN_FAIL_LOG.
 *
 * $SKEIN_FAIL says what happens. "count": nothing; the log has how many calls there are. "once N": the N-th fails. "full
 * N": from the N-th on, all that needs room on a disk fails; it is full, and stays so. "pieces": every write and read moves
 * one byte or half of what was asked for, and every other one is interrupted before. "locale": nothing; but the process has
 * the locale of its environment, as programs with windows have, which skein itself does not ask for. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

typedef enum mode { ASLEEP, COUNT, ONCE, FULL, PIECES } mode;

static struct {
    mode mode;
    long number;
    int log;
    atomic_long calls;
} fail = {.log = -1};

__attribute__((constructor)) static void wake(void) {
    const char *what = getenv("SKEIN_FAIL"), *log = getenv("SKEIN_FAIL_LOG");
    const char *number = what ? strchr(what, ' ') : NULL;
    const char *name = strrchr(program_invocation_name, '/');
    if (!what || !log || strcmp(name ? name + 1 : program_invocation_name, "skein")) return;
    fail.number = number ? atol(number) : 0;
    fail.log = (int)syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (!strcmp(what, "locale") && !setlocale(LC_ALL, "")) abort();
    fail.mode = !strncmp(what, "once ", 5)   ? ONCE
                : !strncmp(what, "full ", 5) ? FULL
                : !strcmp(what, "pieces")    ? PIECES
                                             : COUNT;
}

static bool is_ours(const void *caller) {
    Dl_info info;
    if (fail.mode == ASLEEP || !dladdr(caller, &info) || !info.dli_fname) return false;
    const char *slash = strrchr(info.dli_fname, '/'), *name = slash ? slash + 1 : info.dli_fname;
    return !strcmp(name, "skein") || !strcmp(name, "skein_film.so");
}

/* Whether this call is to fail; `takes_room` on a disk. */
static bool fails(const void *caller, const char *kind, const char *what, bool takes_room) {
    if (!is_ours(caller)) return false;
    long number = atomic_fetch_add(&fail.calls, 1);
    char line[600];
    int size = snprintf(line, sizeof line, "%ld %s %s\n", number, kind, what);
    if (size >= (int)sizeof line) size = (int)sizeof line - 1;
    int before = errno;
    (void)!syscall(SYS_write, fail.log, line, (size_t)size);
    errno = before;
    return fail.mode == ONCE ? number == fail.number : fail.mode == FULL && number >= fail.number && takes_room;
}
static bool fails_of(const void *caller, const char *kind, int fd, bool takes_room) {
    if (fd <= STDERR_FILENO) return false;
    char path[64], name[512];
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    ssize_t length = fail.mode == ASLEEP ? -1 : readlink(path, name, sizeof name - 1);
    name[length < 0 ? 0 : length] = '\0';
    return fails(caller, kind, name, takes_room);
}

static int with(int fault) {
    errno = fault;
    return -1;
}

#define REAL(name_) ((__typeof__(&name_))(uintptr_t)dlsym(RTLD_NEXT, #name_))
#define CALLER __builtin_extract_return_addr(__builtin_return_address(0))

/* ---- files by number ---- */

static int open_flags_fail(const void *caller, const char *path, int flags) {
    return ((flags & O_ACCMODE) != O_RDONLY || flags & O_CREAT) && strncmp(path, "/dev/", 5) &&
           fails(caller, "open", path, flags & O_CREAT);
}
#define OPEN(name_)                                                                                 \
    int name_(const char *path, int flags, ...) {                                                   \
        va_list arguments;                                                                          \
        va_start(arguments, flags);                                                                 \
        mode_t permissions = va_arg(arguments, mode_t); /* garbage without O_CREAT, and not used */ \
        va_end(arguments);                                                                          \
        if (open_flags_fail(CALLER, path, flags)) return with(ENOSPC);                              \
        return REAL(name_)(path, flags, permissions);                                               \
    }
OPEN(open)
OPEN(open64)

/* How many bytes go through at once, or -1: interrupted. */
static ssize_t piece(const void *caller, size_t size) {
    static atomic_uint turn;
    if (fail.mode != PIECES || size == 0 || !is_ours(caller)) return (ssize_t)size;
    unsigned number = atomic_fetch_add(&turn, 1);
    if (number % 2) return with(EINTR);
    return number % 4 ? 1 : (ssize_t)(size / 2 + 1);
}

ssize_t write(int fd, const void *bytes, size_t size) {
    if (fails_of(CALLER, "write", fd, true)) return with(ENOSPC);
    ssize_t part = fd > STDERR_FILENO ? piece(CALLER, size) : (ssize_t)size;
    return part < 0 ? -1 : REAL(write)(fd, bytes, (size_t)part);
}
#define PWRITE(name_, type_)                                                 \
    ssize_t name_(int fd, const void *bytes, size_t size, type_ offset) {    \
        if (fails_of(CALLER, "pwrite", fd, true)) return with(ENOSPC);       \
        ssize_t part = piece(CALLER, size);                                  \
        return part < 0 ? -1 : REAL(name_)(fd, bytes, (size_t)part, offset); \
    }
PWRITE(pwrite, off_t)
PWRITE(pwrite64, off64_t)

ssize_t read(int fd, void *bytes, size_t size) {
    if (fails_of(CALLER, "read", fd, false)) return with(EIO);
    ssize_t part = fd > STDERR_FILENO ? piece(CALLER, size) : (ssize_t)size;
    return part < 0 ? -1 : REAL(read)(fd, bytes, (size_t)part);
}

int fsync(int fd) {
    return fails_of(CALLER, "fsync", fd, true) ? with(EIO) : REAL(fsync)(fd);
}
int ftruncate(int fd, off_t size) {
    return fails_of(CALLER, "ftruncate", fd, false) ? with(EIO) : REAL(ftruncate)(fd, size);
}
int ftruncate64(int fd, off64_t size) {
    return fails_of(CALLER, "ftruncate", fd, false) ? with(EIO) : REAL(ftruncate64)(fd, size);
}
int close(int fd) { // which closes in any case, as Linux does
    bool bad = fails_of(CALLER, "close", fd, false);
    int closed = REAL(close)(fd);
    return bad ? with(EIO) : closed;
}

/* ---- files by name ---- */

int rename(const char *from, const char *to) {
    return fails(CALLER, "rename", to, true) ? with(ENOSPC) : REAL(rename)(from, to);
}
int mkdir(const char *path, mode_t permissions) {
    bool there = access(path, F_OK) == 0; // then it fails in any case, and with another word
    return !there && fails(CALLER, "mkdir", path, true) ? with(ENOSPC) : REAL(mkdir)(path, permissions);
}

/* ---- streams ---- */

FILE *fopen(const char *path, const char *how) {
    if (strncmp(path, "/proc/", 6) && fails(CALLER, "fopen", path, *how != 'r')) return errno = ENOSPC, NULL;
    return REAL(fopen)(path, how);
}
int fclose(FILE *file) {
    bool bad = file && fileno(file) > STDERR_FILENO && fails(CALLER, "fclose", "", true);
    int closed = REAL(fclose)(file);
    return bad ? with(ENOSPC) : closed;
}
size_t fread(void *bytes, size_t size, size_t count, FILE *file) {
    return fails(CALLER, "fread", "", false) ? errno = EIO, 0 : REAL(fread)(bytes, size, count, file);
}

/* ---- threads ---- */

int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *), void *data) {
    if (fails(CALLER, "pthread_create", "", false)) return EAGAIN;
    return REAL(pthread_create)(thread, attributes, run, data);
}
