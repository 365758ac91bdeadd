/* Keeping what a run can go on from, and going on: see keep.h. Owns the resume folder and its files. */
#include "app/keep.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/snapshot.h"

enum { SORT_FRAME = 1, SORT_LINE = 2, NEWEST = 2, RUN_VERSION = 1 };

struct app_keep {
    char folder[APP_FOLDER_SIZE], beside[APP_FOLDER_SIZE]; /* beside: where the outputs are */
    int every, taken[NEWEST];                              /* frames of the newest snapshots; -1: none */
    io_journal *journal;
    char *room; /* of a frame's entry */
    size_t size;
    json_t *run;
    char failure[APP_FAILURE_SIZE];
};

static bool tell(app_keep *keep, const skein_error *error) {
    app_print_error(error);
    app_keep_error(error, keep->failure);
    return false;
}

static bool tell_memory(void) {
    fprintf(stderr, "skein: out of memory\n");
    return false;
}

static void name_in(const char *folder, const char *name, char path[APP_PATH_SIZE]) {
    snprintf(path, APP_PATH_SIZE, "%s/%s", folder, name);
}

static void name_snapshot(const char *folder, int frame, char path[APP_PATH_SIZE]) {
    char name[40];
    snprintf(name, sizeof name, "frame-%06d.snapshot", frame);
    name_in(folder, name, path);
}

/* The frame of a snapshot by its file's name; -1 for other files. */
static int frame_of(const char *name) {
    int frame, length = 0;
    return sscanf(name, "frame-%d.snapshot%n", &frame, &length) == 1 && length && !name[length] ? frame : -1;
}

/* ---- frames ---- */

static size_t frame_size(const skein_world *world) {
    return sizeof(int64_t) + sizeof(double) + 6 * skein_particle_count(world) * sizeof(skein_real);
}

static skein_buffer reals(void *data) {
    skein_buffer buffer = {data, 0, sizeof(skein_real) == 8 ? SKEIN_FLOAT64 : SKEIN_FLOAT32};
    return buffer;
}

static bool note_frame(app_keep *keep, const app_report *r) {
    skein_world *world = r->loaded->world;
    size_t count = skein_particle_count(world);
    int64_t frame = r->frames;
    double time = skein_world_time(world);
    skein_real *x = (skein_real *)(void *)(keep->room + sizeof frame + sizeof time);
    memcpy(keep->room, &frame, sizeof frame);
    memcpy(keep->room + sizeof frame, &time, sizeof time);
    skein_error error;
    if (skein_positions_copy_to(world, 0, count, reals(x)) ||
        skein_velocities_copy_to(world, 0, count, reals(x + 3 * count)))
        return tell(keep, skein_world_error(world));
    return !io_journal_add(keep->journal, SORT_FRAME, keep->room, keep->size, &error) || tell(keep, &error);
}

bool app_keep_line(app_keep *keep, const char *line) {
    skein_error error;
    return !io_journal_add(keep->journal, SORT_LINE, line, strlen(line) + 1, &error) || tell(keep, &error);
}

/* Shows a frame to the world: what is drawn and written of it. */
static bool set_frame(skein_world *world, const char *bytes) {
    size_t count = skein_particle_count(world);
    double time, *xyz = malloc(3 * count * sizeof *xyz + 1);
    memcpy(&time, bytes + sizeof(int64_t), sizeof time);
    bytes += sizeof(int64_t) + sizeof time;
    bool good = xyz && !skein_world_time_set(world, time);
    for (int v = 0; v < 2 && good; v++) {
        for (size_t i = 0; i < 3 * count; i++) {
            skein_real x;
            memcpy(&x, bytes, sizeof x);
            xyz[i] = (double)x;
            bytes += sizeof x;
        }
        good = v ? !skein_velocities_set(world, 0, count, xyz) : !skein_positions_set(world, 0, count, xyz);
    }
    free(xyz);
    return good;
}

/* ---- what the report knows by then ---- */

static char *write_note(const app_keep *keep, const app_report *r) {
    const io_verdict *v = &r->verdict.numbers;
    const struct {
        const char *name;
        json_t *value;
    } members[] = {
        {"frame", json_integer(r->frames)},
        {"journal", json_integer((json_int_t)io_journal_size(keep->journal))},
        {"driven", json_boolean(v->driven)},
        {"start_stretch", json_real(v->start_stretch)},
        {"start_elastic", json_real(v->start_elastic)},
        {"most_moving", json_real(v->most_moving)},
        {"most_potential", json_real(v->most_potential)},
        {"worst_stretch", json_real(r->worst_stretch)},
        {"worst_crossings", json_integer((json_int_t)r->worst_crossings)},
        {"crossed_frames", json_integer(r->crossed_frames)},
        {"crossed_noted", json_integer((json_int_t)r->crossed_noted)},
        {"seconds", json_real(r->seconds)},
        {"flocks_noted", json_integer(r->flocks_noted)},
        {"flocks", json_incref(r->flocks)},
    };
    json_t *note = json_object();
    for (size_t i = 0; i < sizeof members / sizeof *members; i++) // what is not finite stays away
        json_object_set_new(note, members[i].name, members[i].value);
    char *text = json_dumps(note, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(note);
    return text;
}

static double number_in(const json_t *note, const char *name) {
    return json_number_value(json_object_get(note, name));
}

static void read_note(const json_t *note, app_report *r) {
    json_t *flocks = json_object_get(note, "flocks");
    r->frames = (int)number_in(note, "frame");
    r->verdict = (app_verdict){.loaded = r->loaded,
                               .numbers = {.most_stretch = r->loaded->settings.most_stretch,
                                           .driven = json_is_true(json_object_get(note, "driven")),
                                           .start_stretch = number_in(note, "start_stretch"),
                                           .start_elastic = number_in(note, "start_elastic"),
                                           .most_moving = number_in(note, "most_moving"),
                                           .most_potential = number_in(note, "most_potential")}};
    r->worst_stretch = number_in(note, "worst_stretch");
    r->worst_crossings = (size_t)number_in(note, "worst_crossings");
    r->crossed_frames = (int)number_in(note, "crossed_frames");
    r->crossed_noted = (uint64_t)number_in(note, "crossed_noted");
    r->seconds = number_in(note, "seconds");
    r->flocks_noted = (int)number_in(note, "flocks_noted");
    if (json_is_array(flocks)) json_array_extend(r->flocks, flocks);
}

static bool take_snapshot(app_keep *keep, const app_report *r) {
    char path[APP_PATH_SIZE];
    skein_error error;
    if (io_journal_sync(keep->journal, &error)) return tell(keep, &error);
    char *note = write_note(keep, r);
    if (!note) return tell_memory();
    name_snapshot(keep->folder, r->frames, path);
    skein_status status = io_snapshot_write(r->loaded->world, note, path, &error);
    free(note);
    if (status) return tell(keep, &error);
    if (keep->taken[0] == r->frames) return true;
    if (keep->taken[NEWEST - 1] >= 0) {
        name_snapshot(keep->folder, keep->taken[NEWEST - 1], path);
        unlink(path);
    }
    for (int i = NEWEST - 1; i > 0; i--) keep->taken[i] = keep->taken[i - 1];
    keep->taken[0] = r->frames;
    return true;
}

bool app_keep_frame(app_keep *keep, app_report *r, bool now) {
    if (!keep) return true;
    bool due = now || (r->frames && r->frames % keep->every == 0);
    return (now || note_frame(keep, r)) && (!due || !r->frames || take_snapshot(keep, r));
}

const char *app_keep_failure(const app_keep *keep) {
    return keep ? keep->failure : "";
}

/* ---- the folder ---- */

static void beside_of(const char *out, char folder[APP_FOLDER_SIZE]) {
    if (!app_outputs_file(out, folder)) snprintf(folder, APP_FOLDER_SIZE, "%s", out);
}

static bool folder_of(const char *out, char folder[APP_FOLDER_SIZE]) {
    char parent[APP_FOLDER_SIZE];
    int length = snprintf(folder, APP_FOLDER_SIZE, app_outputs_file(out, parent) ? "%s.resume" : "%s/resume", out);
    return length < APP_FOLDER_SIZE - 40;
}

/* Removes the files that runs leave here, and no others. */
static void empty_folder(const char *folder) {
    char path[APP_PATH_SIZE];
    DIR *open = opendir(folder);
    struct dirent *entry;
    name_in(folder, "run.json", path);
    unlink(path); // first: without it nobody goes on from the rest
    while (open && (entry = readdir(open))) {
        size_t length = strlen(entry->d_name);
        if (frame_of(entry->d_name) < 0 && strcmp(entry->d_name, "frames.journal") != 0) continue;
        if (length >= 64) continue;
        snprintf(path, sizeof path, "%s/%.64s", folder, entry->d_name);
        unlink(path);
    }
    if (open) closedir(open);
}

static bool write_run(app_keep *keep) {
    char path[APP_PATH_SIZE];
    skein_error error = {SKEIN_ERROR_MEMORY, "run.json", "out of memory"};
    name_in(keep->folder, "run.json", path);
    char *text = json_dumps(keep->run, JSON_INDENT(2));
    io_output *output = text ? io_output_open(path, &error) : NULL;
    if (output) {
        io_output_write(output, text, strlen(text));
        io_output_write(output, "\n", 1);
        io_output_sync(output);
        if (!io_output_commit(output, &error)) error.status = SKEIN_OK;
    }
    free(text);
    return !error.status || tell(keep, &error);
}

static void note_text(json_t *run, const char *name, const char *text) {
    if (text) json_object_set_new(run, name, json_string(text));
}

/* The log's place from anywhere. */
static void note_log(json_t *run, const char *path) {
    char resolved[PATH_MAX], folder[APP_FOLDER_SIZE];
    const char *slash = path ? strrchr(path, '/') : NULL;
    if (!path) return;
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
    bool whole = realpath(folder, resolved) != NULL;
    json_t *text = whole ? json_sprintf("%s/%s", resolved, slash ? slash + 1 : path) : json_string(path);
    json_object_set_new(run, "log", text);
}

/* Those that a run left which was killed before its first snapshot are to go, too. */
static void note_earlier_processes(json_t *run, const char *folder) {
    char path[APP_PATH_SIZE];
    name_in(folder, "run.json", path);
    json_t *earlier = json_load_file(path, 0, NULL), *list = json_object_get(earlier, "processes");
    if (json_is_array(list)) json_object_set(run, "processes", list);
    json_decref(earlier);
}

static void note_process(app_keep *keep) {
    json_t *list = json_object_get(keep->run, "processes");
    if (!list) json_object_set_new(keep->run, "processes", list = json_array());
    json_array_append_new(list, json_integer(getpid()));
}

static app_keep *new_keep(const app_report *r, const char *folder, const char *out, int every, json_t *run) {
    app_keep *keep = calloc(1, sizeof *keep);
    if (keep) {
        snprintf(keep->folder, sizeof keep->folder, "%s", folder);
        beside_of(out, keep->beside);
        keep->every = every;
        for (int i = 0; i < NEWEST; i++) keep->taken[i] = -1;
        keep->size = frame_size(r->loaded->world);
        keep->room = malloc(keep->size);
        keep->run = run;
    }
    if (keep && keep->room && run) return keep;
    tell_memory();
    if (keep) free(keep->room);
    free(keep);
    json_decref(run);
    return NULL;
}

app_keep *app_keep_begin(app_report *r, const char *out, int every) {
    char folder[APP_FOLDER_SIZE], path[APP_PATH_SIZE];
    if (!folder_of(out, folder)) {
        fprintf(stderr, "skein run: --out: the folder's name is too long to hold snapshots\n");
        return NULL;
    }
    json_t *run = json_object();
    json_object_set_new(run, "version", json_integer(RUN_VERSION));
    note_text(run, "skein", SKEIN_VERSION);
    json_object_set_new(run, "is_file", json_boolean(r->is_file));
    json_object_set_new(run, "snapshots", json_integer(every));
    note_earlier_processes(run, folder);
    note_log(run, r->log_path);
    note_text(run, "up", app_value(r->arguments, "--up"));
    note_text(run, "scale", app_value(r->arguments, "--scale"));
    note_text(run, "device", app_value(r->arguments, "--device"));
    app_keep *keep = new_keep(r, folder, out, every, run);
    if (!keep) return NULL;
    skein_error error = {SKEIN_OK, "", ""};
    bool good = true;
    if (mkdir(folder, 0777) && errno != EEXIST) {
        io_error_set(&error, SKEIN_ERROR_FILE, folder, "cannot write: %s", strerror(errno));
        good = tell(keep, &error);
    }
    if (good) empty_folder(folder);
    name_in(folder, "scene.json", path);
    if (good && io_scene_write(r->loaded->scene, path, &error)) good = tell(keep, &error);
    name_in(folder, "frames.journal", path);
    if (good && !(keep->journal = io_journal_begin(path, &error))) good = tell(keep, &error);
    note_process(keep);
    if (good && write_run(keep)) return keep;
    app_keep_end(keep, false);
    return NULL;
}

/* Removes NAME.PID.part and NAME.PID-N.part of processes that were killed. */
static void remove_parts(const app_keep *keep) {
    DIR *open = opendir(keep->beside);
    struct dirent *entry;
    while (open && (entry = readdir(open))) {
        size_t index, length = strlen(entry->d_name);
        json_t *process;
        if (length < 6 || strcmp(entry->d_name + length - 5, ".part") != 0) continue;
        json_array_foreach(json_object_get(keep->run, "processes"), index, process) {
            char middle[40], path[APP_PATH_SIZE + 256];
            snprintf(middle, sizeof middle, ".%lld", (long long)json_integer_value(process));
            const char *at = strstr(entry->d_name, middle);
            char after = at ? at[strlen(middle)] : 0;
            if (json_integer_value(process) == getpid() || !at || (after != '.' && after != '-')) continue;
            snprintf(path, sizeof path, "%s/%s", keep->beside, entry->d_name);
            unlink(path);
        }
    }
    if (open) closedir(open);
}

void app_keep_end(app_keep *keep, bool complete) {
    if (!keep) return;
    if (complete) remove_parts(keep);
    io_journal_end(keep->journal);
    json_decref(keep->run);
    free(keep->room);
    free(keep);
}

/* ---- going on ---- */

static bool is_file(const char *folder, const char *name) {
    char path[APP_PATH_SIZE];
    struct stat info;
    name_in(folder, name, path);
    return !stat(path, &info) && S_ISREG(info.st_mode);
}

/* Where run.json is: in the folder, or in its "resume". */
static bool find_run(const char *given, char folder[APP_FOLDER_SIZE]) {
    char name[APP_FOLDER_SIZE];
    size_t length = strlen(given);
    while (length > 1 && given[length - 1] == '/') length--;
    if (length >= APP_FOLDER_SIZE - 40) return false;
    snprintf(name, sizeof name, "%.*s", (int)length, given);
    for (size_t i = 0; i < 3; i++) {
        if (i == 0) snprintf(folder, APP_FOLDER_SIZE, "%s", name);
        else if (i == 1) snprintf(folder, APP_FOLDER_SIZE, "%.*s/resume", APP_FOLDER_SIZE - 40, name);
        else snprintf(folder, APP_FOLDER_SIZE, "%.*s.resume", APP_FOLDER_SIZE - 40, name);
        if (is_file(folder, "run.json")) return true;
    }
    return false;
}

static void text_in(const json_t *run, const char *name, char *out, size_t size) {
    const char *text = json_string_value(json_object_get(run, name));
    snprintf(out, size, "%s", text ? text : "");
}

int app_kept_read(const char *given, app_kept *kept) {
    *kept = (app_kept){.every = 0};
    if (!find_run(given, kept->folder)) {
        fprintf(stderr,
                "skein run: --resume %s: there is no run.json: expected what a run with --out FOLDER --snapshots N "
                "left, FOLDER or FOLDER/resume\n",
                given);
        return EXIT_FAULT;
    }
    char path[APP_PATH_SIZE];
    json_error_t fault;
    name_in(kept->folder, "run.json", path);
    kept->run = json_load_file(path, 0, &fault);
    json_int_t version = json_integer_value(json_object_get(kept->run, "version"));
    kept->every = (int)json_integer_value(json_object_get(kept->run, "snapshots"));
    if (version > RUN_VERSION)
        fprintf(stderr,
                "skein: %s: a run of version %lld, and Skein " SKEIN_VERSION
                " goes on with version %d: take the Skein that began it\n",
                path, (long long)version, RUN_VERSION);
    else if (version < 1 || kept->every < 1)
        fprintf(stderr, "skein: %s: it is no run of Skein's, or damaged: %s\n", path,
                kept->run ? "it has no version" : fault.text);
    if (version != RUN_VERSION || kept->every < 1) {
        app_kept_free(kept);
        return EXIT_FAULT;
    }
    name_in(kept->folder, "scene.json", kept->scene);
    text_in(kept->run, "log", kept->log, sizeof kept->log);
    text_in(kept->run, "up", kept->up, sizeof kept->up);
    text_in(kept->run, "scale", kept->scale, sizeof kept->scale);
    text_in(kept->run, "device", kept->device, sizeof kept->device);
    // the outputs go where this folder is
    size_t length = strlen(kept->folder), end = sizeof "/resume" - 1;
    bool beside = length > end &&
                  (!strcmp(kept->folder + length - end, "/resume") || !strcmp(kept->folder + length - end, ".resume"));
    bool none = json_is_true(json_object_get(kept->run, "no_outputs"));
    if (beside && !none) snprintf(kept->out, sizeof kept->out, "%.*s", (int)(length - end), kept->folder);
    else if (!strcmp(kept->folder, "resume") && !none) snprintf(kept->out, sizeof kept->out, ".");
    return EXIT_OK;
}

void app_kept_free(app_kept *kept) {
    json_decref(kept->run);
    kept->run = NULL;
}

/* The newest snapshots in the folder, the newest first. */
static void list_snapshots(const char *folder, int frames[NEWEST]) {
    for (int i = 0; i < NEWEST; i++) frames[i] = -1;
    DIR *open = opendir(folder);
    struct dirent *entry;
    while (open && (entry = readdir(open))) {
        int frame = frame_of(entry->d_name);
        for (int i = 0; i < NEWEST && frame >= 0; i++)
            if (frame > frames[i]) {
                int kept = frames[i];
                frames[i] = frame, frame = kept;
            }
    }
    if (open) closedir(open);
}

typedef struct replay {
    app_report *report;
    app_outputs *outputs;
    size_t size;
    int frames;
    bool good;
} replay;

static bool show_entry(void *user, uint64_t sort, const void *bytes, size_t size) {
    replay *play = user;
    if (sort == SORT_LINE && play->report->log && size && !((const char *)bytes)[size - 1])
        app_log_text(play->report->log, bytes);
    if (sort != SORT_FRAME) return true;
    if (size != play->size) {
        fprintf(stderr, "skein: frames.journal: its frames are of another world\n");
        return play->good = false;
    }
    play->good = set_frame(play->report->loaded->world, bytes);
    if (!play->good) app_print_error(skein_world_error(play->report->loaded->world));
    play->good = play->good && (!play->outputs || app_outputs_frame(play->outputs, play->frames));
    play->frames++;
    return play->good;
}

/* Shows the frames before the snapshot, and takes the world there. */
static bool replay_to(const app_kept *kept, app_report *r, app_outputs *outputs, const io_snapshot *snapshot,
                      uint64_t journal) {
    char path[APP_PATH_SIZE];
    skein_error error = {SKEIN_OK, "", ""};
    skein_world *world = r->loaded->world;
    replay play = {r, outputs, frame_size(world), 0, true};
    name_in(kept->folder, "frames.journal", path);
    bool shows = journal && (outputs || r->log);
    if (skein_snapshot_read(world, snapshot->bytes.data, snapshot->bytes.size)) { // before anything is written
        app_print_error(skein_world_error(world));
        return false;
    }
    if (shows && io_journal_read(path, journal, show_entry, &play, NULL, &error)) {
        app_print_error(&error);
        return false;
    }
    if (shows && play.good && play.frames != r->frames + 1) {
        fprintf(stderr, "skein: %s: it has %d frames, and the snapshot is of frame %d\n", path, play.frames, r->frames);
        return false;
    }
    if (!play.good) return false;
    if (!skein_snapshot_read(world, snapshot->bytes.data, snapshot->bytes.size)) return true;
    app_print_error(skein_world_error(world));
    return false;
}

static bool go_on_from(const app_kept *kept, app_report *r, app_outputs *outputs, int frame, app_keep **keep,
                       bool *damaged) {
    char path[APP_PATH_SIZE];
    skein_error error;
    io_snapshot snapshot;
    json_error_t fault;
    name_snapshot(kept->folder, frame, path);
    *damaged = io_snapshot_read(path, &snapshot, &error) != SKEIN_OK;
    if (*damaged) {
        app_print_error(&error);
        return false;
    }
    json_t *note = json_loads(snapshot.note, 0, &fault);
    uint64_t journal = (uint64_t)json_integer_value(json_object_get(note, "journal"));
    bool good = note && json_integer_value(json_object_get(note, "frame")) == frame;
    *damaged = !good;
    if (good) read_note(note, r);
    else fprintf(stderr, "skein: %s: the snapshot's note is damaged\n", path);
    json_decref(note);
    good = good && replay_to(kept, r, outputs, &snapshot, journal);
    io_snapshot_free(&snapshot);
    if (!good || !kept->out[0]) return good;
    name_in(kept->folder, "frames.journal", path);
    if (!(*keep = new_keep(r, kept->folder, kept->out, kept->every, json_incref(kept->run)))) return false;
    note_process(*keep);
    if (!((*keep)->journal = io_journal_go_on(path, journal, &error))) return tell(*keep, &error);
    int frames[NEWEST];
    list_snapshots(kept->folder, frames);
    for (int i = 0, next = 0; i < NEWEST; i++)
        if (frames[i] >= 0 && frames[i] <= frame) (*keep)->taken[next++] = frames[i];
    return write_run(*keep);
}

bool app_kept_go_on(const app_kept *kept, app_report *r, app_outputs *outputs, app_keep **keep) {
    int frames[NEWEST];
    list_snapshots(kept->folder, frames);
    for (int i = 0; i < NEWEST && frames[i] >= 0; i++) {
        bool damaged;
        if (go_on_from(kept, r, outputs, frames[i], keep, &damaged)) {
            if (!r->calm) fprintf(stderr, "skein: going on from frame %d\n", r->frames);
            return true;
        }
        r->frames = 0; // none were made
        if (!damaged) return false;
    }
    if (!r->calm) fprintf(stderr, "skein: no snapshot had been taken: the run begins anew\n");
    return !kept->out[0] || (*keep = app_keep_begin(r, kept->out, kept->every)) != NULL;
}
