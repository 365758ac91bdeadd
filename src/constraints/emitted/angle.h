// angle(p0 - p1, p2 - p1) - rest(angle(p0 - p1, p2 - p1))
// Parameter 0 is the value of rest(...) number 1.
TEXT("angle(p0 - p1, p2 - p1) - rest(angle(p0 - p1, p2 - p1))")
RESTS(rests) {
    const REAL x_1 = POSITION(0, 0) - POSITION(1, 0);
    const REAL x_2 = POSITION(0, 1) - POSITION(1, 1);
    const REAL x_3 = POSITION(0, 2) - POSITION(1, 2);
    const REAL x_4 = POSITION(2, 0) - POSITION(1, 0);
    const REAL x_5 = POSITION(2, 1) - POSITION(1, 1);
    const REAL x_6 = POSITION(2, 2) - POSITION(1, 2);
    const REAL angle_7 = x_2 * x_6 - x_3 * x_5;
    const REAL angle_8 = x_3 * x_4 - x_1 * x_6;
    const REAL angle_9 = x_1 * x_5 - x_2 * x_4;
    const REAL angle_10 = SQRT(angle_9 * angle_9 + (angle_7 * angle_7 + angle_8 * angle_8));
    const REAL angle_11 = ATAN2(angle_10, x_3 * x_6 + (x_1 * x_4 + x_2 * x_5));
    REST(0, angle_11);
}

FORMULA(formula) {
    const REAL x_1 = POSITION(0, 0) - POSITION(1, 0);
    const REAL x_2 = POSITION(0, 1) - POSITION(1, 1);
    const REAL x_3 = POSITION(0, 2) - POSITION(1, 2);
    const REAL x_4 = POSITION(2, 0) - POSITION(1, 0);
    const REAL x_5 = POSITION(2, 1) - POSITION(1, 1);
    const REAL x_6 = POSITION(2, 2) - POSITION(1, 2);
    const REAL angle_7 = x_2 * x_6 - x_3 * x_5;
    const REAL angle_8 = x_3 * x_4 - x_1 * x_6;
    const REAL angle_9 = x_1 * x_5 - x_2 * x_4;
    const REAL angle_10 = SQRT(angle_9 * angle_9 + (angle_7 * angle_7 + angle_8 * angle_8));
    const REAL angle_11 = x_3 * x_6 + (x_1 * x_4 + x_2 * x_5);
    const REAL d_12 = RECIPROCAL(angle_11 * angle_11 + angle_10 * angle_10);
    const REAL d_13 = angle_10 * d_12;
    const REAL d_14 = angle_11 * d_12 * RECIPROCAL(angle_10);
    const REAL d_15 = angle_9 * d_14;
    const REAL d_16 = angle_8 * d_14;
    const REAL d_17 = angle_7 * d_14;
    const REAL d_18 = x_5 * d_13 + x_4 * d_15;
    const REAL d_19 = x_1 * d_13 + x_2 * d_15;
    const REAL d_20 = x_5 * d_15 - x_4 * d_13;
    const REAL d_21 = x_1 * d_15 - x_2 * d_13;
    const REAL d_22 = x_6 * d_16;
    const REAL d_23 = x_3 * d_13 + x_1 * d_16;
    const REAL d_24 = x_4 * d_16 - x_6 * d_13;
    const REAL d_25 = x_3 * d_16;
    const REAL d_26 = x_5 * d_17;
    const REAL d_27 = x_3 * d_17;
    const REAL d_28 = x_6 * d_17;
    const REAL d_29 = x_2 * d_17;
    GRADIENT(0, 0, 0, d_20 - d_22);
    GRADIENT(0, 0, 1, d_28 - d_18);
    GRADIENT(0, 0, 2, d_24 - d_26);
    GRADIENT(0, 1, 0, d_19 - d_25 + (d_22 - d_20));
    GRADIENT(0, 1, 1, d_27 - d_21 + (d_18 - d_28));
    GRADIENT(0, 1, 2, d_23 - d_29 + (d_26 - d_24));
    GRADIENT(0, 2, 0, d_25 - d_19);
    GRADIENT(0, 2, 1, d_21 - d_27);
    GRADIENT(0, 2, 2, d_29 - d_23);
    VALUE(0, ATAN2(angle_10, angle_11) - PARAMETER(0));
}
