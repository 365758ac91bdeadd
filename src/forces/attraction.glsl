// Attraction to a centre, the same at any distance; flatter in the vertical.
vec4 steer@(vec3 x, float dt) {
    vec3 d = rule@[0].xyz - x;
    d.y *= rule@[1].x;
    float square = dot(d, d);
    return square > 0 ? vec4(rule@[0].w * dt / sqrt(square) * d, 0) : vec4(0);
}
