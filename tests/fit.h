/* What tests of `skein fit` share: a cloth that hangs, a cache of its run, and the report of a fit of three stiffnesses. */
#ifndef SKEIN_TEST_FIT_H
#define SKEIN_TEST_FIT_H

#include "test_command.h"

#include <math.h>

static const char *const fit_paths[3] = {"bodies.0.stretch.stiffness", "bodies.0.shear.stiffness",
                                         "bodies.0.bend.rigidity"};
static const double fit_truth[3] = {100, 20, 1e-4};

/* A square of `side` by `side` particles that swings from its top edge: the scene and, in the folder `name`, its cache. */
static inline void make_target(const char *name, int side, int frames, const char *method) {
    char text[1000], scene[64];
    snprintf(scene, sizeof scene, "%s.json", name);
    snprintf(text, sizeof text,
             "{'skein': 1, 'frames': %d, 'method': {%s}, 'bodies': [{'type': 'cloth', 'name': 'sheet', 'grid': [%d, %d],"
             "'pins': 'top edge', 'rotation': [60, 0, 0], 'stretch': {'stiffness': 100, 'tether': 'infinite'}, "
             "'shear': {'stiffness': 20}, 'bend': {'rigidity': 1e-4}}], 'output': [{'type': 'pc2'}],"
             "'forces': [{'type': 'gravity'}, {'type': 'drag', 'rate': 2}]}",
             frames, method, side, side);
    write_scene(in_folder(scene), text);
    outcome o = SKEIN("run", in_folder(scene), "--out", in_folder(name), "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
}

/* The scene with other numbers to begin with, fitted; the report is to be let go. */
static inline json_t *fit_from(const char *name, const double factors[3], const char *most_iterations, const char *out) {
    char sets[3][100], scene[64], cache[64], vary[300];
    json_error_t error;
    for (int i = 0; i < 3; i++) snprintf(sets[i], sizeof sets[i], "%s=%.17g", fit_paths[i], factors[i] * fit_truth[i]);
    snprintf(scene, sizeof scene, "%s.json", name);
    snprintf(cache, sizeof cache, "%s/sheet.pc2", name);
    snprintf(vary, sizeof vary, "%s,%s,%s", fit_paths[0], fit_paths[1], fit_paths[2]);
    outcome o =
        SKEIN("fit", in_folder(scene), "--target", in_folder(cache), "--vary", vary, "--set", sets[0], "--set", sets[1],
              "--set", sets[2], "--json", "--no-progress", "--iterations", most_iterations, "--out", out);
    if (o.status != 0 && o.status != 1) fail_msg("%d: %s", o.status, o.err);
    json_t *report = json_loads(o.out, 0, &error);
    if (!report) fail_msg("%s in %s", error.text, o.out);
    outcome_free(&o);
    return report;
}

/* All three to 1 %; or bending to another share. */
static inline void assert_found(const json_t *report, double bending) {
    json_t *found = json_object_get(report, "found");
    for (int i = 0; i < 3; i++) {
        double x = json_number_value(json_object_get(found, fit_paths[i]));
        if (!(fabs(x / fit_truth[i] - 1) < (i == 2 ? bending : 0.01)))
            fail_msg("%s is found as %g, not %g", fit_paths[i], x, fit_truth[i]);
    }
}

#endif
