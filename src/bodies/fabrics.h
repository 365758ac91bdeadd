/* Fabrics: what a cloth's field `fabric` stands for. Its words, and the numbers with where they are from, in fabrics.c. */
#ifndef SK_BODIES_FABRICS_H
#define SK_BODIES_FABRICS_H

#include "base/fields.h"

#define SK_FABRIC_FIELD "fabric"
#define SK_FABRICS "none|cotton|silk|denim|wool|felt|rubber|paper"

extern const sk_presets sk_fabrics;

#endif
