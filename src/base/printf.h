/* What a compiler is told of functions that take a format as printf() does. */
#ifndef SK_BASE_PRINTF_H
#define SK_BASE_PRINTF_H

#ifdef __MINGW32__ // where plain printf would be Microsoft's old one, which knows no %zu
#define SK_PRINTF(format_, first_) __attribute__((format(gnu_printf, format_, first_)))
#else
#define SK_PRINTF(format_, first_) __attribute__((format(printf, format_, first_)))
#endif

#endif
