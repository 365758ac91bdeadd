/* Tests of `skein formula`: answers, faults with their place, and the languages that it writes. */
#include "test_command.h"

static void it_answers(void **state) {
    (void)state;
    assert_says(0, "value      3\nd/dp0      -0.6 -0.8 0\nd/dp1      0.6 0.8 0\n", "", "formula", "length(p0-p1) - L",
                "--at", "0,0,0 3,4,0", "--param", "L=2", "--grad");
    assert_says(0, "value      3\n", "", "formula", "length(p0-p1) - L", "--at", "0,0,0; 3,4,0", "--param=L=2");
    assert_says(0, "value      3\n", "", "formula", "length(p0-p1) - L", "--at", "0,0,0", "--at", "3,4,0", "--param",
                "L=2");
    assert_says(0, "value >= 0 -3\n", "", "formula", "length(p0-p1) <= L", "--at", "0,0,0 3,4,0", "--param", "L=2");
    assert_says(0, "value      4\n", "", "formula", "length(p0-p1) - rest(length(p0-p1))", "--at", "0,0,0 3,4,0",
                "--rest", "0,0,0 1,0,0");
    assert_says(0,
                "value      0 -2 0\nd.x/dp0    0 0 0\nd.x/dv0    -2 0 0\nd.y/dp0    0 0 0\nd.y/dv0    0 -2 0\n"
                "d.z/dp0    0 0 0\nd.z/dv0    0 0 -2\n",
                "", "formula", "--at", "0,0,0", "--velocity", "0,1,0", "--grad", "--", "-2*v");
    assert_says(0, "value      0.5\nd/dp0      1 0 0\nd/dt       2\n", "", "formula", "p.x + t^2", "--at", "-0.5,0,0",
                "--time", "1", "--grad");
}

static void it_says_where_it_guards(void **state) {
    (void)state;
    outcome o = SKEIN("formula", "length(p0-p1)", "--at", "1,2,3 1,2,3", "--grad");
    assert_status(o, 0);
    assert_contains(o.out, "d/dp0      0 0 0\n");
    assert_contains(o.out, "guarded");
    outcome_free(&o);
    o = SKEIN("formula", "acos(dot(p0, p1))", "--at", "1,0,0 0,1,0");
    assert_status(o, 0);
    assert_contains(o.err, "warning: line 1, column 1: acos of a dot product is inexact");
    assert_contains(o.err, "acos(dot(p0, p1))\n^^^^^^^^^^^^^^^^^\n");
    outcome_free(&o);
}

static void it_shows_faults(void **state) {
    (void)state;
    assert_says(2, "",
                "skein formula: line 2, column 5: there is no name 'lenght'; did you mean 'length'?\n"
                "1 + lenght(p0)\n"
                "    ^^^^^^\n",
                "formula", "let a = 2;\n1 + lenght(p0)", "--at", "0,0,0");
    static const struct {
        const char *arguments[4], *message;
    } cases[] = {{{"p0.x"}, "give their places, as in --at"},
                 {{"p0.x", "--at", "1,2"}, "expected points as x,y,z"},
                 {{"p0.x", "--at", "1,2,nan"}, "expected points as x,y,z"},
                 {{"L", "--param", "L"}, "a name and a number, as in L=0.5"},
                 {{"L", "--param", "L=x"}, "a name and a number"},
                 {{"L", "--param", "sin=1"}, "'sin' cannot be a parameter"},
                 {{"t", "--time", "noon"}, "a number of seconds"},
                 {{"1", "--emit", "rust"}, "expected c, function, glsl or kernel"},
                 {{"vec3(1,2,3)", "--hessian"}, "must be a number"},
                 {{NULL}, "which formula?"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *const *a = cases[i].arguments;
        outcome o = SKEIN("formula", a[0], a[0] ? a[1] : NULL, a[0] && a[1] ? a[2] : NULL);
        assert_status(o, 2);
        assert_contains(o.err, cases[i].message);
        outcome_free(&o);
    }
}

static void it_writes_languages(void **state) {
    (void)state;
    outcome o = SKEIN("formula", "length(p0-p1) - L", "--param", "L=1", "--emit", "c");
    assert_status(o, 0);
    assert_contains(o.out, "// length(p0-p1) - L\n");
    assert_contains(o.out, "FORMULA(formula) {\n");
    assert_contains(o.out, "// Parameter 0 is L.\n");
    assert_contains(o.out, "\nSKEIN_COMPILED(skein_compiled_formula, UINT64_C(0x");
    outcome_free(&o);
    o = SKEIN("formula", "0.5 * k * length(p0-p1)^2", "--param", "k=1", "--emit", "c", "--hessian", "--name", "spring");
    assert_status(o, 0);
    assert_contains(o.out, "for constraints of kind `energy`");
    assert_contains(o.out, "SECOND(second) {\n");
    assert_contains(o.out, "\nSKEIN_COMPILED(spring, UINT64_C(0x");
    outcome_free(&o);
    o = SKEIN("formula", "p0 - v0", "--emit", "c");
    assert_contains(o.err, "this one is a vector");
    assert_status(o, 2);
    outcome_free(&o);
    o = SKEIN("formula", "p0 - v0", "--emit", "function");
    assert_status(o, 0);
    assert_contains(o.out, "#define VELOCITY(particle, axis)");
    assert_contains(o.out, "FORMULA(formula) {\n");
    outcome_free(&o);
    o = SKEIN("formula", "length(p0-p1) - L", "--param", "L=1", "--emit", "function", "--hessian");
    assert_status(o, 0);
    assert_contains(o.out, "HESSIAN(5, 5, ");
    outcome_free(&o);
    o = SKEIN("formula", "length(p0-p1) - L", "--param", "L=1", "--emit", "glsl");
    assert_status(o, 0);
    assert_contains(o.out, "float formula(vec3 p0, vec3 p1, float q0, float t, out vec3 by_p0, out vec3 by_p1) {\n");
    outcome_free(&o);
    o = SKEIN("formula", "length(p0-p1) - L", "--param", "L=1", "--graph");
    assert_status(o, 0);
    assert_contains(o.out, "sqrt      #");
    assert_contains(o.out, "d/dp1.z = #");
    outcome_free(&o);
    o = SKEIN("formula", "--functions");
    assert_status(o, 0);
    assert_contains(o.out, "dihedral(p0, p1, p2, p3)");
    outcome_free(&o);
    o = SKEIN("formula", "length(p0)", "--at", "0,2,0", "--hessian");
    assert_status(o, 0);
    assert_contains(o.out, "second derivatives, 3 x 3\n        0.5           0           0\n");
    outcome_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(it_answers), cmocka_unit_test(it_says_where_it_guards),
                                       cmocka_unit_test(it_shows_faults), cmocka_unit_test(it_writes_languages)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
