// Formulas by ADOL-C (Debian's libadolc-dev), as its manual has it where speed counts: the formula is traced once, what
// differs from element to element being parameters of the trace; then each element is a forward and a reverse pass over
// that trace by the library's own drivers. It computes in double.
#include <adolc/adolc.h>

#include "bench/by_hand.h"
#include "bench/formulas.hpp"

namespace {

template <class formula> void trace(short tag) {
    vec<adouble> p[formula::particles];
    adouble parameter[formula::parameters];
    double out;
    trace_on(tag, 1);                            // keeps what a reverse pass needs
    for (int k = 0; k < formula::particles; k++) // any place where nothing degenerates
        p[k].x <<= k == 1, p[k].y <<= k == 2, p[k].z <<= k == 3;
    for (int k = 0; k < formula::parameters; k++) parameter[k] = mkparam(0.5 + 0.1 * k);
    adouble value = formula::value(p, parameter);
    value >>= out;
    trace_off();
}

template <class formula> void run(const by_hand_input *in, short tag, bool *traced) {
    const int coordinates = 3 * formula::particles;
    if (!*traced) trace<formula>(tag);
    *traced = true;
    double x[coordinates], parameter[formula::parameters], value, one = 1, gradient[coordinates];
    for (size_t e = 0; e < in->count; e++) {
        for (int k = 0; k < coordinates; k++) x[k] = in->positions[4 * size_t(in->slot[k / 3][e]) + k % 3];
        for (int k = 0; k < formula::parameters; k++) parameter[k] = in->parameter[k][e];
        set_param_vec(tag, formula::parameters, parameter);
        zos_forward(tag, 1, coordinates, 1, x, &value);
        fos_reverse(tag, 1, coordinates, &one, gradient);
        in->output[e] = skein_real(value);
        for (int k = 0; k < coordinates; k++) in->output[(size_t(k) + 1) * in->stride + e] = skein_real(gradient[k]);
    }
}

} // namespace

#define BY_ADOLC(name_, tag_)                        \
    void by_adolc_##name_(const by_hand_input *in) { \
        static bool traced;                          \
        run<name_##_formula>(in, tag_, &traced);     \
    }
BY_ADOLC(distance, 1)
BY_ADOLC(dihedral, 2)
BY_ADOLC(volume, 3)
BY_ADOLC(neo_hookean, 4)
BY_ADOLC(stvk, 5)
