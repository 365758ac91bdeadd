// A walk over a particle's neighbours in the grid, which it reads by cell_at() and position_at(): neighbours.glsl has them.
// Like flocking.glsl it is GLSL ES 3.00, too.
#ifdef MOST@
// The nearest neighbours so far, nearest first; of equally near ones, those found first.
float near_square@[MOST@];
uint near_place@[MOST@];

void keep@(float square, uint other) {
    bool in_list = false; // from there on each takes the place of the next
    for (int k = 0; k < MOST@; k++) {
        if (!in_list && !(square < near_square@[k])) continue;
        in_list = true;
        float next_square = near_square@[k];
        uint next = near_place@[k];
        near_square@[k] = square, near_place@[k] = other;
        square = next_square, other = next;
    }
}
#endif

// Visits all neighbours, or the nearest, of the particle at p, which is at `place` in the grid. Two phases for each 32
// of a row of cells: distances become a mask of hits, then the hits are visited one by one, so that invocations of a
// group diverge as little as possible.
vec3 walk@(uint place, vec3 p, vec3 v) {
    float speed = dot(v, v);
    sum@ sum = start@(speed > 0.0 ? v * inversesqrt(speed) : vec3(0.0));
#if BY_PLACE
    if (place >= cell_at(cell_count)) return finish@(sum, op@[0].w); // it is nowhere
#else
    if (!(dot(p, p) <= 1e38)) return finish@(sum, op@[0].w); // it is nowhere
    place = 0xffffffffu;                                      // and not among those that it looks at
#endif
    vec3 origin = vec3(origin_x, origin_y, origin_z);
    float reach = op@[1].x, square = reach * reach, top = float(cells_x);
#ifdef MOST@
    for (int k = 0; k < MOST@; k++) near_square@[k] = square, near_place@[k] = 0xffffffffu;
#endif
    float slack = 1e-6 * max(max(abs(p.x), abs(p.y)), abs(p.z)) + 1e-5 * reach;
    int cy = clamped((p.y - origin.y) * per_size, cells_y), cz = clamped((p.z - origin.z) * per_size, cells_z);
    for (int z = max(cz - 1, 0); z <= min(cz + 1, cells_z - 1); z++) {
        // how far the row of cells is off at least
        float off_z = z == cz ? 0.0 : z < cz ? p.z - (origin.z + float(cz) * size) : origin.z + float(z) * size - p.z;
        off_z = max(off_z - slack, 0.0);
        for (int y = max(cy - 1, 0); y <= min(cy + 1, cells_y - 1); y++) {
            float off_y = y == cy ? 0.0 : y < cy ? p.y - (origin.y + float(cy) * size) : origin.y + float(y) * size - p.y;
            off_y = max(off_y - slack, 0.0);
            float rest = square - off_z * off_z - off_y * off_y;
            if (rest < 0.0) continue;
            float half_width = sqrt(rest) + slack;
            int line = (z * cells_y + y) * cells_x;
            uint at = cell_at(line + clamped((p.x - half_width - origin.x) * per_size_x, cells_x));
            uint end = cell_at(line + clamped((p.x + half_width - origin.x) * per_size_x, cells_x) + 1);
            while (at < end) {
                uint first = at & ~3u, hits = 0u; // four at a time; those before and behind are cut off below
                for (uint four = 0u; four < 32u && first + four < end; four += 4u) {
                    int k = int(first + four);
                    vec3 a = position_at(k).xyz - p, b = position_at(k + 1).xyz - p;
                    vec3 c = position_at(k + 2).xyz - p, d = position_at(k + 3).xyz - p;
                    uint some = uint(dot(a, a) < square) | uint(dot(b, b) < square) << 1 |
                                uint(dot(c, c) < square) << 2 | uint(dot(d, d) < square) << 3;
                    hits |= some << four;
                }
                hits &= 0xffffffffu << (at - first);
                if (end - first < 32u) hits &= (1u << (end - first)) - 1u;
                while (hits != 0u) {
                    int bit = findLSB(hits);
                    hits &= hits - 1u;
                    uint other = first + uint(bit);
                    if (other == place) continue;
                    vec4 q = position_at(int(other));
                    vec3 apart = p - q.xyz;
#ifdef MOST@
                    if (sees@(sum, apart, dot(apart, apart))) keep@(dot(apart, apart), other);
#else
                    meet@(sum, apart, dot(apart, apart), unpacked(q.w));
#endif
                }
                at = first + 32u;
#ifdef MOST@
                square = near_square@[MOST@ - 1]; // farther ones cannot be among the nearest
#endif
            }
        }
    }
#ifdef MOST@
    for (int k = 0; k < MOST@ && near_place@[k] != 0xffffffffu; k++) {
        vec4 q = position_at(int(near_place@[k]));
        vec3 apart = p - q.xyz;
        meet@(sum, apart, dot(apart, apart), unpacked(q.w));
    }
#endif
    return finish@(sum, op@[0].w);
}
