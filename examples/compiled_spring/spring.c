// length(p0 - p1) - L * (1 + 0.2 * sin(t))
//
// Made by `skein formula --emit c`, for constraints of kind `formula`; hash f75ac1749b099922. Compile it with
//     cc -std=gnu17 -O3 -march=native -ffp-contract=off -fno-math-errno -c
// and give spring to skein_formula_register().
// Parameter 0 is L.
#define SKEIN_PARTICLES 2
#define SKEIN_PARAMETERS 1
#define SKEIN_RESTS 0
#define SKEIN_SHARED 2
#define SKEIN_ENERGY 0
#define SKEIN_ONE_SIDED 0
#include <skein/compiled_formula.h>

SHARED_BY_ALL(shared) {
    const REAL x_1 = PARAMETER(0) * (NUMBER(1.0) + NUMBER(0.20000000000000001) * SIN(TIME));
    SHARE(0, x_1);
    SHARE(1, NUMBER(-0.20000000000000001) * (PARAMETER(0) * COS(TIME)));
}

FORMULA(formula) {
    const REAL x_1 = POSITION(0, 0) - POSITION(1, 0);
    const REAL x_2 = POSITION(0, 1) - POSITION(1, 1);
    const REAL x_3 = POSITION(0, 2) - POSITION(1, 2);
    const REAL length_4 = SQRT(x_3 * x_3 + (x_1 * x_1 + x_2 * x_2));
    const REAL d_5 = RECIPROCAL(length_4);
    const REAL d_6 = x_3 * d_5;
    const REAL d_7 = x_2 * d_5;
    const REAL d_8 = x_1 * d_5;
    GRADIENT(0, 0, 0, d_8);
    GRADIENT(0, 0, 1, d_7);
    GRADIENT(0, 0, 2, d_6);
    GRADIENT(0, 1, 0, -d_8);
    GRADIENT(0, 1, 1, -d_7);
    GRADIENT(0, 1, 2, -d_6);
    BY_TIME(0, SHARED(1));
    VALUE(0, length_4 - SHARED(0));
}

static const char *const formula_text[] = {
    "length(p0 - p1) - L * (1 + 0.2 * sin(t))", NULL};
static const char *const formula_parameters[] = {"L", NULL};
SKEIN_COMPILED(spring, UINT64_C(0xf75ac1749b099922), formula_text, formula_parameters);
