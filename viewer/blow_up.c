/* Finding what went first; see blow_up.h. A step has the same bits each time, so it happens again as it did. */
#include "viewer/blow_up.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Places beyond this are no scene's any more, m. */
static const double far_away = 1e12;

/* The first particle that is not finite; UINT32_MAX: all are. */
static uint32_t first_lost(const skein_world *world) {
    skein_view view = skein_position_view(world);
    for (size_t i = 0; i < view.count; i++) {
        const skein_real *p = view.xyzw + 4 * (size_t)view.slot_of[i];
        for (int k = 0; k < 3; k++)
            if (!(fabs((double)p[k]) < far_away)) return (uint32_t)i;
    }
    return UINT32_MAX;
}

bool viewer_is_finite(const skein_world *world) {
    // a particle that blew up takes its neighbours along: one in some tells
    skein_view view = skein_position_view(world);
    for (size_t i = 0; i < view.count; i += view.count / 64 + 1) {
        const skein_real *p = view.xyzw + 4 * (size_t)view.slot_of[i];
        for (int k = 0; k < 3; k++)
            if (!(fabs((double)p[k]) < far_away)) return false;
    }
    return true;
}

/* The body that has the particle, by its name or kind and number, and the particle's number in it. */
static void name_particle(const skein_world *world, uint32_t particle, char *out, size_t size) {
    for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, b);
        skein_surface s;
        skein_value name = {0, {0, 0, 0}, NULL};
        if (skein_body_surface(world, body, &s)) continue;
        if (particle < s.first_particle || particle >= s.first_particle + s.particle_count) continue;
        bool named = !skein_get(world, body, "name", &name) && name.text && name.text[0];
        snprintf(out, size, "particle %u of body %zu, %.40s", particle - s.first_particle, b,
                 named ? name.text : skein_object_kind(world, body)->name);
        return;
    }
    snprintf(out, size, "particle %u", particle);
}

/* The spring that is stretched or pressed most, relative to its length; false where there is none. */
static bool find_worst(skein_world *world, skein_spring *worst) {
    size_t count = 0;
    bool found = false;
    if (skein_springs_copy(world, NULL, 0, &count) || !count) return false;
    skein_spring *springs = malloc(count * sizeof *springs);
    if (springs && !skein_springs_copy(world, springs, count, &count))
        for (size_t i = 0; i < count; i++) {
            double strain = fabs((double)springs[i].strain);
            if (!isfinite(strain) || (found && strain <= fabs((double)worst->strain))) continue;
            *worst = springs[i];
            found = true;
        }
    free(springs);
    return found;
}

/* Back to the last kept frame of which all is finite. */
static bool go_back(viewer_player *player, uint64_t *frame) {
    const viewer_history *history = &player->history;
    for (uint64_t f = history->last + 1; !history->empty && f-- > history->first;)
        if (viewer_player_go_to(player, f) && first_lost(player->world) == UINT32_MAX) {
            *frame = f;
            return true;
        }
    return false;
}

bool viewer_explain_blow_up(viewer_player *player, char *words, size_t size) {
    uint64_t frame = 0;
    uint32_t lost = UINT32_MAX;
    skein_spring worst;
    char who[140], spring[200] = "";
    bool stretched = false;
    snprintf(words, size, "the state is not finite any more");
    if (!go_back(player, &frame)) return false;
    skein_world *world = player->world;
    for (int step = 0; step < 2 * player->steps && lost == UINT32_MAX; step++) {
        skein_spring before;
        bool some = find_worst(world, &before);
        if (skein_world_step(world, player->dt)) break;
        lost = first_lost(world);
        if (some) worst = before, stretched = true;
    }
    if (stretched && fabs((double)worst.strain) > 0.5) {
        char end[80];
        name_particle(world, worst.particle[0], end, sizeof end);
        snprintf(spring, sizeof spring, "; before that, the spring from %s to particle %u was longer by %.3g %%", end,
                 worst.particle[1], 100 * (double)worst.strain);
    }
    if (lost != UINT32_MAX) name_particle(world, lost, who, sizeof who);
    double time = skein_world_time(world);
    // a frame begins anew: the branch that blew up is forgotten when it goes on
    bool back = viewer_player_go_to(player, frame);
    if (lost != UINT32_MAX)
        snprintf(words, size, "it blew up: first %s, at %.4g s%s. Back at frame %" PRIu64 ", the last good one", who,
                 time, spring, frame);
    return back;
}
