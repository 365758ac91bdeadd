/* Fields: parameters described once, as rows of a table. From a table this file fills in defaults,
 * checks values and reads and writes them in a parameter struct.
 *
 * How a type is stored at its offset: BOOL bool, INT int32_t, INT2 int32_t[2], INT3 int32_t[3], REAL double,
 * REAL2 double[2], VEC3 double[3], CHOICE int32_t (the word's place), TEXT char * (owned). */
#ifndef SK_BASE_FIELDS_H
#define SK_BASE_FIELDS_H

#include "base/memory.h"

/* Table rows, so that a kind's table reads like a page of the manual. `s` is the parameter struct. */
// clang-format off
#define SK_BOOL(s, member, name_, initial_, help_)                                                            \
    {name_, SKEIN_FIELD_BOOL, offsetof(s, member), "", {initial_, 0, 0}, 0, 1, NULL, NULL, help_}
#define SK_INT(s, member, name_, unit_, initial_, least_, most_, help_)                                       \
    {name_, SKEIN_FIELD_INT, offsetof(s, member), unit_, {initial_, 0, 0}, least_, most_, NULL, NULL, help_}
#define SK_INT2(s, member, name_, unit_, a_, b_, least_, most_, help_)                                        \
    {name_, SKEIN_FIELD_INT2, offsetof(s, member), unit_, {a_, b_, 0}, least_, most_, NULL, NULL, help_}
#define SK_INT3(s, member, name_, unit_, a_, b_, c_, least_, most_, help_)                                    \
    {name_, SKEIN_FIELD_INT3, offsetof(s, member), unit_, {a_, b_, c_}, least_, most_, NULL, NULL, help_}
#define SK_REAL(s, member, name_, unit_, initial_, least_, most_, help_)                                      \
    {name_, SKEIN_FIELD_REAL, offsetof(s, member), unit_, {initial_, 0, 0}, least_, most_, NULL, NULL, help_}
#define SK_REAL2(s, member, name_, unit_, a_, b_, least_, most_, help_)                                       \
    {name_, SKEIN_FIELD_REAL2, offsetof(s, member), unit_, {a_, b_, 0}, least_, most_, NULL, NULL, help_}
#define SK_VEC3(s, member, name_, unit_, x_, y_, z_, help_)                                                   \
    {name_, SKEIN_FIELD_VEC3, offsetof(s, member), unit_, {x_, y_, z_}, -SK_FAR, SK_FAR, NULL, NULL, help_}
#define SK_SIZE3(s, member, name_, unit_, x_, y_, z_, help_)                                                  \
    {name_, SKEIN_FIELD_VEC3, offsetof(s, member), unit_, {x_, y_, z_}, 1e-6, 1e9, NULL, NULL, help_}
#define SK_TEXT(s, member, name_, initial_, help_)                                                            \
    {name_, SKEIN_FIELD_TEXT, offsetof(s, member), "", {0, 0, 0}, 0, 0, NULL, initial_, help_}
#define SK_CHOICE(s, member, name_, initial_, choices_, help_)                                                \
    {name_, SKEIN_FIELD_CHOICE, offsetof(s, member), "", {initial_, 0, 0}, 0, 0, choices_, NULL, help_}
/* The parameters of an object's formulas, an array of SKEIN_FORMULA_MOST_PARAMETERS doubles: formula/parameters.h. */
#define SK_PARAMETERS(s, member, help_)                                                                       \
    {"parameters.*", SKEIN_FIELD_REAL, offsetof(s, member), "", {0, 0, 0}, -SK_FAR, SK_FAR, NULL, NULL, help_}
// clang-format on

/* The largest finite length, speed or force that a field takes: squares of it stay finite in float. */
#define SK_FAR 1e15
/* "Infinite" where a kind allows it, such as the stiffness of a rigid distance. */
#define SK_UNBOUNDED __builtin_inf()

/* A choice whose words stand for values of other fields (a fabric: a density, a stiffness ...). The first stands for
 * none. */
typedef struct sk_presets {
    const char *field;        /* the choice */
    const char *const *names; /* of fields that take one number */
    size_t count;
    const double *values; /* `count` for each word but the first; NaN: the field's own default */
} sk_presets;

/* Fills `params` with the table's defaults. Text fields are copied; false when there is no memory. */
bool sk_fields_default(sk_allocator *allocator, const skein_field *fields, size_t count, void *params);
/* Releases the text fields. */
void sk_fields_clear(sk_allocator *allocator, const skein_field *fields, size_t count, void *params);
/* Checks and stores one value. */
skein_status sk_field_store(sk_allocator *allocator, const skein_field *field, void *params, const skein_value *value,
                            skein_error *error);
/* Whether two values are one number, or one text. */
bool sk_values_are_same(const skein_value *a, const skein_value *b);
skein_value sk_field_load(const skein_field *field, const void *params);
/* Stores the values that the chosen word in `params` stands for. */
skein_status sk_presets_apply(sk_allocator *allocator, const sk_presets *presets, const skein_field *fields,
                              size_t count, void *params, skein_error *error);
/* The field of that name, or NULL. */
const skein_field *sk_field_named(const skein_field *fields, size_t count, const char *name);

#endif
