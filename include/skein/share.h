/* Runs that several processes share: each steps a part of the particles, and sees those of the others that are near.
 *
 *   the whole run's world    steps by a *runner*, the program, which has parts of it stepped wherever they are
 *   a part's world           has room for some of the particles; before neighbours are looked for it asks the program for
 *                            what lies at its border
 *
 *     particles of a loose body there:   | own . . . . . | others', only looked at . . | room, nowhere |
 *
 * A *loose* body's particles (a flock's) may lie in any part; one whose particles are joined, or led, lives whole in one, and
 * is not enabled in the others, or a shadow there. What it is to meet comes to it, and it to others, as what lies at the border.
 *
 * Sums over neighbours have the bits of one world that has all particles: cells are laid over the whole run's box, and
 * particles stand in a cell by their numbers in the whole run. `ranks/` shares runs so over the ranks of an MPI job. */
#ifndef SKEIN_SHARE_H
#define SKEIN_SHARE_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

/* The state of a world, to be read and changed. Particle i is in slot slot_of[i], and particle_of[s] in slot s, or
 * UINT32_MAX, nobody. A slot has x, y, z and the inverse mass (m, 1/kg), or the velocity and the mass (m/s, kg). */
typedef struct skein_state {
    size_t count, slot_count;
    const uint32_t *slot_of, *particle_of;
    skein_real (*position)[4], (*velocity)[4];
} skein_state;

/* The cells that neighbours are looked for in. Along an axis a place is in cell (place - origin) * per, rounded down, at
 * least 0 and less than `count`. A particle looks at no cell more than `around` cells from its own. */
typedef struct skein_cells {
    skein_real origin[3], per[3];
    int32_t count[3], around[3];
} skein_cells;

/* Where all particles of the whole run are. */
typedef struct skein_border {
    skein_real low[3], high[3]; /* the box around all that are somewhere; m */
    size_t everybody;           /* how many there are in the run */
    bool alone;                 /* they are all in this part: there is nothing at its border, and no exchange */
} skein_border;

/* Of a rule that looks at neighbours: who looks, and at whom, as ranges of this world's particles. Each is of whole bodies. */
typedef struct skein_share_look {
    size_t first, end, seen_first, seen_end;
} skein_share_look;

/* Who is farther out along an axis is nowhere, and in no cell; nor is a number that is not finite. */
#define SKEIN_SHARE_FARTHEST ((skein_real)(sizeof(skein_real) == 8 ? 1.7976931348623157e308 / 4 : 3.40282347e38 / 4))

typedef struct skein_part {
    void *user;
    /* What the whole run calls each particle of this world, `count` numbers; they may change whenever the program is
     * asked. */
    const uint32_t *number;
    /* Fills in where all are that are seen. */
    bool (*measure)(void *user, const skein_share_look *look, const skein_state *state, skein_border *border);
    /* Sends the other parts what they look at: those of its own that are seen, in the cells around others'. The state is only read. What
     * is sent may be under way until receive() is asked: meanwhile the world finds the cells of its own. */
    bool (*send)(void *user, const skein_share_look *look, const skein_cells *cells, const skein_state *state);
    /* Has all seen ones in the cells around those that look here among the particles of the loose bodies that are seen, behind
     * those of its own and with inverse mass 0, or of a shadow, and the rest of those nowhere. False where it cannot: the step fails. These
     * are asked in each substep, once for each rule that looks at neighbours, on the thread that steps. */
    bool (*receive)(void *user, const skein_share_look *look, const skein_cells *cells, const skein_state *state);
} skein_part;

/* Makes the world a part of a run (copied), or with NULL a whole one. The world then has rules that can be shared: the next
 * step says which cannot (SKEIN_ERROR_VALUE), as skein_world_can_share() does. */
skein_status skein_world_part_set(skein_world *world, const skein_part *part);
/* Makes a body of a part's world a shadow of what lives in another: its particles are there, nothing joins them any more, and
 * where they are an exchange says. Bodies count in the order of their making; SKEIN_ERROR_VALUE for one that is not there. */
skein_status skein_world_part_shadow(skein_world *world, size_t body);
/* Whether a run of this world, in steps of `dt` seconds, can be shared; SKEIN_ERROR_VALUE says what of it cannot. */
skein_status skein_world_can_share(skein_world *world, double dt);
/* A body of a run that can be shared. */
typedef struct skein_share_body {
    size_t first, count; /* its particles */
    bool enabled;
    bool loose;      /* nothing joins or leads its particles, and its kind has a `count` of them */
    size_t together; /* it stays in one part with all bodies of the same number: that of the first of them. Loose ones
                              are with nobody */
    bool shown;      /* a rule on it, and not on the loose ones, looks at those or is looked at: where it does not
                              live it has to be as a shadow */
    double work;     /* about what a step of it costs: how often a constraint or a particle is dealt with */
} skein_share_body;
/* The bodies of a run, in the order of their making, `most` of them at most in `out` (which may be NULL if that is 0);
 * `count` receives how many there are. SKEIN_ERROR_VALUE where the run cannot be shared. */
skein_status skein_world_share_bodies(skein_world *world, double dt, skein_share_body *out, size_t most, size_t *count);
/* The state, to be changed until the next call on the world. */
skein_status skein_world_state(skein_world *world, skein_state *state);

/* Where such a world is stepped, as skein_world_device() says; it cannot be asked of skein_world_device_set(). */
#define SKEIN_DEVICE_SHARED ((skein_device)3)

/* Who steps a whole run's world instead of the world itself. */
typedef struct skein_runner {
    const char *name; /* what skein_world_device() says; as long as the runner is the world's */
    void *user;
    /* One step from `time` on. `state` is what it begins with, if that was changed since it last ended; else NULL. */
    skein_status (*step)(void *user, double time, double dt, const skein_state *state, skein_error *error);
    /* Puts the state as it is now into `state`, and the positions before the last step into `previous`. */
    skein_status (*read)(void *user, const skein_state *state, skein_real (*previous)[4], skein_error *error);
    void (*release)(void *user); /* when the world goes, or takes another; NULL: nothing is to be released */
} skein_runner;

/* Has the world stepped by a runner (copied; the world releases it), or with NULL by itself. On failure the runner stays the
 * caller's. */
skein_status skein_world_runner_set(skein_world *world, const skein_runner *runner);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
