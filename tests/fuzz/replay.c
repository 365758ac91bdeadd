/* The main of a fuzzer in builds without libFuzzer: feeds it the files that are named, and those of folders, each whole
 * and cut off at every place, as a full disk leaves it. */
#include <dirent.h>
#include <stdio.h>

#include "fuzz/fuzz.h"
#include "io/file.h"

enum { MOST_CUTS = 4096 };

/* Exactly as large as the input, so that a sanitizer sees the first byte too many. */
static void feed_copy(const char *bytes, size_t size) {
    uint8_t *copy = malloc(size + (size == 0));
    require(copy != NULL);
    if (size) memcpy(copy, bytes, size);
    LLVMFuzzerTestOneInput(copy, size);
    free(copy);
}

static int replay_file(const char *path) {
    skein_error error;
    io_bytes bytes;
    if (io_file_read(path, (size_t)1 << 30, &bytes, &error) != SKEIN_OK) {
        fprintf(stderr, "%s: %s\n", error.where, error.message);
        return 1;
    }
    feed_copy(bytes.data, bytes.size);
    for (size_t cut = 0; cut < bytes.size && bytes.size <= MOST_CUTS; cut++) feed_copy(bytes.data, cut);
    io_bytes_free(&bytes);
    return 0;
}

int main(int argument_count, char **arguments) {
    int failures = 0, count = 0;
    for (int i = 1; i < argument_count; i++) {
        DIR *folder = opendir(arguments[i]);
        if (!folder) {
            failures += replay_file(arguments[i]);
            count++;
            continue;
        }
        for (struct dirent *entry; (entry = readdir(folder)) != NULL;) {
            char path[4096];
            if (entry->d_name[0] == '.') continue;
            snprintf(path, sizeof path, "%s/%s", arguments[i], entry->d_name);
            failures += replay_file(path);
            count++;
        }
        closedir(folder);
    }
    printf("%d inputs replayed\n", count);
    return failures > 0 || count == 0;
}
