// Nothing is faster than the limit, and what a predator has added to it.
vec3 bound@(vec3 v, vec3 x, vec4 steering, float dt) {
    float most = max(rule@[0].x + steering.w, 0.0), square = dot(v, v);
    return square > most * most ? v * (most / sqrt(square)) : v;
}
