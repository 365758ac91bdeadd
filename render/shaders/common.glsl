#version 450 core
// What all stages share: the scene block (mirrored in render/scene_block.h) and the light of the sky.
// All colours in here are linear; only display() (display.glsl) turns them into what the picture holds.

layout(std140, binding = 0) uniform scene_block {
    mat4 to_sun;      // world to the shadow map: uv and depth, all 0 to 1
    vec4 eye;
    vec4 view_right;  // a ray through the picture's point (x, y) of -1 to 1 is
    vec4 view_up;     // forward + x right + y up; w: 2 / width and 2 / height, pixels
    vec4 view_forward;
    vec4 sun;         // direction; w: tangent of the sun's spread
    vec4 sun_light;   // w: exposure
    vec4 zenith;
    vec4 horizon;
    vec4 ground;      // w: the ground's height
    vec4 sun_map;     // x: uv a metre; y: metres from depth 0 to 1; z: a texel in uv; w: 1 where there is one
    vec4 under_map;   // the ground's occlusion: xy: least x and z; z: uv a metre; w: 1 where there is a map
    vec4 middle;      // the scene's middle; w: its radius
    vec4 balls[8];    // spheres that keep sky light away: centre, radius
    ivec4 counts;     // x: balls; taps of a shadow: y to find what casts it, z through its soft edge, w along its rim
    ivec4 modes;      // x: 1 for plain light; y: 1 for lines on the ground
} scene;

layout(std140, binding = 1) uniform pass_block {
    mat4 to_clip;
} pass;

// The sky along a direction of length 1; below the horizon it is the horizon's haze.
vec3 sky_colour(vec3 direction) {
    float height = max(direction.y, 0.0);
    return mix(scene.horizon.rgb, scene.zenith.rgb, 1.0 - exp(-14.0 * height));
}

// Light from all sides on a surface: the sky above, brighter on the sun's side so that folds show in the
// shade too, and the sunlit ground below. `below` is how much of the ground's light arrives.
vec3 ambient_light(vec3 normal, float below) {
    vec2 side = scene.sun.xz * inversesqrt(dot(scene.sun.xz, scene.sun.xz) + 1e-6);
    vec3 sky = mix(scene.horizon.rgb, scene.zenith.rgb, 0.35) * 0.57 * (1.0 + 0.38 * dot(normal.xz, side));
    vec3 bounce = scene.ground.rgb * mix(scene.sun_light.rgb, vec3(1.0), 0.5) * 0.46 * below;
    return mix(bounce, sky, 0.5 + 0.5 * normal.y);
}

// The plain choice: Blinn-Phong under the sun, with a light of its own from all sides and no shadows.
vec3 blinn_phong(vec3 albedo, vec3 normal, vec3 view) {
    vec3 half_way = normalize(scene.sun.xyz + view);
    float shine = pow(max(dot(normal, half_way), 0.0), 40.0);
    return albedo * (0.38 + 0.72 * max(dot(normal, scene.sun.xyz), 0.0)) + 0.12 * shine;
}
