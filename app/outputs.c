/* A run's folder and its files: free names, folders that are made and undone, each exporter begun and ended. */
#include "app/outputs.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/clips.h"
#include "io/exporters.h"
#include "io/printable.h"
#include "io/recording.h"
#ifdef SKEIN_RENDER
#include "app/footage.h"
#include "render/picture.h"
#endif

enum { MOST_EXPORTS = 16, NAME_SIZE = APP_NAME_SIZE, FOLDER_SIZE = APP_FOLDER_SIZE, PATH_SIZE = APP_PATH_SIZE };

/* One body's growing recording. */
typedef struct record {
    const io_recording_format *format;
    void *file;
    char path[PATH_SIZE]; /* without its ending */
    size_t body;
    int every;
} record;

struct app_outputs {
    const app_scene *loaded;
    int lock; /* the folder, held for this run alone; -1: not */
    char failure[APP_FAILURE_SIZE];
    char folder[FOLDER_SIZE];
    bool made[FOLDER_SIZE];   /* by length: this part of the folder's path was made here */
    char stem[NAME_SIZE];     /* the scene's name, for pictures */
    char (*names)[NAME_SIZE]; /* the bodies' names, all different */
    io_export exports[MOST_EXPORTS];
    size_t export_count, body_count;
    app_clips *clips;
    record *records;
    size_t record_count;
    double *velocities; /* room for the largest body, where there are recordings */
    double *positions;  /* room for the largest body */
#ifdef SKEIN_RENDER
    app_footage *footage; /* of the film, if one is made */
    char film_path[PATH_SIZE];
#endif
};

/* ---- names ---- */

/* A name that is safe as a file's: letters, digits, '-', '_', '.' and whatever is not ASCII. */
static void file_name(const char *given, const char *nameless, char out[NAME_SIZE]) {
    char clean[2 * NAME_SIZE], *name = clean;
    snprintf(clean, sizeof clean, "%s", given);
    io_printable(clean, false);
    const size_t most = NAME_SIZE - 24; // room to tell namesakes apart
    size_t length = 0;
    for (; *name && length < most; name++)
        out[length++] =
            isalnum((unsigned char)*name) || (unsigned char)*name >= 0x80 || strchr("-_.", *name) ? *name : '_';
    while (*name && length && ((unsigned char)*name & 0xc0) == 0x80) name--, length--; // half a letter
    out[length] = 0;
    if (!length || out[0] == '.') snprintf(out, NAME_SIZE, "%s", nameless);
}

static const char *body_text(const skein_world *world, size_t body) {
    skein_handle handle = skein_object_at(world, SKEIN_BODY, body);
    skein_value name = {0, {0, 0, 0}, ""};
    skein_get(world, handle, "name", &name);
    return name.text[0] ? name.text : skein_object_kind(world, handle)->name;
}

static bool is_taken(const app_outputs *outputs, size_t body) {
    for (size_t i = 0; i < outputs->body_count; i++)
        if (i != body && !strcmp(outputs->names[i], outputs->names[body])) return true;
    return false;
}

/* Where a file was named: its stem, and behind that the body's name where there are more than one. */
static void name_by_file(app_outputs *outputs, const char *out) {
    const char *slash = strrchr(out, '/'), *file = slash ? slash + 1 : out;
    int stem = (int)(strrchr(file, '.') - file);
    for (size_t i = 0; i < outputs->body_count; i++) {
        char body[NAME_SIZE];
        snprintf(body, sizeof body, "%s", outputs->names[i]);
        if (outputs->body_count == 1) snprintf(outputs->names[i], NAME_SIZE, "%.*s", stem, file);
        else if (snprintf(outputs->names[i], NAME_SIZE, "%.*s-%s", stem, file, body) >= NAME_SIZE)
            snprintf(outputs->names[i], NAME_SIZE, "%s", body);
    }
}

/* Names all bodies; namesakes get their place behind the name, the first of them keeps its name. */
static void name_bodies(app_outputs *outputs) {
    for (size_t i = 0; i < outputs->body_count; i++)
        file_name(body_text(outputs->loaded->world, i), "body", outputs->names[i]);
    for (size_t i = outputs->body_count; i-- > 0;) {
        size_t length = strlen(outputs->names[i]);
        for (int turn = 0; is_taken(outputs, i) && turn < 100; turn++)
            snprintf(outputs->names[i] + length, NAME_SIZE - length, turn ? "-%zu-%d" : "-%zu", i, turn);
    }
}

/* ---- folders ---- */

/* Makes every folder of the path that is missing; false with errno where it cannot. */
static bool make_folders(app_outputs *outputs) {
    char part[FOLDER_SIZE];
    size_t length = 0;
    while (outputs->folder[length]) {
        length += strspn(outputs->folder + length, "/");
        length += strcspn(outputs->folder + length, "/");
        snprintf(part, sizeof part, "%.*s", (int)length, outputs->folder);
        outputs->made[length] = !mkdir(part, 0777);
        if (!outputs->made[length] && errno != EEXIST) return false;
    }
    struct stat info;
    if (stat(outputs->folder, &info)) return false;
    errno = ENOTDIR;
    return S_ISDIR(info.st_mode) && !access(outputs->folder, W_OK | X_OK);
}

/* Removes those that were made and are empty, the innermost first. */
static void remove_folders(app_outputs *outputs) {
    for (size_t length = strlen(outputs->folder); length; length--) {
        outputs->folder[length] = 0;
        if (outputs->made[length]) rmdir(outputs->folder);
    }
}

/* Two runs would give each other's files their names. The lock goes with the process, so that nothing is left of it
 * after a crash; where a file system has no locks there is none. False: another run has it. */
static bool lock_folder(app_outputs *outputs) {
    outputs->lock = open(outputs->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return outputs->lock < 0 || !flock(outputs->lock, LOCK_EX | LOCK_NB) || errno != EWOULDBLOCK;
}

static int prepare_folder(app_outputs *outputs, const char *folder) {
    size_t length = strlen(folder);
    while (length > 1 && folder[length - 1] == '/') length--;
    if (!length || length >= FOLDER_SIZE) {
        fprintf(stderr, "skein run: --out %s: expected the name of a folder, up to %d bytes\n", length ? "..." : "''",
                FOLDER_SIZE - 1);
        return EXIT_FAULT;
    }
    snprintf(outputs->folder, sizeof outputs->folder, "%.*s", (int)length, folder);
    if (make_folders(outputs)) {
        if (lock_folder(outputs)) return EXIT_OK;
        fprintf(stderr, "skein run: --out %s: another run writes there; wait for its end, or name another folder\n",
                folder);
        return EXIT_FAULT;
    }
    fprintf(stderr, "skein run: --out %s: cannot write there: %s\n", folder,
            errno == ENOTDIR ? "there is a file where a folder should be" : strerror(errno));
    return EXIT_FAULT;
}

/* ---- beginning ---- */

/* Prints a fault, and keeps it for the report. */
static void tell(app_outputs *outputs, const skein_error *error) {
    app_print_error(error);
    app_keep_error(error, outputs->failure);
}

static skein_status surface_of(const app_outputs *outputs, size_t body, skein_surface *surface) {
    return skein_body_surface(outputs->loaded->world, skein_object_at(outputs->loaded->world, SKEIN_BODY, body),
                              surface);
}

/* What of a body is recorded besides its motion. The arrays are the caller's, to be freed. */
typedef struct record_parts {
    double *masses;
    uint32_t *cells, *sizes;
    char *scene;
} record_parts;

static void free_parts(record_parts *parts) {
    free(parts->masses);
    free(parts->cells);
    free(parts->sizes);
    free(parts->scene);
}

/* Its faces, as particles of its own; of a body without any its edges. False without memory. */
static bool gather_cells(const app_outputs *outputs, size_t body, const skein_surface *s, io_recorded *r,
                         record_parts *parts) {
    skein_world *world = outputs->loaded->world;
    skein_handle handle = skein_object_at(world, SKEIN_BODY, body);
    size_t edges = 0, corners = s->face_vertex_count;
    if (!s->face_count && !skein_body_elements(world, handle, SKEIN_EDGES, NULL, 0, &edges)) corners = 2 * edges;
    r->cell_count = s->face_count ? s->face_count : edges;
    if (!r->cell_count) return true;
    parts->cells = malloc(corners * sizeof *parts->cells);
    parts->sizes = malloc(r->cell_count * sizeof *parts->sizes);
    if (!parts->cells || !parts->sizes) return false;
    if (edges) skein_body_elements(world, handle, SKEIN_EDGES, parts->cells, edges, &edges);
    for (size_t c = 0; c < corners; c++)
        parts->cells[c] = (edges ? parts->cells[c] : s->particle_of_vertex[s->face_vertices[c]]) - s->first_particle;
    for (size_t f = 0; f < r->cell_count; f++) parts->sizes[f] = edges ? 2 : s->face_sizes[f];
    r->cells = parts->cells;
    r->cell_sizes = parts->sizes;
    return true;
}

static bool gather_parts(const app_outputs *outputs, size_t body, const skein_surface *s, io_recorded *r,
                         record_parts *parts) {
    skein_view v = skein_velocity_view(outputs->loaded->world);
    parts->masses = malloc(s->particle_count * sizeof *parts->masses + 1);
    parts->scene = io_scene_text(outputs->loaded->scene);
    if (!parts->masses || !parts->scene) return false;
    for (size_t i = 0; i < s->particle_count; i++)
        parts->masses[i] = (double)v.xyzw[4 * (size_t)v.slot_of[s->first_particle + i] + 3];
    *r = (io_recorded){.particles = s->particle_count,
                       .masses = parts->masses,
                       .body = body_text(outputs->loaded->world, body),
                       .scene = parts->scene};
    return gather_cells(outputs, body, s, r, parts);
}

static bool begin_record(app_outputs *outputs, record *r, const skein_surface *surface) {
    char path[PATH_SIZE + 8];
    snprintf(r->path, sizeof r->path, "%s/%s", outputs->folder, outputs->names[r->body]);
    snprintf(path, sizeof path, "%s%s", r->path, r->format->ending);
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    io_recorded recorded;
    record_parts parts = {NULL, NULL, NULL, NULL};
    if (gather_parts(outputs, r->body, surface, &recorded, &parts))
        r->file = r->format->create(path, &recorded, &error);
    free_parts(&parts);
    if (!r->file) tell(outputs, &error);
    return r->file != NULL;
}

/* Begins the recordings of all bodies, if the scene asks for them by name. */
static bool begin_records(app_outputs *outputs, const io_export *wanted) {
    const io_recording_format *format = io_recording_named(wanted->kind->name);
    if (!wanted->asked) return true;
    skein_surface surface;
    for (size_t b = 0; b < outputs->body_count; b++) {
        if (surface_of(outputs, b, &surface)) continue;
        record *r = &outputs->records[outputs->record_count];
        *r = (record){.format = format, .body = b, .every = ((const io_recording_params *)wanted->params)->every};
        if (!begin_record(outputs, r, &surface)) return false;
        outputs->record_count++;
    }
    return true;
}

#ifdef SKEIN_RENDER
/* Begins the film, if the scene asks for one by name. */
static bool begin_film(app_outputs *outputs, const io_export *wanted, bool quiet) {
    const film_options *options = wanted->params;
    if (!wanted->asked) return true;
    snprintf(outputs->film_path, PATH_SIZE, "%s/%s%s", outputs->folder, outputs->stem,
             film_format_at((size_t)options->format)->ending);
    outputs->footage =
        app_footage_begin(outputs->loaded, outputs->film_path, options, outputs->loaded->settings.frames, quiet);
    return outputs->footage != NULL;
}
#endif

static bool reserve(app_outputs *outputs) {
    size_t most = 1;
    skein_surface surface;
    for (size_t b = 0; b < outputs->body_count; b++)
        if (!surface_of(outputs, b, &surface) && surface.particle_count > most) most = surface.particle_count;
    outputs->positions = malloc(3 * most * sizeof *outputs->positions);
    outputs->velocities = malloc(3 * most * sizeof *outputs->velocities);
    outputs->records = calloc(2 * outputs->body_count + 1, sizeof *outputs->records);
    outputs->names = calloc(outputs->body_count + 1, sizeof *outputs->names);
    return outputs->positions && outputs->velocities && outputs->records && outputs->names;
}

static int begin_clips(app_outputs *outputs) {
    skein_error error = {SKEIN_OK, "", ""};
    app_clips_plan plan = {outputs->loaded, outputs->exports, outputs->export_count,
                           outputs->folder, outputs->names,   outputs->body_count};
    outputs->clips = app_clips_begin(&plan, &error);
    if (outputs->clips) return EXIT_OK;
    tell(outputs, &error);
    return EXIT_FAILURE_RUN;
}

/* Begins what else grows with the run. */
static bool begin_export(app_outputs *outputs, const io_export *wanted, bool quiet) {
    const char *kind = wanted->kind->name;
    (void)quiet;
    if (io_recording_named(kind)) return begin_records(outputs, wanted);
#ifdef SKEIN_RENDER
    if (!strcmp(kind, "film")) return begin_film(outputs, wanted, quiet);
#endif
    return true;
}

const char *app_outputs_file(const char *out, char folder[APP_FOLDER_SIZE]) {
    const io_clip_format *format = io_clip_format_of(out);
    const char *slash = strrchr(out, '/');
    struct stat info;
    if (!format || (!stat(out, &info) && S_ISDIR(info.st_mode))) return NULL;
    if (slash && slash - out >= APP_FOLDER_SIZE) return NULL;
    snprintf(folder, APP_FOLDER_SIZE, "%.*s", slash ? (int)(slash - out) + (slash == out) : 1, slash ? out : ".");
    return format->kind.name;
}

static int begin(app_outputs *outputs, const char *out, bool quiet) {
    const app_scene *loaded = outputs->loaded;
    outputs->body_count = skein_object_count(loaded->world, SKEIN_BODY);
    outputs->export_count = io_scene_exports(loaded->scene, outputs->exports, MOST_EXPORTS);
    if (!reserve(outputs)) {
        fprintf(stderr, "skein: out of memory\n");
        return EXIT_FAILURE_RUN;
    }
    file_name(loaded->settings.name, "scene", outputs->stem);
    name_bodies(outputs);
    char parent[FOLDER_SIZE];
    if (app_outputs_file(out, parent)) name_by_file(outputs, out);
    int status = prepare_folder(outputs, app_outputs_file(out, parent) ? parent : out);
    for (size_t e = 0; e < outputs->export_count && !status; e++)
        if (!begin_export(outputs, &outputs->exports[e], quiet)) status = EXIT_FAILURE_RUN;
    return status ? status : begin_clips(outputs);
}

int app_outputs_begin(const app_scene *loaded, const char *out, bool quiet, app_outputs **begun) {
    app_outputs *outputs = calloc(1, sizeof *outputs);
    *begun = NULL;
    if (!outputs) return EXIT_FAILURE_RUN;
    outputs->loaded = loaded;
    outputs->lock = -1;
    int status = begin(outputs, out, quiet);
    if (!status) *begun = outputs;
    else app_outputs_abandon(outputs);
    return status;
}

/* ---- writing ---- */

static bool add_records(app_outputs *outputs, int frame) {
    skein_world *world = outputs->loaded->world;
    for (size_t i = 0; i < outputs->record_count; i++) {
        const record *r = &outputs->records[i];
        skein_surface s;
        skein_error error = {SKEIN_OK, "", ""};
        if (frame % r->every || surface_of(outputs, r->body, &s)) continue;
        skein_positions_copy(world, s.first_particle, s.particle_count, outputs->positions);
        skein_velocities_copy(world, s.first_particle, s.particle_count, outputs->velocities);
        if (!r->format->add(r->file, skein_world_time(world), outputs->positions, outputs->velocities, &error))
            continue;
        tell(outputs, &error);
        return false;
    }
    return true;
}

bool app_outputs_frame(app_outputs *outputs, int frame) {
    if (!add_records(outputs, frame)) return false;
    skein_error error = {SKEIN_OK, "", ""};
    if (app_clips_frame(outputs->clips, frame, &error)) {
        tell(outputs, &error);
        return false;
    }
#ifdef SKEIN_RENDER
    // picture k shows the world after k frames, so that the film is as long as the run
    bool in_film = outputs->footage && (!frame || frame < outputs->loaded->settings.frames);
    if (in_film && !app_footage_frame(outputs->footage)) {
        snprintf(outputs->failure, sizeof outputs->failure, "%s: the film could not be written", outputs->film_path);
        return false;
    }
#endif
    return true;
}

const char *app_outputs_failure(const app_outputs *outputs) {
    return outputs->failure;
}

typedef struct notebook {
    void (*wrote)(void *user, const char *path);
    void *user;
    bool good;
} notebook;

/* Notes a file that was written, or prints why it was not. */
static void note(void *user, const char *path, skein_status status, const skein_error *error) {
    notebook *book = user;
    if (!status) book->wrote(book->user, path);
    else app_print_error(error);
    book->good &= !status;
}

#ifdef SKEIN_RENDER
static void write_picture(const app_outputs *outputs, const render_picture_options *options, notebook *book) {
    char path[PATH_SIZE];
    skein_error error = {SKEIN_OK, "", ""};
    snprintf(path, sizeof path, "%s/%s.png", outputs->folder, outputs->stem);
    note(book, path,
         render_picture(outputs->loaded->world, path, options, io_scene_view(outputs->loaded->scene), &error), &error);
}
#endif

bool app_outputs_finish(app_outputs *outputs, void (*wrote)(void *user, const char *path), void *user) {
    notebook book = {wrote, user, true};
    app_clips_finish(outputs->clips, note, &book);
    outputs->clips = NULL;
    for (size_t i = 0; i < outputs->record_count; i++) {
        record *r = &outputs->records[i];
        char path[PATH_SIZE + 8];
        skein_error error = {SKEIN_OK, "", ""};
        skein_status status = r->format->commit(r->file, &error);
        r->file = NULL;
        for (const char *ending = r->format->ending; ending;
             ending = status || ending != r->format->ending ? NULL : r->format->second) {
            snprintf(path, sizeof path, "%s%s", r->path, ending);
            note(&book, path, status, &error);
        }
    }
    for (size_t e = 0; e < outputs->export_count; e++) {
#ifdef SKEIN_RENDER
        if (!strcmp(outputs->exports[e].kind->name, "png")) write_picture(outputs, outputs->exports[e].params, &book);
#endif
    }
#ifdef SKEIN_RENDER
    if (outputs->footage) {
        bool complete = app_footage_end(outputs->footage, NULL);
        outputs->footage = NULL;
        if (complete) wrote(user, outputs->film_path);
        book.good &= complete;
    }
#endif
    app_outputs_leave(outputs);
    return book.good;
}

/* ---- a run that failed ---- */

static void keep_records(app_outputs *outputs, notebook *book) {
    for (size_t i = 0; i < outputs->record_count; i++) {
        record *r = &outputs->records[i];
        char path[PATH_SIZE + 16];
        skein_error error = {SKEIN_OK, "", ""};
        snprintf(path, sizeof path, "%s.failed%s", r->path, r->format->ending);
        skein_status status = r->format->keep(r->file, path, &error);
        r->file = NULL;
        note(book, path, status, &error);
        if (status || !r->format->second) continue;
        snprintf(path, sizeof path, "%s.failed%s", r->path, r->format->second);
        note(book, path, status, &error);
    }
}

#ifdef SKEIN_RENDER
/* A film grows under its own name; what there is of it plays. */
static void keep_film(app_outputs *outputs, notebook *book) {
    if (!outputs->footage) return;
    char path[PATH_SIZE + 8];
    const char *ending = strrchr(outputs->film_path, '.');
    snprintf(path, sizeof path, "%.*s.failed%s", (int)(ending - outputs->film_path), outputs->film_path, ending);
    book->good &= app_footage_end(outputs->footage, NULL);
    outputs->footage = NULL;
    skein_error error = {SKEIN_OK, "", ""};
    skein_status status = SKEIN_OK;
    if (access(outputs->film_path, F_OK)) { // it was the film that failed, which was told: it has that name, or is gone
        if (access(path, F_OK)) return;
    } else if (rename(outputs->film_path, path))
        status = io_error_set(&error, SKEIN_ERROR_FILE, path, "cannot write: %s", strerror(errno));
    note(book, path, status, &error);
}
#endif

void app_outputs_keep(app_outputs *outputs, void (*wrote)(void *user, const char *path), void *user) {
    notebook book = {wrote, user, true};
    app_clips_keep(outputs->clips, note, &book);
    outputs->clips = NULL;
    keep_records(outputs, &book);
#ifdef SKEIN_RENDER
    keep_film(outputs, &book);
#endif
    app_outputs_leave(outputs);
}

void app_outputs_abandon(app_outputs *outputs) {
    if (!outputs) return;
    app_clips_abandon(outputs->clips);
#ifdef SKEIN_RENDER
    app_footage_abandon(outputs->footage);
#endif
    for (size_t i = 0; i < outputs->record_count; i++)
        if (outputs->records[i].file) outputs->records[i].format->abandon(outputs->records[i].file);
    remove_folders(outputs);
    if (outputs->lock >= 0) close(outputs->lock);
    free(outputs->records);
    free(outputs->velocities);
    free(outputs->names);
    free(outputs->positions);
    free(outputs);
}

void app_outputs_leave(app_outputs *outputs) {
    if (outputs) memset(outputs->made, 0, sizeof outputs->made);
    app_outputs_abandon(outputs);
}
