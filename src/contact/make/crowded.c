/* Bodies that are too thick for their edges: each feature has dozens of others near it then. A flag of 100 x 100, whose edges are
 * 11 mm long in the mean, takes 28 ms a frame with a thickness of 2 mm, 52 with 5, 163 with 8 and 361 with 14 (AVX2). */
#include "contact/touch.h"

/* Edges of a body's triangles, as they were built. */
typedef struct edges {
    double length; // of all together, m
    size_t count;
} edges;

/* Triangles of a body mostly follow each other, so the body of the last one is asked first. */
static size_t body_of(const sk_meeting_parts *parts, uint32_t particle, size_t last) {
    for (size_t n = 0; n < parts->body_count; n++) {
        const size_t i = (last + n) % parts->body_count;
        if (particle >= parts->body[i].first && particle < parts->body[i].end) return i;
    }
    return parts->body_count;
}

static void add_edges(const sk_skin *skin, const sk_meeting_parts *parts, edges *of) {
    for (size_t t = 0, body = 0; t < skin->triangle_count; t++) {
        const uint32_t *corner = skin->triangle[t];
        body = body_of(parts, skin->particle[corner[0]], body);
        if (body == parts->body_count) continue;
        for (int c = 0; c < 3; c++)
            of[body].length +=
                (double)sk_length(sk_sub(sk_xyz(skin->built[corner[(c + 1) % 3]]), sk_xyz(skin->built[corner[c]])));
        of[body].count += 3;
    }
}

const sk_meeting_body *sk_touch_crowded(const sk_touch *touch, sk_allocator *allocator, const sk_meeting_parts *parts,
                                        double usual, double *edge, double *thickness) {
    const double most = 0.6; // of an edge
    edges *of = sk_allocate(allocator, (parts->body_count + 1) * sizeof *of);
    const sk_meeting_body *crowded = NULL;
    if (of) add_edges(&touch->skin, parts, of);
    for (size_t i = 0; i < parts->body_count && of && !crowded; i++) {
        if (!of[i].count) continue;
        *thickness = parts->body[i].thickness > 0 ? parts->body[i].thickness : usual;
        *edge = of[i].length / (double)of[i].count;
        if (*thickness > most * *edge) crowded = &parts->body[i];
    }
    sk_release(allocator, of);
    return crowded;
}
