/* All that a kind of constraint is made of besides its fields: after SK_ARITY, SK_RESTS, SK_FORMULA, SK_UNIT and what else
 * element.h knows, and after linear() or the like where there is one; once a kind. */
#include "constraints/element.h"

SK_ELEMENT_KERNELS

#ifdef SK_ISA
#include "constraints/element_arithmetic.h"
#include "constraints/element_stiffness.h"
#include "constraints/element_sweeps.h"
#else
#include "constraints/element_scalar.h"
#endif
