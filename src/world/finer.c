/* More substeps where pins are led fast past what hangs from them, in a world where surfaces meet.
 *
 * A bound lets nothing pass that comes by several thicknesses in a substep, but stops it corner by corner, while springs pull on what
 * goes on: of 48 sheets of 25 x 25 to 41 x 41, grids and irregular ones, that were led by their middles on circles of 0.3 and 0.5 m at 8
 * and 10 m/s (2.7 and 3.3 thicknesses in a substep of a 600th of a second) 33 had edges of 2 to 20 times their length, and 20 had
 * crossings. Now none has, the worst is stretched by 94 % for a moment, and frames take 31 ms in the mean instead of 55, for nothing is stuck. (Pairs that were
 * pushed before they were near left 19 of them so, and heaps took longer at their impacts.)
 *
 * What counts is how far a pin is led from where its body's free particles go in the mean, or rest where there are none: what flies along
 * with its pins has nothing to fear, and what a moving frame carries is left to that (world/frames.c). It follows from where pins are led in
 * this step and from the state alone, which knows how long the last substep was. */
#include <math.h>

#include "world/world.h"

/* Thicknesses that a pin may be led by in a substep. */
static const double fast = 2;
/* With fewer than this share of those that there are, they become fewer: else a plan would be written anew in each step. */
static const double kept = 0.6;

static bool is_contact(const sk_object *object) {
    return object->category == SKEIN_FORCE && object->common.plain.enabled && object->as.force->type->meeting;
}

/* The rule that the surfaces of a body meet others by: of several, the one that allows the most. */
static const sk_object *rule_of(const skein_world *world, const sk_common *body) {
    const sk_object *found = NULL;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *rule = world->objects.data[i];
        if (!is_contact(rule)) continue;
        const char *on = rule->common.plain.on;
        if (on[0] && !sk_names_mean(on, body->name, body->groups)) continue;
        if (!found || sk_object_number(rule, "more_substeps") > sk_object_number(found, "more_substeps")) found = rule;
    }
    return found;
}

/* How far the free particles of a body go in a step of dt, in the mean. */
static void mean_way(const skein_world *world, const sk_body *body, double dt, double way[3]) {
    const sk_particles *all = &world->particles;
    size_t count = 0;
    way[0] = way[1] = way[2] = 0;
    for (size_t p = body->first_particle; p < body->first_particle + body->particle_count; p++) {
        const sk_vec4 v = all->vector[SK_V][all->slot_of[p]];
        if (all->pinned[p] || !(sk_dot(sk_xyz(v), sk_xyz(v)) < (real)1e12)) continue;
        way[0] += (double)v.x, way[1] += (double)v.y, way[2] += (double)v.z;
        count++;
    }
    for (int k = 0; k < 3 && count; k++) way[k] *= dt / (double)count;
}

/* How far a body's pins are led past its free particles, at most, m. */
static double way_past(const skein_world *world, const sk_body *body, double dt) {
    const sk_particles *all = &world->particles;
    double mean[3], most = 0;
    bool any = false;
    for (size_t i = 0; i < world->led.count; i++) {
        const sk_pin *pin = &world->led.data[i];
        if (pin->particle - body->first_particle >= body->particle_count) continue;
        if (!all->pinned[pin->particle] || !sk_particle_is_here(all, pin->particle)) continue;
        if (!any) mean_way(world, body, dt, mean);
        any = true;
        const sk_vec4 x = all->vector[SK_X][all->slot_of[pin->particle]];
        const double way[3] = {pin->place[0] - (double)x.x - mean[0], pin->place[1] - (double)x.y - mean[1], pin->place[2] - (double)x.z - mean[2]};
        most = fmax(most, sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]));
    }
    return most;
}

/* How many substeps a body's pins ask for, and how many they may have. */
static double wanted_by(const skein_world *world, const sk_object *object, double usual, double dt, double *most) {
    const sk_object *rule = rule_of(world, &object->common.plain);
    if (!rule) return 0;
    const double own = sk_object_number(object, "contact.thickness"), thickness = own > 0 ? own : sk_object_number(rule, "thickness");
    const double its_most = usual * sk_object_number(rule, "more_substeps");
    *most = fmax(*most, its_most);
    return fmin(way_past(world, object->as.body, dt) / (fast * thickness), its_most);
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

bool sk_world_find_finer(skein_world *world, double dt, int usual, int *substeps) {
    *substeps = usual;
    if (world->device || world->share || (!world->pins.count && !world->motions.count)) return true; // there all know the same number
    bool meets = false;
    for (size_t i = 0; i < world->objects.count; i++) meets |= is_contact(world->objects.data[i]);
    if (!meets) return true;
    if (!sk_world_lead(world, world->time + dt)) return false;
    double wanted = 0, most = usual;
    for (size_t i = 0; i < world->objects.count && world->led.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category == SKEIN_BODY && !is_carried(world, &object->common.plain))
            wanted = fmax(wanted, wanted_by(world, object, usual, dt, &most));
    }
    world->led.count = 0;
    const int some = 2 * ((usual + 7) / 8); // an even number stays one (plan_builder_correct.c)
    wanted = fmin(some * ceil(wanted / some), most);
    const double now = world->substep > 0 ? round(dt / (double)world->substep) : 0;
    if (wanted <= now && wanted > now * kept && now <= most) wanted = now;
    *substeps = (int)fmax(usual, wanted);
    return true;
}
