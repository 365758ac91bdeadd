/* Tests of clips (io/clip.h), the files of a run for other programs: what a run writes is read back by small readers of
 * our own here, which know the formats from their descriptions and share no code with the writers. */
#include "test_command.h"

#include <math.h>

#include "io/clip.h"

/* ---- Small readers -------------------------------------------------------------------------------------- */

/* All samples of a point cache. */
typedef struct samples {
    uint32_t count, points;
    double *times; /* count, where the format has them */
    float *places; /* count x points x 3 */
} samples;

static void samples_free(samples *s) {
    free(s->times);
    free(s->places);
}

static io_bytes read_bytes(const char *path) {
    io_bytes bytes;
    skein_error error = {SKEIN_OK, "", ""};
    if (io_file_read(path, (size_t)1 << 30, &bytes, &error)) fail_msg("%s: %s", error.where, error.message);
    return bytes;
}

static uint32_t big(const char *at) {
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static float big_float(const char *at) {
    uint32_t bits = big(at);
    float value;
    memcpy(&value, &bits, 4);
    return value;
}

static samples read_mdd(const char *path) {
    io_bytes bytes = read_bytes(path);
    assert_true(bytes.size >= 8);
    samples s = {big(bytes.data), big(bytes.data + 4), NULL, NULL};
    assert_int_equal(bytes.size, 8 + 4 * (size_t)s.count + 12 * (size_t)s.count * s.points);
    s.times = malloc(s.count * sizeof *s.times);
    s.places = malloc(3 * (size_t)s.count * s.points * sizeof *s.places);
    for (uint32_t i = 0; i < s.count; i++) s.times[i] = big_float(bytes.data + 8 + 4 * i);
    for (size_t i = 0; i < 3 * (size_t)s.count * s.points; i++)
        s.places[i] = big_float(bytes.data + 8 + 4 * (size_t)s.count + 4 * i);
    io_bytes_free(&bytes);
    return s;
}

static samples read_pc2(const char *path) {
    io_bytes bytes = read_bytes(path);
    samples s = {0, 0, NULL, NULL};
    memcpy(&s.points, bytes.data + 16, 4); // these machines are little endian
    memcpy(&s.count, bytes.data + 28, 4);
    assert_int_equal(bytes.size, 32 + 12 * (size_t)s.count * s.points);
    s.places = malloc(bytes.size - 32);
    memcpy(s.places, bytes.data + 32, bytes.size - 32);
    io_bytes_free(&bytes);
    return s;
}

/* ---- Point caches and sequences ------------------------------------------------------------------------- */

static void all_formats_hold_the_same_motion(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char path[64];
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--fps", "24", "--set",
                      "output=[\"pc2\", {\"type\": \"mdd\", \"every\": 2}, {\"type\": \"obj\", \"every\": 2}]");
    assert_status(o, 0);
    assert_contains(o.out, "/out/sheet_0002.obj\n");
    outcome_free(&o);
    samples all = read_pc2(in_folder("out/sheet.pc2")), some = read_mdd(in_folder("out/sheet.mdd"));
    assert_int_equal(all.points, 25);
    assert_int_equal(all.count, 5);
    assert_int_equal(some.points, 25);
    assert_int_equal(some.count, 3);
    size_t sample = 3 * 25;
    assert_true(all.places[sample * 4 + 37] < all.places[37]); // it fell in between
    for (uint32_t i = 0; i < 3; i++) {
        assert_float_equal(some.times[i], 2 * i / 24.0, 1e-8);
        assert_memory_equal(some.places + i * sample, all.places + 2 * i * sample, sample * sizeof(float));
        snprintf(path, sizeof path, "out/sheet_%04u.obj", 2 * i);
        io_mesh mesh;
        assert_int_equal(io_mesh_read(in_folder(path), &mesh, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
        for (size_t k = 0; k < sample; k++) assert_true((float)mesh.positions[k] == all.places[2 * i * sample + k]);
        io_mesh_free(&mesh);
    }
    assert_false(exists(in_folder("out/sheet.obj")) || exists(in_folder("out/sheet_0001.obj")));
    samples_free(&all);
    samples_free(&some);
}

static void a_file_can_be_asked_for_alone(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("run", s, "--out", in_folder("some/cape.MDD"), "--set",
                      "bodies=[{\"type\": \"cloth\", \"grid\": [3, 3]}]", "--set", "output.0.every=4");
    assert_status(o, 0);
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("some")), 1);
    samples one = read_mdd(in_folder("some/cape.mdd"));
    assert_int_equal(one.count, 2);
    samples_free(&one);
    // of two bodies each has its own; a folder of such a name stays a folder
    o = SKEIN("run", s, "--out", in_folder("two.mdd"));
    assert_status(o, 0);
    outcome_free(&o);
    assert_true(exists(in_folder("two-sheet.mdd")) && exists(in_folder("two-cloth.mdd")));
    assert_int_equal(mkdir(in_folder("folder.mdd"), 0777), 0);
    o = SKEIN("run", s, "--out", in_folder("folder.mdd"));
    assert_status(o, 0);
    outcome_free(&o);
    assert_true(exists(in_folder("folder.mdd/sheet.pc2")) && exists(in_folder("folder.mdd/report.json")));
}

static void axes_and_units_change_in_every_format(void **state) {
    (void)state;
    const char *s = tiny_scene();
    static const char outputs[] = "output=[\"pc2\", \"mdd\", \"obj\"]";
    hash_of(SKEIN("run", s, "--out", in_folder("y"), "--set", outputs));
    hash_of(SKEIN("run", s, "--out", in_folder("z"), "--set", outputs, "--up", "z", "--scale", "100"));
    samples y = read_pc2(in_folder("y/sheet.pc2")), z = read_pc2(in_folder("z/sheet.pc2")),
            m = read_mdd(in_folder("z/sheet.mdd"));
    assert_int_equal(y.count, z.count);
    assert_true(y.places[1] != y.places[2]);
    for (size_t i = 0; i < (size_t)y.count * y.points; i++) {
        const float *a = y.places + 3 * i, *b = z.places + 3 * i;
        double placed[3] = {100 * (double)a[0], -100 * (double)a[2], 100 * (double)a[1]};
        for (int k = 0; k < 3; k++) assert_float_equal(b[k], placed[k], 1e-5 * (fabs(placed[k]) + 1e-3));
    }
    assert_memory_equal(m.places, z.places, 3 * (size_t)z.count * z.points * sizeof(float));
    io_mesh mesh;
    assert_int_equal(io_mesh_read(in_folder("z/sheet.obj"), &mesh, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
    const float *last = z.places + 3 * (size_t)(z.count - 1) * z.points;
    for (size_t k = 0; k < 3 * (size_t)z.points; k++) assert_true((float)mesh.positions[k] == last[k]);
    char *text = read_text(in_folder("z/sheet.obj"));
    assert_contains(text, ": a metre is 100, z up; ");
    free(text);
    io_mesh_free(&mesh);
    samples_free(&y);
    samples_free(&z);
    samples_free(&m);

    assert_says(2, "", "skein run: --up x: expected y or z\n", "run", s, "--out", in_folder("x"), "--up", "x");
    assert_says(2, "", "skein run: --scale 0: 0 is out of range: expected from 1e-06 to 1e+06 1/m\n", "run", s, "--out",
                in_folder("x"), "--scale", "0");
    assert_says(2, "", "skein run: --up z: none of the scene's outputs has it (a glTF file is y up, always)\n", "run",
                s, "--out", in_folder("x"), "--up", "z", "--set", "output=[\"csv\"]");
    assert_false(exists(in_folder("x")));
}

/* ---- What does not come to its end ------------------------------------------------------------------------ */

enum { STRIP_VERTICES = 6, STRIP_FACES = 2 };

/* Two squares with a wave in them; as far as `frame`. */
static void strip_places(int frame, double *places) {
    for (int i = 0; i < STRIP_VERTICES; i++) {
        places[3 * i] = i / 2;
        places[3 * i + 1] = sin(0.5 * frame + i / 2);
        places[3 * i + 2] = i % 2;
    }
}

static io_clip strip(const double *places, uint32_t count, const io_clip_params *params) {
    static const uint32_t sizes[] = {4, 4}, corners[] = {0, 1, 3, 2, 2, 3, 5, 4};
    return (io_clip){.name = "strip",
                     .mesh = {places, STRIP_VERTICES, sizes, STRIP_FACES, corners, 8},
                     .fps = 30,
                     .samples = count,
                     .read_path = "",
                     .params = params};
}

static const io_clip_params plain_params = {.every = 1, .scale = 1};

/* Of each format that grows: five samples of ten are a whole file, and none at all is a failure. */
static void a_clip_that_ends_early_is_whole(void **state) {
    (void)state;
    double places[3 * STRIP_VERTICES];
    char name[64], kept[80];
    const io_clip_format *format;
    for (size_t f = 0; (format = io_clip_format_at(f)); f++) {
        if (!format->create) continue;
        for (int way = 0; way < 4; way++) {
            skein_error error = {SKEIN_OK, "", ""};
            snprintf(name, sizeof name, "strip%d%s", way, format->ending);
            snprintf(kept, sizeof kept, "kept%d%s", way, format->ending);
            strip_places(0, places);
            io_clip clip = strip(places, way == 0 ? 5 : 10, &plain_params);
            void *file = format->create(&clip, in_folder(name), &error);
            assert_non_null(file);
            for (int frame = 0; frame < (way == 3 ? 0 : 5); frame++) {
                strip_places(frame, places);
                assert_int_equal(format->add(file, places, &error), SKEIN_OK);
            }
            assert_false(exists(in_folder(name)));
            skein_status status = way < 2 ? format->commit(file, &error) : format->keep(file, in_folder(kept), &error);
            assert_int_equal(status, way < 3 ? SKEIN_OK : SKEIN_ERROR_VALUE);
        }
        snprintf(name, sizeof name, "strip0%s", format->ending);
        io_bytes whole = read_bytes(in_folder(name));
        for (int way = 1; way < 3; way++) {
            snprintf(name, sizeof name, "%s%d%s", way == 1 ? "strip" : "kept", way, format->ending);
            io_bytes other = read_bytes(in_folder(name));
            assert_int_equal(other.size, whole.size);
            assert_memory_equal(other.data, whole.data, whole.size);
            io_bytes_free(&other);
        }
        io_bytes_free(&whole);
        assert_int_equal(count_entries(folder), 3);
        remove_folder(state);
        make_folder(state);
    }
}

static void a_full_disk_leaves_no_clip(void **state) {
    (void)state;
    const char *s = tiny_scene();
    const io_clip_format *format;
    char set[128], out[64];
    for (size_t f = 0; (format = io_clip_format_at(f)); f++) {
        snprintf(set, sizeof set, "output=[\"%s\"]", format->kind.name);
        snprintf(out, sizeof out, "full-%s", format->kind.name);
        outcome o = SKEIN_IN(((surroundings){.file_limit = 400}), "run", s, "--out", in_folder(out), "--set", set);
        assert_status(o, 1);
        assert_contains(o.err, "cannot write: ");
        outcome_free(&o);
        snprintf(out, sizeof out, "full-%s/sheet%s", format->kind.name, format->ending);
        assert_false(exists(in_folder(out)));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(all_formats_hold_the_same_motion),
        TEST(a_file_can_be_asked_for_alone),
        TEST(axes_and_units_change_in_every_format),
        TEST(a_clip_that_ends_early_is_whole),
        TEST(a_full_disk_leaves_no_clip),
    };
    return cmocka_run_group_tests_name("clips", tests, NULL, NULL);
}
