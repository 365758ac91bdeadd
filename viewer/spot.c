/* Fields of place; see spot.h. */
#include "viewer/spot.h"

#include <math.h>
#include <string.h>

#include "io/own_kinds.h"
#include "render/linear.h"

static const double degree = 0.017453292519943295;

/* ---- Rotations: as fields have them, about x, then y, then z; rows of matrices ---- */

static void matrix_of(const double degrees[3], double m[9]) {
    double s[3], c[3];
    for (int k = 0; k < 3; k++) s[k] = sin(degrees[k] * degree), c[k] = cos(degrees[k] * degree);
    m[0] = c[2] * c[1], m[1] = c[2] * s[1] * s[0] - s[2] * c[0], m[2] = c[2] * s[1] * c[0] + s[2] * s[0];
    m[3] = s[2] * c[1], m[4] = s[2] * s[1] * s[0] + c[2] * c[0], m[5] = s[2] * s[1] * c[0] - c[2] * s[0];
    m[6] = -s[1], m[7] = c[1] * s[0], m[8] = c[1] * c[0];
}

static void degrees_of(const double m[9], double degrees[3]) {
    bool upright = fabs(m[6]) > 1 - 1e-10; // x and z turn about one line: x does all of it
    degrees[1] = asin(fmin(fmax(-m[6], -1), 1)) / degree;
    degrees[0] = (upright ? atan2(-m[5], m[4]) : atan2(m[7], m[8])) / degree;
    degrees[2] = upright ? 0 : atan2(m[3], m[0]) / degree;
}

/* Turns a vector about a unit axis. */
static void turn_about(const double axis[3], double angle, double v[3]) {
    double across[3], s = sin(angle), c = cos(angle), along = render_dot(axis, v);
    render_cross(axis, v, across);
    for (int k = 0; k < 3; k++) v[k] = c * v[k] + s * across[k] + (1 - c) * along * axis[k];
}

static double round_to(double x, double unit) {
    if (!(unit > 0)) return x;
    double power = pow(10, floor(log10(unit))), rounded = power * round(x / power);
    // 0.30000000000000004 reads badly in a saved scene
    double inverse = round(1 / power);
    if (power < 1) rounded = round(x * inverse) / inverse;
    return rounded + 0.0;
}

/* ---- Finding it ---- */

static bool take(const skein_world *world, skein_handle handle, const skein_kind *kind, const char *name,
                 skein_field_type type, const skein_field **field, double *numbers, int count) {
    skein_value value;
    const skein_field *found = skein_field_find(kind, name, NULL);
    if (*field || !found || found->type != type || skein_get(world, handle, name, &value)) return false;
    *field = found;
    memcpy(numbers, value.number, (size_t)count * sizeof *numbers);
    return true;
}

/* A sheet of a mesh has no size of its own; a shape that is one of several has that of the chosen one. */
static void leave_out_what_is_ignored(viewer_spot *spot, const skein_world *world, skein_handle handle,
                                      const skein_kind *kind) {
    skein_value mesh, shape;
    const skein_field *choice = skein_field_find(kind, "shape", NULL);
    bool has_mesh = !skein_get(world, handle, "mesh", &mesh) && mesh.text && mesh.text[0];
    bool both = spot->size && spot->uniform, round = false;
    if (both && choice && choice->type == SKEIN_FIELD_CHOICE && !skein_get(world, handle, "shape", &shape)) {
        const char *word = choice->choices;
        for (int i = (int)shape.number[0]; i > 0 && word; i--) word = strchr(word, '|') ? strchr(word, '|') + 1 : NULL;
        round = word && !strncmp(word, "sphere", 6);
    }
    if (!both) return;
    if (has_mesh || round) spot->size = NULL;
    else spot->uniform = NULL;
}

bool viewer_spot_find(viewer_spot *spot, const skein_world *world, skein_category category, size_t index) {
    *spot = (viewer_spot){.factor = 1};
    if (!world || index >= skein_object_count(world, category)) return false;
    skein_handle handle = skein_object_at(world, category, index);
    const skein_kind *own = skein_object_kind(world, handle),
                     *kind = own ? io_kind_find(category, own->name, NULL) : NULL;
    if (!kind) kind = own; // a program's own
    if (!kind) return false;
    if (!take(world, handle, kind, "position", SKEIN_FIELD_VEC3, &spot->point, spot->at, 3))
        take(world, handle, kind, "centre", SKEIN_FIELD_VEC3, &spot->point, spot->at, 3);
    if (!spot->point && take(world, handle, kind, "from", SKEIN_FIELD_VEC3, &spot->from, spot->ends[0], 3))
        take(world, handle, kind, "to", SKEIN_FIELD_VEC3, &spot->to, spot->ends[1], 3);
    if (!spot->point && take(world, handle, kind, "normal", SKEIN_FIELD_VEC3, &spot->normal, spot->up, 3))
        take(world, handle, kind, "offset", SKEIN_FIELD_REAL, &spot->offset, &spot->off, 1);
    if (!spot->point && !(spot->from && spot->to) && !(spot->normal && spot->offset)) return false;
    if (spot->normal) render_normalise(spot->up);
    take(world, handle, kind, "rotation", SKEIN_FIELD_VEC3, &spot->turn, spot->degrees, 3);
    if (!take(world, handle, kind, "size", SKEIN_FIELD_VEC3, &spot->size, spot->extent, 3) &&
        !take(world, handle, kind, "spread", SKEIN_FIELD_VEC3, &spot->size, spot->extent, 3))
        spot->flat = take(world, handle, kind, "size", SKEIN_FIELD_REAL2, &spot->size, spot->extent, 2);
    if (!take(world, handle, kind, "radius", SKEIN_FIELD_REAL, &spot->uniform, &spot->factor, 1))
        take(world, handle, kind, "scale", SKEIN_FIELD_REAL, &spot->uniform, &spot->factor, 1);
    leave_out_what_is_ignored(spot, world, handle, kind);
    const skein_field *ends = spot->point ? spot->point : spot->from ? spot->from : spot->offset;
    const skein_field *fields[3] = {ends, spot->turn ? spot->turn : ends,
                                    spot->size      ? spot->size
                                    : spot->uniform ? spot->uniform
                                                    : ends};
    for (int t = 0; t < 3; t++) spot->live[t] = skein_field_is_live(world, handle, fields[t]->name);
    return true;
}

bool viewer_spot_can(const viewer_spot *spot, viewer_tool tool) {
    switch (tool) {
    case VIEWER_MOVES: return true;
    case VIEWER_TURNS: return spot->turn || spot->from || spot->normal;
    case VIEWER_SIZES: return spot->size || spot->uniform || spot->from;
    default: return false;
    }
}

void viewer_spot_middle(const viewer_spot *spot, const double target[3], double middle[3]) {
    double over = spot->normal ? render_dot(spot->up, target) - spot->off : 0;
    for (int k = 0; k < 3; k++)
        middle[k] = spot->point    ? spot->at[k]
                    : spot->normal ? target[k] - over * spot->up[k]
                                   : 0.5 * (spot->ends[0][k] + spot->ends[1][k]);
}

void viewer_spot_axes(const viewer_spot *spot, double axes[3][3]) {
    double m[9];
    matrix_of(spot->degrees, m);
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++) axes[a][k] = m[3 * k + a];
}

void viewer_spot_gizmo(const viewer_spot *spot, viewer_tool tool, const double target[3], viewer_gizmo *gizmo) {
    static const double world_axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    *gizmo = (viewer_gizmo){.tool = tool, .hot = GIZMO_NOTHING, .scale = 1};
    viewer_spot_middle(spot, target, gizmo->origin);
    memcpy(gizmo->axes, world_axes, sizeof world_axes);
    bool along_itself = tool == VIEWER_MOVES && spot->normal;
    if (tool == VIEWER_SIZES) viewer_spot_axes(spot, gizmo->axes);
    if (along_itself) {
        memcpy(gizmo->axes[1], spot->up, sizeof spot->up);
        render_basis(spot->up, gizmo->axes[0], gizmo->axes[2]);
    }
    for (int a = 0; a < 3; a++) {
        gizmo->has[a] = tool == VIEWER_SIZES ? spot->size && !(spot->flat && a == 1) : !along_itself || a == 1;
        gizmo->has[GIZMO_PLANE + a] = tool == VIEWER_MOVES && !along_itself;
    }
    gizmo->has[GIZMO_ALL] = tool != VIEWER_TURNS && !along_itself;
}

/* ---- What was done ---- */

void viewer_spot_carry(const viewer_spot *spot, const viewer_gizmo *gizmo, int part, const double by[3],
                       double place[3]) {
    double off[3], moved[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) off[k] = place[k] - gizmo->origin[k];
    if (gizmo->tool == VIEWER_TURNS) turn_about(gizmo->axes[part % 3], by[0] * degree, off);
    if (gizmo->tool == VIEWER_SIZES)
        for (int a = 0; a < 3; a++) {
            double along = render_dot(gizmo->axes[a], off), times = spot->flat && a == 1 ? 1 : by[a];
            for (int k = 0; k < 3; k++) moved[k] += times * along * gizmo->axes[a][k];
        }
    bool sizes = gizmo->tool == VIEWER_SIZES;
    for (int k = 0; k < 3; k++)
        place[k] = gizmo->origin[k] + (sizes ? moved[k] : off[k]) + (gizmo->tool == VIEWER_MOVES ? by[k] : 0);
}

static viewer_spot_change vector_change(const skein_field *field, const double v[3], double unit) {
    return (viewer_spot_change){field, skein_vector(round_to(v[0], unit), round_to(v[1], unit), round_to(v[2], unit))};
}

/* Both ends go where they are carried. */
static size_t change_ends(const viewer_spot *spot, const viewer_gizmo *gizmo, int part, const double by[3], double unit,
                          viewer_spot_change changes[2]) {
    const skein_field *fields[2] = {spot->from, spot->to};
    for (int e = 0; e < 2; e++) {
        double place[3];
        memcpy(place, spot->ends[e], sizeof place);
        viewer_spot_carry(spot, gizmo, part, by, place);
        changes[e] = vector_change(fields[e], place, unit);
    }
    return 2;
}

static size_t change_turn(const viewer_spot *spot, const viewer_gizmo *gizmo, int part, const double by[3], double unit,
                          viewer_spot_change changes[2]) {
    double angle = by[0] * degree, degrees[3], axes[3][3], m[9];
    if (spot->turn) {
        viewer_spot_axes(spot, axes);
        for (int a = 0; a < 3; a++) turn_about(gizmo->axes[part % 3], angle, axes[a]);
        for (int a = 0; a < 3; a++)
            for (int k = 0; k < 3; k++) m[3 * k + a] = axes[a][k];
        degrees_of(m, degrees);
        changes[0] = vector_change(spot->turn, degrees, 0.01);
        return 1;
    }
    double up[3];
    memcpy(up, spot->up, sizeof up);
    turn_about(gizmo->axes[part % 3], angle, up);
    changes[0] = vector_change(spot->normal, up, 1e-6);
    // it goes on through the gizmo's place
    double length = sqrt(render_dot(changes[0].value.number, changes[0].value.number));
    double over = render_dot(changes[0].value.number, gizmo->origin) / (length > 0 ? length : 1);
    changes[1] = (viewer_spot_change){spot->offset, skein_number(round_to(over, unit))};
    return 2;
}

/* At least what the field allows: what is made tiny by a hand stays good. */
static double sized(const skein_field *field, double value, double times) {
    double made = value * times, power = pow(10, floor(log10(fmax(fabs(made), 1e-30))) - 2);
    return fmin(fmax(round_to(made, power), field->least), field->most);
}

static size_t change_size(const viewer_spot *spot, const double by[3], viewer_spot_change changes[2]) {
    if (!spot->size) {
        changes[0] = (viewer_spot_change){spot->uniform, skein_number(sized(spot->uniform, spot->factor, by[0]))};
        return 1;
    }
    skein_value value = {spot->flat ? 2 : 3, {0, 0, 0}, NULL};
    for (int k = 0; k < value.count; k++) {
        double times = by[spot->flat && k == 1 ? 2 : k];
        value.number[k] = times == 1 ? spot->extent[k] : sized(spot->size, spot->extent[k], times);
    }
    changes[0] = (viewer_spot_change){spot->size, value};
    return 1;
}

size_t viewer_spot_apply(const viewer_spot *spot, const viewer_gizmo *gizmo, int part, const double by[3], double pixel,
                         viewer_spot_change changes[2]) {
    bool ends = spot->from && !(gizmo->tool == VIEWER_SIZES && spot->uniform);
    if (ends) return change_ends(spot, gizmo, part, by, pixel, changes);
    if (gizmo->tool == VIEWER_TURNS) return change_turn(spot, gizmo, part, by, pixel, changes);
    if (gizmo->tool == VIEWER_SIZES) return change_size(spot, by, changes);
    if (spot->point) {
        double place[3];
        for (int k = 0; k < 3; k++) place[k] = by[k] != 0 ? round_to(spot->at[k] + by[k], pixel) : spot->at[k];
        changes[0] = (viewer_spot_change){spot->point, skein_vector(place[0], place[1], place[2])};
        return 1;
    }
    changes[0] =
        (viewer_spot_change){spot->offset, skein_number(round_to(spot->off + render_dot(spot->up, by), pixel))};
    return 1;
}
