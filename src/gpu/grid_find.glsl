// Finds the box, where none is known yet.
void main() {
    begin_box();
    uint particle = invocation();
    vec3 p = particle < head.x ? at_X[slot_of_particle(head.z + particle)].xyz : vec3(0);
    if (particle < head.x && is_finite(p)) add_to_box(p);
    end_box();
}
