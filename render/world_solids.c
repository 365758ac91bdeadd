/* Colliders and ropes of a picture; see world_solids.h. */
#include "render/world_solids.h"

#include "render/fail.h"
#include "render/linear.h"
#include "render/planes.h"

#include <stdlib.h>
#include <string.h>

/* A rope's radius, in radii of the scene; so many of its pieces have its colour, and then one is marked. */
static const double rope_size = 0.014;
enum { mark_every = 6 };
/* A box's round edges, in parts of half its shortest side. */
static const double roundness = 0.12;

void render_world_solids_release(render_world_solids *s) {
    free(s->planes);
    free(s->spheres);
    free(s->solids);
    free(s->rods);
    free(s->bowls);
    memset(s, 0, sizeof *s);
}

void render_world_solids_clear(render_world_solids *s) {
    s->plane_count = s->sphere_count = s->solid_count = s->bowl_count = s->rod_count = 0;
}

/* ---- Ropes ------------------------------------------------------------------------------------ */

/* A rod from `a` to `b`, turned so that its first axis goes along. */
static void lay_rod(render_solid *rod, const double a[3], const double b[3]) {
    double along[3], across[2][3];
    for (int k = 0; k < 3; k++) along[k] = 0.5 * (b[k] - a[k]), rod->centre[k] = 0.5 * (a[k] + b[k]);
    rod->extent[0] = sqrt(render_dot(along, along)), rod->extent[1] = rod->extent[2] = 0;
    render_normalise(along);
    render_basis(along, across[0], across[1]);
    for (int k = 0; k < 3; k++) {
        rod->rotation[3 * k] = along[k];
        rod->rotation[3 * k + 1] = across[0][k];
        rod->rotation[3 * k + 2] = across[1][k];
    }
}

static void paint_piece(render_solid *rod, const render_world_state *state, const render_view *view, size_t particle,
                        size_t number, size_t body) {
    render_material material = render_default_material(body);
    if (state->range > 0) {
        float ends[2][3];
        for (size_t k = 0; k < 2; k++) render_particle_colour(state, particle + k, ends[k]);
        for (int k = 0; k < 3; k++) rod->colour[k] = 0.5f * (ends[0][k] + ends[1][k]);
    } else if (view->colour == RENDER_BY_MATERIAL && number % mark_every == mark_every - 1) {
        memcpy(rod->colour, material.accent, sizeof rod->colour);
    } else {
        memcpy(rod->colour, material.colour, sizeof rod->colour);
    }
    memcpy(rod->marking, rod->colour, sizeof rod->marking);
}

bool render_add_rope(render_world_solids *s, const render_world_state *state, const skein_surface *rope, size_t index,
                     const render_view *view) {
    size_t pieces = rope->particle_count > 0 ? rope->particle_count - 1 : 0;
    if (s->rod_count + pieces > s->rod_room) {
        size_t room = 2 * (s->rod_count + pieces);
        render_solid *rods = realloc(s->rods, room * sizeof *rods);
        if (!rods) return false;
        s->rods = rods, s->rod_room = room;
    }
    for (size_t i = 0; i < pieces; i++) {
        size_t particle = rope->first_particle + i;
        render_solid *rod = &s->rods[s->rod_count++];
        rod->radius = 0;
        lay_rod(rod, &state->positions[3 * particle], &state->positions[3 * (particle + 1)]);
        paint_piece(rod, state, view, particle, i, index);
    }
    return true;
}

void render_world_solids_size(render_world_solids *s, const render_view *view, double radius) {
    double size = view->particle_radius > 0 ? view->particle_radius : rope_size * (radius > 0 ? radius : 1);
    for (size_t i = 0; i < s->rod_count; i++) s->rods[i].radius = size;
}

/* ---- Colliders -------------------------------------------------------------------------------- */

/* Of one collider: where it stands, and what it looks like. */
typedef struct collider {
    const skein_world *world;
    skein_handle handle;
    skein_pose pose;
    skein_shape shape;
} collider;

static void turn(const double rotation[9], const double v[3], double out[3]) {
    for (int r = 0; r < 3; r++) out[r] = render_dot(&rotation[3 * r], v);
}

/* A level plane is ground, and shown with it; others are colliders like spheres. */
static void add_plane(render_world_solids *s, const collider *c, const render_view *view) {
    render_plane *plane = &s->planes[s->plane_count];
    memcpy(plane->point, c->pose.position, sizeof plane->point);
    turn(c->pose.rotation, c->shape.axis, plane->normal);
    if (render_plane_level(plane) ? view->ground : view->colliders) s->plane_count++;
}

static void add_sphere(render_world_solids *s, const collider *c) {
    render_sphere *sphere = &s->spheres[s->sphere_count];
    *sphere = render_default_sphere();
    sphere->radius = c->shape.radius;
    memcpy(sphere->centre, c->pose.position, sizeof sphere->centre);
    memcpy(sphere->rotation, c->pose.rotation, sizeof sphere->rotation);
    s->sphere_count++;
}

static void add_bowl(render_world_solids *s, const collider *c) {
    render_bowl *bowl = &s->bowls[s->bowl_count];
    *bowl = render_default_bowl();
    bowl->radius = c->shape.radius;
    memcpy(bowl->centre, c->pose.position, sizeof bowl->centre);
    memcpy(bowl->rotation, c->pose.rotation, sizeof bowl->rotation);
    s->bowl_count++;
}

/* Its line goes from the middle both ways along its axis, turned. The rod's other axes turn with it. */
static void add_capsule(render_world_solids *s, const collider *c) {
    const double *axis = c->shape.axis, from[3] = {-axis[0], -axis[1], -axis[2]};
    double own[9];
    render_solid *rod = &s->solids[s->solid_count];
    *rod = render_default_solid();
    rod->radius = c->shape.radius;
    lay_rod(rod, from, axis);
    memcpy(own, rod->rotation, sizeof own);
    for (int k = 0; k < 3; k++) {
        const double side[3] = {own[k], own[3 + k], own[6 + k]};
        double turned[3];
        turn(c->pose.rotation, side, turned);
        for (int r = 0; r < 3; r++) rod->rotation[3 * r + k] = turned[r];
    }
    memcpy(rod->centre, c->pose.position, sizeof rod->centre);
    s->solid_count++;
}

static void add_box(render_world_solids *s, const collider *c) {
    const double *size = c->shape.size;
    render_solid *box = &s->solids[s->solid_count];
    *box = render_default_solid();
    box->radius = 0.5 * roundness * fmin(fmin(size[0], size[1]), size[2]);
    for (int k = 0; k < 3; k++) box->extent[k] = 0.5 * size[k] - box->radius;
    memcpy(box->centre, c->pose.position, sizeof box->centre);
    memcpy(box->rotation, c->pose.rotation, sizeof box->rotation);
    s->solid_count++;
}

static bool is_visible(const collider *c) {
    skein_value value;
    return skein_get(c->world, c->handle, "visible", &value) != SKEIN_OK || value.number[0] != 0;
}

/* Grows an array of `count` items; false where there is no memory. */
static bool grow(void *array, size_t count, size_t size) {
    void **pointer = array;
    void *grown = realloc(*pointer, count * size + 1);
    if (grown) *pointer = grown;
    return grown != NULL;
}

skein_status render_take_colliders(render_world_solids *s, const skein_world *world, const render_view *view,
                                   skein_error *error) {
    size_t count = skein_object_count(world, SKEIN_COLLIDER);
    if (!grow(&s->planes, count, sizeof *s->planes) || !grow(&s->spheres, count, sizeof *s->spheres) ||
        !grow(&s->solids, count, sizeof *s->solids) || !grow(&s->bowls, count, sizeof *s->bowls)) {
        return render_fail_memory(error, "the colliders");
    }
    for (size_t i = 0; i < count; i++) {
        collider c = {.world = world, .handle = skein_object_at(world, SKEIN_COLLIDER, i)};
        if (!is_visible(&c) || skein_collider_pose(world, c.handle, &c.pose) != SKEIN_OK ||
            skein_shape_of(world, c.handle, &c.shape) != SKEIN_OK)
            continue;
        if (c.shape.sort == SKEIN_SHAPE_PLANE) add_plane(s, &c, view);
        if (!view->colliders) continue;
        switch (c.shape.sort) {
        case SKEIN_SHAPE_BALL: add_sphere(s, &c); break;
        case SKEIN_SHAPE_BOWL: add_bowl(s, &c); break;
        case SKEIN_SHAPE_CAPSULE: add_capsule(s, &c); break;
        case SKEIN_SHAPE_BOX: add_box(s, &c); break;
        default: break; // what has no simpler shape is a mesh: world_implicit.c
        }
    }
    return SKEIN_OK;
}

/* ---- Both ------------------------------------------------------------------------------------- */

void render_world_solids_show(const render_world_solids *s, render_frame *frame) {
    frame->planes = s->planes, frame->plane_count = s->plane_count;
    frame->spheres = s->spheres, frame->sphere_count = s->sphere_count;
    frame->solids = s->solids, frame->solid_count = s->solid_count;
    frame->bowls = s->bowls, frame->bowl_count = s->bowl_count;
    frame->rods = s->rods, frame->rod_count = s->rod_count;
}
