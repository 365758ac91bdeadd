/* SANITIZED: whether a sanitizer watches this build, which makes it some twenty times as slow. */
#ifndef SKEIN_TESTS_SANITIZED_H
#define SKEIN_TESTS_SANITIZED_H

#ifdef __has_feature // clang
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED 1
#endif
#elif defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define SANITIZED 1
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

#endif
