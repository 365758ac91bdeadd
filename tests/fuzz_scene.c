/* Feeds any bytes to the scene reader as a document, and judges what it makes of them.
 *
 *   document [\0 path=value]...      what follows a NUL byte is as behind --set
 *
 * Owns nothing. Called by libFuzzer (clang -fsanitize=fuzzer,address), or, built with
 * -DSKEIN_FUZZ_REPLAY, by its own main with files and directories of a corpus as arguments.
 * Invariant: there is a world or there are faults; each fault has a place and words on one line (and a place in a
 * formula on two more); a world
 * can be measured, explained and stepped, and gives all memory back. A grid of 65536 x 65536 is legal, so
 * worlds have little memory here. */
#include "io/exporters.h"
#include "io/scene.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MEMORY = 4 << 20, MOST_SETS = 16, MOST_WORK = 200000 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool fine) {
    if (!fine) abort();
}

/* ---- Little memory -------------------------------------------------------------------------- */

static void *allocate(void *user, size_t size, size_t alignment) {
    size_t *used = user;
    if (size > MOST_MEMORY - *used) return NULL;
    void *memory = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    *used += memory ? size : 0;
    return memory;
}

static void release(void *user, void *memory, size_t size) {
    *(size_t *)user -= size;
    free(memory);
}

/* ---- Judging -------------------------------------------------------------------------------- */

static void judge_line(const char *text) {
    require(text[0] != '\0');
    for (; *text; text++) require(!iscntrl((unsigned char)*text));
}

/* What is wrong in a formula is shown in two more lines, set in by four blanks. */
static void judge_words(const char *text) {
    char line[sizeof(skein_error)];
    for (int lines = 0; *text; lines++) {
        size_t length = strcspn(text, "\n");
        require(lines < 3 && (lines == 0 || strncmp(text, "    ", 4) == 0));
        memcpy(line, text, length);
        line[length] = '\0';
        judge_line(line);
        text += length + (text[length] == '\n');
    }
}

static void judge_fault(void *user, const skein_error *error) {
    ++*(size_t *)user;
    require(error->status != SKEIN_OK);
    require(strncmp(error->where, "tests/corpus/", 13) == 0 || strncmp(error->where, "--set ", 6) == 0 ||
            strncmp(error->where, "...", 3) == 0);
    judge_line(error->where);
    require(error->message[0]);
    judge_words(error->message);
}

static void judge_scene(const io_scene *scene) {
    const io_scene_settings *s = io_scene_get(scene);
    double dt;
    int steps = io_scene_steps_per_frame(s, &dt);
    require(s->version == 1 && s->frames >= 0 && s->threads >= 1 && s->threads <= 64);
    require(s->name && s->description && steps >= 1 && steps <= 1000000 && dt > 0 && isfinite(dt));
    io_export exports[16];
    size_t count = io_scene_exports(scene, exports, 16);
    require(count <= 2);
    for (size_t i = 0; i < count; i++)
        if (exports[i].kind == io_exporter_at(0))
            require((uint32_t)((const io_obj_params *)exports[i].params)->normals <= 2);
        else require(((const io_pc2_params *)exports[i].params)->every >= 1);
}

static double number_or_one(const skein_world *world, const char *path) {
    skein_value value;
    return skein_get_path(world, path, &value) ? 1 : value.number[0];
}

static void read_line(void *user, const char *line) {
    (void)user;
    judge_line(line);
}

static void judge_world(skein_world *world, double dt) {
    skein_statistics s;
    require(skein_particle_count(world) > 0);
    if (skein_world_statistics(world, &s) == SKEIN_OK)
        require(s.nonfinite == 0 && s.particles == skein_particle_count(world));
    require(skein_world_explain(world, dt, read_line, NULL) == SKEIN_OK);
    // A step of a hundred thousand substeps is legal, too; neighbours may be everyone.
    double substeps = number_or_one(world, "method.substeps") * number_or_one(world, "method.iterations");
    double work = (double)s.particles * (double)s.particles + (double)s.constraints;
    if (substeps * work < MOST_WORK) (void)skein_world_step(world, dt);
}

static void ignore(void *user, skein_log_level level, const char *line) {
    (void)user;
    (void)level;
    require(line[0] != '\0');
}

static void feed(const char *text, size_t size, const char *const *sets) {
    static const skein_kind *exporters[3];
    exporters[0] = io_exporter_at(0);
    exporters[1] = io_exporter_at(1);
    size_t reported = 0, used = 0;
    io_faults faults = {judge_fault, &reported, 0};
    io_scene *scene = io_scene_read_text(text, size, "tests/corpus/scene/fuzz.json", sets, exporters, &faults);
    require(faults.count == reported && (scene || reported > 0));
    if (!scene) return;
    judge_scene(scene);
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = allocate;
    desc.release = release;
    desc.memory_user = &used;
    desc.log = ignore;
    skein_world *world = io_scene_build(scene, &desc, &faults);
    require(faults.count == reported && (world != NULL) == (reported == 0));
    double dt;
    io_scene_steps_per_frame(io_scene_get(scene), &dt);
    if (world) judge_world(world, dt);
    skein_world_destroy(world);
    require(used == 0);
    io_scene_free(scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const uint8_t *end = size ? memchr(data, '\0', size) : NULL;
    size_t length = end ? (size_t)(end - data) : size, count = 0;
    // Each exactly as large as it is, so that a sanitizer sees the first byte too many.
    char *document = malloc(length + (length == 0)), *sets[MOST_SETS + 1];
    require(document != NULL);
    memcpy(document, data, length);
    while (end && count < MOST_SETS) {
        const uint8_t *begin = end + 1;
        end = memchr(begin, '\0', size - (size_t)(begin - data));
        size_t set_size = end ? (size_t)(end - begin) : size - (size_t)(begin - data);
        sets[count] = strndup((const char *)begin, set_size);
        require(sets[count++] != NULL);
    }
    sets[count] = NULL;
    feed(document, length, (const char *const *)sets);
    while (count > 0) free(sets[--count]);
    free(document);
    return 0;
}

#ifdef SKEIN_FUZZ_REPLAY

#include <dirent.h>
#include <stdio.h>

static int replay_file(const char *path) {
    skein_error error;
    io_bytes bytes;
    if (io_file_read(path, (size_t)1 << 30, &bytes, &error) != SKEIN_OK) {
        fprintf(stderr, "%s: %s\n", error.where, error.message);
        return 1;
    }
    LLVMFuzzerTestOneInput((const uint8_t *)bytes.data, bytes.size);
    // And cut off at every place, as a full disk leaves it.
    for (size_t cut = 0; cut < bytes.size && bytes.size <= 4096; cut++)
        LLVMFuzzerTestOneInput((const uint8_t *)bytes.data, cut);
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

#endif
