/* Cloth from any mesh: a particle a vertex, springs along edges and across quads, angles or springs at folds.
 *
 *   sheet (mesh or grid, placed, welded) --> springs --> pins --> particles, batches, triangles, tethers
 *
 * Stiffness is the material's, in N/m of a sheet, shared out to springs by the area that each stands
 * for, so that a cloth hangs and swings the same at any resolution. */
#include <math.h>
#include <string.h>

#include "bodies/aggregate.h"
#include "bodies/body.h"
#include "bodies/coarse.h"
#include "bodies/fabrics.h"
#include "bodies/faults.h"
#include "bodies/geodesic.h"
#include "bodies/hinges.h"
#include "bodies/lines.h"
#include "bodies/order.h"
#include "bodies/quads.h"
#include "bodies/sheet.h"
#include "bodies/sheet_selection.h"
#include "bodies/spans.h"
#include "bodies/springs.h"

typedef struct cloth_params {
    char *mesh;
    int32_t grid[2];
    double size[2], position[3], rotation[3], scale, velocity[3];
    int32_t fabric;
    double density, weld;
    char *pins;
    sk_material stretch, shear, bend;
    int32_t diagonals, bending;
    double rigidity;
    double tether, limit, tear;
    double thickness, friction;
    int32_t look;
} cloth_params;

/* The choices of "shear.diagonals". */
enum { SPRINGS, TIES, BY_PINS };

/* The choices of "bend.by". */
enum { BY_SPRINGS, BY_ANGLE, BY_CURVATURE, BY_LINES, BY_SHAPE };

static const skein_field fields[] = {
    SK_TEXT(cloth_params, mesh, "mesh", "",
            "file of a mesh, OBJ, OFF, PLY, STL or glTF (in scenes; a program passes the mesh itself)"),
    SK_INT2(cloth_params, grid, "grid", "", 0, 0, 0, 65536, "instead of a mesh: rows and columns of particles"),
    SK_REAL2(cloth_params, size, "size", "m", 1, 1, 1e-6, 1e9, "of a grid, along x and z before it is turned"),
    SK_VEC3(cloth_params, position, "position", "m", 0, 0, 0, "where the mesh's origin (a grid's middle) is put"),
    SK_VEC3(cloth_params, rotation, "rotation", "deg", 0, 0, 0,
            "turned about x, then y, then z, before it is put there"),
    SK_REAL(cloth_params, scale, "scale", "", 1, 1e-9, 1e9, "factor on the mesh's coordinates"),
    SK_VEC3(cloth_params, velocity, "velocity", "m/s", 0, 0, 0, "at the start"),
    SK_CHOICE(cloth_params, fabric, SK_FABRIC_FIELD, 0, SK_FABRICS,
              "a real one's density, stretch, shear, bend.rigidity and contact, where they are not given themselves"),
    SK_REAL(cloth_params, density, "density", "kg/m2", 0.2, 1e-9, 1e9,
            "mass of a square metre, shared out to the corners"),
    SK_REAL(cloth_params, weld, "weld", "m", 0, 0, SK_FAR,
            "vertices nearer than this become one particle; 0 joins none"),
    SK_TEXT(
        cloth_params, pins, "pins", "",
        "pinned particles: \"corners\", \"top corners\", \"top edge\", numbers, \"box x y z x y z\", \"sphere x y z r\""),
    SK_REAL(cloth_params, stretch.stiffness, "stretch.stiffness", "N/m", 2e4, 0, SK_UNBOUNDED,
            "of the sheet along its threads (1e4 is a firm cotton)"),
    SK_REAL(cloth_params, stretch.damping, "stretch.damping", "N s/m", 0, 0, SK_FAR,
            "of stretching; other motion is free"),
    SK_REAL(cloth_params, shear.stiffness, "shear.stiffness", "N/m", 2e3, 0, SK_UNBOUNDED, "across the threads"),
    SK_REAL(cloth_params, shear.damping, "shear.damping", "N s/m", 0, 0, SK_FAR, "of shearing"),
    SK_CHOICE(
        cloth_params, diagonals, "shear.diagonals", BY_PINS, "springs|ties|pins",
        "springs; or ties, slack when shorter, so that folds can run to one point; \"pins\": ties where all pins are "
        "within three edges and an eighth of the sheet, else springs"),
    SK_CHOICE(
        cloth_params, bending, "bend.by", BY_SHAPE, "springs|angle|curvature|lines|shape",
        "`dihedral` angles at edges, `isometric` curvature there, or `straight` lines and `twist` of a flat grid, which take "
        "the rigidity; \"shape\": lines of a flat grid, curvature of what else is flat, else angles; or springs over folds"),
    SK_REAL(cloth_params, bend.stiffness, "bend.stiffness", "N/m", 0, 0, SK_UNBOUNDED, "of the springs over folds"),
    SK_REAL(cloth_params, bend.damping, "bend.damping", "N s/m", 0, 0, SK_FAR, "of the springs over folds"),
    SK_REAL(cloth_params, rigidity, "bend.rigidity", "N m", 1e-5, 0, SK_UNBOUNDED,
            "of the sheet against angle or curvature, the same at any resolution (1e-5 is a cotton)"),
    SK_REAL(cloth_params, limit, "stretch.limit", "", SK_UNBOUNDED, 0, SK_UNBOUNDED,
            "strain limit: no edge gets longer than rest times 1 + this; \"infinite\" is none"),
    SK_REAL(cloth_params, tether, "stretch.tether", "", 0, 0, SK_UNBOUNDED,
            "no particle gets farther from a pin, or from any 5 or 20 edges away, than along the cloth, times 1 + this; "
            "\"infinite\" is none"),
    SK_REAL(cloth_params, tear, "stretch.tear", "", 0, 0, SK_UNBOUNDED,
            "stretch at which an edge gives way, with the faces beside it, when a step is over; 0: never"),
    SK_REAL(cloth_params, thickness, "contact.thickness", "m", 0, 0, 1e3,
            "its own, in contact: two surfaces come as near as the mean of theirs; 0: what the force `contact` says"),
    SK_REAL(cloth_params, friction, "contact.friction", "", 0.3, 0, 10,
            "with a contact.thickness: its coefficient of friction in contact; of two surfaces the mean counts"),
    SK_LOOK(cloth_params, look, SKEIN_LOOK_CLOTH),
};

enum {
    MOST_SINGLE_ANCHORS = 4,
    NEAR = 20, /* edges from a pin: nearer particles have tethers besides coarse grids */
};

/* What one build needs; all of it scratch. */
typedef struct tailor {
    skein_world *world;
    sk_body *body;
    const cloth_params *params;
    skein_error *error;
    sk_sheet sheet;
    sk_springs springs;
    sk_lines lines;          /* of what lies in strips */
    sk_held_hubs held;       /* of a mesh that has aggregates */
    sk_coarse_grid coarsest; /* of its coarse grids; none where row_step is 0 */
    bool *pinned;
    double *mass;
    uint32_t *rank; /* of each particle, outward; NULL where it is a grid, or a narrow mesh without pins */
} tailor;

static skein_status make_sheet(tailor *t, const skein_mesh *mesh) {
    const cloth_params *p = t->params;
    sk_allocator *allocator = &t->world->allocator;
    bool grid = p->grid[0] || p->grid[1];
    if (mesh && grid) return sk_fail(t->error, SKEIN_ERROR_VALUE, "grid", "a cloth has a grid or a mesh, not both");
    if (!mesh && !grid) return sk_fail(t->error, SKEIN_ERROR_VALUE, "mesh", "a cloth needs a mesh or a grid");
    skein_status status = mesh ? sk_sheet_from_mesh(&t->sheet, allocator, mesh, t->error)
                               : sk_sheet_from_grid(&t->sheet, allocator, p->grid, p->size, t->error);
    if (status) return status;
    sk_sheet_transform(&t->sheet, p->scale, p->rotation, p->position);
    if ((status = sk_sheet_weld(&t->sheet, p->weld, t->error))) return status;
    return sk_springs_find(&t->springs, &t->sheet, t->error);
}

/* Masses, pins and velocities; a particle without a mass (of no face) is pinned. */
static skein_status add_particles(tailor *t) {
    sk_allocator *allocator = &t->world->allocator;
    size_t count = t->sheet.particle_count;
    t->pinned = sk_allocate(allocator, count * sizeof *t->pinned);
    t->mass = sk_allocate(allocator, count * sizeof *t->mass);
    double(*velocity)[3] = sk_allocate(allocator, count * sizeof *velocity);
    skein_status status = t->pinned && t->mass && velocity ? SKEIN_OK : sk_fail_memory(t->error, "particles");
    if (!status) status = sk_sheet_select(t->params->pins, &t->sheet, &t->springs, "pins", t->pinned, t->error);
    for (size_t i = 0; i < count && !status; i++) {
        t->mass[i] = t->params->density * t->sheet.particle_area[i];
        if (t->mass[i] < 1e-15) t->mass[i] = 0;
        if (t->mass[i] > 0 && !t->pinned[i]) memcpy(velocity[i], t->params->velocity, sizeof velocity[i]);
    }
    if (!status)
        status = sk_world_add_particles(t->world, count, (const double *)t->sheet.position, (const double *)velocity,
                                        t->mass, t->error);
    for (size_t i = 0; i < count && !status; i++)
        if (t->pinned[i]) sk_particle_pin(&t->world->particles, t->body->first_particle + i, true);
    sk_release(allocator, velocity);
    return status;
}

/* Springs direction by direction, particles in strips. */
static skein_status put_in_strips(tailor *t, const sk_quad_grid *grid) {
    if (!sk_order_by_direction(&t->springs, grid->place)) return sk_fail_memory(t->error, "the order of springs");
    return sk_world_add_strips(t->world, t->body, grid->rows, grid->columns, (uint32_t)t->sheet.particle_count,
                               grid->place, t->error);
}

/* Exchanges rows and columns of a long grid of few columns, so that it gets coarse grids: swinging by its short edge,
 * 100 x 20 was stretched by 4.3 %, and is by 2.1 % so. False when there is no memory. */
static bool lay_across(tailor *t, sk_quad_grid *grid) {
    sk_allocator *allocator = &t->world->allocator;
    size_t count = t->sheet.particle_count;
    if (count != (size_t)grid->rows * grid->columns || !sk_coarse_fits_across(grid->rows, grid->columns)) return true;
    uint32_t *place = sk_allocate(allocator, count * sizeof *place);
    if (!place) return false;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = grid->place ? grid->place[i] : i;
        place[i] = at % grid->columns * grid->rows + at / grid->columns;
    }
    sk_release(allocator, grid->place);
    *grid = (sk_quad_grid){grid->columns, grid->rows, place};
    return true;
}

static bool has_pins(const tailor *t) {
    bool pinned = false;
    for (size_t i = 0; i < t->sheet.particle_count; i++) pinned |= t->pinned[i];
    return pinned;
}

/* Puts springs and particles in order: strips for grids, outward for other meshes. */
static skein_status put_in_order(tailor *t) {
    sk_quad_grid grid = {0, 0, NULL};
    if (!sk_order_find_grid(&t->sheet, &t->springs, &grid.rows, &grid.columns) ||
        (!grid.rows && !sk_quads_find(&t->sheet, &t->springs, t->pinned, &grid)))
        return sk_fail_memory(t->error, "the order of springs");
    if (grid.rows) {
        skein_status status =
            lay_across(t, &grid) ? put_in_strips(t, &grid) : sk_fail_memory(t->error, "the order of springs");
        if (!status && !sk_lines_find(&t->lines, &t->sheet, grid.rows, grid.columns, grid.place))
            status = sk_fail_memory(t->error, "the lines of the grid");
        sk_release(&t->world->allocator, grid.place);
        return status;
    }
    // without pins there is no outward; in a thin mesh, the order along an axis has too few independent springs
    if (!has_pins(t) && !sk_order_is_broad(&t->springs, &t->sheet))
        return sk_order_scattered(&t->springs) ? SKEIN_OK : sk_fail_memory(t->error, "the order of springs");
    t->rank = sk_allocate(&t->world->allocator, t->sheet.particle_count * sizeof *t->rank);
    if (!t->rank || !sk_order_outward(&t->springs, &t->sheet, t->pinned, t->rank))
        return sk_fail_memory(t->error, "the order of springs");
    sk_world_rank_particles(t->world, t->body, t->rank, t->sheet.particle_count);
    return SKEIN_OK;
}

/* Bending by angle, by curvature or along lines, in place of the springs over folds. */
static skein_status add_bending(tailor *t) {
    int32_t by = t->params->bending;
    if (by == BY_LINES && !t->lines.flat)
        return sk_fail(t->error, SKEIN_ERROR_VALUE, "bend.by",
                       "this mesh is no flat grid of rectangles: set it to shape, angle or curvature");
    if (t->lines.flat && (by == BY_LINES || by == BY_SHAPE))
        return sk_lines_add_bending(&t->lines, t->world, t->body, t->params->rigidity, t->error);
    // what began flat bends back to that by either; by curvature in half the time
    bool curvature = by == BY_CURVATURE || (by == BY_SHAPE && sk_sheet_is_flat(&t->sheet));
    const sk_constraint_type *type = curvature ? &sk_isometric : &sk_dihedral;
    sk_hinges hinges;
    skein_status status = sk_hinges_find(&hinges, &t->sheet, &t->springs, type, t->rank, t->error);
    if (status) return status;
    for (size_t i = 0; i < hinges.count; i++)
        for (int p = 0; p < 4; p++) hinges.corner[i][p] += t->body->first_particle;
    status =
        sk_world_add_body_batch(t->world, t->body, type, "bend", (sk_material){t->params->rigidity, 0}, false,
                                hinges.count, (const uint32_t *)hinges.corner, hinges.rest, hinges.scale, t->error);
    sk_hinges_release(&hinges);
    return status;
}

/* Whether it has coarse grids. Of what may tear nothing is left of them after the first tear, and what they had held would tear for that. */
static bool has_coarse(const tailor *t) {
    return t->lines.area && sk_coarse_fits(&t->lines) && !(t->params->tear > 0);
}

/* Bounds over many edges: by coarse grids if it is a whole and even grid, else along its rows and columns, or for other meshes
 * along the mesh's own x and z, and by aggregates where it is large, pinned and may not tear. A closed mesh without pins gets none: it may be a
 * balloon, which must be able to grow. */
static skein_status add_spans(tailor *t) {
    if (has_coarse(t)) return sk_coarse_add(&t->lines, t->mass, t->world, t->body, &t->coarsest, t->error);
    if (t->lines.area) return sk_lines_add_spans(&t->lines, t->world, t->body, t->error);
    const bool pinned = has_pins(t);
    double axes[2][3] = {{1, 0, 0}, {0, 0, 1}};
    sk_points_transform(axes, 2, 1, t->params->rotation, (const double[3]){0, 0, 0});
    if (pinned && !(t->params->tear > 0)) {
        skein_status status =
            sk_aggregates_add(&t->sheet, t->mass, t->pinned, t->rank, t->world, t->body, &t->held, t->error);
        if (status) return status;
    }
    return sk_spans_add(&t->sheet, (const double(*)[3])axes, t->rank, !pinned, t->world, t->body, t->error);
}

/* Whether a sheet hangs by one point: all of its pins are within a few edges, and an eighth of its extent. */
static bool hangs_by_a_point(const tailor *t) {
    const sk_sheet *sheet = &t->sheet;
    double area = 0;
    for (size_t f = 0; f < sheet->face_count; f++) area += sheet->face_area[f];
    double reach = fmin(3 * sqrt(area / (double)(sheet->face_count ? sheet->face_count : 1)), sqrt(area) / 8);
    size_t first = SIZE_MAX;
    for (size_t i = 0; i < sheet->particle_count; i++) {
        if (!t->pinned[i] || !(t->mass[i] > 0)) continue;
        if (first == SIZE_MAX) first = i;
        const double *p = sheet->position[i], *q = sheet->position[first];
        if (hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]) > reach) return false;
    }
    return first != SIZE_MAX;
}

/* Springs keep all six distances of four corners, so a cell folds only along rows and columns, and a sheet that hangs
 * by one point, to which folds run from all sides, locks around it. Stretch of 64 x 64 (99th percentile and largest,
 * %), with springs and with ties: by a corner 5.9 and 32, 2.2 and 14; by its middle 8.3 and 44, 4.1 and 20; by opposite
 * corners 4.5 and 18, 1.1 and 4. In the plane ties lose nothing: in shear one diagonal gets longer, and has the
 * stiffness of both; compression of both also compresses the edges. But forces have a kink where ties begin to pull,
 * which is where a sheet at rest is: gradients of a run do not exist there, and undamped explicit methods gain energy.
 * So sheets that do not need ties have springs. */
static const sk_constraint_type *tie_diagonals(tailor *t) {
    int32_t by = t->params->diagonals;
    if (by == SPRINGS || (by == BY_PINS && !hangs_by_a_point(t))) return &sk_distance;
    struct sk_spring_list *list = &t->springs.list[SK_SHEAR];
    for (size_t i = 0; i < list->count; i++) list->scale[i] *= 2;
    return &sk_extension;
}

/* Sweeps take batches in the order in which they were made, and satisfy the last best: edges. Measured on a draped
 * grid, 12 substeps: 5.7 % of stretch at most, against 15.8 % with the edges first.
 *
 * If cells are longer one way, from sides of 1.25 to 1 on, sweeps in that order oscillate as a lattice's do
 * (methods/plan_builder_correct.c): the stretch of 64 x 64 that swings by two corners was 5.6 and 17.5 % (99th
 * percentile and largest) with cells of 1.3 to 1, and 14 and 43 % with 2 to 1. With half of the shear springs swept on
 * the way back it is 0.7 and 1.8 %, as with squares, which are a little firmer without. */
static skein_status add_springs(tailor *t) {
    static const char *const labels[] = {"bend", "shear", "stretch"};
    const sk_material *materials[] = {&t->params->bend, &t->params->shear, &t->params->stretch};
    for (int sort = 0; sort < SK_SPRING_SORTS; sort++) {
        struct sk_spring_list *list = &t->springs.list[sort];
        for (size_t i = 0; i < 2 * list->count; i++) list->pairs[i] += t->body->first_particle;
        bool hinges = sort == SK_BEND && t->params->bending != BY_SPRINGS;
        const sk_constraint_type *type = sort == SK_SHEAR ? tie_diagonals(t) : &sk_distance;
        skein_status status = hinges ? add_bending(t)
                                     : sk_world_add_body_batch(t->world, t->body, type, labels[sort], *materials[sort],
                                                               sort == SK_STRETCH, list->count, list->pairs, list->rest,
                                                               list->scale, t->error);
        if (status) return status;
        if (sort == SK_SHEAR && t->lines.area && !sk_lines_square(&t->lines)) sk_world_sweep_both_ways(t->body);
        if (sort == SK_STRETCH && t->lines.area && (t->lines.cut[0] || t->lines.cut[1]) && !has_coarse(t))
            sk_world_sweep_both_ways(t->body);
    }
    sk_world_add_strain_limit(t->body);
    sk_world_keep_firm(t->body);
    return add_spans(t);
}

/* Triangles of the faces, as fans, for forces on areas. */
static skein_status add_triangles(tailor *t) {
    const sk_sheet *sheet = &t->sheet;
    uint32_t(*corners)[3] = sk_allocate(&t->world->allocator, sheet->corner_count * sizeof *corners);
    if (!corners) return sk_fail_memory(t->error, "triangles");
    size_t count = 0;
    for (size_t f = 0; f < sheet->face_count; f++) {
        const uint32_t *c = sheet->corners + sheet->face_start[f];
        size_t size = sheet->face_start[f + 1] - sheet->face_start[f];
        for (size_t k = 1; k + 1 < size; k++, count++)
            for (int j = 0; j < 3; j++) corners[count][j] = t->body->first_particle + c[j == 0 ? 0 : k + (size_t)j - 1];
    }
    skein_status status = sk_world_add_triangles(t->world, count, (const uint32_t(*)[3])corners, t->error);
    sk_release(&t->world->allocator, corners);
    return status;
}

/* The tethers of a cloth. */
typedef struct tethers {
    size_t count, anchors; /* of each */
    uint32_t *particles;   /* count x (1 + anchors) */
    real *lengths;         /* count x anchors */
} tethers;

static bool is_tethered(const tailor *t, size_t i) {
    return !t->world->particles.pinned[t->body->first_particle + i];
}

/* Notes the distances of all particles from one set of anchors as column `k` of the tethers. */
static bool measure_tethers(tailor *t, sk_geodesic *geodesic, const bool *source, size_t k, tethers *all,
                            double *distance, uint32_t *nearest) {
    if (!sk_geodesic_from(geodesic, source, distance, nearest)) return false;
    size_t filled = 0, anchors = all->anchors;
    for (size_t i = 0; i < t->sheet.particle_count; i++) {
        if (!is_tethered(t, i)) continue;
        bool reached = distance[i] < INFINITY;
        all->particles[filled * (1 + anchors)] = t->body->first_particle + (uint32_t)i;
        all->particles[filled * (1 + anchors) + 1 + k] = t->body->first_particle + (uint32_t)(reached ? nearest[i] : i);
        all->lengths[filled++ * anchors + k] = (real)(reached ? distance[i] : SK_FAR);
    }
    return true;
}

/* Whether a particle is a few edges from one of its anchors: nearer than the coarsest grid's own particles. */
static bool is_near(const tailor *t, const tethers *all, size_t i) {
    double edge =
        t->held.is ? t->held.edge : fmax(sk_lines_edge(&t->lines, 0, 0, true), sk_lines_edge(&t->lines, 0, 0, false));
    bool near = false;
    for (size_t k = 0; k < all->anchors; k++) near |= (double)all->lengths[i * all->anchors + k] < (NEAR + 0.5) * edge;
    return near;
}

/* Adds some of the tethers again: those of the coarsest grid's particles, or of ones near an anchor. `some` has
 * room. */
static skein_status add_some_tethers(tailor *t, const tethers *all, sk_limit_order order, tethers *some) {
    size_t anchors = some->anchors = all->anchors;
    some->count = 0;
    for (size_t i = 0; i < all->count; i++) {
        uint32_t particle = all->particles[i * (1 + anchors)] - t->body->first_particle;
        bool taken = order != SK_LIMIT_BEFORE_COARSE ? is_near(t, all, i)
                     : t->held.is                    ? t->held.is[particle]
                                                     : sk_coarse_has(&t->coarsest, &t->lines, particle);
        if (!taken) continue;
        memcpy(some->particles + some->count * (1 + anchors), all->particles + i * (1 + anchors),
               (1 + anchors) * sizeof *all->particles);
        memcpy(some->lengths + some->count++ * anchors, all->lengths + i * anchors, anchors * sizeof *all->lengths);
    }
    return sk_world_add_tethers(t->world, t->body, order, some->count, anchors, some->particles, some->lengths,
                                t->error);
}

static bool allocate_tethers(tailor *t, tethers *all, size_t count, size_t anchors) {
    *all = (tethers){.count = count, .anchors = anchors};
    all->particles = sk_allocate(&t->world->allocator, count * (1 + anchors) * sizeof *all->particles);
    all->lengths = sk_allocate(&t->world->allocator, count * anchors * sizeof *all->lengths);
    return all->particles && all->lengths;
}

static void release_tethers(tailor *t, tethers *all) {
    sk_release(&t->world->allocator, all->particles);
    sk_release(&t->world->allocator, all->lengths);
}

/* With coarse grids, a tether of its own pulls each particle away from the smooth shape that they give. Stretch of a
 * swinging grid of 128 x 128 (99th percentile and largest, %) with all tethers last (in every second substep, then), and
 * without: 0.80 and 1.97, 0.62 and 1.9; of 0.2 m 2.99 and 4.7, 1.45 and 3.3. Only particles near a pin need tethers,
 * for a few edges carry all load there: without any, the first edge beside a pin was stretched by 4.6 % as the fall
 * began; with those within 6 edges 200 x 200 kept 2.2 % at rest, within 20 1.2, within 40 no less. If cells are longer
 * one way, the hem of 20 x 60 kept 3 % so, and 1.3 with all tethers. */
static skein_status add_tethers_of_coarse(tailor *t, const tethers *all) {
    static const sk_limit_order orders[] = {SK_LIMIT_BEFORE_COARSE, SK_LIMIT_AFTER_COARSE};
    tethers some;
    bool square = t->held.is || sk_lines_square(&t->lines);
    skein_status status =
        allocate_tethers(t, &some, all->count, all->anchors)
            ? sk_world_add_tethers(t->world, t->body, square ? SK_LIMIT_WITHOUT_COARSE : SK_LIMIT_SELDOM, all->count,
                                   all->anchors, all->particles, all->lengths, t->error)
            : sk_fail_memory(t->error, "tethers");
    for (int i = 0; i < (square ? 2 : 1) && !status; i++) status = add_some_tethers(t, all, orders[i], &some);
    release_tethers(t, &some);
    return status;
}

/* Each of a few pins tethers every particle; with many (an edge), only the nearest one does. */
static skein_status add_tethers(tailor *t, const bool *to) {
    sk_allocator *allocator = &t->world->allocator;
    size_t count = t->sheet.particle_count, pins = 0, tethered = 0;
    for (size_t i = 0; i < count; i++) pins += to[i], tethered += is_tethered(t, i);
    if (!pins || !tethered) return SKEIN_OK;
    size_t anchors = pins <= MOST_SINGLE_ANCHORS ? pins : 1;

    sk_geodesic *geodesic = sk_geodesic_create(&t->sheet);
    double *distance = sk_allocate(allocator, count * sizeof *distance);
    uint32_t *nearest = sk_allocate(allocator, count * sizeof *nearest);
    bool *source = sk_allocate(allocator, count * sizeof *source);
    tethers all;
    bool good = allocate_tethers(t, &all, tethered, anchors) && geodesic && distance && nearest && source;
    if (good && anchors < pins) good = measure_tethers(t, geodesic, to, 0, &all, distance, nearest);
    for (size_t i = 0, k = 0; i < count && good && anchors == pins; i++) {
        if (!to[i]) continue;
        memset(source, 0, count * sizeof *source);
        source[i] = true;
        good = measure_tethers(t, geodesic, source, k++, &all, distance, nearest);
    }
    sk_limit_order order = t->lines.area ? SK_LIMIT_SELDOM : SK_LIMIT_LAST;
    skein_status status =
        !good ? sk_fail_memory(t->error, "tethers")
        : t->coarsest.row_step || t->held.is
            ? add_tethers_of_coarse(t, &all)
            : sk_world_add_tethers(t->world, t->body, order, tethered, anchors, all.particles, all.lengths, t->error);
    sk_geodesic_release(geodesic);
    sk_release(allocator, distance);
    sk_release(allocator, nearest);
    sk_release(allocator, source);
    release_tethers(t, &all);
    return status;
}

/* The body keeps the surface as it came: the sheet's arrays change owners. */
static void hand_over_surface(tailor *t) {
    sk_body *body = t->body;
    sk_sheet *sheet = &t->sheet;
    for (size_t v = 0; v < sheet->vertex_count; v++) sheet->particle_of_vertex[v] += body->first_particle;
    body->particle_of_vertex = sheet->particle_of_vertex;
    body->face_sizes = sheet->face_sizes;
    body->face_vertices = sheet->face_vertices;
    body->vertex_count = sheet->vertex_count;
    body->face_count = sheet->face_count;
    body->face_vertex_count = sheet->corner_count;
    body->grid_rows = sheet->grid_rows;
    body->grid_columns = sheet->grid_columns;
    sheet->particle_of_vertex = sheet->face_sizes = sheet->face_vertices = NULL;
}

/* The sheet as it was built, as far as distances along it need that. */
static bool lay_out(tailor *t) {
    const sk_body *body = t->body;
    sk_sheet *sheet = &t->sheet;
    sk_allocator *allocator = sheet->allocator = &t->world->allocator;
    sheet->vertex_count = body->vertex_count;
    sheet->particle_count = body->particle_count;
    sheet->face_count = body->face_count;
    sheet->grid_rows = body->grid_rows;
    sheet->grid_columns = body->grid_columns;
    sheet->position = sk_allocate(allocator, body->particle_count * sizeof *sheet->position);
    sheet->face_start = sk_allocate(allocator, (body->face_count + 1) * sizeof *sheet->face_start);
    sheet->corners = sk_allocate(allocator, body->face_vertex_count * sizeof *sheet->corners);
    if (!sheet->position || !sheet->face_start || !sheet->corners) return false;
    for (size_t i = 0; i < body->particle_count; i++) {
        const sk_vec3 p = t->world->particles.built[body->first_particle + i];
        sheet->position[i][0] = (double)p.x, sheet->position[i][1] = (double)p.y, sheet->position[i][2] = (double)p.z;
    }
    for (size_t f = 0; f < body->face_count; f++) sheet->face_start[f + 1] = sheet->face_start[f] + body->face_sizes[f];
    for (size_t c = 0; c < body->face_vertex_count; c++)
        sheet->corners[c] = body->particle_of_vertex[body->face_vertices[c]] - body->first_particle;
    return true;
}

static skein_status tether(skein_world *world, sk_body *body, const void *params, const bool *pins, skein_error *error) {
    tailor t = {.world = world, .body = body, .params = params, .error = error};
    skein_status status = lay_out(&t) ? add_tethers(&t, pins) : sk_fail_memory(error, "tethers");
    sk_sheet_release(&t.sheet);
    return status;
}

/* Of bending, what the cloth was built with. */
static bool live(const void *data, const char *field) {
    const cloth_params *params = data;
    if (!strcmp(field, "bend.stiffness") || !strcmp(field, "bend.damping")) return params->bending == BY_SPRINGS;
    if (!strcmp(field, "bend.rigidity")) return params->bending != BY_SPRINGS;
    static const char *const names[] = {"stretch.stiffness", "stretch.damping", "shear.stiffness", "shear.damping",
                                        "stretch.limit",     "stretch.tether",  "stretch.tear",    "look"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(field, names[i])) return true;
    return false;
}

static void change(sk_body *body, const void *data) {
    const cloth_params *params = data;
    sk_material bend = params->bending == BY_SPRINGS ? params->bend : (sk_material){params->rigidity, 0};
    for (size_t i = 0; i < body->batch_count; i++) {
        const sk_batch *batch = body->batch[i];
        if (batch->only_bounds) continue;
        bool shear = !strcmp(batch->label, "shear");
        *body->material[i] = batch->measured ? params->stretch : shear ? params->shear : bend;
    }
    body->tether_bound = fmin(params->tether, params->limit); // a chain of edges may stretch no more than an edge
    body->strain_bound = params->limit;
    body->tear_bound = params->tear;
}

/* Refuses settings that only springs have for other kinds of bending. */
static skein_status check_bending(const cloth_params *p, skein_error *error) {
    if (p->bending == BY_SPRINGS) return SKEIN_OK;
    const char *field = p->bend.stiffness > 0 ? "bend.stiffness" : p->bend.damping > 0 ? "bend.damping" : NULL;
    if (!field) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, field,
                   "this is of springs over folds: set bend.by to springs, too; else give bend.rigidity, in N m");
}

static skein_status build(skein_world *world, sk_body *body, const void *params, const skein_mesh *mesh,
                          skein_error *error) {
    tailor t = {.world = world, .body = body, .params = params, .error = error};
    skein_status status = check_bending(params, error);
    if (!status) status = make_sheet(&t, mesh);
    if (!status) status = sk_report_faults(world, body->label, &t.sheet, &t.springs, error);
    if (!status) status = add_particles(&t);
    if (!status) status = put_in_order(&t);
    if (!status) status = add_springs(&t);
    if (!status) status = add_triangles(&t);
    if (!status) status = add_tethers(&t, t.pinned);
    if (!status) {
        hand_over_surface(&t);
        change(body, params);
    }
    sk_release(&world->allocator, t.pinned);
    sk_release(&world->allocator, t.mass);
    sk_release(&world->allocator, t.rank);
    sk_release(&world->allocator, t.held.is);
    sk_lines_release(&t.lines);
    sk_springs_release(&t.springs);
    sk_sheet_release(&t.sheet);
    return status;
}

const sk_body_type sk_cloth = {
    .kind =
        {"cloth",
         "a sheet from a triangle or quad mesh, or a grid: springs along and across, bending by angle, tethers to pins",
         SKEIN_BODY, fields, sizeof fields / sizeof *fields, sizeof(cloth_params)},
    .build = build,
    .live = live,
    .change = change,
    .tether = tether,
    .presets = &sk_fabrics,
    .is_sheet = true,
};
