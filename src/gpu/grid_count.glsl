// Each particle adds to its cell, and keeps the number that it got there.
void main() {
    begin_box();
    uint particle = invocation();
    if (particle < head.x) {
        vec3 p = at_X[slot_of_particle(head.z + particle)].xyz;
        number[particle] = atomicAdd(cell[cell_of(p)], 1u);
        if (is_finite(p)) add_to_box(p);
    }
    end_box();
}
