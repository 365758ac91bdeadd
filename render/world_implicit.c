/* Meshes of colliders without a simpler shape: their own triangles; or of those that have a distance alone, a box for the net, its
 * sampling, and a key that says when it is old. */
#include "render/world_implicit.h"

#include "render/fail.h"
#include "render/net.h"
#include "render/planes.h"
#include "render/world_triangles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells along the longest side: to look for a surface with, to notice that it has changed with, to draw it with. */
enum { SEARCH_CELLS = 24, NOTICE_CELLS = 10, DRAWN_CELLS = 56 };
/* The box that a surface is looked for in is so many times as large as what else there is; and if it goes on beyond
 * that, and a larger box does not hold it either, it is terrain. */
static const double room_around = 2.2, search_growth = 3;
enum { SEARCHES = 3 };

struct render_implicit {
    skein_handle handle;
    bool used, made, terrain;
    bool open[6]; /* the surface leaves its box there: towards less and more x, y, z */
    render_bounds box, searched;
    uint64_t key; /* of what the mesh was made from */
    render_net net;
    float *uv;          /* of terrain: metres along x and z */
    bool has_triangles; /* it is drawn by them, and has no net */
    render_world_triangles triangles;
};

/* ---- Sampling --------------------------------------------------------------------------------- */

/* A grid of about `most` cells along the longest side of a box, with its values; NULL where there is no memory. */
static float *sample(const skein_world *world, skein_handle handle, const render_bounds *box, size_t most,
                     render_net_grid *grid) {
    double longest = 0;
    for (int k = 0; k < 3; k++) longest = fmax(longest, box->most[k] - box->least[k]);
    grid->cell = longest / (double)most;
    size_t count = 1, row = 0, points[3];
    for (int k = 0; k < 3; k++) {
        double side = box->most[k] - box->least[k];
        grid->cells[k] = (size_t)fmax(1, ceil(side / grid->cell - 1e-6));
        grid->least[k] = box->least[k] - 0.5 * ((double)grid->cells[k] * grid->cell - side);
        points[k] = grid->cells[k] + 1;
        count *= points[k];
    }
    row = points[0];
    float *values = malloc(count * sizeof *values);
    double *at = malloc(4 * row * sizeof *at), *distances = at ? at + 3 * row : NULL;
    grid->values = values;
    for (size_t r = 0; r < points[1] * points[2] && values && at; r++) {
        for (size_t i = 0; i < row; i++) {
            at[3 * i] = grid->least[0] + grid->cell * (double)i;
            at[3 * i + 1] = grid->least[1] + grid->cell * (double)(r % points[1]);
            at[3 * i + 2] = grid->least[2] + grid->cell * (double)(r / points[1]);
        }
        skein_collider_probe(world, handle, row, at, distances, NULL);
        for (size_t i = 0; i < row; i++) values[r * row + i] = (float)distances[i];
    }
    if (!at) free(values);
    free(at);
    return at ? values : NULL;
}

static uint64_t hash(uint64_t h, const void *data, size_t size) {
    const unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++) h = (h ^ bytes[i]) * 0x100000001b3u;
    return h;
}

/* Of all that the mesh depends on: the collider's fields, and some of the distances, which know of the time, too. */
static bool key_of(const skein_world *world, const render_implicit *it, uint64_t *key) {
    const skein_kind *kind = skein_object_kind(world, it->handle);
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t i = 0; kind && i < kind->field_count; i++) {
        skein_value value;
        if (skein_get(world, it->handle, kind->fields[i].name, &value) != SKEIN_OK) continue;
        h = value.text ? hash(h, value.text, strlen(value.text)) : hash(h, value.number, sizeof value.number);
    }
    render_net_grid grid;
    float *values = sample(world, it->handle, &it->box, NOTICE_CELLS, &grid);
    if (!values) return false;
    *key = hash(h, values, (grid.cells[0] + 1) * (grid.cells[1] + 1) * (grid.cells[2] + 1) * sizeof *values);
    free(values);
    return true;
}

/* ---- Where to look ------------------------------------------------------------------------------ */

/* The part of a box in which a surface is, and at which of its sides it leaves it. */
typedef struct found {
    render_bounds near;
    bool any, open[6];
} found;

static void look_at_cell(const render_net_grid *g, const size_t cell[3], found *f) {
    bool inside = false, outside = false;
    float least = INFINITY;
    for (int c = 0; c < 8; c++) {
        size_t x = cell[0] + (size_t)(c & 1), y = cell[1] + (size_t)(c >> 1 & 1), z = cell[2] + (size_t)(c >> 2);
        float value = g->values[(z * (g->cells[1] + 1) + y) * (g->cells[0] + 1) + x];
        inside |= value < 0, outside |= !(value < 0);
        least = fminf(least, fabsf(value));
    }
    bool cut = inside && outside;
    // small things may lie between the corners
    if (!cut && !((double)least < 0.9 * g->cell)) return;
    double middle[3];
    for (int k = 0; k < 3; k++) {
        middle[k] = g->least[k] + g->cell * ((double)cell[k] + 0.5);
        f->open[2 * k] |= cut && cell[k] == 0;
        f->open[2 * k + 1] |= cut && cell[k] + 1 == g->cells[k];
    }
    render_bounds_add(&f->near, middle, 0.5 * g->cell);
    f->any = true;
}

static bool look(const skein_world *world, skein_handle handle, const render_bounds *box, found *f) {
    render_net_grid grid;
    float *values = sample(world, handle, box, SEARCH_CELLS, &grid);
    *f = (found){.near = render_bounds_nothing()};
    if (!values) return false;
    size_t cell[3];
    for (cell[2] = 0; cell[2] < grid.cells[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < grid.cells[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < grid.cells[0]; cell[0]++) look_at_cell(&grid, cell, f);
    free(values);
    return true;
}

static bool is_open(const found *f) {
    bool open = false;
    for (int side = 0; side < 6; side++) open |= f->open[side];
    return open;
}

/* Draws a box in to what is near the surface, with a little room, where the surface does not leave it. */
static void draw_in(render_bounds *box, const found *f) {
    for (int k = 0; k < 3 && f->any; k++) {
        double room = 0.05 * (f->near.most[k] - f->near.least[k]);
        if (!f->open[2 * k]) box->least[k] = fmax(box->least[k], f->near.least[k] - room);
        if (!f->open[2 * k + 1]) box->most[k] = fmin(box->most[k], f->near.most[k] + room);
    }
}

/* The box in which a surface is looked for first: half a side of it, and its middle. */
static double begin_search(const skein_world *world, render_implicit *it, const render_bounds *things,
                           double middle[3]) {
    double size = room_around * render_bounds_radius(things);
    render_bounds_centre(things, middle);
    if (!(size > 0)) {
        skein_pose pose;
        if (skein_collider_pose(world, it->handle, &pose) == SKEIN_OK)
            memcpy(middle, pose.position, sizeof pose.position);
        size = 2;
    }
    it->searched = render_bounds_nothing();
    render_bounds_add(&it->searched, middle, size);
    return size;
}

/* Finds the box in which a surface is drawn. */
static bool find_box(const skein_world *world, render_implicit *it, const render_bounds *things) {
    double middle[3], size = begin_search(world, it, things, middle);
    found f = {.any = false};
    render_bounds box = it->searched;
    it->terrain = false;
    for (int search = 0; search < SEARCHES; search++, size *= search_growth) {
        box = render_bounds_nothing();
        render_bounds_add(&box, middle, size);
        if (!look(world, it->handle, &box, &f)) return false;
        if (f.any && !is_open(&f)) break;
    }
    if (!f.any || is_open(&f)) {
        box = it->searched;
        if (!look(world, it->handle, &box, &f)) return false;
        it->terrain = is_open(&f);
    }
    draw_in(&box, &f);
    // once more, for what is small in the box
    if (!look(world, it->handle, &box, &f)) return false;
    draw_in(&box, &f);
    memcpy(it->open, f.open, sizeof it->open);
    it->box = box;
    return true;
}

/* ---- Meshes --------------------------------------------------------------------------------------- */

/* Takes the net's vertices on to the surface: they are means of cuts, which lie inside of what is curved. */
static bool settle(const skein_world *world, render_implicit *it, double cell) {
    render_net *net = &it->net;
    double *distances = malloc((4 * net->vertex_count + 1) * sizeof *distances),
           *normals = distances + net->vertex_count;
    if (!distances) return false;
    skein_collider_probe(world, it->handle, net->vertex_count, net->positions, distances, normals);
    for (size_t v = 0; v < net->vertex_count; v++)
        for (size_t k = 0; k < 3 && fabs(distances[v]) < cell; k++)
            net->positions[3 * v + k] -= distances[v] * normals[3 * v + k];
    free(distances);
    return true;
}

/* Terrain has squares, as the ground has: so one sees how it lies. */
static bool lay_pattern(render_implicit *it) {
    float *uv = realloc(it->uv, (2 * it->net.vertex_count + 1) * sizeof *uv);
    if (!uv) return false;
    it->uv = uv;
    for (size_t v = 0; v < it->net.vertex_count; v++)
        for (size_t k = 0; k < 2; k++) uv[2 * v + k] = (float)it->net.positions[3 * v + 2 * k];
    return true;
}

static bool make_mesh(const skein_world *world, render_implicit *it, bool *leaves) {
    render_net_grid grid;
    float *values = sample(world, it->handle, &it->box, DRAWN_CELLS, &grid);
    if (!values) return false;
    bool good = render_net_make(&it->net, &grid);
    free(values);
    *leaves = false;
    for (size_t v = 0; v < it->net.vertex_count && good; v++)
        for (size_t k = 0; k < 3; k++) {
            double at = it->net.positions[3 * v + k] - grid.least[k], end = grid.cell * (double)grid.cells[k];
            *leaves |= (!it->open[2 * k] && at < grid.cell) || (!it->open[2 * k + 1] && at > end - grid.cell);
        }
    return good && settle(world, it, grid.cell) && lay_pattern(it);
}

static bool contains(const render_bounds *outer, const render_bounds *inner) {
    bool in = true;
    for (int k = 0; k < 3 && !render_bounds_empty(inner); k++)
        in &= outer->least[k] <= inner->least[k] && outer->most[k] >= inner->most[k];
    return in;
}

/* By its own triangles, it is drawn whole; and is terrain where the largest box that others are looked for in would not hold it. That
 * is found out as it begins, and when the rest has left its place: what goes by, or falls off it, makes no other picture of it. */
static void bring_triangles(const skein_world *world, render_implicit *it, const render_bounds *things) {
    if (it->made && contains(&it->searched, things)) return;
    double middle[3], size = begin_search(world, it, things, middle);
    render_bounds largest = render_bounds_nothing();
    render_bounds_add(&largest, middle, size * pow(search_growth, SEARCHES - 1));
    it->terrain = render_bounds_radius(things) > 0 && !contains(&largest, &it->triangles.box);
    it->made = true;
}

static bool bring(const skein_world *world, render_implicit *it, const render_bounds *things) {
    uint64_t key = 0;
    bool leaves = false;
    if (!render_take_triangles(&it->triangles, world, it->handle, &it->has_triangles)) return false;
    if (it->has_triangles) {
        bring_triangles(world, it, things);
        return true;
    }
    bool known = it->made && contains(&it->searched, things);
    if (!known && !find_box(world, it, things)) return false;
    if (!key_of(world, it, &key)) return false;
    if (known && key == it->key) return true;
    if (!make_mesh(world, it, &leaves)) return false;
    if (known && (leaves || !it->net.triangle_count)) { // it has moved or grown out of its box
        if (!find_box(world, it, things) || !key_of(world, it, &key) || !make_mesh(world, it, &leaves)) return false;
    }
    it->made = true;
    it->key = key;
    return true;
}

static void release(render_implicit *it) {
    render_net_release(&it->net);
    render_triangles_release(&it->triangles);
    free(it->uv);
}

static render_implicit *find(render_world_implicit *all, skein_handle handle) {
    for (size_t i = 0; i < all->count; i++)
        if (all->data[i].handle.index == handle.index && all->data[i].handle.generation == handle.generation)
            return &all->data[i];
    if (all->count == all->room) {
        size_t room = 2 * all->room + 4;
        render_implicit *data = realloc(all->data, room * sizeof *data);
        if (!data) return NULL;
        all->data = data, all->room = room;
    }
    all->data[all->count] = (render_implicit){.handle = handle};
    return &all->data[all->count++];
}

static void drop_unused(render_world_implicit *all) {
    size_t kept = 0;
    for (size_t i = 0; i < all->count; i++) {
        if (all->data[i].used) all->data[kept++] = all->data[i];
        else release(&all->data[i]);
    }
    all->count = kept;
}

skein_status render_take_implicit(render_world_implicit *all, const skein_world *world, const render_bounds *things,
                                  skein_error *error) {
    for (size_t i = 0; i < all->count; i++) all->data[i].used = false;
    for (size_t i = 0; i < skein_object_count(world, SKEIN_COLLIDER); i++) {
        skein_handle handle = skein_object_at(world, SKEIN_COLLIDER, i);
        skein_shape shape;
        skein_value visible;
        if (skein_shape_of(world, handle, &shape) != SKEIN_OK || shape.sort != SKEIN_SHAPE_SURFACE) continue;
        if (skein_get(world, handle, "visible", &visible) == SKEIN_OK && visible.number[0] == 0) continue;
        render_implicit *it = find(all, handle);
        if (it) it->used = true;
        if (!it || !bring(world, it, things)) return render_fail_memory(error, "a collider's surface");
    }
    drop_unused(all);
    return SKEIN_OK;
}

/* Things are painted as other colliders are, terrain is as the ground. */
static void paint(render_material *material, const render_implicit *it) {
    render_solid solid = render_default_solid();
    render_look look = render_default_look();
    double side = render_grid_cell(render_bounds_radius(&it->searched) / room_around);
    for (int k = 0; k < 3; k++) {
        material->colour[k] = material->lining[k] = it->terrain ? look.ground[k] : solid.colour[k];
        material->accent[k] = 0.94f * material->colour[k];
    }
    material->pattern = it->terrain ? RENDER_CHECKER : RENDER_PLAIN;
    material->repeats[0] = material->repeats[1] = (float)(0.5 / side);
}

size_t render_show_implicit(const render_world_implicit *all, render_surface *surfaces) {
    size_t count = 0;
    for (size_t i = 0; i < all->count; i++) {
        const render_implicit *it = &all->data[i];
        if (!it->has_triangles && !it->net.triangle_count) continue;
        render_surface *surface = &surfaces[count++];
        if (it->has_triangles) {
            render_show_triangles(&it->triangles, surface);
        } else {
            *surface = (render_surface){.positions = it->net.positions,
                                        .vertex_count = it->net.vertex_count,
                                        .triangles = it->net.triangles,
                                        .triangle_count = it->net.triangle_count};
            if (it->terrain) surface->uv = it->uv;
        }
        surface->scenery = it->terrain;
        paint(&surface->material, it);
    }
    return count;
}

void render_world_implicit_release(render_world_implicit *all) {
    for (size_t i = 0; i < all->count; i++) release(&all->data[i]);
    free(all->data);
    memset(all, 0, sizeof *all);
}
