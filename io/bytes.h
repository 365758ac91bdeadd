/* Numbers as bytes, in an order that is said, whatever the machine's is. For readers and writers of binary files. */
#ifndef SKEIN_IO_BYTES_H
#define SKEIN_IO_BYTES_H

#include <stdint.h>
#include <string.h>

static inline void io_put_u32(unsigned char *bytes, uint32_t value) {
    for (int k = 0; k < 4; k++) bytes[k] = (unsigned char)(value >> (8 * k));
}

static inline uint32_t io_get_u32(const unsigned char *bytes) {
    uint32_t value = 0;
    for (int k = 0; k < 4; k++) value |= (uint32_t)bytes[k] << (8 * k);
    return value;
}

/* The same with the highest byte first. */
static inline void io_put_u32_big(unsigned char *bytes, uint32_t value) {
    for (int k = 0; k < 4; k++) bytes[k] = (unsigned char)(value >> (24 - 8 * k));
}

static inline uint32_t io_float_bits(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static inline float io_bits_float(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void io_put_float(unsigned char *bytes, float value) {
    io_put_u32(bytes, io_float_bits(value));
}

static inline float io_get_float(const unsigned char *bytes) {
    return io_bits_float(io_get_u32(bytes));
}

#endif
