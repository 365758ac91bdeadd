// length(p0 - p1 - rest(dot(cross(p0 - p1, p3 - p1), cross(p2 - p1, p3 - p1)) / dot(cross(p2 - p1, p3 - p1), cross(p2 - p1, p3 - p1))) * (p2 - p1) - rest(dot(cross(p2 - p1, p0 - p1), cross(p2 - p1, p3 - p1)) / dot(cross(p2 - p1, p3 - p1), cross(p2 - p1, p3 - p1))) * (p3 - p1) - rest(dot(p0 - p1, normalize(cross(p2 - p1, p3 - p1)))) * normalize(cross(p2 - p1, p3 - p1)))
// Parameter 0 is the value of rest(...) number 1.
// Parameter 1 is the value of rest(...) number 2.
// Parameter 2 is the value of rest(...) number 3.
TEXT("length(p0 - p1 - rest(dot(cross(p0 - p1, p3 - p1), cross(p2 - p1, p3 - p1)) / dot(cross(p2 - p1, p3 - p1), cross(p2 - p1, p3 - p1))) * (p2 - p1) - rest(dot(cross(p2 - p1, p0 - p1), cross(p2 - p1, p3 - p1)) / dot(cross(p2 - p1, p3 - p1), cross(p2 - p1, p3 - p1))) * (p3 - p1) - rest(dot(p0 - p1, normalize(cross(p2 - p1, p3 - p1)))) * normalize(cross(p2 - p1, p3 - p1)))")
RESTS(rests) {
    const REAL x_1 = POSITION(0, 0) - POSITION(1, 0);
    const REAL x_2 = POSITION(0, 1) - POSITION(1, 1);
    const REAL x_3 = POSITION(0, 2) - POSITION(1, 2);
    const REAL x_4 = POSITION(3, 0) - POSITION(1, 0);
    const REAL x_5 = POSITION(3, 1) - POSITION(1, 1);
    const REAL x_6 = POSITION(3, 2) - POSITION(1, 2);
    const REAL x_7 = POSITION(2, 0) - POSITION(1, 0);
    const REAL x_8 = POSITION(2, 1) - POSITION(1, 1);
    const REAL x_9 = POSITION(2, 2) - POSITION(1, 2);
    const REAL cross_10 = x_6 * x_8 - x_5 * x_9;
    const REAL cross_11 = x_4 * x_9 - x_6 * x_7;
    const REAL cross_12 = x_5 * x_7 - x_4 * x_8;
    const REAL dot_13 = (x_2 * x_6 - x_3 * x_5) * cross_10 + (x_3 * x_4 - x_1 * x_6) * cross_11;
    const REAL dot_14 = (x_1 * x_5 - x_2 * x_4) * cross_12 + dot_13;
    const REAL dot_15 = cross_12 * cross_12 + (cross_10 * cross_10 + cross_11 * cross_11);
    const REAL x_16 = RECIPROCAL(dot_15);
    const REAL dot_17 = cross_10 * (x_3 * x_8 - x_2 * x_9) + cross_11 * (x_1 * x_9 - x_3 * x_7);
    const REAL dot_18 = cross_12 * (x_2 * x_7 - x_1 * x_8) + dot_17;
    const REAL normalize_19 = RECIPROCAL(SQRT(dot_15));
    const REAL dot_20 = x_3 * (cross_12 * normalize_19) + (x_1 * (cross_10 * normalize_19) + x_2 * (cross_11 * normalize_19));
    REST(0, dot_14 * x_16);
    REST(1, x_16 * dot_18);
    REST(2, dot_20);
}

FORMULA(formula) {
    const REAL x_1 = POSITION(3, 0) - POSITION(1, 0);
    const REAL x_2 = POSITION(3, 1) - POSITION(1, 1);
    const REAL x_3 = POSITION(3, 2) - POSITION(1, 2);
    const REAL x_4 = POSITION(2, 0) - POSITION(1, 0);
    const REAL x_5 = POSITION(2, 1) - POSITION(1, 1);
    const REAL x_6 = POSITION(2, 2) - POSITION(1, 2);
    const REAL cross_7 = x_3 * x_5 - x_2 * x_6;
    const REAL cross_8 = x_1 * x_6 - x_3 * x_4;
    const REAL cross_9 = x_2 * x_4 - x_1 * x_5;
    const REAL normalize_10 = SQRT(cross_9 * cross_9 + (cross_7 * cross_7 + cross_8 * cross_8));
    const REAL normalize_11 = RECIPROCAL(normalize_10);
    const REAL x_12 = POSITION(0, 0) - POSITION(1, 0) - x_4 * PARAMETER(0) - x_1 * PARAMETER(1) - cross_7 * normalize_11 * PARAMETER(2);
    const REAL x_13 = POSITION(0, 1) - POSITION(1, 1) - x_5 * PARAMETER(0) - x_2 * PARAMETER(1) - cross_8 * normalize_11 * PARAMETER(2);
    const REAL x_14 = POSITION(0, 2) - POSITION(1, 2) - x_6 * PARAMETER(0) - x_3 * PARAMETER(1) - cross_9 * normalize_11 * PARAMETER(2);
    const REAL length_15 = SQRT(x_14 * x_14 + (x_12 * x_12 + x_13 * x_13));
    const REAL d_16 = RECIPROCAL(length_15);
    const REAL d_17 = x_14 * d_16;
    const REAL d_18 = x_13 * d_16;
    const REAL d_19 = x_12 * d_16;
    const REAL d_20 = PARAMETER(2) * d_17;
    const REAL d_21 = PARAMETER(2) * d_18;
    const REAL d_22 = PARAMETER(2) * d_19;
    const REAL d_23 = normalize_11 * (cross_9 * d_20 + cross_8 * d_21 + cross_7 * d_22);
    const REAL d_24 = normalize_11 * (normalize_11 * d_23);
    const REAL d_25 = NUMBER(0.5) * (cross_9 * d_24);
    const REAL d_26 = d_25 + (d_25 - normalize_11 * d_20);
    const REAL d_27 = NUMBER(0.5) * (cross_8 * d_24);
    const REAL d_28 = d_27 + (d_27 - normalize_11 * d_21);
    const REAL d_29 = NUMBER(0.5) * (cross_7 * d_24);
    const REAL d_30 = d_29 + (d_29 - normalize_11 * d_22);
    const REAL d_31 = PARAMETER(1) * d_19 + x_5 * d_26;
    const REAL d_32 = PARAMETER(0) * d_18 + x_1 * d_26;
    const REAL d_33 = x_4 * d_26 - PARAMETER(1) * d_18;
    const REAL d_34 = x_2 * d_26 - PARAMETER(0) * d_19;
    const REAL d_35 = PARAMETER(1) * d_17 + x_4 * d_28;
    const REAL d_36 = x_3 * d_28;
    const REAL d_37 = x_6 * d_28;
    const REAL d_38 = x_1 * d_28 - PARAMETER(0) * d_17;
    const REAL d_39 = x_6 * d_30;
    const REAL d_40 = x_2 * d_30;
    const REAL d_41 = x_5 * d_30;
    const REAL d_42 = x_3 * d_30;
    GRADIENT(0, 0, 0, d_19);
    GRADIENT(0, 0, 1, d_18);
    GRADIENT(0, 0, 2, d_17);
    GRADIENT(0, 1, 0, d_36 - d_34 + (d_31 - d_37) - d_19);
    GRADIENT(0, 1, 1, d_32 - d_42 + (d_39 - d_33) - d_18);
    GRADIENT(0, 1, 2, d_40 - d_38 + (d_35 - d_41) - d_17);
    GRADIENT(0, 2, 0, d_34 - d_36);
    GRADIENT(0, 2, 1, d_42 - d_32);
    GRADIENT(0, 2, 2, d_38 - d_40);
    GRADIENT(0, 3, 0, d_37 - d_31);
    GRADIENT(0, 3, 1, d_33 - d_39);
    GRADIENT(0, 3, 2, d_41 - d_35);
    VALUE(0, length_15);
}
