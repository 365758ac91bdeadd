// The box becomes cells of at least the size asked for, and four times finer along x if there is room.
void main() {
    if (invocation() != 0u) return;
    vec3 least = vec3(0), most = vec3(0);
    if (high[0] != 0u) {
        least = vec3(unordered(~low[0]), unordered(~low[1]), unordered(~low[2]));
        most = vec3(unordered(high[0]), unordered(high[1]), unordered(high[2]));
    }
    vec3 extent = most - least;
    float wide = asked.x, fine = 4;
    for (;;) {
        vec3 needed = floor(extent / wide * vec3(fine, 1, 1)) + 1;
        if (needed.x * needed.y * needed.z <= float(head.y)) {
            cells_x = int(needed.x), cells_y = int(needed.y), cells_z = int(needed.z);
            break;
        }
        if (fine > 1) fine *= 0.5;
        else wide *= 1.25;
    }
    cell_count = uint(cells_x * cells_y * cells_z);
    size = wide;
    per_size = 1 / wide;
    per_size_x = fine / wide;
    origin_x = least.x, origin_y = least.y, origin_z = least.z;
    for (int k = 0; k < 3; k++) low[k] = high[k] = 0u;
}
