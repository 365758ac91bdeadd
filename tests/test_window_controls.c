/* Each control of each kind is dragged, chosen, ticked or typed into with a pointer and keys, and the value is looked for
 * in the world, in the scene that the window saves, and in the state that this leads to; then all of it is undone.
 * With the argument "all" that is each control of each kind, for many minutes; else of bodies, rules, methods, the view and
 * the scene one control of each type, of those that act at once and of those that build the scene anew.
 *
 * Nothing here knows a kind: fields and their types come from the catalogue. What a scene needs so that a kind can be in
 * it, and the texts that its fields take, are in tables. */
#define SCREEN_SIZE "420x2600"
#include "window.h"

#include "io/scene.h"
#include "render/view.h"

/* ---- Scenes, one of each kind ---------------------------------------------------------------------- */

/* More members of an object of that kind; ' stands for ". */
static const struct {
    const char *kind, *members;
} needs[] = {
    {"cloth", ", 'grid': [4, 4]"},
    {"lattice", ", 'grid': [2, 2, 2]"},
    {"tetrahedra", ", 'mesh': '" SKEIN_SOURCE_DIR "/meshes/ball.node'"},
    {"mesh", ", 'mesh': '" SKEIN_SOURCE_DIR "/meshes/ball.obj'"},
    {"field", ", 'mesh': '" SKEIN_SOURCE_DIR "/meshes/ball.obj', 'cell': 0.05"},
    {"flock", ", 'count': 8"},
    {"distance", ", 'particles': [[0, 1]]"},
    {"dihedral", ", 'particles': [[0, 3, 1, 2]]"},
    {"isometric", ", 'particles': [[0, 3, 1, 2]]"},
    {"straight", ", 'particles': [[0, 1, 2]]"},
    {"twist", ", 'particles': [[0, 1, 3, 2]]"},
    {"area", ", 'particles': [[0, 1, 2]]"},
    {"attachment", ", 'particles': [[4, 0, 1, 2]]"},
    {"volume", ", 'particles': [[0, 1, 2, 4]]"},
    {"angle", ", 'particles': [[0, 1, 2]]"},
    {"enclosed_volume", ", 'particles': [[0, 2, 1], [0, 1, 4], [1, 2, 4], [0, 4, 2]]"},
    {"pressure", ", 'particles': [[0, 2, 1], [0, 1, 4], [1, 2, 4], [0, 4, 2]]"},
    {"energy", ", 'particles': [[0, 1]], 'energy': 'k * (length(p0 - p1) - 1)^2', 'parameters': { 'k': 2 }"},
    {"force_field", ", 'force': 'vec3(k, 0, 0)', 'parameters': { 'k': 2 }"},
    {"potential", ", 'energy': 'k * p.y', 'parameters': { 'k': 2 }"},
    {"cache", ", 'on': 'b', 'file': 'led.pc2'"},
};
static const char constraint_formula[] =
    ", 'particles': [[0, 1]], 'constraint': 'length(p0 - p1) - L', 'parameters': { 'L': 1 }";
static const char surface_formula[] = ", 'surface': 'p.y + R', 'parameters': { 'R': 1 }";

static const char *needs_of(const skein_kind *kind) {
    if (!strcmp(kind->name, "formula")) return kind->category == SKEIN_COLLIDER ? surface_formula : constraint_formula;
    for (size_t i = 0; i < COUNT(needs); i++)
        if (!strcmp(needs[i].kind, kind->name)) return needs[i].members;
    return "";
}

/* Texts that fields take; the first row that fits counts. A kind or category of NULL: any. */
static const struct {
    const char *kind, *field, *text;
} texts[] = {
    {NULL, "name", "c d"},
    {NULL, "on", "b"},
    {NULL, "groups", "soft, loose"},
    {NULL, "neighbours", "b"},
    {NULL, "pins", "0"},
    {"cloth", "mesh", SKEIN_SOURCE_DIR "/meshes/ball.obj"},
    {"tetrahedra", "mesh", SKEIN_SOURCE_DIR "/tests/../meshes/ball.node"},
    {"mesh", "mesh", SKEIN_SOURCE_DIR "/tests/../meshes/ball.obj"},
    {"field", "mesh", SKEIN_SOURCE_DIR "/tests/../meshes/ball.obj"},
    {"formula", "constraint", "length(p0 - p1) - 2 * L"},
    {"formula", "surface", "p.y + 2 * R"},
    {"energy", "energy", "2 * k * (length(p0 - p1) - 1)^2"},
    {"potential", "energy", "2 * k * p.y"},
    {"force_field", "force", "vec3(0, k, 0)"},
    {"flocking", NULL, "relative_distance"},
    {"keys", "keys", "0 0 0 0, 1 0.5 0 0"},
    {"cache", "file", "./led.pc2"},
    {"attach", "to", "floor"},
    {NULL, "colliders", "floor"},
    {NULL, "map", "0.5"}, // of the one that "pins" leaves
    {NULL, "jump_times", "0.5"},
    {"scene", "description", "what it shows"},
    {"view", "image", "picture.png"},
    {"view", "camera.follow", "b"},
};

/* What is refused in these scenes, and the words for it: they are to say what to do. */
static const struct {
    const char *kind, *field, *words;
} refusals[] = {
    {"cloth", "mesh", "a cloth has a grid or a mesh, not both"},
    {"attach", "colliders", "is no moving frame"},
    {"attach", "inertia", "is no moving frame"},
    {"attach", "jump", "is no moving frame"},
    {"attach", "jump_turn", "is no moving frame"},
    {"attach", "jump_times", "is no moving frame"},
};

static const char *refusal_of(const skein_kind *kind, const skein_field *field) {
    for (size_t i = 0; i < COUNT(refusals); i++)
        if (!strcmp(refusals[i].kind, kind->name) && !strcmp(refusals[i].field, field->name)) return refusals[i].words;
    return NULL;
}

static const char *text_for(const skein_kind *kind, const skein_field *field) {
    for (size_t i = 0; i < COUNT(texts); i++)
        if ((!texts[i].kind || !strcmp(texts[i].kind, kind->name)) &&
            (!texts[i].field || !strcmp(texts[i].field, field->name)))
            return texts[i].text;
    return NULL;
}

/* A lattice "b" of eight particles, two of them held, that such an object acts on; or the object alone, if it is a body. */
static void write_scene_with(const skein_kind *kind, const char *path) {
    static const char *const lists[] = {"bodies", "constraints", "forces", "colliders", "motions"};
    char text[2048], object[600], floor[300] = "",
                                  base[] = "{ 'type': 'lattice', 'name': 'b', 'grid': [2, 2, 2], 'pins': '0 1' }";
    snprintf(object, sizeof object, "{ 'type': '%s'%s }", kind->name, needs_of(kind));
    if (kind->category == SKEIN_MOTION)
        snprintf(floor, sizeof floor,
                 "'colliders': [ { 'type': 'mesh', 'name': 'floor', 'mesh': '%s/meshes/ball.obj' } ], ",
                 SKEIN_SOURCE_DIR);
    const char *method = kind->category == SKEIN_METHOD ? kind->name : "xpbd";
    if (kind->category == SKEIN_BODY)
        snprintf(text, sizeof text, "{ 'name': '%s', 'method': { 'type': 'xpbd' }, 'bodies': [ %s ] }", kind->name,
                 object);
    else if (kind->category < SKEIN_METHOD)
        snprintf(text, sizeof text, "{ 'name': '%s', 'method': { 'type': 'xpbd' }, %s'bodies': [ %s ], '%s': [ %s ] }",
                 kind->name, floor, base, lists[kind->category], object);
    else
        snprintf(text, sizeof text, "{ 'name': '%s', 'method': { 'type': '%s' }, 'bodies': [ %s ] }", kind->name,
                 method, base);
    write_scene(path, text);
}

/* ---- The saved scene, read here ---------------------------------------------------------------------- */

static void tell_fault(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

typedef struct opened {
    io_scene *scene;
    skein_world *world;
} opened;

static opened open_here(const char *path) {
    const skein_kind *const kinds[] = {render_view_kind(), NULL};
    io_faults faults = {tell_fault, NULL, 0, NULL};
    opened o = {io_scene_read(path, NULL, kinds, &faults), NULL};
    assert_non_null(o.scene);
    o.world = io_scene_build(o.scene, NULL, &faults);
    assert_non_null(o.world);
    return o;
}

static void close_here(opened *o) {
    skein_world_destroy(o->world);
    io_scene_free(o->scene);
}

/* The value in the plain struct of the view or the scene. */
static skein_value plain_value(const skein_field *field, const void *params) {
    const char *at = (const char *)params + field->offset;
    skein_value value = {1, {0, 0, 0}, NULL};
    switch (field->type) {
    case SKEIN_FIELD_BOOL: value.number[0] = *(const bool *)at; break;
    case SKEIN_FIELD_INT:
    case SKEIN_FIELD_CHOICE: value.number[0] = *(const int32_t *)(const void *)at; break;
    case SKEIN_FIELD_REAL: value.number[0] = *(const double *)(const void *)at; break;
    case SKEIN_FIELD_VEC3: value.count = 3, memcpy(value.number, at, 3 * sizeof(double)); break;
    case SKEIN_FIELD_TEXT: value.count = 0, value.text = *(char *const *)(const void *)at; break;
    default: fail_msg("%s: a type that no view or scene had", field->name);
    }
    return value;
}

static void value_here(const opened *o, const skein_kind *kind, const skein_field *field, char text[600]) {
    skein_value value;
    if (kind->category == SKEIN_VIEW) {
        const render_view *view = io_scene_view(o->scene), none = render_view_default();
        value = plain_value(field, view ? view : &none);
    } else if (kind->category == SKEIN_SCENE) value = plain_value(field, io_scene_get(o->scene));
    else
        assert_int_equal(skein_get(o->world, skein_object_at(o->world, kind->category, 0), field->name, &value),
                         SKEIN_OK);
    skein_value_text(field, &value, text, 600);
}

/* ---- Choices ------------------------------------------------------------------------------------------- */

/* The word of a choice to take: not the one that there is. */
static void word_besides(const skein_field *field, const char *now, char word[100]) {
    for (const char *at = field->choices; *at;) {
        size_t length = strcspn(at, "|");
        snprintf(word, 100, "%.*s", (int)length, at);
        if (strcmp(word, now) != 0) return;
        at += length + (at[length] == '|');
    }
}

/* ---- One control ------------------------------------------------------------------------------------------ */

typedef struct control {
    const skein_kind *kind;
    const skein_field *field;
    char name[200], said[200]; /* "body.0.size", "set body 0 size=" */
    char value[600];           /* as it was, then as it is */
    bool told;                 /* the window said so */
} control;

static int number_count(const skein_field *field) {
    switch (field->type) {
    case SKEIN_FIELD_INT2:
    case SKEIN_FIELD_REAL2: return 2;
    case SKEIN_FIELD_INT3:
    case SKEIN_FIELD_VEC3: return 3;
    default: return 1;
    }
}

static bool is_whole(const skein_field *field) {
    return field->type == SKEIN_FIELD_INT || field->type == SKEIN_FIELD_INT2 || field->type == SKEIN_FIELD_INT3;
}

/* Does to the control what a user would; `turn` numbers the tries, each slower and elsewhere. */
static void handle(const control *c, const double box[4], int component, int turn) {
    static const double paces[] = {0.05, 0.1, 0.3, 0.6}, shares[] = {0.7, 0.4, 0.2, 0.6};
    double slowly = paces[turn], chosen[4];
    char word[100], row[320];
    long from = 0;
    struct stat info;
    switch (c->field->type) {
    case SKEIN_FIELD_BOOL:
        if (take(c->name, box[0] + 8, box[1] + 0.5 * box[3])) let_go(slowly);
        break;
    case SKEIN_FIELD_TEXT: type_into(c->name, box, text_for(c->kind, c->field), slowly); break;
    case SKEIN_FIELD_CHOICE:
        word_besides(c->field, c->value, word);
        snprintf(row, sizeof row, "%s=%s", c->name, word);
        if (!stat(screen.events, &info)) from = (long)info.st_size;
        press(box[0] + 0.3 * box[2], box[1] + 0.5 * box[3], slowly);
        // where the row was seen before, it is not told again
        if (find_box(row, from, chosen, 1) || find_box(row, 0, chosen, 1))
            press(chosen[0] + 0.3 * chosen[2], chosen[1] + 0.5 * chosen[3], slowly);
        break;
    default:
        drag_number(c->name, box, component, number_count(c->field),
                    is_whole(c->field) ? 0.12 + 0.06 * turn : shares[turn], slowly);
    }
}

/* Whether one number of a list has changed. */
static bool differs(const char *before, const char *after, int component) {
    char *end;
    for (int i = 0; i < component; i++) strtod(before, &end), before = end, strtod(after, &end), after = end;
    return strtod(before, NULL) != strtod(after, NULL);
}

/* Changes one control (of a vector, one number) until the window says that the world has another value. */
static void print_last_events(void) {
    char *all = read_text(screen.events);
    size_t length = strlen(all);
    fprintf(stderr, "the last events:\n%s\n", all + (length > 900 ? length - 900 : 0));
    free(all);
}

static bool change(control *c, int component) {
    double box[4];
    bool number = c->field->type != SKEIN_FIELD_BOOL && c->field->type != SKEIN_FIELD_TEXT &&
                  c->field->type != SKEIN_FIELD_CHOICE;
    for (int turn = 0; turn < 4; turn++) {
        // what is in view before a rebuild may be elsewhere after it
        if (!find_box(c->name, 0, box, turn ? 5 : 20)) {
            fprintf(stderr, "%s %s: there is no control\n", c->kind->name, c->name);
            return false;
        }
        listen_from_here();
        handle(c, box, component, turn);
        if (refusal_of(c->kind, c->field)) {
            if (!hear("warning ", turn ? 5 : 1.5)) continue;
            return strstr(screen.line, refusal_of(c->kind, c->field)) != NULL;
        }
        if (!hear(c->said, turn ? 5 : 1.5)) continue;
        const char *value = screen.line + strlen(c->said);
        bool good = number ? differs(c->value, value, component) : strcmp(c->value, value) != 0;
        snprintf(c->value, sizeof c->value, "%s", value);
        if (good) return true;
    }
    print_last_events();
    fprintf(stderr, "%s %s: number %d does not change what is %s\n", c->kind->name, c->name, component, c->value);
    return false;
}

/* ---- One kind ----------------------------------------------------------------------------------------------- */

/* What cannot be changed in a window, and why. */
static bool is_left_out(const skein_kind *kind, const skein_field *field) {
    // its file has as many points as the one body that it can be on
    if (!strcmp(kind->name, "cache") && !strcmp(field->name, "on")) return true;
    bool one_value = field->type == SKEIN_FIELD_INT && field->least == field->most; // the format's version
    // a formula's parameters have fields of their own
    return one_value || !strcmp(field->name, "parameters.*");
}

enum { MOST_CONTROLS = 64, FRAMES = 2 };

/* Right after Enter a text box has the keys for one more picture: waits until they are the window's. */
static void await_keys(void) {
    for (int turn = 0; turn < 20; turn++) {
        listen_from_here();
        tool("key Shift_L");
        if (hear("key 340 ", 1)) return;
    }
}

/* Some frames after the start. */
static void ask_hash(char hash[32]) {
    await_keys();
    press_key("BackSpace");
    for (int i = 0; i < FRAMES; i++) press_key("period");
    const char *at = strstr(screen.line, " hash=");
    assert_non_null(at);
    snprintf(hash, 32, "%.16s", at + 6);
    press_key("BackSpace");
}

/* The same here. */
static void find_hash(const opened *o, char hash[32]) {
    double dt;
    int steps = FRAMES * io_scene_steps_per_frame(io_scene_get(o->scene), &dt);
    for (int i = 0; i < steps && !skein_world_step(o->world, dt); i++) {}
    snprintf(hash, 32, "%016llx", (unsigned long long)skein_world_hash(o->world));
}

/* The fields of the object as its world has them: its own, then the common ones. */
static size_t list_controls(const opened *o, const skein_kind *kind, control *controls) {
    size_t own_count = kind->field_count, common_count = 0, count = 0;
    const skein_field *own = kind->fields, *common = NULL;
    if (kind->category < SKEIN_METHOD) {
        const skein_kind *k = skein_object_kind(o->world, skein_object_at(o->world, kind->category, 0));
        own = k->fields, own_count = k->field_count;
        common = skein_common_fields(kind->category, &common_count);
    }
    for (size_t f = 0; f < own_count + common_count; f++) {
        const skein_field *field = f < own_count ? &own[f] : &common[f - own_count];
        if (is_left_out(kind, field)) continue;
        assert_true(count < MOST_CONTROLS);
        control *c = &controls[count++];
        *c = (control){.kind = kind, .field = field};
        snprintf(c->name, sizeof c->name, "%s.0.%s", skein_category_text(kind->category), field->name);
        snprintf(c->said, sizeof c->said, "set %s 0 %s=", skein_category_text(kind->category), field->name);
        value_here(o, kind, field, c->value);
    }
    return count;
}

/* The fields that do not open to what the window said. */
static int compare_saved(const char *path, const skein_kind *kind, const control *controls, size_t count,
                         const char *hash) {
    char value[600], here[32];
    int faults = 0;
    opened o = open_here(path);
    for (size_t i = 0; i < count; i++) {
        value_here(&o, kind, controls[i].field, value);
        const char *end = value;
        // paths become absolute
        if (controls[i].field->type == SKEIN_FIELD_TEXT && strchr(value, '/')) end = strrchr(value, '/') + 1;
        const char *told =
            strrchr(controls[i].value, '/') && end != value ? strrchr(controls[i].value, '/') + 1 : controls[i].value;
        // what nobody set goes with the fabric that was chosen
        bool goes_along = !controls[i].told && skein_field_find(kind, "fabric", NULL);
        if (!strcmp(end, told) || goes_along) continue;
        fprintf(stderr, "%s %s: the window has %s, the file that it saved %s\n", kind->name, controls[i].name, told,
                value);
        faults++;
    }
    find_hash(&o, here);
    if (strcmp(here, hash) != 0) fprintf(stderr, "%s: saved, it opens to another state\n", kind->name), faults++;
    close_here(&o);
    return faults;
}

/* What the window said last of each control, since a place in its events. */
static void take_last_values(control *controls, size_t count, long from) {
    char *all = read_text(screen.events);
    for (char *line = all + from, *next; line && *line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        for (size_t i = 0; i < count; i++)
            if (!strncmp(line, controls[i].said, strlen(controls[i].said))) {
                snprintf(controls[i].value, sizeof controls[i].value, "%s", line + strlen(controls[i].said));
                controls[i].told = true;
            }
    }
    free(all);
}

static bool all_of_them;

/* Whether a control like it was not yet tried; then it is to be. */
static bool is_new(const opened *o, const control *c) {
    static bool tried[SKEIN_CATEGORY_COUNT][SKEIN_FIELD_TEXT + 1][3];
    skein_category category = c->kind->category;
    bool live = category <= SKEIN_METHOD &&
                skein_field_is_live(o->world, skein_object_at(o->world, category, 0), c->field->name);
    int how = !strncmp(c->field->name, "parameters.", 11) ? 2 : live;
    if (category > SKEIN_BODY && category < SKEIN_METHOD) category = SKEIN_FORCE; // rules are alike
    bool *seen = &tried[category][c->field->type][how];
    bool new = !*seen;
    *seen = true;
    return all_of_them || new;
}

/* Drops a scene of that kind on the window, changes all, saves, and takes all back. Returns the number of faults. */
static int try_kind(const skein_kind *kind) {
    static int number;
    char path[64], first[32], last[32], again[32], *saved;
    control controls[MOST_CONTROLS];
    int faults = 0;
    snprintf(path, sizeof path, "scene%d.json", number++);
    write_scene_with(kind, in_folder(path));
    opened o = open_here(in_folder(path));
    size_t count = list_controls(&o, kind, controls), tries = 0;
    bool wanted[MOST_CONTROLS];
    for (size_t i = 0; i < count; i++) tries += wanted[i] = is_new(&o, &controls[i]);
    if (!tries) {
        close_here(&o);
        return 0;
    }
    listen_from_here();
    drop_file(in_folder(path));
    expect("opened ");
    long from = screen.seen;
    ask_hash(first);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; wanted[i] && k < number_count(controls[i].field); k++) faults += !change(&controls[i], k);
    hand("mousemove 100 2590");
    await_hands();
    ask_hash(last);
    listen_from_here();
    hand("key ctrl+s");
    expect("note saved ");
    saved = strdup(screen.line + strlen("note saved "));
    saved[strcspn(saved, ":")] = 0;
    take_last_values(controls, count, from);
    faults += compare_saved(in_folder(saved), kind, controls, count, last);
    free(saved);
    for (size_t i = 0; i < 3 * count && !strstr(screen.line, "nothing to undo"); i++) {
        listen_from_here();
        hand("key ctrl+z");
        expect("note ");
        expect("key 90 ");
    }
    ask_hash(again);
    if (strcmp(first, again) != 0) fprintf(stderr, "%s: undone, it is not as it was\n", kind->name), faults++;
    close_here(&o);
    return faults;
}

/* ---- All of them ------------------------------------------------------------------------------------------- */

static void search_for(const char *words) {
    double box[4];
    char said[100];
    snprintf(said, sizeof said, "searched %s", words);
    for (int turn = 0; turn < 4; turn++) {
        assert_true(find_box("search", 0, box, patience_seconds));
        listen_from_here();
        type_into("search", box, words, 0.05 + 0.1 * turn);
        if (hear("searched ", 2) && !strcmp(screen.line, said)) return;
    }
    fail_msg("nobody searches for %s", words);
}

static void try_category(skein_category category) {
    const skein_kind *kind;
    char words[64];
    int faults = 0;
    const char *const only = getenv("SKEIN_TEST_KIND"); // to look at one alone
    snprintf(words, sizeof words, "%s 0:", skein_category_text(category));
    search_for(words);
    for (size_t k = 0; (kind = skein_kind_at(category, k)) != NULL; k++)
        if (!only || !strcmp(only, kind->name)) faults += try_kind(kind);
    assert_int_equal(faults, 0);
}

static void controls_of_bodies(void **state) {
    (void)state;
    try_category(SKEIN_BODY);
}

static void controls_of_constraints(void **state) {
    (void)state;
    try_category(SKEIN_CONSTRAINT);
}

static void controls_of_forces(void **state) {
    (void)state;
    try_category(SKEIN_FORCE);
}

static void controls_of_colliders(void **state) {
    (void)state;
    try_category(SKEIN_COLLIDER);
}

static void controls_of_motions(void **state) {
    (void)state;
    try_category(SKEIN_MOTION);
}

static void controls_of_methods(void **state) {
    (void)state;
    try_category(SKEIN_METHOD);
}

static void controls_of_the_view(void **state) {
    (void)state;
    search_for("view 0:");
    assert_int_equal(try_kind(render_view_kind()), 0);
}

static void controls_of_the_scene(void **state) {
    (void)state;
    search_for("scene 0:");
    assert_int_equal(try_kind(io_scene_kind()), 0);
}

/* Places for the motion that reads some, and a picture for the view. */
static void write_files(void) {
    const char *const cache[] = {"run", "--frames", "2", "--out", in_folder("led"), in_folder("led.json"), NULL};
    render_image image = {0};
    write_scene(in_folder("led.json"), "{ 'name': 'led', 'bodies': [ { 'type': 'lattice', 'grid': [2, 2, 2] } ],"
                                       "  'output': ['pc2'] }");
    outcome o = finish_skein(start_skein((surroundings){0}, cache));
    assert_status(o, 0);
    outcome_free(&o);
    assert_int_equal(rename(in_folder("led/lattice.pc2"), in_folder("led.pc2")), 0);
    assert_int_equal(render_image_resize(&image, 4, 4, NULL), SKEIN_OK);
    memset(image.pixels, 90, 48);
    assert_int_equal(render_image_write_png(&image, in_folder("picture.png"), NULL), SKEIN_OK);
    render_image_release(&image);
}

static int begin(void **state) {
    if (make_folder(state)) return -1;
    open_screen();
    write_files();
    write_scene_with(skein_kind_at(SKEIN_BODY, 0), in_folder("first.json"));
    const char *const arguments[] = {
        in_folder("first.json"),    "--size", "400x2600", "--scale", "1", "--samples", "1", "--paused", "--allow-path",
        SKEIN_SOURCE_DIR "/meshes", NULL};
    open_window(arguments);
    screen.seen = 0; // so small a scene may be there before the window
    expect("opened ");
    return 0;
}

static int end(void **state) {
    drop_hands();

    end_process(&screen.skein, SIGKILL);
    end_process(&screen.xvfb, SIGTERM);
    return remove_folder(state);
}

int main(int argc, char **argv) {
    all_of_them = argc > 1 && !strcmp(argv[1], "all");
    const struct CMUnitTest sitting[] = {
        cmocka_unit_test(controls_of_bodies),   cmocka_unit_test(controls_of_constraints),
        cmocka_unit_test(controls_of_forces),   cmocka_unit_test(controls_of_colliders),
        cmocka_unit_test(controls_of_motions),  cmocka_unit_test(controls_of_methods),
        cmocka_unit_test(controls_of_the_view), cmocka_unit_test(controls_of_the_scene),
    };
    if (!can_open_screen()) return 0;
    return cmocka_run_group_tests(sitting, begin, end);
}
