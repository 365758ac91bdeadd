/* Tests of numbers in texts: the nearest double, by whatever locale the program runs. */
#include <locale.h>

#include "base/number.h"
#include "helpers.h"

static uint64_t dice(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static void as_strtod(const char *text) {
    double x = -7;
    char *end;
    double ought = strtod(text, &end);
    size_t size = sk_number_read_signed(text, &x);
    if (size != (size_t)(end - text) || (size && memcmp(&x, &ought, sizeof x)))
        fail_msg("'%s': %.17g of %zu characters, expected %.17g of %zu", text, x, size, ought, (size_t)(end - text));
}

/* In the locale C, where strtod() tells. */
static void numbers_are_the_nearest(void **state) {
    (void)state;
    static const char *const texts[] = {"0",
                                        "-0",
                                        "1",
                                        "+1.5",
                                        ".5",
                                        "5.",
                                        "1e3",
                                        "1e",
                                        "1e+",
                                        "2e-3x",
                                        "1.2.3",
                                        "",
                                        "-",
                                        ".",
                                        "x",
                                        " \t7,8",
                                        "1e400",
                                        "1e-400",
                                        "4.9e-324",
                                        "2.2250738585072011e-308",
                                        "9007199254740993",
                                        "9007199254740992.9999999999999999999999",
                                        "0.000000000000000000000000000000000000000000001e45",
                                        "123456789012345678901234567890",
                                        "1e999999999999",
                                        "1e-999999999999",
                                        "0e999999999999",
                                        "1.00000000000000011102230246251565",
                                        "1.7976931348623157e308",
                                        "179769313486231580793e289"};
    for (size_t i = 0; i < COUNT(texts); i++) as_strtod(texts[i]);
    uint64_t seed = 5;
    for (int i = 0; i < 100000; i++) {
        char text[64];
        uint64_t bits = dice(&seed);
        double x;
        memcpy(&x, &bits, sizeof x);
        if (!isfinite(x)) continue;
        snprintf(text, sizeof text, "%.*g", 1 + (int)(dice(&seed) % 20),
                 i & 1 ? x : (double)(int64_t)(bits >> 20) / 1e6);
        as_strtod(text);
    }
    char many[1200]; // a tie, and what decides it in the last place
    memset(many, '0', sizeof many);
    memcpy(many, "1.00000000000000011102230246251565404236316680908203125", 55);
    many[1100] = '1';
    many[1101] = 0;
    as_strtod(many);
}

/* Makes a locale that has commas, and takes it; false where this machine cannot. */
static bool write_commas(void) {
    char folder[] = "/tmp/skein-locale-XXXXXX", path[64], command[200];
    if (!mkdtemp(folder)) return false;
    snprintf(path, sizeof path, "%s/source", folder);
    FILE *file = fopen(path, "w");
    if (!file) return false;
    fputs("LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \"\"\ngrouping -1\nEND LC_NUMERIC\n", file);
    fclose(file);
    snprintf(command, sizeof command, "localedef -c -i %s/source %s/commas >/dev/null 2>&1", folder, folder);
    int made = system(command);
    (void)made; // it warns of all that is missing; whether it did is seen
    setenv("LOCPATH", folder, 1);
    bool taken = setlocale(LC_NUMERIC, "commas") != NULL;
    snprintf(command, sizeof command, "rm -r %s", folder);
    made = system(command);
    return taken && localeconv()->decimal_point[0] == ',';
}

/* A pin at a place with a point, a key and a formula, where the program writes commas. */
static void a_comma_for_a_point_changes_nothing(void **state) {
    (void)state;
    bool there = false;
    uint64_t hash[2];
    for (int turn = 0; turn < 2; turn++) {
        if (turn) there = write_commas();
        skein_world *world = new_world("xpbd", 4);
        OK(world,
           skein_body_add(
               world, "cloth", NULL,
               SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5), SKEIN_TEXT("pins", "box -0.6 -1.5 -1.5 -0.4 1.5 1.5")), NULL));
        OK(world, skein_motion_add(world, "keys", NULL, SKEIN_SETTINGS(SKEIN_TEXT("keys", "0 0 0 0, 0.5 0.25 0 0.125")),
                                   NULL));
        OK(world, skein_force_add(world, "potential", SKEIN_SETTINGS(SKEIN_TEXT("energy", "0.5*p.y")), NULL));
        steps(world, 20, 1.0 / 60);
        hash[turn] = skein_world_hash(world);
        skein_world_destroy(world);
    }
    setlocale(LC_NUMERIC, "C");
    assert_true(hash[0] == hash[1]);
    if (!there) skip(); // this machine has no such locale: nothing was shown
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_the_nearest),
        cmocka_unit_test(a_comma_for_a_point_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
