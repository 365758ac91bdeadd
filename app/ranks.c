/* Ranks of an MPI job, and a run that they share. Rank 0 loads the scene and runs it as one process does, but that its world
 * is stepped by all; every rank has a world of the same scene with fewer birds. */
#include "app/ranks.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/progress.h"
#include "io/budget.h"
#include "io/module.h"

bool app_is_rank(void) {
    // OpenMPI, MPICH and its kin (Intel's), and srun without either
    static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *size = getenv(names[i]);
        if (size && strtol(size, NULL, 10) > 1) return true;
    }
    const char *tasks = getenv("SLURM_STEP_NUM_TASKS");
    return tasks && strtol(tasks, NULL, 10) > 1 && getenv("PMIX_RANK");
}

const ranks_content *app_ranks_join(const char *command, const char *instead, int *rank, int *count, int *here) {
    skein_error error = {SKEIN_OK, "", ""};
    const ranks_content *ranks = io_module_load("ranks", &error);
    if (!ranks) {
        fprintf(stderr,
                "%s: this is one of several processes of an MPI job, and this skein was built without MPI: "
                "'tools/setup build' installs it, then build again; or %s (%s)\n",
                command, instead, error.message);
        return NULL;
    }
    if (ranks->begin(rank, count, here)) return ranks;
    fprintf(stderr, "%s: the MPI job could not be joined\n", command);
    return NULL;
}

/* ---- a run that they share ---- */

int app_shared_join(app_shared *shared, app_arguments *arguments) {
    if (!app_is_rank()) return EXIT_OK;
    int here = 1;
    const char *device = app_value(arguments, "--device");
    if (device && strcmp(device, "cpu") != 0) {
        fprintf(stderr, "skein run: --device %s: the ranks of an MPI job step on processors\n", device);
        return EXIT_FAULT;
    }
    if (app_word(arguments) && !strcmp(app_word(arguments), "-")) {
        fprintf(stderr, "skein run: -: every rank of an MPI job reads the scene: name a file that all can read\n");
        return EXIT_FAULT;
    }
    shared->ranks = app_ranks_join("skein run", "start one process", &shared->rank, &shared->count, &here);
    if (!shared->ranks) return EXIT_FAILURE_RUN;
    long processors = sysconf(_SC_NPROCESSORS_ONLN) / here;
    snprintf(shared->threads, sizeof shared->threads, "threads=%ld", processors > 1 ? processors : 1);
    return app_set_first(arguments, shared->threads) ? EXIT_OK : EXIT_FAILURE_RUN;
}

/* A body that lives on another rank. */
static skein_status put_aside(skein_world *world, const shared_wanted *body, size_t number) {
    char path[64];
    snprintf(path, sizeof path, "bodies.%zu.enabled", number);
    if (body->loose || body->here) return SKEIN_OK;
    return body->shadow ? skein_world_part_shadow(world, number) : skein_set_path(world, path, skein_number(0));
}

/* The scene once more, with so many birds in each flock, and other bodies where they live here. */
static skein_world *make_part(void *user, const shared_wanted *body, size_t bodies) {
    const app_shared *shared = user;
    size_t count = 0;
    while (shared->sets && shared->sets[count]) count++;
    const char **sets = calloc(count + 2 * bodies + 1, sizeof *sets);
    char(*text)[2][64] = calloc(bodies + 1, sizeof *text);
    app_scene *loaded = calloc(1, sizeof *loaded);
    if (!sets || !text || !loaded) return NULL;
    if (count) memcpy(sets, shared->sets, count * sizeof *sets);
    for (size_t b = 0; b < bodies; b++) {
        if (!body[b].loose) continue;
        snprintf(text[b][0], sizeof text[b][0], "bodies.%zu.side=0", b);
        snprintf(text[b][1], sizeof text[b][1], "bodies.%zu.count=%zu", b, body[b].birds);
        sets[count++] = text[b][0], sets[count++] = text[b][1];
    }
    loaded->quiet = true;
    skein_world *world = app_load(shared->word, sets, loaded) ? NULL : loaded->world;
    loaded->world = NULL; // it goes on
    for (size_t b = 0; world && b < bodies; b++) {
        if (!put_aside(world, &body[b], b)) continue;
        app_print_error(skein_world_error(world));
        skein_world_destroy(world);
        world = NULL;
    }
    app_unload(loaded);
    free(loaded);
    free(text);
    free(sets);
    return world;
}

static void unmake_part(void *user, skein_world *world) {
    (void)user;
    skein_world_destroy(world);
}

static int begin(app_shared *shared, const char *word, const char *const *sets) {
    shared->word = word, shared->sets = sets;
    shared->run =
        shared_begin(shared->ranks, shared->rank, shared->count, (shared_source){shared, make_part, unmake_part});
    if (shared->run) return EXIT_OK;
    fprintf(stderr, "skein: out of memory\n");
    return EXIT_FAILURE_RUN;
}

int app_shared_lead(app_shared *shared, app_scene *loaded, const char *word, const char *const *sets) {
    double dt;
    skein_error error = {SKEIN_OK, "", ""};
    if (!shared->ranks) return EXIT_OK;
    if (io_scene_budget(loaded->scene)->ms > 0) {
        fprintf(stderr, "skein: method.budget_ms: each rank would choose substeps of its own: say how many\n");
        return EXIT_FAULT;
    }
    int status = begin(shared, word, sets);
    if (status) return status;
    io_scene_steps_per_frame(&loaded->settings, &dt);
    if (!shared_lead(shared->run, loaded->world, dt, &error)) return EXIT_OK;
    app_print_error(&error);
    return EXIT_FAULT;
}

int app_shared_serve(app_shared *shared, const char *word, const char *const *sets) {
    // a signal that is meant for the job ends it through rank 0, which has what is to be written
    app_catch_interrupts();
    int status = begin(shared, word, sets);
    if (!status) shared_serve(shared->run);
    shared_end(shared->run);
    shared->ranks->end();
    return status;
}

bool app_shared_record(app_shared *shared, const char *out, int frame, double time) {
    if (!shared->run) return true;
    if (!shared->parts[0]) {
        int length = snprintf(shared->parts, sizeof shared->parts, "%s/parts", out);
        if (frame > 1 && length > 0 && (size_t)length < sizeof shared->parts)
            snprintf(shared->parts + length, sizeof shared->parts - (size_t)length, "-from-%d", frame - 1);
        if (mkdir(shared->parts, 0777) && errno != EEXIST) {
            fprintf(stderr, "skein: %s: %s\n", shared->parts, strerror(errno));
            return false;
        }
    }
    shared_record(shared->run, shared->parts, time);
    return true;
}

void app_shared_measure(app_shared *shared) {
    if (shared->run) shared_measure(shared->run, &shared->figures);
}

void app_shared_leave(app_shared *shared) {
    if (!shared->ranks || shared->rank) return;
    // where the run could not begin, the others wait all the same
    if (!shared->run && begin(shared, "", NULL)) shared->ranks->abandon(EXIT_FAILURE_RUN);
    shared_dismiss(shared->run);
    shared_end(shared->run);
    shared->ranks->end();
}
