/* Functions on forces of any kind: whether one is uniform, and the particle that it is placed at. */
#include "forces/force.h"

bool sk_force_on_velocity(const sk_force *force) {
    const sk_force_type *type = force->type;
    return type->uses_velocity ? type->uses_velocity(force->params) : type->on_velocity;
}

int32_t sk_force_particle(const sk_force *force) {
    return force->type->particle ? force->type->particle(force->params) : -1;
}

/* Whether the force at a velocity equals that of the sum, but for rounding in double. */
static bool agrees(const sk_force *force, const sk_uniform_force *sum, const double v[3], double mass) {
    double f[3];
    force->type->at_velocity(force->params, v, mass, f);
    for (int k = 0; k < 3; k++) {
        double own = mass * sum->acceleration[k] + sum->force[k], drag = (sum->linear + sum->rate * mass) * v[k];
        if (!(fabs(f[k] - (own - drag)) <= 1e-12 * (fabs(own) + fabs(drag)))) return false;
    }
    return true;
}

/* The coefficients are read from the force at rest and at 1 m/s, with and without a mass, which is exact for a uniform
 * force. Then both are compared at speeds up to 3e8 m/s, in changing directions and with changing masses. */
bool sk_force_add_uniform(const sk_force *force, sk_uniform_force *sum) {
    static const double velocities[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
    static const double directions[3][3] = {{1, 2, -3}, {-2, 1, 0}, {0.1, -7, 5}}, masses[4] = {1, 1e-3, 30, 0};
    if (!force->type->at_velocity) return false;
    double f[4][3];
    for (int i = 0; i < 4; i++) force->type->at_velocity(force->params, velocities[i], i < 2 ? 0 : 1, f[i]);
    sk_uniform_force own = {.linear = f[0][0] - f[1][0]};
    own.rate = f[2][0] - f[3][0] - own.linear;
    for (int k = 0; k < 3; k++) own.force[k] = f[0][k], own.acceleration[k] = f[2][k] - f[0][k];
    double speed = 1e-6;
    for (int number = 0; number < 25; number++, speed *= 4) { // to 3e8
        const double *d = directions[number % 3], v[3] = {speed * d[0], speed * d[1], speed * d[2]};
        if (!agrees(force, &own, v, masses[number % 4])) return false;
    }
    for (int k = 0; k < 3; k++) sum->force[k] += own.force[k], sum->acceleration[k] += own.acceleration[k];
    sum->linear += own.linear, sum->rate += own.rate;
    return true;
}
