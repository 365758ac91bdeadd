// The sky behind everything: the light that comes along a pixel's ray.
in vec2 place;
out vec4 colour;

void main() {
    vec3 ray = scene.view_forward.xyz + place.x * scene.view_right.xyz + place.y * scene.view_up.xyz;
    colour = vec4(display(sky_colour(normalize(ray))), 1.0);
}
