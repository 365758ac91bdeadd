/* Sorts of a world that has a part of a run: the border, cells of the whole run's box, and the whole run's order in them. */
#include "plan/share_part.h"

#include <string.h>

#include "plan/sort.h"

/* The lines of cells that this part looks into, from cell low[0] to high[0] each. */
typedef struct sk_window {
    int32_t low[3], high[3];
    uint32_t *line; /* its first cell's number, by these */
    size_t count, capacity;
    size_t wide;     /* cells of a line */
    bool alone;      /* all are in this part */
    bool whole;      /* nobody of this part's own who is sorted is outside */
    uint32_t *still; /* slots of those who are sorted and not moved: others', and the room for them */
    size_t still_count, still_capacity;
    uint64_t *mark; /* bits, by place: where one of those may be, in the cells that have any */
    size_t mark_capacity;
    bool marked; /* else anybody may be */
} sk_window;

typedef struct sk_share_part {
    sk_share share;            /* first: the world's pointer is this one's */
    sk_op_kernel *find, *copy; /* of a sort's second op and of its last one, else */
    sk_window window;
} sk_share_part;

sk_share *sk_share_create(sk_allocator *allocator, const skein_part *part) {
    sk_share_part *made = sk_allocate(allocator, sizeof *made);
    if (!made) return NULL;
    *made = (sk_share_part){.share = {.given = *part}};
    return &made->share;
}

void sk_share_destroy(sk_share *share, sk_allocator *allocator) {
    if (share) {
        sk_window *window = &((sk_share_part *)share)->window;
        sk_release(allocator, window->line);
        sk_release(allocator, window->still);
        sk_release(allocator, window->mark);
    }
    sk_release(allocator, share);
}

/* That of the share that an op of a sort has for a rule. */
static sk_window *window_of(const sk_op *op) {
    return &((sk_share_part *)(uintptr_t)op->rule)->window;
}

/* ---- the cells ---- */

static size_t cell_count(const sk_cells *cells) {
    size_t layers = ((size_t)cells->count_y + (size_t)cells->layer - 1) / (size_t)cells->layer;
    return (size_t)cells->count_x * (size_t)cells->layer * layers * (size_t)cells->count_z;
}

/* The frame of cells for `everybody`, so many, in the box, with places for the group's particles. False: no memory. */
static bool frame_of_all(sk_cells *cells, sk_allocator *allocator, const skein_border *border, const sk_group *group,
                         real radius) {
    sk_group all = *group;
    all.out = (group->end - group->first) - border->everybody; // which may be fewer than none: it is taken off again
    if (!sk_cells_frame_box(cells, allocator, sk_v3(border->low[0], border->low[1], border->low[2]),
                            sk_v3(border->high[0], border->high[1], border->high[2]), &all, radius))
        return false;
    cells->group = *group;
    cells->in_order = false;
    // memory for as many cells as there may ever be, at once: growing would copy, and so touch, what is not looked into
    size_t count = cell_count(cells), most = border->everybody < 500000000 ? 4 * border->everybody + 64 : count;
    if (count + 2 <= cells->start_capacity) return true;
    sk_release(allocator, cells->start);
    cells->start = NULL, cells->start_capacity = 0;
    return sk_reserve(allocator, (void **)&cells->start, &cells->start_capacity, (count > most ? count : most) + 2,
                      sizeof *cells->start);
}

/* ---- the window ---- */

/* Lists the window's lines, in the order of memory (sk_cells_line()). False: no memory. */
static bool list_lines(sk_window *window, const sk_cells *cells, sk_allocator *allocator) {
    const int32_t *low = window->low, *high = window->high;
    window->count = 0, window->wide = 0;
    if (low[0] > high[0] || low[1] > high[1] || low[2] > high[2]) return true; // nobody looks
    window->wide = (size_t)(high[0] - low[0]) + 1;
    size_t lines = ((size_t)(high[1] - low[1]) + 1) * ((size_t)(high[2] - low[2]) + 1);
    if (!sk_reserve(allocator, (void **)&window->line, &window->capacity, lines, sizeof *window->line)) return false;
    for (int32_t first = low[1], next; first <= high[1]; first = next) {
        next = (first >> cells->shift_y) == (high[1] >> cells->shift_y) ? high[1] + 1 : (first | cells->layer_y) + 1;
        for (int32_t z = low[2]; z <= high[2]; z++)
            for (int32_t y = first; y < next; y++)
                window->line[window->count++] = (uint32_t)(sk_cells_line(cells, y, z) + low[0]);
    }
    return true;
}

static void take_all(sk_window *window, const sk_cells *cells) {
    const int32_t count[3] = {cells->count_x, cells->count_y, cells->count_z};
    for (int k = 0; k < 3; k++) window->low[k] = 0, window->high[k] = count[k] - 1;
    window->count = 0, window->wide = 0, window->still_count = 0;
    window->whole = true, window->marked = false;
}

typedef struct sk_extent {
    real low[3], high[3];
} sk_extent;

static const sk_extent nobody = {{SK_CELLS_FARTHEST, SK_CELLS_FARTHEST, SK_CELLS_FARTHEST},
                                 {-SK_CELLS_FARTHEST, -SK_CELLS_FARTHEST, -SK_CELLS_FARTHEST}};

static inline bool is_somewhere(sk_vec4 p) {
    const real most = SK_CELLS_FARTHEST;
    const int x = sk_abs(p.x) <= most, y = sk_abs(p.y) <= most, z = sk_abs(p.z) <= most;
    return x & y & z; // no branch: birds come by tens of thousands
}

static inline void take(sk_extent *box, sk_vec4 p) {
    box->low[0] = sk_min(box->low[0], p.x), box->high[0] = sk_max(box->high[0], p.x);
    box->low[1] = sk_min(box->low[1], p.y), box->high[1] = sk_max(box->high[1], p.y);
    box->low[2] = sk_min(box->low[2], p.z), box->high[2] = sk_max(box->high[2], p.z);
}

/* The boxes around this part's own that look, and that are looked at; who is not moved, others' and the room for them among these,
 * is listed. Others' have neither mass nor inverse mass. False: no memory. */
static bool find_own(sk_window *window, const sk_run *run, const sk_op *op, sk_extent *look, sk_extent *seen) {
    const sk_vec4 *x = run->vector[SK_X], *v = run->vector[SK_V];
    const sk_group *group = op->group, *lookers = op->seen;
    const bool both = group->first == lookers->first && group->end == lookers->end;
    sk_extent all = nobody, own = nobody;
    size_t count = 0, slots = group->end_slot - group->first_slot;
    if (!sk_reserve(run->allocator, (void **)&window->still, &window->still_capacity, slots + 1, sizeof *window->still))
        return false;
    for (size_t slot = group->first_slot; slot < group->end_slot; slot++) {
        uint32_t i = run->particle_of[slot];
        sk_vec4 p = x[slot];
        if (i - group->first >= group->end - group->first) continue;
        if (p.w == 0) window->still[count++] = (uint32_t)slot;
        if ((p.w == 0 && v[slot].w == 0) || !is_somewhere(p)) continue;
        take(&all, p);
    }
    for (size_t slot = lookers->first_slot; slot < lookers->end_slot && !both; slot++) {
        uint32_t i = run->particle_of[slot];
        sk_vec4 p = x[slot];
        if (i - lookers->first >= lookers->end - lookers->first || (p.w == 0 && v[slot].w == 0) || !is_somewhere(p))
            continue;
        take(&own, p);
    }
    window->still_count = count;
    *seen = all, *look = both ? all : own;
    return true;
}

/* The window around those that look, and whether all of this part's own that are looked at are within. False: no memory. */
static bool find_window(sk_window *window, const sk_run *run, const sk_cells *cells, const sk_op *op) {
    sk_extent all, box;
    if (!find_own(window, run, op, &box, &all)) return false;
    const real origin[3] = {cells->origin.x, cells->origin.y, cells->origin.z},
               per[3] = {cells->per_x, cells->per_yz, cells->per_yz};
    const int32_t count[3] = {cells->count_x, cells->count_y, cells->count_z}, around[3] = {SK_CELLS_ACROSS + 1, 1, 1};
    window->whole = window->marked = true;
    for (int k = 0; k < 3; k++) {
        if (box.low[k] > box.high[k]) { // nobody
            window->low[k] = 0, window->high[k] = -1;
        } else {
            int32_t from = sk_cells_place(box.low[k], origin[k], per[k], count[k]) - around[k],
                    to = sk_cells_place(box.high[k], origin[k], per[k], count[k]) + around[k];
            window->low[k] = from > 0 ? from : 0, window->high[k] = to < count[k] ? to : count[k] - 1;
        }
        if (all.low[k] > all.high[k]) continue; // there is nobody
        window->whole &= sk_cells_place(all.low[k], origin[k], per[k], count[k]) >= window->low[k] &&
                         sk_cells_place(all.high[k], origin[k], per[k], count[k]) <= window->high[k];
    }
    return true;
}

/* Has the blocks of strips in quads, as the program knows slots, or packed again. */
static void lay(sk_run *run, const sk_op *op, bool quads) {
    const sk_share *share = op->rule;
    const sk_kernels *kernels = quads ? &sk_unpack : &sk_pack;
    static const sk_vector vectors[] = {SK_X, SK_V};
    if (op->packed <= op->group->first_slot && op->packed <= op->seen->first_slot) return; // nobody is asked about
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        const sk_op blocks = {.dst = vectors[i], .source = {vectors[i]}, .end = op->packed};
        kernels->version[share->isa](run, &blocks, 0, op->packed);
    }
}

static skein_state state_of(const sk_run *run) {
    return (skein_state){run->particle_count,
                         run->slot_count,
                         run->slot_of,
                         run->particle_of,
                         (skein_real(*)[4])(void *)run->vector[SK_X],
                         (skein_real(*)[4])(void *)run->vector[SK_V]};
}

static skein_share_look look_of(const sk_op *op) {
    return (skein_share_look){op->seen->first, op->seen->end, op->group->first, op->group->end};
}

/* Candidates lie in whole cells (space/cells_wide.h): one more along y and z, and along x those of the reach. */
static skein_cells shown_of(const sk_cells *cells) {
    return (skein_cells){{cells->origin.x, cells->origin.y, cells->origin.z},
                         {cells->per_x, cells->per_yz, cells->per_yz},
                         {cells->count_x, cells->count_y, cells->count_z},
                         {SK_CELLS_ACROSS + 1, 1, 1}};
}

/* The first op of a sort: cells of the whole run's box, and what others look at goes to them. While it is under way this
 * part's own cells are found; what has come from them is taken in by the third op. */
static void send(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_share *share = (sk_share *)(uintptr_t)op->rule;
    sk_window *window = window_of(op);
    sk_cells *cells = run->cells;
    skein_border border = {.everybody = 1};
    const skein_share_look look = look_of(op);
    const skein_state state = state_of(run);
    lay(run, op, true);
    share->failed = share->failed || !share->given.measure(share->given.user, &look, &state, &border);
    window->alone = border.alone;
    if (border.alone) {
        lay(run, op, false);
        share->frame(run, op, begin, end);
        take_all(window, cells);
        run->no_memory = run->no_memory || !list_lines(window, cells, run->allocator);
        return;
    }
    if (!frame_of_all(cells, run->allocator, &border, op->group, (real)op->coefficient[0])) {
        run->no_memory = true;
        lay(run, op, false);
        return;
    }
    const skein_cells shown = shown_of(cells);
    share->failed = share->failed || !share->given.send(share->given.user, &look, &shown, &state);
    run->no_memory =
        run->no_memory || !find_window(window, run, cells, op) || !list_lines(window, cells, run->allocator);
    lay(run, op, false);
}

/* ---- what is sorted ---- */

static inline bool is_within(const sk_window *window, int32_t x, int32_t y, int32_t z) {
    return (x >= window->low[0]) & (x <= window->high[0]) & (y >= window->low[1]) & (y <= window->high[1]) &
           (z >= window->low[2]) & (z <= window->high[2]);
}

/* The cell of a place, if it is somewhere within the window. */
static uint32_t cell_of(const sk_window *window, const sk_cells *cells, sk_vec4 p) {
    if (!is_somewhere(p)) return SK_NOWHERE;
    int32_t x = sk_cells_place(p.x, cells->origin.x, cells->per_x, cells->count_x),
            y = sk_cells_place(p.y, cells->origin.y, cells->per_yz, cells->count_y),
            z = sk_cells_place(p.z, cells->origin.z, cells->per_yz, cells->count_z);
    return is_within(window, x, y, z) ? (uint32_t)(sk_cells_line(cells, y, z) + x) : SK_NOWHERE;
}

/* What has come from others lies where this part has room for it, among those that are not moved: their cells are found now. */
static void receive(sk_run *run, const sk_op *op) {
    sk_share *share = (sk_share *)(uintptr_t)op->rule;
    const sk_window *window = window_of(op);
    sk_cells *cells = run->cells;
    const skein_share_look look = look_of(op);
    const skein_state state = state_of(run);
    const skein_cells shown = shown_of(cells);
    lay(run, op, true);
    share->failed = share->failed || !share->given.receive(share->given.user, &look, &shown, &state);
    for (size_t k = 0; k < window->still_count; k++) {
        size_t slot = window->still[k];
        cells->cell[slot - cells->group.first_slot] = cell_of(window, cells, run->vector[SK_X][slot]);
    }
    lay(run, op, false);
}

/* The cells of those in slots [begin, end); who is outside of the window is in none. */
static void find(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_share_part *part = op->rule;
    const sk_window *window = &part->window;
    sk_cells *cells = run->cells;
    if (run->no_memory) return;
    part->find(run, op, begin, end);
    if (window->whole) return;
    const int32_t count[3] = {cells->count_x, cells->count_y, cells->count_z};
    size_t first = cells->group.first_slot, last = cells->group.end_slot;
    for (size_t slot = begin > first ? begin : first; slot < (end < last ? end : last); slot++) {
        sk_vec4 p = sk_load(run->vector[SK_X], op->packed, slot);
        int32_t x = sk_cells_place(p.x, cells->origin.x, cells->per_x, count[0]),
                y = sk_cells_place(p.y, cells->origin.y, cells->per_yz, count[1]),
                z = sk_cells_place(p.z, cells->origin.z, cells->per_yz, count[2]);
        cells->cell[slot - first] |= is_within(window, x, y, z) ? 0 : SK_NOWHERE;
    }
}

/* Marks the places of cells that have any who is not moved. False: no memory. */
static bool mark_still(sk_window *window, const sk_cells *cells, sk_allocator *allocator) {
    size_t words = cells->count / 64 + 1;
    if (!sk_reserve(allocator, (void **)&window->mark, &window->mark_capacity, words, sizeof *window->mark))
        return false;
    memset(window->mark, 0, words * sizeof *window->mark);
    for (size_t k = 0; k < window->still_count; k++) {
        uint32_t cell = cells->cell[window->still[k] - cells->group.first_slot];
        if (cell == SK_NOWHERE) continue;
        uint32_t place = cells->start[cell], end = cells->start[cell + 1];
        if (window->mark[place / 64] >> place % 64 & 1) continue; // another one's, who is there, too
        for (; place < end; place++) window->mark[place / 64] |= (uint64_t)1 << place % 64;
    }
    return true;
}

/* A counting sort, over the window's cells alone. The cell behind a line's last one is told where that ends. */
static void rank(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_window *window = window_of(op);
    sk_cells *cells = run->cells;
    uint32_t *start = cells->start, sum = 0;
    (void)begin, (void)end;
    if (run->no_memory) return;
    if (!window->alone) receive(run, op);
    size_t slots = cells->group.end_slot - cells->group.first_slot;
    for (size_t l = 0; l < window->count; l++) memset(start + window->line[l], 0, (window->wide + 1) * sizeof *start);
    for (size_t k = 0; k < slots; k++)
        if (cells->cell[k] != SK_NOWHERE) start[cells->cell[k]]++;
    for (size_t l = 0; l < window->count; l++) {
        uint32_t *line = start + window->line[l];
        for (size_t x = 0; x < window->wide; x++) line[x] = sum += line[x];
        if (l + 1 == window->count || window->line[l] + window->wide != window->line[l + 1]) line[window->wide] = sum;
    }
    // from behind, so that each cell ends up with where it begins, and its members in the order of slots
    for (size_t k = slots; k-- > 0;)
        if (cells->cell[k] != SK_NOWHERE)
            cells->slot[--start[cells->cell[k]]] = (uint32_t)(cells->group.first_slot + k);
    cells->count = sum;
    cells->in_order = true; // they are put in the whole run's below, and in no other
    run->no_memory = window->marked && !mark_still(window, cells, run->allocator);
}

/* The first place from `place` on where a cell begins. (Other threads may be moving members within cells meanwhile.) */
static size_t next_beginning(const sk_cells *cells, const sk_window *window, size_t place) {
    size_t low = 0, high = window->count;
    while (high - low > 1) { // the last line that begins before it
        size_t middle = (low + high) / 2;
        if (cells->start[window->line[middle]] < place) low = middle;
        else high = middle;
    }
    const uint32_t *line = cells->start + window->line[low];
    size_t from = 0, to = window->wide;
    while (from < to) {
        size_t middle = (from + to) / 2;
        if (line[middle] < place) from = middle + 1;
        else to = middle;
    }
    return line[from];
}

/* Moves the last of `count` members of a cell forward to its place among the others, which are in order. */
static void move_forwards(uint32_t *slot, size_t count, const uint32_t *number, const uint32_t *particle_of) {
    uint32_t moved = slot[count - 1], own = number[particle_of[moved]];
    size_t at = count - 1;
    for (; at > 0 && number[particle_of[slot[at - 1]]] > own; at--) slot[at] = slot[at - 1];
    slot[at] = moved;
}

/* Members of cells, by their numbers in the whole run. They are few, or in order but for few. Who is alone in a cell is not asked
 * for a number, which lies anywhere in memory. */
static void put_in_order(sk_cells *cells, size_t begin, size_t end, const uint32_t *number,
                         const uint32_t *particle_of) {
    const uint32_t *cell = cells->cell - cells->group.first_slot;
    uint32_t *slot = cells->slot;
    for (size_t place = begin + 1, first = begin; place < end; place++) {
        if (cell[slot[place]] != cell[slot[place - 1]]) {
            first = place;
        } else if (number[particle_of[slot[place]]] < number[particle_of[slot[place - 1]]]) {
            move_forwards(slot + first, place - first + 1, number, particle_of);
        }
    }
}

static void copy(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_share_part *part = op->rule;
    sk_cells *cells = run->cells;
    if (run->no_memory || begin >= cells->count) return;
    begin = next_beginning(cells, window_of(op), begin);
    end = end < cells->count ? next_beginning(cells, window_of(op), end) : cells->count;
    if (begin >= end) return;
    put_in_order(cells, begin, end, part->share.given.number, run->particle_of);
    part->copy(run, op, begin, end);
}

/* ---- who looks ---- */

/* Whether an element of a rule that looks at neighbours is moved by it. What has no inverse mass is not, and no others' have any:
 * their neighbours are not looked for. */
static bool is_moved(const sk_run *run, const sk_op *op, bool places, size_t element) {
    uint32_t slot = places ? run->cells->slot[element] : run->slot_of[element];
    return sk_load(run->vector[SK_X], op->packed, slot).w != 0;
}

/* The first place from `place` on that is marked, or `end`. */
static size_t next_marked(const uint64_t *mark, size_t place, size_t end) {
    if (place >= end) return end;
    uint64_t word = mark[place / 64] >> place % 64;
    if (word) place += (size_t)__builtin_ctzll(word);
    else
        for (place = (place / 64 + 1) * 64; place < end; place += 64)
            if ((word = mark[place / 64])) {
                place += (size_t)__builtin_ctzll(word);
                break;
            }
    return place < end ? place : end;
}

/* The window of the sort that a rule's op looks into the cells of, which is before it in the plan. */
static const sk_window *window_before(const sk_op *op) {
    do op--;
    while (op->kernel != copy);
    return window_of(op);
}

/* The rule's own kernel, over those that it moves. Its elements are places where those that it moves are those that it sees. */
static void look(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_group *moved = op->group, *seen = op->seen;
    bool places = !moved || !seen || (moved->first == seen->first && moved->end == seen->end);
    if (run->no_memory) return;
    const sk_window *window = window_before(op);
    if (places && end > run->cells->count) end = run->cells->count;
    for (size_t next; begin < end; begin = next) {
        for (; begin < end && !is_moved(run, op, places, begin);) begin++;
        for (next = begin; next < end; next++) {
            if (places && window->marked) next = next_marked(window->mark, next, end);
            if (next == end || !is_moved(run, op, places, next)) break;
        }
        if (begin < next) op->inner(run, op, begin, next);
    }
}

/* Who looks into the cells of the sort at `place`: the group of the rule that steers by them, or where rules push, of which
 * several share a sort, all that are in them. */
static const sk_group *who_looks(const sk_plan *plan, size_t place) {
    for (size_t r = place + SK_SORT_OPS; r < plan->count && !sk_op_type_of(&plan->data[r])->sorts; r++)
        if (sk_op_type_of(&plan->data[r])->walks && plan->data[r].group) return plan->data[r].group;
    return plan->data[place].group;
}

void sk_share_plan(sk_plan *plan, sk_share *share, sk_isa isa) {
    share->isa = isa;
    for (size_t r = 0; r + SK_SORT_OPS <= plan->count; r++) {
        sk_op *first = &plan->data[r], *last = first + SK_SORT_OPS - 1;
        if (!sk_op_type_of(first)->sorts) continue;
        first->seen = first[2].seen = who_looks(plan, r);
        sk_share_part *part = (sk_share_part *)share;
        share->frame = first->kernel, part->find = first[1].kernel, part->copy = last->kernel;
        first->kernel = send, first->rule = share, first->label = "border, frame of cells";
        first[1].kernel = find, first[1].rule = share;
        first[2].kernel = rank, first[2].rule = share, first[2].label = "border's, place of each";
        last->kernel = copy, last->rule = share;
    }
    for (size_t r = 0; r < plan->count; r++) {
        sk_op *op = &plan->data[r];
        if (sk_op_type_of(op)->walks) op->inner = op->kernel, op->kernel = look;
    }
}

bool sk_op_can_be_shared(const sk_op *op) {
    const sk_op_type *type = sk_op_type_of(op);
    bool of_slots = type->reads || (type->arithmetic && type->kernels) || type->rule == SK_RULE_COLLIDER;
    return !op->alone && (of_slots || op->kind == SK_OP_REPEAT || sk_op_is_joined(op));
}

bool sk_op_is_joined(const sk_op *op) {
    static const sk_op_kind kinds[] = {SK_OP_PACK,    SK_OP_UNPACK,     SK_OP_FORCE,
                                       SK_OP_PROJECT, SK_OP_MULTIPLIER, SK_OP_LIMIT};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (op->kind == kinds[i]) return true;
    return false;
}
