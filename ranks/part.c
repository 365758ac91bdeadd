/* A rank's own birds and bodies: the world that steps them, those that come and go, and where space is cut. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ranks/shared_inside.h"

enum { SAMPLES = 1 << 15 }; /* of all ranks */

skein_state shared_state(shared_run *run) {
    skein_state state = {0};
    if (skein_world_state(run->world, &state)) shared_give_up(run, skein_world_error(run->world)->message);
    return state;
}

size_t shared_body_with(const shared_run *run, uint32_t number) {
    size_t low = 0, high = run->body_count;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (number >= run->bodies[middle].of.first) low = middle;
        else high = middle;
    }
    return low;
}

size_t shared_own(const shared_run *run) {
    size_t count = 0;
    for (size_t b = 0; b < run->body_count; b++) count += run->bodies[b].of.loose ? run->bodies[b].own : 0;
    return count;
}

size_t shared_others(const shared_run *run) {
    size_t count = 0;
    for (size_t b = 0; b < run->body_count; b++)
        count += run->bodies[b].of.loose ? run->bodies[b].seen - run->bodies[b].own : 0;
    return count;
}

bool shared_has_loose(const shared_run *run) {
    for (size_t b = 0; b < run->body_count; b++)
        if (run->bodies[b].of.loose && run->bodies[b].of.enabled) return true;
    return false;
}

void shared_forget_birds(shared_run *run) {
    run->unclean = true;
    for (size_t b = 0; b < run->body_count; b++)
        if (run->bodies[b].of.loose) run->bodies[b].own = run->bodies[b].seen = 0;
}

void shared_copy_own(shared_run *run, shared_bytes *to) {
    to->size = 0;
    if (!run->world) return;
    const skein_state state = shared_state(run);
    for (size_t b = 0; b < run->body_count; b++) {
        const shared_body *body = &run->bodies[b];
        shared_bird *birds = shared_grow(run, to, body->own * sizeof *birds);
        for (size_t k = 0; k < body->own; k++) {
            size_t i = body->first + k;
            birds[k].number = run->number[i];
            memcpy(birds[k].position, state.position[state.slot_of[i]], sizeof birds[k].position);
            memcpy(birds[k].velocity, state.velocity[state.slot_of[i]], sizeof birds[k].velocity);
        }
    }
}

void shared_add(shared_run *run, const shared_bird *birds, size_t count) {
    if (!count) return;
    run->unclean = true;
    const skein_state state = shared_state(run);
    for (size_t k = 0; k < count; k++) {
        shared_body *body = &run->bodies[shared_body_with(run, birds[k].number)];
        size_t i = body->first + (body->of.loose ? body->own++ : birds[k].number - body->of.first);
        run->number[i] = birds[k].number;
        memcpy(state.position[state.slot_of[i]], birds[k].position, sizeof birds[k].position);
        memcpy(state.velocity[state.slot_of[i]], birds[k].velocity, sizeof birds[k].velocity);
        if (body->of.loose) body->seen = body->own; // others' are asked for anew
    }
}

/* Where bodies are in the new world, and whose its particles are. */
static void lay_out(shared_run *run) {
    size_t first = 0;
    for (size_t b = 0; b < run->body_count; b++) {
        shared_body *body = &run->bodies[b];
        body->first = first;
        first += body->room;
    }
    run->particles = first;
    free(run->number);
    free(run->body_of);
    run->number = calloc(first + 1, sizeof *run->number);
    run->body_of = calloc(first + 1, sizeof *run->body_of);
    if (!run->number || !run->body_of) shared_give_up(run, "there is no memory for its part of the run");
    for (size_t b = 0; b < run->body_count; b++)
        for (size_t k = 0; k < run->bodies[b].room; k++) {
            run->body_of[run->bodies[b].first + k] = (uint16_t)b;
            run->number[run->bodies[b].first + k] = (uint32_t)(run->bodies[b].of.first + k); // a whole one's stay so
        }
}

static void make_world(shared_run *run) {
    shared_wanted *wanted = calloc(run->body_count + 1, sizeof *wanted);
    if (!wanted) shared_give_up(run, "out of memory");
    for (size_t b = 0; b < run->body_count; b++) {
        const shared_body *body = &run->bodies[b];
        wanted[b] = (shared_wanted){body->of.loose, body->room, body->own != 0, shared_is_shadow(body)};
    }
    run->world = run->source.make(run->source.user, wanted, run->body_count);
    free(wanted);
    if (!run->world) shared_give_up(run, "there is no memory for its part of the run");
    if (skein_particle_count(run->world) != run->particles)
        shared_give_up(run, "its scene is not that of the first rank: can all read the same files?");
}

void shared_make_room(shared_run *run, const size_t *birds) {
    bool fits = run->world != NULL;
    for (size_t b = 0; b < run->body_count && fits; b++)
        fits = !run->bodies[b].of.loose || birds[b] <= run->bodies[b].room;
    if (fits) return;
    shared_bytes kept = {NULL, 0, 0};
    double time = 0;
    if (run->world) {
        shared_copy_own(run, &kept);
        time = skein_world_time(run->world);
        run->source.unmake(run->source.user, run->world);
        run->world = NULL;
    }
    for (size_t b = 0; b < run->body_count; b++) {
        shared_body *body = &run->bodies[b];
        if (body->of.loose && (!body->room || birds[b] > body->room)) body->room = birds[b] + birds[b] / 4 + 1024;
        if (!body->of.loose) body->room = body->of.count;
    }
    shared_forget_birds(run);
    lay_out(run);
    make_world(run);
    skein_part part = {run, run->number, shared_measure_all, shared_send, shared_receive};
    if (skein_world_part_set(run->world, &part) || skein_world_time_set(run->world, time))
        shared_give_up(run, skein_world_error(run->world)->message);
    shared_add(run, (const shared_bird *)(const void *)kept.data, kept.size / sizeof(shared_bird));
    free(kept.data);
}

/* ---- birds that cross ---- */

static const uint32_t nobody = UINT32_MAX;

static void trim(const shared_run *run, shared_body *body) {
    while (body->own && run->number[body->first + body->own - 1] == nobody) body->own--;
    body->seen = body->own;
}

/* Fills the places of those that have gone with the last ones of their body. */
static void close_up(shared_run *run, const skein_state *state, const uint32_t *gone, size_t count) {
    run->unclean |= count > 0;
    for (size_t k = 0; k < count; k++) {
        shared_body *body = &run->bodies[run->body_of[gone[k]]];
        trim(run, body);
        if (gone[k] - body->first >= body->own) continue;
        size_t last = body->first + --body->own, from = state->slot_of[last], to = state->slot_of[gone[k]];
        run->number[gone[k]] = run->number[last];
        memcpy(state->position[to], state->position[from], sizeof state->position[to]);
        memcpy(state->velocity[to], state->velocity[from], sizeof state->velocity[to]);
    }
    for (size_t b = 0; b < run->body_count; b++)
        if (run->bodies[b].of.loose) trim(run, &run->bodies[b]);
}

/* Makes room for what has come, and takes it. */
static void take_in(shared_run *run) {
    size_t come = run->in.size / sizeof(shared_bird), *birds = calloc(run->body_count + 1, sizeof *birds);
    const shared_bird *bird = (const shared_bird *)(const void *)run->in.data;
    if (!birds) shared_give_up(run, "out of memory");
    for (size_t b = 0; b < run->body_count; b++) birds[b] = run->bodies[b].own;
    for (size_t k = 0; k < come; k++) birds[shared_body_with(run, bird[k].number)]++;
    shared_make_room(run, birds);
    shared_add(run, bird, come);
    free(birds);
}

void shared_migrate(shared_run *run) {
    if (!shared_has_loose(run)) return;
    const skein_state state = shared_state(run);
    shared_bytes gone = {NULL, 0, 0};
    double low[3], high[3];
    ranks_region(run->cuts, run->count, run->rank, low, high);
    for (int r = 0; r < run->count; r++) run->out[r].size = 0;
    for (size_t slot = 0; slot < state.slot_count; slot++) {
        const skein_real *p = state.position[slot];
        bool stays = true;
        for (int k = 0; k < 3; k++) stays &= ((double)p[k] >= low[k]) & ((double)p[k] < high[k]);
        if (stays) continue; // nearly all do
        uint32_t i = state.particle_of[slot];
        if (i >= run->particles || !shared_is_own(run, i) || !run->bodies[run->body_of[i]].of.loose) continue;
        int owner = ranks_owner(run->cuts, run->count, (const double[3]){(double)p[0], (double)p[1], (double)p[2]});
        if (owner == run->rank) continue;
        shared_bird *bird = shared_grow(run, &run->out[owner], sizeof *bird);
        bird->number = run->number[i];
        memcpy(bird->position, p, sizeof bird->position);
        memcpy(bird->velocity, state.velocity[slot], sizeof bird->velocity);
        memcpy(shared_grow(run, &gone, sizeof i), &i, sizeof i);
    }
    size_t count = gone.size / sizeof(uint32_t);
    const uint32_t *list = (const uint32_t *)(const void *)gone.data;
    for (size_t k = 0; k < count; k++) run->number[list[k]] = nobody;
    close_up(run, &state, list, count);
    free(gone.data);
    run->tale.moved += count;
    shared_trade(run);
    take_in(run);
}

/* ---- cutting anew ---- */

/* What a bird and a burden cost, s, as the ranks have told: least squares of work = bird x birds + burden x its unit. */
static double find_burden_cost(const shared_run *run) {
    double nn = 0, nk = 0, kk = 0, nw = 0, kw = 0, most = INFINITY;
    for (int r = 0; r < run->count; r++) {
        double n = (double)run->tales[r].own, k = run->burden[r], w = run->tales[r].work;
        nn += n * n, nk += n * k, kk += k * k, nw += n * w, kw += k * w;
        if (k > 0 && w / k < most) most = w / k;
    }
    double under = nn * kk - nk * nk;
    if (!(kk > 0) || isinf(most)) return 0;
    double cost = under > 1e-9 * nn * kk ? (nn * kw - nk * nw) / under : kk > 0 && nn <= 0 ? kw / kk : 0;
    return cost > 0 ? fmin(cost, 0.95 * most) : 0;
}

void shared_balance(shared_run *run) {
    size_t most = SAMPLES / (size_t)run->count, birds = shared_own(run), stride = birds / most + 1, filled = 0,
           passed = 0;
    ranks_sample *all = malloc((most * (size_t)run->count + most) * sizeof *all),
                 *own = all + most * (size_t)run->count;
    double *burden = calloc((size_t)run->count, sizeof *burden);
    if (!all || !burden) shared_give_up(run, "out of memory");
    const skein_state state = shared_state(run);
    double cost = find_burden_cost(run);
    for (int r = 0; r < run->count; r++) burden[r] = cost * run->burden[r];
    double work = run->tale.work - burden[run->rank];
    work = work > 0 && birds ? work / (double)birds * (double)stride : 0;
    for (size_t b = 0; b < run->body_count; b++)
        for (size_t k = 0; k < run->bodies[b].own && run->bodies[b].of.loose; k++) {
            const skein_real *p = state.position[state.slot_of[run->bodies[b].first + k]];
            if (passed++ % stride || filled == most || !isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) continue;
            own[filled++] = (ranks_sample){{(double)p[0], (double)p[1], (double)p[2]}, work};
        }
    for (; filled < most; filled++) own[filled] = (ranks_sample){{0, 0, 0}, -1}; // nobody
    run->ranks->gather(own, most * sizeof *own, all);
    size_t count = 0;
    for (size_t k = 0; k < most * (size_t)run->count; k++)
        if (all[k].work > 0) all[count++] = all[k];
    if (count) ranks_cut_space(all, count, run->count, burden, run->cuts);
    free(all);
    free(burden);
    run->cut_count++;
    run->since_cut = 0;
    run->tale.work = 0;
}
