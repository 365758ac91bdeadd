#!/bin/sh
# Writes the formulas of test_compiled.c as a program would have them: compiled.sh SKEIN FOLDER
set -eu
skein=$1 folder=$2

emit() { # NAME TEXT [OPTION...]
    name=$1
    shift
    "$skein" formula "$@" --emit c --name "$name" >"$folder/$name.c"
}
emit compiled_spring 'length(p0 - p1) - L * (1 + 0.2 * sin(t))' --param L=1
emit compiled_bend 'let a = dihedral(p0, p1, p2, p3) - rest(dihedral(p0, p1, p2, p3));
select(a > pi, a - 2 * pi, select(a < -pi, a + 2 * pi, a)) // the short way'
emit compiled_room 'let vol = dot(cross(p1 - p0, p2 - p0), p3 - p0) / 6;
vol >= share * rest(vol)' --param share=1
emit compiled_all 'let d = p0 - p1; let s = dot(d, d);
exp(-s) + 0.1 * log(s - 0.2) + 0.3 * tan(0.2 * d.x) + acos(d.y) * asin(0.9 * d.z) - (s + 0.1)^power +
abs(d.x) * cos(t) + 0.1 * atan2(d.y, d.z) + sqrt(s - 0.01)' --param power=1
emit compiled_energy 'let s = length(p1 - p0) / rest(length(p1 - p0)); let a = length(cross(p1 - p0, p2 - p0));
k / 2 * (s - 1)^2 + m * (log(a / rest(a)))^2' --param m=1 --param k=1 --hessian
