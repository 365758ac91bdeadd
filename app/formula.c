/* skein formula 'TEXT': what a formula is worth, and what it becomes. */
#include <skein/formula.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/command.h"

/* What was asked, as numbers. */
typedef struct question {
    skein_formula_desc desc;
    const char *names[SKEIN_FORMULA_MOST_PARAMETERS + 2];
    char name_text[SKEIN_FORMULA_MOST_PARAMETERS + 1][32];
    double parameters[SKEIN_FORMULA_MOST_PARAMETERS + 1];
    double positions[3 * SKEIN_FORMULA_MOST_PARTICLES], rest[3 * SKEIN_FORMULA_MOST_PARTICLES],
        velocities[3 * SKEIN_FORMULA_MOST_PARTICLES];
    size_t particles, rest_particles, moving_particles;
    double time;
} question;

static bool fault(const char *option, const char *given, const char *expected) {
    fprintf(stderr, "skein formula: %s '%s': expected %s\n", option, given, expected);
    return false;
}

static bool read_number(const char *text, double *number) {
    char *end;
    *number = strtod(text, &end);
    return end != text && !*end && isfinite(*number);
}

/* Points as x,y,z with blanks or semicolons between them; the option may be repeated, too. */
static bool read_points(const app_arguments *arguments, const char *name, double *points, size_t *count) {
    for (const char *const *given = app_values(arguments, name); given && *given; given++) {
        const char *text = *given;
        while (*text) {
            double p[3];
            int length = 0;
            if (sscanf(text, " %lf , %lf , %lf %n", &p[0], &p[1], &p[2], &length) != 3 || !length ||
                !isfinite(p[0] + p[1] + p[2]))
                return fault(name, *given, "points as x,y,z with blanks between them, as in '0,0,0 1,0,0'");
            if (*count == SKEIN_FORMULA_MOST_PARTICLES) return fault(name, *given, "8 points at the most");
            memcpy(points + 3 * (*count)++, p, sizeof p);
            text += length + (text[length] == ';');
        }
    }
    return true;
}

static bool read_parameters(const app_arguments *arguments, question *q) {
    const char *const *given = app_values(arguments, "--param");
    for (size_t i = 0; given && given[i]; i++) {
        if (i == SKEIN_FORMULA_MOST_PARAMETERS) return fault("--param", "...", "32 parameters at the most");
        const char *text = given[i], *equals = strchr(text, '=');
        size_t length = equals ? (size_t)(equals - text) : 0;
        if (!length || length >= sizeof q->name_text[i] || !read_number(equals + 1, &q->parameters[i]))
            return fault("--param", text, "a name and a number, as in L=0.5");
        memcpy(q->name_text[i], text, length);
        q->names[i] = q->name_text[i];
    }
    return true;
}

static bool read_question(const app_arguments *arguments, question *q) {
    const char *time = app_value(arguments, "--time");
    if (!read_points(arguments, "--at", q->positions, &q->particles) ||
        !read_points(arguments, "--rest", q->rest, &q->rest_particles) ||
        !read_points(arguments, "--velocity", q->velocities, &q->moving_particles) || !read_parameters(arguments, q))
        return false;
    return !time || read_number(time, &q->time) || fault("--time", time, "a number of seconds");
}

/* ---- answers ---- */

static void print_fault(const char *text, const skein_formula_mark *mark, const skein_error *error) {
    char shown[512];
    skein_formula_show(text, mark, shown, sizeof shown);
    fprintf(stderr, "skein formula: %s%s%s\n", error->where, error->where[0] ? ": " : "", error->message);
    if (error->where[0]) fputs(shown, stderr);
}

static void print_warnings(const char *text, const skein_formula *f) {
    skein_formula_mark mark;
    char shown[512];
    for (size_t i = 0; skein_formula_warning(f, i, &mark); i++) {
        skein_formula_show(text, &mark, shown, sizeof shown);
        fprintf(stderr, "skein formula: warning: line %zu, column %zu: %s\n%s", mark.line, mark.column,
                skein_formula_warning(f, i, NULL), shown);
    }
}

static void print_vector(const char *name, const double *x) {
    // a zero has no sign here
    printf("%-10s %.10g %.10g %.10g\n", name, x[0] + 0, x[1] + 0, x[2] + 0);
}

static void print_value(const skein_formula_info *info, const skein_formula_value *v, bool gradient) {
    char name[32];
    if (info->size == 3) print_vector("value", v->number);
    else printf("%-10s %.10g\n", info->at_least_zero ? "value >= 0" : "value", v->number[0] + 0);
    for (int k = 0; k < info->size && gradient; k++) {
        char component[4] = "";
        if (info->size == 3) snprintf(component, sizeof component, ".%c", "xyz"[k]);
        for (int p = 0; p < info->particles; p++) {
            snprintf(name, sizeof name, "d%s/dp%d", component, p);
            print_vector(name, v->by_position[k] + 3 * p);
        }
        for (int p = 0; p < info->particles && info->velocities; p++) {
            snprintf(name, sizeof name, "d%s/dv%d", component, p);
            print_vector(name, v->by_velocity[k] + 3 * p);
        }
        if (info->time) printf("d%-9s %.10g\n", info->size == 3 ? component : "/dt", v->by_time[k] + 0);
    }
    if (v->guarded) printf("guarded    something has no value or derivative here: 0 or the nearest was taken\n");
}

static void print_hessian(const double *hessian, int size) {
    printf("second derivatives, %d x %d\n", size, size);
    for (int i = 0; i < size; i++)
        for (int k = 0; k < size; k++) printf("%11.5g%s", hessian[i * size + k] + 0, k + 1 < size ? " " : "\n");
}

static int print_answer(const skein_formula *f, const app_arguments *arguments, const question *q) {
    bool second = app_given(arguments, "--hessian");
    skein_formula_info info = skein_formula_about(f);
    skein_formula_value value;
    skein_error error = {SKEIN_OK, "", ""};
    const skein_formula_point point = {q->positions, q->velocities, q->rest_particles ? q->rest : NULL, q->parameters,
                                       q->time};
    if ((size_t)info.particles > q->particles || (q->rest_particles && (size_t)info.particles > q->rest_particles)) {
        fprintf(stderr, "skein formula: the formula is on %d particles: give their places, as in --at '0,0,0 1,0,0'\n",
                info.particles);
        return EXIT_FAULT;
    }
    double hessian[9 * SKEIN_FORMULA_MOST_PARTICLES * SKEIN_FORMULA_MOST_PARTICLES];
    if (skein_formula_evaluate(f, &point, &value, &error) ||
        (second && skein_formula_hessian(f, &point, hessian, &error))) {
        app_print_error(&error);
        return EXIT_FAULT;
    }
    print_value(&info, &value, app_given(arguments, "--grad"));
    if (second) print_hessian(hessian, 3 * info.particles);
    return EXIT_OK;
}

static void print_text(void *user, const char *text) {
    (void)user;
    fputs(text, stdout);
}

/* What --emit takes. */
typedef struct language {
    const char *word;
    skein_formula_language language;
} language;
static const language languages[] = {{"c", SKEIN_FORMULA_C}, // to be compiled and registered
                                     {"function", SKEIN_FORMULA_C},
                                     {"glsl", SKEIN_FORMULA_GLSL},
                                     {"kernel", SKEIN_FORMULA_KERNEL},
                                     {NULL, SKEIN_FORMULA_C}};

static int answer(const char *text, const app_arguments *arguments, question *q) {
    skein_formula_mark mark;
    skein_error error = {SKEIN_OK, "", ""};
    const char *word = app_value(arguments, "--emit");
    const language *wanted = languages;
    while (word && wanted->word && strcmp(word, wanted->word)) wanted++;
    q->desc = (skein_formula_desc){.text = text,
                                   .parameters = q->names,
                                   .velocities = true,
                                   .comparison = true,
                                   .second = app_given(arguments, "--hessian")};
    skein_formula *f = skein_formula_create(&q->desc, &mark, &error);
    if (!f) {
        print_fault(text, &mark, &error);
        return EXIT_FAULT;
    }
    print_warnings(text, f);
    int status = EXIT_OK;
    if (word || app_given(arguments, "--graph")) {
        const char *name = app_value(arguments, "--name");
        if (word && wanted == languages
                ? skein_formula_emit_compiled(f, name, print_text, NULL, &error)
                : skein_formula_emit(f, word ? wanted->language : SKEIN_FORMULA_GRAPH, print_text, NULL, &error))
            app_print_error(&error), status = EXIT_FAULT;
    } else {
        status = print_answer(f, arguments, q);
    }
    skein_formula_destroy(f);
    return status;
}

static int print_functions(void) {
    const char *usage, *help;
    for (size_t i = 0; skein_formula_function(i, &usage, &help); i++) printf("%-24s %s\n", usage, help);
    return EXIT_OK;
}

static int formula(app_arguments *arguments) {
    const char *text = app_word(arguments);
    question q = {0};
    if (app_given(arguments, "--functions")) return print_functions();
    if (text) return read_question(arguments, &q) ? answer(text, arguments, &q) : EXIT_FAULT;
    fprintf(stderr,
            "skein formula: which formula? As in: skein formula 'length(p0-p1)-L' --at '0,0,0 1,0,0' --param L=0.5\n");
    return EXIT_FAULT;
}

static const app_option options[] = {
    {"--at", "POINTS", "where the particles are: '0,0,0 1,0,0' are p0 and p1", true, APP_TAKES_ANY},
    {"--rest", "POINTS", "where they are at rest, for rest(...); else where --at says", true, APP_TAKES_ANY},
    {"--velocity", "POINTS", "their velocities, v0, v1, ...; else 0", true, APP_TAKES_ANY},
    {"--param", "NAME=X", "a parameter's name and number; may be repeated", true, APP_TAKES_ANY},
    {"--time", "SECONDS", "what t is; else 0", false, APP_TAKES_ANY},
    {"--grad", NULL, "print the derivatives, too", false, APP_TAKES_ANY},
    {"--hessian", NULL, "print the second derivatives, too; or emit them, in C", false, APP_TAKES_ANY},
    {"--graph", NULL, "print the operations, for the value and its gradient", false, APP_TAKES_ANY},
    {"--emit", "c|function|glsl|kernel",
     "print it as C to compile and register (--hessian: as an energy), or as a function", false, APP_TAKES_ANY},
    {"--name", "NAME", "what the file of --emit c calls it; else skein_compiled_formula", false, APP_TAKES_ANY},
    {"--functions", NULL, "print what functions there are", false, APP_TAKES_ANY},
    APP_END_OF_OPTIONS};

const app_command app_formula_command = {
    "formula",
    "'TEXT' [--at POINTS] [--param NAME=X]... [--grad]",
    "evaluate a formula, differentiate it, and show what it becomes\n\n"
    "A formula is a number or a vector made from the places of particles, p0 to p7, each a vector; from\n"
    "parameters, which you name; and from t, the time. Skein finds its derivatives.\n\n"
    "  skein formula 'length(p0-p1) - L' --at '0,0,0 3,4,0' --param L=2 --grad\n"
    "      a spring's stretch, 3, and how it changes as its ends move\n"
    "  skein formula 'p.y - 0.3*sin(p.x + 2*t)' --at 1,0.5,0 --time 0.2 --grad\n"
    "      the height over a wave; p is p0, the only particle\n"
    "  skein formula 'let n = normalize(cross(p1-p0, p2-p0)); dot(n, p3-p0) >= 0.1' --at ...\n"
    "      a point that stays over a triangle: lines of `let` name parts, and >= makes it one-sided\n"
    "  skein formula 'dihedral(p0,p1,p2,p3) - rest(dihedral(p0,p1,p2,p3))' --emit c\n"
    "      rest(...) is computed once, where the particles begin; --emit prints the whole as C or GLSL\n\n"
    "Operators: + - * / ^, comparisons, && || !, and v.x, v.zyx for parts of a vector. --functions lists the\n"
    "functions. Where a derivative has no value, as at a length of 0, it is 0, and the answer says so.",
    options,
    NULL,
    false,
    APP_TAKES_ANY,
    formula,
    NULL,
};
