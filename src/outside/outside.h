/* Kinds that programs register (skein/kinds.h): each becomes a type like the library's own, so that other parts of the
 * library make no difference.
 *
 *   by formula    a copy of the library's type for such texts, with the text fixed, and a table in which the kind's own
 *                 fields lie where that type keeps its parameters (by_formula.c)
 *   by functions  a type whose functions call the program's. Its parameters begin with a cache line that points to the
 *                 type, followed by the program's own struct (force.c, collider.c, ...)
 *
 * Owns the registries. A kind's address is its type's, and that is its sk_outside's. */
#ifndef SK_OUTSIDE_OUTSIDE_H
#define SK_OUTSIDE_OUTSIDE_H

#include <skein/kinds.h>

#include "base/status.h"
#include "bodies/body.h"

typedef struct sk_outside sk_outside;
struct sk_outside {
    union {
        skein_kind kind;
        sk_body_type body;
        sk_constraint_type constraint;
        sk_force_type force;
        sk_collider_type collider;
        sk_motion_type motion;
        sk_method_type method;
    } type;              /* first */
    const void *given;   /* what was registered */
    skein_field *fields; /* of `type` */
    sk_making making;    /* the type's, if it has one */
    /* by formula: */
    skein_kind inner; /* as the copied type's making has it: its fields are "parameters.NAME" */
    char *names;
    const sk_making *copied;
    const char *text;
    size_t text_offset;
    const skein_field *per; /* a choice that is fixed, too; NULL: there is none */
    int32_t per_place;
    const skein_field *substeps; /* of a method */
};

struct skein_kinds {
    sk_allocator allocator;
    sk_outside **data;
    size_t count, capacity;
};

/* The beginning of the parameters of a kind by functions. */
typedef struct sk_outside_params {
    _Alignas(64) const sk_outside *outside;
} sk_outside_params;

static inline const sk_outside *sk_outside_of(const void *params) {
    return ((const sk_outside_params *)params)->outside;
}
static inline const void *sk_given_params(const void *params) {
    return (const char *)params + sizeof(sk_outside_params);
}

/* The library's own types of a category, passed down by the catalogue. */
typedef struct sk_kind_list {
    const void *const *data;
    size_t count;
} sk_kind_list;

/* Fill in the type, once `given` is set. */
skein_status sk_outside_by_formula(sk_outside *outside, sk_allocator *allocator, const void *base, size_t base_size,
                                   const char *text_field, const char *text, skein_error *error);
skein_status sk_outside_by_functions(sk_outside *outside, sk_allocator *allocator, const skein_kind *kind,
                                     skein_error *error);
void sk_outside_force(sk_outside *outside, const skein_force_type *given);
void sk_outside_collider(sk_outside *outside, const skein_collider_type *given);
void sk_outside_motion(sk_outside *outside, const skein_motion_type *given);
void sk_outside_body(sk_outside *outside, const skein_body_type *given);
void sk_outside_method(sk_outside *outside, const skein_method_type *given);

/* Registers a kind. `library` has the library's own kinds, a list for each category. */
skein_status sk_outside_register(skein_kinds *kinds, const skein_kind *kind, const sk_kind_list *library,
                                 skein_error *error);
/* The registered kind at a place in its category, or by its name; NULL: there is none. */
const skein_kind *sk_outside_at(const skein_kinds *kinds, skein_category category, size_t index);

#endif
