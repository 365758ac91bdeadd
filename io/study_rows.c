/* The rows of a study: which values each has, and the command that does it again.
 *
 * The last field that is listed changes from row to row, but for the times that each point is repeated; random numbers
 * come from the study's seed, the row and the field alone, so that any process can have any row. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/study_inside.h"

size_t io_study_rows(const io_study *study) {
    return study->rows;
}

const char *io_study_name(const io_study *study) {
    return study->name;
}

const char *io_study_varied(const io_study *study, size_t v) {
    return v < study->varied_count ? study->varied[v].path : NULL;
}

bool io_study_is_random(const io_study *study, size_t v, size_t *count) {
    *count = study->varied[v].values ? json_array_size(study->varied[v].values) : 0;
    return study->varied[v].is_random;
}

const char *io_study_measure(const io_study *study, size_t m) {
    return m < study->wanted_count ? study->wanted[m].name : NULL;
}

const char *io_study_measure_unit(const io_study *study, size_t m) {
    return io_study_quantity_unit(study->wanted[m].what);
}

const json_t *io_study_plot(const io_study *study) {
    return study->plot;
}

const char *io_study_text(const io_study *study) {
    return study->text;
}

const char *io_study_scene_text(const io_study *study) {
    return study->scene_text;
}

/* ---- values ---- */

/* A number of [0, 1), of 53 random bits (splitmix64's finisher over what tells one draw from another). */
static double draw(uint64_t seed, uint64_t row, uint64_t v) {
    uint64_t z = seed * 0x9e3779b97f4a7c15u + row * 0xd1342543de82ef95u + (v + 1) * 0xda942042e4dd58b5u;
    for (int k = 0; k < 2; k++) {
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        z ^= z >> 31;
    }
    return (double)(z >> 11) * 0x1p-53;
}

static json_t *draw_value(const io_study *study, size_t row, size_t v) {
    const study_varied *field = &study->varied[v];
    double u = draw(study->seed, row, v), a = field->from, b = field->to;
    if (field->whole) return json_integer((json_int_t)fmin(b, a + floor((b - a + 1) * u)));
    char text[32];
    snprintf(text, sizeof text, "%.12g", field->by_ratio ? a * pow(b / a, u) : a + (b - a) * u);
    return json_real(strtod(text, NULL));
}

json_t *io_study_value(const io_study *study, size_t row, size_t v) {
    if (!study->varied[v].values) return draw_value(study, row, v);
    size_t point = row / study->repeat;
    for (size_t k = study->varied_count; --k > v;)
        if (study->varied[k].values) point /= json_array_size(study->varied[k].values);
    return json_incref(json_array_get(study->varied[v].values, point % json_array_size(study->varied[v].values)));
}

/* ---- texts ---- */

const char *io_study_number(double x, char text[32]) {
    if (isnan(x)) return strcpy(text, "nan");
    if (isinf(x)) return strcpy(text, x < 0 ? "-inf" : "inf");
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 32, "%.*g", digits, x);
        if (strtod(text, NULL) == x) break;
    }
    return text;
}

char *study_short_json(const json_t *value) {
    for (size_t digits = 15; digits <= 17; digits++) {
        char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(digits));
        json_t *back = text ? json_loads(text, JSON_DECODE_ANY, NULL) : NULL;
        bool same = back && json_equal(back, value);
        json_decref(back);
        if (!text || same || digits == 17) return text;
        free(text);
    }
    return NULL;
}

/* Whether a text is a word that needs no quotes after the equals sign of a set. */
static bool is_word(const char *text) {
    static const char *const reserved[] = {"true", "false", "null"};
    for (size_t i = 0; i < COUNT_OF(reserved); i++)
        if (!strcmp(text, reserved[i])) return false;
    return text[0] >= 'a' && text[0] <= 'z' && strspn(text, "abcdefghijklmnopqrstuvwxyz_0123456789") == strlen(text);
}

char *study_set_text(const char *path, const json_t *value) {
    const char *word = json_string_value(value);
    char *json = word && is_word(word) ? strdup(word) : study_short_json(value);
    size_t size = json ? strlen(path) + strlen(json) + 2 : 0;
    char *text = json ? malloc(size) : NULL;
    if (text) snprintf(text, size, "%s=%s", path, json);
    free(json);
    return text;
}

char **study_sets(const io_study *study, size_t row) {
    char **sets = calloc(study->varied_count + 1, sizeof *sets);
    for (size_t v = 0; sets && v < study->varied_count; v++) {
        json_t *value = io_study_value(study, row, v);
        sets[v] = value ? study_set_text(study->varied[v].path, value) : NULL;
        json_decref(value);
        if (sets[v]) continue;
        study_free_sets(sets);
        return NULL;
    }
    return sets;
}

/* ---- the command ---- */

typedef struct words {
    char *text;
    size_t size, capacity;
    bool failed;
} words;

static void put(words *w, const char *text, size_t length) {
    w->failed |= !io_grow(&w->text, &w->capacity, w->size + length + 1, 1);
    if (w->failed) return;
    memcpy(w->text + w->size, text, length);
    w->text[w->size += length] = 0;
}

/* One word of a shell. */
static void put_word(words *w, const char *text) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=:,+-";
    if (strspn(text, plain) == strlen(text)) {
        put(w, text, strlen(text));
        return;
    }
    put(w, "'", 1);
    for (const char *at = text; *at;) {
        size_t length = strcspn(at, "'");
        put(w, at, length);
        at += length;
        if (*at) put(w, "'\\''", 4), at++;
    }
    put(w, "'", 1);
}

/* Scenes may read what lies beside them; whoever does a row again says that its files may be read, too. */
static bool put_allowed(void *user, const char *path) {
    words *w = user;
    put(w, " --allow-path ", 14);
    put_word(w, path);
    return !w->failed;
}

char *io_study_command(const io_study *study, size_t row) {
    words w = {NULL, 0, 0, false};
    char **sets = study_sets(study, row);
    json_t *scene = json_loads(study->scene_text, 0, NULL);
    put(&w, "skein run scene.json", 20);
    w.failed |= !scene || !io_scene_each_file(scene, put_allowed, &w);
    json_decref(scene);
    for (size_t v = 0; sets && sets[v]; v++) {
        put(&w, " --set ", 7);
        put_word(&w, sets[v]);
    }
    if (sets && !w.failed) {
        study_free_sets(sets);
        return w.text;
    }
    study_free_sets(sets);
    free(w.text);
    return NULL;
}
