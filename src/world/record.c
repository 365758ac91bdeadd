/* Recordings: entries, one for each thing that was done.
 *
 *   head    "skeinrec", version, bytes of a real, note
 *   entry   what (1 byte), bytes (8), these, sum (8) over all sums before and this entry: a chain
 *
 * Before a step, and at the end, comes the *sketch* of the state: for every 64 particles the sum of hashes of their
 * positions, that of their velocities, and for each bit of a particle's place among them the sum over those that have
 * it. Where one of the 64 differs, all sums that have it differ by the same and name it: half a byte a particle instead
 * of 24. A recording begins with a snapshot; so replaying needs a world that was built in the same way, and nothing
 * else. */
#include "world/record.h"
#include "world/cut.h"

#include <inttypes.h>
#include <stdio.h>

static const char magic[8] = {'s', 'k', 'e', 'i', 'n', 'r', 'e', 'c'};
enum { VERSION = 3, LOT = 64, LOT_BITS = 6, SUMS = 2 + LOT_BITS };
enum {
    AN_END = 1,
    A_STATE,
    A_STEP,
    A_FIELD,
    POSITIONS,
    VELOCITIES,
    A_HOLD,
    PINS,
    A_TELEPORT,
    THE_CLOCK,
    A_RESET,
    A_STOP,
    A_CUT,   /* from version 2 on */
    VERTICES /* of a collider; from version 3 on */
};

struct sk_recording {
    skein_recorder to;
    char *note;
    uint64_t chain;
    bool failed, stopped;
    unsigned char *room;
    size_t size;
};

/* ---- sketches ---- */

static uint32_t hash_of(const skein_world *world, sk_vector vector, size_t particle) {
    const sk_vec4 *p = &world->particles.vector[vector][world->particles.slot_of[particle]];
    const real xyz[3] = {p->x, p->y, p->z};
    uint64_t hash = sk_hash_word(SK_HASH_START, particle);
    for (int k = 0; k < 3; k++) {
        uint64_t word = 0;
        memcpy(&word, &xyz[k], sizeof xyz[k]);
        hash = sk_hash_word(hash, word);
    }
    return (uint32_t)sk_hash_mix(hash);
}

static size_t lot_count(const skein_world *world) {
    return (world->particles.count + LOT - 1) / LOT;
}

static void sketch_lot(const skein_world *world, size_t lot, uint32_t sums[SUMS]) {
    memset(sums, 0, SUMS * sizeof *sums);
    for (size_t i = 0; i < LOT && lot * LOT + i < world->particles.count; i++) {
        if (!sk_particle_counts(&world->particles, lot * LOT + i)) continue;
        uint32_t x = hash_of(world, SK_X, lot * LOT + i), v = hash_of(world, SK_V, lot * LOT + i);
        sums[0] += x, sums[1] += v;
        for (int b = 0; b < LOT_BITS; b++)
            if (i >> b & 1) sums[2 + b] += x + v;
    }
}

static void put_sketch(sk_byte_writer *w, const skein_world *world) {
    sk_world_fetch(world);
    for (size_t lot = 0; lot < lot_count(world); lot++) {
        uint32_t sums[SUMS];
        sketch_lot(world, lot, sums);
        for (int s = 0; s < SUMS; s++) sk_put_u32(w, sums[s]);
    }
}

/* ---- recording ---- */

static void write_bytes(struct sk_recording *r, const void *bytes, size_t size) {
    if (!r->failed && !r->to.write(r->to.user, bytes, size)) r->failed = true;
}

static void write_entry(struct sk_recording *r, unsigned what, const void *bytes, size_t size) {
    unsigned char head[9], tail[8];
    sk_byte_writer w = {head, sizeof head, 0}, end = {tail, sizeof tail, 0};
    sk_put_u8(&w, what);
    sk_put_u64(&w, size);
    r->chain = sk_hash_word(sk_hash_word(r->chain, what), sk_byte_sum(bytes, size));
    sk_put_u64(&end, r->chain);
    write_bytes(r, head, sizeof head);
    if (size) write_bytes(r, bytes, size);
    write_bytes(r, tail, sizeof tail);
}

/* The recording, if there is one that goes on, with room for an entry of so many bytes. */
static struct sk_recording *room_for(skein_world *world, size_t size) {
    struct sk_recording *r = world->recording;
    if (!r || r->stopped || r->failed) return NULL;
    if (size <= r->size) return r;
    unsigned char *room = sk_allocate(&world->allocator, size);
    if (!room) {
        r->failed = true;
        return NULL;
    }
    sk_release(&world->allocator, r->room);
    r->room = room, r->size = size;
    return r;
}

void sk_record_step(skein_world *world, double dt) {
    struct sk_recording *r = room_for(world, 8 + lot_count(world) * SUMS * 4);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    sk_put_f64(&w, dt);
    put_sketch(&w, world);
    write_entry(r, A_STEP, r->room, w.at);
}

/* An object by its category and its number among those. */
static void put_object(sk_byte_writer *w, const skein_world *world, const sk_object *object) {
    uint32_t number = 0;
    skein_category category = object ? object->category : SKEIN_METHOD;
    for (size_t i = 0; object && world->objects.data[i] != object; i++)
        number += world->objects.data[i]->category == category;
    sk_put_u8(w, (unsigned)category);
    sk_put_u32(w, number);
}

void sk_record_field(skein_world *world, const sk_object *object, const char *name, const skein_value *value) {
    struct sk_recording *r =
        room_for(world, 64 + strlen(name) + (value->count || !value->text ? 0 : strlen(value->text)));
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    put_object(&w, world, object);
    sk_put_text(&w, name);
    sk_put_value(&w, value);
    write_entry(r, A_FIELD, r->room, w.at);
}

void sk_record_numbers(skein_world *world, sk_vector vector, size_t first, size_t count, const double *xyz) {
    struct sk_recording *r = room_for(world, 16 + 24 * count);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    sk_put_u64(&w, first), sk_put_u64(&w, count);
    for (size_t i = 0; i < 3 * count; i++) sk_put_f64(&w, xyz[i]);
    write_entry(r, vector == SK_X ? POSITIONS : VELOCITIES, r->room, w.at);
}

void sk_record_hold(skein_world *world, size_t particle, bool held) {
    struct sk_recording *r = room_for(world, 9);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    sk_put_u64(&w, particle), sk_put_u8(&w, held);
    write_entry(r, A_HOLD, r->room, w.at);
}

void sk_record_pins(skein_world *world, const uint32_t *particles, size_t count, const double *xyz) {
    struct sk_recording *r = room_for(world, 8 + 28 * count);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    sk_put_u64(&w, count);
    for (size_t i = 0; i < count; i++) sk_put_u32(&w, particles ? particles[i] : (uint32_t)i);
    for (size_t i = 0; i < 3 * count; i++) sk_put_f64(&w, xyz[i]);
    write_entry(r, PINS, r->room, w.at);
}

void sk_record_teleport(skein_world *world, const sk_object *object) {
    struct sk_recording *r = room_for(world, 5);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    put_object(&w, world, object);
    write_entry(r, A_TELEPORT, r->room, w.at);
}

void sk_record_vertices(skein_world *world, const sk_object *object, size_t count, const double *xyz) {
    struct sk_recording *r = room_for(world, 13 + 24 * count);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    put_object(&w, world, object);
    sk_put_u64(&w, count);
    for (size_t i = 0; i < 3 * count; i++) sk_put_f64(&w, xyz[i]);
    write_entry(r, VERTICES, r->room, w.at);
}

void sk_record_cut(skein_world *world, const sk_body *body) {
    struct sk_recording *r = room_for(world, 16 + 4 * body->cut->count);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    size_t i = 0;
    while (world->objects.data[i]->category != SKEIN_BODY || world->objects.data[i]->as.body != body) i++;
    put_object(&w, world, world->objects.data[i]);
    sk_put_cut(&w, body);
    write_entry(r, A_CUT, r->room, w.at);
}

void sk_record_clock(skein_world *world, double seconds) {
    struct sk_recording *r = room_for(world, 8);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    sk_put_f64(&w, seconds);
    write_entry(r, THE_CLOCK, r->room, w.at);
}

void sk_record_reset(skein_world *world) {
    struct sk_recording *r = room_for(world, 0);
    if (r) write_entry(r, A_RESET, "", 0);
}

void sk_record_state(skein_world *world) {
    if (!world->recording) return;
    struct sk_recording *r = room_for(world, skein_snapshot_size(world));
    size_t written;
    if (!r) return;
    if (skein_snapshot_write(world, r->room, r->size, &written)) r->failed = true;
    else write_entry(r, A_STATE, r->room, written);
}

void sk_record_stop(skein_world *world, const char *why) {
    struct sk_recording *r = room_for(world, strlen(why) + 5);
    if (!r) return;
    sk_byte_writer w = {r->room, r->size, 0};
    sk_put_text(&w, why);
    write_entry(r, A_STOP, r->room, w.at);
    r->stopped = true;
}

skein_status skein_record_begin(skein_world *world, const skein_recorder *recorder) {
    SK_NEED(world, world);
    SK_NEED(world, recorder);
    skein_error *error = sk_world_error(world);
    if (!recorder->write) return sk_fail_null(error, "write");
    if (world->recording)
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "the world is being recorded: skein_record_end() comes first");
    struct sk_recording *r = sk_allocate(&world->allocator, sizeof *r);
    if (!r) return sk_fail_memory(error, "a recording");
    *r = (struct sk_recording){.to = *recorder, .chain = SK_HASH_START};
    r->to.note = NULL; // it is written now
    world->recording = r;
    const char *note = recorder->note ? recorder->note : "";
    unsigned char head[20];
    sk_byte_writer w = {head, sizeof head, 0};
    sk_put(&w, magic, sizeof magic);
    sk_put_u32(&w, VERSION);
    sk_put_u32(&w, sizeof(real));
    sk_put_u32(&w, (uint32_t)strlen(note) + 1);
    write_bytes(r, head, sizeof head);
    write_bytes(r, note, strlen(note) + 1);
    sk_record_state(world);
    if (!r->failed) return SKEIN_OK;
    sk_record_release(world);
    return sk_fail(error, SKEIN_ERROR_FILE, "", "the recording could not be written");
}

void sk_record_release(skein_world *world) {
    if (!world->recording) return;
    sk_release(&world->allocator, world->recording->room);
    sk_release(&world->allocator, world->recording);
    world->recording = NULL;
}

skein_status skein_record_end(skein_world *world) {
    SK_NEED(world, world);
    skein_error *error = sk_world_error(world);
    if (!world->recording) return sk_fail(error, SKEIN_ERROR_VALUE, "", "the world is not being recorded");
    struct sk_recording *r = room_for(world, lot_count(world) * SUMS * 4);
    if (r) {
        sk_byte_writer w = {r->room, r->size, 0};
        put_sketch(&w, world);
        write_entry(r, AN_END, r->room, w.at);
    }
    bool failed = world->recording->failed;
    sk_record_release(world);
    return failed ? sk_fail(error, SKEIN_ERROR_FILE, "", "the recording could not be written") : SKEIN_OK;
}

/* ---- replaying ---- */

static skein_status fail_damaged(skein_error *error, const sk_byte_reader *r) {
    return sk_fail(error, SKEIN_ERROR_SYNTAX, "", "the recording is damaged near byte %zu", r->at);
}

static skein_status look(sk_byte_reader *r, skein_recording_info *info, skein_error *error) {
    const unsigned char *word = sk_take(r, sizeof magic);
    if (!word || memcmp(word, magic, sizeof magic) != 0)
        return sk_fail(error, SKEIN_ERROR_SYNTAX, "", "it is no recording of Skein's");
    *info = (skein_recording_info){.version = sk_take_u32(r), .real_size = sk_take_u32(r)};
    if (!r->short_ && info->version > VERSION)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "",
                       "a recording of version %" PRIu32 ", and Skein " SKEIN_VERSION
                       " replays version %d: take the Skein that wrote it, or a newer one",
                       info->version, VERSION);
    info->note = sk_take_text(r);
    return r->short_ || info->version < 1 ? fail_damaged(error, r) : SKEIN_OK;
}

skein_status skein_recording_look(const void *bytes, size_t size, skein_recording_info *info, skein_error *error) {
    if (!bytes) return sk_fail_null(error, "bytes");
    if (!info) return sk_fail_null(error, "info");
    sk_byte_reader r = {bytes, size, 0, false};
    return look(&r, info, error);
}

static void name_body(const skein_world *world, skein_difference *d) {
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_BODY) continue;
        const sk_body *body = object->as.body;
        if (d->particle >= body->first_particle && d->particle - body->first_particle < body->particle_count)
            d->body = sk_handle_at(world, i);
    }
}

/* Which of a lot's particles differs: `by` is how much its sums do. */
static void name_particle(const uint32_t by[SUMS], size_t lot, skein_difference *d) {
    uint32_t all = by[0] + by[1], place = 0;
    d->position = by[0] != 0, d->velocity = by[1] != 0, d->exact = all != 0;
    for (int b = 0; b < LOT_BITS; b++) {
        if (by[2 + b] == all) place |= 1u << b;
        else if (by[2 + b]) d->exact = false;
    }
    d->particle = (uint32_t)(lot * LOT) + (d->exact ? place : 0);
    d->found = true;
}

/* Whether the state is the one that was sketched. */
static void compare(sk_byte_reader *r, const skein_world *world, skein_difference *d) {
    sk_world_fetch(world);
    for (size_t lot = 0; lot < lot_count(world); lot++) {
        uint32_t sums[SUMS], by[SUMS], any = 0;
        sketch_lot(world, lot, sums);
        for (int s = 0; s < SUMS; s++) any |= by[s] = sk_take_u32(r) - sums[s];
        if (any && !r->short_ && !d->blocks++) name_particle(by, lot, d);
    }
    if (d->found) name_body(world, d);
}

static skein_handle take_object(sk_byte_reader *r, const skein_world *world) {
    unsigned category = sk_take_u8(r);
    uint32_t number = sk_take_u32(r);
    return category < SKEIN_CATEGORY_COUNT ? skein_object_at(world, (skein_category)category, number)
                                           : (skein_handle){0, 0, 0};
}

/* Many numbers of an entry: in the world's memory, for they need not lie where doubles may. */
static skein_status do_numbers(sk_byte_reader *r, skein_world *world, unsigned what, skein_error *error) {
    const skein_handle collider = what == VERTICES ? take_object(r, world) : (skein_handle){0, 0, 0};
    uint64_t first = what == PINS || what == VERTICES ? 0 : sk_take_u64(r), count = sk_take_u64(r);
    size_t each = what == PINS ? 28 : 24;
    if (r->short_ || count != sk_left(r) / each || sk_left(r) % each) return fail_damaged(error, r);
    double *xyz = sk_allocate(&world->allocator, (size_t)count * 24 + 8);
    uint32_t *pins = sk_allocate(&world->allocator, (size_t)count * 4 + 4);
    skein_status status = xyz && pins ? SKEIN_OK : sk_fail_memory(error, "an entry of a recording");
    for (size_t i = 0; i < count && what == PINS && !status; i++) pins[i] = sk_take_u32(r);
    for (size_t i = 0; i < 3 * count && !status; i++) xyz[i] = sk_take_f64(r);
    if (status) (void)0;
    else if (what == PINS) status = skein_pins_move(world, pins, (size_t)count, xyz);
    else if (what == VERTICES) status = skein_collider_vertices_set(world, collider, xyz, (size_t)count);
    else if (what == POSITIONS) status = skein_positions_set(world, (size_t)first, (size_t)count, xyz);
    else status = skein_velocities_set(world, (size_t)first, (size_t)count, xyz);
    sk_release(&world->allocator, xyz);
    sk_release(&world->allocator, pins);
    return status;
}

static skein_status do_field(sk_byte_reader *r, skein_world *world, skein_error *error) {
    skein_handle handle = take_object(r, world);
    const char *name = sk_take_text(r);
    skein_value value = sk_take_value(r);
    return r->short_ || !name ? fail_damaged(error, r) : skein_set(world, handle, name, value);
}

static skein_status do_hold(sk_byte_reader *r, skein_world *world, skein_error *error) {
    uint64_t particle = sk_take_u64(r);
    bool held = sk_take_u8(r) != 0;
    return r->short_ ? fail_damaged(error, r) : skein_particle_pin(world, (size_t)particle, held);
}

static skein_status do_cut(sk_byte_reader *r, skein_world *world, skein_error *error) {
    sk_object *object = sk_object_find(world, take_object(r, world), SKEIN_BODY);
    bool memory = true;
    if (!object) return SKEIN_ERROR_HANDLE;
    skein_status status = sk_world_touch(world);
    if (status) return status;
    if (!sk_take_cut(r, world, object, true, &memory))
        return memory ? fail_damaged(error, r) : sk_fail_memory(error, "a cut");
    return SKEIN_OK;
}

static skein_status do_step(sk_byte_reader *r, skein_world *world, skein_difference *d, skein_error *error) {
    double dt = sk_take_f64(r);
    compare(r, world, d);
    if (r->short_) return fail_damaged(error, r);
    if (d->found) return SKEIN_OK;
    skein_status status = skein_world_step(world, dt);
    if (!status) d->steps++;
    return status;
}

static skein_status do_stop(sk_byte_reader *r, skein_difference *d, skein_error *error) {
    const char *why = sk_take_text(r);
    if (!why) return fail_damaged(error, r);
    snprintf(d->stopped, sizeof d->stopped, "%s", why);
    d->is_whole = true;
    return SKEIN_OK;
}

static skein_status do_end(sk_byte_reader *r, const skein_world *world, skein_difference *d, skein_error *error) {
    compare(r, world, d);
    d->is_whole = true;
    return r->short_ ? fail_damaged(error, r) : SKEIN_OK;
}

static skein_status do_entry(unsigned what, sk_byte_reader *r, skein_world *world, skein_difference *d,
                             sk_set_method *set, skein_error *error) {
    switch (what) {
    case AN_END: return do_end(r, world, d, error);
    case A_STATE: return sk_snapshot_read(world, r->in, r->size, set);
    case A_STEP: return do_step(r, world, d, error);
    case A_FIELD: return do_field(r, world, error);
    case POSITIONS:
    case VELOCITIES:
    case PINS:
    case VERTICES: return do_numbers(r, world, what, error);
    case A_HOLD: return do_hold(r, world, error);
    case A_TELEPORT: return skein_collider_teleport(world, take_object(r, world));
    case A_CUT: return do_cut(r, world, error);
    case THE_CLOCK: return skein_world_time_set(world, sk_take_f64(r));
    case A_RESET: return skein_world_reset(world);
    case A_STOP: return do_stop(r, d, error);
    default: return fail_damaged(error, r);
    }
}

skein_status sk_replay(skein_world *world, const void *bytes, size_t size, skein_difference *difference,
                       sk_set_method *set) {
    skein_error *error = sk_world_error(world);
    sk_byte_reader r = {bytes, size, 0, false};
    skein_recording_info info;
    *difference = (skein_difference){.steps = 0};
    skein_status status = look(&r, &info, error);
    uint64_t chain = SK_HASH_START;
    bool first = true;
    while (!status && !difference->found && !difference->is_whole && sk_left(&r)) {
        unsigned what = sk_take_u8(&r);
        uint64_t length = sk_take_u64(&r);
        const unsigned char *entry = length <= sk_left(&r) ? sk_take(&r, (size_t)length) : NULL;
        uint64_t sum = entry ? sk_take_u64(&r) : 0;
        if (!entry || r.short_) break; // it breaks off here
        chain = sk_hash_word(sk_hash_word(chain, what), sk_byte_sum(entry, (size_t)length));
        if (sum != chain || (first && what != A_STATE)) return fail_damaged(error, &r);
        first = false;
        sk_byte_reader inner = {entry, (size_t)length, 0, false};
        status = do_entry(what, &inner, world, difference, set, error);
    }
    return status;
}
