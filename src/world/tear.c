/* Tearing: where a step has left an edge stretched beyond its body's bound, the edge gives way, with the faces beside it.
 *
 * Stretch is relieved where an edge has gone, and grows at the ends of the tear. So of edges that meet only the one that is
 * stretched most gives way in a step; all that would at once is no tear, but dust. Who that is depends on the state alone,
 * and not on threads, on the width of vectors or on the method. What then holds no more, a cut finds out (severed.c). */
#include <string.h>

#include "world/cut.h"

enum { SOME = 256 };

static bool may_tear(const sk_object *object) {
    return object->category == SKEIN_BODY && object->as.body->tear_bound > 0 && object->as.body->enabled;
}

bool sk_world_tears(const skein_world *world) {
    for (size_t i = 0; i < world->objects.count; i++)
        if (may_tear(world->objects.data[i])) return true;
    return false;
}

/* The edge of a particle that is stretched most: its number, counted from 1, through all edges of the body. */
typedef struct worst {
    real stretch;
    size_t edge;
} worst;

/* A walk over the edges of a body, with their stretch. */
typedef struct tearing {
    const skein_world *world;
    const sk_body *body;
    sk_cut *cut;
    worst *worst;  /* of each particle */
    uint8_t *face; /* of each face, whether it is to be gone */
} tearing;

typedef void edge_visit(tearing *t, size_t edge, uint32_t a, uint32_t b, real stretch);

/* Shows those whose stretch is beyond the bound to `visit` (or NULL), and returns how many they are. */
static size_t each_too_long(tearing *t, edge_visit *visit) {
    const sk_body *body = t->body;
    size_t edge = 0, count = 0;
    for (size_t i = 0; i < body->batch_count; i++) {
        const sk_batch *batch = body->batch[i];
        if (!batch->measured || !sk_batch_is_on(batch)) continue;
        for (size_t begin = 0; begin < batch->count; begin += SOME) {
            real stretch[SOME];
            size_t end = begin + SOME < batch->count ? begin + SOME : batch->count;
            batch->type->strain(batch, t->world->particles.vector[SK_X], begin, end, stretch);
            for (size_t e = begin; e < end; e++) {
                edge++;
                if (!(stretch[e - begin] > (real)body->tear_bound)) continue;
                count++;
                const uint32_t *p = batch->particle + e * batch->arity;
                if (visit) visit(t, edge, p[0] - body->first_particle, p[1] - body->first_particle, stretch[e - begin]);
            }
        }
    }
    return count;
}

/* Of equal ones the first counts. */
static void note_worst(tearing *t, size_t edge, uint32_t a, uint32_t b, real stretch) {
    worst *ends[] = {&t->worst[a], &t->worst[b]};
    for (int k = 0; k < 2; k++)
        if (!ends[k]->edge || stretch > ends[k]->stretch) *ends[k] = (worst){stretch, edge};
}

/* An edge that is the worst of both its ends takes the faces that it is a side of. */
static void give_way(tearing *t, size_t edge, uint32_t a, uint32_t b, real stretch) {
    (void)stretch;
    const sk_cut *cut = t->cut;
    if (t->worst[a].edge != edge || t->worst[b].edge != edge) return;
    for (size_t i = cut->start[a]; i < cut->start[a + 1]; i++) {
        uint32_t f = cut->around[i];
        for (size_t c = cut->first[f]; c < cut->first[f + 1]; c++)
            if (cut->corner[c] == b) t->face[f] = 1;
    }
}

static bool tear_body(skein_world *world, sk_body *body) {
    sk_allocator *allocator = &world->allocator;
    tearing t = {.world = world, .body = body};
    if (!each_too_long(&t, NULL)) return true;
    bool good = sk_cut_begin(world, body);
    t.cut = body->cut;
    t.worst = sk_allocate(allocator, body->particle_count * sizeof *t.worst);
    t.face = sk_allocate(allocator, body->face_count * sizeof *t.face);
    good = good && t.worst && t.face;
    if (good) {
        memcpy(t.face, t.cut->face, body->face_count * sizeof *t.face);
        each_too_long(&t, note_worst);
        each_too_long(&t, give_way);
        good = sk_cut_set(world, body, t.face);
    }
    sk_release(allocator, t.worst);
    sk_release(allocator, t.face);
    return good;
}

skein_status sk_world_tear(skein_world *world, skein_error *error) {
    skein_status status = sk_world_touch(world); // the state goes to new slots
    bool good = true;
    for (size_t i = 0; i < world->objects.count && !status && good; i++)
        if (may_tear(world->objects.data[i])) good = tear_body(world, world->objects.data[i]->as.body);
    return good ? status : sk_fail_memory(error, "a tear");
}
