/* Feeds any mesh to the builders of bodies, and the world they stand in to any method.
 *
 *   mesh [\0 choices]      an OBJ or OFF; bytes that choose, 0 where there are no more: the body's kind (cloth first),
 *                          the method, a force and a collider, settings of each, and what happens between steps
 *
 * Kinds, fields and their ranges are the catalogue's: a new kind is chosen, too. Owns nothing. Called as fuzz/fuzz.h
 * says. Invariant: every call returns, with a status; one that fails has words; and all memory comes back. */
#include <math.h>

#include "fuzz/fuzz.h"
#include "io/mesh.h"

enum { MOST_SETTINGS = 6, MOST_DEEDS = 8, MOST_WORK = 10000 };

typedef struct chooser {
    const uint8_t *at, *end;
} chooser;

static size_t choose(chooser *c, size_t count) {
    return c->at < c->end && count ? *c->at++ % count : 0;
}

static void ignore(void *user, const char *line) {
    (void)user;
    require(line[0] != '\0');
}

static void judge(const skein_world *world, skein_status status) {
    const skein_error *error = skein_world_error(world);
    require(status == SKEIN_OK || (error->status == status && error->message[0]));
}

/* ---- Values: the ends of a field's range, and what is odd ----------------------------------------- */

static double choose_number(chooser *c, const skein_field *field, double initial) {
    static const double odd[] = {0, 1, -1, 0.5, 2, 3, 30, 1e-9, 1e-3, 1e3, 1e9, -1e9, 1e15, INFINITY, NAN};
    size_t place = choose(c, 3 + sizeof odd / sizeof *odd);
    return place == 0 ? initial : place == 1 ? field->least : place == 2 ? field->most : odd[place - 3];
}

static skein_value choose_value(chooser *c, const skein_field *field) {
    static const char *const texts[] = {"corners", "top edge",       "0",  "0 1",        "box -9 0 -9 9 9 9",
                                        "",        "sphere 0 0 0 1", "x1", "d(x1) - 0.5"};
    static const int counts[] = {[SKEIN_FIELD_BOOL] = 1, [SKEIN_FIELD_INT] = 1,    [SKEIN_FIELD_INT2] = 2,
                                 [SKEIN_FIELD_INT3] = 3, [SKEIN_FIELD_REAL] = 1,   [SKEIN_FIELD_REAL2] = 2,
                                 [SKEIN_FIELD_VEC3] = 3, [SKEIN_FIELD_CHOICE] = 1, [SKEIN_FIELD_TEXT] = 0};
    skein_value value = {.count = counts[field->type]};
    if (field->type == SKEIN_FIELD_TEXT) value.text = texts[choose(c, sizeof texts / sizeof *texts)];
    for (int i = 0; i < value.count; i++)
        value.number[i] =
            field->type == SKEIN_FIELD_CHOICE ? (double)choose(c, 4) : choose_number(c, field, field->initial[i]);
    return value;
}

static const skein_field *choose_field(chooser *c, const skein_kind *kind) {
    return kind->field_count ? &kind->fields[choose(c, kind->field_count)] : NULL;
}

static void choose_settings(chooser *c, const skein_kind *kind, skein_setting settings[MOST_SETTINGS + 1]) {
    size_t count = choose(c, MOST_SETTINGS + 1), used = 0;
    for (size_t i = 0; i < count; i++) {
        const skein_field *field = choose_field(c, kind);
        if (field) settings[used++] = (skein_setting){field->name, choose_value(c, field)};
    }
    settings[used].name = NULL;
}

/* Counted from the end where `last`: the methods that people use are listed last. */
static const skein_kind *choose_kind(chooser *c, skein_category category, bool last) {
    size_t count = 0;
    while (skein_kind_at(category, count)) count++;
    size_t place = choose(c, count);
    return skein_kind_at(category, last ? count - 1 - place : place);
}

/* ---- A world, and what happens to it -------------------------------------------------------------- */

static void build(skein_world *world, const skein_mesh *mesh, chooser *c) {
    skein_setting settings[MOST_SETTINGS + 1];
    const skein_kind *kind = choose_kind(c, SKEIN_BODY, false);
    choose_settings(c, kind, settings);
    judge(world, skein_body_add(world, kind->name, mesh, settings, NULL));
    kind = choose_kind(c, SKEIN_METHOD, true);
    choose_settings(c, kind, settings);
    judge(world, skein_method_set(world, kind->name, settings));
    kind = choose_kind(c, SKEIN_FORCE, false);
    choose_settings(c, kind, settings);
    judge(world, skein_force_add(world, kind->name, settings, NULL));
    kind = choose_kind(c, SKEIN_COLLIDER, false);
    choose_settings(c, kind, settings);
    judge(world, skein_collider_add(world, kind->name, settings, NULL));
}

static void change_something(skein_world *world, chooser *c) {
    static const skein_category categories[] = {SKEIN_BODY, SKEIN_FORCE, SKEIN_COLLIDER, SKEIN_METHOD};
    skein_category category = categories[choose(c, 4)];
    if (!skein_object_count(world, category)) return;
    skein_handle handle = skein_object_at(world, category, 0);
    const skein_field *field = choose_field(c, skein_object_kind(world, handle));
    if (field) judge(world, skein_set(world, handle, field->name, choose_value(c, field)));
}

static void look(skein_world *world) {
    size_t count;
    skein_statistics statistics;
    judge(world, skein_world_statistics(world, &statistics));
    judge(world, skein_springs_copy(world, NULL, 0, &count));
    judge(world, skein_contacts_copy(world, NULL, 0, &count));
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++)
        judge(world, skein_body_elements(world, skein_object_at(world, SKEIN_BODY, i), SKEIN_HINGES, NULL, 0, &count));
    judge(world, skein_world_explain(world, 0.01, ignore, NULL));
}

static void live(skein_world *world, chooser *c) {
    static const double steps[] = {1.0 / 60, 1e-3, 0.1, 1e-9, 10};
    for (int i = 0; i < MOST_DEEDS && (i < 3 || c->at < c->end); i++) {
        switch (choose(c, 4)) {
        case 1: change_something(world, c); break;
        case 2: judge(world, skein_world_reset(world)); break;
        case 3: look(world); break;
        default: break;
        }
        if (fuzz_is_cheap(world, MOST_WORK)) judge(world, skein_world_step(world, steps[choose(c, 5)]));
    }
    look(world);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    size_t length, used = 0;
    char *text = fuzz_take_part(&data, &size, &length);
    chooser c = {data, data ? data + size : NULL};
    io_mesh mesh = {0};
    skein_error error;
    if (io_obj_read(text, length, "input", &mesh, (io_warnings){ignore, NULL}, &error) &&
        io_off_read(text, length, "input", &mesh, (io_warnings){ignore, NULL}, &error)) {
        free(text);
        return 0; // fuzz_mesh looks at these
    }
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = fuzz_allocate;
    desc.release = fuzz_release;
    desc.memory_user = &used;
    skein_world *world = skein_world_create(&desc, NULL);
    require(world != NULL);
    skein_mesh view = io_mesh_view(&mesh);
    build(world, &view, &c);
    live(world, &c);
    skein_world_destroy(world);
    require(used == 0);
    io_mesh_free(&mesh);
    free(text);
    return 0;
}
