/* All of a kind of constraint but its fields. Included once by each kind, after it has defined SK_ARITY, SK_RESTS,
 * SK_FORMULA, SK_UNIT and what else element.h mentions. */
#include "constraints/element.h"

SK_ELEMENT_KERNELS

#ifdef SK_ISA
#include "constraints/element_arithmetic.h"
#ifndef SK_ONLY_BOUNDS
#include "constraints/element_stiffness.h"
#endif
#include "constraints/element_sweeps.h"
#else
#include "constraints/element_scalar.h"
#endif
