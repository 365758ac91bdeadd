/* Registered kinds by formula: a copy of a library type that takes a text, with the text fixed. */
#include <stdio.h>
#include <string.h>

#include "outside/outside.h"

static const char prefix[] = "parameters.";

static bool is_hidden(const sk_outside *outside, const skein_field *field, const char *text_field) {
    return !strcmp(field->name, text_field) || !strcmp(field->name, "parameters.*") || field == outside->per;
}

/* Puts the fixed text and choice into the parameters; the copied type makes the rest. */
static skein_status make(void *params, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    const sk_outside *outside = (const void *)kind;
    char *bytes = params, *text = (char *)(uintptr_t)outside->text;
    memcpy(bytes + outside->text_offset, &text, sizeof text);
    if (outside->per) memcpy(bytes + outside->per->offset, &outside->per_place, sizeof outside->per_place);
    return outside->copied->make(params, &outside->inner, allocator, error);
}

/* Makes the field table: the kind's own fields, stored as the formula's parameters or, if the copied type has a field
 * of that name, in that one's place; then the copied type's other fields. */
static skein_status lay_fields(sk_outside *outside, sk_allocator *allocator, const skein_kind *kind,
                               const skein_kind *base, const char *text_field, skein_error *error) {
    const skein_field *parameters = sk_field_named(base->fields, base->field_count, "parameters.*");
    size_t most = kind->field_count + base->field_count, size = SKEIN_FORMULA_MOST_PARAMETERS * 80, used = 0, count = 0;
    skein_field *fields = outside->fields = sk_allocate(allocator, 2 * most * sizeof *fields), *inner = fields + most;
    outside->names = sk_allocate(allocator, size);
    if (!fields || !outside->names) return sk_fail_memory(error, kind->name);
    for (size_t f = 0; f < kind->field_count; f++) {
        const skein_field *same = sk_field_named(base->fields, base->field_count, kind->fields[f].name);
        fields[f] = kind->fields[f];
        if (fields[f].type != SKEIN_FIELD_REAL)
            return sk_fail(error, SKEIN_ERROR_VALUE, fields[f].name,
                           "a field that a formula names is a SKEIN_FIELD_REAL");
        if (same && same->type == SKEIN_FIELD_REAL && !is_hidden(outside, same, text_field)) {
            fields[f].offset = same->offset;
            continue;
        }
        int length = snprintf(outside->names + used, size - used, "%s%s", prefix, fields[f].name);
        if (count == SKEIN_FORMULA_MOST_PARAMETERS || (size_t)length >= size - used)
            return sk_fail(error, SKEIN_ERROR_LIMIT, fields[f].name, "%d fields of a formula are the most",
                           SKEIN_FORMULA_MOST_PARAMETERS);
        fields[f].offset = parameters->offset + count * sizeof(double);
        inner[count] = fields[f];
        inner[count++].name = outside->names + used;
        used += (size_t)length + 1;
    }
    size_t total = kind->field_count;
    for (size_t f = 0; f < base->field_count; f++) {
        const skein_field *field = &base->fields[f];
        if (!is_hidden(outside, field, text_field) && !sk_field_named(fields, kind->field_count, field->name))
            fields[total++] = *field;
    }
    outside->inner = (skein_kind){kind->name, kind->help, kind->category, inner, count, base->params_size};
    outside->type.kind = (skein_kind){kind->name, kind->help, kind->category, fields, total, base->params_size};
    return SKEIN_OK;
}

skein_status sk_outside_by_formula(sk_outside *outside, sk_allocator *allocator, const void *base, size_t base_size,
                                   const char *text_field, const char *text, skein_error *error) {
    const skein_kind *kind = outside->given, *from = base;
    memcpy(&outside->type, base, base_size);
    outside->text = text;
    outside->text_offset = sk_field_named(from->fields, from->field_count, text_field)->offset;
    outside->copied = from->category == SKEIN_FORCE        ? outside->type.force.making
                      : from->category == SKEIN_CONSTRAINT ? outside->type.constraint.making
                                                           : outside->type.collider.making;
    outside->making = *outside->copied;
    outside->making.make = make;
    if (from->category == SKEIN_FORCE) outside->type.force.making = &outside->making;
    else if (from->category == SKEIN_CONSTRAINT) outside->type.constraint.making = &outside->making;
    else outside->type.collider.making = &outside->making;
    skein_status status = lay_fields(outside, allocator, kind, from, text_field, error);
    if (status) return status;
    // makes one now, so that an error in the text is reported at once
    void *params = sk_allocate(allocator, from->params_size);
    if (!params || !sk_fields_default(allocator, outside->type.kind.fields, outside->type.kind.field_count, params)) {
        sk_release(allocator, params);
        return sk_fail_memory(error, kind->name);
    }
    status = make(params, &outside->type.kind, allocator, error);
    outside->making.unmake(params, allocator);
    sk_fields_clear(allocator, outside->type.kind.fields, outside->type.kind.field_count, params);
    sk_release(allocator, params);
    return status;
}
