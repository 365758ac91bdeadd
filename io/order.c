/* The order of a flock: the force that it is measured by is found by its fields, whatever its kind is called. */
#include "io/order.h"

#include <string.h>

/* The first enabled force that has fields of both names: whatever draws to a centre, or keeps to neighbours. */
static bool find_force(skein_world *world, const char *one, const char *two, skein_handle *force) {
    for (size_t i = 0; i < skein_object_count(world, SKEIN_FORCE); i++) {
        skein_value enabled;
        *force = skein_object_at(world, SKEIN_FORCE, i);
        const skein_kind *kind = skein_object_kind(world, *force);
        if (!skein_field_find(kind, one, NULL) || !skein_field_find(kind, two, NULL)) continue;
        if (!skein_get(world, *force, "enabled", &enabled) && enabled.number[0] != 0) return true;
    }
    return false;
}

static void find_centre(skein_world *world, double centre[3]) {
    skein_handle force;
    skein_value value = {3, {0, 0, 0}, NULL};
    if (find_force(world, "centre", "strength", &force)) skein_get(world, force, "centre", &value);
    memcpy(centre, value.number, sizeof value.number);
}

static double find_reach(skein_world *world) {
    static const char *const zones[] = {"separation", "alignment", "cohesion"};
    double reach = 0;
    skein_handle force;
    if (!find_force(world, zones[0], zones[2], &force)) return 0;
    for (int i = 0; i < 3; i++) {
        skein_value value;
        if (!skein_get(world, force, zones[i], &value)) reach += value.number[0];
    }
    return reach;
}

skein_status io_order_measure(skein_world *world, skein_handle body, skein_order *out) {
    skein_surface surface;
    double centre[3];
    find_centre(world, centre);
    skein_status status = skein_body_surface(world, body, &surface);
    return status ? status
                  : skein_order_measure(world, surface.first_particle, surface.particle_count, centre,
                                        find_reach(world), out);
}

bool io_is_flock(const skein_world *world, skein_handle body) {
    skein_shape shape;
    return !skein_shape_of(world, body, &shape) && shape.sort == SKEIN_SHAPE_BIRDS;
}
