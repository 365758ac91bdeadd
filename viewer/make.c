/* Pieces of the palette, copies and conversions; see make.h. */
#include "viewer/make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/mesh.h"

/* ---- The palette ---- */

/* x, y, z: over what is there; s: a size that suits it. Of all bodies: c, d their middle along x and z, r their
 * radius, b their lowest height, g that or 0. */
static const viewer_piece pieces[] = {
    {"cloth", "a sheet of 24 x 24 particles that falls", SKEIN_BODY, false, false,
     "{'type':'cloth','grid':[24,24],'size':[$s,$s],'position':[$x,$y,$z]}"},
    {"cube", "a soft block of 6 x 6 x 6 particles", SKEIN_BODY, false, false,
     "{'type':'lattice','grid':[6,6,6],'size':[$s,$s,$s],'position':[$x,$y,$z],'struts':true,"
     "'structural':{'damping':5},'shear':{'damping':2.5},'bending':{'damping':1}}"},
    {"rope", "33 particles, held at one end", SKEIN_BODY, false, false,
     "{'type':'rope','from':[$w,$y,$z],'to':[$e,$y,$z],'pins':'first'}"},
    {"flock", "256 loose particles: they fly by rules among the forces", SKEIN_BODY, false, false,
     "{'type':'flock','count':256,'position':[$x,$y,$z],'spread':[$s,$s,$s],'speed':1}"},
    {"mesh",
     "a sheet of a mesh from a file, OBJ, PLY, STL, glTF or OFF; or a solid of tetrahedra, .node with .ele beside it",
     SKEIN_BODY, false, true, NULL},
    {"plane", "flat ground, in the place of the first collider", SKEIN_COLLIDER, true, false,
     "{'type':'plane','name':'ground','offset':$g}"},
    {"slope", "ground that falls by 20 degrees", SKEIN_COLLIDER, true, false,
     "{'type':'plane','name':'ground','normal':[0.3420201,0.9396926,0],'offset':$t}"},
    {"bowl", "a bowl under all bodies", SKEIN_COLLIDER, true, false,
     "{'type':'bowl','name':'ground','centre':[$c,$o,$d],'radius':$q}"},
    {"ball", "a ball under all bodies", SKEIN_COLLIDER, true, false,
     "{'type':'sphere','name':'ground','centre':[$c,$u,$d],'radius':$r}"},
    {"box", "a table under all bodies", SKEIN_COLLIDER, true, false,
     "{'type':'box','name':'ground','centre':[$c,$k,$d],'size':[$l,$m,$l]}"},
};

const viewer_piece *viewer_piece_at(size_t index) {
    return index < sizeof pieces / sizeof *pieces ? &pieces[index] : NULL;
}

/* ---- Where things are ---- */

typedef struct box {
    double least[3], most[3];
} box;

static const box nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void add_particles(box *b, const skein_world *world, size_t first, size_t count) {
    for (size_t i = first; i < first + count; i++) {
        double x[3];
        if (skein_positions_copy(world, (uint32_t)i, 1, x)) return;
        for (int k = 0; k < 3; k++) b->least[k] = fmin(b->least[k], x[k]), b->most[k] = fmax(b->most[k], x[k]);
    }
}

/* Of one body. */
static box box_of(const skein_world *world, size_t body) {
    skein_surface s;
    box b = nothing;
    if (!skein_body_surface(world, skein_object_at(world, SKEIN_BODY, body), &s))
        add_particles(&b, world, s.first_particle, s.particle_count);
    return b;
}

static bool is_empty(const box *b) {
    return !(b->least[0] <= b->most[0]);
}

/* Whether both share some room. */
static bool meet(const box *a, const box *b, const double shift[3]) {
    for (int k = 0; k < 3; k++)
        if (a->least[k] + shift[k] >= b->most[k] || a->most[k] + shift[k] <= b->least[k]) return false;
    return true;
}

/* To one digit. */
static double round_off(double x) {
    if (!(x > 0) || !isfinite(x)) return 1;
    double unit = pow(10, floor(log10(x)));
    return unit * fmax(round(x / unit), 1);
}

/* The scene as it is now, from its file with all changes; and its world at the start. False after a printed fault. */
typedef struct present {
    io_scene *scene;
    skein_world *world;
} present;

static void close_present(present *p) {
    skein_world_destroy(p->world);
    io_scene_free(p->scene);
}

static bool open_present(viewer_stage *stage, present *p) {
    viewer_reading reading = viewer_stage_reading(stage);
    *p = (present){viewer_player_scene(&stage->sides[0], &reading), NULL};
    io_faults faults = {NULL, NULL, 0, NULL};
    if (p->scene) p->world = io_scene_build(p->scene, NULL, &faults);
    if (p->world) return true;
    viewer_say(stage, SKEIN_LOG_WARNING, "the scene's file has a fault or is gone: nothing is made");
    close_present(p);
    return false;
}

/* The letters of the palette; see there. */
static double letter(const box *all, char which) {
    bool none = is_empty(all);
    double middle[3], half[3];
    for (int k = 0; k < 3; k++) {
        middle[k] = none ? 0 : 0.5 * (all->least[k] + all->most[k]);
        half[k] = none ? 0.5 : fmax(0.5 * (all->most[k] - all->least[k]), 1e-3);
    }
    double r = fmax(hypot(half[0], half[2]), half[1]), s = round_off(none ? 1 : 0.8 * r), bottom = middle[1] - half[1];
    double ground = fmin(bottom, 0), top = none ? 0 : all->most[1];
    double x = middle[0], y = top + 0.75 * s, z = middle[2];
    switch (which) {
    case 's': return s;
    case 'x': return x;
    case 'w': return x - 0.5 * s;
    case 'e': return x + 0.5 * s;
    case 'y': return y;
    case 'd':
    case 'z': return z;
    case 'c': return x;
    case 'r': return r;
    case 'b': return bottom;
    case 'g': return ground;
    case 't': return fmin(0.3420201 * (x - half[0]) + 0.9396926 * bottom, 0); // the slope is under all of them
    case 'q': return 1.6 * r;                                                 // a bowl that their outline fits in
    case 'o': return bottom + 1.6 * r - 0.4 * r;
    case 'u': return bottom - 1.05 * r;
    case 'k': return ground - 0.1 * r;
    case 'l': return 4 * r;
    case 'm': return 0.2 * r;
    default: return 0;
    }
}

/* A piece's text with numbers in it; rounded, so that the saved scene reads well. */
static void fill_in(const char *json, const box *all, char *out, size_t size) {
    size_t length = 0;
    for (; *json && length + 32 < size; json++) {
        if (*json == '$') length += (size_t)snprintf(out + length, size - length, "%.4g", letter(all, *++json));
        else out[length++] = *json == '\'' ? '"' : *json;
    }
    out[length] = 0;
}

/* ---- Making ---- */

/* Puts an object into the scene: at the end of its list, or in another's place. */
static bool put(viewer_stage *stage, skein_category category, size_t place, const char *json, const char *words) {
    const char *list = viewer_list_of(category);
    size_t size = strlen(json) + strlen(list) + 40;
    char *set = malloc(size);
    if (set) snprintf(set, size, "%s.%zu=%s", list, place, json);
    bool good = set && viewer_stage_build_with(stage, set);
    free(set);
    if (good) viewer_note(stage, "%s", words);
    stage->camera.placed &= stage->camera.moved; // what is new is to be seen
    return good;
}

/* What a mesh's file makes: as large as suits the scene. */
static bool describe_mesh(viewer_stage *stage, const char *path, const box *all, char *out, size_t size) {
    char *whole = realpath(path, NULL);
    io_mesh mesh;
    skein_error error = {SKEIN_OK, "", ""};
    const char *ending = strrchr(path, '.');
    bool solid = ending && !strcmp(ending, ".node");
    double extent = 0, scale = 1, s = letter(all, 's');
    if (!whole) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s: there is no such file", path);
        return false;
    }
    if (!solid && io_mesh_read(whole, &mesh, (io_warnings){NULL, NULL}, &error)) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", path, error.message);
        free(whole);
        return false;
    }
    double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t v = 0; !solid && v < mesh.vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            least[k] = fmin(least[k], mesh.positions[3 * v + (size_t)k]);
            most[k] = fmax(most[k], mesh.positions[3 * v + (size_t)k]);
        }
    for (int k = 0; k < 3 && !solid; k++) extent = fmax(extent, most[k] - least[k]);
    if (!solid) io_mesh_free(&mesh);
    // what has about the right size already is in metres
    if (extent > 0 && (extent > 10 * s || extent < 0.1 * s)) scale = s / extent;
    snprintf(out, size, "{\"type\":\"%s\",\"mesh\":\"%s\",\"scale\":%.4g,\"position\":[%.4g,%.4g,%.4g]}",
             solid ? "tetrahedra" : "cloth", whole, scale, letter(all, 'x'), letter(all, 'y'), letter(all, 'z'));
    free(whole);
    return true;
}

void viewer_make(viewer_stage *stage, const viewer_request *request) {
    const viewer_piece *piece = viewer_piece_at((size_t)request->code);
    present p;
    char json[2048], words[100];
    if (!piece || !stage->side_count || !open_present(stage, &p)) return;
    box all = nothing;
    add_particles(&all, p.world, 0, skein_particle_count(p.world));
    size_t count = skein_object_count(p.world, piece->category), place = piece->ground && count ? 0 : count;
    bool good = true;
    if (piece->file) good = describe_mesh(stage, request->text, &all, json, sizeof json);
    else fill_in(piece->json, &all, json, sizeof json);
    close_present(&p);
    snprintf(words, sizeof words, "made: %s", piece->title);
    if (good) good = put(stage, piece->category, place, json, words);
    viewer_event(stage->events, "%s %s %zu", good ? "made" : "not made", piece->title, place);
}

/* The way aside, along x, to where no other body is. */
static void find_way(const present *p, skein_category category, size_t index, double by[3]) {
    size_t count = skein_object_count(p->world, SKEIN_BODY);
    box own = category == SKEIN_BODY ? box_of(p->world, index) : nothing, all = nothing;
    add_particles(&all, p->world, 0, skein_particle_count(p->world));
    double step = is_empty(&own) ? letter(&all, 's') : fmax(1.2 * (own.most[0] - own.least[0]), 1e-3);
    by[0] = by[1] = by[2] = 0;
    bool free_place = false;
    for (int turn = 1; turn < 100 && !free_place; turn++) {
        by[0] = turn * step;
        free_place = true;
        for (size_t b = 0; b < count && !is_empty(&own); b++) {
            box other = box_of(p->world, b);
            free_place &= is_empty(&other) || !meet(&own, &other, by);
        }
    }
}

void viewer_duplicate(viewer_stage *stage, const viewer_request *request) {
    present p;
    double by[3];
    char words[100];
    if (!stage->side_count || !open_present(stage, &p)) return;
    find_way(&p, request->category, request->index, by);
    size_t place = skein_object_count(p.world, request->category);
    char *json = io_scene_object_beside(p.scene, viewer_list_of(request->category), request->index, by);
    close_present(&p);
    snprintf(words, sizeof words, "a copy, beside the first: %s %zu", skein_category_text(request->category), place);
    bool good = json && put(stage, request->category, place, json, words);
    viewer_event(stage->events, "%s %s %zu", good ? "copied" : "not copied", skein_category_text(request->category),
                 place);
    free(json);
}

/* Puts an object in its own place, with other members. */
static bool change_members(viewer_stage *stage, skein_category category, size_t index, const char *members,
                           const char *words) {
    present p;
    if (!stage->side_count || !open_present(stage, &p)) return false;
    char *json = io_scene_object_with(p.scene, viewer_list_of(category), index, members);
    close_present(&p);
    bool good = json && put(stage, category, index, json, words);
    free(json);
    return good;
}

void viewer_other_kind(viewer_stage *stage, const viewer_request *request) {
    char members[120], words[120];
    snprintf(members, sizeof members, "{\"type\": \"%.80s\"}", request->text);
    snprintf(words, sizeof words, "%s %zu is now: %.60s", skein_category_text(request->category), request->index,
             request->text);
    bool good = change_members(stage, request->category, request->index, members, words);
    viewer_event(stage->events, "%s %zu %s", good ? "turned" : "not turned", request->index, request->text);
}

/* ---- A grid becomes a mesh ---- */

/* Which of a body's vertices are held, as a text of numbers; NULL when there is no memory. */
static char *held_vertices(const skein_world *world, const skein_surface *s) {
    size_t room = 12 * s->vertex_count + 1, length = 0;
    char *text = malloc(room);
    if (!text) return NULL;
    text[0] = 0;
    for (size_t v = 0; v < s->vertex_count; v++)
        if (viewer_is_held(world, s->particle_of_vertex[v]))
            length += (size_t)snprintf(text + length, room - length, "%s%zu", length ? " " : "", v);
    return text;
}

/* Writes the mesh as it is built, in metres. */
static bool write_mesh(viewer_stage *stage, const skein_world *world, const skein_surface *s, const char *path) {
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    double *positions = malloc(3 * s->vertex_count * sizeof *positions);
    bool good = positions != NULL;
    for (size_t v = 0; v < s->vertex_count && good; v++)
        good = !skein_positions_copy(world, s->particle_of_vertex[v], 1, positions + 3 * v);
    skein_mesh mesh = {positions,     s->vertex_count,  s->face_sizes,
                       s->face_count, s->face_vertices, s->face_vertex_count};
    if (good) good = !io_obj_write(path, &mesh, SKEIN_NORMALS_ANGLE, &error);
    if (!good) viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", path, error.message);
    free(positions);
    return good;
}

void viewer_to_mesh(viewer_stage *stage, const viewer_request *request) {
    present p;
    skein_surface s;
    char path[64];
    if (!stage->side_count || !open_present(stage, &p)) return;
    skein_handle body = skein_object_at(p.world, SKEIN_BODY, request->index);
    bool good = !skein_body_surface(p.world, body, &s) && s.face_count && s.grid_rows;
    if (!good) viewer_note(stage, "only a sheet that is a grid becomes a mesh");
    viewer_free_name("mesh", ".obj", path, sizeof path);
    good = good && write_mesh(stage, p.world, &s, path);
    char *whole = good ? realpath(path, NULL) : NULL, *pins = good ? held_vertices(p.world, &s) : NULL;
    size_t size = pins && whole ? strlen(pins) + strlen(whole) + 400 : 0;
    char *members = size ? malloc(size) : NULL, words[120];
    if (members) {
        snprintf(members, size,
                 "{\"mesh\": \"%s\", \"pins\": \"%s\", \"grid\": null, \"size\": null, \"position\": null, "
                 "\"rotation\": null, \"scale\": null}",
                 whole, pins);
        snprintf(words, sizeof words, "body %zu is now the mesh %s: edit it, or take it elsewhere", request->index,
                 path);
    }
    close_present(&p);
    good = members && change_members(stage, SKEIN_BODY, request->index, members, words);
    viewer_event(stage->events, "%s %s", good ? "meshed" : "not meshed", path);
    free(members);
    free(whole);
    free(pins);
}
