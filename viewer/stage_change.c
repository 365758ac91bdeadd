/* What the user changes in the stage's scenes: methods, fields, rules. Each change is done at once where it can be, else
 * by building the scene anew with it, and kept (changes.h), so that it can be undone, done again and saved. */
#include <stdlib.h>
#include <string.h>

#include "io/groups.h"
#include "io/own_kinds.h"
#include "render/world_follow.h"
#include "viewer/stage.h"

/* ---- Keeping changes ---- */

/* Objects' lists in a scene. */
const char *viewer_list_of(skein_category category) {
    for (size_t i = 0; io_scene_section_at(i); i++)
        if (io_scene_section_at(i)->category == category) return io_scene_section_at(i)->name;
    return "";
}

/* "bodies.0.grid=[64, 64]". NULL when there is no memory; free it. */
static char *set_of(skein_category category, size_t index, const skein_field *field, const skein_value *value) {
    char *json = io_value_json(field, value), *set = NULL;
    size_t size = json ? strlen(json) + 256 : 0;
    if (json) set = malloc(size);
    if (set && category == SKEIN_SCENE) snprintf(set, size, "%s=%s", field->name, json);
    else if (set && (category == SKEIN_METHOD || category == SKEIN_VIEW))
        snprintf(set, size, "%s.%s=%s", viewer_list_of(category), field->name, json);
    else if (set) snprintf(set, size, "%s.%zu.%s=%s", viewer_list_of(category), index, field->name, json);
    free(json);
    return set;
}

/* Keeps what was done; `before` and `after` NULL where it takes a new scene to undo it. */
static void keep(viewer_stage *stage, size_t side, const char *set, const viewer_value *before,
                 const viewer_value *after) {
    if (!set || !viewer_changes_add(&stage->sides[side].changes, set, before, after))
        viewer_say(stage, SKEIN_LOG_WARNING, "out of memory: this change cannot be undone or saved");
}

/* Whether there is a plan for the next step. */
static bool runs(const viewer_player *player) {
    return !skein_world_explain(player->world, player->dt, NULL, NULL);
}

/* ---- Methods ---- */

/* The settings that two kinds of method share stay. A method that cannot run the rules is refused. */
void viewer_stage_method(viewer_stage *stage, size_t side, const char *name) {
    enum { MOST = 32 };
    skein_world *world = side < stage->side_count ? stage->sides[side].world : NULL;
    const skein_kind *kind = io_kind_find(SKEIN_METHOD, name, NULL);
    if (!world || !kind) return;
    skein_handle method = skein_object_at(world, SKEIN_METHOD, 0);
    const skein_kind *old = skein_object_kind(world, method);
    skein_setting all[MOST + 1] = {{NULL, {0, {0, 0, 0}, NULL}}}, shared[MOST + 1] = {{NULL, {0, {0, 0, 0}, NULL}}};
    size_t all_count = 0, shared_count = 0;
    if (kind == old) return;
    bool ran = runs(&stage->sides[side]); // else the method is not to blame
    for (size_t i = 0; i < old->field_count && i < MOST; i++) {
        skein_value value;
        const skein_field *field = &old->fields[i], *same = skein_field_find(kind, field->name, NULL);
        if (field->type == SKEIN_FIELD_TEXT || skein_get(world, method, field->name, &value)) continue;
        all[all_count++] = (skein_setting){field->name, value};
        if (same && same->type == field->type && !skein_field_check(same, &value, NULL))
            shared[shared_count++] = (skein_setting){field->name, value};
    }
    if (skein_method_set(world, kind->name, shared) || (ran && !runs(&stage->sides[side]))) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", kind->name, skein_world_error(world)->message);
        skein_method_set(world, old->name, all);
    } else {
        char set[64];
        snprintf(set, sizeof set, "method.type=%.40s", kind->name);
        keep(stage, side, set, NULL, NULL);
        viewer_note(stage, "method %s", kind->name);
        viewer_player_advise(&stage->sides[side]);
    }
    stage->facts = stage->dirty = true;
}

/* ---- Fields ---- */

/* The view's fields lie in a plain struct, at the table's offsets. */
static void set_view(viewer_stage *stage, const skein_field *field, const skein_value *value) {
    for (size_t s = 0; s < stage->side_count; s++) {
        char *at = (char *)&stage->sides[s].view + field->offset;
        switch (field->type) {
        case SKEIN_FIELD_BOOL: *(bool *)at = value->number[0] != 0; break;
        case SKEIN_FIELD_INT:
        case SKEIN_FIELD_CHOICE: *(int32_t *)(void *)at = (int32_t)value->number[0]; break;
        case SKEIN_FIELD_REAL: *(double *)(void *)at = value->number[0]; break;
        case SKEIN_FIELD_VEC3: memcpy(at, value->number, 3 * sizeof(double)); break;
        default: break; // texts are the scene's
        }
    }
    if (!strncmp(field->name, "camera.", 7)) stage->camera.placed = false;
}

/* The body that the camera goes along with from now on, and is placed anew for; false after a printed fault. */
static bool set_followed(viewer_stage *stage, const char *name) {
    size_t body;
    if (name[0] && !render_body_find(stage->sides[0].world, name, &body)) {
        viewer_say(stage, SKEIN_LOG_WARNING,
                   "camera.follow: there is no body '%.100s'%s: a body's name, its number from 0, or \"all\"", name,
                   io_group_words(stage->sides[0].world, name));
        return false;
    }
    for (size_t s = 0; s < stage->side_count; s++) {
        viewer_player *player = &stage->sides[s];
        snprintf(player->follow, sizeof player->follow, "%s", name);
        player->view.camera.follow = player->follow;
    }
    viewer_stage_follow(stage);
    return true;
}

/* Of the view's texts the one that takes no new scene. */
static bool is_body(const skein_field *field) {
    return !strcmp(field->unit, "body");
}

/* Whether a field changes at once; else the scene is built anew with it. */
static bool is_live(const viewer_stage *stage, size_t side, const viewer_value *at) {
    const skein_world *world = stage->sides[side].world;
    if (at->category == SKEIN_VIEW) return at->field->type != SKEIN_FIELD_TEXT || is_body(at->field);
    return at->category != SKEIN_SCENE &&
           skein_field_is_live(world, skein_object_at(world, at->category, at->index), at->field->name);
}

/* Sets a live field; false after a printed fault. */
static bool set_live(viewer_stage *stage, size_t side, const viewer_value *to) {
    skein_world *world = stage->sides[side].world;
    if (to->category == SKEIN_FORCE) viewer_hunt_leave(stage, side, to->index);
    stage->facts = stage->dirty = true;
    if (to->category == SKEIN_VIEW && is_body(to->field)) return set_followed(stage, to->value.text);
    if (to->category == SKEIN_VIEW) {
        set_view(stage, to->field, &to->value);
        return true;
    }
    skein_handle handle = skein_object_at(world, to->category, to->index);
    if (!skein_set(world, handle, to->field->name, to->value)) {
        // nothing moves meanwhile: a collider stands where it was put, and does not travel there through the next step
        if (to->category == SKEIN_COLLIDER && (stage->paused || viewer_stage_by_key(stage)))
            skein_collider_teleport(world, handle);
        return true;
    }
    viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", to->field->name, skein_world_error(world)->message);
    return false;
}

static bool change_live(viewer_stage *stage, size_t side, const viewer_value *to, const char *set) {
    const viewer_player *player = &stage->sides[side];
    viewer_value before = *to;
    if (to->category == SKEIN_FORCE)
        viewer_hunt_leave(stage, side, to->index); // what the scene has is what it was before
    if (to->category == SKEIN_VIEW) before.value = viewer_plain_value(to->field, &player->view);
    else if (skein_get(player->world, skein_object_at(player->world, to->category, to->index), to->field->name,
                       &before.value))
        return false;
    // the world's own text goes with the change
    char *text = before.value.text ? strdup(before.value.text) : NULL;
    before.value.text = text;
    // a name that is not there is found by the next step alone, and a scene with it would not open; what could not run
    // before is no fault of the name
    bool names = to->category != SKEIN_VIEW && to->field->type == SKEIN_FIELD_TEXT;
    bool ran = names && runs(player);
    bool good = set_live(stage, side, to);
    if (good && ran && !runs(player)) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", to->field->name, skein_world_error(player->world)->message);
        set_live(stage, side, &before);
        good = false;
    }
    if (good) keep(stage, side, set, &before, to);
    free(text);
    return good;
}

/* Builds the scene anew with more sets, as one change; from the start, or where it stands. */
static bool build_with_all(viewer_stage *stage, const char *const *sets, size_t count, bool stays) {
    viewer_changes changes;
    char pins[4096];
    if (!viewer_changes_copy(&changes, &stage->sides[0].changes)) return false;
    viewer_changes_close(&changes);
    bool good = true, lost = false;
    for (size_t i = 0; i < count && good; i++) {
        good = viewer_changes_add(&changes, sets[i], NULL, NULL);
        if (good) changes.data[changes.done - 1].joined = i > 0;
        lost |= good && viewer_pins_lose_meaning(stage, sets[i], pins, sizeof pins);
    }
    if (good && lost) good = viewer_changes_add(&changes, pins, NULL, NULL);
    if (good && lost) changes.data[changes.done - 1].joined = true;
    good = good && viewer_stage_reopen(stage, &changes, stays);
    viewer_changes_free(&changes);
    if (good && lost)
        viewer_note(stage, "built anew with %.120s; the pins painted on it meant other particles: they are gone",
                    sets[0]);
    else if (good) viewer_note(stage, "built anew with %s", sets[0]);
    return good;
}

bool viewer_stage_build_with(viewer_stage *stage, const char *set) {
    return build_with_all(stage, &set, 1, false);
}

bool viewer_stage_build_on(viewer_stage *stage, const char *set) {
    return build_with_all(stage, &set, 1, true);
}

bool viewer_stage_build_on_all(viewer_stage *stage, const char *const *sets, size_t count) {
    return build_with_all(stage, sets, count, true);
}

/* Tells the events what a field is now: what was asked for, or what it stays at. */
static void tell_value(const viewer_stage *stage, size_t side, const viewer_value *at, bool changed) {
    const viewer_player *player = &stage->sides[side];
    skein_value value = {0, {0, 0, 0}, NULL};
    char shown[400];
    if (at->category == SKEIN_VIEW) value = viewer_plain_value(at->field, &player->view);
    else if (at->category == SKEIN_SCENE) value = viewer_plain_value(at->field, &player->settings);
    else if (skein_get(player->world, skein_object_at(player->world, at->category, at->index), at->field->name, &value))
        return;
    skein_value_text(at->field, &value, shown, sizeof shown);
    viewer_event(stage->events, "%s %s %zu %s=%s", changed ? "set" : "refused", skein_category_text(at->category),
                 at->index, at->field->name, shown);
}

void viewer_stage_set(viewer_stage *stage, const viewer_request *r) {
    if (!stage->side_count) return;
    viewer_value to = {r->category, r->index, r->field, r->value};
    skein_error error = {SKEIN_OK, "", ""};
    if (to.value.count == 0) to.value.text = r->text;
    if (skein_field_check(r->field, &to.value, &error)) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", r->field->name, error.message);
        return;
    }
    size_t side = (size_t)r->side < stage->side_count ? (size_t)r->side : 0;
    char *set = set_of(r->category, r->index, r->field, &to.value);
    const char *one = set;
    bool stays = r->category == SKEIN_VIEW; // what is seen takes nothing back
    bool changed =
        is_live(stage, side, &to) ? change_live(stage, side, &to, set) : set && build_with_all(stage, &one, 1, stays);
    free(set);
    if (!changed && r->field->type == SKEIN_FIELD_TEXT)
        viewer_offer_look(stage, r->category, r->index, r->field, to.value.text);
    else if (r->field->type == SKEIN_FIELD_TEXT) viewer_offer_forget(stage);
    if (changed && !r->down) viewer_changes_close(&stage->sides[side].changes);
    tell_value(stage, side, &to, changed);
    // a slider that is dragged asks for nothing yet
    if (changed && r->category != SKEIN_VIEW) stage->advice_due = viewer_seconds() + 0.4;
    stage->facts = stage->dirty = true;
}

/* ---- Several fields of one object, as handles change them ---- */

void viewer_stage_try(viewer_stage *stage, skein_category category, size_t index, const skein_field *field,
                      const skein_value *value) {
    const viewer_value to = {category, index, field, *value};
    for (size_t s = 0; s < stage->side_count; s++) set_live(stage, s, &to);
}

/* One field in place, in all worlds, as one change or a part of it. */
static bool change_shared(viewer_stage *stage, const viewer_value *to, const char *set, bool joined) {
    bool good = true;
    for (size_t s = 0; s < stage->side_count; s++) {
        viewer_changes *changes = &stage->sides[s].changes;
        viewer_changes_close(changes);
        size_t before = changes->done;
        good &= change_live(stage, s, to, set);
        if (changes->done == before) continue;
        viewer_change *last = &changes->data[changes->done - 1];
        last->shared = last->whole = true;
        last->joined = joined;
    }
    return good;
}

bool viewer_stage_change_together(viewer_stage *stage, skein_category category, size_t index,
                                  const viewer_spot_change *changes, size_t count, bool live) {
    enum { MOST = 4 };
    char *sets[MOST] = {NULL};
    bool good = count > 0 && count <= MOST;
    for (size_t i = 0; i < count && good; i++) {
        skein_error error = {SKEIN_OK, "", ""};
        good = !skein_field_check(changes[i].field, &changes[i].value, &error);
        if (!good) viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", changes[i].field->name, error.message);
        sets[i] = good ? set_of(category, index, changes[i].field, &changes[i].value) : NULL;
        good = sets[i] != NULL;
    }
    if (good && !live) good = build_with_all(stage, (const char *const *)sets, count, false);
    for (size_t i = 0; i < count && good && live; i++) {
        const viewer_value to = {category, index, changes[i].field, changes[i].value};
        good = change_shared(stage, &to, sets[i], i > 0);
    }
    for (size_t i = 0; i < count && i < MOST; i++) {
        const viewer_value at = {category, index, changes[i].field, changes[i].value};
        free(sets[i]);
        tell_value(stage, 0, &at, good);
    }
    if (good) stage->advice_due = viewer_seconds() + 0.4;
    return good;
}

void viewer_stage_follow_body(viewer_stage *stage, size_t body) {
    const skein_field *field = skein_field_find(render_view_kind(), "camera.follow", NULL);
    const viewer_player *player = &stage->sides[0];
    size_t found, followed;
    skein_value name;
    viewer_request request = {.kind = VIEWER_SET, .category = SKEIN_VIEW, .field = field, .value = skein_text(NULL)};
    if (!stage->side_count || body >= skein_object_count(player->world, SKEIN_BODY)) return;
    bool already = stage->camera.follows && render_body_find(player->world, player->view.camera.follow, &followed);
    bool named = !skein_get(player->world, skein_object_at(player->world, SKEIN_BODY, body), "name", &name) &&
                 name.text && render_body_find(player->world, name.text, &found) && found == body;
    if (already && followed == body) request.text[0] = 0;
    else if (named) snprintf(request.text, sizeof request.text, "%s", name.text);
    else snprintf(request.text, sizeof request.text, "%zu", body);
    viewer_stage_set(stage, &request);
}

/* ---- Rules ---- */

/* Takes one away of those that are part of what is built. */
static void remove_by_building(viewer_stage *stage, const viewer_request *r) {
    char set[64];
    snprintf(set, sizeof set, "%s.%zu=null", viewer_list_of(r->category), r->index);
    bool good = viewer_stage_build_with(stage, set);
    viewer_event(stage->events, "%s %s", good ? "removed" : "not removed", r->text);
}

void viewer_stage_add_or_remove(viewer_stage *stage, const viewer_request *r) {
    bool adds = r->kind == VIEWER_ADD;
    if (!adds && stage->side_count && r->category != SKEIN_FORCE && r->category != SKEIN_COLLIDER) {
        remove_by_building(stage, r);
        return;
    }
    viewer_hunt_rest(stage); // places among the forces change
    for (size_t s = 0; s < stage->side_count; s++) {
        skein_world *world = stage->sides[s].world;
        size_t place = adds ? skein_object_count(world, r->category) : r->index;
        skein_status status = SKEIN_OK;
        if (!adds) status = skein_remove(world, skein_object_at(world, r->category, r->index));
        else if (r->category == SKEIN_FORCE) status = skein_force_add(world, r->text, NULL, NULL);
        else status = skein_collider_add(world, r->text, NULL, NULL);
        char set[200];
        if (adds)
            snprintf(set, sizeof set, "%s.%zu={\"type\": \"%.60s\"}", viewer_list_of(r->category), place, r->text);
        else snprintf(set, sizeof set, "%s.%zu=null", viewer_list_of(r->category), place);
        if (status) viewer_say(stage, SKEIN_LOG_WARNING, "%s", skein_world_error(world)->message);
        else keep(stage, s, set, NULL, NULL);
        if (!status) viewer_recorded_anew(stage, s);
    }
    viewer_event(stage->events, "%s %s", adds ? "added" : "removed", r->text);
    stage->facts = stage->dirty = true;
}

/* ---- Back and forth ---- */

/* Goes to another number of changes, by a scene built anew that goes on where this one stands. */
static void go_to_change(viewer_stage *stage, size_t done, const char *words) {
    viewer_changes changes;
    if (!viewer_changes_copy(&changes, &stage->sides[0].changes)) return;
    changes.done = done;
    if (viewer_stage_reopen(stage, &changes, true)) viewer_note(stage, "%s", words);
    viewer_changes_free(&changes);
}

/* A change as a note says it. */
static void say_change(char *words, size_t size, const char *what, const viewer_change *change) {
    snprintf(words, size, "%s: %.180s", what, change->set);
}

/* Whether all of [from, to) can be done in place. */
static bool are_live(const viewer_changes *changes, size_t from, size_t to) {
    bool live = true;
    for (size_t i = from; i < to; i++) live &= changes->data[i].before.field != NULL;
    return live;
}

/* One change in place, back or on; the other world goes along where it was changed with it. */
static bool put_live(viewer_stage *stage, const viewer_change *change, bool back) {
    const viewer_value *to = back ? &change->before : &change->after;
    bool good = set_live(stage, 0, to);
    for (size_t s = 1; s < stage->side_count && change->shared && good; s++) {
        viewer_changes *other = &stage->sides[s].changes;
        set_live(stage, s, to);
        if (back) viewer_changes_drop(other, change->set);
        else if (viewer_changes_add(other, change->set, &change->before, &change->after))
            other->data[other->done - 1].shared = other->data[other->done - 1].whole = true;
    }
    return good;
}

void viewer_stage_undo(viewer_stage *stage) {
    viewer_changes *changes = &stage->sides[0].changes;
    char words[220];
    if (!stage->side_count || changes->done == changes->given) {
        viewer_note(stage, "there is nothing to undo");
        return;
    }
    size_t first = viewer_changes_back(changes, changes->done);
    say_change(words, sizeof words, "undone", &changes->data[first]);
    if (are_live(changes, first, changes->done)) {
        bool good = true;
        while (changes->done > first && good && (good = put_live(stage, &changes->data[changes->done - 1], true)))
            changes->done--;
        if (good) viewer_note(stage, "%s", words);
    } else {
        go_to_change(stage, first, words);
    }
    viewer_tell_state(stage);
}

void viewer_stage_redo(viewer_stage *stage) {
    viewer_changes *changes = &stage->sides[0].changes;
    char words[220];
    if (!stage->side_count || changes->done == changes->count) {
        viewer_note(stage, "there is nothing to do again");
        return;
    }
    size_t end = viewer_changes_on(changes, changes->done);
    say_change(words, sizeof words, "done again", &changes->data[changes->done]);
    if (are_live(changes, changes->done, end)) {
        bool good = true;
        while (changes->done < end && good && (good = put_live(stage, &changes->data[changes->done], false)))
            changes->done++;
        if (good) viewer_note(stage, "%s", words);
    } else {
        go_to_change(stage, end, words);
    }
    viewer_tell_state(stage);
}

void viewer_stage_revert(viewer_stage *stage) {
    const viewer_changes *changes = &stage->sides[0].changes;
    if (!stage->side_count || changes->done == changes->given) viewer_note(stage, "nothing is changed");
    else go_to_change(stage, changes->given, "as the file has it; redo brings the changes back");
    viewer_tell_state(stage);
}
