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
void contact_impulse@(vec4 x, inout vec4 v) {
    encounter@ e = meet@(x);
    vec3 past = v.xyz - e.surface;
    float approach = dot(past, e.normal);
    if (!e.touching || !(approach < 0)) return;
    vec3 slide = past - approach * e.normal;
    float bounce = (1 + restitution@(v.w)) * -approach;
    v.xyz += bounce * e.normal - share@(length(slide), pose@[1].w * bounce) * slide;
}

// Moves out to the thickness.
void contact_push@(inout vec4 x) {
    encounter@ e = meet@(x);
    float push = pose@[0].w - e.gap;
    if (e.touching && push > 0) x.xyz += push * e.normal;
}

// Moves out with friction against the start of the substep, and gives V the same move and the bounce.
void contact_update@(inout vec4 x, inout vec4 v, vec4 f, vec4 start, vec4 before) {
    encounter@ e = meet@(x);
    if (!e.touching) return;
    float h = op@[0].w, push = pose@[0].w - e.gap;
    if (push > 0) {
        vec3 moved = x.xyz - start.xyz - h * e.surface, slide = moved - dot(moved, e.normal) * e.normal;
        vec3 way = push * e.normal - share@(length(slide), pose@[1].w * push) * slide;
        x.xyz += way;
        v.xyz += way / h;
    }
    // along the normal what counts is how the particle came
    float approach = dot(before.xyz - e.surface, e.normal);
    if (!(approach < 0)) return;
    float change = -dot(v.xyz - e.surface, e.normal);
    // what a substep's force alone brings is no impact; bouncing it would make resting things jitter
    float resting = 2 * h * x.w * length(f.xyz);
    if (op@[1].x > 0 && -approach > resting) change += restitution@(v.w) * -approach;
    v.xyz += change * e.normal;
}
