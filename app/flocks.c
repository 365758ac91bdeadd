/* Order parameters of flocks: each note is a number in a list. */
#include "app/flocks.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "io/order.h"
#include "io/printable.h"

/* What is noted over time, and where it is in the measure. */
#define LIST(member) \
    { #member, offsetof(skein_order, member) }
static const struct {
    const char *name;
    size_t offset;
} lists[] = {LIST(polarization), LIST(milling), LIST(nearest), LIST(radius), LIST(farthest), LIST(speed)};

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
    skein_order order;
    if (io_order_measure(world, body, &order)) return false;
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
        if (!io_is_flock(world, body)) continue;
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
