// Birds: feathers lit from the sky, from each vertex.
in vec3 world;
flat in vec3 feathers;
flat in vec3 light_here;
out vec4 colour;

void main() {
    vec3 n = normalize(cross(dFdx(world), dFdy(world))), view = normalize(scene.eye.xyz - world);
    if (dot(n, view) < 0) n = -n; // wings have two sides
    float seen = light_here.x, open = light_here.y, below = light_here.z, facing = dot(n, scene.sun.xyz);
    // some light comes through
    vec3 sun = scene.sun_light.rgb * seen * (max(facing, 0.0) + 0.25 * max(-facing, 0.0));
    vec3 light = feathers * (sun + ambient_light(n, below) * open);
    colour = vec4(display(scene.modes.x == 1 ? blinn_phong(feathers, n, view) : light), 1.0);
}
