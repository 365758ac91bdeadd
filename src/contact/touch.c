/* The rule of contact: its fields, and the first two of its ops. */
#include "contact/touch.h"

#include <string.h>

static const skein_field fields[] = {
    SK_REAL(sk_contact_params, thickness, "thickness", "m", 0.005, 1e-6, 1e3,
            "how near surfaces come to each other; less where a body's own vertices are nearer as it was built"),
    SK_REAL(sk_contact_params, friction, "friction", "", 0.3, 0, 10, "coefficient of friction between them"),
};

/* ---- begin ---- */

static const sk_contact_params *params_of(const sk_op *op) {
    return ((const sk_force *)op->rule)->params;
}

static sk_touch *touch_of(const sk_op *op) {
    return ((const sk_force *)op->rule)->state;
}

/* A vertex goes on as it does now; what is fast is seldom as steady. */
static sk_course course_from(const sk_touch *touch, sk_vec3 at, sk_vec3 step, real since, real wanted) {
    const real share = (real)0.25;
    real reach = share * sk_max(touch->thickness, sk_length(sk_sub(step, touch->drift)));
    reach = sk_max(reach, sk_min(wanted, touch->thickness));
    return (sk_course){at, step, since, reach};
}

bool sk_touch_renew(sk_touch *touch, sk_allocator *allocator, sk_touch_search_sort search) {
    if (!sk_touch_search(touch, allocator, search)) return false;
    for (int sort = 0; sort < SK_PAIR_SORTS && search != SK_SEARCH_WAYS; sort++)
        sk_closest[sort][touch->isa](touch->p, &touch->kept[sort]);
    return true;
}

/* The places before the substep; returns whether a vertex is lost. */
static bool load_places(sk_touch *touch, const sk_run *run, const sk_op *op) {
    bool any = false;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        sk_vec4 x = sk_load(run->vector[SK_X], op->packed, run->slot_of[touch->skin.particle[v]]);
        touch->inverse[v] = x.w;
        touch->p[v] = x;
        any |= touch->lost[v] = touch->astray[v] | sk_is_lost(&touch->course[v], touch->now, sk_xyz(x));
        touch->astray[v] = 0;
    }
    return any;
}

enum { FEW = 50 }; /* one in so many */

/* Courses of lost vertices, or of all: as their velocities are. */
static void set_courses(sk_touch *touch, const sk_run *run, const sk_op *op, bool all) {
    // where few are lost, these are what shivers: wider reaches for them cost less than a search in each substep
    size_t count = touch->skin.vertex_count, lost = 0;
    for (size_t v = 0; v < count; v++) lost += touch->lost[v];
    bool few = !all && FEW * lost < count;
    for (size_t v = 0; v < count; v++) {
        if (!all && !touch->lost[v]) continue;
        sk_vec4 velocity = sk_load(run->vector[SK_V], op->packed, run->slot_of[touch->skin.particle[v]]);
        sk_vec3 step = sk_scale((real)op->dt, sk_xyz(velocity));
        if (!(sk_dot(step, step) < (real)1e12)) step = (sk_vec3){0, 0, 0}; // blown up
        touch->course[v] = course_from(touch, sk_xyz(touch->p[v]), step, all ? 0 : touch->now, few ? 2 * touch->course[v].reach : 0);
    }
}

/* Keeps those that are near. */
static bool find_near(sk_touch *touch, sk_allocator *allocator, int sort) {
    const sk_pairs *kept = &touch->kept[sort];
    sk_pairs *near = &touch->near[sort];
    near->count = 0;
    if (!sk_pairs_reserve(near, allocator, kept->count)) return false;
    for (size_t k = 0; k < kept->count; k++) {
        if (!(kept->distance[k] < SK_NEAR_THICKNESSES * kept->thickness[k])) continue;
        size_t to = near->count;
        sk_pairs_copy(near, kept, k);
        for (int c = 0; c < 3; c++) near->normal[c][to] = kept->normal[c][k];
        for (int c = 0; c < 2; c++) near->share[c][to] = kept->share[c][k];
    }
    return true;
}

static void begin(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = touch_of(op);
    real thickness = (real)params_of(op)->thickness;
    if (!touch || !touch->skin.vertex_count) return;
    touch->now += 1;
    bool all = !touch->found || touch->thickness < thickness || touch->thickness > thickness ||
               touch->now + 1 > touch->until;
    touch->thickness = thickness;
    bool lost = load_places(touch, run, op), good = true;
    if (lost || all) {
        set_courses(touch, run, op, all);
        good = sk_touch_renew(touch, run->allocator, all ? SK_SEARCH_ALL : SK_SEARCH_LOST);
    } else {
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) sk_closest[sort][touch->isa](touch->p, &touch->kept[sort]);
    }
    for (int sort = 0; sort < SK_PAIR_SORTS && good; sort++) good = find_near(touch, run->allocator, sort);
    run->no_memory |= !good;
}

/* ---- push ---- */

/* Pushes a pair apart to the distance that it is to have, and rubs it by what that took. */
static void push_pair(sk_touch *touch, const sk_pairs *near, int sort, size_t k, real gain, real friction) {
    real weight[4], resist = 0;
    const real *inverse = touch->inverse;
    const sk_vec4 *p = touch->p;
    sk_vec4 *q = touch->q;
    sk_weights_of(near, sort, k, weight);
    sk_vec3 apart = {0, 0, 0}, before = {0, 0, 0}, n = {near->normal[0][k], near->normal[1][k], near->normal[2][k]};
    for (int c = 0; c < 4; c++) {
        uint32_t v = near->corner[c][k];
        apart = sk_add(apart, sk_scale(weight[c], sk_xyz(q[v])));
        before = sk_add(before, sk_scale(weight[c], sk_xyz(p[v])));
        resist += weight[c] * weight[c] * inverse[v];
    }
    // what has come too near in some other way gets its thickness back over some substeps, not as a blow
    real wanted = sk_min(near->thickness[k], near->distance[k] + gain), missing = wanted - sk_dot(n, apart);
    if (!(missing > 0) || !(resist > 0)) return;
    sk_vec3 slip = sk_sub(apart, before);
    slip = sk_sub(slip, sk_scale(sk_dot(slip, n), n));
    real length = sk_length(slip), rub = friction * missing;
    real share = length > rub ? rub / length : 1;
    sk_vec3 move = sk_sub(sk_scale(missing / resist, n), sk_scale(friction > 0 ? share / resist : 0, slip));
    for (int c = 0; c < 4; c++) {
        uint32_t v = near->corner[c][k];
        sk_accumulate(&q[v], sk_scale(weight[c] * inverse[v], move));
        q[v].w = 1; // moved
    }
}

static void push(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = touch_of(op);
    const sk_contact_params *params = params_of(op);
    if (!touch || !(touch->near[SK_CORNERS].count + touch->near[SK_EDGES].count)) return;
    const uint32_t *particle = touch->skin.particle;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        touch->q[v] = sk_load(run->vector[SK_X], op->packed, run->slot_of[particle[v]]);
        touch->q[v].w = 0;
    }
    const real gain = (real)(60 * op->dt * params->thickness); // a thickness in a sixtieth of a second
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t k = 0; k < touch->near[sort].count; k++)
            push_pair(touch, &touch->near[sort], sort, k, gain, (real)params->friction);
    const real rate = (real)(1 / op->dt);
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        if (!(touch->q[v].w > 0)) continue;
        size_t slot = run->slot_of[particle[v]];
        sk_vec3 old = sk_xyz(sk_load(run->vector[SK_X], op->packed, slot)), now = sk_xyz(touch->q[v]);
        sk_store_at(run->vector[SK_X], op->packed, slot, now);
        if (op->source[1] != SK_NONE)
            sk_add_at(run->vector[op->source[1]], op->packed, slot, sk_scale(rate, sk_sub(now, old)));
    }
}

/* ---- the kind ---- */

static void release_vertices(sk_touch *touch, sk_allocator *allocator) {
    void **arrays[] = {(void **)&touch->p,          (void **)&touch->q,          (void **)&touch->way,
                       (void **)&touch->step,       (void **)&touch->at,         (void **)&touch->in_the_end,
                       (void **)&touch->course,     (void **)&touch->inverse,    (void **)&touch->share,
                       (void **)&touch->next_share, (void **)&touch->lost,       (void **)&touch->astray,      (void **)&touch->vertex_box, (void **)&touch->corner_box, (void **)&touch->lowered,
                       (void **)&touch->edge_box,   (void **)&touch->triangle_box, (void **)&touch->leaf_box,
                       (void **)&touch->anew,       (void **)&touch->changed,      (void **)&touch->start,      (void **)&touch->hit};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        sk_release(allocator, *arrays[i]);
        *arrays[i] = NULL;
    }
    sk_tree_release(&touch->tree, allocator);
}

static bool make_vertices(sk_touch *touch, sk_allocator *allocator) {
    const sk_skin *skin = &touch->skin;
    size_t count = skin->vertex_count + 1, leaves = skin->leaf_count + SK_TREE_WIDTH;
    touch->p = sk_allocate(allocator, count * sizeof *touch->p);
    touch->q = sk_allocate(allocator, count * sizeof *touch->q);
    touch->way = sk_allocate(allocator, count * sizeof *touch->way);
    touch->step = sk_allocate(allocator, count * sizeof *touch->step);
    touch->at = sk_allocate(allocator, count * sizeof *touch->at);
    touch->in_the_end = sk_allocate(allocator, count * sizeof *touch->in_the_end);
    touch->course = sk_allocate(allocator, count * sizeof *touch->course);
    touch->inverse = sk_allocate(allocator, count * sizeof *touch->inverse);
    touch->share = sk_allocate(allocator, count * sizeof *touch->share);
    touch->next_share = sk_allocate(allocator, count * sizeof *touch->next_share);
    touch->lost = sk_allocate(allocator, count * sizeof *touch->lost);
    touch->astray = sk_allocate(allocator, count * sizeof *touch->astray);
    touch->lowered = sk_allocate(allocator, count * sizeof *touch->lowered);
    touch->corner_box = sk_allocate(allocator, count * sizeof *touch->corner_box);
    touch->vertex_box = sk_allocate(allocator, count * sizeof *touch->vertex_box);
    touch->edge_box = sk_allocate(allocator, (skin->edge_count + 1) * sizeof *touch->edge_box);
    touch->triangle_box = sk_allocate(allocator, (skin->triangle_count + 1) * sizeof *touch->triangle_box);
    touch->leaf_box = sk_allocate(allocator, leaves * sizeof *touch->leaf_box);
    touch->anew = sk_allocate(allocator, leaves * sizeof *touch->anew);
    touch->changed = sk_allocate(allocator, leaves * sizeof *touch->changed);
    touch->start = sk_allocate(allocator, leaves * sizeof *touch->start);
    touch->hit = sk_allocate(allocator, leaves * sizeof *touch->hit);
    return touch->p && touch->q && touch->way && touch->step && touch->at && touch->in_the_end && touch->course &&
           touch->inverse && touch->share && touch->next_share && touch->lost && touch->astray && touch->lowered && touch->corner_box && touch->vertex_box &&
           touch->edge_box && touch->triangle_box && touch->leaf_box && touch->anew && touch->changed && touch->start && touch->hit &&
           sk_tree_make(&touch->tree, allocator, skin);
}

static void release(sk_force *force, sk_allocator *allocator) {
    sk_touch *touch = force->state;
    if (!touch) return;
    release_vertices(touch, allocator);
    sk_skin_release(&touch->skin, allocator);
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        sk_pairs_release(&touch->kept[sort], allocator);
        sk_pairs_release(&touch->near[sort], allocator);
    }
    sk_pairs_release(&touch->fresh, allocator);
    sk_pairs_release(&touch->merged, allocator);
    sk_release(allocator, touch->first.data);
    sk_release(allocator, touch->second.data);
    sk_release(allocator, touch->partner.data);
    sk_release(allocator, touch);
    force->state = NULL;
}

/* Another world, or the same with others in it, has another number. */
static uint64_t shape_of(const sk_force *force, uint64_t arrangement) {
    uint64_t shape = arrangement * 2 + force->only.some;
    for (size_t i = 0; i < force->only.count; i++)
        shape = (shape ^ force->only.data[i].first) * 0x100000001b3u ^ force->only.data[i].end;
    return shape;
}

static bool prepare(sk_force *force, sk_allocator *allocator, const sk_particles *particles,
                    const sk_meeting_parts *parts, sk_isa isa) {
    sk_touch *touch = force->state;
    if (!touch && !(touch = force->state = sk_allocate(allocator, sizeof *touch))) return false;
    touch->isa = isa;
    uint64_t shape = shape_of(force, parts->arrangement);
    if (touch->p && touch->shape == shape) return true;
    release_vertices(touch, allocator);
    touch->shape = shape;
    touch->found = touch->boxed = false;
    if (sk_skin_make(&touch->skin, allocator, particles, &force->only, parts) && make_vertices(touch, allocator))
        return true;
    release(force, allocator);
    return false;
}

static bool gave_up(sk_force *force) {
    sk_touch *touch = force->state;
    bool tells = touch && touch->given_up && !touch->told;
    if (tells) touch->told = true;
    return tells;
}

static const sk_meeting meeting = {
    .begin = {SK_ANY_ISA(begin)},
    .push = {SK_ANY_ISA(push)},
    .bound = {SK_ANY_ISA(sk_touch_bound)},
    .prepare = prepare,
    .release = release,
    .crossings = sk_touch_crossings,
    .gave_up = gave_up,
};

const sk_force_type sk_surface_contact = {
    .kind = {"contact", "surfaces and ropes neither pass through each other nor through themselves", SKEIN_FORCE,
             fields, sizeof fields / sizeof *fields, sizeof(sk_contact_params)},
    .domain = SK_OVER_PARTICLES,
    .phase = SK_MEETS,
    .passive = true,
    .meeting = &meeting,
};
