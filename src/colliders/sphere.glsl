// A solid ball.
vec4 probe@(vec3 p) {
    vec3 d = p - position@;
    float length = sqrt(dot(d, d));
    // at the very centre every way out is as good: take up
    return vec4(length > 0 ? d / length : vec3(0, 1, 0), length - rule@[0].x);
}
