// Separation: neighbours closer than the radius push, F = strength (1 - d/radius).
#define sum@ vec3

sum@ start@(vec3 heading) {
    return vec3(0);
}

void meet@(inout sum@ push, vec3 apart, float square, vec3 direction) {
    float reach = rule@[0].x, distance = sqrt(square);
    // at distance 0 there is no direction
    if (square > 0) push += (1 - distance / reach) / distance * apart;
}

vec3 finish@(sum@ push, float dt) {
    return rule@[0].y * push;
}
