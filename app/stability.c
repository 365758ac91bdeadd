/* skein stability SCENE: the largest stable step of each method. */
#include <math.h>
#include <stdio.h>

#include "io/own_kinds.h"

#include "app/command.h"

/* The substep that the scene asks for. */
static double substep_of(const app_scene *loaded, double *dt) {
    skein_value substeps = skein_number(1);
    io_scene_steps_per_frame(&loaded->settings, dt);
    skein_get_path(loaded->world, "method.substeps", &substeps);
    return *dt / substeps.number[0];
}

static bool find(const app_scene *loaded, skein_stability *stability) {
    if (!skein_world_stability(loaded->world, stability)) return true;
    app_print_error(skein_world_error(loaded->world));
    return false;
}

static void print_modes(const app_scene *loaded, const skein_stability *s) {
    static const char *const names[] = {"stiffest", "most damped", "between them"};
    printf("%s: ", loaded->path);
    if (!s->mode_count) printf("no finite springs and no air: nothing limits the step\n");
    for (size_t i = 0; i < s->mode_count; i++) {
        const skein_mode *m = &s->modes[i];
        printf("%smode %-12s %.4g rad/s (%.4g Hz), damping ratio %.3g\n", i ? "  " : "\n  ", names[i], m->frequency,
               m->frequency / (2 * 3.14159265358979323846),
               m->frequency > 0 ? m->damping_rate / m->frequency : INFINITY);
    }
}

static void print_methods(const app_scene *loaded, const skein_stability *s) {
    double dt, substep = substep_of(loaded, &dt);
    printf("\n%-18s %-22s %s %.4g ms\n", "method", "largest stable substep", "substeps for a step of", 1e3 * dt);
    for (size_t i = 0; io_kind_at(SKEIN_METHOD, i); i++) {
        const char *name = io_kind_at(SKEIN_METHOD, i)->name;
        double most = skein_kinds_stable_substep(io_kinds(), name, s);
        if (isinf(most)) printf("%-18s %-22s 1\n", name, "any");
        else if (most <= 0) printf("%-18s %-22s none is enough: it grows at any step\n", name, "none");
        else printf("%-18s %-6.4g %-15s %.0f\n", name, 1e3 * most, "ms", ceil(dt / most));
    }
    printf("\nThe scene runs %s with substeps of %.4g ms: %s.\n", app_method(loaded), 1e3 * substep,
           substep <= skein_kinds_stable_substep(io_kinds(), app_method(loaded), s) ? "stable" : "UNSTABLE");
    if (s->swinging_is_free)
        printf("Damping along constraints does not damp swinging: under explicit_euler and midpoint that grows,\n"
               "slowly, at any step. The force \"drag\" damps it.\n");
}

static int stability(app_arguments *arguments) {
    app_scene loaded = {.quiet = false};
    skein_stability s;
    int status = app_load(app_word(arguments), app_values(arguments, "--set"), &loaded);
    if (!status && !find(&loaded, &s)) status = EXIT_FAILURE_RUN;
    if (!status) {
        print_modes(&loaded, &s);
        print_methods(&loaded, &s);
    }
    app_unload(&loaded);
    return status;
}

static const app_option options[] = {APP_SET_OPTION, APP_END_OF_OPTIONS};

const app_command app_stability_command = {
    "stability",
    "SCENE [--set PATH=VALUE]...",
    "say how large a step each method can take before things blow up\n\n"
    "From the stiffest way in which the scene can vibrate, as it lies at its start: its springs and their damping,\n"
    "and the air's. What is stretched later on can be stiffer; contact and rigid constraints are left out.\n"
    "With frequency omega and damping ratio zeta, the limits are about 2/omega (symplectic_euler, leapfrog), \n"
    "2.828/omega (rk4), 1/omega (lookahead_euler), and 2 zeta/omega (explicit_euler).",
    options,
    "scene",
    false,
    APP_TAKES_SCENE,
    stability,
    NULL,
};
