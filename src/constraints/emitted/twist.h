// length(rest(1 / sqrt(length(cross(p1 - p0, p3 - p0)))) * (p0 - p1 + p2 - p3))
// Parameter 0 is the value of rest(...) number 1.
TEXT("length(rest(1 / sqrt(length(cross(p1 - p0, p3 - p0)))) * (p0 - p1 + p2 - p3))")
RESTS(rests) {
    const REAL x_1 = POSITION(1, 0) - POSITION(0, 0);
    const REAL x_2 = POSITION(1, 1) - POSITION(0, 1);
    const REAL x_3 = POSITION(1, 2) - POSITION(0, 2);
    const REAL x_4 = POSITION(3, 0) - POSITION(0, 0);
    const REAL x_5 = POSITION(3, 1) - POSITION(0, 1);
    const REAL x_6 = POSITION(3, 2) - POSITION(0, 2);
    const REAL cross_7 = x_2 * x_6 - x_3 * x_5;
    const REAL cross_8 = x_3 * x_4 - x_1 * x_6;
    const REAL cross_9 = x_1 * x_5 - x_2 * x_4;
    const REAL length_10 = SQRT(cross_9 * cross_9 + (cross_7 * cross_7 + cross_8 * cross_8));
    REST(0, RECIPROCAL(SQRT(length_10)));
}

FORMULA(formula) {
    const REAL x_1 = PARAMETER(0) * (POSITION(0, 0) - POSITION(1, 0) + POSITION(2, 0) - POSITION(3, 0));
    const REAL x_2 = PARAMETER(0) * (POSITION(0, 1) - POSITION(1, 1) + POSITION(2, 1) - POSITION(3, 1));
    const REAL x_3 = PARAMETER(0) * (POSITION(0, 2) - POSITION(1, 2) + POSITION(2, 2) - POSITION(3, 2));
    const REAL length_4 = SQRT(x_3 * x_3 + (x_1 * x_1 + x_2 * x_2));
    const REAL d_5 = RECIPROCAL(length_4);
    const REAL d_6 = PARAMETER(0) * (x_3 * d_5);
    const REAL d_7 = PARAMETER(0) * (x_2 * d_5);
    const REAL d_8 = PARAMETER(0) * (x_1 * d_5);
    GRADIENT(0, 0, 0, d_8);
    GRADIENT(0, 0, 1, d_7);
    GRADIENT(0, 0, 2, d_6);
    GRADIENT(0, 1, 0, -d_8);
    GRADIENT(0, 1, 1, -d_7);
    GRADIENT(0, 1, 2, -d_6);
    GRADIENT(0, 2, 0, d_8);
    GRADIENT(0, 2, 1, d_7);
    GRADIENT(0, 2, 2, d_6);
    GRADIENT(0, 3, 0, -d_8);
    GRADIENT(0, 3, 1, -d_7);
    GRADIENT(0, 3, 2, -d_6);
    VALUE(0, length_4);
}
