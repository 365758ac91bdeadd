/* Others' birds within reach: each rank sends those of its own that lie in the cells around another's. Whole cells, since
 * the order in which neighbours are summed depends on who else stands in a cell. */
#include <math.h>
#include <string.h>

#include "ranks/shared_inside.h"

static inline bool is_somewhere(const skein_real p[4]) {
    const skein_real most = SKEIN_SHARE_FARTHEST;
    return (p[0] <= most) & (p[0] >= -most) & (p[1] <= most) & (p[1] >= -most) & (p[2] <= most) & (p[2] >= -most);
}

static inline void widen(skein_real low[3], skein_real high[3], const skein_real p[3]) {
    for (int k = 0; k < 3; k++) {
        low[k] = p[k] < low[k] ? p[k] : low[k];
        high[k] = p[k] > high[k] ? p[k] : high[k];
    }
}

/* Whether a body is among [first, end) of this rank's particles. */
static bool is_in(const shared_body *body, size_t first, size_t end) {
    return body->room && body->of.enabled && body->first >= first && body->first + body->room <= end;
}

static bool looks(const shared_run *run, const skein_share_look *look, size_t b) {
    return is_in(&run->bodies[b], look->first, look->end);
}

static bool is_seen(const shared_run *run, const skein_share_look *look, size_t b) {
    return is_in(&run->bodies[b], look->seen_first, look->seen_end);
}

static shared_box *box_of(const shared_run *run, int rank, size_t b) {
    return &run->boxes[(size_t)rank * run->body_count + b];
}

/* The box of a body's own from a slot on, up to the next one of another body, which it returns. */
static size_t find_own_of(const shared_body *body, const skein_state *state, size_t slot, shared_box *box) {
    const skein_real most = SKEIN_SHARE_FARTHEST;
    skein_real low[3] = {most, most, most}, high[3] = {-most, -most, -most};
    size_t begun = slot;
    for (; slot < state->slot_count; slot++) {
        const skein_real *p = state->position[slot];
        if (state->particle_of[slot] - body->first >= body->own) break;
        if (is_somewhere(p)) widen(low, high, p);
    }
    if (begun == slot || low[0] > high[0]) return slot;
    if (!box->any) memcpy(box->low, low, sizeof low), memcpy(box->high, high, sizeof high);
    box->any = 1;
    widen(box->low, box->high, low);
    widen(box->low, box->high, high);
    return slot;
}

/* The boxes of its own, of each body. */
static void find_own(shared_run *run, const skein_share_look *look, const skein_state *state, shared_box *own) {
    memset(own, 0, run->body_count * sizeof *own);
    for (size_t slot = 0; slot < state->slot_count;) {
        uint32_t i = state->particle_of[slot];
        if (i >= run->particles || !shared_is_own(run, i)) slot++;
        else slot = find_own_of(&run->bodies[run->body_of[i]], state, slot, &own[run->body_of[i]]);
    }
    for (size_t b = 0; b < run->body_count; b++)
        if (!looks(run, look, b) && !is_seen(run, look, b)) own[b].any = 0;
}

/* What was spent on others since, and not on birds. */
static void count_exchange(shared_run *run, double begun) {
    run->tale.exchange += shared_seconds() - begun;
    run->tale.work -= shared_seconds() - begun;
}

bool shared_measure_all(void *user, const skein_share_look *look, const skein_state *state, skein_border *border) {
    shared_run *run = user;
    *border = (skein_border){.alone = true};
    for (size_t b = 0; b < run->body_count; b++) {
        if (is_seen(run, look, b)) border->everybody += run->bodies[b].of.count;
        // where no loose one takes part the library has them all in one part
        border->alone &= !run->bodies[b].of.loose || (!is_seen(run, look, b) && !looks(run, look, b));
    }
    if (border->alone) return true;
    shared_box *own = box_of(run, run->count, 0);
    find_own(run, look, state, own);
    double begun = shared_seconds();
    run->ranks->gather(own, run->body_count * sizeof *own, run->boxes);
    bool any = false;
    for (int r = 0; r < run->count; r++)
        for (size_t b = 0; b < run->body_count; b++) {
            const shared_box *box = box_of(run, r, b);
            if (!box->any || !is_seen(run, look, b)) continue;
            if (!any) memcpy(border->low, box->low, sizeof box->low), memcpy(border->high, box->high, sizeof box->high);
            any = true;
            widen(border->low, border->high, box->low);
            widen(border->low, border->high, box->high);
        }
    count_exchange(run, begun);
    return true;
}

/* ---- cells ---- */

static int32_t cell_along(const skein_cells *cells, int axis, skein_real at) {
    skein_real place = (at - cells->origin[axis]) * cells->per[axis];
    int32_t count = cells->count[axis];
    return place > 0 ? place < (skein_real)count ? (int32_t)place : count - 1 : 0;
}

static shared_cells cells_of(const skein_cells *cells, const shared_box *box, bool around) {
    shared_cells out;
    for (int k = 0; k < 3; k++) {
        out.low[k] = cell_along(cells, k, box->low[k]) - (around ? cells->around[k] : 0);
        out.high[k] = cell_along(cells, k, box->high[k]) + (around ? cells->around[k] : 0);
    }
    return out;
}

static bool meet(const shared_cells *a, const shared_cells *b) {
    for (int k = 0; k < 3; k++)
        if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) return false;
    return true;
}

/* Whether rank b may look at any of rank a's: both sides find the same. */
static bool are_near(const shared_run *run, const skein_share_look *look, const skein_cells *cells, int a, int b) {
    for (size_t seen = 0; seen < run->body_count && a != b; seen++) {
        const shared_box *one = box_of(run, a, seen);
        if (!one->any || !is_seen(run, look, seen)) continue;
        shared_cells near = cells_of(cells, one, false);
        for (size_t body = 0; body < run->body_count; body++) {
            const shared_box *other = box_of(run, b, body);
            if (!other->any || !looks(run, look, body)) continue;
            shared_cells far = cells_of(cells, other, true);
            if (meet(&near, &far)) return true;
        }
    }
    return false;
}

/* Which cells rank r looks into; returns how many boxes of them there are. */
static size_t wanted_by(const shared_run *run, const skein_share_look *look, const skein_cells *cells, int r,
                        shared_cells *wanted) {
    size_t count = 0;
    for (size_t b = 0; b < run->body_count; b++)
        if (box_of(run, r, b)->any && looks(run, look, b)) wanted[count++] = cells_of(cells, box_of(run, r, b), true);
    return count;
}

static bool is_wanted(const skein_cells *cells, const shared_cells *wanted, size_t count, const skein_real p[4]) {
    int32_t cell[3];
    for (int k = 0; k < 3; k++) cell[k] = cell_along(cells, k, p[k]);
    for (size_t w = 0; w < count; w++) {
        bool in = true;
        for (int k = 0; k < 3 && in; k++) in = cell[k] >= wanted[w].low[k] && cell[k] <= wanted[w].high[k];
        if (in) return true;
    }
    return false;
}

/* A box around all cells that are wanted, and a little more: of what is outside no cell has to be found. */
static void around_wanted(const skein_cells *cells, const shared_cells *wanted, size_t count, skein_real from[3],
                          skein_real to[3]) {
    const double few = sizeof(skein_real) == 8 ? 1e-14 : 1e-6; // several roundings
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY, origin = (double)cells->origin[k];
        for (size_t w = 0; w < count; w++) low = fmin(low, wanted[w].low[k]), high = fmax(high, wanted[w].high[k]);
        // a place is in a cell to within the rounding of both; the first cell has all below it, and the last one all above
        double least = origin + (low - 1 - few * fabs(low)) / (double)cells->per[k],
               most = origin + (high + 2 + few * fabs(high)) / (double)cells->per[k];
        from[k] = low > 0 ? (skein_real)(least - few * fabs(least)) : -(skein_real)INFINITY;
        to[k] = high < cells->count[k] - 1 ? (skein_real)(most + few * fabs(most)) : (skein_real)INFINITY;
    }
}

/* Lists those of its own that lie around rank r's. */
static void list_for(shared_run *run, const skein_share_look *look, const skein_cells *cells, const skein_state *state,
                     int r) {
    size_t count = wanted_by(run, look, cells, r, run->wanted);
    skein_real from[3], to[3];
    around_wanted(cells, run->wanted, count, from, to);
    run->out[r].size = 0;
    for (size_t slot = 0; slot < state->slot_count; slot++) {
        const skein_real *p = state->position[slot], *v = state->velocity[slot];
        bool near = (p[0] >= from[0]) & (p[0] <= to[0]) & (p[1] >= from[1]) & (p[1] <= to[1]) & (p[2] >= from[2]) &
                    (p[2] <= to[2]);
        if (!near) continue;
        uint32_t i = state->particle_of[slot];
        if (i < look->seen_first || i >= look->seen_end || !shared_is_own(run, i) || !is_somewhere(p)) continue;
        if (!is_wanted(cells, run->wanted, count, p)) continue;
        shared_seen *seen = shared_grow(run, &run->out[r], sizeof *seen);
        *seen = (shared_seen){run->number[i], {p[0], p[1], p[2]}, {v[0], v[1], v[2]}};
    }
}

/* Where what is seen of a body lies: among that one's birds, and of a whole one without a shadow among those of the first
 * that can. */
static shared_body *place_for(shared_run *run, const skein_share_look *look, uint32_t number) {
    size_t b = shared_body_with(run, number);
    if (run->bodies[b].of.loose || shared_is_shadow(&run->bodies[b])) return &run->bodies[b];
    for (b = 0; b < run->body_count; b++)
        if (run->bodies[b].of.loose && is_seen(run, look, b)) return &run->bodies[b];
    shared_give_up(run, "there is no place for what lies at its border");
}

/* Puts what has come behind its own. */
static void take_in(shared_run *run, const skein_share_look *look, const skein_state *state) {
    size_t count = run->in.size / sizeof(shared_seen);
    const shared_seen *come = (const shared_seen *)(const void *)run->in.data;
    for (size_t k = 0; k < count; k++) {
        shared_body *body = place_for(run, look, come[k].number);
        if (body->of.loose && body->seen == body->room) {
            run->tale.overflow = 1, body->full = true; // the step is taken again, with more
            continue;
        }
        size_t i = body->first + (body->of.loose ? body->seen++ : come[k].number - body->of.first),
               slot = state->slot_of[i];
        run->number[i] = come[k].number;
        for (int c = 0; c < 3; c++)
            state->position[slot][c] = come[k].position[c], state->velocity[slot][c] = come[k].velocity[c];
        state->position[slot][3] = state->velocity[slot][3] = 0;
    }
}

/* Those that a loose body has room for, and that are nobody; all of a shadow. */
static void clear(const shared_body *body, const skein_state *state) {
    for (size_t i = body->first + (body->of.loose ? body->seen : 0); i < body->first + body->room; i++) {
        size_t slot = state->slot_of[i];
        for (int c = 0; c < 4; c++) {
            state->position[slot][c] = c < 3 ? 2 * SKEIN_SHARE_FARTHEST : 0;
            state->velocity[slot][c] = 0;
        }
    }
}

void shared_clear_room(shared_run *run) {
    const skein_state state = shared_state(run);
    for (size_t b = 0; b < run->body_count; b++) {
        shared_body *body = &run->bodies[b];
        if (body->of.loose) body->seen = body->own;
        if (body->of.loose || shared_is_shadow(body)) clear(body, &state);
    }
    run->unclean = false;
}

bool shared_send(void *user, const skein_share_look *look, const skein_cells *cells, const skein_state *state) {
    shared_run *run = user;
    double begun = shared_seconds();
    for (int r = 0; r < run->count; r++) {
        if (!are_near(run, look, cells, run->rank, r)) continue;
        list_for(run, look, cells, state, r);
        run->ranks->send_begin(r, run->out[r].data, run->out[r].size);
        run->tale.bytes += (double)run->out[r].size;
    }
    count_exchange(run, begun);
    return true;
}

bool shared_receive(void *user, const skein_share_look *look, const skein_cells *cells, const skein_state *state) {
    shared_run *run = user;
    double begun = shared_seconds();
    for (size_t b = 0; b < run->body_count; b++) {
        if (!is_seen(run, look, b)) continue; // the world may keep what is not asked about in blocks
        if (run->bodies[b].of.loose) run->bodies[b].seen = run->bodies[b].own;
        if (shared_is_shadow(&run->bodies[b])) clear(&run->bodies[b], state);
    }
    for (int r = 0; r < run->count; r++) {
        if (!are_near(run, look, cells, r, run->rank)) continue;
        run->in.size = 0;
        size_t size = run->ranks->size_from(r);
        run->ranks->receive(r, shared_grow(run, &run->in, size), size);
        take_in(run, look, state);
    }
    run->ranks->send_end();
    for (size_t b = 0; b < run->body_count; b++)
        if (run->bodies[b].of.loose && is_seen(run, look, b)) {
            if (run->bodies[b].seen > run->bodies[b].most) run->bodies[b].most = run->bodies[b].seen;
            clear(&run->bodies[b], state);
        }
    if (shared_others(run) > run->tale.seen) run->tale.seen = shared_others(run);
    count_exchange(run, begun);
    return true;
}
