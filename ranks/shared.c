/* The leader of a shared run, and what it calls for. A call is a message of the leader's to all, with what each rank has to
 * tell at that time; then all do the same. */
#include "ranks/shared.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "ranks/shared_inside.h"

enum {
    EVERY = 16,         /* steps between looks at the balance, */
    CROSS = 4,          /* and between looks at who has crossed: ranks know where their birds are, beyond cuts or not */
    FEW = 1 << 16,      /* birds, whose state is kept before every step */
    SURE = 7,           /* eighths of the room: with fewer birds a step cannot need more */
    WORK_OF_A_BIRD = 64 /* constraints or particles of whole bodies that take as long, until it is known */
};
static const double most_imbalance = 0.1;

typedef enum shared_what { STEP, SPREAD_AND_STEP, READ, RECORD, TELL, DISMISS } shared_what;

typedef struct shared_call {
    shared_what what; /* the leader's counts */
    double time, dt;
    size_t body_count;
    shared_tale tale;
} shared_call;

double shared_seconds(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

_Noreturn void shared_give_up(const shared_run *run, const char *what) {
    fprintf(stderr, "skein: rank %d of %d: %s\n", run->rank, run->count, what);
    fflush(stderr);
    run->ranks->abandon(1);
    exit(1);
}

void *shared_grow(const shared_run *run, shared_bytes *bytes, size_t size) {
    if (bytes->size + size > bytes->capacity) {
        size_t capacity = 2 * bytes->capacity + size + 4096;
        unsigned char *data = realloc(bytes->data, capacity);
        if (!data) shared_give_up(run, "out of memory");
        bytes->data = data, bytes->capacity = capacity;
    }
    void *at = bytes->data + bytes->size;
    bytes->size += size;
    return at;
}

void shared_trade(shared_run *run) {
    double begun = shared_seconds();
    size_t count = (size_t)run->count, own[count];
    for (size_t r = 0; r < count; r++) own[r] = run->out[r].size;
    run->ranks->gather(own, count * sizeof *own, run->sizes);
    for (size_t r = 0; r < count; r++) {
        if (!own[r] || (int)r == run->rank) continue;
        run->ranks->send_begin((int)r, run->out[r].data, own[r]);
        run->tale.bytes += (double)own[r];
    }
    run->in.size = 0;
    for (size_t r = 0; r < count; r++) {
        size_t size = run->sizes[r * count + (size_t)run->rank];
        if (!size || (int)r == run->rank) continue;
        run->ranks->size_from((int)r);
        run->ranks->receive((int)r, shared_grow(run, &run->in, size), size);
    }
    run->ranks->send_end();
    run->tale.exchange += shared_seconds() - begun;
}

shared_run *shared_begin(const ranks_content *ranks, int rank, int count, shared_source source) {
    size_t n = (size_t)count;
    shared_run *run = calloc(1, sizeof *run);
    if (!run) return NULL;
    *run = (shared_run){.ranks = ranks, .rank = rank, .count = count, .source = source};
    run->cuts = calloc(n, sizeof *run->cuts);
    run->out = calloc(n, sizeof *run->out);
    run->burden = calloc(n, sizeof *run->burden);
    run->sizes = calloc(n * n, sizeof *run->sizes);
    run->tales = calloc(n, sizeof *run->tales);
    snprintf(run->name_text, sizeof run->name_text, "%d ranks", count);
    if (run->cuts && run->out && run->burden && run->sizes && run->tales) return run;
    shared_end(run);
    return NULL;
}

void shared_end(shared_run *run) {
    if (!run) return;
    shared_record_close(run);
    if (run->world) run->source.unmake(run->source.user, run->world);
    for (int r = 0; r < run->count && run->out; r++) free(run->out[r].data);
    free(run->in.data);
    free(run->before.data);
    free(run->number);
    free(run->body_of);
    free(run->bodies);
    free(run->wanted);
    free(run->burden);
    free(run->cuts);
    free(run->out);
    free(run->boxes);
    free(run->sizes);
    free(run->tales);
    free(run);
}

/* ---- what all do at once ---- */

/* So many bodies, about which the leader is going to tell. */
static void set_bodies(shared_run *run, size_t count) {
    if (run->boxes && run->body_count == count) return;
    free(run->bodies), free(run->boxes), free(run->wanted);
    run->body_count = count;
    run->bodies = calloc(count + 1, sizeof *run->bodies);
    run->boxes = calloc((count + 1) * (size_t)(run->count + 1), sizeof *run->boxes);
    run->wanted = calloc(count + 1, sizeof *run->wanted);
    if (!run->bodies || !run->boxes || !run->wanted) shared_give_up(run, "out of memory");
}

/* Whether more may come to a body in the next step than it has room for: as many as in the last, of whatever rule, and a few;
 * and all of a whole body at once. Where there are few birds it is not worth a thought. */
static bool is_unsure(const shared_run *run, const shared_body *body) {
    size_t elsewhere = 0;
    if (!body->of.loose) return false;
    for (size_t b = 0; b < run->body_count; b++)
        if (!run->bodies[b].of.loose && run->bodies[b].of.enabled && !run->bodies[b].own)
            elsewhere += run->bodies[b].of.count;
    return body->room < FEW || (body->most + elsewhere) * 8 >= body->room * SURE;
}

static size_t memory_had(void) {
    struct rusage used;
    if (getrusage(RUSAGE_SELF, &used)) return 0;
    return (size_t)used.ru_maxrss * 1024; // Linux counts kB
}

/* What the leader calls for, and what all tell. */
static shared_call call(shared_run *run, shared_call own) {
    shared_call all[run->count];
    run->tale.own = shared_own(run);
    run->tale.memory = memory_had();
    run->tale.unsure = 0; // and the step after a cut is kept in any case
    for (size_t b = 0; b < run->body_count; b++) run->tale.unsure |= is_unsure(run, &run->bodies[b]);
    own.tale = run->tale;
    own.body_count = run->body_count;
    run->ranks->gather(&own, sizeof own, all);
    for (int r = 0; r < run->count; r++) run->tales[r] = all[r].tale;
    if (run->rank) set_bodies(run, all[0].body_count);
    return all[0];
}

static double imbalance_of(const shared_run *run) {
    double most = 0, sum = 0;
    for (int r = 0; r < run->count; r++) {
        if (run->tales[r].work > most) most = run->tales[r].work;
        sum += run->tales[r].work;
    }
    return sum > 0 ? most * run->count / sum - 1 : 0;
}

/* The leader tells all which bodies there are, and where whole ones live. Each makes what it has of them anew. */
static void tell_bodies(shared_run *run) {
    size_t size = run->body_count * sizeof *run->bodies, n = (size_t)run->count;
    shared_body *all = malloc(n * size + 1);
    if (!all) shared_give_up(run, "out of memory");
    run->ranks->gather(run->bodies, size, all);
    bool same = run->world != NULL;
    for (size_t b = 0; b < run->body_count; b++) {
        shared_body *body = &run->bodies[b];
        bool here = !all[b].of.loose && all[b].of.enabled && all[b].rank == run->rank;
        same &= body->of.loose || (body->own != 0) == here;
        body->of = all[b].of, body->rank = all[b].rank;
        if (!body->of.loose) body->own = here ? body->of.count : 0;
    }
    free(all);
    if (!same && run->world) run->source.unmake(run->source.user, run->world), run->world = NULL;
    memset(run->burden, 0, n * sizeof *run->burden);
    for (size_t b = 0; b < run->body_count; b++)
        if (!run->bodies[b].of.loose && run->bodies[b].of.enabled)
            run->burden[run->bodies[b].rank] += run->bodies[b].of.work / WORK_OF_A_BIRD;
    shared_forget_birds(run);
}

static int owner_of(const shared_run *run, uint32_t number, const skein_real p[4]) {
    const shared_body *body = &run->bodies[shared_body_with(run, number)];
    if (!body->of.enabled) return run->count;
    return body->of.loose
               ? ranks_owner(run->cuts, run->count, (const double[3]){(double)p[0], (double)p[1], (double)p[2]})
               : body->rank;
}

/* Cuts space by where the leader's birds are. What one costs is not known yet: each rank gets as many, or fewer where
 * whole bodies live. */
static void cut_first(shared_run *run, const skein_state *whole) {
    size_t most = 1 << 16, stride = whole->count / most + 1, samples = 0;
    ranks_sample *sample = malloc((most + 1) * sizeof *sample);
    if (!sample) shared_give_up(run, "out of memory");
    for (size_t i = 0; i < whole->count && samples < most; i += stride) {
        const skein_real *p = whole->position[whole->slot_of[i]];
        const shared_body *body = &run->bodies[shared_body_with(run, (uint32_t)i)];
        if (body->of.loose && body->of.enabled && p[0] - p[0] == 0 && p[1] - p[1] == 0 && p[2] - p[2] == 0)
            sample[samples++] = (ranks_sample){{(double)p[0], (double)p[1], (double)p[2]}, (double)stride};
    }
    ranks_cut_space(sample, samples, run->count, run->burden, run->cuts);
    free(sample);
}

/* The leader's birds and bodies go where they belong. */
static void spread(shared_run *run, const skein_state *whole) {
    double begun = shared_seconds(), exchange = run->tale.exchange, sent = run->tale.bytes;
    tell_bodies(run);
    run->tale.work = 0;
    for (int r = 0; r < run->count; r++) run->out[r].size = 0;
    if (whole) cut_first(run, whole);
    size_t bytes = (size_t)run->count * sizeof *run->cuts;
    ranks_cut *all = malloc(bytes * (size_t)run->count);
    if (!all) shared_give_up(run, "out of memory");
    run->ranks->gather(run->cuts, bytes, all);
    memcpy(run->cuts, all, bytes);
    free(all);
    for (size_t i = 0; whole && i < whole->count; i++) {
        const skein_real *p = whole->position[whole->slot_of[i]];
        int owner = owner_of(run, (uint32_t)i, p);
        if (owner == run->count) continue;
        shared_bird *bird = shared_grow(run, &run->out[owner], sizeof *bird);
        bird->number = (uint32_t)i;
        memcpy(bird->position, p, sizeof bird->position);
        memcpy(bird->velocity, whole->velocity[whole->slot_of[i]], sizeof bird->velocity);
    }
    shared_trade(run);
    const shared_bytes *mine = whole ? &run->out[0] : &run->in;
    const shared_bird *bird = (const shared_bird *)(const void *)mine->data;
    size_t count = mine->size / sizeof(shared_bird), *birds = calloc(run->body_count + 1, sizeof *birds);
    if (!birds) shared_give_up(run, "out of memory");
    for (size_t k = 0; k < count; k++) birds[shared_body_with(run, bird[k].number)]++;
    shared_make_room(run, birds);
    shared_add(run, bird, count);
    free(birds);
    // that is the state before the first step, too
    shared_bytes *taken = whole ? &run->out[0] : &run->in;
    free(run->before.data);
    run->before = *taken;
    *taken = (shared_bytes){NULL, 0, 0};
    run->kept = true;
    for (int r = 0; whole && r < run->count; r++) { // it was all of the run
        free(run->out[r].data);
        run->out[r] = (shared_bytes){NULL, 0, 0};
    }
    run->cut_count += shared_has_loose(run);
    run->since_cut = 0;
    run->guessed = true;
    run->tale.exchange = exchange, run->tale.bytes = sent; // it is no part of a step
    run->start += shared_seconds() - begun;
}

/* The state before a step in which some rank's room may turn out to be too small is kept, so that it can be taken again. */
static void keep(shared_run *run, bool anew) {
    run->keeps = anew;
    for (int r = 0; r < run->count; r++) run->keeps |= run->tales[r].unsure != 0;
    if (run->keeps && !run->kept) shared_copy_own(run, &run->before);
    run->kept = false;
}

/* Whether on any rank there came more than there is room for; then each has room, and the state before. */
static bool takes_back(shared_run *run) {
    if (!run->keeps && !run->tale.overflow) return false;
    if (!run->keeps) shared_give_up(run, "far more birds came within reach in one step than in those before");
    int all[run->count], any = 0;
    double begun = shared_seconds();
    run->ranks->gather(&run->tale.overflow, sizeof(int), all);
    run->tale.exchange += shared_seconds() - begun;
    run->tale.work -= shared_seconds() - begun;
    for (int r = 0; r < run->count; r++) any |= all[r];
    if (!any) return false;
    run->tale.overflow = 0;
    size_t *birds = calloc(run->body_count + 1, sizeof *birds);
    if (!birds) shared_give_up(run, "out of memory");
    for (size_t b = 0; b < run->body_count; b++) {
        shared_body *body = &run->bodies[b];
        birds[b] = body->room + (body->full ? body->room / 2 : 0);
        body->full = false;
    }
    shared_forget_birds(run);
    shared_make_room(run, birds);
    shared_forget_birds(run);
    free(birds);
    shared_add(run, (const shared_bird *)(const void *)run->before.data, run->before.size / sizeof(shared_bird));
    return true;
}

static void step(shared_run *run, double time, double dt) {
    double begun = shared_seconds(), exchange = run->tale.exchange;
    bool due = run->since_cut == EVERY && shared_has_loose(run) && (run->guessed || imbalance_of(run) > most_imbalance);
    if (run->since_cut == EVERY && !due) run->since_cut = 0, run->tale.work = 0;
    if (due) shared_balance(run), run->guessed = false;
    if (due || (run->steps && run->steps % CROSS == 0)) shared_migrate(run);
    keep(run, due || !run->steps);
    for (size_t b = 0; b < run->body_count; b++) run->bodies[b].most = run->bodies[b].own;
    double work = shared_seconds();
    do {
        if (run->unclean) shared_clear_room(run);
        if (skein_world_time(run->world) != time && skein_world_time_set(run->world, time))
            shared_give_up(run, skein_world_error(run->world)->message);
        if (skein_world_step(run->world, dt)) shared_give_up(run, skein_world_error(run->world)->message);
    } while (takes_back(run));
    run->tale.work += shared_seconds() - work; // exchanges have taken theirs off
    run->tale.all_work += shared_seconds() - begun - (run->tale.exchange - exchange);
    run->steps++;
    run->since_cut++;
}

/* Everybody's birds come to the leader, with where they were before the last step. */
typedef struct shared_told {
    shared_bird bird;
    skein_real previous[3];
} shared_told;

static void tell_body(shared_run *run, const shared_body *body) {
    double *before = malloc((body->own ? body->own : 1) * 3 * sizeof *before);
    if (!before) shared_give_up(run, "out of memory");
    if (skein_positions_blend(run->world, 0, body->first, body->own, before))
        shared_give_up(run, skein_world_error(run->world)->message);
    const skein_state state = shared_state(run);
    for (size_t k = 0; k < body->own; k++) {
        size_t i = body->first + k, slot = state.slot_of[i];
        shared_told *told = shared_grow(run, &run->out[0], sizeof *told);
        told->bird.number = run->number[i];
        memcpy(told->bird.position, state.position[slot], sizeof told->bird.position);
        memcpy(told->bird.velocity, state.velocity[slot], sizeof told->bird.velocity);
        for (int c = 0; c < 3; c++) told->previous[c] = (skein_real)before[3 * k + (size_t)c];
    }
    free(before);
}

static void read_all(shared_run *run, const skein_state *whole, skein_real (*previous)[4]) {
    for (int r = 0; r < run->count; r++) run->out[r].size = 0;
    for (size_t b = 0; b < run->body_count; b++) tell_body(run, &run->bodies[b]);
    double bytes = run->tale.bytes, exchange = run->tale.exchange;
    shared_trade(run);
    run->tale.bytes = bytes, run->tale.exchange = exchange; // it is no part of a step
    const shared_bytes *from[] = {&run->out[0], &run->in};
    for (int f = 0; f < 2 && whole; f++)
        for (size_t k = 0; k < from[f]->size / sizeof(shared_told); k++) {
            const shared_told *told = (const shared_told *)(const void *)from[f]->data + k;
            size_t slot = whole->slot_of[told->bird.number];
            memcpy(whole->position[slot], told->bird.position, sizeof told->bird.position);
            memcpy(whole->velocity[slot], told->bird.velocity, sizeof told->bird.velocity);
            memcpy(previous[slot], told->previous, sizeof told->previous);
        }
}

/* ---- the leader ---- */

static skein_status lead_step(void *user, double time, double dt, const skein_state *state, skein_error *error) {
    shared_run *run = user;
    (void)error;
    call(run, (shared_call){.what = state ? SPREAD_AND_STEP : STEP, .time = time, .dt = dt});
    if (state) spread(run, state), run->steps = 0;
    step(run, time, dt);
    return SKEIN_OK;
}

static skein_status lead_read(void *user, const skein_state *state, skein_real (*previous)[4], skein_error *error) {
    shared_run *run = user;
    (void)error;
    call(run, (shared_call){.what = READ});
    read_all(run, state, previous);
    return SKEIN_OK;
}

/* Which bodies there are; whole ones are dealt to ranks, those that stay together at once, the costliest first. */
static void deal(shared_run *run, skein_world *whole, double dt, size_t count) {
    skein_share_body *of = calloc(count + 1, sizeof *of);
    double *load = calloc((size_t)run->count, sizeof *load), *work = calloc(count + 1, sizeof *work);
    if (!of || !load || !work) shared_give_up(run, "out of memory");
    if (skein_world_share_bodies(whole, dt, of, count, &count)) shared_give_up(run, skein_world_error(whole)->message);
    set_bodies(run, count);
    for (size_t b = 0; b < count; b++) {
        run->bodies[b] = (shared_body){.of = of[b], .rank = -1};
        if (!of[b].loose && of[b].enabled) work[of[b].together] += of[b].work;
    }
    for (;;) {
        size_t next = 0;
        int least = 0;
        for (size_t b = 1; b < count; b++)
            if (work[b] > work[next]) next = b;
        if (!count || !(work[next] > 0)) break;
        for (int r = 1; r < run->count; r++)
            if (load[r] < load[least]) least = r;
        load[least] += work[next];
        work[next] = 0;
        for (size_t b = 0; b < count; b++)
            if (!of[b].loose && of[b].together == next) run->bodies[b].rank = least;
    }
    free(of), free(load), free(work);
}

skein_status shared_lead(shared_run *run, skein_world *whole, double dt, skein_error *error) {
    const skein_runner runner = {run->name_text, run, lead_step, lead_read, NULL};
    size_t count;
    skein_status status = skein_world_share_bodies(whole, dt, NULL, 0, &count);
    if (!status && count > SHARED_MOST_BODIES) shared_give_up(run, "a shared run has at most 65,535 bodies");
    if (!status) deal(run, whole, dt, count);
    if (!status) status = skein_world_runner_set(whole, &runner);
    if (status) *error = *skein_world_error(whole);
    return status;
}

static void record(shared_run *run, const char *folder, double time) {
    if (!run->parts.data) shared_record_open(run, folder);
    shared_record_frame(run, time);
}

void shared_record(shared_run *run, const char *folder, double time) {
    call(run, (shared_call){.what = RECORD, .time = time});
    record(run, folder, time);
}

void shared_measure(shared_run *run, shared_figures *figures) {
    call(run, (shared_call){.what = TELL});
    double exchange = 0, all = 0, bytes = 0;
    *figures = (shared_figures){
        .ranks = run->count, .cuts = run->cut_count, .imbalance = imbalance_of(run), .start_seconds = run->start};
    for (size_t b = 0; b < run->body_count; b++)
        figures->whole_bodies += !run->bodies[b].of.loose && run->bodies[b].of.enabled;
    for (int r = 0; r < run->count; r++) {
        const shared_tale *t = &run->tales[r];
        exchange += t->exchange, all += t->exchange + t->all_work, bytes += t->bytes;
        figures->moved += t->moved;
        if (t->own > figures->most_birds) figures->most_birds = t->own;
        if (t->seen > figures->most_seen) figures->most_seen = t->seen;
        if (r && t->memory > figures->most_memory) figures->most_memory = t->memory;
    }
    figures->exchange_share = all > 0 ? exchange / all : 0;
    figures->bytes_per_step = run->steps ? bytes / (double)run->steps : 0;
}

void shared_dismiss(shared_run *run) {
    if (!run->dismissed) call(run, (shared_call){.what = DISMISS});
    run->dismissed = true;
}

/* ---- the others ---- */

void shared_serve(shared_run *run) {
    for (;;) {
        shared_call c = call(run, (shared_call){.what = STEP});
        if (c.what == DISMISS) return;
        if (c.what == READ) read_all(run, NULL, NULL);
        if (c.what == RECORD) record(run, NULL, c.time);
        if (c.what == SPREAD_AND_STEP) spread(run, NULL), run->steps = 0;
        if (c.what == STEP || c.what == SPREAD_AND_STEP) step(run, c.time, c.dt);
    }
}
