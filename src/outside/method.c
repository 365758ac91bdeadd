/* Methods by functions, and what they write with: the library's pen under public names. */
#include <string.h>

#include "outside/outside.h"

static sk_writer *pen(skein_writer *writer) {
    return (sk_writer *)(void *)writer;
}

static sk_vector vector_of(skein_row_vector vector) {
    static const sk_vector vectors[] = {
        [SKEIN_NO_VECTOR] = SK_NONE, [SKEIN_X] = SK_X,   [SKEIN_V] = SK_V,   [SKEIN_F] = SK_F,   [SKEIN_SAVED_X] = SK_X0,
        [SKEIN_SAVED_V] = SK_V0,     [SKEIN_T0] = SK_T0, [SKEIN_T1] = SK_T1, [SKEIN_T2] = SK_T2, [SKEIN_T3] = SK_T3,
    };
    return (size_t)vector < sizeof vectors / sizeof *vectors ? vectors[vector] : SK_NONE;
}

size_t skein_write_repeat(skein_writer *writer, size_t times, double h) {
    return writer ? sk_write_repeat(pen(writer), times, h) : 0;
}

void skein_write_end(skein_writer *writer, size_t repeat) {
    if (writer) sk_write_end(pen(writer), repeat);
}

void skein_write_moment(skein_writer *writer, double part) {
    if (writer) sk_write_moment(pen(writer), part);
}

void skein_write_sum(skein_writer *writer, skein_row_vector dst, double a, skein_row_vector p, double b, skein_row_vector q) {
    if (writer && vector_of(dst)) sk_write_sum(pen(writer), vector_of(dst), a, vector_of(p), b, vector_of(q));
}

void skein_write_kick(skein_writer *writer, skein_row_vector dst, skein_row_vector p, double a, skein_row_vector q) {
    if (writer && vector_of(dst)) sk_write_kick(pen(writer), vector_of(dst), vector_of(p), a, vector_of(q));
}

void skein_write_forces(skein_writer *writer) {
    if (!writer) return;
    sk_write_fields(pen(writer));
    sk_write_forces(pen(writer));
    sk_write_contacts(pen(writer), SK_CONTACT_FORCE);
}

void skein_write_steering(skein_writer *writer) {
    if (writer) sk_write_steering(pen(writer));
}

void skein_write_bounds(skein_writer *writer) {
    if (writer) sk_write_bounds(pen(writer));
}

void skein_write_projections(skein_writer *writer, int passes) {
    if (writer) sk_write_projections(pen(writer), passes < 1 ? 1 : passes);
}

void skein_write_contacts(skein_writer *writer) {
    if (!writer) return;
    sk_write_contacts(pen(writer), SK_CONTACT_IMPULSE);
    sk_write_limits(pen(writer), SK_V);
    sk_write_contacts(pen(writer), SK_CONTACT_PUSH);
}

/* ---- the type ---- */

static skein_status check(const void *params, const sk_rules *rules, skein_error *error) {
    const sk_outside *outside = sk_outside_of(params);
    const skein_method_type *given = outside->given;
    return given->takes_rigid ? SKEIN_OK : sk_refuse_rigid(rules, outside->type.kind.name, error);
}

static void write(sk_writer *writer, const void *params, double dt) {
    const skein_method_type *given = sk_outside_of(params)->given;
    given->write((skein_writer *)(void *)writer, sk_given_params(params), dt);
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
    outside->type.method.check = check;
    outside->type.method.write = write;
    outside->type.method.substeps = substeps;
    outside->type.method.amplify = given->amplify;
    outside->type.method.begin = begin;
}
