// Flocking, see flocking.h: away from near neighbours, along with farther ones, towards those at the edge of the reach.
// Branches are written as selections, so that invocations of a group do not diverge. No literal needs a conversion, so
// that it is GLSL ES 3.00, too: the page has it on its card as it is (playground/src/card.js).
struct sum@ {
    vec3 total, heading;
};

sum@ start@(vec3 heading) {
    return sum@(vec3(0.0), heading);
}

// Whether the neighbour is within the angle of view; a particle at rest sees all round.
bool sees@(sum@ sum, vec3 apart, float square) {
    return square > 0.0 && (dot(-apart, sum.heading) >= rule@[2].x * sqrt(square) || sum.heading == vec3(0.0));
}

void meet@(inout sum@ sum, vec3 apart, float square, vec3 direction) {
    float per_reach = rule@[0].x, away = rule@[0].y, along = rule@[0].z, per_along = rule@[0].w;
    float per_towards = rule@[1].x, least = rule@[1].y;
    float per = inversesqrt(max(square, least * least)), relative_distance = per_reach / per;
    if (rule@[1].w != 0.0) relative_distance *= relative_distance;
#ifdef FORMULA@
    float towards = towards@(relative_distance, op@[1].z), with = along@(relative_distance, op@[1].z);
#else
    bool is_away = relative_distance < away, is_along = relative_distance < along && !is_away;
    float a = is_along ? (relative_distance - away) * per_along : (relative_distance - along) * per_towards;
    float cosine = -0.5 * cos(6.28318531 * (a - 0.5)); // within -pi to pi, where GLSL's cosine is accurate
    float towards = is_away ? 1.0 - away / relative_distance : is_along ? 0.0 : cosine;
    float with = is_along ? 1.0 - cosine : 0.0;
#endif
    vec3 part = with * direction - towards * per * apart;
    sum.total += sees@(sum, apart, square) ? part : vec3(0.0);
}

vec3 finish@(sum@ sum, float dt) {
    return rule@[1].z * dt * sum.total;
}
