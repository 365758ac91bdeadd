/* The table of keys; see keys.h. */
#include "viewer/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <string.h>

#include "io/own_kinds.h"
#include "render/world_birds.h"

/* When a key has its meaning. */
typedef enum key_when { ALWAYS, WITH_SCENE, BY_KEY, WITH_FIELD, WITH_TOOL } key_when;

typedef struct viewer_key {
    int code, mods;   /* mods: 0, or GLFW_MOD_CONTROL, with or without GLFW_MOD_SHIFT */
    const char *name; /* NULL: goes with the row before it */
    key_when when;
    void (*act)(viewer_stage *stage, const struct viewer_key *key);
    int number;        /* what `act` makes of it */
    const char *field; /* of WITH_FIELD: that some rule has */
    bool repeats;      /* while it is held down */
    const char *help;
} viewer_key;

/* ---- What keys do ---- */

static void pause_or_play(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_stage_pause(stage, !stage->paused);
}

static void step(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_stage_pause(stage, true);
    viewer_stage_step(stage);
}

static void step_back(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_stage_pause(stage, true);
    if (stage->sides[0].frame > 0) viewer_stage_go_to(stage, stage->sides[0].frame - 1);
}

static void reset(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_stage_reset(stage);
}

/* As long as the key is down; but a tap moves it a little, too, however fast it was. */
static void move(viewer_stage *stage, const viewer_key *key) {
    static const double tap = 0.03;
    stage->camera.down[key->number] = true;
    stage->dirty |= viewer_camera_move(&stage->camera, tap);
}

static void fly(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_camera_fly(&stage->camera);
    stage->dirty = true;
    viewer_note(stage, stage->camera.flying ? "flight: the mouse looks around, W A S D Q E move, C ends it"
                                            : "back to the first view");
}

static void first_view(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_camera_home(&stage->camera);
    stage->dirty = true;
    viewer_note(stage, "the first view");
}

static void frame_all(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    if (!viewer_take_frames(stage)) return;
    render_subject subject = render_world_frame_subject(stage->frames[0]);
    viewer_camera_frame(&stage->camera, &subject, viewer_aspect(stage));
    stage->dirty = true;
    viewer_note(stage, "all bodies are in the picture");
}

static void follow(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    const char *body = stage->sides[0].view.camera.follow;
    stage->camera.follows = !stage->camera.follows;
    stage->camera.has_middle = false;
    stage->dirty = true;
    if (stage->camera.follows)
        viewer_note(stage, "the view goes along with %.100s; T ends it", body[0] ? body : "the bodies");
    else viewer_note(stage, "the view stands still");
}

static void save_picture(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_save_picture(stage);
}

static void record(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_film_toggle(stage);
}

static void record_all(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    if (stage->records) viewer_recorded_end(stage);
    else viewer_recorded_begin(stage, NULL);
}

static void save_mesh(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_save_mesh(stage);
}

/* Whether colours tell something of this world. */
static bool colours_tell(skein_world *world, int colour) {
    size_t springs = 0, count = skein_object_count(world, SKEIN_BODY);
    bool birds = false;
    for (size_t i = 0; i < count; i++) birds |= render_are_birds(world, skein_object_at(world, SKEIN_BODY, i), NULL);
    switch (colour) {
    case RENDER_BY_BODY: return count > 1;
    case RENDER_BY_STRAIN: return !skein_springs_copy(world, NULL, 0, &springs) && springs > 0;
    case RENDER_BY_DIRECTION: return birds;
    default: return true;
    }
}

/* The next colours that tell something here. */
static void next_colours(viewer_stage *stage, const viewer_key *key) {
    static const int order[] = {RENDER_BY_MATERIAL, RENDER_BY_BODY, RENDER_BY_DIRECTION, RENDER_BY_SPEED,
                                RENDER_BY_STRAIN};
    enum { COUNT = sizeof order / sizeof *order };
    (void)key;
    const skein_field *field = skein_field_find(render_view_kind(), "colour", NULL);
    int at = 0;
    while (at < COUNT && order[at] != stage->sides[0].view.colour) at++;
    do at = (at + 1) % COUNT;
    while (!colours_tell(stage->sides[0].world, order[at]));
    int next = order[at];
    const char *word = field->choices;
    for (int i = 0; i < next; i++) word = strchr(word, '|') + 1;
    viewer_request request = {.kind = VIEWER_SET, .category = SKEIN_VIEW, .field = field, .value = skein_number(next)};
    viewer_stage_set(stage, &request);
    viewer_note(stage, "colours by %.*s", (int)strcspn(word, "|"), word);
}

static void choose_method(viewer_stage *stage, const viewer_key *key) {
    const skein_kind *kind = io_kind_at(SKEIN_METHOD, (size_t)key->number);
    for (size_t s = 0; kind && s < stage->side_count; s++)
        if (!stage->compare[0] || s == 0) viewer_stage_method(stage, s, kind->name);
}

static void toggle_panel(viewer_stage *stage, const viewer_key *key) {
    stage->panel[key->number] = !stage->panel[key->number];
    stage->dirty = true;
    viewer_event(stage->events, "panel %d %s", key->number, stage->panel[key->number] ? "open" : "closed");
}

static void change_theme(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    stage->light = !stage->light;
    bool kept = viewer_theme_keep(stage->light ? VIEWER_LIGHT : VIEWER_DARK);
    viewer_note(stage, "%s%s", stage->light ? "light" : "dark",
                kept ? "" : " (it cannot be kept: ~/.config is not writable)");
    stage->dirty = true;
}

static void reload(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_stage_reload(stage);
}

static void undo(viewer_stage *stage, const viewer_key *key) {
    if (key->number > 0) viewer_stage_redo(stage);
    else viewer_stage_undo(stage);
}

static void revert(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_stage_revert(stage);
}

static void save_scene(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_save_scene(stage);
}

static void solve(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_stage_solve(stage);
}

/* A rule's field goes up or down by a tenth of itself, wherever a rule has it. */
static void change_field(viewer_stage *stage, const viewer_key *key) {
    for (size_t s = 0; s < stage->side_count; s++) {
        skein_world *world = stage->sides[s].world;
        for (size_t i = 0; i < skein_object_count(world, SKEIN_FORCE); i++) {
            skein_handle handle = skein_object_at(world, SKEIN_FORCE, i);
            const skein_field *field = skein_field_find(skein_object_kind(world, handle), key->field, NULL);
            skein_value value;
            if (!field || field->type != SKEIN_FIELD_REAL || skein_get(world, handle, key->field, &value)) continue;
            double step_size = fmax(0.1 * fabs(value.number[0]), 0.01 * fmax(fabs(field->initial[0]), 1));
            double changed = value.number[0] + key->number * step_size;
            changed = fmin(fmax(changed, field->least), field->most);
            viewer_request request = {.kind = VIEWER_SET,
                                      .category = SKEIN_FORCE,
                                      .index = i,
                                      .field = field,
                                      .side = (int)s,
                                      .value = skein_number(changed),
                                      .down = true};
            viewer_stage_set(stage, &request);
            if (s == 0) viewer_note(stage, "%s %.4g %s", key->field, changed, field->unit);
        }
    }
    stage->facts = true;
}

/* First person: what the chosen bird sees. */
static void ride(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    bool done = viewer_ride_toggle(&stage->ride, stage->sides[0].world, &stage->camera);
    stage->dirty = true;
    if (!done) viewer_note(stage, "there is no bird in sight to ride on");
    else if (stage->ride.rides) viewer_note(stage, "rides on bird %u; B ends it", stage->ride.bird);
    else viewer_note(stage, "back to the view before the ride");
}

/* Handles on what is under the pointer, or was before. */
static void handles(viewer_stage *stage, const viewer_key *key) {
    viewer_handles_key(stage, (viewer_tool)key->number);
}

static void next_object(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_handles_next(stage);
}

static void escape(viewer_stage *stage, const viewer_key *key) {
    (void)key;
    viewer_handles_escape(stage);
}

/* ---- The table ---- */

#define TOOL(code_, name_, tool_, help_) \
    { .code = code_, .name = name_, .when = WITH_SCENE, .act = handles, .number = tool_, .help = help_ }

#define PANEL(code_, name_, panel_, help_) \
    { .code = code_, .name = name_, .when = ALWAYS, .act = toggle_panel, .number = panel_, .help = help_ }
#define MOVE(code_, name_, motion_, help_) \
    { .code = code_, .name = name_, .when = WITH_SCENE, .act = move, .number = motion_, .help = help_ }
#define SCENE(code_, name_, act_, help_) \
    { .code = code_, .name = name_, .when = WITH_SCENE, .act = act_, .help = help_ }
#define CONTROL(code_, mods_, name_, act_, number_, help_)                                                 \
    {                                                                                                      \
        .code = code_, .mods = GLFW_MOD_CONTROL | (mods_), .name = name_, .when = WITH_SCENE, .act = act_, \
        .number = number_, .help = help_                                                                   \
    }
#define REPEAT(code_, name_, act_, help_) \
    { .code = code_, .name = name_, .when = WITH_SCENE, .act = act_, .repeats = true, .help = help_ }
#define FIELD(code_, name_, field_, by_, help_)                                                                \
    {                                                                                                          \
        .code = code_, .name = name_, .when = WITH_FIELD, .act = change_field, .number = by_, .field = field_, \
        .repeats = true, .help = help_                                                                         \
    }
#define METHOD(number_, name_, help_)                                                                             \
    {                                                                                                             \
        .code = GLFW_KEY_1 + number_, .name = name_, .when = WITH_SCENE, .act = choose_method, .number = number_, \
        .help = help_                                                                                             \
    }

static const viewer_key keys[] = {
    SCENE(GLFW_KEY_SPACE, "Space", pause_or_play, "pauses and plays"),
    CONTROL(GLFW_KEY_Z, 0, "Ctrl Z", undo, -1, "undoes the last change"),
    CONTROL(GLFW_KEY_Z, GLFW_MOD_SHIFT, NULL, undo, 1, NULL),
    CONTROL(GLFW_KEY_Y, 0, "Ctrl Y", undo, 1, "does it again (as Ctrl Shift Z)"),
    CONTROL(GLFW_KEY_R, 0, "Ctrl R", revert, 0, "back to the scene's file, without the changes"),
    CONTROL(GLFW_KEY_S, 0, "Ctrl S", save_scene, 0, "saves the scene as tuned, in the working directory"),
    REPEAT(GLFW_KEY_PERIOD, ". (period)", step, "pauses, and goes one frame on"),
    REPEAT(GLFW_KEY_COMMA, ", (comma)", step_back, "pauses, and goes one frame back; playing goes on from there"),
    SCENE(GLFW_KEY_BACKSPACE, "Backspace", reset, "puts the scene back to its start"),
    MOVE(GLFW_KEY_W, "W S", VIEWER_FORWARD, "move forward and back"),
    MOVE(GLFW_KEY_S, NULL, VIEWER_BACK, NULL),
    MOVE(GLFW_KEY_A, "A D", VIEWER_LEFT, "move left and right"),
    MOVE(GLFW_KEY_D, NULL, VIEWER_RIGHT, NULL),
    MOVE(GLFW_KEY_Q, "Q E", VIEWER_TURN_LEFT, "turn the view left and right"),
    MOVE(GLFW_KEY_E, NULL, VIEWER_TURN_RIGHT, NULL),
    MOVE(GLFW_KEY_PAGE_UP, "Page Up, Down", VIEWER_TURN_UP, "turn the view up and down"),
    MOVE(GLFW_KEY_PAGE_DOWN, NULL, VIEWER_TURN_DOWN, NULL),
    SCENE(GLFW_KEY_F, "F", frame_all, "brings all bodies into the picture, from the side that is looked from"),
    SCENE(GLFW_KEY_0, "0", first_view, "back to the first view"),
    SCENE(GLFW_KEY_T, "T", follow,
          "the view goes along with the bodies (or the one that camera.follow names), and stands still again"),
    SCENE(GLFW_KEY_C, "C", fly, "flight in the first person, and back to the first view"),
    SCENE(GLFW_KEY_R, "R", next_colours,
          "other colours, those that tell something: material, body, direction, speed, strain"),
    METHOD(0, "1 to 9", "the method: the n-th that `skein list methods` names"),
    METHOD(1, NULL, NULL),
    METHOD(2, NULL, NULL),
    METHOD(3, NULL, NULL),
    METHOD(4, NULL, NULL),
    METHOD(5, NULL, NULL),
    METHOD(6, NULL, NULL),
    METHOD(7, NULL, NULL),
    METHOD(8, NULL, NULL),
    TOOL(GLFW_KEY_G, "G", VIEWER_MOVES,
         "handles to move what is under the pointer: a body, a collider, a force with a place; again puts them away"),
    TOOL(GLFW_KEY_H, "H", VIEWER_TURNS, "handles to turn it"),
    TOOL(GLFW_KEY_L, "L", VIEWER_SIZES, "handles to make it larger and smaller"),
    TOOL(GLFW_KEY_P, "P", VIEWER_PINS,
         "a brush that pins a body's particles, with Shift frees them; the wheel makes it wider"),
    TOOL(GLFW_KEY_K, "K", VIEWER_CUTS,
         "a knife: a stroke cuts the cloth whose picture it crosses; going back makes it whole"),
    SCENE(GLFW_KEY_N, "N", next_object, "the handles go to the next object"),
    {.code = GLFW_KEY_ESCAPE,
     .name = "Esc",
     .when = WITH_TOOL,
     .act = escape,
     .help = "with handles: lets go without a change; puts them away"},
    SCENE(GLFW_KEY_X, "X", save_picture, "saves the picture as a PNG in the working directory (with Shift: the window)"),
    SCENE(GLFW_KEY_V, "V", record, "records a film, and ends it"),
    SCENE(GLFW_KEY_J, "J", record_all, "records all that is done, for `skein verify`, and ends it"),
    SCENE(GLFW_KEY_O, "O", save_mesh, "saves the bodies' meshes as OBJ"),
    SCENE(GLFW_KEY_F5, "F5", reload, "reads the scene's file again; changes made here stay on top of it"),
    PANEL(GLFW_KEY_F1, "F1", VIEWER_PANEL_KEYS, "shows all keys"),
    PANEL(GLFW_KEY_F2, "F2", VIEWER_PANEL_GALLERY, "the gallery of scenes"),
    PANEL(GLFW_KEY_F3, "F3", VIEWER_PANEL_PLOTS, "plots of energy, stretch, contacts and time"),
    PANEL(GLFW_KEY_F4, "F4", VIEWER_PANEL_LOG, "the log"),
    PANEL(GLFW_KEY_F6, "F6", VIEWER_PANEL_LESSON,
          "a constraint, looked into: its value, its derivatives, its formula step by step"),
    {.code = GLFW_KEY_F7, .name = "F7", .when = ALWAYS, .act = change_theme, .help = "the light theme, and the dark one"},
    PANEL(GLFW_KEY_TAB, "Tab", VIEWER_PANEL_SIDE, "the panel at the side"),
    {.code = GLFW_KEY_ENTER,
     .name = "Enter",
     .when = BY_KEY,
     .act = solve,
     .repeats = true,
     .help = "in a scene that advances by keys: one solve (as any key without another meaning)"},
    {.code = GLFW_KEY_B,
     .name = "B",
     .when = WITH_FIELD,
     .act = ride,
     .field = "alignment",
     .help = "in a flock: rides on the bird that was clicked, or the one in the middle, and ends it"},
    FIELD(GLFW_KEY_UP, "Up Down", "separation", 1, "in a flock: more and less separation"),
    FIELD(GLFW_KEY_DOWN, NULL, "separation", -1, NULL),
    FIELD(GLFW_KEY_RIGHT, "Right Left", "alignment", 1, "in a flock: more and less alignment"),
    FIELD(GLFW_KEY_LEFT, NULL, "alignment", -1, NULL),
    FIELD(GLFW_KEY_HOME, "Home End", "cohesion", 1, "in a flock: more and less cohesion"),
    FIELD(GLFW_KEY_END, NULL, "cohesion", -1, NULL),
};
enum { KEY_COUNT = sizeof keys / sizeof *keys };

/* ---- The handler ---- */

static bool some_rule_has(const viewer_stage *stage, const char *field) {
    const skein_world *world = stage->side_count ? stage->sides[0].world : NULL;
    for (size_t i = 0; world && i < skein_object_count(world, SKEIN_FORCE); i++) {
        const skein_kind *kind = skein_object_kind(world, skein_object_at(world, SKEIN_FORCE, i));
        if (skein_field_find(kind, field, NULL)) return true;
    }
    return false;
}

static bool applies(const viewer_stage *stage, const viewer_key *key) {
    switch (key->when) {
    case ALWAYS: return true;
    case WITH_SCENE: return stage->side_count > 0;
    case BY_KEY: return viewer_stage_by_key(stage);
    case WITH_TOOL: return stage->side_count && stage->handles.tool != VIEWER_NO_TOOL;
    case WITH_FIELD: return some_rule_has(stage, key->field);
    }
    return false;
}

bool viewer_key_down(viewer_stage *stage, int code, int mods) {
    const int command = GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER;
    for (int k = 0; k < KEY_COUNT; k++) {
        const viewer_key *key = &keys[k];
        if (key->code != code || !applies(stage, key)) continue;
        // Shift makes a difference only where Control does, too: X saves with both
        int asked = mods & command ? mods & (command | GLFW_MOD_SHIFT) : 0;
        if (asked != key->mods) continue;
        key->act(stage, key);
        return true;
    }
    if (mods & command) return false;
    // modifiers alone are no key
    bool by_key = viewer_stage_by_key(stage) && code < GLFW_KEY_LEFT_SHIFT && code != GLFW_KEY_ESCAPE;
    if (by_key) viewer_stage_solve(stage);
    return by_key;
}

void viewer_key_up(viewer_stage *stage, int code) {
    for (int k = 0; k < KEY_COUNT; k++)
        if (keys[k].act == move && keys[k].code == code) stage->camera.down[keys[k].number] = false;
}

const char *viewer_key_help(size_t index, const char **name) {
    for (int k = 0; k < KEY_COUNT; k++) {
        if (!keys[k].name || index--) continue;
        *name = keys[k].name;
        return keys[k].help;
    }
    return NULL;
}

bool viewer_key_line(size_t index, char *line, size_t size) {
    const char *name, *help = viewer_key_help(index, &name);
    if (help) snprintf(line, size, "%-12s %s", name, help);
    return help != NULL;
}
