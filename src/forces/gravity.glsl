// Gravity: F = m g.
vec3 force@(vec3 x, vec3 v, float mass) {
    return mass * rule@[0].xyz;
}
