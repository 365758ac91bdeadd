/* Finding the body that a camera goes along with; see world_follow.h. */
#include "render/world_follow.h"

#include "render/linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The room around it, in its own radii. */
static const double room = 1.25;

bool render_body_find(const skein_world *world, const char *name, size_t *body) {
    size_t count = skein_object_count(world, SKEIN_BODY);
    *body = SIZE_MAX;
    for (size_t i = 0; i < count && name[0]; i++) {
        skein_value value;
        bool named = !skein_get(world, skein_object_at(world, SKEIN_BODY, i), "name", &value) && value.text;
        if (named && !strcmp(value.text, name)) *body = i;
        if (*body == i) return true;
    }
    if (!strcmp(name, "all")) return count > 0;
    char *end;
    unsigned long long number = strtoull(name, &end, 10);
    bool good = name[0] >= '0' && name[0] <= '9' && !*end && number < count;
    if (good) *body = (size_t)number;
    return good;
}

/* The next particle of the body (or of any: SIZE_MAX) that has a place, from `p` on; SIZE_MAX after the last. */
static size_t next_particle(const render_world_state *state, size_t body, size_t p) {
    for (; p < state->particle_count; p++) {
        const double *x = &state->positions[3 * p];
        bool its = body == SIZE_MAX || state->body[p] == body;
        if (its && isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2])) return p;
    }
    return SIZE_MAX;
}

render_followed render_follow(const skein_world *world, const char *name, const render_world_state *state) {
    render_followed followed = {false, {0, 0, 0}, 0};
    size_t body, count = 0;
    if (!name || !name[0] || !render_body_find(world, name, &body)) return followed;
    for (size_t p = 0; (p = next_particle(state, body, p)) != SIZE_MAX; p++, count++)
        for (int k = 0; k < 3; k++) followed.middle[k] += state->positions[3 * p + (size_t)k];
    for (int k = 0; k < 3 && count; k++) followed.middle[k] /= (double)count;
    for (size_t p = 0; (p = next_particle(state, body, p)) != SIZE_MAX; p++) {
        double off[3];
        for (int k = 0; k < 3; k++) off[k] = state->positions[3 * p + (size_t)k] - followed.middle[k];
        followed.radius = fmax(followed.radius, sqrt(render_dot(off, off)));
    }
    followed.any = count > 0;
    return followed;
}

render_subject render_followed_subject(const render_followed *followed) {
    render_subject subject = render_subject_nothing();
    render_hull_add(&subject.bodies, followed->middle, room * followed->radius);
    subject.all = subject.bodies;
    return subject;
}
