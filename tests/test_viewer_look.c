/* The window's look, as far as it can be computed: whether a slider hides its number, and what the axis of a plot spans
 * where values are not finite. */
#include "helpers.h"

#include <float.h>

#include "viewer/chart.h"
#include "viewer/theme.h"

static const viewer_theme themes[] = {VIEWER_DARK, VIEWER_LIGHT};

/* ---- contrast, as WCAG 2 defines it -------------------------------------------------------------------- */

static double light_of(const double rgb[3]) {
    static const double weight[3] = {0.2126, 0.7152, 0.0722};
    double light = 0;
    for (int k = 0; k < 3; k++)
        light += weight[k] * (rgb[k] <= 0.03928 ? rgb[k] / 12.92 : pow((rgb[k] + 0.055) / 1.055, 2.4));
    return light;
}

/* Of words in one colour on another that lies with this opacity on a third. */
static double contrast(uint32_t words, uint32_t over, double opacity, uint32_t under) {
    double a[3], b[3];
    for (int k = 0; k < 3; k++) {
        int shift = 16 - 8 * k;
        a[k] = (double)(words >> shift & 255) / 255;
        b[k] = (opacity * (double)(over >> shift & 255) + (1 - opacity) * (double)(under >> shift & 255)) / 255;
    }
    double one = light_of(a), other = light_of(b);
    return (fmax(one, other) + 0.05) / (fmin(one, other) + 0.05);
}

/* A slider's number is drawn over its knob: it is to be read there as beside it, also while the knob is held. */
static void sliders_do_not_hide_their_numbers(void **state) {
    (void)state;
    assert_near(contrast(0xffffff, 0x000000, 1, 0), 21, 1e-9);
    for (size_t t = 0; t < COUNT(themes); t++) {
        const viewer_colours *c = viewer_colours_of(themes[t]);
        assert_true(contrast(c->text, c->field, 1, 0) >= 7 && contrast(c->text, c->field_over, 1, 0) >= 7);
        assert_true(contrast(c->text, c->knob, VIEWER_KNOB_OPACITY, c->field) >= 4.5);
        assert_true(contrast(c->text, c->knob, VIEWER_KNOB_OPACITY, c->field_over) >= 4.5);
        assert_true(contrast(c->text, c->accent, VIEWER_HELD_OPACITY, c->field_over) >= 4.5);
        // and the knob is to be seen: not the field's own colour
        assert_true(contrast(c->field, c->knob, VIEWER_KNOB_OPACITY, c->field) >= 1.2);
        assert_true(contrast(c->text, c->panel, 1, 0) >= 7 && contrast(c->quiet, c->panel, 1, 0) >= 4.5);
    }
}

/* ---- axes ------------------------------------------------------------------------------------------------- */

enum { ROOM = 16 };

static void range_of(const float *one, const float *other, bool compared, float *least, float *most) {
    const float *series[] = {one, NULL, other};
    viewer_chart_range(series, 3, 5, ROOM, ROOM, compared, least, most);
    assert_true(isfinite(*least) && isfinite(*most) && *most > *least);
}

/* Values that are not finite are gaps: the axis is that of the others. */
static void axes_survive_infinities(void **state) {
    (void)state;
    float values[ROOM], wild[ROOM], least, most;
    for (int i = 0; i < ROOM; i++) values[i] = wild[i] = 2 + (float)i;
    values[3] = NAN, values[4] = INFINITY, values[5] = -INFINITY;
    range_of(values, NULL, false, &least, &most);
    assert_true(least == 2 && most == 17);
    // none at all, one alone, and huge ones that do not differ
    for (int i = 0; i < ROOM; i++) values[i] = NAN;
    range_of(values, NULL, false, &least, &most);
    assert_true(least == -0.5f && most == 0.5f);
    values[7] = 4;
    range_of(values, NULL, true, &least, &most);
    assert_true(least <= 4 && most >= 4 && most - least < 10);
    for (int i = 0; i < ROOM; i++) values[i] = 1e20f;
    range_of(values, NULL, false, &least, &most);
    assert_true(least < 1e20f && most > 1e20f);
    // what blows up beside what does not: up to infinity, and the calm one still fills a tenth of the axis
    float growing = 1;
    for (int i = 0; i < ROOM; i++, growing *= 1000) wild[(i + 5) % ROOM] = growing;
    for (int i = 0; i < ROOM; i++) values[i] = 1 + 0.5f * (float)(i % 3);
    assert_true(isinf(wild[4]));
    range_of(values, wild, true, &least, &most);
    assert_true(most - least <= 20 && least <= 1 && most >= 2);
    range_of(wild, values, true, &least, &most); // whichever is first
    assert_true(most - least <= 20 && least <= 1 && most >= 2);
}

/* One world that swings, and grows to 1e20 J at its end: what it did before is still to be read. A swing alone, and a
 * single peak that is not that high, have all of the axis. */
static void a_blow_up_leaves_the_axis(void **state) {
    (void)state;
    float values[ROOM], least, most;
    for (int i = 0; i < ROOM; i++) values[(i + 5) % ROOM] = 10 + 2 * sinf((float)i);
    range_of(values, NULL, false, &least, &most);
    assert_true(least > 7.9f && least < 8.2f && most > 11.8f && most < 12.1f);
    values[2] = 1e4f, values[3] = 1e12f, values[4] = 1e20f; // the last ones
    range_of(values, NULL, false, &least, &most);
    assert_true(most - least < 100 && least < 8.2f && most > 12);
    values[3] = -1e12f; // and down
    range_of(values, NULL, false, &least, &most);
    assert_true(most - least < 200 && least < 8.2f && most > 12);
    values[2] = values[3] = 9, values[4] = 900;
    range_of(values, NULL, false, &least, &most);
    assert_true(most == 900);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sliders_do_not_hide_their_numbers),
        cmocka_unit_test(axes_survive_infinities),
        cmocka_unit_test(a_blow_up_leaves_the_axis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
