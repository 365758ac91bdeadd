/* The language of formulas: what they are worth, their derivatives against differences and closed forms, what is said
 * of wrong ones (tests/bad/formulas), and what they become as C. */
#include "helpers.h"

#include <dirent.h>
#include <skein/formula.h>

#include "io/file.h"

static const char *const names[] = {"L", "k", NULL};
static const double parameters[] = {0.7, 1.3};

static skein_formula *make(skein_formula_desc desc) {
    skein_error error = {0};
    desc.parameters = names;
    skein_formula *f = skein_formula_create(&desc, NULL, &error);
    if (!f) fail_msg("%s: %s: %s", desc.text, error.where, error.message);
    return f;
}

static skein_formula_value value_of(const skein_formula *f, const double *positions, const double *velocities,
                                    double time) {
    skein_formula_value value;
    skein_error error = {0};
    const skein_formula_point point = {positions, velocities, NULL, parameters, time};
    if (skein_formula_evaluate(f, &point, &value, &error)) fail_msg("%s", error.message);
    return value;
}

/* ---- values ---- */

static const double corner[] = {1, 2, 3, 4, 6, 3, 0, 0, 0, 1, 0, 0};

static void values(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double ought;
    } cases[] = {
        {"1 + 2*3 - 4/8", 6.5},
        {"-2^2", -4},
        {"(-2)^3", -8},
        {"2^-2", 0.25},
        {"2^3^2", 512},
        {"8 / 4 / 2", 1},
        {"1 - 2 - 3", -4},
        {"1e3 + .5 + 2.5e-1", 1000.75},
        {"12345678901234567890", 12345678901234567890.0},
        {"L*k", 0.7 * 1.3},
        {"p0.x + p1.y", 7},
        {"p.z", 3},
        {"distance(p0, p1)", 5},
        {"length(p1 - p0) - L", 4.3},
        {"dot(p0, p1)", 4 + 12 + 9},
        {"cross(p0, p1).y", 3 * 4 - 1 * 3},
        {"p0.zyx.x + 10*p0.zyx.z", 13},
        {"normalize(p1 - p0).y", 0.8},
        {"length(normalize(p2))", 0},
        {"dot(vec3(1, 2, 3), -vec3(4, 5, 6))", -32},
        {"length(2*p3/4)", 0.5},
        {"angle(p3, vec3(0, 2, 0))", PI / 2},
        {"angle(p3, -p3)", PI},
        {"angle(p3, p3)", 0},
        {"sqrt(2)^2 + sqrt(-4)", 2.0000000000000004},
        {"exp(log(3))", 3.0000000000000004},
        {"pow(2, 0.5) - 2^0.5", 0},
        {"sin(pi/6)", 0.49999999999999994},
        {"atan2(1, -1)", 3 * PI / 4},
        {"acos(2) + asin(-7)", -PI / 2},
        {"abs(-3) + abs(4)", 7},
        {"min(3, 2) + max(5, 4)", 7},
        {"clamp(7, 0, 1) + clamp(-7, 0, 1) + clamp(0.25, 0, 1)", 1.25},
        {"smoothstep(0, 2, 0.5)", 0.15625},
        {"smoothstep(0, 2, 9) + smoothstep(0, 2, -9)", 1},
        {"select(1 < 2, 3, 4) + select(2 <= 1, 30, 40)", 43},
        {"select(2 == 2, 1, 0) + select(2 != 2, 10, 20)", 21},
        {"select(1 < 2 && 3 > 2, 1, 0) + select(1 > 2 || 2 > 3, 10, 20)", 21},
        {"select(!(1 >= 2), 1, 2)", 1},
        {"select(p0.x > 0, p0, p1).y", 2},
        {"let a = p1 - p0; let b = dot(a, a); // a comment\n sqrt(b);", 5},
        {"t*2", 1},
        {"1/(L - 0.7)", 0},
        {"rest(length(p1 - p0)) - length(p1 - p0)", 0},
        {"rest(p0).y", 2},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        skein_formula *f = make((skein_formula_desc){.text = cases[i].text});
        double is = value_of(f, corner, NULL, 0.5).number[0];
        if (fabs(is - cases[i].ought) > 1e-14 * (1 + fabs(is)))
            fail_msg("%s is %.17g, expected %.17g", cases[i].text, is, cases[i].ought);
        skein_formula_destroy(f);
    }
}

/* A hinge opened by an angle: p3 turns about the edge p0 p1. */
static void dihedral_is_the_angle_between_normals(void **state) {
    (void)state;
    skein_formula *f = make((skein_formula_desc){.text = "dihedral(p0, p1, p2, p3)"});
    for (int degrees = -179; degrees < 180; degrees += 7) {
        double a = degrees * PI / 180;
        // the normal of p0 p1 p2 is z: p3 rises with the angle
        const double p[] = {0, 0, 0, 2, 0, 0, 0.3, 1.5, 0, 1, -cos(a), sin(a)};
        skein_formula_value v = value_of(f, p, NULL, 0);
        assert_near(v.number[0], a, 1e-12);
        // p3 at distance 1 from the edge: its gradient is one radian a metre, upwards along its circle
        assert_near(v.by_position[0][9], 0, 1e-12);
        assert_near(v.by_position[0][10], sin(a), 1e-12);
        assert_near(v.by_position[0][11], cos(a), 1e-12);
        assert_near(v.by_position[0][8], 1 / 1.5, 1e-12);
        assert_false(v.guarded);
    }
    skein_formula_destroy(f);
}

static void results_and_flags(void **state) {
    (void)state;
    skein_formula *f = make((skein_formula_desc){.text = "length(p0-p1) <= L", .comparison = true});
    assert_true(skein_formula_about(f).at_least_zero);
    assert_near(value_of(f, corner, NULL, 0).number[0], 0.7 - 5, 1e-15);
    skein_formula_destroy(f);
    f = make((skein_formula_desc){.text = "length(p0-p1) >= L", .comparison = true});
    assert_near(value_of(f, corner, NULL, 0).number[0], 5 - 0.7, 1e-15);
    skein_formula_destroy(f);
    f = make((skein_formula_desc){.text = "L == length(p0-p1)", .comparison = true});
    assert_false(skein_formula_about(f).at_least_zero);
    assert_near(value_of(f, corner, NULL, 0).number[0], 0.7 - 5, 1e-15);
    skein_formula_destroy(f);
    f = make((skein_formula_desc){.text = "cross(v, vec3(0, 0, 2)) - k*p*t", .velocities = true});
    skein_formula_info info = skein_formula_about(f);
    assert_true(info.size == 3 && info.particles == 1 && info.velocities && info.time && info.positions);
    skein_formula_value v = value_of(f, corner, (const double[]){1, 0, 0}, 2);
    assert_near(v.number[1], -2 - 1.3 * 2 * 2, 1e-14);
    assert_near(v.by_velocity[1][0], -2, 0);
    assert_near(v.by_position[2][2], -2.6, 1e-15);
    assert_near(v.by_time[0], -1.3, 1e-15);
    skein_formula_destroy(f);
    // what the rest pose says, and when it is asked
    f = make((skein_formula_desc){.text = "length(p0-p1) - rest(length(p0-p1))"});
    skein_formula_value at_rest;
    const double rest[] = {0, 0, 0, 2, 0, 0};
    assert_int_equal(
        skein_formula_evaluate(f, &(skein_formula_point){corner, NULL, rest, parameters, 0}, &at_rest, NULL), 0);
    assert_near(at_rest.number[0], 3, 1e-15);
    assert_near(at_rest.by_position[0][0], -0.6, 1e-15);
    assert_int_equal(skein_formula_about(f).rests, 1);
    skein_error error = {0};
    assert_int_equal(skein_formula_evaluate(f, &(skein_formula_point){0}, &at_rest, &error), SKEIN_ERROR_VALUE);
    skein_formula_destroy(f);
}

static void acos_of_dot_is_warned_of(void **state) {
    (void)state;
    static const char *const unwise[] = {"acos(dot(p0, p1))", "1 + acos(clamp(dot(p0, p1), -1, 1))",
                                         "let c = dot(p0, p1); acos(c)"};
    for (size_t i = 0; i < COUNT(unwise); i++) {
        skein_formula *f = make((skein_formula_desc){.text = unwise[i]});
        skein_formula_mark mark;
        const char *warning = skein_formula_warning(f, 0, &mark);
        assert_true(warning && strstr(warning, "angle(u, v)") && mark.line == 1);
        assert_int_equal(mark.column, strstr(unwise[i], "acos") - unwise[i] + 1);
        assert_null(skein_formula_warning(f, 1, NULL));
        skein_formula_destroy(f);
    }
    skein_formula *f = make((skein_formula_desc){.text = "acos(p0.x)"});
    assert_null(skein_formula_warning(f, 0, NULL));
    skein_formula_destroy(f);
}

/* ---- derivatives ---- */

static const char *const smooth[] = {
    "length(p0-p1) - L",
    "distance(p0, p1)^2/L",
    "dot(cross(p1-p0, p2-p0), p3-p0)/6",
    "dihedral(p0, p1, p2, p3)",
    "angle(p1-p0, p2-p0) - k",
    "length(cross(p1-p0, p2-p0))/2 - L",
    "dot(normalize(cross(p1-p0, p2-p0)), p3-p0)",
    "acos(0.2*p0.x) + asin(0.3*p1.y)",
    "exp(-k*p0.x*p1.y)*sin(p0.z + t)",
    "log(3 + p0.x*p1.x)",
    "tan(0.3*p0.x)*cos(p1.z)",
    "atan2(p0.y + 2, p0.x - 3)",
    "pow(2 + p0.x*0.5, k*p1.y)",
    "abs(p0.x - 3)*p1.x",
    "(2 + p0.x*0.2)^2.5/(3 + p0.y)",
    "p0.x^7 - p0.y^-3*0.001",
    "sqrt(4 + p0.x + p1.y)",
    "min(p0.x, p0.y - 9)*max(p1.x, p1.y - 9)",
    "clamp(p0.x, -0.01, 0.01)*p1.x + clamp(p0.y, -9, 9)*p1.z",
    "smoothstep(-2, 2, p0.x)*p1.y",
    "select(p0.x + 5 > p1.x, p0.y*p1.y, p0.z)",
    "1/(p0.x*p0.x + p1.y*p1.y + 0.3)",
    "length(vec3(p0.x, p1.y, p2.z)*t - p3)",
    "let a = p1-p0; let b = p2-p0; dot(a,a)*dot(b,b) - dot(a,b)^2",
    "let f0 = (p1-p0)*L; let f1 = (p2-p0)*k; let f2 = p3-p0; let J = dot(f0, cross(f1, f2));"
    "let I = dot(f0,f0) + dot(f1,f1) + dot(f2,f2); 0.5*(I-3) + 1.5*(J-1.25)^2 - 0.5*log(I+1)",
    "let a = (p1-p0)*L; let b = (p1-p0)*0.2 + (p2-p0)*k; let x = (dot(a,a)-1)/2; let y = (dot(b,b)-1)/2;"
    "let z = dot(a,b)/2; x^2 + y^2 + 2*z^2 + 1.5*(x+y)^2",
    "sqrt(2*dot(p0-p1, p0-p1))",
    "sin(cos(sin(p0.x*p1.y)))*t",
    "distance(p0, vec3(sin(t), 0, cos(t)))",
    "cross(p0, cross(p1, cross(p2, p3))).x",
};

/* Central differences of the value and of the gradient, at random places. */
static void derivatives_are_differences(void **state) {
    (void)state;
    uint64_t seed = 7;
    const double h = 1e-5;
    for (size_t c = 0; c < COUNT(smooth); c++) {
        skein_formula *f = make((skein_formula_desc){.text = smooth[c], .second = true});
        int n = 3 * skein_formula_about(f).particles;
        for (int trial = 0; trial < 5; trial++) {
            double p[12], hessian[144], scale = 1, t = random_between(&seed, 0.5, 2);
            for (int i = 0; i < 12; i++) p[i] = random_between(&seed, -1, 1);
            skein_formula_value v = value_of(f, p, NULL, t);
            const skein_formula_point point = {p, NULL, NULL, parameters, t};
            assert_int_equal(skein_formula_hessian(f, &point, hessian, NULL), SKEIN_OK);
            for (int i = 0; i < n; i++) scale = fmax(scale, fabs(v.by_position[0][i]));
            double size = scale;
            for (int i = 0; i < n * n; i++) size = fmax(size, fabs(hessian[i]));
            for (int i = 0; i < n; i++) {
                double before = p[i];
                p[i] = before + h;
                skein_formula_value up = value_of(f, p, NULL, t);
                p[i] = before - h;
                skein_formula_value down = value_of(f, p, NULL, t);
                p[i] = before;
                double difference = (up.number[0] - down.number[0]) / (2 * h);
                if (!(fabs(difference - v.by_position[0][i]) < 1e-6 * size * size))
                    fail_msg("%s: d/d%d is %.9g, by differences %.9g", smooth[c], i, v.by_position[0][i], difference);
                for (int k = 0; k < n; k++) {
                    double second = (up.by_position[0][k] - down.by_position[0][k]) / (2 * h);
                    if (!(fabs(second - hessian[n * i + k]) < 1e-6 * size * size))
                        fail_msg("%s: d2/d%d d%d is %.9g, by differences %.9g", smooth[c], i, k, hessian[n * i + k],
                                 second);
                }
            }
            double later = value_of(f, p, NULL, t + h).number[0], sooner = value_of(f, p, NULL, t - h).number[0];
            assert_near(v.by_time[0], (later - sooner) / (2 * h), 1e-6 * size);
        }
        skein_formula_destroy(f);
    }
}

/* The well-known gradients, by hand. */
static void derivatives_in_closed_form(void **state) {
    (void)state;
    const double p[] = {0, 0, 0, 3, 4, 0, -1, 2, 2, 1, 1, 5};
    skein_formula *f = make((skein_formula_desc){.text = "length(p0-p1) - L", .second = true});
    skein_formula_value v = value_of(f, p, NULL, 0);
    const double spring[] = {-0.6, -0.8, 0, 0.6, 0.8, 0};
    for (int i = 0; i < 6; i++) assert_near(v.by_position[0][i], spring[i], 3e-16);
    skein_formula_destroy(f);
    // a tetrahedron's volume: each corner's gradient is the opposite face's normal, a sixth of the cross product
    f = make((skein_formula_desc){.text = "dot(cross(p1-p0, p2-p0), p3-p0)/6"});
    v = value_of(f, p, NULL, 0);
    const double face[] = {4 * 2 - 0 * 2, 0 * -1 - 3 * 2, 3 * 2 - 4 * -1}; // p1 x p2
    for (int i = 0; i < 3; i++) {
        assert_near(v.by_position[0][9 + i], face[i] / 6.0, 1e-15);
        assert_near(v.by_position[0][i] + v.by_position[0][3 + i] + v.by_position[0][6 + i] + v.by_position[0][9 + i],
                    0, 1e-15);
    }
    skein_formula_destroy(f);
    f = make((skein_formula_desc){.text = "p0.x*exp(p1.x) + sin(p0.x)^2"});
    v = value_of(f, p, NULL, 0);
    assert_near(v.by_position[0][0], exp(3), 1e-13);
    assert_near(v.by_position[0][3], 0, 0);
    skein_formula_destroy(f);
}

/* Where there is no derivative, it is 0, finite, and said so. */
static void awkward_places(void **state) {
    (void)state;
    static const char *const guarded[] = {"length(p0-p1)",   "normalize(p0-p1).x", "acos(p0.x + 1)",
                                          "sqrt(p0.x)",      "log(p0.x)",          "1/p0.x",
                                          "angle(p0, p1)",   "asin(p0.y - 1)",     "dihedral(p0, p1, p2, p3)",
                                          "pow(p0.x, k)",    "exp(1000 + p0.x)",   "sqrt(p0.x - 4)",
                                          "p0.x/(p1.y*p1.z)"};
    const double zero[12] = {0};
    for (size_t i = 0; i < COUNT(guarded); i++) {
        skein_formula *f = make((skein_formula_desc){.text = guarded[i], .second = true});
        skein_formula_value v = value_of(f, zero, NULL, 0);
        double hessian[144];
        if (!v.guarded) fail_msg("%s: not guarded at 0", guarded[i]);
        assert_int_equal(
            skein_formula_hessian(f, &(skein_formula_point){zero, NULL, NULL, parameters, 0}, hessian, NULL), 0);
        int n = 3 * skein_formula_about(f).particles;
        assert_true(isfinite(v.number[0]));
        for (int k = 0; k < n; k++) assert_true(isfinite(v.by_position[0][k]));
        for (int k = 0; k < n * n; k++) assert_true(isfinite(hessian[k]));
        skein_formula_destroy(f);
    }
}

/* The order of operations, so the bits, is the same for every compiler: a hash of what some formulas become. */
static void hash_text(void *user, const char *text) {
    uint64_t *hash = user;
    for (; *text; text++) *hash = (*hash ^ (unsigned char)*text) * 0x100000001b3u;
}

static const uint64_t GRAPHS = 0x3fda48e0527b8f01;

static void graphs_do_not_depend_on_the_compiler(void **state) {
    (void)state;
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t c = 0; c < COUNT(smooth); c++) {
        skein_formula *f = make((skein_formula_desc){.text = smooth[c]});
        assert_int_equal(skein_formula_emit(f, SKEIN_FORMULA_GRAPH, hash_text, &hash, NULL), SKEIN_OK);
        skein_formula_destroy(f);
    }
    if (hash != GRAPHS) fail_msg("the graphs' hash is 0x%016llx", (unsigned long long)hash);
}

/* ---- wrong ones ---- */

/* A file's first line is "// [what is asked] place: message"; the whole file is the formula. */
static void check_bad(const char *name) {
    char path[512], said[1024];
    io_bytes bytes;
    skein_error error = {0};
    snprintf(path, sizeof path, "tests/bad/formulas/%s", name);
    assert_int_equal(io_file_read(path, 1 << 20, &bytes, &error), SKEIN_OK);
    char *text = malloc(bytes.size + 1);
    memcpy(text, bytes.data, bytes.size);
    text[bytes.size] = '\0';
    const char *ought = text + 3;
    skein_formula_desc desc = {.text = text, .parameters = names};
    desc.particles = !strncmp(ought, "[one]", 5) ? 1 : !strncmp(ought, "[two]", 5) ? 2 : 0;
    desc.velocities = !strncmp(ought, "[velocities]", 12);
    desc.comparison = !strncmp(ought, "[comparison]", 12);
    desc.result = !strncmp(ought, "[number]", 8)   ? SKEIN_FORMULA_NUMBER
                  : !strncmp(ought, "[vector]", 8) ? SKEIN_FORMULA_VECTOR
                                                   : SKEIN_FORMULA_ANY;
    if (*ought == '[') ought = strchr(ought, ' ') + 1;
    skein_formula_mark mark;
    skein_formula *f = skein_formula_create(&desc, &mark, &error);
    snprintf(said, sizeof said, "%s: %s", error.where, error.message);
    if (f || error.status == SKEIN_OK || strncmp(ought, said, strcspn(ought, "\n")) ||
        strlen(said) != strcspn(ought, "\n"))
        fail_msg("%s: '%s', expected '%.*s'", name, f ? "no fault" : said, (int)strcspn(ought, "\n"), ought);
    char where[64];
    snprintf(where, sizeof where, "line %zu, column %zu", mark.line, mark.column);
    assert_string_equal(where, error.where);
    // carets stand under the place
    char shown[512];
    assert_true(skein_formula_show(text, &mark, shown, sizeof shown) < sizeof shown);
    char *under = strchr(shown, '\n') + 1;
    assert_true(strspn(under, " ^\n") == strlen(under) && strchr(under, '^') && strlen(under) <= 122);
    free(text);
    io_bytes_free(&bytes);
}

static void bad_formulas(void **state) {
    (void)state;
    DIR *folder = opendir("tests/bad/formulas");
    int count = 0;
    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder)) != NULL;) {
        if (entry->d_name[0] == '.') continue;
        check_bad(entry->d_name);
        count++;
    }
    closedir(folder);
    assert_true(count >= 70);
}

static void refuses(const char *text, const char *part) {
    skein_error error = {0};
    assert_null(skein_formula_create(&(skein_formula_desc){.text = text, .parameters = names}, NULL, &error));
    if (!strstr(error.message, part)) fail_msg("'%s' has no '%s'", error.message, part);
}

static char *repeated(const char *part, size_t count, const char *end) {
    size_t length = strlen(part);
    char *text = malloc(length * count + strlen(end) + 1);
    for (size_t i = 0; i < count; i++) memcpy(text + i * length, part, length);
    strcpy(text + length * count, end);
    return text;
}

static void limits(void **state) {
    (void)state;
    static const struct {
        const char *part;
        size_t count;
        const char *end, *message;
    } cases[] = {{"(", 10000, "1", "nested too deep"},       {"sin(", 10000, "1", "nested too deep"},
                 {"-", 10000, "1", "nested too deep"},       {"!", 10000, "1", "nested too deep"},
                 {"2^", 10000, "1", "nested too deep"},      {"2^-", 10000, "1", "nested too deep"},
                 {"rest(", 10000, "1", "rest(...) in rest"}, {"1+", 40000, "1", "too long: 80001 bytes"},
                 {"select(1<", 200, "1", "nested too deep"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        char *text = repeated(cases[i].part, cases[i].count, cases[i].end);
        refuses(text, cases[i].message);
        free(text);
    }
    char lets[8000], rests[2000] = "0";
    size_t at = 0;
    for (int i = 0; i < 200; i++) at += (size_t)snprintf(lets + at, sizeof lets - at, "let a%d = %d;", i, i);
    refuses(lets, "too many names: 128");
    at = 1;
    for (int i = 0; i < 40; i++) at += (size_t)snprintf(rests + at, sizeof rests - at, "+rest(p0.x*%d)", i + 2);
    refuses(rests, "too many rest values: 32");
    // a value of which every let is the square has few operations, and its size is no trouble
    at = (size_t)snprintf(lets, sizeof lets, "let a0 = p0.x + 1;");
    for (int i = 1; i < 100; i++)
        at += (size_t)snprintf(lets + at, sizeof lets - at, "let a%d = a%d*a%d;", i, i - 1, i - 1);
    snprintf(lets + at, sizeof lets - at, "a99");
    skein_formula *f = make((skein_formula_desc){.text = lets});
    assert_true(skein_formula_about(f).operations < 500);
    skein_formula_destroy(f);
    // a long sum is no deep one
    char *text = repeated("p0.x+", 10000, "1");
    f = make((skein_formula_desc){.text = text});
    assert_near(value_of(f, corner, NULL, 0).number[0], 10001, 1e-9);
    skein_formula_destroy(f);
    free(text);
}

static void bad_parameters(void **state) {
    (void)state;
    static const struct {
        const char *names[3], *message;
    } cases[] = {{{"1x"}, "cannot be a parameter's name"},
                 {{""}, "cannot be a parameter's name"},
                 {{"sin"}, "has a meaning already"},
                 {{"p2"}, "has a meaning already"},
                 {{"a", "a"}, "given twice"}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        skein_error error = {0};
        skein_formula_desc desc = {.text = "1", .parameters = cases[i].names};
        assert_null(skein_formula_create(&desc, NULL, &error));
        assert_non_null(strstr(error.message, cases[i].message));
    }
    assert_null(skein_formula_create(&(skein_formula_desc){.text = "1", .particles = 9}, NULL, NULL));
}

/* ---- as C ---- */

static void append(void *user, const char *text) {
    fputs(text, user);
}

/* The emitted function, compiled by the C compiler that is at hand, says what the library says. */
static void emitted_c_compiles_and_agrees(void **state) {
    (void)state;
    char folder[] = "/tmp/skein-formula-XXXXXX", path[128], command[512];
    if (system("cc --version >/dev/null 2>&1")) skip();
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/all.c", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (size_t c = 0; c < COUNT(smooth); c++) {
        skein_formula *f = make((skein_formula_desc){.text = smooth[c], .second = c % 2});
        fprintf(file, "#define formula formula_%zu\n", c);
        assert_int_equal(skein_formula_emit(f, SKEIN_FORMULA_C, append, file, NULL), SKEIN_OK);
        fprintf(file, "#undef formula\n#undef FORMULA\n#undef PARTICLES\n");
        skein_formula_destroy(f);
    }
    fprintf(file,
            "#include <stdio.h>\nint main(void) {\n    double p[12], q[2] = {%.17g, %.17g}, v, g[12], h[78];\n"
            "    for (int i = 0; i < 12; i++) p[i] = 0.3 * i - 1.7 + 0.05 * (i %% 5);\n",
            parameters[0], parameters[1]);
    for (size_t c = 0; c < COUNT(smooth); c++)
        fprintf(file,
                "    for (int i = 0; i < 12; i++) g[i] = 0;\n    for (int i = 0; i < 78; i++) h[i] = 0;\n"
                "    formula_%zu(p, 0, q, 0.75, &v, g%s);\n    printf(\"%%.17g\", v);\n"
                "    for (int i = 0; i < 12; i++) printf(\" %%.17g\", g[i]);\n"
                "    for (int i = 0; i < 78; i++) printf(\" %%.17g\", h[i]);\n    printf(\"\\n\");\n",
                c, c % 2 ? ", h" : "");
    fprintf(file, "}\n");
    fclose(file);
    snprintf(
        command, sizeof command,
        "cc -std=c99 -Wall -Wextra -Werror -Wno-unused-parameter -ffp-contract=off -o %s/all %s -lm && %s/all >%s/out",
        folder, path, folder, folder);
    assert_int_equal(system(command), 0);
    snprintf(path, sizeof path, "%s/out", folder);
    file = fopen(path, "r");
    double p[12];
    for (int i = 0; i < 12; i++) p[i] = 0.3 * i - 1.7 + 0.05 * (i % 5);
    for (size_t c = 0; c < COUNT(smooth); c++) {
        skein_formula *f = make((skein_formula_desc){.text = smooth[c], .second = c % 2});
        skein_formula_value v = value_of(f, p, NULL, 0.75);
        double ought[13 + 78] = {v.number[0]}, hessian[144];
        int size = 3 * skein_formula_about(f).particles;
        memcpy(ought + 1, v.by_position[0], 12 * sizeof *ought);
        const skein_formula_point point = {p, NULL, NULL, parameters, 0.75};
        if (c % 2) assert_int_equal(skein_formula_hessian(f, &point, hessian, NULL), SKEIN_OK);
        for (int i = 0; i < size && c % 2; i++)
            for (int j = 0; j <= i; j++) ought[13 + i * (i + 1) / 2 + j] = hessian[i * size + j];
        for (int i = 0; i < 13 + 78; i++) {
            double is;
            assert_int_equal(fscanf(file, "%lf", &is), 1);
            if (!(fabs(is - ought[i]) <= 1e-12 * (1 + fabs(ought[i]))))
                fail_msg("%s: output %d is %.17g, expected %.17g", smooth[c], i, is, ought[i]);
        }
        skein_formula_destroy(f);
    }
    fclose(file);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

static void measure(void *user, const char *text) {
    *(size_t *)user += strlen(text);
    assert_null(strstr(text, "__"));
}

static void glsl_is_written(void **state) {
    (void)state;
    for (size_t c = 0; c < COUNT(smooth); c++) {
        skein_formula *f = make((skein_formula_desc){.text = smooth[c]});
        size_t length = 0;
        assert_int_equal(skein_formula_emit(f, SKEIN_FORMULA_GLSL, measure, &length, NULL), SKEIN_OK);
        assert_true(length > 200);
        skein_formula_destroy(f);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values),
        cmocka_unit_test(dihedral_is_the_angle_between_normals),
        cmocka_unit_test(results_and_flags),
        cmocka_unit_test(acos_of_dot_is_warned_of),
        cmocka_unit_test(derivatives_are_differences),
        cmocka_unit_test(derivatives_in_closed_form),
        cmocka_unit_test(awkward_places),
        cmocka_unit_test(graphs_do_not_depend_on_the_compiler),
        cmocka_unit_test(bad_formulas),
        cmocka_unit_test(limits),
        cmocka_unit_test(bad_parameters),
        cmocka_unit_test(emitted_c_compiles_and_agrees),
        cmocka_unit_test(glsl_is_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
