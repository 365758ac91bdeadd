/* The rule of contact: its fields, and the first of its ops. */
#include <string.h>

#include "base/tasks.h"
#include "contact/search/search.h"

static const skein_field fields[] = {
    SK_REAL(sk_contact_params, thickness, "thickness", "m", 0.005, 1e-6, 1e3,
            "how near surfaces come to each other; less where a body's own vertices are nearer as it was built"),
    SK_REAL(sk_contact_params, friction, "friction", "", 0.3, 0, 10, "coefficient of friction between them"),
    SK_REAL(sk_contact_params, recovery, "recovery", "m/s", 0.4, 0, 1e6,
            "how fast surfaces that have gone through each other are led apart; 0: they stay so"),
    SK_INT(
        sk_contact_params, more_substeps, "more_substeps", "", 10, 1, 100,
        "xpbd and pbd, where bodies near others or colliders by over half a thickness a substep, or pins are led past what hangs from them by over two: "
        "up to so many times as many; 1: never"),
    SK_TEXT(
        sk_contact_params, ignore, "ignore", "",
        "pairs of bodies, or of groups of them, that do not meet, by their names, commas between them: \"cape:shirt, cape:cape\""),
};

/* ---- begin ---- */

static const sk_contact_params *params_of(const sk_op *op) {
    return ((const sk_force *)op->rule)->params;
}

static sk_touch *touch_of(const sk_op *op) {
    return ((const sk_force *)op->rule)->state;
}

/* How much of a thickness courses have room for. */
static real roomy_share(const sk_touch *touch) {
    const real room = (real)0.45 * touch->skin.spacing - (real)0.5 * SK_NEAR_THICKNESSES * touch->thickness;
    return touch->untouched && room > (real)0.5 * touch->thickness ? (real)0.5
                                                                   : (real)0.25; // its own features stay out of reach
}

/* A heap trembles by some ways that gravity makes of a substep, however thin it is: silk of 65 x 65, whose edges are 80 thicknesses long, lost
 * nearly everybody in each substep, and took 76 ms a frame at rest where it takes 40 so (with 10 substeps of such ways instead of 40: 47; twice the
 * share of edges: 40); what is as thick as the default takes as long as it did. */
static real most_reach(const sk_touch *touch) {
    const real of_edges = (real)0.08;
    return sk_max(roomy_share(touch) * touch->thickness, of_edges * touch->skin.spacing);
}

/* What is fast is seldom as steady, and what is slow needs little room; `speed` is that of a substep, in the frame. */
static sk_course course_from(const sk_touch *touch, sk_vec3 at, sk_vec3 step, real speed, real time) {
    const real least = (real)0.125, substeps = 40;
    const real reach =
        sk_max(sk_min(most_reach(touch), least * touch->thickness + substeps * speed), roomy_share(touch) * speed);
    return (sk_course){sk_sub(at, sk_scale(time, step)), step, reach};
}

typedef struct looking {
    const sk_touch *touch;
    const sk_pairs *pairs;
    int sort;
} looking;

static void look_at_some(void *data, size_t begin, size_t end) {
    const looking *job = data;
    sk_pairs some = sk_pairs_between(job->pairs, begin, end);
    sk_closest[job->sort][job->touch->isa](job->touch->p, &some);
}

static void look_at_all(sk_touch *touch) {
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        looking kept = {touch, &touch->kept[sort], sort}, late = {touch, &touch->late[sort], sort};
        sk_parallel_for(touch->tasks, 0, kept.pairs->count, look_at_some, &kept);
        sk_parallel_for(touch->tasks, 0, late.pairs->count, look_at_some, &late);
    }
}

static bool list_near(sk_touch *touch, sk_allocator *allocator) {
    bool good = true;
    for (int sort = 0; sort < SK_PAIR_SORTS && good; sort++) good = sk_touch_find_near(touch, allocator, sort);
    return good;
}

bool sk_touch_look_again(sk_touch *touch, sk_allocator *allocator) {
    look_at_all(touch);
    if (!list_near(touch, allocator)) return false;
    sk_touch_choose_sides(touch); // as the solve that comes to be bound has taken them
    return true;
}

bool sk_touch_renew(sk_touch *touch, sk_allocator *allocator, sk_touch_search_sort search) {
    if (!sk_touch_search(touch, allocator, search)) return false;
    if (search != SK_SEARCH_WAYS) look_at_all(touch);
    return true;
}

void sk_touch_copy_start(sk_touch *touch) {
    memcpy(touch->copied, touch->before, touch->slots * sizeof *touch->copied);
    touch->before = touch->copied;
}

typedef struct loading {
    sk_touch *touch;
    size_t packed;
} loading;

static void load_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const loading *job = data;
    sk_touch *touch = job->touch;
    for (size_t v = begin; v < end; v++) {
        touch->p[v] = sk_load(touch->before, job->packed, touch->slot[v]);
        touch->inverse[v] = touch->p[v].w =
            sk_load(touch->x, job->packed, touch->slot[v]).w; // a method's own copy has no masses
    }
}

void sk_touch_load(sk_touch *touch, size_t packed) {
    enum { AT_ONCE = 2048 };
    loading job = {touch, packed};
    if (!touch->loaded) sk_parallel_pieces(touch->tasks, 0, touch->skin.vertex_count, AT_ONCE, load_some, &job);
    touch->loaded = true;
}

static void release_slots(sk_touch *touch, sk_allocator *allocator) {
    void **arrays[] = {(void **)&touch->copied,    (void **)&touch->course_block, (void **)&touch->off,
                       (void **)&touch->vertex_at, (void **)&touch->faces.here,   (void **)&touch->faces.block};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        sk_release(allocator, *arrays[i]);
        *arrays[i] = NULL;
    }
    touch->slots = touch->slot_capacity = 0;
}

/* Where the vertices are among the slots; false when there is no memory. */
static bool find_slots(sk_touch *touch, const sk_run *run) {
    size_t slots = run->slot_count;
    bool same = touch->slots == slots;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        uint32_t slot = run->slot_of[touch->skin.particle[v]];
        same &= touch->slot[v] == slot;
        touch->slot[v] = slot;
    }
    for (size_t i = 0; i < touch->skin.inner_count; i++)
        touch->inner_slot[i] = run->slot_of[touch->skin.inner[i].particle];
    if (same) return true;
    touch->found = false;
    touch->slots = 0;
    if (slots > touch->slot_capacity) {
        release_slots(touch, run->allocator);
        touch->copied = sk_allocate(run->allocator, slots * sizeof *touch->copied);
        touch->course_block = sk_allocate(run->allocator, slots / 16 * sizeof *touch->course_block);
        touch->off = sk_allocate(run->allocator, slots / 16 * sizeof *touch->off);
        touch->vertex_at = sk_allocate(run->allocator, slots * sizeof *touch->vertex_at);
        touch->faces.here = sk_allocate(run->allocator, slots * sizeof *touch->faces.here);
        touch->faces.block = sk_allocate(run->allocator, (slots / 16 + 1) * sizeof *touch->faces.block);
        if (!touch->copied || !touch->course_block || !touch->off || !touch->vertex_at || !touch->faces.here ||
            !touch->faces.block)
            return false;
        touch->slot_capacity = slots;
    }
    touch->slots = slots;
    for (size_t b = 0; b < slots / 16; b++) {
        touch->course_block[b] = (sk_course_block){.square = {0}};
        for (int l = 0; l < 16; l++) touch->course_block[b].square[l] = SK_REAL_MAX; // who is not there is never lost
    }
    memset(touch->faces.here, 0, slots * sizeof *touch->faces.here);
    for (size_t v = 0; v < touch->skin.vertex_count; v++)
        touch->vertex_at[touch->slot[v]] = (uint32_t)v, touch->faces.here[touch->slot[v]] = 1;
    return true;
}

/* How far a vertex goes in a substep, as it does now. */
static sk_vec3 step_of(const sk_touch *touch, const sk_run *run, const sk_op *op, size_t v) {
    sk_vec3 step = sk_scale((real)op->dt, sk_xyz(sk_load(run->vector[SK_V], op->packed, touch->slot[v])));
    return sk_dot(step, step) < (real)1e12 ? step : (sk_vec3){0, 0, 0}; // blown up
}

/* The frame of courses begins here, and goes as all do in the mean, unless some are pinned. */
static void begin_frame(sk_touch *touch, const sk_run *run, const sk_op *op) {
    double sum[3] = {0, 0, 0}, share = 1 / (double)touch->skin.vertex_count;
    touch->held = false;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        sk_vec3 step = step_of(touch, run, op, v);
        sum[0] += (double)step.x, sum[1] += (double)step.y, sum[2] += (double)step.z;
        touch->held |= !(touch->inverse[v] > 0);
    }
    if (touch->held) share = 0;
    touch->shift[0] = (sk_vec3){0, 0, 0};
    touch->frame_step = (sk_vec3){(real)(share * sum[0]), (real)(share * sum[1]), (real)(share * sum[2])};
}

/* A vertex goes on as it does now; but as it did in the mean where, since a course was last set for it, it has rather stayed
 * in the frame than gone as it then did: it trembles. */
static sk_vec3 steady_step(const sk_touch *touch, size_t v, sk_vec3 step) {
    const sk_seen *seen = &touch->seen[v];
    real time = (real)(touch->clock - seen->clock);
    if (!touch->remembers || !(time > 0)) return step;
    sk_vec3 gone = sk_sub(sk_xyz(touch->p[v]), seen->at);
    sk_vec3 stayed = sk_sub(gone, sk_scale(time, touch->frame_step)), went = sk_sub(gone, sk_scale(time, seen->step));
    return sk_dot(stayed, stayed) <= sk_dot(went, went) ? sk_scale(1 / time, stayed) : step;
}

/* Courses of lost vertices, as their velocities are. */
static void set_courses(sk_touch *touch, const sk_run *run, const sk_op *op, real time) {
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        if (!touch->lost[v] || sk_vertex_is_out(&touch->spread, v)) continue;
        sk_vec3 goes = step_of(touch, run, op, v), now = sk_sub(goes, touch->frame_step),
                step = steady_step(touch, v, now);
        real speed = sk_max(sk_length(sk_sub(now, touch->drift)), sk_length(sk_sub(step, touch->drift)));
        touch->seen[v] = (sk_seen){sk_xyz(touch->p[v]), goes, touch->clock};
        touch->course[v] = course_from(touch, sk_sub(sk_xyz(touch->p[v]), touch->shift[0]), step, speed, time);
        sk_touch_put_course(touch, v, false);
    }
}

/* Whether so many vertices are lost that looking for all costs less. */
static bool are_most(const sk_touch *touch) {
    size_t lost = 0;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) lost += touch->lost[v];
    if (2 * touch->spread.out_count > touch->spread.count) return touch->lost_since > 4 * touch->skin.vertex_count;
    return 10 * lost > touch->skin.vertex_count || 2 * (touch->lost_since + lost) > touch->skin.vertex_count;
}

/* Whether all is as the last bound left it. */
static bool is_known(const sk_touch *touch, const sk_run *run) {
    return touch->alone && run->iteration > 0 && touch->followed;
}

/* Finds out who is lost before the substep: the wild, too, get courses now and then. */
static bool mark_lost(sk_touch *touch, const sk_run *run, const sk_op *op) {
    const size_t often = 2;                                                    // substeps
    bool knows = is_known(touch, run) || sk_spread_is_all_out(&touch->spread); // for who has been lost since then?
    if (!knows) sk_touch_set_frame(touch, run->vector[SK_X], op->packed, touch->now, 0);
    else touch->shift[0] = touch->shift[1];
    bool lost = !knows && sk_touch_mark_lost(touch, run->vector[SK_X], op->packed, touch->now, 0);
    if (knows) memset(touch->lost, 0, touch->skin.vertex_count);
    if (!touch->wild_count || (knows && run->iteration % often)) return lost;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) touch->lost[v] |= touch->wild[v];
    return true;
}

/* Whether a search for all has been used up so soon that searches for one substep each would have cost less: as measured, a
 * third of one that holds for longer, and those for the lost between cost by how many they are. Where few pairs are kept,
 * it is the boxes that cost, and a sheet that swings cost twice as much so; unless half of all have been lost: flags that flutter take three
 * quarters of the time so. */
static bool is_stormy(const sk_touch *touch) {
    const size_t vertices = touch->skin.vertex_count;
    if (sk_pairs_kept(touch) < 8 * vertices && 2 * touch->lost_since < vertices) return false;
    double all = 3, each = 0.15, lost = (double)touch->lost_since / (double)touch->skin.vertex_count;
    return touch->found && all + each * (double)touch->searched_since + all * lost > 1.3 * (double)touch->now;
}

static void begin_storm(sk_touch *touch) {
    const size_t least = 10, most = 80;
    const real forever = 1000; // substeps
    touch->storm = touch->next_storm = touch->next_storm ? touch->next_storm : least;
    if (2 * touch->next_storm <= most) touch->next_storm *= 2;
    touch->until = touch->now + forever;
    for (size_t v = 0; v < touch->skin.vertex_count; v++)
        sk_touch_put_course(touch, v, !sk_vertex_is_out(&touch->spread, v));
}

/* Looks at panels: nobody is out where things go through each other, and in an implicit solve, which asks several times what
 * becomes of a substep; others go out once a frame.
 * Whether vertices have lost their courses, for they never had any. */
static bool look_at_panels(sk_touch *touch, const sk_run *run, const sk_op *op) {
    sk_spread *spread = &touch->spread;
    if (!spread->count) return false;
    if (spread->never || touch->tangle.any) return sk_spread_end(touch);
    bool frame = run->iteration == 0, more = frame && spread->out_count < spread->count && !spread->rest;
    if (frame && spread->rest) spread->rest--;
    bool known = touch->tangle.same && !(spread->thickness < touch->thickness || spread->thickness > touch->thickness);
    if (!more && (known || !spread->out_count)) return false;
    sk_touch_load(touch, op->packed);
    return sk_spread_look(touch, more);
}

/* Whether others have blown up than when pairs were found, of whom there may be none where all is out. */
static bool knows_other_torn(sk_touch *touch, const sk_op *op) {
    if (!sk_spread_is_all_out(&touch->spread)) sk_torn_know(touch, op->packed);
    const bool changed = touch->torn_changed;
    touch->torn_changed = false;
    return changed;
}

/* Whether vertices go so fast against each other, in the mean, that they leave any courses within some substeps. */
static bool is_wild(const sk_touch *touch, const sk_run *run, const sk_op *op) {
    const real share = 1 / (real)touch->skin.vertex_count;
    sk_vec3 drift = {0, 0, 0};
    real speed = 0;
    for (size_t v = 0; v < touch->skin.vertex_count; v++)
        drift = sk_add(drift, sk_scale(share, step_of(touch, run, op, v)));
    for (size_t v = 0; v < touch->skin.vertex_count; v++)
        speed += share * sk_length(sk_sub(step_of(touch, run, op, v), drift));
    return speed > (real)0.8 * most_reach(touch);
}

/* A storm that is over goes on where things are still wild: trying courses in the midst of an impact took as long as five substeps of it, and made
 * its worst frame half as long again. Returns whether it goes on. */
static bool goes_on(sk_touch *touch, const sk_run *run, const sk_op *op) {
    if (touch->storm == 1 && is_wild(touch, run, op)) touch->storm += touch->next_storm;
    return --touch->storm > 0;
}

/* In a storm, pairs are those that the last bound has found, on everybody's ways; or of where all are now. */
static bool find_pairs_in_storm(sk_touch *touch, const sk_run *run, const sk_op *op, bool known) {
    sk_touch_load(touch, op->packed);
    touch->shift[0] = (sk_vec3){0, 0, 0};
    look_at_panels(touch, run, op);
    known &= !knows_other_torn(touch, op);
    if (!known && !sk_calm_look(touch, run->allocator, true)) return false;
    memset(touch->lost, known ? 0 : 1, touch->skin.vertex_count);
    if (!known) return sk_touch_renew(touch, run->allocator, SK_SEARCH_LOST);
    look_at_all(touch);
    return true;
}

/* Looks for what is tangled; in a substep it is led apart by a quarter of the thickness, at most. */
static bool find_tangles(sk_touch *touch, const sk_run *run, const sk_op *op) {
    const real most = (real)0.25 * touch->thickness, step = (real)(params_of(op)->recovery * op->dt);
    touch->tangle.same = is_known(touch, run);
    if (!(step > 0)) return true;
    return sk_tangle_look(touch, run, op, sk_min(step, most), is_known(touch, run));
}

/* Searches where that is needed, and looks at all pairs. */
static bool find_pairs(sk_touch *touch, const sk_run *run, const sk_op *op, bool all) {
    bool stormed = touch->storm > 0;
    if (stormed && !all && goes_on(touch, run, op)) return find_pairs_in_storm(touch, run, op, is_known(touch, run));
    touch->storm = 0;
    all |= stormed;
    bool lost = !all && mark_lost(touch, run, op);
    lost |= look_at_panels(touch, run, op) && !all;
    if (touch->spread.went_out) sk_touch_leave_out(touch);
    touch->spread.went_out = false;
    bool looks = !all && !touch->holds;
    if (all || lost || looks || sk_pairs_kept(touch)) sk_touch_load(touch, op->packed);
    if (touch->loaded || touch->any_torn) all |= knows_other_torn(touch, op);
    if (looks && !sk_calm_look(touch, run->allocator, false)) return false;
    all |= lost && are_most(touch);
    bool stormy = all && !stormed && is_stormy(touch);
    if (stormy) {
        begin_storm(touch);
        return find_pairs_in_storm(touch, run, op, false);
    }
    if (all) {
        if (!stormed) touch->next_storm = 0;
        touch->untouched = 8 * sk_pairs_kept(touch) < touch->skin.vertex_count;
        if (!sk_calm_look(touch, run->allocator, true)) return false;
        memset(touch->lost, 1, touch->skin.vertex_count);
        begin_frame(touch, run, op);
    }
    if (all || lost) {
        const uint64_t given_up = touch->given_up;
        set_courses(touch, run, op, all ? 0 : touch->now);
        touch->remembers |= all;
        if (!sk_touch_renew(touch, run->allocator, all ? SK_SEARCH_ALL : SK_SEARCH_LOST)) return false;
        if (touch->found) return true;
        // courses lead too far through each other: what is fast has been hit; a substep at a time it may be found
        touch->given_up = given_up;
        begin_storm(touch);
        return find_pairs_in_storm(touch, run, op, false);
    }
    look_at_all(touch);
    return true;
}

/* By how much the nearest pair has less than its thickness, of those with a corner among the particles that are asked about. */
static real find_missing(const sk_touch *touch, const sk_easing *easing) {
    real missing = 0;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t i = 0; i < touch->near[sort].count; i++) {
            const uint32_t entry = touch->near[sort].data[i];
            const sk_pairs *pairs = sk_pairs_of(touch, sort, entry);
            bool asked = false;
            for (int c = 0; c < 4; c++) {
                const uint32_t particle = touch->skin.particle[pairs->corner[c][entry / 2]];
                asked |= particle >= easing->asks && particle < easing->asks_end;
            }
            if (asked) missing = sk_max(missing, pairs->thickness[entry / 2] - pairs->distance[entry / 2]);
        }
    return missing;
}

/* Who begins, begins with the thickness that his pairs have, and lets it grow; others may have that of before. */
static void ease(sk_touch *touch, sk_force *force, double time) {
    const real missing = find_missing(touch, &force->easing);
    const double left = sk_easing_left(&force->easing, time), less = (double)missing > left ? (double)missing : left;
    force->easing = (sk_easing){less, time, 0, 0};
    touch->less = (real)less;
}

/* Where the substep begins is copied, unless all panels lie spread out and the method keeps it, too: then mostly nobody asks. */
static void begin_where_all_are(sk_touch *touch, const sk_run *run) {
    touch->before = touch->x = run->vector[SK_X];
    if (!touch->start_is_kept || !sk_spread_is_all_out(&touch->spread)) sk_touch_copy_start(touch);
}

static void begin(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = touch_of(op);
    if (!touch || !touch->skin.vertex_count) return;
    real thickness = sk_touch_thickest(touch, params_of(op)), usual = (real)params_of(op)->thickness;
    bool good = (run->iteration && touch->alone && touch->slots) || find_slots(touch, run);
    touch->now += 1, touch->clock++;
    bool all = !touch->found || touch->thickness < thickness || touch->thickness > thickness || touch->usual < usual ||
               touch->usual > usual || touch->now + 1 > touch->until;
    bool same =
        !(touch->thickness < thickness || touch->thickness > thickness || touch->usual < usual || touch->usual > usual);
    touch->thickness = thickness;
    touch->usual = usual;
    const sk_easing *easing = &((const sk_force *)op->rule)->easing;
    touch->less = (real)sk_easing_left(easing, run->time);
    if (!same) sk_calm_forget(touch);
    touch->loaded = false;
    touch->tasks = run->tasks;
    touch->holds = good && touch->found &&
                   (is_known(touch, run) || sk_spread_is_all_out(&touch->spread) ||
                    sk_calm_holds(touch, sk_touch_farthest(touch, run->vector[SK_X], op->packed)));
    if (good) begin_where_all_are(touch, run);
    if (run->vector[SK_SUPPORT] && *run->supported) {
        memset(run->vector[SK_SUPPORT], 0, run->slot_count * sizeof *run->vector[SK_SUPPORT]);
        *run->supported = false;
    }
    good = good && find_tangles(touch, run, op) && find_pairs(touch, run, op, all);
    touch->followed = touch->corrects = touch->pushes.known = false;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) touch->near[sort].count = 0;
    good = good && list_near(touch, run->allocator);
    if (good && easing->asks < easing->asks_end) ease(touch, (sk_force *)op->rule, run->time);
    if (run->near_at < run->time || run->near_at > run->time) run->near = false; // of this substep nobody has said yet
    run->near_at = run->time;
    run->near |= touch->near[SK_CORNERS].count + touch->near[SK_EDGES].count > 0 || touch->tangle.any;
    run->no_memory |= !good;
}

/* ---- the kind ---- */

enum { VERTEX_ARRAYS = 48 };

/* All arrays by vertex, edge, triangle or leaf, with the sizes of their elements. */
static int list_arrays(sk_touch *touch, void ***array, size_t *size, size_t *count) {
    const sk_skin *skin = &touch->skin;
    const size_t vertices = skin->vertex_count + 1, edges = skin->edge_count + 1, triangles = skin->triangle_count + 1;
    const size_t leaves = skin->leaf_count + SK_TREE_WIDTH;
    int n = 0;
#define LIST(name, number) array[n] = (void **)&touch->name, size[n] = sizeof *touch->name, count[n++] = number
    LIST(slot, vertices), LIST(p, vertices), LIST(q, vertices), LIST(way, vertices), LIST(yielded, vertices);
    LIST(slab, vertices), LIST(rank, vertices), LIST(at, vertices), LIST(in_the_end, vertices), LIST(course, vertices);
    LIST(seen, vertices), LIST(inverse, vertices), LIST(share, vertices), LIST(next_share, vertices);
    LIST(lowered, vertices), LIST(loses, vertices), LIST(lost, vertices), LIST(wild, vertices), LIST(waiting, vertices);
    LIST(waits, vertices), LIST(asked_at, vertices), LIST(inner_slot, skin->inner_count + 1);
    LIST(faces.plane, vertices), LIST(press.number, vertices), LIST(press.slot, vertices), LIST(corner_box, vertices);
    LIST(vertex_box, vertices), LIST(edge_box, edges), LIST(triangle_box, triangles), LIST(hot, leaves);
    LIST(leaf_box, leaves), LIST(hot_box, leaves), LIST(edge_cells, leaves), LIST(corner_cells, leaves);
    LIST(torn, leaves), LIST(room, leaves), LIST(anew, leaves), LIST(moved, leaves), LIST(featured, leaves);
    LIST(changed, 2 * leaves), LIST(start, leaves);
#undef LIST
    return n;
}

static void release_vertices(sk_touch *touch, sk_allocator *allocator) {
    void **array[VERTEX_ARRAYS];
    size_t size[VERTEX_ARRAYS], count[VERTEX_ARRAYS];
    for (int i = list_arrays(touch, array, size, count); i-- > 0;) {
        sk_release(allocator, *array[i]);
        *array[i] = NULL;
    }
    sk_touch_release_parts(touch, allocator);
    sk_calm_release(&touch->calm, allocator);
    sk_spread_release(&touch->spread, allocator);
    sk_tangle_release(&touch->tangle, allocator);
    sk_tree_release(&touch->tree, allocator);
    sk_ignored_release(&touch->ignored, allocator);
}

static bool make_vertices(sk_touch *touch, sk_allocator *allocator) {
    void **array[VERTEX_ARRAYS];
    size_t size[VERTEX_ARRAYS], count[VERTEX_ARRAYS];
    bool good = true;
    for (int i = list_arrays(touch, array, size, count); i-- > 0 && good;)
        good = (*array[i] = sk_allocate(allocator, size[i] * count[i])) != NULL;
    return good && sk_tree_make(&touch->tree, allocator, &touch->skin);
}

static void forget_pairs(sk_touch *touch) {
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        touch->near[sort].count = touch->kept[sort].count = touch->late[sort].count = touch->may_close[sort].count = 0;
    touch->press.pair.count = touch->press.now.count = touch->press.slot_count = 0;
}

static void release(sk_force *force, sk_allocator *allocator) {
    sk_touch *touch = force->state;
    if (!touch) return;
    release_vertices(touch, allocator);
    release_slots(touch, allocator);
    sk_skin_release(&touch->skin, allocator);
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        sk_pairs_release(&touch->kept[sort], allocator);
        sk_pairs_release(&touch->late[sort], allocator);
        sk_release(allocator, touch->near[sort].data);
        sk_release(allocator, touch->may_close[sort].data);
        sk_release(allocator, touch->divided[sort].data);
    }
    sk_pairs_release(&touch->fresh, allocator);
    sk_release(allocator, touch->yielding.data);
    sk_release(allocator, touch->order.data);
    sk_release(allocator, touch->other_order.data);
    sk_release(allocator, touch->first.data);
    sk_release(allocator, touch->press.pair.data);
    sk_release(allocator, touch->pushes.pair.data);
    sk_release(allocator, touch->pushes.class_of.data);
    sk_release(allocator, touch->pushes.dealt.data);
    sk_release(allocator, touch->press.now.data);
    sk_release(allocator, touch->partner.data);
    sk_release(allocator, touch->faces.collider);
    sk_release(allocator, touch->faces.near.data);
    sk_release(allocator, touch);
    force->state = NULL;
}

static uint64_t add_text(uint64_t shape, const char *text) {
    for (; *text; text++) shape = (shape ^ (unsigned char)*text) * 0x100000001b3u;
    return (shape ^ 0x100) * 0x100000001b3u; // where it ends
}

/* Another world, or the same with others in it, has another number. */
static uint64_t shape_of(const sk_force *force, const sk_meeting_parts *parts) {
    uint64_t shape = parts->arrangement * 2 + force->only.some;
    for (size_t i = 0; i < force->only.count; i++)
        shape = (shape ^ force->only.data[i].first) * 0x100000001b3u ^ force->only.data[i].end;
    const sk_contact_params *params = force->params;
    shape = add_text(shape, params->ignore);
    for (size_t i = 0; i < parts->body_count && params->ignore[0]; i++) // they say whom that text means
        shape = add_text(add_text(shape, parts->body[i].name), parts->body[i].groups);
    return shape;
}

static bool prepare(sk_force *force, sk_allocator *allocator, const sk_particles *particles,
                    const sk_meeting_parts *parts, sk_isa isa) {
    sk_touch *touch = force->state;
    if (!touch && !(touch = force->state = sk_allocate(allocator, sizeof *touch))) return false;
    touch->isa = isa;
    touch->alone = parts->rule_count == 1;
    touch->start_is_kept = false; // until a bound says so
    if (!sk_faces_take(&touch->faces, allocator, parts)) return false;
    uint64_t shape = shape_of(force, parts);
    if (touch->p && touch->shape == shape) return true;
    release_vertices(touch, allocator);
    touch->shape = shape;
    touch->asked_crowded = false;
    touch->found = touch->boxed = touch->followed = touch->remembers = false;
    touch->slots = touch->wild_count = 0;
    touch->torn_asked = touch->any_torn = touch->torn_changed = false;
    forget_pairs(touch); // of a skin without vertices nobody would
    const sk_contact_params *params = force->params;
    if (sk_skin_make(&touch->skin, allocator, particles, &force->only, parts) && make_vertices(touch, allocator) &&
        sk_ignored_make(&touch->ignored, allocator, &touch->skin, params->ignore, parts) &&
        sk_calm_make(touch, allocator) && sk_spread_make(touch, allocator))
        return true;
    release(force, allocator);
    return false;
}

static const char *ignored(const void *params) {
    return ((const sk_contact_params *)params)->ignore;
}

static skein_status check(const void *params, skein_error *error) {
    return sk_ignored_check(((const sk_contact_params *)params)->ignore, error);
}

static uint64_t gave_up(sk_force *force, bool *first) {
    sk_touch *touch = force->state;
    const uint64_t times = touch ? touch->given_up - touch->told : 0;
    *first = times && !touch->told;
    if (times) touch->told = touch->given_up;
    return times;
}

static const sk_meeting_body *crowded(sk_force *force, sk_allocator *allocator, const sk_meeting_parts *parts,
                                      double *edge, double *thickness) {
    sk_touch *touch = force->state;
    if (!touch || touch->asked_crowded || touch->told_crowded) return NULL;
    const sk_contact_params *params = force->params;
    const sk_meeting_body *body = sk_touch_crowded(touch, allocator, parts, params->thickness, edge, thickness);
    touch->asked_crowded = true, touch->told_crowded = body != NULL;
    return body;
}

static const sk_meeting meeting = {
    .begin = {SK_ANY_ISA(begin)},
    .push = {SK_ANY_ISA(sk_touch_push)},
    .push_on = {SK_ANY_ISA(sk_touch_push_on)},
    .hold = {SK_ANY_ISA(sk_touch_hold)},
    .bound = {SK_ANY_ISA(sk_touch_bound)},
    .faces = {SK_ANY_ISA(sk_touch_push_faces)},
    .near = {SK_ANY_ISA(sk_press_begin)},
    .press = {SK_ANY_ISA(sk_press_force)},
    .diagonal = {SK_ANY_ISA(sk_press_diagonal)},
    .apply = {SK_ANY_ISA(sk_press_apply)},
    .lead = {SK_ANY_ISA(sk_touch_lead)},
    .prepare = prepare,
    .release = release,
    .crossings = sk_touch_crossings,
    .touching = sk_touch_touching,
    .ignored = ignored,
    .check = check,
    .gave_up = gave_up,
    .crowded = crowded,
};

const sk_force_type sk_surface_contact = {
    .kind = {"contact",
             "surfaces and ropes neither pass through each other nor through themselves; colliders meet all of them",
             SKEIN_FORCE, fields, sizeof fields / sizeof *fields, sizeof(sk_contact_params)},
    .domain = SK_OVER_PARTICLES,
    .phase = SK_MEETS,
    .passive = true,
    .meeting = &meeting,
};
