// Formulas by forward-mode dual numbers, as a textbook has them: a class of a value and N derivatives, of which each
// operation works out all. Built with -O3 -march=native.
#include <cmath>

#include "bench/by_hand.h"
#include "bench/formulas.hpp"

namespace {

typedef skein_real real;

template <int N> struct dual {
    real v, d[N];
    dual() {}
    dual(double value) : v(real(value)) {
        for (int i = 0; i < N; i++) d[i] = 0;
    }
    friend dual operator+(const dual &a, const dual &b) {
        dual c;
        c.v = a.v + b.v;
        for (int i = 0; i < N; i++) c.d[i] = a.d[i] + b.d[i];
        return c;
    }
    friend dual operator-(const dual &a, const dual &b) {
        dual c;
        c.v = a.v - b.v;
        for (int i = 0; i < N; i++) c.d[i] = a.d[i] - b.d[i];
        return c;
    }
    friend dual operator*(const dual &a, const dual &b) {
        dual c;
        c.v = a.v * b.v;
        for (int i = 0; i < N; i++) c.d[i] = a.d[i] * b.v + a.v * b.d[i];
        return c;
    }
    // with plain numbers, which have no derivatives
    friend dual operator+(const dual &a, double b) {
        dual c = a;
        c.v += real(b);
        return c;
    }
    friend dual operator-(const dual &a, double b) {
        return a + -b;
    }
    friend dual operator*(const dual &a, double b) {
        return a.chain(a.v * real(b), real(b));
    }
    friend dual sqrt(const dual &a) {
        real root = std::sqrt(a.v);
        return a.chain(root, root > 0 ? 1 / (2 * root) : 0);
    }
    friend dual log(const dual &a) {
        return a.chain(std::log(a.v), 1 / a.v);
    }
    friend dual atan2(const dual &y, const dual &x) {
        dual c;
        real square = x.v * x.v + y.v * y.v, over = square > 0 ? 1 / square : 0;
        c.v = std::atan2(y.v, x.v);
        for (int i = 0; i < N; i++) c.d[i] = (x.v * y.d[i] - y.v * x.d[i]) * over;
        return c;
    }

  private:
    dual chain(real value, real slope) const {
        dual c;
        c.v = value;
        for (int i = 0; i < N; i++) c.d[i] = slope * d[i];
        return c;
    }
};

template <class formula> void run(const by_hand_input *in) {
    const int coordinates = 3 * formula::particles;
    typedef dual<coordinates> number;
    for (size_t e = 0; e < in->count; e++) {
        vec<number> p[formula::particles];
        real parameter[formula::parameters];
        for (int k = 0; k < formula::particles; k++) {
            const real *x = in->positions + 4 * size_t(in->slot[k][e]);
            p[k].x = number(x[0]), p[k].y = number(x[1]), p[k].z = number(x[2]);
            p[k].x.d[3 * k] = p[k].y.d[3 * k + 1] = p[k].z.d[3 * k + 2] = 1;
        }
        for (int k = 0; k < formula::parameters; k++) parameter[k] = in->parameter[k][e];
        number value = formula::value(p, parameter);
        in->output[e] = value.v;
        for (int k = 0; k < coordinates; k++) in->output[(size_t(k) + 1) * in->stride + e] = value.d[k];
    }
}

} // namespace

void by_dual_distance(const by_hand_input *in) {
    run<distance_formula>(in);
}
void by_dual_dihedral(const by_hand_input *in) {
    run<dihedral_formula>(in);
}
void by_dual_volume(const by_hand_input *in) {
    run<volume_formula>(in);
}
void by_dual_neo_hookean(const by_hand_input *in) {
    run<neo_hookean_formula>(in);
}
void by_dual_stvk(const by_hand_input *in) {
    run<stvk_formula>(in);
}
