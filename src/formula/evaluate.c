/* The body is evaluate_in.h, once for each format. */
#include "formula/evaluate.h"

#include "base/elementary.h"

#define NUMBER double
#define NAME(name_) name_##_double
#define ELEMENTARY(name_) sk_##name_
#define ROOT __builtin_sqrt
#define LEAST SK_LEAST_DOUBLE
#define MOST_EXP SK_MOST_EXP_DOUBLE
#include "formula/evaluate_in.h"
#undef NUMBER
#undef NAME
#undef ELEMENTARY
#undef ROOT
#undef LEAST
#undef MOST_EXP

#define NUMBER float
#define NAME(name_) name_##_float
#define ELEMENTARY(name_) sk_##name_##f
#define ROOT __builtin_sqrtf
#define LEAST SK_LEAST_FLOAT
#define MOST_EXP SK_MOST_EXP_FLOAT
#include "formula/evaluate_in.h"
