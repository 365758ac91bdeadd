/* Numbers as bytes, least significant first on every machine: the format of snapshots and journals of inputs.
 *
 * A writer without memory only counts, so that one function both finds the size and writes. A reader never goes beyond
 * its end: what is missing reads as 0, and sets `short_` for good. */
#ifndef SK_BASE_BYTES_H
#define SK_BASE_BYTES_H

#include <skein/skein.h>
#include <string.h>

#include "base/hash.h"

typedef struct sk_byte_writer {
    unsigned char *out; /* NULL: only counted */
    size_t size, at;    /* the size of `out`, and the place of the next byte; nothing is written beyond `size` */
} sk_byte_writer;

static inline void sk_put(sk_byte_writer *w, const void *bytes, size_t size) {
    if (size && w->out && w->at <= w->size && size <= w->size - w->at) memcpy(w->out + w->at, bytes, size);
    w->at += size;
}

static inline void sk_put_word(sk_byte_writer *w, uint64_t word, size_t bytes) {
    unsigned char byte[8];
    for (size_t i = 0; i < bytes; i++) byte[i] = (unsigned char)(word >> 8 * i);
    sk_put(w, byte, bytes);
}

static inline void sk_put_u8(sk_byte_writer *w, unsigned x) {
    sk_put_word(w, x, 1);
}
static inline void sk_put_u32(sk_byte_writer *w, uint32_t x) {
    sk_put_word(w, x, 4);
}
static inline void sk_put_u64(sk_byte_writer *w, uint64_t x) {
    sk_put_word(w, x, 8);
}
static inline void sk_put_f64(sk_byte_writer *w, double x) {
    uint64_t word;
    memcpy(&word, &x, sizeof word);
    sk_put_u64(w, word);
}
static inline void sk_put_real(sk_byte_writer *w, skein_real x) {
    uint64_t word = 0;
    if (sizeof x == 4) {
        uint32_t half;
        memcpy(&half, &x, sizeof half);
        word = half;
    } else {
        memcpy(&word, &x, sizeof x);
    }
    sk_put_word(w, word, sizeof x);
}
/* A text with its size and its zero byte, so that a reader can use it in place. */
static inline void sk_put_text(sk_byte_writer *w, const char *text) {
    size_t size = strlen(text) + 1;
    sk_put_u32(w, (uint32_t)size);
    sk_put(w, text, size);
}

typedef struct sk_byte_reader {
    const unsigned char *in;
    size_t size, at;
    bool short_; /* a read went beyond the end, or found a text that is none */
} sk_byte_reader;

static inline size_t sk_left(const sk_byte_reader *r) {
    return r->size - r->at;
}

/* The next `size` bytes in place, or NULL if there are not as many. */
static inline const unsigned char *sk_take(sk_byte_reader *r, size_t size) {
    if (r->short_ || size > sk_left(r)) {
        r->short_ = true;
        return NULL;
    }
    const unsigned char *at = r->in + r->at;
    r->at += size;
    return at;
}

static inline uint64_t sk_take_word(sk_byte_reader *r, size_t bytes) {
    const unsigned char *at = sk_take(r, bytes);
    uint64_t word = 0;
    for (size_t i = 0; at && i < bytes; i++) word |= (uint64_t)at[i] << 8 * i;
    return word;
}

static inline unsigned sk_take_u8(sk_byte_reader *r) {
    return (unsigned)sk_take_word(r, 1);
}
static inline uint32_t sk_take_u32(sk_byte_reader *r) {
    return (uint32_t)sk_take_word(r, 4);
}
static inline uint64_t sk_take_u64(sk_byte_reader *r) {
    return sk_take_word(r, 8);
}
static inline double sk_take_f64(sk_byte_reader *r) {
    uint64_t word = sk_take_u64(r);
    double x;
    memcpy(&x, &word, sizeof x);
    return x;
}
static inline skein_real sk_take_real(sk_byte_reader *r) {
    skein_real x;
    if (sizeof x == 4) {
        uint32_t half = sk_take_u32(r);
        memcpy(&x, &half, sizeof half);
    } else {
        uint64_t word = sk_take_u64(r);
        memcpy(&x, &word, sizeof x);
    }
    return x;
}
/* A text in place; NULL if there is none, or it does not end where its size says. */
static inline const char *sk_take_text(sk_byte_reader *r) {
    uint32_t size = sk_take_u32(r);
    const unsigned char *at = sk_take(r, size);
    if (at && (!size || at[size - 1] || memchr(at, 0, size) != at + size - 1)) r->short_ = true;
    return at && !r->short_ ? (const char *)at : NULL;
}

/* A checksum that detects changed bytes. */
static inline uint64_t sk_byte_sum(const void *bytes, size_t size) {
    uint64_t sum = sk_hash_word(SK_HASH_START, size);
    sk_byte_reader r = {bytes, size, 0, false};
    while (sk_left(&r) >= 8) sum = sk_hash_word(sum, sk_take_u64(&r));
    return sk_left(&r) ? sk_hash_word(sum, sk_take_word(&r, sk_left(&r))) : sum;
}

#endif
