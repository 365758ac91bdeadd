// Sets the counts of all cells to 0.
void main() {
    uint c = invocation();
    if (c < cell_count + 2u) cell[c] = 0u;
}
