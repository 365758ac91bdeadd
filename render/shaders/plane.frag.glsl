// The floor and other planes: grid lines that fade into the distance, shadow and haze.
in vec3 interpolated;
in vec2 place;
out vec4 colour;

layout(location = 0) uniform vec3 origin;
layout(location = 1) uniform vec3 along;
layout(location = 2) uniform vec3 across;
layout(location = 3) uniform vec3 normal;
layout(location = 4) uniform float cell; // side of the grid's cells, metres
layout(location = 5) uniform int ground; // 1: fades into the horizon
layout(location = 6) uniform vec2 shift; // of the square's middle from where its grid was laid, metres

// Lines of a grid with cells of 1, `half_width` to either side, averaged over a pixel.
float lines(vec2 x, float half_width) {
    vec2 pixel = max(fwidth(x), vec2(1e-6));
    vec2 off = abs(fract(x - 0.5) - 0.5);
    vec2 wide = max(vec2(half_width), 0.5 * pixel);
    vec2 cover = clamp((wide - off) / pixel + 0.5, 0.0, 1.0) * (half_width / wide);
    // where cells are smaller than pixels only their average is left
    cover = mix(cover, vec2(2.0 * half_width), clamp(pixel * 2.0 - 0.5, 0.0, 1.0));
    return max(cover.x, cover.y);
}

// The ground's triangles are so large that its points are exact only where the pixel's ray meets it.
vec3 point_on_ground() {
    vec2 x = gl_FragCoord.xy * vec2(scene.view_right.w, scene.view_up.w) - 1.0;
    vec3 ray = scene.view_forward.xyz + x.x * scene.view_right.xyz + x.y * scene.view_up.xyz;
    return scene.eye.xyz + ray * ((scene.eye.y - origin.y) / max(-ray.y, 1e-6));
}

void main() {
    vec3 world = ground == 1 ? point_on_ground() : interpolated;
    vec3 ray = world - scene.eye.xyz;
    float distance = length(ray);
    vec2 on_plane = ground == 1 ? world.xz : shift + place * vec2(length(along), length(across));

    float fine = lines(on_plane / cell, 0.006), coarse = lines(on_plane / (5.0 * cell), 0.0022);
    float out_there = length(world - scene.middle.xyz) / scene.middle.w;
    float line = float(scene.modes.y) * max(0.10 * fine, 0.20 * coarse) * exp(-0.02 * out_there * out_there);

    float seen = sun_seen(world, normal);
    float open = ground == 1 ? mix(0.16, 1.0, under_seen(world)) : balls_seen(world, normal, -1);
    vec3 light = scene.sun_light.rgb * seen * max(dot(normal, scene.sun.xyz), 0.0);
    light += ambient_light(normal, 1.0) * open;
    if (scene.modes.x == 1) light = blinn_phong(vec3(1.0), normal, vec3(0.0, -1.0, 0.0));
    vec3 lit = scene.ground.rgb * (1.0 - line) * light;

    // a slab has a darker rim; the ground goes over into the sky's haze
    if (ground == 0) {
        vec2 inside = (1.0 - abs(place)) * vec2(length(along), length(across));
        float rim = 0.02 * scene.middle.w;
        lit *= mix(0.72, 1.0, smoothstep(rim - fwidth(inside.x + inside.y), rim, min(inside.x, inside.y)));
    }
    float haze = ground == 1 ? 1.0 - exp(-pow(out_there / 16.0, 2.0)) : 0.0;
    colour = vec4(display(mix(lit, sky_colour(ray / distance), haze)), 1.0);
}
