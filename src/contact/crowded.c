/* Bodies that are too thick for their edges: each feature has dozens of others near it then. A flag of 100 x 100, whose edges are
 * 11 mm long in the mean, takes 28 ms a frame with a thickness of 2 mm, 52 with 5, 163 with 8 and 361 with 14 (AVX2). */
#include "contact/touch.h"

/* The mean edge of a body's triangles, as they were built, m; 0: it has none here. */
static double mean_edge_of(const sk_skin *skin, const sk_meeting_body *body) {
    double sum = 0;
    size_t count = 0;
    for (size_t t = 0; t < skin->triangle_count; t++)
        for (int c = 0; c < 3; c++) {
            const uint32_t a = skin->triangle[t][c], b = skin->triangle[t][(c + 1) % 3];
            if (skin->particle[a] < body->first || skin->particle[a] >= body->end) continue;
            sum += (double)sk_length(sk_sub(sk_xyz(skin->built[b]), sk_xyz(skin->built[a])));
            count++;
        }
    return count ? sum / (double)count : 0;
}

const sk_meeting_body *sk_touch_crowded(const sk_touch *touch, const sk_meeting_parts *parts, double usual, double *edge, double *thickness) {
    const double most = 0.6; // of an edge
    for (size_t i = 0; i < parts->body_count; i++) {
        const sk_meeting_body *body = &parts->body[i];
        *thickness = body->thickness > 0 ? body->thickness : usual;
        *edge = mean_edge_of(&touch->skin, body);
        if (*edge > 0 && *thickness > most * *edge) return body;
    }
    return NULL;
}
