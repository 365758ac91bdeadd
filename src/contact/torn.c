/* Who has blown up: edges twelve times as long as they were built. (At eight, a sheet that falls on an edge, and hangs there by a corner for a moment,
 * with 1,000 % of stretch, went through itself.) Such leaves meet nobody, for their boxes overlap with all others,
 * and a step would take minutes. It goes by where all are before a substep, so that it does not depend on when somebody was last
 * looked for; and is asked again only where they have moved so far against each other since that it may have changed. (Once a frame
 * was too seldom: what blew up within one met everybody until it ended.) */
#include <string.h>

#include "base/quad.h"
#include "base/tasks.h"
#include "contact/touch.h"

enum { LEAVES_AT_ONCE = 1024 };

static real square_between(const sk_vec4 *p, uint32_t a, uint32_t b) {
    real x = p[a].x - p[b].x, y = p[a].y - p[b].y, z = p[a].z - p[b].z;
    return x * x + y * y + z * z;
}

/* How much longer the longest side may get until it is twelve times as long as the longest was built: less than nothing if it is. */
static real room_of(const sk_touch *touch, const sk_vec4 *p, const uint32_t *vertex, int count) {
    real now = 0, built = 0;
    for (int k = 0; k < count; k++) {
        uint32_t a = vertex[k], b = vertex[(k + 1) % count];
        now = sk_max(now, square_between(p, a, b));
        built = sk_max(built, square_between(touch->skin.built, a, b));
    }
    return built > 0 ? 12 * sk_sqrt(built) - sk_sqrt(now) : SK_REAL_MAX;
}

static real room_of_leaf(const sk_touch *touch, size_t i, const sk_vec4 *p) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *leaf = &skin->leaf[i];
    if (!leaf->triangles) return room_of(touch, p, skin->edge[leaf->first_edge], 2);
    real room = SK_REAL_MAX;
    for (size_t k = 0; k < leaf->triangles; k++)
        room = sk_min(room, room_of(touch, p, skin->triangle[leaf->first_triangle + k], 3));
    return room;
}

bool sk_leaf_is_torn(const sk_touch *touch, size_t i, const sk_vec4 *p) {
    return room_of_leaf(touch, i, p) < 0;
}

/* How far vertices have moved against each other since all leaves were asked. */
static real moved(const sk_touch *touch) {
    sk_quad low = {0, 0, 0, 0}, high = low;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const sk_quad way = sk_quad_at(&touch->p[v]) - sk_quad_at(&touch->asked_at[v]);
        low = v ? sk_least_quad(low, way) : way, high = v ? sk_most_quad(high, way) : way;
    }
    const sk_quad across = high - low;
    return sk_sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
}

static void ask_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = data;
    for (size_t i = begin; i < end; i++) touch->room[i] = room_of_leaf(touch, i, touch->p);
}

void sk_torn_know(sk_touch *touch, size_t packed) {
    const real share = (real)0.99; // lengths and ways are rounded
    if (touch->torn_clock == touch->clock) return;
    touch->torn_clock = touch->clock;
    sk_touch_load(touch, packed);
    if (touch->torn_asked && !touch->any_torn && moved(touch) <= share * touch->torn_room) return;
    sk_parallel_pieces(touch->tasks, 0, touch->skin.leaf_count, LEAVES_AT_ONCE, ask_some, touch);
    memcpy(touch->asked_at, touch->p, touch->skin.vertex_count * sizeof *touch->p);
    touch->torn_asked = true;
    touch->any_torn = false;
    touch->torn_room = SK_REAL_MAX;
    for (size_t i = 0; i < touch->skin.leaf_count; i++) {
        const uint8_t torn = touch->room[i] < 0;
        touch->torn_changed |= torn != touch->torn[i];
        touch->torn[i] = torn;
        touch->any_torn |= torn;
        touch->torn_room = sk_min(touch->torn_room, touch->room[i]);
    }
    if (touch->torn_changed) touch->boxed = false;
}
