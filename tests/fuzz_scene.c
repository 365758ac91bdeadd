/* Feeds any bytes to the scene reader as a document, and judges what it makes of them.
 *
 *   document [\0 path=value]...      what follows a NUL byte is as behind --set
 *
 * Owns nothing. Called as fuzz/fuzz.h says.
 * Invariant: there is a world or there are faults; each fault has a place and words on one line (and a place in a
 * formula on two more); a world can be measured, explained and stepped, and gives all memory back. A grid of 65536 x 65536 is legal, so
 * worlds have little memory here. */
#include <ctype.h>
#include <math.h>

#include "fuzz/fuzz.h"
#include "io/exporters.h"
#include "io/scene.h"

enum { MOST_SETS = 16, MOST_WORK = 200000 };

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
    require(s->version == 1 && s->frames >= 0 && s->threads >= 0 && s->threads <= 64);
    require(s->name && s->description && steps >= 1 && steps <= 1000000 && dt > 0 && isfinite(dt));
    io_export exports[16];
    size_t count = io_scene_exports(scene, exports, 16);
    require(count <= 2);
    for (size_t i = 0; i < count; i++)
        if (exports[i].kind == io_exporter_at(0))
            require((uint32_t)((const io_clip_params *)exports[i].params)->normals <= 2);
        else if (exports[i].kind->params_size == sizeof(io_clip_params))
            require(((const io_clip_params *)exports[i].params)->every >= 0);
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
    if (fuzz_is_cheap(world, MOST_WORK)) (void)skein_world_step(world, dt);
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
    io_faults faults = {judge_fault, &reported, 0, NULL};
    io_scene *scene = io_scene_read_text(text, size, "tests/corpus/scene/fuzz.json", sets, exporters, &faults);
    require(faults.count == reported && (scene || reported > 0));
    if (!scene) return;
    judge_scene(scene);
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = fuzz_allocate;
    desc.release = fuzz_release;
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
    size_t length, count = 0;
    char *document = fuzz_take_part(&data, &size, &length), *sets[MOST_SETS + 1];
    while (data && count < MOST_SETS) {
        size_t set_length;
        char *set = fuzz_take_part(&data, &size, &set_length);
        sets[count] = strndup(set, set_length);
        require(sets[count++] != NULL);
        free(set);
    }
    sets[count] = NULL;
    feed(document, length, (const char *const *)sets);
    while (count > 0) free(sets[--count]);
    free(document);
    return 0;
}
