/* Playing a scene; see player.h. */
#include "viewer/player.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/advice.h"
#include "io/reach.h"
#include "viewer/events.h"

/* ---- Opening ---- */

static void report_fault(void *user, const skein_error *error) {
    const viewer_reporter *reporter = user;
    char line[800];
    snprintf(line, sizeof line, "%s%s%s", error->where, error->where[0] ? ": " : "", error->message);
    reporter->say(reporter->user, SKEIN_LOG_WARNING, line);
}

static void world_says(void *user, skein_log_level level, const char *message) {
    const viewer_reporter *reporter = user;
    reporter->say(reporter->user, level, message);
}

/* With what was done in the window, which may name files as it likes: it was the user. */
static io_scene *read_scene(const viewer_player *player, const viewer_reading *reading, io_faults *faults) {
    const char **sets = viewer_changes_sets(&player->changes);
    io_reach reach = {reading->allowed, sets};
    faults->reach = &reach;
    io_scene *scene = io_scene_read(player->path, sets, reading->exporters, faults);
    faults->reach = NULL;
    free(sets);
    return scene;
}

static skein_world *build(const viewer_player *player, const viewer_reading *reading, const skein_world_desc *desc,
                          io_faults *faults) {
    const char **sets = viewer_changes_sets(&player->changes);
    io_reach reach = {reading->allowed, sets};
    faults->reach = &reach;
    skein_world *world = io_scene_build(player->scene, desc, faults);
    faults->reach = NULL;
    free(sets);
    return world;
}

static bool is_held(const skein_world *world, size_t particle) {
    skein_view view = skein_position_view(world);
    return !(view.xyzw[4 * (size_t)view.slot_of[particle] + 3] > 0);
}

static bool note_start(viewer_player *player) {
    size_t count = skein_particle_count(player->world);
    player->pins = malloc(count + 1);
    player->velocities = malloc((3 * count + 1) * sizeof *player->velocities);
    for (size_t i = 0; player->pins && i < count; i++) player->pins[i] = is_held(player->world, i);
    return player->pins && player->velocities && !skein_velocities_copy(player->world, 0, count, player->velocities);
}

static void say_advice(void *user, const char *line) {
    const viewer_reporter *reporter = user;
    reporter->say(reporter->user, SKEIN_LOG_WARNING, line);
}

/* As many substeps as are needed and are not there; 0 where there are enough, or no number is. */
static double missing(const viewer_player *player, double needed) {
    skein_value substeps = skein_number(1);
    bool known = !skein_get_path(player->world, "method.substeps", &substeps);
    return known && isfinite(needed) && needed > substeps.number[0] ? needed : 0;
}

void viewer_player_advise(viewer_player *player) {
    double needed = 0;
    io_advise(player->world, player->dt, (io_warnings){say_advice, &player->reporter}, &needed);
    player->needed = missing(player, needed);
}

void viewer_player_advise_anew(viewer_player *player) {
    double needed = 0, before = player->needed;
    io_advise(player->world, player->dt, (io_warnings){NULL, NULL}, &needed);
    player->needed = missing(player, needed);
    if (player->needed > 0 && player->needed != before) viewer_player_advise(player);
}

/* ---- Cards ---- */

bool viewer_player_on_card(const viewer_player *player) {
    return player->world && skein_world_device(player->world).device != SKEIN_DEVICE_CPU;
}

static void say_line(const viewer_player *player, skein_log_level level, const char *words, const char *what) {
    char line[400];
    snprintf(line, sizeof line, "%s%.300s", words, what);
    player->reporter.say(player->reporter.user, level, line);
}

/* The world goes to the card of the context that is current, if there is one that can run it; says what became of it. */
static void take_to_card(const viewer_player *player, viewer_device device) {
    skein_world *world = player->world;
    if (device == VIEWER_ON_PROCESSOR) return;
    if (skein_world_device_set(world, SKEIN_DEVICE_CURRENT_GL) || skein_world_explain(world, player->dt, NULL, NULL)) {
        say_line(player, device == VIEWER_ON_CARD ? SKEIN_LOG_WARNING : SKEIN_LOG_INFO,
                 "runs on the processor: ", skein_world_error(world)->message);
        skein_world_device_set(world, SKEIN_DEVICE_CPU);
        return;
    }
    skein_device_info info = skein_world_device(world);
    if (info.software && device == VIEWER_ON_CARD_IF_ANY) {
        say_line(player, SKEIN_LOG_INFO, "runs on the processor: there is no graphics card, only ", info.name);
        skein_world_device_set(world, SKEIN_DEVICE_CPU);
    } else if (info.software) {
        say_line(player, SKEIN_LOG_WARNING, "there is no graphics card; the processor plays one, slowly: ", info.name);
    } else {
        say_line(player, SKEIN_LOG_INFO, "runs on ", info.name);
    }
}

/* ---- Building ---- */

/* Fills in scene, world and all that belongs to them; `player` has path, changes and reporter. */
static bool load(viewer_player *player, const viewer_reading *reading) {
    io_faults faults = {report_fault, &player->reporter, 0, NULL};
    player->scene = read_scene(player, reading, &faults);
    if (!player->scene) return false;
    player->settings = *io_scene_get(player->scene);
    skein_world_desc desc = skein_default_world_desc();
    desc.log = world_says;
    desc.log_user = &player->reporter;
    desc.thread_count = reading->threads > 0 ? reading->threads : player->settings.threads;
    player->world = build(player, reading, &desc, &faults);
    if (!player->world) return false;
    if (reading->prepare) reading->prepare(player->world);
    const render_view *view = io_scene_view(player->scene);
    player->view = view ? *view : render_view_default();
    player->steps = io_scene_steps_per_frame(&player->settings, &player->dt);
    viewer_player_advise(player);
    take_to_card(player, reading->device);
    player->opened = viewer_seconds();
    bool good = viewer_history_begin(&player->history, player->world) && note_start(player);
    if (good) viewer_history_keep(&player->history, player->world, 0);
    else player->reporter.say(player->reporter.user, SKEIN_LOG_WARNING, "out of memory");
    return good;
}

void viewer_player_close(viewer_player *player) {
    skein_world_destroy(player->world);
    io_scene_free(player->scene);
    viewer_history_release(&player->history);
    free(player->pins);
    free(player->velocities);
    viewer_changes_free(&player->changes);
    memset(player, 0, sizeof *player);
}

/* Loads what `next` describes and puts it in the player's place, if there is no fault. The world keeps the address of
 * the reporter that it was built with, so that one lies where the player will. */
static bool take_over(viewer_player *player, viewer_player *next, const viewer_reading *reading) {
    viewer_player old = *player;
    viewer_player given = *next;
    *player = given;
    if (load(player, reading)) {
        viewer_player_close(&old);
        return true;
    }
    viewer_player_close(player);
    *player = old;
    return false;
}

bool viewer_player_open(viewer_player *player, const char *path, const char *const *sets, const viewer_reading *reading,
                        viewer_reporter reporter) {
    viewer_player next = {.reporter = reporter};
    snprintf(next.path, sizeof next.path, "%s", path);
    bool good = true;
    for (; sets && *sets; sets++) good &= viewer_changes_add(&next.changes, *sets, NULL, NULL);
    next.changes.given = next.changes.count;
    if (good) return take_over(player, &next, reading);
    viewer_changes_free(&next.changes);
    reporter.say(reporter.user, SKEIN_LOG_WARNING, "out of memory");
    return false;
}

/* The places, velocities, pins and clock of another world, if it has as many particles. Where the scene pins others than
 * it did, as `before` says, it is as the scene has it. */
static void go_on_from(viewer_player *player, viewer_history *state, const unsigned char *before) {
    size_t place = (size_t)(state->last % state->room);
    bool same = state->particles == skein_particle_count(player->world);
    for (size_t i = 0; i < state->particles && before && same; i++)
        if ((before[i] != 0) != (player->pins[i] != 0)) state->held[place * state->particles + i] = player->pins[i];
    if (!viewer_history_restore(state, player->world, state->last)) return;
    player->frame = state->last;
    viewer_history_begin(&player->history, player->world);
    viewer_history_keep(&player->history, player->world, player->frame);
}

bool viewer_player_reopen(viewer_player *player, viewer_changes *changes, bool stays, const viewer_reading *reading) {
    viewer_player next = {.reporter = player->reporter};
    viewer_history state = {0};
    memcpy(next.path, player->path, sizeof next.path);
    bool good = changes || viewer_changes_copy(&next.changes, &player->changes);
    if (changes) next.changes = *changes, *changes = (viewer_changes){NULL, 0, 0, 0, 0};
    if (!good) player->reporter.say(player->reporter.user, SKEIN_LOG_WARNING, "out of memory");
    if (good && stays && viewer_history_begin(&state, player->world))
        viewer_history_keep(&state, player->world, player->frame);
    size_t particles = skein_particle_count(player->world);
    unsigned char *before = malloc(particles + 1);
    if (before) memcpy(before, player->pins, particles);
    good = good && take_over(player, &next, reading);
    if (good && stays && state.state) go_on_from(player, &state, before);
    free(before);
    viewer_history_release(&state);
    return good;
}

io_scene *viewer_player_scene(const viewer_player *player, const viewer_reading *reading) {
    viewer_reporter reporter = player->reporter;
    io_faults faults = {report_fault, &reporter, 0, NULL};
    return read_scene(player, reading, &faults);
}

skein_status viewer_player_write(const viewer_player *player, const char *path, const viewer_reading *reading,
                                 skein_error *error) {
    io_scene *scene = viewer_player_scene(player, reading);
    *error = (skein_error){SKEIN_ERROR_FILE, "", "the scene's file cannot be read any more"};
    skein_status status = scene ? io_scene_write(scene, path, error) : error->status;
    io_scene_free(scene);
    return status;
}

/* ---- Playing ---- */

static bool end_step(viewer_player *player, skein_status status, bool *new_frame) {
    *new_frame = false;
    if (status) {
        if (!player->failed) report_fault(&player->reporter, skein_world_error(player->world));
        player->failed = true;
        return false;
    }
    player->failed = false;
    if (++player->step < player->steps) return true;
    player->step = 0;
    *new_frame = true;
    player->frame++;
    if (!viewer_player_on_card(player)) viewer_history_keep(&player->history, player->world, player->frame);
    return true;
}

/* A step; what has come into a world since and cannot run on its card brings it back to the processor. */
static skein_status step(viewer_player *player) {
    skein_status status = skein_world_step(player->world, player->dt);
    if (!status || !viewer_player_on_card(player)) return status;
    say_line(player, SKEIN_LOG_WARNING, "goes on on the processor: ", skein_world_error(player->world)->message);
    status = skein_world_device_set(player->world, SKEIN_DEVICE_CPU);
    return status ? status : skein_world_step(player->world, player->dt);
}

bool viewer_player_step(viewer_player *player, bool *new_frame) {
    return end_step(player, step(player), new_frame);
}

bool viewer_player_profile(viewer_player *player, bool *new_frame, skein_pass *passes, size_t most, size_t *count) {
    return end_step(player, skein_world_profile(player->world, player->dt, passes, most, count), new_frame);
}

void viewer_player_reset(viewer_player *player) {
    // pins that were set by hand go, too
    for (size_t i = 0; i < skein_particle_count(player->world); i++)
        if (is_held(player->world, i) != (player->pins[i] != 0)) skein_particle_pin(player->world, i, player->pins[i]);
    skein_world_reset(player->world);
    skein_velocities_set(player->world, 0, skein_particle_count(player->world), player->velocities);
    player->frame = 0;
    player->step = 0;
    player->failed = false;
    viewer_history_begin(&player->history, player->world);
    viewer_history_keep(&player->history, player->world, 0);
}

bool viewer_player_go_to(viewer_player *player, uint64_t frame) {
    if (!viewer_history_restore(&player->history, player->world, frame)) return false;
    player->frame = frame;
    player->step = 0;
    return true;
}
