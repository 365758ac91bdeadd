/* Lists for those who look in from outside: springs with their strain, contacts. */
#include "world/world.h"

enum { STRAIN_BLOCK = 256 };

/* The springs of one batch, as far as there is room. */
static void copy_batch(const sk_batch *batch, const sk_vec4 *x, skein_spring *out, size_t room) {
    size_t count = batch->count < room ? batch->count : room;
    real strain[STRAIN_BLOCK];
    for (size_t first = 0; first < count; first += STRAIN_BLOCK) {
        size_t last = first + STRAIN_BLOCK < count ? first + STRAIN_BLOCK : count;
        batch->type->strain(batch, x, first, last, strain);
        for (size_t e = first; e < last; e++)
            out[e] = (skein_spring){
                {batch->particle[2 * e], batch->particle[2 * e + 1]}, (float)strain[e - first], batch->measured};
    }
}

skein_status skein_springs_copy(skein_world *world, skein_spring *out, size_t most, size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, count);
    if (most) SK_NEED(world, out);
    skein_status status = sk_world_arrange(world, sk_world_error(world)); // the slots of new rules may not be known yet
    if (!status) status = sk_world_fetch(world);
    *count = 0;
    for (size_t i = 0; i < world->rules.batches.count && !status; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        if (batch->type->arity != 2 || !sk_batch_is_loaded(batch)) continue;
        if (*count < most) copy_batch(batch, world->particles.vector[SK_X], out + *count, most - *count);
        *count += batch->count;
    }
    return status;
}

/* Where the contacts go. */
typedef struct contact_list {
    skein_contact *out;
    size_t most, count, first; /* the particle that is visited as 0 */
    skein_handle collider;
} contact_list;

static void add_contact(void *user, size_t particle, sk_vec3 normal, double gap) {
    contact_list *list = user;
    if (list->count++ >= list->most) return;
    list->out[list->count - 1] = (skein_contact){
        (uint32_t)(list->first + particle), list->collider, {(double)normal.x, (double)normal.y, (double)normal.z}, gap};
}

skein_status skein_collider_probe(const skein_world *world, skein_handle handle, size_t count, const double *points,
                                  double *distances, double *normals) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, points);
    const sk_object *object = sk_object_find(world, handle, SKEIN_COLLIDER);
    if (!object) return SKEIN_ERROR_HANDLE;
    sk_collider_probe_points(object->as.collider, world->time, world->isa, count, points, distances, normals);
    return SKEIN_OK;
}

skein_status skein_force_probe(const skein_world *world, skein_handle handle, size_t count, const double *points,
                               double *forces) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, points);
    if (count) SK_NEED(world, forces);
    const sk_object *object = sk_object_find(world, handle, SKEIN_FORCE);
    skein_error *error = sk_world_error(world);
    if (!object) return SKEIN_ERROR_HANDLE;
    const sk_force *force = object->as.force;
    if (!force->type->at)
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "%s is no field that a formula gives", object->kind->name);
    for (size_t i = 0; i < count; i++)
        if (!force->type->at(force->params, points + 3 * i, world->time, forces + 3 * i))
            return sk_fail_memory(error, "a formula's value");
    return SKEIN_OK;
}

skein_status skein_contacts_copy(const skein_world *world, skein_contact *out, size_t most, size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, count);
    if (most) SK_NEED(world, out);
    const sk_particles *all = &world->particles;
    skein_status status = sk_world_fetch(world);
    contact_list list = {.out = out, .most = most};
    for (size_t i = 0; i < world->objects.count && !status; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_COLLIDER || !object->as.collider->common->enabled) continue;
        list.collider = sk_handle_at(world, i);
        const char *on = object->as.collider->common->on;
        for (size_t at = 0, end; sk_world_next_run(world, on, &at, &list.first, &end);)
            sk_collider_visit(object->as.collider, world->time, world->isa, all->vector[SK_X],
                              all->slot_of + list.first, end - list.first, add_contact, &list);
    }
    *count = list.count;
    return status;
}
