/* Gradients of a run: the derivative of one number, a measure of the final state or of all states, with respect to where
 * particles begin, how fast, and any fields of the world; by the adjoint method, at the cost of a few runs, however many
 * numbers are asked for.
 *
 *     skein_gradient_desc desc = {.dt = 1 / 60.0, .steps = 120, .measure = distance_to_target, .user = &target,
 *                                 .fields = (const char *const[]){"bodies.0.stretch.stiffness", NULL}};
 *     skein_gradient_result result = {.by_field = slope};
 *     skein_gradient(world, &desc, &result);
 *
 * It differentiates the run as computed, step by step, not the motion that it approximates. For backward Euler's solves
 * it differentiates the equation that they solve, as exactly as the method's tolerance says. docs/gradients.md says
 * what it can do and how. */
#ifndef SKEIN_GRADIENT_H
#define SKEIN_GRADIENT_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

/* A state that is measured. Positions (m) and velocities (m/s) are three numbers a particle, in the user's order. */
typedef struct skein_gradient_state {
    size_t step; /* after so many steps; 0: before the first */
    double time; /* s */
    size_t particle_count;
    const double *positions, *velocities;
    double *by_positions, *by_velocities; /* all 0: the derivatives of what is returned go here */
} skein_gradient_state;

typedef struct skein_gradient_desc {
    double dt; /* s, of a step */
    size_t steps;
    /* What this state adds to the measure, with its derivatives; asked for each state once, from the last to the first. */
    double (*measure)(void *user, const skein_gradient_state *state);
    void *user;
    const char *const *fields; /* paths as skein_set_path() has them, ended by NULL; or NULL: none */
    size_t most_bytes; /* what may be kept of the states on the way; 0: 256 MB. With less than all of them need, those of a
                          square root of the steps are kept, and the others are computed once more */
} skein_gradient_desc;

typedef struct skein_gradient_result {
    double value;          /* the measure */
    double *by_positions;  /* 3 numbers a particle, of the start; or NULL */
    double *by_velocities; /* likewise */
    double *by_field;      /* a number for each number of each field, in their order; or NULL */
} skein_gradient_result;

/* Computes it from the present state, which is restored. Fields are numbers that the run reads as stiffness or damping
 * of constraints, or as a uniform force (gravity, drag, wind). It fails for a field on which anything else depends,
 * such as a mass or a rest length. Rest lengths are constant where positions are varied.
 *
 * Methods: those that only add up vectors and forces, symplectic_euler, explicit_euler, leapfrog, midpoint and rk4;
 * backward_euler, whose linear systems keep 46 vectors of four numbers a particle besides; and xpbd and pbd, of which it keeps
 * all projections of one substep: 7 numbers each, and 6 for each of its particles. Pins go where motions lead them;
 * where they begin changes only their way there.
 * Fails, and names the op, with SKEIN_ERROR_VALUE for anything else in the plan: colliders, contact, limits (tethers, coarse
 * levels), rules that steer, forces that are not uniform; under projections for energies and closed surfaces, and where a
 * constraint's value has a kink, as a length has that is 0 (an attachment's without load); for a library in single precision, whose rounding is too large for this;
 * where places of skein_pins_move() wait; where a substep is not solved (skein_statistics' `unsolved`), or its linear system
 * cannot be; and where the run or a field is not such; with SKEIN_ERROR_NAME for a path that leads nowhere; and with
 * SKEIN_ERROR_MEMORY. */
skein_status skein_gradient(skein_world *world, const skein_gradient_desc *desc, skein_gradient_result *result);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
