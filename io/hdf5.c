/* HDF5 files that can be read at any time: see hdf5.h for the contract and the order of the file.
 *
 * Format: The HDF Group, HDF5 File Format Specification, version 3.0; sections are named where they are written. All
 * numbers of the format are little endian; samples are as the machine has them, which their type says.
 *
 * A set that grows, here with two entries to a node instead of 64. Full nodes never change again; the last one of each
 * level does, and is then written where the tree in the file is not:
 *
 *   level 1   [ . . ]                 each entry: first sample, place
 *   level 0   [ . . ]  [ . _ ]
 *   chunks     c c      c             of one sample or more; the last may be filled in part
 */
#include "io/hdf5.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum {
    SUPERBLOCK = 96,
    FRONT = 4096,      /* a page: a write within one is never cut */
    NODE_ENTRIES = 64, /* twice the format's K of 32 for chunks */
    GROUP_K = 16,
    LEAF_K = 8,            /* of the one group: room for 16 sets, */
    LARGE_LEAF_K = 64,     /* or, in files of more, for 128 */
    CHUNK_BYTES = 1 << 14, /* as many samples as go into that, but one at least */
    MOST_CHUNK_SAMPLES = 1024,
    MOST_LEVELS = 10,
    MOST_PLACES = 4 * MOST_LEVELS,
    MOST_GROWING = 3
};
static const uint64_t nowhere = UINT64_MAX;

/* The last node of a level, which grows. */
typedef struct level {
    uint64_t first[NODE_ENTRIES], child[NODE_ENTRIES];
    size_t count;
    uint64_t place, left; /* in the file; 0 and `nowhere`: none yet */
    bool changed;
} level;

typedef struct growing {
    const io_hdf5_set *set;
    size_t sample_bytes, chunk_samples;
    char *chunk;                /* the one that grows, whole */
    uint64_t chunk_place, next; /* the first sample after it */
    bool dirty;
    level *levels[MOST_LEVELS];
    size_t level_count;
    uint64_t spare[MOST_PLACES], retired[MOST_PLACES]; /* room for nodes: free, and free after the next front */
    size_t spare_count, retired_count;
} growing;

struct io_hdf5 {
    io_output *output;
    char *path;
    growing growing[MOST_GROWING];
    io_hdf5_set sets[MOST_GROWING]; /* what of theirs is needed after the beginning; names and notes in `texts` */
    size_t growing_count;
    char *texts;
    uint64_t samples, readable;
    uint64_t end;              /* of the file, when the last whole sample was in it */
    bool no_room;              /* a chunk or nodes could not be appended: all before that is sound */
    uint64_t root, tree, heap; /* of the group */
    size_t leaf_k;             /* half of what its leaf has room for */
};

/* ---- Bytes --------------------------------------------------------------------------------- */

typedef struct bytes {
    unsigned char *data;
    size_t size, capacity;
    bool failed;
} bytes;

static void put_bytes(bytes *b, const void *from, size_t size) {
    if (b->failed || !io_grow(&b->data, &b->capacity, b->size + size + 8, 1)) {
        b->failed = true;
        return;
    }
    if (size) memcpy(b->data + b->size, from, size);
    b->size += size;
}

static void put(bytes *b, int count, uint64_t value) {
    unsigned char bytes_of[8];
    for (int k = 0; k < count; k++) bytes_of[k] = (unsigned char)(value >> (8 * k));
    put_bytes(b, bytes_of, (size_t)count);
}

static void put_zeros(bytes *b, size_t count) {
    for (; count > 0; count--) put(b, 1, 0);
}

static void pad(bytes *b) {
    put_zeros(b, (8 - b->size % 8) % 8);
}

static void set_at(bytes *b, size_t at, int count, uint64_t value) {
    for (int k = 0; k < count && !b->failed; k++) b->data[at + (size_t)k] = (unsigned char)(value >> (8 * k));
}

/* ---- Messages of an object header (IV.A.2) --------------------------------------------------- */

static bool is_big_endian(void) {
    const uint16_t one = 1;
    return *(const unsigned char *)&one == 0;
}

static uint32_t size_of(io_hdf5_type type, uint32_t size) {
    return type == IO_HDF5_REAL ? sizeof(skein_real) : type == IO_HDF5_DOUBLE ? 8 : type == IO_HDF5_UINT32 ? 4 : size;
}

/* The type and size of a message, and room for its length. Returns where it begins. */
static size_t begin_message(bytes *b, unsigned type) {
    put(b, 2, type);
    put_zeros(b, 6);
    return b->size;
}

static void end_message(bytes *b, size_t begin) {
    pad(b);
    set_at(b, begin - 6, 2, b->size - begin);
}

static void put_type(bytes *b, io_hdf5_type type, uint32_t text_size) {
    uint32_t size = size_of(type, text_size);
    unsigned order = is_big_endian() ? 1 : 0;
    if (type == IO_HDF5_TEXT) {
        put(b, 1, 0x13);
        put(b, 3, 0x10); // ends with a zero; UTF-8
        put(b, 4, size);
    } else if (type == IO_HDF5_UINT32) {
        put(b, 1, 0x10);
        put(b, 3, order);
        put(b, 4, size);
        put(b, 2, 0);
        put(b, 2, 32);
    } else { // IEEE: sign, exponent, fraction from the top down
        bool twice = size == 8;
        put(b, 1, 0x11);
        put(b, 3, (twice ? 0x3f20u : 0x1f20u) | order);
        put(b, 4, size);
        put(b, 2, 0);
        put(b, 2, 8 * (uint64_t)size);
        put(b, 1, twice ? 52 : 23);
        put(b, 1, twice ? 11 : 8);
        put(b, 1, 0);
        put(b, 1, twice ? 52 : 23);
        put(b, 4, twice ? 1023 : 127);
    }
    pad(b);
}

static void put_space(bytes *b, const io_hdf5_set *set, bool grows, uint64_t samples) {
    put(b, 1, 1);
    put(b, 1, (uint64_t)set->rank);
    put(b, 1, grows);
    put_zeros(b, 5);
    for (int k = 0; k < set->rank; k++) put(b, 8, grows && k == 0 ? samples : set->dims[k]);
    for (int k = 0; grows && k < set->rank; k++) put(b, 8, k == 0 ? nowhere : set->dims[k]);
}

static void put_note(bytes *b, const io_hdf5_note *note) {
    size_t name = strlen(note->name) + 1, text = strlen(note->text) + 1;
    size_t begin = begin_message(b, 0x0c);
    put(b, 2, 1);
    put(b, 2, name);
    put(b, 2, 8); // of the type
    put(b, 2, 8); // of the space
    put_bytes(b, note->name, name);
    pad(b);
    put_type(b, IO_HDF5_TEXT, (uint32_t)text);
    put_space(b, &(io_hdf5_set){.rank = 0}, false, 0);
    put_bytes(b, note->text, text);
    end_message(b, begin);
}

/* Begins a header; its count and length are set by end_header(). */
static size_t begin_header(bytes *b) {
    pad(b);
    size_t begin = b->size;
    put(b, 4, 1);
    put(b, 4, 1); // referred to once
    put_zeros(b, 8);
    return begin;
}

static void end_header(bytes *b, size_t begin, size_t messages) {
    set_at(b, begin + 2, 2, messages);
    set_at(b, begin + 8, 4, b->size - begin - 16);
}

static size_t put_notes(bytes *b, const io_hdf5_note *notes) {
    size_t count = 0;
    for (; count < IO_HDF5_MOST_NOTES && notes[count].name; count++) put_note(b, &notes[count]);
    return count;
}

/* What a set is and where: `place` is its first byte, or the root of its tree. */
static void put_set(bytes *b, const io_hdf5_set *set, const growing *g, uint64_t samples, uint64_t place) {
    size_t header = begin_header(b);
    size_t begin = begin_message(b, 0x01);
    put_space(b, set, g != NULL, samples);
    end_message(b, begin);
    begin = begin_message(b, 0x03);
    put_type(b, set->type, set->size);
    end_message(b, begin);
    begin = begin_message(b, 0x05); // what nobody wrote is 0
    put(b, 1, 2);
    put(b, 1, g ? 3 : 2);
    put(b, 1, 2);
    put(b, 1, 1);
    put(b, 4, 0);
    end_message(b, begin);
    begin = begin_message(b, 0x08);
    uint64_t size = size_of(set->type, set->size);
    put(b, 1, 3);
    if (g) {
        put(b, 1, 2);
        put(b, 1, (uint64_t)set->rank + 1);
        put(b, 8, place);
        for (int k = 0; k < set->rank; k++) put(b, 4, k == 0 ? g->chunk_samples : set->dims[k]);
        put(b, 4, size);
    } else {
        for (int k = 0; k < set->rank; k++) size *= set->dims[k];
        put(b, 1, 1);
        put(b, 8, size ? place : nowhere);
        put(b, 8, size);
    }
    end_message(b, begin);
    end_header(b, header, 4 + put_notes(b, set->notes));
}

/* ---- The front: superblock and the sets that grow ---------------------------------------------- */

static uint64_t root_of(const growing *g) {
    return g->level_count ? g->levels[g->level_count - 1]->place : nowhere;
}

/* Fills in where each growing set's header is. */
static void put_front(bytes *b, const io_hdf5 *file, uint64_t headers[MOST_GROWING]) {
    put_bytes(b, "\x89HDF\r\n\x1a\n", 8);
    put(b, 5, 0); // versions
    put(b, 1, 8);
    put(b, 1, 8);
    put(b, 1, 0);
    put(b, 2, file->leaf_k);
    put(b, 2, GROUP_K);
    put(b, 4, 0);
    put(b, 8, 0);
    put(b, 8, nowhere);
    put(b, 8, io_output_place(file->output));
    put(b, 8, nowhere);
    put(b, 8, 0); // the root's entry
    put(b, 8, file->root);
    put(b, 4, 1);
    put(b, 4, 0);
    put(b, 8, file->tree);
    put(b, 8, file->heap);
    assert(b->failed || b->size == SUPERBLOCK);
    for (size_t i = 0; i < file->growing_count; i++) {
        const growing *g = &file->growing[i];
        pad(b);
        headers[i] = b->size;
        put_set(b, g->set, g, file->samples, root_of(g));
    }
    pad(b);
}

/* ---- The tree over the chunks of a set (III.A.1) ------------------------------------------------ */

static void put_key(bytes *b, const growing *g, uint64_t first) {
    put(b, 4, g->sample_bytes * g->chunk_samples);
    put(b, 4, 0);
    put(b, 8, first);
    for (int k = 0; k < g->set->rank; k++) put(b, 8, 0);
}

/* Appends, and returns where; `nowhere` if it failed, and then the file is sound up to `end`. */
static uint64_t append_soundly(io_hdf5 *file, const void *data, size_t size) {
    uint64_t place = io_output_place(file->output);
    io_output_write(file->output, data, size);
    io_output_flush(file->output);
    file->no_room = io_output_status(file->output, NULL) != SKEIN_OK;
    if (file->no_room) return nowhere;
    file->end = io_output_place(file->output);
    return place;
}

/* Room for all nodes that one more chunk may change and a new front may want. */
static bool reserve_nodes(io_hdf5 *file, growing *g) {
    size_t key = 16 + 8 * (size_t)g->set->rank, size = 24 + NODE_ENTRIES * 8 + (NODE_ENTRIES + 1) * key;
    while (g->spare_count < 2 * g->level_count + 2) {
        bytes b = {0};
        put_zeros(&b, size);
        uint64_t place = b.failed ? nowhere : append_soundly(file, b.data, b.size);
        free(b.data);
        if (place == nowhere) return false;
        g->spare[g->spare_count++] = place;
    }
    return true;
}

/* Writes the last node of a level to where the tree in the file is not, and notes its place. */
static void write_node(io_hdf5 *file, growing *g, size_t l) {
    level *v = g->levels[l];
    bytes b = {0};
    put_bytes(&b, "TREE", 4);
    put(&b, 1, 1);
    put(&b, 1, l);
    put(&b, 2, v->count);
    put(&b, 8, v->left);
    put(&b, 8, nowhere);
    for (size_t i = 0; i < v->count; i++) {
        put_key(&b, g, v->first[i]);
        put(&b, 8, v->child[i]);
    }
    put_key(&b, g, g->next);
    if (b.failed) io_output_fail_memory(file->output);
    if (v->place && g->retired_count < MOST_PLACES) g->retired[g->retired_count++] = v->place;
    assert(g->spare_count > 0); // reserve_nodes()
    v->place = g->spare[--g->spare_count];
    if (!b.failed) io_output_patch(file->output, v->place, b.data, b.size);
    v->changed = false;
    free(b.data);
}

/* A node is complete: writes it for good, and tells the one before it. */
static void freeze(io_hdf5 *file, growing *g, size_t l) {
    level *v = g->levels[l];
    if (v->changed || !v->place) write_node(file, g, l);
    bytes b = {0};
    put(&b, 8, v->place);
    if (v->left != nowhere && !b.failed) io_output_patch(file->output, v->left + 16, b.data, b.size);
    free(b.data);
}

static bool add_level(growing *g) {
    if (g->level_count == MOST_LEVELS) return false;
    level *v = calloc(1, sizeof *v);
    if (!v) return false;
    v->left = nowhere;
    g->levels[g->level_count++] = v;
    return true;
}

static bool add_entry(io_hdf5 *file, growing *g, size_t l, uint64_t first, uint64_t child) {
    if (l == g->level_count && !add_level(g)) return false;
    level *v = g->levels[l];
    if (v->count == NODE_ENTRIES) {
        freeze(file, g, l);
        if (l + 1 == g->level_count && !add_entry(file, g, l + 1, v->first[0], 0)) return false;
        level *above = g->levels[l + 1];
        above->child[above->count - 1] = v->place;
        above->changed = true;
        v->left = v->place;
        v->place = 0;
        v->count = 0;
        if (!add_entry(file, g, l + 1, first, 0)) return false; // its place is found by write_tree()
    }
    v->first[v->count] = first;
    v->child[v->count++] = child;
    v->changed = true;
    return true;
}

/* Writes what has changed of the tree, from the bottom up. */
static void write_tree(io_hdf5 *file, growing *g, bool for_good) {
    for (size_t l = 0; l < g->level_count; l++) {
        level *v = g->levels[l];
        if (l > 0 && v->child[v->count - 1] != g->levels[l - 1]->place) {
            v->child[v->count - 1] = g->levels[l - 1]->place;
            v->changed = true;
        }
        if (for_good) freeze(file, g, l);
        else if (v->changed) write_node(file, g, l);
    }
}

/* ---- Samples ----------------------------------------------------------------------------------- */

/* The chunk that grows, as it is; what it had in the file is a part of it. */
static void write_chunk(io_hdf5 *file, growing *g) {
    if (g->dirty) io_output_patch(file->output, g->chunk_place, g->chunk, g->sample_bytes * g->chunk_samples);
    g->dirty = false;
}

static bool add_sample(io_hdf5 *file, growing *g, const void *sample) {
    uint64_t at = file->samples % g->chunk_samples;
    size_t size = g->sample_bytes * g->chunk_samples;
    memcpy(g->chunk + at * g->sample_bytes, sample, g->sample_bytes);
    if (at == 0) { // a new one gets its place; the tree learns of it when it is there
        memset(g->chunk + g->sample_bytes, 0, size - g->sample_bytes);
        uint64_t place = reserve_nodes(file, g) ? append_soundly(file, g->chunk, size) : nowhere;
        if (place == nowhere || !add_entry(file, g, 0, g->next, place)) return false;
        g->chunk_place = place;
        g->next += g->chunk_samples;
    } else {
        g->dirty = true;
        if (at + 1 == g->chunk_samples) write_chunk(file, g);
    }
    return true;
}

/* Makes all samples readable. */
static void publish(io_hdf5 *file, bool for_good) {
    for (size_t i = 0; i < file->growing_count; i++) {
        write_chunk(file, &file->growing[i]);
        write_tree(file, &file->growing[i], for_good);
    }
    uint64_t headers[MOST_GROWING];
    bytes b = {0};
    put_front(&b, file, headers);
    if (b.failed) io_output_fail_memory(file->output);
    else io_output_patch(file->output, 0, b.data, b.size); // after a failure nothing more is written, nor is this
    free(b.data);
    if (io_output_status(file->output, NULL)) return;
    file->readable = file->samples;
    for (size_t i = 0; i < file->growing_count; i++) {
        growing *g = &file->growing[i];
        while (g->retired_count && g->spare_count < MOST_PLACES)
            g->spare[g->spare_count++] = g->retired[--g->retired_count];
    }
}

skein_status io_hdf5_add(io_hdf5 *file, const void *const *data, skein_error *error) {
    bool good = io_output_status(file->output, NULL) == SKEIN_OK;
    for (size_t i = 0; i < file->growing_count && good; i++) good = add_sample(file, &file->growing[i], data[i]);
    skein_status status = io_output_status(file->output, error);
    if (!status && !good) {
        io_output_fail_memory(file->output);
        status = io_output_status(file->output, error);
    }
    if (status) return status;
    file->samples++;
    if (io_output_is_due(file->output)) publish(file, false);
    return io_output_status(file->output, error);
}

void io_hdf5_publish(io_hdf5 *file) {
    publish(file, false);
}

uint64_t io_hdf5_readable(const io_hdf5 *file) {
    return file->readable;
}

/* ---- Beginning: the group and the sets that do not grow -------------------------------------------- */

static void append(io_hdf5 *file, bytes *b) {
    pad(b);
    if (b->failed) io_output_fail_memory(file->output);
    else io_output_write(file->output, b->data, b->size);
    b->size = 0;
}

static uint64_t write_fixed(io_hdf5 *file, const io_hdf5_set *set) {
    uint64_t place = io_output_place(file->output), size = size_of(set->type, set->size);
    for (int k = 0; k < set->rank; k++) size *= set->dims[k];
    bytes b = {0};
    put_set(&b, set, NULL, 0, 0);
    size_t header = b.size;
    b.size = 0;
    put_set(&b, set, NULL, 0, place + header);
    append(file, &b);
    io_output_write(file->output, set->data, (size_t)size);
    put_zeros(&b, (size_t)((8 - size % 8) % 8));
    append(file, &b);
    free(b.data);
    return place;
}

/* The one group, in the old form: a tree of one leaf, the leaf, the names (III.A.1, III.B, III.D). */
static void write_group(io_hdf5 *file, const io_hdf5_set *sets, const uint64_t *headers, size_t count,
                        const io_hdf5_note *notes) {
    bytes b = {0}, names = {0};
    size_t name_at[IO_HDF5_MOST_SETS];
    put_zeros(&names, 8);
    for (size_t i = 0; i < count; i++) {
        name_at[i] = names.size;
        put_bytes(&names, sets[i].name, strlen(sets[i].name) + 1);
        pad(&names);
    }
    file->heap = io_output_place(file->output);
    put_bytes(&b, "HEAP", 4);
    put(&b, 4, 0);
    put(&b, 8, names.size);
    put(&b, 8, 1); // nothing is free
    put(&b, 8, file->heap + 32);
    put_bytes(&b, names.data, names.failed ? 0 : names.size);
    b.failed |= names.failed;
    append(file, &b);

    uint64_t leaf = io_output_place(file->output);
    put_bytes(&b, "SNOD", 4);
    put(&b, 2, 1);
    put(&b, 2, count);
    for (size_t i = 0; i < count; i++) {
        put(&b, 8, name_at[i]);
        put(&b, 8, headers[i]);
        put_zeros(&b, 24);
    }
    put_zeros(&b, (2 * file->leaf_k - count) * 40);
    append(file, &b);

    file->tree = io_output_place(file->output);
    put_bytes(&b, "TREE", 4);
    put(&b, 2, 0);
    put(&b, 2, 1);
    put(&b, 8, nowhere);
    put(&b, 8, nowhere);
    put(&b, 8, 0);
    put(&b, 8, leaf);
    put(&b, 8, name_at[count - 1]);
    put_zeros(&b, 16 * (2 * GROUP_K - 1));
    append(file, &b);

    file->root = io_output_place(file->output);
    size_t header = begin_header(&b), begin = begin_message(&b, 0x11);
    put(&b, 8, file->tree);
    put(&b, 8, file->heap);
    end_message(&b, begin);
    end_header(&b, header, 1 + put_notes(&b, notes));
    append(file, &b);
    free(b.data);
    free(names.data);
}

/* A copy of a text that lives as long as the file. */
static const char *keep_text(char **at, const char *text) {
    size_t size = strlen(text) + 1;
    memcpy(*at, text, size);
    *at += size;
    return *at - size;
}

/* Keeps what publish() needs of the sets that grow. */
static bool keep_growing(io_hdf5 *file, const io_hdf5_set *sets, size_t count) {
    size_t size = 1;
    for (size_t i = 0; i < count; i++) {
        if (sets[i].data) continue;
        size += strlen(sets[i].name) + 1;
        for (int n = 0; n < IO_HDF5_MOST_NOTES && sets[i].notes[n].name; n++)
            size += strlen(sets[i].notes[n].name) + strlen(sets[i].notes[n].text) + 2;
    }
    char *at = file->texts = malloc(size);
    for (size_t i = 0; at && i < count; i++) {
        if (sets[i].data) continue;
        assert(file->growing_count < MOST_GROWING && sets[i].rank > 0);
        io_hdf5_set *set = &file->sets[file->growing_count];
        growing *g = &file->growing[file->growing_count++];
        *set = sets[i];
        set->name = keep_text(&at, sets[i].name);
        for (int n = 0; n < IO_HDF5_MOST_NOTES && sets[i].notes[n].name; n++)
            set->notes[n] =
                (io_hdf5_note){keep_text(&at, sets[i].notes[n].name), keep_text(&at, sets[i].notes[n].text)};
        g->set = set;
        g->sample_bytes = size_of(set->type, set->size);
        for (int k = 1; k < set->rank; k++) g->sample_bytes *= (size_t)set->dims[k];
        g->chunk_samples = set->chunk ? set->chunk : CHUNK_BYTES / g->sample_bytes;
        if (g->chunk_samples < 1) g->chunk_samples = 1;
        if (g->chunk_samples > MOST_CHUNK_SAMPLES) g->chunk_samples = MOST_CHUNK_SAMPLES;
        g->chunk = malloc(g->sample_bytes * g->chunk_samples);
        if (!g->chunk) return false;
    }
    return at != NULL;
}

static void write_beginning(io_hdf5 *file, const io_hdf5_set *sets, size_t count, const io_hdf5_note *notes) {
    uint64_t headers[IO_HDF5_MOST_SETS], growing_headers[MOST_GROWING];
    bytes b = {0};
    put_front(&b, file, growing_headers);                    // for its size and places; the rest is not known yet
    if (b.size > FRONT) io_output_fail_memory(file->output); // no notes of ours are that long
    append(file, &b);
    size_t grown = 0;
    for (size_t i = 0; i < count; i++) {
        assert(i == 0 || strcmp(sets[i - 1].name, sets[i].name) < 0);
        headers[i] = sets[i].data ? write_fixed(file, &sets[i]) : growing_headers[grown++];
    }
    write_group(file, sets, headers, count, notes);
    put_front(&b, file, growing_headers);
    if (b.failed) io_output_fail_memory(file->output);
    else io_output_patch(file->output, 0, b.data, b.size);
    file->end = io_output_place(file->output);
    free(b.data);
}

static void release(io_hdf5 *file) {
    for (size_t i = 0; i < file->growing_count; i++) {
        free(file->growing[i].chunk);
        for (size_t l = 0; l < file->growing[i].level_count; l++) free(file->growing[i].levels[l]);
    }
    free(file->texts);
    free(file);
}

io_hdf5 *io_hdf5_begin(const char *path, const io_hdf5_set *sets, size_t count,
                       const io_hdf5_note notes[IO_HDF5_MOST_NOTES], skein_error *error) {
    assert(count > 0 && count <= IO_HDF5_MOST_SETS);
    io_hdf5 *file = calloc(1, sizeof *file);
    if (!file || !keep_growing(file, sets, count)) {
        if (file) release(file);
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return NULL;
    }
    file->leaf_k = count <= 2 * LEAF_K ? LEAF_K : LARGE_LEAF_K;
    file->output = io_output_open(path, error);
    if (!file->output) {
        release(file);
        return NULL;
    }
    write_beginning(file, sets, count, notes);
    if (!io_output_status(file->output, error)) return file;
    io_hdf5_abandon(file);
    return NULL;
}

/* ---- Ending --------------------------------------------------------------------------------------- */

skein_status io_hdf5_commit(io_hdf5 *file, skein_error *error) {
    publish(file, true);
    skein_status status = io_output_commit(file->output, error);
    release(file);
    return status;
}

uint64_t io_hdf5_round_off(io_hdf5 *file) {
    bool sound = !io_output_status(file->output, NULL) || file->no_room;
    io_output_cut(file->output, file->end);
    if (sound) publish(file, true); // which needs no room. Else what was published last stands
    return file->readable;
}

skein_status io_hdf5_keep(io_hdf5 *file, const char *path, skein_error *error) {
    skein_status status = io_output_keep(file->output, path, file->end, NULL, error);
    release(file);
    return status;
}

void io_hdf5_abandon(io_hdf5 *file) {
    if (!file) return;
    io_output_abandon(file->output);
    release(file);
}
