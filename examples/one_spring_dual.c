/* One spring: two points are brought to their rest length, with derivatives that nobody worked out.
 *
 * The constraint is C = |p1 - p2| - L. Its six controls are the coordinates of the two points, each seeded with the
 * derivative 1 by itself, so that C comes with its gradient. A solve moves the points by -C / |grad C|^2 grad C.
 * Prints the gradient and both points at every solve. It needs skein/dual.h and nothing else of Skein:
 *     cc -std=c17 -Iinclude examples/one_spring_dual.c -lm */
#define SKEIN_DUAL_N 6
#define SKEIN_DUAL_REAL double
#define SKEIN_DUAL_NAME dual
#include <skein/dual.h>

#include <stdio.h>

typedef struct spring {
    double p1[3], p2[3], rest_length;
} spring;

static dual constraint(const spring *s) {
    dual_vec p1 = dual_vec_seed(s->p1[0], s->p1[1], s->p1[2], 1); /* controls 1, 2, 3 */
    dual_vec p2 = dual_vec_seed(s->p2[0], s->p2[1], s->p2[2], 4); /* controls 4, 5, 6 */
    return dual_sub_real(dual_vec_length(dual_vec_sub(p1, p2)), s->rest_length);
}

static void solve(spring *s) {
    dual c = constraint(s);
    double square = 0;
    for (int i = 1; i <= 6; i++) square += c.d[i] * c.d[i];
    double lambda = square > 0 ? -c.d[0] / square : 0; /* points that coincide have no direction to part in */
    for (int k = 0; k < 3; k++) {
        s->p1[k] += lambda * c.d[1 + k];
        s->p2[k] += lambda * c.d[4 + k];
    }
    printf("  C %g, derivatives", c.d[0]);
    for (int i = 1; i <= 6; i++) printf(" %g", c.d[i]);
    printf("\n    -> (%g, %g, %g) and (%g, %g, %g)\n", s->p1[0], s->p1[1], s->p1[2], s->p2[0], s->p2[1], s->p2[2]);
}

int main(void) {
    spring one = {{-0.5, 0, 0}, {0.5, 0, 0}, 0.5};
    printf("from 1 to the rest length %g\n", one.rest_length);
    for (int i = 0; i < 2; i++) solve(&one);

    spring live = {{-10.5, 0, 0}, {10.5, 0, 0}, 5.5};
    printf("every frame, from 21 to the rest length %g\n", live.rest_length);
    for (int frame = 0; frame < 6; frame++) {
        if (frame == 2) live.p1[1] = 4; /* a hand moves a point; the next solve brings both back */
        if (frame == 4) live.p2[0] = -9, live.p2[2] = 3;
        printf("frame %d\n", frame);
        solve(&live);
    }
    printf("ends with C = %g\n", constraint(&live).d[0]);
    return 0;
}
