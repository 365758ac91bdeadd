/* Leaving what makes a blow-up happen again; see blow_up.h. A step has the same bits each time, and so the world is
 * taken back and steps again: each rule is left out of the last step once, to see whether it is the one. */
#include "app/blow_up.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/snapshot.h"

enum { EVERY = 4 };

void app_good_note(app_good *good, const app_report *r) {
    if (r->frames % EVERY) return;
    size_t size = skein_snapshot_size(r->loaded->world), written;
    if (size > good->capacity) {
        void *bytes = realloc(good->bytes, size);
        if (!bytes) return;
        good->bytes = bytes, good->capacity = size;
    }
    if (skein_snapshot_write(r->loaded->world, good->bytes, good->capacity, &written)) return;
    good->size = written;
    good->frame = r->frames;
}

void app_good_free(app_good *good) {
    free(good->bytes);
    *good = (app_good){NULL, 0, 0, 0};
}

/* The first particle that is not finite, or -1. */
static long first_lost(const skein_world *world) {
    skein_view x = skein_position_view(world), v = skein_velocity_view(world);
    for (size_t i = 0; i < x.count; i++)
        for (int k = 0; k < 3; k++)
            if (!isfinite(x.xyzw[4 * (size_t)x.slot_of[i] + (size_t)k]) ||
                !isfinite(v.xyzw[4 * (size_t)v.slot_of[i] + (size_t)k]))
                return (long)i;
    return -1;
}

static const char *name_of(const skein_world *world, skein_handle object) {
    skein_value name = {0, {0, 0, 0}, ""};
    skein_get(world, object, "name", &name);
    return name.text && name.text[0] ? name.text : skein_object_kind(world, object)->name;
}

static void name_particle(const skein_world *world, long particle, char *out, size_t size) {
    snprintf(out, size, "particle %ld", particle);
    for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, b);
        skein_surface s;
        if (skein_body_surface(world, body, &s) || particle < (long)s.first_particle ||
            particle >= (long)s.first_particle + (long)s.particle_count)
            continue;
        snprintf(out, size, "particle %ld of body %zu, %.60s", particle - (long)s.first_particle, b,
                 name_of(world, body));
    }
}

/* The spring of most strain, in words; "" where none is far off. */
static void describe_worst(skein_world *world, char *out, size_t size) {
    size_t count = 0;
    double worst = 0.5;
    out[0] = 0;
    skein_spring *springs = skein_springs_copy(world, NULL, 0, &count) ? NULL : malloc((count + 1) * sizeof *springs);
    if (springs && !skein_springs_copy(world, springs, count, &count))
        for (size_t i = 0; i < count; i++) {
            if (!(fabs((double)springs[i].strain) > worst)) continue;
            worst = fabs((double)springs[i].strain);
            snprintf(out, size,
                     "Before it, the spring between particles %u and %u was stretched by %.3g %%, the most.\n",
                     springs[i].particle[0], springs[i].particle[1], 100 * (double)springs[i].strain);
        }
    free(springs);
}

/* Steps on from the good state without one rule: whether all stays finite for so many steps. */
static bool is_fine_without(const app_report *r, const app_good *good, skein_handle rule, long steps) {
    skein_world *world = r->loaded->world;
    if (skein_snapshot_read(world, good->bytes, good->size) || skein_set(world, rule, "enabled", skein_number(0)))
        return false;
    for (long step = 0; step < steps; step++)
        if (skein_world_step(world, r->dt)) return false;
    return first_lost(world) < 0;
}

/* The rule without which those steps stay finite; where no single one is, that. */
static void describe_rule(const app_report *r, const app_good *good, long steps, char *out, size_t size) {
    static const skein_category categories[] = {SKEIN_CONSTRAINT, SKEIN_COLLIDER, SKEIN_FORCE}; // gravity moves all
    const skein_world *world = r->loaded->world;
    snprintf(
        out, size,
        "No single force, collider or constraint of the scene's own went first: what holds the body together did.\n");
    for (size_t c = 0; c < sizeof categories / sizeof *categories; c++)
        for (size_t i = 0; i < skein_object_count(world, categories[c]); i++) {
            skein_handle rule = skein_object_at(world, categories[c], i);
            if (!is_fine_without(r, good, rule, steps)) continue;
            snprintf(out, size, "The rule that went first: %s %zu, %.60s. Without it all stays finite until then.\n",
                     skein_category_text(categories[c]), i, name_of(world, rule));
            return;
        }
}

static bool write_text(const char *folder, const char *name, const char *text) {
    char path[APP_PATH_SIZE];
    skein_error error;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    io_output *output = io_output_open(path, &error);
    if (output) io_output_write(output, text, strlen(text));
    if (output && !io_output_commit(output, &error)) return true;
    app_print_error(&error);
    return false;
}

/* Steps on to the step that is lost; the state before it goes to the file. The step's number, or -1. */
static long find_step(const app_report *r, const char *path) {
    skein_world *world = r->loaded->world;
    skein_error error;
    long most = (long)(EVERY + 2) * r->steps_per_frame;
    for (long step = 0; step < most; step++) {
        if (io_snapshot_write(world, "", path, &error)) {
            app_print_error(&error);
            return -1;
        }
        if (skein_world_step(world, r->dt)) return -1;
        if (first_lost(world) >= 0) return step;
    }
    return -1;
}

/* Writes what --resume reads; false after a printed fault. */
static bool write_run(const app_report *r, const app_good *good, const char *folder) {
    char path[APP_PATH_SIZE], note[80];
    skein_error error;
    snprintf(path, sizeof path, "%s/scene.json", folder);
    bool fine = !io_scene_write(r->loaded->scene, path, &error);
    snprintf(path, sizeof path, "%s/frame-%06d.snapshot", folder, good->frame);
    snprintf(note, sizeof note, "{\"frame\": %d, \"journal\": 0}", good->frame);
    fine = fine && !io_snapshot_write(r->loaded->world, note, path, &error);
    if (!fine) app_print_error(&error);
    return fine && write_text(folder, "run.json", "{\"version\": 1, \"snapshots\": 1, \"no_outputs\": true}\n");
}

/* Of a blow-up before this one. */
static void remove_older(const char *folder) {
    DIR *open = opendir(folder);
    for (struct dirent *entry; open && (entry = readdir(open));) {
        char path[APP_PATH_SIZE + 256];
        size_t length = strlen(entry->d_name);
        if (strncmp(entry->d_name, "frame-", 6) != 0 || length < 9 ||
            strcmp(entry->d_name + length - 9, ".snapshot") != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        unlink(path);
    }
    if (open) closedir(open);
}

static void write_all(app_good *good, app_report *r, const char *folder) {
    skein_world *world = r->loaded->world;
    char path[APP_PATH_SIZE], who[160], spring[240], rule[240], text[3000];
    io_snapshot before;
    skein_error error;
    remove_older(folder);
    if (skein_snapshot_read(world, good->bytes, good->size) || !write_run(r, good, folder)) return;
    snprintf(path, sizeof path, "%s/before.snapshot", folder);
    long step = find_step(r, path), lost = first_lost(world);
    if (step < 0 || io_snapshot_read(path, &before, &error)) return;
    double time = skein_world_time(world);
    name_particle(world, lost, who, sizeof who);
    skein_snapshot_read(world, before.bytes.data, before.bytes.size);
    describe_worst(world, spring, sizeof spring);
    describe_rule(r, good, step + 1, rule, sizeof rule);
    io_snapshot_free(&before);
    snprintf(
        text, sizeof text,
        "%.300s blew up at %.6g s, in step %ld after frame %d. The first particle to be lost: %s.\n%s%s\n"
        "It does so again:\n\n    skein run --resume %.1000s\n\n"
        "scene.json is the scene, frame-%06d.snapshot the last good state that was kept, before.snapshot that before\n"
        "the step. Skein " SKEIN_VERSION ".\n",
        r->loaded->path, time, step + 1, good->frame, who, rule, spring, folder, good->frame);
    if (!write_text(folder, "README.txt", text)) return;
    fprintf(stderr, "skein: first %s. %sskein: %s/README.txt says how to do it again\n", who, rule, folder);
}

void app_blow_up_leave(app_good *good, app_report *r, const char *out) {
    char folder[APP_FOLDER_SIZE];
    if (!good->size || first_lost(r->loaded->world) < 0 ||
        snprintf(folder, sizeof folder, "%s/blow_up", out) >= (int)sizeof folder)
        return;
    size_t size = skein_snapshot_size(r->loaded->world), written;
    void *end = malloc(size); // the report is about the state as it is
    if (!end || skein_snapshot_write(r->loaded->world, end, size, &written)) {
        free(end);
        return;
    }
    if (mkdir(folder, 0777) && errno != EEXIST)
        fprintf(stderr, "skein: %s: cannot write: %s\n", folder, strerror(errno));
    else write_all(good, r, folder);
    skein_snapshot_read(r->loaded->world, end, written);
    free(end);
}
