// Air drag: F = -(linear + rate m + quadratic |v|) v.
vec3 force@(vec3 x, vec3 v, float mass) {
    float linear = rule@[0].x, rate = rule@[0].y, quadratic = rule@[0].z;
    return -(linear + rate * mass + quadratic * length(v)) * v;
}
