/* What the library's tests use of cmocka, where that cannot be: WebAssembly's C has no setjmp, so the first assertion
 * that fails ends the program, and a test that is skipped returns. The same names, the same meaning else. */
#ifndef SKEIN_TESTS_WASM_CMOCKA_H
#define SKEIN_TESTS_WASM_CMOCKA_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef int (*CMFixtureFunction)(void **state);

struct CMUnitTest {
    const char *name;
    void (*run)(void **state);
    CMFixtureFunction setup, teardown;
    void *state;
};

#define cmocka_unit_test(test_) \
    { #test_, test_, NULL, NULL, NULL }
#define cmocka_unit_test_setup(test_, setup_) \
    { #test_, test_, setup_, NULL, NULL }
#define cmocka_unit_test_setup_teardown(test_, setup_, teardown_) \
    { #test_, test_, setup_, teardown_, NULL }
#define cmocka_unit_test_prestate(test_, state_) \
    { #test_, test_, NULL, NULL, state_ }

static inline _Noreturn void wasm_fail(const char *what, const char *file, int line) {
    printf("[  FAILED  ] %s:%d: %s\n", file, line, what);
    exit(1);
}

/* (All of a program's tests are run.) */
static inline void cmocka_set_test_filter(const char *pattern) {
    (void)pattern;
}

static inline int wasm_run_tests(const struct CMUnitTest *tests, size_t count, CMFixtureFunction setup,
                                 CMFixtureFunction teardown) {
    void *state = NULL;
    if (setup && setup(&state)) wasm_fail("the group's setup", __FILE__, __LINE__);
    for (size_t i = 0; i < count; i++) {
        void *own = tests[i].state ? tests[i].state : state;
        printf("[ RUN      ] %s\n", tests[i].name);
        if (tests[i].setup && tests[i].setup(&own)) wasm_fail("setup", tests[i].name, 0);
        tests[i].run(&own);
        if (tests[i].teardown && tests[i].teardown(&own)) wasm_fail("teardown", tests[i].name, 0);
        printf("[       OK ] %s\n", tests[i].name);
    }
    if (teardown && teardown(&state)) wasm_fail("the group's teardown", __FILE__, __LINE__);
    return 0;
}

#define cmocka_run_group_tests(tests_, setup_, teardown_) \
    wasm_run_tests(tests_, sizeof(tests_) / sizeof *(tests_), setup_, teardown_)
#define cmocka_run_group_tests_name(name_, tests_, setup_, teardown_) cmocka_run_group_tests(tests_, setup_, teardown_)

#define print_message printf
#define print_error printf
#define skip()                    \
    do {                          \
        printf("[  SKIPPED ]\n"); \
        return;                   \
    } while (0)
#define fail() wasm_fail("fail()", __FILE__, __LINE__)
#define fail_msg(...) (printf(__VA_ARGS__), wasm_fail("", __FILE__, __LINE__))

static inline void _assert_true(unsigned long long is, const char *what, const char *file, int line) {
    if (!is) wasm_fail(what, file, line);
}

static inline void wasm_equal(unsigned long long a, unsigned long long b, int equal, const char *what, const char *file,
                              int line) {
    if ((a == b) == equal) return;
    printf("%#llx and %#llx\n", a, b);
    wasm_fail(what, file, line);
}

#define assert_true(a_) _assert_true(!!(a_), #a_, __FILE__, __LINE__)
#define assert_false(a_) _assert_true(!(a_), "not " #a_, __FILE__, __LINE__)
#define assert_null(a_) assert_true((a_) == NULL)
#define assert_non_null(a_) assert_true((a_) != NULL)
#define assert_ptr_equal(a_, b_) assert_true((const void *)(a_) == (const void *)(b_))
#define assert_ptr_not_equal(a_, b_) assert_true((const void *)(a_) != (const void *)(b_))
#define WASM_EQUAL(a_, b_, equal_) \
    wasm_equal((unsigned long long)(a_), (unsigned long long)(b_), equal_, #a_ ", " #b_, __FILE__, __LINE__)
#define assert_int_equal(a_, b_) WASM_EQUAL(a_, b_, 1)
#define assert_int_not_equal(a_, b_) WASM_EQUAL(a_, b_, 0)
#define assert_in_range(a_, least_, most_)                                  \
    assert_true((unsigned long long)(a_) >= (unsigned long long)(least_) && \
                (unsigned long long)(a_) <= (unsigned long long)(most_))
#define assert_float_equal(a_, b_, off_) assert_true((a_) - (b_) <= (off_) && (b_) - (a_) <= (off_))
#define assert_memory_equal(a_, b_, size_) assert_true(!memcmp(a_, b_, size_))
#define assert_memory_not_equal(a_, b_, size_) assert_true(memcmp(a_, b_, size_))

static inline void wasm_same_text(const char *a, const char *b, int equal, const char *file, int line) {
    if ((strcmp(a, b) == 0) == equal) return;
    printf("'%s' and '%s'\n", a, b);
    wasm_fail("texts", file, line);
}
#define assert_string_equal(a_, b_) wasm_same_text(a_, b_, 1, __FILE__, __LINE__)
#define assert_string_not_equal(a_, b_) wasm_same_text(a_, b_, 0, __FILE__, __LINE__)

#endif
