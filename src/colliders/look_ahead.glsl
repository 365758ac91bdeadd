// Steering clear of a collider that is nearer than the clearance half way or all the way ahead; see avoid.c.
// op@[0]: time ahead, clearance, strength, substep
vec4 avoid@(vec3 x, vec3 v) {
    float clearance = op@[0].y + pose@[0].w;
    vec3 sum = vec3(0);
    for (int look = 1; look <= 2; look++) {
        vec4 probed = probe@(x + 0.5 * float(look) * op@[0].x * v);
        if (probed.w < clearance) sum += kept_off(probed.xyz, probed.w, clearance, op@[0].w * op@[0].z);
    }
    return vec4(sum, 0);
}
