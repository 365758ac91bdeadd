// Nothing turns faster or flies steeper than this; see turn_limit.c.
vec3 bound@(vec4 at, vec3 v, vec4 steering, float dt) {
    vec3 x = at.xyz;
    float angle = rule@[0].x * dt, climb_cosine = rule@[0].y, climb_sine = rule@[0].z;
    vec3 before = v - steering.xyz;
    float square = dot(v, v), old = dot(before, before), speed = sqrt(square);
    if (angle < 3.14159 && square > 0 && old > 0) {
        vec3 o = before / sqrt(old);
        float along = dot(v, o);
        if (cos(angle) * speed > along) {
            vec3 n = v - along * o;
            // straight back means to the side first, in the level; of what flies straight up or down, along x
            if (dot(n, n) <= 1e-12 * square) n = o.x * o.x + o.z * o.z > 1e-6 ? vec3(o.z, 0, -o.x) : vec3(1, 0, 0);
            v = speed * (cos(angle) * o + sin(angle) / sqrt(dot(n, n)) * n);
        }
    }
    float level = v.x * v.x + v.z * v.z;
    if (climb_cosine > 0 && v.y * v.y > climb_sine * climb_sine * (level + v.y * v.y)) {
        vec2 ahead = level > 0 ? v.xz / sqrt(level) : vec2(1, 0);
        v = speed * vec3(climb_cosine * ahead.x, v.y < 0 ? -climb_sine : climb_sine, climb_cosine * ahead.y);
    }
    return v;
}
