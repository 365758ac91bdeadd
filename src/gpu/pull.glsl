// What a uniform force (gravity, uniform wind, air drag) makes of the velocity of a particle of inverse mass w.
vec3 pulled@(float w, vec3 v) {
    if (!(w > 0)) return v;
    vec3 force = rule@[0].xyz + w * rule@[1].xyz - (rule@[2].y + rule@[2].x * w) * v;
    return v + op@[0].w * force;
}
