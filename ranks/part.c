/* A rank's own birds: the world that steps them, those that come and go, and where space is cut. */
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

void shared_copy_own(shared_run *run, shared_bytes *to) {
    to->size = 0;
    if (!run->own) return;
    shared_bird *birds = shared_grow(run, to, run->own * sizeof *birds);
    const skein_state state = shared_state(run);
    for (size_t i = 0; i < run->own; i++) {
        birds[i].number = run->number[i];
        memcpy(birds[i].position, state.position[state.slot_of[i]], sizeof birds[i].position);
        memcpy(birds[i].velocity, state.velocity[state.slot_of[i]], sizeof birds[i].velocity);
    }
}

void shared_add(shared_run *run, const shared_bird *birds, size_t count) {
    if (!count) return;
    const skein_state state = shared_state(run);
    for (size_t k = 0; k < count; k++) {
        size_t i = run->own++;
        run->number[i] = birds[k].number;
        memcpy(state.position[state.slot_of[i]], birds[k].position, sizeof birds[k].position);
        memcpy(state.velocity[state.slot_of[i]], birds[k].velocity, sizeof birds[k].velocity);
    }
    run->seen = run->own; // others' are asked for anew
}

void shared_make_room(shared_run *run, size_t birds) {
    if (run->world && birds <= run->room) return;
    shared_bytes kept = {NULL, 0, 0};
    if (run->world) shared_copy_own(run, &kept);
    double time = skein_world_time(run->world);
    if (run->world) run->source.unmake(run->source.user, run->world);
    run->room = birds + birds / 4 + 1024;
    run->own = run->seen = 0;
    free(run->number);
    run->number = calloc(run->room, sizeof *run->number);
    run->world = run->source.make(run->source.user, run->room);
    if (!run->world || !run->number) shared_give_up(run, "there is no memory for its part of the run");
    skein_part part = {run, run->number, shared_measure_all, shared_exchange};
    if (skein_world_part_set(run->world, &part) || skein_world_time_set(run->world, time))
        shared_give_up(run, skein_world_error(run->world)->message);
    shared_add(run, (const shared_bird *)(const void *)kept.data, kept.size / sizeof(shared_bird));
    free(kept.data);
}

/* ---- birds that cross ---- */

static const uint32_t nobody = UINT32_MAX;

/* Fills the places of those that have gone with the last ones. */
static void close_up(shared_run *run, const skein_state *state, const uint32_t *gone, size_t count) {
    for (size_t k = 0; k < count; k++) {
        while (run->own && run->number[run->own - 1] == nobody) run->own--;
        if (gone[k] >= run->own) continue;
        size_t last = --run->own, from = state->slot_of[last], to = state->slot_of[gone[k]];
        run->number[gone[k]] = run->number[last];
        memcpy(state->position[to], state->position[from], sizeof state->position[to]);
        memcpy(state->velocity[to], state->velocity[from], sizeof state->velocity[to]);
    }
    while (run->own && run->number[run->own - 1] == nobody) run->own--;
    run->seen = run->own;
}

void shared_migrate(shared_run *run) {
    const skein_state state = shared_state(run);
    shared_bytes gone = {NULL, 0, 0};
    for (int r = 0; r < run->count; r++) run->out[r].size = 0;
    for (size_t slot = 0; slot < state.slot_count; slot++) {
        uint32_t i = state.particle_of[slot];
        if (i >= run->own) continue;
        const skein_real *p = state.position[slot];
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
    size_t come = run->in.size / sizeof(shared_bird);
    shared_make_room(run, run->own + come);
    shared_add(run, (const shared_bird *)(const void *)run->in.data, come);
}

/* ---- cutting anew ---- */

void shared_balance(shared_run *run) {
    size_t most = SAMPLES / (size_t)run->count, stride = run->own / most + 1, filled = 0;
    ranks_sample *all = malloc((most * (size_t)run->count + most) * sizeof *all), *own = all + most * (size_t)run->count;
    if (!all) shared_give_up(run, "out of memory");
    const skein_state state = shared_state(run);
    double work = run->tale.work > 0 && run->own ? run->tale.work / (double)run->own * (double)stride : 0;
    for (size_t i = 0; i < run->own && filled < most; i += stride) {
        const skein_real *p = state.position[state.slot_of[i]];
        if (isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]))
            own[filled++] = (ranks_sample){{(double)p[0], (double)p[1], (double)p[2]}, work};
    }
    for (; filled < most; filled++) own[filled] = (ranks_sample){{0, 0, 0}, -1}; // nobody
    run->ranks->gather(own, most * sizeof *own, all);
    size_t count = 0;
    for (size_t k = 0; k < most * (size_t)run->count; k++)
        if (all[k].work > 0) all[count++] = all[k];
    if (count) ranks_cut_space(all, count, run->count, run->cuts);
    free(all);
    run->cut_count++;
    run->since_cut = 0;
    run->tale.work = 0;
}
