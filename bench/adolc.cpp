// Formulas by ADOL-C (Debian's libadolc-dev), as its manual has it where speed counts: the formula is traced once, what
// differs from element to element being parameters of the trace; then follow forward and reverse passes over that trace
// by the library's own drivers. A trace is of 32 elements side by side, each a result with coordinates of its own: one
// reverse pass gives the gradients of all, and what a driver does once a call (8 of 9 us, were it one element) is shared.
// It computes in double.
#include <adolc/adolc.h>

#include "bench/by_hand.h"
#include "bench/formulas.hpp"

namespace {

const int block = 32;

template <class formula> void trace(short tag) {
    double out;
    trace_on(tag, 1); // keeps what a reverse pass needs
    for (int e = 0; e < block; e++) {
        vec<adouble> p[formula::particles];
        adouble parameter[formula::parameters];
        for (int k = 0; k < formula::particles; k++) // any place where nothing degenerates
            p[k].x <<= k == 1, p[k].y <<= k == 2, p[k].z <<= k == 3;
        for (int k = 0; k < formula::parameters; k++) parameter[k] = mkparam(0.5 + 0.1 * k);
        adouble value = formula::value(p, parameter);
        value >>= out;
    }
    trace_off();
}

template <class formula> void run(const by_hand_input *in, short tag, bool *traced) {
    const int coordinates = 3 * formula::particles, parameters = formula::parameters;
    if (!*traced) trace<formula>(tag);
    *traced = true;
    double x[block * coordinates], parameter[block * parameters], value[block], one[block],
        gradient[block * coordinates];
    for (size_t first = 0; first < in->count; first += block) {
        for (int e = 0; e < block; e++) { // beyond the last it is repeated
            size_t from = first + e < in->count ? first + e : in->count - 1;
            for (int k = 0; k < coordinates; k++)
                x[e * coordinates + k] = in->positions[4 * size_t(in->slot[k / 3][from]) + k % 3];
            for (int k = 0; k < parameters; k++) parameter[e * parameters + k] = in->parameter[k][from];
            one[e] = 1;
        }
        set_param_vec(tag, block * parameters, parameter);
        zos_forward(tag, block, block * coordinates, 1, x, value);
        fos_reverse(tag, block, block * coordinates, one, gradient);
        for (int e = 0; e < block && first + e < in->count; e++) {
            in->output[first + e] = skein_real(value[e]);
            for (int k = 0; k < coordinates; k++)
                in->output[(size_t(k) + 1) * in->stride + first + e] = skein_real(gradient[e * coordinates + k]);
        }
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
