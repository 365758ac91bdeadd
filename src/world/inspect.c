/* Looking into constraints from outside: how many an object has, what each is now, and its formula's operations. Only
 * looks; whatever kind it is, its batch answers (constraints/inspect.c). */
#include "world/world.h"

/* The batches of a body or a constraint; NULL for what has none, and then the world's error says so. */
static sk_batch *const *batches_of(const skein_world *world, skein_handle handle, size_t *count) {
    sk_object *object = sk_object_of(world, handle);
    if (object && object->category == SKEIN_BODY) {
        *count = object->as.body->batch_count;
        return object->as.body->batch;
    }
    *count = 1;
    if (object && object->category == SKEIN_CONSTRAINT) return &object->as.batch;
    sk_fail_handle(world, handle, "constraint or body", "");
    return NULL;
}

/* Slots as they are now, and the present state. */
static skein_status prepare(skein_world *world) {
    skein_status status = sk_world_settle_presence(world, sk_world_error(world));
    if (!status) status = sk_world_arrange(world, sk_world_error(world));
    return status ? status : sk_world_fetch(world);
}

skein_status skein_constraint_count(skein_world *world, skein_handle object, size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, count);
    size_t batch_count;
    *count = 0;
    skein_status status = prepare(world);
    if (status) return status;
    sk_batch *const *batches = batches_of(world, object, &batch_count);
    if (!batches) return SKEIN_ERROR_HANDLE;
    for (size_t b = 0; b < batch_count; b++) *count += sk_batch_constraint_count(batches[b]);
    return SKEIN_OK;
}

/* The batch of an object's constraint by number, which becomes the number in the batch. NULL after an error. */
static const sk_batch *find(skein_world *world, skein_handle object, size_t *index, skein_status *status) {
    size_t count, all = 0;
    *status = prepare(world);
    if (*status) return NULL;
    sk_batch *const *batches = batches_of(world, object, &count);
    *status = SKEIN_ERROR_HANDLE;
    if (!batches) return NULL;
    for (size_t b = 0; b < count; b++) {
        size_t here = sk_batch_constraint_count(batches[b]);
        *status = SKEIN_OK;
        if (*index - all < here) {
            *index -= all;
            return batches[b];
        }
        all += here;
    }
    *status = sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "index",
                      "there is no constraint %zu: the object has %zu", *index, all);
    return NULL;
}

static double stiffness_of(const sk_batch *batch, size_t element, bool is_energy) {
    if (is_energy && batch->enclosure) return 1; // in J already
    return ((const sk_material *)batch->params)->stiffness * (batch->scale ? (double)batch->scale[element] : 1.0);
}

skein_status skein_constraint_evaluate(skein_world *world, skein_handle object, size_t index,
                                       skein_constraint_value *value, uint32_t *particles, double *gradient,
                                       size_t most) {
    SK_NEED(world, world);
    SK_NEED(world, value);
    if (most) SK_NEED(world, particles);
    if (most) SK_NEED(world, gradient);
    *value = (skein_constraint_value){.label = "", .text = ""};
    skein_status status;
    const sk_batch *batch = find(world, object, &index, &status);
    if (!batch) return status;
    sk_constraint_answer answer = {0};
    if (!batch->type->evaluate(batch, world->time, world->particles.vector[SK_X], index, most, &answer,
                               (double(*)[3])(void *)gradient))
        return sk_fail_memory(sk_world_error(world), "a constraint's value");
    *value = (skein_constraint_value){
        .value = answer.value,
        .by_time = answer.by_time,
        .stiffness = stiffness_of(batch, index, answer.is_energy),
        .is_energy = answer.is_energy,
        .one_sided = answer.one_sided,
        .guarded = answer.guarded,
        .particle_count = sk_batch_particle_count(batch),
        .label = batch->label,
        .text = sk_batch_text(batch),
    };
    for (size_t i = 0; i < value->particle_count && i < most; i++) particles[i] = sk_batch_particle(batch, index, i);
    return SKEIN_OK;
}

skein_status skein_constraint_operations(skein_world *world, skein_handle object, size_t index,
                                         skein_operation *operations, double *derivatives, size_t most, size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, count);
    if (most) SK_NEED(world, operations);
    *count = 0;
    skein_status status;
    const sk_batch *batch = find(world, object, &index, &status);
    if (!batch) return status;
    if (batch->enclosure || !*sk_batch_text(batch)) return SKEIN_OK; // a sum over a surface is no single formula
    return sk_batch_operations(batch, &world->allocator, world->time, world->particles.vector[SK_X], index, operations,
                               derivatives, most, count, sk_world_error(world));
}
