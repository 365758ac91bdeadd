/* Choosing, holding and letting go; see handles.h. */
#include "viewer/handles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/stage.h"

/* A press that moves less (pixels) changes nothing. */
static const double least_way = 2, least_brush = 4, most_brush = 400;

static const char *const words_of_tool[VIEWER_TOOL_COUNT] = {"nothing", "move", "turn", "size", "pins", "knife"};

/* ---- What is chosen ---- */

static const skein_category with_spots[] = {SKEIN_BODY, SKEIN_COLLIDER, SKEIN_FORCE};
enum { CATEGORIES = sizeof with_spots / sizeof *with_spots };

static bool has_spot(const viewer_stage *stage, skein_category category, size_t index, viewer_spot *spot) {
    return stage->side_count && viewer_spot_find(spot, stage->sides[0].world, category, index);
}

static void name_object(const viewer_stage *stage, char *out, size_t size) {
    const viewer_handles *h = &stage->handles;
    const skein_world *world = stage->sides[0].world;
    skein_handle handle = skein_object_at(world, h->category, h->index);
    skein_value name = {0, {0, 0, 0}, NULL};
    bool named = !skein_get(world, handle, "name", &name) && name.text && name.text[0];
    const skein_kind *kind = skein_object_kind(world, handle);
    snprintf(out, size, "%s %zu, %.60s", skein_category_text(h->category), h->index,
             named  ? name.text
             : kind ? kind->name
                    : "");
}

static void tell(viewer_stage *stage) {
    const viewer_handles *h = &stage->handles;
    viewer_spot spot;
    char name[120] = "";
    if (h->chosen) name_object(stage, name, sizeof name);
    bool has = h->chosen && has_spot(stage, h->category, h->index, &spot);
    if (h->tool == VIEWER_PINS)
        viewer_note(
            stage,
            "the brush: drag over a body to pin its particles, with Shift to free them; the wheel makes it wider; P or Esc puts it away");
    else if (h->tool == VIEWER_CUTS)
        viewer_note(
            stage,
            "the knife: a stroke cuts the cloth whose picture it crosses; Shift and the other buttons look around; K or Esc puts it away");
    else if (h->tool && has && !viewer_spot_can(&spot, h->tool))
        viewer_note(stage, "%s: there is no field to %s it by", name, words_of_tool[h->tool]);
    else if (h->tool)
        viewer_note(stage,
                    "%s: drag a handle to %s it, with Ctrl by whole steps; N is the next object, Esc puts them away",
                    name, words_of_tool[h->tool]);
    else viewer_note(stage, "no handles");
    viewer_event(stage->events, "tool %s %s", words_of_tool[h->tool], h->tool >= VIEWER_PINS ? "" : name);
    stage->dirty = true;
}

/* The object under the pointer; false where there is none that has a place. */
static bool find_under_pointer(const viewer_stage *stage, skein_category *category, size_t *index) {
    double inside, direction[3], best = INFINITY;
    viewer_spot spot;
    bool found = false;
    size_t side = viewer_side_at(stage, stage->x, &inside);
    const viewer_player *player = &stage->sides[side];
    viewer_ray_at(stage, side, stage->x, stage->y, direction);
    for (int c = 0; c < 2; c++) { // rays meet bodies and colliders
        skein_hit hit;
        if (with_spots[c] == SKEIN_COLLIDER && !player->view.colliders) continue;
        if (skein_ray_cast(player->world, stage->camera.lens.eye, direction, with_spots[c], &hit)) continue;
        for (size_t i = 0; hit.t < best && i < skein_object_count(player->world, with_spots[c]); i++) {
            skein_handle handle = skein_object_at(player->world, with_spots[c], i);
            if (handle.index != hit.object.index || handle.generation != hit.object.generation) continue;
            if (!has_spot(stage, with_spots[c], i, &spot)) continue;
            *category = with_spots[c], *index = i;
            best = hit.t;
            found = true;
        }
    }
    return found;
}

/* The first object there is; false where none has a place. */
static bool find_any(const viewer_stage *stage, skein_category *category, size_t *index) {
    viewer_spot spot;
    for (int c = 0; c < CATEGORIES; c++)
        for (size_t i = 0; i < skein_object_count(stage->sides[0].world, with_spots[c]); i++)
            if (has_spot(stage, with_spots[c], i, &spot)) {
                *category = with_spots[c], *index = i;
                return true;
            }
    return false;
}

static void put_away(viewer_stage *stage) {
    stage->handles.tool = VIEWER_NO_TOOL;
    stage->handles.hot = GIZMO_NOTHING;
    tell(stage);
}

static void take_tool(viewer_stage *stage, viewer_tool tool, skein_category category, size_t index) {
    viewer_handles *h = &stage->handles;
    h->chosen = true;
    h->category = category, h->index = index;
    h->tool = tool;
    h->hot = GIZMO_NOTHING;
    viewer_hunt_rest(stage);
    tell(stage);
}

/* The knife is for no object. */
static void take_knife(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    if (h->tool == VIEWER_CUTS) {
        put_away(stage);
        return;
    }
    h->tool = VIEWER_CUTS;
    h->hot = GIZMO_NOTHING;
    viewer_hunt_rest(stage);
    tell(stage);
}

void viewer_handles_key(viewer_stage *stage, viewer_tool tool) {
    viewer_handles *h = &stage->handles;
    skein_category category = h->category;
    size_t index = h->index;
    if (!stage->side_count || viewer_handles_busy(stage)) return;
    if (tool == VIEWER_CUTS) {
        take_knife(stage);
        return;
    }
    if (h->brush.radius <= 0) h->brush.radius = 24;
    // with handles on, another tool is for the same object; and the ground, which is behind everything, is not meant
    bool under = stage->over && (!h->tool || h->tool == tool) && find_under_pointer(stage, &category, &index);
    viewer_spot spot;
    if (under && h->chosen && has_spot(stage, category, index, &spot) && spot.normal) under = false;
    if (!under) category = h->category, index = h->index;
    bool other = under && (!h->chosen || category != h->category || index != h->index);
    if (h->tool == tool && (!other || tool == VIEWER_PINS)) {
        put_away(stage);
        return;
    }
    bool any = under || h->chosen || find_any(stage, &category, &index);
    if (any) take_tool(stage, tool, category, index);
    else viewer_note(stage, "nothing here has a place that handles could move");
}

void viewer_handles_request(viewer_stage *stage, const viewer_request *r) {
    viewer_handles *h = &stage->handles;
    viewer_spot spot;
    if (!stage->side_count || viewer_handles_busy(stage) || r->code <= 0 || r->code >= VIEWER_CUTS) return;
    if (h->brush.radius <= 0) h->brush.radius = 24;
    bool same = h->chosen && h->category == r->category && h->index == r->index;
    if (same && h->tool == (viewer_tool)r->code) put_away(stage);
    else if (r->code == VIEWER_PINS || has_spot(stage, r->category, r->index, &spot))
        take_tool(stage, (viewer_tool)r->code, r->category, r->index);
    else viewer_note(stage, "it has no place that handles could move");
}

void viewer_handles_next(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    viewer_spot spot;
    if (!stage->side_count || viewer_handles_busy(stage)) return;
    viewer_tool tool = h->tool && h->tool < VIEWER_PINS ? h->tool : VIEWER_MOVES;
    bool seen = !h->chosen || !h->tool;
    for (int turn = 0; turn < 2; turn++)
        for (int c = 0; c < CATEGORIES; c++)
            for (size_t i = 0; i < skein_object_count(stage->sides[0].world, with_spots[c]); i++) {
                if (seen && has_spot(stage, with_spots[c], i, &spot)) {
                    take_tool(stage, tool, with_spots[c], i);
                    return;
                }
                seen |= h->category == with_spots[c] && h->index == i;
            }
    viewer_note(stage, "nothing here has a place that handles could move");
}

/* ---- On the picture ---- */

static viewer_sight sight_of(const viewer_stage *stage, size_t side) {
    int left, width = viewer_side_width(stage, side, &left);
    return (viewer_sight){stage->camera.lens, left, width, stage->height};
}

static double scale_of(const viewer_stage *stage) {
    return stage->options->scale > 0 ? stage->options->scale : 1;
}

/* The gizmo of a side as it is now; false where there is none. While it is held it is where it was, moved along. */
static bool gizmo_of(const viewer_stage *stage, size_t side, viewer_gizmo *gizmo, viewer_spot *spot) {
    const viewer_handles *h = &stage->handles;
    if (!h->chosen || h->tool == VIEWER_NO_TOOL || h->tool >= VIEWER_PINS || side >= stage->side_count) return false;
    if (h->holds) {
        *spot = h->spot, *gizmo = h->gizmo;
        if (h->moved && h->tool == VIEWER_MOVES)
            for (int k = 0; k < 3; k++) gizmo->origin[k] += h->by[k];
        gizmo->hot = h->part;
        return true;
    }
    if (!viewer_spot_find(spot, stage->sides[side].world, h->category, h->index) || !viewer_spot_can(spot, h->tool))
        return false;
    viewer_spot_gizmo(spot, h->tool, stage->camera.lens.target, gizmo);
    gizmo->scale = scale_of(stage);
    gizmo->hot = side == h->hot_side ? h->hot : GIZMO_NOTHING;
    return true;
}

/* The outline of what it places: a box along its own axes, or a circle as large as its radius. */
static void draw_outline(const viewer_stage *stage, size_t side, const viewer_gizmo *gizmo, const viewer_spot *spot,
                         viewer_strokes *strokes) {
    const viewer_handles *h = &stage->handles;
    viewer_sight sight = sight_of(stage, side);
    viewer_stroke like = {.width = 1.2f, .opacity = 0.7f, .paint = VIEWER_PAINT_QUIET, .part = GIZMO_NOTHING};
    bool metres = spot->uniform && !strcmp(spot->uniform->unit, "m");
    double axes[3][3], corner[8][3], middle[3], at[2];
    viewer_spot_axes(spot, axes);
    viewer_spot_middle(spot, stage->camera.lens.target, middle);
    double times = h->holds && h->tool == VIEWER_SIZES ? h->by[0] : 1;
    if (metres && !spot->from && !spot->size) {
        if (h->holds) viewer_spot_carry(spot, &h->gizmo, h->part, h->by, middle);
        if (viewer_sight_project(&sight, middle, at))
            viewer_stroke_circle(strokes, at, viewer_sight_radius(&sight, middle, times * spot->factor), like);
        return;
    }
    if (!spot->size) return;
    for (int c = 0; c < 8; c++) {
        const double half[3] = {0.5 * spot->extent[0], spot->flat ? 0 : 0.5 * spot->extent[1],
                                0.5 * spot->extent[spot->flat ? 1 : 2]};
        for (int k = 0; k < 3; k++) {
            corner[c][k] = middle[k];
            for (int a = 0; a < 3; a++) corner[c][k] += (c >> a & 1 ? 1 : -1) * half[a] * axes[a][k];
        }
        if (h->holds && h->moved)
            viewer_spot_carry(spot, gizmo->tool == VIEWER_MOVES ? &h->gizmo : gizmo, h->part, h->by, corner[c]);
    }
    for (int c = 0; c < 8; c++)
        for (int a = 0; a < 3; a++)
            if (!(c >> a & 1) && !(spot->flat && (a == 1 || c & 2)))
                viewer_stroke_edge(strokes, &sight, corner[c], corner[c | 1 << a], like);
}

/* The brush, and who is held of the body that it is for. */
static void draw_brush(const viewer_stage *stage, size_t side, viewer_strokes *strokes) {
    const viewer_handles *h = &stage->handles;
    const skein_world *world = stage->sides[side].world;
    viewer_sight sight = sight_of(stage, side);
    double inside;
    skein_surface s = {0};
    bool body =
        h->chosen && h->category == SKEIN_BODY &&
        !skein_body_surface(world, skein_object_at(world, SKEIN_BODY, h->brush.paints ? h->brush.body : h->index), &s);
    for (size_t i = 0; body && i < s.particle_count && strokes->count + 4 < VIEWER_STROKES; i++) {
        double place[3], at[2];
        if (!viewer_is_held(world, s.first_particle + (uint32_t)i) ||
            skein_positions_copy(world, s.first_particle + i, 1, place))
            continue;
        if (!viewer_sight_project(&sight, place, at)) continue;
        viewer_stroke_circle(
            strokes, at, 3.5 * scale_of(stage),
            (viewer_stroke){.width = 0, .opacity = 1, .paint = VIEWER_PAINT_HOT, .part = GIZMO_NOTHING});
    }
    if (!stage->over || viewer_side_at(stage, stage->x, &inside) != side) return;
    const double at[2] = {stage->x + 0.5, stage->y + 0.5};
    viewer_stroke_circle(strokes, at, h->brush.radius,
                         (viewer_stroke){.width = 1.6f,
                                         .opacity = 0.95f,
                                         .part = GIZMO_NOTHING,
                                         .paint = h->brush.paints ? VIEWER_PAINT_HOT : VIEWER_PAINT_ALL});
}

/* Where the blade is: a point, and while it cuts a larger one. */
static void draw_knife(const viewer_stage *stage, size_t side, viewer_strokes *strokes) {
    const viewer_knife *knife = &stage->handles.knife;
    double inside;
    if (!stage->over || viewer_side_at(stage, stage->x, &inside) != side) return;
    const double at[2] = {stage->x + 0.5, stage->y + 0.5};
    viewer_stroke_circle(
        strokes, at, (knife->cuts ? 5 : 3) * scale_of(stage),
        (viewer_stroke){.width = 0, .opacity = 0.95f, .paint = VIEWER_PAINT_HOT, .part = GIZMO_NOTHING});
}

void viewer_handles_draw(const viewer_stage *stage, size_t side, viewer_strokes *strokes) {
    viewer_gizmo gizmo;
    viewer_spot spot;
    strokes->count = 0;
    if (side >= stage->side_count) return;
    if (stage->handles.tool == VIEWER_PINS) draw_brush(stage, side, strokes);
    if (stage->handles.tool == VIEWER_CUTS) draw_knife(stage, side, strokes);
    if (!gizmo_of(stage, side, &gizmo, &spot)) return;
    viewer_sight sight = sight_of(stage, side);
    draw_outline(stage, side, &gizmo, &spot, strokes);
    viewer_gizmo_draw(&gizmo, &sight, strokes);
}

bool viewer_handles_part(const viewer_stage *stage, size_t side, int part, char name[64], double at[2]) {
    viewer_gizmo gizmo;
    viewer_spot spot;
    if (part >= GIZMO_PARTS) return false;
    name[0] = 0;
    if (!gizmo_of(stage, side, &gizmo, &spot)) return true;
    viewer_sight sight = sight_of(stage, side);
    if (viewer_gizmo_place(&gizmo, &sight, part, at))
        snprintf(name, 64, "%shandle %s %s", side ? "other " : "", words_of_tool[gizmo.tool], viewer_gizmo_part(part));
    return true;
}

/* ---- Held ---- */

static void drop(viewer_handles *h) {
    h->holds = h->moved = false;
    h->words[0] = 0;
    free(h->places);
    h->places = NULL;
    h->count = h->before_count = 0;
}

void viewer_handles_release_memory(viewer_handles *handles) {
    drop(handles);
    viewer_brush_forget(&handles->brush);
}

void viewer_handles_anew(viewer_stage *stage, bool another_scene) {
    viewer_handles *h = &stage->handles;
    viewer_spot spot;
    drop(h);
    viewer_brush_forget(&h->brush);
    h->knife.cuts = false;
    if (another_scene) h->tool = VIEWER_NO_TOOL, h->chosen = false;
    else if (h->chosen && h->tool < VIEWER_PINS && !has_spot(stage, h->category, h->index, &spot))
        h->tool = VIEWER_NO_TOOL, h->chosen = false;
    h->hot = GIZMO_NOTHING;
}

bool viewer_handles_busy(const viewer_stage *stage) {
    return stage->handles.holds || stage->handles.brush.paints || stage->handles.knife.cuts;
}

bool viewer_handles_wait(const viewer_stage *stage) {
    return stage->handles.places != NULL || stage->handles.brush.paints;
}

bool viewer_handles_press(viewer_stage *stage, const viewer_request *r) {
    viewer_handles *h = &stage->handles;
    double inside;
    if (r->code != GLFW_MOUSE_BUTTON_LEFT || h->tool == VIEWER_NO_TOOL || !stage->side_count) return false;
    if (h->tool == VIEWER_PINS) return !stage->camera.flying && viewer_brush_begin(stage, !(r->mods & GLFW_MOD_SHIFT));
    if (h->tool == VIEWER_CUTS) {
        if (stage->camera.flying || r->mods & GLFW_MOD_SHIFT) return false;
        viewer_knife_begin(stage);
        return true;
    }
    size_t side = viewer_side_at(stage, r->x, &inside);
    if (!gizmo_of(stage, side, &h->gizmo, &h->spot)) return false;
    viewer_sight sight = sight_of(stage, side);
    int part = viewer_gizmo_pick(&h->gizmo, &sight, r->x, r->y);
    if (part == GIZMO_NOTHING) return false;
    drop(h);
    h->holds = true;
    h->steps = r->mods & GLFW_MOD_CONTROL;
    h->side = side, h->part = part;
    h->from[0] = r->x, h->from[1] = r->y;
    for (int k = 0; k < 3; k++) h->by[k] = h->tool == VIEWER_SIZES ? 1 : 0;
    viewer_event(stage->events, "takes %shandle %s %s", side ? "other " : "", words_of_tool[h->tool],
                 viewer_gizmo_part(part));
    stage->dirty = true;
    return true;
}

/* Whether it follows in place. */
static bool follows_live(const viewer_handles *h) {
    return h->spot.live[h->tool - VIEWER_MOVES];
}

static size_t changes_of(const viewer_stage *stage, viewer_spot_change changes[2]) {
    const viewer_handles *h = &stage->handles;
    viewer_sight sight = sight_of(stage, h->side);
    return viewer_spot_apply(&h->spot, &h->gizmo, h->part, h->by, 0.5 * viewer_sight_metres(&sight, h->gizmo.origin),
                             changes);
}

/* What the fields are before a hand is on them, to the bit. */
static void keep_before(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    viewer_spot_change changes[2];
    size_t count = changes_of(stage, changes);
    for (size_t s = 0; s < stage->side_count; s++)
        for (size_t i = 0; i < count; i++) {
            viewer_handles_before *before = &h->before[h->before_count];
            const skein_world *world = stage->sides[s].world;
            *before = (viewer_handles_before){s, changes[i].field, {0, {0, 0, 0}, NULL}};
            if (!skein_get(world, skein_object_at(world, h->category, h->index), changes[i].field->name, &before->value))
                h->before_count++;
        }
}

/* The body goes back to its start, where it is built from, and its places are kept. */
static bool begin_to_move(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    skein_surface s;
    h->moved = true;
    if (follows_live(h)) {
        keep_before(stage);
        return true;
    }
    skein_world *world = stage->sides[h->side].world;
    bool running = stage->sides[0].frame > 0 || stage->sides[0].step > 0;
    if (running) viewer_stage_reset(stage);
    if (h->category != SKEIN_BODY) return true;
    if (skein_body_surface(world, skein_object_at(world, SKEIN_BODY, h->index), &s)) return false;
    h->first = s.first_particle, h->count = s.particle_count;
    h->places = malloc(3 * h->count * sizeof *h->places + 1);
    if (h->places && !skein_positions_copy(world, h->first, h->count, h->places)) return true;
    drop(h);
    return false;
}

/* By whole steps: a tenth of what an arm's length is rounded to, 15 degrees, a tenth of its size. */
static void take_steps(viewer_handles *h, double pixel) {
    double step = pow(10, round(log10(fmax(30 * pixel, 1e-9))));
    if (h->tool == VIEWER_TURNS) h->by[0] = 15 * round(h->by[0] / 15);
    else
        for (int k = 0; k < 3; k++)
            h->by[k] = h->tool == VIEWER_MOVES ? step * round(h->by[k] / step) : fmax(0.1 * round(10 * h->by[k]), 0.1);
}

static void describe(viewer_handles *h) {
    int axis = h->part % 3;
    const char *part = viewer_gizmo_part(h->part);
    if (h->tool == VIEWER_TURNS) snprintf(h->words, sizeof h->words, "%s %+.1f degrees", part, h->by[0]);
    else if (h->tool == VIEWER_SIZES)
        snprintf(h->words, sizeof h->words, "%s x %.3g", part, h->by[h->part == GIZMO_ALL ? 0 : axis]);
    else snprintf(h->words, sizeof h->words, "%+.3g %+.3g %+.3g m", h->by[0] + 0.0, h->by[1] + 0.0, h->by[2] + 0.0);
}

/* It is seen at once where it would come to. */
static void show_where(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    viewer_spot_change changes[2];
    if (follows_live(h)) {
        size_t count = changes_of(stage, changes);
        for (size_t i = 0; i < count; i++)
            viewer_stage_try(stage, h->category, h->index, changes[i].field, &changes[i].value);
    }
    double *moved = h->places ? malloc(3 * h->count * sizeof *moved + 1) : NULL;
    if (!moved) return;
    memcpy(moved, h->places, 3 * h->count * sizeof *moved);
    for (size_t i = 0; i < h->count; i++) viewer_spot_carry(&h->spot, &h->gizmo, h->part, h->by, moved + 3 * i);
    skein_positions_set(stage->sides[h->side].world, h->first, h->count, moved);
    free(moved);
}

void viewer_handles_drag(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    stage->dirty = true;
    if (h->brush.paints) {
        viewer_brush_go_on(stage);
        return;
    }
    if (h->knife.cuts) {
        viewer_knife_go_on(stage);
        return;
    }
    const double to[2] = {stage->x, stage->y};
    double by[3];
    viewer_sight sight = sight_of(stage, h->side);
    if (!h->moved && hypot(to[0] - h->from[0], to[1] - h->from[1]) < least_way) return;
    if (!viewer_gizmo_follow(&h->gizmo, &sight, h->part, h->from, to, by)) return;
    if (!h->moved && !begin_to_move(stage)) return;
    memcpy(h->by, by, sizeof by);
    if (h->steps) take_steps(h, viewer_sight_metres(&sight, h->gizmo.origin));
    describe(h);
    show_where(stage);
    viewer_event(stage->events, "holds %s", h->words);
}

/* As if it had never been moved. */
static void take_back(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    for (size_t i = 0; i < h->before_count; i++)
        skein_set(stage->sides[h->before[i].side].world,
                  skein_object_at(stage->sides[h->before[i].side].world, h->category, h->index),
                  h->before[i].field->name, h->before[i].value);
    if (h->places) skein_positions_set(stage->sides[h->side].world, h->first, h->count, h->places);
}

void viewer_handles_let_go(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    viewer_spot_change changes[2];
    if (h->brush.paints) {
        viewer_brush_end(stage);
        return;
    }
    if (h->knife.cuts) {
        viewer_knife_end(stage);
        return;
    }
    bool moved = h->moved, live = follows_live(h);
    size_t count = moved ? changes_of(stage, changes) : 0;
    char words[sizeof h->words], name[120], done[32];
    memcpy(words, h->words, sizeof words);
    snprintf(done, sizeof done, "%s", words_of_tool[h->tool]);
    skein_category category = h->category;
    size_t index = h->index;
    name_object(stage, name, sizeof name);
    if (moved) take_back(stage); // from there it is changed as by a field of the panel
    drop(h);
    bool good = count && viewer_stage_change_together(stage, category, index, changes, count, live);
    if (good) viewer_note(stage, "%s: %s %s", name, done, words);
    viewer_event(stage->events, "%s %s", good ? "handled" : "not handled", done);
    stage->facts = stage->dirty = true;
}

bool viewer_handles_escape(viewer_stage *stage) {
    viewer_handles *h = &stage->handles;
    if (h->holds) {
        take_back(stage);
        drop(h);
        viewer_note(stage, "it stays as it was");
    } else if (h->tool && !viewer_handles_busy(stage)) {
        put_away(stage);
    } else {
        return viewer_handles_busy(stage);
    }
    stage->dirty = true;
    return true;
}

/* ---- Over it ---- */

void viewer_handles_hover(viewer_stage *stage, bool over_picture) {
    viewer_handles *h = &stage->handles;
    viewer_gizmo gizmo;
    viewer_spot spot;
    double inside;
    int before = h->hot;
    size_t side = viewer_side_at(stage, stage->x, &inside), side_before = h->hot_side;
    h->hot = GIZMO_NOTHING, h->hot_side = side;
    if (h->tool >= VIEWER_PINS) stage->news = true; // the circle goes along
    if (over_picture && gizmo_of(stage, side, &gizmo, &spot)) {
        viewer_sight sight = sight_of(stage, side);
        h->hot = viewer_gizmo_pick(&gizmo, &sight, stage->x, stage->y);
    }
    stage->news |= h->hot != before || (h->hot != GIZMO_NOTHING && side != side_before);
}

bool viewer_handles_scroll(viewer_stage *stage, double clicks) {
    viewer_handles *h = &stage->handles;
    if (h->tool != VIEWER_PINS) return false;
    h->brush.radius = fmin(fmax(h->brush.radius * pow(1.15, clicks), least_brush), most_brush);
    viewer_event(stage->events, "brush %.4g", h->brush.radius);
    stage->news = true;
    return true;
}
