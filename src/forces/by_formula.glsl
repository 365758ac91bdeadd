// A force by a formula, or a potential energy's: its slope, downwards.
vec3 force@(vec3 x, vec3 v, float mass) {
    float weight = rule@[0].y * (rule@[0].x != 0 ? mass : 1), o[3];
    formula@(x, v, op@[1].z, o);
    return weight * vec3(o[0], o[1], o[2]);
}
