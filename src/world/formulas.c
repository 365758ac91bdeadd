/* Objects' formulas, and the compiled code that runs for them. */
#include "formula/compiled_code.h"
#include "world/world.h"

/* What runs for a formula; NULL: nothing that is compiled. */
static const skein_compiled *find_compiled(const skein_world *world, const skein_formula *formula) {
    for (size_t i = world->compiled.count; formula && i-- > 0;)
        if (world->compiled.data[i]->hash == skein_formula_hash(formula)) return world->compiled.data[i];
    return NULL;
}

static const skein_formula *formula_of(const sk_object *object) {
    return object->making && object->making->formula_of ? object->making->formula_of(object->params) : NULL;
}

void sk_world_run_compiled(skein_world *world) {
    for (size_t i = 0; i < world->objects.count; i++) {
        sk_object *object = world->objects.data[i];
        const skein_formula *formula = formula_of(object);
        if (!formula) continue;
        const skein_compiled *compiled = find_compiled(world, formula);
        object->making->run_compiled(object->params, compiled);
        if (object->category != SKEIN_CONSTRAINT || object->as.batch->compiled == (compiled != NULL)) continue;
        object->as.batch->compiled = compiled != NULL;
        world->slots_stale = true; // its groups are to be dealt anew
    }
}

skein_status skein_formula_register(skein_world *world, const skein_compiled *compiled) {
    SK_NEED(world, world);
    SK_NEED(world, compiled);
    skein_error *error = sk_world_error(world);
    skein_status status = sk_compiled_check(compiled, &world->allocator, error);
    if (status) return status;
    if (!SK_RESERVE(&world->allocator, &world->compiled, world->compiled.count + 1))
        return sk_fail_memory(error, "a compiled formula");
    world->compiled.data[world->compiled.count++] = compiled;
    world->plan_stale = true;
    return SKEIN_OK;
}

const skein_formula *skein_formula_of(const skein_world *world, skein_handle constraint) {
    if (!world) return NULL;
    const sk_object *object = sk_object_of(world, constraint);
    return object ? formula_of(object) : NULL;
}

bool skein_formula_is_compiled(const skein_world *world, skein_handle constraint) {
    return world && find_compiled(world, skein_formula_of(world, constraint)) != NULL;
}
