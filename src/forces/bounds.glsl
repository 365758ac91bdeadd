// A box or a sphere: what would be outside after this substep has its velocity turned inwards, as by a mirror.
vec3 bound@(vec4 at, vec3 v, vec4 steering, float dt) {
    vec3 x = at.xyz;
    vec3 centre = rule@[0].xyz, d = x + dt * v - centre;
    float radius = rule@[0].w; // of a sphere; 0: a box
    if (radius > 0) {
        float square = dot(d, d), out_to = dot(d, v);
        return square > radius * radius && out_to > 0 ? v - 2 * out_to / square * d : v;
    }
    bvec3 leaves = bvec3(uvec3(greaterThan(abs(d), rule@[1].xyz)) & uvec3(greaterThan(d * v, vec3(0))));
    return mix(v, -v, leaves);
}

// Where edges are periodic: by how much what is outside comes in at the other side.
vec3 shift@(vec3 x) {
    vec3 size = 2 * rule@[1].xyz, shift = vec3(0);
    for (int k = 0; k < 3; k++) shift[k] = x[k] > rule@[3][k] ? -size[k] : x[k] < rule@[2][k] ? size[k] : 0;
    return shift;
}
