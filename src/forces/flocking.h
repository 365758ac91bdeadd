/* Flocking: its parameters, and the numbers that the kernel and the shader compute with.
 *
 * A neighbour at distance d inside the reach r has the relative distance u = d/r, or d^2/r^2. Its part of the steering,
 * in units of strength dt:
 *
 *           u   0 ........ away ........ along ........ 1          away, along: thresholds
 *   it is     pushed away    | flown with | drawn near
 *
 *   under `away`:   away/u - 1,            away from the neighbour
 *   under `along`:  0.5 - 0.5 cos(2 pi a) + 0.5, along the neighbour's direction of flight
 *   else:           0.5 cos(2 pi a),             towards it; it pushes in the middle of its zone
 *
 * with a from 0 to 1 through each zone. Parts are summed, not averaged. */
#ifndef SK_FORCES_FLOCKING_H
#define SK_FORCES_FLOCKING_H

#include "forces/force.h"

enum { SK_FLOCKING_MOST_NEAREST = 64 };

/* The kind's parameters. */
typedef struct sk_flocking_params {
    double separation, alignment, cohesion; /* m: widths of the zones */
    int32_t measure;                        /* 0: distance, 1: its square */
    double strength;                        /* m/s2 */
    double view;                            /* degrees: the angle of view around the direction of flight */
    int32_t nearest;                        /* only this many neighbours count, the nearest; 0: all in reach */
    char *neighbours;                       /* the name of a body */
    char *towards, *along;                  /* formulas in place of the zones' weights, or "" */
    struct sk_pair_formula *pair;           /* made from these formulas; NULL if there are none */
} sk_flocking_params;

typedef struct sk_flocking_numbers {
    real reach;       /* r, m; 0: there are no neighbours */
    real per_reach;   /* 1/r */
    real away, along; /* thresholds of the relative distance */
    real per_along;   /* 1/(along - away), 0 where that zone has no width */
    real per_towards; /* 1/(1 - along), likewise */
    real least;       /* m: nearer neighbours count as this near, which keeps weights finite */
    bool squared;
    bool sees_all;
    real view;     /* cosine of half the angle */
    int32_t count; /* of neighbours at most; 0: all */
} sk_flocking_numbers;

sk_flocking_numbers sk_flocking_numbers_of(const sk_flocking_params *params);

/* -cos(2 pi t) = cos(2 pi (t + 0.5)) for |t| <= 0.5, as a polynomial in t^2; the error is at most 1.2e-8. */
#define SK_FLOCKING_COSINE(s_)                                   \
    ((real)-0.99999998894457653 +                                \
     (s_) * ((real)19.739204466576133 +                          \
             (s_) * ((real)-64.939115928346439 +                 \
                     (s_) * ((real)85.450113427506139 +          \
                             (s_) * ((real)-60.167429791965688 + \
                                     (s_) * ((real)25.966884612699047 + (s_) * (real)-6.5277059631782182))))))

#endif
