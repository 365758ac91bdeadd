/* A predator: particles within its reach R flee from it, and may fly faster while they do.
 *
 *   d = predator - x, without its part along the line of sight:   v += d/|d| (|d|^2/R^2 - 1) strength dt,
 *   which points away, and their speed limit is `alarm` higher in this substep
 *
 * It is a place seen along a line (as under the mouse: it acts at any depth), or a place in space where there is no
 * line, or one of the particles. */
#include "forces/force.h"

#include "base/kernels.h"
#include "base/status.h"

typedef struct predator_params {
    double position[3], line[3], radius, strength, alarm;
    int32_t particle;
} predator_params;

#define SK_UNIT predator
SK_KERNELS(sk_row_kernel, kernel);

#ifdef SK_ISA

void SK_KERNEL(kernel)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_force *force = row->rule;
    const predator_params *params = force->params;
    bool flies = params->particle >= 0; // checked when the plan was written
    uint32_t own = flies ? run->slot_of[params->particle] : 0;
    sk_vec3 at = flies ? sk_xyz(sk_load(run->vector[SK_X], row->packed, own)) : sk_v3_of(params->position);
    sk_vec3 line = sk_v3_of(params->line);
    real along = sk_length(line), square_reach = (real)(params->radius * params->radius);
    line = along > 0 && !flies ? sk_scale(1 / along, line) : sk_v3(0, 0, 0);
    real dv = (real)(row->dt * params->strength), alarm = (real)params->alarm;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 s = sk_load_part(run->vector[row->dst], slot, packed);
        sk_wide3 d = {at.x - x.x, at.y - x.y, at.z - x.z};
        sk_wide depth = d.x * line.x + d.y * line.y + d.z * line.z;
        d.x -= depth * line.x, d.y -= depth * line.y, d.z -= depth * line.z;
        sk_wide square = sk_dot_wide(d, d);
        sk_mask near = sk_more(sk_splat(square_reach), square) &
                       sk_lanes_between(slot, force->moved.first_slot, force->moved.end_slot);
        if (flies && own - slot < SK_PART) near[own - slot] = 0;
        if (!sk_any(near)) continue;
        sk_mask apart = near & sk_positive(square); // right on it there is no way to flee
        sk_wide k = dv * (square / square_reach - (real)1) / sk_wide_sqrt(square);
        s.x = sk_plus_where(apart, s.x, k * d.x), s.y = sk_plus_where(apart, s.y, k * d.y);
        s.z = sk_plus_where(apart, s.z, k * d.z), s.w = sk_plus_where(near, s.w, sk_splat(alarm));
        sk_store_part(run->vector[row->dst], slot, packed, s);
    }
}

#else

static const skein_field fields[] = {
    SK_VEC3(predator_params, position, "position", "m", 0, 0, 0, "where it is, where no particle is given"),
    SK_VEC3(predator_params, line, "line", "", 0, 0, 0,
            "the line of sight that it acts along, at any depth; 0 0 0: it is in one place"),
    SK_INT(predator_params, particle, "particle", "", -1, -1, 4294967294.0 / 2, "the particle that it is; -1: none"),
    SK_REAL(predator_params, radius, "radius", "m", 100, 0, 1e9, "how far it is feared"),
    SK_REAL(predator_params, strength, "strength", "m/s2", 100, -SK_FAR, SK_FAR,
            "the acceleration away when it is very near"),
    SK_REAL(predator_params, alarm, "alarm", "m/s", 5, -SK_FAR, SK_FAR,
            "how much higher the speed limit is for those who flee"),
};

static skein_status check(const void *data, size_t particle_count, skein_error *error) {
    const predator_params *params = data;
    if (params->particle >= 0 && (size_t)params->particle >= particle_count)
        return sk_fail(error, SKEIN_ERROR_VALUE, "particle", "there is no particle %d: the world has %zu",
                       params->particle, particle_count);
    return SKEIN_OK;
}

static void pack(const void *data, float (*block)[4]) {
    const predator_params *params = data;
    const double *line = params->line;
    double length = sqrt(line[0] * line[0] + line[1] * line[1] + line[2] * line[2]);
    sk_shader_vector(block[0], params->position);
    for (int k = 0; k < 3 && length > 0 && params->particle < 0; k++) block[1][k] = (float)(line[k] / length);
    block[0][3] = (float)params->radius, block[1][3] = (float)params->strength, block[2][0] = (float)params->alarm;
}

static int32_t particle(const void *params) {
    return ((const predator_params *)params)->particle;
}

const sk_force_type sk_predator = {
    .kind = {"predator", "what is near flees from it: a place, a line of sight or a particle", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(predator_params)},
    .domain = SK_OVER_PARTICLES,
    .deed = SK_STEERS,
    .kernel = {SK_EACH_ISA(kernel)},
    .check = check,
    .particle = particle,
    .shader = {.file = "forces/predator", .size = 3, .pack = pack},
};
#endif
