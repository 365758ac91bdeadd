/* Every method there is, and the orders of those that have one. (helpers.h has the two that most tests are about.) */
#ifndef SKEIN_TESTS_ALL_METHODS_H
#define SKEIN_TESTS_ALL_METHODS_H

static const char *const all_methods[] = {"explicit_euler",
                                          "symplectic_euler",
                                          "lookahead_euler",
                                          "midpoint",
                                          "leapfrog",
                                          "rk4",
                                          "backward_euler",
                                          "xpbd",
                                          "pbd"};

static const struct {
    const char *method;
    int order;
} orders[] = {
    {"explicit_euler", 1},
    {"symplectic_euler", 1},
    {"lookahead_euler", 1},
    {"backward_euler", 1},
    {"midpoint", 2},
    {"leapfrog", 2},
    {"rk4", 4},
};

#endif
