// A half space: solid below the plane through the pose's position.
vec4 probe@(vec3 p) {
    vec3 normal = axis@;
    return vec4(normal, dot(normal, p - position@));
}
