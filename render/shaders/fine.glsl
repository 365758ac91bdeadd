// Ahead of the stages of what has triangles of a few pixels: light is found by vertex.
#define FINE
