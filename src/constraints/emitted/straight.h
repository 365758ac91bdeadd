// length(rest(1 / length(p0 - p1)) * (p0 - p1) + rest(1 / length(p2 - p1)) * (p2 - p1))
// Parameter 0 is the value of rest(...) number 1.
// Parameter 1 is the value of rest(...) number 2.
TEXT("length(rest(1 / length(p0 - p1)) * (p0 - p1) + rest(1 / length(p2 - p1)) * (p2 - p1))")
RESTS(rests) {
    const REAL x_1 = POSITION(0, 0) - POSITION(1, 0);
    const REAL x_2 = POSITION(0, 1) - POSITION(1, 1);
    const REAL x_3 = POSITION(0, 2) - POSITION(1, 2);
    const REAL length_4 = SQRT(x_3 * x_3 + (x_1 * x_1 + x_2 * x_2));
    const REAL x_5 = POSITION(2, 0) - POSITION(1, 0);
    const REAL x_6 = POSITION(2, 1) - POSITION(1, 1);
    const REAL x_7 = POSITION(2, 2) - POSITION(1, 2);
    const REAL length_8 = SQRT(x_7 * x_7 + (x_5 * x_5 + x_6 * x_6));
    REST(0, RECIPROCAL(length_4));
    REST(1, RECIPROCAL(length_8));
}

FORMULA(formula) {
    const REAL x_1 = (POSITION(0, 0) - POSITION(1, 0)) * PARAMETER(0) + (POSITION(2, 0) - POSITION(1, 0)) * PARAMETER(1);
    const REAL x_2 = (POSITION(0, 1) - POSITION(1, 1)) * PARAMETER(0) + (POSITION(2, 1) - POSITION(1, 1)) * PARAMETER(1);
    const REAL x_3 = (POSITION(0, 2) - POSITION(1, 2)) * PARAMETER(0) + (POSITION(2, 2) - POSITION(1, 2)) * PARAMETER(1);
    const REAL length_4 = SQRT(x_3 * x_3 + (x_1 * x_1 + x_2 * x_2));
    const REAL d_5 = RECIPROCAL(length_4);
    const REAL d_6 = x_3 * d_5;
    const REAL d_7 = x_2 * d_5;
    const REAL d_8 = x_1 * d_5;
    const REAL d_9 = PARAMETER(1) * d_6;
    const REAL d_10 = PARAMETER(1) * d_7;
    const REAL d_11 = PARAMETER(1) * d_8;
    const REAL d_12 = PARAMETER(0) * d_6;
    const REAL d_13 = PARAMETER(0) * d_7;
    const REAL d_14 = PARAMETER(0) * d_8;
    GRADIENT(0, 0, 0, d_14);
    GRADIENT(0, 0, 1, d_13);
    GRADIENT(0, 0, 2, d_12);
    GRADIENT(0, 1, 0, -(d_11 + d_14));
    GRADIENT(0, 1, 1, -(d_10 + d_13));
    GRADIENT(0, 1, 2, -(d_9 + d_12));
    GRADIENT(0, 2, 0, d_11);
    GRADIENT(0, 2, 1, d_10);
    GRADIENT(0, 2, 2, d_9);
    VALUE(0, length_4);
}
