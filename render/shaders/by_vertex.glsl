// For light.glsl, ahead of it: this stage works by vertex.
#define BY_VERTEX
