// What shapes say their arithmetic in; see shape.h. Once for all shapes of a shader.
struct sk_pose {
    vec3 position, axis, row_0, row_1, row_2; // rows of the rotation
};

struct sk_contact {
    vec3 normal;
    float distance;
};

#define position_of(where) (where).position
#define axis_of(where) (where).axis

sk_contact contact_of(vec3 normal, float distance) {
    return sk_contact(normal, distance);
}

vec3 turned(sk_pose where, vec3 v) {
    return vec3(dot(where.row_0, v), dot(where.row_1, v), dot(where.row_2, v));
}

vec3 turned_back(sk_pose where, vec3 v) {
    return where.row_0 * v.x + where.row_1 * v.y + where.row_2 * v.z;
}
