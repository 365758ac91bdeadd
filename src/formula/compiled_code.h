/* Formulas that a C compiler has compiled (include/skein/compiled.h): what makes two formulas the same, whether code
 * may run here, and the functions that it calls. */
#ifndef SK_FORMULA_COMPILED_CODE_H
#define SK_FORMULA_COMPILED_CODE_H

#include <skein/compiled.h>

#include "formula/formula.h"

/* Finds the formula's hash: of the operations of the value, its derivatives and, of an energy, its second ones, node by
 * node in the graph's order; parameters go by their names. */
skein_status sk_formula_find_hash(skein_formula *formula, skein_error *error);

/* Whether this library, on this processor, may run it; the text that it holds is made into a formula again, which must
 * have its hash. */
skein_status sk_compiled_check(const skein_compiled *compiled, sk_allocator *allocator, skein_error *error);

/* For code of so many lanes. */
const skein_elementary *sk_compiled_elementary(uint32_t lanes);

#endif
