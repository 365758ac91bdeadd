/* Registered methods by functions, and the library's plan builder under public names, with which they write. */
#include <string.h>

#include "outside/outside.h"

static sk_plan_builder *inner(skein_plan_builder *builder) {
    return (sk_plan_builder *)(void *)builder;
}

static sk_vector vector_of(skein_plan_vector vector) {
    static const sk_vector vectors[] = {
        [SKEIN_NO_VECTOR] = SK_NONE, [SKEIN_X] = SK_X,        [SKEIN_V] = SK_V,   [SKEIN_F] = SK_F,
        [SKEIN_SAVED_X] = SK_X0,     [SKEIN_SAVED_V] = SK_V0, [SKEIN_T0] = SK_T0, [SKEIN_T1] = SK_T1,
        [SKEIN_T2] = SK_T2,          [SKEIN_T3] = SK_T3,
    };
    return (size_t)vector < sizeof vectors / sizeof *vectors ? vectors[vector] : SK_NONE;
}

size_t skein_write_repeat(skein_plan_builder *builder, size_t times, double h) {
    if (!builder) return 0;
    size_t repeat = sk_write_repeat(inner(builder), times, h);
    sk_write_start(inner(builder)); // the method may not save X0 itself
    return repeat;
}

void skein_write_end(skein_plan_builder *builder, size_t repeat) {
    if (builder) sk_write_end(inner(builder), repeat);
}

void skein_write_stage_time(skein_plan_builder *builder, double part) {
    if (builder) sk_write_stage_time(inner(builder), part);
}

void skein_write_sum(skein_plan_builder *builder, skein_plan_vector dst, double a, skein_plan_vector p, double b,
                     skein_plan_vector q) {
    if (builder && vector_of(dst)) sk_write_sum(inner(builder), vector_of(dst), a, vector_of(p), b, vector_of(q));
}

void skein_write_kick(skein_plan_builder *builder, skein_plan_vector dst, skein_plan_vector p, double a,
                      skein_plan_vector q) {
    if (builder && vector_of(dst)) sk_write_kick(inner(builder), vector_of(dst), vector_of(p), a, vector_of(q));
}

void skein_write_forces(skein_plan_builder *builder) {
    if (builder) sk_write_derivative(inner(builder));
}

void skein_write_steering(skein_plan_builder *builder) {
    if (builder) sk_write_steering(inner(builder));
}

void skein_write_bounds(skein_plan_builder *builder) {
    if (builder) sk_write_bounds(inner(builder));
}

void skein_write_projections(skein_plan_builder *builder, int passes) {
    if (builder) sk_write_projections(inner(builder), passes < 1 ? 1 : passes);
}

void skein_write_contacts(skein_plan_builder *builder) {
    if (builder) sk_write_impulses(inner(builder));
}

/* ---- the type ---- */

static void write(sk_plan_builder *builder, const void *params, double dt) {
    const skein_method_type *given = sk_outside_of(params)->given;
    given->write((skein_plan_builder *)(void *)builder, sk_given_params(params), dt);
}

static int substeps(const void *params) {
    const skein_field *field = sk_outside_of(params)->substeps;
    return field ? (int)sk_field_load(field, params).number[0] : 1;
}

static void begin(void *params, const sk_method_type *type) {
    ((sk_outside_params *)params)->outside = (const void *)type;
}

void sk_outside_method(sk_outside *outside, const skein_method_type *given) {
    const skein_kind *kind = &outside->type.kind;
    const skein_field *field = sk_field_named(kind->fields, kind->field_count, "substeps");
    outside->substeps = field && field->type == SKEIN_FIELD_INT ? field : NULL;
    outside->type.method.takes_rigid = given->takes_rigid;
    outside->type.method.write = write;
    outside->type.method.substeps = substeps;
    outside->type.method.amplify = given->amplify;
    outside->type.method.begin = begin;
}
