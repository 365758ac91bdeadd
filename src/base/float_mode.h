/* The floating-point mode of a step: IEEE 754 as it is written, to nearest, with its thin numbers (denormals), no traps.
 * Set around a step on the caller and in every task, and put back after it: a program may have another, such as one
 * that flushes thin numbers to zero.
 *
 * Part of the same bits on every machine: WebAssembly has no other mode, and processors do not flush alike (x86-64 looks
 * at a result after it is rounded, ARM before). Where thin numbers are slow, as on many processors, a cloth that settles
 * would crawl through them; so each step ends by calling what is slower than 1e-18 m/s at rest (sk_combine_rest). */
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
