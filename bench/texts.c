/* The texts of the measured formulas, and no more, so that the program that emits their C needs nothing else. */
#include "bench/texts.h"

#include <stddef.h>

static const char *const rest_parameters[] = {"rest0", NULL};
static const char *const tet_parameters[] = {"d0", "d1", "d2", "d3", "d4", "d5", "d6", "d7", "d8", "vol", NULL};
static const char *const triangle_parameters[] = {"d0", "d1", "d2", "d3", "area", NULL};

const bench_text bench_texts[BENCH_FORMULAS] = {
    {"distance", "distance", "length(p1-p0) - rest0", rest_parameters, 2, 1, false},
    {"dihedral", "dihedral", "dihedral(p0,p1,p2,p3) - rest0", rest_parameters, 4, 1, false},
    {"volume", "volume", "dot(cross(p1-p0, p2-p0), p3-p0)/6 - rest0", rest_parameters, 4, 1, true},
    {"neo-Hookean", "neo_hookean",
     "let a = p1-p0; let b = p2-p0; let c = p3-p0;\n"
     "let f0 = a*d0 + b*d3 + c*d6; let f1 = a*d1 + b*d4 + c*d7; let f2 = a*d2 + b*d5 + c*d8;\n"
     "let I = dot(f0,f0) + dot(f1,f1) + dot(f2,f2); let J = dot(f0, cross(f1, f2));\n"
     "vol*(0.5*(I-3) + 1.5*(J-1.25)^2 - 0.5*log(I+1))",
     tet_parameters, 4, 10, true},
    {"StVK triangle", "stvk",
     "let a = p1-p0; let b = p2-p0; let f = a*d0 + b*d2; let g = a*d1 + b*d3;\n"
     "let x = 0.5*(dot(f,f)-1); let y = 0.5*(dot(g,g)-1); let z = 0.5*dot(f,g);\n"
     "area*(x*x + y*y + 2*z*z + 1.5*(x+y)^2)",
     triangle_parameters, 3, 5, false},
};

const bench_kind_text bench_kind_texts[BENCH_KINDS] = {
    [BENCH_DISTANCE] = {"distance", "length(p0 - p1) - rest(length(p0 - p1))"},
    [BENCH_DIHEDRAL] = {"dihedral", "let a = dihedral(p0, p1, p2, p3) - rest(dihedral(p0, p1, p2, p3)); "
                                    "a - 2*pi * select(a > pi, 1, select(a < -pi, -1, 0))"},
    [BENCH_VOLUME] = {"volume",
                      "dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6 - rest(dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6)"},
    [BENCH_AREA] = {"area", "length(cross(p1 - p0, p2 - p0)) / 2 - rest(length(cross(p1 - p0, p2 - p0)) / 2)"},
};
