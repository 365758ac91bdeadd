// A force by a formula: the formula's value, or minus the gradient of a potential energy.
vec3 force@(vec3 x, vec3 v, float mass) {
    float weight = rule@[0].y * (rule@[0].x != 0 ? mass : 1), o[3];
    formula@(x, v, op@[1].z, o);
    return weight * vec3(o[0], o[1], o[2]);
}
