/* SPARING: whether what takes long is to do with fewer frames and cases: where a sanitizer watches, for faults of memory show in a
 * few, and each takes some twenty times as long; and in WebAssembly, for its bits are those of all (test_bits). */
#ifndef SKEIN_TESTS_SPARING_H
#define SKEIN_TESTS_SPARING_H

#ifdef __has_feature // clang
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SPARING 1
#endif
#endif
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__ || defined __wasm__
#define SPARING 1
#endif
#ifndef SPARING
#define SPARING 0
#endif

#endif
