// Lines of one colour.
flat in vec3 paint;
out vec4 colour;

void main() {
    colour = vec4(display(paint), 1.0);
}
