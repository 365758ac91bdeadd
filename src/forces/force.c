#include "forces/force.h"

bool sk_force_on_velocity(const sk_force *force) {
    const sk_force_type *type = force->type;
    return type->uses_velocity ? type->uses_velocity(force->params) : type->on_velocity;
}

int32_t sk_force_particle(const sk_force *force) {
    return force->type->particle ? force->type->particle(force->params) : -1;
}
