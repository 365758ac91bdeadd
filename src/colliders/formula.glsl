// A surface by a formula: solid where it is under 0; see formula.c.
#define DEFORMS@
float speed@; // of the surface along its normal, where it was probed last

vec4 probe@(vec3 p) {
    float o[5];
    formula@(turned_back@(p - position@), vec3(0), pose@[4].w, o);
    vec3 slope = vec3(o[1], o[2], o[3]);
    float square = dot(slope, slope);
    if (!(square > 0 && square <= 3.4e38)) {
        // without a slope, what is not inside is far off, and up is the way out
        speed@ = 0;
        return vec4(turned@(vec3(0, 1, 0)), o[0] < 0 ? o[0] : 1e15);
    }
    float per = 1 / sqrt(square);
    speed@ = -o[4] * per;
    return vec4(turned@(per * slope), o[0] * per);
}
