// The vocabulary of base/arithmetic.h in GLSL.
#define num float
#define flag bool
#define scalar float
#define exact float
#define SK_INLINE
#define STRUCT(name) struct name
#define PARAM(e) (e)
#define PARAM3(v) (v)
#define NUM(a) float(a)
#define cosine(angle) cos(angle)
#define sine(angle) sin(angle)
#define both(a, b) ((a) && (b))
#define either(a, b) ((a) || (b))
#define none(a) (!(a))
#define root(a) sqrt(a)
#define absolute(a) abs(a)
#define vec3_of(x, y, z) vec3(x, y, z)
#define vec4_of(v, w) vec4(v, w)
#define times(s, a) ((s) * (a))
#define plus(a, b) ((a) + (b))
#define minus(a, b) ((a) - (b))

vec3 xyz(vec4 a) {
    return a.xyz;
}

float pick(bool f, float yes, float no) {
    return f ? yes : no;
}

vec3 pick3(bool f, vec3 yes, vec3 no) {
    return f ? yes : no;
}
