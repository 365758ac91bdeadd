/* Bodies: builders, which add particles and rules to a world. Steps know nothing of bodies. */
#ifndef SK_BODIES_BODY_H
#define SK_BODIES_BODY_H

#include "world/world.h"

/* How a body's surface is drawn: an enum skein_look, stored as int32_t. It has no effect on the motion. */
#define SK_LOOK(s, member, initial_)                            \
    SK_CHOICE(s, member, "look", initial_, "cloth|jelly|plain", \
              "what its surface is drawn as: woven; smooth and lit through, with round edges; or of one colour")

/* The constraints that bodies are made of. */
extern const sk_constraint_type sk_distance, sk_dihedral, sk_isometric, sk_straight, sk_twist, sk_volume;

#endif
