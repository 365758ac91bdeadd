// length(p0 - p1) <= rest(length(p0 - p1))
// Parameter 0 is the value of rest(...) number 1.
TEXT("length(p0 - p1) <= rest(length(p0 - p1))")
RESTS(rests) {
    const REAL x_1 = POSITION(0, 0) - POSITION(1, 0);
    const REAL x_2 = POSITION(0, 1) - POSITION(1, 1);
    const REAL x_3 = POSITION(0, 2) - POSITION(1, 2);
    const REAL length_4 = SQRT(x_3 * x_3 + (x_1 * x_1 + x_2 * x_2));
    REST(0, length_4);
}

FORMULA(formula) {
    const REAL x_1 = POSITION(0, 0) - POSITION(1, 0);
    const REAL x_2 = POSITION(0, 1) - POSITION(1, 1);
    const REAL x_3 = POSITION(0, 2) - POSITION(1, 2);
    const REAL length_4 = SQRT(x_3 * x_3 + (x_1 * x_1 + x_2 * x_2));
    UNIT_DIVISOR(length_4);
    GRADIENT(0, 0, 0, -x_1);
    GRADIENT(0, 0, 1, -x_2);
    GRADIENT(0, 0, 2, -x_3);
    OPPOSITE(1, 0);
    VALUE(0, PARAMETER(0) - length_4);
}
