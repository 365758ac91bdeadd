/* The floating-point mode of a step: plain IEEE 754, round to nearest, with denormals, without traps. It is set for the
 * caller and every task during a step, and restored after it: a program may use another, such as one that flushes
 * denormals to zero.
 *
 * This is a part of having the same bits on every machine: WebAssembly has no other mode, and processors flush in
 * different ways (x86-64 tests a result after rounding, ARM before). Many processors are slow with denormals, which a
 * settling cloth would reach; so each step ends by setting velocities under 1e-18 m/s to 0 (sk_combine_rest). */
#ifndef SK_BASE_FLOAT_MODE_H
#define SK_BASE_FLOAT_MODE_H

#include <stdint.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

static inline uint64_t sk_float_mode_enter(void) {
#if defined(__x86_64__)
    uint32_t old = _mm_getcsr();
    _mm_setcsr(0x1f80);
    return old;
#elif defined(__aarch64__)
    uint64_t old, mode = 0;
    __asm__ volatile("mrs %0, fpcr" : "=r"(old));
    __asm__ volatile("msr fpcr, %0" : : "r"(mode));
    return old;
#else
    return 0;
#endif
}

static inline void sk_float_mode_leave(uint64_t old) {
#if defined(__x86_64__)
    _mm_setcsr((uint32_t)old);
#elif defined(__aarch64__)
    __asm__ volatile("msr fpcr, %0" : : "r"(old));
#else
    (void)old;
#endif
}

#endif
