/* Painting pins; see brush.h. */
#include "viewer/brush.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "viewer/stage.h"

const skein_field *viewer_pins_field(const skein_world *world, size_t body) {
    const skein_kind *kind = skein_object_kind(world, skein_object_at(world, SKEIN_BODY, body));
    const skein_field *field = kind ? skein_field_find(kind, "pins", NULL) : NULL;
    return field && field->type == SKEIN_FIELD_TEXT ? field : NULL;
}

/* ---- Where it is ---- */

/* The place of a body that the pointer is on, and the particle nearest to it; of any body with SIZE_MAX, else of that. */
static bool find_place(const viewer_stage *stage, size_t side, double x, double y, size_t *body, double place[3],
                       uint32_t *particle) {
    const skein_world *world = stage->sides[side].world;
    const double *eye = stage->camera.lens.eye;
    double direction[3], t,
        slope = 2 * tan(0.5 * stage->camera.lens.fov * 0.017453292519943295) / fmax(stage->height, 1);
    skein_hit hit;
    viewer_ray_at(stage, side, x, y, direction);
    bool on_face = !skein_ray_cast(world, eye, direction, SKEIN_BODY, &hit) && hit.t < INFINITY;
    if (on_face) *particle = hit.particle, memcpy(place, hit.point, sizeof hit.point);
    else if (skein_particle_near_ray(world, eye, direction, stage->sides[side].view.particle_radius,
                                     slope * stage->handles.brush.radius, particle, &t) ||
             !(t < INFINITY) || skein_positions_copy(world, *particle, 1, place))
        return false;
    for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) {
        skein_surface s;
        if (skein_body_surface(world, skein_object_at(world, SKEIN_BODY, b), &s)) continue;
        if (*particle < s.first_particle || *particle - s.first_particle >= s.particle_count) continue;
        if (*body != SIZE_MAX && *body != b) return false;
        *body = b;
        return true;
    }
    return false;
}

/* ---- A stroke ---- */

static void paint(viewer_stage *stage, size_t i) {
    viewer_brush *brush = &stage->handles.brush;
    if (i >= brush->count || (brush->held[i] != 0) == brush->pins) return;
    brush->held[i] = brush->pins;
    brush->changed++;
    skein_particle_pin(stage->sides[brush->side].world, brush->first + i, brush->pins);
}

/* All that lie in the ball around a place of the picture. */
static void dab(viewer_stage *stage, double x, double y) {
    viewer_brush *brush = &stage->handles.brush;
    const skein_world *world = stage->sides[brush->side].world;
    double place[3], right[3], up[3], back[3], depth = 0;
    uint32_t nearest;
    size_t body = brush->body;
    if (!find_place(stage, brush->side, x, y, &body, place, &nearest)) return;
    render_camera_axes(&stage->camera.lens, right, up, back);
    for (int k = 0; k < 3; k++) depth -= back[k] * (place[k] - stage->camera.lens.eye[k]);
    double radius =
        brush->radius * 2 * depth * tan(0.5 * stage->camera.lens.fov * 0.017453292519943295) / fmax(stage->height, 1);
    skein_view view = skein_position_view(world);
    for (size_t i = 0; i < brush->count; i++) {
        const skein_real *p = view.xyzw + 4 * (size_t)view.slot_of[brush->first + i];
        double square = 0;
        for (int k = 0; k < 3; k++) square += ((double)p[k] - place[k]) * ((double)p[k] - place[k]);
        if (square <= radius * radius) paint(stage, i);
    }
    if (nearest >= brush->first) paint(stage, nearest - brush->first); // of a coarse body at least one
    stage->dirty = true;
}

bool viewer_brush_begin(viewer_stage *stage, bool pins) {
    viewer_brush *brush = &stage->handles.brush;
    double place[3], inside;
    uint32_t particle;
    skein_surface s;
    size_t body = SIZE_MAX, side = viewer_side_at(stage, stage->x, &inside);
    if (!find_place(stage, side, stage->x, stage->y, &body, place, &particle)) return false;
    const viewer_player *player = &stage->sides[side];
    if (!viewer_pins_field(player->world, body)) {
        viewer_note(stage, "body %zu has no pins: nothing holds its particles", body);
        return false;
    }
    if (skein_body_surface(player->world, skein_object_at(player->world, SKEIN_BODY, body), &s)) return false;
    unsigned char *held = malloc(s.particle_count + 1);
    if (!held) return false;
    // what is held by a click or by the hand for a while is not the scene's
    memcpy(held, player->pins + s.first_particle, s.particle_count);
    free(brush->held);
    brush->held = held;
    brush->first = s.first_particle, brush->count = s.particle_count, brush->changed = 0;
    brush->paints = true, brush->pins = pins;
    brush->side = side, brush->body = body;
    brush->last[0] = stage->x, brush->last[1] = stage->y;
    dab(stage, stage->x, stage->y);
    return true;
}

/* From where it was to where it is, without gaps. */
void viewer_brush_go_on(viewer_stage *stage) {
    enum { MOST_DABS = 24 };
    viewer_brush *brush = &stage->handles.brush;
    double way[2] = {stage->x - brush->last[0], stage->y - brush->last[1]};
    int dabs = (int)fmin(ceil(hypot(way[0], way[1]) / fmax(0.6 * brush->radius, 2)), MOST_DABS);
    for (int i = 1; i <= dabs; i++) dab(stage, brush->last[0] + way[0] * i / dabs, brush->last[1] + way[1] * i / dabs);
    brush->last[0] = stage->x, brush->last[1] = stage->y;
}

void viewer_brush_forget(viewer_brush *brush) {
    free(brush->held);
    brush->held = NULL;
    brush->paints = false;
    brush->count = brush->changed = 0;
}

/* ---- Its pins as text ---- */

/* Which numbers `pins` means: vertices where each particle is one of the surface, else particles. */
static bool numbers_are_vertices(const skein_surface *s) {
    unsigned char *seen = calloc(s->particle_count + 1, 1);
    size_t count = 0;
    for (size_t v = 0; seen && v < s->vertex_count; v++) {
        size_t i = s->particle_of_vertex[v] - s->first_particle;
        if (i < s->particle_count && !seen[i]) seen[i] = 1, count++;
    }
    free(seen);
    return s->vertex_count && count == s->particle_count;
}

static void put_run(char *text, size_t size, size_t *length, size_t from, size_t to) {
    const char *gap = *length ? " " : "";
    if (to > from + 1) *length += (size_t)snprintf(text + *length, size - *length, "%s%zu..%zu", gap, from, to);
    else if (to > from) *length += (size_t)snprintf(text + *length, size - *length, "%s%zu %zu", gap, from, to);
    else *length += (size_t)snprintf(text + *length, size - *length, "%s%zu", gap, from);
}

/* "0 5 10..24": free it. A particle that several vertices share is named by the first. NULL when there is no memory. */
static char *text_of(const skein_surface *s, const unsigned char *held) {
    bool vertices = numbers_are_vertices(s);
    size_t numbers = vertices ? s->vertex_count : s->particle_count, size = 24 * (numbers + 2), length = 0;
    char *text = malloc(size);
    unsigned char *named = calloc(s->particle_count + 1, 1);
    for (size_t n = 0, from = SIZE_MAX; text && named && n <= numbers; n++) {
        size_t i = n == numbers ? SIZE_MAX : vertices ? s->particle_of_vertex[n] - s->first_particle : n;
        bool in = i < s->particle_count && held[i] && !named[i];
        if (in) named[i] = 1;
        if (in && from == SIZE_MAX) from = n;
        if (in || from == SIZE_MAX) continue;
        put_run(text, size, &length, from, n - 1);
        from = SIZE_MAX;
    }
    if (text) text[length] = 0;
    free(named);
    return text;
}

void viewer_brush_end(viewer_stage *stage) {
    viewer_brush *brush = &stage->handles.brush;
    skein_surface s;
    const skein_world *world = stage->sides[brush->side].world;
    size_t changed = brush->changed, now = 0;
    if (!brush->paints) return;
    brush->paints = false;
    for (size_t i = 0; i < brush->count; i++) now += brush->held[i] != 0;
    bool good = changed && !skein_body_surface(world, skein_object_at(world, SKEIN_BODY, brush->body), &s);
    char *text = good ? text_of(&s, brush->held) : NULL, *set = text ? malloc(strlen(text) + 80) : NULL;
    if (set) {
        sprintf(set, "bodies.%zu.pins=\"%s\"", brush->body, text);
        bool pins = brush->pins;
        good = viewer_stage_build_on(stage, set);
        if (good) viewer_note(stage, "%s %zu of its particles: %zu are held", pins ? "pinned" : "freed", changed, now);
    }
    viewer_event(stage->events, "painted %zu held %zu", changed, now);
    viewer_brush_forget(brush);
    free(set);
    free(text);
}

/* ---- When numbers mean nothing any more ---- */

static bool is_pins_of(const char *set, size_t body) {
    char begin[40];
    snprintf(begin, sizeof begin, "bodies.%zu.pins=", body);
    return !strncmp(set, begin, strlen(begin));
}

static size_t numbers_of(const skein_world *world, size_t body) {
    skein_surface s;
    if (skein_body_surface(world, skein_object_at(world, SKEIN_BODY, body), &s)) return 0;
    return s.vertex_count > s.particle_count ? s.vertex_count : s.particle_count;
}

bool viewer_pins_lose_meaning(viewer_stage *stage, const char *set, char *out, size_t size) {
    const viewer_changes *changes = &stage->sides[0].changes;
    unsigned long body = 0;
    bool painted = false, lost = false;
    if (sscanf(set, "bodies.%lu.", &body) != 1 || is_pins_of(set, body)) return false;
    const char **sets = malloc((changes->done + 2) * sizeof *sets);
    size_t count = 0;
    for (size_t i = 0; sets && i < changes->done; i++) {
        if (is_pins_of(changes->data[i].set, body)) painted = true;
        else sets[count++] = changes->data[i].set;
    }
    if (painted && sets) {
        sets[count++] = set, sets[count] = NULL;
        viewer_reading reading = viewer_stage_reading(stage);
        io_faults quiet = {NULL, NULL, 0, NULL};
        io_scene *scene = io_scene_read(stage->sides[0].path, sets, reading.exporters, &quiet);
        skein_world *world = scene ? io_scene_build(scene, NULL, &quiet) : NULL;
        skein_value pins = {0, {0, 0, 0}, NULL};
        lost = world && numbers_of(world, body) != numbers_of(stage->sides[0].world, body) &&
               !skein_get(world, skein_object_at(world, SKEIN_BODY, body), "pins", &pins) && pins.text;
        const skein_field *field = lost ? viewer_pins_field(world, body) : NULL;
        char *json = field ? io_value_json(field, &pins) : NULL;
        lost = json && strlen(json) + 60 < size;
        if (lost) snprintf(out, size, "bodies.%lu.pins=%s", body, json);
        free(json);
        skein_world_destroy(world);
        io_scene_free(scene);
    }
    free(sets);
    return lost;
}
