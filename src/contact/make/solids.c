/* Which pieces of a skin are solids: each edge of a closed surface has two triangles; and whom such a surface encloses: the particles
 * of a body that has no other. */
#include "contact/touch.h"

#define NOBODY UINT32_MAX

/* Six times the volume in front of the origin that a triangle adds. */
static double volume_of(const sk_skin *skin, const uint32_t t[3]) {
    const sk_vec3 a = sk_xyz(skin->built[t[0]]), b = sk_xyz(skin->built[t[1]]), c = sk_xyz(skin->built[t[2]]);
    return (double)sk_dot(a, sk_cross(b, c));
}

static bool find_closed(sk_skin *skin, sk_allocator *allocator) {
    const size_t vertices = skin->vertex_count + 1;
    int32_t *open = sk_allocate(allocator, vertices * sizeof *open);
    double *volume = sk_allocate(allocator, vertices * sizeof *volume);
    skin->closed = sk_allocate(allocator, vertices);
    const bool good = open && volume && skin->closed;
    if (good) {
        for (size_t t = 0; t < skin->triangle_count; t++) {
            const uint32_t piece = skin->piece[skin->triangle[t][0]];
            open[piece] += 3;
            volume[piece] += volume_of(skin, skin->triangle[t]);
        }
        for (size_t e = 0; e < skin->edge_count; e++) open[skin->piece[skin->edge[e][0]]] -= 2;
        for (size_t p = 0; p < skin->vertex_count; p++) skin->closed[p] = open[p] != 0 ? 0 : volume[p] < 0 ? -1 : 1;
    }
    sk_release(allocator, open);
    sk_release(allocator, volume);
    return good;
}

/* The piece that is all of a body's surface, if it is closed, or NOBODY. */
static uint32_t piece_of(const sk_skin *skin, const sk_meeting_body *body, const uint32_t *vertex_of) {
    uint32_t piece = NOBODY;
    for (size_t i = body->first; i < body->end; i++) {
        if (vertex_of[i] == NOBODY) continue;
        const uint32_t own = skin->piece[vertex_of[i]];
        if (piece != NOBODY && own != piece) return NOBODY;
        piece = own;
    }
    return piece != NOBODY && skin->closed[piece] ? piece : NOBODY;
}

bool sk_solids_make(sk_skin *skin, sk_allocator *allocator, const sk_particles *particles, const uint32_t *vertex_of,
                    const sk_meeting_parts *parts) {
    if (!find_closed(skin, allocator)) return false;
    for (int fill = 0; fill < 2; fill++) {
        if (fill && !(skin->inner = sk_allocate(allocator, (skin->inner_count + 1) * sizeof *skin->inner)))
            return false;
        skin->inner_count = 0;
        for (size_t b = 0; b < parts->body_count; b++) {
            const sk_meeting_body *body = &parts->body[b];
            const uint32_t piece = piece_of(skin, body, vertex_of);
            for (size_t i = body->first; piece != NOBODY && i < body->end; i++) {
                if (vertex_of[i] != NOBODY || !sk_particle_is_here(particles, (uint32_t)i)) continue;
                if (fill) skin->inner[skin->inner_count] = (sk_inner){(uint32_t)i, piece};
                skin->inner_count++;
            }
        }
    }
    return true;
}
