/* Copies of what the panels show, so that the window never touches a world: objects with their fields, measures, plots.
 *
 * Called by the stage, viewer_mirror() under the exchange's lock. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/own_kinds.h"
#include "viewer/flock.h"
#include "viewer/stage.h"

/* Measures are taken at most so often, and for at most so large a part of the time. */
static const double sample_every = 0.1, sample_share = 0.1;

/* ---- Objects and fields ---- */

static bool reserve(void *array, size_t *room, size_t count, size_t size) {
    void **pointer = array;
    if (count <= *room) return true;
    void *grown = realloc(*pointer, 2 * count * size);
    if (!grown) return false;
    *pointer = grown;
    *room = 2 * count;
    return true;
}

skein_value viewer_plain_value(const skein_field *field, const void *params) {
    const char *at = (const char *)params + field->offset;
    skein_value value = {1, {0, 0, 0}, NULL};
    switch (field->type) {
    case SKEIN_FIELD_BOOL: value.number[0] = *(const bool *)at; break;
    case SKEIN_FIELD_INT:
    case SKEIN_FIELD_CHOICE: value.number[0] = *(const int32_t *)(const void *)at; break;
    case SKEIN_FIELD_INT2:
    case SKEIN_FIELD_INT3:
        value.count = field->type == SKEIN_FIELD_INT2 ? 2 : 3;
        for (int i = 0; i < value.count; i++) value.number[i] = ((const int32_t *)(const void *)at)[i];
        break;
    case SKEIN_FIELD_REAL: value.number[0] = *(const double *)(const void *)at; break;
    case SKEIN_FIELD_REAL2:
        value.count = 2;
        memcpy(value.number, at, 2 * sizeof(double));
        break;
    case SKEIN_FIELD_VEC3:
        value.count = 3;
        memcpy(value.number, at, 3 * sizeof(double));
        break;
    case SKEIN_FIELD_TEXT: value = (skein_value){0, {0, 0, 0}, *(char *const *)(const void *)at}; break;
    }
    return value;
}

static double largest(const skein_value *value) {
    double most = 0;
    for (int i = 0; i < value->count; i++)
        if (isfinite(value->number[i])) most = fmax(most, fabs(value->number[i]));
    return most;
}

static bool add_entry(viewer_side *side, const skein_field *field, skein_value value, bool shapes) {
    if (!reserve(&side->entries, &side->entry_room, side->entry_count + 1, sizeof *side->entries)) return false;
    viewer_entry *entry = &side->entries[side->entry_count];
    *entry = (viewer_entry){.field = field, .value = value, .anchor = largest(&value), .shapes = shapes};
    entry->cut = value.text && strlen(value.text) >= sizeof entry->text;
    snprintf(entry->text, sizeof entry->text, "%s", value.text ? value.text : "");
    entry->value.text = NULL;
    side->entry_count++;
    side->objects[side->object_count].count++;
    return true;
}

static bool begin_object(viewer_side *side, skein_category category, size_t index, const skein_kind *kind,
                         const char *name) {
    if (!reserve(&side->objects, &side->object_room, side->object_count + 1, sizeof *side->objects)) return false;
    side->objects[side->object_count] =
        (viewer_object){.category = category, .index = index, .kind = kind, .first = side->entry_count};
    snprintf(side->objects[side->object_count].name, sizeof side->objects->name, "%s", name);
    return true;
}

/* A field that stays where it is, whatever becomes of the object: an object with a formula has a table of its own, which
 * goes with it, while panels on another thread still look at it. So the listed kind's field of that name, or, of a formula's
 * own parameters, a copy. NULL when there is no memory. */
static const skein_field *field_to_keep(viewer_side *side, const skein_kind *listed, const skein_field *field) {
    for (size_t f = 0; listed && f < listed->field_count; f++)
        if (!strcmp(listed->fields[f].name, field->name)) return &listed->fields[f];
    for (viewer_own_field *own = side->own_fields; own; own = own->next)
        if (!strcmp(own->name, field->name)) return &own->field;
    viewer_own_field *own = calloc(1, sizeof *own);
    if (!own) return NULL;
    own->field = *field;
    snprintf(own->name, sizeof own->name, "%s", field->name);
    own->field.name = own->name;
    own->next = side->own_fields;
    side->own_fields = own;
    return &own->field;
}

/* `listed` has these very fields, or is NULL: they are nobody's but the category's, and stay. */
static void add_fields(viewer_side *side, const skein_world *world, skein_handle handle, const skein_kind *listed,
                       const skein_field *fields, size_t count) {
    for (size_t f = 0; f < count; f++) {
        skein_value value;
        if (!skein_kind_takes(skein_object_kind(world, handle), fields[f].name))
            continue; // setting it would be refused
        if (skein_get(world, handle, fields[f].name, &value)) continue;
        const skein_field *field = listed ? field_to_keep(side, listed, &fields[f]) : &fields[f];
        if (field) add_entry(side, field, value, !skein_field_is_live(world, handle, field->name));
    }
}

/* Whether a field's help says that it is given "instead of count", "instead of the mass". */
static bool is_instead_of(const skein_field *field, const char *name) {
    const char *at = strstr(field->help, "instead of ");
    if (!at) return false;
    at += strlen("instead of ");
    if (!strncmp(at, "the ", 4)) at += 4;
    size_t length = strlen(name);
    return !strncmp(at, name, length) &&
           !strchr("abcdefghijklmnopqrstuvwxyz_.0123456789", at[length] ? at[length] : ' ');
}

/* Fields that count for nothing, because another one is given instead of them. */
static void mark_ignored(viewer_side *side, const viewer_object *object) {
    viewer_entry *entries = side->entries + object->first;
    for (size_t e = 0; e < object->count; e++)
        for (size_t other = 0; other < object->count && !entries[e].instead; other++) {
            const skein_value *value = &entries[other].value;
            bool given = entries[other].text[0] || value->number[0] != 0;
            if (given && is_instead_of(entries[other].field, entries[e].field->name))
                entries[e].instead = entries[other].field;
        }
}

static void add_objects(viewer_side *side, const skein_world *world, skein_category category) {
    for (size_t i = 0; i < skein_object_count(world, category); i++) {
        skein_handle handle = skein_object_at(world, category, i);
        const skein_kind *kind = skein_object_kind(world, handle), *listed = io_kind_find(category, kind->name, NULL);
        skein_value name = {0, {0, 0, 0}, NULL};
        size_t common_count;
        const skein_field *common = skein_common_fields(category, &common_count);
        bool named = category != SKEIN_METHOD && !skein_get(world, handle, "name", &name) && name.text && name.text[0];
        if (!begin_object(side, category, i, listed ? listed : kind, named ? name.text : kind->name)) return;
        add_fields(side, world, handle, listed ? listed : kind, kind->fields, kind->field_count);
        if (category != SKEIN_METHOD) add_fields(side, world, handle, NULL, common, common_count);
        mark_ignored(side, &side->objects[side->object_count]);
        side->object_count++;
    }
}

static void add_plain(viewer_side *side, const skein_kind *kind, const void *params) {
    if (!begin_object(side, kind->category, 0, kind, kind->name)) return;
    for (size_t f = 0; f < kind->field_count; f++)
        add_entry(side, &kind->fields[f], viewer_plain_value(&kind->fields[f], params), kind->category == SKEIN_SCENE);
    side->object_count++;
}

/* Sliders keep the measure that they began with, as long as the objects are the same. */
static void keep_anchors(viewer_side *side, const viewer_entry *old, size_t count) {
    for (size_t e = 0; e < side->entry_count && e < count; e++)
        if (old[e].field == side->entries[e].field) side->entries[e].anchor = old[e].anchor;
}

static void mirror_objects(viewer_side *side, const viewer_player *player) {
    size_t count = side->entry_count;
    viewer_entry *old = malloc(count * sizeof *old + 1);
    if (old && count) memcpy(old, side->entries, count * sizeof *old);
    side->object_count = side->entry_count = 0;
    add_objects(side, player->world, SKEIN_METHOD);
    add_objects(side, player->world, SKEIN_BODY);
    add_objects(side, player->world, SKEIN_CONSTRAINT);
    add_objects(side, player->world, SKEIN_FORCE);
    add_objects(side, player->world, SKEIN_COLLIDER);
    add_objects(side, player->world, SKEIN_MOTION);
    add_plain(side, render_view_kind(), &player->view);
    add_plain(side, io_scene_kind(), &player->settings);
    if (old) keep_anchors(side, old, count);
    free(old);
}

/* ---- Measures ---- */

/* A moment that is measured again takes its own place; where time goes back, curves begin anew. */
static void make_room(viewer_plots *plots, double time) {
    size_t last = (plots->next + VIEWER_SAMPLES - 1) % VIEWER_SAMPLES;
    if (!plots->count || (float)time > plots->time[last]) return;
    if ((float)time < plots->time[last]) plots->count = 0;
    else plots->next = last, plots->count--;
}

static void add_sample(viewer_plots *plots, double time, const skein_statistics *s, const skein_order *flock,
                       double step_ms, double draw_ms) {
    const double values[VIEWER_QUANTITY_COUNT] = {
        [VIEWER_KINETIC] = s->kinetic_energy,
        [VIEWER_POTENTIAL] = s->potential_energy,
        [VIEWER_ELASTIC] = s->elastic_energy,
        [VIEWER_TOTAL] = s->kinetic_energy + s->potential_energy + s->elastic_energy,
        [VIEWER_STRETCH] = 100 * s->max_stretch,
        [VIEWER_CONTACTS] = (double)s->contacts,
        [VIEWER_STEP_MS] = step_ms,
        [VIEWER_DRAW_MS] = draw_ms,
        [VIEWER_POLARIZATION] = flock ? flock->polarization : NAN,
        [VIEWER_MILLING] = flock ? flock->milling : NAN,
    };
    make_room(plots, time);
    plots->time[plots->next] = (float)time;
    for (int q = 0; q < VIEWER_QUANTITY_COUNT; q++) {
        bool finite = isfinite(values[q]) && fabs(values[q]) < 1e30;
        plots->value[q][plots->next] = finite ? (float)values[q] : NAN; // a gap
    }
    plots->next = (plots->next + 1) % VIEWER_SAMPLES;
    if (plots->count < VIEWER_SAMPLES) plots->count++;
}

void viewer_measure(viewer_stage *stage) {
    double now = viewer_seconds();
    if (now < stage->sampled) return;
    for (size_t s = 0; s < stage->side_count; s++) {
        skein_statistics statistics;
        skein_order order;
        if (skein_world_statistics(stage->sides[s].world, &statistics)) continue;
        bool flock = viewer_flock_measure(stage->sides[s].world, &order);
        viewer_side *side = &stage->exchange->shown.sides[s];
        pthread_mutex_lock(&stage->exchange->lock);
        side->flock = flock;
        side->statistics = statistics;
        add_sample(&side->plots, skein_world_time(stage->sides[s].world), &statistics, flock ? &order : NULL,
                   stage->step_ms, stage->draw_ms);
        pthread_mutex_unlock(&stage->exchange->lock);
    }
    double took = viewer_seconds() - now;
    stage->sampled = now + fmax(sample_every, took / sample_share);
}

/* ---- All of it ---- */

static void mirror_time(viewer_stage *stage, viewer_shown *shown) {
    const viewer_player *player = &stage->sides[0];
    shown->frame = player->frame;
    shown->first_frame = player->history.first;
    shown->last_frame = player->history.last > player->frame ? player->history.last : player->frame;
    shown->time = skein_world_time(player->world);
    shown->needed = player->needed;
    shown->changes = 0;
    for (size_t i = player->changes.given; i < player->changes.done; i++)
        shown->changes += !player->changes.data[i].joined;
    const char *name = player->settings.name[0] ? player->settings.name : player->path;
    snprintf(shown->title, sizeof shown->title, "Skein: %.160s%s", name, stage->paused ? " (paused)" : "");
    snprintf(shown->about, sizeof shown->about, "%s", player->settings.description);
    for (size_t s = 0; s < stage->side_count; s++) {
        const viewer_player *p = &stage->sides[s];
        snprintf(shown->sides[s].name, sizeof shown->sides[s].name, "%.150s",
                 s == 1 ? stage->compare
                        : skein_object_kind(p->world, skein_object_at(p->world, SKEIN_METHOD, 0))->name);
        if (stage->facts) mirror_objects(&shown->sides[s], p);
    }
}

/* The handles over the pictures. */
static void mirror_handles(const viewer_stage *stage, viewer_shown *shown) {
    const viewer_handles *h = &stage->handles;
    shown->tool = stage->side_count ? h->tool : VIEWER_NO_TOOL;
    shown->tool_category = h->category, shown->tool_index = h->index;
    shown->brush = h->brush.radius;
    snprintf(shown->tool_words, sizeof shown->tool_words, "%s", h->words);
    shown->tool_at[0] = stage->x, shown->tool_at[1] = stage->y;
    for (size_t s = 0; s < VIEWER_SIDES; s++) {
        viewer_side *side = &shown->sides[s];
        side->strokes.count = 0;
        if (shown->tool) viewer_handles_draw(stage, s, &side->strokes);
        for (int part = 0; part < GIZMO_PARTS; part++) {
            side->handles[part].name[0] = 0;
            if (shown->tool) viewer_handles_part(stage, s, part, side->handles[part].name, side->handles[part].at);
        }
    }
}

void viewer_mirror(viewer_stage *stage) {
    viewer_shown *shown = &stage->exchange->shown;
    shown->has_scene = stage->side_count > 0;
    shown->paused = stage->paused;
    shown->light = stage->light;
    shown->alarm = stage->alarm && stage->message[0];
    shown->recording = stage->film != NULL || (stage->records && stage->side_count);
    shown->flying = stage->camera.flying;
    shown->by_key = viewer_stage_by_key(stage);
    shown->play_away = stage->play_away;
    shown->slow = stage->slow;
    shown->speed = stage->speed;
    memcpy(shown->panel, stage->panel, sizeof shown->panel);
    snprintf(shown->message, sizeof shown->message, "%s", stage->message);
    shown->side_count = stage->side_count;
    memcpy(shown->recent, stage->recent.path, sizeof shown->recent);
    shown->recent_count = stage->recent.count;
    if (stage->panel[VIEWER_PANEL_LESSON]) viewer_lesson_copy(&shown->lesson, &stage->lesson);
    mirror_handles(stage, shown);
    shown->offer = stage->offer;
    if (stage->side_count) mirror_time(stage, shown);
    else snprintf(shown->title, sizeof shown->title, "Skein");
    stage->facts = false;
}
