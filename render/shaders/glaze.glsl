// What smooth, wet surfaces have besides their colour: the sky and the ground mirrored, more so at grazing angles.
vec3 glaze(vec3 normal, vec3 view) {
    vec3 mirror = reflect(-view, normal);
    vec3 around = mix(scene.ground.rgb * 0.7, sky_colour(mirror), smoothstep(-0.3, 0.3, mirror.y));
    float glance = 0.035 + 0.5 * pow(1.0 - clamp(dot(normal, view), 0.0, 1.0), 5.0);
    return around * glance;
}

// And the sun's soft spot, for a part of the sun that is seen.
vec3 sun_spot(vec3 normal, vec3 view, float seen) {
    vec3 half_way = normalize(scene.sun.xyz + view);
    return scene.sun_light.rgb * seen * 0.5 * pow(max(dot(normal, half_way), 0.0), 160.0);
}
