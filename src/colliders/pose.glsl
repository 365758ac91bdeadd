// Where a collider stands at the end of the substep; what the shapes' texts build on.
//
// pose@: position, thickness | velocity, friction | spin, restitution | axis, mass | three rows of the rotation, with
// the time, the recovery, and how it is passed (sk_passing) | for how much of the substep it has moved so
#define position@ pose@[0].xyz
#define axis@ pose@[3].xyz

vec3 turned@(vec3 v) {
    return vec3(dot(pose@[4].xyz, v), dot(pose@[5].xyz, v), dot(pose@[6].xyz, v));
}

vec3 turned_back@(vec3 v) {
    return pose@[4].xyz * v.x + pose@[5].xyz * v.y + pose@[6].xyz * v.z;
}
