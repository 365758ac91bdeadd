// A solid box, turned as one likes.
vec4 probe@(vec3 p) {
    vec3 own = turned_back@(p - position@), side = mix(vec3(1), vec3(-1), lessThan(own, vec3(0)));
    // in the box's own axes, on the positive side of each: how far beyond the faces
    vec3 over = own * side - rule@[0].xyz, beyond = max(over, vec3(0));
    float length = sqrt(dot(beyond, beyond));
    // outside, to the nearest point of the box; inside, through the nearest face
    if (length > 0) return vec4(turned@(side * beyond / length), length);
    vec3 face = over.z > max(over.x, over.y) ? vec3(0, 0, 1) : over.y > over.x ? vec3(0, 1, 0) : vec3(1, 0, 0);
    return vec4(turned@(side * face), max(over.z, max(over.x, over.y)));
}
