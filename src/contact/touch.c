/* The rule of contact: its fields, and the first two of its rows. */
#include "contact/touch.h"

#include <string.h>

static const skein_field fields[] = {
    SK_REAL(sk_contact_params, thickness, "thickness", "m", 0.005, 1e-6, 1e3,
            "how near surfaces come to each other; less where a body's own vertices are nearer as it was built"),
    SK_REAL(sk_contact_params, friction, "friction", "", 0.3, 0, 10, "coefficient of friction between them"),
};

/* ---- begin ---- */

static const sk_contact_params *params_of(const sk_row *row) {
    return ((const sk_force *)row->rule)->params;
}

static sk_touch *touch_of(const sk_row *row) {
    return ((const sk_force *)row->rule)->state;
}

bool sk_touch_renew(sk_touch *touch, sk_allocator *allocator, real thickness) {
    const real least = (real)0.25 * thickness, ahead = (real)2.5; // substeps that a reach is to last
    for (size_t v = 0; v < touch->skin.vertex_count; v++) touch->reach[v] = sk_max(least, ahead * touch->way[v].w);
    touch->thickness = thickness;
    return sk_touch_search(touch, allocator, thickness, SK_NEAR_THICKNESSES * thickness);
}

/* How far vertices will go in a substep, beside what all do together. */
static void guess_ways(sk_touch *touch, const sk_run *run, const sk_row *row) {
    const sk_skin *skin = &touch->skin;
    double sum[3] = {0, 0, 0};
    for (size_t v = 0; v < skin->vertex_count; v++) {
        sk_vec4 velocity = sk_load(run->vector[SK_V], row->packed, run->slot_of[skin->particle[v]]);
        touch->way[v] = velocity;
        sum[0] += (double)velocity.x, sum[1] += (double)velocity.y, sum[2] += (double)velocity.z;
    }
    double share = 1 / (double)skin->vertex_count;
    sk_vec3 mean = {(real)(share * sum[0]), (real)(share * sum[1]), (real)(share * sum[2])};
    for (size_t v = 0; v < skin->vertex_count; v++) {
        real way = (real)row->dt * sk_length(sk_sub(sk_xyz(touch->way[v]), mean));
        touch->way[v].w = way < (real)1e3 ? way : 0;
    }
}

/* The places before the substep; returns whether a vertex has left its reach. */
static bool load_places(sk_touch *touch, const sk_run *run, const sk_row *row) {
    bool left = false;
    touch->most_moved = 0;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        sk_vec4 x = sk_load(run->vector[SK_X], row->packed, run->slot_of[touch->skin.particle[v]]);
        touch->inverse[v] = x.w;
        x.w = sk_length(sk_sub(sk_xyz(x), sk_xyz(touch->s[v])));
        left |= x.w > touch->reach[v];
        touch->most_moved = sk_max(touch->most_moved, x.w);
        touch->p[v] = x;
    }
    return left;
}

/* Looks closely at pairs that may be near, and keeps those that are. */
static bool find_near(sk_touch *touch, sk_allocator *allocator, int sort) {
    const sk_pairs *kept = &touch->kept[sort];
    sk_pairs *near = &touch->near[sort];
    near->count = 0;
    if (!sk_pairs_reserve(near, allocator, kept->count)) return false;
    for (size_t k = 0; k < kept->count; k++) {
        real most[2], limit = SK_NEAR_THICKNESSES * kept->thickness[k];
        if (kept->distance[k] - 2 * touch->most_moved >= limit) continue;
        sk_most_of_features(kept, sort, k, touch->p, most);
        if (kept->distance[k] - most[0] - most[1] < limit) sk_pairs_copy(near, kept, k);
    }
    sk_pairs_pad(near);
    sk_closest[sort][touch->isa](touch->p, near);
    size_t count = near->count;
    near->count = 0;
    for (size_t k = 0; k < count; k++) {
        if (!(near->distance[k] < SK_NEAR_THICKNESSES * near->thickness[k])) continue;
        size_t to = near->count;
        sk_pairs_copy(near, near, k);
        for (int c = 0; c < 3; c++) near->normal[c][to] = near->normal[c][k];
        for (int c = 0; c < 2; c++) near->share[c][to] = near->share[c][k];
    }
    return true;
}

static void begin(sk_run *run, const sk_row *row, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = touch_of(row);
    real thickness = (real)params_of(row)->thickness;
    if (!touch || !touch->skin.vertex_count) return;
    bool left = load_places(touch, run, row), good = true;
    if (left || !touch->found || touch->thickness < thickness || touch->thickness > thickness) {
        guess_ways(touch, run, row);
        good = sk_touch_renew(touch, run->allocator, thickness);
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

static void push(sk_run *run, const sk_row *row, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = touch_of(row);
    const sk_contact_params *params = params_of(row);
    if (!touch || !(touch->near[SK_CORNERS].count + touch->near[SK_EDGES].count)) return;
    const uint32_t *particle = touch->skin.particle;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        touch->q[v] = sk_load(run->vector[SK_X], row->packed, run->slot_of[particle[v]]);
        touch->q[v].w = 0;
    }
    const real gain = (real)(60 * row->dt * params->thickness); // a thickness in a sixtieth of a second
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t k = 0; k < touch->near[sort].count; k++)
            push_pair(touch, &touch->near[sort], sort, k, gain, (real)params->friction);
    const real rate = (real)(1 / row->dt);
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        if (!(touch->q[v].w > 0)) continue;
        size_t slot = run->slot_of[particle[v]];
        sk_vec3 old = sk_xyz(sk_load(run->vector[SK_X], row->packed, slot)), now = sk_xyz(touch->q[v]);
        sk_store_at(run->vector[SK_X], row->packed, slot, now);
        if (row->source[1] != SK_NONE)
            sk_add_at(run->vector[row->source[1]], row->packed, slot, sk_scale(rate, sk_sub(now, old)));
    }
}

/* ---- the kind ---- */

static void release_vertices(sk_touch *touch, sk_allocator *allocator) {
    void *arrays[] = {touch->p,        touch->q,          touch->way,      touch->s,    touch->reach,
                      touch->inverse,  touch->share,      touch->next_share, touch->vertex_box, touch->edge_box,
                      touch->triangle_box, touch->leaf_box, touch->sorted_box, touch->cell, touch->item};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    touch->p = touch->q = touch->way = touch->s = NULL;
    touch->reach = touch->inverse = touch->share = touch->next_share = NULL;
    touch->vertex_box = touch->edge_box = touch->triangle_box = touch->leaf_box = touch->sorted_box = NULL;
    touch->cell = touch->item = NULL;
}

static bool make_vertices(sk_touch *touch, sk_allocator *allocator) {
    const sk_skin *skin = &touch->skin;
    size_t count = skin->vertex_count + 1, leaves = skin->leaf_count + 1;
    touch->p = sk_allocate(allocator, count * sizeof *touch->p);
    touch->q = sk_allocate(allocator, count * sizeof *touch->q);
    touch->way = sk_allocate(allocator, count * sizeof *touch->way);
    touch->s = sk_allocate(allocator, count * sizeof *touch->s);
    touch->reach = sk_allocate(allocator, count * sizeof *touch->reach);
    touch->inverse = sk_allocate(allocator, count * sizeof *touch->inverse);
    touch->share = sk_allocate(allocator, count * sizeof *touch->share);
    touch->next_share = sk_allocate(allocator, count * sizeof *touch->next_share);
    touch->vertex_box = sk_allocate(allocator, count * sizeof *touch->vertex_box);
    touch->edge_box = sk_allocate(allocator, (skin->edge_count + 1) * sizeof *touch->edge_box);
    touch->triangle_box = sk_allocate(allocator, (skin->triangle_count + 1) * sizeof *touch->triangle_box);
    touch->leaf_box = sk_allocate(allocator, leaves * sizeof *touch->leaf_box);
    touch->sorted_box = sk_allocate(allocator, leaves * sizeof *touch->sorted_box);
    touch->cell = sk_allocate(allocator, leaves * sizeof *touch->cell);
    touch->item = sk_allocate(allocator, leaves * sizeof *touch->item);
    return touch->p && touch->q && touch->way && touch->s && touch->reach && touch->inverse && touch->share &&
           touch->next_share && touch->vertex_box && touch->edge_box && touch->triangle_box && touch->leaf_box &&
           touch->sorted_box && touch->cell && touch->item;
}

static void release(sk_force *force, sk_allocator *allocator) {
    sk_touch *touch = force->state;
    if (!touch) return;
    release_vertices(touch, allocator);
    sk_skin_release(&touch->skin, allocator);
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        sk_pairs_release(&touch->kept[sort], allocator);
        sk_pairs_release(&touch->near[sort], allocator);
        sk_pairs_release(&touch->closing[sort], allocator);
    }
    sk_pairs_release(&touch->rest, allocator);
    sk_release(allocator, touch->start);
    sk_release(allocator, touch->list.data);
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
    touch->found = false;
    if (sk_skin_make(&touch->skin, allocator, particles, &force->only, parts) && make_vertices(touch, allocator))
        return true;
    release(force, allocator);
    return false;
}

static const sk_meeting meeting = {
    .begin = {SK_ANY_ISA(begin)},
    .push = {SK_ANY_ISA(push)},
    .bound = {SK_ANY_ISA(sk_touch_bound)},
    .prepare = prepare,
    .release = release,
    .crossings = sk_touch_crossings,
};

const sk_force_type sk_surface_contact = {
    .kind = {"contact", "surfaces and ropes neither pass through each other nor through themselves", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(sk_contact_params)},
    .domain = SK_OVER_PARTICLES,
    .deed = SK_MEETS,
    .passive = true,
    .meeting = &meeting,
};
