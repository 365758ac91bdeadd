/* A curve through space, and sorting along it. */
#include "contact/make/curve.h"

#include <string.h>

/* Every third bit: those of a number of ten bits. */
static uint32_t spread(uint32_t a) {
    uint32_t all = 0;
    for (uint32_t bit = 0; bit < 10; bit++) all |= (a >> bit & 1) << (3 * bit);
    return all;
}

sk_curve sk_curve_through(sk_vec3 low, sk_vec3 high) {
    real size = sk_max(high.x - low.x, sk_max(high.y - low.y, high.z - low.z));
    return (sk_curve){low, size > 0 ? (real)1023.0 / size : 0};
}

uint64_t sk_curve_place(const sk_curve *c, sk_vec3 b) {
    uint32_t x = (uint32_t)(sk_max(0, b.x - c->low.x) * c->per), y = (uint32_t)(sk_max(0, b.y - c->low.y) * c->per),
             z = (uint32_t)(sk_max(0, b.z - c->low.z) * c->per);
    return spread(x & 1023) | spread(y & 1023) << 1 | spread(z & 1023) << 2;
}

/* By bytes. */
void sk_sort_by_place(uint64_t *place, uint32_t *number, uint64_t *other_place, uint32_t *other, size_t count) {
    for (int shift = 0; shift < 64; shift += 8) {
        size_t start[257] = {0};
        for (size_t i = 0; i < count; i++) start[(place[i] >> shift & 255) + 1]++;
        for (int i = 0; i < 256; i++) start[i + 1] += start[i];
        for (size_t i = 0; i < count; i++) {
            size_t to = start[place[i] >> shift & 255]++;
            other_place[to] = place[i], other[to] = number[i];
        }
        memcpy(place, other_place, count * sizeof *place);
        memcpy(number, other, count * sizeof *number);
    }
}
