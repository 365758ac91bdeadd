/* The springs of a sheet: which pairs of particles are joined, and how much material each stands for.
 *
 *   o---o---o     stretch  every edge of the mesh, once
 *   | X | X |     shear    each quad's two diagonals (in larger faces, the corners two apart)
 *   o---o---o     bend     across every edge between two faces: the off-edge corners of two triangles,
 *   |   |   |              the vertices straight across of two quads
 *
 * No pair gets two springs; stretch goes before shear before bend. A pair's scale turns the material's
 * stiffness (N/m of a sheet) into the spring's: a sheet feels the same at any resolution. */
#ifndef SK_BODIES_SPRINGS_H
#define SK_BODIES_SPRINGS_H

#include "base/vector.h"
#include "bodies/sheet.h"

/* In the order of sweeps. */
typedef enum sk_spring_sort { SK_BEND, SK_SHEAR, SK_STRETCH, SK_SPRING_SORTS } sk_spring_sort;

typedef struct sk_edge {
    uint32_t a, b;       /* a < b */
    uint32_t face[2];    /* the faces on it, UINT32_MAX where there is none */
    uint32_t corner[2];  /* where a..b or b..a starts in sheet->corners */
    uint32_t face_count; /* can be over 2: a fault of the mesh */
} sk_edge;

typedef struct sk_springs {
    sk_allocator *allocator;
    sk_edge *edges;
    size_t edge_count, edge_capacity;
    struct sk_spring_list {
        uint32_t *pairs; /* count x 2 */
        real *rest, *scale;
        size_t count;
    } list[SK_SPRING_SORTS];
} sk_springs;

skein_status sk_springs_find(sk_springs *springs, const sk_sheet *sheet, skein_error *error);
void sk_springs_release(sk_springs *springs);

#endif
