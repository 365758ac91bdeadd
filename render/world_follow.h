/* The body that a camera goes along with.
 *
 * A view names it; here it is found, with where it is now. Called by world_frame.c once a frame, and by those who want to
 * know beforehand whether there is such a body. */
#ifndef SKEIN_RENDER_WORLD_FOLLOW_H
#define SKEIN_RENDER_WORLD_FOLLOW_H

#include "render/subject.h"
#include "render/world_state.h"
#include "skein/skein.h"

typedef struct render_followed {
    bool any;
    double middle[3], radius; /* the mean of its particles, and how far they reach from it; metres */
} render_followed;

/* Whether `name` is a body's name or number, from 0, or "all". `body` gets its number, or SIZE_MAX for all. */
bool render_body_find(const skein_world *world, const char *name, size_t *body);
/* Nobody where the name is empty, or nobody's, or the body has no particles. The state knows whose its particles are. */
render_followed render_follow(const skein_world *world, const char *name, const render_world_state *state);
/* What a picture of it shows: some room around it, so that it may turn without coming closer to the edges. */
render_subject render_followed_subject(const render_followed *followed);

#endif
