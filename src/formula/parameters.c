/* An object's own kind: its type's table, and a field more for each parameter that its texts name. */
#include "formula/parameters.h"

#include <stdio.h>
#include <string.h>

#include "base/fields.h"
#include "base/status.h"
#include "formula/parser.h"

static const char prefix[] = "parameters.";
enum { PREFIX = sizeof prefix - 1 };

/* ---- an object's own kind ---- */

static const skein_field *row_of(const skein_kind *kind) {
    for (size_t i = 0; i < kind->field_count; i++)
        if (!strcmp(kind->fields[i].name, "parameters.*")) return &kind->fields[i];
    return NULL;
}

bool sk_takes_parameters(const skein_kind *kind) {
    return row_of(kind) != NULL;
}

/* The name that a setting declares, or NULL. */
static const char *declared(const skein_setting *setting) {
    return strncmp(setting->name, prefix, PREFIX) ? NULL : setting->name + PREFIX;
}

static skein_status check_name(const skein_setting *settings, const skein_setting *at, size_t before,
                               skein_error *error) {
    const char *name = declared(at);
    if (before == SKEIN_FORMULA_MOST_PARAMETERS)
        return sk_fail(error, SKEIN_ERROR_LIMIT, at->name, "too many parameters: %d are the most",
                       SKEIN_FORMULA_MOST_PARAMETERS);
    if (!sk_is_name(name))
        return sk_fail(error, SKEIN_ERROR_NAME, at->name,
                       "'%.40s' cannot be a parameter's name: that is up to %d letters, digits and _, and no digit "
                       "first",
                       name, SK_NAME_SIZE - 1);
    if (sk_parser_is_taken(name))
        return sk_fail(error, SKEIN_ERROR_NAME, at->name,
                       "'%s' cannot be a parameter: it has a meaning in formulas already", name);
    for (; settings < at; settings++)
        if (!strcmp(settings->name, at->name))
            return sk_fail(error, SKEIN_ERROR_NAME, at->name, "the parameter '%s' is given twice", name);
    return SKEIN_OK;
}

/* One block: the kind, its rows, and the new rows' names. */
typedef struct own_kind {
    skein_kind kind;
    char name[SKEIN_FORMULA_MOST_PARAMETERS][PREFIX + SK_NAME_SIZE];
    skein_field fields[];
} own_kind;

skein_status sk_own_kind_create(sk_allocator *allocator, const skein_kind *kind, const skein_setting *settings,
                                skein_kind **own, skein_error *error) {
    size_t count = 0;
    for (const skein_setting *s = settings; s && s->name; s++) {
        skein_status status = declared(s) ? check_name(settings, s, count, error) : SKEIN_OK;
        if (status) return status;
        count += declared(s) != NULL;
    }
    own_kind *made = sk_allocate(allocator, sizeof *made + (kind->field_count + count) * sizeof *made->fields);
    if (!made) return sk_fail_memory(error, kind->name);
    skein_field *next = made->fields;
    const skein_field *row = row_of(kind);
    for (size_t i = 0; i < kind->field_count; i++)
        if (&kind->fields[i] != row) *next++ = kind->fields[i];
    count = 0;
    for (const skein_setting *s = settings; s && s->name; s++) {
        if (!declared(s)) continue;
        *next = *row;
        next->offset = row->offset + count * sizeof(double);
        next->help = "named by the formula";
        snprintf(made->name[count], sizeof made->name[count], "%s", s->name);
        next++->name = made->name[count++];
    }
    made->kind = *kind;
    made->kind.fields = made->fields;
    made->kind.field_count = (size_t)(next - made->fields);
    *own = &made->kind;
    return SKEIN_OK;
}

int sk_parameter_names(const skein_kind *own, const char *names[static SKEIN_FORMULA_MOST_PARAMETERS + 1]) {
    int count = 0;
    for (size_t i = 0; i < own->field_count && count < SKEIN_FORMULA_MOST_PARAMETERS; i++)
        if (!strncmp(own->fields[i].name, prefix, PREFIX)) names[count++] = own->fields[i].name + PREFIX;
    names[count] = NULL;
    return count;
}

/* ---- a field's formula ---- */

/* Puts the place before what is wrong, and the marked line behind it. */
static void show_place(const char *field, const char *text, const skein_formula_mark *mark, skein_error *error) {
    char words[sizeof error->message], shown[200];
    bool whole = skein_formula_show(text, mark, shown, sizeof shown) < sizeof shown;
    snprintf(words, sizeof words, "%s", error->message);
    size_t size = sizeof error->message, length = 0;
    if (strchr(text, '\n')) length = (size_t)snprintf(error->message, size, "line %zu, ", mark->line);
    length += (size_t)snprintf(error->message + length, size - length, "column %zu: %.*s", mark->column, 260, words);
    for (char *line = shown; whole && *line; line += strcspn(line, "\n"), line += *line == '\n')
        length += (size_t)snprintf(error->message + length, length < size ? size - length : 0, "\n    %.*s",
                                   (int)strcspn(line, "\n"), line);
    snprintf(error->where, sizeof error->where, "%s", field);
}

skein_formula *sk_formula_of_field(const char *field, const char *text, skein_formula_desc desc, const skein_kind *own,
                                   sk_allocator *allocator, skein_error *error) {
    const char *names[SKEIN_FORMULA_MOST_PARAMETERS + 1];
    skein_formula_mark mark = {0, 0, 0};
    skein_error words = {SKEIN_OK, "", ""};
    desc.text = text ? text : "";
    sk_parameter_names(own, names);
    desc.parameters = names;
    skein_formula *formula = sk_formula_create(&desc, allocator, &mark, &words);
    if (formula) return formula;
    if (words.where[0]) show_place(field, desc.text, &mark, &words); // else it is no place's fault
    else snprintf(words.where, sizeof words.where, "%s", field);
    if (error) *error = words;
    return NULL;
}

static bool names_parameter(const skein_formula *formula, uint32_t parameter) {
    for (size_t i = 0; i < formula->graph.count; i++) {
        const sk_graph_node *node = &formula->graph.data[i];
        if (node->op == SK_NODE_PARAMETER && node->arg[0] == parameter) return true;
    }
    return false;
}

skein_status sk_formula_check_used(const skein_kind *own, const skein_formula *const *formulas, size_t count,
                                   skein_error *error) {
    const char *names[SKEIN_FORMULA_MOST_PARAMETERS + 1];
    int parameters = sk_parameter_names(own, names);
    for (int i = 0; i < parameters; i++) {
        bool used = false;
        for (size_t f = 0; f < count; f++) used |= names_parameter(formulas[f], (uint32_t)i);
        if (!used)
            return sk_fail(error, SKEIN_ERROR_NAME, names[i] - PREFIX, "'%s' is in no formula of this object", names[i]);
    }
    return SKEIN_OK;
}
