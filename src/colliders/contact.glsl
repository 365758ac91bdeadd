// Contact: what happens to a particle that touches a collider, the same for every shape (see contact.c). The shape's
// probe@ stands before it. op@[0].w is the substep, op@[1].x is 1 where bounces look at the force.

struct encounter@ {
    vec3 normal, surface; // the surface's velocity there
    float gap;            // from the surface
    bool touching;
};

encounter@ meet@(vec4 x) {
    vec4 probed = probe@(x.xyz);
    // rounding must not break a resting contact: forces and velocities look a little beyond the thickness
    float size = max(abs(x.x), max(abs(x.y), abs(x.z))), thickness = pose@[0].w;
#ifdef DEFORMS@
    vec3 own = speed@ * probed.xyz;
#else
    const vec3 own = vec3(0);
#endif
    float reach = thickness + 1e-3 * thickness + 4e-6 * (size + 0.1);
    vec3 surface = pose@[1].xyz + cross(pose@[2].xyz, x.xyz - position@) + own;
    return encounter@(probed.xyz, surface, probed.w, probed.w <= reach && x.w > 0);
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

struct past@ {
    float level; // so far off it is pushed
    bool leaving; // slowly
};

// Meets x at the end of a substep that began at `start`: what came through stops at the surface, and v gets `per_step` of that move.
encounter@ meet_at_end@(inout vec4 x, inout vec4 v, vec4 start, float per_step, out past@ begun) {
    encounter@ e = meet@(x);
    float thickness = pose@[0].w, h = op@[0].w, recovery = h * pose@[5].w;
    begun = past@(thickness, false);
    if (!(x.w > 0)) return e;
    vec3 from = began@(start.xyz), seen = from;
#ifdef DEFORMS@
    seen += h * speed@ * e.normal;
#endif
    vec3 way = x.xyz - seen, size = abs(x.xyz);
    float s = e.gap - dot(way, e.normal), slack = 1e-3 * thickness + 4e-6 * (max(size.x, max(size.y, size.z)) + 0.1);
    bool deep = e.touching && s < thickness - slack - 0.1 * recovery, crossing = pose@[6].w > 0 && s < -slack;
    // a long way may end before another wall; one that only comes in is pushed out of the surface that it came through
    if (!crossing && pose@[6].w == 2 && e.gap > 0 && length(way) > max(5 * thickness, e.gap)) crossing = true;
    if (crossing) {
        vec3 to = x.xyz;
        if (stop@(seen, to, per_step > 0)) {
            v.xyz += per_step * (to - x.xyz);
            x.xyz = to;
        }
        e = meet@(x);
    }
    if (deep) {
        float level = probe@(from).w + recovery;
#ifdef DEFORMS@
        level += h * speed@;
#endif
        begun.leaving = level < thickness - slack + recovery;
        if (begun.leaving) begun.level = min(level, thickness);
        e = meet@(x);
    }
    return e;
}

// The part of a vector of this length that friction takes, at most `most`: 1 where it takes all.
float share@(float length, float most) {
    return length > most ? most / length : 1;
}

// Speed after a bounce over speed before: of a collider with a mass (m - M)/(m + M), but never inwards.
float restitution@(float mass) {
    float own = pose@[3].w;
    return own > 0 ? max((own - mass) / (own + mass), 0.0) : pose@[2].w;
}

// Cancels the force that would bring the particle inwards, and rubs what slides.
void contact_force@(vec4 x, vec4 v, inout vec4 f) {
    encounter@ e = meet@(x);
    vec3 past = v.xyz - e.surface;
    float inward = dot(f.xyz, e.normal), leaving = dot(past, e.normal), mass_per_step = 1 / (x.w * op@[0].w);
    float pressing = pose@[3].w > 0 ? inward : inward + mass_per_step * max(leaving, 0.0);
    if (!e.touching || !(pressing < 0)) return;
    vec3 across = f.xyz - inward * e.normal, slide = past - leaving * e.normal;
    // the friction that would stop the slide within this substep, cut to Coulomb's cone
    vec3 stop = -mass_per_step * slide - across;
    f.xyz += -pressing * e.normal + share@(length(stop), pose@[1].w * -pressing) * stop;
}

// Reflects and rubs the inward velocity.
void contact_impulse@(inout vec4 x, inout vec4 v, vec4 start) {
    past@ begun;
    encounter@ e = meet_at_end@(x, v, start, 0.0, begun);
    vec3 past = v.xyz - e.surface;
    float approach = dot(past, e.normal);
    if (!e.touching || !(approach < 0)) return;
    vec3 slide = past - approach * e.normal;
    float bounce = (1 + restitution@(v.w)) * -approach;
    v.xyz += bounce * e.normal - share@(length(slide), pose@[1].w * bounce) * slide;
}

// Moves out to the thickness.
void contact_push@(inout vec4 x, vec4 start) {
    past@ begun;
    vec4 v = vec4(0);
    encounter@ e = meet_at_end@(x, v, start, 0.0, begun);
    float push = begun.level - e.gap;
    if (e.touching && push > 0) x.xyz += push * e.normal;
}

// Moves out with friction against the start of the substep, and gives V the same move and the bounce.
void contact_update@(inout vec4 x, inout vec4 v, vec4 f, vec4 start, vec4 before) {
    float h = op@[0].w;
    past@ begun;
    encounter@ e = meet_at_end@(x, v, start, 1 / h, begun);
    if (!e.touching) return;
    float push = begun.level - e.gap;
    if (push > 0) {
        vec3 moved = x.xyz - start.xyz - h * e.surface, slide = moved - dot(moved, e.normal) * e.normal;
        vec3 way = push * e.normal - share@(length(slide), pose@[1].w * push) * slide;
        x.xyz += way;
        v.xyz += (begun.leaving ? way - push * e.normal : way) / h;
    }
    // along the normal what counts is how the particle came
    float approach = dot(before.xyz - e.surface, e.normal), change = -dot(v.xyz - e.surface, e.normal);
    if (!(approach < 0) && !(begun.leaving && change > 0)) return;
    // what a substep's force alone brings is no impact; bouncing it would make resting things jitter
    float resting = 2 * h * x.w * length(f.xyz);
    if (op@[1].x > 0 && -approach > resting) change += restitution@(v.w) * -approach;
    v.xyz += change * e.normal;
}
