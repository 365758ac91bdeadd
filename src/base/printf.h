/* The attribute that lets compilers check the arguments of functions with a format like printf()'s. */
#ifndef SK_BASE_PRINTF_H
#define SK_BASE_PRINTF_H

#ifdef __MINGW32__ // plain `printf` would mean Microsoft's old one there, which has no %zu
#define SK_PRINTF(format_, first_) __attribute__((format(gnu_printf, format_, first_)))
#else
#define SK_PRINTF(format_, first_) __attribute__((format(printf, format_, first_)))
#endif

#endif
