/* Lines and arrows of constraints; see world_constraints.h. */
#include "render/world_constraints.h"

#include <math.h>

#include "render/fail.h"

enum { MOST_PARTICLES = 8 };

/* An arrow of the strongest gradients, in radii of the scene, at most. */
static const double arrow_size = 0.4;
static const float ink[3] = {0.20f, 0.19f, 0.24f}, amber[3] = {0.75f, 0.42f, 0.02f}, crimson[3] = {0.78f, 0.07f, 0.13f};

/* A constraint's own part of a picture. */
typedef struct looked {
    skein_constraint_value value;
    uint32_t particle[MOST_PARTICLES];
    double gradient[MOST_PARTICLES][3];
    size_t count; /* of particles that fit */
} looked;

static bool look(skein_world *world, skein_handle object, size_t index, looked *out) {
    if (skein_constraint_evaluate(world, object, index, &out->value, out->particle, &out->gradient[0][0],
                                  MOST_PARTICLES))
        return false;
    out->count = out->value.particle_count < MOST_PARTICLES ? out->value.particle_count : MOST_PARTICLES;
    return true;
}

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double strongest_of(const looked *l) {
    double strongest = 0;
    for (size_t i = 0; i < l->count; i++)
        if (isfinite(length_of(l->gradient[i]))) strongest = fmax(strongest, length_of(l->gradient[i]));
    return strongest;
}

/* Through its particles in their order. A closed surface has its own picture. */
static void add_line(render_world_lines *lines, const render_world_state *state, const looked *l,
                     const float colour[3]) {
    for (size_t i = 1; i < l->count && l->value.particle_count <= MOST_PARTICLES; i++)
        if (state->shown[l->particle[i]] != RENDER_HIDDEN)
            render_add_line(lines, RENDER_CONSTRAINTS, &state->positions[3 * (size_t)l->particle[i - 1]],
                            &state->positions[3 * (size_t)l->particle[i]], colour);
}

static void add_arrows(render_world_lines *lines, const render_world_state *state, const looked *l, double scale,
                       double off) {
    for (size_t i = 0; i < l->count; i++) {
        double length = length_of(l->gradient[i]), from[3], along[3];
        if (!(length > 0) || state->shown[l->particle[i]] == RENDER_HIDDEN) continue;
        for (int k = 0; k < 3; k++) {
            along[k] = scale * l->gradient[i][k];
            from[k] = state->positions[3 * (size_t)l->particle[i] + (size_t)k] + off / length * l->gradient[i][k];
        }
        render_add_arrow(lines, RENDER_GRADIENTS, from, along, crimson);
    }
}

/* The length of an arrow for a gradient of 1: by powers of two, so that a gradient that shrinks from solve to solve is
 * seen to shrink. */
static double scale_of(const render_view *view, double strongest, double radius) {
    if (view->gradient_scale > 0) return view->gradient_scale;
    return strongest > 0 ? arrow_size * radius / exp2(ceil(log2(strongest))) : 0;
}

typedef void visitor(void *user, const looked *l);

static skein_status visit(skein_world *world, visitor *see, void *user) {
    for (size_t o = 0; o < skein_object_count(world, SKEIN_CONSTRAINT); o++) {
        skein_handle object = skein_object_at(world, SKEIN_CONSTRAINT, o);
        size_t count = 0;
        skein_value enabled;
        if (skein_get(world, object, "enabled", &enabled) || enabled.number[0] == 0) continue;
        if (skein_constraint_count(world, object, &count)) return SKEIN_ERROR_MEMORY;
        for (size_t i = 0; i < count; i++) {
            looked l;
            if (!look(world, object, i, &l)) return SKEIN_ERROR_MEMORY;
            see(user, &l);
        }
    }
    return SKEIN_OK;
}

typedef struct drawing {
    render_world_lines *lines;
    const render_world_state *state;
    const render_view *view;
    double strongest, scale, off;
} drawing;

static void find_strongest(void *user, const looked *l) {
    drawing *d = user;
    d->strongest = fmax(d->strongest, strongest_of(l));
}

static void draw(void *user, const looked *l) {
    const drawing *d = user;
    if (d->view->constraints) add_line(d->lines, d->state, l, ink);
    if (d->view->gradients) add_arrows(d->lines, d->state, l, d->scale, d->off);
}

skein_status render_take_constraints(render_world_lines *lines, const render_world_state *state, skein_world *world,
                                     const render_view *view, const render_chosen *chosen, double radius, double off,
                                     skein_error *error) {
    drawing d = {.lines = lines, .state = state, .view = view, .off = off};
    looked l;
    skein_status status = SKEIN_OK;
    bool any = chosen && chosen->any && look(world, chosen->object, chosen->index, &l);
    if (any) find_strongest(&d, &l);
    if (view->gradients) status = visit(world, find_strongest, &d);
    d.scale = scale_of(view, d.strongest, radius);
    if (!status && (view->constraints || view->gradients)) status = visit(world, draw, &d);
    if (any) add_line(lines, state, &l, amber);
    if (any && !view->gradients) add_arrows(lines, state, &l, d.scale, off);
    return status ? render_fail(error, status, "", "the constraints cannot be read") : SKEIN_OK;
}
