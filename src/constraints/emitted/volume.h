// dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6 - rest(dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6)
// Parameter 0 is the value of rest(...) number 1.
TEXT("dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6 - rest(dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6)")
RESTS(rests) {
    const REAL x_1 = POSITION(1, 0) - POSITION(0, 0);
    const REAL x_2 = POSITION(1, 1) - POSITION(0, 1);
    const REAL x_3 = POSITION(1, 2) - POSITION(0, 2);
    const REAL x_4 = POSITION(2, 0) - POSITION(0, 0);
    const REAL x_5 = POSITION(2, 1) - POSITION(0, 1);
    const REAL x_6 = POSITION(2, 2) - POSITION(0, 2);
    const REAL dot_7 = (x_2 * x_6 - x_3 * x_5) * (POSITION(3, 0) - POSITION(0, 0)) + (x_3 * x_4 - x_1 * x_6) * (POSITION(3, 1) - POSITION(0, 1));
    const REAL dot_8 = (x_1 * x_5 - x_2 * x_4) * (POSITION(3, 2) - POSITION(0, 2)) + dot_7;
    REST(0, NUMBER(0.16666666666666666) * dot_8);
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
    const REAL x_10 = POSITION(3, 0) - POSITION(0, 0);
    const REAL x_11 = POSITION(3, 1) - POSITION(0, 1);
    const REAL x_12 = POSITION(3, 2) - POSITION(0, 2);
    const REAL x_13 = NUMBER(0.16666666666666666) * (cross_9 * x_12 + (cross_7 * x_10 + cross_8 * x_11));
    const REAL d_14 = NUMBER(0.16666666666666666) * (x_5 * x_12) + NUMBER(-0.16666666666666666) * (x_6 * x_11);
    const REAL d_15 = NUMBER(-0.16666666666666666) * (x_2 * x_12) + NUMBER(0.16666666666666666) * (x_3 * x_11);
    const REAL d_16 = NUMBER(0.16666666666666666) * (x_4 * x_11) + NUMBER(-0.16666666666666666) * (x_5 * x_10);
    const REAL d_17 = NUMBER(0.16666666666666666) * (x_1 * x_12) + NUMBER(-0.16666666666666666) * (x_3 * x_10);
    const REAL d_18 = NUMBER(-0.16666666666666666) * (x_4 * x_12) + NUMBER(0.16666666666666666) * (x_6 * x_10);
    const REAL d_19 = NUMBER(-0.16666666666666666) * (x_1 * x_11) + NUMBER(0.16666666666666666) * (x_2 * x_10);
    GRADIENT(0, 0, 0, NUMBER(-0.16666666666666666) * cross_7 - d_15 - d_14);
    GRADIENT(0, 0, 1, NUMBER(-0.16666666666666666) * cross_8 - d_17 - d_18);
    GRADIENT(0, 0, 2, NUMBER(-0.16666666666666666) * cross_9 - d_19 - d_16);
    GRADIENT(0, 1, 0, d_14);
    GRADIENT(0, 1, 1, d_18);
    GRADIENT(0, 1, 2, d_16);
    GRADIENT(0, 2, 0, d_15);
    GRADIENT(0, 2, 1, d_17);
    GRADIENT(0, 2, 2, d_19);
    GRADIENT(0, 3, 0, NUMBER(0.16666666666666666) * cross_7);
    GRADIENT(0, 3, 1, NUMBER(0.16666666666666666) * cross_8);
    GRADIENT(0, 3, 2, NUMBER(0.16666666666666666) * cross_9);
    VALUE(0, x_13 - PARAMETER(0));
}
