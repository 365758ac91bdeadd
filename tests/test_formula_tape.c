/* Tapes: the bits of the scalar evaluator on every instruction set, for blocks of any length; nothing that is not
 * finite, whatever goes in; and nothing lost where memory fails. */
#include "helpers.h"

#include "formula/evaluate.h"
#include "formula/formula.h"
#include "formula/tape.h"

#ifdef SKEIN_DOUBLE
#define sk_evaluate_real sk_evaluate_double
#else
#define sk_evaluate_real sk_evaluate_float
#endif

enum { ELEMENTS = 333, POINTS = 500, OUTPUTS = 12 * 13 / 2 }; // the second derivatives of four particles

/* ---- formulas ---- */

static const char *const names[] = {"L", "k", "q", NULL};
static const char *const formulas[] = {
    "length(p0-p1) - L",
    "distance(p0, p1)^2 / L - rest(distance(p0, p1))",
    "dihedral(p0, p1, p2, p3) - rest(dihedral(p0, p1, p2, p3))",
    "dot(cross(p1-p0, p2-p0), p3-p0)/6 - rest(dot(cross(p1-p0, p2-p0), p3-p0)/6)",
    "angle(p1-p0, p2-p0) - k",
    "length(cross(p1-p0, p2-p0))/2",
    "let a = p1-p0; let b = p2-p0; let n = normalize(cross(a, b)); dot(n, p3-p0) + k*sin(3*t)",
    "acos(clamp(dot(normalize(p1-p0), normalize(p2-p0)), -1, 1))",
    "exp(-L*distance(p0,p1)) + log(k + abs(p0.x)) + tan(p1.y*0.3)",
    "sqrt(abs(p0.x*p1.y - p0.y*p1.x)) - asin(clamp(p0.z, -1, 1))",
    "select(p0.y > p1.y, p0.y - p1.y, q*p2.z) + smoothstep(0, 1, p0.x)*min(p1.x, max(p2.x, k))",
    "abs(p0.x)^1.5 + (1 + p1.x^2)^k - p0.y^3 + 1/p0.z",
    "cos(p0.x)*sin(p1.x*t) + select(p0.x < 0 && p1.x <= 0 || !(p0.y == 0), 1, 2)*p2.x",
    "let f0 = (p1-p0)*L + (p2-p0)*k + (p3-p0)*q; let f1 = (p1-p0)*k + (p2-p0)*q; let f2 = (p3-p0)*L;"
    "let J = dot(f0, cross(f1, f2)); let I = dot(f0,f0) + dot(f1,f1) + dot(f2,f2);"
    "0.5*(I-3) + 1.5*(J-1.25)^2 - 0.5*log(I+1)",
    "p0.x",
    "3",
    "L",
    "p0.x - p0.x",
    "atan2(p0.y, p0.x)",
    "p0.x + p0.y + p0.z - p1.x - p1.y*p1.z - k",
    // minus a sum, of two and of three terms, with and without products
    "-(p0.x + p0.y + p0.z)",
    "-(p0.x + p0.y + p1.x*p1.y)",
    "-(p0.x + p0.y*p0.z + p1.x)",
    "-(p0.x + p0.y*p0.z + p1.x*p1.y)",
    "-(p0.x*p0.y + p0.z + p1.x)",
    "-(p0.x*p0.y + p0.z + p1.x*p1.y)",
    "-(p0.x*p0.y + p0.z*p1.x + p1.y)",
    "-(p0.x*p0.y + p0.z*p1.x + p1.y*p1.z)",
    "-(p0.x + p0.y)",
    "-(p0.x + p1.x*p1.y)",
    "-(p0.x*p0.y + p0.z)",
    "-(p0.x*p0.y + p1.x*p1.y)",
};

static skein_formula *make(const char *text) {
    skein_error error = {0};
    skein_formula *f = skein_formula_create(&(skein_formula_desc){.text = text, .parameters = names}, NULL, &error);
    if (!f) fail_msg("%s: %s: %s", text, error.where, error.message);
    return f;
}

static size_t outputs_of(const skein_formula *f, sk_node *outputs) {
    size_t count = 0;
    outputs[count++] = f->value[0];
    for (int i = 0; i < 3 * f->particles; i++) outputs[count++] = f->by_position[0][i];
    outputs[count++] = f->by_time[0];
    return count;
}

/* ---- a mesh of random elements ---- */

typedef struct elements {
    sk_vec4 position[POINTS]; // first, so that it is aligned
    uint32_t slot[4][ELEMENTS];
    const uint32_t *slots[4];
    real parameter[3 + SKEIN_FORMULA_MOST_RESTS][ELEMENTS];
    const real *parameters[3 + SKEIN_FORMULA_MOST_RESTS];
    sk_tape_input input;
} elements;

/* What positions are made of: mostly ordinary numbers, or whatever is awkward. */
static real coordinate(uint64_t *seed, bool awkward) {
    static const double odd[] = {0, 0, 0, 1, -1, 1e-6, -1e-12, 1e-20, 1e-30, 1e-40, 1e10, -1e18, 1e25, 3e38, -3e38};
    double ordinary = random_between(seed, -1.5, 1.5);
    return (real)(awkward ? odd[(size_t)random_between(seed, 0, COUNT(odd) - 1e-9)] : ordinary);
}

static elements *new_elements(void) {
    elements *e = aligned_alloc(64, (sizeof *e + 63) / 64 * 64);
    assert_non_null(e);
    return e;
}

static void fill(elements *e, uint64_t seed, bool awkward) {
    memset(e, 0, sizeof *e);
    for (int i = 0; i < POINTS; i++)
        e->position[i] = (sk_vec4){coordinate(&seed, awkward && i % 3), coordinate(&seed, awkward && i % 5),
                                   coordinate(&seed, awkward && i % 7), 1};
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < ELEMENTS; i++) e->slot[k][i] = (uint32_t)random_between(&seed, 0, POINTS - 1e-9);
        e->slots[k] = e->slot[k];
    }
    for (int k = 0; k < 3 + SKEIN_FORMULA_MOST_RESTS; k++) {
        for (int i = 0; i < ELEMENTS; i++) e->parameter[k][i] = (real)random_between(&seed, 0.1, 2);
        e->parameters[k] = e->parameter[k];
    }
    // the second parameter is the same for all
    e->input = (sk_tape_input){e->position, NULL, 0, e->slots, e->parameters, 1 << 1, (real)0.7};
}

/* One element by the scalar evaluator. */
static void by_graph(const skein_formula *f, const elements *e, size_t element, const sk_node *outputs, size_t count,
                     real *out) {
    real inputs[SK_INPUT_COUNT] = {0}, parameters[3 + SKEIN_FORMULA_MOST_RESTS];
    real *values = calloc(f->graph.count, sizeof *values);
    bool *live = calloc(f->graph.count, sizeof *live);
    for (int k = 0; k < f->particles; k++) memcpy(inputs + 3 * k, &e->position[e->slot[k][element]], 3 * sizeof(real));
    for (int k = 0; k < 3 + SKEIN_FORMULA_MOST_RESTS; k++) parameters[k] = e->parameter[k][k == 1 ? 0 : element];
    inputs[SK_INPUT_TIME] = e->input.time;
    sk_graph_mark(&f->graph, outputs, count, live);
    sk_evaluate_real(&f->graph, live, inputs, parameters, values);
    real sum = 0;
    for (size_t k = 0; k < count; k++) sum += out[k] = values[outputs[k]];
    for (size_t k = 0; k < count && !isfinite(sum); k++) out[k] = 0;
    free(values);
    free(live);
}

/* Runs a tape over all elements in one call and holds every bit against the graph. */
static void compare(const skein_formula *f, const sk_tape *tape, const elements *e, const sk_node *outputs,
                    size_t count, int isa, size_t begin, size_t end, const char *text) {
    static real out[OUTPUTS][ELEMENTS + 1];
    real *arrays[OUTPUTS], ought[OUTPUTS];
    for (size_t k = 0; k < count; k++) {
        arrays[k] = out[k];
        for (int i = 0; i <= ELEMENTS; i++) out[k][i] = -77;
    }
    sk_tape_kernels_of[isa]->evaluate(tape, &e->input, begin, end, arrays);
    for (size_t i = 0; i < ELEMENTS; i++) {
        by_graph(f, e, i, outputs, count, ought);
        for (size_t k = 0; k < count; k++) {
            real is = out[k][i], should = i >= begin && i < end ? ought[k] : -77;
            if (memcmp(&is, &should, sizeof is) && !(is == 0 && should == 0))
                fail_msg("%s: output %zu of element %zu on %s is %.9g, expected %.9g", text, k, i,
                         sk_isa_text((sk_isa)isa), (double)is, (double)should);
        }
        for (size_t k = 0; k < count; k++) assert_true(out[k][ELEMENTS] == -77);
    }
}

static bool processor_has(int isa) {
    char *before = getenv("SKEIN_SIMD") ? strdup(getenv("SKEIN_SIMD")) : NULL;
    setenv("SKEIN_SIMD", sk_isa_text((sk_isa)isa), 1);
    bool has = (int)sk_isa_choose() == isa;
    if (before) setenv("SKEIN_SIMD", before, 1);
    else unsetenv("SKEIN_SIMD");
    free(before);
    return has;
}

static void tapes_have_the_bits_of_the_graph(bool awkward) {
    elements *e = new_elements();
    sk_allocator allocator = sk_default_allocator();
    for (size_t k = 0; k < COUNT(formulas); k++) {
        skein_formula *f = make(formulas[k]);
        sk_node outputs[OUTPUTS];
        size_t count = outputs_of(f, outputs);
        sk_tape tape;
        fill(e, 99 + k, awkward);
        assert_int_equal(sk_tape_create(&tape, &f->graph, outputs, count, &allocator, NULL), SKEIN_OK);
        for (int isa = 0; isa < SK_ISA_COUNT; isa++)
            if (processor_has(isa)) compare(f, &tape, e, outputs, count, isa, 0, ELEMENTS, formulas[k]);
        compare(f, &tape, e, outputs, count, 0, 17, 17, formulas[k]);
        compare(f, &tape, e, outputs, count, 0, 17, 18, formulas[k]);
        compare(f, &tape, e, outputs, count, 0, 5, 5 + 16 + 128, formulas[k]);
        for (tape.wides = 1; tape.wides < 8; tape.wides *= 2) // as a tape with many registers has
            compare(f, &tape, e, outputs, count, 0, 3, ELEMENTS, formulas[k]);
        sk_tape_free(&tape);
        skein_formula_destroy(f);
    }
    assert_int_equal(allocator.bytes, 0);
    free(e);
}

static void ordinary_numbers(void **state) {
    (void)state;
    tapes_have_the_bits_of_the_graph(false);
}

static void awkward_numbers(void **state) {
    (void)state;
    tapes_have_the_bits_of_the_graph(true);
}

/* ---- the parts ---- */

static void sums_are_fused(void **state) {
    (void)state;
    static const struct {
        const char *text;
        size_t instructions;
    } cases[] = {{"p0.x*p1.x + p0.y*p1.y + p0.z*p1.z", 1},
                 {"p0.x*p1.x - p0.y", 1},
                 {"p0.x - p0.y*p0.z + L", 1},
                 {"p0.x - (p0.y*p0.z + L)", 2},
                 {"L + k", 1},
                 {"L*k", 1},
                 {"L*k + q + p0.x + p0.y + p0.z", 2},
                 {"length(p0)", 2},
                 {"-(p0.x + p0.y + p1.x*p1.y)", 1},
                 {"-(p0.x*p0.y + p1.z)", 1},
                 {"-(p0.x + p0.y)*(p0.x + p0.y)", 3},
                 {"p0.x", 0}};
    sk_allocator allocator = sk_default_allocator();
    for (size_t i = 0; i < COUNT(cases); i++) {
        skein_formula *f = make(cases[i].text);
        sk_tape tape;
        assert_int_equal(sk_tape_create(&tape, &f->graph, f->value, 1, &allocator, NULL), SKEIN_OK);
        if (tape.code.count != cases[i].instructions)
            fail_msg("%s: %zu instructions, expected %zu", cases[i].text, tape.code.count, cases[i].instructions);
        sk_tape_free(&tape);
        skein_formula_destroy(f);
    }
}

/* Second derivatives: the tape's bits are the graph's; a block's rows sum up to 0, since moving all particles changes
 * nothing; and they are as few instructions as can be hoped for: 864 and 272 without what second.c knows. */
static void second_derivatives_are_few(void **state) {
    (void)state;
    static const struct {
        const char *text;
        size_t instructions;
    } cases[] = {
        {"let f0 = (p1-p0)*L + (p2-p0)*k + (p3-p0)*q; let f1 = (p1-p0)*k + (p2-p0)*L; let f2 = (p3-p0)*L + (p1-p0)*q;"
         "let J = dot(f0, cross(f1, f2)); let I = dot(f0,f0) + dot(f1,f1) + dot(f2,f2);"
         "0.5*(I-3) + 1.5*(J-1.25)^2 - 0.5*log(I+1)",
         240},
        {"let f = (p1-p0)*L + (p2-p0)*k; let g = (p1-p0)*q + (p2-p0)*L; let x = 0.5*(dot(f,f)-1);"
         "let y = 0.5*(dot(g,g)-1); let z = 0.5*dot(f,g); x*x + y*y + 2*z*z + 1.5*(x+y)^2",
         150},
        {"0.5*k*(distance(p0, p1) - L)^2", 32},
        {"0.5*k*dot(p0, p0)", 2}};
    elements *e = new_elements();
    sk_allocator allocator = sk_default_allocator();
    fill(e, 11, false);
    for (size_t c = 0; c < COUNT(cases); c++) {
        skein_error error = {0};
        skein_formula_desc desc = {.text = cases[c].text, .parameters = names, .second = true};
        skein_formula *f = skein_formula_create(&desc, NULL, &error);
        if (!f) fail_msg("%s: %s: %s", cases[c].text, error.where, error.message);
        sk_node outputs[OUTPUTS];
        size_t count = 0, size = 3 * (size_t)f->particles;
        sk_tape tape;
        for (size_t i = 0; i < size; i++)
            for (size_t j = 0; j <= i; j++) outputs[count++] = f->hessian[i * size + j];
        assert_int_equal(sk_tape_create(&tape, &f->graph, outputs, count, &allocator, NULL), SKEIN_OK);
        if (tape.code.count > cases[c].instructions)
            fail_msg("%s: %zu instructions, expected %zu", cases[c].text, tape.code.count, cases[c].instructions);
        compare(f, &tape, e, outputs, count, (int)sk_isa_choose(), 0, ELEMENTS, cases[c].text);
        double x[12], hessian[144], largest = 0;
        const double parameters[] = {0.7, 1.1, 0.4};
        for (int i = 0; i < 12; i++) x[i] = sin(2.0 + 5 * i);
        skein_formula_point point = {.positions = x, .parameters = parameters};
        assert_int_equal(skein_formula_hessian(f, &point, hessian, NULL), SKEIN_OK);
        for (size_t i = 0; i < size * size; i++) largest = fmax(largest, fabs(hessian[i]));
        for (size_t i = 0; i < size && f->particles > 1; i++)
            for (size_t axis = 0; axis < 3; axis++) {
                double sum = 0;
                for (size_t j = axis; j < size; j += 3) sum += hessian[i * size + j];
                assert_near(sum, 0, 1e-14 * largest);
            }
        sk_tape_free(&tape);
        skein_formula_destroy(f);
    }
    assert_int_equal(allocator.bytes, 0);
    free(e);
}

static void guards_are_counted(void **state) {
    (void)state;
    elements *e = new_elements();
    sk_allocator allocator = sk_default_allocator();
    skein_formula *f = make("length(p0-p1) - L");
    sk_node outputs[OUTPUTS];
    size_t count = outputs_of(f, outputs);
    sk_tape tape;
    real out[OUTPUTS][40], *arrays[OUTPUTS];
    for (size_t k = 0; k < count; k++) arrays[k] = out[k];
    fill(e, 5, false);
    for (int i = 0; i < 40; i++) e->slot[0][i] = (uint32_t)i, e->slot[1][i] = (uint32_t)(i % 10 == 3 ? i : i + 50);
    e->position[25].x = (real)INFINITY;
    assert_int_equal(sk_tape_create(&tape, &f->graph, outputs, count, &allocator, NULL), SKEIN_OK);
    for (int isa = 0; isa < SK_ISA_COUNT; isa++) {
        if (!processor_has(isa)) continue;
        assert_int_equal(sk_tape_kernels_of[isa]->evaluate(&tape, &e->input, 0, 34, arrays), 5);
        assert_true(out[0][3] == -e->parameter[0][3] && out[1][3] == 0 && out[0][25] == 0 && out[1][25] == 0);
        assert_true(out[0][24] != 0 && out[1][24] != 0);
    }
    sk_tape_free(&tape);
    skein_formula_destroy(f);
    free(e);
}

/* Slots in packed blocks are found as well. */
static void packed_positions(void **state) {
    (void)state;
    elements *e = new_elements(), *packed = new_elements();
    sk_allocator allocator = sk_default_allocator();
    skein_formula *f = make(formulas[2]);
    sk_node outputs[OUTPUTS];
    size_t count = outputs_of(f, outputs);
    sk_tape tape;
    fill(e, 8, false);
    memcpy(packed, e, sizeof *e);
    for (size_t i = 0; i < 160; i++) {
        real *block = (real *)&packed->position[i & ~(size_t)15];
        const real four[] = {e->position[i].x, e->position[i].y, e->position[i].z, 1};
        for (int k = 0; k < 4; k++) block[16 * k + (int)(i & 15)] = four[k];
    }
    packed->input.positions = packed->position, packed->input.packed = 160;
    e->input.positions = packed->position, e->input.packed = 160; // the graph looks into e->position itself
    assert_int_equal(sk_tape_create(&tape, &f->graph, outputs, count, &allocator, NULL), SKEIN_OK);
    compare(f, &tape, e, outputs, count, 0, 0, ELEMENTS, "packed");
    sk_tape_free(&tape);
    skein_formula_destroy(f);
    free(e);
    free(packed);
}

static void too_many_registers(void **state) {
    (void)state;
    sk_allocator allocator = sk_default_allocator();
    static char text[40000];
    // a tree of products that are all used twice, so that all must be kept
    size_t length = 0;
    for (int i = 0; i < 120; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "let a%d = p0.x*%d.5 + sin(p0.y*%d.25);", i,
                                   i + 1, i + 1);
    length += (size_t)snprintf(text + length, sizeof text - length, "0");
    for (int i = 0; i < 120; i++)
        for (int k = 1; k < 8; k++)
            length += (size_t)snprintf(text + length, sizeof text - length, "+a%d*a%d*a%d", i, (i + 7 * k) % 120,
                                       (i + 19 * k + 5) % 120);
    skein_formula *f = make(text);
    sk_tape tape;
    skein_error error = {0};
    assert_int_equal(sk_tape_create(&tape, &f->graph, f->value, 1, &allocator, &error), SKEIN_OK);
    assert_true(tape.wides < 8 && tape.registers * tape.wides * sizeof(sk_wide) <= SK_TAPE_MEMORY);
    sk_tape_free(&tape);
    // all nodes as outputs need a register each
    size_t count = f->graph.count;
    sk_node *outputs = calloc(count, sizeof *outputs);
    for (size_t i = 0; i < count; i++) outputs[i] = (sk_node)i;
    skein_status status = sk_tape_create(&tape, &f->graph, outputs, count, &allocator, &error);
    assert_int_equal(status, count * sizeof(sk_wide) > SK_TAPE_MEMORY ? SKEIN_ERROR_LIMIT : SKEIN_OK);
    assert_true(status == SKEIN_ERROR_LIMIT && strstr(error.message, "too large to run"));
    assert_int_equal(allocator.bytes, 0);
    free(outputs);
    skein_formula_destroy(f);
}

/* Near flat and near folded, where acos would be off by half: the tape's gradient against the one in double at the
 * same, rounded, places; relative to the gradient's size. */
static void the_dihedral_is_exact_near_flat(void **state) {
    (void)state;
    elements *e = new_elements();
    sk_allocator allocator = sk_default_allocator();
    skein_formula *f = make("dihedral(p0, p1, p2, p3)");
    sk_node outputs[OUTPUTS];
    size_t count = outputs_of(f, outputs);
    sk_tape tape;
    real out[OUTPUTS][64], *arrays[OUTPUTS];
    fill(e, 3, false);
    for (size_t k = 0; k < count; k++) arrays[k] = out[k];
    for (int i = 0; i < 64; i++) {
        double off = pow(10, -1 - i % 16 * 0.5),
               angle = (i < 32 ? 0 : PI - off) + (i < 32 ? off : 0) * (i & 16 ? -1 : 1);
        const double p[4][3] = {{0.1, 0.2, 0}, {1.1, 0.3, 0}, {0.5, 1.4, 0}, {0.7, 0.25 - cos(angle), sin(angle)}};
        for (int k = 0; k < 4; k++) {
            e->position[4 * i + k] = (sk_vec4){(real)p[k][0], (real)p[k][1], (real)p[k][2], 1};
            e->slot[k][i] = (uint32_t)(4 * i + k);
        }
    }
    assert_int_equal(sk_tape_create(&tape, &f->graph, outputs, count, &allocator, NULL), SKEIN_OK);
    sk_tape_kernels_of[sk_isa_choose()]->evaluate(&tape, &e->input, 0, 64, arrays);
    for (int i = 0; i < 64; i++) {
        double p[12], size = 0;
        skein_formula_value v;
        for (int k = 0; k < 4; k++)
            p[3 * k] = e->position[4 * i + k].x, p[3 * k + 1] = e->position[4 * i + k].y,
                  p[3 * k + 2] = e->position[4 * i + k].z;
        const double parameters[] = {0, 0, 0};
        assert_int_equal(skein_formula_evaluate(f, &(skein_formula_point){p, NULL, NULL, parameters, 0}, &v, NULL), 0);
        for (int k = 0; k < 12; k++) size = fmax(size, fabs(v.by_position[0][k]));
        for (int k = 0; k < 12; k++) assert_near((double)out[1 + k][i], v.by_position[0][k], 1e-5 * size);
        assert_near((double)out[0][i], v.number[0], 1e-6);
    }
    sk_tape_free(&tape);
    skein_formula_destroy(f);
    free(e);
}

/* ---- memory ---- */

typedef struct purse {
    size_t calls, fail_at, blocks;
} purse;

static void *take(void *user, size_t size, size_t alignment) {
    purse *p = user;
    if (p->calls++ == p->fail_at) return NULL;
    p->blocks++;
    return aligned_alloc(alignment, size);
}

static void give_back(void *user, void *memory, size_t size) {
    purse *p = user;
    (void)size;
    p->blocks--;
    free(memory);
}

/* Everything once, with the n-th allocation failing. */
static skein_status make_all(sk_allocator *allocator, skein_error *error) {
    skein_formula_desc desc = {.text = formulas[13], .parameters = names, .second = true};
    skein_formula *f = sk_formula_create(&desc, allocator, NULL, error);
    if (!f) return error->status;
    sk_node outputs[OUTPUTS];
    sk_tape tape;
    skein_status status = sk_tape_create(&tape, &f->graph, outputs, outputs_of(f, outputs), allocator, error);
    sk_tape_free(&tape);
    skein_formula_destroy(f);
    return status;
}

static void failing_allocations(void **state) {
    (void)state;
    skein_status status = SKEIN_ERROR_MEMORY;
    size_t turns = 0;
    for (; status == SKEIN_ERROR_MEMORY && turns < 1000; turns++) {
        purse p = {.fail_at = turns};
        sk_allocator allocator = {take, give_back, &p, 0};
        skein_error error = {0};
        status = make_all(&allocator, &error);
        assert_int_equal(p.blocks, 0);
        assert_int_equal(error.status, status);
        assert_true(status == SKEIN_OK || strstr(error.message, "no memory"));
    }
    assert_int_equal(status, SKEIN_OK);
    assert_true(turns > 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ordinary_numbers),   cmocka_unit_test(awkward_numbers),
        cmocka_unit_test(sums_are_fused),     cmocka_unit_test(second_derivatives_are_few),
        cmocka_unit_test(guards_are_counted), cmocka_unit_test(packed_positions),
        cmocka_unit_test(too_many_registers), cmocka_unit_test(the_dihedral_is_exact_near_flat),
        cmocka_unit_test(failing_allocations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
