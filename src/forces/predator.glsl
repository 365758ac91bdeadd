// A predator: what is near flees, across the line of sight, and may fly faster while it does.
vec4 steer@(vec3 x, float dt) {
    float reach = rule@[0].w, strength = rule@[1].w;
    vec3 line = rule@[1].xyz, d = rule@[0].xyz - x;
    d -= dot(d, line) * line;
    float square = dot(d, d);
    if (!(square < reach * reach)) return vec4(0);
    // right on it there is no way to flee
    vec3 away = square > 0 ? strength * dt * (square / (reach * reach) - 1) / sqrt(square) * d : vec3(0);
    return vec4(away, rule@[2].x);
}
