/* The report of a run: put together once as a JSON document, written as report.json, and said in lines. */
#include "app/report.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/flocks.h"
#include "app/ranks.h"
#include "io/budget.h"

static double ms_per_step(const app_report *r) {
    return r->statistics.steps ? 1e3 * r->seconds / (double)r->statistics.steps : 0;
}

static double realtime_factor(const app_report *r) {
    return r->seconds > 0 ? r->statistics.time / r->seconds : 0;
}

/* A number for JSON, which has no NaN and no infinity. */
static json_t *number(double x) {
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *count(uint64_t x) {
    return json_integer((json_int_t)x);
}

/* What was typed behind "skein". */
static json_t *command_line(const app_arguments *arguments) {
    json_t *list = json_array();
    json_array_append_new(list, json_string(arguments->command->name));
    for (int i = 0; i < arguments->argc; i++) {
        json_t *word = json_string(arguments->argv[i]);
        json_array_append_new(list, word ? word : json_string("(not UTF-8)"));
    }
    return list;
}

static json_t *trial(const io_trial *t) {
    return t->substeps ? json_pack("{s:i, s:f, s:o, s:o}", "substeps", t->substeps, "ms_per_frame", t->ms,
                                   "max_stretch", number(t->max_stretch), "p99_stretch", number(t->p99_stretch))
                       : json_null();
}

static json_t *budget(const io_budget *b) {
    return json_pack("{s:f, s:i, s:b, s:b, s:o, s:o, s:o}", "ms_per_frame", b->ms, "frames", b->frames, "exceeded",
                     b->exceeded, "bounded", b->bounded, "chosen", trial(&b->chosen), "half", trial(&b->half), "twice",
                     trial(&b->twice));
}

/* What sharing has cost. */
static json_t *ranks_document(const shared_figures *f) {
    return json_pack("{s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "count", f->ranks, "exchange_share",
                     number(f->exchange_share), "imbalance", number(f->imbalance), "bytes_per_step",
                     number(f->bytes_per_step), "cuts", count(f->cuts), "moved", count(f->moved), "most_own",
                     count(f->most_birds), "most_seen", count(f->most_seen), "most_memory", count(f->most_memory),
                     "whole_bodies", count(f->whole_bodies), "start_seconds", number(f->start_seconds));
}

static json_t *make_document(const app_report *r) {
    const skein_statistics *s = &r->statistics;
    const io_scene_settings *scene = &r->loaded->settings;
    const char *failed = r->failure[0] ? r->failure : r->verdict.words;
    char hash[24];
    snprintf(hash, sizeof hash, "%016" PRIx64, s->state_hash);
    const struct {
        const char *key;
        json_t *value;
    } members[] = {
        {"skein", json_string(SKEIN_VERSION)},
        {"commit", json_string(app_commit)},
        {"command_line", command_line(r->arguments)},
        {"precision", json_string(sizeof(skein_real) == 8 ? "double" : "float")},
        {"scene", json_string(r->loaded->path)},
        {"name", json_string(scene->name)},
        {"method", json_string(app_method(r->loaded))},
        {"threads", count((uint64_t)scene->threads)},
        {"device", json_string(r->device)},
        {"interrupted", json_boolean(r->interrupted)},
        {"failed", failed[0] ? json_string(failed) : json_false()},
        {"warnings", count(r->loaded->warnings)},
        // what was done
        {"frames", count((uint64_t)r->frames)},
        {"fps", number(scene->fps)},
        {"step", number(r->dt)},
        {"steps", count(s->steps)},
        {"substeps", count(s->substeps)},
        {"time", number(s->time)},
        {"load_seconds", number(r->loaded->load_seconds)},
        {"run_seconds", number(r->seconds)},
        {"ms_per_step", number(ms_per_step(r))},
        {"realtime_factor", number(realtime_factor(r))},
        {"memory_bytes", count(s->memory_bytes)},
        {"device_bytes", count(r->device_bytes)},
        // the state at the end
        {"particles", count(s->particles)},
        {"pinned_particles", count(s->pinned_particles)},
        {"asleep_particles", count(s->asleep)},
        {"constraints", count(s->constraints)},
        {"contacts", count(s->contacts)},
        {"crossings", count(s->crossings)},
        {"worst_crossings_of_run", count(r->worst_crossings)},
        {"contact_overflows", count(s->contact_overflows)},
        {"crossed_frames", count((uint64_t)r->crossed_frames)},
        {"kinetic_energy", number(s->kinetic_energy)},
        {"potential_energy", number(s->potential_energy)},
        {"elastic_energy", number(s->elastic_energy)},
        {"dissipated_energy", number(s->dissipated_energy)},
        {"max_stretch", number(s->max_stretch)},
        {"p99_stretch", number(s->p99_stretch)},
        {"worst_stretch_of_run", number(r->worst_stretch)},
        {"limited_edges", count(s->limited)},
        {"edges_over_limit", count(s->over_limit)},
        {"most_over_limit", number(s->most_over_limit)},
        {"worst_over_limit_of_run", number(r->worst_over_limit)},
        {"max_penetration", number(s->max_penetration)},
        {"unsolved", count(s->all_unsolved)},
        {"solver_failures", count(s->all_solver_failures)},
        {"nonfinite_particles", count(s->nonfinite)},
        {"guarded_values", count(s->guarded)},
        {"state_hash", json_string(hash)},
        {"files", json_incref(r->files)},
        // what was run, with all changes
        {"document", json_deep_copy(io_scene_document(r->loaded->scene))},
    };
    json_t *root = json_object();
    bool good = true;
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        good &= !json_object_set_new(root, members[i].key, members[i].value);
    const io_budget *b = io_scene_budget(r->loaded->scene);
    if (b->ms > 0) good &= !json_object_set_new(root, "budget", budget(b));
    if (r->shared) good &= !json_object_set_new(root, "ranks", ranks_document(&r->shared->figures));
    if (json_array_size(r->flocks)) good &= !json_object_set(root, "flocks", r->flocks);
    if (good) return root;
    json_decref(root);
    return NULL;
}

bool app_report_print_json(const app_report *report) {
    json_t *root = make_document(report);
    bool good = root && !json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    if (good) putchar('\n');
    else if (!root) fprintf(stderr, "skein: out of memory\n");
    json_decref(root);
    return good;
}

bool app_report_write(app_report *report, const char *folder) {
    size_t size = strlen(folder) + sizeof "/report.failed.json";
    char *path = malloc(size);
    json_t *root = make_document(report);
    char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(root);
    skein_error error = {SKEIN_ERROR_MEMORY, "report.json", "out of memory"};
    if (path && text) {
        snprintf(path, size, "%s/report%s.json", folder, report->failure[0] ? ".failed" : "");
        io_output *output = io_output_open(path, &error);
        if (output) {
            io_output_write(output, text, strlen(text));
            io_output_write(output, "\n", 1);
            if (!io_output_commit(output, &error)) error.status = SKEIN_OK;
        }
    }
    if (error.status) app_print_error(&error);
    else json_array_append_new(report->files, json_string(path));
    free(text);
    free(path);
    return !error.status;
}

static const char *plural(uint64_t n) {
    return n == 1 ? "" : "s";
}

/* Whether the edges keep the limit that they were given. */
static void print_limit(const app_report *r) {
    const skein_statistics *s = &r->statistics;
    if (!s->limited) return;
    if (s->over_limit)
        printf(
            "stretch limit not kept: %zu of %zu edges are over it, by up to %.3g %% of their length (%.3g %% during the "
            "run): more substeps help\n",
            s->over_limit, s->limited, 100 * s->most_over_limit, 100 * r->worst_over_limit);
    else
        printf("stretch limit kept by all %zu edges (over it by up to %.3g %% of their length during the run)\n",
               s->limited, 100 * r->worst_over_limit);
}

void app_report_print(const app_report *r) {
    const skein_statistics *s = &r->statistics;
    printf("%zu particles, %zu constraints; %d frame%s, %" PRIu64 " step%s of %.4g ms%s\n", s->particles,
           s->constraints, r->frames, plural((uint64_t)r->frames), s->steps, plural(s->steps), 1e3 * r->dt,
           r->interrupted ? " (interrupted)" : "");
    printf("%.3f ms a step, %.2f times real time\n", ms_per_step(r), realtime_factor(r));
    printf(
        "kinetic energy %.3g J, stretch at most %.2f %% (99 %% of edges under %.2f %%), penetration at most %.2g mm\n",
        s->kinetic_energy, 100 * s->max_stretch, 100 * s->p99_stretch, 1e3 * s->max_penetration);
    print_limit(r);
    if (s->asleep == s->particles && s->asleep) printf("all sleep\n");
    else if (s->asleep) printf("%zu of %zu particles sleep\n", s->asleep, s->particles);
    if (r->crossed_frames)
        printf("%d frame%s had edges that go through faces, up to %zu in one; %zu at the end\n", r->crossed_frames,
               plural((uint64_t)r->crossed_frames), r->worst_crossings, s->crossings);
    else if (r->counts_crossings) printf("no edge went through a face in any frame\n");
    if (s->contact_overflows)
        printf("contact gave up %" PRIu64
               " time%s, for more pairs were near each other than there is room for: a smaller thickness helps\n",
               s->contact_overflows, plural(s->contact_overflows));
    if (s->all_unsolved)
        printf("%" PRIu64 " of %" PRIu64
               " substeps were left unsolved: more substeps, newton_iterations or cg_iterations help\n",
               s->all_unsolved, s->substeps);
    if (s->all_solver_failures)
        printf("%" PRIu64 " times a factor failed, and each particle's own block took its place\n",
               s->all_solver_failures);
    if (r->shared) {
        const shared_figures *f = &r->shared->figures;
        printf("%d ranks: %.1f %% of the time for exchange, %.1f %% imbalance, %.4g kB a step", f->ranks,
               100 * f->exchange_share, 100 * f->imbalance, 1e-3 * f->bytes_per_step);
        if (f->cuts)
            printf("; space cut %zu time%s, at most %zu birds a rank and %zu of others", f->cuts,
                   plural((uint64_t)f->cuts), f->most_birds, f->most_seen);
        printf("; at most %.3g MB a rank but the first", 1e-6 * (double)f->most_memory);
        if (f->whole_bodies)
            printf("; %zu bod%s on one rank each", f->whole_bodies, f->whole_bodies == 1 ? "y" : "ies");
        printf("\n");
    }
    app_flocks_print(r->flocks);
    printf("state hash %016" PRIx64 "\n", s->state_hash);
    size_t index;
    json_t *file;
    json_array_foreach(r->files, index, file) printf("wrote %s\n", json_string_value(file));
}
