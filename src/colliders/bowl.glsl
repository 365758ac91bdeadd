// A ball from inside: everything outside of it is solid.
vec4 probe@(vec3 p) {
    vec3 d = position@ - p;
    float length = sqrt(dot(d, d));
    // in the very middle no way leads to the wall: there is no contact
    return length > 0 ? vec4(d / length, rule@[0].x - length) : vec4(0, 1, 0, 1e15);
}
