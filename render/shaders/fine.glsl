// Ahead of a surface's stages: its triangles are no larger than a few pixels, so that light is found by vertex.
#define FINE
