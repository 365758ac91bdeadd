/* More substeps where surfaces come near each other fast, or pins are led fast past what hangs from them.
 *
 * A bound lets nothing pass that comes by several thicknesses in a substep, but stops it corner by corner, while springs pull on what
 * goes on, and these are asked once a substep. So substeps are to be so short that nobody comes far in one:
 *   bodies   that come near each other, by half a thickness. Of 60 that were thrown at 3 to 20 m/s (sheets of 30 x 30 and 41 x 41, half of them
 *            irregular, on the upper edge of one that is pinned; a jelly at a hung sheet; sheets on a jelly) 30 had edges of more than
 *            twice their length in substeps of a 600th of a second, and two have; frames took 11.2 ms in the mean, and take 11.1, for what
 *            comes slowly is near fewer. By a whole thickness: nine; by a third: two, and worst frames a fifth longer. In five substeps 47, and eight.
 *            The same with colliders, but planes, for what falls flat is stopped as a whole: of 40 sheets that were thrown at balls and boxes 13 were
 *            torn, and none is; of 20 hung ones at which balls were thrown 12, and six.
 *   pins     past the free particles of their body, in the mean, by two. Of 48 sheets of 25 x 25 to 41 x 41, grids and irregular ones, that
 *            were led by their middles on circles of 0.3 and 0.5 m at 8 and 10 m/s, 33 had edges of 2 to 20 times their length, and 20 had
 *            crossings. Now none has, the worst is stretched by 94 % for a moment, and frames take 31 ms in the mean instead of 55. (Pairs
 *            that were pushed before they were near left 19 of them so, and heaps took longer at their impacts.)
 * What flies along with its pins has nothing to fear, and what a moving frame carries is left to that (world/frames.c). A sheet that meets
 * but itself has as many as ever: asked by how its velocities spread, it had no fewer crossings, nor less stretch.
 *
 * Substeps become shorter by a fifth from step to step at most (world/step.c), so bodies are looked for some steps ahead, and have what
 * leads to enough of them when they meet. It all follows from where pins are led in this step and from the state alone, which knows how long the last
 * substep was. */
#include <math.h>
#include <stdlib.h>

#include "world/nearness.h"

/* Thicknesses in a substep: that a pin may be led by, and that bodies may come nearer. */
static const double led = 2, nearer = 0.5;
/* By what share a substep may be shorter from one step to the next, and for how many steps bodies are expected. */
static const double shorter = 0.8, soon = 12;
/* With fewer than this share of those that there are, they become fewer: else a plan would be written anew in each step. */
static const double kept = 0.6;

/* A body as others come near it, and as its pins go past it. */
typedef struct comer {
    const sk_object *object;
    double thickness;     /* m, its own; 0: the rule's */
    real low[3], high[3]; /* m: around all of it, now, */
    double first, last;   /* and along x, until `soon` */
    double free[3];       /* m/s: its free particles, in the mean, or 0 where there are none; */
    double all[3];        /* all of it, where a pin goes as it is led; */
    double past;          /* and how fast a pin goes past the free ones, at most */
} comer;

static bool is_contact(const sk_object *object) {
    return object->category == SKEIN_FORCE && object->common.plain.enabled && object->as.force->type->meeting;
}

static bool acts_on(const sk_object *rule, const sk_object *body) {
    const char *on = rule->common.plain.on;
    return !on[0] || sk_names_mean(on, body->common.plain.name, body->common.plain.groups);
}

/* Whether a moving frame takes a body's free particles along. */
static bool is_carried(const skein_world *world, const sk_common *body) {
    for (size_t i = 0; i < world->motions.count; i++) {
        const sk_motion_common *common = world->motions.data[i]->common;
        const bool its = !common->on[0] || sk_names_mean(common->on, body->name, body->groups);
        if (its && common->enabled && common->inertia < 1) return true;
    }
    return false;
}

/* Whether a body has surfaces or rods, and is there, and no frame goes with it. */
static bool may_come(const skein_world *world, const sk_object *object) {
    if (object->category != SKEIN_BODY || !object->as.body->enabled || !object->as.body->particle_count) return false;
    const bool has_features = object->as.body->triangle_count || object->body_type->shape == SKEIN_SHAPE_CHAIN;
    return has_features && !is_carried(world, &object->common.plain);
}

static void look_at_particles(const sk_particles *all, const sk_body *body, comer *c) {
    size_t free = 0;
    sk_box_begin(c->low, c->high);
    sk_box_widen(all, body, 0, c->low, c->high);
    for (size_t p = body->first_particle; p < body->first_particle + body->particle_count; p++) {
        const sk_vec4 v = all->vector[SK_V][all->slot_of[p]];
        if (all->pinned[p] || !(sk_dot(sk_xyz(v), sk_xyz(v)) < (real)1e12)) continue; // or blown up
        c->free[0] += (double)v.x, c->free[1] += (double)v.y, c->free[2] += (double)v.z;
        free++;
    }
    for (int k = 0; k < 3; k++) {
        c->all[k] = c->free[k] / (double)body->particle_count;
        c->free[k] /= (double)(free ? free : 1);
    }
}

static void look_at_pins(const skein_world *world, const sk_body *body, double dt, comer *c) {
    const sk_particles *all = &world->particles;
    for (size_t i = 0; i < world->led.count; i++) {
        const sk_pin *pin = &world->led.data[i];
        if (pin->particle - body->first_particle >= body->particle_count) continue;
        if (!all->pinned[pin->particle] || !sk_particle_is_here(all, pin->particle)) continue;
        const sk_vec4 x = all->vector[SK_X][all->slot_of[pin->particle]];
        const double at[3] = {(double)x.x, (double)x.y, (double)x.z};
        double square = 0;
        for (int k = 0; k < 3; k++) {
            const double v = (pin->place[k] - at[k]) / dt;
            c->all[k] += v / (double)body->particle_count;
            square += (v - c->free[k]) * (v - c->free[k]);
        }
        c->past = fmax(c->past, sqrt(square));
    }
}

static comer comer_of(const skein_world *world, const sk_object *object, double dt) {
    const sk_body *body = object->as.body;
    comer c = {.object = object, .thickness = sk_object_number(object, "contact.thickness")};
    look_at_particles(&world->particles, body, &c);
    look_at_pins(world, body, dt, &c);
    c.first = (double)c.low[0] + fmin(0, soon * dt * c.all[0]);
    c.last = (double)c.high[0] + fmax(0, soon * dt * c.all[0]);
    return c;
}

static double thickness_of(const comer *c, const sk_object *rule) {
    return c->thickness > 0 ? c->thickness : sk_object_number(rule, "thickness");
}

/* When the boxes of two will be as near as that, s; INFINITY: never, if both go on as they do. */
static double time_until(const comer *a, const comer *b, double near) {
    double begin = 0, end = INFINITY;
    for (int k = 0; k < 3; k++) {
        const double speed = b->all[k] - a->all[k];
        const double least = (double)a->low[k] - near - (double)b->high[k],
                     most = (double)a->high[k] + near - (double)b->low[k];
        if (speed == 0 && (least > 0 || most < 0)) return INFINITY;
        if (speed == 0) continue;
        begin = fmax(begin, fmin(least / speed, most / speed));
        end = fmin(end, fmax(least / speed, most / speed));
    }
    return begin <= end ? begin : INFINITY;
}

/* How many substeps a rule wants in a step of dt where two come near each other at their velocities; 0: no more than usual. */
static double wanted_at(const sk_object *rule, const double a[3], const double b[3], double thickness, double usual,
                        double dt) {
    const double v[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    const double wanted = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * dt / (nearer * thickness);
    return wanted > usual ? fmin(wanted, usual * sk_object_number(rule, "more_substeps")) : 0;
}

/* How many there have to be now, so that there are enough so many steps ahead. */
static double wanted_before(double wanted, double steps) {
    while (steps-- > 0) wanted *= shorter;
    return wanted;
}

/* How many it wants for two bodies. */
static double wanted_by_two(const sk_object *rule, const comer *a, const comer *b, double usual, double dt) {
    const double thick[2] = {thickness_of(a, rule), thickness_of(b, rule)};
    const double wanted = wanted_at(rule, a->all, b->all, fmax(thick[0], thick[1]), usual, dt);
    if (!(wanted > 0)) return 0;
    const double steps = floor(time_until(a, b, thick[0] + thick[1]) / dt);
    if (!(steps < soon)) return 0;
    const sk_common *one = &a->object->common.plain, *other = &b->object->common.plain;
    const sk_force *force = rule->as.force;
    if (sk_pairs_mean(force->type->meeting->ignored(force->params), one->name, one->groups, other->name, other->groups))
        return 0;
    return wanted_before(wanted, steps);
}

/* Whether a collider may stop but a part of a body: what falls flat on the ground is stopped as a whole. Formulas do not tell how far they are. */
static bool may_be_met(const sk_object *object) {
    if (object->category != SKEIN_COLLIDER || !object->as.collider->common->enabled) return false;
    const sk_collider *collider = object->as.collider;
    skein_shape shape = {.sort = SKEIN_SHAPE_SURFACE};
    if (collider->type->shape) collider->type->shape(collider->params, &shape);
    return shape.sort != SKEIN_SHAPE_PLANE && !(collider->type->making && !collider->type->take);
}

/* How many it wants for a body that nears a collider at these poses, now and when the step is over: this goes to where the body is, as both go
 * now. */
static double wanted_by_collider(const skein_world *world, const sk_object *rule, const sk_collider *collider,
                                 const sk_pose pose[2], const comer *c, double usual, double dt) {
    const sk_vec3 way = sk_sub(pose[1].position, pose[0].position);
    const double goes[3] = {(double)way.x / dt, (double)way.y / dt, (double)way.z / dt},
                 thickness = thickness_of(c, rule);
    const double wanted = wanted_at(rule, c->all, goes, thickness, usual, dt);
    if (!(wanted > 0)) return 0;
    const sk_vec3 past = sk_sub(way, (sk_vec3){(real)(dt * c->all[0]), (real)(dt * c->all[1]), (real)(dt * c->all[2])});
    const double clear = (double)sk_length(past) + thickness + collider->common->thickness;
    sk_pose at = pose[0];
    for (double steps = 0; steps < soon && wanted_before(wanted, steps) > usual;
         steps++, at.position = sk_add(at.position, past))
        if (!sk_collider_is_far(world, collider, &at, c->low, c->high, clear) &&
            !(sk_collider_distance(world, collider, &at, c->object->as.body) > clear))
            return wanted_before(wanted, steps);
    return 0;
}

static double wanted_by_colliders(const skein_world *world, const sk_object *rule, const comer *body, size_t count,
                                  double usual, double dt) {
    double wanted = 0;
    for (size_t i = 0; i < world->objects.count; i++) {
        if (!may_be_met(world->objects.data[i])) continue;
        const sk_collider *collider = world->objects.data[i]->as.collider;
        const char *on = collider->common->on;
        sk_pose pose[2];
        sk_collider_find_poses(world, collider, dt, pose);
        for (size_t b = 0; b < count; b++) {
            const sk_common *common = &body[b].object->common.plain;
            if (!acts_on(rule, body[b].object) || (on[0] && !sk_names_mean(on, common->name, common->groups))) continue;
            wanted = fmax(wanted, wanted_by_collider(world, rule, collider, pose, &body[b], usual, dt));
        }
    }
    return wanted;
}

static int compare_first(const void *a, const void *b) {
    const comer *one = a, *other = b;
    return (one->first > other->first) - (one->first < other->first);
}

/* How many substeps a rule wants for the bodies that it acts on, sorted by where they begin. */
static double wanted_by(const skein_world *world, const sk_object *rule, const comer *body, size_t count, double usual,
                        double dt) {
    double wanted = wanted_by_colliders(world, rule, body, count, usual, dt), thickest = 0;
    for (size_t i = 0; i < count; i++) thickest = fmax(thickest, thickness_of(&body[i], rule));
    for (size_t a = 0; a < count; a++) {
        if (!acts_on(rule, body[a].object)) continue;
        const double by_pins = body[a].past * dt / (led * thickness_of(&body[a], rule));
        wanted = fmax(wanted, fmin(by_pins, usual * sk_object_number(rule, "more_substeps")));
        for (size_t b = a + 1; b < count && body[b].first <= body[a].last + 2 * thickest; b++)
            if (acts_on(rule, body[b].object))
                wanted = fmax(wanted, wanted_by_two(rule, &body[a], &body[b], usual, dt));
    }
    return wanted;
}

/* How many all rules want; body: room for all bodies. */
static double wanted_by_all(const skein_world *world, comer *body, double usual, double dt) {
    size_t bodies = 0, colliders = 0, count = 0;
    for (size_t i = 0; i < world->objects.count; i++) {
        bodies += may_come(world, world->objects.data[i]);
        colliders += may_be_met(world->objects.data[i]);
    }
    if (bodies < 2 && !colliders && !world->led.count) return 0; // nobody comes
    for (size_t i = 0; i < world->objects.count; i++)
        if (may_come(world, world->objects.data[i])) body[count++] = comer_of(world, world->objects.data[i], dt);
    if (count) qsort(body, count, sizeof *body, compare_first);
    double wanted = 0;
    for (size_t i = 0; i < world->objects.count; i++)
        if (is_contact(world->objects.data[i]))
            wanted = fmax(wanted, wanted_by(world, world->objects.data[i], body, count, usual, dt));
    return wanted;
}

bool sk_world_find_finer(skein_world *world, double dt, int usual, int *substeps) {
    *substeps = usual;
    if (world->device || world->share) return true; // there all know the same number
    double most = 0, wanted = 0;
    for (size_t i = 0; i < world->objects.count; i++)
        if (is_contact(world->objects.data[i]))
            most = fmax(most, usual * sk_object_number(world->objects.data[i], "more_substeps"));
    if (!(most > usual)) return true;
    const bool leads = world->pins.count || world->motions.count;
    comer *body = sk_allocate(&world->allocator, (world->objects.count + 1) * sizeof *body);
    const bool good = body && (!leads || sk_world_lead(world, world->time + dt)) && sk_world_look_ahead(world, dt);
    if (good) wanted = wanted_by_all(world, body, usual, dt);
    world->led.count = 0;
    sk_release(&world->allocator, body);
    if (!good) return false;
    const int some = 2 * ((usual + 7) / 8); // an even number stays one (plan_builder_correct.c)
    wanted = fmin(some * ceil(wanted / some), most);
    const double now = world->substep > 0 ? round(dt / (double)world->substep) : 0;
    if (wanted <= now && wanted > now * kept && now <= most) wanted = now;
    *substeps = (int)fmax(usual, wanted);
    return true;
}
