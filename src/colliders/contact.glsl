// Contact of a particle with a collider of any shape, whose probe@ stands before it; what the collider answers is in response.h. Ways
// through the surface are followed here as cast.c and swept.c do it, of one particle at a time. op@[0].w is the substep, op@[1].x is
// 1 where bounces look at the force.

contact_law law@() {
    float h = op@[0].w;
    return contact_law(pose@[0].w, pose@[1].w, pose@[2].w, pose@[3].w, h, h * pose@[5].w, op@[1].x > 0);
}

encounter meet@(vec4 x) {
    vec4 probed = probe@(x.xyz);
#ifdef DEFORMS@
    float own = speed@;
#else
    const float own = 0;
#endif
    vec3 surface = motion_of(pose@[1].xyz, pose@[2].xyz, x.xyz - position@) + own * probed.xyz;
    float reach = reach_of(law@(), x.xyz);
    bool touching = probed.w <= reach && x.w > 0;
    return encounter(x, probed.xyz, surface, probed.w, own, reach, pose@[0].w, touching, false, true);
}

// ---- the start of the substep: see start.h and swept.c ----

// Where the way from a to b comes in, as a part of it, and the normal there; 2: nowhere.
float cross@(vec3 a, vec3 b, out vec3 normal) {
    float length_ = length(b - a), t = 0;
    normal = vec3(0);
    if (!(length_ > 0)) return 2;
    vec3 along = (b - a) / length_;
    vec3 size = abs(a);
    float tolerance = 4e-6 * (size.x + size.y + size.z + 0.1), before = 0;
    vec4 p = probe@(a);
    if (p.w < -tolerance) return 2;
    for (int turn = 0; turn < 200 && t <= length_; turn++) {
        float lean = -dot(p.xyz, along);
        if (p.w <= tolerance && lean > 0) {
            normal = p.xyz;
            return t / length_;
        }
        before = t;
        float go = max(p.w, tolerance);
        if (pose@[6].w == 1) go = lean * 4 > 1 ? go / lean : 4 * go;
        else go = min(go, max(length_ / 16, tolerance));
        t += go;
        p = probe@(a + t * along);
        if (!(p.w < 0)) continue;
        // inside: between there and the last place
        float inside = t;
        for (int half_ = 0; half_ < 40 && inside - before > 0.5 * tolerance; half_++) {
            t = 0.5 * (before + inside);
            p = probe@(a + t * along);
            if (p.w > 0) before = t;
            else inside = t;
        }
        t = before;
        p = probe@(a + t * along);
        p.w = min(p.w, tolerance);
    }
    return 2;
}

// Stops x where its way crosses the surface; what is left of it goes on along it, less what friction takes.
bool stop@(vec3 from, inout vec3 x, bool rubs) {
    vec3 size = abs(x), normal;
    float off = max(0.5 * pose@[0].w, 4e-6 * (size.x + size.y + size.z + 0.1));
    for (int turn = 0; turn < 4; turn++) {
        float part = cross@(from, x, normal);
        if (part > 1) return turn > 0;
        float closing = -dot(normal, x - from);
        part = closing > 0 ? max(0.0, part - off / closing) : 0.0;
        vec3 rest = (1 - part) * (x - from) + (1 - part) * closing * normal;
        from += part * (x - from);
        float far = length(rest), rub = rubs ? pose@[1].w * (1 - part) * closing : 0.0;
        x = from + (far > rub ? 1 - rub / far : 0.0) * rest;
    }
    if (cross@(from, x, normal) <= 1) x = from;
    return true;
}

// Where a place was, as the collider sees it that has moved since.
vec3 began@(vec3 start) {
    float h = pose@[7].x, angle = h * length(pose@[2].xyz);
    vec3 arm = start - (position@ - h * pose@[1].xyz);
    if (angle > 0) {
        vec3 k = normalize(pose@[2].xyz);
        arm = cos(angle) * arm + sin(angle) * cross(k, arm) + (1 - cos(angle)) * dot(k, arm) * k;
    }
    return position@ + arm;
}

// Meets x at the end of a substep that began at `start`: what came through stops at the surface, and v gets `per_step` of that move.
encounter meet_at_end@(vec4 x, inout vec4 v, vec4 start, float per_step) {
    encounter e = meet@(x);
    if (!(x.w > 0)) return e;
    vec3 from = began@(start.xyz), seen = from + op@[0].w * e.speed * e.normal, way = x.xyz - seen;
    float thickness = pose@[0].w, s = e.distance - dot(way, e.normal), slack = e.reach - thickness;
    bool deep = began_deep(law@(), e, s), crossing = pose@[6].w > 0 && s < -slack;
    // a long way may end before another wall; one that only comes in is pushed out of the surface that it came through
    if (!crossing && pose@[6].w == 2 && e.distance > 0 && length(way) > max(5 * thickness, e.distance)) crossing = true;
    encounter there = e;
    if (crossing) {
        vec3 to = x.xyz;
        if (stop@(seen, to, per_step > 0)) {
            v.xyz += per_step * (to - x.xyz);
            there = meet@(vec4(to, x.w));
        }
    }
    if (deep) {
        float began = probe@(from).w;
#ifdef DEFORMS@
        began += op@[0].w * speed@;
#endif
        e = coming_out(law@(), e, deep, depth_before(law@(), e, began, length(way)));
        there.level = e.level;
        there.leaving = e.leaving;
    }
    return there;
}

void contact_force@(vec4 x, vec4 v, inout vec4 f) {
    f.xyz = force_after(law@(), meet@(x), v.xyz, f.xyz);
}

void contact_impulse@(inout vec4 x, inout vec4 v, vec4 start) {
    encounter e = meet_at_end@(x, v, start, 0);
    x = e.x;
    v.xyz = velocity_after(law@(), e, v);
}

void contact_push@(inout vec4 x, vec4 start) {
    vec4 v = vec4(0);
    x.xyz = pushed_out(meet_at_end@(x, v, start, 0));
}

void contact_update@(inout vec4 x, inout vec4 v, vec4 f, vec4 start, vec4 came) {
    float per_step = 1 / op@[0].w;
    encounter e = meet_at_end@(x, v, start, per_step);
    x = e.x;
    if (!e.touching) return;
    vec3 way = way_out(law@(), e, start.xyz);
    if (push_of(e) > 0) x.xyz += way;
    v.xyz = velocity_moved(law@(), e, v, way, came.xyz, f.xyz, per_step);
}
