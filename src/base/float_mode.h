/* The floating-point mode of a step: round to nearest, denormals are zero. Part of the same bits on every
 * machine, and a settled cloth would otherwise crawl through denormals. Set around a step on the caller
 * and in every task, and put back after it. */
#ifndef SK_BASE_FLOAT_MODE_H
#define SK_BASE_FLOAT_MODE_H

#include <stdint.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

static inline uint64_t sk_float_mode_enter(void) {
#if defined(__x86_64__)
    uint32_t old = _mm_getcsr();
    _mm_setcsr(0x1f80 | 0x8040); // no traps, to nearest; results and operands that are denormal become zero
    return old;
#elif defined(__aarch64__)
    uint64_t old, mode = (uint64_t)1 << 24; // to nearest; flush to zero
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
