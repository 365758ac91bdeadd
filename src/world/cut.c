/* Cutting cloth: which faces a blade meets, and taking faces away. A face that is gone keeps its place among the world's
 * triangles, with one corner three times, so that no rule has to count anew; what held across it is left out when slots
 * are next arranged, as all is of bodies that come and go. */
#include <skein/cut.h>

#include <math.h>
#include <string.h>

#include "world/cut.h"
#include "world/record.h"

/* ---- a body's cut ---- */

void sk_cut_release(sk_cut *cut, sk_allocator *allocator) {
    if (!cut) return;
    void *arrays[] = {cut->face,       cut->triangle, cut->first,  cut->corner, cut->start, cut->around,
                      cut->first_side, cut->side,     cut->to_cut, cut->queue,  cut->mark};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    sk_release(allocator, cut);
}

/* The corners of faces as particles, and the faces around each particle. */
static void fill_surface(sk_cut *cut) {
    const sk_body *body = cut->body;
    size_t corners = 0;
    for (size_t f = 0; f < body->face_count; f++) {
        cut->first[f] = corners;
        for (uint32_t k = 0; k < body->face_sizes[f]; k++, corners++)
            cut->corner[corners] = body->particle_of_vertex[body->face_vertices[corners]] - body->first_particle;
    }
    cut->first[body->face_count] = corners;
    for (size_t i = 0; i < corners; i++) cut->start[cut->corner[i] + 1]++;
    for (size_t p = 0; p < body->particle_count; p++) cut->start[p + 1] += cut->start[p];
    for (size_t f = body->face_count; f-- > 0;) // from behind, so that starts end where they are to be
        for (size_t i = cut->first[f]; i < cut->first[f + 1]; i++)
            cut->around[--cut->start[cut->corner[i] + 1]] = (uint32_t)f;
    memmove(cut->start, cut->start + 1, body->particle_count * sizeof *cut->start);
    cut->start[body->particle_count] = corners;
}

/* Notes a neighbour of the particle whose sides end at `end`, once. */
static size_t add_side(sk_cut *cut, size_t first, size_t end, uint32_t particle) {
    for (size_t i = first; i < end; i++)
        if (cut->side[i].particle == particle) return end;
    cut->side[end] = (sk_side){particle, true};
    return end + 1;
}

static void fill_sides(sk_cut *cut) {
    size_t end = 0;
    for (uint32_t p = 0; p < cut->body->particle_count; p++) {
        size_t first = cut->first_side[p] = end;
        for (size_t i = cut->start[p]; i < cut->start[p + 1]; i++) {
            size_t corner = cut->first[cut->around[i]], size = cut->first[cut->around[i] + 1] - corner;
            for (size_t k = 0; k < size; k++) {
                if (cut->corner[corner + k] != p) continue;
                end = add_side(cut, first, end, cut->corner[corner + (k + 1) % size]);
                end = add_side(cut, first, end, cut->corner[corner + (k + size - 1) % size]);
            }
        }
    }
    cut->first_side[cut->body->particle_count] = end;
}

static sk_cut *make_cut(skein_world *world, const sk_body *body) {
    sk_allocator *allocator = &world->allocator;
    sk_cut *cut = sk_allocate(allocator, sizeof *cut);
    if (!cut) return NULL;
    size_t particles = body->particle_count;
    cut->body = body;
    cut->face = sk_allocate(allocator, body->face_count * sizeof *cut->face);
    cut->triangle = sk_allocate(allocator, body->triangle_count * sizeof *cut->triangle);
    cut->first = sk_allocate(allocator, (body->face_count + 1) * sizeof *cut->first);
    cut->corner = sk_allocate(allocator, body->face_vertex_count * sizeof *cut->corner);
    cut->start = sk_allocate(allocator, (particles + 1) * sizeof *cut->start);
    cut->around = sk_allocate(allocator, body->face_vertex_count * sizeof *cut->around);
    cut->first_side = sk_allocate(allocator, (particles + 1) * sizeof *cut->first_side);
    cut->side = sk_allocate(allocator, 2 * body->face_vertex_count * sizeof *cut->side);
    cut->to_cut = sk_allocate(allocator, particles * sizeof *cut->to_cut);
    cut->queue = sk_allocate(allocator, particles * sizeof *cut->queue);
    cut->mark = sk_allocate(allocator, particles * sizeof *cut->mark);
    if (!cut->face || !cut->triangle || !cut->first || !cut->corner || !cut->start || !cut->around ||
        !cut->first_side || !cut->side || !cut->to_cut || !cut->queue || !cut->mark) {
        sk_cut_release(cut, allocator);
        return NULL;
    }
    memcpy(cut->triangle, world->triangles.corner + body->first_triangle, body->triangle_count * sizeof *cut->triangle);
    fill_surface(cut);
    fill_sides(cut);
    return cut;
}

const uint32_t (*sk_built_triangles(const skein_world *world, const sk_body *body))[3] {
    if (!body->triangle_count) return NULL;
    return (const uint32_t(*)[3])(body->cut ? body->cut->triangle : world->triangles.corner + body->first_triangle);
}

/* Takes the faces' triangles out of the world's, or puts them back. */
static void set_triangles(skein_world *world, const sk_cut *cut) {
    const sk_body *body = cut->body;
    uint32_t(*to)[3] = world->triangles.corner + body->first_triangle;
    for (size_t f = 0, t = 0; f < body->face_count; f++)
        for (uint32_t k = 2; k < body->face_sizes[f]; k++, t++)
            for (int c = 0; c < 3; c++) to[t][c] = cut->triangle[t][cut->face[f] ? 0 : c];
}

bool sk_cut_begin(skein_world *world, sk_body *body) {
    return body->cut || (body->cut = make_cut(world, body));
}

bool sk_cut_set(skein_world *world, sk_body *body, const uint8_t *face) {
    if (!body->cut && !face) return true;
    if (!sk_cut_begin(world, body)) return false;
    sk_cut *cut = body->cut;
    size_t changed = 0;
    for (size_t f = 0; f < body->face_count; f++) changed += cut->face[f] != (face && face[f]);
    if (!changed) return true;
    cut->count = 0;
    for (size_t f = 0; f < body->face_count; f++) {
        cut->face[f] = face && face[f];
        cut->count += cut->face[f];
    }
    cut->changes++;
    sk_world_rouse_at(world, body->first_particle, body->particle_count);
    sk_cut_find_sides(cut);
    set_triangles(world, cut);
    world->plan_stale = world->slots_stale = world->presence_stale = true;
    return true;
}

void sk_put_cut(sk_byte_writer *w, const sk_body *body) {
    const sk_cut *cut = body->cut;
    sk_put_u64(w, cut ? cut->count : 0);
    for (size_t f = 0; cut && f < body->face_count; f++)
        if (cut->face[f]) sk_put_u32(w, (uint32_t)f);
}

bool sk_take_cut(sk_byte_reader *r, skein_world *world, sk_object *object, bool apply, bool *memory) {
    sk_body *body = object->as.body;
    uint64_t count = sk_take_u64(r);
    *memory = true;
    if (r->short_ || !object->body_type->is_sheet || count > body->face_count || count > sk_left(r) / 4) return false;
    uint8_t *face = sk_allocate(&world->allocator, body->face_count * sizeof *face);
    *memory = face != NULL;
    bool good = face != NULL;
    for (uint64_t i = 0; i < count && good; i++) {
        uint32_t f = sk_take_u32(r);
        good = f < body->face_count;
        if (good) face[f] = 1;
    }
    if (good && apply) good = *memory = sk_cut_set(world, body, face);
    sk_release(&world->allocator, face);
    return good;
}

/* ---- the blade ---- */

static void minus(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}
static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}
static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether the way from p to q goes through a triangle (Moeller and Trumbore 1997). One within its plane does not. */
static bool goes_through(const double p[3], const double q[3], const double a[3], const double b[3], const double c[3]) {
    double way[3], ab[3], ac[3], ap[3], h[3], s[3];
    minus(q, p, way), minus(b, a, ab), minus(c, a, ac), minus(p, a, ap);
    cross(way, ac, h);
    double det = dot(ab, h), u = dot(ap, h), sign = det < 0 ? -1 : 1;
    det *= sign, u *= sign;
    if (!(det > 0) || u < 0 || u > det) return false;
    cross(ap, ab, s);
    double v = sign * dot(way, s), t = sign * dot(ac, s);
    return v >= 0 && u + v <= det && t >= 0 && t <= det;
}

static bool meet(const double a[3][3], const double b[3][3]) {
    for (int k = 0; k < 3; k++)
        if (goes_through(a[k], a[(k + 1) % 3], b[0], b[1], b[2]) || goes_through(b[k], b[(k + 1) % 3], a[0], a[1], a[2]))
            return true;
    return false;
}

/* Marks the faces that the blade meets. The state is here. */
static void mark_met(const skein_world *world, const sk_body *body, const double (*blade)[3], uint8_t *face) {
    const sk_particles *all = &world->particles;
    const uint32_t(*triangle)[3] = sk_built_triangles(world, body);
    for (size_t f = 0, t = 0; f < body->face_count; f++)
        for (uint32_t k = 2; k < body->face_sizes[f]; k++, t++) {
            double corner[3][3];
            for (int c = 0; c < 3; c++) {
                sk_vec4 p = all->vector[SK_X][all->slot_of[triangle[t][c]]];
                corner[c][0] = (double)p.x, corner[c][1] = (double)p.y, corner[c][2] = (double)p.z;
            }
            if (meet((const double(*)[3])corner, blade)) face[f] = 1;
        }
}

/* ---- calls ---- */

/* The body that is to be cut, and its cut faces to be added to (the caller's); where there is none the world's error says
 * why. */
static skein_status find_sheet(skein_world *world, skein_handle handle, sk_body **body, uint8_t **face) {
    const sk_object *object = sk_object_find(world, handle, SKEIN_BODY);
    skein_error *error = sk_world_error(world);
    if (!object) return SKEIN_ERROR_HANDLE;
    if (!object->body_type->is_sheet)
        return sk_fail(error, SKEIN_ERROR_VALUE, object->label, "a %s cannot be cut: only sheets can, such as a cloth",
                       object->kind->name);
    *body = object->as.body;
    *face = sk_allocate(&world->allocator, (*body)->face_count * sizeof **face);
    if (!*face) return sk_fail_memory(error, "a cut");
    if ((*body)->cut) memcpy(*face, (*body)->cut->face, (*body)->face_count * sizeof **face);
    return SKEIN_OK;
}

/* Takes the faces away, tells the recording, and releases `face`. */
static skein_status take_away(skein_world *world, sk_body *body, uint8_t *face, size_t *count) {
    size_t before = body->cut ? body->cut->count : 0;
    skein_status status = sk_world_touch(world); // the state goes to new slots
    if (!status && !sk_cut_set(world, body, face)) status = sk_fail_memory(sk_world_error(world), "a cut");
    sk_release(&world->allocator, face);
    if (status) return status;
    if (count) *count = body->cut->count - before;
    if (body->cut->count > before) sk_record_cut(world, body);
    return SKEIN_OK;
}

skein_status skein_cut(skein_world *world, skein_handle handle, const double (*blade)[3], size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, blade);
    sk_body *body;
    uint8_t *face;
    for (int i = 0; i < 9; i++)
        if (!(fabs(blade[i / 3][i % 3]) <= SK_FAR))
            return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "blade",
                           "corner %d of the blade: numbers must be finite, under 1e15", i / 3);
    skein_status status = find_sheet(world, handle, &body, &face);
    if (status) return status;
    if ((status = sk_world_fetch(world))) {
        sk_release(&world->allocator, face);
        return status;
    }
    mark_met(world, body, blade, face);
    return take_away(world, body, face, count);
}

skein_status skein_cut_faces(skein_world *world, skein_handle handle, const uint32_t *faces, size_t count) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, faces);
    sk_body *body;
    uint8_t *face;
    skein_status status = find_sheet(world, handle, &body, &face);
    for (size_t i = 0; i < count && !status; i++) {
        if (faces[i] < body->face_count) {
            face[faces[i]] = 1;
            continue;
        }
        status = sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "faces", "there is no face %u (the body has %zu)",
                         faces[i], body->face_count);
        sk_release(&world->allocator, face);
    }
    return status ? status : take_away(world, body, face, NULL);
}

skein_status skein_cut_mend(skein_world *world, skein_handle handle) {
    SK_NEED(world, world);
    const sk_object *object = sk_object_find(world, handle, SKEIN_BODY);
    if (!object) return SKEIN_ERROR_HANDLE;
    sk_body *body = object->as.body;
    if (!body->cut || !body->cut->count) return SKEIN_OK;
    skein_status status = sk_world_touch(world);
    if (status) return status;
    sk_cut_set(world, body, NULL);
    sk_record_cut(world, body);
    return SKEIN_OK;
}

skein_status skein_body_cuts(const skein_world *world, skein_handle handle, skein_cuts *cuts) {
    SK_NEED(world, world);
    SK_NEED(world, cuts);
    const sk_object *object = sk_object_find(world, handle, SKEIN_BODY);
    if (!object) return SKEIN_ERROR_HANDLE;
    const sk_cut *cut = object->as.body->cut;
    *cuts = cut ? (skein_cuts){cut->face, cut->count, cut->changes} : (skein_cuts){NULL, 0, 0};
    return SKEIN_OK;
}
