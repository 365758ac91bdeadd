// length(cross(p1 - p0, p2 - p0)) / 2 - rest(length(cross(p1 - p0, p2 - p0)) / 2)
// Parameter 0 is the value of rest(...) number 1.
TEXT("length(cross(p1 - p0, p2 - p0)) / 2 - rest(length(cross(p1 - p0, p2 - p0)) / 2)")
RESTS(rests) {
    const REAL x_1 = POSITION(1, 0) - POSITION(0, 0);
    const REAL x_2 = POSITION(1, 1) - POSITION(0, 1);
    const REAL x_3 = POSITION(1, 2) - POSITION(0, 2);
    const REAL x_4 = POSITION(2, 0) - POSITION(0, 0);
    const REAL x_5 = POSITION(2, 1) - POSITION(0, 1);
    const REAL x_6 = POSITION(2, 2) - POSITION(0, 2);
    const REAL cross_7 = x_2 * x_6 - x_3 * x_5;
    const REAL cross_8 = x_3 * x_4 - x_1 * x_6;
    const REAL cross_9 = x_1 * x_5 - x_2 * x_4;
    const REAL length_10 = SQRT(cross_9 * cross_9 + (cross_7 * cross_7 + cross_8 * cross_8));
    REST(0, NUMBER(0.5) * length_10);
}

FORMULA(formula) {
    const REAL x_1 = POSITION(1, 0) - POSITION(0, 0);
    const REAL x_2 = POSITION(1, 1) - POSITION(0, 1);
    const REAL x_3 = POSITION(1, 2) - POSITION(0, 2);
    const REAL x_4 = POSITION(2, 0) - POSITION(0, 0);
    const REAL x_5 = POSITION(2, 1) - POSITION(0, 1);
    const REAL x_6 = POSITION(2, 2) - POSITION(0, 2);
    const REAL cross_7 = x_2 * x_6 - x_3 * x_5;
    const REAL cross_8 = x_3 * x_4 - x_1 * x_6;
    const REAL cross_9 = x_1 * x_5 - x_2 * x_4;
    const REAL length_10 = SQRT(cross_9 * cross_9 + (cross_7 * cross_7 + cross_8 * cross_8));
    const REAL d_11 = RECIPROCAL(length_10);
    const REAL d_12 = cross_9 * d_11;
    const REAL d_13 = cross_8 * d_11;
    const REAL d_14 = cross_7 * d_11;
    const REAL d_15 = NUMBER(0.5) * (x_5 * d_12) + NUMBER(-0.5) * (x_6 * d_13);
    const REAL d_16 = NUMBER(-0.5) * (x_2 * d_12) + NUMBER(0.5) * (x_3 * d_13);
    const REAL d_17 = NUMBER(0.5) * (x_4 * d_13) + NUMBER(-0.5) * (x_5 * d_14);
    const REAL d_18 = NUMBER(0.5) * (x_1 * d_12) + NUMBER(-0.5) * (x_3 * d_14);
    const REAL d_19 = NUMBER(-0.5) * (x_4 * d_12) + NUMBER(0.5) * (x_6 * d_14);
    const REAL d_20 = NUMBER(-0.5) * (x_1 * d_13) + NUMBER(0.5) * (x_2 * d_14);
    GRADIENT(0, 0, 0, -(d_15 + d_16));
    GRADIENT(0, 0, 1, -(d_18 + d_19));
    GRADIENT(0, 0, 2, -(d_17 + d_20));
    GRADIENT(0, 1, 0, d_15);
    GRADIENT(0, 1, 1, d_19);
    GRADIENT(0, 1, 2, d_17);
    GRADIENT(0, 2, 0, d_16);
    GRADIENT(0, 2, 1, d_18);
    GRADIENT(0, 2, 2, d_20);
    VALUE(0, NUMBER(0.5) * length_10 - PARAMETER(0));
}
