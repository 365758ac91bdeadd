/* Making triangles from a mesh: fans, vertices at one place joined, neighbours over edges, pseudo-normals. */
#include "colliders/trimesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/elementary.h"
#include "base/hash.h"
#include "base/status.h"

/* ---- vertices and corners ---- */

static skein_status check_mesh(const skein_mesh *mesh, skein_error *error) {
    if (!mesh || !mesh->vertex_count || !mesh->face_count)
        return sk_fail(error, SKEIN_ERROR_MESH, "mesh", "a collider needs a mesh with vertices and faces%s",
                       mesh ? "" : ": name its file, or pass it to skein_collider_add_mesh()");
    if (mesh->vertex_count > UINT32_MAX / 4 || mesh->face_vertex_count > UINT32_MAX / 4)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "mesh",
                       "%zu vertices and %zu face corners are too many for 32-bit indices", mesh->vertex_count,
                       mesh->face_vertex_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        if (!(fabs(mesh->positions[i]) <= 1e12))
            return sk_fail(error, SKEIN_ERROR_MESH, "mesh", "vertex %zu: coordinates must be finite, under 1e12", i / 3);
    size_t corner = 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        uint32_t size = mesh->face_sizes[f];
        if (size < 3 || size > mesh->face_vertex_count - corner)
            return sk_fail(error, SKEIN_ERROR_MESH, "mesh",
                           "face %zu has %u corners, and %zu are left: expected 3 or more", f, size,
                           mesh->face_vertex_count - corner);
        for (uint32_t k = 0; k < size; k++, corner++)
            if (mesh->face_vertices[corner] >= mesh->vertex_count)
                return sk_fail(error, SKEIN_ERROR_MESH, "mesh", "face %zu names vertex %u, but there are only %zu", f,
                               mesh->face_vertices[corner], mesh->vertex_count);
    }
    return SKEIN_OK;
}

/* Vertices at the same place are one, whatever the file says. */
static bool weld(sk_trimesh *m, const double *positions) {
    size_t buckets = 16;
    while (buckets < m->given_count) buckets *= 2;
    uint32_t *head = sk_allocate(m->allocator, buckets * sizeof *head);
    uint32_t *next = sk_allocate(m->allocator, m->given_count * sizeof *next); // of welded ones
    bool good = head && next;
    for (size_t v = 0; good && v < m->given_count; v++) {
        sk_vec3 p = sk_v3_of(&positions[3 * v]);
        const real own[3] = {p.x + 0, p.y + 0, p.z + 0}; // no -0
        uint64_t key = 0;
        for (int k = 0; k < 3; k++) {
            double d = (double)own[k];
            uint64_t bits;
            memcpy(&bits, &d, sizeof bits);
            key = sk_hash_mix(key ^ bits);
        }
        uint32_t *chain = &head[key & (buckets - 1)], at = *chain; // one more than the vertex
        while (at && (m->place[at - 1].x != own[0] || m->place[at - 1].y != own[1] || m->place[at - 1].z != own[2]))
            at = next[at - 1];
        if (!at) {
            m->place[m->vertex_count] = (sk_vec3){own[0], own[1], own[2]};
            next[m->vertex_count] = *chain;
            at = *chain = (uint32_t)++m->vertex_count;
        }
        m->vertex_of[v] = at - 1;
    }
    sk_release(m->allocator, head);
    sk_release(m->allocator, next);
    return good;
}

/* Faces as fans; those that welding left without three different corners are left out. */
static void cut_faces(sk_trimesh *m, const skein_mesh *mesh) {
    const uint32_t *of_face = mesh->face_vertices;
    for (size_t f = 0; f < mesh->face_count; of_face += mesh->face_sizes[f++])
        for (uint32_t k = 2; k < mesh->face_sizes[f]; k++) {
            uint32_t a = m->vertex_of[of_face[0]], b = m->vertex_of[of_face[k - 1]], c = m->vertex_of[of_face[k]];
            if (a == b || b == c || c == a) {
                m->thin++;
                continue;
            }
            uint32_t *corner = m->corner[m->triangle_count++];
            corner[0] = a, corner[1] = b, corner[2] = c;
        }
}

/* ---- edges ---- */

/* Finds who is beside whom. Edges are listed at their lower vertex. */
static bool join_edges(sk_trimesh *m) {
    size_t edges = 3 * m->triangle_count;
    uint32_t *head = sk_allocate(m->allocator, m->vertex_count * sizeof *head); // one more than the edge
    uint32_t *next = sk_allocate(m->allocator, edges * sizeof *next);
    bool good = head && next;
    for (uint32_t e = 0; good && e < edges; e++) {
        uint32_t a = m->corner[e / 3][e % 3], b = m->corner[e / 3][(e + 1) % 3], low = a < b ? a : b;
        next[e] = head[low], head[low] = e + 1;
        m->beside[e / 3][e % 3] = SK_ALONE;
    }
    for (uint32_t e = 0; good && e < edges; e++) {
        uint32_t a = m->corner[e / 3][e % 3], b = m->corner[e / 3][(e + 1) % 3], partner = SK_ALONE, first = e;
        size_t along = 0, against = 0;
        for (uint32_t i = head[a < b ? a : b]; i; i = next[i - 1]) {
            uint32_t o = i - 1, p = m->corner[o / 3][o % 3], q = m->corner[o / 3][(o + 1) % 3];
            if (p == a && q == b) along++;
            else if (p == b && q == a) against++, partner = o;
            else continue;
            if (o < first) first = o;
        }
        if (along == 1 && against == 1) m->beside[e / 3][e % 3] = partner / 3;
        else if (first == e && along + against == 1) m->open_edges++;
        else if (first == e) m->torn_edges++;
    }
    sk_release(m->allocator, head);
    sk_release(m->allocator, next);
    return good;
}

/* ---- shape ---- */

static void unit(const double v[3], sk_vec3 *out) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), per = length > 0 ? 1 / length : 0;
    *out = sk_v3((real)(per * v[0]), (real)(per * v[1]), (real)(per * v[2]));
}

static void to_double(sk_vec3 v, double out[3]) {
    out[0] = (double)v.x, out[1] = (double)v.y, out[2] = (double)v.z;
}

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static real per(real a) {
    return a > 0 && 1 / a <= SK_REAL_MAX ? 1 / a : 0;
}

static void shape_facet(sk_trimesh *m, size_t t) {
    const uint32_t *corner = m->corner[t];
    sk_vec3 a = m->place[corner[0]], ab = sk_sub(m->place[corner[1]], a), ac = sk_sub(m->place[corner[2]], a);
    sk_facet *f = &m->facet[t];
    *f = (sk_facet){.a = {a.x, a.y, a.z}, .ab = {ab.x, ab.y, ab.z}, .ac = {ac.x, ac.y, ac.z}};
    f->bb = sk_dot(ab, ab), f->bc = sk_dot(ab, ac), f->cc = sk_dot(ac, ac);
    f->per_bb = per(f->bb), f->per_cc = per(f->cc), f->per_ee = per(f->bb - 2 * f->bc + f->cc);
    sk_vec3 n = sk_cross(ab, ac);
    double wide[3];
    to_double(n, wide);
    unit(wide, &m->normal[t]);
    real area = f->bb * f->cc - f->bc * f->bc; // what rounding leaves of it is no area
    f->per_area = area > (real)(sizeof(real) == 4 ? 1e-6 : 1e-13) * f->bb * f->cc ? 1 / area : (real)NAN;
}

static void shape(sk_trimesh *m) {
    memset(m->vertex_normal, 0, m->vertex_count * sizeof *m->vertex_normal);
    for (size_t t = 0; t < m->triangle_count; t++) {
        shape_facet(m, t);
        for (int k = 0; k < 3; k++) {
            uint32_t at = m->corner[t][k];
            double side[2][3], n[3];
            to_double(sk_sub(m->place[m->corner[t][(k + 1) % 3]], m->place[at]), side[0]);
            to_double(sk_sub(m->place[m->corner[t][(k + 2) % 3]], m->place[at]), side[1]);
            n[0] = side[0][1] * side[1][2] - side[0][2] * side[1][1];
            n[1] = side[0][2] * side[1][0] - side[0][0] * side[1][2];
            n[2] = side[0][0] * side[1][1] - side[0][1] * side[1][0];
            real angle = (real)sk_atan2(sqrt(dot3(n, n)), dot3(side[0], side[1]));
            sk_vec3 *sum = &m->vertex_normal[at];
            *sum = sk_add(*sum, sk_v3(angle * m->normal[t].x, angle * m->normal[t].y, angle * m->normal[t].z));
        }
    }
    real most = 0;
    for (size_t v = 0; v < m->vertex_count; v++) {
        double n[3];
        to_double(m->vertex_normal[v], n);
        unit(n, &m->vertex_normal[v]);
        sk_vec3 p = m->place[v];
        most = (real)fmax((double)most, fmax(fabs((double)p.x), fmax(fabs((double)p.y), fabs((double)p.z))));
    }
    real rounding = (sizeof(real) == 4 ? (real)1e-6 : (real)2e-15) * most;
    m->slack = 1000 * rounding * rounding;
    sk_trimesh_fit(m);
}

/* Six times the volume inside. */
static double volume_of(const sk_trimesh *m) {
    double sum = 0, o[3];
    to_double(m->place[m->corner[0][0]], o);
    for (size_t t = 0; t < m->triangle_count; t++) {
        double p[3][3];
        for (int k = 0; k < 3; k++) {
            to_double(m->place[m->corner[t][k]], p[k]);
            for (int i = 0; i < 3; i++) p[k][i] -= o[i];
        }
        sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
               p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    }
    return sum;
}

/* Faces that look inwards all round a closed mesh. */
static void turn_out(sk_trimesh *m) {
    for (size_t t = 0; t < m->triangle_count; t++) {
        uint32_t *corner = m->corner[t], *beside = m->beside[t], kept = corner[1];
        corner[1] = corner[2], corner[2] = kept;
        kept = beside[0], beside[0] = beside[2], beside[2] = kept;
    }
    m->turned = true;
}

/* By what a mesh with a border is a sheet, and not a body with holes: the areas of a body's faces, as vectors, sum up to next to nothing.
 * (Of a flat sheet they are all there is, of half a sphere half, of a crate without its lid a fifth; of a doll without arms, which has an
 * inside, a twentieth. By the winding number, the hollow side of a sheet would be inside or outside as its faces happen to look.) */
static double openness_of(const sk_trimesh *m) {
    double sum[3] = {0, 0, 0}, all = 0;
    for (size_t t = 0; t < m->triangle_count && m->open_edges; t++) {
        double p[3][3], ab[3], ac[3];
        for (int k = 0; k < 3; k++) to_double(m->place[m->corner[t][k]], p[k]);
        for (int k = 0; k < 3; k++) ab[k] = p[1][k] - p[0][k], ac[k] = p[2][k] - p[0][k];
        const double area[3] = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                                ab[0] * ac[1] - ab[1] * ac[0]};
        for (int k = 0; k < 3; k++) sum[k] += area[k];
        all += sqrt(dot3(area, area));
    }
    return all > 0 ? sqrt(dot3(sum, sum)) / all : 0;
}

/* ---- life ---- */

static bool make_room(sk_trimesh *m, size_t triangles) {
    sk_allocator *a = m->allocator;
    m->vertex_of = sk_allocate(a, m->given_count * sizeof *m->vertex_of);
    m->place = sk_allocate(a, m->given_count * sizeof *m->place);
    m->velocity = sk_allocate(a, m->given_count * sizeof *m->velocity);
    m->vertex_normal = sk_allocate(a, m->given_count * sizeof *m->vertex_normal);
    m->corner = sk_allocate(a, triangles * sizeof *m->corner);
    m->beside = sk_allocate(a, triangles * sizeof *m->beside);
    m->facet = sk_allocate(a, triangles * sizeof *m->facet);
    m->normal = sk_allocate(a, triangles * sizeof *m->normal);
    return m->vertex_of && m->place && m->velocity && m->vertex_normal && m->corner && m->beside && m->facet &&
           m->normal;
}

static skein_status fill(sk_trimesh *m, const skein_mesh *mesh, skein_error *error) {
    m->given_count = mesh->vertex_count;
    size_t triangles = mesh->face_vertex_count - 2 * mesh->face_count;
    if (!make_room(m, triangles) || !weld(m, mesh->positions)) return sk_fail_memory(error, "the mesh");
    cut_faces(m, mesh);
    if (!m->triangle_count)
        return sk_fail(error, SKEIN_ERROR_MESH, "mesh", "none of its %zu faces has three corners at different places",
                       mesh->face_count);
    if (!sk_trimesh_plant(m) || !join_edges(m)) return sk_fail_memory(error, "the mesh");
    m->closed = !m->open_edges && !m->torn_edges;
    if (m->closed && volume_of(m) < 0) turn_out(m);
    m->openness = openness_of(m);
    m->sheet = m->openness > 0.15;
    m->dipole = sk_allocate(m->allocator, m->node_count * sizeof *m->dipole);
    if (!m->dipole) return sk_fail_memory(error, "the mesh");
    shape(m);
    return !m->closed || sk_trimesh_divide(m) ? SKEIN_OK : sk_fail_memory(error, "the mesh");
}

skein_status sk_trimesh_create(const skein_mesh *mesh, sk_allocator *allocator, sk_trimesh **made, skein_error *error) {
    skein_status status = check_mesh(mesh, error);
    if (status) return status;
    sk_trimesh *m = sk_allocate(allocator, sizeof *m);
    if (!m) return sk_fail_memory(error, "the mesh");
    m->allocator = allocator;
    status = fill(m, mesh, error);
    if (status) sk_trimesh_destroy(m), m = NULL;
    *made = m;
    return status;
}

void sk_trimesh_destroy(sk_trimesh *m) {
    if (!m) return;
    void *const parts[] = {m->led,  m->from,          m->to,     m->vertex_of, m->place, m->velocity,
                           m->made, m->vertex_normal, m->corner, m->beside,    m->facet, m->normal,
                           m->node, m->dipole,        m->cell};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) sk_release(m->allocator, parts[i]);
    sk_release(m->allocator, m);
}

void sk_trimesh_faults(const sk_trimesh *m, const char *file, char *text, size_t size) {
    size_t at = 0;
    text[0] = 0;
    const struct {
        size_t count;
        const char *one, *many;
    } faults[] = {
        {m->open_edges, "open edge", "open edges"},
        {m->torn_edges, "edge whose faces disagree", "edges whose faces disagree"},
        {m->thin, "face without area, left out", "faces without area, left out"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
        if (faults[i].count && at < size)
            at += (size_t)snprintf(text + at, size - at, "%s%s%s%s%zu %s", at ? ", " : "the mesh",
                                   !at && file[0] ? " " : "", at ? "" : file, at ? "" : " has ", faults[i].count,
                                   faults[i].count == 1 ? faults[i].one : faults[i].many);
}

/* ---- moving ---- */

bool sk_trimesh_provide(sk_trimesh *m) {
    size_t places = m->vertex_count * sizeof *m->from;
    if (!m->led) m->led = sk_allocate(m->allocator, 3 * m->given_count * sizeof *m->led);
    if (!m->from) m->from = sk_allocate(m->allocator, places);
    if (!m->to) m->to = sk_allocate(m->allocator, places);
    if (!m->made) {
        if (!(m->made = sk_allocate(m->allocator, places))) return false;
        memcpy(m->made, m->place, places);
    }
    if (!m->led || !m->from || !m->to) return false;
    sk_release(m->allocator, m->cell); // they would have to be made anew all the time
    m->cell = NULL;
    return true;
}

bool sk_trimesh_lead(sk_trimesh *m, const double *positions) {
    if (!sk_trimesh_provide(m)) return false;
    memcpy(m->led, positions, 3 * m->given_count * sizeof *m->led);
    m->leads = true;
    return true;
}

double sk_trimesh_way(const sk_trimesh *m) {
    double most = 0;
    for (size_t v = 0; v < m->given_count && m->leads; v++) {
        const sk_vec3 way = sk_sub(sk_v3_of(&m->led[3 * v]), m->place[m->vertex_of[v]]);
        most = fmax(most, (double)sk_length(way));
    }
    return most;
}

static void rest(sk_trimesh *m) {
    memset(m->velocity, 0, m->vertex_count * sizeof *m->velocity);
    m->moves = false;
    m->fastest = 0;
}

/* The step is over: they have arrived, and rest. */
static void arrive(sk_trimesh *m) {
    if (!m->moves) return;
    sk_trimesh_follow(m, m->start + m->dt);
    rest(m);
}

/* Where the welded vertices are led. */
static void read_led(const sk_trimesh *m, sk_vec3 *place) {
    // from the last on, so that of several that are one the first counts
    for (size_t v = m->given_count; v-- > 0;) place[m->vertex_of[v]] = sk_v3_of(&m->led[3 * v]);
}

void sk_trimesh_begin(sk_trimesh *m, double time, double dt) {
    arrive(m);
    m->moves = m->leads;
    m->leads = false;
    if (!m->moves) return;
    memcpy(m->from, m->place, m->vertex_count * sizeof *m->from);
    read_led(m, m->to);
    for (size_t v = 0; v < m->vertex_count; v++) {
        m->velocity[v] = sk_scale((real)(1 / dt), sk_sub(m->to[v], m->from[v]));
        m->fastest = fmax(m->fastest, (double)sk_length(m->velocity[v]));
    }
    m->start = m->now = time, m->dt = dt;
}

void sk_trimesh_stop(sk_trimesh *m) {
    arrive(m);
    if (!m->leads) return;
    read_led(m, m->place);
    sk_trimesh_settle(m);
}

void sk_trimesh_settle(sk_trimesh *m) {
    rest(m);
    m->leads = false;
    shape(m);
}

void sk_trimesh_follow(sk_trimesh *m, double time) {
    if (!m->moves || m->now == time) return;
    double part = (time - m->start) / m->dt;
    // at the end exactly there
    bool over = part > 1 - 1e-9;
    for (size_t v = 0; v < m->vertex_count; v++)
        m->place[v] = over ? m->to[v] : sk_add(m->from[v], sk_scale((real)part, sk_sub(m->to[v], m->from[v])));
    m->now = time;
    shape(m);
}

sk_vec3 sk_trimesh_place(const sk_trimesh *m, size_t vertex, double time) {
    return m->moves && (time - m->start) / m->dt > 1 - 1e-9 ? m->to[vertex] : m->place[vertex];
}

/* ---- looking at one triangle ---- */

/* The nearest point of a triangle to `ap`, from corner a on: its weights of b and c, and the normal of the face, edge or corner
 * that it is on. */
static void nearest(const sk_trimesh *m, uint32_t t, const double ap[3], double weight[2], double normal[3]) {
    const sk_facet *f = &m->facet[t];
    double ab[3], ac[3];
    for (int k = 0; k < 3; k++) ab[k] = (double)f->ab[k], ac[k] = (double)f->ac[k];
    double d1 = dot3(ab, ap), d2 = dot3(ac, ap), bb = dot3(ab, ab), bc = dot3(ab, ac), cc = dot3(ac, ac);
    double d3 = d1 - bb, d4 = d2 - bc, d5 = d1 - bc, d6 = d2 - cc;
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    int corner = -1, edge = -1;
    weight[0] = weight[1] = 0;
    if (d1 <= 0 && d2 <= 0) corner = 0;
    else if (d3 >= 0 && d4 <= d3) corner = 1, weight[0] = 1;
    else if (d6 >= 0 && d5 <= d6) corner = 2, weight[1] = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0) edge = 0, weight[0] = d1 / (d1 - d3);
    else if (vb <= 0 && d2 >= 0 && d6 <= 0) edge = 2, weight[1] = d2 / (d2 - d6);
    else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        edge = 1, weight[1] = (d4 - d3) / ((d4 - d3) + (d5 - d6)), weight[0] = 1 - weight[1];
    } else weight[0] = vb / (va + vb + vc), weight[1] = vc / (va + vb + vc);
    to_double(corner >= 0 ? m->vertex_normal[m->corner[t][corner]] : m->normal[t], normal);
    if (edge < 0 || m->beside[t][edge] == SK_ALONE) return;
    double other[3];
    to_double(m->normal[m->beside[t][edge]], other);
    for (int k = 0; k < 3; k++) normal[k] += other[k];
    double length = sqrt(dot3(normal, normal));
    for (int k = 0; k < 3; k++) normal[k] = length > 0 ? normal[k] / length : (double)(&m->normal[t].x)[k];
}

void sk_trimesh_look(const sk_trimesh *m, uint32_t triangle, const real p[3], sk_trimesh_spot *spot) {
    const sk_facet *f = &m->facet[triangle];
    double ap[3], weight[2], n[3], away[3], at[3], size = 0.1;
    for (int k = 0; k < 3; k++) ap[k] = (double)p[k] - (double)f->a[k], at[k] = (double)p[k], size += fabs(at[k]);
    nearest(m, triangle, ap, weight, n);
    for (int k = 0; k < 3; k++) away[k] = ap[k] - weight[0] * (double)f->ab[k] - weight[1] * (double)f->ac[k];
    double d = sqrt(dot3(away, away)), side = dot3(away, n);
    bool inside = m->closed ? side < 0 : !m->sheet && sk_trimesh_winding(m, at) > 0.5;
    // on the surface itself its own normal counts, on the side of an open one that p is on
    double sign = inside ? -1 : 1, tiny = (sizeof(real) == 4 ? 1e-6 : 1e-14) * size;
    bool on = d <= tiny;
    if (on && !m->closed) sign = 1;
    for (int k = 0; k < 3; k++)
        spot->normal[k] = on ? (!m->closed && !inside && side < 0 ? -n[k] : n[k]) : sign * away[k] / d;
    spot->distance = (inside ? -1 : 1) * d;
    spot->speed = spot->slide[0] = spot->slide[1] = spot->slide[2] = 0;
    if (!m->moves) return;
    const uint32_t *corner = m->corner[triangle];
    double v[3][3];
    for (int k = 0; k < 3; k++) to_double(m->velocity[corner[k]], v[k]);
    for (int k = 0; k < 3; k++)
        spot->slide[k] = (1 - weight[0] - weight[1]) * v[0][k] + weight[0] * v[1][k] + weight[1] * v[2][k];
    spot->speed = dot3(spot->normal, spot->slide);
    for (int k = 0; k < 3; k++) spot->slide[k] -= spot->speed * spot->normal[k];
}
