/* The painter's thread: it does one piece of work at a time, in order, and what work has written its stage reads once the
 * painter is idle. ThreadSanitizer watches. */
#include "helpers.h"

#include "viewer/painter.h"

typedef struct canvas {
    int strokes[200], count; /* no lock: whose turn it is guards them */
} canvas;

static void paint_stroke(void *user) {
    canvas *c = user;
    c->strokes[c->count] = c->count;
    c->count++;
}

static viewer_events nobody;

/* The stage begins work, waits in its own queue, and is nudged when that is done. */
static void hands_over_and_back(void **state) {
    viewer_exchange exchange;
    viewer_painter painter;
    canvas c = {{0}, 0};
    (void)state;
    assert_true(viewer_exchange_open(&exchange, &nobody));
    assert_true(viewer_painter_start(&painter, &exchange));
    while (c.count < 200) { // the painter is idle here
        int before = c.count;
        size_t asked;
        viewer_painter_begin(&painter, paint_stroke, &c);
        while (viewer_painter_busy(&painter)) viewer_take(&exchange, 60, &asked);
        assert_int_equal(c.count, before + 1);
    }
    for (int i = 0; i < 200; i++) assert_int_equal(c.strokes[i], i);
    viewer_painter_stop(&painter);
    viewer_exchange_close(&exchange);
}

/* What is begun while it is busy waits for that; stopping waits for all. */
static void keeps_order_and_ends_its_work(void **state) {
    viewer_exchange exchange;
    viewer_painter painter;
    canvas c = {{0}, 0};
    (void)state;
    assert_true(viewer_exchange_open(&exchange, &nobody));
    assert_true(viewer_painter_start(&painter, &exchange));
    for (int i = 0; i < 150; i++) viewer_painter_begin(&painter, paint_stroke, &c);
    viewer_painter_do(&painter, paint_stroke, &c);
    assert_int_equal(c.count, 151);
    viewer_painter_begin(&painter, paint_stroke, &c);
    viewer_painter_stop(&painter);
    assert_int_equal(c.count, 152);
    viewer_exchange_close(&exchange);
}

/* A nudge ends a wait that nobody asked anything in; it is used up then. */
static void a_nudge_ends_the_wait(void **state) {
    viewer_exchange exchange;
    size_t asked = 1;
    (void)state;
    assert_true(viewer_exchange_open(&exchange, &nobody));
    viewer_nudge(&exchange);
    double start = viewer_seconds();
    viewer_take(&exchange, 600, &asked);
    assert_true(viewer_seconds() - start < 500);
    assert_int_equal(asked, 0);
    start = viewer_seconds();
    viewer_take(&exchange, 0.05, &asked);
    assert_true(viewer_seconds() - start >= 0.04);
    viewer_exchange_close(&exchange);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hands_over_and_back),
        cmocka_unit_test(keeps_order_and_ends_its_work),
        cmocka_unit_test(a_nudge_ends_the_wait),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
