// All that is within a radius of a line.
vec4 probe@(vec3 p) {
    vec3 half_line = turned@(rule@[0].xyz), d = p - position@;
    float square = dot(half_line, half_line);
    // the nearest point of the line is at the middle plus t halves of it
    d -= (square > 0 ? clamp(dot(d, half_line) / square, -1.0, 1.0) : 0.0) * half_line;
    float length = sqrt(dot(d, d));
    if (length > 0) return vec4(d / length, length - rule@[0].w);
    // on the line itself every way aside is as good: up, as far as that is across; of an upright one, along x
    vec3 up = square > 0 ? vec3(0, 1, 0) - half_line.y / square * half_line : vec3(0, 1, 0);
    float rise = sqrt(dot(up, up));
    return vec4(rise > 1e-3 ? up / rise : vec3(1, 0, 0), -rule@[0].w);
}
