/* One constraint, looked into; see lesson.h. */
#include "viewer/lesson.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/own_kinds.h"
#include "skein/formula.h"
#include "viewer/stage.h"

/* So many operations are shown at the most: a reader's formula has some tens. */
enum { MOST_OPERATIONS = 1000 };

/* ---- Which one ---- */

static bool is_open(const viewer_stage *stage) {
    return stage->side_count && stage->panel[VIEWER_PANEL_LESSON];
}

/* Finds the object that is asked for, or the last there is, among those that have constraints. */
static void find_object(viewer_lesson *lesson, skein_world *world) {
    static const skein_category categories[2] = {SKEIN_CONSTRAINT, SKEIN_BODY};
    size_t seen = 0;
    lesson->any = false;
    for (int c = 0; c < 2; c++)
        for (size_t i = 0; i < skein_object_count(world, categories[c]); i++) {
            skein_handle handle = skein_object_at(world, categories[c], i);
            size_t count = 0;
            if (skein_constraint_count(world, handle, &count) || !count) continue;
            if (seen++ > lesson->object) continue;
            lesson->any = true;
            lesson->handle = handle, lesson->count = count;
            lesson->category = categories[c], lesson->place = i;
        }
    lesson->object_count = seen;
    if (lesson->object >= seen) lesson->object = seen ? seen - 1 : 0;
    if (lesson->any && lesson->index >= lesson->count) lesson->index = lesson->count - 1;
}

static void forget_looks(viewer_lesson *lesson) {
    lesson->before.taken = lesson->after.taken = lesson->now.taken = false;
    lesson->fault[0] = 0;
}

void viewer_lesson_begin(viewer_stage *stage) {
    viewer_lesson *lesson = &stage->lesson;
    lesson->object = lesson->index = 0;
    forget_looks(lesson);
    // scenes that advance by keys are there to be looked into
    stage->panel[VIEWER_PANEL_LESSON] = stage->options->panels && viewer_stage_by_key(stage);
}

void viewer_lesson_choose(viewer_stage *stage, const viewer_request *request) {
    viewer_lesson *lesson = &stage->lesson;
    if (!stage->side_count) return;
    if (request->code) lesson->index = 0;
    if (request->code > 0) lesson->object++;
    else if (request->code < 0 && lesson->object > 0) lesson->object--;
    else if (!request->code) lesson->index = request->x > 0 ? (size_t)request->x : 0;
    forget_looks(lesson);
    viewer_lesson_refresh(stage);
    viewer_event(stage->events, "lesson %s %zu of %zu: %s", lesson->name, lesson->index, lesson->count, lesson->text);
    stage->dirty = true;
}

render_chosen viewer_lesson_chosen(const viewer_stage *stage) {
    const viewer_lesson *lesson = &stage->lesson;
    return (render_chosen){is_open(stage) && lesson->any, lesson->handle, lesson->index};
}

/* ---- Looking ---- */

static bool look(viewer_lesson *lesson, skein_world *world, viewer_look *out, skein_constraint_value *value) {
    *out = (viewer_look){.taken = false};
    if (!lesson->any || skein_constraint_evaluate(world, lesson->handle, lesson->index, value, lesson->particle,
                                                  &out->gradient[0][0], VIEWER_LESSON_PARTICLES))
        return false;
    lesson->many = value->particle_count > VIEWER_LESSON_PARTICLES;
    lesson->particle_count = lesson->many ? VIEWER_LESSON_PARTICLES : value->particle_count;
    for (size_t i = 0; i < lesson->particle_count; i++)
        skein_positions_copy(world, lesson->particle[i], 1, out->place[i]);
    out->taken = true;
    out->time = skein_world_time(world);
    out->value = value->value;
    return true;
}

void viewer_lesson_before(viewer_stage *stage) {
    skein_constraint_value value;
    skein_world *world = stage->sides[0].world;
    if (!is_open(stage)) return;
    find_object(&stage->lesson, world);
    look(&stage->lesson, world, &stage->lesson.before, &value);
}

void viewer_lesson_after(viewer_stage *stage) {
    skein_constraint_value value;
    if (is_open(stage)) look(&stage->lesson, stage->sides[0].world, &stage->lesson.after, &value);
}

/* The object's text that is the constraint's formula; NULL where it is its kind's own. */
static const skein_field *field_of(const viewer_lesson *lesson, const skein_world *world, const char *text) {
    const skein_kind *kind = skein_object_kind(world, lesson->handle);
    for (size_t f = 0; kind && lesson->category == SKEIN_CONSTRAINT && f < kind->field_count; f++) {
        skein_value value;
        const skein_field *field = &kind->fields[f];
        if (field->type != SKEIN_FIELD_TEXT || skein_get(world, lesson->handle, field->name, &value)) continue;
        // that of the table, which lasts
        const skein_kind *listed = io_kind_find(SKEIN_CONSTRAINT, kind->name, NULL);
        if (value.text && !strcmp(value.text, text)) return listed ? skein_field_find(listed, field->name, NULL) : NULL;
    }
    return NULL;
}

static void take_names(viewer_lesson *lesson, const skein_world *world, const skein_constraint_value *value) {
    skein_value name = {0, {0, 0, 0}, NULL};
    const skein_kind *kind = skein_object_kind(world, lesson->handle);
    bool named = !skein_get(world, lesson->handle, "name", &name) && name.text && name.text[0];
    snprintf(lesson->name, sizeof lesson->name, "%.95s", named ? name.text : kind ? kind->name : "");
    snprintf(lesson->label, sizeof lesson->label, "%.63s", value->label);
    snprintf(lesson->text, sizeof lesson->text, "%s", value->text);
    lesson->field = strlen(value->text) < sizeof lesson->text ? field_of(lesson, world, value->text) : NULL;
    lesson->is_energy = value->is_energy, lesson->one_sided = value->one_sided, lesson->guarded = value->guarded;
}

static void take_operations(viewer_lesson *lesson, skein_world *world) {
    size_t count = 0;
    lesson->operation_count = 0;
    if (lesson->many || skein_constraint_operations(world, lesson->handle, lesson->index, NULL, NULL, 0, &count))
        return;
    lesson->too_long = count > MOST_OPERATIONS;
    if (lesson->too_long) count = MOST_OPERATIONS;
    if (!count || !viewer_lesson_reserve(lesson, count, 3 * count * lesson->particle_count)) return;
    size_t all;
    if (!skein_constraint_operations(world, lesson->handle, lesson->index, lesson->operations, lesson->derivatives,
                                     count, &all))
        lesson->operation_count = count;
}

/* Over the middle of its particles, above the highest of them, as the camera sees them. */
static void find_place(viewer_stage *stage) {
    viewer_lesson *lesson = &stage->lesson;
    const render_camera *lens = &stage->camera.lens;
    double right[3], up[3], back[3], ball = stage->sides[0].view.particle_radius, sum = 0, top = 1;
    int left, width = viewer_side_width(stage, 0, &left);
    render_camera_axes(lens, right, up, back);
    double slope = tan(0.5 * lens->fov * 0.017453292519943295), aspect = (double)width / fmax(stage->height, 1);
    lesson->in_view = lesson->particle_count > 0;
    for (size_t i = 0; i < lesson->particle_count; i++) {
        double x = 0, y = 0, depth = 0;
        for (int k = 0; k < 3; k++) {
            double d = lesson->now.place[i][k] - lens->eye[k];
            x += d * right[k], y += d * up[k], depth -= d * back[k];
        }
        if (!(depth > lens->near)) lesson->in_view = false;
        if (!lesson->in_view) return;
        sum += 0.5 + 0.5 * x / (depth * slope * aspect);
        top = fmin(top, 0.5 - 0.5 * (y + 1.3 * ball) / (depth * slope));
    }
    lesson->x = sum / (double)lesson->particle_count;
    lesson->y = top - 0.02;
}

void viewer_lesson_refresh(viewer_stage *stage) {
    viewer_lesson *lesson = &stage->lesson;
    skein_constraint_value value;
    if (!is_open(stage)) return;
    skein_world *world = stage->sides[0].world;
    find_object(lesson, world);
    lesson->operation_count = 0;
    if (!look(lesson, world, &lesson->now, &value)) {
        lesson->any = false;
        return;
    }
    // a step that was gone back over is not the last any more
    if (lesson->after.taken && lesson->after.time != lesson->now.time)
        lesson->before.taken = lesson->after.taken = false;
    take_names(lesson, world, &value);
    take_operations(lesson, world);
    find_place(stage);
}

/* ---- Another text ---- */

/* Whether the world could make a formula of it: says where it is wrong. `same` tells whether the living constraint can
 * take it, or has to be made anew. */
static bool is_right(viewer_lesson *lesson, const skein_world *world, const char *text, bool *same) {
    const skein_formula *old = skein_formula_of(world, lesson->handle);
    const skein_kind *kind = skein_object_kind(world, lesson->handle);
    const char *names[SKEIN_FORMULA_MOST_PARAMETERS + 1] = {NULL};
    size_t count = 0;
    for (size_t f = 0; f < kind->field_count && count < SKEIN_FORMULA_MOST_PARAMETERS; f++)
        if (!strncmp(kind->fields[f].name, "parameters.", 11) && strcmp(kind->fields[f].name, "parameters.*") != 0)
            names[count++] = kind->fields[f].name + 11;
    skein_error error = {SKEIN_OK, "", ""};
    skein_formula_desc desc = {
        .text = text, .parameters = names, .comparison = !lesson->is_energy, .result = SKEIN_FORMULA_NUMBER};
    skein_formula *formula = skein_formula_create(&desc, NULL, &error);
    if (!formula) {
        snprintf(lesson->fault, sizeof lesson->fault, "%.60s: %.300s", error.where, error.message);
        return false;
    }
    skein_formula_info now = skein_formula_about(formula), before = skein_formula_about(old);
    *same = now.particles == before.particles && !now.rests && !before.rests;
    skein_formula_destroy(formula);
    return true;
}

/* The scene with the text, as it stands. */
static bool build_with(viewer_stage *stage, const char *text) {
    const viewer_lesson *lesson = &stage->lesson;
    skein_value value = skein_text(text);
    char *json = io_value_json(lesson->field, &value), *set = json ? malloc(strlen(json) + 100) : NULL;
    viewer_changes changes = {NULL, 0, 0, 0, 0};
    bool good = false;
    if (set) {
        sprintf(set, "constraints.%zu.%.60s=%s", lesson->place, lesson->field->name, json);
        good = viewer_changes_copy(&changes, &stage->sides[0].changes) &&
               viewer_changes_add(&changes, set, NULL, NULL) && viewer_stage_reopen(stage, &changes, true);
    }
    viewer_changes_free(&changes);
    free(json);
    free(set);
    return good;
}

void viewer_lesson_write(viewer_stage *stage, const char *text) {
    viewer_lesson *lesson = &stage->lesson;
    bool same = false;
    if (!is_open(stage)) return;
    viewer_lesson_refresh(stage);
    if (!lesson->any || !lesson->field || !strcmp(text, lesson->text)) return;
    lesson->fault[0] = 0;
    stage->dirty = true;
    if (!is_right(lesson, stage->sides[0].world, text, &same)) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s; the old one stays", lesson->fault);
        viewer_offer_look(stage, lesson->category, lesson->place, lesson->field, text);
        return;
    }
    if (same) {
        viewer_request request = {.kind = VIEWER_SET,
                                  .category = lesson->category,
                                  .index = lesson->place,
                                  .field = lesson->field,
                                  .value = skein_text(NULL)};
        snprintf(request.text, sizeof request.text, "%s", text);
        viewer_stage_set(stage, &request);
    } else if (!build_with(stage, text)) {
        snprintf(lesson->fault, sizeof lesson->fault, "the scene cannot be built with it: see the log");
        return;
    }
    forget_looks(lesson);
    viewer_offer_forget(stage);
    viewer_lesson_refresh(stage);
    if (!strcmp(lesson->text, text)) viewer_note(stage, "%.60s: %.160s", lesson->name, text);
    else snprintf(lesson->fault, sizeof lesson->fault, "it was not taken: see the log");
}

/* ---- Operations as text ---- */

static bool is_leaf(const skein_operation *operation) {
    return operation->operand_count == 0;
}

size_t viewer_operation_number(const viewer_lesson *lesson, size_t operation) {
    size_t number = 0;
    if (is_leaf(&lesson->operations[operation])) return 0;
    for (size_t i = 0; i <= operation; i++) number += !is_leaf(&lesson->operations[i]);
    return number;
}

size_t viewer_operation_last(const viewer_lesson *lesson) {
    size_t number = 0;
    for (size_t i = 0; i < lesson->operation_count; i++) number += !is_leaf(&lesson->operations[i]);
    return number;
}

size_t viewer_operation_at(const viewer_lesson *lesson, size_t number) {
    size_t i = 0;
    for (; i + 1 < lesson->operation_count; i++)
        if (!is_leaf(&lesson->operations[i]) && --number == 0) break;
    return i;
}

static void name_of(const viewer_lesson *lesson, size_t operation, char name[48]) {
    const skein_operation *o = &lesson->operations[operation];
    if (is_leaf(o)) snprintf(name, 48, "%s", o->label);
    else snprintf(name, 48, "x%zu", viewer_operation_number(lesson, operation));
}

void viewer_operation_text(const viewer_lesson *lesson, size_t operation, char *text, size_t size) {
    const skein_operation *o = &lesson->operations[operation];
    char a[4][48] = {"", "", "", ""}, name[48];
    name_of(lesson, operation, name);
    for (int k = 0; k < o->operand_count && k < 4; k++) name_of(lesson, o->operand[k], a[k]);
    const char *sign = !strcmp(o->name, "add") ? "+" : !strcmp(o->name, "sub") ? "-" : "*";
    bool infix = !strcmp(o->name, "add") || !strcmp(o->name, "sub") || !strcmp(o->name, "mul");
    if (is_leaf(o)) snprintf(text, size, "%s", name);
    else if (infix) snprintf(text, size, "%s = %s %s %s", name, a[0], sign, a[1]);
    else if (!strcmp(o->name, "neg")) snprintf(text, size, "%s = -%s", name, a[0]);
    else if (!strcmp(o->name, "rcp")) snprintf(text, size, "%s = 1/%s", name, a[0]);
    else if (o->operand_count == 4) snprintf(text, size, "%s = %s < %s ? %s : %s", name, a[0], a[1], a[2], a[3]);
    else if (o->operand_count == 2) snprintf(text, size, "%s = %s(%s, %s)", name, o->name, a[0], a[1]);
    else snprintf(text, size, "%s = %s(%s)", name, o->name, a[0]);
}
