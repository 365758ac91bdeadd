/* A lattice: a block of n x m x l particles with springs between neighbours. Jelly, beams, bars.
 *
 *   o---o---o---o   structural  to the 6 nearest, along the axes
 *   | X | X | X |   shear       to the 20 diagonal ones: 12 across faces, 8 across the body of a cell
 *   o---o---o---o   bending     2 apart, along the axes
 *   | X | X | X |   struts      one a line, from each face straight to the opposite one: they keep a cube
 *   o---o---o---o               that falls from high from folding into itself
 *
 * No pair gets two springs: a strut that is as long as a structural or bending spring is left out. Stiffness
 * is each spring's own, in N/m, whatever the resolution. */
#include <math.h>
#include <string.h>

#include "bodies/block.h"
#include "bodies/body.h"
#include "bodies/sheet.h"

typedef struct lattice_params {
    int32_t grid[3];
    double size[3], position[3], rotation[3], velocity[3];
    double mass, density;
    char *pins;
    sk_material structural, shear, bending;
    int32_t diagonals;
    bool bends, struts;
    double limit;
    int32_t look;
} lattice_params;

/* In the order of `shear.diagonals`. */
enum { DIAGONALS_ALL, DIAGONALS_OF_FACES, DIAGONALS_OF_BODY, DIAGONALS_NONE };

static const skein_field fields[] = {
    SK_INT3(lattice_params, grid, "grid", "", 8, 8, 8, 1, 65536, "particles along x, y and z; the last runs fastest"),
    SK_SIZE3(lattice_params, size, "size", "m", 1, 1, 1, "along x, y and z before it is turned"),
    SK_VEC3(lattice_params, position, "position", "m", 0, 0, 0, "where its middle is put"),
    SK_VEC3(lattice_params, rotation, "rotation", "deg", 0, 0, 0,
            "turned about x, then y, then z, before it is put there"),
    SK_VEC3(lattice_params, velocity, "velocity", "m/s", 0, 0, 0, "at the start"),
    SK_REAL(lattice_params, mass, "mass", "kg", 10, 1e-9, 1e12, "of all of it, shared out equally to the particles"),
    SK_REAL(lattice_params, density, "density", "kg/m3", 0, 0, 1e9, "instead of the mass, where it is over 0"),
    SK_TEXT(lattice_params, pins, "pins", "",
            "pinned particles: \"left face\" (right, bottom, top, back, front), \"corners\", numbers, "
            "\"box x y z x y z\", \"sphere x y z r\""),
    SK_REAL(lattice_params, structural.stiffness, "structural.stiffness", "N/m", 2000, 0, SK_UNBOUNDED,
            "of each spring along the axes"),
    SK_REAL(lattice_params, structural.damping, "structural.damping", "N s/m", 0, 0, SK_FAR, "of each"),
    SK_REAL(lattice_params, limit, "structural.limit", "", SK_UNBOUNDED, 0, SK_UNBOUNDED,
            "strain limit: none gets longer than rest times 1 + this; \"infinite\" is none"),
    SK_REAL(lattice_params, shear.stiffness, "shear.stiffness", "N/m", 1000, 0, SK_UNBOUNDED, "of each diagonal"),
    SK_REAL(lattice_params, shear.damping, "shear.damping", "N s/m", 0, 0, SK_FAR, "of each"),
    {"shear.diagonals",
     SKEIN_FIELD_CHOICE,
     offsetof(lattice_params, diagonals),
     "",
     {DIAGONALS_ALL, 0, 0},
     0,
     3,
     "all|faces|body|none",
     NULL,
     "which there are: across faces, across the body of a cell, both or none"},
    SK_REAL(lattice_params, bending.stiffness, "bending.stiffness", "N/m", 500, 0, SK_UNBOUNDED,
            "of each spring between particles 2 apart, and of each strut"),
    SK_REAL(lattice_params, bending.damping, "bending.damping", "N s/m", 0, 0, SK_FAR, "of each"),
    SK_BOOL(lattice_params, bends, "bending.springs", 1, "whether there are springs between particles 2 apart"),
    SK_BOOL(lattice_params, struts, "struts", 0, "whether there are struts from face to face, a line each"),
    SK_LOOK(lattice_params, look, SKEIN_LOOK_JELLY),
};

/* The body's batches, in the order of sweeps on the way forth; on the way back it is the opposite. */
enum { BENDING, STRUTS, BODY_DIAGONALS, FACE_DIAGONALS, STRUCTURAL, SORTS };

/* ---- particles ---- */

static void place_particles(sk_block *block, const lattice_params *params) {
    size_t i = 0;
    double step[3], start[3];
    for (int k = 0; k < 3; k++) {
        step[k] = block->size[k] > 1 ? params->size[k] / (block->size[k] - 1) : 0;
        start[k] = block->size[k] > 1 ? -0.5 * params->size[k] : 0;
    }
    for (uint32_t x = 0; x < block->size[0]; x++)
        for (uint32_t y = 0; y < block->size[1]; y++)
            for (uint32_t z = 0; z < block->size[2]; z++, i++) {
                block->position[i][0] = start[0] + x * step[0];
                block->position[i][1] = start[1] + y * step[1];
                block->position[i][2] = start[2] + z * step[2];
            }
    sk_points_transform(block->position, block->count, 1, params->rotation, params->position);
}

/* Faces go by index, however the lattice is turned; each word is an axis and an end of it. */
skein_status sk_lattice_choose_words(void *data, const char *words) {
    sk_block *block = data;
    static const char *const forms[] = {"left face", "right face", "bottom face", "top face",
                                        "back face", "front face", "corners",     "all"};
    enum { FORMS = sizeof forms / sizeof *forms, CORNERS = 6, ALL = 7 };
    int form = 0;
    while (form < FORMS && strcmp(words, forms[form]) != 0) form++;
    if (form == FORMS) {
        const char *nearest = sk_nearest_name(words, forms, FORMS);
        return sk_fail(block->error, SKEIN_ERROR_NAME, "pins",
                       "'%s' names no part of a lattice%s%s%s; expected numbers, \"left face\" (right, bottom, top, "
                       "back, front), \"corners\", \"all\", \"box x y z x y z\" or \"sphere x y z radius\"",
                       words, nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
    }
    size_t m = block->size[1], l = block->size[2];
    for (size_t i = 0; i < block->count; i++) {
        size_t at[3] = {i / l / m, i / l % m, i % l};
        bool low[3], high[3], corner = true;
        for (int k = 0; k < 3; k++) {
            low[k] = at[k] == 0, high[k] = at[k] + 1 == block->size[k];
            corner &= low[k] || high[k];
        }
        if (form == ALL || (form == CORNERS && corner) || (form < CORNERS && (form % 2 ? high : low)[form / 2]))
            block->pinned[i] = true;
    }
    return SKEIN_OK;
}

/* ---- springs ---- */

/* Adds directions of a sort to a list, with the rest length that the lattice's spacing gives them. */
static size_t note_directions(const sk_block *block, const lattice_params *params, const int32_t (*steps)[3],
                              size_t count, sk_block_springs *springs) {
    for (size_t d = 0; d < count; d++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            double way = block->size[k] > 1 ? steps[d][k] * params->size[k] / (block->size[k] - 1) : 0;
            square += way * way;
        }
        memcpy(springs[d].step, steps[d], sizeof springs[d].step);
        springs[d].rest = sqrt(square);
        springs[d].scale = 1;
    }
    return count;
}

/* Struts of the axes that have room for one which is not a structural or a bending spring already. */
static size_t strut_steps(const sk_block *block, bool bends, int32_t (*steps)[3]) {
    size_t count = 0;
    for (int axis = 2; axis >= 0; axis--) {
        uint32_t way = block->size[axis] - 1;
        if (way < 2 || (way == 2 && bends)) continue;
        memset(steps[count], 0, sizeof steps[count]);
        steps[count++][axis] = (int32_t)way;
    }
    return count;
}

static skein_status add_springs(sk_block *block, const lattice_params *params) {
    static const int32_t structural[3][3] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
                         bending[3][3] = {{0, 0, 2}, {0, 2, 0}, {2, 0, 0}},
                         faces[6][3] = {{0, 1, -1}, {0, 1, 1}, {1, -1, 0}, {1, 0, -1}, {1, 0, 1}, {1, 1, 0}},
                         body[4][3] = {{1, -1, -1}, {1, -1, 1}, {1, 1, -1}, {1, 1, 1}};
    int32_t struts[3][3];
    size_t strut_count = params->struts ? strut_steps(block, params->bends, struts) : 0;
    bool across_faces = params->diagonals == DIAGONALS_ALL || params->diagonals == DIAGONALS_OF_FACES,
         across_body = params->diagonals == DIAGONALS_ALL || params->diagonals == DIAGONALS_OF_BODY;
    const struct {
        const char *label;
        const sk_material *material;
        const int32_t (*steps)[3];
        size_t count;
    } sorts[SORTS] = {
        [BENDING] = {"bending", &params->bending, bending, params->bends ? 3 : 0},
        [STRUTS] = {"strut", &params->bending, (const int32_t(*)[3])struts, strut_count},
        [BODY_DIAGONALS] = {"body diagonal", &params->shear, body, across_body ? 4 : 0},
        [FACE_DIAGONALS] = {"face diagonal", &params->shear, faces, across_faces ? 6 : 0},
        [STRUCTURAL] = {"structural", &params->structural, structural, 3},
    };
    for (int s = 0; s < SORTS; s++) {
        sk_block_springs springs[6];
        size_t count = note_directions(block, params, sorts[s].steps, sorts[s].count, springs);
        skein_status status =
            sk_block_add_springs(block, sorts[s].label, *sorts[s].material, s == STRUCTURAL, springs, count);
        if (status) return status;
        sk_world_sweep_both_ways(block->body);
    }
    sk_world_add_strain_limit(block->body);
    return SKEIN_OK;
}

/* ---- the type ---- */

static bool live(const void *params, const char *field) {
    (void)params;
    static const char *const names[] = {
        "structural.stiffness", "structural.damping", "structural.limit", "shear.stiffness",
        "shear.damping",        "bending.stiffness",  "bending.damping",  "look"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(field, names[i])) return true;
    return false;
}

static void change(sk_body *body, const void *data) {
    const lattice_params *params = data;
    *body->material[BENDING] = *body->material[STRUTS] = params->bending;
    *body->material[BODY_DIAGONALS] = *body->material[FACE_DIAGONALS] = params->shear;
    *body->material[STRUCTURAL] = params->structural;
    body->strain_bound = params->limit;
}

static skein_status build(skein_world *world, sk_body *body, const void *data, const skein_mesh *mesh,
                          skein_error *error) {
    const lattice_params *params = data;
    if (mesh) return sk_fail(error, SKEIN_ERROR_VALUE, "mesh", "a lattice is made from its grid, not from a mesh");
    sk_block block = {.world = world, .body = body, .error = error};
    for (int k = 0; k < 3; k++) block.size[k] = (uint32_t)params->grid[k];
    double volume = params->size[0] * params->size[1] * params->size[2];
    double mass = params->density > 0 ? params->density * volume : params->mass;
    skein_status status = sk_block_begin(&block);
    if (!status) {
        place_particles(&block, params);
        status = sk_block_add_particles(&block, mass, params->velocity, params->pins, sk_lattice_choose_words);
    }
    if (!status) status = sk_block_add_strips(&block);
    if (!status) status = add_springs(&block, params);
    if (!status) status = sk_block_add_surface(&block);
    if (!status) change(body, params);
    sk_block_release(&block);
    return status;
}

const sk_body_type sk_lattice = {
    .kind = {"lattice",
             "a block of particles with springs to its neighbours: along the axes, across, two apart, face to face",
             SKEIN_BODY, fields, sizeof fields / sizeof *fields, sizeof(lattice_params)},
    .build = build,
    .live = live,
    .change = change,
};
