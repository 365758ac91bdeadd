// No particle is in any cell.
void main() {
    uint c = invocation();
    if (c < cell_count + 2u) cell[c] = 0u;
}
