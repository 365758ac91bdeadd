/* Bodies: the builders. Each lays down particles and rules; the step knows none of them. */
#ifndef SK_BODIES_BODY_H
#define SK_BODIES_BODY_H

#include "world/world.h"

extern const sk_body_type sk_cloth, sk_lattice, sk_rope, sk_tetrahedra, sk_flock;

#endif
