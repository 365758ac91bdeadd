// Each particle goes to its cell's place.
void main() {
    uint particle = invocation();
    if (particle >= head.x) return;
    order[cell[cell_of(at_X[slot_of_particle(head.z + particle)].xyz)] + number[particle]] = head.z + particle;
}
