// Fits light of any strength into 0 to 1: straight up to 0.76, then ever flatter and paler.
vec3 display(vec3 light) {
    // a little less towards the corners, as a lens has it
    vec2 from_middle = gl_FragCoord.xy * vec2(scene.view_right.w, scene.view_up.w) - 1.0;
    light *= scene.sun_light.w * (1.0 - 0.05 * dot(from_middle, from_middle));
    float peak = max(light.r, max(light.g, light.b));
    if (peak > 0.76) {
        float squeezed = 1.0 - 0.0576 / (peak - 0.52);
        light = mix(vec3(squeezed), light * (squeezed / peak), 1.0 / (0.15 * (peak - squeezed) + 1.0));
    }
    return light;
}
