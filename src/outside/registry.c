/* Registries of kinds, and the checks that a kind must pass to be registered. */
#include <string.h>

#include "formula/text.h"
#include "outside/outside.h"

skein_kinds *skein_kinds_create(skein_error *error) {
    sk_allocator allocator = sk_default_allocator();
    skein_kinds *kinds = sk_allocate(&allocator, sizeof *kinds);
    if (kinds) kinds->allocator = allocator;
    else sk_fail_memory(error, "a registry of kinds");
    return kinds;
}

static void release(sk_outside *outside, sk_allocator *allocator) {
    if (!outside) return;
    sk_release(allocator, outside->fields);
    sk_release(allocator, outside->names);
    sk_release(allocator, outside);
}

void skein_kinds_destroy(skein_kinds *kinds) {
    if (!kinds) return;
    sk_allocator allocator = kinds->allocator;
    for (size_t i = 0; i < kinds->count; i++) release(kinds->data[i], &allocator);
    sk_release(&allocator, kinds->data);
    sk_release(&allocator, kinds);
}

const skein_kind *sk_outside_at(const skein_kinds *kinds, skein_category category, size_t index) {
    for (size_t i = 0; kinds && i < kinds->count; i++)
        if (kinds->data[i]->type.kind.category == category && index-- == 0) return &kinds->data[i]->type.kind;
    return NULL;
}

/* ---- checks ---- */

static bool lies_in(const skein_field *field, size_t size) {
    static const size_t sizes[] = {
        [SKEIN_FIELD_BOOL] = sizeof(bool),        [SKEIN_FIELD_INT] = sizeof(int32_t),
        [SKEIN_FIELD_INT2] = 2 * sizeof(int32_t), [SKEIN_FIELD_INT3] = 3 * sizeof(int32_t),
        [SKEIN_FIELD_REAL] = sizeof(double),      [SKEIN_FIELD_REAL2] = 2 * sizeof(double),
        [SKEIN_FIELD_VEC3] = 3 * sizeof(double),  [SKEIN_FIELD_CHOICE] = sizeof(int32_t),
        [SKEIN_FIELD_TEXT] = sizeof(char *),
    };
    return field->type <= SKEIN_FIELD_TEXT && field->offset <= size && sizes[field->type] <= size - field->offset;
}

static skein_status check_field(const skein_kind *kind, size_t f, bool by_formula, skein_error *error) {
    const skein_field *field = &kind->fields[f];
    size_t common_count;
    const skein_field *common = sk_common_fields(kind->category, &common_count);
    if (!field->name || !field->name[0] || strchr(field->name, '*') || !strncmp(field->name, "parameters.", 11))
        return sk_fail(error, SKEIN_ERROR_NAME, kind->name, "field %zu has no name that fields may have", f);
    if (!field->unit || !field->help)
        return sk_fail(error, SKEIN_ERROR_VALUE, field->name, "a field needs a unit (\"\" is none) and a line of help");
    for (size_t g = 0; g < f; g++)
        if (!strcmp(field->name, kind->fields[g].name))
            return sk_fail(error, SKEIN_ERROR_NAME, field->name, "two fields of '%s' have this name", kind->name);
    if (sk_field_named(common, common_count, field->name))
        return sk_fail(error, SKEIN_ERROR_NAME, field->name, "every %s has a field of this name",
                       skein_category_text(kind->category));
    if (!by_formula && !lies_in(field, kind->params_size))
        return sk_fail(error, SKEIN_ERROR_VALUE, field->name, "it does not lie within the %zu bytes of params_size",
                       kind->params_size);
    if (field->type == SKEIN_FIELD_CHOICE && !field->choices)
        return sk_fail(error, SKEIN_ERROR_VALUE, field->name, "a choice needs its words, \"a|b|c\"");
    return SKEIN_OK;
}

static skein_status check_kind(const skein_kind *kind, bool by_formula, skein_error *error) {
    if (!kind->name || !sk_is_name(kind->name))
        return sk_fail(error, SKEIN_ERROR_NAME, "name", "a kind's name is letters, digits and _, and no digit first");
    if (!kind->help || (kind->field_count && !kind->fields))
        return sk_fail(error, SKEIN_ERROR_VALUE, kind->name, "a kind needs a line of help, and its table of fields");
    for (size_t f = 0; f < kind->field_count; f++) {
        skein_status status = check_field(kind, f, by_formula, error);
        if (status) return status;
    }
    return SKEIN_OK;
}

/* ---- by functions ---- */

static skein_status make(void *params, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    (void)allocator, (void)error;
    ((sk_outside_params *)params)->outside = (const void *)kind;
    return SKEIN_OK;
}

static void unmake(void *params, sk_allocator *allocator) {
    (void)params, (void)allocator;
}

skein_status sk_outside_by_functions(sk_outside *outside, sk_allocator *allocator, const skein_kind *kind,
                                     skein_error *error) {
    outside->fields = sk_allocate(allocator, (kind->field_count + 1) * sizeof *outside->fields);
    if (!outside->fields) return sk_fail_memory(error, kind->name);
    for (size_t f = 0; f < kind->field_count; f++) {
        outside->fields[f] = kind->fields[f];
        outside->fields[f].offset += sizeof(sk_outside_params);
    }
    outside->making = (sk_making){.make = make, .unmake = unmake};
    outside->type.kind =
        (skein_kind){kind->name,      kind->help,        kind->category,
                     outside->fields, kind->field_count, sizeof(sk_outside_params) + kind->params_size};
    return SKEIN_OK;
}

/* ---- registering ---- */

static const char *formula_of(const skein_kind *kind) {
    const void *given = kind;
    const skein_force_type *force = given;
    const skein_constraint_type *constraint = given;
    const skein_collider_type *collider = given;
    switch (kind->category) {
    case SKEIN_FORCE: return force->formula ? force->formula : force->potential;
    case SKEIN_CONSTRAINT: return constraint->formula ? constraint->formula : constraint->energy;
    case SKEIN_COLLIDER: return collider->formula;
    default: return NULL;
    }
}

/* Whether it has the function that says how it acts. */
static bool acts(const skein_kind *kind) {
    const void *given = kind;
    switch (kind->category) {
    case SKEIN_FORCE: return ((const skein_force_type *)given)->force != NULL;
    case SKEIN_COLLIDER: return ((const skein_collider_type *)given)->distance != NULL;
    case SKEIN_MOTION: return ((const skein_motion_type *)given)->move != NULL;
    case SKEIN_BODY: return ((const skein_body_type *)given)->build != NULL;
    case SKEIN_METHOD: return ((const skein_method_type *)given)->write != NULL;
    default: return false;
    }
}

static const void *library_type(const sk_kind_list *library, skein_category category, const char *name) {
    for (size_t i = 0; i < library[category].count; i++)
        if (!strcmp(((const skein_kind *)library[category].data[i])->name, name)) return library[category].data[i];
    return NULL;
}

static bool is_taken(const skein_kinds *kinds, const sk_kind_list *library, skein_category category, const char *name) {
    const skein_kind *kind;
    for (size_t i = 0; (kind = sk_outside_at(kinds, category, i)); i++)
        if (!strcmp(kind->name, name)) return true;
    return library_type(library, category, name) != NULL;
}

static skein_status fill_by_formula(sk_outside *outside, sk_allocator *allocator, const skein_kind *kind,
                                    const sk_kind_list *library, skein_error *error) {
    const void *given = kind;
    const char *text = formula_of(kind);
    if (kind->category == SKEIN_FORCE) {
        const skein_force_type *force = given;
        const sk_force_type *base = library_type(library, SKEIN_FORCE, force->formula ? "force_field" : "potential");
        outside->per = sk_field_named(base->kind.fields, base->kind.field_count, "per");
        outside->per_place = force->per_particle;
        return sk_outside_by_formula(outside, allocator, base, sizeof *base, force->formula ? "force" : "energy", text,
                                     error);
    }
    if (kind->category == SKEIN_CONSTRAINT) {
        const char *name = ((const skein_constraint_type *)given)->formula ? "formula" : "energy";
        return sk_outside_by_formula(outside, allocator, library_type(library, SKEIN_CONSTRAINT, name),
                                     sizeof(sk_constraint_type), strcmp(name, "energy") ? "constraint" : name, text,
                                     error);
    }
    return sk_outside_by_formula(outside, allocator, library_type(library, SKEIN_COLLIDER, "formula"),
                                 sizeof(sk_collider_type), "surface", text, error);
}

static skein_status fill(sk_outside *outside, sk_allocator *allocator, const skein_kind *kind,
                         const sk_kind_list *library, skein_error *error) {
    const char *text = formula_of(kind);
    skein_status status = check_kind(kind, text != NULL, error);
    if (status) return status;
    outside->given = kind;
    if (text) return fill_by_formula(outside, allocator, kind, library, error);
    if (!acts(kind))
        return sk_fail(error, SKEIN_ERROR_VALUE, kind->name,
                       "a %s needs a formula, or the function that says how it acts",
                       skein_category_text(kind->category));
    status = sk_outside_by_functions(outside, allocator, kind, error);
    if (status) return status;
    switch (kind->category) {
    case SKEIN_FORCE: sk_outside_force(outside, outside->given); break;
    case SKEIN_COLLIDER: sk_outside_collider(outside, outside->given); break;
    case SKEIN_MOTION: sk_outside_motion(outside, outside->given); break;
    case SKEIN_BODY: sk_outside_body(outside, outside->given); break;
    default: sk_outside_method(outside, outside->given); break;
    }
    return SKEIN_OK;
}

skein_status sk_outside_register(skein_kinds *kinds, const skein_kind *kind, const sk_kind_list *library,
                                 skein_error *error) {
    if (!kinds) return sk_fail_null(error, "kinds");
    if (!kind) return sk_fail_null(error, "kind");
    if (kind->category > SKEIN_METHOD)
        return sk_fail(error, SKEIN_ERROR_VALUE, "category", "kinds of a %s are not registered",
                       skein_category_text(kind->category));
    if (kind->name && is_taken(kinds, library, kind->category, kind->name))
        return sk_fail(error, SKEIN_ERROR_NAME, "name", "there is a %s '%s' already",
                       skein_category_text(kind->category), kind->name);
    sk_outside *outside = NULL;
    if (sk_reserve(&kinds->allocator, (void **)&kinds->data, &kinds->capacity, kinds->count + 1, sizeof(sk_outside *)))
        outside = sk_allocate(&kinds->allocator, sizeof *outside);
    if (!outside) return sk_fail_memory(error, "a kind");
    skein_error words = {SKEIN_OK, "", ""};
    skein_status status = fill(outside, &kinds->allocator, kind, library, &words);
    if (status) {
        if (error) *error = words;
        release(outside, &kinds->allocator);
        return status;
    }
    kinds->data[kinds->count++] = outside;
    return SKEIN_OK;
}
