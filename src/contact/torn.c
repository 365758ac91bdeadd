/* Who has blown up: edges eight times as long as they were built. Such leaves meet nobody, for their boxes overlap with all others,
 * and a step would take minutes. It is asked once a frame, of where all are when that begins, so that it does not depend on when
 * somebody was last looked for. */
#include <string.h>

#include "base/tasks.h"
#include "contact/touch.h"

enum { LEAVES_AT_ONCE = 1024 };

static real square_between(const sk_vec4 *p, uint32_t a, uint32_t b) {
    real x = p[a].x - p[b].x, y = p[a].y - p[b].y, z = p[a].z - p[b].z;
    return x * x + y * y + z * z;
}

/* Whether the longest side is eight times as long as the longest was built. */
static bool is_long(const sk_touch *touch, const sk_vec4 *p, const uint32_t *vertex, int count) {
    const real most = 8 * 8;
    real now = 0, built = 0;
    for (int k = 0; k < count; k++) {
        uint32_t a = vertex[k], b = vertex[(k + 1) % count];
        now = sk_max(now, square_between(p, a, b));
        built = sk_max(built, square_between(touch->skin.built, a, b));
    }
    return built > 0 && now > most * built;
}

bool sk_leaf_is_torn(const sk_touch *touch, size_t i, const sk_vec4 *p) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *leaf = &skin->leaf[i];
    bool torn = !leaf->triangles && is_long(touch, p, skin->edge[leaf->first_edge], 2);
    for (size_t k = 0; k < leaf->triangles; k++) torn |= is_long(touch, p, skin->triangle[leaf->first_triangle + k], 3);
    return torn;
}

typedef struct tearing {
    sk_touch *touch;
    bool changed;
} tearing;

static void ask_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    tearing *job = data;
    sk_touch *touch = job->touch;
    bool changed = false;
    for (size_t i = begin; i < end; i++) {
        const uint8_t torn = sk_leaf_is_torn(touch, i, touch->at_first);
        changed |= torn != touch->torn[i];
        touch->torn[i] = torn;
    }
    if (changed) __atomic_store_n(&job->changed, true, __ATOMIC_RELAXED);
}

void sk_torn_begin(sk_touch *touch) {
    touch->began = NULL; // that is X, as it still is
    touch->torn_known = false;
}

void sk_torn_keep(sk_touch *touch, size_t packed) {
    if (touch->torn_known) return;
    touch->began_packed = packed;
    // where all are as the last bound left them, in the frame before, that is kept until the frame ends
    touch->began = touch->tangle.same && touch->tangle.left_count == touch->slots && touch->alone ? touch->tangle.left : touch->began_copy;
    if (touch->began == touch->began_copy) memcpy(touch->began_copy, touch->x, touch->slots * sizeof *touch->began_copy);
}

void sk_torn_know(sk_touch *touch, size_t packed) {
    if (touch->torn_known) return;
    const sk_vec4 *first = touch->began ? touch->began : touch->x;
    if (touch->began) packed = touch->began_packed;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) touch->at_first[v] = sk_load(first, packed, touch->slot[v]);
    tearing job = {.touch = touch};
    sk_parallel_pieces(touch->tasks, 0, touch->skin.leaf_count, LEAVES_AT_ONCE, ask_some, &job);
    touch->torn_known = true;
    if (job.changed) touch->torn_changed = true, touch->boxed = false;
}
