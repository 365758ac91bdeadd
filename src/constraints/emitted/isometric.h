// let a = p1 - p0; let b = p2 - p0; let c = p3 - p0; let d = p2 - p1; let e = p3 - p1; let s = sqrt(2 / (length(cross(a, b)) + length(cross(a, c)))); let k = s * dot(a, b) / length(cross(a, b)); let l = s * dot(a, c) / length(cross(a, c)); let m = -s * dot(a, d) / length(cross(a, d)); let n = -s * dot(a, e) / length(cross(a, e)); length(rest(k + l) * a - rest(k + m) * b - rest(l + n) * c)
// Parameter 0 is the value of rest(...) number 1.
// Parameter 1 is the value of rest(...) number 2.
// Parameter 2 is the value of rest(...) number 3.
TEXT("let a = p1 - p0; let b = p2 - p0; let c = p3 - p0; let d = p2 - p1; let e = p3 - p1; let s = sqrt(2 / (length(cross(a, b)) + length(cross(a, c)))); let k = s * dot(a, b) / length(cross(a, b)); let l = s * dot(a, c) / length(cross(a, c)); let m = -s * dot(a, d) / length(cross(a, d)); let n = -s * dot(a, e) / length(cross(a, e)); length(rest(k + l) * a - rest(k + m) * b - rest(l + n) * c)")
RESTS(rests) {
    const REAL a_1 = POSITION(1, 0) - POSITION(0, 0);
    const REAL a_2 = POSITION(1, 1) - POSITION(0, 1);
    const REAL a_3 = POSITION(1, 2) - POSITION(0, 2);
    const REAL b_4 = POSITION(2, 0) - POSITION(0, 0);
    const REAL b_5 = POSITION(2, 1) - POSITION(0, 1);
    const REAL b_6 = POSITION(2, 2) - POSITION(0, 2);
    const REAL c_7 = POSITION(3, 0) - POSITION(0, 0);
    const REAL c_8 = POSITION(3, 1) - POSITION(0, 1);
    const REAL c_9 = POSITION(3, 2) - POSITION(0, 2);
    const REAL d_10 = POSITION(2, 0) - POSITION(1, 0);
    const REAL d_11 = POSITION(2, 1) - POSITION(1, 1);
    const REAL d_12 = POSITION(2, 2) - POSITION(1, 2);
    const REAL e_13 = POSITION(3, 0) - POSITION(1, 0);
    const REAL e_14 = POSITION(3, 1) - POSITION(1, 1);
    const REAL e_15 = POSITION(3, 2) - POSITION(1, 2);
    const REAL cross_16 = a_2 * b_6 - a_3 * b_5;
    const REAL cross_17 = a_3 * b_4 - a_1 * b_6;
    const REAL cross_18 = a_1 * b_5 - a_2 * b_4;
    const REAL length_19 = SQRT(cross_18 * cross_18 + (cross_16 * cross_16 + cross_17 * cross_17));
    const REAL cross_20 = a_2 * c_9 - a_3 * c_8;
    const REAL cross_21 = a_3 * c_7 - a_1 * c_9;
    const REAL cross_22 = a_1 * c_8 - a_2 * c_7;
    const REAL length_23 = SQRT(cross_22 * cross_22 + (cross_20 * cross_20 + cross_21 * cross_21));
    const REAL s_24 = SQRT(NUMBER(2.0) * RECIPROCAL(length_19 + length_23));
    const REAL x_25 = s_24 * (a_3 * b_6 + (a_1 * b_4 + a_2 * b_5));
    const REAL k_26 = x_25 * RECIPROCAL(length_19);
    const REAL x_27 = s_24 * (a_3 * c_9 + (a_1 * c_7 + a_2 * c_8));
    const REAL l_28 = x_27 * RECIPROCAL(length_23);
    const REAL x_29 = s_24 * (a_3 * d_12 + (a_1 * d_10 + a_2 * d_11));
    const REAL cross_30 = a_2 * d_12 - a_3 * d_11;
    const REAL cross_31 = a_3 * d_10 - a_1 * d_12;
    const REAL cross_32 = a_1 * d_11 - a_2 * d_10;
    const REAL length_33 = SQRT(cross_32 * cross_32 + (cross_30 * cross_30 + cross_31 * cross_31));
    const REAL x_34 = s_24 * (a_3 * e_15 + (a_1 * e_13 + a_2 * e_14));
    const REAL cross_35 = a_2 * e_15 - a_3 * e_14;
    const REAL cross_36 = a_3 * e_13 - a_1 * e_15;
    const REAL cross_37 = a_1 * e_14 - a_2 * e_13;
    const REAL length_38 = SQRT(cross_37 * cross_37 + (cross_35 * cross_35 + cross_36 * cross_36));
    REST(0, k_26 + l_28);
    REST(1, k_26 - x_29 * RECIPROCAL(length_33));
    REST(2, l_28 - x_34 * RECIPROCAL(length_38));
}

FORMULA(formula) {
    const REAL x_1 = (POSITION(1, 0) - POSITION(0, 0)) * PARAMETER(0) - (POSITION(2, 0) - POSITION(0, 0)) * PARAMETER(1) - (POSITION(3, 0) - POSITION(0, 0)) * PARAMETER(2);
    const REAL x_2 = (POSITION(1, 1) - POSITION(0, 1)) * PARAMETER(0) - (POSITION(2, 1) - POSITION(0, 1)) * PARAMETER(1) - (POSITION(3, 1) - POSITION(0, 1)) * PARAMETER(2);
    const REAL x_3 = (POSITION(1, 2) - POSITION(0, 2)) * PARAMETER(0) - (POSITION(2, 2) - POSITION(0, 2)) * PARAMETER(1) - (POSITION(3, 2) - POSITION(0, 2)) * PARAMETER(2);
    const REAL length_4 = SQRT(x_3 * x_3 + (x_1 * x_1 + x_2 * x_2));
    const REAL d_5 = RECIPROCAL(length_4);
    const REAL d_6 = x_3 * d_5;
    const REAL d_7 = x_2 * d_5;
    const REAL d_8 = x_1 * d_5;
    const REAL d_9 = PARAMETER(2) * d_6;
    const REAL d_10 = PARAMETER(2) * d_7;
    const REAL d_11 = PARAMETER(2) * d_8;
    const REAL d_12 = PARAMETER(1) * d_6;
    const REAL d_13 = PARAMETER(1) * d_7;
    const REAL d_14 = PARAMETER(1) * d_8;
    const REAL d_15 = PARAMETER(0) * d_6;
    const REAL d_16 = PARAMETER(0) * d_7;
    const REAL d_17 = PARAMETER(0) * d_8;
    GRADIENT(0, 0, 0, d_11 + d_14 - d_17);
    GRADIENT(0, 0, 1, d_10 + d_13 - d_16);
    GRADIENT(0, 0, 2, d_9 + d_12 - d_15);
    GRADIENT(0, 1, 0, d_17);
    GRADIENT(0, 1, 1, d_16);
    GRADIENT(0, 1, 2, d_15);
    GRADIENT(0, 2, 0, -d_14);
    GRADIENT(0, 2, 1, -d_13);
    GRADIENT(0, 2, 2, -d_12);
    GRADIENT(0, 3, 0, -d_11);
    GRADIENT(0, 3, 1, -d_10);
    GRADIENT(0, 3, 2, -d_9);
    VALUE(0, length_4);
}
