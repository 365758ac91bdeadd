/* How long a cloth takes that was let go from level and swings by pins. */
#ifndef SKEIN_TESTS_SWING_H
#define SKEIN_TESTS_SWING_H

#include "helpers.h"

/* When the middle of its `count` particles swings through below the pins, at `pins` along z, the second time. The world goes. */
static inline double time_of_swing_of(skein_world *world, size_t count, double pins) {
    double before = 0, when = 0;
    for (int n = 0, crossed = 0; n < 120 && crossed < 2; n++) {
        steps(world, 1, 1.0 / 60);
        double z = 0;
        for (size_t i = 0; i < count; i++) z += (position_of(world, i).z - pins) / (double)count;
        if (n && z * before < 0 && ++crossed == 2) when = (n + before / (before - z)) / 60;
        before = z;
    }
    skein_world_destroy(world);
    return when;
}

#endif
