/* Order parameters of flocks: the force that they are measured by is found, and each note is a number in a list. */
#include "app/flocks.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "io/printable.h"

/* What is noted over time, and where it is in the measure. */
#define LIST(member) \
    { #member, offsetof(skein_order, member) }
static const struct {
    const char *name;
    size_t offset;
} lists[] = {LIST(polarization), LIST(milling), LIST(nearest), LIST(radius), LIST(farthest), LIST(speed)};

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

static json_t *new_flock(skein_world *world, skein_handle body) {
    skein_value name = {0, {0, 0, 0}, NULL};
    skein_get(world, body, "name", &name);
    json_t *flock = json_object();
    json_object_set_new(flock, "name", json_string(name.text ? name.text : ""));
    json_object_set_new(flock, "time", json_array());
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) json_object_set_new(flock, lists[i].name, json_array());
    json_object_set_new(flock, "groups", json_array());
    return flock;
}

static void append(json_t *flock, const char *list, double x) {
    json_array_append_new(json_object_get(flock, list), isfinite(x) ? json_real(x) : json_null());
}

static bool note(json_t *flock, skein_world *world, skein_handle body) {
    skein_surface surface;
    skein_order order;
    double centre[3];
    find_centre(world, centre);
    if (skein_body_surface(world, body, &surface) ||
        skein_order_measure(world, surface.first_particle, surface.particle_count, centre, find_reach(world), &order))
        return false;
    append(flock, "time", skein_world_time(world));
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        double x;
        memcpy(&x, (const char *)&order + lists[i].offset, sizeof x);
        append(flock, lists[i].name, x);
    }
    json_array_append_new(json_object_get(flock, "groups"), json_integer((json_int_t)order.groups));
    return true;
}

bool app_flocks_note(json_t *flocks, skein_world *world) {
    size_t place = 0;
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, i);
        skein_shape shape;
        if (skein_shape_of(world, body, &shape) || shape.sort != SKEIN_SHAPE_BIRDS) continue;
        if (place == json_array_size(flocks)) json_array_append_new(flocks, new_flock(world, body));
        if (!note(json_array_get(flocks, place++), world, body)) return false;
    }
    return true;
}

static double last_of(const json_t *flock, const char *list) {
    const json_t *all = json_object_get(flock, list);
    size_t count = json_array_size(all);
    return count ? json_number_value(json_array_get(all, count - 1)) : 0;
}

void app_flocks_print(const json_t *flocks) {
    size_t index;
    json_t *flock;
    json_array_foreach(flocks, index, flock) {
        const char *given = json_string_value(json_object_get(flock, "name"));
        char name[256];
        snprintf(name, sizeof name, "%s", given && given[0] ? given : "flock");
        io_printable(name, false);
        printf("%s: polarization %.2f, milling %.2f, nearest %.3g m, %.0f groups; %.3g m from the centre, %.3g m/s\n",
               name, last_of(flock, "polarization"), last_of(flock, "milling"), last_of(flock, "nearest"),
               last_of(flock, "groups"), last_of(flock, "radius"), last_of(flock, "speed"));
    }
}
