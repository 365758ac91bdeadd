/* Others' birds within reach: each rank sends those of its own that lie in the cells around another's. Whole cells, since
 * the order in which neighbours are summed depends on who else stands in a cell. */
#include <string.h>

#include "ranks/shared_inside.h"

static bool is_somewhere(const skein_real p[4]) {
    for (int k = 0; k < 3; k++)
        if (!(p[k] <= SKEIN_SHARE_FARTHEST && p[k] >= -SKEIN_SHARE_FARTHEST)) return false;
    return true;
}

static void widen(skein_real low[3], skein_real high[3], const skein_real p[3]) {
    for (int k = 0; k < 3; k++) {
        if (p[k] < low[k]) low[k] = p[k];
        if (p[k] > high[k]) high[k] = p[k];
    }
}

bool shared_measure_all(void *user, const skein_state *state, skein_border *border) {
    shared_run *run = user;
    shared_box own = {.any = 0};
    for (size_t slot = 0; slot < state->slot_count; slot++) {
        const skein_real *p = state->position[slot];
        if (state->particle_of[slot] >= run->own || !is_somewhere(p)) continue;
        if (!own.any) memcpy(own.low, p, sizeof own.low), memcpy(own.high, p, sizeof own.high);
        own.any = 1;
        widen(own.low, own.high, p);
    }
    double begun = shared_seconds();
    run->ranks->gather(&own, sizeof own, run->boxes);
    bool any = false;
    *border = (skein_border){.everybody = run->total};
    for (int r = 0; r < run->count; r++) {
        const shared_box *box = &run->boxes[r];
        if (!box->any) continue;
        if (!any) memcpy(border->low, box->low, sizeof box->low), memcpy(border->high, box->high, sizeof box->high);
        any = true;
        widen(border->low, border->high, box->low);
        widen(border->low, border->high, box->high);
    }
    run->tale.exchange += shared_seconds() - begun;
    run->tale.work -= shared_seconds() - begun;
    return true;
}

/* ---- cells ---- */

typedef struct cell_box {
    int32_t low[3], high[3];
} cell_box;

static int32_t cell_along(const skein_cells *cells, int axis, skein_real at) {
    skein_real place = (at - cells->origin[axis]) * cells->per[axis];
    int32_t count = cells->count[axis];
    return place > 0 ? place < (skein_real)count ? (int32_t)place : count - 1 : 0;
}

static cell_box cells_of(const skein_cells *cells, const shared_box *box, bool around) {
    cell_box out;
    for (int k = 0; k < 3; k++) {
        out.low[k] = cell_along(cells, k, box->low[k]) - (around ? cells->around[k] : 0);
        out.high[k] = cell_along(cells, k, box->high[k]) + (around ? cells->around[k] : 0);
    }
    return out;
}

static bool meet(const cell_box *a, const cell_box *b) {
    for (int k = 0; k < 3; k++)
        if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) return false;
    return true;
}

/* Whether two ranks' birds may look at each other: both sides find the same. */
static bool are_near(const shared_run *run, const skein_cells *cells, int a, int b) {
    const shared_box *one = &run->boxes[a], *other = &run->boxes[b];
    if (a == b || !one->any || !other->any) return false;
    cell_box near = cells_of(cells, one, false), far = cells_of(cells, other, true);
    return meet(&near, &far);
}

/* Lists those of its own that lie around rank r's. */
static void list_for(shared_run *run, const skein_cells *cells, const skein_state *state, int r) {
    cell_box wanted = cells_of(cells, &run->boxes[r], true);
    run->out[r].size = 0;
    for (size_t slot = 0; slot < state->slot_count; slot++) {
        const skein_real *p = state->position[slot], *v = state->velocity[slot];
        uint32_t i = state->particle_of[slot];
        if (i >= run->own || !is_somewhere(p)) continue;
        bool in = true;
        for (int k = 0; k < 3 && in; k++) {
            int32_t cell = cell_along(cells, k, p[k]);
            in = cell >= wanted.low[k] && cell <= wanted.high[k];
        }
        if (!in) continue;
        shared_seen *seen = shared_grow(run, &run->out[r], sizeof *seen);
        *seen = (shared_seen){run->number[i], {p[0], p[1], p[2]}, {v[0], v[1], v[2]}};
    }
}

/* Puts what has come behind its own. */
static void take_in(shared_run *run, const skein_state *state) {
    size_t count = run->in.size / sizeof(shared_seen);
    const shared_seen *come = (const shared_seen *)(const void *)run->in.data;
    for (size_t k = 0; k < count; k++) {
        if (run->seen == run->room) {
            run->tale.overflow = 1; // the step is taken again, with more
            break;
        }
        size_t i = run->seen++, slot = state->slot_of[i];
        run->number[i] = come[k].number;
        for (int c = 0; c < 3; c++)
            state->position[slot][c] = come[k].position[c], state->velocity[slot][c] = come[k].velocity[c];
        state->position[slot][3] = state->velocity[slot][3] = 0;
    }
}

bool shared_exchange(void *user, const skein_cells *cells, const skein_state *state) {
    shared_run *run = user;
    double begun = shared_seconds();
    run->seen = run->own;
    for (int r = 0; r < run->count; r++) {
        if (!are_near(run, cells, run->rank, r)) continue;
        list_for(run, cells, state, r);
        run->ranks->send_begin(r, run->out[r].data, run->out[r].size);
        run->tale.bytes += (double)run->out[r].size;
    }
    for (int r = 0; r < run->count; r++) {
        if (!are_near(run, cells, r, run->rank)) continue;
        run->in.size = 0;
        size_t size = run->ranks->size_from(r);
        run->ranks->receive(r, shared_grow(run, &run->in, size), size);
        take_in(run, state);
    }
    run->ranks->send_end();
    for (size_t i = run->seen; i < run->room; i++) {
        size_t slot = state->slot_of[i];
        for (int c = 0; c < 4; c++) {
            state->position[slot][c] = c < 3 ? 2 * SKEIN_SHARE_FARTHEST : 0;
            state->velocity[slot][c] = 0;
        }
    }
    run->tale.exchange += shared_seconds() - begun;
    run->tale.work -= shared_seconds() - begun;
    return true;
}
