/* Lists of panels, made with the skin, once; nothing where no sheet was built flat. Here is what kernels walk along, and room
 * for it all. */
#include "contact/make/spread.h"

/* ---- rows ---- */

/* What makes J of two differences of corners. */
static void put_inverse(const making *m, const uint32_t corner[3], real (*inverse)[SK_PANEL_LANES], size_t lane) {
    spot o = m->spot[corner[0]], a = m->spot[corner[1]], b = m->spot[corner[2]];
    real x1 = a.u - o.u, y1 = a.v - o.v, x2 = b.u - o.u, y2 = b.v - o.v, det = x1 * y2 - x2 * y1;
    bool good = det > 0 || det < 0;
    const real of[4] = {y2, -y1, -x2, x1};
    for (int k = 0; k < 4; k++) inverse[k][lane] = good ? of[k] / det : 0;
}

static void put_row(making *m, size_t row, size_t lane, uint32_t leaf, bool flat) {
    sk_spread *spread = m->spread;
    uint32_t corner[4];
    corners_in_row(m->skin, &m->skin->leaf[leaf], corner);
    for (int c = 0; c < 4; c++) spread->corner[row][c][lane] = corner[c];
    const uint32_t first[3] = {corner[0], corner[1], corner[2]}, second[3] = {corner[0], corner[1], corner[3]};
    if (flat)
        put_inverse(m, first, spread->inverse[row][0], lane), put_inverse(m, second, spread->inverse[row][1], lane);
}

static bool make_rows(making *m) {
    sk_spread *spread = m->spread;
    const size_t groups = (spread->count + SK_PANEL_LANES - 1) / SK_PANEL_LANES;
    spread->row_start = sk_allocate(m->allocator, (groups + 1) * sizeof *spread->row_start);
    if (!spread->row_start) return false;
    for (size_t p = 0; p < spread->count; p++) {
        uint32_t leaves = spread->leaves.start[p + 1] - spread->leaves.start[p],
                 *rows = &spread->row_start[p / SK_PANEL_LANES + 1];
        if (leaves > *rows) *rows = leaves;
    }
    for (size_t g = 0; g < groups; g++) spread->row_start[g + 1] += spread->row_start[g];
    const size_t rows = spread->row_start[groups];
    spread->corner = sk_allocate(m->allocator, (rows + 1) * sizeof *spread->corner);
    spread->inverse = sk_allocate(m->allocator, (rows + 1) * sizeof *spread->inverse);
    spread->gradient = sk_allocate(m->allocator, (rows + 1) * sizeof *spread->gradient);
    if (!spread->corner || !spread->inverse || !spread->gradient) return false;
    for (size_t p = 0; p < groups * SK_PANEL_LANES; p++) { // lanes of no panel are the last one's
        const size_t panel = p < spread->count ? p : spread->count - 1, group = p / SK_PANEL_LANES;
        const uint32_t first = spread->leaves.start[panel], leaves = spread->leaves.start[panel + 1] - first;
        const bool flat = m->flat[piece_of_panel(m, panel)];
        for (uint32_t r = spread->row_start[group]; r < spread->row_start[group + 1]; r++) {
            uint32_t k = r - spread->row_start[group];
            put_row(m, r, p % SK_PANEL_LANES, spread->leaves.number[first + (k < leaves ? k : 0)], flat);
        }
    }
    return true;
}

/* ---- all ---- */

static bool reserve(making *m) {
    const size_t vertices = m->skin->vertex_count + 1, leaves = m->skin->leaf_count + 2;
    sk_spread *spread = m->spread;
    sk_allocator *a = m->allocator;
    spread->of_leaf = sk_allocate(a, leaves * sizeof *spread->of_leaf);
    spread->leaves.start = sk_allocate(a, leaves * sizeof *spread->leaves.start);
    spread->leaves.number = sk_allocate(a, leaves * sizeof *spread->leaves.number);
    spread->vertex_out = sk_allocate(a, vertices);
    spread->patch_out = sk_allocate(a, leaves);
    spread->mark = sk_allocate(a, vertices);
    m->centre = sk_allocate(a, leaves * sizeof *m->centre);
    m->bin = sk_allocate(a, leaves * sizeof *m->bin);
    m->of_leaf = sk_allocate(a, leaves * sizeof *m->of_leaf);
    return spread->of_leaf && spread->leaves.start && spread->leaves.number && spread->vertex_out &&
           spread->patch_out && spread->mark && m->centre && m->of_leaf && m->bin;
}

static bool reserve_panels(making *m) {
    const size_t panels = m->spread->count + 2;
    sk_spread *spread = m->spread;
    sk_allocator *a = m->allocator;
    spread->sixteen = sk_allocate(a, (panels + SK_PANEL_LANES) / SK_PANEL_LANES * sizeof *spread->sixteen);
    spread->least = sk_allocate(a, panels * sizeof *spread->least);
    spread->out = sk_allocate(a, panels);
    spread->was_out = sk_allocate(a, panels);
    spread->turned = sk_allocate(a, panels);
    spread->box = sk_allocate(a, panels * sizeof *spread->box);
    spread->wide = sk_allocate(a, panels * sizeof *spread->wide);
    spread->age = SK_PANEL_AHEAD;
    spread->met = sk_allocate(a, panels * sizeof *spread->met);
    spread->beside.start = sk_allocate(a, panels * sizeof *spread->beside.start);
    m->in_bin = sk_allocate(a, panels * sizeof *m->in_bin);
    m->apart = sk_allocate(a, panels * sizeof *m->apart);
    m->steep = sk_allocate(a, panels * sizeof *m->steep);
    m->of_panel = sk_allocate(a, panels * sizeof *m->of_panel);
    m->longest = sk_allocate(a, panels * sizeof *m->longest);
    m->order = sk_allocate(a, panels * sizeof *m->order);
    bool good = sk_tree_reserve(&spread->tree, a, spread->count);
    return good && spread->sixteen && spread->least && spread->out && spread->was_out && spread->turned &&
           spread->box && spread->wide && spread->met && spread->beside.start && m->in_bin && m->apart && m->steep &&
           m->of_panel && m->longest && m->order;
}

/* Lanes of no panel are never off their course. */
static void free_lanes(sk_spread *spread) {
    for (size_t p = spread->count; p % SK_PANEL_LANES; p++)
        for (int n = 0; n < 6; n++) {
            sk_tree_block *course = &spread->sixteen[p / SK_PANEL_LANES].course;
            course->low[n / 3][n % 3][p % SK_PANEL_LANES] = -SK_REAL_MAX;
            course->high[n / 3][n % 3][p % SK_PANEL_LANES] = SK_REAL_MAX;
        }
}

static bool make_panels(making *m) {
    if (!reserve(m)) return false;
    if (!sk_panels_deal(m) || !reserve_panels(m)) return false;
    free_lanes(m->spread);
    sk_panels_measure(m);
    return sk_blocks_list(m) && make_rows(m);
}

bool sk_spread_make(sk_touch *touch, sk_allocator *allocator) {
    sk_spread_release(&touch->spread, allocator);
    const size_t vertices = touch->skin.vertex_count + 1;
    making m = {.skin = &touch->skin, .spread = &touch->spread, .allocator = allocator};
    m.normal = sk_allocate(allocator, vertices * sizeof *m.normal);
    m.along = sk_allocate(allocator, vertices * sizeof *m.along);
    m.flat = sk_allocate(allocator, vertices);
    m.border = sk_allocate(allocator, touch->skin.edge_count + 1);
    m.spot = sk_allocate(allocator, vertices * sizeof *m.spot);
    bool good = m.normal && m.along && m.flat && m.border && m.spot;
    if (good && sk_sheets_find(&m)) good = make_panels(&m);
    void *arrays[] = {m.normal,         m.along,      m.flat,        m.border,       m.spot,        m.centre,
                      m.of_leaf,        m.of_panel,   m.longest,     m.apart,        m.steep,       m.bin,
                      m.order,          m.in_bin,     m.beside.data, m.members.data, m.around.data, m.starts[0].data,
                      m.starts[1].data, m.block.data, m.point,       m.hull};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    if (!good) sk_spread_release(&touch->spread, allocator);
    return good;
}

void sk_spread_release(sk_spread *spread, sk_allocator *allocator) {
    sk_lists *lists[] = {&spread->leaves,  &spread->blocks, &spread->beside,
                         &spread->members, &spread->around, &spread->through};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        sk_release(allocator, lists[i]->start);
        sk_release(allocator, lists[i]->number);
    }
    void *arrays[] = {spread->sixteen,   spread->least,  spread->of_leaf,    spread->block,     spread->out,
                      spread->was_out,   spread->turned, spread->vertex_out, spread->patch_out, spread->mark,
                      spread->row_start, spread->corner, spread->inverse,    spread->gradient,  spread->box,
                      spread->wide,      spread->met};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    sk_tree_release(&spread->tree, allocator);
    *spread = (sk_spread){.count = 0};
}
