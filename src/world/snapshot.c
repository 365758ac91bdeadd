/* Snapshots: all that steps and calls have changed in a world since it was built, as bytes.
 *
 *   head       "skeinsnp", version, bytes of a real, size of all, sum of what follows, how long the last substep was
 *   clock      time, steps and what they have counted
 *   method     its kind and fields
 *   objects    each one's kind, fields and what it was built of (a hash); of a collider the way that it is on
 *   particles  held or not, position, velocity, and the position before the last step, in the user's order
 *   pins       places that wait for the next step
 *   cuts       from version 2 on: how many bodies are cut, and of each its place among the objects and the faces
 *   rests      from version 3 on: of how many bodies it is known that they rest, and of each its place among the objects,
 *              whether it sleeps or is to wake, for how long it has been still, from where on, and beside whom; before these,
 *              whether all are to wake
 *   surfaces   from version 4 on: of how many colliders a program leads the vertices, and of each its place among the objects, where
 *              they are, and where they are to go in the next step
 *   easings    from version 5 on: of how many rules of contact a thickness is still eased, and of each its place among
 *              the objects, how much was missing and since when; from version 6 on also from which to which particle that is still to be found out
 *
 * What was built stays the world's: meshes, constraints and masses are compared by their hashes, and a world that is
 * built otherwise refuses the snapshot. A reader looks through all of it before it changes anything, and allocates
 * nothing by what it says. Everything else that a world has is made from these (the plan, slots, sweeps, contact's
 * pairs): no bit of a step depends on how long it has been there. */
#include "colliders/trimesh.h"
#include "world/cut.h"
#include "world/record.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static const char magic[8] = {'s', 'k', 'e', 'i', 'n', 's', 'n', 'p'};
enum { AT_SIZE = 16, AT_SUM = 24, AT_SUBSTEP = 32 };

/* ---- values ---- */

void sk_put_value(sk_byte_writer *w, const skein_value *value) {
    sk_put_u8(w, (unsigned)value->count);
    for (int k = 0; k < value->count && k < 3; k++) sk_put_f64(w, value->number[k]);
    if (!value->count) sk_put_text(w, value->text ? value->text : "");
}

skein_value sk_take_value(sk_byte_reader *r) {
    skein_value value = {.count = (int)sk_take_u8(r)};
    if (value.count > 3) r->short_ = true, value.count = 0;
    for (int k = 0; k < value.count; k++) value.number[k] = sk_take_f64(r);
    if (!value.count) value.text = sk_take_text(r);
    return value;
}

/* ---- what an object was built of ---- */

static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t size) {
    return sk_hash_word(hash, bytes && size ? sk_byte_sum(bytes, size) : 0);
}

static uint64_t hash_batch(uint64_t hash, const sk_batch *batch) {
    const bool all = batch->whole.count != 0;
    size_t count = all ? batch->whole.count : batch->count;
    const real *scale = all ? batch->whole.scale : batch->scale;
    hash = hash_bytes(hash, batch->type->kind.name, strlen(batch->type->kind.name));
    hash = hash_bytes(hash, all ? batch->whole.particle : batch->particle, count * batch->arity * sizeof(uint32_t));
    hash = hash_bytes(hash, all ? batch->whole.rest : batch->rest, count * batch->rest_count * sizeof(real));
    return scale ? hash_bytes(hash, scale, count * sizeof *scale) : hash;
}

static uint64_t hash_object(const skein_world *world, const sk_object *object) {
    const sk_particles *all = &world->particles;
    uint64_t hash = SK_HASH_START;
    if (object->category == SKEIN_CONSTRAINT) return hash_batch(hash, object->as.batch);
    if (object->category == SKEIN_MOTION) {
        const sk_track *t = &object->as.motion->track;
        hash = hash_bytes(hash, t->particles, t->particle_count * sizeof *t->particles);
        return hash_bytes(hash, t->places, t->particle_count * t->sample_count * sizeof *t->places);
    }
    if (object->category != SKEIN_BODY) return hash;
    const sk_body *body = object->as.body;
    size_t first = body->first_particle, count = body->particle_count;
    hash = sk_hash_word(sk_hash_word(hash, first), count);
    hash = hash_bytes(hash, all->mass + first, count * sizeof *all->mass);
    hash = hash_bytes(hash, all->built + first, count * sizeof *all->built);
    hash = hash_bytes(hash, sk_built_triangles(world, body), body->triangle_count * sizeof *world->triangles.corner);
    for (size_t i = 0; i < body->batch_count; i++) hash = hash_batch(hash, body->batch[i]);
    return hash;
}

/* What is no object's: loose particles, and tethers; not those to who is pinned now, which follow from that. */
static uint64_t hash_rest(const skein_world *world) {
    const sk_particles *all = &world->particles;
    uint64_t hash = hash_bytes(SK_HASH_START, all->mass, all->count * sizeof *all->mass);
    for (size_t i = 0; i < world->rules.limits.count; i++) {
        const sk_limit *limit = world->rules.limits.data[i];
        if (limit->late) continue;
        hash = hash_bytes(hash, limit->particle, limit->count * (1 + limit->anchors) * sizeof *limit->particle);
        hash = hash_bytes(hash, limit->length, limit->count * limit->anchors * sizeof *limit->length);
    }
    return hash;
}

/* ---- writing ---- */

/* The fields of an object (NULL: the method), one after the other: its kind's own, then those that its category shares.
 * NULL past the end. What stands for an object's own parameters is none of its own. */
static const skein_field *field_at(const skein_world *world, const sk_object *object, size_t index,
                                   const void **params) {
    const skein_kind *kind = object ? object->kind : &world->method->kind;
    size_t common_count;
    const skein_field *common = sk_common_fields(kind->category, &common_count);
    *params = object ? object->params : world->method_params;
    if (index < kind->field_count) return &kind->fields[index];
    if (!object || index - kind->field_count >= common_count) return NULL;
    *params = &object->common;
    return &common[index - kind->field_count];
}

static bool is_pattern(const skein_field *field) {
    size_t length = strlen(field->name);
    return length > 1 && field->name[length - 1] == '*';
}

static void put_fields(sk_byte_writer *w, const skein_world *world, const sk_object *object) {
    const void *params;
    const skein_field *field;
    for (size_t i = 0; (field = field_at(world, object, i, &params)); i++) {
        if (is_pattern(field)) continue;
        skein_value value = sk_field_load(field, params);
        sk_put_text(w, field->name);
        sk_put_value(w, &value);
    }
    sk_put_text(w, "");
}

/* The numbers of a way, for writing and for reading. */
enum { TRAVEL_NUMBERS = 3 + 9 + 3 + 15 + 3 + 3 + 3 };
static void travel_numbers(sk_travel *t, double *number[TRAVEL_NUMBERS]) {
    size_t n = 0;
    for (int k = 0; k < 3; k++) number[n++] = &t->position[k];
    for (int k = 0; k < 9; k++) number[n++] = &t->rotation[k];
    for (int k = 0; k < 3; k++) number[n++] = &t->direction[k];
    for (int k = 0; k < 15; k++) number[n++] = &t->own[k];
    for (int k = 0; k < 3; k++) number[n++] = &t->way[k];
    for (int k = 0; k < 3; k++) number[n++] = &t->axis[k];
    number[n++] = &t->angle, number[n++] = &t->start, number[n] = &t->dt;
}

static void put_travel(sk_byte_writer *w, const sk_travel *travel) {
    sk_travel copy = *travel;
    double *number[TRAVEL_NUMBERS];
    travel_numbers(&copy, number);
    sk_put_u8(w, (copy.noted ? 1u : 0u) | (copy.changed ? 2u : 0u) | (copy.ever ? 4u : 0u) | (copy.moving ? 8u : 0u));
    for (size_t i = 0; i < TRAVEL_NUMBERS; i++) sk_put_f64(w, *number[i]);
}

static void put_clock(sk_byte_writer *w, const skein_world *world) {
    const sk_solve *solve = &world->solve;
    sk_put_f64(w, world->time);
    sk_put_u64(w, world->steps);
    sk_put_u64(w, world->particles.count);
    sk_put_u64(w, world->objects.count);
    sk_put_u64(w, world->substeps);
    sk_put_u64(w, world->unsolved);
    sk_put_u64(w, world->solver_failures);
    sk_put_f64(w, world->first_energy);
    sk_put_f64(w, solve->residual);
    const uint64_t counts[] = {solve->unsolved, solve->newton_iterations, solve->iterations, solve->factors,
                               solve->failures};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) sk_put_u64(w, counts[i]);
}

static void put_vector(sk_byte_writer *w, const skein_world *world, sk_vector vector) {
    const sk_particles *all = &world->particles;
    for (size_t i = 0; i < all->count; i++) {
        const sk_vec4 *p = &all->vector[vector][all->slot_of[i]];
        sk_put_real(w, p->x), sk_put_real(w, p->y), sk_put_real(w, p->z);
    }
}

static bool is_cut(const sk_object *object) {
    return object->category == SKEIN_BODY && object->as.body->cut && object->as.body->cut->count;
}

static uint32_t count_cut(const skein_world *world) {
    uint32_t count = 0;
    for (size_t i = 0; i < world->objects.count; i++) count += is_cut(world->objects.data[i]);
    return count;
}

static void put_cuts(sk_byte_writer *w, const skein_world *world) {
    sk_put_u32(w, count_cut(world));
    for (size_t i = 0; i < world->objects.count; i++) {
        if (!is_cut(world->objects.data[i])) continue;
        sk_put_u32(w, (uint32_t)i);
        sk_put_cut(w, world->objects.data[i]->as.body);
    }
}

/* What is known of a body's rest: bits. */
enum { SLEEPS = 1, IS_ROUSED = 2, HAS_PLACES = 4 };

static unsigned rest_of(const sk_object *object) {
    if (object->category != SKEIN_BODY) return 0;
    const sk_body *body = object->as.body;
    return (body->rest.asleep ? SLEEPS : 0) | (body->rest.roused ? IS_ROUSED : 0) | (body->rest.from ? HAS_PLACES : 0);
}

static uint32_t count_resting(const skein_world *world) {
    uint32_t count = 0;
    for (size_t i = 0; i < world->objects.count; i++) count += rest_of(world->objects.data[i]) != 0;
    return count;
}

static void put_rests(sk_byte_writer *w, const skein_world *world) {
    sk_put_u8(w, world->roused);
    sk_put_u32(w, count_resting(world));
    for (size_t i = 0; i < world->objects.count; i++) {
        const unsigned rest = rest_of(world->objects.data[i]);
        if (!rest) continue;
        const sk_body *body = world->objects.data[i]->as.body;
        sk_put_u32(w, (uint32_t)i);
        sk_put_u8(w, rest);
        sk_put_f64(w, body->rest.still);
        sk_put_u64(w, body->rest.near);
        for (int k = 0; k < 3 && body->rest.roused; k++)
            sk_put_real(w, body->rest.low[k]), sk_put_real(w, body->rest.high[k]);
        for (size_t k = 0; k < body->particle_count && body->rest.from; k++)
            sk_put_real(w, body->rest.from[k].x), sk_put_real(w, body->rest.from[k].y),
                sk_put_real(w, body->rest.from[k].z);
    }
}

/* The surface of an object that is a collider whose vertices a program may lead, else NULL. */
static sk_trimesh *surface_of(const sk_object *object) {
    if (object->category != SKEIN_COLLIDER) return NULL;
    const sk_collider *collider = object->as.collider;
    return collider->type->surface && collider->type->begin ? collider->type->surface(collider->params) : NULL;
}

static uint32_t count_led(const skein_world *world) {
    uint32_t count = 0;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_trimesh *m = surface_of(world->objects.data[i]);
        count += m && m->led;
    }
    return count;
}

/* Where they are now that the step is over. */
static void put_surfaces(sk_byte_writer *w, const skein_world *world) {
    sk_put_u32(w, count_led(world));
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_trimesh *m = surface_of(world->objects.data[i]);
        if (!m || !m->led) continue;
        sk_put_u32(w, (uint32_t)i);
        sk_put_u64(w, m->vertex_count), sk_put_u64(w, m->leads ? m->given_count : 0);
        for (size_t v = 0; v < m->vertex_count; v++) {
            const sk_vec3 place = sk_trimesh_place(m, v, world->time);
            sk_put_real(w, place.x), sk_put_real(w, place.y), sk_put_real(w, place.z);
        }
        for (size_t k = 0; k < 3 * m->given_count && m->leads; k++) sk_put_f64(w, m->led[k]);
    }
}

static bool is_eased(const skein_world *world, const sk_object *object) {
    if (object->category != SKEIN_FORCE || !object->as.force->type->meeting) return false;
    const sk_easing *easing = &object->as.force->easing;
    return easing->asks < easing->asks_end || sk_easing_left(easing, world->time) > 0;
}

/* Whether of any it is still to be found out how much is missing. */
static bool any_asks(const skein_world *world) {
    bool any = false;
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        const sk_easing *easing = &world->rules.forces.data[i]->easing;
        any |= world->rules.forces.data[i]->type->meeting && easing->asks < easing->asks_end;
    }
    return any;
}

static uint32_t count_eased(const skein_world *world) {
    uint32_t count = 0;
    for (size_t i = 0; i < world->objects.count; i++) count += is_eased(world, world->objects.data[i]);
    return count;
}

static void put_easings(sk_byte_writer *w, const skein_world *world, bool asks) {
    sk_put_u32(w, count_eased(world));
    for (size_t i = 0; i < world->objects.count; i++) {
        if (!is_eased(world, world->objects.data[i])) continue;
        const sk_easing *easing = &world->objects.data[i]->as.force->easing;
        sk_put_u32(w, (uint32_t)i);
        sk_put_f64(w, easing->less), sk_put_f64(w, easing->since);
        if (asks) sk_put_u32(w, easing->asks), sk_put_u32(w, easing->asks_end);
    }
}

/* As it is written: 0, here; 1, aside; 2, gone; those asleep are among the rests. */
static unsigned presence_of(const skein_world *world, size_t particle) {
    const unsigned presence = world->particles.presence[particle];
    return presence <= SK_ASLEEP ? 0 : presence == SK_ASIDE ? 1 : 2;
}

static void put_all(sk_byte_writer *w, const skein_world *world) {
    const bool any_eased = count_eased(world) > 0, any_led = any_eased || count_led(world) > 0,
               any_rests = any_led || count_resting(world) > 0;
    const bool any_cut = any_rests || count_cut(world) > 0;
    sk_put(w, magic, sizeof magic);
    const bool asks = any_asks(world);
    sk_put_u32(w, asks ? SK_SNAPSHOT_VERSION : any_eased ? 5 : any_led ? 4 : any_rests ? 3 : any_cut ? 2 : 1);
    sk_put_u32(w, sizeof(real));
    uint32_t substep;
    memcpy(&substep, &world->substep, sizeof substep);
    sk_put_u64(w, 0), sk_put_u64(w, 0), sk_put_u32(w, substep); // two are not known yet
    put_clock(w, world);
    sk_put_text(w, world->method->kind.name);
    put_fields(w, world, NULL);
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        sk_put_text(w, object->kind->name);
        sk_put_u8(w, (unsigned)object->category);
        sk_put_u64(w, hash_object(world, object));
        put_fields(w, world, object);
        if (object->category == SKEIN_COLLIDER) put_travel(w, &object->as.collider->travel);
    }
    sk_put_u64(w, hash_rest(world));
    for (size_t i = 0; i < world->particles.count; i++)
        sk_put_u8(w, (world->particles.pinned[i] ? 1u : 0u) | presence_of(world, i) << 1);
    static const sk_vector vectors[] = {SK_X, SK_V, SK_PREVIOUS};
    for (size_t v = 0; v < 3; v++) put_vector(w, world, vectors[v]);
    sk_put_u64(w, world->pins.count);
    for (size_t i = 0; i < world->pins.count; i++) {
        sk_put_u32(w, world->pins.data[i].particle);
        for (int k = 0; k < 3; k++) sk_put_f64(w, world->pins.data[i].place[k]);
    }
    if (any_cut) put_cuts(w, world);
    if (any_rests) put_rests(w, world);
    if (any_led) put_surfaces(w, world);
    if (any_eased) put_easings(w, world, asks);
}

void sk_snapshot_seal(unsigned char *bytes, size_t size) {
    sk_byte_writer w = {bytes, size, AT_SUM};
    sk_put_u64(&w, sk_byte_sum(bytes + SK_SNAPSHOT_HEAD, size - SK_SNAPSHOT_HEAD));
}

size_t skein_snapshot_size(const skein_world *world) {
    if (!world) return 0;
    sk_byte_writer w = {NULL, 0, 0};
    put_all(&w, world);
    return w.at;
}

skein_status skein_snapshot_write(const skein_world *world, void *out, size_t size, size_t *written) {
    SK_NEED(world, world);
    SK_NEED(world, out);
    skein_status status = sk_world_fetch(world);
    if (status) return status;
    sk_byte_writer w = {out, size, 0};
    put_all(&w, world);
    if (w.at > size)
        return sk_fail(sk_world_error(world), SKEIN_ERROR_LIMIT, "size",
                       "a snapshot of %zu bytes into room for %zu: skein_snapshot_size() says how many it takes", w.at,
                       size);
    sk_byte_writer head = {out, size, AT_SIZE};
    sk_put_u64(&head, w.at);
    sk_snapshot_seal(out, w.at);
    if (written) *written = w.at;
    return SKEIN_OK;
}

/* ---- reading ---- */

#define OTHER_WORLD "; read it into the world that it was taken of, or into one that is built in the same way"

static skein_status fail_short(skein_error *error) {
    return sk_fail(error, SKEIN_ERROR_SYNTAX, "",
                   "the snapshot is damaged: it ends before it should, or its parts do not fit");
}

static skein_status look(const void *bytes, size_t size, skein_snapshot_info *info, skein_error *error) {
    sk_byte_reader r = {bytes, size, 0, false};
    const unsigned char *word = sk_take(&r, sizeof magic);
    if (!word || memcmp(word, magic, sizeof magic) != 0)
        return sk_fail(error, SKEIN_ERROR_SYNTAX, "", "it is no snapshot of Skein's");
    *info = (skein_snapshot_info){.version = sk_take_u32(&r), .real_size = sk_take_u32(&r)};
    uint64_t whole = sk_take_u64(&r), sum = sk_take_u64(&r);
    sk_take_u32(&r);
    if (r.short_) return fail_short(error);
    if (info->version > SK_SNAPSHOT_VERSION)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "",
                       "a snapshot of version %" PRIu32 ", and Skein " SKEIN_VERSION
                       " reads version %d: take the Skein that wrote it, or a newer one",
                       info->version, SK_SNAPSHOT_VERSION);
    if (info->version < 1) return fail_short(error);
    if (whole > size || whole < SK_SNAPSHOT_HEAD)
        return sk_fail(error, SKEIN_ERROR_SYNTAX, "", "the snapshot is damaged: it has %zu bytes of %" PRIu64, size,
                       whole);
    info->size = (size_t)whole;
    if (sk_byte_sum(r.in + SK_SNAPSHOT_HEAD, info->size - SK_SNAPSHOT_HEAD) != sum)
        return sk_fail(error, SKEIN_ERROR_SYNTAX, "", "the snapshot is damaged: its sum is another");
    info->time = sk_take_f64(&r);
    info->steps = sk_take_u64(&r);
    info->particles = sk_take_u64(&r);
    info->objects = sk_take_u64(&r);
    return r.short_ ? fail_short(error) : SKEIN_OK;
}

skein_status skein_snapshot_look(const void *bytes, size_t size, skein_snapshot_info *info, skein_error *error) {
    if (!bytes) return sk_fail_null(error, "bytes");
    if (!info) return sk_fail_null(error, "info");
    return look(bytes, size, info, error);
}

/* Whether two texts name one file, seen from different folders: what was in it is compared by the object's hash. */
static bool is_same_file(const skein_field *field, const skein_value *a, const skein_value *b) {
    if (field->type != SKEIN_FIELD_TEXT || !a->text || !b->text) return false;
    const char *end_a = strrchr(a->text, '/'), *end_b = strrchr(b->text, '/');
    return (end_a || end_b) && !strcmp(end_a ? end_a + 1 : a->text, end_b ? end_b + 1 : b->text);
}

/* The fields of one object: compares those that are built in, and where `apply` is set sets the others. `failed` is the
 * first that could not be; a second pass may, when those beside it are set. */
static skein_status take_fields(sk_byte_reader *r, skein_world *world, sk_object *object, skein_handle handle,
                                bool apply, skein_error *error) {
    const char *label = object ? object->label : world->method->kind.name, *name;
    const void *params;
    const skein_field *field;
    size_t i = 0;
    skein_status status = SKEIN_OK;
    while ((name = sk_take_text(r)) && name[0]) {
        skein_value value = sk_take_value(r);
        if (r->short_) return fail_short(error);
        while ((field = field_at(world, object, i++, &params)) && is_pattern(field)) {}
        if (!field || strcmp(field->name, name) != 0)
            return sk_fail(error, SKEIN_ERROR_NAME, label,
                           "the snapshot has a field '%.60s' of it where this world has %s%s" OTHER_WORLD, name,
                           field ? "" : "none", field ? field->name : "");
        skein_value now = sk_field_load(field, params);
        bool track = object && object->category == SKEIN_MOTION && object->as.motion->type->given &&
                     !strcmp(object->as.motion->type->given, name); // a file: what was in it is compared
        if (track || sk_values_are_same(&value, &now)) continue;
        if (is_same_file(field, &value, &now) && !skein_field_is_live(world, handle, name)) continue;
        if (!apply) {
            char there[48], here[48];
            if ((status = skein_field_check(field, &value, error))) return status;
            if (skein_field_is_live(world, handle, name)) continue;
            skein_value_text(field, &value, there, sizeof there);
            skein_value_text(field, &now, here, sizeof here);
            return sk_fail(error, SKEIN_ERROR_VALUE, label, "its %s is %s in the snapshot, and %s here" OTHER_WORLD,
                           name, there, here);
        }
        skein_status set = skein_set(world, handle, name, value);
        if (set && !status) status = set;
    }
    if (r->short_ || !name) return fail_short(error);
    while ((field = field_at(world, object, i++, &params)))
        if (!is_pattern(field))
            return sk_fail(error, SKEIN_ERROR_NAME, label, "the snapshot knows no field '%s' of it" OTHER_WORLD,
                           field->name);
    return status;
}

/* Again while that helps: what one field may be can depend on another. */
static skein_status apply_fields(sk_byte_reader *r, skein_world *world, sk_object *object, skein_handle handle,
                                 bool apply, skein_error *error) {
    size_t at = r->at;
    skein_status status = take_fields(r, world, object, handle, apply, error);
    for (int pass = 0; apply && status && pass < 3; pass++) {
        r->at = at;
        status = take_fields(r, world, object, handle, true, error);
    }
    return status;
}

static skein_status take_travel(sk_byte_reader *r, sk_travel *travel, bool apply, skein_error *error) {
    sk_travel read = {0};
    double *number[TRAVEL_NUMBERS];
    unsigned flags = sk_take_u8(r);
    travel_numbers(&read, number);
    bool good = true;
    for (size_t i = 0; i < TRAVEL_NUMBERS; i++) {
        *number[i] = sk_take_f64(r);
        good = good && fabs(*number[i]) <= 1e16;
    }
    read.noted = flags & 1, read.changed = flags & 2, read.ever = flags & 4, read.moving = flags & 8;
    if (r->short_ || !good || flags > 15 || (read.moving && !(read.dt > 0))) return fail_short(error);
    if (apply) *travel = read;
    return SKEIN_OK;
}

static skein_status take_method(sk_byte_reader *r, skein_world *world, sk_set_method *set, bool apply,
                                skein_error *error) {
    const char *name = sk_take_text(r);
    if (!name) return fail_short(error);
    if (strcmp(name, world->method->kind.name) != 0) {
        if (!apply) { // its fields are those of another kind: they are looked at once it is set
            while ((name = sk_take_text(r)) && name[0]) sk_take_value(r);
            return r->short_ ? fail_short(error) : SKEIN_OK;
        }
        skein_status status = set(world, name, NULL);
        if (status) return status;
    }
    return apply_fields(r, world, NULL, skein_object_at(world, SKEIN_METHOD, 0), apply, error);
}

static skein_status take_object(sk_byte_reader *r, skein_world *world, size_t index, bool apply, skein_error *error) {
    sk_object *object = world->objects.data[index];
    const char *name = sk_take_text(r);
    unsigned category = sk_take_u8(r);
    uint64_t hash = sk_take_u64(r);
    if (r->short_ || !name) return fail_short(error);
    if (category != object->category || strcmp(name, object->kind->name) != 0)
        return sk_fail(error, SKEIN_ERROR_VALUE, object->label,
                       "object %zu is a %.60s in the snapshot, and a %s here" OTHER_WORLD, index, name,
                       object->kind->name);
    skein_status status = apply_fields(r, world, object, sk_handle_at(world, index), apply, error);
    if (!status && hash != hash_object(world, object))
        status = sk_fail(error, SKEIN_ERROR_VALUE, object->label,
                         "it has other particles, masses or constraints than in the snapshot" OTHER_WORLD);
    if (!status && object->category == SKEIN_COLLIDER)
        status = take_travel(r, &object->as.collider->travel, apply, error);
    return status;
}

static skein_status take_clock(sk_byte_reader *r, skein_world *world, bool apply, skein_error *error) {
    double time = sk_take_f64(r);
    uint64_t steps = sk_take_u64(r), particles = sk_take_u64(r), objects = sk_take_u64(r), substeps = sk_take_u64(r);
    uint64_t unsolved = sk_take_u64(r), failures = sk_take_u64(r);
    double first = sk_take_f64(r);
    sk_solve solve = {.residual = sk_take_f64(r)};
    size_t *const counts[] = {&solve.unsolved, &solve.newton_iterations, &solve.iterations, &solve.factors,
                              &solve.failures};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) *counts[i] = (size_t)sk_take_u64(r);
    if (r->short_ || !(time >= 0 && time <= SK_FAR)) return fail_short(error);
    if (particles != world->particles.count || objects != world->objects.count)
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "the snapshot has %" PRIu64 " particles and %" PRIu64
                       " objects, this world %zu and %zu" OTHER_WORLD,
                       particles, objects, world->particles.count, world->objects.count);
    if (!apply) return SKEIN_OK;
    world->time = time, world->steps = steps, world->substeps = substeps;
    world->unsolved = unsolved, world->solver_failures = failures, world->first_energy = first;
    world->solve = solve;
    return SKEIN_OK;
}

static skein_status take_particles(sk_byte_reader *r, skein_world *world, bool apply, skein_error *error) {
    sk_particles *all = &world->particles;
    if (sk_take_u64(r) != hash_rest(world))
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "the particles have other masses or tethers than in the snapshot" OTHER_WORLD);
    const unsigned char *flags = sk_take(r, all->count);
    if (apply) sk_particles_forget(all), world->pins_stale = true;
    static const sk_vector vectors[] = {SK_X, SK_V, SK_PREVIOUS};
    for (size_t i = 0; flags && i < all->count; i++) {
        if (flags[i] >> 1 > 2 || (flags[i] >> 1 == 2) != (all->presence[i] == SK_GONE))
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "particle %zu: whether its body is there differs" OTHER_WORLD,
                           i);
        if (apply) sk_particle_pin(all, i, flags[i] & 1);
    }
    for (size_t v = 0; v < 3; v++)
        for (size_t i = 0; i < all->count && !r->short_; i++) {
            real x = sk_take_real(r), y = sk_take_real(r), z = sk_take_real(r);
            if (!apply || all->presence[i] == SK_GONE) continue; // it has no place of its own
            sk_vec4 *p = &all->vector[vectors[v]][all->slot_of[i]];
            *p = (sk_vec4){x, y, z, p->w};
        }
    return r->short_ ? fail_short(error) : SKEIN_OK;
}

static skein_status take_pins(sk_byte_reader *r, skein_world *world, bool apply, skein_error *error) {
    uint64_t count = sk_take_u64(r);
    if (r->short_ || count > sk_left(r) / 28) return fail_short(error);
    if (apply && !SK_RESERVE(&world->allocator, &world->pins, (size_t)count))
        return sk_fail_memory(error, "places for pins");
    if (apply) world->pins.count = (size_t)count;
    for (size_t i = 0; i < count; i++) {
        sk_pin pin = {.particle = sk_take_u32(r)};
        bool good = pin.particle < world->particles.count;
        for (int k = 0; k < 3; k++) {
            pin.place[k] = sk_take_f64(r);
            good = good && fabs(pin.place[k]) <= SK_FAR;
        }
        if (!good) return fail_short(error);
        if (apply) world->pins.data[i] = pin;
    }
    return SKEIN_OK;
}

/* What is not cut in the snapshot is whole. */
static skein_status take_cuts(sk_byte_reader *r, skein_world *world, uint32_t version, bool apply, skein_error *error) {
    uint32_t count = version > 1 ? sk_take_u32(r) : 0, next = 0;
    for (size_t i = 0; i < world->objects.count && apply; i++)
        if (is_cut(world->objects.data[i])) sk_cut_set(world, world->objects.data[i]->as.body, NULL);
    for (uint32_t i = 0; i < count && !r->short_; i++) {
        uint32_t index = sk_take_u32(r);
        bool memory = true;
        if (r->short_ || index < next || index >= world->objects.count ||
            world->objects.data[index]->category != SKEIN_BODY)
            return fail_short(error);
        if (!sk_take_cut(r, world, world->objects.data[index], apply, &memory))
            return memory ? fail_short(error) : sk_fail_memory(error, "a cut");
        next = index + 1;
    }
    return r->short_ ? fail_short(error) : SKEIN_OK;
}

static skein_status take_rest(sk_byte_reader *r, skein_world *world, sk_body *body, bool apply, skein_error *error) {
    const unsigned rest = sk_take_u8(r);
    const double still = sk_take_f64(r);
    const uint64_t near = sk_take_u64(r);
    real low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    sk_vec3 *from = NULL;
    for (int k = 0; k < 3 && rest & IS_ROUSED; k++) low[k] = sk_take_real(r), high[k] = sk_take_real(r);
    if (r->short_ || rest > 7 || (rest & SLEEPS && rest & HAS_PLACES) || !(still >= 0 && still <= SK_FAR) ||
        (rest & HAS_PLACES && sk_left(r) / (3 * sizeof(real)) < body->particle_count))
        return fail_short(error);
    if (apply && rest & HAS_PLACES && !(from = sk_allocate(&world->allocator, body->particle_count * sizeof *from)))
        return sk_fail_memory(error, "places of rest");
    for (size_t k = 0; k < body->particle_count && rest & HAS_PLACES; k++) {
        const real x = sk_take_real(r), y = sk_take_real(r), z = sk_take_real(r);
        if (apply) from[k] = (sk_vec3){x, y, z};
    }
    if (!apply) return SKEIN_OK;
    if (rest & SLEEPS && body->enabled) sk_body_set_asleep(world, body, true);
    body->rest.roused = rest & IS_ROUSED;
    memcpy(body->rest.low, low, sizeof low), memcpy(body->rest.high, high, sizeof high);
    body->rest.from = from;
    body->rest.still = still;
    body->rest.near = near;
    return SKEIN_OK;
}

/* Of whom nothing is said nothing is known. */
static skein_status take_rests(sk_byte_reader *r, skein_world *world, uint32_t version, bool apply, skein_error *error) {
    const unsigned roused = version > 2 ? sk_take_u8(r) : 0;
    const uint32_t count = version > 2 ? sk_take_u32(r) : 0;
    uint32_t next = 0;
    if (roused > 1) return fail_short(error);
    if (apply) world->roused = roused;
    for (size_t i = 0; i < world->objects.count && apply; i++)
        if (world->objects.data[i]->category == SKEIN_BODY) sk_body_forget_rest(world, world->objects.data[i]->as.body);
    for (uint32_t i = 0; i < count && !r->short_; i++) {
        const uint32_t index = sk_take_u32(r);
        if (r->short_ || index < next || index >= world->objects.count ||
            world->objects.data[index]->category != SKEIN_BODY)
            return fail_short(error);
        skein_status status = take_rest(r, world, world->objects.data[index]->as.body, apply, error);
        if (status) return status;
        next = index + 1;
    }
    return r->short_ ? fail_short(error) : SKEIN_OK;
}

static skein_status take_surface(sk_byte_reader *r, skein_world *world, sk_trimesh *m, bool apply, skein_error *error) {
    const uint64_t count = sk_take_u64(r), led = sk_take_u64(r);
    if (r->short_ || count != m->vertex_count || (led && led != m->given_count) ||
        sk_left(r) / (3 * sizeof(real)) < count)
        return fail_short(error);
    if (apply && !m->led) world->plan_stale = true;
    if (apply && !sk_trimesh_provide(m)) return sk_fail_memory(error, "the vertices of a collider");
    bool good = true;
    for (size_t v = 0; v < count; v++) {
        const real x = sk_take_real(r), y = sk_take_real(r), z = sk_take_real(r);
        good = good && fabs((double)x) <= 1e12 && fabs((double)y) <= 1e12 && fabs((double)z) <= 1e12;
        if (apply) m->place[v] = (sk_vec3){x, y, z};
    }
    for (size_t k = 0; k < 3 * led && !r->short_; k++) {
        const double x = sk_take_f64(r);
        good = good && fabs(x) <= 1e12;
        if (apply) m->led[k] = x;
    }
    if (r->short_ || !good) return fail_short(error);
    if (apply) sk_trimesh_settle(m), m->leads = led != 0;
    return SKEIN_OK;
}

/* What nobody led there is as it was made. */
static skein_status take_surfaces(sk_byte_reader *r, skein_world *world, uint32_t version, bool apply,
                                  skein_error *error) {
    const uint32_t count = version > 3 ? sk_take_u32(r) : 0;
    uint32_t next = 0;
    for (uint32_t i = 0; i <= count && !r->short_; i++) {
        const uint32_t index = i < count ? sk_take_u32(r) : (uint32_t)world->objects.count;
        if (r->short_ || index < next || index > world->objects.count) return fail_short(error);
        for (; next < index && apply; next++) {
            sk_trimesh *m = surface_of(world->objects.data[next]);
            if (!m || !m->led) continue;
            memcpy(m->place, m->made, m->vertex_count * sizeof *m->place);
            sk_trimesh_settle(m);
        }
        if (i == count) break;
        sk_trimesh *m = index < world->objects.count ? surface_of(world->objects.data[index]) : NULL;
        skein_status status = m ? take_surface(r, world, m, apply, error) : fail_short(error);
        if (status) return status;
        next = index + 1;
    }
    return r->short_ ? fail_short(error) : SKEIN_OK;
}

/* What was raised by the fields that have been read is so at once, unless the snapshot says otherwise. */
static skein_status take_easings(sk_byte_reader *r, skein_world *world, uint32_t version, bool apply,
                                 skein_error *error) {
    const uint32_t count = version > 4 ? sk_take_u32(r) : 0;
    uint32_t next = 0;
    for (size_t i = 0; i < world->rules.forces.count && apply; i++)
        world->rules.forces.data[i]->easing = (sk_easing){.less = 0};
    for (uint32_t i = 0; i < count && !r->short_; i++) {
        const uint32_t index = sk_take_u32(r);
        const double less = sk_take_f64(r), since = sk_take_f64(r);
        const uint32_t asks = version > 5 ? sk_take_u32(r) : 0, end = version > 5 ? sk_take_u32(r) : 0;
        const sk_object *object = index < world->objects.count ? world->objects.data[index] : NULL;
        const bool asks_well = asks < end ? end <= world->particles.count || end == UINT32_MAX : !asks && !end;
        if (r->short_ || index < next || !object || object->category != SKEIN_FORCE ||
            !object->as.force->type->meeting || !(less >= 0 && less <= SK_FAR) || !(fabs(since) <= SK_FAR) || !asks_well)
            return fail_short(error);
        if (apply) object->as.force->easing = (sk_easing){less, since, asks, end};
        next = index + 1;
    }
    return r->short_ || sk_left(r) ? fail_short(error) : SKEIN_OK;
}

/* Once to look whether all of it fits, once to take it. */
static skein_status walk(skein_world *world, const void *bytes, const skein_snapshot_info *info, sk_set_method *set,
                         bool apply, skein_error *error) {
    sk_byte_reader r = {bytes, info->size, SK_SNAPSHOT_HEAD, false};
    skein_status status = take_clock(&r, world, apply, error);
    if (!status) status = take_method(&r, world, set, apply, error);
    for (size_t i = 0; i < world->objects.count && !status; i++) status = take_object(&r, world, i, apply, error);
    if (!status) status = take_particles(&r, world, apply, error);
    if (!status) status = take_pins(&r, world, apply, error);
    if (!status) status = take_cuts(&r, world, info->version, apply, error);
    if (!status) status = take_rests(&r, world, info->version, apply, error);
    if (!status) status = take_surfaces(&r, world, info->version, apply, error);
    return status ? status : take_easings(&r, world, info->version, apply, error);
}

/* Of what is no length, nothing comes. */
static void take_substep(skein_world *world, const void *bytes) {
    sk_byte_reader r = {bytes, SK_SNAPSHOT_HEAD, AT_SUBSTEP, false};
    const uint32_t substep = sk_take_u32(&r);
    memcpy(&world->substep, &substep, sizeof substep);
}

skein_status sk_snapshot_read(skein_world *world, const void *bytes, size_t size, sk_set_method *set) {
    skein_error *error = sk_world_error(world);
    skein_snapshot_info info = {.version = 0};
    skein_status status = look(bytes, size, &info, error);
    if (status) return status;
    if (info.real_size != sizeof(real))
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "the snapshot is of a library built in %s, and this one is in %s: take the other build",
                       info.real_size == 8 ? "double" : "float", sizeof(real) == 8 ? "double" : "float");
    sk_world_seat_all(world);
    status = walk(world, bytes, &info, set, false, error);
    if (!status) status = sk_world_touch(world);
    if (status) return status;
    struct sk_recording *recording = world->recording; // which hears of it once, as a whole
    world->recording = NULL;
    sk_world_wake_all(world);
    status = walk(world, bytes, &info, set, true, error);
    take_substep(world, bytes);
    sk_world_place_colliders(world);
    world->recording = recording;
    sk_record_state(world);
    return status;
}
