/* The GLSL that formulas become is compiled by the driver. */
#include "helpers.h"

#include <epoxy/gl.h>
#include <skein/formula.h>

#include "render/context.h"

static const char *const formulas[] = {
    "length(p0-p1) - L",
    "dihedral(p0, p1, p2, p3) - rest(dihedral(p0, p1, p2, p3))",
    "exp(p0.x) + log(p0.y) + pow(abs(p0.z), L) + asin(p0.x) + acos(p1.x) + tan(p1.y) + sin(t)*cos(p1.z) + sqrt(p0.x)",
    "let out_ = p0.x; let float = p0.y*2; let main = out_*float; select(main > 0, main, -float)*1e300",
    "cross(v, vec3(0, 0, 2)) - L*p // a comment \\\n + vec3(atan2(p.x, p.y), 3, -2)",
    "// */ not an end\n3",
};

static void append(void *user, const char *text) {
    strcat(user, text);
}

static void glsl_compiles(void **state) {
    (void)state;
    skein_error error = {0};
    render_context *context = render_context_create(&error);
    if (!context) fail_msg("%s", error.message);
    for (size_t i = 0; i < COUNT(formulas); i++) {
        static char text[100000];
        char words[2000] = "";
        const char *source = text;
        GLint good = 0;
        skein_formula_desc desc = {.text = formulas[i], .parameters = (const char *[]){"L", NULL}, .velocities = true};
        skein_formula *f = skein_formula_create(&desc, NULL, &error);
        if (!f) fail_msg("%s: %s: %s", formulas[i], error.where, error.message);
        strcpy(text, "#version 450 core\n");
        assert_int_equal(skein_formula_emit(f, SKEIN_FORMULA_GLSL, append, text, NULL), SKEIN_OK);
        strcat(text, "void main() {}\n");
        GLuint shader = glCreateShader(GL_VERTEX_SHADER);
        glShaderSource(shader, 1, &source, NULL);
        glCompileShader(shader);
        glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
        glGetShaderInfoLog(shader, sizeof words, NULL, words);
        if (!good) fail_msg("%s\n%s\n%s", formulas[i], words, text);
        glDeleteShader(shader);
        skein_formula_destroy(f);
    }
    render_context_destroy(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(glsl_compiles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
