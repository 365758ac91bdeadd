/* The distance by another formula, for test_emitted.c. */
#define sk_distance sk_changed_distance
#define SK_FORMULA "changed_distance.h"
#define SK_UNIT changed_distance
#include "constraints/distance.c"
