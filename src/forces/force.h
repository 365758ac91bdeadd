/* Forces: what pushes particles besides constraints and contact. Each type is one file.
 *
 * A force's kernel adds newtons to F over its domain: particles (slots), triangles of the bodies'
 * surfaces, or particles with their neighbours in the grid. */
#ifndef SK_FORCES_FORCE_H
#define SK_FORCES_FORCE_H

#include "base/fields.h"
#include "formula/parameters.h"
#include "plan/row.h"

typedef enum sk_domain { SK_OVER_PARTICLES, SK_OVER_TRIANGLES, SK_OVER_NEIGHBOURS } sk_domain;

typedef struct sk_force_type {
    skein_kind kind;
    sk_domain domain;
    bool sets;        /* its kernel minds the row's `sets`: it can be the first to write F */
    bool on_velocity; /* it depends on velocities */
    sk_kernels kernel;
    /* Adds the force to the sum if it is plain with these parameters, else returns false; NULL: it never is. */
    bool (*plain)(const void *params, sk_plain_force *sum);
    /* For implicit methods, with the row's coefficient a: dst += a d, where -d is how the force grows with the
     * particle's own velocity; the same in x, y and z. NULL: it does not, or too little to matter. */
    sk_kernels resistance;
    /* Neighbour rules: how far they reach, m; NULL else. */
    double (*radius)(const void *params);
    /* The potential energy of a particle at x; NULL: it has none. */
    double (*potential)(const void *params, const double x[3], double mass);
    const sk_making *making; /* what is made from its texts; NULL: nothing */
} sk_force_type;

/* A force as methods see it: a type with its parameters. A row's rule is one of these. */
typedef struct sk_force {
    const sk_force_type *type;
    const void *params;
    const char *label;
    const bool *enabled;
} sk_force;

extern const sk_force_type sk_gravity, sk_wind, sk_surface_wind, sk_drag, sk_separation;

#endif
