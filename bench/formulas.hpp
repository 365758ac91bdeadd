/* Formulas written once for any class of numbers: for a textbook's duals (dual.cpp) and for ADOL-C (adolc.cpp). `real`
 * is what their parameters are. */
#ifndef SKEIN_BENCH_FORMULAS_HPP
#define SKEIN_BENCH_FORMULAS_HPP

template <class number> struct vec { number x, y, z; };
template <class number> vec<number> operator+(const vec<number> &a, const vec<number> &b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class number> vec<number> operator-(const vec<number> &a, const vec<number> &b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class number, class factor> vec<number> operator*(const vec<number> &a, const factor &s) {
    return {a.x * s, a.y * s, a.z * s};
}
template <class number> number dot(const vec<number> &a, const vec<number> &b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class number> vec<number> cross(const vec<number> &a, const vec<number> &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class number> number length(const vec<number> &a) {
    return sqrt(dot(a, a));
}

struct distance_formula {
    static const int particles = 2, parameters = 1;
    template <class number, class real> static number value(const vec<number> *p, const real *q) {
        return length(p[1] - p[0]) - q[0];
    }
};

struct dihedral_formula {
    static const int particles = 4, parameters = 1;
    template <class number, class real> static number value(const vec<number> *p, const real *q) {
        vec<number> e = p[1] - p[0], a = p[2] - p[0], b = p[3] - p[0], left = cross(e, a), right = cross(b, e);
        return atan2(length(e) * dot(left, b), dot(left, right)) - q[0];
    }
};

struct volume_formula {
    static const int particles = 4, parameters = 1;
    template <class number, class real> static number value(const vec<number> *p, const real *q) {
        return dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) * (1.0 / 6) - q[0];
    }
};

struct neo_hookean_formula {
    static const int particles = 4, parameters = 10;
    template <class number, class real> static number value(const vec<number> *p, const real *d) {
        vec<number> a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
        vec<number> f0 = a * d[0] + b * d[3] + c * d[6], f1 = a * d[1] + b * d[4] + c * d[7],
                    f2 = a * d[2] + b * d[5] + c * d[8];
        number i = dot(f0, f0) + dot(f1, f1) + dot(f2, f2), j = dot(f0, cross(f1, f2)) - 1.25;
        return ((i - 3.0) * 0.5 + j * j * 1.5 - log(i + 1.0) * 0.5) * d[9];
    }
};

struct stvk_formula {
    static const int particles = 3, parameters = 5;
    template <class number, class real> static number value(const vec<number> *p, const real *d) {
        vec<number> a = p[1] - p[0], b = p[2] - p[0], f = a * d[0] + b * d[2], g = a * d[1] + b * d[3];
        number x = (dot(f, f) - 1.0) * 0.5, y = (dot(g, g) - 1.0) * 0.5, z = dot(f, g) * 0.5, trace = x + y;
        return (x * x + y * y + z * z * 2.0 + trace * trace * 1.5) * d[4];
    }
};

#endif
