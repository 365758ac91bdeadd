/* What Python calls besides the public header: scenes from JSON, many steps in one call, and the sizes of structs.
 *
 * Owns: a py_scene, the document that a world was built from. skein/_library.py is the only caller, by ctypes, which lets
 * go of the interpreter's lock while a call runs; nothing here calls Python but the callback that faults go to. Worlds
 * are the caller's, as everywhere; a scene outlives its world's building and may be freed before or after it. */
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "io/advice.h"
#include "io/mesh.h"
#include "io/scene_settings.h"
#include "render/view.h"
#include <skein/attach.h>
#include <skein/cut.h>
#include <skein/gradient.h>
#include <skein/record.h>

#define EXPORT __attribute__((visibility("default")))

typedef struct py_scene {
    io_scene *scene;
} py_scene;

/* Whoever hears of faults: status, place and words of each. */
typedef void (*py_report)(void *user, int status, const char *where, const char *message);
typedef struct hearer {
    py_report report;
    void *user;
} hearer;

static void pass_fault(void *user, const skein_error *error) {
    const hearer *to = user;
    to->report(to->user, (int)error->status, error->where, error->message);
}

/* ---- scenes ---- */

EXPORT bool py_path_is_mesh(const char *path);
EXPORT py_scene *py_scene_open(const char *text, size_t size, const char *path, const char *const *sets,
                               py_report report, void *user);
EXPORT skein_world *py_scene_build(py_scene *scene, const skein_world_desc *desc, py_report report, void *user);
EXPORT char *py_scene_settings(const py_scene *scene);
EXPORT char *py_scene_text(const py_scene *scene);
EXPORT char *py_scene_text_anywhere(const py_scene *scene);
EXPORT bool py_scene_note(py_scene *scene, const char *set, py_report report, void *user);
EXPORT const void *py_scene_view(const py_scene *scene);
EXPORT void py_scene_free(py_scene *scene);
EXPORT void py_free(void *memory);

/* Whether a path's ending is a mesh's: then py_scene_open() takes it without a text. */
bool py_path_is_mesh(const char *path) {
    return io_path_is_mesh(path);
}

/* Reads a scene; `path` serves messages and finds what it names; without a text it is a mesh, which falls on a ball.
 * `sets` are "path=value", NULL-terminated, or NULL. NULL
 * after a fault that leaves nothing to build. What a scene wants to be written is passed over: a run writes, not this. */
py_scene *py_scene_open(const char *text, size_t size, const char *path, const char *const *sets, py_report report,
                        void *user) {
    const skein_kind *const kinds[] = {render_view_kind(), NULL};
    hearer to = {report, user};
    io_faults faults = {pass_fault, &to, 0, NULL};
    py_scene *scene = calloc(1, sizeof *scene);
    if (!scene) return NULL;
    scene->scene = text ? io_scene_read_text(text, size, path, sets, kinds, &faults)
                        : io_scene_of_mesh(path, sets, kinds, &faults);
    if (scene->scene) return scene;
    free(scene);
    return NULL;
}

/* Builds its world; NULL if there was any fault, in reading too. */
skein_world *py_scene_build(py_scene *scene, const skein_world_desc *desc, py_report report, void *user) {
    hearer to = {report, user};
    io_faults faults = {pass_fault, &to, 0, NULL};
    skein_world_desc own = *desc;
    if (!own.thread_count) own.thread_count = io_scene_get(scene->scene)->threads;
    return io_scene_build(scene->scene, &own, &faults);
}

/* What it says of itself, as JSON to be freed. */
char *py_scene_settings(const py_scene *scene) {
    const io_scene_settings *s = io_scene_get(scene->scene);
    double dt;
    int steps = io_scene_steps_per_frame(s, &dt);
    json_t *json = json_pack("{s:s, s:s, s:i, s:f, s:f, s:i}", "name", s->name ? s->name : "", "description",
                             s->description ? s->description : "", "frames", (int)s->frames, "fps", s->fps, "dt", dt,
                             "steps_per_frame", steps);
    char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(json);
    return text;
}

/* The whole document with what was set in it, to be freed. */
char *py_scene_text(const py_scene *scene) {
    return io_scene_text(scene->scene);
}

/* The same with whole paths of its files, to be freed. */
char *py_scene_text_anywhere(const py_scene *scene) {
    return io_scene_text_anywhere(scene->scene);
}

/* Notes "path=value" in the document, so that it can be opened again as its world is now. */
bool py_scene_note(py_scene *scene, const char *set, py_report report, void *user) {
    const skein_kind *const kinds[] = {render_view_kind(), NULL};
    hearer to = {report, user};
    io_faults faults = {pass_fault, &to, 0, NULL};
    json_t *notes = json_array();
    bool good = notes && io_scene_override(io_scene_document(scene->scene), set, kinds, &faults, notes);
    json_decref(notes);
    return good;
}

/* How it wants to be seen, for draw.c: a render_view, which lives as long as the scene. */
const void *py_scene_view(const py_scene *scene) {
    return io_scene_view(scene->scene);
}

void py_scene_free(py_scene *scene) {
    if (!scene) return;
    io_scene_free(scene->scene);
    free(scene);
}

void py_free(void *memory) {
    free(memory);
}

/* ---- stepping ---- */

EXPORT skein_status py_steps(skein_world *world, double dt, size_t count);
EXPORT size_t py_steps_of_all(skein_world *const *worlds, size_t world_count, double dt, size_t count);

/* So many steps, up to the first that fails. */
skein_status py_steps(skein_world *world, double dt, size_t count) {
    skein_status status = SKEIN_OK;
    for (size_t i = 0; i < count && !status; i++) status = skein_world_step(world, dt);
    return status;
}

/* Steps several worlds, one after the other; returns how many went well, and stops at the first that does not. */
size_t py_steps_of_all(skein_world *const *worlds, size_t world_count, double dt, size_t count) {
    size_t done = 0;
    while (done < world_count && !py_steps(worlds[done], dt, count)) done++;
    return done;
}

/* ---- what will go wrong ---- */

EXPORT double py_advise(skein_world *world, double dt, void (*write)(void *user, const char *line), void *user);

/* Foretells what steps of `dt` will suffer from, a line each, as the command does; returns the substeps that a step takes
 * to be stable, infinity where none is enough, 0 where that could not be found. */
double py_advise(skein_world *world, double dt, void (*write)(void *user, const char *line), void *user) {
    double needed = 0;
    io_advise(world, dt, (io_warnings){write, user}, &needed);
    return needed;
}

/* ---- how structs are laid out, so that a binding of another version says so ---- */

EXPORT size_t py_struct_size(const char *name);

/* Of a struct of the header by its name, without "skein_"; 0 for one that is not known here. */
size_t py_struct_size(const char *name) {
#define SIZE_OF(type_) \
    { #type_, sizeof(skein_##type_) }
    static const struct {
        const char *name;
        size_t size;
    } sizes[] = {SIZE_OF(error),
                 SIZE_OF(field),
                 SIZE_OF(kind),
                 SIZE_OF(value),
                 SIZE_OF(setting),
                 SIZE_OF(handle),
                 SIZE_OF(world_desc),
                 SIZE_OF(mesh),
                 SIZE_OF(track),
                 SIZE_OF(view),
                 SIZE_OF(buffer),
                 SIZE_OF(surface),
                 SIZE_OF(pose),
                 SIZE_OF(contact),
                 SIZE_OF(hit),
                 SIZE_OF(statistics),
                 SIZE_OF(order),
                 SIZE_OF(constraint_value),
                 SIZE_OF(gradient_state),
                 SIZE_OF(gradient_desc),
                 SIZE_OF(gradient_result),
                 SIZE_OF(cuts),
                 SIZE_OF(recorder),
                 SIZE_OF(difference),
                 SIZE_OF(pass)};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (!strcmp(sizes[i].name, name)) return sizes[i].size;
    return 0;
}

EXPORT const char *py_statistics_member(size_t index, size_t *offset, size_t *size, bool *whole);

/* What skein_statistics has: a member's name by its index, NULL past the end, with where it is, how many bytes it takes,
 * and whether it is a whole number or, of eight bytes each, real ones. */
const char *py_statistics_member(size_t index, size_t *offset, size_t *size, bool *whole) {
    static const skein_statistics s;
    (void)s;
#define MEMBER(name_) \
    { #name_, offsetof(skein_statistics, name_), sizeof s.name_, _Generic(s.name_, uint64_t : true, default : false) }
    static const struct {
        const char *name;
        size_t offset, size;
        bool whole;
    } members[] = {MEMBER(steps),
                   MEMBER(substeps),
                   MEMBER(time),
                   MEMBER(kinetic_energy),
                   MEMBER(potential_energy),
                   MEMBER(elastic_energy),
                   MEMBER(dissipated_energy),
                   MEMBER(momentum),
                   MEMBER(angular_momentum),
                   MEMBER(max_stretch),
                   MEMBER(p99_stretch),
                   MEMBER(limited),
                   MEMBER(over_limit),
                   MEMBER(most_over_limit),
                   MEMBER(residual),
                   MEMBER(unsolved),
                   MEMBER(newton_iterations),
                   MEMBER(cg_iterations),
                   MEMBER(solver_factors),
                   MEMBER(solver_failures),
                   MEMBER(all_unsolved),
                   MEMBER(all_solver_failures),
                   MEMBER(contact_overflows),
                   MEMBER(max_penetration),
                   MEMBER(contacts),
                   MEMBER(crossings),
                   MEMBER(particles),
                   MEMBER(pinned_particles),
                   MEMBER(constraints),
                   MEMBER(asleep),
                   MEMBER(nonfinite),
                   MEMBER(guarded),
                   MEMBER(memory_bytes),
                   MEMBER(state_hash)};
    if (index >= sizeof members / sizeof *members) return NULL;
    *offset = members[index].offset, *size = members[index].size, *whole = members[index].whole;
    return members[index].name;
}
