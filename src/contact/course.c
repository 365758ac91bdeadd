/* Where vertices are expected, and who is elsewhere: all that a substep asks for while nothing comes near anything. Courses
 * lie in a frame that goes as most vertices do, where none is pinned: what falls keeps to its courses. */
#include <string.h>

#include "base/kernels.h"
#include "contact/touch.h"
#define SK_UNIT course
SK_KERNELS(sk_course_kernel, off);

#ifdef SK_ISA
#include "contact/lanes.h"

bool SK_KERNEL(off)(const sk_vec4 *x, const sk_vec4 *before, size_t packed, size_t slots, const sk_course_block *block,
                    real time, const sk_vec3 *shift, const sk_vec3 *gone, real jump, uint16_t *off, real *way) {
    const sk_wide t = sk_splat(time), sx = sk_splat(shift->x), sy = sk_splat(shift->y), sz = sk_splat(shift->z);
    const sk_wide gx = sk_splat(gone->x), gy = sk_splat(gone->y), gz = sk_splat(gone->z);
    sk_wide farthest = sk_splat(0);
    uint32_t any = 0;
    for (size_t b = 0; b < slots / 16; b++) {
        uint32_t bits = 0;
        for (size_t part = 0; part < SK_PARTS; part++) {
            size_t l = part * SK_PART;
            sk_wide4 at = sk_load_part(x, 16 * b + l, 16 * b < packed);
            const sk_wide3 step = {*sk_row(block[b].step[0] + l), *sk_row(block[b].step[1] + l),
                                   *sk_row(block[b].step[2] + l)};
            const sk_wide square = *sk_row(block[b].square + l);
            sk_wide3 r = {at.x - sx - *sk_row(block[b].from[0] + l) - t * step.x,
                          at.y - sy - *sk_row(block[b].from[1] + l) - t * step.y,
                          at.z - sz - *sk_row(block[b].from[2] + l) - t * step.z};
            bits |= sk_more_bits(sk_dot_wide(r, r), square) << l;
            if (!before) continue;
            sk_wide4 was = sk_load_part(before, 16 * b + l, 16 * b < packed);
            sk_wide3 j = {at.x - was.x - gx - step.x, at.y - was.y - gy - step.y, at.z - was.z - gz - step.z};
            const sk_mask here = sk_more(sk_splat(SK_REAL_MAX / 2), square); // who has no course never jumps
            bits |= sk_more_bits(sk_keep(here, sk_dot_wide(j, j)), sk_splat(jump)) << l;
            sk_wide3 w = {at.x - was.x, at.y - was.y, at.z - was.z};
            sk_wide gone_on = sk_keep(here, sk_dot_wide(w, w));
            farthest = sk_select(sk_more(gone_on, farthest), gone_on, farthest);
        }
        off[b] = (uint16_t)bits;
        any |= bits;
    }
    for (size_t l = 0; l < SK_PART && before; l++) *way = sk_max(*way, farthest[l]);
    return any;
}
#else
sk_course_kernel *const sk_course_off[SK_ISA_COUNT] = SK_EACH_ISA(off);

void sk_touch_put_course(sk_touch *touch, size_t v, bool wild) {
    sk_course_block *block = &touch->course_block[touch->slot[v] / 16];
    size_t l = touch->slot[v] % 16;
    const sk_course *course = &touch->course[v];
    block->from[0][l] = course->from.x, block->from[1][l] = course->from.y, block->from[2][l] = course->from.z;
    block->step[0][l] = course->step.x, block->step[1][l] = course->step.y, block->step[2][l] = course->step.z;
    bool none = wild || sk_vertex_is_out(&touch->spread, v);
    block->square[l] = none ? SK_REAL_MAX : course->reach * course->reach;
    touch->wild_count += (size_t)wild - touch->wild[v];
    touch->wild[v] = wild;
}

bool sk_touch_mark_lost(sk_touch *touch, const sk_vec4 *x, size_t packed, real time, int after) {
    memset(touch->lost, 0, touch->skin.vertex_count);
    const real jump = sk_most_jump(touch);
    const sk_vec3 gone = sk_sub(touch->shift[1], touch->shift[0]);
    real way = 0;
    bool any = sk_course_off[touch->isa](x, after ? touch->before : NULL, packed, touch->slots, touch->course_block,
                                         time, &touch->shift[after], &gone, jump * jump, touch->off, &way);
    touch->farthest = sk_sqrt(way);
    if (!any) return false;
    for (size_t b = 0; b < touch->slots / 16; b++)
        for (uint32_t bits = touch->off[b]; bits; bits &= bits - 1)
            touch->lost[touch->vertex_at[16 * b + (size_t)__builtin_ctz(bits)]] = 1;
    return true;
}

real sk_touch_farthest(sk_touch *touch, const sk_vec4 *x, size_t packed) {
    const sk_vec3 none = {0, 0, 0};
    real way = 0;
    if (touch->wild_count || !touch->before) return SK_REAL_MAX; // of those nobody knows
    sk_course_off[touch->isa](x, touch->before, packed, touch->slots, touch->course_block, 0, &none, &none, 0,
                              touch->off, &way);
    return sk_sqrt(way);
}

/* ---- the frame ---- */

enum { SAMPLES = 33 };

static real middle_of(real value[SAMPLES], int count) {
    for (int i = 1; i < count; i++) {
        real a = value[i];
        int to = i;
        for (; to && value[to - 1] > a; to--) value[to] = value[to - 1];
        value[to] = a;
    }
    return value[count / 2];
}

void sk_touch_set_frame(sk_touch *touch, const sk_vec4 *x, size_t packed, real time, int after) {
    real off[3][SAMPLES];
    int count = 0;
    size_t vertices = touch->skin.vertex_count;
    touch->shift[after] = (sk_vec3){0, 0, 0};
    if (touch->held) return;
    for (size_t i = 0; i < SAMPLES; i++) {
        size_t v = (2 * i + 1) * vertices / (2 * SAMPLES);
        if (touch->wild[v] || sk_vertex_is_out(&touch->spread, v)) continue;
        sk_vec3 r = sk_sub(sk_xyz(sk_load(x, packed, touch->slot[v])), sk_expected(&touch->course[v], time));
        if (!(sk_dot(r, r) < (real)1e12)) continue; // blown up
        off[0][count] = r.x, off[1][count] = r.y, off[2][count++] = r.z;
    }
    if (!count) touch->shift[after] = touch->shift[0];
    else touch->shift[after] = (sk_vec3){middle_of(off[0], count), middle_of(off[1], count), middle_of(off[2], count)};
}
#endif
