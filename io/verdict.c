/* The judgement of a run: its energy, stretch and speed at the end, against what they were as it went on. */
#include "io/verdict.h"

#include <math.h>

/* Energy may not have grown by more than this share of the kinetic energy that there was at the most, while as much of
 * what it grew by still moves: methods of the first order make some, and contact pushes things up. Elastic energy does
 * not tell: stiff springs that position methods have not yet solved hold much of it, for a while. Nor is the rounding
 * of potential energy, a difference of large numbers, any growth. */
static const double most_growth = 0.5, moving_share = 0.3, rounding = 1e-3;

io_verdict io_verdict_begin(skein_world *world, double most_stretch, const skein_statistics *start) {
    // what begins inside a collider is pushed out of it
    bool driven = start->max_penetration > 0 || skein_world_is_driven(world);
    io_verdict v = {.most_stretch = most_stretch,
                    .driven = driven,
                    .start_stretch = start->max_stretch,
                    .start_elastic = start->elastic_energy};
    io_verdict_note(&v, start);
    return v;
}

void io_verdict_note(io_verdict *v, const skein_statistics *now) {
    v->most_moving = fmax(v->most_moving, now->kinetic_energy);
    v->most_potential = fmax(v->most_potential, fabs(now->potential_energy));
}

/* A scene that begins with long edges may keep them. */
static bool is_torn(const io_verdict *v, const skein_statistics *end) {
    return end->max_stretch > v->most_stretch && end->max_stretch > 1.01 * v->start_stretch;
}

static bool has_grown(const io_verdict *v, const skein_statistics *end, double growth) {
    return !v->driven && growth > most_growth * v->most_moving && growth > rounding * v->most_potential &&
           end->kinetic_energy > moving_share * fmax(v->most_moving, growth);
}

io_ending io_verdict_end(io_verdict *v, const skein_statistics *end, double *growth) {
    io_verdict_note(v, end);
    *growth = -end->dissipated_energy - fmax(end->elastic_energy - v->start_elastic, 0);
    return is_torn(v, end) ? IO_ENDED_TORN : has_grown(v, end, *growth) ? IO_ENDED_GROWN : IO_ENDED_WELL;
}

static bool all_finite(const skein_view *view) {
    for (size_t i = 0; i < view->count; i++) {
        const skein_real *p = view->xyzw + 4 * (size_t)view->slot_of[i];
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) return false;
    }
    return true;
}

bool io_is_finite(const skein_world *world) {
    skein_view x = skein_position_view(world), v = skein_velocity_view(world);
    return all_finite(&x) && all_finite(&v);
}
