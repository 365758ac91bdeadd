// Plain wind: one force, whatever the mass.
vec3 force@(vec3 x, vec3 v, float mass) {
    return rule@[0].xyz;
}
