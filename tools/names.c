/* Writes include/skein/names.h from the tables of the library itself: `make names`; tests/names.sh compares.
 *
 * A constant's name is made from a kind's and a field's: "stretch.stiffness" of cloth is SKEIN_CLOTH_STRETCH_STIFFNESS.
 * Fails where two names that are not the same would become one. */
#include <ctype.h>
#include <skein/skein.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 4096, LENGTH = 128 };
typedef struct constant {
    char name[LENGTH], text[LENGTH];
} constant;
static constant made[MOST];
static size_t made_count;

static const char head[] =
    "/* Names of kinds and of their fields as constants: a misspelt one does not compile, and editors complete them.\n"
    " *\n"
    " *     skein_body_add(world, SKEIN_CLOTH, NULL, SKEIN_SETTINGS(SKEIN_PAIR(SKEIN_CLOTH_GRID, 33, 33)), NULL);\n"
    " *     skein_set(world, cloth, SKEIN_CLOTH_STRETCH_STIFFNESS, skein_number(2e4));\n"
    " *\n"
    " * A kind's own fields begin with its name, those that a whole category has with the category's (SKEIN_BODY_VISIBLE).\n"
    " * Made by `make names` from the library's own tables: do not edit it by hand. Defaults and ranges are in\n"
    " * docs/reference.md. Each constant is a plain text, and texts do as well. */\n"
    "#ifndef SKEIN_NAMES_H\n"
    "#define SKEIN_NAMES_H\n"
    "\n"
    "#include <skein/skein.h>\n"
    "\n"
    "/* A number that the formulas of an object name: SKEIN_PARAMETER(\"L\"). */\n"
    "#define SKEIN_PARAMETER(name_) \"parameters.\" name_\n"
    "\n"
    "// clang-format off\n";

static void fail(const char *what, const char *name) {
    fprintf(stderr, "names: %s: %s\n", name, what);
    exit(1);
}

/* Appends a word as a constant's name has it: capitals, and _ for whatever is no letter and no digit. */
static void append(char name[static LENGTH], const char *word, size_t length) {
    size_t at = strlen(name);
    if (at + length + 2 > LENGTH) fail("too long a name", word);
    name[at++] = '_';
    for (size_t i = 0; i < length; i++) name[at++] = (char)(isalnum((unsigned char)word[i]) ? toupper(word[i]) : '_');
    name[at] = '\0';
}

/* One line; the same name twice is right where it is the same text (a `formula` is a constraint and a collider). */
static void define(const char *name, const char *text, size_t length, const char *comment) {
    for (size_t i = 0; i < made_count; i++)
        if (!strcmp(made[i].name, name) && (strlen(made[i].text) != length || strncmp(made[i].text, text, length)))
            fail("stands for two different names", name);
    if (made_count == MOST) fail("there are too many names", name);
    snprintf(made[made_count].name, LENGTH, "%s", name);
    snprintf(made[made_count++].text, LENGTH, "%.*s", (int)length, text);
    if (strstr(comment, "*/")) fail("its help would end a comment", name);
    printf("#define %s \"%.*s\"%s%s%s\n", name, (int)length, text, *comment ? " /* " : "", comment,
           *comment ? " */" : "");
}

static void write_field(const char *prefix, const skein_field *field) {
    static const char *const types[] = {"true or false",       "a whole number", "two whole numbers",
                                        "three whole numbers", "a number",       "two numbers",
                                        "three numbers",       "a word",         "a text"};
    char name[LENGTH], comment[512];
    if (strchr(field->name, '*')) return; // whatever the object's formulas name
    snprintf(name, sizeof name, "%s", prefix);
    append(name, field->name, strlen(field->name));
    snprintf(comment, sizeof comment, "%s%s%s; %s", types[field->type], *field->unit ? " in " : "", field->unit,
             field->help);
    define(name, field->name, strlen(field->name), comment);
    if (field->type != SKEIN_FIELD_CHOICE) return;
    for (const char *word = field->choices; word;) {
        char choice[LENGTH];
        size_t length = strcspn(word, "|");
        snprintf(choice, sizeof choice, "%s", name);
        append(choice, word, length);
        define(choice, word, length, "");
        word = word[length] ? word + length + 1 : NULL;
    }
}

static void write_category(skein_category category, const char *title) {
    char prefix[LENGTH] = "SKEIN";
    size_t count;
    const skein_field *common = skein_common_fields(category, &count);
    append(prefix, skein_category_text(category), strlen(skein_category_text(category)));
    printf("\n/* ---- %s ---- */\n", title);
    if (count) printf("\n/* of every %s */\n", skein_category_text(category));
    for (size_t i = 0; i < count; i++) write_field(prefix, &common[i]);
    for (size_t k = 0; skein_kind_at(category, k); k++) {
        const skein_kind *kind = skein_kind_at(category, k);
        snprintf(prefix, sizeof prefix, "SKEIN");
        append(prefix, kind->name, strlen(kind->name));
        printf("\n");
        define(prefix, kind->name, strlen(kind->name), kind->help);
        for (size_t i = 0; i < kind->field_count; i++) write_field(prefix, &kind->fields[i]);
    }
}

int main(void) {
    fputs(head, stdout);
    write_category(SKEIN_BODY, "bodies");
    write_category(SKEIN_CONSTRAINT, "constraints");
    write_category(SKEIN_FORCE, "forces");
    write_category(SKEIN_COLLIDER, "colliders");
    write_category(SKEIN_METHOD, "methods");
    printf("// clang-format on\n\n#endif\n");
    return ferror(stdout) || fflush(stdout) ? 1 : 0;
}
