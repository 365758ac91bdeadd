/* PBD, position based dynamics (Mueller and others 2007): predict, project every constraint as if it were
 * rigid, and take the velocity from the way that was made. How firm things become depends on passes and
 * substeps, not on the constraints' stiffness: that is what xpbd adds. A stiffness of 0 is no constraint;
 * dampings are not used. */
#include "methods/method.h"

typedef struct pbd_params {
    int32_t substeps, iterations;
} pbd_params;

static const skein_field fields[] = {
    SK_INT(pbd_params, substeps, "substeps", "", 10, 1, 100000,
           "equal parts that a step is cut into; more is firmer and more exact"),
    SK_INT(pbd_params, iterations, "iterations", "", 1, 1, 1000, "passes over the constraints in a substep"),
};

static void write(sk_writer *writer, const void *data, double dt) {
    const pbd_params *params = data;
    double h = dt / params->substeps;
    size_t repeat = sk_write_predicted_repeat(writer, (size_t)params->substeps, h, params->iterations);
    sk_write_rigid_projections(writer, params->iterations);
    sk_write_limits(writer, SK_NONE);
    sk_write_following(writer, params->iterations);
    sk_write_contacts(writer, SK_CONTACT_SETTLE);
    sk_write_end(writer, repeat);
}

const sk_method_type sk_pbd = {
    .kind = {"pbd", "positions corrected as if every constraint were rigid; substeps and passes say how firm",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(pbd_params)},
    .write = write,
    .substeps = sk_substeps_of,
};
