/* PBD, position based dynamics (Mueller and others 2007): predict positions, correct a share of each constraint's
 * error, and take velocities from the change of position. The textbook's share is a number between 0 and 1 that means
 * another stiffness for every substep and mass; here it follows from the constraint's own stiffness k,
 *
 *   s = K/(n + K),   K = k h^2 sum w |grad C|^2,   n passes,
 *
 * so that a soft spring is soft, and a rigid one (s = 1) is a rod. Unlike XPBD's, passes keep no multiplier from one to
 * the next: a single constraint is left with 1/(1 + K/n)^n of its error after n of them, 1/(1 + K) after one. So one
 * pass is the same as XPBD's, and with several a constraint of large K is stiffer than its k says. */
#include "methods/method.h"

typedef struct pbd_params {
    int32_t substeps, iterations;
    bool inertia;
} pbd_params;

static const skein_field fields[] = {
    SK_INT(
        pbd_params, substeps, "substeps", "", 10, 1, 100000,
        "equal parts that a step is cut into, fewer where steps get shorter, more where contact is fast (more_substeps); "
        "more is firmer and more exact"),
    SK_INT(pbd_params, iterations, "iterations", "", 1, 1, 1000,
           "passes over the constraints in a substep, which share the stiffness; stiff ones come out stiffer"),
    SK_BOOL(
        pbd_params, inertia, "inertia", 1,
        "false: constraints move positions, and pins go their way; other velocities, and forces, are as if they were not"),
};

/* Projections alone, as a solver for constraints: with velocities, particles would fly on after a solve. Pinned
 * particles still move by their velocities, which is how they are led. */
static void write_projections_only(sk_plan_builder *builder, const pbd_params *params, double h) {
    size_t repeat = sk_write_repeat(builder, (size_t)params->substeps, h);
    sk_write_stage_time(builder, 1);
    if (sk_writes_velocity_forces(builder)) sk_write_sum(builder, SK_X0, 1, SK_X, 0, SK_NONE); // damping looks back
    else sk_write_start(builder);
    sk_write_lead(builder, h);
    sk_write_shared_projections(builder, params->iterations);
    sk_write_limits(builder, SK_NONE);
    sk_write_contacts(builder, SK_CONTACT_PUSH);
    sk_write_end(builder, repeat);
}

static void write(sk_plan_builder *builder, const void *data, double dt) {
    const pbd_params *params = data;
    double h = dt / params->substeps;
    if (!params->inertia) {
        write_projections_only(builder, params, h);
        return;
    }
    size_t repeat = sk_write_repeat(builder, (size_t)params->substeps, h);
    sk_write_prediction(builder);
    sk_write_shared_projections(builder, params->iterations);
    sk_write_limits(builder, SK_NONE);
    sk_write_correction(builder);
    sk_write_contacts(builder, SK_CONTACT_UPDATE);
    sk_write_end(builder, repeat);
}

const sk_method_type sk_pbd = {
    .kind = {"pbd", "positions corrected by a share of each error; passes forget each other and share the stiffness",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(pbd_params)},
    .takes_rigid = true,
    .shortens_slowly = true,
    .write = write,
    .substeps = sk_substeps_of,
};
