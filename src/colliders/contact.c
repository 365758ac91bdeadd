/* Contact: what happens to particles that touch a collider, the same for every shape.
 *
 *            n                 A particle touches when its distance d is under the thickness.
 *        p   ^                 Forces, velocities and moves split into a normal and a tangential
 *     ---o---|------- d        part, both relative to the surface's own velocity at p, so that a
 *   =========|=========        turning sphere carries what lies on it (Coulomb friction).
 *
 * Particles are probed in blocks, so that a shape's function is called once a block. */
#include "colliders/collider.h"

#include <math.h>
#include <string.h>

#include "base/elementary.h"

enum { BLOCK = 64 };

const skein_field sk_collider_fields[] = {
    SK_TEXT(sk_collider_common, name, "name", "", "for paths and messages"),
    SK_BOOL(sk_collider_common, enabled, "enabled", 1, "false: as if it were not there"),
    SK_BOOL(sk_collider_common, visible, "visible", 1, "whether it is drawn"),
    SK_REAL(sk_collider_common, thickness, "thickness", "m", 0.002, 0, SK_FAR, "particles are kept so far off"),
    SK_REAL(sk_collider_common, friction, "friction", "", 0.3, 0, SK_FAR, "Coulomb's coefficient, at rest and sliding"),
    SK_REAL(sk_collider_common, restitution, "restitution", "", 0, 0, 1, "speed after a bounce over speed before"),
    SK_VEC3(sk_collider_common, velocity, "motion.velocity", "m/s", 0, 0, 0, "it moves so from motion.start on"),
    SK_VEC3(sk_collider_common, axis, "motion.axis", "", 0, 1, 0, "axis of the spin, through its own point"),
    SK_REAL(sk_collider_common, spin, "motion.spin", "rad/s", 0, -1e6, 1e6, "angular speed from motion.start on"),
    SK_REAL(sk_collider_common, start, "motion.start", "s", 0, 0, SK_FAR, "when the motion begins"),
};
const size_t sk_collider_field_count = sizeof sk_collider_fields / sizeof *sk_collider_fields;

/* Rows of the matrix of a turn by `angle` about a unit axis (Rodrigues). */
static void rotation_about(const double u[3], double angle, real rotation[9]) {
    double s, c;
    sk_sincos(angle, &s, &c);
    double d = 1 - c;
    double m[9] = {c + u[0] * u[0] * d,        u[0] * u[1] * d - u[2] * s, u[0] * u[2] * d + u[1] * s,
                   u[1] * u[0] * d + u[2] * s, c + u[1] * u[1] * d,        u[1] * u[2] * d - u[0] * s,
                   u[2] * u[0] * d - u[1] * s, u[2] * u[1] * d + u[0] * s, c + u[2] * u[2] * d};
    for (int i = 0; i < 9; i++) rotation[i] = (real)m[i];
}

sk_pose sk_collider_pose_at(const sk_collider *collider, double time) {
    const sk_collider_common *common = collider->common;
    double since = time - common->start, position[3], axis[3] = {0, 1, 0};
    bool moving = since > 0;
    if (!moving) since = 0;
    collider->type->place(collider->params, position);
    for (int k = 0; k < 3; k++) position[k] += common->velocity[k] * since;
    const double *a = common->axis;
    double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    double spin = moving && length > 0 ? common->spin : 0;
    for (int k = 0; k < 3 && length > 0; k++) axis[k] = a[k] / length;

    sk_pose pose = {.position = sk_v3_of(position)};
    pose.velocity = moving ? sk_v3_of(common->velocity) : sk_v3(0, 0, 0);
    pose.spin = sk_v3((real)(axis[0] * spin), (real)(axis[1] * spin), (real)(axis[2] * spin));
    rotation_about(axis, spin * since, pose.rotation);
    return pose;
}

static inline sk_vec3 surface_velocity(const sk_pose *pose, sk_vec3 p) {
    return sk_add(pose->velocity, sk_cross(pose->spin, sk_sub(p, pose->position)));
}

/* Rounding must not break a resting contact: forces and velocities look a little beyond the thickness. */
static inline real touching_distance(real thickness, sk_vec3 p) {
    real size = sk_max(sk_abs(p.x), sk_max(sk_abs(p.y), sk_abs(p.z)));
    return thickness + (real)1e-3 * thickness + (real)4e-6 * (size + (real)0.1);
}

/* Splits u into its part along the unit normal (returned) and the rest. */
static inline real split(sk_vec3 u, sk_vec3 normal, sk_vec3 *tangential) {
    real along = sk_dot(u, normal);
    *tangential = sk_sub(u, sk_scale(along, normal));
    return along;
}

/* Calls ANSWER for each free particle of [begin, end) with its contact, block by block. */
typedef struct answer {
    sk_run *run;
    const sk_row *row;
    const sk_collider *collider;
    sk_pose pose;
} answer;

static void for_contacts(sk_run *run, const sk_row *row, size_t begin, size_t end,
                         void (*respond)(const answer *a, size_t slot, sk_contact contact)) {
    answer a = {run, row, row->rule, {{0, 0, 0}, {0}, {0, 0, 0}, {0, 0, 0}}};
    a.pose = sk_collider_pose_at(a.collider, run->time);
    const sk_vec4 *x = run->vector[SK_X];
    sk_contact contact[BLOCK];
    for (size_t first = begin; first < end; first += BLOCK) {
        size_t count = end - first < BLOCK ? end - first : BLOCK;
        a.collider->type->probe(a.collider->params, &a.pose, x + first, count, contact);
        for (size_t i = 0; i < count; i++)
            if (x[first + i].w > 0) respond(&a, first + i, contact[i]);
    }
}

static void respond_force(const answer *a, size_t slot, sk_contact contact) {
    const sk_vec4 *x = &a->run->vector[SK_X][slot], *v = &a->run->vector[SK_V][slot];
    sk_vec4 *f = &a->run->vector[a->row->dst][slot];
    if (contact.distance > touching_distance((real)a->collider->common->thickness, sk_xyz(*x))) return;
    sk_vec3 force_t, slide;
    real normal_force = split(sk_xyz(*f), contact.normal, &force_t);
    if (!(normal_force < 0)) return;
    split(sk_sub(sk_xyz(*v), surface_velocity(&a->pose, sk_xyz(*x))), contact.normal, &slide);
    // the friction that would stop the slide within this substep, cut to Coulomb's cone
    sk_vec3 stop = sk_sub(sk_scale(-1 / (x->w * (real)a->row->dt), slide), force_t);
    real needed = sk_length(stop), most = (real)a->collider->common->friction * -normal_force;
    real share = needed > most ? most / needed : (real)1;
    sk_accumulate(f, sk_scale(-normal_force, contact.normal));
    sk_accumulate(f, sk_scale(share, stop));
}

void sk_contact_force(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    for_contacts(run, row, begin, end, respond_force);
}

static void respond_impulse(const answer *a, size_t slot, sk_contact contact) {
    const sk_vec4 *x = &a->run->vector[SK_X][slot];
    sk_vec4 *v = &a->run->vector[a->row->dst][slot];
    const sk_collider_common *common = a->collider->common;
    if (contact.distance > touching_distance((real)common->thickness, sk_xyz(*x))) return;
    sk_vec3 slide;
    real approach = split(sk_sub(sk_xyz(*v), surface_velocity(&a->pose, sk_xyz(*x))), contact.normal, &slide);
    if (!(approach < 0)) return;
    real bounce = (1 + (real)common->restitution) * -approach;
    real speed = sk_length(slide), most = (real)common->friction * bounce;
    real share = speed > most ? most / speed : (real)1;
    sk_accumulate(v, sk_sub(sk_scale(bounce, contact.normal), sk_scale(share, slide)));
}

void sk_contact_impulse(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    for_contacts(run, row, begin, end, respond_impulse);
}

static void respond_push(const answer *a, size_t slot, sk_contact contact) {
    sk_vec4 *x = &a->run->vector[SK_X][slot];
    const sk_collider_common *common = a->collider->common;
    real push = (real)common->thickness - contact.distance;
    if (!(push > 0)) return;
    sk_vec3 move = sk_scale(push, contact.normal);
    if (a->row->source[1] != SK_NONE) {
        // friction takes back the slide since the start of the substep, up to mu times the push
        sk_vec3 start = sk_xyz(a->run->vector[a->row->source[1]][slot]), slide;
        sk_vec3 carried = sk_scale((real)a->row->dt, surface_velocity(&a->pose, sk_xyz(*x)));
        split(sk_sub(sk_sub(sk_xyz(*x), start), carried), contact.normal, &slide);
        real length = sk_length(slide), most = (real)common->friction * push;
        real share = length > most ? most / length : (real)1;
        move = sk_sub(move, sk_scale(share, slide));
    }
    sk_accumulate(x, move);
}

void sk_contact_push(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    for_contacts(run, row, begin, end, respond_push);
}

static void respond_restitution(const answer *a, size_t slot, sk_contact contact) {
    const sk_vec4 *x = &a->run->vector[SK_X][slot], *f = &a->run->vector[SK_F][slot];
    sk_vec4 *v = &a->run->vector[a->row->dst][slot];
    const sk_vec4 *before = &a->run->vector[a->row->source[1]][slot];
    const sk_collider_common *common = a->collider->common;
    if (contact.distance > touching_distance((real)common->thickness, sk_xyz(*x))) return;
    sk_vec3 surface = surface_velocity(&a->pose, sk_xyz(*x));
    real approach = sk_dot(sk_sub(sk_xyz(*before), surface), contact.normal);
    if (!(approach < 0)) return;
    // what a substep's force alone brings is no impact; bouncing it would make resting things jitter
    real resting = 2 * (real)a->row->dt * x->w * sk_length(sk_xyz(*f));
    real bounce = -approach > resting ? (real)common->restitution * -approach : (real)0;
    real leaving = sk_dot(sk_sub(sk_xyz(*v), surface), contact.normal);
    sk_accumulate(v, sk_scale(bounce - leaving, contact.normal));
}

void sk_contact_restitution(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    for_contacts(run, row, begin, end, respond_restitution);
}

void sk_collider_measure(const sk_collider *collider, double time, const sk_vec4 *x,
                         const uint32_t *slot_of, size_t particle_count, double *penetration, size_t *contacts) {
    sk_pose pose = sk_collider_pose_at(collider, time);
    real thickness = (real)collider->common->thickness;
    for (size_t i = 0; i < particle_count; i++) {
        sk_vec4 p = x[slot_of[i]];
        sk_contact contact;
        collider->type->probe(collider->params, &pose, &p, 1, &contact);
        if (contact.distance <= touching_distance(thickness, sk_xyz(p))) ++*contacts;
        double depth = (double)(thickness - contact.distance);
        if (p.w > 0 && depth > *penetration) *penetration = depth;
    }
}
